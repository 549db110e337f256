/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts, set by Pango: any script, either direction, taken literally. */
#include <cairo.h>
#include <math.h>
#include <pango/pangocairo.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/output/draw/canvas_parts.h"

/* One family by name, so that pictures look alike on every machine that has it. */
static const char *const FAMILY = "DejaVu Sans, Liberation Sans, sans-serif";
static const double SIZE = 8.0, HALO = 2.4;

PangoLayout *strut_canvas_layout_create(cairo_t *cairo) {
  PangoLayout *layout = pango_cairo_create_layout(cairo);
  if (!layout) return NULL;
  PangoContext *context = pango_layout_get_context(layout);
  cairo_font_options_t *options = cairo_font_options_create();
  /* Letters keep their places whatever the resolution. */
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  pango_cairo_context_set_font_options(context, options);
  cairo_font_options_destroy(options);
  pango_cairo_context_set_resolution(context, 72.0);
  pango_context_set_round_glyph_positions(context, FALSE);
  pango_layout_context_changed(layout);
  return layout;
}

void strut_canvas_layout_free(PangoLayout *layout) {
  if (layout) g_object_unref(layout);
}

static void set_text(strut_canvas *c, const char *text, const strut_font *font) {
  PangoFontDescription *wanted = pango_font_description_new();
  pango_font_description_set_family_static(wanted, FAMILY);
  pango_font_description_set_absolute_size(wanted,
                                           (font->size > 0 ? font->size : SIZE) * PANGO_SCALE);
  if (font->bold) pango_font_description_set_weight(wanted, PANGO_WEIGHT_BOLD);
  if (font->italic) pango_font_description_set_style(wanted, PANGO_STYLE_ITALIC);
  pango_layout_set_font_description(c->layout, wanted);
  pango_font_description_free(wanted);
  pango_layout_set_width(c->layout, font->width > 0 ? (int)(font->width * PANGO_SCALE) : -1);
  PangoAlignment side = font->across > 0.75   ? PANGO_ALIGN_RIGHT
                        : font->across > 0.25 ? PANGO_ALIGN_CENTER
                                              : PANGO_ALIGN_LEFT;
  pango_layout_set_alignment(c->layout, side);
  pango_layout_set_wrap(c->layout, PANGO_WRAP_WORD_CHAR);
  if (g_utf8_validate(text, -1, NULL)) {
    pango_layout_set_text(c->layout, text, -1);
  } else { /* which Pango would complain of on the standard error stream */
    gchar *mended = g_utf8_make_valid(text, -1);
    pango_layout_set_text(c->layout, mended, -1);
    g_free(mended);
  }
}

/* The layout's size [pt]. */
static void measure(strut_canvas *c, double *width, double *height) {
  PangoRectangle logical;
  pango_layout_get_extents(c->layout, NULL, &logical);
  *width = (double)logical.width / PANGO_SCALE;
  *height = (double)logical.height / PANGO_SCALE;
}

void strut_text_size(strut_canvas *c, const char *text, strut_font font, double *width,
                     double *height) {
  set_text(c, text, &font);
  measure(c, width, height);
}

void strut_draw_text(strut_canvas *c, double x, double y, const char *text, strut_font font) {
  double width, height;
  if (!text || !*text) return;
  set_text(c, text, &font);
  measure(c, &width, &height);
  PangoRectangle logical;
  pango_layout_get_extents(c->layout, NULL, &logical);
  cairo_save(c->cairo);
  cairo_translate(c->cairo, strut_canvas_near(x), strut_canvas_near(y));
  if (font.upwards) cairo_rotate(c->cairo, -0.5 * STRUT_PI);
  cairo_move_to(c->cairo, -font.across * width - (double)logical.x / PANGO_SCALE,
                -font.down * height);
  if (font.halo.alpha > 0) {
    cairo_save(c->cairo);
    strut_canvas_ink(c, font.halo);
    pango_cairo_layout_path(c->cairo, c->layout);
    cairo_set_dash(c->cairo, NULL, 0, 0);
    cairo_set_line_width(c->cairo, HALO);
    cairo_stroke(c->cairo);
    cairo_restore(c->cairo);
    cairo_move_to(c->cairo, -font.across * width - (double)logical.x / PANGO_SCALE,
                  -font.down * height);
  }
  strut_canvas_ink(c, font.colour.alpha > 0 ? font.colour : (strut_colour){0, 0, 0, 1});
  pango_cairo_show_layout(c->cairo, c->layout);
  cairo_new_path(c->cairo);
  cairo_restore(c->cairo);
}

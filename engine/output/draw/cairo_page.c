/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/cairo_page.h"

#include <assert.h>
#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <math.h>
#include <pango/pangocairo.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/vec.h"

struct strut_cairo_page {
  cairo_t *cairo;
  cairo_t *ink;        /* the same without texts, a pixel for a point: what labels keep off */
  PangoLayout *layout; /* used for every text in turn */
  strut_page_format format;
  void *context;
  strut_status (*write)(void *context, const void *bytes, size_t count);
};

/* Limit of Cairo's fixed-point numbers; nothing on a page is as far away. Largest side with ink [pt]. */
static const double FARTHEST = 1e6, LARGEST = 20000;

/* Sets the colour of what is drawn next. */
static void set_ink(cairo_t *cairo, strut_colour colour) {
  if (colour.alpha >= 1.0) { /* an opaque source keeps SVG and PDF free of transparency */
    cairo_set_source_rgb(cairo, colour.red, colour.green, colour.blue);
  } else {
    cairo_set_source_rgba(cairo, colour.red, colour.green, colour.blue, colour.alpha);
  }
}

/* A coordinate that Cairo can take: the page's neighbourhood at most; NaN is far away. */
static double clamp_coordinate(double coordinate) {
  if (!(coordinate > -FARTHEST)) return -FARTHEST;
  return coordinate < FARTHEST ? coordinate : FARTHEST;
}

/* ---- texts, set by Pango: any script, either direction, taken literally ---- */

/* A fixed family: pictures look alike on every machine that has it. */
static const char *const FAMILY = "DejaVu Sans, Liberation Sans, sans-serif";
static const double USUAL_SIZE = 8.0, HALO = 2.4;

static PangoLayout *create_layout(cairo_t *cairo) {
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

/* Length of the unit's name at `text` where a prefix u stands for micro, 0 if it is another word. */
static size_t measure_unit(const char *text) {
  static const char *const units[] = {"s", "m", "N", "J", "W", "Hz", "rad", "Pa"};
  for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
    size_t length = strlen(units[i]);
    if (strncmp(text, units[i], length) == 0 && !g_ascii_isalnum(text[length])) return length;
  }
  return 0;
}

/* The text with "50 us", as terminals and tables write it, as "50 µs". To be freed. */
static gchar *write_micro(const gchar *text) {
  GString *written = g_string_new(NULL);
  for (const gchar *at = text; *at; at++) {
    bool quantity = at >= text + 2 && at[-1] == ' ' && g_ascii_isdigit(at[-2]);
    if (*at == 'u' && quantity && measure_unit(at + 1))
      g_string_append(written, "\xc2\xb5");
    else
      g_string_append_c(written, *at);
  }
  return g_string_free(written, FALSE);
}

static void set_text(strut_cairo_page *page, const char *text, const strut_font *font) {
  PangoFontDescription *wanted = pango_font_description_new();
  pango_font_description_set_family_static(wanted, FAMILY);
  pango_font_description_set_absolute_size(
      wanted, (font->size > 0 ? font->size : USUAL_SIZE) * PANGO_SCALE);
  if (font->bold) pango_font_description_set_weight(wanted, PANGO_WEIGHT_BOLD);
  if (font->italic) pango_font_description_set_style(wanted, PANGO_STYLE_ITALIC);
  pango_layout_set_font_description(page->layout, wanted);
  pango_font_description_free(wanted);
  pango_layout_set_width(page->layout, font->width > 0 ? (int)(font->width * PANGO_SCALE) : -1);
  PangoAlignment side = font->across > 0.75   ? PANGO_ALIGN_RIGHT
                        : font->across > 0.25 ? PANGO_ALIGN_CENTER
                                              : PANGO_ALIGN_LEFT;
  pango_layout_set_alignment(page->layout, side);
  pango_layout_set_wrap(page->layout, PANGO_WRAP_WORD_CHAR);
  gchar *valid =
      g_utf8_make_valid(text, -1); /* Pango complains of other texts on the error stream */
  gchar *written = write_micro(valid);
  pango_layout_set_text(page->layout, written, -1);
  g_free(written);
  g_free(valid);
}

/* The layout's own box, or that of its ink [pt]. */
static strut_box measure_layout(strut_cairo_page *page, bool ink) {
  PangoRectangle box;
  pango_layout_get_extents(page->layout, ink ? &box : NULL, ink ? NULL : &box);
  return (strut_box){(double)box.x / PANGO_SCALE, (double)box.y / PANGO_SCALE,
                     (double)box.width / PANGO_SCALE, (double)box.height / PANGO_SCALE};
}

static void find_text_size(strut_cairo_page *page, const char *text, strut_font font, double *width,
                           double *height) {
  set_text(page, text, &font);
  const strut_box box = measure_layout(page, false);
  *width = box.width, *height = box.height;
}

/* True if the box is on the page and inside the clip, but for a hair. */
static bool is_unclipped(strut_cairo_page *page, strut_box box) {
  const double hair = 0.3; /* [pt] */
  double x1, y1, x2, y2;
  cairo_clip_extents(page->cairo, &x1, &y1, &x2, &y2);
  return box.x >= x1 - hair && box.y >= y1 - hair && box.x + box.width <= x2 + hair &&
         box.y + box.height <= y2 + hair;
}

static strut_drawn_text draw_text(strut_cairo_page *page, const double at[2], const char *text,
                                  strut_font font) {
  set_text(page, text, &font);
  const strut_box whole = measure_layout(page, false), own = measure_layout(page, true);
  /* Where the layout's own origin is, before turning. */
  const double corner[2] = {-font.across * whole.width - whole.x, -font.down * whole.height};
  double x = corner[0] + own.x, y = corner[1] + own.y;
  strut_box ink = {at[0] + x, at[1] + y, own.width, own.height};
  if (font.upwards) ink = (strut_box){at[0] + y, at[1] - x - own.width, own.height, own.width};
  const strut_drawn_text drawn = {pango_layout_get_text(page->layout), ink,
                                  is_unclipped(page, ink)};
  cairo_save(page->cairo);
  cairo_translate(page->cairo, clamp_coordinate(at[0]), clamp_coordinate(at[1]));
  if (font.upwards) cairo_rotate(page->cairo, -0.5 * STRUT_PI);
  cairo_move_to(page->cairo, corner[0], corner[1]);
  if (font.halo.alpha > 0) {
    cairo_save(page->cairo);
    set_ink(page->cairo, font.halo);
    pango_cairo_layout_path(page->cairo, page->layout);
    cairo_set_dash(page->cairo, NULL, 0, 0);
    cairo_set_line_width(page->cairo, HALO);
    cairo_stroke(page->cairo);
    cairo_restore(page->cairo);
    cairo_move_to(page->cairo, corner[0], corner[1]);
  }
  set_ink(page->cairo, font.colour.alpha > 0 ? font.colour : (strut_colour){0, 0, 0, 1});
  pango_cairo_show_layout(page->cairo, page->layout);
  cairo_new_path(page->cairo);
  cairo_restore(page->cairo);
  return drawn;
}

/* ---- pages ---- */

static cairo_status_t write_bytes(void *context, const unsigned char *bytes, unsigned int count) {
  strut_cairo_page *page = context;
  strut_status status = page->write(page->context, bytes, count);
  return status == STRUT_OK          ? CAIRO_STATUS_SUCCESS
         : status == STRUT_NO_MEMORY ? CAIRO_STATUS_NO_MEMORY
                                     : CAIRO_STATUS_WRITE_ERROR;
}

static cairo_surface_t *create_surface(strut_cairo_page *page, const strut_page_request *request) {
  double width = request->width, height = request->height, scale = request->scale;
  if (request->format == STRUT_PAGE_SVG)
    return cairo_svg_surface_create_for_stream(write_bytes, page, width, height);
  if (request->format == STRUT_PAGE_PNG || request->format == STRUT_PAGE_PIXELS)
    return cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)(width * scale + 0.5),
                                      (int)(height * scale + 0.5));
  cairo_surface_t *surface = cairo_pdf_surface_create_for_stream(write_bytes, page, width, height);
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_TITLE, request->title);
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATOR, "strut " STRUT_VERSION);
  /* A fixed date keeps the bytes reproducible. */
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATE_DATE, "1970-01-01T00:00:00Z");
  return surface;
}

static void free_page(strut_cairo_page *page) {
  if (!page) return;
  if (page->layout) g_object_unref(page->layout);
  cairo_surface_finish(cairo_get_target(page->cairo));
  cairo_destroy(page->cairo);
  cairo_destroy(page->ink);
  strut_release(page);
}

static strut_cairo_page *open_page(const strut_page_request *request) {
  assert(request->scale > 0);
  strut_cairo_page *page = strut_allocate(1, sizeof *page);
  if (!page) return NULL;
  page->format = request->format;
  page->context = request->context, page->write = request->write;
  cairo_surface_t *surface = create_surface(page, request);
  page->cairo = cairo_create(surface);
  cairo_surface_destroy(surface); /* the context keeps it */
  surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)ceil(fmin(request->width, LARGEST)),
                                       (int)ceil(fmin(request->height, LARGEST)));
  page->ink = cairo_create(surface);
  cairo_surface_destroy(surface);
  cairo_scale(page->cairo, request->scale, request->scale);
  cairo_set_line_join(page->cairo, CAIRO_LINE_JOIN_ROUND);
  page->layout = create_layout(page->cairo);
  if (page->layout && cairo_status(page->cairo) == CAIRO_STATUS_SUCCESS &&
      cairo_status(page->ink) == CAIRO_STATUS_SUCCESS)
    return page;
  free_page(page);
  return NULL;
}

static const unsigned char *pixels_of(strut_cairo_page *page, size_t *stride) {
  assert(page->format == STRUT_PAGE_PIXELS);
  cairo_surface_t *surface = cairo_get_target(page->cairo);
  cairo_surface_flush(surface);
  *stride = (size_t)cairo_image_surface_get_stride(surface);
  return cairo_image_surface_get_data(surface);
}

static strut_status finish_page(strut_cairo_page *page, const char **reason) {
  cairo_status_t status = cairo_status(page->cairo);
  cairo_surface_t *surface = cairo_get_target(page->cairo);
  *reason = NULL;
  if (status == CAIRO_STATUS_SUCCESS) {
    if (page->format == STRUT_PAGE_PNG)
      status = cairo_surface_write_to_png_stream(surface, write_bytes, page);
    cairo_surface_finish(surface);
    if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface);
  }
  if (status == CAIRO_STATUS_SUCCESS) return STRUT_OK;
  if (status == CAIRO_STATUS_NO_MEMORY) return STRUT_NO_MEMORY;
  if (status != CAIRO_STATUS_WRITE_ERROR) *reason = cairo_status_to_string(status);
  return STRUT_FILE_TROUBLE;
}

static void clear_page(strut_cairo_page *page, strut_colour colour) {
  for (int k = 0; k < 2; k++) {
    cairo_t *cairo = k ? page->ink : page->cairo;
    set_ink(cairo, colour);
    cairo_paint(cairo);
  }
}

static void clip_to(strut_cairo_page *page, strut_box box) {
  for (int k = 0; k < 2; k++) {
    cairo_t *cairo = k ? page->ink : page->cairo;
    cairo_save(cairo);
    cairo_rectangle(cairo, box.x, box.y, box.width, box.height);
    cairo_clip(cairo);
  }
}

static void unclip(strut_cairo_page *page) {
  cairo_restore(page->cairo);
  cairo_restore(page->ink);
}

static double sum_ink(strut_cairo_page *page, strut_box box) {
  cairo_surface_t *surface = cairo_get_target(page->ink);
  cairo_surface_flush(surface);
  const unsigned char *bytes = cairo_image_surface_get_data(surface);
  size_t stride = (size_t)cairo_image_surface_get_stride(surface);
  int left = (int)fmax(floor(box.x), 0), top = (int)fmax(floor(box.y), 0);
  int right = (int)fmin(ceil(box.x + box.width), cairo_image_surface_get_width(surface));
  int bottom = (int)fmin(ceil(box.y + box.height), cairo_image_surface_get_height(surface));
  long sum = 0; /* hundredths of darkness, from 0 to 255 */
  for (int y = top; y < bottom; y++)
    for (int x = left; x < right; x++) {
      uint32_t rgb;
      memcpy(&rgb, bytes + (size_t)y * stride + sizeof rgb * (size_t)x, sizeof rgb);
      sum += 25500 - (long)(30 * (rgb >> 16 & 255) + 59 * (rgb >> 8 & 255) + 11 * (rgb & 255));
    }
  return (double)sum / 25500.0;
}

/* ---- lines, areas and their hatching ---- */

static const double HATCH_DISTANCE = 4.0, HATCH_WIDTH = 0.6;

static void set_pen(cairo_t *cairo, const strut_pen *pen) {
  int dashes = 0;
  while (dashes < 4 && pen->dash[dashes] > 0) dashes++;
  set_ink(cairo, pen->colour);
  cairo_set_line_width(cairo, pen->width);
  cairo_set_dash(cairo, pen->dash, dashes, 0);
  cairo_set_line_cap(cairo, pen->butt ? CAIRO_LINE_CAP_BUTT : CAIRO_LINE_CAP_ROUND);
}

/* One line at every HATCH_DISTANCE across the clip, anchored to the page so that areas side by side
   join; `slant` is the line's rise for each point it runs to the right. */
static void hatch_lines(cairo_t *cairo, double slant) {
  double x1, y1, x2, y2;
  cairo_clip_extents(cairo, &x1, &y1, &x2, &y2);
  double step = slant == 0 ? HATCH_DISTANCE : HATCH_DISTANCE * sqrt(2.0);
  double low = y1 + fmin(slant * x1, slant * x2), high = y2 + fmax(slant * x1, slant * x2);
  for (double k = floor(low / step); k * step <= high; k++) {
    cairo_move_to(cairo, x1, k * step - slant * x1);
    cairo_line_to(cairo, x2, k * step - slant * x2);
  }
  cairo_stroke(cairo);
}

static void hatch(cairo_t *cairo, const strut_fill *fill) {
  static const double slants[] = {
      [STRUT_HATCH_RISING] = 1, [STRUT_HATCH_FALLING] = -1, [STRUT_HATCH_LEVEL] = 0};
  const strut_pen pen = {.colour = fill->hatch_colour, .width = HATCH_WIDTH, .butt = true};
  cairo_save(cairo);
  cairo_clip_preserve(cairo);
  cairo_path_t *outline = cairo_copy_path(cairo);
  cairo_new_path(cairo);
  set_pen(cairo, &pen);
  hatch_lines(cairo, slants[fill->hatch]);
  cairo_restore(cairo);
  cairo_append_path(cairo, outline);
  cairo_path_destroy(outline);
}

static void trace(cairo_t *cairo, const strut_outline *outline) {
  cairo_new_path(cairo);
  for (size_t i = 0; i < outline->count; i++) {
    double x = clamp_coordinate(outline->points[i][0]), y = clamp_coordinate(outline->points[i][1]);
    if (outline->kind == STRUT_OUTLINE_CIRCLE)
      cairo_arc(cairo, x, y, outline->radius, 0, 2 * STRUT_PI);
    else if (outline->kind == STRUT_OUTLINE_SEGMENTS && i % 2 == 0)
      cairo_move_to(cairo, x, y);
    else
      cairo_line_to(cairo, x, y);
  }
  if (outline->kind >= STRUT_OUTLINE_CLOSED) cairo_close_path(cairo);
}

/* Nothing is drawn of what has a point that is nowhere. */
static void draw(strut_cairo_page *page, const strut_outline *outline, const strut_fill *fill,
                 const strut_pen *pen) {
  for (size_t i = 0; i < outline->count; i++)
    if (!isfinite(outline->points[i][0] + outline->points[i][1])) return;
  for (int k = 0; k < 2 && outline->count; k++) {
    cairo_t *cairo = k ? page->ink : page->cairo;
    trace(cairo, outline);
    if (fill && fill->colour.alpha > 0) {
      set_ink(cairo, fill->colour);
      cairo_fill_preserve(cairo);
    }
    if (fill && fill->hatch != STRUT_HATCH_NONE) hatch(cairo, fill);
    if (pen && pen->colour.alpha > 0) {
      set_pen(cairo, pen);
      cairo_stroke_preserve(cairo);
    }
    cairo_new_path(cairo);
  }
}

extern STRUT_API const strut_cairo_library strut_cairo_table;
const strut_cairo_library strut_cairo_table = {
    .stamp = STRUT_LIBRARY_STAMP(strut_cairo_library),
    .open = open_page,
    .pixels = pixels_of,
    .finish = finish_page,
    .free = free_page,
    .clear = clear_page,
    .clip = clip_to,
    .unclip = unclip,
    .draw = draw,
    .ink = sum_ink,
    .text = draw_text,
    .text_size = find_text_size,
};

strut_status strut_cairo_load(const strut_cairo_library **library, strut_error *error) {
  (void)error;
  *library = &strut_cairo_table;
  return STRUT_OK;
}

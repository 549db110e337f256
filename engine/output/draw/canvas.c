/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The canvas: all of strut that calls Cairo and Pango. */
#include "engine/output/draw/canvas.h"

#include <assert.h>
#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <errno.h>
#include <math.h>
#include <pango/pangocairo.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/base/vec.h"
#include "engine/output/buffer.h"
#include "engine/output/draw/painter.h"
#include "engine/output/file.h"

struct strut_canvas {
  cairo_t *cairo;
  cairo_t *ink;        /* the same without texts, a pixel for a point: what labels keep off */
  PangoLayout *layout; /* used for every text in turn */
  strut_box box;
  strut_picture_format format;
  strut_file file;    /* zero for pixels in memory */
  strut_buffer svg;   /* gathered; its surfaces are renumbered at the end */
  strut_buffer texts; /* of an SVG: where its texts are, which are drawn as outlines */
  strut_buffer lines; /* or themselves, if they are kept */
  bool keep_texts;
  strut_labels labels;
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

/* Cairo (1.16: surface7, 1.18: source-7) numbers the surfaces of SVG files through the life of the process. Counting
   them from the first one in every picture makes its bytes independent of what was drawn before. Texts are outlines,
   so no other text matches. */
static gchar *renumber_surfaces(const char *svg) {
  enum { LENGTH = 7 };
  GString *out = g_string_sized_new(strlen(svg));
  long first = -1;
  while (*svg) {
    bool name = strncmp(svg, "surface", LENGTH) == 0 || strncmp(svg, "source-", LENGTH) == 0;
    g_string_append_len(out, svg, name ? LENGTH : 1);
    svg += name ? LENGTH : 1;
    if (!name || !g_ascii_isdigit(*svg)) continue;
    char *end;
    long number = strtol(svg, &end, 10);
    if (first < 0) first = number;
    g_string_append_printf(out, "%ld", number - first);
    svg = end;
  }
  return g_string_free(out, FALSE);
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

static bool begins_unit(const char *text) {
  static const char *const units[] = {"s", "m", "N", "J", "W", "Hz", "rad", "Pa"};
  for (size_t i = 0; i < sizeof units / sizeof *units; i++)
    if (g_str_has_prefix(text, units[i]) && !g_ascii_isalnum(text[strlen(units[i])])) return true;
  return false;
}

/* The text with "50 us" and "-1", as terminals and tables write them, as "50 µs" and "−1". To be freed. */
static gchar *write_signs(const gchar *text) {
  GString *out = g_string_new(NULL);
  for (const char *c = text; *c; c++) {
    char before = c > text ? c[-1] : ' ';
    bool word = g_ascii_isalnum(before) || before < 0 || strchr("_.)-", before);
    if (*c == '-' && !word && g_ascii_isdigit(c[1]))
      g_string_append(out, "\xe2\x88\x92");
    else if (*c == 'u' && before == ' ' && c > text + 1 && g_ascii_isdigit(c[-2]) &&
             begins_unit(c + 1))
      g_string_append(out, "\xc2\xb5");
    else
      g_string_append_c(out, *c);
  }
  return g_string_free(out, FALSE);
}

static void set_text(strut_canvas *canvas, const char *text, const strut_font *font) {
  PangoFontDescription *wanted = pango_font_description_new();
  pango_font_description_set_family_static(wanted, FAMILY);
  pango_font_description_set_absolute_size(
      wanted, (font->size > 0 ? font->size : USUAL_SIZE) * PANGO_SCALE);
  if (font->bold) pango_font_description_set_weight(wanted, PANGO_WEIGHT_BOLD);
  if (font->italic) pango_font_description_set_style(wanted, PANGO_STYLE_ITALIC);
  pango_layout_set_font_description(canvas->layout, wanted);
  pango_font_description_free(wanted);
  pango_layout_set_width(canvas->layout, font->width > 0 ? (int)(font->width * PANGO_SCALE) : -1);
  PangoAlignment side = font->across > 0.75   ? PANGO_ALIGN_RIGHT
                        : font->across > 0.25 ? PANGO_ALIGN_CENTER
                                              : PANGO_ALIGN_LEFT;
  pango_layout_set_alignment(canvas->layout, side);
  pango_layout_set_wrap(canvas->layout, PANGO_WRAP_WORD_CHAR);
  pango_layout_set_ellipsize(canvas->layout,
                             font->lines ? PANGO_ELLIPSIZE_END : PANGO_ELLIPSIZE_NONE);
  pango_layout_set_height(canvas->layout, font->lines ? -font->lines : -1);
  gchar *valid =
      g_utf8_make_valid(text, -1); /* Pango complains of other texts on the error stream */
  gchar *written = write_signs(valid);
  pango_layout_set_text(canvas->layout, written, -1);
  g_free(written);
  g_free(valid);
}

/* The layout's own box, or that of its ink [pt]. */
static strut_box measure_layout(strut_canvas *canvas, bool ink) {
  PangoRectangle box;
  pango_layout_get_extents(canvas->layout, ink ? &box : NULL, ink ? NULL : &box);
  return (strut_box){(double)box.x / PANGO_SCALE, (double)box.y / PANGO_SCALE,
                     (double)box.width / PANGO_SCALE, (double)box.height / PANGO_SCALE};
}

strut_box strut_text_box(strut_canvas *canvas, const char *text, strut_font font) {
  if (!text || !*text) return (strut_box){0};
  set_text(canvas, text, &font);
  return measure_layout(canvas, false);
}

/* Adds letters of a text. */
static void add_letters(strut_buffer *out, const char *text, size_t count) {
  for (const char *end = text + count; text < end; text++) {
    unsigned char letter = (unsigned char)*text;
    if (*text == '<' || *text == '&' || *text == '>')
      strut_buffer_add(out, "&#%d;", (int)letter);
    else
      strut_buffer_add(out, "%c", letter < ' ' ? ' ' : *text);
  }
}

/* Notes the text of the layout and the box of its ink for the SVG's metadata, where programs find it. */
static void note_text(strut_canvas *canvas, const strut_box *ink) {
  strut_buffer *out = &canvas->texts;
  if (canvas->format != STRUT_PICTURE_SVG || !isfinite(ink->x + ink->y)) return;
  strut_c_locale locale = strut_c_locale_enter();
  strut_buffer_add(out, "<t box=\"%.1f %.1f %.1f %.1f\">", ink->x, ink->y, ink->width, ink->height);
  strut_c_locale_leave(locale);
  const char *text = pango_layout_get_text(canvas->layout);
  add_letters(out, text, strlen(text));
  strut_buffer_add(out, pango_layout_is_ellipsized(canvas->layout) ? "\u2026</t>\n" : "</t>\n");
}

/* Writes the layout's lines from the corner on, as wide as Pango sets them, about the place of the text. */
static void write_lines(strut_canvas *canvas, const double at[2], const double corner[2],
                        const strut_font *font) {
  strut_buffer *out = &canvas->lines;
  const char *text = pango_layout_get_text(canvas->layout);
  PangoLayoutIter *lines = pango_layout_get_iter(canvas->layout);
  strut_c_locale locale = strut_c_locale_enter();
  do {
    PangoRectangle box;
    const PangoLayoutLine *line = pango_layout_iter_get_line_readonly(lines);
    pango_layout_iter_get_line_extents(lines, NULL, &box);
    const strut_colour *colour = &font->colour;
    strut_buffer_add(
        out,
        "<text transform=\"translate(%.2f,%.2f)%s\" x=\"%.2f\" y=\"%.2f\" textLength=\"%.2f\" "
        "font-size=\"%g\"%s%s fill=\"rgb(%.4g%%,%.4g%%,%.4g%%)\">",
        at[0], at[1], font->upwards ? " rotate(-90)" : "", corner[0] + (double)box.x / PANGO_SCALE,
        corner[1] + (double)pango_layout_iter_get_baseline(lines) / PANGO_SCALE,
        (double)box.width / PANGO_SCALE, font->size > 0 ? font->size : USUAL_SIZE,
        font->bold ? " font-weight=\"bold\"" : "", font->italic ? " font-style=\"italic\"" : "",
        100 * colour->red, 100 * colour->green, 100 * colour->blue);
    add_letters(out, text + line->start_index, (size_t)line->length);
    strut_buffer_add(out, "</text>\n");
  } while (pango_layout_iter_next_line(lines));
  strut_c_locale_leave(locale);
  pango_layout_iter_free(lines);
}

void strut_draw_text(strut_canvas *canvas, double x, double y, const char *text, strut_font font) {
  cairo_t *cairo = canvas->cairo;
  if (!text || !*text) return;
  set_text(canvas, text, &font);
  const strut_box whole = measure_layout(canvas, false), own = measure_layout(canvas, true);
  /* Where the layout's own origin is, before turning. */
  const double corner[2] = {-font.across * whole.width - whole.x, -font.down * whole.height};
  double left = corner[0] + own.x, top = corner[1] + own.y;
  strut_box ink = {x + left, y + top, own.width, own.height};
  if (font.upwards) ink = (strut_box){x + top, y - left - own.width, own.height, own.width};
  note_text(canvas, &ink);
  strut_labels_avoid(&canvas->labels, ink);
  cairo_save(cairo);
  cairo_translate(cairo, clamp_coordinate(x), clamp_coordinate(y));
  if (font.upwards) cairo_rotate(cairo, -0.5 * STRUT_PI);
  cairo_move_to(cairo, corner[0], corner[1]);
  if (font.halo.alpha > 0) {
    cairo_save(cairo);
    set_ink(cairo, font.halo);
    pango_cairo_layout_path(cairo, canvas->layout);
    cairo_set_dash(cairo, NULL, 0, 0);
    cairo_set_line_width(cairo, HALO);
    cairo_stroke(cairo);
    cairo_restore(cairo);
    cairo_move_to(cairo, corner[0], corner[1]);
  }
  set_ink(cairo, font.colour.alpha > 0 ? font.colour : strut_grey(0));
  if (canvas->keep_texts && !pango_layout_is_ellipsized(canvas->layout))
    write_lines(canvas, (const double[2]){x, y}, corner, &font);
  else
    pango_cairo_show_layout(cairo, canvas->layout);
  cairo_new_path(cairo);
  cairo_restore(cairo);
}

/* ---- files ---- */

/* Pixels of a PNG for each point: 300 to the inch, as printers ask for. */
static const double PNG_SCALE = 300.0 / 72.0;

/* SVGs are gathered, since they are changed at the end. */
static cairo_status_t write_bytes(void *context, const unsigned char *bytes, unsigned int count) {
  strut_canvas *canvas = context;
  if (canvas->format == STRUT_PICTURE_SVG) {
    strut_buffer_add(&canvas->svg, "%.*s", (int)count, (const char *)bytes);
    return canvas->svg.failed ? CAIRO_STATUS_NO_MEMORY : CAIRO_STATUS_SUCCESS;
  }
  errno = 0;
  return fwrite(bytes, 1, count, canvas->file.stream) == count ? CAIRO_STATUS_SUCCESS
                                                               : CAIRO_STATUS_WRITE_ERROR;
}

static cairo_surface_t *create_surface(strut_canvas *canvas, double scale, const char *title) {
  double width = canvas->box.width, height = canvas->box.height;
  if (canvas->format == STRUT_PICTURE_SVG)
    return cairo_svg_surface_create_for_stream(write_bytes, canvas, width, height);
  if (canvas->format != STRUT_PICTURE_PDF)
    return cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)(width * scale + 0.5),
                                      (int)(height * scale + 0.5));
  cairo_surface_t *surface =
      cairo_pdf_surface_create_for_stream(write_bytes, canvas, width, height);
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_TITLE, title);
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATOR, "strut " STRUT_VERSION);
  /* A fixed date keeps the bytes reproducible. */
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATE_DATE, "1970-01-01T00:00:00Z");
  return surface;
}

/* With `path`, a canvas that becomes that file. */
static strut_status open_canvas(strut_canvas *wanted, const char *path, double scale,
                                const char *title, strut_canvas **canvas, strut_error *error) {
  assert(scale > 0);
  strut_canvas *c = *canvas = strut_allocate(1, sizeof *c);
  if (!c) return strut_no_memory(error, "");
  *c = *wanted;
  strut_status status = path ? strut_file_open_path(&c->file, path, error) : STRUT_OK;
  if (status == STRUT_OK) {
    cairo_surface_t *page = create_surface(c, scale, title);
    cairo_surface_t *ink =
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)ceil(fmin(c->box.width, LARGEST)),
                                   (int)ceil(fmin(c->box.height, LARGEST)));
    c->cairo = cairo_create(page), c->ink = cairo_create(ink);
    cairo_surface_destroy(page); /* the contexts keep them */
    cairo_surface_destroy(ink);
    cairo_scale(c->cairo, scale, scale);
    cairo_set_line_join(c->cairo, CAIRO_LINE_JOIN_ROUND);
    c->layout = create_layout(c->cairo);
    if (!c->layout || cairo_status(c->cairo) || cairo_status(c->ink))
      status = strut_fail(error, STRUT_NO_MEMORY, "out of memory for a picture of %g by %g points",
                          c->box.width, c->box.height);
  }
  if (status == STRUT_OK) {
    strut_canvas_clear(c, strut_grey(1));
    return STRUT_OK;
  }
  strut_canvas_free(c);
  *canvas = NULL;
  return status;
}

strut_status strut_canvas_open(const char *path, double width, double height, const char *title,
                               strut_canvas **canvas, strut_error *error) {
  strut_canvas wanted = {.box = {0, 0, width, height}, .format = strut_picture_format_of(path)};
  *canvas = NULL;
  strut_status status = strut_figure_check_name(path, error);
  if (status != STRUT_OK) return status;
  return open_canvas(&wanted, path, wanted.format == STRUT_PICTURE_PNG ? PNG_SCALE : 1.0, title,
                     canvas, error);
}

strut_status strut_canvas_open_pixels(int width, int height, double scale, strut_canvas **canvas,
                                      strut_error *error) {
  strut_canvas wanted = {.box = {0, 0, width / scale, height / scale},
                         .format = STRUT_PICTURE_PIXELS};
  return open_canvas(&wanted, NULL, scale, NULL, canvas, error);
}

const unsigned char *strut_canvas_pixels(strut_canvas *canvas, size_t *stride) {
  cairo_surface_t *surface = cairo_get_target(canvas->cairo);
  assert(canvas->format == STRUT_PICTURE_PIXELS);
  strut_labels_place(&canvas->labels, canvas);
  cairo_surface_flush(surface);
  *stride = (size_t)cairo_image_surface_get_stride(surface);
  return cairo_image_surface_get_data(surface);
}

/* Writes the gathered SVG with its metadata before the last tag; false with the reason in errno. */
static bool write_svg(strut_canvas *canvas) {
  FILE *stream = canvas->file.stream;
  char *gathered = strut_buffer_take(&canvas->svg);
  errno = ENOMEM;
  if (!gathered || canvas->texts.failed || canvas->lines.failed)
    return strut_release(gathered), false;
  gchar *svg = renumber_surfaces(gathered);
  const char *end = strstr(svg, "</svg>");
  errno = 0;
  bool good = end && fprintf(stream, "%.*s", (int)(end - svg), svg) >= 0;
  if (good && canvas->lines.length)
    fprintf(stream, "<g font-family=\"%s\">\n%s</g>\n", FAMILY, canvas->lines.text);
  if (good && canvas->texts.length)
    fprintf(stream, "<metadata><texts xmlns=\"urn:strut:texts\">\n%s</texts></metadata>\n",
            canvas->texts.text);
  good = good && fputs(end, stream) >= 0;
  g_free(svg);
  strut_release(gathered);
  return good;
}

strut_status strut_canvas_commit(strut_canvas *canvas, strut_error *error) {
  cairo_surface_t *surface = cairo_get_target(canvas->cairo);
  strut_labels_place(&canvas->labels, canvas);
  cairo_status_t found = cairo_status(canvas->cairo);
  if (!found && canvas->format == STRUT_PICTURE_PNG)
    found = cairo_surface_write_to_png_stream(surface, write_bytes, canvas);
  cairo_surface_finish(surface);
  if (!found) found = cairo_surface_status(surface);
  if (!found && canvas->labels.failed) found = CAIRO_STATUS_NO_MEMORY;
  if (!found && canvas->format == STRUT_PICTURE_SVG && !write_svg(canvas))
    found = CAIRO_STATUS_WRITE_ERROR;
  if (!found) return strut_file_commit(&canvas->file, error);
  strut_status status = found == CAIRO_STATUS_NO_MEMORY ? strut_no_memory(error, "while drawing")
                        : found == CAIRO_STATUS_WRITE_ERROR
                            ? strut_file_trouble(&canvas->file, error)
                            : strut_fail(error, STRUT_FILE_TROUBLE, "cannot draw '%s': %s",
                                         canvas->file.path, cairo_status_to_string(found));
  strut_file_abandon(&canvas->file);
  return status;
}

void strut_canvas_free(strut_canvas *canvas) {
  if (!canvas) return;
  if (canvas->layout) g_object_unref(canvas->layout);
  /* What an abandoned page still writes goes into the file that is removed next. */
  if (canvas->cairo) cairo_surface_finish(cairo_get_target(canvas->cairo));
  cairo_destroy(canvas->cairo);
  cairo_destroy(canvas->ink);
  strut_release(strut_buffer_take(&canvas->svg));
  strut_release(strut_buffer_take(&canvas->texts));
  strut_release(strut_buffer_take(&canvas->lines));
  strut_labels_free(&canvas->labels);
  strut_file_abandon(&canvas->file);
  strut_release(canvas);
}

void strut_canvas_keep_texts(strut_canvas *canvas) {
  canvas->keep_texts = canvas->format == STRUT_PICTURE_SVG;
}

strut_box strut_canvas_box(const strut_canvas *canvas) { return canvas->box; }

void strut_canvas_clear(strut_canvas *canvas, strut_colour colour) {
  for (int k = 0; k < 2; k++) {
    cairo_t *cairo = k ? canvas->ink : canvas->cairo;
    set_ink(cairo, colour);
    cairo_paint(cairo);
  }
}

void strut_canvas_clip(strut_canvas *canvas, strut_box box) {
  for (int k = 0; k < 2; k++) {
    cairo_t *cairo = k ? canvas->ink : canvas->cairo;
    cairo_save(cairo);
    cairo_rectangle(cairo, box.x, box.y, box.width, box.height);
    cairo_clip(cairo);
  }
}

void strut_canvas_unclip(strut_canvas *canvas) {
  cairo_restore(canvas->cairo);
  cairo_restore(canvas->ink);
}

double strut_canvas_ink(strut_canvas *canvas, strut_box box) {
  cairo_surface_t *surface = cairo_get_target(canvas->ink);
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
static const double DOT = 2.7, RING = 3.4; /* radii of labels' marks [pt] */

static void set_pen(cairo_t *cairo, const strut_pen *pen) {
  int dashes = 0;
  while (dashes < 4 && pen->dash[dashes] > 0) dashes++;
  set_ink(cairo, pen->colour);
  cairo_set_line_width(cairo, pen->width);
  cairo_set_dash(cairo, pen->dash, dashes, 0);
  cairo_set_line_cap(cairo, pen->butt ? CAIRO_LINE_CAP_BUTT : CAIRO_LINE_CAP_ROUND);
}

/* Rising lines at every HATCH_DISTANCE within the path, anchored to the page so that areas side by side join. */
static void hatch(cairo_t *cairo, const strut_fill *fill) {
  const strut_pen pen = {.colour = fill->hatch, .width = HATCH_WIDTH, .butt = true};
  const double step = HATCH_DISTANCE * sqrt(2.0);
  double x1, y1, x2, y2;
  cairo_save(cairo);
  cairo_clip_preserve(cairo);
  cairo_path_t *outline = cairo_copy_path(cairo);
  cairo_new_path(cairo);
  set_pen(cairo, &pen);
  cairo_clip_extents(cairo, &x1, &y1, &x2, &y2);
  for (double k = floor((y1 + x1) / step); k * step <= y2 + x2; k++) {
    cairo_move_to(cairo, x1, k * step - x1);
    cairo_line_to(cairo, x2, k * step - x2);
  }
  cairo_stroke(cairo);
  cairo_restore(cairo);
  cairo_append_path(cairo, outline);
  cairo_path_destroy(outline);
}

typedef enum outline_kind {
  LINE,
  SEGMENTS, /* points 2 i and 2 i + 1 belong together */
  CLOSED,
  CIRCLE /* around its only point */
} outline_kind;

typedef struct outline {
  outline_kind kind;
  size_t count;
  const double (*points)[2]; /* (count) */
  double radius;
} outline;

static void trace(cairo_t *cairo, const outline *line) {
  cairo_new_path(cairo);
  for (size_t i = 0; i < line->count; i++) {
    double x = clamp_coordinate(line->points[i][0]), y = clamp_coordinate(line->points[i][1]);
    if (line->kind == CIRCLE)
      cairo_arc(cairo, x, y, line->radius, 0, 2 * STRUT_PI);
    else if (line->kind == SEGMENTS && i % 2 == 0)
      cairo_move_to(cairo, x, y);
    else
      cairo_line_to(cairo, x, y);
  }
  if (line->kind >= CLOSED) cairo_close_path(cairo);
}

/* Nothing is drawn of what has a point that is nowhere. */
static void draw(strut_canvas *canvas, outline line, const strut_fill *fill, const strut_pen *pen) {
  for (size_t i = 0; i < line.count; i++)
    if (!isfinite(line.points[i][0] + line.points[i][1])) return;
  for (int k = 0; k < 2 && line.count; k++) {
    cairo_t *cairo = k ? canvas->ink : canvas->cairo;
    trace(cairo, &line);
    if (fill && fill->colour.alpha > 0) {
      set_ink(cairo, fill->colour);
      cairo_fill_preserve(cairo);
    }
    if (fill && fill->hatch.alpha > 0) hatch(cairo, fill);
    if (pen && pen->colour.alpha > 0) {
      set_pen(cairo, pen);
      cairo_stroke_preserve(cairo);
    }
    cairo_new_path(cairo);
  }
}

void strut_draw_line(strut_canvas *canvas, const double (*points)[2], size_t count, strut_pen pen) {
  draw(canvas, (outline){LINE, count, points, 0}, NULL, &pen);
}

void strut_draw_segments(strut_canvas *canvas, const double (*ends)[2], size_t count,
                         strut_pen pen) {
  draw(canvas, (outline){SEGMENTS, 2 * count, ends, 0}, NULL, &pen);
}

void strut_draw_segment(strut_canvas *canvas, double x1, double y1, double x2, double y2,
                        strut_pen pen) {
  strut_draw_line(canvas, (const double[2][2]){{x1, y1}, {x2, y2}}, 2, pen);
}

void strut_draw_polygon(strut_canvas *canvas, const double (*points)[2], size_t count,
                        const strut_fill *fill, const strut_pen *pen) {
  draw(canvas, (outline){CLOSED, count, points, 0}, fill, pen);
}

void strut_draw_box(strut_canvas *canvas, strut_box box, const strut_fill *fill,
                    const strut_pen *pen) {
  double right = box.x + box.width, bottom = box.y + box.height;
  strut_draw_polygon(
      canvas,
      (const double[4][2]){{box.x, box.y}, {right, box.y}, {right, bottom}, {box.x, bottom}}, 4,
      fill, pen);
}

void strut_draw_circle(strut_canvas *canvas, double x, double y, double radius,
                       const strut_fill *fill, const strut_pen *pen) {
  draw(canvas, (outline){CIRCLE, 1, (const double[1][2]){{x, y}}, radius}, fill, pen);
}

void strut_draw_label(strut_canvas *canvas, const strut_label *label) {
  const strut_pen edge = {.colour = strut_grey(0.1), .width = label->ring ? 0.9 : 0.6};
  const strut_fill fill = {.colour = label->colour};
  if (label->dot || label->ring)
    strut_draw_circle(canvas, label->at[0], label->at[1], label->ring ? RING : DOT,
                      label->dot ? &fill : NULL, &edge);
  strut_labels_add(&canvas->labels, label);
}

void strut_draw_arrow(strut_canvas *canvas, double x1, double y1, double x2, double y2, double head,
                      strut_pen pen) {
  double length = hypot(x2 - x1, y2 - y1);
  if (!(length > 0)) return;
  double along[2] = {(x2 - x1) / length, (y2 - y1) / length}, size = fmin(head, length);
  double neck[2] = {x2 - size * along[0], y2 - size * along[1]};
  if (length > size) {
    strut_pen shaft = pen;
    shaft.butt = true;
    strut_draw_segment(canvas, x1, y1, neck[0] + 0.2 * size * along[0],
                       neck[1] + 0.2 * size * along[1], shaft);
  }
  const double half = 0.35 * size;
  const double tip[3][2] = {{x2, y2},
                            {neck[0] - half * along[1], neck[1] + half * along[0]},
                            {neck[0] + half * along[1], neck[1] - half * along[0]}};
  const strut_fill fill = {.colour = pen.colour};
  strut_draw_polygon(canvas, tip, 3, &fill, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/canvas.h"
#include "engine/base/vec.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/buffer.h"
#include "engine/output/draw/drawing_calls.h"
#include "engine/output/file.h"

struct strut_canvas {
  cairo_t *cairo;
  PangoLayout *layout; /* used for every text in turn */
  strut_box box;
  strut_file file;  /* zero for pixels in memory */
  strut_buffer svg; /* gathered; its surfaces are renumbered at the end */
  bool is_svg, is_png;
};

/* Limit of Cairo's fixed-point numbers; nothing on a page is as far away [pt]. */
static const double FARTHEST = 1e6;

/* Sets the colour of what is drawn next. */
static void set_ink(strut_canvas *c, strut_colour colour) {
  if (colour.alpha >= 1.0) { /* an opaque source keeps SVG and PDF free of transparency */
    cairo_set_source_rgb(c->cairo, colour.red, colour.green, colour.blue);
  } else {
    cairo_set_source_rgba(c->cairo, colour.red, colour.green, colour.blue, colour.alpha);
  }
}

/* A coordinate that Cairo can take: the page's neighbourhood at most; NaN is far away. */
static double clamp_coordinate(double coordinate) {
  if (!(coordinate > -FARTHEST)) return -FARTHEST;
  return coordinate < FARTHEST ? coordinate : FARTHEST;
}

/* Cairo numbers the surfaces of SVG files through the life of the process. Numbering them from 0
   in every picture makes its bytes independent of what was drawn before. */

/* Prefixes of numbered names in Cairo 1.16 and 1.18. Texts are outlines, so no other text
   matches. */
static const char *const prefixes[] = {"surface", "source-"};

typedef struct numbers {
  unsigned long *seen;
  size_t count, room;
} numbers;

/* The place of `number` among those seen so far; false when memory is out. */
static bool find_index(numbers *n, unsigned long number, size_t *place) {
  for (*place = 0; *place < n->count; ++*place)
    if (n->seen[*place] == number) return true;
  if (n->count == n->room) {
    size_t room = 2 * n->room + 16;
    unsigned long *more = strut_reallocate(n->seen, room, sizeof *more);
    if (!more) return false;
    n->seen = more;
    n->room = room;
  }
  n->seen[n->count++] = number;
  return true;
}

/* Length of the prefix of a numbered name at `text`, or 0. */
static size_t numbered(const char *text) {
  for (size_t i = 0; i < sizeof prefixes / sizeof *prefixes; i++) {
    size_t length = strlen(prefixes[i]);
    if (strncmp(text, prefixes[i], length) == 0 && text[length] >= '0' && text[length] <= '9')
      return length;
  }
  return 0;
}

static bool renumber_surfaces(char *svg) {
  numbers n = {0};
  bool good = true;
  char *out = svg;
  for (const char *in = svg; *in && good;) {
    size_t length = *in == 's' ? numbered(in) : 0, place;
    if (!length) {
      *out++ = *in++;
      continue;
    }
    char *end;
    unsigned long number = strtoul(in + length, &end, 10);
    good = find_index(&n, number, &place);
    memmove(out, in, length);
    /* The i-th that appears cannot have a number below i: the new one is never longer. */
    char digits[24];
    size_t count = (size_t)snprintf(digits, sizeof digits, "%zu", place);
    memcpy(out + length, digits, count);
    out += length + count;
    in = end;
  }
  if (good) *out = '\0';
  strut_release(n.seen);
  return good;
}

/* Texts, set by Pango: any script, either direction, taken literally. */

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

static void free_layout(PangoLayout *layout) {
  if (layout) g_object_unref(layout);
}

static void set_text(strut_canvas *c, const char *text, const strut_font *font) {
  PangoFontDescription *wanted = pango_font_description_new();
  pango_font_description_set_family_static(wanted, FAMILY);
  pango_font_description_set_absolute_size(
      wanted, (font->size > 0 ? font->size : USUAL_SIZE) * PANGO_SCALE);
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
static void measure_layout(strut_canvas *c, double *width, double *height) {
  PangoRectangle logical;
  pango_layout_get_extents(c->layout, NULL, &logical);
  *width = (double)logical.width / PANGO_SCALE;
  *height = (double)logical.height / PANGO_SCALE;
}

void strut_text_size(strut_canvas *c, const char *text, strut_font font, double *width,
                     double *height) {
  set_text(c, text, &font);
  measure_layout(c, width, height);
}

void strut_draw_text(strut_canvas *c, double x, double y, const char *text, strut_font font) {
  double width, height;
  if (!text || !*text) return;
  set_text(c, text, &font);
  measure_layout(c, &width, &height);
  PangoRectangle logical;
  pango_layout_get_extents(c->layout, NULL, &logical);
  cairo_save(c->cairo);
  cairo_translate(c->cairo, clamp_coordinate(x), clamp_coordinate(y));
  if (font.upwards) cairo_rotate(c->cairo, -0.5 * STRUT_PI);
  cairo_move_to(c->cairo, -font.across * width - (double)logical.x / PANGO_SCALE,
                -font.down * height);
  if (font.halo.alpha > 0) {
    cairo_save(c->cairo);
    set_ink(c, font.halo);
    pango_cairo_layout_path(c->cairo, c->layout);
    cairo_set_dash(c->cairo, NULL, 0, 0);
    cairo_set_line_width(c->cairo, HALO);
    cairo_stroke(c->cairo);
    cairo_restore(c->cairo);
    cairo_move_to(c->cairo, -font.across * width - (double)logical.x / PANGO_SCALE,
                  -font.down * height);
  }
  set_ink(c, font.colour.alpha > 0 ? font.colour : (strut_colour){0, 0, 0, 1});
  pango_cairo_show_layout(c->cairo, c->layout);
  cairo_new_path(c->cairo);
  cairo_restore(c->cairo);
}

/* Pixels of a PNG for each point: 300 to the inch, as printers ask for. */
static const double PNG_SCALE = 300.0 / 72.0;

typedef enum ending { NO_ENDING, SVG, PDF, PNG } ending;

static ending ending_of(const char *path) {
  const char *dot = strrchr(path, '.');
  if (!dot || strchr(dot, '/') || dot == path || dot[-1] == '/') return NO_ENDING;
  if (strcmp(dot, ".svg") == 0) return SVG;
  if (strcmp(dot, ".pdf") == 0) return PDF;
  return strcmp(dot, ".png") == 0 ? PNG : NO_ENDING;
}

strut_status strut_canvas_check_name(const char *path, strut_error *error) {
  if (ending_of(path) != NO_ENDING) return STRUT_OK;
  return strut_fail(error, STRUT_USAGE,
                    "unknown picture format '%s': the name must end with .svg, .pdf or .png", path);
}

static cairo_status_t gather_bytes(void *context, const unsigned char *bytes, unsigned int count) {
  strut_buffer *svg = context;
  strut_buffer_add(svg, "%.*s", (int)count, (const char *)bytes);
  return svg->failed ? CAIRO_STATUS_NO_MEMORY : CAIRO_STATUS_SUCCESS;
}

static cairo_status_t write_bytes(void *context, const unsigned char *bytes, unsigned int count) {
  strut_file *file = context;
  errno = 0;
  return fwrite(bytes, 1, count, file->stream) == count ? CAIRO_STATUS_SUCCESS
                                                        : CAIRO_STATUS_WRITE_ERROR;
}

/* Opens a drawing context on a surface and takes ownership of the surface. */
static strut_status open_context(strut_canvas *c, cairo_surface_t *surface, double scale,
                                 strut_error *error) {
  c->cairo = cairo_create(surface);
  cairo_surface_destroy(surface); /* the context keeps it */
  cairo_scale(c->cairo, scale, scale);
  cairo_set_line_join(c->cairo, CAIRO_LINE_JOIN_ROUND);
  c->layout = create_layout(c->cairo);
  if (c->layout && cairo_status(c->cairo) == CAIRO_STATUS_SUCCESS) return STRUT_OK;
  return strut_fail(error, STRUT_NO_MEMORY, "out of memory for a picture of %g by %g points",
                    c->box.width, c->box.height);
}

static cairo_surface_t *surface_for(strut_canvas *c, ending kind, const char *title) {
  double width = c->box.width, height = c->box.height;
  c->is_svg = kind == SVG;
  c->is_png = kind == PNG;
  if (kind == SVG) return cairo_svg_surface_create_for_stream(gather_bytes, &c->svg, width, height);
  if (kind == PNG) {
    return cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)(width * PNG_SCALE + 0.5),
                                      (int)(height * PNG_SCALE + 0.5));
  }
  cairo_surface_t *surface =
      cairo_pdf_surface_create_for_stream(write_bytes, &c->file, width, height);
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_TITLE, title);
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATOR, "strut " STRUT_VERSION);
  /* A fixed date keeps the bytes reproducible. */
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATE_DATE, "1970-01-01T00:00:00Z");
  return surface;
}

strut_status strut_canvas_open(const char *path, double width, double height, const char *title,
                               strut_canvas **canvas, strut_error *error) {
  *canvas = NULL;
  strut_status status = strut_canvas_check_name(path, error);
  if (status == STRUT_OK) status = strut_drawing_load(error);
  if (status != STRUT_OK) return status;
  strut_canvas *c = strut_allocate(1, sizeof *c);
  if (!c) return strut_no_memory(error, "");
  *c = (strut_canvas){.box = {0, 0, width, height}};
  status = strut_file_open_path(&c->file, path, error);
  if (status == STRUT_OK) {
    ending kind = ending_of(path);
    status = open_context(c, surface_for(c, kind, title), kind == PNG ? PNG_SCALE : 1.0, error);
  }
  if (status == STRUT_OK) {
    strut_canvas_clear(c, (strut_colour){1, 1, 1, 1});
    *canvas = c;
  } else {
    strut_canvas_free(c);
  }
  return status;
}

strut_status strut_canvas_open_pixels(int width, int height, double scale, strut_canvas **canvas,
                                      strut_error *error) {
  *canvas = NULL;
  strut_status status = strut_drawing_load(error);
  if (status != STRUT_OK) return status;
  strut_canvas *c = strut_allocate(1, sizeof *c);
  if (!c) return strut_no_memory(error, "");
  *c = (strut_canvas){.box = {0, 0, width / scale, height / scale}};
  status =
      open_context(c, cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height), scale, error);
  if (status == STRUT_OK) {
    strut_canvas_clear(c, (strut_colour){1, 1, 1, 1});
    *canvas = c;
  } else {
    strut_canvas_free(c);
  }
  return status;
}

const unsigned char *strut_canvas_pixels(strut_canvas *c, size_t *stride) {
  cairo_surface_t *surface = cairo_get_target(c->cairo);
  cairo_surface_flush(surface);
  *stride = (size_t)cairo_image_surface_get_stride(surface);
  return cairo_image_surface_get_data(surface);
}

static cairo_status_t write_svg(strut_canvas *c) {
  char *text = strut_buffer_take(&c->svg);
  cairo_status_t status = CAIRO_STATUS_NO_MEMORY;
  if (text && renumber_surfaces(text))
    status = write_bytes(&c->file, (const unsigned char *)text, (unsigned)strlen(text));
  strut_release(text);
  return status;
}

strut_status strut_canvas_commit(strut_canvas *c, strut_error *error) {
  cairo_status_t status = cairo_status(c->cairo);
  cairo_surface_t *surface = cairo_get_target(c->cairo);
  if (status == CAIRO_STATUS_SUCCESS) {
    if (c->is_png) status = cairo_surface_write_to_png_stream(surface, write_bytes, &c->file);
    cairo_surface_finish(surface);
    if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface);
    if (status == CAIRO_STATUS_SUCCESS && c->is_svg) status = write_svg(c);
  }
  if (status == CAIRO_STATUS_SUCCESS) return strut_file_commit(&c->file, error);
  strut_status ours = status == CAIRO_STATUS_NO_MEMORY ? strut_no_memory(error, "while drawing")
                      : status == CAIRO_STATUS_WRITE_ERROR
                          ? strut_file_trouble(&c->file, error)
                          : strut_fail(error, STRUT_FILE_TROUBLE, "cannot draw '%s': %s",
                                       c->file.path, cairo_status_to_string(status));
  strut_file_abandon(&c->file);
  return ours;
}

void strut_canvas_free(strut_canvas *c) {
  if (!c) return;
  free_layout(c->layout);
  if (c->cairo) {
    /* What an abandoned surface still writes goes into the file that is removed next. */
    cairo_surface_finish(cairo_get_target(c->cairo));
    cairo_destroy(c->cairo);
  }
  strut_release(strut_buffer_take(&c->svg));
  strut_file_abandon(&c->file);
  strut_release(c);
}

strut_file *strut_canvas_file(strut_canvas *c) { return &c->file; }

strut_box strut_canvas_box(const strut_canvas *c) { return c->box; }

void strut_canvas_clear(strut_canvas *c, strut_colour colour) {
  set_ink(c, colour);
  cairo_paint(c->cairo);
}

void strut_canvas_clip(strut_canvas *c, strut_box box) {
  cairo_save(c->cairo);
  cairo_rectangle(c->cairo, box.x, box.y, box.width, box.height);
  cairo_clip(c->cairo);
}

void strut_canvas_unclip(strut_canvas *c) { cairo_restore(c->cairo); }

/* Lines, areas and their hatching. */

static const double HATCH_DISTANCE = 4.0, HATCH_WIDTH = 0.6;

static void set_pen(strut_canvas *c, const strut_pen *pen) {
  int dashes = 0;
  while (dashes < 4 && pen->dash[dashes] > 0) dashes++;
  set_ink(c, pen->colour);
  cairo_set_line_width(c->cairo, pen->width);
  cairo_set_dash(c->cairo, pen->dash, dashes, 0);
  cairo_set_line_cap(c->cairo, pen->butt ? CAIRO_LINE_CAP_BUTT : CAIRO_LINE_CAP_ROUND);
}

static void trace(strut_canvas *c, const double (*points)[2], size_t count) {
  cairo_new_path(c->cairo);
  for (size_t i = 0; i < count; i++)
    cairo_line_to(c->cairo, clamp_coordinate(points[i][0]), clamp_coordinate(points[i][1]));
}

void strut_draw_line(strut_canvas *c, const double (*points)[2], size_t count, strut_pen pen) {
  if (!count || !(pen.colour.alpha > 0)) return;
  trace(c, points, count);
  set_pen(c, &pen);
  cairo_stroke(c->cairo);
}

void strut_draw_segments(strut_canvas *c, const double (*ends)[2], size_t count, strut_pen pen) {
  if (!count || !(pen.colour.alpha > 0)) return;
  cairo_new_path(c->cairo);
  for (size_t i = 0; i < count; i++) {
    cairo_move_to(c->cairo, clamp_coordinate(ends[2 * i][0]), clamp_coordinate(ends[2 * i][1]));
    cairo_line_to(c->cairo, clamp_coordinate(ends[2 * i + 1][0]),
                  clamp_coordinate(ends[2 * i + 1][1]));
  }
  set_pen(c, &pen);
  cairo_stroke(c->cairo);
}

void strut_draw_segment(strut_canvas *c, double x1, double y1, double x2, double y2,
                        strut_pen pen) {
  const double ends[2][2] = {{x1, y1}, {x2, y2}};
  strut_draw_line(c, ends, 2, pen);
}

/* One line at every HATCH_DISTANCE across the clip, anchored to the page so that areas side by side
   join; `slant` is the line's rise for each point it runs to the right. */
static void hatch_lines(strut_canvas *c, double slant) {
  double x1, y1, x2, y2;
  cairo_clip_extents(c->cairo, &x1, &y1, &x2, &y2);
  double step = slant == 0 ? HATCH_DISTANCE : HATCH_DISTANCE * sqrt(2.0);
  double low = y1 + fmin(slant * x1, slant * x2), high = y2 + fmax(slant * x1, slant * x2);
  for (double k = floor(low / step); k * step <= high; k++) {
    cairo_move_to(c->cairo, x1, k * step - slant * x1);
    cairo_line_to(c->cairo, x2, k * step - slant * x2);
  }
  cairo_stroke(c->cairo);
}

static void hatch_dots(strut_canvas *c) {
  double x1, y1, x2, y2;
  cairo_clip_extents(c->cairo, &x1, &y1, &x2, &y2);
  for (double j = floor(y1 / HATCH_DISTANCE); j * HATCH_DISTANCE <= y2; j++)
    for (double i = floor(x1 / HATCH_DISTANCE); i * HATCH_DISTANCE <= x2; i++) {
      cairo_arc(c->cairo, i * HATCH_DISTANCE, j * HATCH_DISTANCE, HATCH_WIDTH, 0, 2 * STRUT_PI);
      cairo_fill(c->cairo);
    }
}

static void hatch(strut_canvas *c, const strut_fill *fill) {
  cairo_save(c->cairo);
  cairo_clip_preserve(c->cairo);
  cairo_path_t *outline = cairo_copy_path(c->cairo);
  cairo_new_path(c->cairo);
  const strut_pen pen = {.colour = fill->hatch_colour, .width = HATCH_WIDTH, .butt = true};
  set_pen(c, &pen);
  if (fill->hatch == STRUT_HATCH_RISING || fill->hatch == STRUT_HATCH_CROSSED) hatch_lines(c, 1);
  if (fill->hatch == STRUT_HATCH_FALLING || fill->hatch == STRUT_HATCH_CROSSED) hatch_lines(c, -1);
  if (fill->hatch == STRUT_HATCH_LEVEL) hatch_lines(c, 0);
  if (fill->hatch == STRUT_HATCH_DOTS) hatch_dots(c);
  cairo_restore(c->cairo);
  cairo_append_path(c->cairo, outline);
  cairo_path_destroy(outline);
}

/* Fills and strokes the current path. */
static void paint(strut_canvas *c, const strut_fill *fill, const strut_pen *pen) {
  if (fill && fill->colour.alpha > 0) {
    set_ink(c, fill->colour);
    cairo_fill_preserve(c->cairo);
  }
  if (fill && fill->hatch != STRUT_HATCH_NONE) hatch(c, fill);
  if (pen && pen->colour.alpha > 0) {
    set_pen(c, pen);
    cairo_stroke_preserve(c->cairo);
  }
  cairo_new_path(c->cairo);
}

void strut_draw_polygon(strut_canvas *c, const double (*points)[2], size_t count,
                        const strut_fill *fill, const strut_pen *pen) {
  trace(c, points, count);
  cairo_close_path(c->cairo);
  paint(c, fill, pen);
}

void strut_draw_box(strut_canvas *c, strut_box box, const strut_fill *fill, const strut_pen *pen) {
  const double corners[4][2] = {{box.x, box.y},
                                {box.x + box.width, box.y},
                                {box.x + box.width, box.y + box.height},
                                {box.x, box.y + box.height}};
  strut_draw_polygon(c, corners, 4, fill, pen);
}

void strut_draw_circle(strut_canvas *c, double x, double y, double radius, const strut_fill *fill,
                       const strut_pen *pen) {
  cairo_new_path(c->cairo);
  cairo_arc(c->cairo, clamp_coordinate(x), clamp_coordinate(y), radius, 0, 2 * STRUT_PI);
  cairo_close_path(c->cairo);
  paint(c, fill, pen);
}

void strut_draw_arrow(strut_canvas *c, double x1, double y1, double x2, double y2, double head,
                      strut_pen pen) {
  double length = hypot(x2 - x1, y2 - y1);
  if (!(length > 0)) return;
  double along[2] = {(x2 - x1) / length, (y2 - y1) / length}, size = fmin(head, length);
  double neck[2] = {x2 - size * along[0], y2 - size * along[1]};
  if (length > size) {
    strut_pen shaft = pen;
    shaft.butt = true;
    strut_draw_segment(c, x1, y1, neck[0] + 0.2 * size * along[0], neck[1] + 0.2 * size * along[1],
                       shaft);
  }
  const double half = 0.35 * size;
  const double tip[3][2] = {{x2, y2},
                            {neck[0] - half * along[1], neck[1] + half * along[0]},
                            {neck[0] + half * along[1], neck[1] - half * along[0]}};
  const strut_fill fill = {.colour = pen.colour};
  strut_draw_polygon(c, tip, 3, &fill, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/canvas.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/memory.h"
#include "engine/output/buffer.h"
#include "engine/output/draw/cairo_page.h"
#include "engine/output/draw/labels.h"
#include "engine/output/file.h"

struct strut_canvas {
  const strut_cairo_library *cairo;
  strut_cairo_page *page;
  strut_box box;
  strut_file file;    /* zero for pixels in memory */
  strut_buffer svg;   /* gathered; its surfaces are renumbered at the end */
  strut_buffer texts; /* of an SVG: where its texts are, which are drawn as outlines */
  bool is_svg;
  strut_labels labels;
};

/* ---- numbers in SVG files ---- */

/* Cairo numbers the surfaces of SVG files through the life of the process. Counting them from the first one
   in every picture makes its bytes independent of what was drawn before. */

/* Length of the prefix of a numbered name at `text`, of Cairo 1.16 or 1.18, or 0. Texts are outlines, so no other
   text matches. */
static size_t numbered(const char *text) {
  static const char *const prefixes[] = {"surface", "source-"};
  for (size_t i = 0; i < sizeof prefixes / sizeof *prefixes; i++) {
    size_t length = strlen(prefixes[i]);
    if (strncmp(text, prefixes[i], length) == 0 && text[length] >= '0' && text[length] <= '9')
      return length;
  }
  return 0;
}

static void renumber_surfaces(char *svg) {
  unsigned long first = 0;
  char *out = svg;
  for (const char *in = svg; *in;) {
    size_t length = *in == 's' ? numbered(in) : 0;
    if (!length) {
      *out++ = *in++;
      continue;
    }
    char *end, digits[24];
    unsigned long number = strtoul(in + length, &end, 10);
    if (!first) first = number;
    memmove(out, in, length);
    /* Not longer than it was. */
    size_t count =
        (size_t)snprintf(digits, sizeof digits, "%lu", number >= first ? number - first : number);
    memcpy(out + length, digits, count);
    out += length + count;
    in = end;
  }
  *out = '\0';
}

/* ---- files ---- */

/* Pixels of a PNG for each point: 300 to the inch, as printers ask for. */
static const double PNG_SCALE = 300.0 / 72.0;

/* STRUT_PAGE_PIXELS: a name with another ending. */
static strut_page_format read_ending(const char *path) {
  static const char *const endings[] = {".svg", ".pdf", ".png"};
  const char *dot = strrchr(path, '.');
  bool name = dot && !strchr(dot, '/') && dot != path && dot[-1] != '/';
  for (int i = 0; i < 3 && name; i++)
    if (strcmp(dot, endings[i]) == 0) return (strut_page_format)i;
  return STRUT_PAGE_PIXELS;
}

strut_status strut_canvas_check_name(const char *path, strut_error *error) {
  if (read_ending(path) != STRUT_PAGE_PIXELS) return STRUT_OK;
  return strut_fail(error, STRUT_USAGE,
                    "unknown picture format '%s': the name must end with .svg, .pdf or .png, or "
                    ".json for its data",
                    path);
}

static strut_status gather_bytes(void *context, const void *bytes, size_t count) {
  strut_canvas *canvas = context;
  strut_buffer_add(&canvas->svg, "%.*s", (int)count, (const char *)bytes);
  return canvas->svg.failed ? STRUT_NO_MEMORY : STRUT_OK;
}

static strut_status write_bytes(void *context, const void *bytes, size_t count) {
  strut_canvas *canvas = context;
  errno = 0;
  return fwrite(bytes, 1, count, canvas->file.stream) == count ? STRUT_OK : STRUT_FILE_TROUBLE;
}

/* The canvas of a request whose context it becomes; with `path`, one that becomes that file. */
static strut_status open_canvas(strut_page_request *request, const char *path,
                                strut_canvas **canvas, strut_error *error) {
  const strut_cairo_library *cairo = NULL;
  *canvas = NULL;
  strut_status status = strut_cairo_load(&cairo, error);
  if (status != STRUT_OK) return status;
  strut_canvas *c = strut_allocate(1, sizeof *c);
  if (!c) return strut_no_memory(error, "");
  *c = (strut_canvas){.cairo = cairo,
                      .box = {0, 0, request->width, request->height},
                      .is_svg = request->format == STRUT_PAGE_SVG};
  request->context = c;
  if (path) status = strut_file_open_path(&c->file, path, error);
  if (status == STRUT_OK && !(c->page = cairo->open(request)))
    status = strut_fail(error, STRUT_NO_MEMORY, "out of memory for a picture of %g by %g points",
                        c->box.width, c->box.height);
  if (status == STRUT_OK) {
    strut_canvas_clear(c, (strut_colour){1, 1, 1, 1});
    *canvas = c;
  } else {
    strut_canvas_free(c);
  }
  return status;
}

strut_status strut_canvas_open(const char *path, double width, double height, const char *title,
                               strut_canvas **canvas, strut_error *error) {
  strut_page_request request = {.width = width, .height = height, .title = title};
  *canvas = NULL;
  strut_status status = strut_canvas_check_name(path, error);
  if (status != STRUT_OK) return status;
  request.format = read_ending(path);
  request.scale = request.format == STRUT_PAGE_PNG ? PNG_SCALE : 1.0;
  request.write = request.format == STRUT_PAGE_SVG ? gather_bytes : write_bytes;
  return open_canvas(&request, path, canvas, error);
}

strut_status strut_canvas_open_pixels(int width, int height, double scale, strut_canvas **canvas,
                                      strut_error *error) {
  strut_page_request request = {.format = STRUT_PAGE_PIXELS,
                                .width = width / scale,
                                .height = height / scale,
                                .scale = scale};
  return open_canvas(&request, NULL, canvas, error);
}

const unsigned char *strut_canvas_pixels(strut_canvas *canvas, size_t *stride) {
  strut_labels_place(&canvas->labels, canvas);
  return canvas->cairo->pixels(canvas->page, stride);
}

/* Notes a text and the box of its ink for the SVG's metadata, where programs find it. */
static void note_text(strut_canvas *canvas, const strut_drawn_text *drawn) {
  const strut_box *ink = &drawn->ink;
  strut_buffer *out = &canvas->texts;
  if (!canvas->is_svg || !isfinite(ink->x + ink->y)) return;
  strut_c_locale locale = strut_c_locale_enter();
  strut_buffer_add(out, "<t box=\"%.1f %.1f %.1f %.1f\"%s>", ink->x, ink->y, ink->width,
                   ink->height, drawn->whole ? "" : " cut=\"\"");
  strut_c_locale_leave(locale);
  for (const char *text = drawn->text; *text; text++) {
    unsigned char letter = (unsigned char)*text;
    if (*text == '<' || *text == '&' || *text == '>')
      strut_buffer_add(out, "&#%d;", (int)letter);
    else
      strut_buffer_add(out, "%c", letter < ' ' ? ' ' : *text);
  }
  strut_buffer_add(out, "</t>\n");
}

/* The gathered SVG with its metadata before the last tag. */
static strut_status write_svg(strut_canvas *canvas) {
  static const char last[] = "</svg>", space[] = "urn:strut:texts";
  char *svg = strut_buffer_take(&canvas->svg), *end = NULL;
  if (svg) renumber_surfaces(svg);
  if (svg) end = strstr(svg, last);
  if (end) {
    strut_buffer whole = {0};
    strut_buffer_add(&whole, "%.*s", (int)(end - svg), svg);
    if (canvas->texts.length)
      strut_buffer_add(&whole, "<metadata><texts xmlns=\"%s\">\n%s</texts></metadata>\n", space,
                       canvas->texts.text);
    strut_buffer_add(&whole, "%s", end);
    whole.failed = whole.failed || canvas->texts.failed;
    strut_release(svg);
    svg = strut_buffer_take(&whole);
  }
  strut_status status = end && svg ? write_bytes(canvas, svg, strlen(svg)) : STRUT_NO_MEMORY;
  strut_release(svg);
  return status;
}

strut_status strut_canvas_commit(strut_canvas *canvas, strut_error *error) {
  const char *reason = NULL;
  strut_labels_place(&canvas->labels, canvas);
  strut_status status = canvas->cairo->finish(canvas->page, &reason);
  if (status == STRUT_OK && canvas->labels.failed) status = STRUT_NO_MEMORY;
  if (status == STRUT_OK && canvas->is_svg) status = write_svg(canvas);
  if (status == STRUT_OK) return strut_file_commit(&canvas->file, error);
  if (status == STRUT_NO_MEMORY)
    status = strut_no_memory(error, "while drawing");
  else if (!reason)
    status = strut_file_trouble(&canvas->file, error);
  else
    status =
        strut_fail(error, STRUT_FILE_TROUBLE, "cannot draw '%s': %s", canvas->file.path, reason);
  strut_file_abandon(&canvas->file);
  return status;
}

void strut_canvas_free(strut_canvas *canvas) {
  if (!canvas) return;
  /* What an abandoned page still writes goes into the file that is removed next. */
  canvas->cairo->free(canvas->page);
  strut_release(strut_buffer_take(&canvas->svg));
  strut_release(strut_buffer_take(&canvas->texts));
  strut_labels_free(&canvas->labels);
  strut_file_abandon(&canvas->file);
  strut_release(canvas);
}

strut_file *strut_canvas_file(strut_canvas *canvas) { return &canvas->file; }

/* ---- drawing ---- */

static const double DOT = 2.7, RING = 3.4; /* radii [pt] */

strut_box strut_canvas_box(const strut_canvas *canvas) { return canvas->box; }

void strut_canvas_clear(strut_canvas *canvas, strut_colour colour) {
  canvas->cairo->clear(canvas->page, colour);
}

void strut_canvas_clip(strut_canvas *canvas, strut_box box) {
  canvas->cairo->clip(canvas->page, box);
}

void strut_canvas_unclip(strut_canvas *canvas) { canvas->cairo->unclip(canvas->page); }

double strut_canvas_ink(strut_canvas *canvas, strut_box box) {
  return canvas->cairo->ink(canvas->page, box);
}

void strut_draw_line(strut_canvas *canvas, const double (*points)[2], size_t count, strut_pen pen) {
  const strut_outline line = {STRUT_OUTLINE_LINE, count, points, 0};
  canvas->cairo->draw(canvas->page, &line, NULL, &pen);
}

void strut_draw_segments(strut_canvas *canvas, const double (*ends)[2], size_t count,
                         strut_pen pen) {
  const strut_outline segments = {STRUT_OUTLINE_SEGMENTS, 2 * count, ends, 0};
  canvas->cairo->draw(canvas->page, &segments, NULL, &pen);
}

void strut_draw_segment(strut_canvas *canvas, double x1, double y1, double x2, double y2,
                        strut_pen pen) {
  const double ends[2][2] = {{x1, y1}, {x2, y2}};
  strut_draw_line(canvas, ends, 2, pen);
}

void strut_draw_polygon(strut_canvas *canvas, const double (*points)[2], size_t count,
                        const strut_fill *fill, const strut_pen *pen) {
  const strut_outline polygon = {STRUT_OUTLINE_CLOSED, count, points, 0};
  canvas->cairo->draw(canvas->page, &polygon, fill, pen);
}

void strut_draw_box(strut_canvas *canvas, strut_box box, const strut_fill *fill,
                    const strut_pen *pen) {
  const double corners[4][2] = {{box.x, box.y},
                                {box.x + box.width, box.y},
                                {box.x + box.width, box.y + box.height},
                                {box.x, box.y + box.height}};
  strut_draw_polygon(canvas, corners, 4, fill, pen);
}

void strut_draw_circle(strut_canvas *canvas, double x, double y, double radius,
                       const strut_fill *fill, const strut_pen *pen) {
  const double centre[1][2] = {{x, y}};
  const strut_outline circle = {STRUT_OUTLINE_CIRCLE, 1, centre, radius};
  canvas->cairo->draw(canvas->page, &circle, fill, pen);
}

void strut_text_size(strut_canvas *canvas, const char *text, strut_font font, double *width,
                     double *height) {
  canvas->cairo->text_size(canvas->page, text, font, width, height);
}

double strut_text_width(strut_canvas *canvas, const char *text, strut_font font) {
  double width, height;
  strut_text_size(canvas, text, font, &width, &height);
  return width;
}

double strut_text_height(strut_canvas *canvas, const char *text, strut_font font) {
  double width, height;
  strut_text_size(canvas, text, font, &width, &height);
  return height;
}

void strut_draw_text(strut_canvas *canvas, double x, double y, const char *text, strut_font font) {
  if (!text || !*text) return;
  const strut_drawn_text drawn =
      canvas->cairo->text(canvas->page, (const double[2]){x, y}, text, font);
  strut_labels_avoid(&canvas->labels, drawn.ink);
  note_text(canvas, &drawn);
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

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/canvas.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/memory.h"
#include "engine/base/vec.h"
#include "engine/output/buffer.h"
#include "engine/output/draw/cairo_page.h"
#include "engine/output/draw/labels.h"
#include "engine/output/draw/page_ink.h"
#include "engine/output/file.h"

enum { MOST_CLIPS = 8, CIRCLE = 12 };

struct strut_canvas {
  const strut_cairo_library *cairo;
  strut_cairo_page *page;
  strut_box box;
  strut_file file;    /* zero for pixels in memory */
  strut_buffer svg;   /* gathered; its surfaces are renumbered at the end */
  strut_buffer texts; /* of an SVG: where its texts are, which are drawn as outlines */
  bool is_svg;
  strut_page_ink ink;
  strut_labels labels;
  strut_box clips[MOST_CLIPS + 1]; /* the page, and the boxes inside which is drawn */
  size_t clip_count;
};

/* ---- numbers in SVG files ---- */

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
  strut_canvas *c = context;
  strut_buffer_add(&c->svg, "%.*s", (int)count, (const char *)bytes);
  return c->svg.failed ? STRUT_NO_MEMORY : STRUT_OK;
}

static strut_status write_bytes(void *context, const void *bytes, size_t count) {
  strut_canvas *c = context;
  errno = 0;
  return fwrite(bytes, 1, count, c->file.stream) == count ? STRUT_OK : STRUT_FILE_TROUBLE;
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
  c->clips[0] = c->box;
  if (status == STRUT_OK && (!strut_page_ink_create(&c->ink, c->box.width, c->box.height) ||
                             !(c->page = cairo->open(request))))
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

const unsigned char *strut_canvas_pixels(strut_canvas *c, size_t *stride) {
  strut_labels_place(&c->labels, c, &c->ink);
  return c->cairo->pixels(c->page, stride);
}

/* Notes a text and the box of its ink for the SVG's metadata, where programs find it. */
static void note_text(strut_canvas *c, const strut_drawn_text *drawn) {
  const strut_box *ink = &drawn->ink;
  strut_buffer *out = &c->texts;
  if (!c->is_svg || !isfinite(ink->x + ink->y)) return;
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
static strut_status write_svg(strut_canvas *c) {
  static const char last[] = "</svg>", space[] = "urn:strut:texts";
  char *svg = strut_buffer_take(&c->svg), *end = NULL;
  if (svg && renumber_surfaces(svg)) end = strstr(svg, last);
  if (end) {
    strut_buffer whole = {0};
    strut_buffer_add(&whole, "%.*s", (int)(end - svg), svg);
    if (c->texts.length)
      strut_buffer_add(&whole, "<metadata><texts xmlns=\"%s\">\n%s</texts></metadata>\n", space,
                       c->texts.text);
    strut_buffer_add(&whole, "%s", end);
    whole.failed = whole.failed || c->texts.failed;
    strut_release(svg);
    svg = strut_buffer_take(&whole);
  }
  strut_status status = end && svg ? write_bytes(c, svg, strlen(svg)) : STRUT_NO_MEMORY;
  strut_release(svg);
  return status;
}

strut_status strut_canvas_commit(strut_canvas *c, strut_error *error) {
  const char *reason = NULL;
  strut_labels_place(&c->labels, c, &c->ink);
  strut_status status = c->cairo->finish(c->page, &reason);
  if (status == STRUT_OK && c->labels.failed) status = STRUT_NO_MEMORY;
  if (status == STRUT_OK && c->is_svg) status = write_svg(c);
  if (status == STRUT_OK) return strut_file_commit(&c->file, error);
  if (status == STRUT_NO_MEMORY)
    status = strut_no_memory(error, "while drawing");
  else if (!reason)
    status = strut_file_trouble(&c->file, error);
  else
    status = strut_fail(error, STRUT_FILE_TROUBLE, "cannot draw '%s': %s", c->file.path, reason);
  strut_file_abandon(&c->file);
  return status;
}

void strut_canvas_free(strut_canvas *c) {
  if (!c) return;
  /* What an abandoned page still writes goes into the file that is removed next. */
  c->cairo->free(c->page);
  strut_release(strut_buffer_take(&c->svg));
  strut_release(strut_buffer_take(&c->texts));
  strut_labels_free(&c->labels);
  strut_page_ink_free(&c->ink);
  strut_file_abandon(&c->file);
  strut_release(c);
}

strut_file *strut_canvas_file(strut_canvas *c) { return &c->file; }

/* ---- drawing ---- */

strut_box strut_canvas_box(const strut_canvas *c) { return c->box; }

void strut_canvas_clear(strut_canvas *c, strut_colour colour) { c->cairo->clear(c->page, colour); }

void strut_canvas_clip(strut_canvas *c, strut_box box) {
  const strut_box *outer = &c->clips[c->clip_count];
  assert(c->clip_count < MOST_CLIPS);
  strut_box both = {fmax(outer->x, box.x), fmax(outer->y, box.y), 0, 0};
  both.width = fmin(outer->x + outer->width, box.x + box.width) - both.x;
  both.height = fmin(outer->y + outer->height, box.y + box.height) - both.y;
  c->clips[++c->clip_count] = both;
  c->cairo->clip(c->page, box);
}

void strut_canvas_unclip(strut_canvas *c) {
  assert(c->clip_count > 0);
  c->clip_count--;
  c->cairo->unclip(c->page);
}

static void blacken_line(strut_canvas *c, const double (*points)[2], size_t count, strut_pen pen) {
  strut_page_ink_line(&c->ink, c->clips[c->clip_count], points, count, pen);
}

void strut_draw_line(strut_canvas *c, const double (*points)[2], size_t count, strut_pen pen) {
  blacken_line(c, points, count, pen);
  c->cairo->line(c->page, points, count, pen);
}

void strut_draw_segments(strut_canvas *c, const double (*ends)[2], size_t count, strut_pen pen) {
  for (size_t i = 0; i < count; i++) blacken_line(c, ends + 2 * i, 2, pen);
  c->cairo->segments(c->page, ends, count, pen);
}

void strut_draw_segment(strut_canvas *c, double x1, double y1, double x2, double y2,
                        strut_pen pen) {
  const double ends[2][2] = {{x1, y1}, {x2, y2}};
  strut_draw_line(c, ends, 2, pen);
}

static void blacken_polygon(strut_canvas *c, const double (*points)[2], size_t count,
                            const strut_fill *fill, const strut_pen *pen) {
  if (fill) strut_page_ink_fill(&c->ink, c->clips[c->clip_count], points, count, fill);
  if (!pen || !count) return;
  const double closing[2][2] = {{points[count - 1][0], points[count - 1][1]},
                                {points[0][0], points[0][1]}};
  blacken_line(c, points, count, *pen);
  blacken_line(c, closing, 2, *pen);
}

void strut_draw_polygon(strut_canvas *c, const double (*points)[2], size_t count,
                        const strut_fill *fill, const strut_pen *pen) {
  blacken_polygon(c, points, count, fill, pen);
  c->cairo->polygon(c->page, points, count, fill, pen);
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
  double points[CIRCLE][2];
  for (int i = 0; i < CIRCLE; i++) {
    double angle = STRUT_TAU * i / CIRCLE;
    points[i][0] = x + radius * cos(angle), points[i][1] = y + radius * sin(angle);
  }
  blacken_polygon(c, (const double(*)[2])points, CIRCLE, fill, pen);
  c->cairo->circle(c->page, (const double[2]){x, y}, radius, fill, pen);
}

void strut_text_size(strut_canvas *c, const char *text, strut_font font, double *width,
                     double *height) {
  c->cairo->text_size(c->page, text, font, width, height);
}

double strut_text_width(strut_canvas *c, const char *text, strut_font font) {
  double width, height;
  strut_text_size(c, text, font, &width, &height);
  return width;
}

double strut_text_height(strut_canvas *c, const char *text, strut_font font) {
  double width, height;
  strut_text_size(c, text, font, &width, &height);
  return height;
}

void strut_draw_text(strut_canvas *c, double x, double y, const char *text, strut_font font) {
  if (!text || !*text) return;
  const strut_drawn_text drawn = c->cairo->text(c->page, (const double[2]){x, y}, text, font);
  strut_labels_avoid(&c->labels, drawn.ink);
  note_text(c, &drawn);
}

void strut_draw_label(strut_canvas *c, const strut_label *label) {
  strut_labels_add(&c->labels, label);
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

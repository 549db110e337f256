/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/canvas.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <errno.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/draw/canvas_parts.h"

/* Pixels of a PNG for each point: 300 to the inch, as printers ask for. */
static const double PNG_SCALE = 300.0 / 72.0;

/* Beyond this Cairo's fixed-point numbers end; nothing on a page is so far away [pt]. */
static const double FARTHEST = 1e6;

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
                    "the name of a picture says how it is written: '%s' should end with .svg, .pdf "
                    "or .png",
                    path);
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

/* The drawing context on a surface, which it takes over. */
static strut_status start(strut_canvas *c, cairo_surface_t *surface, double scale,
                          strut_error *error) {
  c->cairo = cairo_create(surface);
  cairo_surface_destroy(surface); /* the context keeps it */
  cairo_scale(c->cairo, scale, scale);
  cairo_set_line_join(c->cairo, CAIRO_LINE_JOIN_ROUND);
  c->layout = strut_canvas_layout_create(c->cairo);
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
  /* Without one of ours it takes the clock's. */
  cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATE_DATE, "1970-01-01T00:00:00Z");
  return surface;
}

strut_status strut_canvas_open(const char *path, double width, double height, const char *title,
                               strut_canvas **canvas, strut_error *error) {
  *canvas = NULL;
  strut_status status = strut_canvas_check_name(path, error);
  if (status != STRUT_OK) return status;
  strut_canvas *c = strut_allocate(1, sizeof *c);
  if (!c) return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  *c = (strut_canvas){.box = {0, 0, width, height}};
  status = strut_file_open_path(&c->file, path, error);
  if (status == STRUT_OK) {
    ending kind = ending_of(path);
    status = start(c, surface_for(c, kind, title), kind == PNG ? PNG_SCALE : 1.0, error);
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
  strut_canvas *c = strut_allocate(1, sizeof *c);
  *canvas = NULL;
  if (!c) return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  *c = (strut_canvas){.box = {0, 0, width / scale, height / scale}};
  strut_status status =
      start(c, cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height), scale, error);
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
  if (text && strut_canvas_renumber(text))
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
  strut_status ours = status == CAIRO_STATUS_NO_MEMORY
                          ? strut_fail(error, STRUT_NO_MEMORY, "out of memory while drawing")
                      : status == CAIRO_STATUS_WRITE_ERROR
                          ? strut_file_trouble(&c->file, error)
                          : strut_fail(error, STRUT_FILE_TROUBLE, "cannot draw '%s': %s",
                                       c->file.path, cairo_status_to_string(status));
  strut_file_abandon(&c->file);
  return ours;
}

void strut_canvas_free(strut_canvas *c) {
  if (!c) return;
  strut_canvas_layout_free(c->layout);
  if (c->cairo) {
    /* What an abandoned surface still writes goes into the file that is removed next. */
    cairo_surface_finish(cairo_get_target(c->cairo));
    cairo_destroy(c->cairo);
  }
  strut_release(strut_buffer_take(&c->svg));
  strut_file_abandon(&c->file);
  strut_release(c);
}

strut_box strut_canvas_box(const strut_canvas *c) { return c->box; }

void strut_canvas_clear(strut_canvas *c, strut_colour colour) {
  strut_canvas_ink(c, colour);
  cairo_paint(c->cairo);
}

void strut_canvas_clip(strut_canvas *c, strut_box box) {
  cairo_save(c->cairo);
  cairo_rectangle(c->cairo, box.x, box.y, box.width, box.height);
  cairo_clip(c->cairo);
}

void strut_canvas_unclip(strut_canvas *c) { cairo_restore(c->cairo); }

void strut_canvas_ink(strut_canvas *c, strut_colour colour) {
  if (colour.alpha >= 1.0) { /* an opaque source keeps SVG and PDF free of transparency */
    cairo_set_source_rgb(c->cairo, colour.red, colour.green, colour.blue);
  } else {
    cairo_set_source_rgba(c->cairo, colour.red, colour.green, colour.blue, colour.alpha);
  }
}

double strut_canvas_near(double coordinate) {
  if (!(coordinate > -FARTHEST)) return -FARTHEST;
  return coordinate < FARTHEST ? coordinate : FARTHEST;
}

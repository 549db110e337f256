/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Work-precision diagrams: error over force evaluations and over CPU time, side by side. */
#include <math.h>
#include <stdio.h>

#include "engine/output/draw/canvas.h"
#include "engine/output/draw/work_precision.h"
#include "tests/bench/precision.h"

enum { MOST_GROUPS = 40, MOST_POINTS = 600 };
static const double LEAST = 1e-12;                       /* error at the lower edge */
static const double WIDTH = 640, HEIGHT = 340, EDGE = 8; /* [pt] */

typedef struct diagram {
  size_t groups, count;
  const char *names[MOST_GROUPS];
  strut_saving points[MOST_POINTS];
} diagram;

static double cost_of(const precision_row *row, bool time) {
  return time ? row->answer.seconds : (double)row->answer.evaluations;
}

static void fill(diagram *d, const precision_row *rows, size_t count, bool time) {
  const precision_method *last = NULL;
  *d = (diagram){0};
  for (size_t i = 0; i < count && d->count < MOST_POINTS; i++) {
    const precision_row *row = &rows[i];
    if (!(row->error < 1.0)) continue;
    if (row->method != last) d->names[d->groups++] = row->method->name;
    last = row->method;
    d->points[d->count++] = (strut_saving){.group = (int)d->groups - 1,
                                           .cost = cost_of(row, time),
                                           .error = fmax(row->error, LEAST),
                                           .low = (double)NAN,
                                           .high = (double)NAN};
  }
}

static strut_status draw_panel(strut_canvas *canvas, strut_box box, const diagram *d,
                               const char *title, bool time) {
  const strut_work_precision wanted = {
      .title = title,
      .cost = {time ? "CPU time [s]" : "force evaluations", "", true, (double)NAN, (double)NAN},
      .error = {"relative error of the velocity", "", true, LEAST, 1.0},
      .group_count = d->groups,
      .count = d->count,
      .groups = d->names,
      .bargains = d->points};
  return strut_draw_work_precision(canvas, box, &wanted);
}

strut_status precision_draw(const char *path, const precision_scene *scene,
                            const precision_row *rows, size_t count, strut_error *error) {
  static diagram d;
  strut_canvas *canvas = NULL;
  strut_box box = {EDGE, EDGE, 0.5 * WIDTH - 1.5 * EDGE, HEIGHT - 2 * EDGE};
  strut_status status = strut_canvas_open(path, WIDTH, HEIGHT, scene->title, &canvas, error);
  for (int time = 0; time < 2 && status == STRUT_OK; time++) {
    fill(&d, rows, count, time == 1);
    status = draw_panel(canvas, box, &d, time ? "" : scene->title, time == 1);
    box.x += 0.5 * WIDTH - 0.5 * EDGE;
    if (status != STRUT_OK) strut_fail(error, status, "out of memory while drawing");
  }
  if (status == STRUT_OK) status = strut_canvas_commit(canvas, error);
  strut_canvas_free(canvas);
  return status;
}

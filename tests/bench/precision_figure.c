/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Work-precision diagrams: error over force evaluations and over CPU time, side by side. */
#include <math.h>
#include <stdio.h>

#include "engine/output/figures/work_precision.h"
#include "tests/bench/precision.h"

enum { MOST_GROUPS = 40, MOST_POINTS = 600 };
static const double LEAST = 1e-12;             /* error at the lower edge */
static const double WIDTH = 640, HEIGHT = 330; /* [pt] */

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

static void add_panel(const diagram *d, bool time, strut_figure *figure) {
  const strut_work_precision wanted = {
      .cost = strut_axis_of(time ? "CPU time [s]" : "force evaluations", ""),
      .error = {.name = "relative error of the velocity", .unit = "", .low = LEAST, .high = 1.0},
      .group_count = d->groups,
      .count = d->count,
      .groups = d->names,
      .bargains = d->points};
  strut_add_work_precision(figure, &wanted)->height = HEIGHT;
}

strut_status precision_draw(const char *path, const precision_scene *scene,
                            const precision_row *rows, size_t count, strut_error *error) {
  static diagram d[2];
  const strut_plot plot = {.path = path, .width = WIDTH};
  strut_figure figure = {.title = scene->title, .columns = 2, .least_width = 0.4 * WIDTH};
  for (int time = 0; time < 2; time++) {
    fill(&d[time], rows, count, time == 1);
    add_panel(&d[time], time == 1, &figure);
  }
  return strut_figure_draw(&plot, &figure, error);
}

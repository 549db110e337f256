/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Work-precision diagrams: error over force evaluations and over CPU time, side by side. */
#include <math.h>
#include <stdio.h>

#include "engine/output/figures/work_precision.h"
#include "tests/bench/precision.h"

enum { MOST_POINTS = 600 };
static const double LEAST = 1e-12;             /* error at the lower edge */
static const double WIDTH = 640, HEIGHT = 330; /* [pt] */

static size_t fill(strut_saving *points, const precision_row *rows, size_t count, bool time) {
  size_t used = 0;
  for (size_t i = 0; i < count && used < MOST_POINTS; i++) {
    const precision_answer *answer = &rows[i].answer;
    if (!(rows[i].error < 1.0)) continue;
    points[used++] = (strut_saving){.group = rows[i].method->name,
                                    .cost = time ? answer->seconds : (double)answer->evaluations,
                                    .error = fmax(rows[i].error, LEAST),
                                    .low = (double)NAN,
                                    .high = (double)NAN};
  }
  return used;
}

strut_status precision_draw(const char *path, const precision_scene *scene,
                            const precision_row *rows, size_t count, strut_error *error) {
  static strut_saving points[2][MOST_POINTS];
  const strut_plot plot = {.path = path, .width = WIDTH};
  strut_figure figure = {.title = scene->title, .columns = 2, .least_width = 0.4 * WIDTH};
  for (int time = 0; time < 2; time++) {
    const strut_axis error_axis = {
        .name = "relative error of the velocity", .unit = "", .low = LEAST, .high = 1.0};
    size_t used = fill(points[time], rows, count, time == 1);
    strut_add_work_precision(&figure,
                             strut_axis_of(time ? "CPU time [s]" : "force evaluations", ""),
                             error_axis, points[time], used)
        ->height = HEIGHT;
  }
  return strut_figure_draw(&plot, &figure, error);
}

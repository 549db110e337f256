/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Work-precision diagrams: error over force evaluations and over CPU time, side by side. */
#include <math.h>
#include <string.h>

#include "engine/output/draw/figure.h"
#include "tests/bench/precision.h"

static const double LEAST = 1e-12;             /* error at the lower edge */
static const double WIDTH = 640, HEIGHT = 330; /* [pt] */

/* A line for each method: what follows each other is of one. */
static void add_lines(strut_figure *figure, strut_panel *panel, const precision_row *rows,
                      size_t count, bool time) {
  strut_series *line = NULL;
  for (size_t i = 0; i < count; i++) {
    const precision_answer *answer = &rows[i].answer;
    if (!(rows[i].error < 1.0)) continue;
    if (!line || strcmp(line->label, rows[i].method->name) != 0)
      line = strut_add_series(figure, panel, rows[i].method->name);
    strut_add_point(figure, line, time ? answer->seconds : (double)answer->evaluations,
                    fmax(rows[i].error, LEAST));
  }
}

strut_status precision_draw(const char *path, const precision_scene *scene,
                            const precision_row *rows, size_t count, strut_error *error) {
  const strut_plot plot = {.path = path, .width = WIDTH};
  strut_figure figure = {.title = scene->title, .columns = 2, .least_width = 0.4 * WIDTH};
  for (int time = 0; time < 2; time++) {
    strut_panel *panel = strut_add_panel(&figure);
    panel->x = strut_axis_of(time ? "CPU time [s]" : "force evaluations", "");
    panel->y = strut_axis_of("relative error of the velocity", "");
    panel->y.low = LEAST, panel->y.high = 1.0;
    panel->x.logarithmic = panel->y.logarithmic = true;
    panel->height = HEIGHT;
    add_lines(&figure, panel, rows, count, time == 1);
  }
  return strut_figure_draw(&plot, &figure, error);
}

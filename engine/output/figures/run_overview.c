/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The overview of a run: where it ended, how it got there, and curves of the last periods. */
#include <math.h>
#include <stdio.h>

#include "engine/output/figures/run_parts.h"

static const double EDGE = 5, TITLE = 26, SCALE = 46, CHART = 130, MARGIN = 26;
static const double PERIODS = 5, PART = 0.1; /* of what was recorded, where nothing is periodic */

static size_t first_of_trails(const strut_run_scene *run) {
  const strut_trajectory *m = run->motion;
  double all = m->time[m->frames - 1] - m->time[0];
  return strut_run_since(run, run->period > 0 ? fmin(run->period, all) : PART * all);
}

static size_t first_of_curves(const strut_run_scene *run) {
  const strut_trajectory *m = run->motion;
  double all = m->time[m->frames - 1] - m->time[0];
  return strut_run_since(run, run->period > 0 ? fmin(PERIODS * run->period, all) : all);
}

static bool bounds_of(strut_run_scene *run, strut_bounds *bounds) {
  *bounds = strut_bounds_none();
  for (size_t f = first_of_trails(run); f < run->motion->frames; f++) {
    const double *q = run->motion->position + 2 * f * run->motion->node_count;
    strut_bounds_add(bounds, run->model, q);
  }
  return true;
}

/* Height of the drawing: the shape's own, within limits. */
static double drawing_height(strut_run_scene *run) {
  strut_bounds b;
  double width = run->figure->width - 2 * EDGE - SCALE;
  bounds_of(run, &b);
  double aspect = (b.high[1] - b.low[1]) / (b.high[0] - b.low[0]);
  double wanted = (width - 2 * MARGIN) * (aspect >= 0 && aspect < 10 ? aspect : 1) + 2 * MARGIN;
  return fmax(0.22 * width, fmin(wanted, 0.62 * width));
}

/* The panels below: two, beside each other where there is room. */
static int panels_of(const strut_run_scene *run, int panels[2]) {
  static const int order[] = {STRUT_RUN_WAY, STRUT_RUN_NORMALS, STRUT_RUN_FORCES,
                              STRUT_RUN_HEIGHTS};
  int count = 0;
  for (size_t i = 0; i < sizeof order / sizeof *order && count < 2; i++)
    if (strut_run_panel_wanted(run, order[i])) panels[count++] = order[i];
  return count;
}

static bool beside(const strut_run_scene *run) { return run->figure->width >= 380; }

double strut_run_overview_height(strut_run_scene *run) {
  int panels[2], count = panels_of(run, panels);
  if (run->motion->frames < 2) count = 0;
  return 2 * EDGE + TITLE + drawing_height(run) + CHART * (beside(run) ? count > 0 : count);
}

strut_status strut_run_overview(strut_run_scene *run, strut_canvas *canvas) {
  const strut_trajectory *m = run->motion;
  double width = run->figure->width - 2 * EDGE, height = drawing_height(run);
  char what[100];
  snprintf(what, sizeof what, "at %s", strut_drawn_quantity(m->time[m->frames - 1], 5, "s").text);
  double used = strut_run_draw_title(run, canvas, (strut_box){EDGE, EDGE, width, TITLE}, what);
  if (used < TITLE) used = TITLE;
  strut_box box = {EDGE, EDGE + used, width - SCALE, height};
  strut_bounds bounds;
  bounds_of(run, &bounds);
  strut_window window = strut_window_fit(box, bounds, MARGIN);
  strut_run_expect_frame(run, m->frames - 1);
  if (!strut_run_draw_frame(run, canvas, &window, m->frames - 1, true)) return STRUT_NO_MEMORY;
  if (!strut_run_draw_trails(run, canvas, &window, first_of_trails(run), m->frames - 1))
    return STRUT_NO_MEMORY;
  strut_draw_yardstick(canvas, &window);
  strut_run_draw_scale(run, canvas,
                       (strut_box){EDGE + width - SCALE + 6, box.y + 4, SCALE - 6,
                                   fmin(height - 8, 130)});
  int panels[2], count = m->frames > 1 ? panels_of(run, panels) : 0;
  strut_box chart = {EDGE, box.y + height, beside(run) && count > 1 ? 0.5 * width : width, CHART};
  for (int i = 0; i < count; i++) {
    strut_status status = strut_run_draw_panel(run, canvas, chart, panels[i], first_of_curves(run));
    if (status != STRUT_OK) return status;
    if (beside(run)) {
      chart.x += chart.width;
    } else {
      chart.y += CHART;
    }
  }
  return STRUT_OK;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The nodes' ways over the last period, exaggerated, as in the paper's figure 9. */
#include <math.h>
#include <stdio.h>

#include "engine/output/draw/palette.h"
#include "engine/output/figures/run_parts.h"

static const double EDGE = 5, TITLE = 38, KEY = 34, MARGIN = 26;

/* The last period, or all there is where nothing is periodic. */
static size_t first_frame(const strut_run_scene *run) {
  const strut_trajectory *m = run->motion;
  double all = m->time[m->frames - 1] - m->time[0];
  return strut_run_since(run, run->period > 0 ? fmin(run->period, all) : all);
}

static double factor(const strut_run_scene *run, int axis) {
  return run->figure->scale[axis] > 0 ? run->figure->scale[axis] : 1;
}

/* Where a node's motion is drawn from: its mean place along x and, where there is a ground, the
   lowest along y, so that what touches the ground is drawn touching it. */
static void anchor(const strut_run_scene *run, size_t node, size_t first, double at[2]) {
  const strut_trajectory *m = run->motion;
  double count = (double)(m->frames - first), lowest = HUGE_VAL;
  at[0] = at[1] = 0;
  for (size_t f = first; f < m->frames; f++) {
    const double *p = m->position + 2 * (f * m->node_count + node);
    at[0] += p[0] / count;
    at[1] += p[1] / count;
    lowest = fmin(lowest, p[1]);
  }
  if (run->model->scene->ground.present) at[1] = lowest;
}

typedef struct ways {
  size_t first, count;
  double *rest;      /* (length) the shape that motions start from */
  double (*way)[2];  /* (nodes, count) as drawn */
  strut_bounds bounds;
} ways;

static bool find_ways(strut_run_scene *run, ways *w) {
  const strut_trajectory *m = run->motion;
  w->first = first_frame(run);
  w->count = m->frames - w->first;
  w->rest = strut_arena_allocate(&run->arena, (size_t)run->model->length, sizeof *w->rest);
  w->way = strut_arena_allocate(&run->arena, m->node_count * w->count, sizeof *w->way);
  w->bounds = strut_bounds_none();
  if (!w->rest || !w->way) return false;
  for (size_t i = 0; i < m->node_count; i++) {
    anchor(run, i, w->first, w->rest + 2 * i);
    for (size_t f = 0; f < w->count; f++)
      for (int d = 0; d < 2; d++) {
        double moved = m->position[2 * ((w->first + f) * m->node_count + i) + (size_t)d] -
                       w->rest[2 * i + (size_t)d];
        double drawn = w->rest[2 * i + (size_t)d] + factor(run, d) * moved;
        w->way[i * w->count + f][d] = drawn;
        if (!isfinite(drawn)) continue;
        w->bounds.low[d] = fmin(w->bounds.low[d], drawn);
        w->bounds.high[d] = fmax(w->bounds.high[d], drawn);
      }
  }
  strut_bounds_add(&w->bounds, run->model, w->rest);
  return true;
}

double strut_run_period_height(strut_run_scene *run) {
  ways w;
  double width = run->figure->width - 2 * EDGE;
  if (!find_ways(run, &w)) return width;
  double aspect = (w.bounds.high[1] - w.bounds.low[1]) / (w.bounds.high[0] - w.bounds.low[0]);
  double wanted = (width - 2 * MARGIN) * (aspect >= 0 && aspect < 10 ? aspect : 1) + 2 * MARGIN;
  return 2 * EDGE + TITLE + KEY + fmax(0.2 * width, fmin(wanted, 0.75 * width));
}

static void describe(const strut_run_scene *run, const ways *w, char *text, size_t size) {
  const double *time = run->motion->time;
  double span = time[run->motion->frames - 1] - time[w->first];
  int used = snprintf(text, size, "ways of the nodes over %s%s, dark to bright",
                      run->period > 0 ? "one period, " : "",
                      strut_drawn_quantity(span, 4, "s").text);
  if (factor(run, 0) == 1 && factor(run, 1) == 1) return;
  snprintf(text + used, size - (size_t)used, "; motion %g times along x, %g times along y",
           factor(run, 0), factor(run, 1));
}

strut_status strut_run_period(strut_run_scene *run, strut_canvas *canvas) {
  ways w;
  char text[240];
  double width = run->figure->width - 2 * EDGE, page = strut_canvas_box(canvas).height;
  if (!find_ways(run, &w)) return STRUT_NO_MEMORY;
  describe(run, &w, text, sizeof text);
  double used = strut_run_draw_title(run, canvas, (strut_box){EDGE, EDGE, width, TITLE}, text);
  strut_box box = {EDGE, EDGE + used, width, page - 2 * EDGE - used - KEY};
  strut_window window = strut_window_fit(box, w.bounds, MARGIN);
  const strut_structure_style pale = {.colouring = STRUT_COLOUR_ONE,
                                      .colour = strut_grey(0.75),
                                      .thinness = 0.6,
                                      .node_names = true,
                                      .no_nodes = true};
  strut_draw_ground(canvas, &window, run->model);
  strut_draw_structure(canvas, &window, run->model, w.rest, &pale);
  for (size_t i = 0; i < run->motion->node_count; i++)
    strut_draw_trail(canvas, &window, (const double(*)[2])(w.way + i * w.count), w.count, 1.5);
  strut_draw_yardstick(canvas, &window);
  const strut_colour_scale scale = {
      .name = run->period > 0 ? "part of the period" : "time", .unit = run->period > 0 ? "" : "s",
      .low = 0,
      .high = run->period > 0 ? 1
                              : run->motion->time[run->motion->frames - 1] -
                                    run->motion->time[w.first],
      .sequence = true};
  double wide = fmin(170, 0.5 * width);
  if (scale.high > 0)
    strut_draw_colour_scale(canvas, (strut_box){EDGE + width - wide, page - EDGE - KEY, wide, KEY},
                            &scale);
  return STRUT_OK;
}

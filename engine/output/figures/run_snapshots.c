/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shapes at several instants at one scale, as in the paper's figure 11. */
#include <math.h>
#include <stdio.h>

#include "engine/output/draw/palette.h"
#include "engine/output/figures/run_parts.h"

enum { USUAL = 6 };

static const double EDGE = 5, TITLE = 26, LINE = 12, MARGIN = 12, NARROW = 150, SCALE = 34;

/* How the panels stand. */
typedef struct grid {
  size_t count, columns, rows;
  double size[2];   /* largest width and height of a shape [m] */
  double low;       /* lowest point of all shapes [m] */
  double cell[2];   /* [pt] */
} grid;

static size_t frame_of(const strut_run_scene *run, size_t i, size_t count) {
  const strut_trajectory *m = run->motion;
  if (!run->figure->time_count) return count > 1 ? i * (m->frames - 1) / (count - 1) : 0;
  double time = run->figure->times[i];
  size_t best = 0;
  for (size_t f = 1; f < m->frames; f++)
    if (fabs(m->time[f] - time) < fabs(m->time[best] - time)) best = f;
  return best;
}

static void bounds_of_frame(const strut_run_scene *run, size_t frame, strut_bounds *b) {
  *b = strut_bounds_none();
  strut_bounds_add(b, run->model, run->motion->position + 2 * frame * run->motion->node_count);
}

static grid lay_out(const strut_run_scene *run) {
  const strut_run_figure *figure = run->figure;
  grid g = {.count = figure->time_count, .low = HUGE_VAL};
  if (!g.count) g.count = run->motion->frames < USUAL ? run->motion->frames : USUAL;
  double highest = -HUGE_VAL;
  for (size_t i = 0; i < g.count; i++) {
    strut_bounds b;
    bounds_of_frame(run, frame_of(run, i, g.count), &b);
    g.size[0] = fmax(g.size[0], b.high[0] - b.low[0]);
    g.low = fmin(g.low, b.low[1]);
    highest = fmax(highest, b.high[1]);
  }
  if (run->model->scene->ground.present && run->model->scene->ground.slope == 0)
    g.low = fmin(g.low, run->model->scene->ground.height);
  g.size[1] = highest - g.low;
  double width = figure->width - 2 * EDGE;
  g.columns = (size_t)fmax(1, floor(width / NARROW));
  if (g.columns > 3) g.columns = 3;
  if (g.columns > g.count) g.columns = g.count;
  g.rows = (g.count + g.columns - 1) / g.columns;
  g.cell[0] = width / (double)g.columns;
  double aspect = g.size[0] > 0 ? g.size[1] / g.size[0] : 1;
  double wanted = (g.cell[0] - 2 * MARGIN) * aspect + 2 * MARGIN + 8;
  g.cell[1] = LINE + fmax(40, fmin(wanted, 1.4 * g.cell[0]));
  return g;
}

double strut_run_snapshots_height(strut_run_scene *run) {
  grid g = lay_out(run);
  return 2 * EDGE + TITLE + (double)g.rows * g.cell[1] + SCALE;
}

/* One shape: centred on itself, so that its place is told in words. */
static bool draw_one(strut_run_scene *run, strut_canvas *canvas, const grid *g, size_t i,
                     strut_box cell) {
  size_t frame = frame_of(run, i, g->count);
  strut_bounds b;
  char text[200];
  bounds_of_frame(run, frame, &b);
  double middle = 0.5 * (b.low[0] + b.high[0]);
  const strut_bounds window_bounds = {{middle - 0.5 * g->size[0], g->low},
                                      {middle + 0.5 * g->size[0], g->low + g->size[1]}};
  strut_box box = {cell.x, cell.y + LINE, cell.width, cell.height - LINE};
  strut_window window = strut_window_fit(box, window_bounds, MARGIN);
  double way = strut_run_measured(run, frame) - strut_run_measured(run, 0);
  snprintf(text, sizeof text, "%c) t = %s, way %s", (char)('a' + (int)(i % 26)),
           strut_drawn_quantity(run->motion->time[frame], 5, "s").text,
           strut_drawn_quantity(fabs(way) < 1e-9 * run->model->size ? 0 : way, 3, "m").text);
  strut_draw_text(canvas, cell.x + 4, cell.y, text, (strut_font){.size = 8});
  strut_canvas_clip(canvas, cell);
  bool good = strut_run_draw_frame(run, canvas, &window, frame, g->cell[0] > 120);
  strut_canvas_unclip(canvas);
  if (i == 0) { /* at the foot of the page, where no structure is */
    window.box.y = strut_canvas_box(canvas).height - EDGE - window.box.height;
    strut_draw_yardstick(canvas, &window);
  }
  return good;
}

strut_status strut_run_snapshots(strut_run_scene *run, strut_canvas *canvas) {
  grid g = lay_out(run);
  double width = run->figure->width - 2 * EDGE;
  char what[80];
  snprintf(what, sizeof what, "%zu instants at one scale", g.count);
  strut_run_draw_title(run, canvas, (strut_box){EDGE, EDGE, width, TITLE}, what);
  for (size_t i = 0; i < g.count; i++) strut_run_expect_frame(run, frame_of(run, i, g.count));
  for (size_t i = 0; i < g.count; i++) {
    strut_box cell = {EDGE + (double)(i % g.columns) * g.cell[0],
                      EDGE + TITLE + (double)(i / g.columns) * g.cell[1], g.cell[0], g.cell[1]};
    if (!draw_one(run, canvas, &g, i, cell)) return STRUT_NO_MEMORY;
  }
  double wide = fmin(170, 0.6 * width);
  strut_run_draw_scale(run, canvas,
                       (strut_box){EDGE + width - wide,
                                   EDGE + TITLE + (double)g.rows * g.cell[1] + 2, wide, SCALE - 2});
  return STRUT_OK;
}

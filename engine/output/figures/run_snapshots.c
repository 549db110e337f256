/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shapes at several instants at one scale, as in the paper's figure 11. */
#include <math.h>
#include <stdio.h>

#include "engine/output/draw/palette.h"
#include "engine/output/figures/run_parts.h"

enum { USUAL = 6, MOST_NAMED = 10 };

static const double LINE = 12, MARGIN = 15, ARROW = 18, GAP = 4, FOOT = 28; /* [pt] */
static const double NARROWEST = 105, NAMED = 130; /* cells, and those with names [pt] */
static const double TALLEST = 0.95;               /* all cells together, of the page's width */
static const double LEAST = 12, WIDE = 380, KEY_LINE = 12; /* [pt] */
static const double COMMON = 2.2; /* shapes no further apart share a window, in their sizes */

static const double RAISED =
    1.5; /* so many times the largest shape a cell may grow for the ground */
static const double SEEN = 2e-3; /* of the drawing: the measured point moves so much at least */

/* How the cells stand, and what they show. */
typedef struct grid {
  size_t count, columns, rows;
  bool moves;     /* the measured point, to be seen */
  bool common[2]; /* all show the same part of the plane along that axis */
  strut_bounds all;
  double base;    /* lowest point of all shapes above the ground below their middle [m] */
  double size[2]; /* of that part, or of the largest shape [m] */
  double cell[2]; /* [pt] */
} grid;

/* The usual instants are spread evenly over the record; where many periods lie between them, each
   is a little further in its period than the one before, or all would look alike. */
static double usual_time(const strut_run_scene *run, size_t i, size_t count) {
  double all = strut_run_time_from(run, 0), between = count > 1 ? all / (double)(count - 1) : 0;
  if (run->period > 0 && between > 1.2 * run->period) {
    double part = 1.0 / (double)(count - 1);
    between = (floor(between / run->period - part) + part) * run->period;
  }
  return run->motion->time[run->frames - 1] - between * (double)(count - 1 - i);
}

static size_t frame_of(const strut_run_scene *run, size_t i, size_t count) {
  const strut_trajectory *m = run->motion;
  double time = run->figure->time_count ? run->figure->times[i] : usual_time(run, i, count);
  size_t best = 0;
  for (size_t f = 1; f < run->frames; f++)
    if (fabs(m->time[f] - time) < fabs(m->time[best] - time)) best = f;
  return best;
}

/* The frame of the other motion nearest to one of this. */
static size_t beside(const strut_run_scene *run, const strut_run_scene *other, size_t frame) {
  double time = run->motion->time[frame];
  size_t best = 0;
  for (size_t f = 1; f < other->frames; f++)
    if (fabs(other->motion->time[f] - time) < fabs(other->motion->time[best] - time)) best = f;
  return best;
}

/* Instants to draw: those asked for that the run came to. */
static size_t count_of(const strut_run_scene *run) {
  const strut_run_figure *figure = run->figure;
  if (!figure->time_count) return run->frames < USUAL ? run->frames : USUAL;
  if (!run->summary || run->summary->status == STRUT_OK) return figure->time_count;
  size_t last = run->frames - 1, count = 0;
  const double *time = run->motion->time;
  double end = time[last] + (last > 0 ? time[last] - time[last - 1] : STRUT_RUN_MOMENT);
  while (count < figure->time_count && figure->times[count] <= end) count++;
  return count > 0 ? count : 1;
}

/* Bounds of all that a cell shows: both motions, and the ground where it is near. */
static strut_bounds cell_bounds(const strut_run_scene *run, const grid *g, size_t i) {
  strut_run_scene other;
  size_t frame = frame_of(run, i, g->count);
  strut_bounds b = strut_run_frame_bounds(run, frame);
  if (strut_run_find_other(run, &other))
    strut_bounds_add(&b, run->model, strut_run_positions(&other, beside(run, &other, frame)));
  strut_run_add_ground(run, &b);
  return b;
}

/* Height of the ground below the middle of bounds. */
static double ground_below(const strut_run_scene *run, const strut_bounds *b) {
  return strut_run_ground_at(run, 0.5 * (b->low[0] + b->high[0]));
}

/* Where cells do not show the same height range: room for shapes on the ground drawn at one height. */
static void stand_on_ground(const strut_run_scene *run, grid *g) {
  g->base = HUGE_VAL;
  for (size_t i = 0; i < g->count; i++) {
    strut_bounds b = cell_bounds(run, g, i);
    g->base = fmin(g->base, b.low[1] - ground_below(run, &b));
  }
  double shape = g->size[1];
  for (size_t i = 0; i < g->count; i++) {
    strut_bounds b = cell_bounds(run, g, i);
    double reach = b.high[1] - ground_below(run, &b) - g->base;
    if (reach < RAISED * shape) g->size[1] = fmax(g->size[1], reach);
  }
}

static void find_sizes(const strut_run_scene *run, grid *g) {
  double shape[2] = {0, 0};
  g->all = strut_bounds_none();
  for (size_t i = 0; i < g->count; i++) {
    strut_bounds b = cell_bounds(run, g, i);
    for (int d = 0; d < 2; d++) {
      shape[d] = fmax(shape[d], b.high[d] - b.low[d]);
      g->all.low[d] = fmin(g->all.low[d], b.low[d]);
      g->all.high[d] = fmax(g->all.high[d], b.high[d]);
    }
  }
  size_t first = frame_of(run, 0, g->count);
  for (size_t i = 0; i < g->count; i++) {
    size_t frame = frame_of(run, i, g->count);
    double way = strut_run_measured(run, frame, 0) - strut_run_measured(run, first, 0);
    g->moves = g->moves || fabs(way) > SEEN * strut_run_extent(&g->all);
  }
  const strut_ground *ground = &run->model->scene->ground;
  double most = COMMON * fmax(shape[0], shape[1]);
  for (int d = 0; d < 2; d++) {
    double together = g->all.high[d] - g->all.low[d];
    g->common[d] = together <= fmax(COMMON * shape[d], 0.5 * most);
    if (d == 1 && ground->present && ground->slope != 0 && !g->common[0]) g->common[1] = false;
    g->size[d] = g->common[d] ? together : shape[d];
  }
  if (ground->present && !g->common[1]) stand_on_ground(run, g);
}

/* What is left free below the shapes, for arrows [pt]. */
static double below(const strut_run_scene *run) {
  return (run->model->contacts.count ? fmax(ARROW, MARGIN) + 3 : MARGIN) + GAP;
}

/* As many columns as make the shapes largest on a page that is not too tall. */
static grid lay_out(const strut_run_scene *run) {
  grid g = {.count = count_of(run)};
  double width = run->figure->width - 2 * STRUT_RUN_EDGE, best = 0;
  find_sizes(run, &g);
  for (size_t columns = 1; columns <= g.count; columns++) {
    size_t rows = (g.count + columns - 1) / columns;
    double cell = width / (double)columns;
    if (cell < NARROWEST && columns > 1) break;
    double other = LINE + MARGIN + below(run);
    double tallest = fmax(TALLEST * width / (double)rows, other + LEAST);
    double scale = fmin((cell - 2 * MARGIN) / g.size[0], (tallest - other) / g.size[1]);
    if (!(scale > best * (1 + 1e-9))) continue;
    best = scale;
    g.columns = columns;
    g.rows = rows;
    g.cell[0] = cell;
    g.cell[1] = scale * g.size[1] + other;
  }
  return g;
}

static double foot_height(const strut_run_scene *run) {
  bool narrow = run->figure->width < WIDE && run->model->contacts.count;
  return narrow ? FOOT + KEY_LINE : FOOT;
}

double strut_run_snapshots_height(strut_run_scene *run) {
  grid g = lay_out(run);
  return 2 * STRUT_RUN_EDGE + STRUT_RUN_TITLE + (double)g.rows * g.cell[1] + foot_height(run);
}

static strut_window window_of(const strut_run_scene *run, const grid *g, size_t i, strut_box cell) {
  strut_bounds b = cell_bounds(run, g, i);
  double low = run->model->scene->ground.present ? ground_below(run, &b) + g->base : b.low[1];
  bool grounded = run->model->scene->ground.present && !g->common[1] &&
                  b.high[1] <= low + g->size[1] * (1 + 1e-9);
  for (int d = 0; d < 2; d++) {
    double middle = 0.5 * (b.low[d] + b.high[d]);
    b.low[d] = g->common[d] ? g->all.low[d] : middle - 0.5 * g->size[d];
    b.high[d] = g->common[d] ? g->all.high[d] : middle + 0.5 * g->size[d];
  }
  if (grounded) b.low[1] = low, b.high[1] = low + g->size[1];
  /* What is below the shapes for arrows is no part of the window. */
  strut_box box = {cell.x, cell.y + LINE, cell.width, cell.height - LINE - below(run) + MARGIN};
  return strut_window_fit(box, b, MARGIN);
}

/* Where the measured point was in the first of them, so that the way it went is seen. */
static void mark_start(const strut_run_scene *run, strut_canvas *canvas, const grid *g,
                       const strut_window *window) {
  size_t first = frame_of(run, 0, g->count);
  const double start[2] = {strut_run_measured(run, first, 0), g->all.low[1]};
  double at[2];
  strut_window_point(window, start, at);
  if (g->common[0] && g->moves)
    strut_draw_segment(canvas, at[0], window->box.y + 2, at[0], at[1],
                       (strut_pen){.colour = strut_grey(0.6), .width = 0.6, .dash = {2, 2}});
}

/* As many digits as tell the instants apart, and one more. */
static int digits_of(const strut_run_scene *run, const grid *g) {
  double least = HUGE_VAL, latest = 0;
  for (size_t i = 0; i < g->count; i++) {
    double time = run->motion->time[frame_of(run, i, g->count)];
    double before = i ? run->motion->time[frame_of(run, i - 1, g->count)] : -HUGE_VAL;
    latest = fmax(latest, fabs(time));
    if (fabs(time - before) > STRUT_RUN_MOMENT) least = fmin(least, fabs(time - before));
  }
  double digits = isfinite(least) && latest > 0 ? ceil(log10(latest / least)) + 2 : 4;
  return (int)fmax(3, fmin(digits, 9));
}

static bool draw_one(strut_run_scene *run, strut_canvas *canvas, const grid *g, size_t i,
                     strut_box cell) {
  size_t frame = frame_of(run, i, g->count), first = frame_of(run, 0, g->count);
  strut_window window = window_of(run, g, i, cell);
  double *q = strut_run_shape(run, frame);
  double way = strut_run_measured(run, frame, 0) - strut_run_measured(run, first, 0);
  char text[200], fitted[STRUT_FITTED_TEXT];
  const strut_font font = {.size = 8};
  int used = snprintf(text, sizeof text, "%s",
                      strut_drawn_quantity(run->motion->time[frame], digits_of(run, g), "s").text);
  if (i > 0 && fabs(way) > 1e-6 * run->model->size)
    snprintf(text + used, sizeof text - (size_t)used, ", x %s%s", way > 0 ? "+" : "",
             strut_drawn_quantity(way, 3, "m").text);
  strut_draw_text(canvas, cell.x + 4, cell.y,
                  strut_text_fit(canvas, text, font, cell.width - 6, 0, fitted), font);
  strut_canvas_clip(canvas, (strut_box){cell.x, cell.y + LINE, cell.width, cell.height - LINE});
  mark_start(run, canvas, g, &window);
  bool good = q && strut_run_draw_frame(run, canvas, &window, frame);
  strut_run_draw_reactions(run, canvas, &window, frame);
  strut_run_scene other;
  if (strut_run_find_other(run, &other))
    strut_run_draw_other(&other, canvas, &window, beside(run, &other, frame));
  if (good && run->model->node_count <= MOST_NAMED && cell.width > NAMED)
    strut_run_draw_names(run, canvas, &window, q);
  strut_canvas_unclip(canvas);
  run->avoid_count = 0;
  return good;
}

static void draw_foot(strut_run_scene *run, strut_canvas *canvas, const grid *g, strut_box foot) {
  strut_window window = window_of(run, g, 0, (strut_box){foot.x, 0, g->cell[0], g->cell[1]});
  char text[120];
  strut_key_item item;
  window.box.y = foot.y + foot.height - window.box.height;
  strut_draw_yardstick(canvas, &window);
  double scale = fmin(130, 0.45 * foot.width), left = 0.32 * g->cell[0] + 8;
  strut_box key = {foot.x, foot.y, foot.width, KEY_LINE}; /* a line of its own, or between both */
  if (foot.height > FOOT) {
    foot.y += KEY_LINE;
    foot.height -= KEY_LINE;
  } else {
    key.x += left;
    key.y += 0.5 * foot.height - 4;
    key.width -= left + scale;
  }
  if (strut_run_arrow_item(run, text, &item)) strut_draw_key(canvas, key, &item, 1);
  strut_run_draw_scale(run, canvas,
                       (strut_box){foot.x + foot.width - scale, foot.y, scale, foot.height});
}

strut_status strut_run_snapshots(strut_run_scene *run, strut_canvas *canvas) {
  grid g = lay_out(run);
  char what[200];
  bool marked = g.common[0] && g.moves;
  double top = STRUT_RUN_EDGE + STRUT_RUN_TITLE;
  snprintf(what, sizeof what, "%zu snapshot%s to the same scale%s%s", g.count,
           g.count == 1 ? "" : "s",
           marked        ? "; dashed: initial position of "
           : g.common[0] ? ""
                         : "; each centred",
           marked ? strut_run_measured_name(run) : "");
  strut_run_describe_other(run, what, sizeof what);
  strut_run_draw_title(run, canvas, what, false);
  run->arrow = ARROW;
  for (size_t i = 0; i < g.count; i++) strut_run_expect_frame(run, frame_of(run, i, g.count));
  for (size_t i = 0; i < g.count; i++) {
    strut_box cell = {STRUT_RUN_EDGE + (double)(i % g.columns) * g.cell[0],
                      top + (double)(i / g.columns) * g.cell[1], g.cell[0], g.cell[1]};
    if (!draw_one(run, canvas, &g, i, cell)) return STRUT_NO_MEMORY;
  }
  draw_foot(run, canvas, &g,
            (strut_box){STRUT_RUN_EDGE, top + (double)g.rows * g.cell[1],
                        run->figure->width - 2 * STRUT_RUN_EDGE, foot_height(run)});
  return STRUT_OK;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <math.h>
#include <stdio.h>

#include "engine/base/c_locale.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/figures/run_parts.h"

/* Node trajectories over the last period, enlarged, as in the paper's figure 9; and snapshots to
   one scale, as in its figure 11. */

static const double KEY = 30, NOTE = 28, WIDE = 380, PERIOD_MARGIN = 20; /* [pt] */
static const double CLOSED = 1e-3; /* of the model's size: less above the ground is on it */

typedef struct node_paths {
  size_t first, count;
  double *rest;      /* (length) centres of enlargement [m] */
  double *shape;     /* (length) drawn beneath: the centres, or the last shape */
  double (*path)[2]; /* (nodes, count) as drawn */
  bool grounded;     /* some paths are enlarged from the ground */
  strut_bounds bounds;
} node_paths;

/* The last period, or the whole record where nothing is periodic. */
static size_t first_frame(const strut_run_scene *run) {
  double all = strut_run_time_from(run, 0);
  return strut_run_since(run, run->period > 0 ? fmin(run->period, all) : all);
}

static double enlargement(const strut_run_scene *run, int axis) {
  return run->figure->scale[axis] > 0 ? run->figure->scale[axis] : 1;
}

static bool is_enlarged(const strut_run_scene *run) {
  return enlargement(run, 0) != 1 || enlargement(run, 1) != 1;
}

static bool can_touch(const strut_run_scene *run, size_t node) {
  for (int32_t i = 0; i < run->model->contacts.count; i++)
    if ((size_t)run->model->contacts.entry[i].node == node) return true;
  return false;
}

/* The centre of a node's enlargement: its mean position or, of a node that touches the ground,
   the point of the ground below, so that contact is drawn as contact. */
static void find_anchor(const strut_run_scene *run, size_t node, node_paths *w) {
  double *at = w->rest + 2 * node, lowest = HUGE_VAL;
  at[0] = at[1] = 0;
  for (size_t f = w->first; f < run->frames; f++) {
    const double *p = strut_run_positions(run, f) + 2 * node;
    for (int d = 0; d < 2; d++) at[d] += p[d] / (double)w->count;
    if (run->model->scene->ground.present)
      lowest = fmin(lowest, p[1] - strut_run_ground_at(run, p[0]));
  }
  if (!(lowest < CLOSED * run->model->size) || !can_touch(run, node)) return;
  at[1] = strut_run_ground_at(run, at[0]);
  w->grounded = true;
}

static bool find_paths(strut_run_scene *run, node_paths *w) {
  size_t nodes = run->motion->node_count;
  *w = (node_paths){.first = first_frame(run)};
  w->count = run->frames - w->first;
  w->rest = strut_arena_allocate(&run->arena, (size_t)run->model->length, sizeof *w->rest);
  w->path = strut_arena_allocate(&run->arena, nodes * w->count, sizeof *w->path);
  if (!w->rest || !w->path) return false;
  w->bounds = strut_run_frame_bounds(run, run->frames - 1);
  for (size_t i = 0; i < nodes; i++) {
    find_anchor(run, i, w);
    for (size_t f = 0; f < w->count; f++)
      for (int d = 0; d < 2; d++) {
        double rest = w->rest[2 * i + (size_t)d];
        double moved = strut_run_positions(run, w->first + f)[2 * i + (size_t)d] - rest;
        double drawn = rest + enlargement(run, d) * moved;
        w->path[i * w->count + f][d] = drawn;
        w->bounds.low[d] = fmin(w->bounds.low[d], drawn);
        w->bounds.high[d] = fmax(w->bounds.high[d], drawn);
      }
  }
  strut_run_add_ground(run, &w->bounds);
  /* Mean positions are no shape of a large motion: only enlarged paths are drawn over them. */
  w->shape = is_enlarged(run) ? w->rest : strut_run_shape(run, run->frames - 1);
  return w->shape;
}

/* Height below the drawing: in a narrow one the note has its own lines. */
static double period_foot_height(const strut_run_scene *run) {
  return run->figure->width < WIDE && is_enlarged(run) ? KEY + NOTE : KEY;
}

/* Moves the paths of the second motion to the centres of the first. */
static void add_other(const node_paths *w, node_paths *o, size_t nodes) {
  for (size_t i = 0; i < nodes; i++)
    for (size_t f = 0; f < o->count; f++)
      for (int d = 0; d < 2; d++)
        o->path[i * o->count + f][d] += w->rest[2 * i + (size_t)d] - o->rest[2 * i + (size_t)d];
}

/* False: memory is out. */
static bool draw_other_paths(const strut_run_scene *run, strut_canvas *canvas, const node_paths *w,
                             const strut_window *window) {
  strut_run_scene other;
  node_paths o;
  if (!strut_run_find_other(run, &other)) return true;
  bool fine = find_paths(&other, &o);
  if (fine) add_other(w, &o, run->motion->node_count);
  for (size_t i = 0; i < run->motion->node_count && fine; i++)
    fine = strut_run_draw_other_path(&other, canvas, window,
                                     (const double(*)[2])(o.path + i * o.count), o.count);
  strut_arena_free(&other.arena);
  return fine;
}

double strut_run_period_height(strut_run_scene *run) {
  node_paths w;
  double width = run->figure->width - 2 * STRUT_RUN_EDGE;
  if (!find_paths(run, &w)) return width;
  return 2 * STRUT_RUN_EDGE + run->head + period_foot_height(run) +
         strut_run_drawing_height(&w.bounds, width, PERIOD_MARGIN, 0.16, 0.75);
}

void strut_run_period_describe(strut_run_scene *run, char *text) {
  strut_c_locale locale = strut_c_locale_enter();
  /* The period itself: the frames drawn of it span a whole number of samples. */
  double span = run->period > 0 ? run->period : strut_run_time_from(run, first_frame(run));
  snprintf(text, STRUT_RUN_NOTE, "%s%s%s%s, dark to bright",
           run->figure->width < WIDE ? "" : "node trajectories over ",
           run->period > 0 ? "one period (" : "", strut_drawn_quantity(span, 4, "s").text,
           run->period > 0 ? ")" : "");
  strut_c_locale_leave(locale);
  strut_run_describe_other(run, text, STRUT_RUN_NOTE);
}

/* A note on the enlargement, between scale bar and colour bar, or above both. */
static void draw_note(const strut_run_scene *run, strut_canvas *canvas, const node_paths *w,
                      strut_box box) {
  char text[240], fitted[STRUT_FITTED_TEXT];
  bool narrow = run->figure->width < WIDE;
  if (!is_enlarged(run)) return;
  strut_c_locale locale = strut_c_locale_enter();
  snprintf(text, sizeof text,
           "Motion enlarged %g times along x and %g times along y about each node's mean position "
           "(grey)%s.",
           enlargement(run, 0), enlargement(run, 1),
           w->grounded ? " or, where it touches the ground, the point below" : "");
  strut_c_locale_leave(locale);
  double indent = narrow ? 0 : 0.34 * (run->figure->width - 2 * STRUT_RUN_EDGE);
  strut_font note = {.size = 7, .colour = strut_grey(0.3)};
  note.width = narrow ? run->figure->width - 2 * STRUT_RUN_EDGE : box.width - indent;
  note.down = narrow ? 0 : 0.5;
  strut_draw_text(canvas, box.x + indent, narrow ? box.y : box.y + 0.5 * box.height,
                  strut_text_fit(canvas, text, note, note.width, box.height, fitted), note);
}

static void draw_time_scale(const strut_run_scene *run, strut_canvas *canvas, const node_paths *w,
                            strut_box box) {
  bool parts = run->period > 0;
  const strut_colour_scale scale = {.name = parts ? "phase" : "time",
                                    .unit = parts ? "" : "s",
                                    .high = parts ? 1 : strut_run_time_from(run, w->first),
                                    .colours = STRUT_COLOURS_SEQUENTIAL};
  if (scale.high > 0) strut_draw_colour_scale(canvas, box, &scale);
}

strut_status strut_run_period(strut_run_scene *run, strut_canvas *canvas) {
  node_paths w;
  double width = run->figure->width - 2 * STRUT_RUN_EDGE, page = strut_canvas_box(canvas).height;
  double foot = page - STRUT_RUN_EDGE - KEY, scale_width = fmin(150, 0.45 * width);
  double end = page - STRUT_RUN_EDGE - period_foot_height(run);
  if (!find_paths(run, &w)) return STRUT_NO_MEMORY;
  strut_box box = {STRUT_RUN_EDGE, STRUT_RUN_EDGE + run->head, width,
                   end - STRUT_RUN_EDGE - run->head};
  strut_window window = strut_window_fit(box, w.bounds, PERIOD_MARGIN);
  const strut_structure_style pale = {
      .colouring = STRUT_COLOUR_ONE, .colour = strut_grey(0.72), .thinness = 0.5};
  strut_draw_ground(canvas, &window, run->model);
  strut_draw_structure(canvas, &window, run->model, w.shape, &pale);
  if (!draw_other_paths(run, canvas, &w, &window)) return STRUT_NO_MEMORY;
  for (size_t i = 0; i < run->motion->node_count; i++)
    strut_run_draw_path(canvas, &window, (const double(*)[2])(w.path + i * w.count), w.count,
                        STRUT_RUN_TRAIL);
  strut_run_draw_names(run, canvas, &window, w.shape);
  window.box.y = page - STRUT_RUN_EDGE - box.height; /* at the bottom, below the structure */
  strut_draw_yardstick(canvas, &window);
  double right = STRUT_RUN_EDGE + width - scale_width;
  draw_note(run, canvas, &w, (strut_box){STRUT_RUN_EDGE, end, right - STRUT_RUN_EDGE - 6, KEY});
  draw_time_scale(run, canvas, &w, (strut_box){right, foot, scale_width, KEY});
  return STRUT_OK;
}

/* Snapshots. */

enum { USUAL = 6, MOST_NAMED = 10 };

static const double LINE = 12, MARGIN = 15, ARROW = 18, GAP = 4, FOOT = 28; /* [pt] */
static const double NARROWEST = 105, NAMED = 130; /* cells, and those with names [pt] */
static const double TALLEST = 0.95;               /* all cells together, of the page's width */
static const double LEAST = 12, KEY_LINE = 12;    /* [pt] */
static const double COMMON = 2.2; /* shapes closer than this, in their sizes, share a window */

static const double RAISED =
    1.5; /* most growth of a cell to show the ground, of the largest shape */
static const double SEEN = 2e-3; /* of the drawing: least visible motion of the measured point */

/* Layout and range of the cells. */
typedef struct grid {
  size_t count, columns, rows;
  bool moves;     /* the measured point moves visibly */
  bool common[2]; /* all cells show the same range along that axis */
  strut_bounds all;
  double base;    /* lowest point of all shapes above the ground below their middle [m] */
  double size[2]; /* of that range, or of the largest shape [m] */
  double cell[2]; /* [pt] */
} grid;

/* Default times are spread evenly over the record. If many periods lie between them, the phase
   advances from one to the next; otherwise all snapshots would look alike. */
static double default_time(const strut_run_scene *run, size_t i, size_t count) {
  double all = strut_run_time_from(run, 0), between = count > 1 ? all / (double)(count - 1) : 0;
  if (run->period > 0 && between > 1.2 * run->period) {
    double part = 1.0 / (double)(count - 1);
    between = (floor(between / run->period - part) + part) * run->period;
  }
  return run->motion->time[run->frames - 1] - between * (double)(count - 1 - i);
}

static size_t frame_of_cell(const strut_run_scene *run, size_t i, size_t count) {
  return strut_run_nearest(
      run, run->figure->time_count ? run->figure->times[i] : default_time(run, i, count));
}

/* The number of snapshots: requested ones up to the end of the run. */
static size_t count_cells(const strut_run_scene *run) {
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
  size_t frame = frame_of_cell(run, i, g->count);
  strut_bounds b = strut_run_frame_bounds(run, frame);
  if (strut_run_find_other(run, &other))
    strut_bounds_add(
        &b, run->model,
        strut_run_positions(&other, strut_run_nearest(&other, run->motion->time[frame])));
  strut_run_add_ground(run, &b);
  return b;
}

/* Height of the ground below the middle of bounds. */
static double ground_below(const strut_run_scene *run, const strut_bounds *b) {
  return strut_run_ground_at(run, 0.5 * (b->low[0] + b->high[0]));
}

/* Where cells do not show the same height range: room for shapes on the ground drawn at one
   height. */
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
  size_t first = frame_of_cell(run, 0, g->count);
  for (size_t i = 0; i < g->count; i++) {
    size_t frame = frame_of_cell(run, i, g->count);
    double path = strut_run_measured(run, frame, 0) - strut_run_measured(run, first, 0);
    g->moves = g->moves || fabs(path) > SEEN * strut_run_extent(&g->all);
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

/* Space below the shapes, for arrows [pt]. */
static double space_below(const strut_run_scene *run) {
  return (run->model->contacts.count ? fmax(ARROW, MARGIN) + 3 : MARGIN) + GAP;
}

/* Chooses the number of columns that makes the shapes largest on a page that is not too tall. */
static grid lay_out_grid(const strut_run_scene *run) {
  grid g = {.count = count_cells(run)};
  double width = run->figure->width - 2 * STRUT_RUN_EDGE, best = 0;
  find_sizes(run, &g);
  for (size_t columns = 1; columns <= g.count; columns++) {
    size_t rows = (g.count + columns - 1) / columns;
    double cell = width / (double)columns;
    if (cell < NARROWEST && columns > 1) break;
    double other = LINE + MARGIN + space_below(run);
    double tallest = fmax(TALLEST * width / (double)rows, other + LEAST);
    double scale = fmin((cell - 2 * MARGIN) / g.size[0], (tallest - other) / g.size[1]);
    if (!(scale > best * (1 + 1e-9))) continue;
    best = scale;
    g.columns = columns;
    g.rows = rows;
    g.cell[0] = cell;
    g.cell[1] = scale * g.size[1] + other;
  }
  assert(g.columns > 0 && g.columns * g.rows >= g.count);
  return g;
}

static double snapshots_foot_height(const strut_run_scene *run) {
  bool narrow = run->figure->width < WIDE && run->model->contacts.count;
  return narrow ? FOOT + KEY_LINE : FOOT;
}

void strut_run_snapshots_describe(strut_run_scene *run, char *text) {
  grid g = lay_out_grid(run);
  bool marked = g.common[0] && g.moves;
  snprintf(text, STRUT_RUN_NOTE, "%zu snapshot%s to the same scale%s%.200s", g.count,
           g.count == 1 ? "" : "s",
           marked        ? "; dashed: initial position of "
           : g.common[0] ? ""
                         : "; each centred",
           marked ? strut_run_measured_name(run) : "");
  strut_run_describe_other(run, text, STRUT_RUN_NOTE);
}

double strut_run_snapshots_height(strut_run_scene *run) {
  grid g = lay_out_grid(run);
  return 2 * STRUT_RUN_EDGE + run->head + (double)g.rows * g.cell[1] + snapshots_foot_height(run);
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
  /* The space for arrows is not part of the window. */
  strut_box box = {cell.x, cell.y + LINE, cell.width,
                   cell.height - LINE - space_below(run) + MARGIN};
  return strut_window_fit(box, b, MARGIN);
}

/* Marks the initial position of the measured point, so that its travel is visible. */
static void mark_start(const strut_run_scene *run, strut_canvas *canvas, const grid *g,
                       const strut_window *window) {
  size_t first = frame_of_cell(run, 0, g->count);
  const double start[2] = {strut_run_measured(run, first, 0), g->all.low[1]};
  double at[2];
  strut_window_point(window, start, at);
  if (g->common[0] && g->moves)
    strut_draw_segment(canvas, at[0], window->box.y + 2, at[0], at[1],
                       (strut_pen){.colour = strut_grey(0.6), .width = 0.6, .dash = {2, 2}});
}

/* One digit more than the times need to differ. */
static int count_digits(const strut_run_scene *run, const grid *g) {
  double least = HUGE_VAL, latest = 0;
  for (size_t i = 0; i < g->count; i++) {
    double time = run->motion->time[frame_of_cell(run, i, g->count)];
    double before = i ? run->motion->time[frame_of_cell(run, i - 1, g->count)] : -HUGE_VAL;
    latest = fmax(latest, fabs(time));
    if (fabs(time - before) > STRUT_RUN_MOMENT) least = fmin(least, fabs(time - before));
  }
  double digits = isfinite(least) && latest > 0 ? ceil(log10(latest / least)) + 2 : 4;
  return (int)fmax(3, fmin(digits, 9));
}

/* Draws the second motion, if there is one, at the same time. False: out of memory. */
static bool draw_other_shape(const strut_run_scene *run, strut_canvas *canvas,
                             const strut_window *window, size_t frame) {
  strut_run_scene other;
  if (!strut_run_find_other(run, &other)) return true;
  const double *q = strut_run_shape(&other, strut_run_nearest(&other, run->motion->time[frame]));
  if (q) strut_run_draw_other(&other, canvas, window, q);
  strut_arena_free(&other.arena);
  return q != NULL;
}

static bool draw_cell(strut_run_scene *run, strut_canvas *canvas, const grid *g, size_t i,
                      strut_box cell) {
  size_t frame = frame_of_cell(run, i, g->count), first = frame_of_cell(run, 0, g->count);
  strut_window window = window_of(run, g, i, cell);
  double *q = strut_run_shape(run, frame);
  double path = strut_run_measured(run, frame, 0) - strut_run_measured(run, first, 0);
  char text[200], fitted[STRUT_FITTED_TEXT];
  const strut_font font = {.size = 8};
  int used =
      snprintf(text, sizeof text, "%s",
               strut_drawn_quantity(run->motion->time[frame], count_digits(run, g), "s").text);
  if (i > 0 && fabs(path) > 1e-6 * run->model->size)
    snprintf(text + used, sizeof text - (size_t)used, ", x %s%s", path > 0 ? "+" : "",
             strut_drawn_quantity(path, 3, "m").text);
  strut_draw_text(canvas, cell.x + 4, cell.y,
                  strut_text_fit(canvas, text, font, cell.width - 6, 0, fitted), font);
  strut_canvas_clip(canvas, (strut_box){cell.x, cell.y + LINE, cell.width, cell.height - LINE});
  mark_start(run, canvas, g, &window);
  bool good = q && draw_other_shape(run, canvas, &window, frame) &&
              strut_run_draw_frame(run, canvas, &window, frame);
  strut_run_draw_reactions(run, canvas, &window, frame);
  if (good && run->model->node_count <= MOST_NAMED && cell.width > NAMED)
    strut_run_draw_names(run, canvas, &window, q);
  strut_canvas_unclip(canvas);
  return good;
}

static void draw_foot(strut_run_scene *run, strut_canvas *canvas, const grid *g, strut_box foot) {
  strut_window window = window_of(run, g, 0, (strut_box){foot.x, 0, g->cell[0], g->cell[1]});
  char text[120];
  strut_key_item item;
  window.box.y = foot.y + foot.height - window.box.height;
  strut_draw_yardstick(canvas, &window);
  double scale = fmin(130, 0.45 * foot.width), left = 0.32 * g->cell[0] + 8;
  strut_box key = {foot.x, foot.y, foot.width, KEY_LINE}; /* its own line, or between both bars */
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
  grid g = lay_out_grid(run);
  double top = STRUT_RUN_EDGE + run->head;
  run->arrow = ARROW;
  for (size_t i = 0; i < g.count; i++) strut_run_expect_frame(run, frame_of_cell(run, i, g.count));
  for (size_t i = 0; i < g.count; i++) {
    strut_box cell = {STRUT_RUN_EDGE + (double)(i % g.columns) * g.cell[0],
                      top + (double)(i / g.columns) * g.cell[1], g.cell[0], g.cell[1]};
    if (!draw_cell(run, canvas, &g, i, cell)) return STRUT_NO_MEMORY;
  }
  draw_foot(run, canvas, &g,
            (strut_box){STRUT_RUN_EDGE, top + (double)g.rows * g.cell[1],
                        run->figure->width - 2 * STRUT_RUN_EDGE, snapshots_foot_height(run)});
  return STRUT_OK;
}

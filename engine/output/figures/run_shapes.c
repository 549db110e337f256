/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/output/figures/run_parts.h"

/* Node trajectories over the last period, enlarged, as in the paper's figure 9; and snapshots to
   one scale, as in its figure 11. */

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
static void find_anchor(const strut_run_scene *run, size_t node, node_paths *self) {
  double *at = self->rest + 2 * node, lowest = HUGE_VAL;
  at[0] = at[1] = 0;
  for (size_t f = self->first; f < run->frames; f++) {
    const double *p = strut_run_positions(run, f) + 2 * node;
    for (int d = 0; d < 2; d++) at[d] += p[d] / (double)self->count;
    if (run->model->scene->ground.present)
      lowest = fmin(lowest, p[1] - strut_run_ground_at(run, p[0]));
  }
  if (!(lowest < CLOSED * run->model->size) || !can_touch(run, node)) return;
  at[1] = strut_run_ground_at(run, at[0]);
  self->grounded = true;
}

static bool find_paths(strut_run_scene *run, node_paths *self) {
  size_t nodes = run->motion->node_count;
  *self = (node_paths){.first = first_frame(run)};
  self->count = run->frames - self->first;
  self->rest = strut_arena_allocate(&run->arena, (size_t)run->model->length, sizeof *self->rest);
  self->path = strut_arena_allocate(&run->arena, nodes * self->count, sizeof *self->path);
  if (!self->rest || !self->path) return false;
  self->bounds = strut_run_frame_bounds(run, run->frames - 1);
  for (size_t i = 0; i < nodes; i++) {
    find_anchor(run, i, self);
    for (size_t f = 0; f < self->count; f++) {
      double *at = self->path[i * self->count + f];
      for (int d = 0; d < 2; d++) {
        double rest = self->rest[2 * i + (size_t)d];
        double moved = strut_run_positions(run, self->first + f)[2 * i + (size_t)d] - rest;
        at[d] = rest + enlargement(run, d) * moved;
      }
      strut_bounds_widen(&self->bounds, at, at);
    }
  }
  strut_run_add_ground(run, &self->bounds);
  /* Mean positions are no shape of a large motion: only enlarged paths are drawn over them. */
  self->shape = is_enlarged(run) ? self->rest : strut_run_coordinates(run, run->frames - 1);
  return self->shape;
}

/* The paths of the second motion, about the centres of the first. False: out of memory. */
static bool find_other_paths(strut_run_scene *run, const node_paths *self, node_paths *other_self) {
  strut_run_scene other;
  if (!strut_run_find_other(run, &other)) return true;
  other.arena = run->arena; /* what is drawn stays until the figure is */
  bool good = find_paths(&other, other_self);
  run->arena = other.arena;
  for (size_t i = 0; good && i < run->motion->node_count; i++)
    for (size_t f = 0; f < other_self->count; f++)
      for (size_t d = 0; d < 2; d++)
        other_self->path[i * other_self->count + f][d] +=
            self->rest[2 * i + d] - other_self->rest[2 * i + d];
  return good;
}

static void describe_period(const strut_run_scene *run, const node_paths *self, char *note) {
  /* The period itself: the frames drawn of it span a whole number of samples. */
  double span = run->period > 0 ? run->period : strut_run_time_from(run, self->first);
  strut_c_locale locale = strut_c_locale_enter();
  snprintf(note, STRUT_RUN_NOTE, "node trajectories over %s%s%s, dark to bright",
           run->period > 0 ? "one period (" : "", strut_drawn_quantity(span, 4, "s").text,
           run->period > 0 ? ")" : "");
  strut_run_describe_other(run, note, STRUT_RUN_NOTE);
  size_t used = strlen(note);
  if (is_enlarged(run))
    snprintf(note + used, STRUT_RUN_NOTE - used,
             ", enlarged %g times along x and %g times along y about each node's mean position "
             "(grey)%s",
             enlargement(run, 0), enlargement(run, 1),
             self->grounded ? " or, where it touches the ground, the point below" : "");
  strut_c_locale_leave(locale);
}

bool strut_run_period(strut_run_scene *run, strut_figure *figure, char *note) {
  size_t nodes = run->motion->node_count;
  node_paths paths[2] = {{0}}; /* of the second motion, where there is one, too */
  struct {
    strut_panel panel;
    strut_view view;
    strut_shape shape;
  } *to = strut_arena_allocate(&run->arena, 1, sizeof *to);
  strut_trail *trails = strut_arena_allocate(&run->arena, 2 * nodes, sizeof *trails);
  if (!to || !trails || !find_paths(run, &paths[0])) return false;
  if (!find_other_paths(run, &paths[0], &paths[1])) return false;
  to->shape = (strut_shape){
      .model = run->model,
      .q = paths[0].shape,
      .style = {.colouring = STRUT_COLOUR_ONE, .colour = strut_grey(0.72), .thinness = 0.5},
      .ground = true,
      .names = true};
  to->view = (strut_view){.shape_count = 1,
                          .shapes = &to->shape,
                          .trails = trails,
                          .bounds = paths[0].bounds,
                          .margin = 20};
  for (int k = 1; k >= 0; k--)
    for (size_t i = 0; i < nodes && paths[k].path; i++)
      trails[to->view.trail_count++] =
          (strut_trail){.kind = k ? STRUT_TRAIL_LINE : STRUT_TRAIL_SEQUENCE,
                        .count = paths[k].count,
                        .at = (const double(*)[2])(paths[k].path + i * paths[k].count),
                        .pen = k ? strut_run_other_pen() : (strut_pen){.width = STRUT_RUN_TRAIL}};
  to->panel = (strut_panel){.view = &to->view};
  figure->panels = &to->panel;
  figure->panel_count = 1;
  figure->aspect = 0.75;
  figure->yardstick = true;
  double span = strut_run_time_from(run, paths[0].first);
  figure->scale = (strut_colour_scale){.name = run->period > 0 ? "phase" : "time",
                                       .unit = run->period > 0 ? "" : "s",
                                       .high = run->period > 0 ? 1 : span,
                                       .colours = STRUT_COLOURS_SEQUENTIAL};
  describe_period(run, &paths[0], note);
  return true;
}

/* Snapshots. */

enum { USUAL = 6 };

static const double COMMON = 2.2; /* shapes closer than this, in their sizes, share a window */
static const double SEEN = 2e-3;  /* of the drawing: least visible motion of the measured point */
static const double MARGIN = 15;  /* [pt] */

/* What a cell shows. */
typedef struct snapshot {
  size_t frame;
  strut_bounds bounds;
  strut_view view;
  strut_shape shapes[2]; /* of the second motion, where there is one, first */
  strut_trail start;     /* where the measured point began */
  double line[2][2];
  char title[200];
} snapshot;

/* Range of the cells. */
typedef struct grid {
  size_t count;
  snapshot *cells; /* (count) */
  bool moves;      /* the measured point moves visibly */
  bool common[2];  /* all cells show the same range along that axis */
  strut_bounds all;
  double base;    /* of the deepest point in the ground, 0 at most [m] */
  double size[2]; /* of that range, or of the largest shape [m] */
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

/* Height of the ground below the middle of bounds. */
static double ground_below(const strut_run_scene *run, const strut_bounds *bounds) {
  return strut_run_ground_at(run, 0.5 * (bounds->low[0] + bounds->high[0]));
}

/* Finds the frames of the cells and what they show: both motions, and the ground where it is near. */
static bool find_cells(strut_run_scene *run, grid *self) {
  strut_run_scene other;
  bool two = strut_run_find_other(run, &other);
  self->count = count_cells(run);
  self->cells = strut_arena_allocate(&run->arena, self->count, sizeof *self->cells);
  self->all = strut_bounds_none();
  for (size_t i = 0; self->cells && i < self->count; i++) {
    snapshot *cell = &self->cells[i];
    double time =
        run->figure->time_count ? run->figure->times[i] : default_time(run, i, self->count);
    cell->frame = strut_run_nearest(run, time);
    cell->bounds = strut_run_frame_bounds(run, cell->frame);
    if (two) {
      size_t frame = strut_run_nearest(&other, run->motion->time[cell->frame]);
      strut_bounds_add(&cell->bounds, run->model, strut_run_positions(&other, frame));
      other.arena = run->arena;
      if (!strut_run_other_shape(&other, frame, &cell->shapes[0])) return false;
      run->arena = other.arena;
    }
    strut_run_add_ground(run, &cell->bounds);
    strut_bounds_widen(&self->all, cell->bounds.low, cell->bounds.high);
    for (int d = 0; d < 2; d++)
      self->size[d] = fmax(self->size[d], cell->bounds.high[d] - cell->bounds.low[d]);
    strut_run_expect_frame(run, cell->frame);
  }
  return self->cells != NULL;
}

/* How far the measured point has come since the first cell [m]. */
static double way_to(const strut_run_scene *run, const grid *self, size_t i) {
  return strut_run_measured(run, self->cells[i].frame, 0) -
         strut_run_measured(run, self->cells[0].frame, 0);
}

/* A shape near the ground, whose bounds reach it. */
static bool is_grounded(const strut_run_scene *run, const strut_bounds *bounds) {
  return run->model->scene->ground.present && bounds->low[1] <= ground_below(run, bounds);
}

/* The range of all cells along each axis: one for all where the shapes are close together. */
static void find_sizes(const strut_run_scene *run, grid *self) {
  const strut_ground *ground = &run->model->scene->ground;
  double most = COMMON * fmax(self->size[0], self->size[1]);
  for (size_t i = 0; i < self->count; i++)
    self->moves =
        self->moves || fabs(way_to(run, self, i)) > SEEN * strut_bounds_extent(&self->all);
  for (int d = 0; d < 2; d++) {
    double together = self->all.high[d] - self->all.low[d];
    self->common[d] = together <= fmax(COMMON * self->size[d], 0.5 * most);
    if (d == 1 && ground->present && ground->slope != 0 && !self->common[0])
      self->common[1] = false;
    if (self->common[d]) self->size[d] = together;
  }
  for (int pass = 0; pass < 2 && !self->common[1]; pass++)
    for (size_t i = 0; i < self->count; i++) {
      const strut_bounds *bounds = &self->cells[i].bounds;
      if (!is_grounded(run, bounds)) continue;
      if (pass == 0) self->base = fmin(self->base, bounds->low[1] - ground_below(run, bounds));
      if (pass == 1)
        self->size[1] =
            fmax(self->size[1], bounds->high[1] - ground_below(run, bounds) - self->base);
    }
}

/* What cell i shows, as large as all others: shapes on the ground are drawn at one height. */
static strut_bounds bounds_of(const strut_run_scene *run, const grid *self, size_t i) {
  const strut_bounds *own = &self->cells[i].bounds;
  strut_bounds b = self->all;
  for (int d = 0; d < 2; d++) {
    double middle = 0.5 * (own->low[d] + own->high[d]);
    if (self->common[d]) continue;
    b.low[d] = middle - 0.5 * self->size[d];
    if (d == 1 && is_grounded(run, own)) b.low[1] = ground_below(run, own) + self->base;
    b.high[d] = b.low[d] + self->size[d];
  }
  return b;
}

/* One digit more than the times need to differ. */
static int count_digits(const strut_run_scene *run, const grid *self) {
  double least = HUGE_VAL, latest = 0;
  for (size_t i = 0; i < self->count; i++) {
    double time = run->motion->time[self->cells[i].frame];
    double before = i ? run->motion->time[self->cells[i - 1].frame] : -HUGE_VAL;
    latest = fmax(latest, fabs(time));
    if (fabs(time - before) > STRUT_RUN_MOMENT) least = fmin(least, fabs(time - before));
  }
  double digits = isfinite(least) && latest > 0 ? ceil(log10(latest / least)) + 2 : 4;
  return (int)fmax(3, fmin(digits, 9));
}

/* Fills in a cell's panel. False: out of memory. */
static bool fill_cell(strut_run_scene *run, const grid *self, size_t i, strut_panel *panel) {
  snapshot *cell = &self->cells[i];
  bool alone = !cell->shapes[0].q;
  double path = way_to(run, self, i), start = strut_run_measured(run, self->cells[0].frame, 0);
  const char *time =
      strut_drawn_quantity(run->motion->time[cell->frame], count_digits(run, self), "s").text;
  int used = snprintf(cell->title, sizeof cell->title, "%s", time);
  if (i > 0 && fabs(path) > 1e-6 * run->model->size)
    snprintf(cell->title + used, sizeof cell->title - (size_t)used, ", x %s%s", path > 0 ? "+" : "",
             strut_drawn_quantity(path, 3, "m").text);
  if (!strut_run_shape(run, cell->frame, &cell->shapes[1])) return false;
  cell->shapes[1].names = true;
  cell->line[0][0] = cell->line[1][0] = start;
  cell->line[0][1] = self->all.low[1], cell->line[1][1] = self->all.high[1];
  cell->start = (strut_trail){.count = 2,
                              .at = (const double(*)[2])cell->line,
                              .pen = {strut_grey(0.6), 0.6, {2, 2}, false},
                              .below = true};
  cell->view = (strut_view){.shapes = cell->shapes + alone,
                            .shape_count = 2 - alone,
                            .trails = &cell->start,
                            .trail_count = self->common[0] && self->moves,
                            .bounds = bounds_of(run, self, i),
                            .margin = MARGIN};
  *panel = (strut_panel){.title = cell->title, .view = &cell->view};
  return true;
}

bool strut_run_snapshots(strut_run_scene *run, strut_figure *figure, char *note) {
  grid g = {0};
  if (!find_cells(run, &g)) return false;
  strut_panel *panels = strut_arena_allocate(&run->arena, g.count, sizeof *panels);
  if (!panels) return false;
  find_sizes(run, &g);
  for (size_t i = 0; i < g.count; i++)
    if (!fill_cell(run, &g, i, &panels[i])) return false;
  bool marked = g.common[0] && g.moves;
  snprintf(note, STRUT_RUN_NOTE, "%zu snapshot%s to the same scale%s%.200s", g.count,
           g.count == 1 ? "" : "s",
           marked        ? "; dashed: initial position of "
           : g.common[0] ? ""
                         : "; each centred",
           marked ? strut_run_measured_name(run) : "");
  strut_run_describe_other(run, note, STRUT_RUN_NOTE);
  figure->panels = panels;
  figure->panel_count = figure->columns = g.count;
  figure->aspect = 0.95;
  figure->yardstick = true;
  figure->scale = strut_run_scale(run);
  figure->keys = strut_run_arrow_item(run);
  figure->key_count = 1;
  return figure->keys != NULL;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <string.h>

#include "engine/output/figures/run_parts.h"

/* Node trajectories over the last period, enlarged, as in the paper's figure 9; and snapshots to
   one scale, as in its figure 11. */

static const double TRAIL = 1.5;   /* width of enlarged trajectories [pt] */
static const double CLOSED = 1e-3; /* of the model's size: less above the ground is on it */

/* A second motion of the same structure, dashed below the first. */

static const double FRINGE =
    1.8; /* both edges of dashes, which show on both sides of what lies on them [pt] */

/* False where there is none. */
static bool find_other(const strut_run_scene *run, strut_run_scene *other) {
  *other = (strut_run_scene){
      .figure = run->figure, .model = run->model, .motion = run->figure->other, .page = run->page};
  if (other->motion && other->motion->position) strut_run_count_frames(other);
  return other->frames > 0;
}

/* "; thick dashes: NAME", or "". */
static const char *other_text(const strut_run_scene *run) {
  const char *name = run->figure->other_name;
  if (!run->figure->other) return "";
  return strut_figure_text(run->page, "; thick dashes: %s", name ? name : "another");
}

static double enlargement(const strut_run_scene *run, int axis) {
  return run->figure->scale[axis] > 0 ? run->figure->scale[axis] : 1;
}

/*
 * The nodes' mean positions, about which their motion is enlarged, as coordinates; of a node that touches the ground the
 * point of the ground below, so that contact is drawn as contact. NULL: out of memory.
 */
static double *find_anchors(const strut_run_scene *run, bool *grounded) {
  const strut_contact_table *contacts = &run->model->contacts;
  size_t first = strut_run_first(run, 1, 1);
  double *rest = strut_figure_numbers(run->page, NULL, (size_t)run->model->length);
  for (size_t i = 0; rest && i < run->motion->node_count; i++) {
    double *at = rest + 2 * i, lowest = HUGE_VAL;
    bool touches = false;
    for (size_t f = first; f < run->frames; f++) {
      const double *p = strut_run_positions(run, f) + 2 * i;
      for (int d = 0; d < 2; d++) at[d] += p[d] / (double)(run->frames - first);
      lowest = fmin(lowest, p[1] - strut_run_ground_at(run, p[0]));
    }
    for (int32_t k = 0; k < contacts->count && run->model->scene->ground.present; k++)
      touches |= (size_t)contacts->entry[k].node == i && lowest < CLOSED * run->model->size;
    if (touches) at[1] = strut_run_ground_at(run, at[0]);
    *grounded |= touches;
  }
  return rest;
}

/* The nodes' enlarged paths about their own centres, at those of the motion drawn. */
static void add_paths(const strut_run_scene *run, const double *own, const double *centres,
                      bool other, strut_panel *panel) {
  const strut_pen dashed = {strut_grey(0.25), TRAIL + FRINGE, {2.2, 2.2}, true};
  const strut_pen pen = other ? dashed : (strut_pen){.width = TRAIL};
  for (size_t i = 0; own && centres && i < run->motion->node_count; i++) {
    strut_series *way =
        strut_add_line(run->page, panel, other ? STRUT_SERIES_LINE : STRUT_SERIES_SEQUENCE, pen);
    for (size_t f = strut_run_first(run, 1, 1); f < run->frames; f++) {
      double at[2];
      for (int d = 0; d < 2; d++) {
        size_t k = 2 * i + (size_t)d;
        at[d] = centres[k] + enlargement(run, d) * (strut_run_positions(run, f)[k] - own[k]);
      }
      strut_add_point(run->page, way, at[0], at[1]);
      if (!other) strut_bounds_widen(&panel->bounds, at, at);
    }
  }
}

static const char *describe_period(const strut_run_scene *run, bool grounded) {
  /* The period itself: the frames drawn of it span a whole number of samples. */
  double span =
      run->period > 0 ? run->period : strut_run_time_from(run, strut_run_first(run, 1, 1));
  const char *over = run->period > 0 ? "one period (" : "", *note;
  if (run->repeats > 1)
    over = strut_figure_text(run->page, "the %d periods of the drive after which they repeat (",
                             (int)run->repeats);
  note = strut_figure_text(run->page, "node trajectories over %s%s%s, dark to bright%s", over,
                           strut_quantity_of(span, 4, "s").text, *over ? ")" : "", other_text(run));
  if (enlargement(run, 0) == 1 && enlargement(run, 1) == 1) return note;
  return strut_figure_text(
      run->page,
      "%s, enlarged %g times along x and %g times along y about each node's mean position "
      "(grey)%s",
      note, enlargement(run, 0), enlargement(run, 1),
      grounded ? " or, where it touches the ground, the point below" : "");
}

const char *strut_run_period(strut_run_scene *run, strut_figure *figure) {
  strut_run_scene other;
  bool grounded = false, periodic = run->period > 0, ignored = false;
  bool enlarged = enlargement(run, 0) != 1 || enlargement(run, 1) != 1;
  const double *centres = find_anchors(run, &grounded);
  strut_panel *panel = strut_add_panel(figure);
  /* Mean positions are no shape of a large motion: only enlarged paths are drawn over them. */
  strut_shape *shape = strut_add_shape(
      figure, panel, run->model, enlarged ? centres : strut_run_coordinates(run, run->frames - 1));
  shape->style = (strut_structure_style){
      .colouring = STRUT_COLOUR_ONE, .colour = strut_grey(0.72), .thinness = 0.5};
  shape->ground = shape->names = true;
  panel->bounds = strut_run_frame_bounds(run, run->frames - 1);
  panel->margin = 20;
  if (find_other(run, &other))
    add_paths(&other, find_anchors(&other, &ignored), centres, true, panel);
  add_paths(run, centres, centres, false, panel);
  strut_run_add_ground(run, &panel->bounds);
  figure->aspect = 0.75;
  figure->yardstick = true;
  figure->scale = (strut_colour_scale){
      .name = periodic ? "phase" : "time",
      .unit = periodic ? "" : "s",
      .high = periodic ? 1 : strut_run_time_from(run, strut_run_first(run, 1, 1)),
      .colours = STRUT_COLOURS_SEQUENTIAL};
  return describe_period(run, grounded);
}

/* Snapshots. */

enum { USUAL = 6 };

static const double COMMON = 2.2; /* shapes closer than this, in their sizes, share a window */
static const double SEEN = 2e-3;  /* of the drawing: least visible motion of the measured point */
static const double MARGIN = 15;  /* [pt] */

static const double LEVEL = 3;

/* The panels, and what they have in common. */
typedef struct grid {
  size_t count;
  size_t *frame;       /* (count) */
  strut_panel *panels; /* (count) with the bounds of their shapes */
  bool moves;          /* the measured point moves visibly */
  strut_bounds all;
  double size[2]; /* of the largest shape [m] */
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

/* Finds the frames and what they show: both motions, and the ground where it is near. */
static void find_cells(strut_run_scene *run, grid *self) {
  strut_run_scene other;
  bool two = find_other(run, &other);
  size_t count = count_cells(run);
  self->frame = strut_arena_allocate(&run->page->arena, count, sizeof *self->frame);
  self->all = strut_bounds_none();
  run->page->failed = run->page->failed || !self->frame;
  for (size_t i = 0; self->frame && i < count; i++) {
    double time = run->figure->time_count ? run->figure->times[i] : default_time(run, i, count);
    strut_panel *panel = strut_add_panel(run->page);
    self->frame[i] = strut_run_nearest(run, time);
    panel->bounds = strut_run_frame_bounds(run, self->frame[i]);
    if (two) {
      size_t frame = strut_run_nearest(&other, run->motion->time[self->frame[i]]);
      strut_bounds_add(&panel->bounds, run->model, strut_run_positions(&other, frame));
      strut_add_ghost(run->page, panel, run->model, strut_run_coordinates(&other, frame), 0.25)
          ->style.fringe = FRINGE;
    }
    strut_run_add_ground(run, &panel->bounds);
    strut_bounds_widen(&self->all, panel->bounds.low, panel->bounds.high);
    for (int d = 0; d < 2; d++)
      self->size[d] = fmax(self->size[d], panel->bounds.high[d] - panel->bounds.low[d]);
  }
  self->panels = run->page->panels;
  self->count = run->page->failed ? 0 : count;
}

/* How far the measured point has come since the first cell [m]. */
static double way_to(const strut_run_scene *run, const grid *self, size_t i) {
  return strut_run_measured(run, self->frame[i], 0) - strut_run_measured(run, self->frame[0], 0);
}

/*
 * Shapes that are close together have one window; of others each is about its own middle and from its foot on, but on
 * level ground all have the same height above it.
 */
static void share_bounds(const strut_run_scene *run, grid *self) {
  const strut_ground *ground = &run->model->scene->ground;
  double most = COMMON * fmax(self->size[0], self->size[1]);
  double high = self->all.high[1] - self->all.low[1];
  bool level = ground->present && ground->slope == 0 && high <= LEVEL * most;
  run->page->shared_axes = strut_bounds_extent(&self->all) <= most;
  if (level) self->size[1] = high;
  for (size_t i = 0; i < self->count; i++) {
    self->moves |= fabs(way_to(run, self, i)) > SEEN * strut_bounds_extent(&self->all);
    strut_bounds *own = &self->panels[i].bounds;
    if (!run->page->shared_axes) strut_bounds_share(own, self->size);
    if (level) own->low[1] = self->all.low[1], own->high[1] = self->all.high[1];
  }
}

static void fill_cell(const strut_run_scene *run, const grid *self, size_t i) {
  strut_panel *panel = &self->panels[i];
  double way = way_to(run, self, i), start = strut_run_measured(run, self->frame[0], 0);
  bool far = i > 0 && fabs(way) > 1e-6 * run->model->size;
  double time = run->motion->time[self->frame[i]];
  panel->title = strut_figure_text(run->page, "%s%s%s%s", strut_quantity_of(time, 5, "s").text,
                                   far ? ", x " : "", far && way > 0 ? "+" : "",
                                   far ? strut_quantity_of(way, 3, "m").text : "");
  strut_run_add_shape(run, panel, self->frame[i])->names = true;
  panel->margin = MARGIN;
  if (!run->page->shared_axes || !self->moves) return;
  /* Where the measured point began. */
  strut_add_segment(
      run->page, panel, STRUT_SERIES_LINE, (strut_pen){strut_grey(0.6), 0.6, {2, 2}, false},
      (const double[2]){start, self->all.low[1]}, (const double[2]){start, self->all.high[1]});
}

const char *strut_run_snapshots(strut_run_scene *run, strut_figure *figure) {
  grid g = {0};
  find_cells(run, &g);
  share_bounds(run, &g);
  for (size_t i = 0; i < g.count; i++) fill_cell(run, &g, i);
  bool marked = figure->shared_axes && g.moves;
  figure->columns = g.count;
  figure->aspect = 0.95;
  strut_run_add_scales(run);
  return strut_figure_text(figure, "%zu snapshot%s to the same scale%s%.200s%s", g.count,
                           g.count == 1 ? "" : "s",
                           marked                ? "; dashed: initial position of "
                           : figure->shared_axes ? ""
                                                 : "; each centred",
                           marked ? strut_run_measured_name(run) : "", other_text(run));
}

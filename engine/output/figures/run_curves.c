/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/output/figures/run_parts.h"

/* Curves over time, one kind of quantity in each panel, and the overview that shows some below
   the shape. */

enum { MOST_CURVES = 6, MOST_DRIVEN = 3, CURVES_HEIGHT = 122 };

static const double LEVEL = 1e-3;    /* of a force or an energy: smaller changes look level */
static const double STANDING = 1e-6; /* of the model's size: smaller motion is none */
static const double CLOSED = 1e-3;   /* of the model's size: closer to the ground is contact */
static const double ROUNDING = 1e-9; /* of an energy */
static const double ROOM = 0.06;     /* above and below the curves */

/* A panel and its curves of (frames) values each. */
typedef struct panel {
  const char *name, *unit;
  double least; /* range at least */
  size_t count;
  double *values[MOST_CURVES];
  const char *labels[MOST_CURVES];
} panel;

/* A drive of a member whose change follows from the time alone; a driven hinge shows in its angle. */
static bool is_shown(const strut_run_scene *run, int32_t drive) {
  const strut_drive_table *drives = &run->model->drives;
  double value, rate;
  if (drives->member[drive] >= run->model->members.count) return false;
  strut_signal_evaluate(run->model->scene->signals, drives->signal[drive], 0.0, &value, &rate);
  return !isnan(value);
}

static size_t count_driven(const strut_run_scene *run) {
  size_t count = 0;
  for (int32_t i = 0; i < run->model->drives.count; i++) count += is_shown(run, i);
  return count;
}

/* What each panel shows: a channel, or what is derived from the motion. */
static const struct {
  strut_channels channel; /* 0: none */
  const char *name, *unit;
  double factor;
} kinds[] = {[STRUT_RUN_DISPLACEMENT] = {0, "displacement", "m", 1},
             [STRUT_RUN_NORMALS] = {STRUT_CHANNEL_CONTACT, "contact force", "N", 1},
             [STRUT_RUN_DRIVE] = {0, "change", "m", 1},
             [STRUT_RUN_HEIGHTS] = {0, "height", "m", 1},
             [STRUT_RUN_FORCES] = {STRUT_CHANNEL_FORCE, "member force", "N", 1},
             [STRUT_RUN_ANGLES] = {STRUT_CHANNEL_ANGLE, "angle", "deg", 180.0 / STRUT_PI},
             [STRUT_RUN_MOMENTS] = {STRUT_CHANNEL_MOMENT, "moment", "N m", 1},
             [STRUT_RUN_PRESSURES] = {STRUT_CHANNEL_PRESSURE, "pressure", "N/m", 1},
             [STRUT_RUN_AREAS] = {STRUT_CHANNEL_AREA, "area", "m^2", 1},
             [STRUT_RUN_ENERGIES] = {STRUT_CHANNEL_ENERGY, "energy change", "J", 1}};
enum { ENERGIES = 4 }; /* that are stored */

static size_t count_items(const strut_run_scene *run, int kind) {
  const strut_scene *scene = run->model->scene;
  if (kind == STRUT_RUN_DISPLACEMENT) return scene->ground.present ? 1 : 2;
  if (kind == STRUT_RUN_DRIVE) return count_driven(run);
  if (kind == STRUT_RUN_HEIGHTS) return scene->ground.present ? run->motion->contact_count : 0;
  if (!strut_trajectory_channel(run->motion, kinds[kind].channel)) return 0;
  if (kind == STRUT_RUN_ENERGIES) return ENERGIES;
  return strut_channel_items(strut_channel_row_of(kinds[kind].channel), scene);
}

/* One value of a kind at a frame: of a channel the first component. */
static double value_at(const strut_run_scene *run, int kind, size_t item, size_t f) {
  const strut_trajectory *trajectory = run->motion;
  assert(item < count_items(run, kind));
  if (kind == STRUT_RUN_DISPLACEMENT) return strut_run_measured(run, f, (int)item);
  if (kind == STRUT_RUN_HEIGHTS) {
    const double *at = strut_run_positions(run, f) + 2 * trajectory->contact_node[item];
    return (at[1] - strut_run_ground_at(run, at[0])) * cos(run->model->scene->ground.slope);
  }
  const strut_channel_row *row = strut_channel_row_of(kinds[kind].channel);
  size_t step = kind == STRUT_RUN_ENERGIES ? 1 : row->components;
  size_t columns = row->components * strut_channel_items(row, run->model->scene);
  return kinds[kind].factor *
         strut_trajectory_channel(trajectory, row->id)[f * columns + step * item];
}

/* True if a contact ever touches the ground; heights of others are omitted. */
static bool comes_down(const strut_run_scene *run, size_t contact) {
  for (size_t f = 0; f < run->frames; f++)
    if (value_at(run, STRUT_RUN_HEIGHTS, contact, f) < CLOSED * run->model->size) return true;
  return false;
}

static const char *label_of(const strut_run_scene *run, int kind, size_t item) {
  static const char *const energies[] = {"kinetic", "elastic", "gravity", "contact"};
  static const char *const axes[] = {"along x", "along y"};
  strut_channels channel = kind == STRUT_RUN_HEIGHTS ? STRUT_CHANNEL_CONTACT : kinds[kind].channel;
  if (kind == STRUT_RUN_DISPLACEMENT) return axes[item];
  if (kind == STRUT_RUN_ENERGIES) return energies[item];
  return strut_channel_item(strut_channel_row_of(channel), run->model->scene, item);
}

/* Kinds drawn as changes from the first frame. */
static bool from_start(int kind) {
  return kind == STRUT_RUN_DISPLACEMENT || kind == STRUT_RUN_ENERGIES;
}

/* Range of a curve; contact forces include zero. */
static double variation(const strut_run_scene *run, int kind, size_t item, size_t first) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  if (kind == STRUT_RUN_HEIGHTS && !comes_down(run, item)) return 0;
  for (size_t f = first; f < run->frames; f++) {
    double value = value_at(run, kind, item, f);
    if (!isfinite(value)) continue;
    low = fmin(low, value);
    high = fmax(high, value);
  }
  if (kind == STRUT_RUN_NORMALS) low = fmin(low, 0), high = fmax(high, 0);
  return high > low ? high - low : 0;
}

/* Smaller changes are rounding. */
static double least_range(const strut_run_scene *run, int kind) {
  bool length =
      kind == STRUT_RUN_DISPLACEMENT || kind == STRUT_RUN_HEIGHTS || kind == STRUT_RUN_DRIVE;
  double most = 0;
  if (kind == STRUT_RUN_ANGLES) return STANDING * 180.0 / STRUT_PI;
  if (length) return STANDING * run->model->size;
  for (size_t i = 0; i < count_items(run, kind) && kind == STRUT_RUN_ENERGIES; i++)
    most = fmax(most, fabs(value_at(run, kind, i, 0)));
  return ROUNDING * most;
}

bool strut_run_panel_wanted(const strut_run_scene *run, int kind) {
  size_t items = count_items(run, kind);
  if (kind == STRUT_RUN_DRIVE) return items > 0;
  for (size_t i = 0; i < items; i++)
    if (variation(run, kind, i, 0) > least_range(run, kind)) return true;
  return false;
}

/* Chooses the items that vary most, in the scene's order. Returns how many. */
static size_t choose_curves(const strut_run_scene *run, int kind, size_t first,
                            size_t chosen[MOST_CURVES]) {
  double lively[MOST_CURVES];
  size_t count = 0;
  for (size_t i = 0; i < count_items(run, kind); i++) {
    double value = variation(run, kind, i, first);
    size_t dullest = 0;
    if (!(value > least_range(run, kind)) && !(kind == STRUT_RUN_DISPLACEMENT && i == 0)) continue;
    if (count == MOST_CURVES) {
      for (size_t k = 1; k < count; k++)
        if (lively[k] < lively[dullest]) dullest = k;
      if (!(value > lively[dullest])) continue;
      count--;
      for (size_t k = dullest; k < count; k++) chosen[k] = chosen[k + 1], lively[k] = lively[k + 1];
    }
    chosen[count] = i;
    lively[count++] = value;
  }
  return count;
}

static bool fill_panel(strut_run_scene *run, int kind, size_t first, panel *self) {
  size_t chosen[MOST_CURVES], frames = run->frames - first;
  double most = 0;
  self->count = choose_curves(run, kind, first, chosen);
  for (size_t i = 0; i < self->count; i++) {
    double start = from_start(kind) ? value_at(run, kind, chosen[i], first) : 0;
    self->values[i] = strut_arena_allocate(&run->arena, frames, sizeof(double));
    if (!self->values[i]) return false;
    for (size_t f = 0; f < frames; f++) {
      self->values[i][f] = value_at(run, kind, chosen[i], first + f) - start;
      most = fmax(most, fabs(self->values[i][f]));
    }
    self->labels[i] = label_of(run, kind, chosen[i]);
  }
  if (kind == STRUT_RUN_DISPLACEMENT && self->count == 1) self->labels[0] = NULL;
  self->least = fmax(least_range(run, kind), from_start(kind) ? 0 : LEVEL * most);
  return true;
}

/* The actuated change of a member's rest length at a time [m]. */
static double driven_by(const strut_run_scene *run, int32_t member, double time) {
  const strut_drive_table *drives = &run->model->drives;
  double sum = 0;
  for (int32_t i = 0; i < drives->count; i++) {
    double value, rate;
    if (drives->member[i] != member) continue;
    strut_signal_evaluate(run->model->scene->signals, drives->signal[i], time, &value, &rate);
    sum += value;
  }
  return sum;
}

static double length_at(const strut_run_scene *run, int32_t member, size_t f) {
  return strut_member_path_length(run->model, member, strut_run_positions(run, f));
}

/* Actuated rest lengths and actual lengths, as changes from the first frame. */
static bool fill_drive(strut_run_scene *run, size_t first, panel *self) {
  const strut_drive_table *drives = &run->model->drives;
  size_t frames = run->frames - first;
  for (int32_t i = 0; i < drives->count && self->count < 2 * MOST_DRIVEN; i++) {
    int32_t member = drives->member[i];
    if (!drives->first[i] || !is_shown(run, i)) continue;
    const char *name = run->model->scene->members[member].name;
    for (int k = 0; k < 2; k++) {
      double *values = strut_arena_allocate(&run->arena, frames, sizeof *values);
      if (!values) return false;
      for (size_t f = 0; f < frames; f++)
        values[f] = k ? length_at(run, member, first + f) - length_at(run, member, first)
                      : driven_by(run, member, run->motion->time[first + f]);
      self->labels[self->count] =
          strut_arena_format(&run->arena, k ? "length of %s" : "rest length of %s", name);
      if (!self->labels[self->count]) return false;
      self->values[self->count++] = values;
    }
  }
  self->least = least_range(run, STRUT_RUN_DRIVE);
  return true;
}

/* The range of all curves, at least p->least. */
static void find_range(const panel *self, size_t frames, int kind, strut_axis *axis) {
  for (size_t i = 0; i < self->count; i++)
    for (size_t f = 0; f < frames; f++) strut_axis_include(axis, self->values[i][f]);
  if (kind == STRUT_RUN_NORMALS) strut_axis_include(axis, 0);
  if (!(axis->low <= axis->high)) return;
  double missing = self->least - (axis->high - axis->low);
  if (missing > 0) axis->low -= 0.5 * missing, axis->high += 0.5 * missing;
  strut_axis_settle(axis, ROOM);
}

bool strut_run_panel(strut_run_scene *run, int kind, size_t first, strut_panel *to) {
  panel p = {.name = kinds[kind].name, .unit = kinds[kind].unit};
  const double *time = run->motion->time + first;
  size_t frames = run->frames - first;
  strut_series *series = strut_arena_allocate(&run->arena, MOST_CURVES, sizeof *series);
  if (!series) return false;
  if (!(kind == STRUT_RUN_DRIVE ? fill_drive(run, first, &p) : fill_panel(run, kind, first, &p)))
    return false;
  if (kind == STRUT_RUN_DISPLACEMENT && p.count == 1) p.name = "x displacement";
  for (size_t i = 0; i < p.count; i++)
    series[i] = (strut_series){
        .label = p.labels[i], .count = frames, .x = time, .y = p.values[i], .look = -1};
  *to =
      (strut_panel){.x = {.name = "time", .unit = "s", .low = time[0], .high = time[frames - 1]},
                    .y = {.name = p.name, .unit = p.unit, .low = (double)NAN, .high = (double)NAN},
                    .series_count = p.count,
                    .series = series,
                    .height = CURVES_HEIGHT};
  find_range(&p, frames, kind, &to->y);
  return true;
}

bool strut_run_curves(strut_run_scene *run, strut_figure *figure, char *note) {
  strut_panel *panels = strut_arena_allocate(&run->arena, STRUT_RUN_PANELS, sizeof *panels);
  if (!panels) return false;
  for (int kind = 0; kind < STRUT_RUN_PANELS; kind++) {
    if (!strut_run_panel_wanted(run, kind)) continue;
    if (!strut_run_panel(run, kind, 0, &panels[figure->panel_count++])) return false;
  }
  figure->panels = panels;
  snprintf(note, STRUT_RUN_NOTE, "%s",
           figure->panel_count ? "everything recorded" : "nothing changed");
  return true;
}

/* The overview of a run: where it ended, how it got there, and curves of the last periods. */

enum { MOST_PANELS = 4, MOST_STACKED = 3, MOST_PATHS = 300 };

static const double CHART = 118, MARGIN = 27, COLUMN = 190, WIDE = 380; /* [pt] */
static const double PERIODS = 5, PART = 0.1; /* of the record, where nothing is periodic */
static const double SEEN = 2e-3;             /* of the drawing: shorter paths are not drawn */
static const double REACH =
    0.6; /* paths are shown within this distance of the shape, in its sizes */

static size_t first_of_paths(const strut_run_scene *run) {
  double all = strut_run_time_from(run, 0);
  return strut_run_since(run, run->period > 0 ? fmin(run->period, all) : PART * all);
}

static size_t first_of_curves(const strut_run_scene *run) {
  double all = strut_run_time_from(run, 0);
  return strut_run_since(run, run->period > 0 ? fmin(PERIODS * run->period, all) : all);
}

/* Bounds of the last shape and of the paths near it. */
static strut_bounds bounds_of(const strut_run_scene *run) {
  strut_bounds shape = strut_run_frame_bounds(run, run->frames - 1), all = shape;
  double reach = REACH * strut_bounds_extent(&shape);
  for (size_t f = first_of_paths(run); f < run->frames; f++)
    strut_bounds_add(&all, run->model, strut_run_positions(run, f));
  for (int d = 0; d < 2; d++) {
    all.low[d] = fmax(all.low[d], shape.low[d] - reach);
    all.high[d] = fmin(all.high[d], shape.high[d] + reach);
  }
  strut_run_add_ground(run, &all);
  return all;
}

/* The nodes' ways to where they are; none where all are too short to be seen. False: out of memory. */
static bool add_paths(strut_run_scene *run, strut_view *view) {
  size_t first = first_of_paths(run), count = run->frames - first, nodes = run->motion->node_count;
  double least = SEEN * strut_bounds_extent(&view->bounds);
  if (nodes > MOST_PATHS) return true;
  double(*path)[2] = strut_arena_allocate(&run->arena, nodes * count, sizeof *path);
  strut_trail *trails = strut_arena_allocate(&run->arena, nodes, sizeof *trails);
  if (!path || !trails) return false;
  for (size_t i = 0; i < nodes; i++) {
    const double *end = strut_run_positions(run, run->frames - 1) + 2 * i;
    for (size_t f = 0; f < count; f++) {
      double *at =
          memcpy(path[i * count + f], strut_run_positions(run, first + f) + 2 * i, sizeof *path);
      if (fabs(at[0] - end[0]) > least || fabs(at[1] - end[1]) > least) view->trail_count = nodes;
    }
    trails[i] = (strut_trail){.kind = STRUT_TRAIL_SEQUENCE,
                              .count = count,
                              .at = (const double(*)[2])(path + i * count),
                              .pen.width = 0.9};
  }
  view->trails = trails;
  return true;
}

/* Two charts in a row where there is room; an odd one takes a whole row. False: out of memory. */
static bool add_charts(strut_run_scene *run, strut_figure *figure, strut_panel *panels) {
  static const int order[] = {STRUT_RUN_DISPLACEMENT, STRUT_RUN_NORMALS, STRUT_RUN_DRIVE,
                              STRUT_RUN_HEIGHTS,      STRUT_RUN_ANGLES,  STRUT_RUN_FORCES};
  size_t count = 1, most = run->figure->width >= WIDE ? MOST_PANELS : MOST_STACKED;
  for (size_t i = 0; run->frames > 1 && i < sizeof order / sizeof *order && count <= most; i++) {
    if (!strut_run_panel_wanted(run, order[i])) continue;
    if (!strut_run_panel(run, order[i], first_of_curves(run), &panels[count])) return false;
    panels[count++].height = CHART;
  }
  panels[1].whole = count % 2 == 0;
  figure->panel_count = count;
  return true;
}

bool strut_run_overview(strut_run_scene *run, strut_figure *figure, char *note) {
  struct {
    strut_panel panels[1 + MOST_PANELS];
    strut_view view;
    strut_shape shape;
    strut_key_item keys[2];
  } *to = strut_arena_allocate(&run->arena, 1, sizeof *to);
  size_t last = run->frames - 1;
  strut_run_expect_frame(run, last);
  if (!to || !strut_run_shape(run, last, &to->shape)) return false;
  to->shape.names = true;
  to->view = (strut_view){
      .shape_count = 1, .shapes = &to->shape, .bounds = bounds_of(run), .margin = MARGIN};
  to->panels[0] = (strut_panel){.view = &to->view, .whole = true};
  const strut_key_item *arrow = strut_run_arrow_item(run);
  if (!arrow || !add_paths(run, &to->view) || !add_charts(run, figure, to->panels)) return false;
  to->keys[0] = *arrow;
  to->keys[1] = (strut_key_item){.sign = STRUT_KEY_WORDS};
  double span = strut_run_time_from(run, first_of_paths(run));
  if (to->view.trail_count) {
    to->keys[1].text = strut_arena_format(&run->arena, "trajectories, last %s, dark to bright",
                                          strut_drawn_quantity(span, 3, "s").text);
    if (!to->keys[1].text) return false;
  }
  figure->panels = to->panels;
  figure->columns = 2;
  figure->least_width = COLUMN;
  figure->aspect = 0.62;
  figure->yardstick = true;
  figure->keys = to->keys;
  figure->key_count = 2;
  figure->scale = strut_run_scale(run);
  snprintf(note, STRUT_RUN_NOTE, "shape at %s",
           strut_drawn_quantity(run->motion->time[last], 5, "s").text);
  return true;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Curves over time, one kind of quantity in each panel, and the overview that shows some below the shape. */
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/output/figures/run_parts.h"

enum { MOST_CURVES = 6, CURVES_HEIGHT = 122, STORED = 4 /* energies */ };

static const double LEVEL = 1e-3;    /* of a force or an energy: smaller changes look level */
static const double STANDING = 1e-6; /* of the model's size: smaller motion is none */
static const double CLOSED = 1e-3;   /* of the model's size: closer to the ground is contact */
static const double ROUNDING = 1e-9; /* of an energy */

/* What panels show: what is derived from the motion, or a channel. */
typedef enum kind {
  DISPLACEMENT,
  NORMALS,
  DRIVE, /* rest length and length of driven members */
  HEIGHTS,
  FORCES,
  ANGLES,
  MOMENTS,
  PRESSURES,
  AREAS,
  ENERGIES, /* that are stored */
  KINDS     /* then each channel, for what is measured and in no panel above */
} kind;

static const struct {
  const char *channel; /* NULL: derived */
  const char *name;
  double least; /* of the model's size: smaller ranges are rounding */
  bool change;  /* from the first frame */
} kinds[] = {[DISPLACEMENT] = {NULL, "displacement", STANDING, true},
             [NORMALS] = {"contact", "contact force", 0, false},
             [DRIVE] = {NULL, "change", STANDING, false},
             [HEIGHTS] = {NULL, "height", STANDING, false},
             [FORCES] = {"force", "member force", 0, false},
             [ANGLES] = {"angle", "angle", 0, false},
             [MOMENTS] = {"moment", "moment", 0, false},
             [PRESSURES] = {"pressure", "pressure", 0, false},
             [AREAS] = {"area", "area", 0, false},
             [ENERGIES] = {"energy", "energy change", 0, true}};

/* The values of a kind: curve i is column `stride` * i. */
typedef struct block {
  const strut_run_scene *run;
  kind of;
  const strut_channel_row *row; /* NULL: derived */
  const char *name;
  const double *values; /* (frames, columns) */
  size_t columns, stride, count, first;
  double least; /* smaller ranges are rounding */
  bool change;
  int32_t driven[MOST_CURVES / 2]; /* of DRIVE: members */
} block;

static double value_at(const block *self, size_t item, size_t f) {
  return self->values[f * self->columns + self->stride * item];
}

/* The actuated change of a member's rest length at a time [m]. */
static double driven_by(const strut_run_scene *run, int32_t member, double time) {
  const strut_drive_table *drives = &run->model->drives;
  double sum = 0, value, rate;
  for (int32_t i = 0; i < drives->count; i++) {
    if (drives->member[i] != member) continue;
    strut_signal_evaluate(run->model->scene->signals, drives->signal[i], time, &value, &rate);
    sum += value;
  }
  return sum;
}

/* The first driven members whose change follows from the time alone; a driven hinge shows in its angle. */
static void choose_driven(block *self) {
  const strut_model *model = self->run->model;
  for (int32_t i = 0; i < model->drives.count && self->count < MOST_CURVES; i++) {
    int32_t member = model->drives.member[i];
    if (!model->drives.first[i] || member >= model->members.count) continue;
    if (isnan(driven_by(self->run, member, 0.0))) continue;
    self->driven[self->count / 2] = member;
    self->count += 2;
  }
}

/* A value that is derived from the motion [m]. */
static double derive(const block *self, size_t item, size_t f) {
  const strut_run_scene *run = self->run;
  if (self->of == DISPLACEMENT) return strut_run_measured(run, f, (int)item);
  if (self->of == HEIGHTS) {
    const double *at = strut_run_positions(run, f) + 2 * run->motion->contact_node[item];
    return (at[1] - strut_run_ground_at(run, at[0])) * cos(run->model->scene->ground.slope);
  }
  int32_t member = self->driven[item / 2];
  if (item % 2 == 0) return driven_by(run, member, run->motion->time[f]);
  return strut_member_path_length(run->model, member, strut_run_positions(run, f)) -
         strut_member_path_length(run->model, member, strut_run_positions(run, self->first));
}

/* Fills in what is derived from the motion. */
static void derive_all(block *self) {
  const strut_run_scene *run = self->run;
  bool ground = run->model->scene->ground.present;
  if (self->of == DISPLACEMENT) self->count = ground ? 1 : 2;
  if (self->of == HEIGHTS && ground) self->count = run->motion->contact_count;
  if (self->of == DRIVE) choose_driven(self);
  double *values = strut_figure_numbers(run->page, NULL, run->frames * self->count);
  self->columns = self->count;
  if (!values) self->count = 0;
  for (size_t k = 0; k < run->frames * self->count; k++)
    values[k] = derive(self, k % self->count, k / self->count);
  self->values = values;
}

/* The values of a kind that begins at frame `first`; a count of 0 where there are none. */
static block find_block(const strut_run_scene *run, kind of, size_t first) {
  block b = {.run = run, .of = of, .first = first, .stride = 1};
  if (of >= KINDS) {
    b.row = strut_channel_at((size_t)of - KINDS);
    b.name = b.row->name;
  } else {
    if (kinds[of].channel) b.row = strut_channel_named(kinds[of].channel);
    b.name = kinds[of].name, b.change = kinds[of].change;
    b.least = of == ANGLES ? STANDING : kinds[of].least * run->model->size;
  }
  if (b.row) {
    b.values = strut_trajectory_channel(run->motion, b.row->id);
    b.columns = b.row->components * strut_channel_items(b.row, run->model->scene);
    b.stride = of < ENERGIES ? b.row->components : 1;
    b.count = !b.values ? 0 : of == ENERGIES ? STORED : b.columns / b.stride;
  } else {
    derive_all(&b);
  }
  for (size_t i = 0; i < b.count && of == ENERGIES; i++)
    b.least = fmax(b.least, ROUNDING * fabs(value_at(&b, i, 0)));
  return b;
}

/* Data beside a curve; `dots` may be NULL. Returns how many. */
static size_t measured(const block *self, size_t item, double (*dots)[2]) {
  const strut_run_scene *run = self->run;
  const double span[] = {run->motion->time[self->first], run->motion->time[run->frames - 1]};
  if (!self->row || self->change) return 0;
  for (int k = 0; k < KINDS && self->of >= KINDS && item % self->row->components == 0; k++)
    if (kinds[k].channel && !kinds[k].change && !strcmp(kinds[k].channel, self->row->name))
      return 0;
  return strut_data_dots(run->model->scene, self->row, self->stride * item, span, dots);
}

static const char *label_of(const block *self, size_t item) {
  static const char *const directions[] = {"along x", "along y"};
  const strut_scene *scene = self->run->model->scene;
  const strut_channel_row *row = self->row;
  if (self->of == DISPLACEMENT) return self->count > 1 ? directions[item] : NULL;
  if (self->of == DRIVE)
    return strut_figure_text(self->run->page, item % 2 ? "length of %s" : "rest length of %s",
                             scene->members[self->driven[item / 2]].name);
  if (self->of == HEIGHTS) row = strut_channel_row_of(STRUT_CHANNEL_CONTACT);
  if (self->of < ENERGIES) return strut_channel_item(row, scene, item);
  const char *word = row->column_names[item % row->components];
  return strut_channel_is_whole(row)
             ? word
             : strut_figure_text(self->run->page, "%s.%s",
                                 strut_channel_item(row, scene, item / row->components), word);
}

/* Range of a curve from a frame on, endless beside data; contact forces include zero, heights of what never comes down are omitted. */
static double variation(const block *self, size_t item, size_t first) {
  double low = HUGE_VAL, high = -HUGE_VAL, lowest = HUGE_VAL;
  if (measured(self, item, NULL)) return HUGE_VAL;
  if (self->of >= KINDS) return 0;
  for (size_t f = self->of == HEIGHTS ? 0 : first; f < self->run->frames; f++) {
    double value = value_at(self, item, f);
    lowest = fmin(lowest, value);
    if (!isfinite(value) || f < first) continue;
    low = fmin(low, value);
    high = fmax(high, value);
  }
  if (self->of == HEIGHTS && !(lowest < CLOSED * self->run->model->size)) return 0;
  if (self->of == NORMALS) low = fmin(low, 0), high = fmax(high, 0);
  return high > low ? high - low : 0;
}

/* Chooses the items that vary most, in the scene's order. Returns how many. */
static size_t choose_curves(const block *self, size_t chosen[MOST_CURVES]) {
  double *lively = strut_figure_numbers(self->run->page, NULL, self->count);
  size_t count = 0;
  for (size_t i = 0; lively && i < self->count; i++)
    lively[i] = self->of == DRIVE || (self->of == DISPLACEMENT && i == 0)
                    ? HUGE_VAL
                    : variation(self, i, self->first);
  for (size_t i = 0; lively && i < self->count; i++) {
    size_t rank = 0;
    for (size_t k = 0; k < self->count; k++)
      rank += lively[k] > lively[i] || (lively[k] == lively[i] && k < i);
    if (lively[i] > self->least && rank < MOST_CURVES) chosen[count++] = i;
  }
  return count;
}

/* Adds the data beside a curve, in its colour, paler. */
static void add_dots(const block *self, strut_panel *panel, size_t item, size_t look) {
  strut_figure *page = self->run->page;
  double dots[STRUT_DATA_DOTS][2];
  size_t count = measured(self, item, dots);
  if (!count) return;
  strut_series *series =
      strut_add_series(page, panel, strut_figure_text(page, "%s measured", label_of(self, item)));
  series->kind = STRUT_SERIES_DOTS;
  series->pen = (strut_pen){.colour = strut_faded(strut_series_pen(look).colour, 0.4), .width = 1};
  for (size_t k = 0; k < count; k++) strut_add_point(page, series, dots[k][0], dots[k][1]);
}

/* Adds the panel of a kind from frame `first` on, if anything changes in the whole record. */
static void add_panel(strut_run_scene *run, kind of, size_t first, double height) {
  const block b = find_block(run, of, first);
  size_t chosen[MOST_CURVES], last = run->frames - 1;
  double most = 0;
  bool wanted = false;
  for (size_t i = 0; i < b.count && !wanted; i++)
    wanted = of == DRIVE || variation(&b, i, 0) > b.least;
  if (!wanted) return;
  size_t count = choose_curves(&b, chosen);
  strut_panel *panel = strut_add_panel(run->page);
  bool one = of == DISPLACEMENT && count == 1;
  for (size_t i = 0; i < count; i++) {
    double start = b.change ? value_at(&b, chosen[i], first) : 0;
    strut_series *series = strut_add_series(run->page, panel, one ? NULL : label_of(&b, chosen[i]));
    if (measured(&b, chosen[i], NULL)) series->unmarked = true;
    for (size_t f = first; f <= last; f++) {
      double value = value_at(&b, chosen[i], f) - start;
      strut_add_point(run->page, series, run->motion->time[f], value);
      most = fmax(most, fabs(value));
    }
  }
  for (size_t i = 0; i < count; i++) add_dots(&b, panel, chosen[i], i);
  panel->x = (strut_axis){.name = "time",
                          .unit = "s",
                          .low = run->motion->time[first],
                          .high = run->motion->time[last]};
  panel->y = strut_axis_of(one ? "x displacement" : b.name,
                           b.row ? strut_channel_unit(b.row, run->model->scene) : "m");
  panel->height = height;
  panel->zero = of == NORMALS;
  panel->least = fmax(b.least, b.change ? 0 : LEVEL * most);
}

const char *strut_run_curves(strut_run_scene *run, strut_figure *figure) {
  for (int of = 0; of < KINDS + STRUT_CHANNEL_COUNT; of++)
    add_panel(run, (kind)of, 0, CURVES_HEIGHT);
  return figure->panel_count ? "everything recorded" : "nothing changed";
}

/* The overview of a run: where it ended, how it got there, and curves of the last periods. */

enum { MOST_PANELS = 4, MOST_STACKED = 3, MOST_PATHS = 300 };

static const double CHART = 118, MARGIN = 27, COLUMN = 190, WIDE = 380; /* [pt] */
static const double PERIODS = 5, PART = 0.1; /* of the record, where nothing is periodic */
static const double SEEN = 2e-3;             /* of the drawing: shorter paths are not drawn */
static const double REACH =
    0.6; /* paths are shown within this distance of the shape, in its sizes */

/* Bounds of the last shape and of the paths near it. */
static strut_bounds bounds_of(const strut_run_scene *run, size_t first) {
  strut_bounds shape = strut_run_frame_bounds(run, run->frames - 1), all = shape;
  double reach = REACH * strut_bounds_extent(&shape);
  for (size_t f = first; f < run->frames; f++)
    strut_bounds_add(&all, run->model, strut_run_positions(run, f));
  for (int d = 0; d < 2; d++) {
    all.low[d] = fmax(all.low[d], shape.low[d] - reach);
    all.high[d] = fmin(all.high[d], shape.high[d] + reach);
  }
  strut_run_add_ground(run, &all);
  return all;
}

/* The nodes' ways from a frame on to where they are; false where all are too short to be seen. */
static bool add_paths(const strut_run_scene *run, size_t first, strut_panel *panel) {
  size_t nodes = run->motion->node_count;
  double least = SEEN * strut_bounds_extent(&panel->bounds);
  const double *end = strut_run_positions(run, run->frames - 1);
  bool seen = false;
  for (size_t f = first; f < run->frames; f++)
    for (size_t i = 0; i < 2 * nodes; i++)
      seen = seen || fabs(strut_run_positions(run, f)[i] - end[i]) > least;
  for (size_t i = 0; i < nodes && seen && nodes <= MOST_PATHS; i++) {
    strut_series *way =
        strut_add_line(run->page, panel, STRUT_SERIES_SEQUENCE, (strut_pen){.width = 0.9});
    for (size_t f = first; f < run->frames; f++) {
      const double *at = strut_run_positions(run, f) + 2 * i;
      strut_add_point(run->page, way, at[0], at[1]);
    }
  }
  return seen && nodes <= MOST_PATHS;
}

const char *strut_run_overview(strut_run_scene *run, strut_figure *figure) {
  static const kind order[] = {DISPLACEMENT, NORMALS, DRIVE, HEIGHTS, ANGLES, FORCES};
  size_t last = run->frames - 1, first = strut_run_first(run, 1, PART);
  size_t most = run->figure->plot.width >= WIDE ? MOST_PANELS : MOST_STACKED;
  strut_panel *panel = strut_add_panel(figure);
  strut_run_add_shape(run, panel, last)->names = true;
  panel->bounds = bounds_of(run, first);
  panel->margin = MARGIN;
  panel->whole = true;
  bool paths = add_paths(run, first, panel);
  for (size_t i = 0; last > 0 && i < sizeof order / sizeof *order; i++)
    if (figure->panel_count <= most)
      add_panel(run, order[i], strut_run_first(run, PERIODS, 1), CHART);
  /* Two charts in a row where there is room; an odd one takes a whole row. */
  if (figure->panel_count > 1) figure->panels[1].whole = figure->panel_count % 2 == 0;
  strut_run_add_scales(run);
  if (paths)
    strut_add_key(
        figure, STRUT_KEY_WORDS, (strut_pen){0},
        strut_figure_text(figure, "trajectories, last %s, dark to bright",
                          strut_quantity_of(strut_run_time_from(run, first), 3, "s").text));
  figure->columns = 2;
  figure->least_width = COLUMN;
  figure->aspect = 0.62;
  return strut_figure_text(figure, "shape at %s",
                           strut_quantity_of(run->motion->time[last], 5, "s").text);
}

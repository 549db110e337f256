/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/output/figures/run_parts.h"

/* Curves over time, one kind of quantity in each panel, and the overview that shows some below
   the shape. */

enum { MOST_CURVES = 6, CURVES_HEIGHT = 122 };

static const double LEVEL = 1e-3;    /* of a force or an energy: smaller changes look level */
static const double STANDING = 1e-6; /* of the model's size: smaller motion is none */
static const double CLOSED = 1e-3;   /* of the model's size: closer to the ground is contact */
static const double ROUNDING = 1e-9; /* of an energy */
static const double ROOM = 0.06;     /* above and below the curves */

/* What panels show: a channel, or what is derived from the motion. */
typedef enum kind {
  DISPLACEMENT,
  NORMALS,
  DRIVE, /* rest length and length of driven members: items 2 j and 2 j + 1 of member j */
  HEIGHTS,
  FORCES,
  ANGLES,
  MOMENTS,
  PRESSURES,
  AREAS,
  ENERGIES, /* that are stored */
  KINDS     /* then each channel, for what is measured and in no panel above */
} kind;

static const struct kind_row {
  strut_channels channel; /* 0: none */
  const char *name, *unit;
  double factor;
  bool change;  /* from the first frame */
  double least; /* of the model's size: smaller ranges are rounding */
} kinds[] = {[DISPLACEMENT] = {0, "displacement", "m", 1, true, STANDING},
             [NORMALS] = {STRUT_CHANNEL_CONTACT, "contact force", "N", 1, false, 0},
             [DRIVE] = {0, "change", "m", 1, true, STANDING},
             [HEIGHTS] = {STRUT_CHANNEL_CONTACT, "height", "m", 1, false, STANDING},
             [FORCES] = {STRUT_CHANNEL_FORCE, "member force", "N", 1, false, 0},
             [ANGLES] = {STRUT_CHANNEL_ANGLE, "angle", "deg", 180.0 / STRUT_PI, false, 0},
             [MOMENTS] = {STRUT_CHANNEL_MOMENT, "moment", "N m", 1, false, 0},
             [PRESSURES] = {STRUT_CHANNEL_PRESSURE, "pressure", "N/m", 1, false, 0},
             [AREAS] = {STRUT_CHANNEL_AREA, "area", "m^2", 1, false, 0},
             [ENERGIES] = {STRUT_CHANNEL_ENERGY, "energy change", "J", 1, true, 0}};

static struct kind_row row_of(kind of) {
  const strut_channel_row *row = of < KINDS ? NULL : strut_channel_at((size_t)of - KINDS);
  return row ? (struct kind_row){row->id, row->name, row->unit, 1, false, 0} : kinds[of];
}

static size_t count_items(const strut_run_scene *run, kind of) {
  static const size_t energies = 4;
  const strut_scene *scene = run->model->scene;
  if (of == DISPLACEMENT) return scene->ground.present ? 1 : 2;
  if (of == HEIGHTS) return scene->ground.present ? run->motion->contact_count : 0;
  if (of == DRIVE || !strut_trajectory_channel(run->motion, row_of(of).channel)) return 0;
  if (of == ENERGIES) return energies;
  const strut_channel_row *row = strut_channel_row_of(row_of(of).channel);
  return strut_channel_items(row, scene) * (of < KINDS ? 1 : row->components);
}

/* Data beside the curve of an item from frame `first` on; `dots` may be NULL. Returns how many. */
static size_t measured(const strut_run_scene *run, kind of, size_t item, size_t first,
                       double (*dots)[2]) {
  const double span[] = {run->motion->time[first], run->motion->time[run->frames - 1]};
  const struct kind_row own = row_of(of);
  if (!own.channel || of == HEIGHTS || own.change) return 0;
  const strut_channel_row *row = strut_channel_row_of(own.channel);
  for (int k = 0; k < KINDS && of >= KINDS && item % row->components == 0; k++)
    if (kinds[k].channel == own.channel && !kinds[k].change) return 0;
  return strut_data_dots(run->model->scene, row, of < KINDS ? item * row->components : item, span,
                         dots);
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

/* One value of a kind at a frame: of a channel that has a panel the first component. */
static double value_at(const strut_run_scene *run, kind of, size_t item, size_t f) {
  const strut_trajectory *trajectory = run->motion;
  if (of == DISPLACEMENT) return strut_run_measured(run, f, (int)item);
  if (of == DRIVE && item % 2)
    return strut_member_path_length(run->model, (int32_t)item / 2, strut_run_positions(run, f));
  if (of == DRIVE) return driven_by(run, (int32_t)item / 2, trajectory->time[f]);
  if (of == HEIGHTS) {
    const double *at = strut_run_positions(run, f) + 2 * trajectory->contact_node[item];
    return (at[1] - strut_run_ground_at(run, at[0])) * cos(run->model->scene->ground.slope);
  }
  const strut_channel_row *row = strut_channel_row_of(row_of(of).channel);
  size_t step = of >= ENERGIES ? 1 : row->components;
  size_t columns = row->components * strut_channel_items(row, run->model->scene);
  return row_of(of).factor *
         strut_trajectory_channel(trajectory, row->id)[f * columns + step * item];
}

static const char *label_of(const strut_run_scene *run, kind of, size_t item) {
  static const char *const energies[] = {"kinetic", "elastic", "gravity", "contact"};
  const strut_scene *scene = run->model->scene;
  if (of == DISPLACEMENT && count_items(run, of) == 1) return NULL;
  if (of == DISPLACEMENT) return item ? "along y" : "along x";
  if (of == ENERGIES) return energies[item];
  if (of == DRIVE)
    return strut_figure_text(run->page, item % 2 ? "length of %s" : "rest length of %s",
                             scene->members[item / 2].name);
  const strut_channel_row *row = strut_channel_row_of(row_of(of).channel);
  if (of < KINDS) return strut_channel_item(row, scene, item);
  const char *word = row->column_names[item % row->components];
  const char *thing = strut_channel_item(row, scene, item / row->components);
  return strut_channel_is_whole(row) ? word : strut_figure_text(run->page, "%s.%s", thing, word);
}

/* Range of a curve, endless beside data; contact forces include zero, heights of what never comes down are omitted. */
static double variation(const strut_run_scene *run, kind of, size_t item, size_t first) {
  double low = HUGE_VAL, high = -HUGE_VAL, lowest = HUGE_VAL;
  if (measured(run, of, item, first, NULL)) return HUGE_VAL;
  if (of >= KINDS) return 0;
  for (size_t f = of == HEIGHTS ? 0 : first; f < run->frames; f++) {
    double value = value_at(run, of, item, f);
    lowest = fmin(lowest, value);
    if (!isfinite(value) || f < first) continue;
    low = fmin(low, value);
    high = fmax(high, value);
  }
  if (of == HEIGHTS && !(lowest < CLOSED * run->model->size)) return 0;
  if (of == NORMALS) low = fmin(low, 0), high = fmax(high, 0);
  return high > low ? high - low : 0;
}

/* Smaller changes are rounding. */
static double least_range(const strut_run_scene *run, kind of) {
  double most = 0;
  if (of == ANGLES) return STANDING * kinds[of].factor;
  for (size_t i = 0; i < count_items(run, of) && of == ENERGIES; i++)
    most = fmax(most, fabs(value_at(run, of, i, 0)));
  return row_of(of).least * run->model->size + ROUNDING * most;
}

/* The first driven members whose change follows from the time alone; a driven hinge shows in its angle. */
static size_t choose_driven(const strut_run_scene *run, size_t chosen[MOST_CURVES]) {
  const strut_drive_table *drives = &run->model->drives;
  size_t count = 0;
  for (int32_t i = 0; i < drives->count && count < MOST_CURVES; i++) {
    double value, rate;
    if (!drives->first[i] || drives->member[i] >= run->model->members.count) continue;
    strut_signal_evaluate(run->model->scene->signals, drives->signal[i], 0.0, &value, &rate);
    for (int k = 0; k < 2 && !isnan(value); k++)
      chosen[count++] = 2 * (size_t)drives->member[i] + (size_t)k;
  }
  return count;
}

/* Chooses the items that vary most, in the scene's order. Returns how many. */
static size_t choose_curves(const strut_run_scene *run, kind of, size_t first,
                            size_t chosen[MOST_CURVES]) {
  double lively[MOST_CURVES], least = least_range(run, of);
  size_t count = 0;
  if (of == DRIVE) return choose_driven(run, chosen);
  for (size_t i = 0; i < count_items(run, of); i++) {
    double value = variation(run, of, i, first);
    size_t dullest = 0;
    if (!(value > least) && !(of == DISPLACEMENT && i == 0)) continue;
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

/* True if anything changes in the whole record. */
static bool is_wanted(const strut_run_scene *run, kind of) {
  size_t chosen[MOST_CURVES], count = choose_curves(run, of, 0, chosen);
  for (size_t i = 0; i < count; i++)
    if (of == DRIVE || variation(run, of, chosen[i], 0) > least_range(run, of)) return true;
  return false;
}

/* The range of all curves, at least `least`. */
static void find_range(const strut_panel *panel, double least, bool zero, strut_axis *axis) {
  for (size_t i = 0; i < panel->series_count; i++)
    for (size_t k = 0; k < panel->series[i].count; k++)
      strut_axis_include(axis, panel->series[i].points[k].y);
  if (zero) strut_axis_include(axis, 0);
  if (!(axis->low <= axis->high)) return;
  double missing = least - (axis->high - axis->low);
  if (missing > 0) axis->low -= 0.5 * missing, axis->high += 0.5 * missing;
  strut_axis_settle(axis, ROOM);
}

/* Adds the data beside a curve, in its colour, paler. */
static void add_dots(strut_run_scene *run, strut_panel *panel, kind of, size_t item, size_t first,
                     size_t look) {
  double dots[STRUT_DATA_DOTS][2];
  size_t count = measured(run, of, item, first, dots);
  if (!count) return;
  strut_series *series = strut_add_series(
      run->page, panel, strut_figure_text(run->page, "%s measured", label_of(run, of, item)));
  series->cloud = true;
  series->pen = (strut_pen){.colour = strut_faded(strut_series_pen(look).colour, 0.4), .width = 1};
  for (size_t k = 0; k < count; k++)
    strut_add_point(run->page, series, dots[k][0], row_of(of).factor * dots[k][1]);
}

/* Adds the panel of a kind from frame `first` on, if it is wanted. */
static void add_panel(strut_run_scene *run, kind of, size_t first, double height) {
  size_t chosen[MOST_CURVES], last = run->frames - 1;
  if (!is_wanted(run, of)) return;
  size_t count = choose_curves(run, of, first, chosen);
  strut_panel *panel = strut_add_panel(run->page);
  double most = 0;
  for (size_t i = 0; i < count; i++) {
    bool change = row_of(of).change && (of != DRIVE || chosen[i] % 2);
    double start = change ? value_at(run, of, chosen[i], first) : 0;
    strut_series *series = strut_add_series(run->page, panel, label_of(run, of, chosen[i]));
    if (measured(run, of, chosen[i], first, NULL)) series->markers = STRUT_MARKERS_NONE;
    for (size_t f = first; f <= last; f++) {
      double value = value_at(run, of, chosen[i], f) - start;
      strut_add_point(run->page, series, run->motion->time[f], value);
      most = fmax(most, fabs(value));
    }
  }
  for (size_t i = 0; i < count; i++) add_dots(run, panel, of, chosen[i], first, i);
  bool one = of == DISPLACEMENT && count == 1;
  if (one && count_items(run, of) > 1 && !run->page->failed) panel->series[0].label = NULL;
  panel->x = (strut_axis){.name = "time",
                          .unit = "s",
                          .low = run->motion->time[first],
                          .high = run->motion->time[last]};
  panel->y = strut_axis_of(one ? "x displacement" : row_of(of).name, row_of(of).unit);
  panel->height = height;
  if (!run->page->failed)
    find_range(panel, fmax(least_range(run, of), row_of(of).change ? 0 : LEVEL * most),
               of == NORMALS, &panel->y);
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
  if (!seen || nodes > MOST_PATHS) return false;
  for (size_t i = 0; i < nodes; i++) {
    strut_trail *trail =
        strut_add_trail(run->page, panel, STRUT_TRAIL_SEQUENCE, (strut_pen){.width = 0.9});
    for (size_t f = first; f < run->frames; f++)
      strut_add_place(run->page, trail, strut_run_positions(run, f) + 2 * i);
  }
  return true;
}

const char *strut_run_overview(strut_run_scene *run, strut_figure *figure) {
  static const kind order[] = {DISPLACEMENT, NORMALS, DRIVE, HEIGHTS, ANGLES, FORCES};
  size_t last = run->frames - 1, first = strut_run_first(run, 1, PART);
  size_t most = run->figure->width >= WIDE ? MOST_PANELS : MOST_STACKED;
  strut_run_expect_frame(run, last);
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
                          strut_drawn_quantity(strut_run_time_from(run, first), 3, "s").text));
  figure->columns = 2;
  figure->least_width = COLUMN;
  figure->aspect = 0.62;
  return strut_figure_text(figure, "shape at %s",
                           strut_drawn_quantity(run->motion->time[last], 5, "s").text);
}

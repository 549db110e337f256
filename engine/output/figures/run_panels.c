/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Curves of what was recorded: one kind of quantity in each panel. */
#include <math.h>
#include <string.h>

#include "engine/output/draw/curves.h"
#include "engine/output/figures/run_parts.h"

enum { MOST_CURVES = 6, MOST_DRIVEN = 3, CURVES_HEIGHT = 122 };

static const double LEVEL = 1e-3;    /* of a force or an energy: less is drawn as level */
static const double STANDING = 1e-6; /* of the model's size: less is no motion */
static const double CLOSED = 1e-3;   /* of that: less above the ground is on it */
static const double ROUNDING = 1e-9; /* of an energy */
static const double ROOM = 0.06;     /* above and below the curves */

/* What a panel draws, and its curves; values are (frames) each. */
typedef struct panel {
  const char *name, *unit;
  double least; /* range at least */
  size_t count;
  double *values[MOST_CURVES];
  const char *labels[MOST_CURVES];
} panel;

/* One value of a kind at a frame. */
static double value_at(const strut_run_scene *run, int kind, size_t item, size_t f) {
  const strut_trajectory *m = run->motion;
  const double *q = strut_run_positions(run, f);
  switch (kind) {
    case STRUT_RUN_WAY: return strut_run_measured(run, f, (int)item);
    case STRUT_RUN_NORMALS: return m->contact[2 * (f * m->contact_count + item)];
    case STRUT_RUN_HEIGHTS: {
      size_t node = (size_t)m->contact_node[item];
      return (q[2 * node + 1] - strut_run_ground_at(run, q[2 * node])) *
             cos(run->model->scene->ground.slope);
    }
    case STRUT_RUN_FORCES: return m->force[f * m->member_count + item];
    default: return m->energy[f * STRUT_ENERGIES + item];
  }
}

/* Whether a contact comes down to the ground: heights of others tell little. */
static bool comes_down(const strut_run_scene *run, size_t contact) {
  for (size_t f = 0; f < run->frames; f++)
    if (value_at(run, STRUT_RUN_HEIGHTS, contact, f) < CLOSED * run->model->size) return true;
  return false;
}

static size_t items_of(const strut_run_scene *run, int kind) {
  const strut_trajectory *m = run->motion;
  switch (kind) {
    case STRUT_RUN_WAY: return run->model->scene->ground.present ? 1 : 2;
    case STRUT_RUN_NORMALS: return m->contact ? m->contact_count : 0;
    case STRUT_RUN_DRIVE: return (size_t)run->model->drives.count;
    case STRUT_RUN_HEIGHTS: return run->model->scene->ground.present ? m->contact_count : 0;
    case STRUT_RUN_FORCES: return m->force ? m->member_count : 0;
    default: return m->energy ? 4 : 0;
  }
}

static const char *label_of(const strut_run_scene *run, int kind, size_t item) {
  static const char *const energies[] = {"kinetic", "elastic", "gravity", "contact"};
  static const char *const axes[] = {"along x", "along y"};
  const strut_scene *scene = run->model->scene;
  switch (kind) {
    case STRUT_RUN_WAY: return axes[item];
    case STRUT_RUN_FORCES: return scene->members[item].name;
    case STRUT_RUN_ENERGIES: return energies[item];
    default: return scene->nodes[run->motion->contact_node[item]].name;
  }
}

/* Kinds whose curves start at zero: only how far things went is of interest. */
static bool from_start(int kind) { return kind == STRUT_RUN_WAY || kind == STRUT_RUN_ENERGIES; }

/* How far a curve moves; of a kind whose zero means something, from there. */
static double liveliness(const strut_run_scene *run, int kind, size_t item, size_t first) {
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

/* A change of less than this is rounding. */
static double least_range(const strut_run_scene *run, int kind) {
  bool length = kind == STRUT_RUN_WAY || kind == STRUT_RUN_HEIGHTS || kind == STRUT_RUN_DRIVE;
  double most = 0;
  if (length) return STANDING * run->model->size;
  for (size_t i = 0; i < items_of(run, kind) && kind == STRUT_RUN_ENERGIES; i++)
    most = fmax(most, fabs(value_at(run, kind, i, 0)));
  return ROUNDING * most;
}

bool strut_run_panel_wanted(const strut_run_scene *run, int kind) {
  size_t items = items_of(run, kind);
  if (kind == STRUT_RUN_DRIVE) return items > 0;
  for (size_t i = 0; i < items; i++)
    if (liveliness(run, kind, i, 0) > least_range(run, kind)) return true;
  return false;
}

/* The liveliest items, in the scene's order. Returns how many. */
static size_t choose(const strut_run_scene *run, int kind, size_t first,
                     size_t chosen[MOST_CURVES]) {
  double lively[MOST_CURVES];
  size_t count = 0;
  for (size_t i = 0; i < items_of(run, kind); i++) {
    double value = liveliness(run, kind, i, first);
    size_t dullest = 0;
    if (!(value > least_range(run, kind)) && !(kind == STRUT_RUN_WAY && i == 0)) continue;
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

static bool fill(strut_run_scene *run, int kind, size_t first, panel *p) {
  size_t chosen[MOST_CURVES], frames = run->frames - first;
  double most = 0;
  p->count = choose(run, kind, first, chosen);
  for (size_t i = 0; i < p->count; i++) {
    double start = from_start(kind) ? value_at(run, kind, chosen[i], first) : 0;
    p->values[i] = strut_arena_allocate(&run->arena, frames, sizeof(double));
    if (!p->values[i]) return false;
    for (size_t f = 0; f < frames; f++) {
      p->values[i][f] = value_at(run, kind, chosen[i], first + f) - start;
      most = fmax(most, fabs(p->values[i][f]));
    }
    p->labels[i] = label_of(run, kind, chosen[i]);
  }
  if (kind == STRUT_RUN_WAY && p->count == 1) p->labels[0] = NULL;
  p->least = fmax(least_range(run, kind), from_start(kind) ? 0 : LEVEL * most);
  return true;
}

/* What drives a member at a time, beyond its rest length [m]. */
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
  const int32_t *node = run->model->scene->members[member].node;
  const double *q = strut_run_positions(run, f);
  return hypot(q[2 * node[1]] - q[2 * node[0]], q[2 * node[1] + 1] - q[2 * node[0] + 1]);
}

/* Rest lengths as they are driven, and lengths as they come, both from where they are at first. */
static bool fill_drive(strut_run_scene *run, size_t first, panel *p) {
  const strut_drive_table *drives = &run->model->drives;
  size_t frames = run->frames - first;
  for (int32_t i = 0; i < drives->count && p->count < 2 * MOST_DRIVEN; i++) {
    int32_t member = drives->member[i];
    const char *name = run->model->scene->members[member].name;
    if (!drives->first[i]) continue;
    for (int k = 0; k < 2; k++) {
      double *values = strut_arena_allocate(&run->arena, frames, sizeof *values);
      if (!values) return false;
      for (size_t f = 0; f < frames; f++)
        values[f] = k ? length_at(run, member, first + f) - length_at(run, member, first)
                      : driven_by(run, member, run->motion->time[first + f]);
      p->labels[p->count] =
          strut_arena_format(&run->arena, k ? "length of %s" : "rest length of %s", name);
      if (!p->labels[p->count]) return false;
      p->values[p->count++] = values;
    }
  }
  p->least = least_range(run, STRUT_RUN_DRIVE);
  return true;
}

/* The range of all curves, widened to what is worth seeing. */
static void find_range(const panel *p, size_t frames, int kind, strut_axis *axis) {
  for (size_t i = 0; i < p->count; i++)
    for (size_t f = 0; f < frames; f++) strut_axis_include(axis, p->values[i][f]);
  if (kind == STRUT_RUN_NORMALS) strut_axis_include(axis, 0);
  if (!(axis->low <= axis->high)) return;
  double missing = p->least - (axis->high - axis->low);
  if (missing > 0) axis->low -= 0.5 * missing, axis->high += 0.5 * missing;
  strut_axis_settle(axis, ROOM);
}

/* Long names are cut, so that the legend fits. */
static bool fit_labels(strut_run_scene *run, double width, panel *p) {
  char fitted[STRUT_FITTED_TEXT];
  for (size_t i = 0; i < p->count; i++) {
    if (!p->labels[i]) continue;
    strut_text_fit(run->ruler, p->labels[i], (strut_font){.size = 7.5}, width, 0, fitted);
    p->labels[i] = strut_arena_text(&run->arena, fitted, strlen(fitted));
    if (!p->labels[i]) return false;
  }
  return true;
}

strut_status strut_run_draw_panel(strut_run_scene *run, strut_canvas *canvas, strut_box box,
                                  int kind, size_t first) {
  static const char *const names[][2] = {
      [STRUT_RUN_WAY] = {"displacement", "m"},    [STRUT_RUN_NORMALS] = {"contact force", "N"},
      [STRUT_RUN_DRIVE] = {"change", "m"},        [STRUT_RUN_HEIGHTS] = {"height", "m"},
      [STRUT_RUN_FORCES] = {"member force", "N"}, [STRUT_RUN_ENERGIES] = {"energy change", "J"}};
  panel p = {.name = names[kind][0], .unit = names[kind][1]};
  size_t frames = run->frames - first;
  if (!(kind == STRUT_RUN_DRIVE ? fill_drive(run, first, &p) : fill(run, kind, first, &p)))
    return STRUT_NO_MEMORY;
  if (kind == STRUT_RUN_WAY && p.count == 1) p.name = "x displacement";
  if (!fit_labels(run, 0.4 * box.width, &p)) return STRUT_NO_MEMORY;
  strut_series series[MOST_CURVES];
  for (size_t i = 0; i < p.count; i++)
    series[i] = (strut_series){.label = p.labels[i],
                               .count = frames,
                               .x = run->motion->time + first,
                               .y = p.values[i],
                               .look = -1};
  const double *time = run->motion->time;
  strut_curves curves = {.x = {"time", "s", false, time[first], time[run->frames - 1]},
                         .y = {p.name, p.unit, false, (double)NAN, (double)NAN},
                         .series_count = p.count,
                         .series = series,
                         .cursor = (double)NAN};
  find_range(&p, frames, kind, &curves.y);
  return strut_draw_curves(canvas, box, &curves);
}

double strut_run_curves_height(strut_run_scene *run) {
  double height = 2 * STRUT_RUN_EDGE + STRUT_RUN_TITLE;
  for (int kind = 0; kind < STRUT_RUN_PANELS; kind++)
    if (strut_run_panel_wanted(run, kind)) height += CURVES_HEIGHT;
  return height;
}

strut_status strut_run_curves(strut_run_scene *run, strut_canvas *canvas) {
  strut_box box = {STRUT_RUN_EDGE, STRUT_RUN_EDGE + STRUT_RUN_TITLE,
                   run->figure->width - 2 * STRUT_RUN_EDGE, CURVES_HEIGHT};
  size_t drawn = 0;
  for (int kind = 0; kind < STRUT_RUN_PANELS; kind++) {
    if (!strut_run_panel_wanted(run, kind)) continue;
    strut_status status = strut_run_draw_panel(run, canvas, box, kind, 0);
    if (status != STRUT_OK) return status;
    box.y += CURVES_HEIGHT;
    drawn++;
  }
  strut_run_draw_title(run, canvas, drawn ? "all that was recorded" : "nothing changed", true);
  return STRUT_OK;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Curves of what was recorded: one kind of quantity in each panel. */
#include <math.h>

#include "engine/output/draw/curves.h"
#include "engine/output/figures/run_parts.h"

enum { MOST_CURVES = 6, CURVES_HEIGHT = 125, EDGE = 5, TITLE = 26 };

/* What a panel draws: some columns of an array. */
typedef struct quantity {
  const char *name, *unit;
  const double *values;  /* (frames, items * stride) */
  size_t items, stride, component;
} quantity;

static quantity quantity_of(const strut_run_scene *run, int panel) {
  const strut_trajectory *m = run->motion;
  switch (panel) {
    case STRUT_RUN_HEIGHTS:
      return (quantity){"height", "m", m->position, m->node_count, 2, 1};
    case STRUT_RUN_FORCES:
      return (quantity){"member force", "N", m->force, m->member_count, 1, 0};
    case STRUT_RUN_NORMALS:
      return (quantity){"contact force", "N", m->contact, m->contact_count, 2, 0};
    case STRUT_RUN_ENERGIES:
      return (quantity){"energy", "J", m->energy, 4, 1, 0};
    default:
      return (quantity){"displacement", "m", m->position, 1, 1, 0};
  }
}

static double value_at(const strut_run_scene *run, int panel, const quantity *what, size_t frame,
                       size_t item, size_t first) {
  if (panel == STRUT_RUN_WAY) return strut_run_measured(run, frame) - strut_run_measured(run, first);
  size_t row = panel == STRUT_RUN_ENERGIES ? STRUT_ENERGIES : what->items * what->stride;
  double value = what->values[frame * row + item * what->stride + what->component];
  if (panel != STRUT_RUN_HEIGHTS) return value;
  const strut_ground *ground = &run->model->scene->ground; /* above it, along its normal */
  const double *p = run->motion->position + 2 * (frame * run->motion->node_count + item);
  return (value - ground->height - tan(ground->slope) * p[0]) * cos(ground->slope);
}

static const char *label_of(const strut_run_scene *run, int panel, size_t item) {
  static const char *const energies[] = {"kinetic", "elastic", "gravity", "contact"};
  const strut_scene *scene = run->model->scene;
  if (panel == STRUT_RUN_HEIGHTS) return scene->nodes[item].name;
  if (panel == STRUT_RUN_FORCES) return scene->members[item].name;
  if (panel == STRUT_RUN_NORMALS) return scene->nodes[run->motion->contact_node[item]].name;
  return panel == STRUT_RUN_ENERGIES ? energies[item] : NULL;
}

/* How much a curve has to tell: how far it moves. */
static double liveliness(const strut_run_scene *run, int panel, const quantity *what, size_t item,
                         size_t first) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (size_t f = first; f < run->motion->frames; f++) {
    double value = value_at(run, panel, what, f, item, first);
    if (!isfinite(value)) continue;
    low = fmin(low, value);
    high = fmax(high, value);
  }
  if (panel == STRUT_RUN_NORMALS || panel == STRUT_RUN_ENERGIES) low = fmin(low, 0), high = fmax(high, 0);
  return high > low ? high - low : 0;
}

/* Contacts that heights are worth showing of. */
static bool touches(const strut_run_scene *run, size_t node) {
  for (size_t i = 0; i < run->motion->contact_count; i++)
    if ((size_t)run->motion->contact_node[i] == node) return true;
  return false;
}

bool strut_run_panel_wanted(const strut_run_scene *run, int panel) {
  quantity what = quantity_of(run, panel);
  if (!what.values || !what.items) return false;
  if (panel == STRUT_RUN_HEIGHTS && !run->model->scene->ground.present) return false;
  for (size_t i = 0; i < what.items; i++)
    if (liveliness(run, panel, &what, i, 0) > 0) return true;
  return false;
}

/* The liveliest items, in the scene's order. Returns how many. */
static size_t choose(const strut_run_scene *run, int panel, const quantity *what, size_t first,
                     size_t chosen[MOST_CURVES]) {
  double value[MOST_CURVES];
  size_t count = 0;
  for (size_t i = 0; i < what->items; i++) {
    double lively = liveliness(run, panel, what, i, first);
    if (!(lively > 0) || (panel == STRUT_RUN_HEIGHTS && !touches(run, i))) continue;
    size_t at = count;
    if (count == MOST_CURVES) { /* takes the place of the dullest */
      at = 0;
      for (size_t k = 1; k < count; k++)
        if (value[k] < value[at]) at = k;
      if (!(lively > value[at])) continue;
      for (size_t k = at; k + 1 < count; k++) chosen[k] = chosen[k + 1], value[k] = value[k + 1];
      at = count - 1;
    } else {
      count++;
    }
    chosen[at] = i;
    value[at] = lively;
  }
  return count;
}

strut_status strut_run_draw_panel(strut_run_scene *run, strut_canvas *canvas, strut_box box,
                                  int panel, size_t first) {
  quantity what = quantity_of(run, panel);
  size_t chosen[MOST_CURVES], frames = run->motion->frames - first;
  size_t count = choose(run, panel, &what, first, chosen);
  if (panel == STRUT_RUN_WAY) chosen[0] = 0, count = 1;
  strut_series series[MOST_CURVES];
  for (size_t i = 0; i < count; i++) {
    double *y = strut_arena_allocate(&run->arena, frames, sizeof *y);
    if (!y) return STRUT_NO_MEMORY;
    for (size_t f = 0; f < frames; f++)
      y[f] = value_at(run, panel, &what, first + f, chosen[i], first);
    series[i] = (strut_series){.label = label_of(run, panel, chosen[i]),
                               .count = frames,
                               .x = run->motion->time + first,
                               .y = y,
                               .look = -1};
  }
  const strut_curves curves = {.x = {"time", "s", false, NAN, NAN},
                               .y = {what.name, what.unit, false, NAN, NAN},
                               .series_count = count,
                               .series = series,
                               .cursor = NAN};
  return strut_draw_curves(canvas, box, &curves);
}

double strut_run_curves_height(strut_run_scene *run) {
  double height = 2 * EDGE + TITLE;
  for (int panel = 0; panel < STRUT_RUN_PANELS; panel++)
    height += strut_run_panel_wanted(run, panel) ? CURVES_HEIGHT : 0;
  return fmax(height, CURVES_HEIGHT);
}

strut_status strut_run_curves(strut_run_scene *run, strut_canvas *canvas) {
  strut_box box = {EDGE, EDGE, run->figure->width - 2 * EDGE, CURVES_HEIGHT};
  box.y += fmax(TITLE, strut_run_draw_title(run, canvas, box, "what was recorded"));
  for (int panel = 0; panel < STRUT_RUN_PANELS; panel++) {
    if (!strut_run_panel_wanted(run, panel)) continue;
    strut_status status = strut_run_draw_panel(run, canvas, box, panel, 0);
    if (status != STRUT_OK) return status;
    box.y += CURVES_HEIGHT;
  }
  return STRUT_OK;
}

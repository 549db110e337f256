/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/work_precision.h"

#include <math.h>
#include <string.h>

#include "engine/base/vec.h"

static bool diverged(const strut_saving *saving) { return !isfinite(saving->error); }

void strut_pareto_front(const strut_saving *saving, size_t count, bool *front) {
  for (size_t i = 0; i < count; i++) {
    front[i] = !diverged(&saving[i]) && saving[i].cost > 0;
    for (size_t k = 0; k < count && front[i]; k++) {
      bool no_worse = saving[k].cost <= saving[i].cost && saving[k].error <= saving[i].error;
      bool better = saving[k].cost < saving[i].cost || saving[k].error < saving[i].error;
      front[i] = diverged(&saving[k]) || !(no_worse && better);
    }
  }
}

/* The points of a group in their order, diverged ones last, off its line. */
static void add_group(strut_figure *figure, const strut_work_precision *precision, int group,
                      strut_panel *panel) {
  strut_series *series = strut_add_series(figure, panel, precision->groups[group]);
  series->look = group;
  series->markers = STRUT_MARKERS_ALL;
  for (int lost = 0; lost < 2; lost++)
    for (size_t i = 0; i < precision->count; i++) {
      const strut_saving *saving = &precision->bargains[i];
      if (saving->group != group || diverged(saving) != (lost == 1)) continue;
      strut_point *point = strut_add_point(figure, series, saving->cost, saving->error);
      point->low = saving->low, point->high = saving->high;
    }
}

/* The text beside a point of the front; with its group where other points have the same label. */
static const char *label_of(strut_figure *figure, const strut_work_precision *precision,
                            const strut_saving *own, const bool *front) {
  bool alike = false;
  for (size_t i = 0; i < precision->count; i++) {
    const strut_saving *other = &precision->bargains[i];
    alike = alike ||
            (other != own && front[i] && other->label && strcmp(other->label, own->label) == 0);
  }
  return strut_figure_text(figure, "%.60s%s%.60s", own->label, alike ? ", " : "",
                           alike ? precision->groups[own->group] : "");
}

/* The staircase of the front, by cost, and its labels. */
static void add_front(strut_figure *figure, const strut_work_precision *precision,
                      const bool *front, strut_panel *panel) {
  strut_series *stairs = strut_add_series(figure, panel, NULL);
  const strut_saving *last = NULL;
  stairs->pen = (strut_pen){.colour = strut_grey(0.6), .width = 3.2};
  for (size_t done = 0; done < precision->count; done++) {
    const strut_saving *next = NULL; /* of equal ones the first that was not yet drawn */
    for (size_t i = 0; i < precision->count; i++) {
      const strut_saving *saving = &precision->bargains[i];
      bool behind = front[i] && (!last || saving->cost > last->cost ||
                                 (saving->cost == last->cost && saving > last));
      if (behind && (!next || saving->cost < next->cost)) next = saving;
    }
    if (!next) break;
    if (last) strut_add_point(figure, stairs, next->cost, last->error);
    strut_add_point(figure, stairs, next->cost, next->error);
    last = next;
    if (!next->label) continue;
    strut_label *mark = strut_add_mark(figure, panel, next->cost, next->error,
                                       label_of(figure, precision, next, front));
    mark->angle = 1.25 * STRUT_PI; /* no better point can be there */
    mark->steady = 0.5;
  }
}

strut_panel *strut_add_work_precision(strut_figure *figure, const strut_work_precision *precision) {
  bool *front = strut_arena_allocate(&figure->arena, precision->count + 1, sizeof *front);
  strut_panel *panel = strut_add_panel(figure);
  panel->title = precision->title;
  panel->x = precision->cost;
  panel->y = precision->error;
  panel->x.logarithmic = panel->y.logarithmic = true;
  panel->room = 0.06;
  panel->lost = "diverged";
  figure->failed = figure->failed || !front;
  if (!front) return panel;
  strut_pareto_front(precision->bargains, precision->count, front);
  add_front(figure, precision, front, panel);
  for (size_t g = 0; g < precision->group_count; g++) add_group(figure, precision, (int)g, panel);
  return panel;
}

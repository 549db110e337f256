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

/* The text beside a point of the front; with its group where other points have the same label. */
static const char *label_of(strut_figure *figure, const strut_saving *own,
                            const strut_saving *savings, size_t count, const bool *front) {
  bool alike = false;
  for (size_t i = 0; i < count; i++)
    alike = alike || (own != &savings[i] && front[i] && savings[i].label &&
                      strcmp(savings[i].label, own->label) == 0);
  return strut_figure_text(figure, "%.60s%s%.60s", own->label, alike ? ", " : "",
                           alike ? own->group : "");
}

/* The staircase of the front, by cost, and its labels. */
static void add_front(strut_figure *figure, const strut_saving *savings, size_t count,
                      const bool *front, strut_panel *panel) {
  strut_series *stairs = strut_add_series(figure, panel, NULL);
  const strut_saving *last = NULL;
  stairs->pen = (strut_pen){.colour = strut_grey(0.6), .width = 3.2};
  for (size_t done = 0; done < count; done++) {
    const strut_saving *next = NULL; /* of equal ones the first that was not yet drawn */
    for (const strut_saving *s = savings; s < savings + count; s++) {
      bool behind = front[s - savings] &&
                    (!last || s->cost > last->cost || (s->cost == last->cost && s > last));
      if (behind && (!next || s->cost < next->cost)) next = s;
    }
    if (!next) break;
    if (last) strut_add_point(figure, stairs, next->cost, last->error);
    strut_add_point(figure, stairs, next->cost, next->error);
    last = next;
    if (!next->label) continue;
    strut_label *mark = strut_add_mark(figure, panel, next->cost, next->error,
                                       label_of(figure, next, savings, count, front));
    mark->angle = 1.25 * STRUT_PI; /* no better point can be there */
    mark->steady = 0.5;
  }
}

strut_panel *strut_add_work_precision(strut_figure *figure, strut_axis cost, strut_axis error,
                                      const strut_saving *savings, size_t count) {
  bool *front = strut_arena_allocate(&figure->arena, count + 1, sizeof *front);
  strut_panel *panel = strut_add_panel(figure);
  panel->x = cost;
  panel->y = error;
  panel->x.logarithmic = panel->y.logarithmic = true;
  panel->room = 0.06;
  panel->lost = "at the upper edge: diverged";
  figure->failed = figure->failed || !front;
  if (!front) return panel;
  strut_pareto_front(savings, count, front);
  add_front(figure, savings, count, front, panel);
  for (size_t i = 0, end, look = 0; i < count; i = end, look++) {
    strut_series *series = strut_add_series(figure, panel, savings[i].group);
    series->look = (int)look;
    series->markers = STRUT_MARKERS_ALL;
    for (end = i; end < count && strcmp(savings[end].group, savings[i].group) == 0; end++) {
      strut_point *point = strut_add_point(figure, series, savings[end].cost, savings[end].error);
      point->low = savings[end].low, point->high = savings[end].high;
    }
  }
  return panel;
}

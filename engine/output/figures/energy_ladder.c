/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/energy_ladder.h"

#include <math.h>
#include <stdio.h>

#include "engine/base/vec.h"

enum { ARC = 41, FEW = 4 };

static const double LEVEL = 0.3;          /* half the width of a level, in places */
static const double OUTLYING = 1.0 / 3.0; /* so many of the barriers may lie beyond the axis */

/* A ladder being filled in. */
typedef struct ladder {
  const strut_equilibria *all;
  const size_t *chosen; /* (count) states, in the order of their places */
  size_t count, top_count;
  double zero;  /* the lowest energy [J] */
  double *tops; /* heights of the barriers drawn */
  strut_figure *figure;
  strut_panel *panel;
} ladder;

/* The barrier between the states at two places: its top above zero, its height from either side [J]. */
typedef struct pass {
  bool known;
  double top, height[2]; /* NAN: not known from that side */
} pass;

static double level_energy(const ladder *self, size_t place) {
  return self->all->list[self->chosen[place]].energy - self->zero;
}

static pass find_pass(const ladder *self, size_t left, size_t right) {
  pass p = {.top = (double)NAN, .height = {(double)NAN, (double)NAN}};
  for (size_t i = 0; i < self->all->barrier_count; i++) {
    const strut_barrier *barrier = &self->all->barriers[i];
    size_t from = (size_t)barrier->from, to = (size_t)barrier->to;
    bool along = from == self->chosen[left] && to == self->chosen[right];
    bool back = from == self->chosen[right] && to == self->chosen[left];
    /* The direct pass where it is known, else the lowest path. */
    double height = isfinite(barrier->direct) ? barrier->direct : barrier->height;
    if ((!along && !back) || !isfinite(height)) continue;
    p.known = true;
    p.height[back] = height;
    if (along || isnan(p.top)) p.top = height + level_energy(self, along ? left : right);
  }
  return p;
}

bool strut_ladder_wanted(const strut_equilibria *all, const size_t *chosen, size_t count) {
  const ladder l = {.all = all, .chosen = chosen, .count = count};
  for (size_t left = 0; left < count; left++)
    for (size_t right = left + 1; right < count; right++)
      if (find_pass(&l, left, right).known) return true;
  return false;
}

/* A smooth curve from one level over the barrier to the other, which leaves the frame where it is higher. */
static void add_arc(ladder *self, strut_series *arcs, size_t left, size_t right, double top) {
  double most = self->panel->y.high;
  top = top <= most ? top : 1.3 * most;
  for (int i = 0; i < ARC; i++) {
    double t = (double)i / (ARC - 1), low = level_energy(self, t < 0.5 ? left : right);
    double rise = 0.5 - 0.5 * cos(STRUT_TAU * t); /* 0, 1, 0 */
    strut_add_point(self->figure, arcs,
                    (double)left + LEVEL + t * ((double)(right - left) - 2 * LEVEL),
                    low + rise * (top - low));
  }
  strut_add_gap(self->figure, arcs);
}

/* The heights from either side, above the top. */
static void name_pass(ladder *self, size_t left, const pass *p) {
  char text[2][80] = {"", ""};
  for (int back = 0; back < 2; back++)
    if (isfinite(p->height[back]))
      snprintf(text[back], sizeof text[back], back ? "\xe2\x86\x90 %s" : "%s \xe2\x86\x92",
               strut_drawn_quantity(p->height[back], 3, "J").text);
  strut_label *mark =
      strut_add_mark(self->figure, self->panel, (double)left + 0.5, p->top,
                     strut_figure_text(self->figure, "%s%s%s", text[0],
                                       text[0][0] && text[1][0] ? "\n" : "", text[1]));
  mark->gap = 2;
  mark->angle = 0.5 * STRUT_PI;
  mark->steady = mark->priority = 1;
}

/*
 * Gathers the tops of the barriers or, with a series, adds those between neighbours, or all others. Among many states,
 * only those between neighbours remain readable.
 */
static void add_passes(ladder *self, strut_series *arcs, bool far) {
  for (size_t left = 0; left < self->count; left++)
    for (size_t right = left + 1; right < self->count; right++) {
      if (right > left + 1 && self->count > FEW) continue;
      const pass p = find_pass(self, left, right);
      if (!p.known || (arcs && far != (right > left + 1))) continue;
      if (arcs) add_arc(self, arcs, left, right, p.top);
      if (arcs && !far) name_pass(self, left, &p);
      if (!arcs) self->tops[self->top_count++] = p.top;
    }
}

static void add_level(ladder *self, strut_series *levels, size_t place) {
  double x = (double)place, energy = level_energy(self, place);
  bool few = self->count <= FEW;
  strut_add_point(self->figure, levels, x - LEVEL, energy);
  strut_add_point(self->figure, levels, x + LEVEL, energy);
  strut_add_gap(self->figure, levels);
  strut_label *mark = strut_add_mark(self->figure, self->panel, x, energy,
                                     self->all->list[self->chosen[place]].name);
  mark->font.size = few ? 8 : 7, mark->font.bold = few;
  mark->gap = 3;
  mark->angle = -0.5 * STRUT_PI;
  mark->steady = 1;
  mark->priority = 2;
}

/* The energy axis, which leaves out single barriers far above all else. */
static strut_axis find_axis(ladder *self, strut_beyond *beyond) {
  strut_axis y = {.name = "energy above the lowest", .unit = "J", .low = 0.0, .high = 0.0};
  for (size_t k = 0; k < self->count; k++) strut_axis_include(&y, level_energy(self, k));
  strut_axis_include(
      &y, strut_limit_without_outliers(self->tops, self->top_count, y.high, OUTLYING, beyond));
  strut_axis_settle(&y, 0.2);
  return y;
}

strut_panel *strut_add_ladder(strut_figure *figure, const strut_equilibria *all,
                              const size_t *chosen, size_t count) {
  static const strut_pen pens[] = {
      {.colour = {0.35, 0.35, 0.35, 1}, .width = 0.9},
      {.colour = {0.65, 0.65, 0.65, 1}, .width = 0.6, .dash = {2.5, 2}},
      {.colour = {0, 96 / 255.0, 168 / 255.0, 1}, .width = 2, .butt = true}};
  static const char *const no_names[] = {NULL};
  ladder l = {.all = all, .chosen = chosen, .count = count, .zero = HUGE_VAL, .figure = figure};
  strut_beyond beyond = {0};
  char text[STRUT_BEYOND_TEXT];
  double wider = count > FEW ? 0.8 : 0.5; /* names are wider than their levels */
  for (size_t k = 0; k < count; k++) l.zero = fmin(l.zero, all->list[chosen[k]].energy);
  l.panel = strut_add_panel(figure);
  l.tops = strut_figure_numbers(figure, count * count);
  if (!l.tops) return l.panel;
  add_passes(&l, NULL, false);
  l.panel->x = (strut_axis){"", "", false, -wider, (double)count - 1 + wider, no_names, 0};
  l.panel->y = find_axis(&l, &beyond);
  for (int i = 0; i < 3; i++) {
    strut_series *series = strut_add_series(figure, l.panel, NULL);
    series->pen = pens[i];
    for (size_t k = 0; k < count && i == 2; k++) add_level(&l, series, k);
    if (i < 2) add_passes(&l, series, i == 1);
  }
  l.panel->remark =
      strut_figure_text(figure, "%s", strut_beyond_text(&beyond, "barrier", "J", text));
  return l.panel;
}

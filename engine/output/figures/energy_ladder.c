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
  size_t count;
  double zero;                         /* the lowest energy [J] */
  strut_series levels, arcs[2];        /* arcs between neighbours, and others */
  double *level[2], *arc[2][2], *tops; /* their x and y; heights of the barriers drawn */
  size_t top_count, mark_count;
  strut_mark *marks;
  strut_arena *arena;
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

static void add_point(strut_series *series, double *const columns[2], double x, double y) {
  columns[0][series->count] = x, columns[1][series->count++] = y;
}

/* A smooth curve from one level over the barrier to the other, which leaves the frame where it is higher. */
static void add_arc(ladder *self, size_t left, size_t right, double top, double most) {
  bool far = right > left + 1;
  top = top <= most ? top : 1.3 * most;
  for (int i = 0; i < ARC; i++) {
    double t = (double)i / (ARC - 1), low = level_energy(self, t < 0.5 ? left : right);
    double rise = 0.5 - 0.5 * cos(STRUT_TAU * t); /* 0, 1, 0 */
    add_point(&self->arcs[far], self->arc[far],
              (double)left + LEVEL + t * ((double)(right - left) - 2 * LEVEL),
              low + rise * (top - low));
  }
  add_point(&self->arcs[far], self->arc[far], (double)NAN, (double)NAN);
}

/* The heights from either side, above the top. */
static bool name_pass(ladder *self, size_t left, const pass *p) {
  char text[2][80] = {"", ""};
  for (int back = 0; back < 2; back++)
    if (isfinite(p->height[back]))
      snprintf(text[back], sizeof text[back], back ? "\xe2\x86\x90 %s" : "%s \xe2\x86\x92",
               strut_drawn_quantity(p->height[back], 3, "J").text);
  strut_mark *mark = &self->marks[self->mark_count++];
  *mark = (strut_mark){.at = {(double)left + 0.5, p->top},
                       .text = strut_arena_format(self->arena, "%s%s%s", text[0],
                                                  text[0][0] && text[1][0] ? "\n" : "", text[1]),
                       .gap = 2,
                       .angle = 0.5 * STRUT_PI,
                       .steady = 1,
                       .priority = 1};
  return mark->text != NULL;
}

/*
 * Gathers the tops of the barriers, or adds these below an axis that ends at `most`. Among many states, only those
 * between neighbours remain readable.
 */
static bool add_passes(ladder *self, const double *most) {
  bool fine = true;
  for (size_t left = 0; left < self->count; left++)
    for (size_t right = left + 1; right < self->count && fine; right++) {
      if (right > left + 1 && self->count > FEW) continue;
      const pass p = find_pass(self, left, right);
      if (!p.known) continue;
      if (most) add_arc(self, left, right, p.top, *most);
      if (most && right == left + 1) fine = name_pass(self, left, &p);
      if (!most) self->tops[self->top_count++] = p.top;
    }
  return fine;
}

static void add_level(ladder *self, size_t place) {
  double x = (double)place, energy = level_energy(self, place);
  bool few = self->count <= FEW;
  add_point(&self->levels, self->level, x - LEVEL, energy);
  add_point(&self->levels, self->level, x + LEVEL, energy);
  add_point(&self->levels, self->level, (double)NAN, (double)NAN);
  self->marks[self->mark_count++] = (strut_mark){.at = {x, energy},
                                                 .text = self->all->list[self->chosen[place]].name,
                                                 .font = {.size = few ? 8 : 7, .bold = few},
                                                 .gap = 3,
                                                 .angle = -0.5 * STRUT_PI,
                                                 .steady = 1,
                                                 .priority = 2};
}

static double *allocate_columns(strut_series *series, double *columns[2], size_t count,
                                strut_arena *arena) {
  columns[0] = strut_arena_allocate(arena, 2 * count + 2, sizeof **columns);
  if (columns[0]) columns[1] = columns[0] + count + 1;
  series->x = columns[0], series->y = columns[1];
  return columns[0];
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

bool strut_ladder_fill(const strut_equilibria *all, const size_t *chosen, size_t count,
                       strut_arena *arena, strut_panel *panel) {
  static const strut_pen pens[] = {
      {.colour = {0.35, 0.35, 0.35, 1}, .width = 0.9},
      {.colour = {0.65, 0.65, 0.65, 1}, .width = 0.6, .dash = {2.5, 2}},
      {.colour = {0, 96 / 255.0, 168 / 255.0, 1}, .width = 2, .butt = true}};
  static const char *const no_names[] = {NULL};
  ladder l = {.all = all, .chosen = chosen, .count = count, .zero = HUGE_VAL, .arena = arena};
  strut_series *series = strut_arena_allocate(arena, 3, sizeof *series);
  strut_beyond beyond = {0};
  char text[STRUT_BEYOND_TEXT];
  for (size_t k = 0; k < count; k++) l.zero = fmin(l.zero, all->list[chosen[k]].energy);
  l.marks = strut_arena_allocate(arena, 2 * count, sizeof *l.marks);
  l.tops = strut_arena_allocate(arena, count * count + 1, sizeof *l.tops);
  bool fine = series && l.marks && l.tops && allocate_columns(&l.levels, l.level, 3 * count, arena);
  for (int far = 0; far < 2 && fine; far++)
    fine = allocate_columns(&l.arcs[far], l.arc[far], (ARC + 1) * count * (far ? FEW : 1), arena);
  if (!fine) return false;
  add_passes(&l, NULL);
  strut_axis y = find_axis(&l, &beyond);
  if (!add_passes(&l, &y.high)) return false;
  for (size_t k = 0; k < count; k++) add_level(&l, k);
  for (int i = 0; i < 3; i++) {
    series[i] = i < 2 ? l.arcs[i] : l.levels;
    series[i].pen = &pens[i];
  }
  double wider = count > FEW ? 0.8 : 0.5; /* names are wider than their levels */
  *panel = (strut_panel){.x = {"", "", false, -wider, (double)count - 1 + wider, no_names, 0},
                         .y = y,
                         .series_count = 3,
                         .series = series,
                         .mark_count = l.mark_count,
                         .marks = l.marks};
  strut_beyond_text(&beyond, "barrier", "J", text);
  panel->remark = strut_arena_format(arena, "%s", text);
  return panel->remark != NULL;
}

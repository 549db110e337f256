/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>

#include "engine/base/vec.h"
#include "engine/output/draw/figure.h"
#include "engine/output/figures/statics_figures.h"

/* ---- the energy ladder: stable states as levels, with the barriers between them ---- */

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

/* True if there are barriers between some of the (count) chosen equilibria. */
static bool is_wanted(const strut_equilibria *all, const size_t *chosen, size_t count) {
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

/* Adds a panel with them as levels in the order given, and the barriers between them. */
static strut_panel *add_ladder(strut_figure *figure, const strut_equilibria *all,
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

/* ---- the figure ---- */

static const double COLLAPSED = 1.0 / 3.0; /* most of the cards with forces beyond the scale */
static const double ARROW = 20, MARGIN = 17, LEAST_MARGIN = 6, LADDER = 150; /* [pt] */
static const double ROUNDING = 1e-12; /* of the largest energy: written as zero */
enum { MOST_CARDS = 12, MOST_SMALL = 6 };

/* The equilibria that are drawn. */
typedef struct picture {
  const strut_model *model;
  const strut_equilibria *all;
  size_t *standing, standing_count; /* those that stand, and floppy ones, by energy */
  size_t floppy_count;              /* of these */
  size_t *aside, aside_count;       /* further stable ones, by energy */
  size_t cards, small;              /* drawn of both */
  double size[2], force_limit, contact_limit, largest_energy;
  strut_beyond beyond; /* force_limit */
  strut_figure figure;
} picture;

/* The shape drawn of an equilibrium: at rest on the real ground if it comes to rest as itself. */
static const double *drawn_shape(const picture *self, size_t i) {
  const strut_equilibrium *equilibrium = &self->all->list[i];
  return equilibrium->rest && equilibrium->ends_as == (int32_t)i ? equilibrium->rest
                                                                 : equilibrium->point.q;
}

/* Adds an index to those sorted by energy; equal ones keep the list's order. */
static void add_by_energy(const strut_equilibria *all, size_t *index, size_t *count, size_t added) {
  size_t k = (*count)++;
  for (; k > 0 && all->list[index[k - 1]].energy > all->list[added].energy; k--)
    index[k] = index[k - 1];
  index[k] = added;
}

static bool choose_equilibria(picture *self) {
  size_t count = self->all->count;
  self->standing = strut_arena_allocate(&self->figure.arena, count, sizeof *self->standing);
  self->aside = strut_arena_allocate(&self->figure.arena, count, sizeof *self->aside);
  if (!self->standing || !self->aside) return false;
  for (size_t i = 0; i < count; i++) {
    const strut_equilibrium *equilibrium = &self->all->list[i];
    bool floppy = equilibrium->outcome == STRUT_OUTCOME_FLOPPY;
    self->largest_energy = fmax(self->largest_energy, fabs(equilibrium->energy));
    if (equilibrium->point.label != STRUT_STABLE && equilibrium->point.label != STRUT_FLOPPY)
      continue;
    if (equilibrium->outcome == STRUT_OUTCOME_STANDS || floppy)
      add_by_energy(self->all, self->standing, &self->standing_count, i),
          self->floppy_count += floppy;
    else
      add_by_energy(self->all, self->aside, &self->aside_count, i);
  }
  self->cards = self->standing_count < MOST_CARDS ? self->standing_count : MOST_CARDS;
  self->small = self->aside_count < MOST_SMALL ? self->aside_count : MOST_SMALL;
  return true;
}

static strut_bounds bounds_of(const picture *self, size_t i) {
  strut_bounds b = strut_bounds_none();
  strut_bounds_add(&b, self->model, drawn_shape(self, i));
  return b;
}

/* The scales that all cards share: of forces but for collapsed states with far larger ones. */
static void find_scales(picture *self) {
  double most[MOST_CARDS] = {0};
  const size_t *shown = self->cards ? self->standing : self->aside;
  for (size_t k = 0; k < (self->cards ? self->cards : self->small); k++) {
    const strut_bounds b = bounds_of(self, shown[k]);
    for (int d = 0; d < 2; d++) self->size[d] = fmax(self->size[d], b.high[d] - b.low[d]);
  }
  for (size_t k = 0; k < self->cards; k++) {
    const strut_equilibrium *equilibrium = &self->all->list[self->standing[k]];
    most[k] = strut_largest(equilibrium->member_force, self->model->scene->member_count);
    self->contact_limit =
        fmax(self->contact_limit,
             strut_largest(equilibrium->normal, (size_t)equilibrium->contact_count));
  }
  self->force_limit =
      strut_limit_without_outliers(most, self->cards, 0.0, COLLAPSED, &self->beyond);
  self->beyond.below = self->beyond.above; /* of either sign */
}

/* Adds the panel of an equilibrium, without its shape. */
static strut_panel *add_panel(picture *self, size_t i, double margin) {
  const strut_equilibrium *equilibrium = &self->all->list[i];
  const strut_ground *ground = &self->model->scene->ground;
  bool zero = !(fabs(equilibrium->energy) > ROUNDING * self->largest_energy);
  strut_panel *panel = strut_add_panel(&self->figure);
  panel->bounds = bounds_of(self, i);
  if (ground->present && ground->slope == 0)
    panel->bounds.low[1] = fmin(panel->bounds.low[1], ground->height);
  strut_bounds_share(&panel->bounds, self->size);
  panel->margin = margin;
  panel->note = strut_figure_text(&self->figure, "%s, %s",
                                  strut_drawn_quantity(zero ? 0 : equilibrium->energy, 6, "J").text,
                                  equilibrium->verdict);
  return panel;
}

/* An equilibrium that stands, with the forces in it and of the ground. */
static void add_card(picture *self, size_t i) {
  const strut_equilibrium *equilibrium = &self->all->list[i];
  const strut_contact_table *contacts = &self->model->contacts;
  double *force = strut_figure_numbers(&self->figure, 2 * (size_t)contacts->count);
  for (int32_t k = 0; force && k < equilibrium->contact_count && equilibrium->normal; k++)
    for (int32_t c = 0; c < contacts->count; c++)
      if (contacts->entry[c].node == equilibrium->contacts[k])
        force[2 * c] = equilibrium->normal[k];
  strut_panel *panel = add_panel(self, i, MARGIN);
  panel->title = equilibrium->name;
  strut_shape *shape = strut_add_forces(&self->figure, panel, self->model, drawn_shape(self, i),
                                        equilibrium->member_force, self->force_limit);
  shape->names = true;
  shape->forces = (const double(*)[2])force;
  shape->force_limit = self->contact_limit;
  shape->arrow = ARROW;
}

/* Cards, their energies with the barriers, and the others small. */
static void add_panels(picture *self) {
  for (size_t k = 0; k < self->cards; k++) add_card(self, self->standing[k]);
  if (self->cards > 1 && is_wanted(self->all, self->standing, self->cards)) {
    strut_panel *panel = add_ladder(&self->figure, self->all, self->standing, self->cards);
    panel->height = LADDER;
    panel->whole = true;
  }
  for (size_t k = 0; k < self->small; k++) {
    strut_panel *panel = add_panel(self, self->aside[k], LEAST_MARGIN);
    strut_shape *shape =
        strut_add_ghost(&self->figure, panel, self->model, drawn_shape(self, self->aside[k]), 0.45);
    shape->style.thinness = 0.4;
    shape->style.no_supports = false;
    shape->ground = panel->small = true;
  }
}

static const char *describe_all(picture *self) {
  size_t stable = self->standing_count - self->floppy_count, floppy = self->floppy_count;
  bool few = self->small < self->aside_count;
  const char *aside = "";
  if (self->small)
    aside = strut_figure_text(
        &self->figure,
        "; small and grey: stable on static supports, but not at rest on the ground%s%.0zu%s",
        few ? " (the lowest of " : "", few ? self->aside_count : 0, few ? ")" : "");
  return strut_figure_text(
      &self->figure, "%zu stable equilibri%s%s%s%.0zu%s%s%s", stable, stable == 1 ? "um" : "a",
      self->model->scene->ground.present ? " on the ground" : "", floppy ? ", " : "", floppy,
      floppy ? " floppy" : "", self->cards < self->standing_count ? ", the lowest are drawn" : "",
      aside);
}

strut_status strut_equilibria_figure(const strut_plot *plot, const strut_model *model,
                                     const strut_equilibria *equilibria, strut_error *error) {
  picture p = {.model = model, .all = equilibria, .figure.title = model->scene->name};
  if (choose_equilibria(&p)) {
    find_scales(&p);
    add_panels(&p);
  } else {
    p.figure.failed = true;
  }
  p.figure.note = describe_all(&p);
  p.figure.yardstick = p.cards > 0;
  p.figure.scale = strut_force_scale(p.force_limit, &p.beyond);
  return strut_figure_draw(plot, &p.figure, error);
}

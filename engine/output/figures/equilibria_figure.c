/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>

#include "engine/output/draw/figure.h"
#include "engine/output/figures/energy_ladder.h"
#include "engine/output/figures/statics_figures.h"

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
  if (self->cards > 1 && strut_ladder_wanted(self->all, self->standing, self->cards)) {
    strut_panel *ladder = strut_add_ladder(&self->figure, self->all, self->standing, self->cards);
    ladder->height = LADDER;
    ladder->whole = true;
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

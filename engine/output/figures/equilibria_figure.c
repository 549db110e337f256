/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>

#include "engine/output/draw/figure.h"
#include "engine/output/figures/energy_ladder.h"
#include "engine/output/figures/statics_figures.h"

static const double COLLAPSED = 1.0 / 3.0; /* most of the cards with forces beyond the scale */
static const double ARROW = 20, MARGIN = 17, LEAST_MARGIN = 6, LADDER = 150; /* [pt] */
static const double ROUNDING = 1e-12; /* of the largest energy: written as zero */
enum { MOST_CARDS = 12, MOST_SMALL = 6, PANELS = MOST_CARDS + MOST_SMALL + 1, NOTE = 300 };

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
  size_t panel_count;
  strut_panel panels[PANELS];
  strut_view views[PANELS];
  strut_shape shapes[PANELS];
  char texts[PANELS][NOTE];
  strut_arena arena;
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
  self->standing = strut_arena_allocate(&self->arena, count, sizeof *self->standing);
  self->aside = strut_arena_allocate(&self->arena, count, sizeof *self->aside);
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
    for (size_t j = 0; j < self->model->scene->member_count; j++)
      most[k] = fmax(most[k], fabs(equilibrium->member_force[j]));
    for (int32_t i = 0; i < equilibrium->contact_count && equilibrium->normal; i++)
      self->contact_limit = fmax(self->contact_limit, fabs(equilibrium->normal[i]));
  }
  self->force_limit =
      strut_limit_without_outliers(most, self->cards, 0.0, COLLAPSED, &self->beyond);
  self->beyond.below = self->beyond.above; /* of either sign */
}

/* As large as all others, about the shape's middle, from the ground or its foot on. */
static strut_bounds shared_bounds(const picture *self, size_t i) {
  const strut_ground *ground = &self->model->scene->ground;
  strut_bounds b = bounds_of(self, i);
  double middle = 0.5 * (b.low[0] + b.high[0]);
  if (ground->present && ground->slope == 0) b.low[1] = fmin(b.low[1], ground->height);
  for (int side = -1; side <= 1; side += 2)
    (side < 0 ? b.low : b.high)[0] = middle + side * 0.5 * self->size[0];
  b.high[1] = b.low[1] + self->size[1];
  return b;
}

/* The panel of an equilibrium. */
static strut_shape *add_panel(picture *self, size_t i, double margin) {
  const strut_equilibrium *equilibrium = &self->all->list[i];
  size_t k = self->panel_count++;
  double energy =
      fabs(equilibrium->energy) > ROUNDING * self->largest_energy ? equilibrium->energy : 0;
  self->shapes[k] = (strut_shape){.model = self->model, .q = drawn_shape(self, i), .ground = true};
  self->views[k] = (strut_view){.shape_count = 1,
                                .shapes = &self->shapes[k],
                                .bounds = shared_bounds(self, i),
                                .margin = margin};
  self->panels[k] = (strut_panel){.note = self->texts[k], .view = &self->views[k]};
  snprintf(self->texts[k], NOTE, "%s, %s", strut_drawn_quantity(energy, 6, "J").text,
           equilibrium->verdict);
  return &self->shapes[k];
}

/* An equilibrium that stands, with the forces in it and of the ground. False: out of memory. */
static bool add_card(picture *self, size_t i) {
  const strut_equilibrium *equilibrium = &self->all->list[i];
  const strut_contact_table *contacts = &self->model->contacts;
  double(*force)[2] =
      strut_arena_allocate(&self->arena, (size_t)contacts->count + 1, sizeof *force);
  for (int32_t k = 0; force && k < equilibrium->contact_count && equilibrium->normal; k++)
    for (int32_t c = 0; c < contacts->count; c++)
      if (contacts->entry[c].node == equilibrium->contacts[k]) force[c][0] = equilibrium->normal[k];
  strut_shape *shape = add_panel(self, i, MARGIN);
  self->panels[self->panel_count - 1].title = equilibrium->name;
  shape->style = (strut_structure_style){.colouring = STRUT_COLOUR_FORCE,
                                         .values = equilibrium->member_force,
                                         .slack_forces = equilibrium->member_force,
                                         .limit = self->force_limit};
  shape->names = true;
  shape->forces = (const double(*)[2])force;
  shape->force_limit = self->contact_limit;
  shape->arrow = ARROW;
  return force != NULL;
}

/* Cards, their energies with the barriers, and the others small. False: out of memory. */
static bool add_panels(picture *self) {
  for (size_t k = 0; k < self->cards; k++)
    if (!add_card(self, self->standing[k])) return false;
  if (self->cards > 1 && strut_ladder_wanted(self->all, self->standing, self->cards)) {
    strut_panel *ladder = &self->panels[self->panel_count++];
    if (!strut_ladder_fill(self->all, self->standing, self->cards, &self->arena, ladder))
      return false;
    ladder->height = LADDER;
    ladder->whole = true;
  }
  for (size_t k = 0; k < self->small; k++) {
    add_panel(self, self->aside[k], LEAST_MARGIN)->style =
        (strut_structure_style){.colouring = STRUT_COLOUR_ONE,
                                .colour = strut_grey(0.45),
                                .thinness = 0.4,
                                .no_nodes = true};
    self->panels[self->panel_count - 1].small = true;
  }
  return true;
}

static void describe_all(const picture *self, char text[NOTE]) {
  size_t stable = self->standing_count - self->floppy_count;
  char floppy[40] = "", aside[200] = "";
  if (self->floppy_count) snprintf(floppy, sizeof floppy, ", %zu floppy", self->floppy_count);
  if (self->small)
    snprintf(aside, sizeof aside,
             "; small and grey: stable on static supports, but not at rest on the ground%s%.0zu%s",
             self->small < self->aside_count ? " (the lowest of " : "",
             self->small < self->aside_count ? self->aside_count : 0,
             self->small < self->aside_count ? ")" : "");
  snprintf(text, NOTE, "%zu stable equilibri%s%s%s%s%s", stable, stable == 1 ? "um" : "a",
           self->model->scene->ground.present ? " on the ground" : "", floppy,
           self->cards < self->standing_count ? ", the lowest are drawn" : "", aside);
}

strut_status strut_equilibria_figure(const strut_plot *plot, const strut_model *model,
                                     const strut_equilibria *equilibria, strut_error *error) {
  picture p = {.model = model, .all = equilibria};
  char note[NOTE];
  bool good = choose_equilibria(&p);
  if (good) find_scales(&p);
  good = good && add_panels(&p);
  describe_all(&p, note);
  const strut_figure figure = {.title = model->scene->name,
                               .note = note,
                               .panel_count = p.panel_count,
                               .panels = p.panels,
                               .yardstick = p.cards > 0,
                               .scale = {p.force_limit > 0 ? "force" : NULL, "N", -p.force_limit,
                                         p.force_limit, STRUT_COLOURS_SIGNED, p.beyond}};
  strut_status status =
      good ? strut_figure_draw(plot, &figure, error) : strut_no_memory(error, "while drawing");
  strut_arena_free(&p.arena);
  return status;
}

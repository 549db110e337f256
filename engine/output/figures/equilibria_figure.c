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
static const double *drawn_shape(const picture *p, size_t i) {
  const strut_equilibrium *e = &p->all->list[i];
  return e->rest && e->ends_as == (int32_t)i ? e->rest : e->point.q;
}

/* Adds an index to those sorted by energy; equal ones keep the list's order. */
static void add_by_energy(const strut_equilibria *all, size_t *index, size_t *count, size_t added) {
  size_t k = (*count)++;
  for (; k > 0 && all->list[index[k - 1]].energy > all->list[added].energy; k--)
    index[k] = index[k - 1];
  index[k] = added;
}

static bool choose_equilibria(picture *p) {
  size_t count = p->all->count;
  p->standing = strut_arena_allocate(&p->arena, count, sizeof *p->standing);
  p->aside = strut_arena_allocate(&p->arena, count, sizeof *p->aside);
  if (!p->standing || !p->aside) return false;
  for (size_t i = 0; i < count; i++) {
    const strut_equilibrium *e = &p->all->list[i];
    bool floppy = e->outcome == STRUT_OUTCOME_FLOPPY;
    p->largest_energy = fmax(p->largest_energy, fabs(e->energy));
    if (e->point.label != STRUT_STABLE && e->point.label != STRUT_FLOPPY) continue;
    if (e->outcome == STRUT_OUTCOME_STANDS || floppy)
      add_by_energy(p->all, p->standing, &p->standing_count, i), p->floppy_count += floppy;
    else
      add_by_energy(p->all, p->aside, &p->aside_count, i);
  }
  p->cards = p->standing_count < MOST_CARDS ? p->standing_count : MOST_CARDS;
  p->small = p->aside_count < MOST_SMALL ? p->aside_count : MOST_SMALL;
  return true;
}

static strut_bounds bounds_of(const picture *p, size_t i) {
  strut_bounds b = strut_bounds_none();
  strut_bounds_add(&b, p->model, drawn_shape(p, i));
  return b;
}

/* The scales that all cards share: of forces but for collapsed states with far larger ones. */
static void find_scales(picture *p) {
  double most[MOST_CARDS] = {0};
  const size_t *shown = p->cards ? p->standing : p->aside;
  for (size_t k = 0; k < (p->cards ? p->cards : p->small); k++) {
    const strut_bounds b = bounds_of(p, shown[k]);
    for (int d = 0; d < 2; d++) p->size[d] = fmax(p->size[d], b.high[d] - b.low[d]);
  }
  for (size_t k = 0; k < p->cards; k++) {
    const strut_equilibrium *e = &p->all->list[p->standing[k]];
    for (size_t j = 0; j < p->model->scene->member_count; j++)
      most[k] = fmax(most[k], fabs(e->member_force[j]));
    for (int32_t i = 0; i < e->contact_count && e->normal; i++)
      p->contact_limit = fmax(p->contact_limit, fabs(e->normal[i]));
  }
  p->force_limit = strut_limit_without_outliers(most, p->cards, 0.0, COLLAPSED, &p->beyond);
  p->beyond.below = p->beyond.above; /* of either sign */
}

/* As large as all others, about the shape's middle, from the ground or its foot on. */
static strut_bounds shared_bounds(const picture *p, size_t i) {
  const strut_ground *ground = &p->model->scene->ground;
  strut_bounds b = bounds_of(p, i);
  double middle = 0.5 * (b.low[0] + b.high[0]);
  if (ground->present && ground->slope == 0) b.low[1] = fmin(b.low[1], ground->height);
  for (int side = -1; side <= 1; side += 2)
    (side < 0 ? b.low : b.high)[0] = middle + side * 0.5 * p->size[0];
  b.high[1] = b.low[1] + p->size[1];
  return b;
}

/* The panel of an equilibrium. */
static strut_shape *add_panel(picture *p, size_t i, double margin) {
  const strut_equilibrium *e = &p->all->list[i];
  size_t k = p->panel_count++;
  double energy = fabs(e->energy) > ROUNDING * p->largest_energy ? e->energy : 0;
  p->shapes[k] = (strut_shape){.model = p->model, .q = drawn_shape(p, i), .ground = true};
  p->views[k] = (strut_view){
      .shape_count = 1, .shapes = &p->shapes[k], .bounds = shared_bounds(p, i), .margin = margin};
  p->panels[k] = (strut_panel){.note = p->texts[k], .view = &p->views[k]};
  snprintf(p->texts[k], NOTE, "%s, %s", strut_drawn_quantity(energy, 6, "J").text, e->verdict);
  return &p->shapes[k];
}

/* An equilibrium that stands, with the forces in it and of the ground. False: out of memory. */
static bool add_card(picture *p, size_t i) {
  const strut_equilibrium *e = &p->all->list[i];
  const strut_contact_table *contacts = &p->model->contacts;
  double(*force)[2] = strut_arena_allocate(&p->arena, (size_t)contacts->count + 1, sizeof *force);
  for (int32_t k = 0; force && k < e->contact_count && e->normal; k++)
    for (int32_t c = 0; c < contacts->count; c++)
      if (contacts->entry[c].node == e->contacts[k]) force[c][0] = e->normal[k];
  strut_shape *shape = add_panel(p, i, MARGIN);
  p->panels[p->panel_count - 1].title = e->name;
  shape->style = (strut_structure_style){.colouring = STRUT_COLOUR_FORCE,
                                         .values = e->member_force,
                                         .slack_forces = e->member_force,
                                         .limit = p->force_limit};
  shape->names = true;
  shape->forces = (const double(*)[2])force;
  shape->force_limit = p->contact_limit;
  shape->arrow = ARROW;
  return force != NULL;
}

/* Cards, their energies with the barriers, and the others small. False: out of memory. */
static bool add_panels(picture *p) {
  for (size_t k = 0; k < p->cards; k++)
    if (!add_card(p, p->standing[k])) return false;
  if (p->cards > 1 && strut_ladder_wanted(p->all, p->standing, p->cards)) {
    strut_panel *ladder = &p->panels[p->panel_count++];
    if (!strut_ladder_fill(p->all, p->standing, p->cards, &p->arena, ladder)) return false;
    ladder->height = LADDER;
    ladder->whole = true;
  }
  for (size_t k = 0; k < p->small; k++) {
    add_panel(p, p->aside[k], LEAST_MARGIN)->style =
        (strut_structure_style){.colouring = STRUT_COLOUR_ONE,
                                .colour = strut_grey(0.45),
                                .thinness = 0.4,
                                .no_nodes = true};
    p->panels[p->panel_count - 1].small = true;
  }
  return true;
}

static void describe_all(const picture *p, char text[NOTE]) {
  size_t stable = p->standing_count - p->floppy_count;
  char floppy[40] = "", aside[200] = "";
  if (p->floppy_count) snprintf(floppy, sizeof floppy, ", %zu floppy", p->floppy_count);
  if (p->small)
    snprintf(aside, sizeof aside,
             "; small and grey: stable on static supports, but not at rest on the ground%s%.0zu%s",
             p->small < p->aside_count ? " (the lowest of " : "",
             p->small < p->aside_count ? p->aside_count : 0, p->small < p->aside_count ? ")" : "");
  snprintf(text, NOTE, "%zu stable equilibri%s%s%s%s%s", stable, stable == 1 ? "um" : "a",
           p->model->scene->ground.present ? " on the ground" : "", floppy,
           p->cards < p->standing_count ? ", the lowest are drawn" : "", aside);
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

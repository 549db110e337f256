/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Equilibria as cards; their energies as a ladder of levels with the barriers between them. */
#include <math.h>

#include "engine/base/vec.h"
#include "engine/output/draw/figure.h"
#include "engine/output/figures/statics_figures.h"

enum { MOST_CARDS = 12, ARC = 41, FEW = 4 };

static const double COLLAPSED = 1.0 / 3.0;     /* most of the cards with forces beyond the scale */
static const double MARGIN = 17, LADDER = 150; /* [pt] */
static const double ROUNDING = 1e-12;          /* of the largest energy: written as zero */
static const double LEVEL = 0.3;               /* half the width of a level, in places */
static const double OUTLYING = 1.0 / 3.0;      /* so many of the barriers may lie beyond the axis */

typedef struct picture {
  const strut_model *model;
  const strut_equilibria *all;
  size_t *list, count, cards; /* by energy: those that stand, and floppy ones; drawn */
  size_t floppy, aside;       /* of these; other stable ones, */
  bool none;                  /* which are drawn if none stands */
  double size[2], force_limit, largest_energy;
  strut_beyond beyond; /* force_limit */
  strut_figure figure;
} picture;

static const strut_equilibrium *card_of(const picture *self, size_t place) {
  return &self->all->list[self->list[place]];
}

/* ---- the ladder ---- */

/* From card to card [J]: the direct pass where it is known, else the lowest path; NAN: not known. */
static double find_height(const picture *self, size_t from, size_t to) {
  double height = (double)NAN;
  for (size_t i = 0; i < self->all->barrier_count; i++) {
    const strut_barrier *b = &self->all->barriers[i];
    if ((size_t)b->from == self->list[from] && (size_t)b->to == self->list[to])
      height = isfinite(b->direct) ? b->direct : b->height;
  }
  return height;
}

/* The top of the barrier between a card and the next [J], NAN: none; and its heights from either side. */
static double find_pass(picture *self, size_t k, const double *level, const char **text) {
  double up = find_height(self, k, k + 1), down = find_height(self, k + 1, k);
  bool one = isfinite(up), two = isfinite(down);
  *text = strut_figure_text(
      &self->figure, "%s%s%s%s%s", one ? strut_quantity_of(up, 3, "J").text : "",
      one ? " \xe2\x86\x92" : "", one && two ? "\n" : "", two ? "\xe2\x86\x90 " : "",
      two ? strut_quantity_of(down, 3, "J").text : "");
  return one ? level[k] + up : level[k + 1] + down;
}

/* Its curve from level to level, smooth, which leaves the frame where it is higher than that. */
static void add_arc(picture *self, strut_panel *panel, size_t k, const double *level, double top) {
  const strut_pen pen = {.colour = strut_grey(0.35), .width = 0.9};
  strut_series *arc = strut_add_line(&self->figure, panel, STRUT_SERIES_LINE, pen);
  for (int i = 0; i < ARC; i++) {
    double t = (double)i / (ARC - 1), low = level[k + (t >= 0.5)];
    double rise = 0.5 - 0.5 * cos(STRUT_TAU * t); /* 0, 1, 0 */
    strut_add_point(&self->figure, arc, (double)k + LEVEL + t * (1 - 2 * LEVEL),
                    low + rise * (top - low));
  }
}

static void add_name(picture *self, strut_panel *panel, double x, double y, const char *text,
                     bool level) {
  strut_label *mark = strut_add_mark(&self->figure, panel, x, y, text);
  bool large = level && self->cards <= FEW;
  mark->font.size = large ? 8 : 7, mark->font.bold = large;
  mark->gap = level ? 3 : 2;
  mark->angle = (level ? -0.5 : 0.5) * STRUT_PI;
  mark->steady = 1;
  mark->priority = level ? 2 : 1;
}

/* Adds a panel with the cards as levels and barriers between neighbours, of which few far above all leave the axis. */
static void add_ladder(picture *self) {
  static const char *const no_names[] = {NULL};
  const size_t cards = self->cards;
  const double wider = cards > FEW ? 0.8 : 0.5; /* names are wider than levels */
  double level[MOST_CARDS], top[MOST_CARDS] = {0}, sorted[MOST_CARDS], range[2] = {0, 0};
  const char *heights[MOST_CARDS];
  char text[STRUT_BEYOND_TEXT];
  size_t known = 0;
  for (size_t k = 0; k < cards; k++) level[k] = card_of(self, k)->energy - card_of(self, 0)->energy;
  for (size_t k = 0; k + 1 < cards; k++)
    if (isfinite(top[k] = find_pass(self, k, level, &heights[k]))) sorted[known++] = top[k];
  if (!known) return;
  range[1] = level[cards - 1];
  const strut_beyond beyond = strut_leave_out(sorted, known, OUTLYING, range);
  strut_panel *panel = strut_add_panel(&self->figure);
  panel->height = LADDER;
  panel->whole = true;
  panel->x = (strut_axis){.low = -wider, .high = (double)cards - 1 + wider, .names = no_names};
  panel->y = (strut_axis){"energy above the lowest", "J", .low = range[0], .high = range[1]};
  strut_axis_settle(&panel->y, 0.2);
  for (size_t k = 0; k + 1 < cards; k++) {
    if (!isfinite(top[k])) continue;
    double most = panel->y.high;
    add_arc(self, panel, k, level, top[k] <= most ? top[k] : 1.3 * most);
    add_name(self, panel, (double)k + 0.5, top[k], heights[k], false);
  }
  for (size_t k = 0; k < cards; k++) {
    const strut_pen pen = {.colour = strut_palette_thing(0), .width = 2, .butt = true};
    double x = (double)k;
    strut_add_segment(&self->figure, panel, STRUT_SERIES_LINE, pen,
                      (const double[2]){x - LEVEL, level[k]},
                      (const double[2]){x + LEVEL, level[k]});
    add_name(self, panel, x, level[k], card_of(self, k)->name, true);
  }
  panel->note = strut_figure_text(
      &self->figure, "%s", strut_beyond_text(&beyond, "barrier", "J", (strut_file_unit){0}, text));
}

/* ---- cards ---- */

/* The shape drawn of an equilibrium: at rest on the real ground if it comes to rest as itself. */
static const double *drawn_shape(const picture *self, size_t i) {
  const strut_equilibrium *equilibrium = &self->all->list[i];
  return equilibrium->rest && equilibrium->ends_as == (int32_t)i ? equilibrium->rest
                                                                 : equilibrium->point.q;
}

/* Adds an index to those sorted by energy; equal ones keep the list's order. */
static void add_by_energy(picture *self, size_t added) {
  const strut_equilibrium *all = self->all->list;
  size_t k = self->count++;
  for (; k > 0 && all[self->list[k - 1]].energy > all[added].energy; k--)
    self->list[k] = self->list[k - 1];
  self->list[k] = added;
}

/* Those that stand; where none does, all that are stable. */
static void choose_equilibria(picture *self) {
  self->list = strut_arena_allocate(&self->figure.arena, self->all->count, sizeof *self->list);
  self->figure.failed = !self->list;
  for (int all = 0; all < 2 && self->list && !self->count; all++) {
    self->aside = 0;
    self->none = all;
    for (size_t i = 0; i < self->all->count; i++) {
      const strut_equilibrium *equilibrium = &self->all->list[i];
      bool floppy = equilibrium->outcome == STRUT_OUTCOME_FLOPPY;
      self->largest_energy = fmax(self->largest_energy, fabs(equilibrium->energy));
      if (equilibrium->point.label != STRUT_STABLE && equilibrium->point.label != STRUT_FLOPPY)
        continue;
      bool stands = equilibrium->outcome == STRUT_OUTCOME_STANDS || floppy;
      self->floppy += floppy, self->aside += !stands;
      if (stands || all) add_by_energy(self, i);
    }
  }
  self->cards = self->count < MOST_CARDS ? self->count : MOST_CARDS;
}

/* The scales that all cards share: of forces but for collapsed states with far larger ones. */
static void find_scales(picture *self) {
  double most[MOST_CARDS] = {0};
  for (size_t k = 0; k < self->cards; k++) {
    const strut_equilibrium *card = card_of(self, k);
    const strut_bounds b = strut_bounds_of(self->model, drawn_shape(self, self->list[k]));
    for (int d = 0; d < 2; d++) self->size[d] = fmax(self->size[d], b.high[d] - b.low[d]);
    most[k] = strut_largest(card->member_force, self->model->scene->member_count);
  }
  double range[2] = {0, 0};
  self->beyond = strut_leave_out(most, self->cards, COLLAPSED, range);
  self->force_limit = range[1];
  self->beyond.below = self->beyond.above; /* of either sign */
}

/* An equilibrium that stands, with the forces in it and of the ground. */
static void add_card(picture *self, size_t i) {
  const strut_equilibrium *card = &self->all->list[i];
  const strut_contact_table *contacts = &self->model->contacts;
  const strut_ground *ground = &self->model->scene->ground;
  bool zero = !(fabs(card->energy) > ROUNDING * self->largest_energy);
  double *force = strut_figure_numbers(&self->figure, NULL, 2 * (size_t)contacts->count);
  for (int32_t k = 0; force && k < card->contact_count && card->normal; k++)
    for (int32_t c = 0; c < contacts->count; c++)
      if (contacts->entry[c].node == card->contacts[k]) force[2 * c] = card->normal[k];
  strut_panel *panel = strut_add_panel(&self->figure);
  panel->title = card->name;
  panel->note =
      strut_figure_text(&self->figure, "%s, %s",
                        strut_quantity_of(zero ? 0 : card->energy, 6, "J").text, card->verdict);
  panel->bounds = strut_bounds_of(self->model, drawn_shape(self, i));
  if (ground->present && ground->slope == 0)
    panel->bounds.low[1] = fmin(panel->bounds.low[1], ground->height);
  strut_bounds_share(&panel->bounds, self->size);
  panel->margin = MARGIN;
  strut_shape *shape = strut_add_forces(&self->figure, panel, self->model, drawn_shape(self, i),
                                        card->member_force, self->force_limit);
  shape->names = true;
  shape->forces = (const double(*)[2])force;
}

static const char *describe_all(picture *self) {
  strut_figure *figure = &self->figure;
  size_t stable = self->count - self->floppy, few = self->cards < self->count;
  const char *text =
      strut_figure_text(figure, "%zu stable equilibri%s%s", stable, stable == 1 ? "um" : "a",
                        self->model->scene->ground.present && !self->none ? " on the ground" : "");
  if (self->floppy) text = strut_figure_text(figure, "%s, %zu floppy", text, self->floppy);
  if (few) text = strut_figure_text(figure, "%s, the lowest are drawn", text);
  if (!self->aside || self->none)
    return self->none ? strut_figure_text(figure, "%s, none at rest on the ground", text) : text;
  return strut_figure_text(figure, "%s; %zu more are stable, but not at rest on the ground", text,
                           self->aside);
}

strut_status strut_equilibria_figure(const strut_plot *plot, const strut_model *model,
                                     const strut_equilibria *equilibria, strut_error *error) {
  picture p = {.model = model, .all = equilibria, .figure.title = model->scene->name};
  choose_equilibria(&p);
  find_scales(&p);
  for (size_t k = 0; k < p.cards; k++) add_card(&p, p.list[k]);
  add_ladder(&p);
  p.figure.note = describe_all(&p);
  p.figure.yardstick = p.cards > 0;
  p.figure.scale = strut_force_scale(p.force_limit, &p.beyond);
  return strut_figure_draw(plot, &p.figure, error);
}

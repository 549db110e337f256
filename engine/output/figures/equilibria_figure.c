/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "engine/model/pose.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/draw/chart.h"
#include "engine/output/draw/legend.h"
#include "engine/output/draw/painter.h"
#include "engine/output/draw/structure.h"
#include "engine/output/figures/energy_ladder.h"
#include "engine/output/figures/statics_figures.h"

static bool on_ground(const strut_equilibrium *e) { return e->rest != NULL; }

/* The shape drawn of an equilibrium: at rest on the real ground if it comes to rest as itself. */
static const double *drawn_shape(const strut_equilibria *all, size_t i) {
  assert(i < all->count);
  const strut_equilibrium *e = &all->list[i];
  return on_ground(e) && e->ends_as == (int32_t)i ? e->rest : e->point.q;
}

/* The energy that all outputs list of an equilibrium [J]. */
static double drawn_energy(const strut_equilibria *all, size_t i) { return all->list[i].energy; }

static const double COLLAPSED = 1.0 / 3.0; /* most of the cards with forces beyond the scale */
static const double ARROW = 20;            /* the longest force of the ground [pt] */
static const double EDGE = 5, NAME_LINE = 12, MARGIN = 17, NARROW = 110, SCALE = 34, LADDER = 150;
enum { MOST_CARDS = 12, MOST_SMALL = 6, NOTE = 300 };

/* The equilibria that are drawn, and the sizes of their cards. */
typedef struct plan {
  const char *title;
  const strut_model *model;
  const strut_equilibria *all;
  size_t *standing, standing_count; /* those that stand, and floppy ones, by energy */
  size_t floppy_count;              /* of these */
  size_t *aside, aside_count;       /* further stable ones, by energy */
  size_t cards, columns, small, small_columns;
  double width, size[2], cell[2], small_cell[2], force_limit, contact_limit, largest_energy;
  strut_beyond beyond; /* force_limit */
  bool ladder;
  strut_heading heading;
  double head; /* its height [pt] */
  double card_head, small_foot,
      aside_line; /* heights of texts: above cards, below small ones, between [pt] */
  char aside_text[NOTE];
  strut_canvas *ruler; /* to measure texts before there is a page */
  strut_arena arena;
} plan;

/* Rounding noise of an energy is written as zero. */
static double drop_rounding(const plan *p, double energy) {
  return fabs(energy) > 1e-12 * p->largest_energy ? energy : 0;
}

/* Sorts indices by energy; equal ones keep the list's order. */
static void by_energy(const strut_equilibria *all, size_t *index, size_t count) {
  for (size_t i = 1; i < count; i++) {
    size_t moved = index[i], k = i;
    for (; k > 0 && drawn_energy(all, index[k - 1]) > drawn_energy(all, moved); k--)
      index[k] = index[k - 1];
    index[k] = moved;
  }
}

static bool is_stable(const strut_equilibrium *e) {
  return e->point.label == STRUT_STABLE || e->point.label == STRUT_FLOPPY;
}

static bool choose_equilibria(plan *p) {
  size_t count = p->all->count;
  p->standing = strut_arena_allocate(&p->arena, count, sizeof *p->standing);
  p->aside = strut_arena_allocate(&p->arena, count, sizeof *p->aside);
  if (!p->standing || !p->aside) return false;
  for (size_t i = 0; i < count; i++) {
    const strut_equilibrium *e = &p->all->list[i];
    if (!is_stable(e)) continue;
    if (e->outcome == STRUT_OUTCOME_STANDS || e->outcome == STRUT_OUTCOME_FLOPPY) {
      p->standing[p->standing_count++] = i;
      p->floppy_count += e->outcome == STRUT_OUTCOME_FLOPPY;
    } else {
      p->aside[p->aside_count++] = i;
    }
  }
  by_energy(p->all, p->standing, p->standing_count);
  by_energy(p->all, p->aside, p->aside_count);
  return true;
}

/* Texts of cards, which wrap. */
static strut_font card_font(const plan *p) {
  return (strut_font){.size = 7.5, .colour = strut_grey(0.3), .width = p->cell[0] - 8};
}

static strut_font small_font(const plan *p) {
  return (strut_font){.size = 6.5, .colour = strut_grey(0.35), .width = p->small_cell[0] - 6};
}

static strut_font aside_font(const plan *p) {
  return (strut_font){.size = 8, .colour = strut_grey(0.3), .width = p->width - 2 * EDGE};
}

static void describe_card(const plan *p, size_t i, char text[NOTE]) {
  snprintf(text, NOTE, "%s, %s",
           strut_drawn_quantity(drop_rounding(p, drawn_energy(p->all, i)), 6, "J").text,
           p->all->list[i].verdict);
}

static void describe_small_card(const plan *p, size_t i, char text[NOTE]) {
  snprintf(text, NOTE, "%s: %s",
           strut_drawn_quantity(drop_rounding(p, drawn_energy(p->all, i)), 5, "J").text,
           p->all->list[i].verdict);
}

static double measure_height(const plan *p, const char *text, strut_font font) {
  double width, height;
  strut_text_size(p->ruler, text, font, &width, &height);
  return height;
}

/* Heights of the texts around the cards, whose widths are known. */
static void measure_texts(plan *p) {
  char text[NOTE];
  p->card_head = p->small_foot = 0;
  for (size_t k = 0; k < p->cards; k++) {
    describe_card(p, p->standing[k], text);
    p->card_head = fmax(p->card_head, NAME_LINE + measure_height(p, text, card_font(p)) + 2);
  }
  for (size_t k = 0; k < p->small; k++) {
    describe_small_card(p, p->aside[k], text);
    p->small_foot = fmax(p->small_foot, measure_height(p, text, small_font(p)) + 2);
  }
  snprintf(p->aside_text, NOTE,
           "Stable on static supports, but not at rest on the ground%s%.0zu%s:",
           p->small < p->aside_count ? " (the lowest of " : "",
           p->small < p->aside_count ? p->aside_count : 0, p->small < p->aside_count ? ")" : "");
  p->aside_line = measure_height(p, p->aside_text, aside_font(p)) + 6;
}

static strut_bounds bounds_of(const plan *p, size_t i) {
  strut_bounds b = strut_bounds_none();
  strut_bounds_add(&b, p->model, drawn_shape(p->all, i));
  return b;
}

/* Widens the scales that all cards share to hold equilibrium i. */
static void widen_scales(plan *p, size_t i) {
  const strut_equilibrium *e = &p->all->list[i];
  strut_bounds b = bounds_of(p, i);
  for (size_t k = 0; k < p->all->count; k++)
    p->largest_energy = fmax(p->largest_energy, fabs(p->all->list[k].energy));
  for (int d = 0; d < 2; d++) p->size[d] = fmax(p->size[d], b.high[d] - b.low[d]);
  for (int32_t k = 0; k < e->contact_count && e->normal; k++)
    p->contact_limit = fmax(p->contact_limit, fabs(e->normal[k]));
}

/* The scale of forces, which all cards share, but for collapsed states with far larger ones. */
static void find_force_limit(plan *p) {
  double most[MOST_CARDS] = {0};
  for (size_t k = 0; k < p->cards; k++)
    for (size_t j = 0; j < p->model->scene->member_count; j++)
      most[k] = fmax(most[k], fabs(p->all->list[p->standing[k]].member_force[j]));
  p->force_limit = strut_limit_without_outliers(most, p->cards, 0.0, COLLAPSED, &p->beyond);
  p->beyond.below = p->beyond.above; /* of either sign */
}

static void lay_out_cards(plan *p) {
  double inner = p->width - 2 * EDGE;
  p->cards = p->standing_count < MOST_CARDS ? p->standing_count : MOST_CARDS;
  for (size_t k = 0; k < p->cards; k++) widen_scales(p, p->standing[k]);
  find_force_limit(p);
  p->small_columns = (size_t)fmax(1, floor(inner / 82));
  if (p->small_columns > MOST_SMALL) p->small_columns = MOST_SMALL;
  p->small = p->aside_count < p->small_columns ? p->aside_count : p->small_columns;
  if (!p->cards)
    for (size_t k = 0; k < p->small; k++) widen_scales(p, p->aside[k]);
  p->columns = (size_t)fmax(1, fmin(3, floor(inner / NARROW)));
  if (p->columns > p->cards && p->cards) p->columns = p->cards;
  p->cell[0] = inner / (double)p->columns;
  double aspect = p->size[0] > 0 ? p->size[1] / p->size[0] : 1;
  double wanted = (p->cell[0] - 2 * MARGIN) * aspect + 2 * MARGIN + 6;
  p->small_cell[0] = inner / (double)p->small_columns;
  measure_texts(p);
  p->cell[1] = p->card_head + fmax(46, fmin(wanted, 1.2 * p->cell[0]));
  p->small_cell[1] =
      p->small_foot + fmax(36, fmin(p->small_cell[0] * aspect + 14, p->small_cell[0]));
  p->ladder = p->cards > 1 && strut_ladder_wanted(p->all, p->standing, p->cards);
}

static double figure_height(const plan *p) {
  double rows = ceil((double)p->cards / (double)p->columns);
  return 2 * EDGE + p->head + rows * p->cell[1] + (p->cards ? SCALE : 0) +
         (p->ladder ? LADDER : 0) + (p->small ? p->small_cell[1] + p->aside_line : 0);
}

/* Forces of the ground as (contacts, 2), zero where it is not touched; NULL: no memory. */
static double (*contact_forces(plan *p, const strut_equilibrium *e))[2] {
  const strut_contact_table *contacts = &p->model->contacts;
  double(*force)[2] = strut_arena_allocate(&p->arena, (size_t)contacts->count + 1, sizeof *force);
  for (int32_t k = 0; force && k < e->contact_count && e->normal; k++)
    for (int32_t c = 0; c < contacts->count; c++)
      if (contacts->entry[c].node == e->contacts[k]) force[c][0] = e->normal[k];
  return force;
}

static strut_window window_for(const plan *p, size_t i, strut_box box, double margin) {
  strut_bounds b = bounds_of(p, i);
  double middle = 0.5 * (b.low[0] + b.high[0]), low = b.low[1];
  const strut_ground *ground = &p->model->scene->ground;
  if (ground->present && ground->slope == 0) low = fmin(low, ground->height);
  const strut_bounds shared = {{middle - 0.5 * p->size[0], low},
                               {middle + 0.5 * p->size[0], low + p->size[1]}};
  return strut_window_fit(box, shared, margin);
}

static bool draw_card(plan *p, strut_canvas *canvas, size_t i, strut_box cell) {
  const strut_equilibrium *e = &p->all->list[i];
  char text[NOTE], fitted[STRUT_FITTED_TEXT];
  strut_font name = {.size = 8.5, .bold = true};
  strut_box box = {cell.x, cell.y + p->card_head, cell.width, cell.height - p->card_head};
  strut_window window = window_for(p, i, box, MARGIN);
  double(*force)[2] = contact_forces(p, e);
  if (!force) return false;
  const strut_structure_style style = {.colouring = STRUT_COLOUR_FORCE,
                                       .values = e->member_force,
                                       .slack_forces = e->member_force,
                                       .limit = p->force_limit};
  strut_draw_text(canvas, cell.x + 4, cell.y,
                  strut_text_fit(canvas, e->name, name, cell.width - 8, 0, fitted), name);
  describe_card(p, i, text);
  strut_draw_text(canvas, cell.x + 4, cell.y + NAME_LINE - 1, text, card_font(p));
  strut_canvas_clip(canvas, cell);
  strut_draw_ground(canvas, &window, p->model, (double)NAN);
  strut_draw_structure(canvas, &window, p->model, drawn_shape(p->all, i), &style);
  strut_draw_contact_forces(canvas, &window, p->model, drawn_shape(p->all, i),
                            (const double(*)[2])force, p->contact_limit, ARROW);
  strut_canvas_unclip(canvas);
  if (cell.width > 105) strut_draw_names(canvas, &window, p->model, drawn_shape(p->all, i), false);
  return true;
}

static void draw_small_card(plan *p, strut_canvas *canvas, size_t i, strut_box cell) {
  char text[NOTE];
  strut_window window =
      window_for(p, i, (strut_box){cell.x, cell.y, cell.width, cell.height - p->small_foot}, 6);
  const strut_structure_style style = {
      .colouring = STRUT_COLOUR_ONE, .colour = strut_grey(0.45), .thinness = 0.4, .no_nodes = true};
  strut_canvas_clip(canvas, cell);
  strut_draw_ground(canvas, &window, p->model, (double)NAN);
  strut_draw_structure(canvas, &window, p->model, drawn_shape(p->all, i), &style);
  strut_canvas_unclip(canvas);
  describe_small_card(p, i, text);
  strut_draw_text(canvas, cell.x + 3, cell.y + cell.height - p->small_foot + 1, text,
                  small_font(p));
}

static double draw_cards(plan *p, strut_canvas *canvas, double y, bool *good) {
  for (size_t k = 0; k < p->cards && *good; k++) {
    strut_box cell = {EDGE + (double)(k % p->columns) * p->cell[0],
                      y + (double)(k / p->columns) * p->cell[1], p->cell[0], p->cell[1]};
    *good = draw_card(p, canvas, p->standing[k], cell);
  }
  if (!p->cards) return y;
  y += ceil((double)p->cards / (double)p->columns) * p->cell[1];
  strut_window foot = window_for(
      p, p->standing[0], (strut_box){EDGE, y + p->card_head, p->cell[0], p->cell[1] - p->card_head},
      MARGIN);
  foot.box.y = y + SCALE - 8 - foot.box.height;
  strut_draw_yardstick(canvas, &foot);
  double wide = fmin(170, 0.5 * (p->width - 2 * EDGE));
  const strut_colour_scale scale = {.name = "force",
                                    .unit = "N",
                                    .low = -p->force_limit,
                                    .high = p->force_limit,
                                    .colours = STRUT_COLOURS_SIGNED,
                                    .beyond = p->beyond};
  if (p->force_limit > 0)
    strut_draw_colour_scale(canvas, (strut_box){p->width - EDGE - wide, y, wide, SCALE}, &scale);
  return y + SCALE;
}

/* The heading, whose note is written to `text`, and its height. */
static strut_status describe_all(plan *p, char text[NOTE], strut_error *error) {
  size_t stable = p->standing_count - p->floppy_count;
  char floppy[40] = "";
  if (p->floppy_count) snprintf(floppy, sizeof floppy, ", %zu floppy", p->floppy_count);
  snprintf(text, NOTE, "%zu stable equilibri%s%s%s%s", stable, stable == 1 ? "um" : "a",
           p->model->scene->ground.present ? " on the ground" : "", floppy,
           p->cards < p->standing_count ? ", the lowest are drawn" : "");
  p->heading = (strut_heading){.width = p->width, .edge = EDGE, .title = p->title, .note = text};
  return strut_heading_measure(&p->heading, &p->head, error);
}

static strut_status draw_figure(plan *p, strut_canvas *canvas) {
  bool good = true;
  double inner = p->width - 2 * EDGE, y = EDGE + p->head;

  strut_heading_draw(canvas, &p->heading);
  y = draw_cards(p, canvas, y, &good);
  if (!good) return STRUT_NO_MEMORY;
  if (p->ladder) {
    double wide = fmin(inner, 90.0 + 120.0 * (double)p->cards);
    strut_panel ladder;
    if (!strut_ladder_fill(p->all, p->standing, p->cards, &p->arena, &ladder) ||
        !strut_draw_chart(canvas, (strut_box){EDGE, y + 4, wide, LADDER - 8}, &ladder, false,
                          &p->arena))
      return STRUT_NO_MEMORY;
    y += LADDER;
  }
  if (!p->small) return STRUT_OK;
  strut_draw_text(canvas, EDGE, y + 2, p->aside_text, aside_font(p));
  for (size_t k = 0; k < p->small; k++)
    draw_small_card(p, canvas, p->aside[k],
                    (strut_box){EDGE + (double)k * p->small_cell[0], y + p->aside_line,
                                p->small_cell[0], p->small_cell[1]});
  return STRUT_OK;
}

strut_status strut_equilibria_figure(const strut_plot *plot, const strut_model *model,
                                     const strut_equilibria *equilibria, strut_error *error) {
  plan p = {.model = model,
            .all = equilibria,
            .width = plot->width,
            .title = strut_plot_title(plot, model->scene->name)};
  strut_canvas *canvas = NULL;
  char note[NOTE];
  strut_status status = strut_canvas_open_pixels(1, 1, 1.0, &p.ruler, error);
  if (status == STRUT_OK && !choose_equilibria(&p))
    status = strut_no_memory(error, "while drawing");
  if (status == STRUT_OK) {
    lay_out_cards(&p);
    status = describe_all(&p, note, error);
  }
  if (status == STRUT_OK)
    status = strut_canvas_open(plot->path, plot->width, figure_height(&p), p.title, &canvas, error);
  if (status == STRUT_OK) {
    status = draw_figure(&p, canvas);
    if (status != STRUT_OK) strut_fail(error, status, "out of memory while drawing");
  }
  if (status == STRUT_OK) status = strut_canvas_commit(canvas, error);
  strut_canvas_free(canvas);
  strut_canvas_free(p.ruler);
  strut_arena_free(&p.arena);
  return status;
}

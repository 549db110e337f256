/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/statics_figures.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/output/draw/figure.h"

enum { NAMED = 12, TITLE = 200, MOST = STRUT_MODES_FIGURE_MOST };

static const double MARGIN = 13.0, NARROWEST = 112.0; /* [pt]; panels, for their titles */
static const double UNSTRAINED = 1e-9; /* strain by rounding, relative to displacement over size */

/* A mode's panel: the shape at rest, and displaced. */
typedef struct mode_panel {
  strut_view view;
  strut_shape shapes[2];
  double *moved, *strain; /* (length) [m], (members) */
  char title[TITLE], words[TITLE + TITLE / 2];
} mode_panel;

typedef struct picture {
  const strut_model *model;
  const strut_modes *modes;
  size_t count;
  const strut_mode *shown[MOST];
  double *taut; /* (members) 0 where a cable is slack at rest */
  double size;  /* larger extent of the shape at rest [m] */
  strut_bounds bounds;
  mode_panel *of; /* (count) */
  strut_panel *panels;
  strut_mark *rings; /* (closed_count) around contacts that are closed */
  strut_arena arena;
} picture;

/* Chooses the modes with panels: rigid-body motions only if there are no others. */
static void choose_modes(picture *self, size_t panels) {
  size_t others = 0, most = panels ? panels : STRUT_MODES_FIGURE_PANELS;
  for (size_t i = 0; i < self->modes->count; i++)
    others += self->modes->list[i].kind != STRUT_MODE_RIGID;
  for (size_t i = 0; i < self->modes->count && self->count < most && self->count < MOST; i++)
    if (!others || self->modes->list[i].kind != STRUT_MODE_RIGID)
      self->shown[self->count++] = &self->modes->list[i];
}

/* Strains of all members by the displacement drawn, to first order; returns the largest. */
static double find_strains(const picture *self, const double *moved, double *strain) {
  const double *q = self->modes->q;
  double largest = 0.0;
  for (size_t j = 0; j < self->model->scene->member_count; j++) {
    const strut_member *member = &self->model->scene->members[j];
    double change = 0.0, length = 0.0;
    for (size_t k = 0; k <= member->guide_count; k++) {
      int32_t a = 2 * strut_member_node(member, k), b = 2 * strut_member_node(member, k + 1);
      double own = 0.0, part = strut_distance(q + a, q + b);
      for (int d = 0; d < 2; d++)
        own += (q[b + d] - q[a + d]) * (moved[b + d] - q[b + d] - moved[a + d] + q[a + d]);
      length += part;
      change += part > 0 ? own / part : 0.0;
    }
    strain[j] = length > 0 ? change / length : 0.0;
    largest = fmax(largest, fabs(strain[j]));
  }
  return largest > UNSTRAINED ? largest : 1.0;
}

/* "mode 3: 1.02 Hz, zeta = 0.1" and the moving nodes. */
static void describe_mode(const strut_mode *mode, size_t number, mode_panel *to) {
  const char *end = strchr(mode->description, ';');
  int length = strut_text_bytes(mode->description, end ? (int)(end - mode->description) : TITLE);
  char growth[TITLE / 2] = "", damping[40] = "";
  strut_c_locale locale = strut_c_locale_enter();
  if (mode->kind == STRUT_MODE_ELASTIC && mode->damping_ratio > 0)
    snprintf(damping, sizeof damping, ", \xCE\xB6 = %.2g", mode->damping_ratio);
  if (mode->just_taut)
    snprintf(damping, sizeof damping, ", %d member%s just taut", (int)mode->just_taut,
             mode->just_taut == 1 ? "" : "s");
  if (mode->kind == STRUT_MODE_UNSTABLE)
    snprintf(growth, sizeof growth, "grows e-fold in %s: ",
             strut_drawn_quantity(1.0 / sqrt(-mode->eigenvalue), 3, "s").text);
  static const char *const kinds[] = {[STRUT_MODE_RIGID] = "rigid-body motion",
                                      [STRUT_MODE_MECHANISM] = "mechanism",
                                      [STRUT_MODE_UNSTABLE] = "unstable",
                                      [STRUT_MODE_UNKNOWN] = "frequency not known"};
  const strut_rounded_quantity frequency =
      strut_drawn_quantity(mode->angular_frequency / STRUT_TAU, 4, "Hz");
  snprintf(to->title, TITLE, "mode %zu: %s%s", number,
           mode->kind == STRUT_MODE_ELASTIC ? frequency.text : kinds[mode->kind], damping);
  snprintf(to->words, sizeof to->words, "%s%.*s", growth, length, mode->description);
  strut_c_locale_leave(locale);
}

/* Fills in a panel, and widens the picture's bounds to it. False: out of memory. */
static bool add_mode(picture *self, size_t k) {
  const strut_mode *mode = self->shown[k];
  const strut_model *model = self->model;
  mode_panel *to = &self->of[k];
  double most = 0.0;
  to->moved =
      strut_arena_copy(&self->arena, self->modes->q, (size_t)model->length, sizeof *to->moved);
  to->strain = strut_arena_allocate(&self->arena, model->scene->member_count + 1, sizeof(double));
  if (!to->moved || !to->strain) return false;
  for (int32_t i = 0; i < model->node_count; i++)
    most = fmax(most, hypot(mode->shape[2 * i], mode->shape[2 * i + 1]));
  for (int32_t i = 0; i < model->length && most > 0; i++)
    to->moved[i] += STRUT_MODES_FIGURE_SWING * self->size / most * mode->shape[i];
  strut_bounds_add(&self->bounds, model, to->moved);
  describe_mode(mode, (size_t)(mode - self->modes->list) + 1, to);
  to->shapes[0] = (strut_shape){.model = model,
                                .q = self->modes->q,
                                .style = {.colouring = STRUT_COLOUR_ONE,
                                          .colour = strut_grey(0.8),
                                          .slack_forces = self->taut,
                                          .no_nodes = true},
                                .ground = true};
  to->shapes[1] = (strut_shape){.model = model,
                                .q = to->moved,
                                .style = {.colouring = STRUT_COLOUR_FORCE,
                                          .values = to->strain,
                                          .limit = find_strains(self, to->moved, to->strain),
                                          .slack_forces = self->taut,
                                          .no_supports = true},
                                .from = self->modes->q,
                                .names = model->node_count <= NAMED};
  to->view = (strut_view){.shape_count = 2, .shapes = to->shapes, .margin = MARGIN};
  self->panels[k] = (strut_panel){.title = to->title,
                                  .note = to->words,
                                  .view = &to->view,
                                  .marks = self->rings,
                                  .mark_count = (size_t)self->modes->closed_count};
  return true;
}

/* Fills in all panels. False: out of memory. */
static bool add_modes(picture *self) {
  const double *q = self->modes->q;
  self->of = strut_arena_allocate(&self->arena, self->count + 1, sizeof *self->of);
  self->panels = strut_arena_allocate(&self->arena, self->count + 1, sizeof *self->panels);
  self->rings = strut_arena_allocate(&self->arena, (size_t)self->modes->closed_count + 1,
                                     sizeof *self->rings);
  self->taut =
      strut_arena_allocate(&self->arena, self->model->scene->member_count + 1, sizeof(double));
  if (!self->of || !self->panels || !self->rings || !self->taut) return false;
  for (size_t j = 0; j < self->model->scene->member_count; j++)
    self->taut[j] = self->model->scene->members[j].kind != STRUT_CABLE ||
                    strut_member_path_length(self->model, (int32_t)j, q) >
                        self->model->members.rest[j] * (1 - 1e-12);
  for (int32_t k = 0; k < self->modes->closed_count; k++) {
    const double *at = q + 2 * self->modes->closed[k];
    self->rings[k] = (strut_mark){.at = {at[0], at[1]}, .ring = true};
  }
  self->bounds = strut_bounds_none();
  strut_bounds_add(&self->bounds, self->model, q);
  self->size = strut_bounds_extent(&self->bounds);
  if (!(self->size > 0)) self->size = self->model->size;
  for (size_t k = 0; k < self->count; k++)
    if (!add_mode(self, k)) return false;
  for (size_t k = 0; k < self->count; k++) self->of[k].view.bounds = self->bounds;
  return true;
}

/* Names the modes that have no panel; empty where all have one. */
static void describe_omitted(const picture *self, char text[TITLE]) {
  size_t rigid = 0, left = self->modes->count - self->count;
  for (size_t i = 0; i < self->modes->count; i++)
    rigid += self->modes->list[i].kind == STRUT_MODE_RIGID;
  if (self->shown[0]->kind == STRUT_MODE_RIGID) rigid -= self->count;
  left -= rigid;
  text[0] = '\0';
  int used = 0;
  if (rigid)
    used = snprintf(text, TITLE, "not drawn: %zu rigid-body motion%s", rigid, rigid > 1 ? "s" : "");
  if (left)
    snprintf(text + used, TITLE - (size_t)used, "%s%zu higher mode%s",
             used ? ", " : "not drawn: ", left, left > 1 ? "s" : "");
}

strut_status strut_modes_figure(const strut_plot *plot, const strut_model *model,
                                const strut_modes *modes, size_t panels, strut_error *error) {
  picture p = {.model = model, .modes = modes};
  char at[TITLE], rest[TITLE];
  choose_modes(&p, panels);
  describe_omitted(&p, rest);
  snprintf(at, TITLE, "%s %.*s%s", modes->at_rest ? "equilibrium" : "shape",
           strut_text_bytes(modes->at, 150), modes->at, modes->at_rest ? "" : " (no equilibrium)");
  const strut_pen grey = {.colour = strut_grey(0.8), .width = 1.8};
  const strut_pen ring = {.colour = strut_grey(0.1), .width = 0.9};
  const strut_key_item keys[] = {
      {.sign = STRUT_KEY_LINE, .pen = grey, .text = at},
      {.sign = STRUT_KEY_ARROW, .pen = strut_displacement_pen(), .text = "displacement"},
      {.sign = STRUT_KEY_SIGNED, .before = "shortens", .text = "stretches, relative per mode"},
      {.sign = STRUT_KEY_DOT, .pen = ring, .text = modes->closed_count ? "closed contact" : NULL},
      {.sign = STRUT_KEY_WORDS, .text = *rest ? rest : NULL}};
  strut_status status = add_modes(&p) ? STRUT_OK : strut_no_memory(error, "while drawing");
  if (status == STRUT_OK)
    status = strut_figure_draw(plot,
                               &(strut_figure){.title = model->scene->name,
                                               .panel_count = p.count,
                                               .panels = p.panels,
                                               .columns = MOST,
                                               .least_width = NARROWEST,
                                               .aspect = 0.95,
                                               .key_count = sizeof keys / sizeof *keys,
                                               .keys = keys},
                               error);
  strut_arena_free(&p.arena);
  return status;
}

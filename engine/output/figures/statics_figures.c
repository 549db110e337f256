/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/statics_figures.h"

#include <math.h>
#include <string.h>

#include "engine/forces/elements.h"
#include "engine/output/draw/figure.h"

static const double MARGIN = 20; /* [pt] */

/* ---- a form that was found ---- */

strut_status strut_form_figure(const strut_plot *plot, const strut_model *model,
                               const double (*drawn)[2], strut_error *error) {
  strut_figure figure = {.title = model->scene->name,
                         .note = "the drawn shape, and the forces that hold it",
                         .aspect = 0.9,
                         .yardstick = true};
  size_t members = model->scene->member_count;
  double *before = strut_figure_numbers(&figure, (size_t)model->length), moved = 0;
  double *force = strut_figure_numbers(&figure, members);
  strut_panel *panel = strut_add_panel(&figure);
  panel->margin = MARGIN;
  if (before) memcpy(before, drawn, (size_t)model->node_count * sizeof *drawn);
  for (size_t j = 0; force && j < members; j++)
    force[j] = strut_member_elastic_tension(model, model->members.rest, (int32_t)j, model->start);
  for (int32_t i = 0; before && i < 2 * model->node_count; i += 2)
    moved = fmax(moved, hypot(model->start[i] - before[i], model->start[i + 1] - before[i + 1]));
  if (moved > 1e-9 * model->size) {
    strut_add_ghost(&figure, panel, model, before, 0.75)->style.thinness = 0.4;
    figure.note = strut_figure_text(&figure, "grey: drawn shape; nodes moved by up to %s",
                                    strut_quantity_of(moved, 3, "m").text);
  }
  strut_add_forces(&figure, panel, model, model->start, force, strut_largest(force, members))
      ->names = true;
  figure.scale = strut_force_scale(strut_largest(force, members), NULL);
  return strut_figure_draw(plot, &figure, error);
}

/* ---- rigidity ---- */

static const double SWING = 0.12; /* the largest motion as drawn, of the larger extent */
enum { PANELS = 12, COLUMNS = 3 };

typedef struct picture {
  const strut_model *model;
  const double *q;
  const strut_rigidity *rigidity;
  strut_bounds bounds;
  double swing; /* [m] */
  strut_figure figure;
} picture;

/* True if member forces exceed the effect of rounding in their lengths. */
static bool forces_told(const picture *self) {
  const strut_member_table *m = &self->model->members;
  size_t members = self->model->scene->member_count;
  double scale = 0;
  for (size_t j = 0; j < members; j++) scale = fmax(scale, m->stiffness[j] * m->rest[j]);
  return self->rigidity->prestressed &&
         strut_largest(self->rigidity->force, members) > 1e-12 * scale;
}

static strut_panel *add_panel(picture *self, const char *title) {
  strut_panel *panel = strut_add_panel(&self->figure);
  panel->title = title;
  panel->bounds = self->bounds;
  panel->margin = MARGIN;
  return panel;
}

/* The shape in colours of forces. */
static void add_forces(picture *self, const char *title, const double *force) {
  strut_add_forces(&self->figure, add_panel(self, title), self->model, self->q, force,
                   strut_largest(force, self->model->scene->member_count))
      ->names = true;
}

/* The shape in grey, displaced by a small motion. */
static void add_mechanism(picture *self, int32_t number) {
  const strut_mechanism *mechanism = &self->rigidity->mechanisms.list[number];
  const strut_equilibrium_matrix *matrix = &self->rigidity->matrix;
  double *moved = strut_figure_copy(&self->figure, self->q, (size_t)self->model->length);
  double most = strut_largest(mechanism->motion, (size_t)matrix->rows);
  for (int32_t r = 0; r < matrix->rows && most > 0 && moved; r++)
    moved[matrix->coordinate[r]] += self->swing / most * mechanism->motion[r];
  strut_panel *panel =
      add_panel(self, strut_figure_text(&self->figure, "mechanism %d, %s", (int)number + 1,
                                        strut_motion_kind_name(mechanism->kind)));
  for (int k = 0; k < 2; k++) {
    strut_shape *shape =
        strut_add_ghost(&self->figure, panel, self->model, k ? moved : self->q, 0.72);
    shape->style.thinness = 0.5;
    shape->style.no_supports = k == 1;
    if (k) shape->style.colour = strut_palette_thing(0);
  }
  if (moved) strut_add_displacements(&self->figure, panel, self->model, self->q, moved);
}

/* Forces, states of self-stress, mechanisms: as many as go in; the last two share the room. Returns how many do not. */
static int32_t add_panels(picture *self, int32_t columns) {
  const strut_rigidity *rigidity = self->rigidity;
  int32_t states = rigidity->states.force ? rigidity->states.count : 0;
  int32_t motions = rigidity->mechanisms.list ? rigidity->mechanisms.count : 0;
  int32_t room = PANELS / COLUMNS * columns;
  self->bounds = strut_bounds_of(self->model, self->q);
  self->swing = SWING * strut_bounds_extent(&self->bounds);
  for (int d = 0; d < 2 && motions > 0; d++) /* there is room for motions */
    self->bounds.low[d] -= self->swing, self->bounds.high[d] += self->swing;
  if (forces_told(self)) {
    double limit = strut_largest(rigidity->force, self->model->scene->member_count);
    add_forces(
        self,
        strut_figure_text(&self->figure, "forces, up to %s", strut_quantity_of(limit, 3, "N").text),
        rigidity->force);
    room--;
  }
  int32_t kept = motions < room / 2 ? motions : room / 2; /* at least, if states abound */
  if (states > room - kept) states = room - kept;
  if (motions > room - states) motions = room - states;
  for (int32_t i = 0; i < states; i++) {
    bool presses = rigidity->has_cables && !rigidity->states.cables_pull[i];
    add_forces(self,
               strut_figure_text(&self->figure, "self-stress %d%s", (int)i + 1,
                                 presses ? ", presses cables" : ""),
               rigidity->states.force + (size_t)i * (size_t)rigidity->matrix.columns);
  }
  for (int32_t i = 0; i < motions; i++) add_mechanism(self, i);
  if (!self->figure.panel_count) /* the shape itself */
    strut_add_shape(&self->figure, add_panel(self, ""), self->model, self->q)->names = true;
  return rigidity->states.count - states + rigidity->mechanisms.count - motions;
}

strut_status strut_rigidity_figure(const strut_plot *plot, const strut_model *model,
                                   const double *positions, const char *at,
                                   const strut_rigidity *rigidity, strut_error *error) {
  picture p = {.model = model,
               .q = positions,
               .rigidity = rigidity,
               .figure = {.title = model->scene->name, .columns = COLUMNS, .yardstick = true}};
  int states = (int)rigidity->states.count, mechanisms = (int)rigidity->mechanisms.count;
  int left_out = add_panels(&p, (int32_t)fmax(1, fmin(COLUMNS, floor(plot->width / 110))));
  p.figure.note =
      strut_figure_text(&p.figure, "%s: %d state%s of self-stress, %d mechanism%s", at, states,
                        states == 1 ? "" : "s", mechanisms, mechanisms == 1 ? "" : "s");
  if (left_out > 0)
    p.figure.note = strut_figure_text(&p.figure, "%s; %d not drawn", p.figure.note, left_out);
  p.figure.scale = strut_force_scale(1, NULL);
  p.figure.scale.unit = "";
  p.figure.scale.name =
      !p.figure.failed && p.figure.panels->shapes->style.limit > 0 ? "force, of the largest" : NULL;
  return strut_figure_draw(plot, &p.figure, error);
}

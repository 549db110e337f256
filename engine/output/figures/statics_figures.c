/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/statics_figures.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/forces/elements.h"
#include "engine/output/draw/figure.h"

enum { NOTE = 400 };
static const double MARGIN = 20; /* [pt] */

static double largest(const double *values, size_t count) {
  double most = 0;
  for (size_t i = 0; i < count; i++) most = fmax(most, fabs(values[i]));
  return most;
}

/* A shape in colours of the forces in it, with names. */
static strut_shape force_shape(const strut_model *model, const double *positions,
                               const double *force) {
  return (strut_shape){.model = model,
                       .q = positions,
                       .style = {.colouring = STRUT_COLOUR_FORCE,
                                 .values = force,
                                 .slack_forces = force,
                                 .limit = largest(force, model->scene->member_count)},
                       .ground = true,
                       .names = true};
}

/* ---- a form that was found ---- */

/* How far the node went that went farthest [m]. */
static double farthest(const strut_model *model, const double *before) {
  double most = 0;
  for (int32_t i = 0; i < 2 * model->node_count; i += 2)
    most = fmax(most, hypot(model->start[i] - before[i], model->start[i + 1] - before[i + 1]));
  return most;
}

strut_status strut_form_figure(const strut_plot *plot, const strut_model *model,
                               const double (*drawn)[2], strut_error *error) {
  strut_arena arena = {0};
  size_t members = model->scene->member_count, nodes = (size_t)model->node_count;
  double *before = strut_arena_allocate(&arena, (size_t)model->length, sizeof *before);
  double *force = strut_arena_allocate(&arena, members + 1, sizeof *force);
  strut_status status = before && force ? STRUT_OK : strut_no_memory(error, "while drawing");
  if (status == STRUT_OK) {
    memcpy(before, drawn, nodes * sizeof *drawn);
    for (size_t j = 0; j < members; j++)
      force[j] = strut_member_elastic_tension(model, model->members.rest, (int32_t)j, model->start);
    double limit = largest(force, members), moved = farthest(model, before);
    char note[NOTE] = "the drawn shape, and the forces that hold it";
    bool as_drawn = moved <= 1e-9 * model->size;
    if (!as_drawn)
      snprintf(note, NOTE, "grey: drawn shape; nodes moved by up to %s",
               strut_drawn_quantity(moved, 3, "m").text);
    const strut_shape shapes[] = {{.model = model,
                                   .q = before,
                                   .style = {.colouring = STRUT_COLOUR_ONE,
                                             .colour = strut_grey(0.75),
                                             .thinness = 0.4,
                                             .no_nodes = true,
                                             .no_supports = true}},
                                  force_shape(model, model->start, force)};
    strut_view view = {.shapes = shapes + as_drawn,
                       .shape_count = 2 - as_drawn,
                       .bounds = strut_bounds_none(),
                       .margin = MARGIN};
    strut_bounds_add(&view.bounds, model, before);
    strut_bounds_add(&view.bounds, model, model->start);
    const strut_panel panel = {.view = &view};
    status = strut_figure_draw(
        plot,
        &(strut_figure){.title = model->scene->name,
                        .note = note,
                        .panel_count = 1,
                        .panels = &panel,
                        .aspect = 0.9,
                        .yardstick = true,
                        .scale = {"force", "N", -limit, limit, STRUT_COLOURS_SIGNED, {0}}},
        error);
  }
  strut_arena_free(&arena);
  return status;
}

/* ---- rigidity ---- */

static const double SWING = 0.12; /* the largest motion as drawn, of the larger extent */
enum { PANELS = 12, COLUMNS = 3, TITLE = 80 };

typedef struct picture {
  const strut_model *model;
  const double *q;
  const strut_rigidity *rigidity;
  strut_bounds bounds;
  double swing; /* [m] */
  size_t count;
  strut_panel panels[PANELS];
  strut_view views[PANELS];
  strut_shape shapes[PANELS][2];
  char titles[PANELS][TITLE];
  strut_arena arena;
} picture;

/* True if member forces exceed the effect of rounding in their lengths. */
static bool forces_told(const picture *self) {
  const strut_member_table *m = &self->model->members;
  size_t members = self->model->scene->member_count;
  double scale = 0;
  for (size_t j = 0; j < members; j++) scale = fmax(scale, m->stiffness[j] * m->rest[j]);
  return self->rigidity->prestressed && largest(self->rigidity->force, members) > 1e-12 * scale;
}

/* The next panel, with so many shapes. Its title is written to what is returned. */
static char *add_panel(picture *self, size_t shapes) {
  size_t k = self->count++;
  self->views[k] = (strut_view){
      .shape_count = shapes, .shapes = self->shapes[k], .bounds = self->bounds, .margin = MARGIN};
  self->panels[k] = (strut_panel){.title = self->titles[k], .view = &self->views[k]};
  return self->titles[k];
}

/* The shape in grey, displaced by a small motion. False: out of memory. */
static bool add_mechanism(picture *self, int32_t number) {
  const strut_mechanism *mechanism = &self->rigidity->mechanisms.list[number];
  const strut_equilibrium_matrix *matrix = &self->rigidity->matrix;
  double *moved =
      strut_arena_copy(&self->arena, self->q, (size_t)self->model->length, sizeof *moved);
  double most = largest(mechanism->motion, (size_t)matrix->rows);
  if (!moved) return false;
  for (int32_t r = 0; r < matrix->rows && most > 0; r++)
    moved[matrix->coordinate[r]] += self->swing / most * mechanism->motion[r];
  strut_shape *shapes = self->shapes[self->count];
  shapes[0] = shapes[1] = (strut_shape){.model = self->model,
                                        .q = self->q,
                                        .style = {.colouring = STRUT_COLOUR_ONE,
                                                  .colour = strut_grey(0.72),
                                                  .thinness = 0.5,
                                                  .no_nodes = true}};
  shapes[1].q = moved;
  shapes[1].from = self->q;
  shapes[1].style.colour = strut_palette_thing(0);
  shapes[1].style.no_supports = true;
  snprintf(add_panel(self, 2), TITLE, "mechanism %d, %s", (int)number + 1,
           strut_motion_kind_name(mechanism->kind));
  return true;
}

/* Forces, states of self-stress, mechanisms: as many as go in; the last two share the room. False: out of memory. */
static bool add_panels(picture *self, int32_t columns) {
  const strut_rigidity *rigidity = self->rigidity;
  int32_t states = rigidity->states.force ? rigidity->states.count : 0;
  int32_t motions = rigidity->mechanisms.list ? rigidity->mechanisms.count : 0;
  int32_t room = PANELS / COLUMNS * columns;
  self->bounds = strut_bounds_none();
  strut_bounds_add(&self->bounds, self->model, self->q);
  self->swing = SWING * strut_bounds_extent(&self->bounds);
  for (int d = 0; d < 2 && motions > 0; d++) /* there is room for motions */
    self->bounds.low[d] -= self->swing, self->bounds.high[d] += self->swing;
  if (forces_told(self)) {
    double limit = largest(rigidity->force, self->model->scene->member_count);
    self->shapes[self->count][0] = force_shape(self->model, self->q, rigidity->force);
    snprintf(add_panel(self, 1), TITLE, "forces, up to %s",
             strut_drawn_quantity(limit, 3, "N").text);
    room--;
  }
  int32_t kept = motions < room / 2 ? motions : room / 2; /* at least, if states abound */
  if (states > room - kept) states = room - kept;
  if (motions > room - states) motions = room - states;
  for (int32_t i = 0; i < states; i++) {
    self->shapes[self->count][0] =
        force_shape(self->model, self->q,
                    rigidity->states.force + (size_t)i * (size_t)rigidity->matrix.columns);
    snprintf(add_panel(self, 1), TITLE, "self-stress %d%s", (int)i + 1,
             rigidity->has_cables && !rigidity->states.cables_pull[i] ? ", presses cables" : "");
  }
  for (int32_t i = 0; i < motions; i++)
    if (!add_mechanism(self, i)) return false;
  if (self->count) return true;
  self->shapes[0][0] =
      (strut_shape){.model = self->model, .q = self->q, .names = true}; /* the shape itself */
  add_panel(self, 1)[0] = '\0';
  return true;
}

strut_status strut_rigidity_figure(const strut_plot *plot, const strut_model *model,
                                   const double *positions, const char *at,
                                   const strut_rigidity *rigidity, strut_error *error) {
  picture p = {.model = model, .q = positions, .rigidity = rigidity};
  int32_t states = rigidity->states.count, mechanisms = rigidity->mechanisms.count;
  char note[NOTE];
  strut_status status = STRUT_OK;
  if (!add_panels(&p, (int32_t)fmax(1, fmin(COLUMNS, floor(plot->width / 110)))))
    status = strut_no_memory(error, "while drawing");
  bool forces = p.views[0].shapes->style.limit > 0;
  int left_out = (int)states + (int)mechanisms - (int)p.count + (forces_told(&p) ? 1 : 0);
  int used = snprintf(note, NOTE, "%s: %d state%s of self-stress, %d mechanism%s", at, (int)states,
                      states == 1 ? "" : "s", (int)mechanisms, mechanisms == 1 ? "" : "s");
  if (left_out > 0) snprintf(note + used, NOTE - (size_t)used, "; %d not drawn", left_out);
  if (status == STRUT_OK)
    status = strut_figure_draw(
        plot,
        &(strut_figure){
            .title = model->scene->name,
            .note = note,
            .panel_count = p.count,
            .panels = p.panels,
            .columns = COLUMNS,
            .yardstick = true,
            .scale =
                {forces ? "force, of the largest" : NULL, "", -1, 1, STRUT_COLOURS_SIGNED, {0}}},
        error);
  strut_arena_free(&p.arena);
  return status;
}

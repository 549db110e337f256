/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shapes in panels: a form that was found, forces, self-stress, mechanisms and modes; waves. */
#include "engine/output/figures/statics_figures.h"

#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/output/draw/figure.h"

static const double MARGIN = 20; /* [pt] */

/* A shape displaced along a motion, its farthest node by that much [m]; NULL: out of memory. */
static double *displace(strut_figure *figure, const strut_model *model, const double *positions,
                        const double *motion, double swing) {
  double most = 0.0, *moved = strut_figure_numbers(figure, positions, (size_t)model->length);
  for (int32_t i = 0; i < 2 * model->node_count; i += 2)
    most = fmax(most, hypot(motion[i], motion[i + 1]));
  for (int32_t i = 0; i < model->length && most > 0 && moved; i++)
    moved[i] += swing / most * motion[i];
  return moved;
}

/* ---- a form that was found ---- */

strut_status strut_form_figure(const strut_plot *plot, const strut_model *model,
                               const double (*drawn)[2], strut_error *error) {
  strut_figure figure = {.title = model->scene->name,
                         .note = "the drawn shape, and the forces that hold it",
                         .aspect = 0.9,
                         .yardstick = true};
  size_t members = model->scene->member_count;
  double *before = strut_figure_numbers(&figure, NULL, (size_t)model->length), moved = 0;
  double *force = strut_figure_numbers(&figure, NULL, members);
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

/* The member forces, where they exceed the effect of rounding in lengths. Returns how many panels that are. */
static int32_t add_prestress(picture *self) {
  const strut_member_table *m = &self->model->members;
  size_t members = self->model->scene->member_count;
  double scale = 0, limit = strut_largest(self->rigidity->force, members);
  for (size_t j = 0; j < members; j++) scale = fmax(scale, m->stiffness[j] * m->rest[j]);
  if (!self->rigidity->prestressed || !(limit > 1e-12 * scale)) return 0;
  add_forces(
      self,
      strut_figure_text(&self->figure, "forces, up to %s", strut_quantity_of(limit, 3, "N").text),
      self->rigidity->force);
  return 1;
}

/* The shape in grey, displaced by a small motion. */
static void add_mechanism(picture *self, int32_t number) {
  const strut_mechanism *mechanism = &self->rigidity->mechanisms.list[number];
  const strut_equilibrium_matrix *matrix = &self->rigidity->matrix;
  double *motion = strut_figure_numbers(&self->figure, NULL, (size_t)self->model->length), *moved;
  for (int32_t r = 0; r < matrix->rows && motion; r++)
    motion[matrix->coordinate[r]] = mechanism->motion[r];
  if (!motion || !(moved = displace(&self->figure, self->model, self->q, motion, self->swing)))
    return;
  strut_panel *panel =
      add_panel(self, strut_figure_text(&self->figure, "mechanism %d, %s", (int)number + 1,
                                        strut_motion_kind_name(mechanism->kind)));
  strut_shape *shape = strut_add_ghost(&self->figure, panel, self->model, self->q, 0.72);
  shape->style.no_supports = false;
  shape->style.thinness = 0.5;
  shape = strut_add_ghost(&self->figure, panel, self->model, moved, 0.72);
  shape->style.colour = strut_palette_thing(0);
  shape->style.thinness = 0.5;
  strut_add_displacements(&self->figure, panel, self->model, self->q, moved);
}

/* Forces, states of self-stress, mechanisms: as many as go in; the last two share the room. Returns how many do not. */
static int32_t add_panels(picture *self) {
  const strut_rigidity *rigidity = self->rigidity;
  int32_t states = rigidity->states.force ? rigidity->states.count : 0;
  int32_t motions = rigidity->mechanisms.list ? rigidity->mechanisms.count : 0;
  self->bounds = strut_bounds_of(self->model, self->q);
  self->swing = SWING * strut_bounds_extent(&self->bounds);
  for (int d = 0; d < 2 && motions > 0; d++) /* there is room for motions */
    self->bounds.low[d] -= self->swing, self->bounds.high[d] += self->swing;
  int32_t room = PANELS - add_prestress(self);
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
  int left_out = add_panels(&p);
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

/* ---- modes ---- */

enum { NAMED = 12, TITLE = 200, MOST = STRUT_MODES_FIGURE_MOST };

static const double MODE_MARGIN = 13.0, NARROWEST = 112.0; /* [pt]; panels, for their titles */
static const double UNSTRAINED = 1e-9; /* strain by rounding, relative to displacement over size */

typedef struct mode_picture {
  const strut_model *model;
  const strut_modes *modes;
  size_t count, rigid, higher; /* shown, and not */
  const strut_mode *shown[MOST];
  double *taut; /* (members) 0 where a cable is slack at rest */
  double size;  /* larger extent of the shape at rest [m] */
  strut_figure figure;
} mode_picture;

/* Chooses the modes with panels: rigid-body motions only if there are no others. Counts the rest. */
static void choose_modes(mode_picture *self, size_t panels) {
  size_t others = 0, most = panels ? panels : STRUT_MODES_FIGURE_PANELS;
  if (most > MOST) most = MOST;
  for (size_t i = 0; i < self->modes->count; i++)
    others += self->modes->list[i].kind != STRUT_MODE_RIGID;
  for (size_t i = 0; i < self->modes->count; i++) {
    bool rigid = self->modes->list[i].kind == STRUT_MODE_RIGID;
    if (self->count < most && !(others && rigid))
      self->shown[self->count++] = &self->modes->list[i];
    else
      ++*(rigid ? &self->rigid : &self->higher);
  }
}

/* Strains of all members by the displacement drawn, to first order: from that against it to that along it. */
static double find_strains(const mode_picture *self, const double *moved, const double *back,
                           double *strain) {
  double largest = 0.0;
  for (int32_t j = 0; j < (int32_t)self->model->scene->member_count; j++) {
    double length = strut_member_path_length(self->model, j, self->modes->q);
    double change = strut_member_path_length(self->model, j, moved) -
                    strut_member_path_length(self->model, j, back);
    strain[j] = length > 0 ? 0.5 * change / length : 0.0;
    largest = fmax(largest, fabs(strain[j]));
  }
  return largest > UNSTRAINED ? largest : 1.0;
}

/* "mode 3: 1.02 Hz, zeta = 0.1" and the moving nodes. */
static void describe_mode(strut_figure *figure, const strut_mode *mode, size_t number,
                          strut_panel *to) {
  static const char *const kinds[] = {[STRUT_MODE_RIGID] = "rigid-body motion",
                                      [STRUT_MODE_MECHANISM] = "mechanism",
                                      [STRUT_MODE_UNSTABLE] = "unstable",
                                      [STRUT_MODE_UNKNOWN] = "frequency not known"};
  const char *end = strchr(mode->description, ';'), *rest = "";
  int length = strut_text_bytes(mode->description, end ? (int)(end - mode->description) : TITLE);
  if (mode->just_taut)
    rest = strut_figure_text(figure, ", %d member%s just taut", (int)mode->just_taut,
                             mode->just_taut == 1 ? "" : "s");
  else if (mode->kind == STRUT_MODE_ELASTIC && mode->damping_ratio > 0)
    rest = strut_figure_text(figure, ", \xCE\xB6 = %.2g", mode->damping_ratio);
  const strut_rounded_quantity frequency =
      strut_quantity_of(mode->angular_frequency / STRUT_TAU, 4, "Hz");
  to->title = strut_figure_text(
      figure, "mode %zu: %s%s", number,
      mode->kind == STRUT_MODE_ELASTIC ? frequency.text : kinds[mode->kind], rest);
  bool grows = mode->kind == STRUT_MODE_UNSTABLE;
  to->note =
      strut_figure_text(figure, "%s%s%s%.*s", grows ? "grows e-fold in " : "",
                        grows ? strut_quantity_of(1.0 / sqrt(-mode->eigenvalue), 3, "s").text : "",
                        grows ? ": " : "", length, mode->description);
}

/* The shape at rest, and displaced. */
static void add_mode(mode_picture *self, const strut_mode *mode) {
  const strut_model *model = self->model;
  const double *q = self->modes->q;
  strut_panel *panel = strut_add_panel(&self->figure);
  const double swing = STRUT_MODES_FIGURE_SWING * self->size;
  double *moved = displace(&self->figure, model, q, mode->shape, swing);
  double *back = displace(&self->figure, model, q, mode->shape, -swing);
  double *strain = strut_figure_numbers(&self->figure, NULL, model->scene->member_count);
  if (!moved || !back || !strain) return;
  describe_mode(&self->figure, mode, (size_t)(mode - self->modes->list) + 1, panel);
  panel->margin = MODE_MARGIN;
  strut_shape *shape = strut_add_ghost(&self->figure, panel, model, q, 0.8);
  shape->style.slack_forces = self->taut;
  shape->style.no_supports = false;
  shape->ground = true;
  shape = strut_add_forces(&self->figure, panel, model, moved, strain,
                           find_strains(self, moved, back, strain));
  shape->style.slack_forces = self->taut;
  shape->style.no_supports = true;
  shape->ground = false;
  strut_add_displacements(&self->figure, panel, model, q, moved);
  shape->names = model->node_count <= NAMED;
  for (int32_t k = 0; k < self->modes->closed_count; k++) {
    const double *at = q + 2 * self->modes->closed[k];
    strut_add_mark(&self->figure, panel, at[0], at[1], NULL)->ring = true;
  }
}

static void add_modes(mode_picture *self) {
  size_t members = self->model->scene->member_count;
  self->taut = strut_figure_numbers(&self->figure, NULL, members);
  for (size_t j = 0; self->taut && j < members; j++)
    self->taut[j] = self->model->scene->members[j].kind != STRUT_CABLE ||
                    strut_member_path_length(self->model, (int32_t)j, self->modes->q) >
                        self->model->members.rest[j] * (1 - 1e-12);
  const strut_bounds bounds = strut_bounds_of(self->model, self->modes->q);
  self->size = strut_bounds_extent(&bounds);
  if (!(self->size > 0)) self->size = self->model->size;
  for (size_t k = 0; k < self->count; k++) add_mode(self, self->shown[k]);
}

static void add_keys(mode_picture *self) {
  const strut_modes *modes = self->modes;
  const strut_pen grey = {.colour = strut_grey(0.8), .width = 1.8};
  const strut_pen ring = {.colour = strut_grey(0.1), .width = 0.9};
  strut_add_key(
      &self->figure, STRUT_KEY_LINE, grey,
      strut_figure_text(&self->figure, "%s %.*s%s", modes->at_rest ? "equilibrium" : "shape",
                        strut_text_bytes(modes->at, 150), modes->at,
                        modes->at_rest ? "" : " (no equilibrium)"));
  if (modes->closed_count) strut_add_key(&self->figure, STRUT_KEY_DOT, ring, "closed contact");
  const char *rest = "";
  if (self->rigid)
    rest = strut_figure_text(&self->figure, ": %zu rigid-body motion%s", self->rigid,
                             self->rigid > 1 ? "s" : "");
  if (self->higher)
    rest = strut_figure_text(&self->figure, "%s%s%zu higher mode%s", rest, *rest ? ", " : ": ",
                             self->higher, self->higher > 1 ? "s" : "");
  if (*rest)
    strut_add_key(&self->figure, STRUT_KEY_WORDS, grey,
                  strut_figure_text(&self->figure, "not drawn%s", rest));
}

strut_status strut_modes_figure(const strut_plot *plot, const strut_model *model,
                                const strut_modes *modes, size_t panels, strut_error *error) {
  mode_picture p = {.model = model,
                    .modes = modes,
                    .figure = {.title = model->scene->name,
                               .columns = MOST,
                               .least_width = NARROWEST,
                               .aspect = 0.95,
                               .shared_axes = true}};
  choose_modes(&p, panels);
  add_modes(&p);
  add_keys(&p);
  p.figure.scale = strut_force_scale(1, NULL);
  p.figure.scale.name = "strain, of the mode's largest", p.figure.scale.unit = "";
  return strut_figure_draw(plot, &p.figure, error);
}

/* ---- waves ---- */

/* Over one step the phase itself; over two the place on the line, with its corners by name. */
static const char *name_axis(const strut_waves *waves, strut_figure *figure) {
  const char *text = "wave vector:";
  if (waves->steps == 1) return "phase from cell to cell in turns";
  for (int32_t i = 0; i < waves->corner_count && waves->steps == 2; i++)
    text = strut_figure_text(figure, "%s%s %s at %d", text, i ? "," : "",
                             waves->corner[i].name[0] == 'G' ? "\u0393" : waves->corner[i].name,
                             (int)i);
  return text;
}

strut_status strut_waves_figure(const strut_plot *plot, const strut_model *model,
                                const strut_waves *waves, strut_error *error) {
  strut_figure figure = {.title = model->scene->name};
  strut_panel *panel = strut_add_panel(&figure);
  bool one = waves->steps == 1;
  for (int32_t b = 0; b < waves->shown; b++) {
    strut_series *series = strut_add_series(&figure, panel, NULL);
    series->look = 0;
    series->unmarked = true;
    for (size_t i = 0; i < waves->count; i++)
      strut_add_point(&figure, series, one ? waves->phase[i][0] : waves->along[i],
                      waves->frequency[i * (size_t)waves->band_count + (size_t)b]);
  }
  for (size_t g = 0; g < waves->gap_count; g++)
    if (waves->gaps[g].below < waves->shown)
      strut_add_band(&figure, panel, waves->gaps[g].low, waves->gaps[g].high, "no waves")->level =
          true;
  panel->x = (strut_axis){.name = name_axis(waves, &figure),
                          .high = one ? 0.5 : waves->corner_count - 1.0};
  panel->y = strut_axis_of("frequency", "Hz");
  return strut_figure_draw(plot, &figure, error);
}

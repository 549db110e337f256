/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/statics_figures.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/forces/elements.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/draw/chart.h"
#include "engine/output/draw/legend.h"
#include "engine/output/draw/structure.h"

static const double EDGE = 5, MARGIN = 24, SCALE = 46;
/* Narrower figures have the colour bar below the drawing and no names. */
enum { NOTE = 400 };
static const double NARROW = 170, FOOT = 50, LEAST_MARGIN = 8;

/* Member forces at the start, of cables that only pull, by rest lengths. Returns the largest. */
static double find_forces(const strut_model *model, double *force) {
  double most = 0;
  for (size_t j = 0; j < model->scene->member_count; j++) {
    force[j] = strut_member_elastic_tension(model, model->members.rest, (int32_t)j, model->start);
    most = fmax(most, fabs(force[j]));
  }
  return most;
}

static double farthest(const strut_model *model, const double (*drawn)[2]) {
  double most = 0;
  for (int32_t i = 0; i < model->node_count; i++)
    most =
        fmax(most, hypot(model->start[2 * i] - drawn[i][0], model->start[2 * i + 1] - drawn[i][1]));
  return most;
}

/* A shape that was found, beside the one that was drawn. */
typedef struct found_form {
  const strut_model *model;
  const double *before; /* (length) as drawn */
  const double *force;  /* (members) */
  double limit, moved;  /* the largest of them; the way of the node that went farthest [m] */
  strut_bounds bounds;
  strut_heading heading;
  double head; /* its height [pt] */
} found_form;

static bool is_as_drawn(const found_form *form) { return form->moved <= 1e-9 * form->model->size; }

/* The heading, whose note is written to `text`, and its height. */
static strut_status describe_form(found_form *form, double width, const char *title,
                                  char text[NOTE], strut_error *error) {
  if (is_as_drawn(form))
    snprintf(text, NOTE, "the drawn shape, and the forces that hold it");
  else
    snprintf(text, NOTE, "grey: drawn shape; nodes moved by up to %s",
             strut_drawn_quantity(form->moved, 3, "m").text);
  form->heading = (strut_heading){.width = width, .edge = EDGE, .title = title, .note = text};
  return strut_heading_measure(&form->heading, &form->head, error);
}

static void draw_form(strut_canvas *canvas, const found_form *form) {
  const strut_model *model = form->model;
  strut_box page = strut_canvas_box(canvas);
  double inner = page.width - 2 * EDGE, limit = form->limit;
  bool narrow = page.width < NARROW;
  strut_box box = {EDGE, EDGE + form->head, inner - (narrow ? 0 : SCALE),
                   page.height - 2 * EDGE - form->head - (narrow ? FOOT : 0)};
  strut_window window = strut_window_fit(box, form->bounds, narrow ? LEAST_MARGIN : MARGIN);
  strut_heading_draw(canvas, &form->heading);
  const strut_structure_style pale = {.colouring = STRUT_COLOUR_ONE,
                                      .colour = strut_grey(0.75),
                                      .thinness = 0.4,
                                      .no_nodes = true,
                                      .no_supports = true};
  const strut_structure_style full = {.colouring = STRUT_COLOUR_FORCE,
                                      .values = form->force,
                                      .slack_forces = form->force,
                                      .limit = limit,
                                      .node_names = !narrow};
  strut_draw_ground(canvas, &window, model);
  if (!is_as_drawn(form)) strut_draw_structure(canvas, &window, model, form->before, &pale);
  strut_draw_structure(canvas, &window, model, model->start, &full);
  if (narrow) window.box.height += 14;
  strut_draw_yardstick(canvas, &window);
  const strut_colour_scale scale = {
      .name = "force", .unit = "N", .low = -limit, .high = limit, .colours = STRUT_COLOURS_SIGNED};
  const strut_box beside = {EDGE + inner - SCALE + 6, box.y + 4, SCALE - 6,
                            fmin(box.height - 8, 130)};
  const strut_box below = {EDGE, box.y + box.height + FOOT - 34, inner, 34};
  if (limit > 0) strut_draw_colour_scale(canvas, narrow ? below : beside, &scale);
}

strut_status strut_form_figure(const strut_plot *plot, const strut_model *model,
                               const double (*drawn)[2], strut_error *error) {
  strut_arena arena = {0};
  strut_canvas *canvas = NULL;
  const char *title = strut_plot_title(plot, model->scene->name);
  double width = plot->width;
  double *before = strut_arena_allocate(&arena, (size_t)model->length, sizeof *before);
  double *force = strut_arena_allocate(&arena, model->scene->member_count + 1, sizeof *force);
  if (!before || !force) {
    strut_arena_free(&arena);
    return strut_no_memory(error, "while drawing");
  }
  memcpy(before, drawn, (size_t)model->node_count * sizeof *drawn);
  strut_bounds bounds = strut_bounds_none();
  strut_bounds_add(&bounds, model, before);
  strut_bounds_add(&bounds, model, model->start);
  bool narrow = width < NARROW;
  double margin = narrow ? LEAST_MARGIN : MARGIN, limit = find_forces(model, force);
  double room = width - 2 * EDGE - (narrow ? 0 : SCALE) - 2 * margin;
  double aspect = (bounds.high[1] - bounds.low[1]) / (bounds.high[0] - bounds.low[0]);
  double high = room * (aspect >= 0 && aspect < 10 ? aspect : 1) + 2 * margin;
  high = fmax(0.25 * width, fmin(high, 0.9 * width)) + (narrow ? FOOT : 0);
  char note[NOTE];
  found_form form = {.model = model,
                     .before = before,
                     .force = force,
                     .limit = limit,
                     .moved = farthest(model, drawn),
                     .bounds = bounds};
  strut_status status = describe_form(&form, width, title, note, error);
  if (status == STRUT_OK)
    status =
        strut_canvas_open(plot->path, width, 2 * EDGE + form.head + high, title, &canvas, error);
  if (status == STRUT_OK) {
    draw_form(canvas, &form);
    status = strut_canvas_commit(canvas, error);
  }
  strut_canvas_free(canvas);
  strut_arena_free(&arena);
  return status;
}

static const double LINE = 12, PANEL_MARGIN = 18, PANEL_NARROW = 110, PANEL_SCALE = 34;
static const double SWING = 0.12; /* the largest motion as drawn, of the larger extent */
enum { ROWS = 4, COLUMNS = 3 };

/* Contents of the panels, in this order. */
typedef struct plan {
  const char *title;
  const strut_model *model;
  const double *q;
  const strut_rigidity *rigidity;
  double width, size[2], cell[2];
  strut_bounds bounds;
  int32_t forces, states, motions; /* panels of each */
  size_t columns, rows;
  double *moved; /* (length) scratch */
  strut_heading heading;
  double head; /* its height [pt] */
} plan;

static int32_t panels_of(const plan *p) { return p->forces + p->states + p->motions; }

/* True if member forces exceed the effect of rounding in their lengths. */
static bool forces_told(const plan *p) {
  double most = 0, scale = 0;
  for (size_t j = 0; j < p->model->scene->member_count; j++) {
    const strut_member_table *m = &p->model->members;
    most = fmax(most, fabs(p->rigidity->force[j]));
    scale = fmax(scale, m->stiffness[j] * m->rest[j]);
  }
  return p->rigidity->prestressed && most > 1e-12 * scale;
}

/* As many as go in; states and mechanisms share the room. */
static void choose_panels(plan *p) {
  const strut_rigidity *r = p->rigidity;
  int32_t room = (int32_t)p->columns * ROWS;
  p->forces = forces_told(p) ? 1 : 0;
  p->states = r->states.force ? r->states.count : 0;
  p->motions = r->mechanisms.list ? r->mechanisms.count : 0;
  if (panels_of(p) <= room) return;
  room -= p->forces;
  int32_t motions = p->motions < room / 2 ? p->motions : room / 2; /* at least, if states abound */
  if (p->states > room - motions) p->states = room - motions;
  if (p->motions > room - p->states) p->motions = room - p->states;
}

static void lay_out_panels(plan *p) {
  double inner = p->width - 2 * EDGE;
  p->columns = (size_t)fmax(1, fmin(COLUMNS, floor(inner / PANEL_NARROW)));
  choose_panels(p);
  size_t panels = panels_of(p) > 0 ? (size_t)panels_of(p) : 1;
  if (p->columns > panels) p->columns = panels;
  p->rows = (panels + p->columns - 1) / p->columns;
  p->cell[0] = inner / (double)p->columns;
  p->bounds = strut_bounds_none();
  strut_bounds_add(&p->bounds, p->model, p->q);
  for (int d = 0; d < 2; d++) p->size[d] = p->bounds.high[d] - p->bounds.low[d];
  double swing = SWING * fmax(p->size[0], p->size[1]); /* there is room for motions */
  for (int d = 0; d < 2 && p->motions > 0; d++) {
    p->bounds.low[d] -= swing;
    p->bounds.high[d] += swing;
    p->size[d] += 2 * swing;
  }
  double aspect = p->size[0] > 0 ? p->size[1] / p->size[0] : 1;
  double wanted = (p->cell[0] - 2 * PANEL_MARGIN) * aspect + 2 * PANEL_MARGIN;
  p->cell[1] = LINE + fmax(50, fmin(wanted, 1.3 * p->cell[0]));
}

static double largest(const double *values, size_t count) {
  double most = 0;
  for (size_t i = 0; i < count; i++) most = fmax(most, fabs(values[i]));
  return most;
}

static void draw_forces(const plan *p, strut_canvas *canvas, const strut_window *window,
                        const double *force) {
  double limit = largest(force, p->model->scene->member_count);
  const strut_structure_style style = {.colouring = STRUT_COLOUR_FORCE,
                                       .values = force,
                                       .slack_forces = force,
                                       .limit = limit,
                                       .node_names = p->cell[0] > 105};
  strut_draw_structure(canvas, window, p->model, p->q, &style);
}

/* The shape in grey, displaced by a small motion, with an arrow at each node. */
static void draw_motion(const plan *p, strut_canvas *canvas, const strut_window *window,
                        const double *motion) {
  const strut_equilibrium_matrix *a = &p->rigidity->matrix;
  double most = 0, extent = fmax(p->size[0], p->size[1]) / (1 + 2 * SWING);
  memcpy(p->moved, p->q, (size_t)p->model->length * sizeof *p->moved);
  for (int32_t i = 0; i < p->model->node_count; i++) p->moved[2 * i] = p->q[2 * i];
  for (int32_t r = 0; r < a->rows; r++) most = fmax(most, fabs(motion[r]));
  double scale = most > 0 ? SWING * extent / most : 0;
  for (int32_t r = 0; r < a->rows; r++) p->moved[a->coordinate[r]] += scale * motion[r];
  const strut_structure_style pale = {
      .colouring = STRUT_COLOUR_ONE, .colour = strut_grey(0.72), .thinness = 0.5, .no_nodes = true};
  const strut_structure_style there = {.colouring = STRUT_COLOUR_ONE,
                                       .colour = strut_palette_thing(0),
                                       .thinness = 0.8,
                                       .no_nodes = true,
                                       .no_supports = true};
  strut_draw_structure(canvas, window, p->model, p->q, &pale);
  strut_draw_structure(canvas, window, p->model, p->moved, &there);
  for (int32_t i = 0; i < p->model->node_count && p->model->node_count <= 200; i++) {
    double from[2], to[2];
    strut_window_point(window, p->q + 2 * i, from);
    strut_window_point(window, p->moved + 2 * i, to);
    if (hypot(to[0] - from[0], to[1] - from[1]) > 2)
      strut_draw_arrow(canvas, from[0], from[1], to[0], to[1], 5,
                       (strut_pen){.colour = strut_palette_thing(1), .width = 0.9});
  }
}

static void panel_text(const plan *p, int32_t k, char *text, size_t size) {
  const strut_rigidity *r = p->rigidity;
  if (k < p->forces) {
    snprintf(text, size, "forces, up to %s",
             strut_drawn_quantity(largest(r->force, p->model->scene->member_count), 3, "N").text);
  } else if (k < p->forces + p->states) {
    int32_t state = k - p->forces;
    snprintf(text, size, "self-stress %d%s", (int)state + 1,
             r->has_cables && !r->states.cables_pull[state] ? ", presses cables" : "");
  } else {
    int32_t motion = k - p->forces - p->states;
    snprintf(text, size, "mechanism %d, %s", (int)motion + 1,
             strut_motion_kind_name(r->mechanisms.list[motion].kind));
  }
}

static void draw_panel(const plan *p, strut_canvas *canvas, int32_t k, strut_box cell) {
  char text[200], fitted[STRUT_FITTED_TEXT];
  strut_font font = {.size = 8};
  strut_box box = {cell.x, cell.y + LINE, cell.width, cell.height - LINE};
  strut_window window = strut_window_fit(box, p->bounds, PANEL_MARGIN);
  panel_text(p, k, text, sizeof text);
  strut_draw_text(canvas, cell.x + 4, cell.y,
                  strut_text_fit(canvas, text, font, cell.width - 8, 0, fitted), font);
  strut_canvas_clip(canvas, cell);
  if (k < p->forces) {
    draw_forces(p, canvas, &window, p->rigidity->force);
  } else if (k < p->forces + p->states) {
    size_t state = (size_t)(k - p->forces);
    draw_forces(p, canvas, &window,
                p->rigidity->states.force + state * (size_t)p->rigidity->matrix.columns);
  } else {
    draw_motion(p, canvas, &window, p->rigidity->mechanisms.list[k - p->forces - p->states].motion);
  }
  strut_canvas_unclip(canvas);
}

/* The heading, whose note is written to `text`, and its height. */
static strut_status describe_rigidity(plan *p, const char *at, char text[NOTE],
                                      strut_error *error) {
  const strut_rigidity *r = p->rigidity;
  int32_t left_out = r->states.count - p->states + r->mechanisms.count - p->motions;

  int used = snprintf(text, NOTE, "%s: %d state%s of self-stress, %d mechanism%s", at,
                      (int)r->states.count, r->states.count == 1 ? "" : "s",
                      (int)r->mechanisms.count, r->mechanisms.count == 1 ? "" : "s");
  if (left_out > 0) snprintf(text + used, NOTE - (size_t)used, "; %d not drawn", (int)left_out);
  p->heading = (strut_heading){.width = p->width, .edge = EDGE, .title = p->title, .note = text};
  return strut_heading_measure(&p->heading, &p->head, error);
}

static void draw_figure(const plan *p, strut_canvas *canvas) {
  strut_heading_draw(canvas, &p->heading);
  for (int32_t k = 0; k < panels_of(p); k++) {
    size_t row = (size_t)k / p->columns, column = (size_t)k % p->columns;
    draw_panel(p, canvas, k,
               (strut_box){EDGE + (double)column * p->cell[0],
                           EDGE + p->head + (double)row * p->cell[1], p->cell[0], p->cell[1]});
  }
  double y = EDGE + p->head + (double)p->rows * p->cell[1];
  strut_box cell = {EDGE, EDGE + p->head, p->cell[0], p->cell[1]};
  if (panels_of(p) == 0) { /* nothing holds and nothing moves: the shape itself */
    strut_window window = strut_window_fit(cell, p->bounds, PANEL_MARGIN);
    strut_draw_structure(canvas, &window, p->model, p->q,
                         &(strut_structure_style){.node_names = true});
  }
  strut_window foot = strut_window_fit((strut_box){EDGE, y, p->cell[0], p->cell[1] - LINE},
                                       p->bounds, PANEL_MARGIN);
  foot.box.y = y + PANEL_SCALE - 8 - foot.box.height;
  strut_draw_yardstick(canvas, &foot);
  double wide = fmin(170, 0.5 * (p->width - 2 * EDGE));
  const strut_colour_scale scale = {.name = "force, of the largest",
                                    .unit = "",
                                    .low = -1,
                                    .high = 1,
                                    .colours = STRUT_COLOURS_SIGNED};
  if (p->forces + p->states > 0)
    strut_draw_colour_scale(canvas, (strut_box){p->width - EDGE - wide, y, wide, PANEL_SCALE},
                            &scale);
}

strut_status strut_rigidity_figure(const strut_plot *plot, const strut_model *model,
                                   const double *q, const char *at, const strut_rigidity *rigidity,
                                   strut_error *error) {
  plan p = {.model = model,
            .q = q,
            .rigidity = rigidity,
            .width = plot->width,
            .title = strut_plot_title(plot, model->scene->name)};
  strut_arena arena = {0};
  strut_canvas *canvas = NULL;
  char note[NOTE];
  p.moved = strut_arena_allocate(&arena, (size_t)model->length, sizeof *p.moved);
  strut_status status = p.moved ? STRUT_OK : strut_no_memory(error, "while drawing");
  if (status == STRUT_OK) {
    lay_out_panels(&p);
    status = describe_rigidity(&p, at, note, error);
  }
  if (status == STRUT_OK) {
    double height = 2 * EDGE + p.head + (double)p.rows * p.cell[1] + PANEL_SCALE;
    status = strut_canvas_open(plot->path, plot->width, height, p.title, &canvas, error);
  }
  if (status == STRUT_OK) {
    draw_figure(&p, canvas);
    status = strut_canvas_commit(canvas, error);
  }
  strut_canvas_free(canvas);
  strut_arena_free(&arena);
  return status;
}

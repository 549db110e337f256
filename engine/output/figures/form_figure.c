/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/elements.h"
#include "engine/output/figures/statics_figures.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/draw/canvas.h"
#include "engine/output/draw/chart.h"
#include "engine/output/draw/legend.h"
#include "engine/output/draw/structure.h"

static const double EDGE = 5, TITLE = 28, MARGIN = 24, SCALE = 46;
/* Narrower figures have the colour bar below the drawing and no names. */
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

static void draw_form(strut_canvas *canvas, const char *title, const strut_model *model,
                      const double *before, const double (*drawn)[2], const double *force,
                      double limit, strut_bounds bounds) {
  strut_box page = strut_canvas_box(canvas);
  double inner = page.width - 2 * EDGE, moved = farthest(model, drawn);
  bool narrow = page.width < NARROW;
  strut_box box = {EDGE, EDGE + TITLE, inner - (narrow ? 0 : SCALE),
                   page.height - 2 * EDGE - TITLE - (narrow ? FOOT : 0)};
  strut_window window = strut_window_fit(box, bounds, narrow ? LEAST_MARGIN : MARGIN);
  char text[200];
  bool same = moved <= 1e-9 * model->size;
  if (same) {
    snprintf(text, sizeof text, "the drawn shape, and the forces that hold it");
  } else {
    snprintf(text, sizeof text, "grey: drawn shape; nodes moved by up to %s",
             strut_drawn_quantity(moved, 3, "m").text);
  }
  strut_draw_heading(canvas, EDGE, title, text);
  const strut_structure_style pale = {.colouring = STRUT_COLOUR_ONE,
                                      .colour = strut_grey(0.75),
                                      .thinness = 0.4,
                                      .no_nodes = true,
                                      .no_supports = true};
  const strut_structure_style full = {.colouring = STRUT_COLOUR_FORCE,
                                      .values = force,
                                      .slack_forces = force,
                                      .limit = limit,
                                      .node_names = !narrow};
  strut_draw_ground(canvas, &window, model);
  if (!same) strut_draw_structure(canvas, &window, model, before, &pale);
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
  strut_status status =
      strut_canvas_open(plot->path, width, 2 * EDGE + TITLE + high, title, &canvas, error);
  if (status == STRUT_OK) {
    draw_form(canvas, title, model, before, drawn, force, limit, bounds);
    status = strut_canvas_commit(canvas, error);
  }
  strut_canvas_free(canvas);
  strut_arena_free(&arena);
  return status;
}

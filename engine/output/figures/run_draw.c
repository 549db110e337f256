/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What several views of a run draw: titles, shapes, reactions, ways, names. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/draw/palette.h"
#include "engine/output/figures/run_parts.h"

enum { MOST_NAMES = 30, MOST_AVOIDED = 1500, WAY_PIECES = 40, LINE = 600 };

static const double DOT = 0.3;       /* [pt] */
static const double STANDING = 1e-6; /* of the model's size over the whole run: it does not move */

void strut_run_expect_frame(strut_run_scene *run, size_t frame) {
  const strut_trajectory *m = run->motion;
  for (size_t i = 0; m->contact && i < 2 * m->contact_count; i++) {
    double force = fabs(m->contact[2 * frame * m->contact_count + i]);
    if (isfinite(force)) run->contact_limit = fmax(run->contact_limit, force);
  }
}

bool strut_run_draw_frame(strut_run_scene *run, strut_canvas *canvas, const strut_window *window,
                          size_t frame) {
  const strut_trajectory *m = run->motion;
  double *q = strut_run_shape(run, frame);
  if (!q) return false;
  strut_structure_style style = {.colouring = STRUT_COLOUR_KIND};
  if (m->force) {
    style.colouring = STRUT_COLOUR_FORCE;
    style.values = style.slack_forces = m->force + frame * m->member_count;
    style.limit = run->force_limit;
  }
  strut_draw_ground(canvas, window, run->model);
  strut_draw_structure(canvas, window, run->model, q, &style);
  return true;
}

/* Keeps names off a line; without memory, or with very many, they are not kept off. */
static void avoid(strut_run_scene *run, const double from[2], const double to[2]) {
  if (!run->avoid)
    run->avoid = strut_arena_allocate(&run->arena, 2 * MOST_AVOIDED, sizeof *run->avoid);
  if (!run->avoid || run->avoid_count == MOST_AVOIDED) return;
  memcpy(run->avoid[2 * run->avoid_count], from, sizeof *run->avoid);
  memcpy(run->avoid[2 * run->avoid_count + 1], to, sizeof *run->avoid);
  run->avoid_count++;
}

void strut_run_draw_reactions(strut_run_scene *run, strut_canvas *canvas,
                              const strut_window *window, size_t frame) {
  const strut_trajectory *m = run->motion;
  const strut_contact_table *contacts = &run->model->contacts;
  const double *q = strut_run_positions(run, frame);
  if (!m->contact || !(run->contact_limit > 0)) return;
  const double *force = m->contact + 2 * frame * m->contact_count;
  strut_draw_contact_forces(canvas, window, run->model, q, (const double(*)[2])force,
                            run->contact_limit, run->arrow);
  for (int32_t i = 0; i < contacts->count; i++) {
    double at[2], length = force[2 * i] / run->contact_limit * run->arrow;
    strut_window_point(window, q + contacts->at[i], at);
    const double foot[2] = {at[0] - length * contacts->normal[0],
                            at[1] + length * contacts->normal[1]};
    if (length > 1) avoid(run, foot, at);
    length = force[2 * i + 1] / run->contact_limit * run->arrow;
    const double tip[2] = {at[0] + length * contacts->tangent[0],
                           at[1] - length * contacts->tangent[1]};
    if (fabs(length) > 1) avoid(run, at, tip);
  }
}

/* Whether a way is longer than a dot on the page. */
static bool is_seen(const strut_window *window, const double (*way)[2], size_t count) {
  double first[2], at[2];
  for (size_t i = 0; i < count; i++) {
    strut_window_point(window, way[i], i ? at : first);
    if (i && hypot(at[0] - first[0], at[1] - first[1]) > DOT) return true;
  }
  return false;
}

void strut_run_draw_path(strut_run_scene *run, strut_canvas *canvas, const strut_window *window,
                         const double (*way)[2], size_t count, double width) {
  double before[2], at[2];
  if (!is_seen(window, way, count)) return;
  strut_canvas_clip(canvas, window->box);
  strut_draw_trail(canvas, window, way, count, width);
  strut_canvas_unclip(canvas);
  for (size_t i = 0; i <= WAY_PIECES && count > 1; i++) {
    strut_window_point(window, way[i * (count - 1) / WAY_PIECES], at);
    if (i > 0 && hypot(at[0] - before[0], at[1] - before[1]) > 0.5) avoid(run, before, at);
    if (i > 0 && hypot(at[0] - before[0], at[1] - before[1]) <= 0.5) continue;
    memcpy(before, at, sizeof before);
  }
}

void strut_run_draw_names(strut_run_scene *run, strut_canvas *canvas, const strut_window *window,
                          const double *q) {
  if (run->model->node_count <= MOST_NAMES)
    strut_draw_names(canvas, window, run->model, q, true, false, (const double(*)[2])run->avoid,
                     run->avoid_count);
  run->avoid_count = 0;
}

void strut_run_draw_scale(const strut_run_scene *run, strut_canvas *canvas, strut_box box) {
  const strut_colour_scale scale = {.name = "force",
                                    .unit = "N",
                                    .low = -run->force_limit,
                                    .high = run->force_limit,
                                    .colours = STRUT_COLOURS_SIGNED};
  if (run->motion->force && run->force_limit > 0) strut_draw_colour_scale(canvas, box, &scale);
}

bool strut_run_arrow_item(const strut_run_scene *run, char text[120], strut_key_item *item) {
  if (!(run->contact_limit > 0)) return false;
  snprintf(text, 120, "force of the ground, %s at most",
           strut_drawn_quantity(run->contact_limit, 3, "N").text);
  *item = (strut_key_item){.sign = STRUT_KEY_ARROW,
                           .pen = {.colour = strut_palette_thing(1), .width = 1.1},
                           .text = text};
  return true;
}

/* The velocity, 0 where nothing moved to speak of. */
static double velocity_of(const strut_run_scene *run) {
  const strut_summary *s = run->summary;
  double way = fabs(s->velocity) * fmax(s->duration, STRUT_RUN_MOMENT);
  return way > STANDING * run->model->size ? s->velocity : 0;
}

/* Adds the velocity to the line, with the point's name where that leaves it short enough. */
static void say_velocity(const strut_run_scene *run, strut_canvas *canvas, double velocity,
                         double room, strut_font font, char line[LINE]) {
  size_t used = strlen(line);
  double width, height;
  strut_quantity text = strut_drawn_quantity(velocity, 4, "m/s");
  snprintf(line + used, LINE - used, "; velocity of %s %s", strut_run_measured_name(run),
           text.text);
  strut_text_size(canvas, line, font, &width, &height);
  if (width > room) snprintf(line + used, LINE - used, "; velocity %s", text.text);
}

void strut_run_draw_title(const strut_run_scene *run, strut_canvas *canvas, const char *what,
                          bool velocity) {
  const strut_summary *s = run->summary;
  double room = strut_canvas_box(canvas).width - 2 * STRUT_RUN_EDGE, width, height;
  const double arrow = 18, x = STRUT_RUN_EDGE, y = STRUT_RUN_EDGE + 12;
  char line[LINE], fitted[STRUT_FITTED_TEXT];
  const strut_font title = {.size = 9, .bold = true};
  strut_font below = {.size = 8, .colour = strut_grey(0.3)};
  bool failed = s && s->status != STRUT_OK;
  if (failed) below.colour = strut_palette_thing(1);
  velocity = velocity && !failed && s && isfinite(s->velocity);
  double v = velocity ? velocity_of(run) : 0;
  if (failed)
    snprintf(line, sizeof line, "%s at %s; %s",
             s->status == STRUT_DIVERGED ? "diverged" : "stopped",
             strut_drawn_quantity(s->duration, 4, "s").text, what);
  else
    snprintf(line, sizeof line, "%s", what);
  if (velocity) say_velocity(run, canvas, v, v != 0 ? room - arrow - 6 : room, below, line);
  strut_draw_text(canvas, x, STRUT_RUN_EDGE,
                  strut_text_fit(canvas, run->model->scene->name, title, room, 0, fitted), title);
  strut_text_fit(canvas, line, below, v != 0 ? room - arrow - 6 : room, 0, fitted);
  strut_draw_text(canvas, x, y, fitted, below);
  if (v == 0) return;
  strut_text_size(canvas, fitted, below, &width, &height);
  double left = x + width + 5, right = left + arrow, middle = y + 0.5 * height;
  strut_draw_arrow(canvas, v > 0 ? left : right, middle, v > 0 ? right : left, middle, 5,
                   (strut_pen){.colour = strut_grey(0.3), .width = 1.1});
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What stands beside members in a drawing: cells, bodies, hinges, stops, distances, feet, guides; grounds. */
#include "engine/output/draw/structure_parts.h"

#include <math.h>

#include "engine/base/memory.h"
#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/output/draw/legend.h"
#include "engine/scene/profile.h"

enum { ARC = 24 };                           /* pieces of a hinge's arc */
static const double HINGE = 7.0, STOP = 4.0; /* radius of the arc, half a stop's bar [pt] */

strut_colour strut_thing_colour(const strut_drawing *drawing, double alpha) {
  bool one = drawing->style->colouring == STRUT_COLOUR_ONE;
  return strut_faded(one ? drawing->style->colour : strut_palette_thing(2),
                     alpha * drawing->opacity);
}

/* A line on the page through (count) places of the plane. */
static void draw_places(strut_canvas *canvas, const strut_drawing *drawing, double (*places)[2],
                        size_t count, strut_pen pen) {
  for (size_t k = 0; k < count; k++) strut_window_point(drawing->window, places[k], places[k]);
  strut_draw_line(canvas, (const double(*)[2])places, count, pen);
}

/* A hinge: an arc around its node, from the first arm to the second by its angle. */
static void draw_hinge(strut_canvas *canvas, const strut_drawing *drawing, const strut_hinge *hinge,
                       double angle, strut_pen pen) {
  const double *q = drawing->q, *at = q + 2 * hinge->node[1], *from = q + 2 * hinge->node[0];
  double arc[ARC + 1][2],
      arm = fmin(strut_distance(from, at), strut_distance(at, q + 2 * hinge->node[2]));
  double radius = fmin(HINGE * drawing->thin / drawing->window->scale, 0.4 * arm);
  double first = atan2(from[1] - at[1], from[0] - at[0]);
  angle = fmax(-STRUT_TAU, fmin(STRUT_TAU, angle));
  for (int i = 0; i <= ARC; i++) {
    arc[i][0] = at[0] + radius * cos(first + angle * i / ARC);
    arc[i][1] = at[1] + radius * sin(first + angle * i / ARC);
  }
  draw_places(canvas, drawing, arc, ARC + 1, pen);
}

/* A stop that acts: a bar across the middle of its member. */
static void draw_stop(strut_canvas *canvas, const strut_drawing *drawing, size_t member,
                      strut_pen pen) {
  double ends[2][2];
  strut_longest_segment(drawing->window, drawing->model, drawing->q, member, ends);
  double length = strut_distance(ends[0], ends[1]), half = STOP * drawing->thin / length;
  double x = half * (ends[1][0] - ends[0][0]), y = half * (ends[1][1] - ends[0][1]);
  double middle[2] = {0.5 * (ends[0][0] + ends[1][0]), 0.5 * (ends[0][1] + ends[1][1])};
  strut_draw_segment(canvas, middle[0] - y, middle[1] + x, middle[0] + y, middle[1] - x, pen);
}

/* Cells: filled polygons below all else. */
void strut_draw_cells(strut_canvas *canvas, const strut_drawing *drawing) {
  const strut_scene *scene = drawing->model->scene;
  const strut_fill fill = {.colour = strut_thing_colour(drawing, 0.15)};
  const strut_pen pen = {.colour = strut_thing_colour(drawing, 0.5), .width = 0.5 * drawing->thin};
  double corner[STRUT_MOST_ELEMENT_NODES][2];
  for (size_t i = 0; i < scene->cell_count; i++) {
    const strut_cell *cell = &scene->cells[i];
    for (size_t k = 0; k < cell->node_count; k++)
      strut_window_point(drawing->window, drawing->q + 2 * cell->node[k], corner[k]);
    strut_draw_polygon(canvas, (const double(*)[2])corner, cell->node_count, &fill, &pen);
  }
}

/* Bodies that may collide: discs or rods with round ends, as thick as they are. */
void strut_draw_collisions(strut_canvas *canvas, const strut_drawing *drawing) {
  const strut_scene *scene = drawing->model->scene;
  const strut_fill fill = {.colour = strut_thing_colour(drawing, 0.15)};
  double ends[2][2];
  for (size_t i = 0; i < 2 * scene->collision_count; i++) {
    const strut_collision *collision = &scene->collisions[i / 2];
    int32_t node = collision->node[i % 2], member = collision->member[i % 2];
    double width = collision->thickness * drawing->window->scale;
    if (node >= 0)
      strut_draw_round(canvas, drawing, drawing->q + 2 * node, 0.5 * width, &fill, NULL);
    if (member < 0) continue;
    strut_window_segment(drawing->window, drawing->model, drawing->q, (size_t)member, 0, ends);
    strut_draw_line(canvas, (const double(*)[2])ends, 2,
                    (strut_pen){.colour = fill.colour, .width = width});
  }
}

/* A dashed line along which the distance is measured: to the first node's foot, then to the second. */
static void draw_distance(strut_canvas *canvas, const strut_drawing *drawing, int32_t element,
                          const strut_element_pose *pose, strut_pen pen) {
  const strut_element *e = &drawing->model->elements.element[element];
  const uint32_t *at = drawing->model->elements.at + e->first;
  bool line = e->strain == STRUT_STRAIN_OFFSET;
  double side = line ? -pose->strain : pose->strain, way[3][2];
  for (int c = 0; c < 2; c++) {
    way[0][c] = drawing->q[at[0] + (uint32_t)c];
    way[1][c] = way[0][c] + side * pose->b[line ? c : 2 + c];
    way[2][c] = line ? way[1][c] : drawing->q[at[1] + (uint32_t)c];
  }
  pen.dash[0] = pen.dash[1] = 2.0 * pen.width;
  draw_places(canvas, drawing, way, 3, pen);
}

/* The arc of a foot, as far as it may meet the ground while its member stands. */
static void draw_foot(strut_canvas *canvas, const strut_drawing *drawing, int32_t element,
                      strut_pen pen) {
  enum { POINTS = 33 };
  const strut_element *e = &drawing->model->elements.element[element];
  const uint32_t *at = drawing->model->elements.at + e->first;
  const double *from = drawing->q + at[0], *to = drawing->q + at[1];
  double length = strut_distance(from, to), way[POINTS][2];
  double ux = (to[0] - from[0]) / length, uy = (to[1] - from[1]) / length;
  for (int k = 0; k < POINTS; k++) {
    double angle = STRUT_PI * (0.8 * k / (POINTS - 1) - 0.4), c = cos(angle), s = sin(angle);
    way[k][0] = from[0] + e->radius * (ux - (c * ux - s * uy));
    way[k][1] = from[1] + e->radius * (uy - (s * ux + c * uy));
  }
  draw_places(canvas, drawing, way, POINTS, pen);
}

/* Circles of a cable's guides. */
static void draw_guides(strut_canvas *canvas, const strut_drawing *drawing, int32_t element) {
  const strut_element_table *elements = &drawing->model->elements;
  const strut_element *e = &elements->element[element];
  const strut_fill fill = {.colour = strut_faded(strut_grey(0.93), drawing->opacity)};
  const strut_pen pen = {.colour = strut_faded(strut_grey(0.5), drawing->opacity),
                         .width = 0.6 * drawing->thin};
  for (int32_t k = 1; k + 1 < e->nodes; k++)
    strut_draw_round(canvas, drawing, drawing->q + elements->at[e->first + k],
                     e->radius * drawing->window->scale, &fill, &pen);
}

void strut_draw_elements(strut_canvas *canvas, const strut_drawing *drawing) {
  strut_pen pen = {.colour = strut_thing_colour(drawing, 1)};
  strut_element_pose pose;
  for (int32_t i = 0; i < drawing->model->elements.count; i++) {
    const strut_element *element = &drawing->model->elements.element[i];
    if (element->strain == STRUT_STRAIN_WRAP && element->role == STRUT_ELEMENT_MEMBER)
      draw_guides(canvas, drawing, i);
    if (element->role == STRUT_ELEMENT_MEMBER || element->role == STRUT_ELEMENT_CELL ||
        element->role == STRUT_ELEMENT_COLLISION || element->role == STRUT_ELEMENT_CONTACT ||
        element->role == STRUT_ELEMENT_LOAD)
      continue;
    strut_element_evaluate(drawing->model, i, drawing->model->members.rest, drawing->q, (double)NAN,
                           &pose);
    bool thin = element->role == STRUT_ELEMENT_HINGE || element->role == STRUT_ELEMENT_DISTANCE;
    pen.width = (thin ? 1.0 : 1.6) * drawing->thin / (1 + drawing->style->thinness);
    if (element->role == STRUT_ELEMENT_DISTANCE)
      draw_distance(canvas, drawing, i, &pose, pen);
    else if (element->role == STRUT_ELEMENT_FOOT)
      draw_foot(canvas, drawing, i, pen);
    else if (element->role == STRUT_ELEMENT_HINGE)
      draw_hinge(canvas, drawing, &drawing->model->scene->hinges[element->item], pose.strain, pen);
    else if (pose.acts)
      draw_stop(canvas, drawing, (size_t)element->item, pen);
  }
}

/* ---- grounds ---- */

static const double DEPTH = 8.0; /* of the hatching below a surface [pt] */

/* Hatching to the right of each segment of (count) points on the page. */
static void hatch_below(strut_canvas *canvas, const double (*points)[2], size_t count) {
  const strut_fill fill = {
      .colour = strut_grey(0.95), .hatch = STRUT_HATCH_RISING, .hatch_colour = strut_grey(0.72)};
  for (size_t k = 0; k + 1 < count; k++) {
    const double *a = points[k], *b = points[k + 1];
    double x = b[0] - a[0], y = b[1] - a[1], length = sqrt(x * x + y * y);
    if (!(length > 0.0)) continue;
    double across[2] = {-y / length * DEPTH, x / length * DEPTH}; /* the page's y points down */
    const double strip[4][2] = {{a[0], a[1]},
                                {b[0], b[1]},
                                {b[0] + across[0], b[1] + across[1]},
                                {a[0] + across[0], a[1] + across[1]}};
    strut_draw_polygon(canvas, strip, 4, &fill, NULL);
  }
}

/* The belt's direction, within the solid below the middle of a line. */
static void draw_belt(strut_canvas *canvas, const double (*points)[2], double speed) {
  const double *a = points[0], *b = points[1];
  double x = b[0] - a[0], y = b[1] - a[1], length = sqrt(x * x + y * y);
  if (!(length > 0.0) || speed == 0.0) return;
  double along[2] = {x / length, y / length}, sign = speed > 0.0 ? 12.0 : -12.0, at[2];
  for (int c = 0; c < 2; c++) at[c] = 0.5 * (a[c] + b[c]);
  at[0] -= 1.9 * DEPTH * along[1], at[1] += 1.9 * DEPTH * along[0];
  strut_draw_arrow(canvas, at[0] - sign * along[0], at[1] - sign * along[1],
                   at[0] + sign * along[0], at[1] + sign * along[1], 5,
                   (strut_pen){.colour = strut_grey(0.3), .width = 0.9});
}

static void draw_one(strut_canvas *canvas, const strut_window *window, const strut_ground *ground,
                     const double *place) {
  double width = window->box.width / window->scale, height = window->box.height / window->scale;
  const double middle[2] = {window->left + 0.5 * width, window->top - 0.5 * height};
  strut_arena arena = {0};
  double(*points)[2] = strut_arena_allocate(&arena, strut_outline_most(ground), sizeof *points);
  if (points) {
    size_t count = strut_outline_of(ground, place, middle, 0.7 * (width + height), points);
    for (size_t k = 0; k < count; k++) strut_window_point(window, points[k], points[k]);
    hatch_below(canvas, (const double(*)[2])points, count);
    strut_draw_line(canvas, (const double(*)[2])points, count,
                    (strut_pen){.colour = strut_grey(0.3), .width = 0.8});
    if (ground->shape == STRUT_GROUND_LINE)
      draw_belt(canvas, (const double(*)[2])points, ground->belt_speed);
  }
  strut_arena_free(&arena);
}

void strut_draw_ground(strut_canvas *canvas, const strut_window *window, const strut_model *model,
                       double time) {
  const strut_scene *scene = model->scene;
  strut_canvas_clip(canvas, window->box);
  if (scene->ground.present) draw_one(canvas, window, &scene->ground, NULL);
  for (size_t g = 0; g < scene->ground_count; g++) {
    double place[2];
    if (!isnan(time)) strut_ground_place(scene, g, time, place);
    draw_one(canvas, window, &scene->grounds[g], isnan(time) ? NULL : place);
  }
  strut_canvas_unclip(canvas);
}

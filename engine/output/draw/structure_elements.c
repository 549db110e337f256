/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What stands between and beside members in a drawing: cells, bodies, hinges, stops, distances, feet, guides. */
#include "engine/output/draw/structure_parts.h"

#include <math.h>

#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/output/draw/legend.h"

enum { ARC = 24 };                           /* pieces of a hinge's arc */
static const double HINGE = 7.0, STOP = 4.0; /* radius of the arc, half a stop's bar [pt] */

strut_colour strut_thing_colour(const strut_drawing *drawing, double alpha) {
  bool one = drawing->style->colouring == STRUT_COLOUR_ONE;
  return strut_faded(one ? drawing->style->colour : strut_palette_thing(2),
                     alpha * drawing->opacity);
}

/* A hinge: an arc around its node, from the first arm to the second by its angle. */
static void draw_hinge(strut_canvas *canvas, const strut_drawing *drawing, const strut_hinge *hinge,
                       double angle, strut_pen pen) {
  double at[3][2], arc[ARC + 1][2], arm = HUGE_VAL;
  for (int k = 0; k < 3; k++)
    strut_window_point(drawing->window, drawing->q + 2 * hinge->node[k], at[k]);
  for (int k = 0; k < 3; k += 2) arm = fmin(arm, hypot(at[k][0] - at[1][0], at[k][1] - at[1][1]));
  double radius = fmin(HINGE * drawing->thin, 0.4 * arm);
  double first = atan2(at[1][1] - at[0][1], at[0][0] - at[1][0]);
  angle = fmax(-STRUT_TAU, fmin(STRUT_TAU, angle));
  if (!isfinite(first + radius + angle)) return;
  for (int i = 0; i <= ARC; i++) {
    arc[i][0] = at[1][0] + radius * cos(first + angle * i / ARC);
    arc[i][1] = at[1][1] - radius * sin(first + angle * i / ARC);
  }
  strut_draw_line(canvas, (const double(*)[2])arc, ARC + 1, pen);
}

/* A stop that acts: a bar across the middle of its member. */
static void draw_stop(strut_canvas *canvas, const strut_drawing *drawing, size_t member,
                      strut_pen pen) {
  double ends[2][2] = {{0}};
  strut_longest_segment(drawing->window, drawing->model, drawing->q, member, ends);
  double x = ends[1][0] - ends[0][0], y = ends[1][1] - ends[0][1], length = hypot(x, y);
  if (!(length > 0) || !isfinite(length)) return;
  double half = STOP * drawing->thin / length, middle[2];
  for (int k = 0; k < 2; k++) middle[k] = 0.5 * (ends[0][k] + ends[1][k]);
  strut_draw_segment(canvas, middle[0] - half * y, middle[1] + half * x, middle[0] + half * y,
                     middle[1] - half * x, pen);
}

/* Cells: filled polygons below all else. */
void strut_draw_cells(strut_canvas *canvas, const strut_drawing *drawing) {
  const strut_scene *scene = drawing->model->scene;
  const strut_fill fill = {.colour = strut_thing_colour(drawing, 0.15)};
  const strut_pen pen = {.colour = strut_thing_colour(drawing, 0.5), .width = 0.5 * drawing->thin};
  double corner[STRUT_MOST_ELEMENT_NODES][2];
  for (size_t i = 0; i < scene->cell_count; i++) {
    const strut_cell *cell = &scene->cells[i];
    bool finite = true;
    for (size_t k = 0; k < cell->node_count; k++) {
      strut_window_point(drawing->window, drawing->q + 2 * cell->node[k], corner[k]);
      finite = finite && isfinite(corner[k][0]) && isfinite(corner[k][1]);
    }
    if (finite)
      strut_draw_polygon(canvas, (const double(*)[2])corner, cell->node_count, &fill, &pen);
  }
}

/* A body that may collide: a disc or a rod with round ends, as thick as it is. */
static void draw_body(strut_canvas *canvas, const strut_drawing *drawing, int32_t node,
                      int32_t member, double width, strut_colour colour) {
  double ends[2][2];
  const strut_fill fill = {.colour = colour};
  const strut_pen pen = {.colour = colour, .width = width};
  if (member >= 0) {
    strut_window_segment(drawing->window, drawing->model, drawing->q, (size_t)member, 0, ends);
    strut_draw_segment(canvas, ends[0][0], ends[0][1], ends[1][0], ends[1][1], pen);
    return;
  }
  strut_window_point(drawing->window, drawing->q + 2 * node, ends[0]);
  strut_draw_circle(canvas, ends[0][0], ends[0][1], 0.5 * width, &fill, NULL);
}

void strut_draw_collisions(strut_canvas *canvas, const strut_drawing *drawing) {
  const strut_scene *scene = drawing->model->scene;
  strut_colour colour = strut_thing_colour(drawing, 0.15);
  for (size_t i = 0; i < scene->collision_count; i++) {
    const strut_collision *collision = &scene->collisions[i];
    double width = collision->thickness * drawing->window->scale;
    for (int k = 0; k < 2; k++) {
      if (collision->node[k] >= 0)
        draw_body(canvas, drawing, collision->node[k], -1, width, colour);
      if (collision->member[k] >= 0)
        draw_body(canvas, drawing, -1, collision->member[k], width, colour);
    }
  }
}

/* A dashed line along which the distance is measured: to the first node's foot, then to the second. */
static void draw_distance(strut_canvas *canvas, const strut_drawing *drawing, int32_t element,
                          const strut_element_pose *pose, strut_pen pen) {
  const strut_element_table *elements = &drawing->model->elements;
  const strut_element *e = &elements->element[element];
  const uint32_t *at = elements->at + e->first;
  bool line = e->strain == STRUT_STRAIN_OFFSET;
  const double *from = drawing->q + at[0];
  double side = line ? -pose->strain : pose->strain, foot[2], way[3][2];
  for (int c = 0; c < 2; c++) foot[c] = from[c] + side * pose->b[line ? c : 2 + c];
  strut_window_point(drawing->window, from, way[0]);
  strut_window_point(drawing->window, foot, way[1]);
  strut_window_point(drawing->window, line ? foot : drawing->q + at[1], way[2]);
  pen.dash[0] = pen.dash[1] = 2.0 * pen.width;
  if (!isfinite(way[0][0] + way[0][1] + way[1][0] + way[1][1] + way[2][0] + way[2][1])) return;
  strut_draw_line(canvas, (const double(*)[2])way, 3, pen);
}

/* The arc of a foot, as far as it may meet the ground while its member stands. */
static void draw_foot(strut_canvas *canvas, const strut_drawing *drawing, int32_t element,
                      strut_pen pen) {
  enum { POINTS = 33 };
  const strut_element *e = &drawing->model->elements.element[element];
  const uint32_t *at = drawing->model->elements.at + e->first;
  const double *from = drawing->q + at[0], *to = drawing->q + at[1];
  double length = strut_distance(from, to), way[POINTS][2];
  if (!(length > 0.0)) return;
  double ux = (to[0] - from[0]) / length, uy = (to[1] - from[1]) / length;
  for (int k = 0; k < POINTS; k++) {
    double angle = STRUT_PI * (0.8 * k / (POINTS - 1) - 0.4), c = cos(angle), s = sin(angle);
    const double point[2] = {from[0] + e->radius * (ux - (c * ux - s * uy)),
                             from[1] + e->radius * (uy - (s * ux + c * uy))};
    strut_window_point(drawing->window, point, way[k]);
    if (!isfinite(way[k][0] + way[k][1])) return;
  }
  strut_draw_line(canvas, (const double(*)[2])way, POINTS, pen);
}

/* Circles of a cable's guides. */
static void draw_guides(strut_canvas *canvas, const strut_drawing *drawing, int32_t element) {
  const strut_element *e = &drawing->model->elements.element[element];
  double middle[2];
  const strut_fill fill = {.colour = strut_faded(strut_grey(0.93), drawing->opacity)};
  const strut_pen pen = {.colour = strut_faded(strut_grey(0.5), drawing->opacity),
                         .width = 0.6 * drawing->thin};
  for (int32_t k = 1; k + 1 < e->nodes; k++) {
    strut_window_point(drawing->window, drawing->q + drawing->model->elements.at[e->first + k],
                       middle);
    if (isfinite(middle[0] + middle[1]))
      strut_draw_circle(canvas, middle[0], middle[1], e->radius * drawing->window->scale, &fill,
                        &pen);
  }
}

void strut_draw_elements(strut_canvas *canvas, const strut_drawing *drawing) {
  strut_pen pen = {.colour = strut_thing_colour(drawing, 1)};
  strut_element_pose pose;
  if (drawing->thin < 0.3) return; /* too small to be drawn */
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

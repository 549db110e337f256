/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The grounds of a scene. See structure.h. */
#include <math.h>

#include "engine/base/memory.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/draw/structure.h"
#include "engine/scene/profile.h"

static const double DEPTH = 8.0; /* of the hatching below a surface [pt] */

/* Hatching to the right of each segment of (count) points on the page. */
static void hatch(strut_canvas *canvas, const double (*points)[2], size_t count) {
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
    hatch(canvas, (const double(*)[2])points, count);
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

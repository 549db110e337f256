/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Another motion of the same structure over the one that is drawn. See run_parts.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/figures/run_parts.h"

static const strut_pen PEN = {.colour = {0.05, 0.05, 0.05, 1}, .width = 0.7, .dash = {2.4, 1.6}};

bool strut_run_find_other(const strut_run_scene *run, strut_run_scene *other) {
  *other = (strut_run_scene){.figure = run->figure,
                             .model = run->model,
                             .motion = run->figure->other,
                             .arrow = run->arrow};
  if (!other->motion || !other->motion->position) return false;
  strut_run_count_frames(other);
  return other->frames > 0;
}

void strut_run_draw_other(const strut_run_scene *other, strut_canvas *canvas,
                          const strut_window *window, size_t frame) {
  const strut_scene *scene = other->model->scene;
  const double *q = strut_run_positions(other, frame);
  for (size_t i = 0; i < scene->member_count; i++) {
    double from[2], to[2];
    strut_window_point(window, q + 2 * scene->members[i].node[0], from);
    strut_window_point(window, q + 2 * scene->members[i].node[1], to);
    strut_draw_segment(canvas, from[0], from[1], to[0], to[1], PEN);
  }
}

bool strut_run_draw_other_path(strut_run_scene *other, strut_canvas *canvas,
                               const strut_window *window, const double (*way)[2], size_t count) {
  double(*points)[2] = strut_arena_allocate(&other->arena, count, sizeof *points);
  for (size_t i = 0; points && i < count; i++) strut_window_point(window, way[i], points[i]);
  if (points) strut_draw_line(canvas, (const double(*)[2])points, count, PEN);
  return points != NULL;
}

void strut_run_describe_other(const strut_run_scene *run, char *text, size_t size) {
  size_t used = strlen(text);
  if (run->figure->other)
    snprintf(text + used, size - used, ", black dashes: %s",
             run->figure->other_name ? run->figure->other_name : "another");
}

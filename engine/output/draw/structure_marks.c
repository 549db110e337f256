/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What stands around a structure: supports, ground, forces on it, ways, a yardstick. */
#include <math.h>

#include "engine/output/draw/axes.h"
#include "engine/output/draw/palette.h"
#include "engine/output/draw/structure_parts.h"

enum { TRAIL_SHADES = 64 };

/* A support's triangle, its tip at the node, its base towards `out`; rolling: on two wheels. */
static void draw_support(strut_canvas *canvas, const double tip[2], const double out[2],
                         bool rolling, double size, double opacity) {
  const double across[2] = {-out[1], out[0]}, height = 7.0 * size, half = 4.2 * size;
  const strut_pen pen = {.colour = strut_faded(strut_grey(0.25), opacity), .width = 0.7 * size};
  const strut_fill white = {.colour = strut_faded(strut_grey(1), opacity)};
  const strut_fill hatched = {.hatch = STRUT_HATCH_RISING,
                              .hatch_colour = strut_faded(strut_grey(0.45), opacity)};
  double corner[4][2];
  for (int d = 0; d < 2; d++) {
    corner[0][d] = tip[d];
    corner[1][d] = tip[d] + height * out[d] + half * across[d];
    corner[2][d] = tip[d] + height * out[d] - half * across[d];
  }
  strut_draw_polygon(canvas, (const double(*)[2])corner, 3, &white, &pen);
  double base = height, wheel = 1.1 * size;
  for (int side = -1; side <= 1 && rolling; side += 2)
    strut_draw_circle(canvas, tip[0] + (height + wheel) * out[0] + 0.55 * side * half * across[0],
                      tip[1] + (height + wheel) * out[1] + 0.55 * side * half * across[1], wheel,
                      &white, &pen);
  if (rolling) base += 2 * wheel;
  for (int d = 0; d < 2; d++) {
    corner[0][d] = tip[d] + base * out[d] + 1.5 * half * across[d];
    corner[1][d] = tip[d] + base * out[d] - 1.5 * half * across[d];
    corner[2][d] = corner[1][d] + 3.5 * size * out[d];
    corner[3][d] = corner[0][d] + 3.5 * size * out[d];
  }
  strut_draw_polygon(canvas, (const double(*)[2])corner, 4, &hatched, NULL);
  strut_draw_segment(canvas, corner[0][0], corner[0][1], corner[1][0], corner[1][1], pen);
}

void strut_draw_supports(strut_canvas *canvas, const strut_window *w, const strut_model *model,
                         const double *q, double size, double opacity) {
  double middle = 0;
  for (int32_t i = 0; i < model->node_count; i++) middle += q[2 * i] / model->node_count;
  for (int32_t i = 0; i < model->node_count; i++) {
    const bool *fixed = model->scene->nodes[i].fixed;
    double tip[2];
    if (!fixed[0] && !fixed[1]) continue;
    strut_window_point(w, q + 2 * i, tip);
    /* Held along x only: from the side, where the structure is not. */
    const double below[2] = {0, 1}, side[2] = {q[2 * i] <= middle ? -1 : 1, 0};
    draw_support(canvas, tip, fixed[1] ? below : side, !(fixed[0] && fixed[1]), size, opacity);
  }
}

void strut_ground_line(const strut_window *w, const strut_model *model, double ends[2][2]) {
  const strut_ground *ground = &model->scene->ground;
  for (int k = 0; k < 2; k++) {
    double x = w->left + (1.2 * k - 0.1) * w->box.width / w->scale;
    const double position[2] = {x, ground->height + tan(ground->slope) * x};
    strut_window_point(w, position, ends[k]);
  }
}

void strut_draw_ground(strut_canvas *canvas, const strut_window *w, const strut_model *model) {
  const strut_ground *ground = &model->scene->ground;
  if (!ground->present) return;
  double ends[4][2];
  strut_ground_line(w, model, ends);
  const double down[2] = {STRUT_GROUND_DEPTH * sin(ground->slope),
                          STRUT_GROUND_DEPTH * cos(ground->slope)};
  for (int d = 0; d < 2; d++) {
    ends[2][d] = ends[1][d] + down[d];
    ends[3][d] = ends[0][d] + down[d];
  }
  const strut_fill fill = {
      .colour = strut_grey(0.95), .hatch = STRUT_HATCH_RISING, .hatch_colour = strut_grey(0.72)};
  strut_canvas_clip(canvas, w->box);
  strut_draw_polygon(canvas, (const double(*)[2])ends, 4, &fill, NULL);
  strut_draw_segment(canvas, ends[0][0], ends[0][1], ends[1][0], ends[1][1],
                     (strut_pen){.colour = strut_grey(0.3), .width = 0.8});
  if (ground->belt_speed != 0) {
    double sign = ground->belt_speed > 0 ? 1 : -1;
    const double from[2] = {0.5 * (ends[0][0] + ends[1][0]) + 1.9 * down[0],
                            0.5 * (ends[0][1] + ends[1][1]) + 1.9 * down[1]};
    strut_draw_arrow(
        canvas, from[0] - sign * 12 * cos(ground->slope), from[1] + sign * 12 * sin(ground->slope),
        from[0] + sign * 12 * cos(ground->slope), from[1] - sign * 12 * sin(ground->slope), 5,
        (strut_pen){.colour = strut_grey(0.3), .width = 0.9});
  }
  strut_canvas_unclip(canvas);
}

void strut_draw_contact_forces(strut_canvas *canvas, const strut_window *w,
                               const strut_model *model, const double *q, const double (*force)[2],
                               double limit, double longest) {
  const strut_contact_table *contacts = &model->contacts;
  const strut_pen pen = {.colour = strut_palette_thing(1), .width = 1.1};
  for (int32_t i = 0; i < contacts->count && limit > 0; i++) {
    double at[2], normal = force[i][0] / limit * longest, along = force[i][1] / limit * longest;
    strut_window_point(w, q + contacts->at[i], at);
    if (fabs(normal) > 0.3) /* it pushes from below: its tip is at the node */
      strut_draw_arrow(canvas, at[0] - normal * contacts->normal[0],
                       at[1] + normal * contacts->normal[1], at[0], at[1], 5, pen);
    if (fabs(along) > 0.3)
      strut_draw_arrow(canvas, at[0], at[1], at[0] + along * contacts->tangent[0],
                       at[1] - along * contacts->tangent[1], 5, pen);
  }
}

void strut_draw_trail(strut_canvas *canvas, const strut_window *w, const double (*positions)[2],
                      size_t count, double width) {
  double points[66][2];
  strut_pen pen = {.width = width};
  if (count < 2) return;
  for (size_t shade = 0; shade < TRAIL_SHADES; shade++) {
    size_t first = shade * (count - 1) / TRAIL_SHADES;
    size_t last = (shade + 1) * (count - 1) / TRAIL_SHADES, used = 0;
    if (last == first) continue;
    pen.colour = strut_palette_sequence((double)shade / (TRAIL_SHADES - 1));
    for (size_t i = first; i <= last; i++) { /* long ones in pieces of the array's size */
      strut_window_point(w, positions[i], points[used++]);
      if (used < 66 && i < last) continue;
      strut_draw_line(canvas, (const double(*)[2])points, used, pen);
      points[0][0] = points[used - 1][0];
      points[0][1] = points[used - 1][1];
      used = 1;
    }
  }
}

void strut_draw_yardstick(strut_canvas *canvas, const strut_window *w) {
  double room = 0.3 * w->box.width / w->scale, power = pow(10.0, floor(log10(room)));
  /* Round, and never more than the room. */
  double length = room >= 5 * power ? 5 * power : room >= 2 * power ? 2 * power : power;
  double x = w->box.x + 3, y = w->box.y + w->box.height - 4, end = x + length * w->scale;
  const strut_pen pen = {.colour = strut_grey(0.2), .width = 0.9, .butt = true};
  if (!isfinite(length) || !(length > 0)) return;
  strut_draw_segment(canvas, x, y, end, y, pen);
  strut_draw_segment(canvas, x, y - 2, x, y + 2, pen);
  strut_draw_segment(canvas, end, y - 2, end, y + 2, pen);
  strut_draw_text(canvas, 0.5 * (x + end), y - 2, strut_drawn_quantity(length, 3, "m").text,
                  (strut_font){.size = 7, .across = 0.5, .down = 1, .halo = strut_grey(1)});
}

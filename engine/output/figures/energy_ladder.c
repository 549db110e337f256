/* SPDX-License-Identifier: GPL-3.0-or-later */
/* States as levels of energy, and what it takes from one to the other. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "engine/output/draw/axes.h"
#include "engine/output/draw/legend.h"
#include "engine/output/draw/palette.h"
#include "engine/output/figures/equilibria_parts.h"

enum { ARC = 40, FEW = 4 };

static const double LEVEL = 0.3; /* half the width of a level, in places */

static int place_of(const size_t *chosen, size_t count, int32_t state) {
  for (size_t k = 0; k < count; k++)
    if ((int32_t)chosen[k] == state) return (int)k;
  return -1;
}

/* The barrier's two ends among the chosen; false where it is of others. */
static bool ends_of(const strut_barrier *b, const size_t *chosen, size_t count, int ends[2]) {
  ends[0] = place_of(chosen, count, b->from);
  ends[1] = place_of(chosen, count, b->to);
  return ends[0] >= 0 && ends[1] >= 0 && ends[0] != ends[1];
}

/* What leads straight there where it is known, else the lowest way of all. */
static double height_of(const strut_barrier *b) {
  return isfinite(b->direct) ? b->direct : b->height;
}

bool strut_ladder_wanted(const strut_equilibria *all, const size_t *chosen, size_t count) {
  int ends[2];
  for (size_t i = 0; i < all->barrier_count; i++)
    if (ends_of(&all->barriers[i], chosen, count, ends)) return true;
  return false;
}

/* A smooth way from one level over the pass to the other. */
static void draw_pass(strut_canvas *canvas, const strut_axes *axes, const int ends[2],
                      const double energy[2], double top) {
  double points[ARC + 1][2];
  bool neighbours = abs(ends[0] - ends[1]) == 1;
  const strut_pen pen = {.colour = strut_grey(neighbours ? 0.35 : 0.65),
                         .width = neighbours ? 0.9 : 0.6,
                         .dash = {neighbours ? 0 : 2.5, 2}};
  double side = ends[1] > ends[0] ? LEVEL : -LEVEL;
  for (int i = 0; i <= ARC; i++) {
    double t = (double)i / ARC, low = t < 0.5 ? energy[0] : energy[1];
    double rise = 0.5 - 0.5 * cos(4 * acos(0) * t); /* 0, 1, 0 */
    strut_axes_point(axes, ends[0] + side + t * (ends[1] - ends[0] - 2 * side),
                     low + rise * (top - low), points[i]);
  }
  strut_draw_line(canvas, (const double(*)[2])points, ARC + 1, pen);
}

static void draw_passes(strut_canvas *canvas, const strut_axes *axes, const strut_equilibria *all,
                        const size_t *chosen, size_t count, double zero) {
  for (size_t i = 0; i < all->barrier_count; i++) {
    const strut_barrier *b = &all->barriers[i];
    int ends[2];
    if (!ends_of(b, chosen, count, ends)) continue;
    const double energy[2] = {strut_drawn_energy(all, (size_t)b->from) - zero,
                              strut_drawn_energy(all, (size_t)b->to) - zero};
    double top = energy[0] + height_of(b), at[2];
    /* Among many only the ways between neighbours can be told apart. */
    bool told = abs(ends[0] - ends[1]) == 1 || count <= FEW;
    if (ends[0] < ends[1] && told) draw_pass(canvas, axes, ends, energy, top);
    if (abs(ends[0] - ends[1]) != 1) continue;
    /* What it takes, beside the slope that it is taken on. */
    char text[80];
    bool right = ends[1] > ends[0];
    snprintf(text, sizeof text, right ? "%s \xe2\x86\x92" : "\xe2\x86\x90 %s",
             strut_drawn_quantity(height_of(b), 3, "J").text);
    strut_axes_point(axes, 0.5 * (ends[0] + ends[1]), top, at);
    strut_draw_text(canvas, at[0], at[1] - (right ? 2 : 11), text,
                    (strut_font){.size = 7, .across = 0.5, .down = 1, .halo = strut_grey(1)});
  }
}

static void draw_levels(strut_canvas *canvas, const strut_axes *axes, const strut_equilibria *all,
                        const size_t *chosen, size_t count, double zero) {
  /* Many names stand in two lines in turn, each with the room of two. */
  int lines = count <= FEW ? 1 : 2;
  double room = lines * axes->frame.width / (double)count - 2;
  for (size_t k = 0; k < count; k++) {
    double left[2], right[2], energy = strut_drawn_energy(all, chosen[k]) - zero;
    char fitted[STRUT_FITTED_TEXT];
    strut_font font = {
        .size = count <= FEW ? 8 : 7, .bold = count <= FEW, .across = 0.5, .halo = strut_grey(1)};
    strut_axes_point(axes, (double)k - LEVEL, energy, left);
    strut_axes_point(axes, (double)k + LEVEL, energy, right);
    strut_draw_segment(canvas, left[0], left[1], right[0], right[1],
                       (strut_pen){.colour = strut_palette_thing(0), .width = 2, .butt = true});
    strut_draw_text(canvas, 0.5 * (left[0] + right[0]), left[1] + 3 + (double)((int)k % lines) * 8,
                    strut_text_fit(canvas, all->list[chosen[k]].name, font, room, 0, fitted), font);
  }
}

strut_status strut_draw_ladder(strut_canvas *canvas, strut_box box, const strut_equilibria *all,
                               const size_t *chosen, size_t count) {
  strut_axis x = {.name = "", .unit = "", .low = -0.5, .high = (double)count - 0.5};
  if (count > FEW) { /* names reach beyond their levels */
    x.low -= 0.3;
    x.high += 0.3;
  }
  const double any = (double)NAN;
  strut_axis y = {.name = "energy above the lowest", .unit = "J", .low = any, .high = any};
  double zero = HUGE_VAL;
  int ends[2];
  for (size_t k = 0; k < count; k++) zero = fmin(zero, strut_drawn_energy(all, chosen[k]));
  for (size_t k = 0; k < count; k++)
    strut_axis_include(&y, strut_drawn_energy(all, chosen[k]) - zero);
  for (size_t i = 0; i < all->barrier_count; i++)
    if (ends_of(&all->barriers[i], chosen, count, ends))
      strut_axis_include(&y, strut_drawn_energy(all, (size_t)all->barriers[i].from) - zero +
                                 height_of(&all->barriers[i]));
  strut_axis_settle(&y, 0.2);
  strut_axes axes = strut_axes_place(canvas, box, x, y, NULL, NULL);
  axes.frame.height = box.y + box.height - axes.frame.y - 4; /* places have no numbers */
  strut_draw_vertical_axis(canvas, &axes);
  strut_canvas_clip(canvas, axes.frame);
  draw_passes(canvas, &axes, all, chosen, count, zero);
  draw_levels(canvas, &axes, all, chosen, count, zero);
  strut_canvas_unclip(canvas);
  return STRUT_OK;
}

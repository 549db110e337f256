/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The energy ladder: states as levels, with the barriers between them. See energy_ladder.h. */
#include <math.h>
#include <stdio.h>

#include "engine/base/vec.h"
#include "engine/output/draw/chart.h"
#include "engine/output/figures/energy_ladder.h"

enum { ARC = 40, FEW = 4, TEXT = 160 };

static const double LEVEL = 0.3;          /* half the width of a level, in places */
static const double OUTLYING = 1.0 / 3.0; /* so many of the barriers may lie beyond the axis */

/* A ladder being drawn. */
typedef struct ladder {
  strut_canvas *canvas;
  const strut_equilibria *all;
  const size_t *chosen; /* (count) states, in the order of their places */
  size_t count;
  strut_axes axes;
  double zero; /* the lowest energy [J] */
} ladder;

/* The barrier between the states at two places: its top above zero, its height from either side [J]. */
typedef struct pass {
  bool known;
  double top, height[2]; /* NAN: not known from that side */
} pass;

static double level_energy(const ladder *l, size_t place) {
  return l->all->list[l->chosen[place]].energy - l->zero;
}

static pass find_pass(const ladder *l, size_t left, size_t right) {
  pass p = {.top = (double)NAN, .height = {(double)NAN, (double)NAN}};
  for (size_t i = 0; i < l->all->barrier_count; i++) {
    const strut_barrier *b = &l->all->barriers[i];
    size_t from = (size_t)b->from, to = (size_t)b->to;
    bool along = from == l->chosen[left] && to == l->chosen[right];
    bool back = from == l->chosen[right] && to == l->chosen[left];
    /* The direct pass where it is known, else the lowest path. */
    double height = isfinite(b->direct) ? b->direct : b->height;
    if ((!along && !back) || !isfinite(height)) continue;
    p.known = true;
    p.height[back] = height;
    if (along || isnan(p.top)) p.top = height + level_energy(l, along ? left : right);
  }
  return p;
}

/* Among many states, only barriers between neighbours remain readable. */
static bool is_drawn(const ladder *l, size_t left, size_t right) {
  return left < right && (right == left + 1 || l->count <= FEW);
}

/* Calls `visit` for each barrier that is drawn. */
static void visit_passes(ladder *l,
                         void (*visit)(ladder *l, size_t left, size_t right, const pass *p,
                                       void *context),
                         void *context) {
  for (size_t left = 0; left < l->count; left++)
    for (size_t right = left + 1; right < l->count; right++) {
      if (!is_drawn(l, left, right)) continue;
      const pass p = find_pass(l, left, right);
      if (p.known) visit(l, left, right, &p, context);
    }
}

bool strut_ladder_wanted(const strut_equilibria *all, const size_t *chosen, size_t count) {
  const ladder l = {.all = all, .chosen = chosen, .count = count};
  for (size_t left = 0; left < count; left++)
    for (size_t right = left + 1; right < count; right++)
      if (find_pass(&l, left, right).known) return true;
  return false;
}

/* A smooth curve from one level over the barrier to the other; it leaves the frame where it is higher. */
static void draw_pass(ladder *l, size_t left, size_t right, const pass *p, void *context) {
  double points[ARC + 1][2], high = l->axes.y.high;
  double top = p->top <= high ? p->top : 1.3 * high;
  const double energy[2] = {level_energy(l, left), level_energy(l, right)};
  bool neighbours = right == left + 1;
  const strut_pen pen = {.colour = strut_grey(neighbours ? 0.35 : 0.65),
                         .width = neighbours ? 0.9 : 0.6,
                         .dash = {neighbours ? 0 : 2.5, 2}};
  (void)context;
  for (int i = 0; i <= ARC; i++) {
    double t = (double)i / ARC, low = t < 0.5 ? energy[0] : energy[1];
    double rise = 0.5 - 0.5 * cos(STRUT_TAU * t); /* 0, 1, 0 */
    double x = (double)left + LEVEL + t * ((double)(right - left) - 2 * LEVEL);
    strut_axes_point(&l->axes, x, low + rise * (top - low), points[i]);
  }
  strut_draw_line(l->canvas, (const double(*)[2])points, ARC + 1, pen);
}

/* The heights from either side, above the top; of a barrier beyond the axis below an arrow. */
static void name_pass(ladder *l, size_t left, size_t right, const pass *p, void *context) {
  char text[TEXT] = "";
  size_t used = 0;
  bool beyond = p->top > l->axes.y.high;
  double at[2];
  (void)context;
  if (right != left + 1) return;
  for (int back = 0; back < 2; back++)
    if (isfinite(p->height[back]))
      used += (size_t)snprintf(text + used, TEXT - used,
                               back ? "%s\xe2\x86\x90 %s" : "%s%s \xe2\x86\x92", used ? "\n" : "",
                               strut_drawn_quantity(p->height[back], 3, "J").text);
  strut_axes_point(&l->axes, 0.5 * (double)(left + right), fmin(p->top, l->axes.y.high), at);
  if (beyond) strut_draw_beyond(l->canvas, at, STRUT_SIDE_TOP);
  strut_draw_label(l->canvas, &(strut_label){.text = text,
                                             .font = {.size = 7, .halo = strut_grey(1)},
                                             .at = {at[0], at[1]},
                                             .gap = beyond ? STRUT_BEYOND_SIZE + 2 : 2,
                                             .angle = (beyond ? -0.5 : 0.5) * STRUT_PI,
                                             .steady = 1,
                                             .inside = l->axes.frame,
                                             .priority = 1});
}

static void draw_levels(const ladder *l) {
  for (size_t k = 0; k < l->count; k++) {
    double ends[2][2], energy = level_energy(l, k);
    bool few = l->count <= FEW;
    for (int side = 0; side < 2; side++)
      strut_axes_point(&l->axes, (double)k + (side ? LEVEL : -LEVEL), energy, ends[side]);
    strut_draw_segment(l->canvas, ends[0][0], ends[0][1], ends[1][0], ends[1][1],
                       (strut_pen){.colour = strut_palette_thing(0), .width = 2, .butt = true});
    strut_draw_label(
        l->canvas, &(strut_label){.text = l->all->list[l->chosen[k]].name,
                                  .font = {.size = few ? 8 : 7, .bold = few, .halo = strut_grey(1)},
                                  .at = {0.5 * (ends[0][0] + ends[1][0]), ends[0][1]},
                                  .gap = 3,
                                  .angle = -0.5 * STRUT_PI,
                                  .steady = 1,
                                  .inside = l->axes.frame,
                                  .priority = 2});
  }
}

/* Heights that the axis has to hold. */
typedef struct heights {
  double *top;
  size_t count;
} heights;

static void add_top(ladder *l, size_t left, size_t right, const pass *p, void *context) {
  heights *h = context;
  (void)l, (void)left, (void)right;
  h->top[h->count++] = p->top;
}

/* The energy axis, which leaves out single barriers far above all else; how many, and the highest. */
static strut_axis find_axis(ladder *l, heights *h, strut_beyond *beyond) {
  strut_axis y = {.name = "energy above the lowest", .unit = "J", .low = 0.0, .high = 0.0};
  visit_passes(l, add_top, h);
  for (size_t k = 0; k < l->count; k++) strut_axis_include(&y, level_energy(l, k));
  double limit = strut_limit_without_outliers(h->top, h->count, y.high, OUTLYING, beyond);
  strut_axis_include(&y, limit);
  strut_axis_settle(&y, 0.2);
  return y;
}

strut_status strut_ladder_draw(strut_canvas *canvas, strut_box box, const strut_equilibria *all,
                               const size_t *chosen, size_t count) {
  ladder l = {.canvas = canvas, .all = all, .chosen = chosen, .count = count, .zero = HUGE_VAL};
  strut_axis x = {.name = "", .unit = "", .low = -0.5, .high = (double)count - 0.5};
  heights h = {.top = strut_allocate(count * count + 1, sizeof *h.top)};
  strut_beyond beyond = {0};
  char text[STRUT_BEYOND_TEXT];
  if (!h.top) return STRUT_NO_MEMORY;
  if (count > FEW) x.low -= 0.3, x.high += 0.3; /* names are wider than their levels */
  for (size_t k = 0; k < count; k++) l.zero = fmin(l.zero, all->list[chosen[k]].energy);
  strut_axis y = find_axis(&l, &h, &beyond);
  strut_release(h.top);
  l.axes = strut_axes_place(canvas, box, x, y, NULL);
  l.axes.frame.height = box.y + box.height - l.axes.frame.y - 4; /* the x axis has no numbers */
  strut_draw_vertical_axis(canvas, &l.axes);
  strut_canvas_clip(canvas, l.axes.frame);
  visit_passes(&l, draw_pass, NULL);
  strut_canvas_unclip(canvas);
  draw_levels(&l);
  visit_passes(&l, name_pass, NULL);
  strut_draw_axis_note(canvas, &l.axes, strut_beyond_text(&beyond, "barrier", y.unit, text));
  return STRUT_OK;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/work_precision.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/vec.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/draw/legend.h"

static const double MARKER = 2.4, STRIP = 18, TITLE_GAP = 3.5; /* [pt] */
enum { LABEL = 130 };

typedef struct diagram {
  strut_canvas *canvas;
  const strut_work_precision *wanted;
  strut_axes axes;
  strut_box strip; /* above the frame, for diverged points; height 0: none */
  bool *front;     /* (count) */
  size_t *order;   /* (count) of the front by cost */
  strut_legend_entry *entries;
} diagram;

static bool diverged(const strut_saving *b) { return !isfinite(b->error); }

void strut_pareto_front(const strut_saving *b, size_t count, bool *front) {
  for (size_t i = 0; i < count; i++) {
    front[i] = !diverged(&b[i]) && b[i].cost > 0;
    for (size_t k = 0; k < count && front[i]; k++) {
      bool no_worse = b[k].cost <= b[i].cost && b[k].error <= b[i].error;
      bool better = b[k].cost < b[i].cost || b[k].error < b[i].error;
      front[i] = diverged(&b[k]) || !(no_worse && better);
    }
  }
}

static void settle_axes(const strut_work_precision *w, strut_axis *cost, strut_axis *error) {
  *cost = w->cost;
  *error = w->error;
  cost->logarithmic = error->logarithmic = true;
  bool fit_cost = !(cost->low < cost->high), fit_error = !(error->low < error->high);
  if (fit_cost) cost->low = cost->high = (double)NAN;
  if (fit_error) error->low = error->high = (double)NAN;
  for (size_t i = 0; i < w->count; i++) {
    const strut_saving *b = &w->bargains[i];
    if (fit_cost) strut_axis_include(cost, b->cost);
    if (!fit_error) continue;
    strut_axis_include(error, b->error);
    strut_axis_include(error, b->low);
    strut_axis_include(error, b->high);
  }
  strut_axis_settle(cost, fit_cost ? 0.06 : 0);
  strut_axis_settle(error, fit_error ? 0.08 : 0);
}

static void place_point(const diagram *d, const strut_saving *b, double at[2]) {
  double error = diverged(b) || !(b->error > 0) ? d->axes.y.high : b->error;
  strut_axes_point(&d->axes, b->cost, error, at);
  if (diverged(b)) { /* each group at its own height, so that none hides another */
    double groups = d->wanted->group_count > 0 ? (double)d->wanted->group_count : 1;
    at[1] = d->strip.y + d->strip.height * (0.2 + 0.6 * (b->group + 0.5) / groups);
  }
  if (b->error == 0)
    at[1] = d->axes.frame.y + d->axes.frame.height; /* zero is off a logarithmic scale */
}

static void draw_lines(const diagram *d) {
  const strut_work_precision *w = d->wanted;
  for (size_t g = 0; g < w->group_count; g++) {
    double before[2];
    bool started = false;
    strut_pen pen = strut_series_pen(g);
    for (size_t i = 0; i < w->count; i++) {
      double at[2];
      if (w->bargains[i].group != (int)g || diverged(&w->bargains[i])) continue;
      place_point(d, &w->bargains[i], at);
      if (started) strut_draw_segment(d->canvas, before[0], before[1], at[0], at[1], pen);
      before[0] = at[0];
      before[1] = at[1];
      started = true;
    }
  }
}

/* The staircase of the Pareto front. */
static void draw_front(const diagram *d) {
  const strut_work_precision *w = d->wanted;
  const strut_pen pen = {.colour = strut_grey(0.6), .width = 3.2};
  double before[2];
  bool started = false;
  for (size_t k = 0; k < w->count && d->order[k] < w->count; k++) {
    double at[2];
    place_point(d, &w->bargains[d->order[k]], at);
    if (started) {
      strut_draw_segment(d->canvas, before[0], before[1], at[0], before[1], pen);
      strut_draw_segment(d->canvas, at[0], before[1], at[0], at[1], pen);
    }
    before[0] = at[0];
    before[1] = at[1];
    started = true;
  }
}

/* The text beside the k-th point of the front; with its group where other points have the same label. */
static const char *label_text(const diagram *d, size_t k, char text[LABEL]) {
  const strut_work_precision *w = d->wanted;
  const strut_saving *own = &w->bargains[d->order[k]];
  bool alike = false;
  for (size_t i = 0; i < w->count && d->order[i] < w->count; i++) {
    const strut_saving *other = &w->bargains[d->order[i]];
    alike = alike || (i != k && other->label && strcmp(other->label, own->label) == 0);
  }
  snprintf(text, LABEL, "%.60s%s%.60s", own->label, alike ? ", " : "",
           alike ? w->groups[own->group] : "");
  return text;
}

/* The cheapest first. */
static void draw_labels(const diagram *d) {
  for (size_t k = 0; k < d->wanted->count && d->order[k] < d->wanted->count; k++) {
    const strut_saving *b = &d->wanted->bargains[d->order[k]];
    double at[2];
    char text[LABEL];
    if (!b->label) continue;
    place_point(d, b, at);
    strut_draw_label(d->canvas,
                     &(strut_label){.text = label_text(d, k, text),
                                    .font = {.size = 7, .halo = strut_grey(1)},
                                    .at = {at[0], at[1]},
                                    .gap = MARKER + 1,
                                    .angle = 1.25 * STRUT_PI, /* no better point can be there */
                                    .steady = 0.5,
                                    .inside = d->axes.frame});
  }
}

static void draw_points(const diagram *d) {
  const strut_work_precision *w = d->wanted;
  for (size_t i = 0; i < w->count; i++) {
    const strut_saving *b = &w->bargains[i];
    double at[2], low[2], high[2];
    if (!(b->cost > 0)) continue;
    place_point(d, b, at);
    if (isfinite(b->low) && isfinite(b->high) && b->low > 0) {
      const strut_pen bar = {
          .colour = strut_palette_thing((size_t)b->group), .width = 0.7, .butt = true};
      strut_axes_point(&d->axes, b->cost, b->low, low);
      strut_axes_point(&d->axes, b->cost, b->high, high);
      strut_draw_segment(d->canvas, low[0], low[1], high[0], high[1], bar);
      strut_draw_segment(d->canvas, low[0] - 2, low[1], low[0] + 2, low[1], bar);
      strut_draw_segment(d->canvas, high[0] - 2, high[1], high[0] + 2, high[1], bar);
    }
    strut_draw_marker(d->canvas, (size_t)b->group, at[0], at[1], MARKER);
  }
}

/* Sorts the front's indices by cost; `count` terminates them. */
static void sort_front(diagram *d) {
  const strut_work_precision *w = d->wanted;
  size_t used = 0;
  for (size_t i = 0; i < w->count; i++) {
    if (!d->front[i]) continue;
    size_t k = used++;
    for (; k > 0 && w->bargains[d->order[k - 1]].cost > w->bargains[i].cost; k--)
      d->order[k] = d->order[k - 1];
    d->order[k] = i;
  }
  if (used < w->count) d->order[used] = w->count;
}

static void draw_strip(const diagram *d) {
  const strut_fill grey = {.colour = strut_grey(0.94)};
  const strut_pen frame = {.colour = strut_grey(0.25), .width = 0.6};
  strut_draw_box(d->canvas, d->strip, &grey, &frame);
  strut_draw_label(d->canvas,
                   &(strut_label){.text = "diverged",
                                  .font = {.size = 7, .colour = strut_grey(0.35)},
                                  .at = {d->strip.x + d->strip.width, d->strip.y + 0.5 * STRIP},
                                  .inside = {d->strip.x + 3, d->strip.y + 5, d->strip.width - 6, 9},
                                  .loose = true});
}

static void draw_diagram(diagram *d, strut_box box) {
  const strut_work_precision *w = d->wanted;
  strut_axis cost, error;
  double legend[2];
  bool some_diverged = false;
  settle_axes(w, &cost, &error);
  for (size_t g = 0; g < w->group_count; g++)
    d->entries[g] =
        (strut_legend_entry){.label = w->groups[g], .look = g, .line = true, .marker = true};
  strut_legend_size(d->canvas, d->entries, w->group_count, box.width - 40, legend);
  for (size_t i = 0; i < w->count; i++) some_diverged = some_diverged || diverged(&w->bargains[i]);
  double top = legend[1] + (some_diverged ? STRIP : 0);
  const strut_box below = {box.x, box.y + top, box.width, box.height - top};
  d->axes = strut_axes_place(d->canvas, below, cost, error, NULL);
  d->strip = d->axes.frame;
  d->strip.height = some_diverged ? STRIP : 0;
  d->strip.y -= d->strip.height;
  strut_draw_axes(d->canvas, &d->axes, NULL);
  if (some_diverged) draw_strip(d);
  draw_front(d);
  draw_lines(d);
  draw_points(d);
  draw_labels(d);
  strut_draw_legend(d->canvas, d->entries, w->group_count, box.width - 40, d->axes.frame.x, box.y,
                    false);
}

strut_status strut_draw_work_precision(strut_canvas *canvas, strut_box box,
                                       const strut_work_precision *wanted) {
  diagram d = {.canvas = canvas, .wanted = wanted};
  d.front = strut_allocate(wanted->count + 1, sizeof *d.front);
  d.order = strut_allocate(wanted->count + 1, sizeof *d.order);
  d.entries = strut_allocate(wanted->group_count + 1, sizeof *d.entries);
  bool good = d.front && d.order && d.entries;
  if (good) {
    strut_pareto_front(wanted->bargains, wanted->count, d.front);
    sort_front(&d);
    if (wanted->title) {
      const strut_font font = {.size = 9, .bold = true, .width = box.width};
      double wide, high;
      strut_text_size(canvas, wanted->title, font, &wide, &high);
      strut_draw_text(canvas, box.x, box.y, wanted->title, font);
      box.y += high + TITLE_GAP;
      box.height -= high + TITLE_GAP;
    }
    draw_diagram(&d, box);
  }
  strut_release(d.front);
  strut_release(d.order);
  strut_release(d.entries);
  return good ? STRUT_OK : STRUT_NO_MEMORY;
}

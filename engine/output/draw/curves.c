/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/chart.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/vec.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/draw/legend.h"

static const double GRAIN = 0.25, MARKER = 2.0, LONE_MARKER = 1.4, INSET = 4;
enum { FEW_POINTS = 30, MARKERS = 8 };

/* A figure being drawn. */
typedef struct plotter {
  strut_canvas *canvas;
  const strut_curves *curves;
  strut_axes axes;
  strut_legend_entry *entries;
  size_t entry_count;
  double (**points)[2]; /* (series) thinned points on the page, broken lines with NAN between */
  size_t *counts;       /* (series) */
} plotter;

static size_t style_of(const strut_curves *c, size_t series) {
  return c->series[series].look >= 0 ? (size_t)c->series[series].look : series;
}

/* Settles x and y: ranges that are not given come from the series. */
static void settle_axes(const strut_curves *c, strut_axis *x, strut_axis *y) {
  *x = c->x;
  *y = c->y;
  bool fit_x = isnan(x->low) || isnan(x->high), fit_y = isnan(y->low) || isnan(y->high);
  for (size_t i = 0; i < c->series_count; i++) {
    const strut_series *s = &c->series[i];
    for (size_t k = 0; k < s->count; k++) {
      if (!isfinite(s->x[k]) || !isfinite(s->y[k])) continue;
      if (fit_x) strut_axis_include(x, s->x[k]);
      if (fit_y) strut_axis_include(y, s->y[k]);
    }
  }
  strut_axis_settle(x, 0);
  strut_axis_settle(y, fit_y ? 0.06 : 0);
}

/* Places the points of a series on the page; a NAN point separates pieces. */
static bool place_points(plotter *p, size_t i) {
  const strut_series *s = &p->curves->series[i];
  size_t used = 0, start = 0;
  assert(!s->count || (s->x && s->y));
  double(*points)[2] = strut_allocate(s->count + 1, sizeof *points);
  p->points[i] = points;
  if (!points) return false;
  for (size_t k = 0; k <= s->count; k++) {
    double at[2] = {(double)NAN, (double)NAN};
    if (k < s->count && isfinite(s->x[k]) && isfinite(s->y[k]))
      strut_axes_point(&p->axes, s->x[k], s->y[k], at);
    if (isfinite(at[0]) && isfinite(at[1])) {
      points[used][0] = at[0];
      points[used++][1] = at[1];
    } else if (used > start) {
      used = start + strut_thin(points + start, used - start, GRAIN);
      points[used][0] = points[used][1] = (double)NAN;
      start = ++used;
    }
  }
  p->counts[i] = used;
  return true;
}

static bool place_curves(plotter *p, strut_box box) {
  strut_axis x, y;
  settle_axes(p->curves, &x, &y);
  p->axes = strut_axes_place(p->canvas, box, x, y, p->curves->title);
  bool good = true;
  for (size_t i = 0; i < p->curves->series_count && good; i++) {
    strut_release(p->points[i]);
    good = place_points(p, i);
  }
  return good;
}

static void draw_bands(const plotter *p) {
  for (size_t i = 0; i < p->curves->band_count; i++) {
    const strut_band *b = &p->curves->bands[i];
    const strut_fill fill = strut_band_fill();
    const strut_axis *axis = b->level ? &p->axes.y : &p->axes.x;
    double from = fmax(b->low, axis->low), to = fmin(b->high, axis->high), low[2], high[2];
    if (!(to > from)) continue;
    strut_axes_point(&p->axes, b->level ? p->axes.x.low : from, b->level ? to : p->axes.y.high,
                     low);
    strut_axes_point(&p->axes, b->level ? p->axes.x.high : to, b->level ? from : p->axes.y.low,
                     high);
    strut_draw_box(p->canvas, (strut_box){low[0], low[1], high[0] - low[0], high[1] - low[1]},
                   &fill, NULL);
  }
}

/* True on the frame's edge, too. */
static bool is_inside(const strut_box *frame, const double at[2]) {
  const double hair = 0.01; /* [pt] */
  return at[0] >= frame->x - hair && at[0] <= frame->x + frame->width + hair &&
         at[1] >= frame->y - hair && at[1] <= frame->y + frame->height + hair;
}

/* Whole markers, on the frame too. */
static void draw_markers(const plotter *p, size_t i) {
  const strut_series *s = &p->curves->series[i];
  size_t look = style_of(p->curves, i);
  bool all = s->count <= FEW_POINTS;
  if (!all && !s->label) return;
  /* A few markers, at other points than those of the other curves. */
  size_t every = all ? 1 : s->count / MARKERS;
  size_t first = all ? 0 : (look * every / 3 + every / 2) % every;
  for (size_t k = first; k < s->count; k += every) {
    double at[2];
    if (!isfinite(s->x[k]) || !isfinite(s->y[k])) continue;
    strut_axes_point(&p->axes, s->x[k], s->y[k], at);
    if (is_inside(&p->axes.frame, at)) strut_draw_marker(p->canvas, look, at[0], at[1], MARKER);
  }
}

/* Draws the line of a series, which the caller clips. */
static void draw_series(const plotter *p, size_t i) {
  strut_pen pen = strut_series_pen(style_of(p->curves, i));
  double(*points)[2] = p->points[i];
  for (size_t start = 0; start < p->counts[i];) {
    size_t end = start;
    while (end < p->counts[i] && !isnan(points[end][0])) end++;
    if (end - start == 1) { /* a line of one point would be invisible */
      strut_draw_marker(p->canvas, style_of(p->curves, i), points[start][0], points[start][1],
                        LONE_MARKER);
    } else {
      strut_draw_line(p->canvas, (const double(*)[2])points + start, end - start, pen);
    }
    start = end + 1;
  }
}

/* Excursions of a panel's curves beyond the y axis, and how many of them show their values. */
enum { MOST_LABELLED = 6 };

/* Marks the farthest point k of an excursion of series i. */
static void mark_point(const plotter *p, size_t i, size_t k, bool labelled) {
  const strut_series *s = &p->curves->series[i];
  const strut_axes *axes = &p->axes;
  bool above = s->y[k] > axes->y.high;
  double at[2];
  strut_axes_point(axes, s->x[k], above ? axes->y.high : axes->y.low, at);
  strut_draw_beyond(p->canvas, at, above ? STRUT_SIDE_TOP : STRUT_SIDE_BOTTOM);
  if (labelled)
    strut_draw_label(p->canvas,
                     &(strut_label){.text = strut_drawn_quantity(s->y[k], 3, axes->y.unit).text,
                                    .font = {.size = 7, .halo = strut_grey(1)},
                                    .at = {at[0], at[1]},
                                    .gap = STRUT_BEYOND_SIZE + 1,
                                    .angle = (above ? -0.5 : 0.5) * STRUT_PI,
                                    .steady = 0.2,
                                    .inside = axes->frame});
}

/* Marks where curves leave the frame above or below, and says how many points are there. */
static void mark_beyond(const plotter *p) {
  strut_beyond beyond = {0};
  const strut_axis *y = &p->axes.y;
  char text[STRUT_BEYOND_TEXT];
  size_t labelled = 0;
  for (size_t i = 0; i < p->curves->series_count; i++) {
    const strut_series *s = &p->curves->series[i];
    size_t farthest = SIZE_MAX; /* of the excursion that k is in */
    for (size_t k = 0; k <= s->count; k++) {
      bool out = k < s->count && (s->y[k] > y->high || s->y[k] < y->low);
      if (out && (farthest == SIZE_MAX || fabs(s->y[k]) > fabs(s->y[farthest]))) farthest = k;
      if (!out && farthest != SIZE_MAX) mark_point(p, i, farthest, labelled++ < MOST_LABELLED);
      if (!out) farthest = SIZE_MAX;
      if (!out) continue;
      beyond.above++;
      if (fabs(s->y[k]) > fabs(beyond.farthest)) beyond.farthest = s->y[k];
    }
  }
  strut_draw_axis_note(p->canvas, &p->axes, strut_beyond_text(&beyond, "point", y->unit, text));
}

/* Collects the rows of the legend; series of equal names get one row. */
static void name_entries(plotter *p) {
  const strut_curves *c = p->curves;
  for (size_t i = 0; i < c->series_count; i++) {
    const char *label = c->series[i].label;
    bool known = !label || !*label;
    for (size_t k = 0; k < p->entry_count && !known; k++)
      known = strcmp(p->entries[k].label, label) == 0;
    if (known) continue;
    p->entries[p->entry_count++] = (strut_legend_entry){
        .label = label, .look = style_of(c, i), .line = true, .marker = c->series_count > 1};
  }
  for (size_t i = 0; i < c->band_count; i++)
    if (c->bands[i].label)
      p->entries[p->entry_count++] =
          (strut_legend_entry){.label = c->bands[i].label, .area = true, .fill = strut_band_fill()};
}

/* Counts samples of the curves' lines that lie in a box. */
static size_t covered(const plotter *p, strut_box box) {
  size_t count = 0;
  for (size_t i = 0; i < p->curves->series_count; i++)
    for (size_t k = 0; k + 1 < p->counts[i]; k++) {
      const double *a = p->points[i][k], *b = p->points[i][k + 1];
      if (isnan(a[0])) continue;
      int pieces = isnan(b[0]) ? 0 : (int)fmin(fmax(fabs(b[0] - a[0]), fabs(b[1] - a[1])) / 3, 100);
      for (int m = 0; m <= pieces; m++) {
        double t = pieces ? (double)m / pieces : 0;
        double x = t > 0 ? a[0] + t * (b[0] - a[0]) : a[0];
        double y = t > 0 ? a[1] + t * (b[1] - a[1]) : a[1];
        count += x > box.x && x < box.x + box.width && y > box.y && y < box.y + box.height;
      }
    }
  return count;
}

/* Finds a place for a legend of this size that covers no curve; false if every place covers one. */
static bool find_corner(const plotter *p, const double size[2], double corner[2]) {
  const strut_box *f = &p->axes.frame;
  if (size[0] > 0.6 * f->width || size[1] > 0.6 * f->height) return false;
  for (int k = 0; k < 6; k++) {
    double across = k < 4 ? (k % 2 ? 0 : 1) : 0.5, down = k < 4 ? k / 2 : k - 4;
    corner[0] = f->x + INSET + across * (f->width - size[0] - 2 * INSET);
    corner[1] = f->y + INSET + down * (f->height - size[1] - 2 * INSET);
    const strut_box around = {corner[0] - 2, corner[1] - 2, size[0] + 4, size[1] + 4};
    if (!covered(p, around)) return true;
  }
  return false;
}

/* Places the legend inside the frame where it covers no curve, else above a smaller frame. False
   when memory is out. */
static bool place_legend(plotter *p, strut_box box, double corner[2], double *width, bool *inside) {
  double size[2];
  *width = 0;
  if (!p->entry_count) return true;
  strut_legend_size(p->canvas, p->entries, p->entry_count, 0, size);
  *inside = find_corner(p, size, corner);
  if (*inside) return true;
  *width = fmax(p->axes.frame.width, 60);
  strut_legend_size(p->canvas, p->entries, p->entry_count, *width, size);
  strut_box rest = {box.x, box.y + size[1], box.width, box.height - size[1]};
  corner[0] = p->axes.frame.x;
  corner[1] = box.y;
  return place_curves(p, rest);
}

static bool draw_all(plotter *p, strut_box box) {
  double corner[2] = {0, 0}, width = 0;
  bool inside = false;
  if (!place_curves(p, box)) return false;
  name_entries(p);
  if (!place_legend(p, box, corner, &width, &inside)) return false;
  strut_canvas_clip(p->canvas, p->axes.frame);
  draw_bands(p);
  strut_canvas_unclip(p->canvas);
  strut_draw_axes(p->canvas, &p->axes, p->curves->title);
  strut_canvas_clip(p->canvas, p->axes.frame);
  for (size_t i = 0; i < p->curves->series_count; i++) draw_series(p, i);
  strut_canvas_unclip(p->canvas);
  for (size_t i = 0; i < p->curves->series_count && p->curves->series_count > 1; i++)
    draw_markers(p, i);
  if (p->curves->mark_beyond) mark_beyond(p);
  if (p->entry_count)
    strut_draw_legend(p->canvas, p->entries, p->entry_count, width, corner[0], corner[1], inside);
  return true;
}

strut_status strut_draw_curves(strut_canvas *canvas, strut_box box, const strut_curves *curves) {
  plotter p = {.canvas = canvas, .curves = curves};
  size_t count = curves->series_count;
  p.entries = strut_allocate(count + curves->band_count, sizeof *p.entries);
  p.points = strut_allocate(count, sizeof *p.points);
  p.counts = strut_allocate(count, sizeof *p.counts);
  bool good = p.entries && p.points && p.counts && draw_all(&p, box);
  for (size_t i = 0; p.points && i < count; i++) strut_release(p.points[i]);
  strut_release(p.points);
  strut_release(p.counts);
  strut_release(p.entries);
  return good ? STRUT_OK : STRUT_NO_MEMORY;
}

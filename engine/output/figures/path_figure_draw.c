/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The curve of a path, and its shapes over each other. */
#include <math.h>
#include <stdio.h>

#include "engine/output/draw/axes.h"
#include "engine/output/draw/legend.h"
#include "engine/output/draw/palette.h"
#include "engine/output/draw/structure.h"
#include "engine/output/figures/path_figure_parts.h"

enum { NAMED = 12, LABEL = 200, DIRECTIONS = 12 };

static const double MARKER = 2.7, LETTER = 8.5, MARGIN = 15.0, ARROW = 22.0; /* [pt] */
static const double PI = 3.14159265358979323846;

static double from_segment(const double p[2], const double a[2], const double b[2]) {
  double along[2] = {b[0] - a[0], b[1] - a[1]}, square = along[0] * along[0] + along[1] * along[1];
  double t = square > 0 ? ((p[0] - a[0]) * along[0] + (p[1] - a[1]) * along[1]) / square : 0.0;
  t = fmax(0.0, fmin(1.0, t));
  return hypot(p[0] - a[0] - t * along[0], p[1] - a[1] - t * along[1]);
}

/* One more line that names keep off. */
static void keep_off(strut_path_picture *p, const double a[2], const double b[2]) {
  if (p->other_count >= p->other_room) return;
  double(*ends)[2] = p->others + 2 * p->other_count++;
  for (int d = 0; d < 2; d++) {
    ends[0][d] = a[d];
    ends[1][d] = b[d];
  }
}

/* Letters beside the stops, where the line through p->points and other letters leave room. */
static void draw_letters(strut_path_picture *p, strut_box inside, const double (*points)[2]) {
  double placed[STRUT_PATH_STOPS][2];
  size_t count = 0;
  for (size_t i = 0; i < p->stop_count; i++) {
    double best = -HUGE_VAL;
    if (!p->stops[i].letter[0]) continue;
    for (int k = 0; k < DIRECTIONS; k++) {
      double angle = 2 * PI * (k + 0.5) / DIRECTIONS, free = LETTER;
      const double at[2] = {points[i][0] + LETTER * cos(angle), points[i][1] - LETTER * sin(angle)};
      for (size_t j = 0; j + 1 < p->count; j++)
        free = fmin(free, from_segment(at, p->points[j], p->points[j + 1]));
      for (size_t j = 0; j < p->stop_count; j++)
        free = fmin(free, hypot(at[0] - points[j][0], at[1] - points[j][1]));
      for (size_t j = 0; j < count; j++)
        free = fmin(free, hypot(at[0] - placed[j][0], at[1] - placed[j][1]) - LETTER);
      if (at[0] < inside.x + 4 || at[0] > inside.x + inside.width - 4 || at[1] < inside.y + 5 ||
          at[1] > inside.y + inside.height - 5)
        free -= 2 * LETTER;
      if (free <= best + 1e-9) continue;
      best = free;
      placed[count][0] = at[0];
      placed[count][1] = at[1];
    }
    strut_draw_text(p->canvas, placed[count][0], placed[count][1], p->stops[i].letter,
                    (strut_font){.size = 8,
                                 .bold = true,
                                 .across = 0.5,
                                 .down = 0.5,
                                 .halo = strut_faded(strut_grey(1), 0.85)});
    for (int side = -1; side <= 1; side += 2) {
      const double *at = placed[count], half = 3.0;
      const double low[2] = {at[0] - half, at[1] - side * half};
      const double high[2] = {at[0] + half, at[1] + side * half};
      keep_off(p, low, high);
    }
    count++;
  }
}

static void draw_markers(strut_path_picture *p, const double (*points)[2]) {
  const strut_pen edge = {.colour = strut_grey(0.1), .width = 0.6};
  for (size_t i = 0; i < p->stop_count; i++) {
    const strut_fill fill = {.colour = p->stops[i].colour};
    strut_draw_circle(p->canvas, points[i][0], points[i][1], MARKER, &fill, &edge);
  }
}

/* A name cut to a width, in `text`. */
static const char *cut(strut_path_picture *p, const char *name, double width,
                       char text[STRUT_FITTED_TEXT]) {
  return strut_text_fit(p->canvas, name, (strut_font){.size = 8}, width, 0, text);
}

/* What the curve shows of the parameter, in words; cut to a width. */
static void name_height(strut_path_picture *p, double width, char label[LABEL]) {
  char fitted[STRUT_FITTED_TEXT];
  const strut_path *path = p->path;
  bool force = path->reference > 0, all = path->over == STRUT_PATH_OVER_LOAD && !path->load;
  if (path->over == STRUT_PATH_OVER_LOAD)
    snprintf(label, LABEL, "%s of %.100s", force ? "force" : "factor",
             !all                     ? cut(p, path->name, width - 100, fitted)
             : force && path->several ? "each load"
                                      : "the load");
  else if (path->coordinate >= 0)
    snprintf(label, LABEL, "reaction of %.100s", cut(p, path->name, width - 100, fitted));
  else
    snprintf(label, LABEL, "%.100s", cut(p, path->name, width - 40, fitted));
}

static strut_axes place_axes(strut_path_picture *p, strut_box box, char labels[2][LABEL]) {
  static const char *const ways[] = {"to the left", "to the right", "downwards", "upwards"};
  char fitted[STRUT_FITTED_TEXT];
  const char *node = p->model->scene->nodes[p->coordinate / 2].name;
  bool force = p->path->reference > 0 || p->path->coordinate >= 0;
  snprintf(labels[0], LABEL, "motion of %.100s %s",
           cut(p, node, p->upright ? box.height - 125 : box.width - 170, fitted),
           ways[2 * (p->coordinate % 2) + (p->sign > 0)]);
  name_height(p, p->upright ? box.width : box.height, labels[1]);
  strut_axis motion = {.name = labels[0], .unit = "m", .low = (double)NAN, .high = (double)NAN};
  strut_axis height = {.name = labels[1],
                       .unit = force ? "N" : p->path->unit,
                       .low = (double)NAN,
                       .high = (double)NAN};
  for (size_t k = 0; k < p->count; k++) {
    strut_axis_include(&motion, p->vertices[k].motion);
    strut_axis_include(&height, p->vertices[k].height);
  }
  strut_axis_settle(&motion, 0.05);
  strut_axis_settle(&height, 0.05);
  return strut_axes_place(p->canvas, box, p->upright ? height : motion,
                          p->upright ? motion : height, NULL, NULL);
}

void strut_path_draw_curve(strut_path_picture *p, strut_box box) {
  char labels[2][LABEL];
  double stops[STRUT_PATH_STOPS][2];
  strut_axes axes = place_axes(p, box, labels);
  strut_draw_axes(p->canvas, &axes, NULL);
  for (size_t k = 0; k < p->count; k++)
    strut_axes_point(&axes, p->upright ? p->vertices[k].height : p->vertices[k].motion,
                     p->upright ? p->vertices[k].motion : p->vertices[k].height, p->points[k]);
  strut_canvas_clip(p->canvas, axes.frame);
  const strut_pen zero = {.colour = strut_grey(0.6), .width = 0.6, .butt = true};
  if (axes.y.low < 0 && axes.y.high > 0) {
    double at[2];
    strut_axes_point(&axes, axes.x.low, 0.0, at);
    strut_draw_segment(p->canvas, at[0], at[1], at[0] + axes.frame.width, at[1], zero);
  }
  for (size_t first = 0, k = 1; k < p->count; k++) {
    bool ends = k + 1 == p->count || p->vertices[k].unstable != p->vertices[first].unstable;
    if (!ends) continue;
    strut_pen pen = {.colour = strut_grey(0.15), .width = 1.2};
    if (p->vertices[first].unstable) {
      pen.dash[0] = 3;
      pen.dash[1] = 2;
      pen.butt = true;
    }
    strut_draw_line(p->canvas, (const double(*)[2])p->points + first, k - first + 1, pen);
    first = k;
  }
  strut_canvas_unclip(p->canvas);
  for (size_t i = 0; i < p->stop_count; i++)
    for (int d = 0; d < 2; d++) stops[i][d] = p->points[p->stops[i].vertex][d];
  draw_markers(p, (const double(*)[2])stops);
  draw_letters(p, axes.frame, (const double(*)[2])stops);
}

/* A shape with its motion enlarged, in p->shape. */
static const double *enlarged(strut_path_picture *p, const double *q) {
  const double *from = p->path->points[0].q;
  for (int32_t i = 0; i < p->model->length; i++)
    p->shape[i] = from[i] + p->larger * (q[i] - from[i]);
  return p->shape;
}

/* Which cables pull there; of other members it does not matter. */
static const double *find_taut(strut_path_picture *p, const strut_path_vertex *vertex) {
  for (size_t j = 0; j < p->model->scene->member_count; j++)
    p->taut[j] = vertex->force[j] > 0 ? 1.0 : 0.0;
  return p->taut;
}

/* All shapes' rectangle. */
static strut_bounds bounds_of(strut_path_picture *p) {
  strut_bounds bounds = strut_bounds_none();
  for (size_t i = 0; i < p->stop_count; i++)
    strut_bounds_add(&bounds, p->model, enlarged(p, p->vertices[p->stops[i].vertex].q));
  for (size_t k = 0; k < p->count; k++) { /* the way of the node between them */
    const double *at = enlarged(p, p->vertices[k].q) + p->coordinate / 2 * 2;
    for (int d = 0; d < 2; d++) {
      bounds.low[d] = fmin(bounds.low[d], at[d]);
      bounds.high[d] = fmax(bounds.high[d], at[d]);
    }
  }
  return bounds;
}

double strut_path_shapes_height(strut_path_picture *p, double width) {
  strut_bounds b = bounds_of(p);
  double wide = b.high[0] - b.low[0], high = b.high[1] - b.low[1];
  double scale = wide > 0 ? (width - 2 * MARGIN) / wide : HUGE_VAL;
  return fmax(60.0, fmin(scale * high, 10 * width) + 2 * MARGIN + ARROW);
}

/* The arrow of a load at the beginning [pt]: outwards from its node, or from outside onto it. */
static bool load_arrow(const strut_path_picture *p, const strut_window *window,
                       const strut_load *load, double ends[2][2]) {
  const double *q = p->path->points[0].q;
  double largest = 0.0, size = hypot(load->force[0], load->force[1]), middle[2] = {0, 0};
  if (!strut_path_load_grows(p->path, load) || !(size > 0)) return false;
  for (size_t l = 0; l < p->model->scene->load_count; l++) {
    const strut_load *other = &p->model->scene->loads[l];
    if (strut_path_load_grows(p->path, other))
      largest = fmax(largest, hypot(other->force[0], other->force[1]));
  }
  for (int32_t i = 0; i < 2 * p->model->node_count; i++)
    middle[i % 2] += q[i] / p->model->node_count;
  double length = ARROW * fmax(0.3, size / largest), outwards = 0.0;
  for (int d = 0; d < 2; d++) outwards += (q[2 * load->node + d] - middle[d]) * load->force[d];
  strut_window_point(window, q + 2 * load->node, ends[0]);
  for (int d = 0; d < 2; d++) {
    double step = (d ? -1.0 : 1.0) * load->force[d] / size;
    ends[1][d] = ends[0][d] + step * (MARKER + length);
    ends[0][d] += step * MARKER;
    if (outwards > 0) continue;
    ends[1][d] = ends[0][d] - step * 2 * MARKER;
    ends[0][d] = ends[1][d] - step * length;
  }
  return true;
}

/* The window onto all shapes and arrows. */
static strut_window find_window(strut_path_picture *p, strut_box box) {
  strut_bounds bounds = bounds_of(p), all = bounds;
  strut_window window = strut_window_fit(box, bounds, MARGIN);
  for (int pass = 0; pass < 3; pass++) { /* arrows are of the page, not of the plane */
    all = bounds;
    for (size_t l = 0; l < p->model->scene->load_count; l++) {
      double ends[2][2];
      if (!load_arrow(p, &window, &p->model->scene->loads[l], ends)) continue;
      for (int k = 0; k < 2; k++) {
        const double at[2] = {window.left + (ends[k][0] - box.x) / window.scale,
                              window.top - (ends[k][1] - box.y) / window.scale};
        for (int d = 0; d < 2; d++) {
          all.low[d] = fmin(all.low[d], at[d]);
          all.high[d] = fmax(all.high[d], at[d]);
        }
      }
    }
    window = strut_window_fit(box, all, MARGIN);
  }
  return window;
}

static void draw_way(strut_path_picture *p, const strut_window *window, double stops[][2]) {
  int32_t node = p->coordinate / 2;
  for (size_t k = 0; k < p->count; k++) {
    const double *at = enlarged(p, p->vertices[k].q) + 2 * node;
    p->points[k][0] = at[0];
    p->points[k][1] = at[1];
  }
  for (size_t k = 0; k < p->count; k++) {
    const double at[2] = {p->points[k][0], p->points[k][1]};
    strut_window_point(window, at, p->points[k]);
  }
  strut_draw_line(p->canvas, (const double(*)[2])p->points, p->count,
                  (strut_pen){.colour = strut_grey(0.45), .width = 0.7});
  for (size_t i = 0; i < p->stop_count; i++)
    for (int d = 0; d < 2; d++) stops[i][d] = p->points[p->stops[i].vertex][d];
}

void strut_path_draw_shapes(strut_path_picture *p, strut_box box) {
  double stops[STRUT_PATH_STOPS][2], arrow[2][2];
  strut_window window = find_window(p, box);
  p->other_count = 0; /* the curve's letters are elsewhere */
  strut_draw_ground(p->canvas, &window, p->model);
  for (size_t i = 0; i < p->stop_count; i++) {
    const strut_path_vertex *vertex = &p->vertices[p->stops[i].vertex];
    const double *q = vertex->q;
    const strut_structure_style style = {.colouring = STRUT_COLOUR_ONE,
                                         .colour = p->stops[i].colour,
                                         .slack_forces = find_taut(p, vertex),
                                         .thinness = 0.3,
                                         .no_supports = i > 0};
    strut_draw_structure(p->canvas, &window, p->model, enlarged(p, q), &style);
    for (size_t j = 0; i > 0 && j < p->model->scene->member_count; j++) {
      const int32_t *node = p->model->scene->members[j].node;
      double ends[2][2];
      for (int k = 0; k < 2; k++) strut_window_point(&window, p->shape + 2 * node[k], ends[k]);
      keep_off(p, ends[0], ends[1]);
    }
  }
  for (size_t l = 0; l < p->model->scene->load_count; l++) {
    if (!load_arrow(p, &window, &p->model->scene->loads[l], arrow)) continue;
    strut_draw_arrow(p->canvas, arrow[0][0], arrow[0][1], arrow[1][0], arrow[1][1], 6,
                     (strut_pen){.colour = strut_palette_thing(1), .width = 1.4});
    keep_off(p, arrow[0], arrow[1]);
  }
  draw_way(p, &window, stops);
  draw_markers(p, (const double(*)[2])stops);
  draw_letters(p, box, (const double(*)[2])stops);
  if (p->model->node_count <= NAMED)
    strut_draw_names(p->canvas, &window, p->model, p->path->points[0].q, true, false,
                     (const double(*)[2])p->others, p->other_count);
}

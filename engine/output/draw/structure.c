/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The window, members and nodes. */
#include "engine/output/draw/structure.h"

#include <math.h>

#include "engine/output/draw/palette.h"
#include "engine/output/draw/structure_parts.h"

enum { SHADES = 33, BATCH = 256 };

static const double BAR = 2.4, SPRING = 1.3, CABLE = 0.8, CASING = 0.7; /* [pt] */
static const double FULL_LENGTH = 28.0; /* members this long on the page have full width [pt] */
static const double THINNEST = 0.06;

strut_bounds strut_bounds_none(void) {
  return (strut_bounds){{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
}

void strut_bounds_add(strut_bounds *b, const strut_model *model, const double *q) {
  for (int32_t i = 0; i < 2 * model->node_count; i++) {
    if (!isfinite(q[i])) continue;
    b->low[i % 2] = fmin(b->low[i % 2], q[i]);
    b->high[i % 2] = fmax(b->high[i % 2], q[i]);
  }
}

strut_window strut_window_fit(strut_box box, strut_bounds b, double margin) {
  double width = b.high[0] - b.low[0], height = b.high[1] - b.low[1];
  bool empty = !(width >= 0 && height >= 0);
  double middle[2] = {empty ? 0 : b.low[0] + 0.5 * width, empty ? 0 : b.low[1] + 0.5 * height};
  double room[2] = {fmax(box.width - 2 * margin, 1), fmax(box.height - 2 * margin, 1)};
  double scale = fmin(room[0] / width, room[1] / height);
  if (empty || !(scale < HUGE_VAL)) scale = fmin(room[0], room[1]); /* a single point: 1 m wide */
  return (strut_window){.box = box,
                        .scale = scale,
                        .left = middle[0] - 0.5 * box.width / scale,
                        .top = middle[1] + 0.5 * box.height / scale};
}

void strut_window_point(const strut_window *w, const double position[2], double point[2]) {
  point[0] = w->box.x + (position[0] - w->left) * w->scale;
  point[1] = w->box.y + (w->top - position[1]) * w->scale;
}

void strut_member_ends(const strut_window *w, const strut_model *model, const double *q,
                       size_t member, double ends[2][2]) {
  const strut_member *m = &model->scene->members[member];
  for (int k = 0; k < 2; k++) strut_window_point(w, q + 2 * m->node[k], ends[k]);
}

/* How much thinner than usual things are, for members of this mean length on the page. */
static double thinning(const strut_window *w, const strut_model *model, const double *q) {
  double sum = 0;
  size_t count = model->scene->member_count, finite = 0;
  for (size_t j = 0; j < count; j++) {
    double ends[2][2];
    strut_member_ends(w, model, q, j, ends);
    double length = hypot(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]);
    if (isfinite(length)) sum += length, finite++;
  }
  return finite ? fmax(THINNEST, fmin(1.0, sum / (double)finite / FULL_LENGTH)) : 1.0;
}

/* One way to draw some of the members: they share a pen. */
typedef struct batch {
  strut_canvas *canvas;
  strut_pen pen;
  size_t count;
  double ends[2 * BATCH][2];
} batch;

static void flush(batch *b) {
  strut_draw_segments(b->canvas, (const double(*)[2])b->ends, b->count, b->pen);
  b->count = 0;
}

static void add(batch *b, const double ends[2][2]) {
  for (int k = 0; k < 2; k++)
    for (int d = 0; d < 2; d++) b->ends[2 * b->count + (size_t)k][d] = ends[k][d];
  if (++b->count == BATCH) flush(b);
}

typedef struct look {
  const strut_window *window;
  const strut_model *model;
  const double *q;
  const strut_structure_style *style;
  double thin, opacity;
} look;

static bool is_slack(const look *l, size_t j) {
  if (l->model->scene->members[j].kind != STRUT_CABLE) return false;
  if (l->style->slack_forces) return !(l->style->slack_forces[j] > 0);
  const strut_member *m = &l->model->scene->members[j];
  const double *a = l->q + 2 * m->node[0], *b = l->q + 2 * m->node[1];
  return hypot(b[0] - a[0], b[1] - a[1]) < l->model->members.rest[j] * (1 - 1e-12);
}

static double width_of(const look *l, size_t j) {
  strut_member_kind kind = l->model->scene->members[j].kind;
  double width = kind == STRUT_BAR ? BAR : kind == STRUT_SPRING ? SPRING : CABLE;
  return width * l->thin / (1.0 + l->style->thinness);
}

/* The shade of a member, -1 where it has none of its own. */
static int shade_of(const look *l, size_t j) {
  if (l->style->colouring != STRUT_COLOUR_FORCE || !l->style->values) return -1;
  double limit = l->style->limit, value = l->style->values[j];
  double part = limit > 0 && isfinite(value) ? fmax(-1.0, fmin(1.0, value / limit)) : 0;
  return (int)lround(0.5 * (part + 1.0) * (SHADES - 1));
}

static strut_colour colour_of(const look *l, strut_member_kind kind, bool slack, int shade) {
  if (l->style->colouring == STRUT_COLOUR_ONE) return l->style->colour;
  if (slack) return strut_grey(0.55);
  if (shade >= 0) return strut_palette_signed(2.0 * shade / (SHADES - 1) - 1.0);
  return kind == STRUT_BAR      ? strut_grey(0.15)
         : kind == STRUT_SPRING ? strut_palette_thing(0)
                                : strut_palette_thing(1);
}

/* A dark edge keeps light colours apart from the paper. */
static void draw_casings(strut_canvas *canvas, const look *l, strut_member_kind kind) {
  batch b = {.canvas = canvas};
  b.pen.colour = strut_faded(strut_grey(0.1), l->opacity);
  for (size_t j = 0; j < l->model->scene->member_count; j++) {
    double ends[2][2];
    if (l->model->scene->members[j].kind != kind) continue;
    b.pen.width = width_of(l, j) + CASING * l->thin;
    strut_member_ends(l->window, l->model, l->q, j, ends);
    add(&b, (const double(*)[2])ends);
  }
  flush(&b);
}

/* All members of one kind, slackness and shade, in one piece. */
static void draw_alike(strut_canvas *canvas, const look *l, strut_member_kind kind, bool slack,
                       int shade) {
  batch b = {.canvas = canvas};
  b.pen.colour = strut_faded(colour_of(l, kind, slack, shade), l->opacity);
  if (slack) {
    b.pen.dash[0] = 2.5 * l->thin;
    b.pen.dash[1] = 2.0 * l->thin;
    b.pen.butt = true;
  }
  for (size_t j = 0; j < l->model->scene->member_count; j++) {
    double ends[2][2];
    if (l->model->scene->members[j].kind != kind || is_slack(l, j) != slack) continue;
    if (!slack && shade_of(l, j) != shade) continue;
    b.pen.width = width_of(l, j);
    strut_member_ends(l->window, l->model, l->q, j, ends);
    add(&b, (const double(*)[2])ends);
  }
  flush(&b);
}

/* Thin things lie above thick ones, so that a cable along a bar is seen. */
static void draw_members(strut_canvas *canvas, const look *l) {
  static const strut_member_kind order[] = {STRUT_BAR, STRUT_SPRING, STRUT_CABLE};
  bool shaded = l->style->colouring == STRUT_COLOUR_FORCE && l->style->values;
  for (int k = 0; k < 3; k++) {
    if (shaded && order[k] != STRUT_CABLE) draw_casings(canvas, l, order[k]);
    if (order[k] == STRUT_CABLE) draw_alike(canvas, l, order[k], true, -1);
    if (!shaded) draw_alike(canvas, l, order[k], false, -1);
    for (int shade = 0; shaded && shade < SHADES; shade++)
      draw_alike(canvas, l, order[k], false, shade);
  }
}

static void draw_nodes(strut_canvas *canvas, const look *l) {
  double thin = l->thin / (1.0 + l->style->thinness), point[2];
  const strut_fill white = {.colour = strut_faded(strut_grey(1), l->opacity)};
  strut_colour edge = l->style->colouring == STRUT_COLOUR_ONE ? l->style->colour : strut_grey(0.1);
  const strut_pen pen = {.colour = strut_faded(edge, l->opacity), .width = 0.8 * thin};
  if (l->thin < 0.3) return; /* a texture has none */
  for (int32_t i = 0; i < l->model->node_count; i++) {
    strut_window_point(l->window, l->q + 2 * i, point);
    strut_draw_circle(canvas, point[0], point[1], 1.9 * thin, &white, &pen);
  }
}

void strut_draw_structure(strut_canvas *canvas, const strut_window *window,
                          const strut_model *model, const double *q,
                          const strut_structure_style *style) {
  const look l = {.window = window,
                  .model = model,
                  .q = q,
                  .style = style,
                  .thin = thinning(window, model, q),
                  .opacity = style->opacity > 0 ? style->opacity : 1.0};
  if (!style->no_supports)
    strut_draw_supports(canvas, window, model, q, fmax(l.thin, 0.3), l.opacity);
  draw_members(canvas, &l);
  if (!style->no_nodes) draw_nodes(canvas, &l);
  if (style->node_names || style->member_names)
    strut_draw_names(canvas, window, model, q, style->node_names, style->member_names, NULL, 0);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/structure.h"
#include "engine/base/vec.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/forces/elements.h"
#include "engine/model/pose.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/draw/chart.h"
#include "engine/output/draw/legend.h"
#include "engine/output/draw/structure_parts.h"
#include "engine/scene/wrap.h"

/* The window, members and nodes. */

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
  for (size_t m = 0; m < model->scene->member_count; m++) { /* circles of guides */
    const strut_member *member = &model->scene->members[m];
    for (size_t k = 1; k <= member->guide_count && member->guide_radius > 0.0; k++)
      for (int c = 0; c < 2; c++) {
        double at = q[2 * strut_member_node(member, k) + c];
        b->low[c] = fmin(b->low[c], at - member->guide_radius);
        b->high[c] = fmax(b->high[c], at + member->guide_radius);
      }
  }
}

strut_window strut_window_fit(strut_box box, strut_bounds b, double margin) {
  assert(box.width > 0 && box.height > 0);
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

size_t strut_member_segments(const strut_model *model, size_t member) {
  return model->scene->members[member].guide_count + 1;
}

/*
 * The straight part of a wrapped member that leads over its way from node k to the next: from where it leaves one
 * circle to where it meets the other. Where a guide is left aside, the parts are divided beside its centre.
 */
static void find_tangent(const strut_scene *scene, const strut_member *m, const double *q, int k,
                         double places[2][2]) {
  double p[STRUT_MOST_WRAPPED][2];
  int n = (int)m->guide_count + 2, at = 0;
  uint32_t right = strut_member_right_guides(scene, m);
  strut_wrap way;
  for (int i = 0; i < n; i++) memcpy(p[i], q + 2 * strut_member_node(m, (size_t)i), sizeof p[i]);
  strut_wrap_find((const double(*)[2])p, n, right, m->guide_radius, &way);
  while (at + 2 < way.count && way.node[at + 1] <= k) at++;
  int from = way.node[at];
  double off = from > 0 ? m->guide_radius * strut_wrap_side(right, from) : 0.0;
  const double ux = way.ux[at], uy = way.uy[at];
  const double start[2] = {p[from][0] + off * uy, p[from][1] - off * ux};
  for (int end = 0; end < 2; end++) {
    double along = (p[k + end][0] - start[0]) * ux + (p[k + end][1] - start[1]) * uy;
    along = fmax(0.0, fmin(along, way.free[at]));
    places[end][0] = start[0] + along * ux, places[end][1] = start[1] + along * uy;
  }
}

void strut_window_segment(const strut_window *w, const strut_model *model, const double *q,
                          size_t member, size_t k, double ends[2][2]) {
  const strut_member *m = &model->scene->members[member];
  double places[2][2];
  for (size_t end = 0; end < 2; end++)
    memcpy(places[end], q + 2 * strut_member_node(m, k + end), sizeof places[end]);
  if (m->guide_count && m->guide_radius > 0.0) find_tangent(model->scene, m, q, (int)k, places);
  for (int end = 0; end < 2; end++) strut_window_point(w, places[end], ends[end]);
}

/* The longest segment of a member, where its name and its stop stand. */
void strut_longest_segment(const strut_window *w, const strut_model *model, const double *q,
                           size_t member, double longest[2][2]) {
  strut_window_segment(w, model, q, member, 0, longest);
  for (size_t k = 1; k < strut_member_segments(model, member); k++) {
    double ends[2][2], x = longest[1][0] - longest[0][0], y = longest[1][1] - longest[0][1];
    strut_window_segment(w, model, q, member, k, ends);
    if (hypot(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]) > hypot(x, y))
      memcpy(longest, ends, sizeof ends);
  }
}

/* Around a structure: supports, ground, contact forces, node paths, the scale bar. */

enum { TRAIL_SHADES = 64 };

static const double GROUND_DEPTH = 7.0; /* of the hatching below the ground's line [pt] */

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

/* Triangles below pinned nodes, on wheels where one direction is free. */
static void draw_supports(strut_canvas *canvas, const strut_window *w, const strut_model *model,
                          const double *q, double size, double opacity) {
  double middle = 0;
  for (int32_t i = 0; i < model->node_count; i++) middle += q[2 * i] / model->node_count;
  for (int32_t i = 0; i < model->node_count; i++) {
    const bool *fixed = model->scene->nodes[i].fixed;
    double tip[2];
    if (!fixed[0] && !fixed[1]) continue;
    strut_window_point(w, q + 2 * i, tip);
    /* Fixed in x only: drawn from the side away from the structure. */
    const double below[2] = {0, 1}, side[2] = {q[2 * i] <= middle ? -1 : 1, 0};
    draw_support(canvas, tip, fixed[1] ? below : side, !(fixed[0] && fixed[1]), size, opacity);
  }
}

/* The ends of the ground's line in the window's neighbourhood [pt]. */
static void find_ground_line(const strut_window *w, const strut_model *model, double ends[2][2]) {
  const strut_ground *ground = &model->scene->ground;
  for (int k = 0; k < 2; k++) {
    double x = w->left + (1.2 * k - 0.1) * w->box.width / w->scale;
    const double position[2] = {x, ground->height + tan(ground->slope) * x};
    strut_window_point(w, position, ends[k]);
  }
}

void strut_draw_ground(strut_canvas *canvas, const strut_window *w, const strut_model *model) {
  strut_draw_ground_at(canvas, w, model, (double)NAN);
}

void strut_draw_ground_at(strut_canvas *canvas, const strut_window *w, const strut_model *model,
                          double time) {
  const strut_ground *ground = &model->scene->ground;
  strut_draw_surfaces(canvas, w, model->scene, time);
  if (!ground->present) return;
  double ends[4][2];
  find_ground_line(w, model, ends);
  const double down[2] = {GROUND_DEPTH * sin(ground->slope), GROUND_DEPTH * cos(ground->slope)};
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
    const strut_contact_pose pose = strut_contact_pose_at(contacts, i, q, NULL, -1);
    const double *n = pose.axes.normal, *t = pose.axes.tangent;
    strut_window_point(w, q + contacts->at[i], at);
    if (fabs(normal) > 0.3) /* the arrow's tip is at the node */
      strut_draw_arrow(canvas, at[0] - normal * n[0], at[1] + normal * n[1], at[0], at[1], 5, pen);
    if (fabs(along) > 0.3)
      strut_draw_arrow(canvas, at[0], at[1], at[0] + along * t[0], at[1] - along * t[1], 5, pen);
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
    for (size_t i = first; i <= last; i++) { /* in pieces of the array's size */
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
  /* The largest of 1, 2 or 5 times a power of ten that fits. */
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

/* Names beside nodes and members, where the page is emptiest. */

enum { DIRECTIONS = 16, MOST_NAMED = 60 };

static const double GAP = 3.6, NAME_SIZE = 7.5, MOST_WIDTH = 90;
static const double SUPPORT = 5.0; /* half the width of a support [pt] */
static const double HATCHED = 2.0, FREE = 1.0,
                    FAR = 6.0;       /* cost, enough freedom, second try [pt] */
static const double COVERED = -20.0; /* clearance where a name begins to cover another one [pt] */

/* What names must not cover: segments, the first of which are the members' longest. */
typedef struct obstacles {
  size_t segment_count, label_count;
  double (*ends)[2]; /* (2 segment_count) [pt] */
  strut_box *labels; /* those placed so far */
  strut_box inside;  /* names stay in here */
  bool ground;       /* hatched to GROUND_DEPTH below the segment `surface` */
  double surface[2][2];
} obstacles;

/* True if a point is on the hatching below the ground's line. */
static bool is_on_hatching(const obstacles *o, const double p[2]) {
  const double *a = o->surface[0], *b = o->surface[1];
  double along[2] = {b[0] - a[0], b[1] - a[1]}, length = hypot(along[0], along[1]);
  double depth = (along[0] * (p[1] - a[1]) - along[1] * (p[0] - a[0])) / length;
  return o->ground && depth > 0 && depth < GROUND_DEPTH;
}

/* Distance of a box from all that is drawn; negative where it covers another name or leaves the
   page. */
static double clearance(const obstacles *o, strut_box box) {
  double least = HUGE_VAL;
  for (int i = 0; i <= 4; i++)
    for (int k = 0; k <= 2; k++) {
      const double p[2] = {box.x + 0.25 * i * box.width, box.y + 0.5 * k * box.height};
      if (is_on_hatching(o, p)) least = -HATCHED;
    }
  for (size_t j = 0; j < o->segment_count; j++)
    for (int i = 0; i <= 4; i++)
      for (int k = 0; k <= 2; k++) {
        const double p[2] = {box.x + 0.25 * i * box.width, box.y + 0.5 * k * box.height};
        least = fmin(least, strut_distance_to_segment(p, o->ends[2 * j], o->ends[2 * j + 1]));
      }
  for (size_t i = 0; i < o->label_count; i++) {
    const strut_box *other = &o->labels[i];
    double dx = fmax(other->x - box.x - box.width, box.x - other->x - other->width);
    double dy = fmax(other->y - box.y - box.height, box.y - other->y - other->height);
    double apart = fmax(dx, dy);
    least = fmin(least, apart < 0 ? apart + COVERED : apart);
  }
  double out = fmax(fmax(o->inside.x - box.x, o->inside.y - box.y),
                    fmax(box.x + box.width - o->inside.x - o->inside.width,
                         box.y + box.height - o->inside.y - o->inside.height));
  return out > 0 ? fmin(least, -out) : least;
}

static strut_font name_font(void) {
  return (strut_font){.size = NAME_SIZE, .italic = true, .halo = strut_faded(strut_grey(1), 0.85)};
}

/* The box of a name of this size around `at`, in one of the directions. */
static strut_box beside(const double at[2], int direction, double gap, double width,
                        double height) {
  double angle = 2 * STRUT_PI * direction / DIRECTIONS;
  double x = at[0] + (gap + 0.5 * width) * cos(angle),
         y = at[1] - (gap + 0.5 * height) * sin(angle);
  return (strut_box){x - 0.5 * width, y - 0.5 * height, width, height};
}

static void draw_name(strut_canvas *canvas, obstacles *o, const double at[2], double gap,
                      const char *name) {
  double width, height, best = -HUGE_VAL;
  char fitted[STRUT_FITTED_TEXT];
  strut_box chosen = {0};
  name = strut_text_fit(canvas, name, name_font(), MOST_WIDTH, 0, fitted);
  strut_text_size(canvas, name, name_font(), &width, &height);
  for (int k = 0; k < 2 * DIRECTIONS; k++) {
    /* Start at the upper right; any clearance of 4 pt is enough. A second ring is tried if the
       first is full. */
    int direction = (k + DIRECTIONS / 8) % DIRECTIONS;
    if (k == DIRECTIONS && best > FREE) break;
    strut_box box = beside(at, direction, gap + (k < DIRECTIONS ? 0 : FAR), width, height);
    double free = fmin(clearance(o, box), 4.0);
    if (free > best + 1e-9) {
      best = free;
      chosen = box;
    }
  }
  if (best <= COVERED) return; /* one of many: those that can be read say more */
  o->labels[o->label_count++] = chosen;
  strut_draw_text(canvas, chosen.x, chosen.y, name, name_font());
}

/* Adds the sides of supports below nodes as segments. */
static void add_supports(const strut_window *w, const strut_model *model, const double *q,
                         obstacles *o) {
  for (int32_t i = 0; i < model->node_count; i++) {
    if (!model->scene->nodes[i].fixed[1]) continue;
    for (int side = -1; side <= 1; side += 2) {
      double(*ends)[2] = o->ends + 2 * o->segment_count++;
      strut_window_point(w, q + 2 * i, ends[0]);
      ends[1][0] = ends[0][0] + side * SUPPORT;
      ends[1][1] = ends[0][1] + 2 * SUPPORT;
    }
  }
}

static bool collect_obstacles(const strut_window *w, const strut_model *model, const double *q,
                              size_t others, obstacles *o, strut_arena *arena) {
  size_t members = model->scene->member_count, nodes = (size_t)model->node_count, all = members;
  for (size_t j = 0; j < members; j++)
    if (model->scene->members[j].guide_count) all += strut_member_segments(model, j);
  o->ends = strut_arena_allocate(arena, 2 * (all + 1 + 2 * nodes + others), sizeof *o->ends);
  o->labels = strut_arena_allocate(arena, nodes + members, sizeof *o->labels);
  o->inside = w->box;
  if (!o->ends || !o->labels) return false;
  for (size_t j = 0; j < members; j++)
    strut_longest_segment(w, model, q, j, o->ends + 2 * o->segment_count++);
  for (size_t j = 0; j < members; j++)
    for (size_t k = 0; model->scene->members[j].guide_count && k < strut_member_segments(model, j);
         k++)
      strut_window_segment(w, model, q, j, k, o->ends + 2 * o->segment_count++);
  if (model->scene->ground.present) { /* its line is one more segment */
    double(*line)[2] = o->ends + 2 * o->segment_count++;
    find_ground_line(w, model, line);
    memcpy(o->surface, line, sizeof o->surface);
    o->ground = true;
  }
  add_supports(w, model, q, o);
  return true;
}

void strut_draw_names(strut_canvas *canvas, const strut_window *w, const strut_model *model,
                      const double *q, const strut_drawn_names *names) {
  size_t other_count = names->other_count;
  const strut_scene *scene = model->scene;
  strut_arena arena = {0};
  obstacles o = {0};
  if (scene->node_count <= MOST_NAMED && collect_obstacles(w, model, q, other_count, &o, &arena)) {
    if (other_count)
      memcpy(o.ends + 2 * o.segment_count, names->others, 2 * other_count * sizeof *names->others);
    o.segment_count += other_count;
    for (size_t i = 0; i < scene->node_count && names->nodes; i++) {
      double at[2];
      strut_window_point(w, q + 2 * i, at);
      if (isfinite(at[0]) && isfinite(at[1])) draw_name(canvas, &o, at, GAP, scene->nodes[i].name);
    }
    for (size_t j = 0; j < scene->member_count && names->members; j++) {
      /* the middle of its longest segment */
      const double at[2] = {0.5 * (o.ends[2 * j][0] + o.ends[2 * j + 1][0]),
                            0.5 * (o.ends[2 * j][1] + o.ends[2 * j + 1][1])};
      if (isfinite(at[0]) && isfinite(at[1]))
        draw_name(canvas, &o, at, 1.5, scene->members[j].name);
    }
  }
  strut_arena_free(&arena);
}

/* Members and nodes. */

/* Factor for line widths, from the mean length of the members on the page. */
static double thinning(const strut_window *w, const strut_model *model, const double *q) {
  double sum = 0;
  size_t count = model->scene->member_count, finite = 0;
  for (size_t j = 0; j < count; j++)
    for (size_t k = 0; k < strut_member_segments(model, j); k++) {
      double ends[2][2];
      strut_window_segment(w, model, q, j, k, ends);
      double length = hypot(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]);
      if (isfinite(length)) sum += length, finite++;
    }
  return finite ? fmax(THINNEST, fmin(1.0, sum / (double)finite / FULL_LENGTH)) : 1.0;
}

/* Members drawn together, with one pen. */
typedef struct batch {
  strut_canvas *canvas;
  strut_pen pen;
  size_t count;
  double ends[2 * BATCH][2];
} batch;

static void draw_batch(batch *b) {
  strut_draw_segments(b->canvas, (const double(*)[2])b->ends, b->count, b->pen);
  b->count = 0;
}

static void add_segment(batch *b, double ends[2][2]) {
  for (int k = 0; k < 2; k++)
    for (int d = 0; d < 2; d++) b->ends[2 * b->count + (size_t)k][d] = ends[k][d];
  if (++b->count == BATCH) draw_batch(b);
}

static bool is_slack(const strut_drawing *d, size_t j) {
  if (d->model->scene->members[j].kind != STRUT_CABLE) return false;
  if (d->style->slack_forces) return !(fabs(d->style->slack_forces[j]) > 0);
  return strut_member_path_length(d->model, (int32_t)j, d->q) <
         d->model->members.rest[j] * (1 - 1e-12);
}

static double width_of(const strut_drawing *d, size_t j) {
  strut_member_kind kind = d->model->scene->members[j].kind;
  double width = kind == STRUT_BAR ? BAR : kind == STRUT_SPRING ? SPRING : CABLE;
  return width * d->thin / (1.0 + d->style->thinness);
}

/* Index of a member's force colour; -1 where members are not coloured by force. */
static int shade_of(const strut_drawing *d, size_t j) {
  if (d->style->colouring != STRUT_COLOUR_FORCE || !d->style->values) return -1;
  double limit = d->style->limit, value = d->style->values[j];
  double part = limit > 0 && isfinite(value) ? fmax(-1.0, fmin(1.0, value / limit)) : 0;
  return (int)lround(0.5 * (part + 1.0) * (SHADES - 1));
}

static strut_colour colour_of(const strut_drawing *d, strut_member_kind kind, bool slack,
                              int shade) {
  if (d->style->colouring == STRUT_COLOUR_ONE) return d->style->colour;
  if (slack) return strut_grey(0.55);
  if (shade >= 0) return strut_palette_signed(2.0 * shade / (SHADES - 1) - 1.0);
  return kind == STRUT_BAR      ? strut_grey(0.15)
         : kind == STRUT_SPRING ? strut_palette_thing(0)
                                : strut_palette_thing(1);
}

/* Adds all segments of a member. */
static void add_member(batch *b, const strut_drawing *d, size_t j) {
  double ends[2][2];
  for (size_t k = 0; k < strut_member_segments(d->model, j); k++) {
    strut_window_segment(d->window, d->model, d->q, j, k, ends);
    add_segment(b, ends);
  }
}

/* A dark edge separates light colours from the paper. */
static void draw_casings(strut_canvas *canvas, const strut_drawing *d, strut_member_kind kind) {
  batch b = {.canvas = canvas};
  b.pen.colour = strut_faded(strut_grey(0.1), d->opacity);
  for (size_t j = 0; j < d->model->scene->member_count; j++) {
    if (d->model->scene->members[j].kind != kind) continue;
    b.pen.width = width_of(d, j) + CASING * d->thin;
    add_member(&b, d, j);
  }
  draw_batch(&b);
}

/* Draws all members of one kind, slackness and shade. */
static void draw_alike(strut_canvas *canvas, const strut_drawing *d, strut_member_kind kind,
                       bool slack, int shade) {
  batch b = {.canvas = canvas};
  b.pen.colour = strut_faded(colour_of(d, kind, slack, shade), d->opacity);
  if (slack) {
    b.pen.dash[0] = 2.5 * d->thin;
    b.pen.dash[1] = 2.0 * d->thin;
    b.pen.butt = true;
  }
  for (size_t j = 0; j < d->model->scene->member_count; j++) {
    if (d->model->scene->members[j].kind != kind || is_slack(d, j) != slack) continue;
    if (!slack && shade_of(d, j) != shade) continue;
    b.pen.width = width_of(d, j);
    add_member(&b, d, j);
  }
  draw_batch(&b);
}

/* Thin members are drawn above thick ones, so that a cable along a bar is visible. */
static void draw_members(strut_canvas *canvas, const strut_drawing *d) {
  static const strut_member_kind order[] = {STRUT_BAR, STRUT_SPRING, STRUT_CABLE};
  bool shaded = d->style->colouring == STRUT_COLOUR_FORCE && d->style->values;
  for (int k = 0; k < 3; k++) {
    if (shaded && order[k] != STRUT_CABLE) draw_casings(canvas, d, order[k]);
    if (order[k] == STRUT_CABLE) draw_alike(canvas, d, order[k], true, -1);
    if (!shaded) draw_alike(canvas, d, order[k], false, -1);
    for (int shade = 0; shaded && shade < SHADES; shade++)
      draw_alike(canvas, d, order[k], false, shade);
  }
}

/* Masses that slide along members: filled circles on them. */
static void draw_sliding_masses(strut_canvas *canvas, const strut_drawing *d) {
  const strut_scene *scene = d->model->scene;
  double thin = d->thin / (1.0 + d->style->thinness), point[2], at[2];
  bool one = d->style->colouring == STRUT_COLOUR_ONE;
  strut_colour colour = one ? d->style->colour : strut_palette_thing(2);
  const strut_fill fill = {.colour = strut_faded(colour, d->opacity)};
  const strut_pen pen = {.colour = strut_faded(strut_grey(1), d->opacity), .width = 0.5 * thin};
  if (d->thin < 0.3) return; /* too small to be drawn */
  for (size_t i = 0; i < scene->sliding_count; i++) {
    const int32_t *node = scene->members[scene->sliding_masses[i].member].node;
    double far = strut_sliding_mass_share(scene, i, d->style->time);
    for (int c = 0; c < 2; c++)
      at[c] = (1.0 - far) * d->q[2 * node[0] + c] + far * d->q[2 * node[1] + c];
    strut_window_point(d->window, at, point);
    if (isfinite(point[0]) && isfinite(point[1]))
      strut_draw_circle(canvas, point[0], point[1], 3.2 * thin, &fill, &pen);
  }
}

static void draw_nodes(strut_canvas *canvas, const strut_drawing *d) {
  double thin = d->thin / (1.0 + d->style->thinness), point[2];
  const strut_fill white = {.colour = strut_faded(strut_grey(1), d->opacity)};
  strut_colour edge = d->style->colouring == STRUT_COLOUR_ONE ? d->style->colour : strut_grey(0.1);
  const strut_pen pen = {.colour = strut_faded(edge, d->opacity), .width = 0.8 * thin};
  if (d->thin < 0.3) return; /* too small to be drawn */
  for (int32_t i = 0; i < d->model->node_count; i++) {
    strut_window_point(d->window, d->q + 2 * i, point);
    strut_draw_circle(canvas, point[0], point[1], 1.9 * thin, &white, &pen);
  }
}

void strut_draw_structure(strut_canvas *canvas, const strut_window *window,
                          const strut_model *model, const double *q,
                          const strut_structure_style *style) {
  const strut_drawing d = {.window = window,
                           .model = model,
                           .q = q,
                           .style = style,
                           .thin = thinning(window, model, q),
                           .opacity = style->opacity > 0 ? style->opacity : 1.0};
  if (!style->no_supports) draw_supports(canvas, window, model, q, fmax(d.thin, 0.3), d.opacity);
  strut_draw_cells(canvas, &d);
  strut_draw_collisions(canvas, &d);
  draw_members(canvas, &d);
  strut_draw_elements(canvas, &d);
  if (!style->no_nodes) draw_nodes(canvas, &d);
  draw_sliding_masses(canvas, &d);
  if (style->node_names || style->member_names)
    strut_draw_names(
        canvas, window, model, q,
        &(strut_drawn_names){.nodes = style->node_names, .members = style->member_names});
}

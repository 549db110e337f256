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
#include "engine/output/draw/structure_parts.h"
#include "engine/scene/wrap.h"

/* The window, members and nodes. */

enum { SHADES = 16, BATCH = 256 }; /* of either sign; segments */

static const double BAR = 2.4, SPRING = 1.3, CABLE = 0.8, CASING = 0.7; /* [pt] */
static const double FULL_LENGTH = 28.0; /* members this long on the page have full width [pt] */
static const double THINNEST = 0.06, FRINGE_DASH = 2.2; /* [1], [pt] */
static const double SMALLEST = 0.3;                     /* more that is thinner is not drawn */

strut_bounds strut_bounds_none(void) {
  return (strut_bounds){{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
}

void strut_bounds_widen(strut_bounds *bounds, const double low[2], const double high[2]) {
  for (int d = 0; d < 2; d++) {
    bounds->low[d] = fmin(bounds->low[d], low[d]);
    bounds->high[d] = fmax(bounds->high[d], high[d]);
  }
}

void strut_bounds_add(strut_bounds *bounds, const strut_model *model, const double *positions) {
  for (int32_t i = 0; i < 2 * model->node_count; i++) {
    if (!isfinite(positions[i])) continue;
    bounds->low[i % 2] = fmin(bounds->low[i % 2], positions[i]);
    bounds->high[i % 2] = fmax(bounds->high[i % 2], positions[i]);
  }
  for (size_t m = 0; m < model->scene->member_count; m++) { /* circles of guides */
    const strut_member *member = &model->scene->members[m];
    double radius = member->guide_radius;
    for (size_t k = 1; k <= member->guide_count && radius > 0.0; k++) {
      const double *at = positions + 2 * strut_member_node(member, k);
      strut_bounds_widen(bounds, (const double[2]){at[0] - radius, at[1] - radius},
                         (const double[2]){at[0] + radius, at[1] + radius});
    }
  }
}

void strut_bounds_share(strut_bounds *bounds, const double size[2]) {
  double middle = 0.5 * (bounds->low[0] + bounds->high[0]);
  bounds->low[0] = middle - 0.5 * size[0], bounds->high[0] = middle + 0.5 * size[0];
  bounds->high[1] = bounds->low[1] + size[1];
}

double strut_bounds_extent(const strut_bounds *bounds) {
  return fmax(bounds->high[0] - bounds->low[0], bounds->high[1] - bounds->low[1]);
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

void strut_window_point(const strut_window *window, const double position[2], double point[2]) {
  point[0] = window->box.x + (position[0] - window->left) * window->scale;
  point[1] = window->box.y + (window->top - position[1]) * window->scale;
}

static size_t count_segments(const strut_model *model, size_t member) {
  return model->scene->members[member].guide_count + 1;
}

/*
 * The straight part of a wrapped member that leads over its way from node k to the next: from where it leaves one
 * circle to where it meets the other. Where a guide is left aside, the parts are divided beside its centre.
 */
static void find_tangent(const strut_scene *scene, const strut_member *member,
                         const double *positions, int k, double places[2][2]) {
  double p[STRUT_MOST_WRAPPED][2];
  int n = (int)member->guide_count + 2, at = 0;
  uint32_t right = strut_member_right_guides(scene, member);
  strut_wrap way;
  for (int i = 0; i < n; i++)
    memcpy(p[i], positions + 2 * strut_member_node(member, (size_t)i), sizeof p[i]);
  strut_wrap_find((const double(*)[2])p, n, right, member->guide_radius, &way);
  while (at + 2 < way.count && way.node[at + 1] <= k) at++;
  int from = way.node[at];
  double off = from > 0 ? member->guide_radius * strut_wrap_side(right, from) : 0.0;
  const double ux = way.ux[at], uy = way.uy[at];
  const double start[2] = {p[from][0] + off * uy, p[from][1] - off * ux};
  for (int end = 0; end < 2; end++) {
    double along = (p[k + end][0] - start[0]) * ux + (p[k + end][1] - start[1]) * uy;
    along = fmax(0.0, fmin(along, way.free[at]));
    places[end][0] = start[0] + along * ux, places[end][1] = start[1] + along * uy;
  }
}

void strut_window_segment(const strut_window *window, const strut_model *model,
                          const double *positions, size_t member, size_t k, double ends[2][2]) {
  const strut_member *m = &model->scene->members[member];
  double places[2][2];
  for (size_t end = 0; end < 2; end++)
    memcpy(places[end], positions + 2 * strut_member_node(m, k + end), sizeof places[end]);
  if (m->guide_count && m->guide_radius > 0.0)
    find_tangent(model->scene, m, positions, (int)k, places);
  for (int end = 0; end < 2; end++) strut_window_point(window, places[end], ends[end]);
}

/* The longest segment of a member, where its name and its stop stand. */
void strut_longest_segment(const strut_window *window, const strut_model *model,
                           const double *positions, size_t member, double longest[2][2]) {
  double most = -1.0, ends[2][2];
  for (size_t k = 0; k < count_segments(model, member); k++) {
    strut_window_segment(window, model, positions, member, k, ends);
    double length = strut_settle_coordinate(strut_distance(ends[0], ends[1]));
    if (k && !(length > most)) continue;
    memcpy(longest, ends, sizeof ends);
    most = length;
  }
}

/* Around a structure: supports, contact forces, the scale bar. */

/* A support's triangle, its tip at the node, its base towards `out`; rolling: on two wheels. */
static void draw_support(strut_canvas *canvas, const double tip[2], const double out[2],
                         bool rolling, double size, double opacity) {
  const double height = 7.0 * size, half = 4.2 * size, wheel = 1.1 * size;
  const double base = height + (rolling ? 2 * wheel : 0), below = base + 3.5 * size;
  const double place[][2] = {{0, 0}, /* outwards, across */
                             {height, half},
                             {height, -half},
                             {base, 1.5 * half},
                             {base, -1.5 * half},
                             {below, -1.5 * half},
                             {below, 1.5 * half},
                             {height + wheel, 0.55 * half},
                             {height + wheel, -0.55 * half}};
  const strut_pen pen = {.colour = strut_faded(strut_grey(0.25), opacity), .width = 0.7 * size};
  const strut_fill white = {.colour = strut_faded(strut_grey(1), opacity)};
  const strut_fill hatched = {.hatch = STRUT_HATCH_RISING,
                              .hatch_colour = strut_faded(strut_grey(0.45), opacity)};
  double at[9][2];
  for (int k = 0; k < 9; k++) {
    at[k][0] = tip[0] + place[k][0] * out[0] - place[k][1] * out[1];
    at[k][1] = tip[1] + place[k][0] * out[1] + place[k][1] * out[0];
  }
  strut_draw_polygon(canvas, (const double(*)[2])at, 3, &white, &pen);
  for (int k = 7; k < 9 && rolling; k++)
    strut_draw_circle(canvas, at[k][0], at[k][1], wheel, &white, &pen);
  strut_draw_polygon(canvas, (const double(*)[2])at + 3, 4, &hatched, NULL);
  strut_draw_line(canvas, (const double(*)[2])at + 3, 2, pen);
}

/* Triangles below pinned nodes, on wheels where one direction is free. */
static void draw_supports(strut_canvas *canvas, const strut_window *window,
                          const strut_model *model, const double *positions, double size,
                          double opacity) {
  double centre[2] = {0.0, 0.0}, middle[2];
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    centre[i % 2] += positions[i] / model->node_count;
  strut_window_point(window, centre, middle);
  for (int32_t i = 0; i < model->node_count; i++) {
    const bool *fixed = model->scene->nodes[i].fixed;
    double tip[2];
    if (!fixed[0] && !fixed[1]) continue;
    strut_window_point(window, positions + 2 * i, tip);
    /* Fixed in x only: drawn from the side away from the structure. */
    bool left = strut_settle_coordinate(tip[0]) <= strut_settle_coordinate(middle[0]);
    const double below[2] = {0, 1}, side[2] = {left ? -1 : 1, 0};
    draw_support(canvas, tip, fixed[1] ? below : side, !(fixed[0] && fixed[1]), size, opacity);
  }
}

void strut_draw_contact_forces(strut_canvas *canvas, const strut_window *window,
                               const strut_model *model, const double *positions,
                               const double (*force)[2], double limit, double longest) {
  const strut_contact_table *contacts = &model->contacts;
  const strut_pen pen = {.colour = strut_palette_thing(1), .width = 1.1};
  for (int32_t i = 0; i < contacts->count && limit > 0; i++) {
    double at[2], normal = force[i][0] / limit * longest, along = force[i][1] / limit * longest;
    const strut_contact_pose pose = strut_contact_pose_at(contacts, i, positions, NULL, -1);
    const double *n = pose.axes.normal, *t = pose.axes.tangent;
    strut_window_point(window, positions + contacts->at[i], at);
    if (fabs(normal) > 0.3) /* the arrow's tip is at the node */
      strut_draw_arrow(canvas, at[0] - normal * n[0], at[1] + normal * n[1], at[0], at[1], 5, pen);
    if (fabs(along) > 0.3)
      strut_draw_arrow(canvas, at[0], at[1], at[0] + along * t[0], at[1] - along * t[1], 5, pen);
  }
}

void strut_draw_yardstick(strut_canvas *canvas, const strut_window *window) {
  double room = 0.3 * window->box.width / window->scale, power = pow(10.0, floor(log10(room)));
  /* The largest of 1, 2 or 5 times a power of ten that fits. */
  double length = room >= 5 * power ? 5 * power : room >= 2 * power ? 2 * power : power;
  double x = window->box.x + 3, y = window->box.y + window->box.height - 4,
         end = x + length * window->scale;
  const strut_pen pen = {.colour = strut_grey(0.2), .width = 0.9, .butt = true};
  if (!isfinite(length) || !(length > 0)) return;
  strut_draw_segment(canvas, x, y, end, y, pen);
  strut_draw_segment(canvas, x, y - 2, x, y + 2, pen);
  strut_draw_segment(canvas, end, y - 2, end, y + 2, pen);
  strut_draw_text(canvas, 0.5 * (x + end), y - 2, strut_drawn_quantity(length, 3, "m").text,
                  (strut_font){.size = 7, .across = 0.5, .down = 1, .halo = strut_grey(1)});
}

/* Names beside nodes and members. */

enum { MOST_NAMED = 60 }; /* nodes; of larger structures none is named */

static const double NODE_GAP = 3.6, MEMBER_GAP = 1.5, NAME_SIZE = 7.5, NEAR_MIDDLE = 6.0; /* [pt] */

static void draw_name(strut_canvas *canvas, const strut_window *window, const double at[2],
                      double angle, double gap, const char *name) {
  strut_draw_label(canvas, &(strut_label){.text = name,
                                          .font = {.size = NAME_SIZE,
                                                   .italic = true,
                                                   .halo = strut_faded(strut_grey(1), 0.85)},
                                          .at = {at[0], at[1]},
                                          .gap = gap,
                                          .angle = angle,
                                          .steady = 0.2,
                                          .inside = window->box});
}

/* Names stand outside of a structure rather than inside: away from its middle, else at the upper right. */
static double find_outwards(const double at[2], const double middle[2]) {
  double x = strut_settle_coordinate(at[0]) - strut_settle_coordinate(middle[0]);
  double y = strut_settle_coordinate(middle[1]) - strut_settle_coordinate(at[1]);
  return hypot(x, y) > NEAR_MIDDLE ? atan2(y, x) : 0.25 * STRUT_PI;
}

void strut_draw_names(strut_canvas *canvas, const strut_window *window, const strut_model *model,
                      const double *positions, bool members) {
  const strut_scene *scene = model->scene;
  double middle[2] = {0.0, 0.0}, at[2];
  if (scene->node_count > MOST_NAMED) return;
  for (size_t i = 0; i < scene->node_count; i++) {
    strut_window_point(window, positions + 2 * i, at);
    for (int d = 0; d < 2; d++) middle[d] += at[d] / (double)scene->node_count;
  }
  for (size_t i = 0; i < scene->node_count; i++) {
    strut_window_point(window, positions + 2 * i, at);
    draw_name(canvas, window, at, find_outwards(at, middle), NODE_GAP, scene->nodes[i].name);
  }
  for (size_t j = 0; j < scene->member_count && members; j++) {
    double ends[2][2]; /* the name stands at the middle of the longest segment */
    strut_longest_segment(window, model, positions, j, ends);
    for (int d = 0; d < 2; d++) at[d] = 0.5 * (ends[0][d] + ends[1][d]);
    draw_name(canvas, window, at, 0.25 * STRUT_PI, MEMBER_GAP, scene->members[j].name);
  }
}

/* Members and nodes. */

/* Factor for line widths, from the mean length of the members on the page. */
static double thinning(const strut_window *window, const strut_model *model,
                       const double *positions) {
  double sum = 0;
  size_t count = model->scene->member_count, finite = 0;
  for (size_t j = 0; j < count; j++)
    for (size_t k = 0; k < count_segments(model, j); k++) {
      double ends[2][2];
      strut_window_segment(window, model, positions, j, k, ends);
      double length = strut_distance(ends[0], ends[1]);
      if (isfinite(length)) sum += length, finite++;
    }
  return finite ? fmax(THINNEST, fmin(1.0, sum / (double)finite / FULL_LENGTH)) : 1.0;
}

static bool is_slack(const strut_drawing *drawing, size_t j) {
  if (drawing->model->scene->members[j].kind != STRUT_CABLE) return false;
  if (drawing->style->slack_forces) return !(fabs(drawing->style->slack_forces[j]) > 0);
  return strut_member_path_length(drawing->model, (int32_t)j, drawing->q) <
         drawing->model->members.rest[j] * (1 - 1e-12);
}

static double width_of(const strut_drawing *drawing, strut_member_kind kind) {
  double width = kind == STRUT_BAR ? BAR : kind == STRUT_SPRING ? SPRING : CABLE;
  return width * drawing->thin / (1.0 + drawing->style->thinness) + drawing->style->fringe;
}

static bool is_shaded(const strut_structure_style *style) {
  return style->colouring == STRUT_COLOUR_FORCE && style->values;
}

static strut_colour colour_of(const strut_drawing *drawing, size_t j, bool slack) {
  const strut_structure_style *style = drawing->style;
  strut_member_kind kind = drawing->model->scene->members[j].kind;
  if (style->colouring == STRUT_COLOUR_ONE) return style->colour;
  if (slack) return strut_grey(0.55);
  if (is_shaded(style)) {
    double part = style->limit > 0 ? style->values[j] / style->limit : 0;
    return strut_palette_signed(isfinite(part) ? round(SHADES * part) / SHADES : 0);
  }
  return kind == STRUT_BAR      ? strut_grey(0.15)
         : kind == STRUT_SPRING ? strut_palette_thing(0)
                                : strut_palette_thing(1);
}

static strut_pen pen_of(const strut_drawing *drawing, size_t j, bool slack) {
  strut_pen pen = {.colour = strut_faded(colour_of(drawing, j, slack), drawing->opacity),
                   .width = width_of(drawing, drawing->model->scene->members[j].kind),
                   .butt = slack || drawing->style->fringe > 0.0};
  if (drawing->style->fringe > 0.0)
    pen.dash[0] = pen.dash[1] = FRINGE_DASH;
  else if (slack)
    pen.dash[0] = 2.5 * drawing->thin, pen.dash[1] = 2.0 * drawing->thin;
  return pen;
}

static bool is_same_pen(const strut_pen *one, const strut_pen *two) {
  return memcmp(&one->colour, &two->colour, sizeof one->colour) == 0 && one->width == two->width &&
         one->dash[0] == two->dash[0];
}

/*
 * Members of a kind; of shaded ones a dark edge first, which separates light colours from the paper. Segments wait for
 * the next one with another pen, since one piece makes a small file.
 */
static void draw_kind(strut_canvas *canvas, const strut_drawing *drawing, strut_member_kind kind,
                      bool slack) {
  const strut_member *members = drawing->model->scene->members;
  const strut_pen casing = {.colour = strut_faded(strut_grey(0.1), drawing->opacity),
                            .width = width_of(drawing, kind) + CASING * drawing->thin};
  double ends[2 * BATCH][2];
  strut_pen last = casing;
  size_t count = 0;
  for (int pass = is_shaded(drawing->style) && kind != STRUT_CABLE ? 0 : 1; pass < 2; pass++)
    for (size_t j = 0; j < drawing->model->scene->member_count; j++) {
      if (members[j].kind != kind || is_slack(drawing, j) != slack) continue;
      const strut_pen pen = pass ? pen_of(drawing, j, slack) : casing;
      for (size_t k = 0; k < count_segments(drawing->model, j); k++) {
        if (count == BATCH || !is_same_pen(&pen, &last)) {
          strut_draw_segments(canvas, (const double(*)[2])ends, count, last);
          count = 0;
        }
        last = pen;
        strut_window_segment(drawing->window, drawing->model, drawing->q, j, k, ends + 2 * count++);
      }
    }
  strut_draw_segments(canvas, (const double(*)[2])ends, count, last);
}

void strut_draw_round(strut_canvas *canvas, const strut_drawing *drawing, const double place[2],
                      double radius, const strut_fill *fill, const strut_pen *pen) {
  double at[2];
  strut_window_point(drawing->window, place, at);
  strut_draw_circle(canvas, at[0], at[1], radius, fill, pen);
}

/* Masses that slide along members: filled circles on them. */
static void draw_sliding_masses(strut_canvas *canvas, const strut_drawing *drawing) {
  const strut_scene *scene = drawing->model->scene;
  double thin = drawing->thin / (1.0 + drawing->style->thinness), at[2];
  const strut_fill fill = {.colour = strut_thing_colour(drawing, 1)};
  const strut_pen pen = {.colour = strut_faded(strut_grey(1), drawing->opacity),
                         .width = 0.5 * thin};
  for (size_t i = 0; i < scene->sliding_count; i++) {
    const int32_t *node = scene->members[scene->sliding_masses[i].member].node;
    double far = strut_sliding_mass_share(scene, i, drawing->style->time);
    for (int c = 0; c < 2; c++)
      at[c] = (1.0 - far) * drawing->q[2 * node[0] + c] + far * drawing->q[2 * node[1] + c];
    strut_draw_round(canvas, drawing, at, 3.2 * thin, &fill, &pen);
  }
}

static void draw_nodes(strut_canvas *canvas, const strut_drawing *drawing) {
  double thin = drawing->thin / (1.0 + drawing->style->thinness);
  const strut_fill white = {.colour = strut_faded(strut_grey(1), drawing->opacity)};
  strut_colour edge =
      drawing->style->colouring == STRUT_COLOUR_ONE ? drawing->style->colour : strut_grey(0.1);
  const strut_pen pen = {.colour = strut_faded(edge, drawing->opacity), .width = 0.8 * thin};
  for (int32_t i = 0; i < drawing->model->node_count; i++)
    strut_draw_round(canvas, drawing, drawing->q + 2 * i, 1.9 * thin, &white, &pen);
}

void strut_draw_structure(strut_canvas *canvas, const strut_window *window,
                          const strut_model *model, const double *positions,
                          const strut_structure_style *style) {
  const strut_drawing d = {.window = window,
                           .model = model,
                           .q = positions,
                           .style = style,
                           .thin = thinning(window, model, positions),
                           .opacity = style->opacity > 0 ? style->opacity : 1.0};
  if (!style->no_supports)
    draw_supports(canvas, window, model, positions, fmax(d.thin, SMALLEST), d.opacity);
  strut_draw_cells(canvas, &d);
  strut_draw_collisions(canvas, &d);
  draw_kind(canvas, &d, STRUT_BAR, false); /* thin ones above thick ones, to be seen along a bar */
  draw_kind(canvas, &d, STRUT_SPRING, false);
  draw_kind(canvas, &d, STRUT_CABLE, true);
  draw_kind(canvas, &d, STRUT_CABLE, false);
  if (d.thin >= SMALLEST) {
    strut_draw_elements(canvas, &d);
    if (!style->no_nodes) draw_nodes(canvas, &d);
    draw_sliding_masses(canvas, &d);
  }
  if (style->node_names) strut_draw_names(canvas, window, model, positions, style->member_names);
}

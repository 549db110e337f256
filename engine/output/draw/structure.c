/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Structures to scale: members and nodes, what stands beside them, supports, grounds, forces, names. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/model/pose.h"
#include "engine/output/draw/painter.h"
#include "engine/scene/profile.h"
#include "engine/scene/wrap.h"

static const double CASING = 0.7;       /* beside shaded members [pt] */
static const double FULL_LENGTH = 28.0; /* members this long on the page have full width [pt] */
static const double THINNEST = 0.06, FRINGE_DASH = 2.2; /* [1], [pt] */
static const double SMALLEST = 0.3;                     /* more that is thinner is not drawn */

/* A structure being drawn. */
typedef struct drawing {
  strut_canvas *canvas;
  const strut_axes *axes;
  const strut_model *model;
  const double *q;
  const strut_structure_style *style;
  double thin; /* factor of widths, from the mean length of the members on the page */
} drawing;

/* ---- in places of the plane ---- */

static void draw_places(const drawing *d, double (*places)[2], size_t count, strut_pen pen) {
  for (size_t k = 0; k < count; k++) strut_axes_point(d->axes, places[k], places[k]);
  strut_draw_line(d->canvas, (const double(*)[2])places, count, pen);
}

/* A circle, its radius in points. */
static void draw_circle(const drawing *d, const double place[2], double radius, strut_colour fill,
                        const strut_pen *pen) {
  double at[2];
  strut_axes_point(d->axes, place, at);
  strut_draw_circle(d->canvas, at[0], at[1], radius, &(strut_fill){.colour = fill}, pen);
}

/* The colour of all but members and nodes, so opaque. */
static strut_colour thing_colour(const drawing *d, double alpha) {
  bool one = d->style->colouring == STRUT_COLOUR_ONE;
  return strut_faded(one ? d->style->colour : strut_palette_thing(2), alpha);
}

/* ---- members ---- */

enum { MOST_PARTS = STRUT_MOST_ELEMENT_NODES };

/*
 * The ends on the page of a member's straight parts: from node to node or, of a wrapped one, from circle to circle.
 * Returns how many parts there are.
 */
static size_t find_parts(const drawing *d, size_t j, double (*ends)[2]) {
  const strut_member *member = &d->model->scene->members[j];
  const double radius = member->guide_count ? member->guide_radius : 0.0;
  size_t count = member->guide_count + 1;
  uint32_t right = 0;
  strut_wrap wrap = {0};
  double node[STRUT_MOST_WRAPPED][2];
  for (size_t i = 0; i <= count; i++)
    memcpy(node[i], d->q + 2 * strut_member_node(member, i), sizeof *node);
  if (radius > 0.0) {
    right = strut_member_right_guides(d->model->scene, member);
    strut_wrap_find((const double(*)[2])node, (int)count + 1, right, radius, &wrap);
    count = (size_t)wrap.count - 1;
  }
  for (size_t k = 0; k < count; k++, ends += 2) {
    memcpy(ends, node[k], 2 * sizeof *ends);
    if (radius > 0.0) {
      int from = wrap.node[k];
      double off = from > 0 ? radius * strut_wrap_side(right, from) : 0.0;
      ends[0][0] = node[from][0] + off * wrap.uy[k], ends[0][1] = node[from][1] - off * wrap.ux[k];
      ends[1][0] = ends[0][0] + wrap.free[k] * wrap.ux[k];
      ends[1][1] = ends[0][1] + wrap.free[k] * wrap.uy[k];
    }
    for (int end = 0; end < 2; end++) strut_axes_point(d->axes, ends[end], ends[end]);
  }
  return count;
}

/* The longest part of a member, where its name and its stop stand. */
static void find_longest(const drawing *d, size_t member, double longest[2][2]) {
  double ends[2 * MOST_PARTS][2], most = -1.0;
  size_t count = find_parts(d, member, ends);
  for (size_t k = 0; k < count; k++) {
    double length = strut_settle_coordinate(strut_distance(ends[2 * k], ends[2 * k + 1]));
    if (k && !(length > most)) continue;
    memcpy(longest, ends[2 * k], 2 * sizeof *ends);
    most = length;
  }
}

static drawing begin(strut_canvas *canvas, const strut_axes *axes, const strut_shape *shape) {
  drawing d = {canvas, axes, shape->model, shape->q, &shape->style, 1.0};
  double sum = 0, ends[2 * MOST_PARTS][2];
  size_t finite = 0;
  for (size_t j = 0; j < d.model->scene->member_count; j++) {
    size_t count = find_parts(&d, j, ends);
    for (size_t k = 0; k < count; k++) {
      double length = strut_distance(ends[2 * k], ends[2 * k + 1]);
      if (isfinite(length)) sum += length, finite++;
    }
  }
  if (finite) d.thin = fmax(THINNEST, fmin(1.0, sum / (double)finite / FULL_LENGTH));
  return d;
}

static bool is_slack(const drawing *d, size_t j) {
  if (d->model->scene->members[j].kind != STRUT_CABLE) return false;
  if (d->style->slack_forces) return !(fabs(d->style->slack_forces[j]) > 0);
  return strut_member_path_length(d->model, (int32_t)j, d->q) <
         d->model->members.rest[j] * (1 - 1e-12);
}

static bool is_shaded(const strut_structure_style *style) {
  return style->colouring == STRUT_COLOUR_FORCE && style->values;
}

static strut_pen pen_of(const drawing *d, size_t j, double width, bool slack) {
  enum { SHADES = 16 }; /* of either sign */
  const strut_structure_style *style = d->style;
  bool fringe = style->fringe > 0.0, driven = strut_member_is_driven(d->model->scene, j);
  strut_pen pen = {.colour = style->colour, .width = width, .butt = slack || fringe};
  double part = is_shaded(style) && style->limit > 0 ? style->values[j] / style->limit : 0;
  if (style->colouring != STRUT_COLOUR_ONE)
    pen.colour = slack ? strut_grey(0.55)
                 : is_shaded(style)
                     ? strut_palette_at(STRUT_COLOURS_SIGNED,
                                        isfinite(part) ? round(SHADES * part) / SHADES : 0, -1, 1)
                     : strut_kind_pen(d->model->scene->members[j].kind, driven).colour;
  if (fringe)
    pen.dash[0] = pen.dash[1] = FRINGE_DASH;
  else if (slack)
    pen.dash[0] = 2.5 * d->thin, pen.dash[1] = 2.0 * d->thin;
  return pen;
}

static bool is_same_pen(const strut_pen *one, const strut_pen *two) {
  return memcmp(&one->colour, &two->colour, sizeof one->colour) == 0 && one->width == two->width &&
         one->dash[0] == two->dash[0];
}

/*
 * Members of a kind; of shaded ones a dark edge first, which separates light colours from the paper. Parts wait for
 * the next one with another pen, since one piece makes a small file.
 */
static void draw_kind(const drawing *d, strut_member_kind kind, bool slack) {
  enum { BATCH = 256 };
  double width =
      strut_kind_pen(kind, false).width * d->thin / (1.0 + d->style->thinness) + d->style->fringe;
  const strut_pen casing = {.colour = strut_grey(0.1), .width = width + CASING * d->thin};
  double ends[2 * (BATCH + MOST_PARTS)][2];
  strut_pen last = casing;
  size_t count = 0;
  for (int pass = is_shaded(d->style) && kind != STRUT_CABLE ? 0 : 1; pass < 2; pass++)
    for (size_t j = 0; j < d->model->scene->member_count; j++) {
      if (d->model->scene->members[j].kind != kind || is_slack(d, j) != slack) continue;
      const strut_pen pen = pass ? pen_of(d, j, width, slack) : casing;
      if (count >= BATCH || !is_same_pen(&pen, &last)) {
        strut_draw_segments(d->canvas, (const double(*)[2])ends, count, last);
        count = 0;
      }
      last = pen;
      count += find_parts(d, j, ends + 2 * count);
    }
  strut_draw_segments(d->canvas, (const double(*)[2])ends, count, last);
}

/* ---- supports ---- */

/* A support's triangle, its tip at the node, its base towards `out`; rolling: on two wheels. */
static void draw_support(strut_canvas *canvas, const double tip[2], const double out[2],
                         bool rolling, double size) {
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
  const strut_pen pen = {.colour = strut_grey(0.25), .width = 0.7 * size};
  const strut_fill white = {.colour = strut_grey(1)};
  const strut_fill hatched = {.hatch = strut_grey(0.45)};
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

/* The middle of all nodes on the page. */
static void find_middle(const drawing *d, double middle[2]) {
  int32_t count = d->model->node_count;
  double centre[2] = {0.0, 0.0};
  for (int32_t i = 0; i < 2 * count; i++) centre[i % 2] += d->q[i] / count;
  strut_axes_point(d->axes, centre, middle);
}

/* Triangles below pinned nodes, on wheels where one direction is free. */
static void draw_supports(const drawing *d) {
  double middle[2], tip[2];
  find_middle(d, middle);
  for (int32_t i = 0; i < d->model->node_count; i++) {
    const bool *fixed = d->model->scene->nodes[i].fixed;
    if (!fixed[0] && !fixed[1]) continue;
    strut_axes_point(d->axes, d->q + 2 * i, tip);
    /* Fixed in x only: drawn from the side away from the structure. */
    bool left = strut_settle_coordinate(tip[0]) <= strut_settle_coordinate(middle[0]);
    const double below[2] = {0, 1}, side[2] = {left ? -1 : 1, 0};
    draw_support(d->canvas, tip, fixed[1] ? below : side, !(fixed[0] && fixed[1]),
                 fmax(d->thin, SMALLEST));
  }
}

/* ---- what stands beside members ---- */

static const double HINGE = 7.0, STOP = 4.0; /* radius of the arc, half a stop's bar [pt] */

/* An arc from an angle on. */
static void draw_arc(const drawing *d, const double centre[2], double radius, double first,
                     double angle, strut_pen pen) {
  enum { POINTS = 33 };
  double arc[POINTS][2];
  for (int i = 0; i < POINTS; i++) {
    arc[i][0] = centre[0] + radius * cos(first + angle * i / (POINTS - 1));
    arc[i][1] = centre[1] + radius * sin(first + angle * i / (POINTS - 1));
  }
  draw_places(d, arc, POINTS, pen);
}

/* A hinge: an arc around its node, from the first arm to the second by its angle. */
static void draw_hinge(const drawing *d, const strut_hinge *hinge, double angle, strut_pen pen) {
  const double *at = d->q + 2 * hinge->node[1], *from = d->q + 2 * hinge->node[0];
  double arm = fmin(strut_distance(from, at), strut_distance(at, d->q + 2 * hinge->node[2]));
  draw_arc(d, at, fmin(HINGE * d->thin / d->axes->scale, 0.4 * arm),
           atan2(from[1] - at[1], from[0] - at[0]), fmax(-STRUT_TAU, fmin(STRUT_TAU, angle)), pen);
}

/* A stop that acts: a bar across the middle of its member. */
static void draw_stop(const drawing *d, size_t member, strut_pen pen) {
  double ends[2][2];
  find_longest(d, member, ends);
  double half = STOP * d->thin / strut_distance(ends[0], ends[1]);
  double x = half * (ends[1][0] - ends[0][0]), y = half * (ends[1][1] - ends[0][1]);
  double middle[2] = {0.5 * (ends[0][0] + ends[1][0]), 0.5 * (ends[0][1] + ends[1][1])};
  strut_draw_segment(d->canvas, middle[0] - y, middle[1] + x, middle[0] + y, middle[1] - x, pen);
}

/* Cells: filled polygons below all else. */
static void draw_cells(const drawing *d) {
  const strut_fill fill = {.colour = thing_colour(d, 0.15)};
  const strut_pen pen = {.colour = thing_colour(d, 0.5), .width = 0.5 * d->thin};
  double corner[STRUT_MOST_ELEMENT_NODES][2];
  for (size_t i = 0; i < d->model->scene->cell_count; i++) {
    const strut_cell *cell = &d->model->scene->cells[i];
    for (size_t k = 0; k < cell->node_count; k++)
      strut_axes_point(d->axes, d->q + 2 * cell->node[k], corner[k]);
    strut_draw_polygon(d->canvas, (const double(*)[2])corner, cell->node_count, &fill, &pen);
  }
}

/* Bodies that may collide: discs or rods with round ends, as thick as they are. */
static void draw_collisions(const drawing *d) {
  const strut_colour colour = thing_colour(d, 0.15);
  double ends[2 * MOST_PARTS][2];
  for (size_t i = 0; i < 2 * d->model->scene->collision_count; i++) {
    const strut_collision *collision = &d->model->scene->collisions[i / 2];
    int32_t node = collision->node[i % 2], member = collision->member[i % 2];
    double width = collision->thickness * d->axes->scale;
    if (node >= 0) draw_circle(d, d->q + 2 * node, 0.5 * width, colour, NULL);
    if (member < 0) continue;
    find_parts(d, (size_t)member, ends);
    strut_draw_line(d->canvas, (const double(*)[2])ends, 2,
                    (strut_pen){.colour = colour, .width = width});
  }
}

/* A dashed line along which the distance is measured: to the first node's foot, then to the second. */
static void draw_distance(const drawing *d, const strut_element *e, const uint32_t *at,
                          const strut_element_pose *pose, strut_pen pen) {
  bool line = e->strain == STRUT_STRAIN_OFFSET;
  double side = line ? -pose->strain : pose->strain, way[3][2];
  for (int c = 0; c < 2; c++) {
    way[0][c] = d->q[at[0] + (uint32_t)c];
    way[1][c] = way[0][c] + side * pose->b[line ? c : 2 + c];
    way[2][c] = line ? way[1][c] : d->q[at[1] + (uint32_t)c];
  }
  pen.dash[0] = pen.dash[1] = 2.0 * pen.width;
  draw_places(d, way, 3, pen);
}

/* The arc of a foot, as far as it may meet the ground while its member stands. */
static void draw_foot(const drawing *d, const strut_element *e, const uint32_t *at, strut_pen pen) {
  const double *from = d->q + at[0], *to = d->q + at[1];
  double x = to[0] - from[0], y = to[1] - from[1], part = e->radius / hypot(x, y);
  const double centre[2] = {from[0] + part * x, from[1] + part * y};
  draw_arc(d, centre, e->radius, atan2(-y, -x) - 0.4 * STRUT_PI, 0.8 * STRUT_PI, pen);
}

/* Hinges, stops that act, distances, feet, and circles of guides. */
static void draw_elements(const drawing *d) {
  const strut_element_table *elements = &d->model->elements;
  const strut_pen rim = {.colour = strut_grey(0.5), .width = 0.6 * d->thin};
  strut_pen pen = {.colour = thing_colour(d, 1)};
  strut_element_pose pose;
  for (int32_t i = 0; i < elements->count; i++) {
    const strut_element *e = &elements->element[i];
    const uint32_t *at = elements->at + e->first;
    if (e->strain == STRUT_STRAIN_WRAP && e->role == STRUT_ELEMENT_MEMBER)
      for (int32_t k = 1; k + 1 < e->nodes; k++)
        draw_circle(d, d->q + at[k], e->radius * d->axes->scale, strut_grey(0.93), &rim);
    if (e->role == STRUT_ELEMENT_MEMBER || e->role == STRUT_ELEMENT_CELL ||
        e->role == STRUT_ELEMENT_COLLISION || e->role == STRUT_ELEMENT_CONTACT ||
        e->role == STRUT_ELEMENT_LOAD)
      continue;
    strut_element_evaluate(d->model, i, d->model->members.rest, d->q, (double)NAN, &pose);
    bool thin = e->role == STRUT_ELEMENT_HINGE || e->role == STRUT_ELEMENT_DISTANCE;
    pen.width = (thin ? 1.0 : 1.6) * d->thin / (1 + d->style->thinness);
    if (e->role == STRUT_ELEMENT_DISTANCE)
      draw_distance(d, e, at, &pose, pen);
    else if (e->role == STRUT_ELEMENT_FOOT)
      draw_foot(d, e, at, pen);
    else if (e->role == STRUT_ELEMENT_HINGE)
      draw_hinge(d, &d->model->scene->hinges[e->item], pose.strain, pen);
    else if (pose.acts)
      draw_stop(d, (size_t)e->item, pen);
  }
}

/* Nodes, and masses that slide along members: filled circles on them. */
static void draw_masses(const drawing *d) {
  const strut_scene *scene = d->model->scene;
  bool one = d->style->colouring == STRUT_COLOUR_ONE;
  double thin = d->thin / (1.0 + d->style->thinness), at[2];
  const strut_pen edge = {.colour = one ? d->style->colour : strut_grey(0.1), .width = 0.8 * thin};
  const strut_pen rim = {.colour = strut_grey(1), .width = 0.5 * thin};
  for (int32_t i = 0; i < d->model->node_count && !d->style->no_nodes; i++)
    draw_circle(d, d->q + 2 * i, 1.9 * thin, strut_grey(1), &edge);
  for (size_t i = 0; i < scene->sliding_count; i++) {
    const int32_t *node = scene->members[scene->sliding_masses[i].member].node;
    double far = strut_sliding_mass_share(scene, i, d->style->time);
    for (int c = 0; c < 2; c++)
      at[c] = (1.0 - far) * d->q[2 * node[0] + c] + far * d->q[2 * node[1] + c];
    draw_circle(d, at, 3.2 * thin, thing_colour(d, 1), &rim);
  }
}

/* ---- names ---- */

static const double NODE_GAP = 3.6, MEMBER_GAP = 1.5, NAME_SIZE = 7.5, NEAR_MIDDLE = 6.0; /* [pt] */

static void draw_name(const drawing *d, const double at[2], double angle, double gap,
                      const char *name) {
  const strut_font font = {
      .size = NAME_SIZE, .italic = true, .halo = strut_faded(strut_grey(1), 0.85)};
  strut_draw_label(d->canvas, &(strut_label){.text = name,
                                             .font = font,
                                             .at = {at[0], at[1]},
                                             .gap = gap,
                                             .angle = angle,
                                             .steady = 0.2,
                                             .inside = d->axes->frame});
}

/* True if names cover little of what is seen. */
static bool names_fit(const drawing *d, const strut_panel *view) {
  static const double COVERED = 0.22; /* of a view, by names */
  double covered = 0.0, seen = COVERED;
  for (int c = 0; c < 2; c++)
    seen *= (view->bounds.high[c] - view->bounds.low[c]) * d->axes->scale + 2 * view->margin;
  for (size_t i = 0; i < d->model->scene->node_count; i++) {
    const strut_box name =
        strut_text_box(d->canvas, d->model->scene->nodes[i].name, (strut_font){.size = NAME_SIZE});
    covered += name.width * name.height;
  }
  return covered <= seen;
}

/* Names stand outside of a structure rather than inside: away from its middle, else at the upper right. */
static void draw_names(const drawing *d) {
  const strut_scene *scene = d->model->scene;
  double middle[2], at[2], ends[2][2];
  find_middle(d, middle);
  for (size_t i = 0; i < scene->node_count; i++) {
    strut_axes_point(d->axes, d->q + 2 * i, at);
    double x = strut_settle_coordinate(at[0]) - strut_settle_coordinate(middle[0]);
    double y = strut_settle_coordinate(middle[1]) - strut_settle_coordinate(at[1]);
    draw_name(d, at, hypot(x, y) > NEAR_MIDDLE ? atan2(y, x) : 0.25 * STRUT_PI, NODE_GAP,
              scene->nodes[i].name);
  }
  for (size_t j = 0; j < scene->member_count && d->style->member_names; j++) {
    find_longest(d, j, ends); /* the name is drawn at its middle */
    for (int c = 0; c < 2; c++) at[c] = 0.5 * (ends[0][c] + ends[1][c]);
    draw_name(d, at, 0.25 * STRUT_PI, MEMBER_GAP, scene->members[j].name);
  }
}

void strut_draw_names(strut_canvas *canvas, const strut_axes *axes, const strut_panel *view) {
  enum { MOST_NAMED = 60 }; /* nodes; of larger structures none is named */
  for (const strut_shape *shape = view->shapes; shape < view->shapes + view->shape_count; shape++) {
    const drawing d = begin(canvas, axes, shape);
    if (shape->names && d.model->node_count <= MOST_NAMED && names_fit(&d, view)) draw_names(&d);
  }
}

/* ---- forces of the ground on its contacts: normal and friction ---- */

static const double ARROW = 20.0; /* the largest of them [pt] */

static void draw_forces(const drawing *d, const strut_shape *shape) {
  const strut_contact_table *contacts = &d->model->contacts;
  const strut_pen pen = {.colour = strut_palette_thing(1), .width = 1.1};
  for (int32_t i = 0; shape->forces && i < contacts->count && shape->force_limit > 0; i++) {
    double at[2], normal = shape->forces[i][0] / shape->force_limit * ARROW;
    double along = shape->forces[i][1] / shape->force_limit * ARROW;
    const strut_contact_pose pose = strut_contact_pose_at(contacts, i, d->q, NULL, -1);
    const double *n = pose.axes.normal, *t = pose.axes.tangent;
    strut_axes_point(d->axes, d->q + contacts->at[i], at);
    if (fabs(normal) > 0.3) /* the arrow's tip is at the node */
      strut_draw_arrow(d->canvas, at[0] - normal * n[0], at[1] + normal * n[1], at[0], at[1], 5,
                       pen);
    if (fabs(along) > 0.3)
      strut_draw_arrow(d->canvas, at[0], at[1], at[0] + along * t[0], at[1] - along * t[1], 5, pen);
  }
}

double strut_view_arrows(const strut_panel *view) {
  double room = 0.0;
  for (size_t i = 0; i < view->shape_count; i++)
    if (view->shapes[i].forces) room = fmax(room, ARROW - view->margin);
  return room;
}

static void draw_shape(const drawing *d, const strut_shape *shape) {
  if (!d->style->no_supports) draw_supports(d);
  draw_cells(d);
  draw_collisions(d);
  draw_kind(d, STRUT_BAR, false); /* thin ones above thick ones, to be seen along a bar */
  draw_kind(d, STRUT_SPRING, false);
  draw_kind(d, STRUT_CABLE, true);
  draw_kind(d, STRUT_CABLE, false);
  if (d->thin >= SMALLEST) {
    draw_elements(d);
    draw_masses(d);
  }
  draw_forces(d, shape);
}

/* ---- grounds ---- */

static const double DEPTH = 8.0; /* of the hatching below a surface [pt] */

/* Hatching to the right of each segment of (count) points on the page. */
static void hatch_below(strut_canvas *canvas, const double (*points)[2], size_t count) {
  const strut_fill fill = {.colour = strut_grey(0.95), .hatch = strut_grey(0.72)};
  for (size_t k = 0; k + 1 < count; k++) {
    const double *a = points[k], *b = points[k + 1];
    double part = DEPTH / strut_distance(a, b);
    double across[2] = {part * (a[1] - b[1]), part * (b[0] - a[0])}; /* the page's y points down */
    const double strip[4][2] = {{a[0], a[1]},
                                {b[0], b[1]},
                                {b[0] + across[0], b[1] + across[1]},
                                {a[0] + across[0], a[1] + across[1]}};
    strut_draw_polygon(canvas, strip, 4, &fill, NULL);
  }
}

/* The belt's direction, within the solid below the middle of a line. */
static void draw_belt(strut_canvas *canvas, const double *a, const double *b, double speed) {
  double length = strut_distance(a, b), way = speed > 0.0 ? 12.0 : -12.0;
  double along[2] = {(b[0] - a[0]) / length, (b[1] - a[1]) / length};
  double x = 0.5 * (a[0] + b[0]) - 1.9 * DEPTH * along[1];
  double y = 0.5 * (a[1] + b[1]) + 1.9 * DEPTH * along[0];
  if (length > 0.0 && speed != 0.0)
    strut_draw_arrow(canvas, x - way * along[0], y - way * along[1], x + way * along[0],
                     y + way * along[1], 5, (strut_pen){.colour = strut_grey(0.3), .width = 0.9});
}

/* A ground's line or body across the frame, moved to `place` unless that is NULL. */
static void draw_ground(const drawing *d, const strut_ground *ground, const double *place) {
  const strut_axis *x = &d->axes->x, *y = &d->axes->y;
  const double middle[2] = {0.5 * (x->low + x->high), 0.5 * (y->low + y->high)};
  double reach = 0.7 * (x->high - x->low + y->high - y->low);
  strut_arena arena = {0};
  double(*points)[2] = strut_arena_allocate(&arena, strut_outline_most(ground), sizeof *points);
  if (points) {
    size_t count = strut_outline_of(ground, place, middle, reach, points);
    for (size_t k = 0; k < count; k++) strut_axes_point(d->axes, points[k], points[k]);
    hatch_below(d->canvas, (const double(*)[2])points, count);
    strut_draw_line(d->canvas, (const double(*)[2])points, count,
                    (strut_pen){.colour = strut_grey(0.3), .width = 0.8});
    if (ground->shape == STRUT_GROUND_LINE)
      draw_belt(d->canvas, points[0], points[1], ground->belt_speed);
  }
  strut_arena_free(&arena);
}

/* The lines and bodies of all grounds, of a shape that is moving where they are at its time. */
static void draw_grounds(const drawing *d, const strut_shape *shape) {
  const strut_scene *scene = d->model->scene;
  double place[2];
  if (scene->ground.present) draw_ground(d, &scene->ground, NULL);
  for (size_t g = 0; g < scene->ground_count; g++) {
    if (shape->moving) strut_ground_place(scene, g, shape->style.time, place);
    draw_ground(d, &scene->grounds[g], shape->moving ? place : NULL);
  }
}

void strut_draw_shapes(strut_canvas *canvas, const strut_axes *axes, const strut_panel *view) {
  for (int pass = 0; pass < 2; pass++) /* grounds first */
    for (size_t i = 0; i < view->shape_count; i++) {
      const strut_shape *shape = &view->shapes[i];
      const drawing d = begin(canvas, axes, shape);
      if (pass) draw_shape(&d, shape);
      if (!pass && shape->ground) draw_grounds(&d, shape);
    }
}

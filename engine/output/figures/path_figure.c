/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/vec.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/draw/chart.h"
#include "engine/output/draw/legend.h"
#include "engine/output/draw/structure.h"
#include "engine/output/figures/statics_figures.h"
#include "engine/statics/path/path.h"

enum { MOST_STOPS = 10, STOP_TEXT = 160 };

/* A point or an event of the path. */
typedef struct path_vertex {
  double value, motion;    /* the parameter [its unit]; the displacement [m] */
  double height;           /* drawn: a load [N], a reaction [N], or the value */
  bool unstable;           /* of the edge to the next vertex */
  const double *q, *force; /* (length) [m], (members) [N] */
} path_vertex;

/* A shape that is drawn: the beginning, events, the end. */
typedef struct path_stop {
  size_t vertex;
  strut_colour colour;
  char letter[4]; /* of an event; else empty */
  char text[STOP_TEXT];
} path_stop;

typedef struct path_picture {
  const strut_plot *plot;
  strut_canvas *canvas;
  const strut_model *model;
  const strut_path *path;
  bool upright;       /* the motion is drawn upwards, over the parameter */
  int32_t coordinate; /* index into q of the displacement drawn */
  double sign;        /* 1 or -1: its direction */
  size_t count, stop_count;
  path_vertex *vertices; /* (count) */
  path_stop stops[MOST_STOPS];
  size_t events_left;  /* that did not get a stop */
  double larger;       /* factor by which displacements are enlarged */
  double *shape;       /* (length) scratch for an enlarged shape */
  double *taut;        /* (members) its cables: 0 where slack */
  double (*points)[2]; /* (count) likewise for lines */
} path_picture;

/* True if the path scales this load. */
static bool load_grows(const strut_path *path, const strut_load *load) {
  if (path->over != STRUT_PATH_OVER_LOAD) return false;
  if (path->load) return strcmp(load->name, path->load) == 0;
  return load->signal < 0;
}

/* The curve of a path, and its shapes over each other. */

enum { NAMED = 12, LABEL = 200 };

static const double MARKER = 2.7, MARGIN = 15.0, ARROW = 22.0; /* [pt] */

/* Letters beside the stops. A stop at NAN is not shown. */
static void draw_letters(const path_picture *p, strut_box inside, const double (*points)[2]) {
  for (size_t i = 0; i < p->stop_count; i++)
    strut_draw_label(
        p->canvas,
        &(strut_label){.text = p->stops[i].letter,
                       .font = {.size = 8, .bold = true, .halo = strut_faded(strut_grey(1), 0.85)},
                       .at = {points[i][0], points[i][1]},
                       .gap = MARKER + 1.5,
                       .angle = 0.25 * STRUT_PI,
                       .inside = inside,
                       .priority = 1});
}

/* Is the point within the box, its edges included up to rounding? */
static bool is_inside(strut_box box, const double at[2]) {
  const double edge = 0.01; /* [pt] */
  return at[0] >= box.x - edge && at[0] <= box.x + box.width + edge && at[1] >= box.y - edge &&
         at[1] <= box.y + box.height + edge;
}

static void draw_markers(path_picture *p, const double (*points)[2]) {
  const strut_pen edge = {.colour = strut_grey(0.1), .width = 0.6};
  for (size_t i = 0; i < p->stop_count; i++) {
    const strut_fill fill = {.colour = p->stops[i].colour};
    if (isnan(points[i][0])) continue;
    strut_draw_circle(p->canvas, points[i][0], points[i][1], MARKER, &fill, &edge);
  }
}

/* A name cut to a width, in `text`. */
static const char *fit_name(path_picture *p, const char *name, double width,
                            char text[STRUT_FITTED_TEXT]) {
  return strut_text_fit(p->canvas, name, (strut_font){.size = 8}, width, 0, text);
}

/* Writes the label of the parameter's axis, cut to a width. */
static void name_height(path_picture *p, double width, char label[LABEL]) {
  char fitted[STRUT_FITTED_TEXT];
  const strut_path *path = p->path;
  bool force = path->reference > 0, all = path->over == STRUT_PATH_OVER_LOAD && !path->load;
  if (path->over == STRUT_PATH_OVER_LOAD)
    snprintf(label, LABEL, "%s of %.100s", force ? "force" : "factor",
             !all                     ? fit_name(p, path->name, width - 100, fitted)
             : force && path->several ? "each load"
                                      : "the load");
  else if (path->coordinate >= 0)
    snprintf(label, LABEL, "reaction of %.100s", fit_name(p, path->name, width - 100, fitted));
  else
    snprintf(label, LABEL, "%.100s", fit_name(p, path->name, width - 40, fitted));
}

/* The drawn ordinate: a load, the reaction to a displacement, or the parameter itself. */
static double curve_height(const strut_path *path, double value, const double *reaction) {
  if (path->coordinate >= 0) return reaction[path->coordinate];
  return path->reference > 0 ? value * path->reference : value;
}

/* Where a point of a branch lies on the curve's axes. */
static void branch_vertex(const path_picture *p, const strut_path_point *point, double *motion,
                          double *height) {
  *motion = p->sign * (point->at.q[p->coordinate] - p->path->points[0].at.q[p->coordinate]);
  *height = curve_height(p->path, point->at.factor, point->at.reaction);
}

static strut_axes place_axes(path_picture *p, strut_box box, char labels[2][LABEL]) {
  static const char *const directions[] = {"to the left", "to the right", "downwards", "upwards"};
  char fitted[STRUT_FITTED_TEXT];
  const char *node = p->model->scene->nodes[p->coordinate / 2].name;
  bool force = p->path->reference > 0 || p->path->coordinate >= 0;
  snprintf(labels[0], LABEL, "displacement of %.100s %s",
           fit_name(p, node, p->upright ? box.height - 125 : box.width - 170, fitted),
           directions[2 * (p->coordinate % 2) + (p->sign > 0)]);
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
  for (size_t i = 0; i < p->path->branch_count; i++)
    for (size_t k = 0; k < p->path->branches[i].point_count; k++) {
      double along, upwards;
      branch_vertex(p, &p->path->branches[i].points[k], &along, &upwards);
      strut_axis_include(&motion, along);
      strut_axis_include(&height, upwards);
    }
  strut_axis_settle(&motion, 0.05);
  strut_axis_settle(&height, 0.05);
  strut_axis x = p->upright ? height : motion, y = p->upright ? motion : height;
  strut_axis_choose(&x, &p->plot->x);
  strut_axis_choose(&y, &p->plot->y);
  return strut_axes_place(p->canvas, box, x, y);
}

/* Branches, faint where they are unstable. */
static void draw_branches(const path_picture *p, const strut_axes *axes) {
  for (size_t i = 0; i < p->path->branch_count; i++) {
    const strut_path *branch = &p->path->branches[i];
    double ends[2][2];
    for (size_t k = 0; k < branch->point_count; k++) {
      double motion, height;
      branch_vertex(p, &branch->points[k], &motion, &height);
      memcpy(ends[0], ends[1], sizeof ends[0]);
      strut_axes_point(axes, p->upright ? height : motion, p->upright ? motion : height, ends[1]);
      if (k == 0) continue;
      strut_pen pen = {.colour = strut_palette_thing(0), .width = 1.2};
      if (branch->points[k - 1].negative > 0)
        pen.colour = strut_faded(pen.colour, 0.45), pen.butt = true;
      strut_draw_segment(p->canvas, ends[0][0], ends[0][1], ends[1][0], ends[1][1], pen);
    }
  }
}

static void draw_curve(path_picture *p, strut_box box) {
  char labels[2][LABEL];
  double stops[MOST_STOPS][2];
  strut_axes axes = place_axes(p, box, labels);
  strut_draw_axes(p->canvas, &axes);
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
  draw_branches(p, &axes);
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
  for (size_t i = 0; i < p->stop_count; i++) {
    const double *at = p->points[p->stops[i].vertex];
    bool shown = is_inside(axes.frame, at);
    for (int d = 0; d < 2; d++) stops[i][d] = shown ? at[d] : (double)NAN;
  }
  draw_markers(p, (const double(*)[2])stops);
  draw_letters(p, axes.frame, (const double(*)[2])stops);
}

/* A shape with its motion enlarged, in p->shape. */
static const double *enlarged(path_picture *p, const double *q) {
  const double *from = p->path->points[0].at.q;
  for (int32_t i = 0; i < p->model->length; i++)
    p->shape[i] = from[i] + p->larger * (q[i] - from[i]);
  return p->shape;
}

/* Flags the taut cables at a vertex; other members ignore it. */
static const double *flag_taut_cables(path_picture *p, const path_vertex *vertex) {
  for (size_t j = 0; j < p->model->scene->member_count; j++)
    p->taut[j] = vertex->force[j] > 0 ? 1.0 : 0.0;
  return p->taut;
}

/* All shapes' rectangle. */
static strut_bounds bounds_of(path_picture *p) {
  strut_bounds bounds = strut_bounds_none();
  for (size_t i = 0; i < p->stop_count; i++)
    strut_bounds_add(&bounds, p->model, enlarged(p, p->vertices[p->stops[i].vertex].q));
  for (size_t k = 0; k < p->count; k++) { /* the path of the node between them */
    const double *at = enlarged(p, p->vertices[k].q) + p->coordinate / 2 * 2;
    strut_bounds_widen(&bounds, at, at);
  }
  return bounds;
}

static double shapes_height(path_picture *p, double width) {
  strut_bounds b = bounds_of(p);
  double wide = b.high[0] - b.low[0], high = b.high[1] - b.low[1];
  double scale = wide > 0 ? (width - 2 * MARGIN) / wide : HUGE_VAL;
  return fmax(60.0, fmin(scale * high, 10 * width) + 2 * MARGIN + ARROW);
}

/* The arrow of a load at the beginning [pt]: outwards from its node, or from outside onto it. */
static bool load_arrow(const path_picture *p, const strut_window *window, const strut_load *load,
                       double ends[2][2]) {
  const double *q = p->path->points[0].at.q;
  double largest = 0.0, size = hypot(load->force[0], load->force[1]), middle[2] = {0, 0};
  if (!load_grows(p->path, load) || !(size > 0)) return false;
  for (size_t l = 0; l < p->model->scene->load_count; l++) {
    const strut_load *other = &p->model->scene->loads[l];
    if (load_grows(p->path, other))
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
static strut_window find_window(path_picture *p, strut_box box) {
  strut_bounds bounds = bounds_of(p), all = bounds;
  strut_window window = strut_window_fit(box, bounds, MARGIN);
  for (int pass = 0; pass < 3; pass++) { /* arrows have a length on the page, not in the plane */
    all = bounds;
    for (size_t l = 0; l < p->model->scene->load_count; l++) {
      double ends[2][2];
      if (!load_arrow(p, &window, &p->model->scene->loads[l], ends)) continue;
      for (int k = 0; k < 2; k++) {
        const double at[2] = {window.left + (ends[k][0] - box.x) / window.scale,
                              window.top - (ends[k][1] - box.y) / window.scale};
        strut_bounds_widen(&all, at, at);
      }
    }
    window = strut_window_fit(box, all, MARGIN);
  }
  return window;
}

static void draw_node_path(path_picture *p, const strut_window *window, double stops[][2]) {
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

static void draw_shapes(path_picture *p, strut_box box) {
  double stops[MOST_STOPS][2], arrow[2][2];
  strut_window window = find_window(p, box);
  strut_draw_ground(p->canvas, &window, p->model);
  for (size_t i = 0; i < p->stop_count; i++) {
    const path_vertex *vertex = &p->vertices[p->stops[i].vertex];
    const double *q = vertex->q;
    const strut_structure_style style = {.colouring = STRUT_COLOUR_ONE,
                                         .colour = p->stops[i].colour,
                                         .slack_forces = flag_taut_cables(p, vertex),
                                         .thinness = 0.3,
                                         .no_supports = i > 0};
    strut_draw_structure(p->canvas, &window, p->model, enlarged(p, q), &style);
  }
  for (size_t l = 0; l < p->model->scene->load_count; l++) {
    if (!load_arrow(p, &window, &p->model->scene->loads[l], arrow)) continue;
    strut_draw_arrow(p->canvas, arrow[0][0], arrow[0][1], arrow[1][0], arrow[1][1], 6,
                     (strut_pen){.colour = strut_palette_thing(1), .width = 1.4});
  }
  draw_node_path(p, &window, stops);
  draw_markers(p, (const double(*)[2])stops);
  draw_letters(p, box, (const double(*)[2])stops);
  if (p->model->node_count <= NAMED)
    strut_draw_names(p->canvas, &window, p->model, p->path->points[0].at.q, false);
}

/* The path put in order, places to stop at, the page. */

static const double EDGE = 4.0, BETWEEN = 12.0, WIDE = 330.0; /* [pt] */
static const double CURVE_SHAPE = 0.72;        /* height over width of the curve's box */
static const double SEEN = 0.05, LARGE = 0.12; /* motion over the structure's size */
static const double NO_MOTION = 1e-10;         /* likewise: rounding, which is not enlarged */
static const char MINUS[] = "\xE2\x88\x92";
enum { NAME = 28 };              /* bytes of a name in the key */
static const double SAME = 1e-7; /* of the whole arc: events so close are one */

/* Largest motion of a coordinate, with its sign. */
static double largest_motion(const strut_path *path, int32_t coordinate) {
  double most = 0.0;
  for (size_t k = 0; k < path->point_count; k++) {
    double here = path->points[k].at.q[coordinate] - path->points[0].at.q[coordinate];
    if (fabs(here) > fabs(most) * (1 + 1e-9)) most = here;
  }
  return most;
}

/* The coordinate of a loaded node that moves farthest; of a free one where loads act on none. */
static void choose_coordinate(path_picture *p) {
  const strut_scene *scene = p->model->scene;
  double most = -1.0;
  if (p->path->coordinate >= 0) { /* the displaced coordinate */
    p->coordinate = p->path->coordinate;
    p->sign = largest_motion(p->path, p->coordinate) < 0 ? -1.0 : 1.0;
    return;
  }
  for (int pass = 0; pass < 3 && most < 0; pass++)
    for (int32_t i = 0; i < 2 * p->model->node_count; i++) {
      bool loaded = pass == 2 || (pass == 1 && !p->model->fixed[i]);
      for (size_t l = 0; l < scene->load_count; l++)
        loaded = loaded || (scene->loads[l].node == i / 2 && load_grows(p->path, &scene->loads[l]));
      double here = largest_motion(p->path, i);
      if (!loaded || fabs(here) <= most * (1 + 1e-9)) continue;
      most = fabs(here);
      p->coordinate = i;
      p->sign = here < 0 ? -1.0 : 1.0;
    }
}

static void add_vertex(path_picture *p, double value, const double *q, const double *force,
                       const double *reaction, bool unstable) {
  assert(p->count < p->path->point_count + p->path->event_count);
  p->vertices[p->count++] =
      (path_vertex){.value = value,
                    .motion = p->sign * (q[p->coordinate] - p->path->points[0].at.q[p->coordinate]),
                    .height = curve_height(p->path, value, reaction),
                    .unstable = unstable,
                    .q = q,
                    .force = force};
}

static path_stop *add_stop(path_picture *p, size_t vertex) {
  assert(p->stop_count < MOST_STOPS && vertex < p->count);
  path_stop *stop = &p->stops[p->stop_count++];
  stop->vertex = vertex;
  return stop;
}

/* The name of what an event happens to; "" where that is the whole structure. */
static const char *subject_of(const strut_model *model, const strut_path_event *event) {
  const strut_scene *scene = model->scene;
  switch (event->kind) {
    case STRUT_PATH_SLACK:
    case STRUT_PATH_TAUT:
    case STRUT_PATH_ZERO_LENGTH: return scene->members[event->index].name;
    case STRUT_PATH_TOUCHDOWN:
    case STRUT_PATH_LIFT_OFF:
    case STRUT_PATH_CORNER:
    case STRUT_PATH_SLIP:
    case STRUT_PATH_STICK: return scene->nodes[event->index].name;
    case STRUT_PATH_ENGAGE:
    case STRUT_PATH_RELEASE:
    case STRUT_PATH_LAW: return strut_element_name(scene, &model->elements.element[event->index]);
    case STRUT_PATH_LIMIT:
    case STRUT_PATH_BIFURCATION:
    case STRUT_PATH_KINK_LIMIT:
    case STRUT_PATH_KINK_BIFURCATION: break;
  }
  return "";
}

/* "slack: left" or, for events at the same place, "slack: left, right". */
static void describe_event(const path_picture *p, const strut_path_event *event,
                           const strut_path_event *before, char text[STOP_TEXT]) {
  size_t used = strlen(text), room = STOP_TEXT - used;
  const char *name = subject_of(p->model, event);
  int length = strut_text_bytes(name, NAME);
  if (used + NAME + 60 > STOP_TEXT) return; /* no room: the rest of the events here is not named */
  if (before && before->kind == event->kind)
    snprintf(text + used, room, "%s%.*s", length ? ", " : "", length, name);
  else
    snprintf(text + used, room, "%s%s%s%.*s", used ? "; " : "", strut_path_event_name(event->kind),
             length ? ": " : "", length, name);
}

static void add_event(path_picture *p, size_t index, double whole) {
  const strut_path_event *event = &p->path->events[index];
  const strut_path_event *before = index ? event - 1 : NULL;
  bool same = before && event->at.arc - before->at.arc <= SAME * whole;
  if (same && p->stop_count > 1 && !p->events_left) {
    describe_event(p, event, before, p->stops[p->stop_count - 1].text);
  } else if (p->stop_count + 1 < MOST_STOPS) { /* one is kept for the end */
    path_stop *stop = add_stop(p, p->count - 1);
    snprintf(stop->letter, sizeof stop->letter, "%c", (char)('A' + (int)p->stop_count - 2));
    describe_event(p, event, NULL, stop->text);
  } else {
    p->events_left++;
  }
}

/* Orders points and events by arc length. The start of an edge determines its stability. */
static void put_in_order(path_picture *p) {
  const strut_path *path = p->path;
  double whole = fmax(path->points[path->point_count - 1].at.arc, 1e-300);
  size_t at = 0;
  for (size_t k = 0; k < path->point_count; k++) {
    const strut_path_point *point = &path->points[k];
    for (; at < path->event_count && path->events[at].at.arc <= point->at.arc; at++) {
      const strut_path_event *event = &path->events[at];
      add_vertex(p, event->at.factor, event->at.q, event->at.force, event->at.reaction,
                 event->after > 0);
      add_event(p, at, whole);
    }
    add_vertex(p, point->at.factor, point->at.q, point->at.force, point->at.reaction,
               point->negative > 0);
    if (k == 0) snprintf(add_stop(p, p->count - 1)->text, STOP_TEXT, "start");
  }
  snprintf(add_stop(p, p->count - 1)->text, STOP_TEXT, "end");
  strut_c_locale locale = strut_c_locale_enter();
  for (size_t i = 0; i < p->stop_count; i++) {
    char *text = p->stops[i].text;
    size_t used = strlen(text);
    p->stops[i].colour = strut_palette_sequence((double)i / (double)(p->stop_count - 1));
    double value = p->vertices[p->stops[i].vertex].value, reference = path->reference;
    const char *unit = reference > 0 ? "N" : path->unit;
    if (*unit)
      snprintf(text + used, STOP_TEXT - used, ", %s",
               strut_drawn_quantity(reference > 0 ? value * reference : value, 5, unit).text);
    else
      snprintf(text + used, STOP_TEXT - used, ", %s%.5g", value < 0 ? MINUS : "", fabs(value));
  }
  strut_c_locale_leave(locale);
}

/* 1, or a round factor that makes small motion visible. */
static void choose_enlargement(path_picture *p) {
  double most = 0.0, steps[] = {1, 2, 5};
  for (int32_t i = 0; i < 2 * p->model->node_count; i++)
    most = fmax(most, fabs(largest_motion(p->path, i)));
  p->larger = 1.0;
  /* Beside a ground nothing is enlarged: contact would look wrong. */
  if (!(most > NO_MOTION * p->model->size) || most >= SEEN * p->model->size ||
      p->model->scene->ground.present)
    return;
  double wanted = LARGE * p->model->size / most, power = pow(10.0, floor(log10(wanted)));
  for (int i = 0; i < 3; i++)
    if (steps[i] * power <= wanted) p->larger = fmax(1.0, steps[i] * power);
}

static bool prepare_picture(path_picture *p, strut_arena *arena) {
  size_t most = p->path->point_count + p->path->event_count;
  p->vertices = strut_arena_allocate(arena, most, sizeof *p->vertices);
  p->points = strut_arena_allocate(arena, most, sizeof *p->points);
  p->shape = strut_arena_allocate(arena, (size_t)p->model->length, sizeof *p->shape);
  p->taut = strut_arena_allocate(arena, p->model->scene->member_count + 1, sizeof *p->taut);
  if (!p->vertices || !p->points || !p->shape || !p->taut) return false;
  p->upright = p->path->over == STRUT_PATH_OVER_ACTUATOR || p->path->over == STRUT_PATH_OVER_SCENE;
  choose_coordinate(p);
  put_in_order(p);
  choose_enlargement(p);
  return true;
}

enum { ITEMS = MOST_STOPS + 5, NOTE = 80 };

static size_t make_key(const path_picture *p, char notes[2][NOTE], strut_key_item items[ITEMS]) {
  size_t count = 0;
  bool unstable = false;
  for (size_t k = 0; k + 1 < p->count; k++) unstable = unstable || p->vertices[k].unstable;
  for (size_t i = 0; i < p->stop_count; i++)
    items[count++] = (strut_key_item){.sign = STRUT_KEY_DOT,
                                      .pen = {.colour = strut_grey(0.1), .width = 0.6},
                                      .fill = {.colour = p->stops[i].colour},
                                      .letter = p->stops[i].letter[0] ? p->stops[i].letter : NULL,
                                      .text = p->stops[i].text};
  if (p->events_left) {
    snprintf(notes[0], NOTE, "and %zu more event%s", p->events_left, p->events_left > 1 ? "s" : "");
    items[count++] = (strut_key_item){.sign = STRUT_KEY_WORDS, .text = notes[0]};
  }
  if (unstable)
    items[count++] = (strut_key_item){
        .sign = STRUT_KEY_LINE,
        .pen = {.colour = strut_grey(0.15), .width = 1.2, .dash = {3, 2}, .butt = true},
        .text = "unstable"};
  if (p->path->branch_count)
    items[count++] = (strut_key_item){.sign = STRUT_KEY_LINE,
                                      .pen = {.colour = strut_palette_thing(0), .width = 1.2},
                                      .text = "branches, faint where unstable"};
  if (p->larger > 1) {
    snprintf(notes[1], NOTE, "shapes: displacements enlarged %.0f times", p->larger);
    items[count++] = (strut_key_item){.sign = STRUT_KEY_WORDS, .text = notes[1]};
  }
  return count;
}

static strut_status draw_picture(path_picture *p, strut_error *error) {
  const char *title = strut_plot_title(p->plot, p->model->scene->name);
  double width = p->plot->width;
  char notes[2][NOTE];
  strut_key_item items[ITEMS] = {{0}};
  size_t count = make_key(p, notes, items);
  strut_canvas *ruler;
  strut_status status = strut_canvas_open_pixels(1, 1, 1.0, &ruler, error);
  if (status != STRUT_OK) return status;
  double inside = width - 2 * EDGE, key = strut_key_height(ruler, inside, items, count);
  strut_canvas_free(ruler);
  double head = 0.0;
  const strut_heading heading = {.width = width, .edge = EDGE, .title = title};
  status = strut_heading_measure(&heading, &head, error);
  if (status != STRUT_OK) return status;
  bool wide = width >= WIDE;
  strut_box curve = {EDGE, EDGE + head, wide ? 0.5 * (inside - BETWEEN) : inside, 0};
  curve.height = CURVE_SHAPE * curve.width;
  strut_box shapes = curve;
  if (wide) {
    shapes.x += curve.width + BETWEEN;
  } else {
    shapes.y += curve.height + BETWEEN;
    shapes.height = fmin(shapes_height(p, inside), 0.9 * inside);
  }
  double below = shapes.y + shapes.height + 0.5 * BETWEEN;
  status = strut_canvas_open(p->plot->path, width, below + key + EDGE, title, &p->canvas, error);
  if (status != STRUT_OK) return status;
  strut_heading_draw(p->canvas, &heading);
  draw_curve(p, curve);
  draw_shapes(p, shapes);
  strut_draw_key(p->canvas, (strut_box){EDGE, below, inside, key}, items, count);
  status = strut_canvas_commit(p->canvas, error);
  strut_canvas_free(p->canvas);
  return status;
}

strut_status strut_path_figure(const strut_plot *plot, const strut_model *model,
                               const strut_path *path, strut_error *error) {
  strut_arena arena = {0};
  path_picture picture = {.plot = plot, .model = model, .path = path};
  strut_status status = prepare_picture(&picture, &arena) ? draw_picture(&picture, error)
                                                          : strut_no_memory(error, "");
  strut_arena_free(&arena);
  return status;
}

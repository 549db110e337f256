/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/output/draw/figure.h"
#include "engine/output/figures/statics_figures.h"
#include "engine/scene/things.h"
#include "engine/statics/path/path.h"

enum { MOST_STOPS = 10 };

static const double MARGIN = 15.0;             /* [pt] */
static const double CURVE = 0.72;              /* height over width of the curve's panel */
static const double ARROW = 0.13;              /* a load's, of the structure's size */
static const double SEEN = 0.05, LARGE = 0.12; /* motion over the structure's size */
static const double NO_MOTION = 1e-10;         /* likewise: rounding, which is not enlarged */
static const double SAME = 1e-7;               /* of the whole arc: events so close are one */
enum { NAME = 28, TEXT = 110 }; /* bytes of a name in the key; of events that are named together */

/* A shape that is drawn: the beginning, events, the end. */
typedef struct path_stop {
  const strut_path_state *at;
  const char *letter, *text; /* "" but of an event; its events */
} path_stop;

typedef struct path_picture {
  const strut_model *model;
  const strut_path *path;
  bool upright;                   /* the motion is drawn upwards, over the parameter */
  int32_t coordinate;             /* index into q of the displacement drawn */
  double sign;                    /* 1 or -1: its direction */
  double larger;                  /* factor by which displacements are enlarged */
  bool unstable;                  /* some of the path */
  size_t stop_count, events_left; /* without a stop */
  path_stop stops[MOST_STOPS];
  strut_figure figure;
} path_picture;

/* True if the path scales this load. */
static bool load_grows(const strut_path *path, const strut_load *load) {
  if (path->over != STRUT_PATH_OVER_LOAD) return false;
  return path->load ? strcmp(load->name, path->load) == 0 : load->signal < 0;
}

/* ---- the curve ---- */

/* Largest motion of a coordinate, with its sign. */
static double largest_motion(const strut_path *path, int32_t coordinate) {
  double most = 0.0;
  for (size_t k = 0; k < path->point_count; k++) {
    double here = path->points[k].at.q[coordinate] - path->points[0].at.q[coordinate];
    if (fabs(here) > fabs(most) * (1 + 1e-9)) most = here;
  }
  return most;
}

/* 2 if the path's loads act on the node of a coordinate, 1 if it is free, 0 else. */
static int rank_of(const path_picture *picture, int32_t coordinate) {
  const strut_scene *scene = picture->model->scene;
  for (size_t l = 0; l < scene->load_count; l++)
    if (scene->loads[l].node == coordinate / 2 && load_grows(picture->path, &scene->loads[l]))
      return 2;
  return !picture->model->fixed[coordinate];
}

/*
 * The displaced coordinate; else that of a loaded node that moves farthest; of a free one where loads act on none. Small
 * motion is enlarged by a round factor, but beside a ground, where contact would look wrong.
 */
static void choose_coordinate(path_picture *picture) {
  const strut_model *model = picture->model;
  double most = 0.0, all = 0.0;
  int best = -1;
  picture->coordinate = picture->path->coordinate;
  for (int32_t i = 0; i < 2 * model->node_count; i++) {
    int rank = rank_of(picture, i);
    double here = fabs(largest_motion(picture->path, i));
    all = fmax(all, here);
    if (rank < best || (rank == best && here <= most * (1 + 1e-9))) continue;
    most = here, best = rank;
    if (picture->path->coordinate < 0) picture->coordinate = i;
  }
  picture->sign = largest_motion(picture->path, picture->coordinate) < 0 ? -1.0 : 1.0;
  bool small = all > NO_MOTION * model->size && all < SEEN * model->size;
  picture->larger = small && !model->scene->ground.present
                        ? fmax(1.0, strut_round_below(LARGE * model->size / all))
                        : 1.0;
}

/* Where a state is in the chart: the displacement [m]; a load or reaction [N], or the value. */
static void find_place(const path_picture *picture, const strut_path_state *at, double place[2]) {
  const strut_path *path = picture->path;
  double motion = at->q[picture->coordinate] - path->points[0].at.q[picture->coordinate];
  place[picture->upright] = picture->sign * motion;
  place[!picture->upright] = path->coordinate >= 0   ? at->reaction[path->coordinate]
                             : path->reference > 0.0 ? at->factor * path->reference
                                                     : at->factor;
}

/* Coordinate i with its motion enlarged. */
static double enlarged(const path_picture *picture, const double *positions, int32_t i) {
  double from = picture->path->points[0].at.q[i];
  return from + picture->larger * (positions[i] - from);
}

/* Where the node whose motion is drawn is in a state. */
static void find_node(const path_picture *picture, const strut_path_state *at, double place[2]) {
  int32_t node = picture->coordinate / 2 * 2;
  for (int32_t d = 0; d < 2; d++) place[d] = enlarged(picture, at->q, node + d);
}

/* Adds the next point of a curve, whose edge to the one after it is unstable or not, and of the path's way. */
static void add_point(path_picture *picture, strut_series *curve, strut_series *way,
                      const strut_path_state *at, bool unstable) {
  double place[2];
  find_place(picture, at, place);
  strut_add_point(&picture->figure, curve, place[0], place[1])->unstable = unstable;
  find_node(picture, at, place);
  if (way) strut_add_point(&picture->figure, way, place[0], place[1]);
}

static void add_stop(path_picture *picture, const strut_path_state *at, const char *letter,
                     const char *text) {
  assert(picture->stop_count < MOST_STOPS);
  picture->stops[picture->stop_count++] = (path_stop){at, letter, text};
}

/* "limit point" or, of what happens to one thing, "left goes slack"; after what happens at the same place. */
static const char *describe_event(path_picture *picture, const strut_path_event *event,
                                  const char *before) {
  bool whole = event->kind == STRUT_PATH_LIMIT || event->kind == STRUT_PATH_BIFURCATION ||
               event->kind == STRUT_PATH_KINK_LIMIT || event->kind == STRUT_PATH_KINK_BIFURCATION;
  const char *what = whole ? strut_path_event_name(event->kind) : event->detail;
  int length = strut_text_bytes(what, (int)strcspn(what, ";:,"));
  if (strlen(before) > TEXT - NAME) return before; /* the rest of the events here is not named */
  return strut_figure_text(&picture->figure, "%s%s%.*s", before, *before ? "; " : "", length, what);
}

static void add_event(path_picture *picture, const strut_path_event *event, bool same) {
  path_stop *stop = &picture->stops[picture->stop_count - 1];
  char letter = (char)('A' + (int)picture->stop_count - 1);
  if (same && *stop->letter && !picture->events_left)
    stop->text = describe_event(picture, event, stop->text);
  else if (picture->stop_count + 1 < MOST_STOPS) /* one is kept for the end */
    add_stop(picture, &event->at, strut_figure_text(&picture->figure, "%c", letter),
             describe_event(picture, event, ""));
  else
    picture->events_left++;
}

/* The path's points and events in the order of arc length. The start of an edge determines its stability. */
static void add_path(path_picture *picture, strut_series *curve, strut_panel *view) {
  const strut_path *path = picture->path;
  double whole = fmax(path->points[path->point_count - 1].at.arc, 1e-300);
  size_t next = 0;
  strut_series *way = strut_add_line(&picture->figure, view, STRUT_SERIES_LINE,
                                     (strut_pen){.colour = strut_grey(0.45), .width = 0.7});
  for (size_t k = 0; k < path->point_count; k++) {
    const strut_path_point *point = &path->points[k];
    for (; next < path->event_count && path->events[next].at.arc <= point->at.arc; next++) {
      const strut_path_event *event = &path->events[next];
      bool same = next && event->at.arc - event[-1].at.arc <= SAME * whole;
      add_point(picture, curve, way, &event->at, event->after > 0);
      add_event(picture, event, same);
      picture->unstable |= event->after > 0;
    }
    add_point(picture, curve, way, &point->at, point->negative > 0);
    picture->unstable |= point->negative > 0 && k + 1 < path->point_count;
    if (k == 0) add_stop(picture, &point->at, "", "start");
  }
  add_stop(picture, &path->points[path->point_count - 1].at, "", "end");
}

static strut_pen line_pen(bool branch) {
  return (strut_pen){.colour = branch ? strut_palette_thing(0) : strut_grey(0.15), .width = 1.2};
}

/* The path above its branches. */
static void add_curves(path_picture *picture, strut_panel *panel, strut_panel *view) {
  const strut_path *path = picture->path;
  for (size_t i = 0; i < path->branch_count; i++) {
    const strut_path *branch = &path->branches[i];
    strut_series *curve =
        strut_add_line(&picture->figure, panel, STRUT_SERIES_LINE, line_pen(true));
    for (size_t k = 0; k < branch->point_count; k++)
      add_point(picture, curve, NULL, &branch->points[k].at, branch->points[k].negative > 0);
  }
  add_path(picture, strut_add_line(&picture->figure, panel, STRUT_SERIES_LINE, line_pen(false)),
           view);
}

/* The unit that the scene gives the parameter in. */
static strut_file_unit shown_unit(const path_picture *picture) {
  const strut_path *path = picture->path;
  const strut_parameter *parameter = path->over == STRUT_PATH_OVER_SCENE
                                         ? strut_parameter_named(picture->model->scene, path->name)
                                         : NULL;
  return parameter ? parameter->shown : (strut_file_unit){0};
}

/* Names the axes of motion and parameter. */
static void name_axes(path_picture *picture, strut_panel *panel) {
  static const char *const directions[] = {"to the left", "to the right", "downwards", "upwards"};
  const strut_path *path = picture->path;
  bool force = path->reference > 0, all = path->over == STRUT_PATH_OVER_LOAD && !path->load;
  const char *motion =
      strut_figure_text(&picture->figure, "displacement of %s %s",
                        picture->model->scene->nodes[picture->coordinate / 2].name,
                        directions[2 * (picture->coordinate % 2) + (picture->sign > 0)]);
  const char *of = path->over == STRUT_PATH_OVER_LOAD ? force ? "force of " : "factor of "
                   : path->coordinate >= 0            ? "reaction of "
                                                      : "";
  const char *name = all ? force && path->several ? "each load" : "the load" : path->name;
  *(picture->upright ? &panel->y : &panel->x) = strut_axis_of(motion, "m");
  *(picture->upright ? &panel->x : &panel->y) =
      strut_axis_in(strut_figure_text(&picture->figure, "%s%s", of, name),
                    force || path->coordinate >= 0 ? "N" : path->unit, shown_unit(picture));
}

static strut_colour colour_of(const path_picture *picture, size_t stop) {
  return strut_palette_at(STRUT_COLOURS_SEQUENTIAL, (double)stop, 0,
                          (double)picture->stop_count - 1);
}

static void add_mark(path_picture *picture, strut_panel *panel, size_t stop,
                     const double place[2]) {
  strut_label *mark =
      strut_add_mark(&picture->figure, panel, place[0], place[1], picture->stops[stop].letter);
  mark->dot = true;
  mark->colour = colour_of(picture, stop);
  mark->font.size = 8, mark->font.bold = true;
  mark->angle = 0.25 * STRUT_PI;
  mark->priority = 1;
}

/* ---- the shapes ---- */

/* Arrows of loads at the beginning: outwards from the node, or from outside onto it. */
static void add_loads(path_picture *picture, strut_panel *panel) {
  const strut_model *model = picture->model;
  const strut_pen pen = {.colour = strut_palette_thing(1), .width = 1.4};
  const double *q = picture->path->points[0].at.q;
  double largest = 0.0;
  for (int pass = 0; pass < 2; pass++)
    for (size_t l = 0; l < model->scene->load_count; l++) {
      const strut_load *load = &model->scene->loads[l];
      double size = hypot(load->force[0], load->force[1]), outwards = 0.0, ends[2][2];
      if (!load_grows(picture->path, load) || !(size > 0)) continue;
      largest = fmax(largest, size);
      for (int32_t i = 0; i < 2 * model->node_count; i++)
        outwards += (q[2 * load->node + i % 2] - q[i]) * load->force[i % 2];
      for (int d = 0; d < 2; d++) {
        double step = ARROW * model->size * fmax(0.3, size / largest) * load->force[d] / size;
        ends[0][d] = q[2 * load->node + d] - (outwards > 0 ? 0.0 : step);
        ends[1][d] = ends[0][d] + step;
      }
      if (pass)
        strut_add_segment(&picture->figure, panel, STRUT_SERIES_ARROW, pen, ends[0], ends[1]);
    }
}

/* All stops' shapes over each other. */
static void add_shapes(path_picture *picture, strut_panel *panel) {
  strut_figure *figure = &picture->figure;
  size_t members = picture->model->scene->member_count;
  for (size_t i = 0; i < picture->stop_count; i++) {
    const strut_path_state *at = picture->stops[i].at;
    double *q = strut_figure_numbers(figure, NULL, (size_t)picture->model->length), place[2];
    double *taut = strut_figure_numbers(figure, NULL, members); /* for cables */
    for (int32_t c = 0; q && c < picture->model->length; c++) q[c] = enlarged(picture, at->q, c);
    for (size_t j = 0; taut && j < members; j++) taut[j] = at->force[j] > 0 ? 1.0 : 0.0;
    strut_shape *shape = strut_add_shape(figure, panel, picture->model, q);
    shape->style = (strut_structure_style){.colouring = STRUT_COLOUR_ONE,
                                           .colour = colour_of(picture, i),
                                           .slack_forces = taut,
                                           .thinness = 0.3,
                                           .no_supports = i > 0};
    shape->ground = shape->names = i == 0;
    find_node(picture, at, place);
    add_mark(picture, panel, i, place);
  }
}

/* ---- the figure ---- */

static void add_keys(path_picture *picture) {
  strut_figure *figure = &picture->figure;
  const strut_path *path = picture->path;
  size_t more = picture->events_left;
  bool force = path->reference > 0;
  strut_pen pen = {.colour = strut_grey(0.1), .width = 0.6};
  for (size_t i = 0; i < picture->stop_count; i++) {
    const path_stop *stop = &picture->stops[i];
    const strut_rounded_quantity value =
        strut_quantity_shown(stop->at->factor * (force ? path->reference : 1.0), 5,
                             force         ? "N"
                             : *path->unit ? path->unit
                                           : "1",
                             shown_unit(picture));
    strut_add_key(figure, STRUT_KEY_DOT, pen,
                  strut_figure_text(figure, "%s%s%s, %s", stop->letter, *stop->letter ? ": " : "",
                                    stop->text, value.text))
        ->fill.colour = colour_of(picture, i);
  }
  if (more)
    strut_add_key(figure, STRUT_KEY_WORDS, pen,
                  strut_figure_text(figure, "and %zu more event%s", more, more > 1 ? "s" : ""));
  pen = (strut_pen){.colour = strut_grey(0.15), .width = 1.2, .dash = {3, 2}, .butt = true};
  if (picture->unstable) strut_add_key(figure, STRUT_KEY_LINE, pen, "unstable");
  if (path->branch_count) strut_add_key(figure, STRUT_KEY_LINE, line_pen(true), "branches");
  if (picture->larger > 1)
    strut_add_key(
        figure, STRUT_KEY_WORDS, pen,
        strut_figure_text(figure, "shapes: displacements enlarged %.0f times", picture->larger));
}

strut_status strut_path_figure(const strut_plot *plot, const strut_model *model,
                               const strut_path *path, strut_error *error) {
  path_picture p = {
      .model = model,
      .path = path,
      .upright = path->over == STRUT_PATH_OVER_ACTUATOR || path->over == STRUT_PATH_OVER_SCENE,
      .figure = {.title = model->scene->name, .aspect = CURVE}};
  choose_coordinate(&p);
  strut_panel *chart = strut_add_panel(&p.figure), *view = strut_add_panel(&p.figure);
  if (!p.figure.failed) chart = view - 1;
  add_curves(&p, chart, view);
  name_axes(&p, chart);
  chart->room = 0.05;
  for (size_t i = 0; i < p.stop_count; i++) {
    double place[2];
    find_place(&p, p.stops[i].at, place);
    add_mark(&p, chart, i, place);
  }
  view->margin = MARGIN;
  view->beside = true;
  add_loads(&p, view);
  add_shapes(&p, view);
  add_keys(&p);
  return strut_figure_draw(plot, &p.figure, error);
}

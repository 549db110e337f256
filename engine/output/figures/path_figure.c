/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/vec.h"
#include "engine/output/draw/figure.h"
#include "engine/output/figures/statics_figures.h"
#include "engine/statics/path/path.h"

enum { MOST_STOPS = 10, STOP_TEXT = 160, LABEL = 200, NOTE = 80, KEYS = MOST_STOPS + 5 };

static const double MARGIN = 15.0, GAP = 4.0;  /* [pt]; between a node and the arrow of its load */
static const double CURVE = 0.72;              /* height over width of the curve's panel */
static const double ARROW = 0.13;              /* a load's, of the structure's size */
static const double SEEN = 0.05, LARGE = 0.12; /* motion over the structure's size */
static const double NO_MOTION = 1e-10;         /* likewise: rounding, which is not enlarged */
static const double SAME = 1e-7;               /* of the whole arc: events so close are one */
static const char MINUS[] = "\xE2\x88\x92";
enum { NAME = 28 }; /* bytes of a name in the key */

/* A curve: the path, or a branch of it. */
typedef struct path_curve {
  size_t count;
  double *motion, *height; /* (count) the displacement [m]; a load or reaction [N], or the value */
  bool *unstable;          /* (count) of the edge to the next one */
  const strut_path_state **at; /* (count) */
} path_curve;

/* A shape that is drawn: the beginning, events, the end. */
typedef struct path_stop {
  size_t at; /* on the curve */
  strut_colour colour;
  char letter[4]; /* of an event; else empty */
  char text[STOP_TEXT];
} path_stop;

typedef struct path_picture {
  const strut_model *model;
  const strut_path *path;
  bool upright;       /* the motion is drawn upwards, over the parameter */
  int32_t coordinate; /* index into q of the displacement drawn */
  double sign;        /* 1 or -1: its direction */
  double larger;      /* factor by which displacements are enlarged */
  path_curve curve, *branches;
  size_t stop_count, events_left; /* without a stop */
  path_stop stops[MOST_STOPS];
  strut_view view;
  strut_arena arena;
} path_picture;

/* True if the path scales this load. */
static bool load_grows(const strut_path *path, const strut_load *load) {
  if (path->over != STRUT_PATH_OVER_LOAD) return false;
  if (path->load) return strcmp(load->name, path->load) == 0;
  return load->signal < 0;
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

/* True if the path's loads act on the node of a coordinate. */
static bool is_loaded(const path_picture *picture, int32_t coordinate) {
  const strut_scene *scene = picture->model->scene;
  for (size_t l = 0; l < scene->load_count; l++)
    if (scene->loads[l].node == coordinate / 2 && load_grows(picture->path, &scene->loads[l]))
      return true;
  return false;
}

/* The displaced coordinate; else that of a loaded node that moves farthest; of a free one where loads act on none. */
static void choose_coordinate(path_picture *picture) {
  double most = 0.0;
  int best = -1;
  picture->coordinate = picture->path->coordinate;
  for (int32_t i = 0; i < 2 * picture->model->node_count && picture->path->coordinate < 0; i++) {
    int rank = is_loaded(picture, i) ? 2 : picture->model->fixed[i] ? 0 : 1;
    double here = fabs(largest_motion(picture->path, i));
    if (rank < best || (rank == best && here <= most * (1 + 1e-9))) continue;
    most = here, best = rank;
    picture->coordinate = i;
  }
  picture->sign = largest_motion(picture->path, picture->coordinate) < 0 ? -1.0 : 1.0;
}

/* Sets the next point of a curve. */
static void add_point(const path_picture *picture, path_curve *curve, const strut_path_state *at,
                      bool unstable) {
  size_t k = curve->count++;
  double start = picture->path->points[0].at.q[picture->coordinate];
  curve->at[k] = at;
  curve->motion[k] = picture->sign * (at->q[picture->coordinate] - start);
  curve->height[k] = picture->path->coordinate >= 0   ? at->reaction[picture->path->coordinate]
                     : picture->path->reference > 0.0 ? at->factor * picture->path->reference
                                                      : at->factor;
  curve->unstable[k] = unstable;
}

static path_stop *add_stop(path_picture *picture) {
  assert(picture->stop_count < MOST_STOPS && picture->curve.count);
  path_stop *stop = &picture->stops[picture->stop_count++];
  stop->at = picture->curve.count - 1;
  return stop;
}

/* The name of what an event happens to; "" where that is the whole structure. */
static const char *subject_of(const strut_model *model, const strut_path_event *event) {
  enum { WHOLE, MEMBER, NODE, ELEMENT };
  static const char things[] = {[STRUT_PATH_SLACK] = MEMBER,       [STRUT_PATH_TAUT] = MEMBER,
                                [STRUT_PATH_ZERO_LENGTH] = MEMBER, [STRUT_PATH_TOUCHDOWN] = NODE,
                                [STRUT_PATH_LIFT_OFF] = NODE,      [STRUT_PATH_CORNER] = NODE,
                                [STRUT_PATH_SLIP] = NODE,          [STRUT_PATH_STICK] = NODE,
                                [STRUT_PATH_ENGAGE] = ELEMENT,     [STRUT_PATH_RELEASE] = ELEMENT,
                                [STRUT_PATH_LAW] = ELEMENT};
  const strut_scene *scene = model->scene;
  switch ((size_t)event->kind < sizeof things ? things[event->kind] : WHOLE) {
    case MEMBER: return scene->members[event->index].name;
    case NODE: return scene->nodes[event->index].name;
    case ELEMENT: return strut_element_name(scene, &model->elements.element[event->index]);
    default: return "";
  }
}

/* "slack: left" or, for events at the same place, "slack: left, right". */
static void describe_event(const path_picture *picture, const strut_path_event *event,
                           const strut_path_event *before, char text[STOP_TEXT]) {
  size_t used = strlen(text), room = STOP_TEXT - used;
  const char *name = subject_of(picture->model, event);
  int length = strut_text_bytes(name, NAME);
  if (used + NAME + 60 > STOP_TEXT) return; /* no room: the rest of the events here is not named */
  if (before && before->kind == event->kind)
    snprintf(text + used, room, "%s%.*s", length ? ", " : "", length, name);
  else
    snprintf(text + used, room, "%s%s%s%.*s", used ? "; " : "", strut_path_event_name(event->kind),
             length ? ": " : "", length, name);
}

static void add_event(path_picture *picture, size_t index, double whole) {
  const strut_path_event *event = &picture->path->events[index];
  const strut_path_event *before = index ? event - 1 : NULL;
  bool same = before && event->at.arc - before->at.arc <= SAME * whole;
  if (same && picture->stop_count > 1 && !picture->events_left) {
    describe_event(picture, event, before, picture->stops[picture->stop_count - 1].text);
  } else if (picture->stop_count + 1 < MOST_STOPS) { /* one is kept for the end */
    path_stop *stop = add_stop(picture);
    snprintf(stop->letter, sizeof stop->letter, "%c", (char)('A' + (int)picture->stop_count - 2));
    describe_event(picture, event, NULL, stop->text);
  } else {
    picture->events_left++;
  }
}

/* Orders points and events by arc length. The start of an edge determines its stability. */
static void put_in_order(path_picture *picture) {
  const strut_path *path = picture->path;
  double whole = fmax(path->points[path->point_count - 1].at.arc, 1e-300);
  size_t at = 0;
  for (size_t k = 0; k < path->point_count; k++) {
    const strut_path_point *point = &path->points[k];
    for (; at < path->event_count && path->events[at].at.arc <= point->at.arc; at++) {
      add_point(picture, &picture->curve, &path->events[at].at, path->events[at].after > 0);
      add_event(picture, at, whole);
    }
    add_point(picture, &picture->curve, &point->at, point->negative > 0);
    if (k == 0) snprintf(add_stop(picture)->text, STOP_TEXT, "start");
  }
  snprintf(add_stop(picture)->text, STOP_TEXT, "end");
}

/* Colours of the stops, and the values there. */
static void describe_stops(path_picture *picture) {
  double reference = picture->path->reference;
  const char *unit = reference > 0 ? "N" : picture->path->unit;
  strut_c_locale locale = strut_c_locale_enter();
  for (size_t i = 0; i < picture->stop_count; i++) {
    char *text = picture->stops[i].text;
    size_t used = strlen(text);
    double value =
        picture->curve.at[picture->stops[i].at]->factor * (reference > 0 ? reference : 1.0);
    picture->stops[i].colour =
        strut_palette_sequence((double)i / (double)(picture->stop_count - 1));
    if (*unit)
      snprintf(text + used, STOP_TEXT - used, ", %s", strut_drawn_quantity(value, 5, unit).text);
    else
      snprintf(text + used, STOP_TEXT - used, ", %s%.5g", value < 0 ? MINUS : "", fabs(value));
  }
  strut_c_locale_leave(locale);
}

/* False: out of memory. */
static bool make_curve(path_picture *picture, size_t most, path_curve *curve) {
  curve->motion = strut_arena_allocate(&picture->arena, 2 * most, sizeof *curve->motion);
  curve->unstable = strut_arena_allocate(&picture->arena, most, sizeof *curve->unstable);
  curve->at = strut_arena_allocate(&picture->arena, most, sizeof *curve->at);
  if (curve->motion) curve->height = curve->motion + most;
  return curve->motion && curve->unstable && curve->at;
}

static bool make_curves(path_picture *picture) {
  const strut_path *path = picture->path;
  picture->branches =
      strut_arena_allocate(&picture->arena, path->branch_count + 1, sizeof *picture->branches);
  if (!picture->branches ||
      !make_curve(picture, path->point_count + path->event_count, &picture->curve))
    return false;
  put_in_order(picture);
  describe_stops(picture);
  for (size_t i = 0; i < path->branch_count; i++) {
    const strut_path *branch = &path->branches[i];
    if (!make_curve(picture, branch->point_count, &picture->branches[i])) return false;
    for (size_t k = 0; k < branch->point_count; k++)
      add_point(picture, &picture->branches[i], &branch->points[k].at,
                branch->points[k].negative > 0);
  }
  return true;
}

/* Writes what the axes of motion and parameter are called. */
static void name_axes(const path_picture *picture, char labels[2][LABEL]) {
  static const char *const directions[] = {"to the left", "to the right", "downwards", "upwards"};
  const strut_path *path = picture->path;
  bool force = path->reference > 0, all = path->over == STRUT_PATH_OVER_LOAD && !path->load;
  const char *node = picture->model->scene->nodes[picture->coordinate / 2].name;
  int most = strut_text_bytes(node, NAME), length = strut_text_bytes(path->name, NAME);
  snprintf(labels[0], LABEL, "displacement of %.*s %s", most, node,
           directions[2 * (picture->coordinate % 2) + (picture->sign > 0)]);
  if (path->over != STRUT_PATH_OVER_LOAD)
    snprintf(labels[1], LABEL, "%s%.*s", path->coordinate >= 0 ? "reaction of " : "", length,
             path->name);
  else if (all)
    snprintf(labels[1], LABEL, "%s of %s", force ? "force" : "factor",
             force && path->several ? "each load" : "the load");
  else
    snprintf(labels[1], LABEL, "%s of %.*s", force ? "force" : "factor", length, path->name);
}

static strut_series series_of(const path_picture *picture, const path_curve *curve,
                              const strut_pen *pen) {
  return (strut_series){.count = curve->count,
                        .x = picture->upright ? curve->height : curve->motion,
                        .y = picture->upright ? curve->motion : curve->height,
                        .pen = pen,
                        .unstable = curve->unstable,
                        .markers = STRUT_MARKERS_NONE};
}

static strut_mark mark_of(const path_stop *stop, double x, double y) {
  return (strut_mark){.at = {x, y},
                      .text = stop->letter,
                      .dot = true,
                      .colour = stop->colour,
                      .font = {.size = 8, .bold = true},
                      .angle = 0.25 * STRUT_PI,
                      .priority = 1};
}

/* ---- the shapes ---- */

/* 1, or a round factor that makes small motion visible. */
static void choose_enlargement(path_picture *picture) {
  double most = 0.0, steps[] = {1, 2, 5};
  for (int32_t i = 0; i < 2 * picture->model->node_count; i++)
    most = fmax(most, fabs(largest_motion(picture->path, i)));
  picture->larger = 1.0;
  /* Beside a ground nothing is enlarged: contact would look wrong. */
  if (!(most > NO_MOTION * picture->model->size) || most >= SEEN * picture->model->size ||
      picture->model->scene->ground.present)
    return;
  double wanted = LARGE * picture->model->size / most, power = pow(10.0, floor(log10(wanted)));
  for (int i = 0; i < 3; i++)
    if (steps[i] * power <= wanted) picture->larger = fmax(1.0, steps[i] * power);
}

/* A shape with its motion enlarged; NULL: out of memory. */
static const double *enlarged(path_picture *picture, const double *positions) {
  const double *from = picture->path->points[0].at.q;
  double *shape =
      strut_arena_copy(&picture->arena, from, (size_t)picture->model->length, sizeof *shape);
  for (int32_t i = 0; shape && i < picture->model->length; i++)
    shape[i] += picture->larger * (positions[i] - from[i]);
  return shape;
}

/* Flags the taut cables in a state; other members ignore it. NULL: out of memory. */
static const double *flag_taut_cables(path_picture *picture, const strut_path_state *at) {
  size_t members = picture->model->scene->member_count;
  double *taut = strut_arena_allocate(&picture->arena, members + 1, sizeof *taut);
  for (size_t j = 0; taut && j < members; j++) taut[j] = at->force[j] > 0 ? 1.0 : 0.0;
  return taut;
}

/* The arrow of a load at the beginning [m]: outwards from its node, or from outside onto it. */
static void load_arrow(const path_picture *picture, const strut_load *load, double largest,
                       double ends[2][2]) {
  const double *q = picture->path->points[0].at.q, *at = q + 2 * load->node;
  double size = hypot(load->force[0], load->force[1]), outwards = 0.0;
  double length = ARROW * picture->model->size * fmax(0.3, size / largest);
  for (int32_t i = 0; i < 2 * picture->model->node_count; i++)
    outwards += (at[i % 2] - q[i]) * load->force[i % 2];
  for (int d = 0; d < 2; d++) {
    double step = length * load->force[d] / size;
    ends[0][d] = at[d] - (outwards > 0 ? 0.0 : step);
    ends[1][d] = at[d] + (outwards > 0 ? step : 0.0);
  }
}

/* The way of the node whose motion is drawn, and the arrows of loads. False: out of memory. */
static bool add_trails(path_picture *picture, double (*way)[2]) {
  const strut_scene *scene = picture->model->scene;
  strut_trail *trails =
      strut_arena_allocate(&picture->arena, scene->load_count + 1, sizeof *trails);
  double(*arrows)[2] =
      strut_arena_allocate(&picture->arena, 2 * scene->load_count + 1, sizeof *arrows);
  if (!trails || !arrows) return false;
  trails[0] = (strut_trail){.count = picture->curve.count,
                            .at = (const double(*)[2])way,
                            .pen = {.colour = strut_grey(0.45), .width = 0.7}};
  size_t count = 1;
  double largest = 0.0;
  for (size_t l = 0; l < scene->load_count; l++)
    if (load_grows(picture->path, &scene->loads[l]))
      largest = fmax(largest, hypot(scene->loads[l].force[0], scene->loads[l].force[1]));
  for (size_t l = 0; l < scene->load_count && largest > 0; l++) {
    double(*ends)[2] = arrows + 2 * l;
    const double *force = scene->loads[l].force;
    if (!load_grows(picture->path, &scene->loads[l]) || !(hypot(force[0], force[1]) > 0)) continue;
    load_arrow(picture, &scene->loads[l], largest, ends);
    for (int end = 0; end < 2; end++)
      strut_bounds_widen(&picture->view.bounds, ends[end], ends[end]);
    trails[count++] = (strut_trail){.kind = STRUT_TRAIL_ARROW,
                                    .count = 2,
                                    .at = (const double(*)[2])ends,
                                    .pen = {.colour = strut_palette_thing(1), .width = 1.4},
                                    .gap = GAP};
  }
  for (size_t k = 0; k < picture->curve.count; k++)
    strut_bounds_widen(&picture->view.bounds, way[k], way[k]);
  picture->view.trails = trails;
  picture->view.trail_count = count;
  return true;
}

/* All stops' shapes over each other. False: out of memory. */
static bool make_view(path_picture *picture, strut_mark *marks) {
  double(*way)[2] = strut_arena_allocate(&picture->arena, picture->curve.count, sizeof *way);
  strut_shape *shapes = strut_arena_allocate(&picture->arena, picture->stop_count, sizeof *shapes);
  const double *from = picture->path->points[0].at.q;
  if (!way || !shapes) return false;
  for (size_t k = 0; k < picture->curve.count; k++)
    for (int d = 0; d < 2; d++) {
      int32_t i = picture->coordinate / 2 * 2 + d;
      way[k][d] = from[i] + picture->larger * (picture->curve.at[k]->q[i] - from[i]);
    }
  picture->view = (strut_view){.shapes = shapes,
                               .shape_count = picture->stop_count,
                               .bounds = strut_bounds_none(),
                               .margin = MARGIN};
  for (size_t i = 0; i < picture->stop_count; i++) {
    const path_stop *stop = &picture->stops[i];
    const strut_path_state *at = picture->curve.at[stop->at];
    shapes[i] = (strut_shape){.model = picture->model,
                              .q = enlarged(picture, at->q),
                              .style = {.colouring = STRUT_COLOUR_ONE,
                                        .colour = stop->colour,
                                        .slack_forces = flag_taut_cables(picture, at),
                                        .thinness = 0.3,
                                        .no_supports = i > 0},
                              .ground = i == 0,
                              .names = i == 0};
    if (!shapes[i].q || !shapes[i].style.slack_forces) return false;
    strut_bounds_add(&picture->view.bounds, picture->model, shapes[i].q);
    marks[i] = mark_of(stop, way[stop->at][0], way[stop->at][1]);
  }
  return add_trails(picture, way);
}

/* ---- the figure ---- */

static size_t make_key(const path_picture *picture, char notes[2][NOTE],
                       strut_key_item items[KEYS]) {
  size_t count = 0, more = picture->events_left;
  bool unstable = false;
  for (size_t k = 0; k + 1 < picture->curve.count; k++)
    unstable = unstable || picture->curve.unstable[k];
  for (size_t i = 0; i < picture->stop_count; i++)
    items[count++] =
        (strut_key_item){.sign = STRUT_KEY_DOT,
                         .pen = {.colour = strut_grey(0.1), .width = 0.6},
                         .fill = {.colour = picture->stops[i].colour},
                         .letter = picture->stops[i].letter[0] ? picture->stops[i].letter : NULL,
                         .text = picture->stops[i].text};
  snprintf(notes[0], NOTE, "and %zu more event%s", more, more > 1 ? "s" : "");
  snprintf(notes[1], NOTE, "shapes: displacements enlarged %.0f times", picture->larger);
  const strut_key_item others[] = {
      {.sign = STRUT_KEY_WORDS, .text = more ? notes[0] : NULL},
      {.sign = STRUT_KEY_LINE,
       .pen = {.colour = strut_grey(0.15), .width = 1.2, .dash = {3, 2}, .butt = true},
       .text = unstable ? "unstable" : NULL},
      {.sign = STRUT_KEY_LINE,
       .pen = {.colour = strut_palette_thing(0), .width = 1.2},
       .text = picture->path->branch_count ? "branches" : NULL},
      {.sign = STRUT_KEY_WORDS, .text = picture->larger > 1 ? notes[1] : NULL}};
  memcpy(items + count, others, sizeof others);
  return count + sizeof others / sizeof *others;
}

/* Draws a picture whose curves are made. */
static strut_status draw_picture(path_picture *picture, const strut_plot *plot,
                                 strut_error *error) {
  const strut_pen dark = {.colour = strut_grey(0.15), .width = 1.2};
  const strut_pen pale = {.colour = strut_palette_thing(0), .width = 1.2};
  const strut_path *path = picture->path;
  char labels[2][LABEL], notes[2][NOTE];
  strut_mark marks[2][MOST_STOPS];
  strut_key_item keys[KEYS];
  size_t branches = path->branch_count, key_count = make_key(picture, notes, keys);
  strut_series *series = strut_arena_allocate(&picture->arena, branches + 1, sizeof *series);
  if (!series || !make_view(picture, marks[1])) return strut_no_memory(error, "while drawing");
  for (size_t i = 0; i < branches; i++)
    series[i] = series_of(picture, &picture->branches[i], &pale);
  series[branches] = series_of(picture, &picture->curve, &dark);
  for (size_t i = 0; i < picture->stop_count; i++)
    marks[0][i] = mark_of(&picture->stops[i], series[branches].x[picture->stops[i].at],
                          series[branches].y[picture->stops[i].at]);
  name_axes(picture, labels);
  bool force = path->reference > 0 || path->coordinate >= 0;
  const strut_axis motion = {
      .name = labels[0], .unit = "m", .low = (double)NAN, .high = (double)NAN};
  const strut_axis height = {
      .name = labels[1], .unit = force ? "N" : path->unit, .low = (double)NAN, .high = (double)NAN};
  const strut_panel panels[2] = {{.x = picture->upright ? height : motion,
                                  .y = picture->upright ? motion : height,
                                  .series_count = branches + 1,
                                  .series = series,
                                  .room = 0.05,
                                  .mark_count = picture->stop_count,
                                  .marks = marks[0]},
                                 {.view = &picture->view,
                                  .mark_count = picture->stop_count,
                                  .marks = marks[1],
                                  .beside = true}};
  const strut_figure figure = {.title = picture->model->scene->name,
                               .panel_count = 2,
                               .panels = panels,
                               .aspect = CURVE,
                               .key_count = key_count,
                               .keys = keys};
  return strut_figure_draw(plot, &figure, error);
}

strut_status strut_path_figure(const strut_plot *plot, const strut_model *model,
                               const strut_path *path, strut_error *error) {
  path_picture p = {.model = model, .path = path};
  p.upright = path->over == STRUT_PATH_OVER_ACTUATOR || path->over == STRUT_PATH_OVER_SCENE;
  choose_coordinate(&p);
  choose_enlargement(&p);
  strut_status status =
      make_curves(&p) ? draw_picture(&p, plot, error) : strut_no_memory(error, "while drawing");
  strut_arena_free(&p.arena);
  return status;
}

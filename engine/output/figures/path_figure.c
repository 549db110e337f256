/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The path put in order, places to stop at, the page. */
#include "engine/output/figures/path_figure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/output/draw/axes.h"
#include "engine/output/draw/legend.h"
#include "engine/output/draw/palette.h"
#include "engine/output/figures/path_figure_parts.h"

static const double EDGE = 4.0, BETWEEN = 12.0, WIDE = 330.0; /* [pt] */
static const double CURVE_SHAPE = 0.72;        /* height over width of the curve's box */
static const double SEEN = 0.05, LARGE = 0.12; /* motion over the structure's size */
static const char MINUS[] = "\xE2\x88\x92";
enum { NAME = 28 };              /* bytes of a name in the key */
static const double SAME = 1e-7; /* of the whole arc: events so close are one */

bool strut_path_load_grows(const strut_path *path, const strut_load *load) {
  if (path->over != STRUT_PATH_OVER_LOAD) return false;
  if (path->load) return strcmp(load->name, path->load) == 0;
  return load->signal < 0;
}

/* Largest motion of a coordinate, with its sign. */
static double motion_of(const strut_path *path, int32_t coordinate) {
  double most = 0.0;
  for (size_t k = 0; k < path->point_count; k++) {
    double here = path->points[k].q[coordinate] - path->points[0].q[coordinate];
    if (fabs(here) > fabs(most) * (1 + 1e-9)) most = here;
  }
  return most;
}

/* The coordinate of a loaded node that moves farthest; of a free one where loads act on none. */
static void choose_coordinate(strut_path_picture *p) {
  const strut_scene *scene = p->model->scene;
  double most = -1.0;
  if (p->path->coordinate >= 0) { /* the one that is displaced */
    p->coordinate = p->path->coordinate;
    p->sign = motion_of(p->path, p->coordinate) < 0 ? -1.0 : 1.0;
    return;
  }
  for (int pass = 0; pass < 3 && most < 0; pass++)
    for (int32_t i = 0; i < 2 * p->model->node_count; i++) {
      bool loaded = pass == 2 || (pass == 1 && !p->model->fixed[i]);
      for (size_t l = 0; l < scene->load_count; l++)
        loaded = loaded || (scene->loads[l].node == i / 2 &&
                            strut_path_load_grows(p->path, &scene->loads[l]));
      double here = motion_of(p->path, i);
      if (!loaded || fabs(here) <= most * (1 + 1e-9)) continue;
      most = fabs(here);
      p->coordinate = i;
      p->sign = here < 0 ? -1.0 : 1.0;
    }
}

/* The force of a load that the value stands for, the reaction to a displacement, or the value. */
static double height_of(const strut_path *path, double value, const double *reaction) {
  if (path->coordinate >= 0) return reaction[path->coordinate];
  return path->reference > 0 ? value * path->reference : value;
}

static void add_vertex(strut_path_picture *p, double value, const double *q, const double *force,
                       const double *reaction, bool unstable) {
  p->vertices[p->count++] = (strut_path_vertex){
      .value = value,
      .motion = p->sign * (q[p->coordinate] - p->path->points[0].q[p->coordinate]),
      .height = height_of(p->path, value, reaction),
      .unstable = unstable,
      .q = q,
      .force = force};
}

static strut_path_stop *add_stop(strut_path_picture *p, size_t vertex) {
  strut_path_stop *stop = &p->stops[p->stop_count++];
  stop->vertex = vertex;
  return stop;
}

/* "slack: left" or, for events at the same place, "slack: left, right". */
static void say_event(const strut_path_picture *p, const strut_path_event *event,
                      const strut_path_event *before, char text[STRUT_PATH_STOP_TEXT]) {
  const strut_scene *scene = p->model->scene;
  size_t used = strlen(text), room = STRUT_PATH_STOP_TEXT - used;
  const char *name = "";
  if (event->kind == STRUT_PATH_SLACK || event->kind == STRUT_PATH_TAUT)
    name = scene->members[event->index].name;
  if (event->kind == STRUT_PATH_TOUCHDOWN || event->kind == STRUT_PATH_LIFT_OFF)
    name = scene->nodes[event->index].name;
  int length = strut_text_bytes(name, NAME);
  if (used + NAME + 60 > STRUT_PATH_STOP_TEXT) return; /* of so many at one place these do */
  if (before && before->kind == event->kind)
    snprintf(text + used, room, "%s%.*s", length ? ", " : "", length, name);
  else
    snprintf(text + used, room, "%s%s%s%.*s", used ? "; " : "", strut_path_event_name(event->kind),
             length ? ": " : "", length, name);
}

static void add_event(strut_path_picture *p, size_t index, double whole) {
  const strut_path_event *event = &p->path->events[index];
  const strut_path_event *before = index ? event - 1 : NULL;
  bool same = before && event->arc - before->arc <= SAME * whole;
  if (same && p->stop_count > 1 && !p->events_left) {
    say_event(p, event, before, p->stops[p->stop_count - 1].text);
  } else if (p->stop_count + 1 < STRUT_PATH_STOPS) { /* the end wants one too */
    strut_path_stop *stop = add_stop(p, p->count - 1);
    snprintf(stop->letter, sizeof stop->letter, "%c", (char)('A' + (int)p->stop_count - 2));
    say_event(p, event, NULL, stop->text);
  } else {
    p->events_left++;
  }
}

/* Points and events in the order of their arcs. An edge is as stable as what it begins at says. */
static void put_in_order(strut_path_picture *p) {
  const strut_path *path = p->path;
  double whole = fmax(path->points[path->point_count - 1].arc, 1e-300);
  size_t at = 0;
  for (size_t k = 0; k < path->point_count; k++) {
    const strut_path_point *point = &path->points[k];
    for (; at < path->event_count && path->events[at].arc <= point->arc; at++) {
      const strut_path_event *event = &path->events[at];
      add_vertex(p, event->factor, event->q, event->force, event->reaction, event->after > 0);
      add_event(p, at, whole);
    }
    add_vertex(p, point->factor, point->q, point->force, point->reaction, point->negative > 0);
    if (k == 0) snprintf(add_stop(p, p->count - 1)->text, STRUT_PATH_STOP_TEXT, "start");
  }
  snprintf(add_stop(p, p->count - 1)->text, STRUT_PATH_STOP_TEXT, "end");
  strut_c_locale locale = strut_c_locale_enter();
  for (size_t i = 0; i < p->stop_count; i++) {
    char *text = p->stops[i].text;
    size_t used = strlen(text);
    p->stops[i].colour = strut_palette_sequence((double)i / (double)(p->stop_count - 1));
    double value = p->vertices[p->stops[i].vertex].value, reference = path->reference;
    const char *unit = reference > 0 ? "N" : path->unit;
    if (*unit)
      snprintf(text + used, STRUT_PATH_STOP_TEXT - used, ", %s",
               strut_drawn_quantity(reference > 0 ? value * reference : value, 5, unit).text);
    else
      snprintf(text + used, STRUT_PATH_STOP_TEXT - used, ", %s%.5g", value < 0 ? MINUS : "",
               fabs(value));
  }
  strut_c_locale_leave(locale);
}

/* 1, or a round factor that makes small motion visible. */
static void choose_enlargement(strut_path_picture *p) {
  double most = 0.0, steps[] = {1, 2, 5};
  for (int32_t i = 0; i < 2 * p->model->node_count; i++)
    most = fmax(most, fabs(motion_of(p->path, i)));
  p->larger = 1.0;
  /* Beside the ground, which is where it is, shapes are too. */
  if (!(most > 0) || most >= SEEN * p->model->size || p->model->scene->ground.present) return;
  double wanted = LARGE * p->model->size / most, power = pow(10.0, floor(log10(wanted)));
  for (int i = 0; i < 3; i++)
    if (steps[i] * power <= wanted) p->larger = fmax(1.0, steps[i] * power);
}

static bool prepare(strut_path_picture *p, strut_arena *arena) {
  size_t most = p->path->point_count + p->path->event_count;
  p->vertices = strut_arena_allocate(arena, most, sizeof *p->vertices);
  p->points = strut_arena_allocate(arena, most, sizeof *p->points);
  p->shape = strut_arena_allocate(arena, (size_t)p->model->length, sizeof *p->shape);
  p->other_room =
      STRUT_PATH_STOPS * (p->model->scene->member_count + 2) + p->model->scene->load_count;
  p->others = strut_arena_allocate(arena, 2 * p->other_room, sizeof *p->others);
  p->taut = strut_arena_allocate(arena, p->model->scene->member_count + 1, sizeof *p->taut);
  if (!p->vertices || !p->points || !p->shape || !p->taut || !p->others) return false;
  p->upright = p->path->over == STRUT_PATH_OVER_ACTUATOR || p->path->over == STRUT_PATH_OVER_SCENE;
  choose_coordinate(p);
  put_in_order(p);
  choose_enlargement(p);
  return true;
}

enum { ITEMS = STRUT_PATH_STOPS + 4, NOTE = 80 };

static size_t make_key(const strut_path_picture *p, char notes[2][NOTE],
                       strut_key_item items[ITEMS]) {
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
  if (p->larger > 1) {
    snprintf(notes[1], NOTE, "shapes: motion drawn %.0f times larger", p->larger);
    items[count++] = (strut_key_item){.sign = STRUT_KEY_WORDS, .text = notes[1]};
  }
  return count;
}

static strut_status draw(strut_path_picture *p, const char *name, double width,
                         strut_error *error) {
  char notes[2][NOTE];
  strut_key_item items[ITEMS] = {{0}};
  size_t count = make_key(p, notes, items);
  strut_canvas *ruler;
  strut_status status = strut_canvas_open_pixels(1, 1, 1.0, &ruler, error);
  if (status != STRUT_OK) return status;
  double inside = width - 2 * EDGE, key = strut_key_height(ruler, inside, items, count);
  strut_canvas_free(ruler);
  bool wide = width >= WIDE;
  strut_box curve = {EDGE, EDGE, wide ? 0.5 * (inside - BETWEEN) : inside, 0};
  curve.height = CURVE_SHAPE * curve.width;
  strut_box shapes = curve;
  if (wide) {
    shapes.x += curve.width + BETWEEN;
  } else {
    shapes.y += curve.height + BETWEEN;
    shapes.height = fmin(strut_path_shapes_height(p, inside), 0.9 * inside);
  }
  double below = shapes.y + shapes.height + 0.5 * BETWEEN;
  status =
      strut_canvas_open(name, width, below + key + EDGE, p->model->scene->name, &p->canvas, error);
  if (status != STRUT_OK) return status;
  strut_path_draw_curve(p, curve);
  strut_path_draw_shapes(p, shapes);
  strut_draw_key(p->canvas, (strut_box){EDGE, below, inside, key}, items, count);
  status = strut_canvas_commit(p->canvas, error);
  strut_canvas_free(p->canvas);
  return status;
}

strut_status strut_path_figure(const char *path_name, double width, const strut_model *model,
                               const strut_path *path, strut_error *error) {
  strut_arena arena = {0};
  strut_path_picture picture = {.model = model, .path = path};
  strut_status status = prepare(&picture, &arena)
                            ? draw(&picture, path_name, width, error)
                            : strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  strut_arena_free(&arena);
  return status;
}

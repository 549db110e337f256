/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/path/path_parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Points and events are kept with positions and all forces. */

double strut_path_distance(const strut_path_walk *w, const double *a, const double *b) {
  double sum = 0;
  for (int32_t i = 0; i <= w->system.n; i++) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sqrt(sum);
}

/* Memory for one more of `size` bytes at *items. */
static bool reserve_items(strut_path_walk *w, void **items, size_t count, size_t *room,
                          size_t size) {
  if (count < *room) return true;
  size_t more = *room ? 2 * *room : 64;
  void *block = *items ? strut_reallocate(*items, more, size) : strut_allocate(more, size);
  if (!block) {
    w->failed = true;
    return false;
  }
  *items = block, *room = more;
  return true;
}

static double *new_values(strut_path_walk *w, size_t count) {
  double *values = strut_arena_allocate(&w->path->arena, count, sizeof *values);
  if (!values) w->failed = true;
  return values;
}

/* What the path is at y, `arc` from its beginning; w->failed: out of memory. */
static strut_path_state keep_state(strut_path_walk *w, const double *y, double arc) {
  strut_path_system *s = &w->system;
  const strut_model *model = s->model;
  const strut_scene *scene = model->scene;
  size_t length = (size_t)model->length, members = (size_t)model->members.count;
  size_t contacts = (size_t)model->contacts.count;
  strut_path_state state = {.factor = strut_path_value(s, y),
                            .arc = arc,
                            .q = new_values(w, length),
                            .force = new_values(w, members),
                            .moment = new_values(w, scene->hinge_count),
                            .pressure = new_values(w, scene->cell_count),
                            .distance = new_values(w, scene->distance_count),
                            .reaction = new_values(w, length),
                            .contact = new_values(w, contacts),
                            .friction = new_values(w, contacts)};
  if (w->failed) return state;
  strut_path_evaluate(s, y); /* y is of the path: its value was not refused */
  memcpy(state.q, s->latest.q, length * sizeof *s->latest.q);
  for (size_t j = 0; j < members; j++) {
    bool cable = scene->members[j].kind == STRUT_CABLE; /* at a kink a rounding may push */
    state.force[j] = cable ? fmax(s->force[j].pose.force, 0.0) : s->force[j].pose.force;
    if (strut_element_of_member(&model->elements, (int32_t)j))
      state.force[j] += strut_path_element_tension(s, (int32_t)j);
  }
  strut_path_element_forces(s, STRUT_ELEMENT_HINGE, state.moment);
  strut_path_element_forces(s, STRUT_ELEMENT_DISTANCE, state.distance);
  strut_path_pressures(s, state.pressure);
  strut_path_reactions(s, state.reaction, state.contact, state.friction);
  return state;
}

void strut_path_add_point(strut_path_walk *w, int32_t negative) {
  strut_path *p = w->path;
  strut_path_keep_guides(w);
  void *items = p->points;
  strut_path_point point = {keep_state(w, w->y, w->arc), negative};
  if (w->failed || !reserve_items(w, &items, p->point_count, &w->point_room, sizeof *p->points))
    return;
  strut_path_keep_turns(&w->system);
  strut_path_keep_directions(&w->system);
  p->points = items;
  p->points[p->point_count++] = point;
}

void strut_path_add_event(strut_path_walk *w, strut_path_event_kind kind, const double *y,
                          int32_t index, int32_t before, int32_t after, const char *detail) {
  strut_path *p = w->path;
  void *items = p->events;
  detail = strut_arena_text(&p->arena, detail, strlen(detail));
  if (!detail) w->failed = true;
  if (w->failed) return;
  strut_path_event event = {keep_state(w, y, w->arc + strut_path_distance(w, w->y, y)),
                            kind,
                            index,
                            before,
                            after,
                            detail};
  if (w->failed || !reserve_items(w, &items, p->event_count, &w->event_room, sizeof *p->events))
    return;
  p->events = items;
  size_t at = p->event_count++; /* in the order of the path */
  for (; at > 0 && p->events[at - 1].at.arc > event.at.arc; at--) p->events[at] = p->events[at - 1];
  p->events[at] = event;
}

/* Predictor, corrector, and the events between them. */

enum { ROUNDS = 4, MOST_BENDS = 1000 };

static const double LONGEST = 0.05;          /* step [units of y] */
static const double SHORT = 1e-3;            /* from here on steps grow slowly */
static const double SHORTEST_CHECKED = 1e-5; /* likewise, for jumps between branches */
static const double LONGEST_HELD =
    0.02; /* where the curve is a reaction, which bends as it likes */
static const double BOUND = 1e3, DEEP = -10; /* sizes away; ranges the other way */
/* Relative to the size: a cable whose length equals its rest length along the path, up to rounding. */
static const double HANGING = 1e-15;
static const double CLOSE = 1e-6;  /* of the range: a value refused so near ends the path */
static const double NEARBY = 1e-6; /* largest correction of the start */

double strut_path_dot(const strut_path_walk *w, const double *a, const double *b) {
  double sum = 0;
  for (int32_t i = 0; i <= w->system.n; i++) sum += a[i] * b[i];
  return sum;
}

/* Do the nodes of a member pass beside one another, so that it turns fast, but does not shrink to nothing? */
static bool is_passing_by(strut_path_walk *w, int32_t which, double place) {
  strut_path_system *s = &w->system;
  if (place < 0 || !strut_path_turns_round(s, which) || !strut_path_evaluate(s, w->spare))
    return false;
  return fabs(s->force[which].pose.strain) > STRUT_PATH_EVEN * s->size;
}

/*
 * The first switch that the piece throws: its place, and the point in w->trial; -1: none. *strayed: a search has left
 * the path, as where the piece is a jump onto another branch.
 */
static double first_switch(strut_path_walk *w, const strut_path_piece *piece, int32_t *which,
                           bool *strayed) {
  strut_path_system *s = &w->system;
  double first = -1;
  *which = -1, *strayed = false;
  for (int32_t k = 0; k < strut_path_switch_count(s); k++) {
    bool on = strut_path_switch_is_on(s, k);
    double value = strut_path_measure_switch(s, piece->to, piece, k);
    if (!isfinite(value) || (on ? value >= 0 : value <= 0)) continue;
    if (fabs(value) <= HANGING * s->size) continue;
    double place = strut_path_locate(s, piece, strut_path_measure_switch, k, w->spare);
    *strayed = *strayed || s->strayed || is_passing_by(w, k, place);
    if (place < 0) { /* it should have been thrown where the piece begins */
      place = 0;
      memcpy(w->spare, piece->from, strut_path_bytes(w));
    }
    if (first >= 0 && place >= first) continue;
    first = place, *which = k;
    memcpy(w->trial, w->spare, strut_path_bytes(w));
  }
  return first;
}

void strut_path_count_negative(strut_path_walk *w) {
  strut_path_spectrum(&w->system, w->y,
                      STRUT_PATH_SIGNS); /* y is of the path: its value was not refused */
  w->negative = w->system.spectrum.negative;
  for (int32_t i = 0; i < w->system.n; i++) w->values[i] = w->system.spectrum.value[i];
}

/* Ends the path exactly at the requested value if this piece passes it. */
static bool land_on_end(strut_path_walk *w) {
  strut_path_system *s = &w->system;
  double from = w->y[s->n], to = w->next[s->n];
  if (!(from < 1 && to >= 1)) return false;
  double share = (1 - from) / (to - from);
  for (int32_t i = 0; i < 2 * (s->n + 1); i++)
    w->trial[i] = w->y[i] + share * (w->next[i] - w->y[i]);
  if (strut_path_correct(s, w->upward, 1.0, w->trial) < 0) return false;
  w->trial[s->n] = 1.0, w->trial[2 * s->n + 1] = 0.0;
  memcpy(w->next, w->trial, strut_path_bytes(w));
  return true;
}

/* How far the coordinate at which the path stops is from there. */
static double measure_stop(strut_path_system *s, const double *y, const strut_path_piece *piece,
                           int32_t which) {
  (void)piece, (void)which;
  if (!strut_path_evaluate(s, y)) return (double)NAN;
  return s->latest.q[s->parameter.options->stop.coordinate] - s->stop_at;
}

/* Ends the piece where the path is to stop, if it passes that. */
static bool land_on_stop(strut_path_walk *w, const strut_path_piece *piece) {
  strut_path_system *s = &w->system;
  const strut_path_stop *stop = &s->parameter.options->stop;
  if (!stop->given) return false;
  double from = measure_stop(s, piece->from, piece, 0), to = measure_stop(s, piece->to, piece, 0);
  if (!(from * to <= 0.0) || from == 0.0) return false;
  if (strut_path_locate(s, piece, measure_stop, 0, w->trial) < 0) return false;
  memcpy(w->next, w->trial, strut_path_bytes(w));
  if (!strut_path_tangent(s, w->next, w->tangent, w->next_tangent))
    memcpy(w->next_tangent, w->tangent, strut_path_bytes(w));
  return true;
}

static bool is_away(const strut_path_walk *w) {
  const strut_path_system *s = &w->system;
  const double *start = w->path->points[0].at.q;
  double most = 0;
  for (int32_t i = 0; i < s->n; i++)
    most = fmax(most, fabs(w->y[i] - start[s->potential->coordinate[i]] / s->size));
  return most > BOUND || w->y[w->system.n] < DEEP;
}

/* Why no step succeeds: the scene is invalid there, or no equilibrium is nearby. */
static strut_path_end find_reason(strut_path_walk *w) {
  const strut_path_parameter *p = &w->system.parameter;
  double here = strut_path_value(&w->system, w->y);
  if (p->refusal.status == STRUT_NO_MEMORY) w->failed = true;
  if (p->refusal.status == STRUT_OK || fabs(p->refused_at - here) > CLOSE * fabs(p->range))
    return STRUT_PATH_LOST;
  return STRUT_PATH_INVALID;
}

/* A segment that is shorter than this part of the structure has lost its direction. */
static const double VANISHED = 1e-4;

/* Says which member, or which segment of a running cable, has shrunk to nothing where no step succeeds. */
static void name_vanished(strut_path_walk *w, char *text, size_t room) {
  const strut_scene *scene = w->system.model->scene;
  *text = '\0';
  if (!strut_path_evaluate(&w->system, w->y)) return;
  const double *q = w->system.latest.q;
  for (size_t i = 0; i < scene->member_count; i++) {
    const strut_member *m = &scene->members[i];
    for (size_t k = 0; k < m->guide_count + 1; k++) {
      int32_t a = strut_member_node(m, k), b = strut_member_node(m, k + 1);
      double length = hypot(q[2 * b] - q[2 * a], q[2 * b + 1] - q[2 * a + 1]);
      if (!(length < VANISHED * w->system.size)) continue;
      snprintf(text, room, "; %s '%s' has shrunk to nothing there, between nodes '%s' and '%s'",
               m->guide_count ? "a segment of cable" : "member", m->name, scene->nodes[a].name,
               scene->nodes[b].name);
      return;
    }
  }
}

static bool end_path(strut_path_walk *w, strut_path_end end) {
  char cause[400] = "";
  if (end == STRUT_PATH_LOST) name_vanished(w, cause, sizeof cause);
  const strut_path_parameter *p = &w->system.parameter;
  size_t room = sizeof w->path->remark;
  double value = strut_path_value(&w->system, w->y);
  const char *unit = w->path->unit, *gap = *unit ? " " : "";
  w->path->end = end;
  if (end == STRUT_PATH_LOST)
    snprintf(w->path->remark, room,
             "the path ends at %s %.6g%s%s: no equilibrium was found nearby beyond it%s",
             strut_path_subject(w), value, gap, unit, cause);
  if (end == STRUT_PATH_AWAY)
    snprintf(w->path->remark, room,
             "followed to %s %.6g%s%s: beyond, the structure moves away without end",
             strut_path_subject(w), value, gap, unit);
  if (end == STRUT_PATH_INVALID)
    snprintf(w->path->remark, room, "the path ends at %s %.6g%s%s: beyond, at %.6g%s%s, %s",
             strut_path_subject(w), value, gap, unit, p->refused_at, gap, unit, p->refusal.message);
  return false;
}

static bool pass_switch(strut_path_walk *w, int32_t which, const double *beyond) {
  const strut_path_system *s = &w->system;
  if (strut_path_turns_round(s, which)) return strut_path_pass_zero_length(w, which);
  if (which < strut_path_first_corner_switch(s) || which >= strut_path_first_element_switch(s))
    return strut_path_pass_kink(w, which, beyond);
  return which < strut_path_first_grip_switch(s) ? strut_path_pass_corner(w, which)
                                                 : strut_path_pass_grip(w, which, beyond);
}

/* From w->fork, where the path ends, along another one. */
static bool go_on_along(strut_path_walk *w, const strut_path_ray *way) {
  w->bends = 0;
  w->arc += strut_path_distance(w, w->fork, w->y);
  memcpy(w->y, w->fork, strut_path_bytes(w));
  w->negative = way->negative;
  strut_path_add_point(w, w->negative);
  memcpy(w->next, way->y, strut_path_bytes(w));
  bool landed = land_on_end(w);
  w->step = strut_path_distance(w, w->next, w->y);
  w->arc += w->step;
  memcpy(w->y, w->next, strut_path_bytes(w));
  if (w->failed || !strut_path_tangent(&w->system, w->y, way->direction, w->tangent))
    return end_path(w, STRUT_PATH_LOST);
  strut_path_count_negative(w);
  strut_path_add_point(w, w->negative);
  if (landed) w->path->end = STRUT_PATH_UNTIL;
  return !landed && !w->failed;
}

/* Ends the piece where a switch is thrown and continues from there. */
static bool end_at_switch(strut_path_walk *w, strut_path_piece *piece, int32_t which,
                          double *beyond) {
  memcpy(beyond, w->next, strut_path_bytes(w));
  memcpy(w->next, w->trial, strut_path_bytes(w));
  if (!strut_path_tangent(&w->system, w->next, w->tangent, w->next_tangent))
    memcpy(w->next_tangent, w->tangent, strut_path_bytes(w));
  strut_path_ray way;
  if (strut_path_find_criticals(w, piece, &way)) return go_on_along(w, &way);
  w->arc += strut_path_distance(w, w->next, w->y);
  memcpy(w->y, w->next, strut_path_bytes(w));
  memcpy(w->tangent, w->next_tangent, strut_path_bytes(w));
  int32_t negative = w->negative;
  bool on = pass_switch(w, which, beyond);
  double since = w->arc - w->path->points[w->path->point_count - 1].at.arc;
  if (!on && strut_path_turns_round(&w->system, which)) return end_path(w, STRUT_PATH_LOST);
  bool bends = on && negative == w->negative && strut_path_is_bend(&w->system, which);
  if (bends && since < w->step && ++w->bends < MOST_BENDS) return true;
  strut_path_add_point(w, w->negative);
  w->bends = 0;
  return on || end_path(w, STRUT_PATH_LOST);
}

/* A step, or a part of it up to a kink. */
static bool take_step(strut_path_walk *w) {
  strut_path_piece piece = {w->y, w->tangent, w->next, 0};
  int32_t which;
  bool landed, stopped, strayed;
  double place;
  do {
    if (!strut_path_find_next(w)) return end_path(w, find_reason(w));
    piece.length = strut_path_dot(w, w->tangent, w->next) - strut_path_dot(w, w->tangent, w->y);
    landed = land_on_end(w), stopped = land_on_stop(w, &piece);
    if (landed || stopped)
      piece.length = strut_path_dot(w, w->tangent, w->next) - strut_path_dot(w, w->tangent, w->y);
    place = first_switch(w, &piece, &which, &strayed);
    strayed = strayed && w->step > SHORTEST_CHECKED;
    if (strayed) w->step *= 0.25;
  } while (strayed && !w->failed);
  if (which >= 0) {
    piece.length = place;
    double *beyond = strut_allocate(1, strut_path_bytes(w));
    w->failed = w->failed || !beyond;
    bool on = beyond && end_at_switch(w, &piece, which, beyond);
    strut_release(beyond);
    return on && !w->failed;
  }
  w->bends = 0;
  strut_path_ray way;
  if (strut_path_find_criticals(w, &piece, &way)) return go_on_along(w, &way);
  w->arc += strut_path_distance(w, w->next, w->y);
  memcpy(w->y, w->next, strut_path_bytes(w));
  memcpy(w->tangent, w->next_tangent, strut_path_bytes(w));
  strut_path_add_point(w, w->negative);
  if (w->failed) return false;
  if (landed || stopped) {
    w->path->end = stopped ? STRUT_PATH_STOP : STRUT_PATH_UNTIL;
    return false;
  }
  if (is_away(w)) return end_path(w, STRUT_PATH_AWAY);
  w->step = fmin((w->step < SHORT ? 4.0 : 1.4) * w->step,
                 w->path->coordinate >= 0 ? LONGEST_HELD : LONGEST);
  return true;
}

bool strut_path_walk_step(strut_path_walk *w) {
  bool on = take_step(w);
  while (on && w->bends) on = take_step(w);
  return on;
}

/*
 * The tangent at the start: with growing load; if only the load moves the structure, so that it
 * does work.
 */
static bool first_tangent(strut_path_walk *w) {
  strut_path_system *s = &w->system;
  if (strut_path_tangent(s, w->y, w->upward, w->tangent)) return true;
  for (int32_t i = 0; i < s->n; i++) w->trial[i] = -s->latest.slope[i];
  w->trial[s->n] = 0;
  return strut_path_tangent(s, w->y, w->trial, w->tangent);
}

/* Corrects the start to all digits: the descent that found y used doubles. */
static void sharpen_start(strut_path_walk *w) {
  memcpy(w->next, w->y, strut_path_bytes(w));
  if (strut_path_correct(&w->system, w->upward, 0.0, w->next) < 0) return;
  if (strut_path_distance(w, w->next, w->y) > NEARBY) return;
  memcpy(w->y, w->next, strut_path_bytes(w));
  w->y[w->system.n] = w->y[2 * w->system.n + 1] = 0;
}

/* A contact that slides at once with another coefficient does so in a first step, which jumps. */
static bool is_about_to_drop(const strut_path_system *s, int32_t which) {
  int32_t grip = which - strut_path_first_grip_switch(s);
  return grip >= 0 && which < strut_path_first_element_switch(s) &&
         strut_path_friction_drops(s, grip);
}

bool strut_path_walk_begin(strut_path_walk *w) {
  strut_path_system *s = &w->system;
  const double h = 1e-6;
  if (strut_path_evaluate(s, w->y)) strut_path_find_pieces(s);
  s->lends = true;
  for (int32_t k = 0; k < strut_path_switch_count(s); k++) {
    double value = strut_path_switch_value(s, k, w->y);
    if (isfinite(value)) strut_path_switch_set(s, k, value > -STRUT_PATH_EVEN * s->size);
  }
  if (strut_path_evaluate(s, w->y)) strut_path_friction_begin(s);
  sharpen_start(w);
  for (int round = 0; round < ROUNDS; round++) { /* switches at zero follow the path */
    bool changed = false;
    if (!first_tangent(w)) continue;
    memcpy(w->next, w->y, strut_path_bytes(w));
    for (int32_t i = 0; i <= s->n; i++) w->next[i] += h * w->tangent[i];
    for (int32_t k = 0; k < strut_path_switch_count(s); k++) {
      double here = strut_path_switch_value(s, k, w->y);
      if (!isfinite(here) || fabs(here) > STRUT_PATH_EVEN * s->size) continue;
      if (is_about_to_drop(s, k)) continue;
      bool on = strut_path_switch_value(s, k, w->next) >= here;
      changed = changed || on != strut_path_switch_is_on(s, k);
      strut_path_switch_set(s, k, on);
    }
    if (!changed) break;
  }
  if (!first_tangent(w) || s->drifts) return end_path(w, STRUT_PATH_LOST);
  strut_path_count_negative(w);
  strut_path_add_point(w, w->negative);
  const strut_path_stop *stop = &s->parameter.options->stop;
  if (!w->failed && stop->given)
    s->stop_at = w->path->points[0].at.q[stop->coordinate] + stop->displacement;
  return !w->failed;
}

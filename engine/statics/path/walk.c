/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/statics/path/path_parts.h"

/* Points and events are kept with positions and all forces. */

double strut_path_distance(const strut_path_walk *walk, const double *first, const double *second) {
  double sum = 0;
  for (int32_t i = 0; i <= walk->system.n; i++)
    sum += (first[i] - second[i]) * (first[i] - second[i]);
  return sqrt(sum);
}

static double *new_values(strut_path_walk *walk, size_t count) {
  double *values = strut_arena_allocate(&walk->path->arena, count, sizeof *values);
  if (!values) walk->failed = true;
  return values;
}

/* Adds forces of elements to those of members; moments of hinges [N m], forces of distances [N], pressures [N/m]. */
static void find_element_forces(const strut_path_system *system, strut_path_state *state) {
  for (int32_t i = 0; i < system->model->elements.count; i++) {
    const strut_element *element = &system->model->elements.element[i];
    double force = strut_path_element_force(system, i)->pose.force;
    double outside = system->equations.terms.laws->elements.element[i].numbers.outside;
    if (element->role == STRUT_ELEMENT_HINGE)
      state->moment[element->item] = force + 0.0; /* no -0 */
    if (element->role == STRUT_ELEMENT_DISTANCE) state->distance[element->item] = force + 0.0;
    if (element->role == STRUT_ELEMENT_CELL) state->pressure[element->item] = outside - force;
    if (!strut_element_is_of_member(element)) continue;
    if (element->carries)
      force = element->carries * fmax(element->carries * force, 0.0); /* rounding */
    state->force[element->item] += force;
  }
}

/* After strut_path_evaluate: reactions (length), normal forces and friction of contacts. */
static void find_reactions(const strut_path_system *system, double *reaction, double *contact,
                           double *friction) {
  for (int32_t at = 0; at < system->model->length; at++)
    reaction[at] = -system->equations.terms.force[at];
  for (int32_t i = 0; i < strut_force_count(system->model, false); i++) {
    const strut_force *force = &system->force[i];
    bool element = force->kind == STRUT_FORCE_ELEMENT;
    bool rubs = element && force->pose.acts && strut_path_rubs(system, force->index);
    if (rubs) strut_path_rubbing_reactions(system, force->index, reaction);
    for (int32_t k = 0; k < 2 * force->nodes && !rubs; k++)
      reaction[strut_force_coordinate(force, k)] += force->pose.force * force->pose.b[k];
  }
  strut_path_contact_reactions(system, reaction, contact, friction);
  for (int32_t at = 0; at < system->model->length; at++)
    reaction[at] = at < 2 * system->model->node_count && system->potential->row_of[at] < 0
                       ? 0.0 + reaction[at]
                       : 0.0;
}

/* What the path is at y, `arc` from its beginning; w->failed: out of memory. */
static strut_path_state keep_state(strut_path_walk *walk, const double *unknowns, double arc) {
  strut_path_system *system = &walk->system;
  const strut_model *model = system->model;
  const strut_scene *scene = model->scene;
  size_t length = (size_t)model->length, members = (size_t)model->members.count;
  size_t contacts = (size_t)model->contacts.count;
  strut_path_state state = {.factor = strut_path_value(system, unknowns),
                            .arc = arc,
                            .q = new_values(walk, length),
                            .force = new_values(walk, members),
                            .moment = new_values(walk, scene->hinge_count),
                            .pressure = new_values(walk, scene->cell_count),
                            .distance = new_values(walk, scene->distance_count),
                            .reaction = new_values(walk, length),
                            .contact = new_values(walk, contacts),
                            .friction = new_values(walk, contacts)};
  if (walk->failed) return state;
  strut_path_evaluate(system, unknowns); /* y is of the path: its value was not refused */
  memcpy(state.q, system->latest.q, length * sizeof *system->latest.q);
  for (size_t j = 0; j < members; j++) {
    bool cable = scene->members[j].kind == STRUT_CABLE; /* at a kink a rounding may push */
    state.force[j] = cable ? fmax(system->force[j].pose.force, 0.0) : system->force[j].pose.force;
  }
  find_element_forces(system, &state);
  find_reactions(system, state.reaction, state.contact, state.friction);
  return state;
}

/* Angles are taken near those of the last evaluation from now on. */
static void keep_turns(strut_path_system *system) {
  for (int32_t i = 0; i < system->model->elements.count; i++)
    system->elements.element[i].turn = strut_path_element_force(system, i)->pose.strain;
}

static void keep_directions(strut_path_system *system) {
  for (int32_t j = 0; j < system->model->members.count; j++)
    memcpy(&system->latest.ahead[2 * j], &system->force[j].pose.b[2], 2 * sizeof(double));
}

void strut_path_add_point(strut_path_walk *walk, int32_t negative) {
  strut_path *path = walk->path;
  strut_path_keep_guides(walk);
  strut_path_point point = {keep_state(walk, walk->y, walk->arc), negative};
  walk->failed = walk->failed || !strut_grow(&path->points, &walk->point_room, path->point_count,
                                             sizeof *path->points);
  if (walk->failed) return;
  keep_turns(&walk->system);
  keep_directions(&walk->system);
  path->points[path->point_count++] = point;
}

void strut_path_add_event(strut_path_walk *walk, strut_path_event_kind kind, const double *unknowns,
                          int32_t index, int32_t before, int32_t after, const char *detail) {
  strut_path *path = walk->path;
  detail = strut_arena_text(&path->arena, detail, strlen(detail));
  if (!detail) walk->failed = true;
  if (walk->failed) return;
  strut_path_event event = {
      keep_state(walk, unknowns, walk->arc + strut_path_distance(walk, walk->y, unknowns)),
      kind,
      index,
      before,
      after,
      detail};
  walk->failed = walk->failed || !strut_grow(&path->events, &walk->event_room, path->event_count,
                                             sizeof *path->events);
  if (walk->failed) return;
  size_t at = path->event_count++; /* in the order of the path */
  for (; at > 0 && path->events[at - 1].at.arc > event.at.arc; at--)
    path->events[at] = path->events[at - 1];
  path->events[at] = event;
}

/* Predictor, corrector, and the events between them. */

enum { ROUNDS = 4, MOST_BENDS = 1000 };

static const double LONGEST = 0.05;          /* step [units of y] */
static const double SHORT = 1e-3;            /* from here on steps grow slowly */
static const double SHORTEST_CHECKED = 1e-5; /* likewise, for jumps between branches */
static const double LONGEST_HELD = 0.02;     /* where the curve is a reaction */
static const double BOUND = 1e3, DEEP = -10; /* sizes away; ranges the other way */
/* Relative to the size: a cable whose length equals its rest length along the path, up to rounding. */
static const double HANGING = 1e-15;
static const double CLOSE = 1e-6;  /* of the range: a value refused so near ends the path */
static const double NEARBY = 1e-6; /* largest correction of the start */
static const double SAME = 1e-5;   /* [units of y] an event so near an end is that end */
static const double ALONG = 0.9;   /* cosine of tangents of one way through a point */

double strut_path_dot(const strut_path_walk *walk, const double *first, const double *second) {
  double sum = 0;
  for (int32_t i = 0; i <= walk->system.n; i++) sum += first[i] * second[i];
  return sum;
}

/* Do the nodes of a member pass beside one another, so that it turns fast, but does not shrink to nothing? */
static bool is_passing_by(strut_path_walk *walk, int32_t which, double place) {
  strut_path_system *system = &walk->system;
  if (place < 0 || !strut_path_turns_round(system, which) ||
      !strut_path_evaluate(system, walk->spare))
    return false;
  return fabs(system->force[which].pose.strain) > STRUT_PATH_EVEN * system->size;
}

/*
 * The first switch that the piece throws: its place, and the point in w->trial; -1: none. *strayed: a search has left
 * the path, as where the piece is a jump onto another branch.
 */
static double first_switch(strut_path_walk *walk, const strut_path_piece *piece, int32_t *which,
                           bool *strayed) {
  strut_path_system *system = &walk->system;
  double first = -1;
  *which = -1, *strayed = false;
  for (int32_t k = 0; k < strut_path_switch_count(system); k++) {
    bool on = strut_path_switch_is_on(system, k);
    double value = strut_path_measure_switch(system, piece->to, piece, k);
    if (!isfinite(value) || (on ? value >= 0 : value <= 0)) continue;
    if (fabs(value) <= HANGING * system->size) continue;
    double place = strut_path_locate(system, piece, strut_path_measure_switch, k, walk->spare);
    *strayed = *strayed || system->strayed || is_passing_by(walk, k, place);
    if (place < 0) { /* it should have been thrown where the piece begins */
      place = 0;
      memcpy(walk->spare, piece->from, strut_path_bytes(walk));
    }
    if (first >= 0 && place >= first) continue;
    first = place, *which = k;
    memcpy(walk->trial, walk->spare, strut_path_bytes(walk));
  }
  return first;
}

void strut_path_count_negative(strut_path_walk *walk) {
  strut_path_spectrum(&walk->system, walk->y); /* y is of the path: its value was not refused */
  walk->negative = walk->system.spectrum.negative;
  walk->earlier = 0.0;
  strut_path_keep_values(walk);
}

/* From the present point. */
static strut_path_piece piece_to(const strut_path_walk *walk, const double *to) {
  const double *row = walk->tangent;
  return (strut_path_piece){walk->y, row, to,
                            strut_path_dot(walk, row, to) - strut_path_dot(walk, row, walk->y)};
}

/* The piece ends in w->trial. */
static void cut_piece(strut_path_walk *walk) {
  memcpy(walk->next, walk->trial, strut_path_bytes(walk));
  if (!strut_path_tangent(&walk->system, walk->next, walk->tangent, walk->next_tangent))
    memcpy(walk->next_tangent, walk->tangent, strut_path_bytes(walk));
}

/* How far the parameter is from where the path ends [ranges]. */
static double measure_end(strut_path_system *system, const double *unknowns,
                          const strut_path_piece *piece, int32_t which) {
  (void)piece, (void)which;
  return (unknowns[system->n] - 1.0) + unknowns[2 * system->n + 1];
}

/*
 * Ends the path exactly at the requested value if this piece passes it, on its way to a limit point between its ends,
 * too. To a hair below the limit the stiffness is singular but for rounding, and the search along the path finds it.
 */
static bool land_on_end(strut_path_walk *walk) {
  int32_t n = walk->system.n;
  strut_path_piece piece = piece_to(walk, walk->next);
  if (!(walk->y[n] < 1)) return false;
  if (walk->next[n] < 1) {
    if (!strut_path_turns_back(walk) || walk->tangent[n] < 0 || !(piece.length > 0) ||
        strut_path_locate(&walk->system, &piece, strut_path_measure_turn, 0, walk->fork) < 0 ||
        walk->system.strayed || !(measure_end(&walk->system, walk->fork, &piece, 0) >= 0))
      return false;
    piece = piece_to(walk, walk->fork);
  }
  double share = (1 - walk->y[n]) / (piece.to[n] - walk->y[n]);
  for (int32_t i = 0; i < 2 * (n + 1); i++)
    walk->trial[i] = walk->y[i] + share * (piece.to[i] - walk->y[i]);
  if ((piece.to == walk->fork ||
       strut_path_correct(&walk->system, walk->upward, 1.0, walk->trial) < 0) &&
      (!(piece.length > 0) ||
       strut_path_locate(&walk->system, &piece, measure_end, 0, walk->trial) < 0))
    return false;
  walk->trial[n] = 1.0, walk->trial[2 * n + 1] = 0.0;
  memcpy(walk->next, walk->trial, strut_path_bytes(walk));
  return true;
}

/* How far the coordinate at which the path stops is from there. */
static double measure_stop(strut_path_system *system, const double *unknowns,
                           const strut_path_piece *piece, int32_t which) {
  (void)piece, (void)which;
  if (!strut_path_evaluate(system, unknowns)) return (double)NAN;
  return system->latest.q[system->parameter.options->stop.coordinate] - system->stop_at;
}

/* Ends the piece where the path is to stop, if it passes that. */
static bool land_on_stop(strut_path_walk *walk, const strut_path_piece *piece) {
  strut_path_system *system = &walk->system;
  const strut_path_stop *stop = &system->parameter.options->stop;
  if (!stop->given) return false;
  double from = measure_stop(system, piece->from, piece, 0),
         to = measure_stop(system, piece->to, piece, 0);
  if (!(from * to <= 0.0) || from == 0.0) return false;
  if (strut_path_locate(system, piece, measure_stop, 0, walk->trial) < 0) return false;
  cut_piece(walk);
  return true;
}

static bool is_away(const strut_path_walk *walk) {
  const strut_path_system *system = &walk->system;
  const double *start = walk->path->points[0].at.q;
  double most = 0;
  for (int32_t i = 0; i < system->n; i++)
    most = fmax(most, fabs(walk->y[i] - start[system->potential->coordinate[i]] / system->size));
  return most > BOUND || walk->y[walk->system.n] < DEEP;
}

/* Why no step succeeds: the scene is invalid there, or no equilibrium is nearby. */
static strut_path_end find_reason(strut_path_walk *walk) {
  const strut_path_parameter *parameter = &walk->system.parameter;
  double here = strut_path_value(&walk->system, walk->y);
  if (parameter->refusal.status == STRUT_NO_MEMORY) walk->failed = true;
  if (parameter->refusal.status == STRUT_OK ||
      fabs(parameter->refused_at - here) > CLOSE * fabs(parameter->range))
    return STRUT_PATH_LOST;
  return STRUT_PATH_INVALID;
}

/* A segment that is shorter than this part of the structure has lost its direction. */
static const double VANISHED = 1e-4;

/* Says which member, or which segment of a running cable, has shrunk to nothing where no step succeeds. */
static void name_vanished(strut_path_walk *walk, char *text, size_t room) {
  const strut_scene *scene = walk->system.model->scene;
  *text = '\0';
  if (!strut_path_evaluate(&walk->system, walk->y)) return;
  const double *q = walk->system.latest.q;
  for (size_t i = 0; i < scene->member_count; i++) {
    const strut_member *member = &scene->members[i];
    for (size_t k = 0; k < member->guide_count + 1; k++) {
      int32_t a = strut_member_node(member, k), b = strut_member_node(member, k + 1);
      double length = hypot(q[2 * b] - q[2 * a], q[2 * b + 1] - q[2 * a + 1]);
      if (!(length < VANISHED * walk->system.size)) continue;
      snprintf(text, room, "; %s '%s' has shrunk to nothing there, between nodes '%s' and '%s'",
               member->guide_count ? "a segment of cable" : "member", member->name,
               scene->nodes[a].name, scene->nodes[b].name);
      return;
    }
  }
}

static bool end_path(strut_path_walk *walk, strut_path_end end) {
  char cause[400] = "";
  if (end == STRUT_PATH_LOST) name_vanished(walk, cause, sizeof cause);
  const strut_path_parameter *parameter = &walk->system.parameter;
  size_t room = sizeof walk->path->remark;
  char at[STRUT_PATH_TEXT];
  const char *unit = walk->path->unit;
  strut_path_at(walk, strut_path_value(&walk->system, walk->y), at);
  walk->path->end = end;
  if (end == STRUT_PATH_LOST)
    snprintf(walk->path->remark, room,
             "the path ends at %s: no equilibrium was found nearby beyond it%s", at, cause);
  if (end == STRUT_PATH_AWAY)
    snprintf(walk->path->remark, room,
             "followed to %s: beyond, the structure moves away without end", at);
  if (end == STRUT_PATH_INVALID)
    snprintf(walk->path->remark, room, "the path ends at %s: beyond, at %.6g%s%s, %s", at,
             parameter->refused_at, *unit ? " " : "", unit, parameter->refusal.message);
  return false;
}

static bool pass_switch(strut_path_walk *walk, int32_t which, const double *beyond) {
  const strut_path_switch own = strut_path_switch_at(&walk->system, which);
  if (strut_path_turns_round(&walk->system, which)) return strut_path_pass_zero_length(walk, which);
  if (own.of == STRUT_PATH_FACET) return strut_path_pass_corner(walk, own.index);
  return own.of == STRUT_PATH_GRIP ? strut_path_pass_grip(walk, which, beyond)
                                   : strut_path_pass_kink(walk, which, beyond);
}

/* From w->fork, where the path ends, along another one. */
static bool go_on_along(strut_path_walk *walk, const strut_path_ray *way) {
  walk->bends = 0;
  walk->arc += strut_path_distance(walk, walk->fork, walk->y);
  memcpy(walk->y, walk->fork, strut_path_bytes(walk));
  walk->negative = way->negative;
  strut_path_add_point(walk, walk->negative);
  memcpy(walk->next, way->y, strut_path_bytes(walk));
  bool landed = land_on_end(walk);
  walk->step = strut_path_distance(walk, walk->next, walk->y);
  walk->arc += walk->step;
  memcpy(walk->y, walk->next, strut_path_bytes(walk));
  if (walk->failed || !strut_path_tangent(&walk->system, walk->y, way->direction, walk->tangent))
    return end_path(walk, STRUT_PATH_LOST);
  strut_path_count_negative(walk);
  strut_path_add_point(walk, walk->negative);
  if (landed) walk->path->end = STRUT_PATH_UNTIL;
  return !landed && !walk->failed;
}

/* To the next point. */
static void advance(strut_path_walk *walk) {
  walk->arc += strut_path_distance(walk, walk->next, walk->y);
  memcpy(walk->y, walk->next, strut_path_bytes(walk));
  memcpy(walk->tangent, walk->next_tangent, strut_path_bytes(walk));
}

/*
 * A mechanism that is stretched out turns the parameter back, but tension may lead on. At an ordinary limit point no
 * motion was without stiffness where the step began.
 */
static bool leaves_at_turn(strut_path_walk *walk, const strut_path_piece *piece) {
  int32_t first;
  return strut_path_turns_back(walk) && piece->length > 0 &&
         strut_path_find_mechanisms(&walk->system, walk->y, &first) &&
         strut_path_locate(&walk->system, piece, strut_path_measure_turn, -1, walk->fork) >= 0 &&
         strut_path_leave_mechanism(walk, walk->fork, walk->tangent[walk->system.n]);
}

/* Throws a switch where the piece has ended, and continues from there. */
static bool leave_switch(strut_path_walk *walk, int32_t which) {
  int32_t negative = walk->negative;
  bool on = pass_switch(walk, which, walk->beyond);
  double since = walk->arc - walk->path->points[walk->path->point_count - 1].at.arc;
  if (!on && strut_path_turns_round(&walk->system, which)) return end_path(walk, STRUT_PATH_LOST);
  bool bends = on && negative == walk->negative && strut_path_is_bend(&walk->system, which);
  if (bends && since < walk->step && ++walk->bends < MOST_BENDS) return true;
  if (since > 0.0) strut_path_add_point(walk, walk->negative);
  walk->bends = 0;
  return on || strut_path_leave_mechanism(walk, walk->y, walk->tangent[walk->system.n]) ||
         end_path(walk, STRUT_PATH_LOST);
}

/* A step, or a part of it up to a kink. */
static bool take_step(strut_path_walk *walk) {
  strut_path_piece piece;
  strut_path_ray way;
  int32_t which;
  bool landed, stopped, strayed;
  double place;
  do {
    if (!strut_path_find_next(walk))
      return strut_path_leave_mechanism(walk, walk->y, walk->tangent[walk->system.n]) ||
             end_path(walk, find_reason(walk));
    piece = piece_to(walk, walk->next);
    landed = land_on_end(walk), stopped = land_on_stop(walk, &piece);
    piece = piece_to(walk, walk->next);
    place = first_switch(walk, &piece, &which, &strayed);
    strayed = strayed && walk->step > SHORTEST_CHECKED;
    if (strayed) walk->step *= 0.25;
  } while (strayed && !walk->failed);
  if (which >= 0) {
    piece.length = place;
    memcpy(walk->beyond, walk->next, strut_path_bytes(walk));
    cut_piece(walk);
  } else {
    walk->bends = 0;
  }
  if (leaves_at_turn(walk, &piece)) return !walk->failed;
  if (strut_path_find_criticals(walk, &piece, &way)) return go_on_along(walk, &way);
  advance(walk);
  if (which >= 0) return leave_switch(walk, which) && !walk->failed;
  strut_path_add_point(walk, walk->negative);
  if (walk->failed) return false;
  if (landed || stopped) {
    walk->path->end = stopped ? STRUT_PATH_STOP : STRUT_PATH_UNTIL;
    return false;
  }
  if (is_away(walk)) return end_path(walk, STRUT_PATH_AWAY);
  walk->step = fmin((walk->step < SHORT ? 4.0 : 1.4) * walk->step,
                    walk->path->coordinate >= 0 ? LONGEST_HELD : LONGEST);
  return true;
}

void strut_path_end_within(strut_path_walk *walk, const double *unknowns, strut_path_end end) {
  strut_path *path = walk->path;
  walk->arc = walk->last_arc + strut_path_distance(walk, walk->last, unknowns);
  while (path->point_count > 1 && path->points[path->point_count - 1].at.arc > walk->last_arc)
    path->point_count--;
  while (path->event_count > 0 && path->events[path->event_count - 1].at.arc > walk->arc - SAME)
    path->event_count--;
  memcpy(walk->y, unknowns, strut_path_bytes(walk));
  strut_path_add_point(walk, path->points[path->point_count - 1].negative);
  path->end = end;
}

/* Has the latest step led through the first point of the path, along the same tangent? */
static bool is_closed(strut_path_walk *walk) {
  strut_path_system *system = &walk->system;
  const double *row = walk->first_tangent;
  double place = strut_path_dot(walk, row, walk->first), step;
  double before = strut_path_dot(walk, row, walk->last) - place,
         after = strut_path_dot(walk, row, walk->y) - place;
  step = strut_path_distance(walk, walk->last, walk->y);
  if (walk->forks.path || system->parameter.options->friction || !(before < 0.0 && after >= 0.0) ||
      strut_path_distance(walk, walk->first, walk->y) > 2.0 * step ||
      strut_path_dot(walk, row, walk->tangent) < ALONG)
    return false;
  for (int32_t i = 0; i < 2 * (system->n + 1); i++)
    walk->trial[i] = walk->last[i] + before / (before - after) * (walk->y[i] - walk->last[i]);
  return strut_path_correct(system, row, place, walk->trial) >= 0 &&
         strut_path_distance(walk, walk->trial, walk->first) <= NEARBY;
}

bool strut_path_walk_step(strut_path_walk *walk) {
  memcpy(walk->last, walk->y, strut_path_bytes(walk));
  memcpy(walk->last_tangent, walk->tangent, strut_path_bytes(walk) / 2);
  walk->last_arc = walk->arc;
  bool on = take_step(walk);
  while (on && walk->bends) on = take_step(walk);
  if (!on || walk->failed || !is_closed(walk)) return on;
  strut_path_end_within(walk, walk->first, STRUT_PATH_CLOSED);
  char at[STRUT_PATH_TEXT];
  snprintf(walk->path->remark, sizeof walk->path->remark,
           "closed path: it comes back to its first point, at %s",
           strut_path_at(walk, strut_path_value(&walk->system, walk->first), at));
  return false;
}

/* The tangent at the start: with growing load; if it moves the structure in one way only, so that it does work. */
static bool first_tangent(strut_path_walk *walk) {
  strut_path_system *system = &walk->system;
  int32_t first;
  if (strut_path_tangent(system, walk->y, walk->upward, walk->tangent)) return true;
  if (strut_path_find_mechanisms(system, walk->y, &first) > 1) return false;
  for (int32_t i = 0; i < system->n; i++) walk->trial[i] = -system->latest.slope[i];
  walk->trial[system->n] = 0;
  return strut_path_tangent(system, walk->y, walk->trial, walk->tangent);
}

/* Corrects the start to all digits: the descent that found y used doubles. */
static bool sharpen_start(strut_path_walk *walk, double most) {
  double value = walk->y[walk->system.n];
  memcpy(walk->next, walk->y, strut_path_bytes(walk));
  if (strut_path_correct(&walk->system, walk->upward, value, walk->next) < 0) return false;
  if (strut_path_distance(walk, walk->next, walk->y) > most) return false;
  memcpy(walk->y, walk->next, strut_path_bytes(walk));
  walk->y[walk->system.n] = value, walk->y[2 * walk->system.n + 1] = 0;
  return true;
}

/* A contact that slides at once with another coefficient does so in a first step, which jumps. */
static bool is_about_to_drop(const strut_path_system *system, int32_t which) {
  const strut_path_switch own = strut_path_switch_at(system, which);
  return own.of == STRUT_PATH_GRIP && strut_path_friction_drops(system, own.index);
}

/* Pieces of laws that fold, at system->latest->q, as they follow from what the model remembers. */
static void find_pieces(strut_path_system *system) {
  const double *rest = system->equations.terms.rest;
  strut_element_pose pose;
  for (int32_t i = 0; i < system->model->elements.count; i++) {
    const strut_element *element = &system->model->elements.element[i];
    if (element->law != STRUT_LAW_FOLDING) continue;
    strut_element_evaluate(system->model, i, rest, system->latest.q,
                           system->elements.element[i].turn, &pose);
    system->elements.element[i].piece =
        strut_element_piece(element, rest, pose.strain - pose.natural);
  }
}

bool strut_path_set_out(strut_path_walk *walk, double most) {
  strut_path_system *system = &walk->system;
  const double h = 1e-6;
  system->lends = true;
  for (int32_t k = 0; k < strut_path_switch_count(system); k++) {
    double value = strut_path_switch_value(system, k, walk->y);
    if (isfinite(value)) strut_path_switch_set(system, k, value > -STRUT_PATH_EVEN * system->size);
  }
  if (strut_path_evaluate(system, walk->y)) strut_path_friction_begin(system);
  bool sharp = sharpen_start(walk, most);
  for (int round = 0; round < ROUNDS; round++) { /* switches at zero follow the path */
    bool changed = false;
    if (!first_tangent(walk)) continue;
    memcpy(walk->next, walk->y, strut_path_bytes(walk));
    for (int32_t i = 0; i <= system->n; i++) walk->next[i] += h * walk->tangent[i];
    for (int32_t k = 0; k < strut_path_switch_count(system); k++) {
      double here = strut_path_switch_value(system, k, walk->y);
      if (!isfinite(here) || fabs(here) > STRUT_PATH_EVEN * system->size) continue;
      if (is_about_to_drop(system, k)) continue;
      bool on = strut_path_switch_value(system, k, walk->next) >= here;
      changed = changed || on != strut_path_switch_is_on(system, k);
      strut_path_switch_set(system, k, on);
    }
    if (!changed) break;
  }
  return first_tangent(walk) && !system->drifts && sharp;
}

bool strut_path_walk_begin(strut_path_walk *walk) {
  strut_path_system *system = &walk->system;
  if (strut_path_evaluate(system, walk->y)) find_pieces(system);
  strut_path_set_out(walk, NEARBY);
  bool leads = first_tangent(walk) && !system->drifts, leapt = false;
  if (!system->drifts && !leads) leapt = strut_path_leave_mechanism(walk, walk->y, 1.0);
  if (!leads && !leapt) return end_path(walk, STRUT_PATH_LOST);
  strut_path_count_negative(walk);
  if (!leapt) strut_path_add_point(walk, walk->negative);
  memcpy(walk->first, walk->y, strut_path_bytes(walk));
  memcpy(walk->first_tangent, walk->tangent, strut_path_bytes(walk) / 2);
  const strut_path_stop *stop = &system->parameter.options->stop;
  if (!walk->failed && stop->given)
    system->stop_at = walk->path->points[0].at.q[stop->coordinate] + stop->displacement;
  return !walk->failed;
}

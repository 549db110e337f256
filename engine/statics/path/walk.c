/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Predictor, corrector, what happens in between, and on. See path_walk.h. */
#include "engine/statics/path/walk.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SLOW = 8, ROUNDS = 4 };

static const double LONGEST = 0.05, SHORTEST = 1e-9; /* steps [units of y] */
static const double BEND = 0.97;    /* cosine that tangents of neighbouring points keep */
static const double COUPLED = 1e-6; /* of the load: what a null vector feels at a limit point */
static const double EVEN = 1e-9;    /* of the size: switches that change together */
static const double BOUND = 1e3, DEEP = -10; /* sizes away; factors below */

static size_t bytes_of(const strut_path_walk *w) {
  return ((size_t)w->system.n + 1) * sizeof(double);
}

static double dot(const strut_path_walk *w, const double *a, const double *b) {
  double sum = 0;
  for (int32_t i = 0; i <= w->system.n; i++) sum += a[i] * b[i];
  return sum;
}

static double distance(const strut_path_walk *w, const double *a, const double *b) {
  double sum = 0;
  for (int32_t i = 0; i <= w->system.n; i++) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sqrt(sum);
}

/* Room for one more of `size` bytes at *items. */
static bool grow(strut_path_walk *w, void **items, size_t count, size_t *room, size_t size) {
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

static double *keep_positions(strut_path_walk *w, const double *y) {
  double *q = strut_arena_allocate(&w->path->arena, (size_t)w->system.model.length, sizeof *q);
  if (q) strut_path_place(&w->system, y, q);
  if (!q) w->failed = true;
  return q;
}

static void add_point(strut_path_walk *w, int32_t negative) {
  strut_path *p = w->path;
  double *q = keep_positions(w, w->y);
  void *items = p->points;
  if (!q || !grow(w, &items, p->point_count, &w->point_room, sizeof *p->points)) return;
  p->points = items;
  p->points[p->point_count++] = (strut_path_point){
      .factor = w->system.unit * w->y[w->system.n], .arc = w->arc, .negative = negative, .q = q};
}

static void add_event(strut_path_walk *w, strut_path_event_kind kind, const double *y,
                      int32_t index, const char *detail) {
  strut_path *p = w->path;
  void *items = p->events;
  double *q = keep_positions(w, y);
  detail = strut_arena_text(&p->arena, detail, strlen(detail));
  if (!detail) w->failed = true;
  if (w->failed || !grow(w, &items, p->event_count, &w->event_room, sizeof *p->events)) return;
  p->events = items;
  strut_path_event event = {.kind = kind,
                            .factor = w->system.unit * y[w->system.n],
                            .arc = w->arc + distance(w, w->y, y),
                            .index = index,
                            .detail = detail,
                            .q = q};
  size_t at = p->event_count++; /* in the order of the path */
  for (; at > 0 && p->events[at - 1].arc > event.arc; at--) p->events[at] = p->events[at - 1];
  p->events[at] = event;
}

/* The node that a vector over the free coordinates moves most. */
static int32_t most_moved(const strut_path_system *s, const gsl_vector *vector) {
  int32_t best = 0;
  double most = -1;
  for (int32_t i = 0; i < s->n; i++) {
    int32_t at = s->potential->coordinate[i];
    double moved = gsl_vector_get(vector, (size_t)i), square = moved * moved;
    if (i > 0 && s->potential->coordinate[i - 1] == at - 1 && at % 2 == 1) {
      double other = gsl_vector_get(vector, (size_t)(i - 1));
      square += other * other;
    }
    if (square > most * (1 + 1e-9)) most = square, best = at / 2;
  }
  return best;
}

/* The share of a unit vector that the load works on. */
static double coupling(const strut_path_system *s, const gsl_vector *vector) {
  double work = 0, load = 0;
  for (int32_t i = 0; i < s->n; i++) {
    double p = s->load[s->potential->coordinate[i]];
    work += p * gsl_vector_get(vector, (size_t)i), load += p * p;
  }
  return load > 0 ? fabs(work) / sqrt(load) : 0;
}

/* An eigenvalue has changed its sign on the piece: a limit point or a fork. */
static void find_critical(strut_path_walk *w, const strut_path_piece *piece, int32_t which,
                          double turn) {
  strut_path_system *s = &w->system;
  char detail[200];
  if (strut_path_locate(s, piece, strut_path_measure_eigenvalue, which, w->trial) < 0) return;
  strut_path_spectrum(s, w->trial, true);
  gsl_vector_const_view null = gsl_matrix_const_column(s->vectors, (size_t)which);
  int32_t node = most_moved(s, &null.vector);
  const char *name = s->model.scene->nodes[node].name;
  if (turn * w->tangent[s->n] < 0 && coupling(s, &null.vector) > COUPLED) {
    double at = strut_path_locate(s, piece, strut_path_measure_turn, 0, w->spare);
    snprintf(detail, sizeof detail, "the factor %s here; %s moves most",
             w->tangent[s->n] > 0 ? "can grow no further" : "grows again from", name);
    add_event(w, STRUT_PATH_LIMIT, at >= 0 ? w->spare : w->trial, node, detail);
  } else {
    snprintf(detail, sizeof detail, "another path branches off: %s moves most on it", name);
    add_event(w, STRUT_PATH_BIFURCATION, w->trial, node, detail);
  }
}

/* The first switch that the piece throws: its place, and the point in w->trial; -1: none. */
static double first_switch(strut_path_walk *w, const strut_path_piece *piece, int32_t *which) {
  strut_path_system *s = &w->system;
  double first = -1;
  *which = -1;
  for (int32_t k = 0; k < strut_path_switch_count(s); k++) {
    bool on = strut_path_switch_is_on(s, k);
    double value = strut_path_measure_switch(s, piece->to, piece, k);
    if (!isfinite(value) || (on ? value >= 0 : value <= 0)) continue;
    double place = strut_path_locate(s, piece, strut_path_measure_switch, k, w->spare);
    if (place < 0) { /* it should have been thrown where the piece begins */
      place = 0;
      memcpy(w->spare, piece->from, bytes_of(w));
    }
    if (first >= 0 && place >= first) continue;
    first = place, *which = k;
    memcpy(w->trial, w->spare, bytes_of(w));
  }
  return first;
}

static void report_switch(strut_path_walk *w, int32_t which, bool on) {
  const strut_scene *scene = w->system.model.scene;
  int32_t members = w->system.model.members.count;
  char detail[300];
  if (which < members) {
    snprintf(detail, sizeof detail, "%s %s", scene->members[which].name,
             on ? "begins to pull" : "goes slack");
    add_event(w, on ? STRUT_PATH_TAUT : STRUT_PATH_SLACK, w->y, which, detail);
    return;
  }
  int32_t node = w->system.model.contacts.entry[which - members].node;
  snprintf(detail, sizeof detail, "%s %s", scene->nodes[node].name,
           on ? "touches the ground" : "leaves the ground");
  add_event(w, on ? STRUT_PATH_TOUCHDOWN : STRUT_PATH_LIFT_OFF, w->y, node, detail);
}

/* Says of the last event what it does to the stability. */
static void amend_last(strut_path_walk *w, const char *words) {
  strut_path_event *event = &w->path->events[w->path->event_count - 1];
  char *text = strut_arena_format(&w->path->arena, "%s%s", event->detail, words);
  if (text)
    event->detail = text;
  else
    w->failed = true;
}

static void count_negative(strut_path_walk *w) {
  strut_path_spectrum(&w->system, w->y, false);
  w->negative = strut_path_negative(&w->system);
}

/*
 * Throws the switch `which` at y, and those that stand at zero there and `end`, beyond, has thrown
 * too. The new tangent goes on into the side it was thrown to.
 */
static bool throw_switch(strut_path_walk *w, int32_t which, const double *end) {
  strut_path_system *s = &w->system;
  double turn = w->tangent[s->n], along = 0;
  int32_t before = w->negative;
  for (int32_t k = 0; k < strut_path_switch_count(s); k++) {
    bool on = strut_path_switch_is_on(s, k);
    double here = strut_path_measure_switch(s, w->y, NULL, k);
    double there = strut_path_measure_switch(s, end, NULL, k);
    bool zero = fabs(here) <= EVEN * s->size && (on ? there < 0 : there > 0);
    if (k != which && !zero) continue;
    report_switch(w, k, !on);
    strut_path_switch_set(s, k, !on);
  }
  for (int32_t i = 0; i <= s->n; i++) w->trial[i] = end[i] - w->y[i];
  if (!strut_path_tangent(s, w->y, w->tangent, w->next_tangent) &&
      !strut_path_tangent(s, w->y, w->trial, w->next_tangent))
    return false;
  bool on = strut_path_switch_is_on(s, which);
  double h = 1e-6, here = strut_path_measure_switch(s, w->y, NULL, which);
  for (int32_t i = 0; i <= s->n; i++) w->trial[i] = w->y[i] + h * w->next_tangent[i];
  along = strut_path_measure_switch(s, w->trial, NULL, which) - here;
  double sense = on ? along : -along;
  for (int32_t i = 0; i <= s->n; i++)
    w->tangent[i] = sense < 0 ? -w->next_tangent[i] : w->next_tangent[i];
  count_negative(w);
  if (!before && w->negative) amend_last(w, ", unstable from here");
  if (before && !w->negative) amend_last(w, ", stable from here");
  if (turn * w->tangent[s->n] < 0)
    add_event(
        w, STRUT_PATH_LIMIT, w->y, 0,
        turn > 0 ? "the factor can grow no further, for that" : "the factor grows again from here");
  return true;
}

/* Predictor and corrector, shorter until they succeed: the next point and its tangent. */
static bool find_next(strut_path_walk *w) {
  strut_path_system *s = &w->system;
  double here = dot(w, w->tangent, w->y);
  for (; w->step >= SHORTEST; w->step *= 0.5) {
    for (int32_t i = 0; i <= s->n; i++) w->next[i] = w->y[i] + w->step * w->tangent[i];
    int used = strut_path_correct(s, w->tangent, here + w->step, w->next);
    if (used < 0 || used > SLOW || distance(w, w->next, w->y) > 1.5 * w->step) continue;
    if (!strut_path_tangent(s, w->next, w->tangent, w->next_tangent)) continue;
    if (dot(w, w->tangent, w->next_tangent) < BEND) continue;
    return true;
  }
  w->step = SHORTEST;
  return false;
}

/* Ends the path exactly at the factor asked for if this piece passes it. */
static bool land(strut_path_walk *w) {
  strut_path_system *s = &w->system;
  double from = w->y[s->n], to = w->next[s->n];
  if (!(from < 1 && to >= 1)) return false;
  double share = (1 - from) / (to - from);
  for (int32_t i = 0; i <= s->n; i++) w->trial[i] = w->y[i] + share * (w->next[i] - w->y[i]);
  if (strut_path_correct(s, w->upward, 1.0, w->trial) < 0) return false;
  w->trial[s->n] = 1.0;
  memcpy(w->next, w->trial, bytes_of(w));
  return true;
}

static void find_criticals(strut_path_walk *w, const strut_path_piece *piece) {
  strut_path_system *s = &w->system;
  double turn = w->next_tangent[s->n];
  strut_path_spectrum(s, piece->to, false);
  int32_t after = strut_path_negative(s);
  int32_t low = after < w->negative ? after : w->negative;
  int32_t high = after < w->negative ? w->negative : after;
  for (int32_t k = low; k < high && piece->length > 0; k++) find_critical(w, piece, k, turn);
  w->negative = after;
}

static bool is_away(const strut_path_walk *w) {
  double most = 0;
  for (int32_t i = 0; i < w->system.n; i++) most = fmax(most, fabs(w->y[i]));
  return most > BOUND || w->y[w->system.n] < DEEP;
}

static bool give_up(strut_path_walk *w, strut_path_end end) {
  w->path->end = end;
  double factor = w->system.unit * w->y[w->system.n];
  if (end == STRUT_PATH_LOST)
    snprintf(w->path->remark, sizeof w->path->remark,
             "the path ends at the factor %.6g: no equilibrium follows it nearby", factor);
  if (end == STRUT_PATH_AWAY)
    snprintf(w->path->remark, sizeof w->path->remark,
             "followed to the factor %.6g: from there it leads ever further away", factor);
  return false;
}

/* The piece ends early where a switch is thrown, and the walk goes on from there. */
static bool take_switch(strut_path_walk *w, strut_path_piece *piece, int32_t which,
                        double *beyond) {
  memcpy(beyond, w->next, bytes_of(w));
  memcpy(w->next, w->trial, bytes_of(w));
  if (!strut_path_tangent(&w->system, w->next, w->tangent, w->next_tangent))
    memcpy(w->next_tangent, w->tangent, bytes_of(w));
  find_criticals(w, piece);
  w->arc += distance(w, w->next, w->y);
  memcpy(w->y, w->next, bytes_of(w));
  memcpy(w->tangent, w->next_tangent, bytes_of(w));
  add_point(w, w->negative);
  return throw_switch(w, which, beyond) || give_up(w, STRUT_PATH_LOST);
}

bool strut_path_walk_step(strut_path_walk *w) {
  strut_path_piece piece = {w->y, w->tangent, w->next, 0};
  int32_t which;
  if (!find_next(w)) return give_up(w, STRUT_PATH_LOST);
  piece.length = dot(w, w->tangent, w->next) - dot(w, w->tangent, w->y);
  bool landed = land(w);
  if (landed) piece.length = dot(w, w->tangent, w->next) - dot(w, w->tangent, w->y);
  double place = first_switch(w, &piece, &which);
  if (which >= 0) {
    piece.length = place;
    double *beyond = strut_allocate(1, bytes_of(w));
    w->failed = w->failed || !beyond;
    bool on = beyond && take_switch(w, &piece, which, beyond);
    strut_release(beyond);
    return on && !w->failed;
  }
  find_criticals(w, &piece);
  w->arc += distance(w, w->next, w->y);
  memcpy(w->y, w->next, bytes_of(w));
  memcpy(w->tangent, w->next_tangent, bytes_of(w));
  add_point(w, w->negative);
  if (w->failed) return false;
  if (landed) {
    w->path->end = STRUT_PATH_UNTIL;
    return false;
  }
  if (is_away(w)) return give_up(w, STRUT_PATH_AWAY);
  w->step = fmin(1.4 * w->step, LONGEST);
  return true;
}

/* The tangent at the beginning: with the load; where the load alone decides, so that it does work. */
static bool first_tangent(strut_path_walk *w) {
  strut_path_system *s = &w->system;
  if (strut_path_tangent(s, w->y, w->upward, w->tangent)) return true;
  for (int32_t i = 0; i < s->n; i++) w->trial[i] = s->load[s->potential->coordinate[i]] * s->unit;
  w->trial[s->n] = 0;
  return strut_path_tangent(s, w->y, w->trial, w->tangent);
}

bool strut_path_walk_begin(strut_path_walk *w) {
  strut_path_system *s = &w->system;
  const double h = 1e-6;
  strut_path_place(s, w->y, s->q);
  for (int32_t k = 0; k < strut_path_switch_count(s); k++) {
    double value = strut_path_switch_value(s, k, s->q);
    if (isfinite(value)) strut_path_switch_set(s, k, value > -EVEN * s->size);
  }
  for (int round = 0; round < ROUNDS; round++) { /* what stands at zero goes the way of the path */
    bool changed = false;
    if (!first_tangent(w)) continue;
    for (int32_t i = 0; i <= s->n; i++) w->next[i] = w->y[i] + h * w->tangent[i];
    for (int32_t k = 0; k < strut_path_switch_count(s); k++) {
      double here = strut_path_measure_switch(s, w->y, NULL, k);
      if (!isfinite(here) || fabs(here) > EVEN * s->size) continue;
      bool on = strut_path_measure_switch(s, w->next, NULL, k) >= here;
      changed = changed || on != strut_path_switch_is_on(s, k);
      strut_path_switch_set(s, k, on);
    }
    if (!changed) break;
  }
  if (!first_tangent(w) || w->system.drifts) return give_up(w, STRUT_PATH_LOST);
  count_negative(w);
  add_point(w, w->negative);
  return !w->failed;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/follow/follow_criterion.h"

#include <math.h>
#include <string.h>

#include "engine/model/pose.h"

/* Gap in units of the motion within which a start is on the curve; shift of the phase in a step. */
static const double NEAR = 0.02, PHASE = 0.1;
enum { MOST_EXTREMA = 64 };

/* ---- determinants ---- */

/* det(jacobian + shift), by elimination with pivots; the multipliers that decide are of order one. */
static double determinant(const double *jacobian, double shift, size_t n, double *a) {
  double value = 1.0;
  memcpy(a, jacobian, n * n * sizeof(double));
  for (size_t i = 0; i < n; i++) a[i * n + i] += shift;
  for (size_t k = 0; k < n; k++) {
    size_t best = k;
    for (size_t i = k + 1; i < n; i++)
      if (fabs(a[i * n + k]) > fabs(a[best * n + k])) best = i;
    double pivot = a[best * n + k];
    if (pivot == 0.0) return 0.0;
    for (size_t j = k; j < n && best != k; j++) {
      double keep = a[k * n + j];
      a[k * n + j] = a[best * n + j], a[best * n + j] = keep;
    }
    value *= best != k ? -pivot : pivot;
    for (size_t i = k + 1; i < n; i++) {
      double factor = a[i * n + k] / pivot;
      for (size_t j = k; j < n; j++) a[i * n + j] -= factor * a[k * n + j];
    }
  }
  return value;
}

/* ---- extrema of a gap ---- */

typedef struct extremum {
  double gap, phase; /* [m], [repetitions] */
} extremum;

/* What looks on during a period: the gap of a contact at the ends of steps, and its extrema between. */
typedef struct gap_watch {
  const strut_model *model;
  int32_t contact;
  bool highest; /* maxima instead of minima */
  double gap, rate, time, begin, span, dt;
  size_t count;
  extremum found[MOST_EXTREMA];
} gap_watch;

/* The gap and its rate; of a ground that moves, without its own velocity. */
static double gap_of(const gap_watch *w, const double *q, const double *v,
                     const strut_ground_motion *motion, double *rate) {
  const strut_contact_table *c = &w->model->contacts;
  const strut_contact_pose pose = strut_contact_pose_at(c, w->contact, q, motion, -1);
  const double *at = v + c->at[w->contact];
  *rate = at[0] * pose.axes.normal[0] + at[1] * pose.axes.normal[1];
  return pose.gap;
}

/* An extremum of the cubic between two ends of a step. */
static void watch_gap(void *context, const strut_state *state) {
  gap_watch *w = context;
  double rate, h = w->dt;
  double gap = gap_of(w, state->q, state->v, state->ground_motion, &rate);
  double sign = w->highest ? -1.0 : 1.0;
  if (sign * w->rate < 0.0 && sign * rate >= 0.0 && w->count < MOST_EXTREMA) {
    double rise = gap - w->gap, a = h * w->rate, b = h * rate;
    double c = 3.0 * rise - 2.0 * a - b, d = a + b - 2.0 * rise; /* slope a + 2 c x + 3 d x^2 */
    double root = sqrt(fmax(0.0, c * c - 3.0 * d * a));
    double x = -a / (c + (a < 0.0 ? root : -root));
    if (!(x >= 0.0 && x <= 1.0)) x = 1.0;
    w->found[w->count++] =
        (extremum){w->gap + x * (a + x * (c + x * d)), (w->time + x * h - w->begin) / w->span};
  }
  w->gap = gap, w->rate = rate, w->time += h;
}

/* All extrema of the contact's gap in a repetition. False: the motion is lost. */
static bool find_extrema(strut_follow_surface *u, const strut_follow_surface_point *p, bool highest,
                         int32_t contact, gap_watch *w) {
  strut_follow_system *s = &u->s;
  if (!strut_follow_surface_set(u, p->value)) return false;
  strut_period_map *map = &s->map[0];
  *w = (gap_watch){.model = s->model, .contact = contact, .highest = highest};
  w->dt = map->dt;
  w->span = s->period * s->repeats;
  memcpy(s->end, p->y, s->both * sizeof(double));
  w->gap = gap_of(w, s->end, s->end + s->model->length, NULL, &w->rate);
  map->watch = watch_gap;
  map->watch_context = w;
  double travel = strut_period_map_apply(map, s->end);
  map->watch = NULL;
  return isfinite(travel);
}

static double phase_distance(double a, double b) {
  double off = fabs(a - b);
  off -= floor(off);
  return fmin(off, 1.0 - off);
}

static bool gap_at(strut_follow_surface *u, strut_follow_criterion *criterion,
                   const strut_follow_surface_point *p, double *value) {
  gap_watch w;
  double nearest = HUGE_VAL;
  if (!find_extrema(u, p, criterion->kind == STRUT_FOLLOW_LIFT, criterion->contact, &w))
    return false;
  for (size_t i = 0; i < w.count; i++) {
    double off = phase_distance(w.found[i].phase, criterion->phase);
    if (off >= nearest) continue;
    nearest = off;
    *value = w.found[i].gap / u->s.length;
    criterion->next_phase = w.found[i].phase;
  }
  return nearest <= PHASE;
}

bool strut_follow_criterion_choose(strut_follow_surface *u, strut_follow_criterion *criterion,
                                   const strut_follow_surface_point *p, const char *node) {
  double least = NEAR * u->s.length;
  bool found = false;
  gap_watch w;
  if (!strut_follow_surface_set(u, p->value)) return false;
  for (int32_t i = 0; i < u->s.model->contacts.count && !u->status; i++) {
    const char *name = u->s.setup.scene.nodes[u->s.model->contacts.entry[i].node].name;
    if (!node || strcmp(name, node) != 0) continue;
    if (!find_extrema(u, p, criterion->kind == STRUT_FOLLOW_LIFT, i, &w)) continue;
    for (size_t k = 0; k < w.count; k++) {
      if (fabs(w.found[k].gap) >= least) continue;
      least = fabs(w.found[k].gap);
      criterion->contact = i;
      criterion->phase = criterion->next_phase = w.found[k].phase;
      found = true;
    }
  }
  return found;
}

bool strut_follow_criterion_at(strut_follow_surface *u, strut_follow_criterion *criterion,
                               strut_follow_surface_point *p, double *value) {
  size_t n = u->s.n;
  if (criterion->kind == STRUT_FOLLOW_TOUCH || criterion->kind == STRUT_FOLLOW_LIFT)
    return gap_at(u, criterion, p, value);
  if (!strut_follow_surface_complete(u, p)) return false;
  *value = determinant(p->jacobian, criterion->kind == STRUT_FOLLOW_DOUBLING ? 1.0 : -1.0, n,
                       criterion->scratch);
  return isfinite(*value);
}

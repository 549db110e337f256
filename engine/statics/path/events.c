/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/path/path_parts.h"

#include <assert.h>
#include <gsl/gsl_blas.h>
#include <gsl/gsl_sort_vector.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Regula falsi with the Illinois correction; each trial is corrected back onto the path. */

enum { MOST_TRIALS = 60, KEPT = 4 };

static const double ZERO = 1e-13;   /* of the measure at the ends */
static const double NARROW = 1e-13; /* of the piece's length */
/*
 * Of the eigenvalue at the ends. Nearer to zero Newton's method may leave by the other branch, and
 */
static const double FORK = 1e-4;
static const double BLURRED = 100; /* and this many roundings of the stiffness */

double strut_path_measure_switch(strut_path_system *s, const double *y,
                                 const strut_path_piece *piece, int32_t which) {
  bool grip =
      which >= strut_path_first_grip_switch(s) && which < strut_path_first_element_switch(s);
  return grip ? strut_path_measure_grip(s, y, piece, which) : strut_path_switch_value(s, which, y);
}

double strut_path_measure_eigenvalue(strut_path_system *s, const double *y,
                                     const strut_path_piece *piece, int32_t which) {
  assert(which >= 0 && which < s->n);
  (void)piece;
  if (!strut_path_spectrum(s, y, STRUT_PATH_VALUES)) return (double)NAN;
  return gsl_vector_get(s->algebra.values, (size_t)which);
}

/* Linear interpolation between two points; must be corrected afterwards. */
static void interpolate_linearly(const strut_path_system *s, double share, const double *low,
                                 const double *high, double *y) {
  for (int32_t i = 0; i < 2 * (s->n + 1); i++) y[i] = low[i] + share * (high[i] - low[i]);
}

/* The point of the path at `place` along the tangent, begun between the two ends low and high. */
static bool point_at(strut_path_system *s, const strut_path_piece *piece, double place,
                     double share, const double *low, const double *high, double *y) {
  double value = place;
  interpolate_linearly(s, share, low, high, y);
  for (int32_t i = 0; i <= s->n; i++) value += piece->tangent[i] * piece->from[i];
  return strut_path_correct(s, piece->tangent, value, y) >= 0;
}

/* Points of the path where the measure is known, those nearest to zero first. */
typedef struct trial {
  double place, value, *y; /* y (2 n + 2) */
} trial;

typedef struct trials {
  int32_t which; /* eigenvalue that is followed */
  int count;
  trial kept[KEPT];
} trials;

static bool make_trials(const strut_path_system *s, strut_arena *arena, trials *t) {
  for (int k = 0; k < KEPT; k++) {
    t->kept[k].y = strut_arena_allocate(arena, 2 * ((size_t)s->n + 1), sizeof(double));
    if (!t->kept[k].y) return false;
  }
  return true;
}

static void keep_trial(const strut_path_system *s, trials *t, double place, double value,
                       const double *y) {
  int at = t->count < KEPT ? t->count++ : KEPT;
  if (at == KEPT && !(fabs(value) < fabs(t->kept[--at].value))) return;
  double *block = t->kept[at].y;
  for (; at > 0 && fabs(value) < fabs(t->kept[at - 1].value); at--) t->kept[at] = t->kept[at - 1];
  t->kept[at] = (trial){place, value, block};
  memcpy(block, y, 2 * ((size_t)s->n + 1) * sizeof *y);
}

/*
 * Where the measure vanishes, by a polynomial in it through the trials kept; false: off the piece.
 */
static bool interpolate(const strut_path_system *s, const trials *t, double length, double *place,
                        double *y) {
  double weight[KEPT], sum = 0;
  const trial *nearest = &t->kept[0];
  for (int k = 0; k < t->count; k++) {
    weight[k] = 1;
    for (int l = 0; l < t->count; l++)
      if (l != k) weight[k] *= t->kept[l].value / (t->kept[l].value - t->kept[k].value);
    sum += weight[k] * t->kept[k].place;
  }
  if (!(sum >= -NARROW * length && sum <= (1 + NARROW) * length)) return false;
  *place = fmax(0.0, fmin(length, sum));
  for (int32_t i = 0, count = s->n + 1; i < count; i++) {
    double change = 0;
    for (int k = 1; k < t->count; k++)
      change += weight[k] * ((t->kept[k].y[i] - nearest->y[i]) +
                             (t->kept[k].y[count + i] - nearest->y[count + i]));
    strut_dd at = dd_add((strut_dd){nearest->y[i], nearest->y[count + i]}, dd_of(change));
    y[i] = at.hi, y[count + i] = at.lo;
  }
  return true;
}

/*
 * Where an eigenvalue vanishes near `place`. Newton's method would be led astray there, so that the
 * point is interpolated between four on its two sides, near enough for a cubic and far enough for
 * Newton's method. `slope` is the measure's derivative. False: they are not to be had.
 */
static bool interpolate_fork(strut_path_system *s, const strut_path_piece *piece, double scale,
                             double slope, trials *t, double *place, double *y) {
  static const double sides[KEPT] = {-2, -1, 1, 2};
  double apart = fmin(fmax(FORK * scale, BLURRED * s->spectrum.noise) / slope, 0.1 * piece->length);
  double middle = *place;
  t->count = 0;
  for (int k = 0; k < KEPT; k++) {
    double at = middle + sides[k] * apart;
    if (!point_at(s, piece, at, at / piece->length, piece->from, piece->to, y)) continue;
    double value = strut_path_measure_eigenvalue(s, y, piece, t->which);
    if (fabs(value) <= 2 * scale) keep_trial(s, t, at, value, y);
  }
  return t->count > 1 && interpolate(s, t, piece->length, place, y);
}

double strut_path_locate(strut_path_system *s, const strut_path_piece *piece,
                         strut_path_measure measure, int32_t which, double *y) {
  assert(piece->length >= 0);
  size_t bytes = 2 * ((size_t)s->n + 1) * sizeof *y;
  double at[2] = {0, piece->length}, place = -1;
  double value[2] = {measure(s, piece->from, piece, which), measure(s, piece->to, piece, which)};
  double scale = fmax(fabs(value[0]), fabs(value[1])), slope = scale / piece->length;
  bool fork = measure == strut_path_measure_eigenvalue;
  double near = (fork ? 10 * FORK : ZERO) * scale;
  strut_arena arena = {0};
  trials t = {.which = which};
  double *end[2] = {strut_arena_allocate(&arena, 1, bytes), strut_arena_allocate(&arena, 1, bytes)};
  if (end[0] && end[1] && make_trials(s, &arena, &t) && value[0] * value[1] <= 0 && scale > 0) {
    memcpy(end[0], piece->from, bytes);
    memcpy(end[1], piece->to, bytes);
    for (int k = 0, last = -1; k < MOST_TRIALS; k++) {
      double share = value[0] / (value[0] - value[1]), before = value[0] - value[1];
      place = at[0] + share * (at[1] - at[0]);
      if (at[1] > at[0]) slope = fabs(before) / (at[1] - at[0]);
      bool found = point_at(s, piece, place, share, end[0], end[1], y);
      double now = found ? measure(s, y, piece, which) : (double)NAN;
      if (!found || !(fabs(now) <= 2 * scale)) { /* it left the path: the last point before */
        if (!fork) place = at[0];
        interpolate_linearly(s, fork ? share : 0.0, end[0], end[1], y);
        break;
      }
      if (fabs(now) <= near || at[1] - at[0] <= NARROW * piece->length) break;
      int side = now * value[1] > 0 || (now == 0 && value[1] != 0) ? 1 : 0;
      at[side] = place, value[side] = now;
      memcpy(end[side], y, bytes);
      if (side == last) value[1 - side] *= 0.5;
      last = side;
    }
    double *rough = end[0];
    memcpy(rough, y, bytes);
    if (fork && !interpolate_fork(s, piece, scale, slope, &t, &place, y)) memcpy(y, rough, bytes);
  }
  strut_arena_free(&arena);
  return place;
}

/*
 * A kink of the path: a cable goes slack or taut, a node touches or leaves the ground. The
 * stiffness jumps there, so that the parameter may turn back, and stability change, with no
 * eigenvalue at zero.
 */

/* Switches at one kink of which all combinations are tried. */
enum { MOST_TOGETHER = 10 };

static const double AHEAD = 1e-6;   /* how far along a tangent it is seen what a switch will do */
static const double STEADY = 1e-12; /* of the size: a switch that changes less stays as it is */

/* The switches that stand at zero at a kink, in their order; the one that made it is `first`. */
typedef struct switch_group {
  int32_t count, first, which[MOST_TOGETHER];
  bool was_on[MOST_TOGETHER];
  double here[MOST_TOGETHER]; /* their values at the kink [m] */
} switch_group;

static bool is_thrown(bool on, double value) { return on ? value < 0 : value > 0; }

static switch_group collect_switches(strut_path_walk *w, int32_t which) {
  strut_path_system *s = &w->system;
  switch_group g = {0};
  for (int32_t k = 0; k < strut_path_switch_count(s); k++) {
    double here = strut_path_switch_value(s, k, w->y);
    if (k >= strut_path_first_corner_switch(s) && k < strut_path_first_element_switch(s))
      continue; /* they are passed one by one */
    if (k == which) g.first = g.count;
    if (k != which &&
        !(fabs(here) <= STRUT_PATH_EVEN * s->size && g.count + (k < which) < MOST_TOGETHER))
      continue;
    g.which[g.count] = k;
    g.was_on[g.count] = strut_path_switch_is_on(s, k);
    g.here[g.count++] = here;
  }
  return g;
}

static void set_switches(strut_path_walk *w, const switch_group *g, unsigned thrown) {
  strut_path_system *s = &w->system;
  strut_path_evaluate(s, w->y); /* what touches does so here */
  for (int32_t i = 0; i < g->count; i++)
    strut_path_switch_set(s, g->which[i], g->was_on[i] != (thrown >> i & 1));
}

/* Change of a switch's value over a small step along a tangent [m]. */
static double change_ahead(strut_path_walk *w, const switch_group *g, int32_t i,
                           const double *tangent) {
  strut_path_system *s = &w->system;
  memcpy(w->spare, w->y, 2 * ((size_t)s->n + 1) * sizeof *w->y);
  for (int32_t k = 0; k <= s->n; k++) w->spare[k] += AHEAD * tangent[k];
  return strut_path_switch_value(s, g->which[i], w->spare) - g->here[i];
}

/*
 * The tangent with these switches thrown, into w->next_tangent, so that each switch continues to
 * where it was put. False: no such tangent exists, or it contradicts a switch.
 */
static bool find_tangent(strut_path_walk *w, const switch_group *g, unsigned thrown,
                         const double *beyond) {
  strut_path_system *s = &w->system;
  double sense = 0;
  set_switches(w, g, thrown);
  for (int32_t i = 0; i <= s->n; i++) w->trial[i] = beyond[i] - w->y[i];
  if (!strut_path_tangent(s, w->y, w->tangent, w->next_tangent) &&
      !strut_path_tangent(s, w->y, w->trial, w->next_tangent))
    return false;
  for (int32_t i = 0; i < g->count; i++) {
    double change = change_ahead(w, g, i, w->next_tangent);
    if (!(fabs(change) > STEADY * s->size)) continue;
    bool on = g->was_on[i] != (thrown >> i & 1);
    double wanted = (change > 0) == on ? 1 : -1;
    if (sense == 0) {
      sense = wanted;
    } else if (sense != wanted) {
      return false;
    }
  }
  for (int32_t i = 0; i <= s->n && sense < 0; i++) w->next_tangent[i] = -w->next_tangent[i];
  return true;
}

/*
 * Chooses the switches thrown here: those that the old stiffness throws, else any consistent set.
 */
static bool choose_switches(strut_path_walk *w, const switch_group *g, const double *beyond,
                            unsigned *thrown) {
  unsigned first = 1u << g->first;
  for (int32_t i = 0; i < g->count; i++)
    if (is_thrown(g->was_on[i], strut_path_switch_value(&w->system, g->which[i], beyond)))
      first |= 1u << i;
  *thrown = first;
  if (find_tangent(w, g, first, beyond)) return true;
  for (*thrown = 1; *thrown < 1u << g->count; ++*thrown)
    if (*thrown != first && find_tangent(w, g, *thrown, beyond)) return true;
  set_switches(w, g, first);
  *thrown = first;
  return false;
}

/* What an element does as its switch is thrown: "m1 reaches its longest length". */
static strut_path_event_kind describe_element(const strut_path_system *s, int32_t which, bool on,
                                              char *text, size_t room) {
  const strut_scene *scene = s->model->scene;
  const strut_path_element_switch *w = &s->elements.switches[which];
  const strut_element *e = &s->model->elements.element[w->element];
  const char *name = strut_element_name(scene, e);
  strut_path_event_kind kind = on ? STRUT_PATH_ENGAGE : STRUT_PATH_RELEASE;
  const char *what = on ? "begins to act" : "ceases to act";
  if (w->kink >= 0) {
    bool fold = strut_law_way(e->law, &e->numbers, w->kink) !=
                strut_law_way(e->law, &e->numbers, w->kink + 1);
    kind = STRUT_PATH_LAW, what = fold ? "reaches a fold of its law" : "passes a kink of its law";
  }
  if (e->role == STRUT_ELEMENT_LONGEST)
    what = on ? "reaches its longest length" : "leaves its longest length";
  if (e->role == STRUT_ELEMENT_SHORTEST)
    what = on ? "reaches its shortest length" : "leaves its shortest length";
  if (e->role == STRUT_ELEMENT_COLLISION) what = on ? "touches" : "separates";
  if (w->kink < 0 && e->role == STRUT_ELEMENT_MEMBER) {
    bool cable = scene->members[e->item].kind == STRUT_CABLE;
    if (cable) kind = on ? STRUT_PATH_TAUT : STRUT_PATH_SLACK;
    what = cable            ? (on ? "begins to pull" : "goes slack")
           : e->carries > 0 ? (on ? "begins to pull" : "ceases to pull")
                            : (on ? "begins to push" : "ceases to push");
  }
  snprintf(text, room, "%s %s", name, what);
  return kind;
}

bool strut_path_is_bend(const strut_path_system *s, int32_t which) {
  int32_t k = which - strut_path_first_element_switch(s);
  if (k < 0 || s->elements.switches[k].kink < 0) return false;
  const strut_element *e = &s->model->elements.element[s->elements.switches[k].element];
  int kink = s->elements.switches[k].kink;
  return e->law == STRUT_LAW_FOLDING && e->numbers.curve->smooth &&
         strut_folding_way(e->numbers.curve, kink) == strut_folding_way(e->numbers.curve, kink + 1);
}

static void report_switch(strut_path_walk *w, int32_t which, int32_t before, int32_t after) {
  const strut_path_system *s = &w->system;
  if (strut_path_is_bend(s, which)) return;
  const strut_scene *scene = s->model->scene;
  int32_t members = s->model->members.count, elements = strut_path_first_element_switch(s);
  bool on = strut_path_switch_is_on(s, which);
  const char *stable = !before && after   ? ", unstable from here"
                       : before && !after ? ", stable from here"
                                          : "";
  char detail[300], what[240];
  int32_t index = which;
  strut_path_event_kind kind = on ? STRUT_PATH_TAUT : STRUT_PATH_SLACK;
  if (which >= elements) {
    int32_t element = s->elements.switches[which - elements].element;
    kind = describe_element(s, which - elements, on, what, sizeof what);
    index = kind == STRUT_PATH_TAUT || kind == STRUT_PATH_SLACK
                ? s->model->elements.element[element].item
                : element;
  } else if (which < members) {
    snprintf(what, sizeof what, "%s %s", scene->members[which].name,
             on ? "begins to pull" : "goes slack");
  } else {
    int32_t contact = which - members;
    index = s->model->contacts.entry[contact].node;
    kind = on ? STRUT_PATH_TOUCHDOWN : STRUT_PATH_LIFT_OFF;
    snprintf(what, sizeof what, "%s %s %s", scene->nodes[index].name, on ? "touches" : "leaves",
             strut_path_ground_name(s, contact));
  }
  snprintf(detail, sizeof detail, "%s%s", what, stable);
  strut_path_add_event(w, kind, w->y, index, before, after, detail);
}

void strut_path_report_exchange(strut_path_walk *w, double turn, int32_t before) {
  strut_path_system *s = &w->system;
  char detail[300];
  if (turn * w->tangent[s->n] < 0) {
    snprintf(detail, sizeof detail, "%s %s here", strut_path_subject(w), strut_path_turn(w, turn));
    strut_path_add_event(w, STRUT_PATH_KINK_LIMIT, w->y, 0, before, w->negative, detail);
  } else if (before != w->negative) {
    int32_t count = w->negative > before ? w->negative - before : before - w->negative;
    snprintf(detail, sizeof detail, "%d eigenvalue%s of the stiffness jump%s %s zero%s", (int)count,
             count == 1 ? "" : "s", count == 1 ? "s" : "", w->negative > before ? "below" : "above",
             count % 2 ? "; another path branches off" : "");
    strut_path_add_event(w, STRUT_PATH_KINK_BIFURCATION, w->y, 0, before, w->negative, detail);
  }
}

bool strut_path_pass_kink(strut_path_walk *w, int32_t which, const double *beyond) {
  strut_path_system *s = &w->system;
  switch_group g = collect_switches(w, which);
  double turn = w->tangent[s->n];
  int32_t before = w->negative;
  unsigned thrown;
  bool found = choose_switches(w, &g, beyond, &thrown);
  if (found) memcpy(w->tangent, w->next_tangent, ((size_t)s->n + 1) * sizeof *w->tangent);
  strut_path_count_negative(w);
  int32_t last = g.count - 1;
  while (!(thrown >> last & 1)) last--;
  for (int32_t i = 0; i <= last; i++)
    if (thrown >> i & 1) report_switch(w, g.which[i], before, i == last ? w->negative : before);
  if (found) strut_path_report_exchange(w, turn, before);
  return found;
}

/*
 * Eigenvalues of the stiffness. The dense method is good to the last bit of the largest eigenvalue:
 * with a bar of 1e11 N/m a soft one of 100 N/m would have seven digits left, and its sign at a
 * bifurcation none. So the soft ones are computed once more, as Ritz values of the soft
 * eigenvectors, from the members one by one: a motion that does not stretch a stiff bar then meets
 * none of its stiffness.
 */

enum { MOST_SOFT = 40 };

static const double SOFT = 1e-6;        /* of the largest eigenvalue: few digits are left */
static const double UNSIGNED = 1e-12;   /* likewise: not even the sign is sure */
static const double ZERO_VALUE = 1e-13; /* of a soft mode's largest parts: no sign below this */
static const double NO_VALUE = 1e-20;   /* of the largest eigenvalue, likewise */
static const double ROUNDING = 2e-16;   /* of a double */

/* Displacement of a member's second end relative to its first in a mode of the free coordinates. */
static void relative_motion(const strut_path_system *s, int32_t j, size_t mode, double d[2]) {
  const strut_member_table *t = &s->model->members;
  for (uint32_t c = 0; c < 2; c++) {
    int32_t a = s->potential->row_of[t->from[j] + c], b = s->potential->row_of[t->to[j] + c];
    d[c] = (b >= 0 ? gsl_matrix_get(s->algebra.vectors, (size_t)b, mode) : 0.0) -
           (a >= 0 ? gsl_matrix_get(s->algebra.vectors, (size_t)a, mode) : 0.0);
  }
}

static double held_motion(const strut_path_system *s, int32_t k, size_t mode) {
  double sum = 0;
  for (int32_t i = 0; i < s->n; i++)
    sum += s->held.motion[k][i] * gsl_matrix_get(s->algebra.vectors, (size_t)i, mode);
  return sum;
}

/* ritz += factor part part^T */
static void add_square(gsl_matrix *ritz, const double *part, double factor) {
  for (size_t k = 0; k < ritz->size1; k++)
    for (size_t l = 0; l < ritz->size1; l++)
      *gsl_matrix_ptr(ritz, k, l) += factor * part[k] * part[l];
}

/* Displacement of a contact's node along a unit vector in a mode. */
static double contact_motion(const strut_path_system *s, int32_t i, const double *unit,
                             size_t mode) {
  const int32_t *row = s->potential->row_of + s->model->contacts.at[i];
  double sum = 0;
  for (int c = 0; c < 2; c++)
    if (row[c] >= 0) sum += unit[c] * gsl_matrix_get(s->algebra.vectors, (size_t)row[c], mode);
  return sum;
}

static void project_contact(const strut_path_system *s, int32_t i, size_t first, gsl_matrix *ritz) {
  const strut_contact_axes *axes = &s->contacts.contact[i].pose.axes;
  double part[MOST_SOFT], along, across;
  strut_path_contact_stiffness(s, i, &along, &across);
  for (size_t k = 0; k < ritz->size1; k++) part[k] = contact_motion(s, i, axes->normal, first + k);
  add_square(ritz, part, along);
  for (size_t k = 0; k < ritz->size1; k++) part[k] = contact_motion(s, i, axes->tangent, first + k);
  add_square(ritz, part, across);
}

/* slope b b' + t d2e/dq2 of an element, and the largest of its parts. */
static void project_element(strut_path_system *s, int32_t i, size_t first, gsl_matrix *ritz) {
  const strut_element *e = &s->model->elements.element[i];
  const strut_element_pose *pose = &s->elements.element[i].pose;
  const uint32_t *at = s->model->elements.at + e->first;
  double along[MOST_SOFT], motion[MOST_SOFT][STRUT_MOST_GRADIENT];
  double bend[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT] = {0};
  int32_t n = 2 * e->nodes;
  size_t count = ritz->size1;
  strut_element_bend(s->model, i, s->latest.q, pose->force, bend);
  for (size_t k = 0; k < count; k++) {
    along[k] = 0.0;
    for (int32_t c = 0; c < n; c++) {
      int32_t row = s->potential->row_of[at[c / 2] + (uint32_t)(c % 2)];
      motion[k][c] = row >= 0 ? gsl_matrix_get(s->algebra.vectors, (size_t)row, first + k) : 0.0;
      along[k] += pose->b[c] * motion[k][c];
    }
  }
  add_square(ritz, along, pose->slope);
  for (size_t k = 0; k < count; k++)
    for (size_t l = 0; l < count; l++) {
      double sum = 0.0;
      for (int32_t a = 0; a < n; a++)
        for (int32_t b = 0; b < n; b++) sum += motion[k][a] * bend[a * n + b] * motion[l][b];
      *gsl_matrix_ptr(ritz, k, l) += sum;
      if (k == l)
        s->spectrum.soft_parts =
            fmax(s->spectrum.soft_parts, fmax(fabs(sum), fabs(pose->slope) * along[k] * along[k]));
    }
}

/* The stiffness seen by the modes first, first + 1, ... */
static void project(strut_path_system *s, size_t first, gsl_matrix *ritz) {
  double along[MOST_SOFT], across[MOST_SOFT];
  size_t count = ritz->size1;
  gsl_matrix_set_zero(ritz);
  for (int32_t j = 0; j < s->model->members.count; j++) {
    const strut_path_member *m = &s->member[j];
    if (!m->pulls) continue;
    for (size_t k = 0; k < count; k++) {
      double d[2];
      relative_motion(s, j, first + k, d);
      along[k] = m->length > 0 ? m->ux * d[0] + m->uy * d[1] : d[0];
      across[k] = m->length > 0 ? m->ux * d[1] - m->uy * d[0] : d[1];
    }
    add_square(ritz, along, m->length > 0 ? s->equations.terms.stiffness[j] : m->across);
    add_square(ritz, across, m->across);
  }
  s->spectrum.soft_parts = 0.0;
  for (int32_t i = 0; i < s->model->elements.count; i++)
    if (s->elements.element[i].acts) project_element(s, i, first, ritz);
  for (int32_t i = 0; i < s->model->contacts.count; i++)
    if (s->contacts.contact[i].touches) project_contact(s, i, first, ritz);
  for (int32_t i = 0; i < s->held.count; i++) {
    for (size_t k = 0; k < count; k++) along[k] = held_motion(s, i, first + k);
    add_square(ritz, along, s->held.by);
  }
}

/* Ritz values and vectors in place of the soft eigenvalues; false: out of memory. */
static bool refine(strut_path_system *s, size_t first, size_t count) {
  gsl_matrix *ritz = gsl_matrix_alloc(count, count), *turn = gsl_matrix_alloc(count, count);
  gsl_matrix *turned = gsl_matrix_alloc((size_t)s->n, count);
  gsl_vector *values = gsl_vector_alloc(count);
  gsl_eigen_symmv_workspace *eigen = gsl_eigen_symmv_alloc(count);
  bool made = ritz && turn && turned && values && eigen;
  if (made) {
    project(s, first, ritz);
    gsl_eigen_symmv(ritz, values, turn, eigen);
    gsl_eigen_symmv_sort(values, turn, GSL_EIGEN_SORT_VAL_ASC);
    gsl_matrix_view soft = gsl_matrix_submatrix(s->algebra.vectors, 0, first, (size_t)s->n, count);
    gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1.0, &soft.matrix, turn, 0.0, turned);
    gsl_matrix_memcpy(&soft.matrix, turned);
    for (size_t k = 0; k < count; k++)
      gsl_vector_set(s->algebra.values, first + k, gsl_vector_get(values, k));
  }
  gsl_matrix_free(ritz);
  gsl_matrix_free(turn);
  gsl_matrix_free(turned);
  gsl_vector_free(values);
  gsl_eigen_symmv_free(eigen);
  return made;
}

/* The largest stiffness that tension lends: what a soft eigenvalue is a difference of. */
static double largest_across(const strut_path_system *s) {
  double most = 0;
  for (int32_t j = 0; j < s->model->members.count; j++)
    if (s->member[j].pulls) most = fmax(most, fabs(s->member[j].across));
  return most;
}

static void find_vectors(strut_path_system *s) {
  gsl_matrix_memcpy(s->algebra.work, s->algebra.hessian);
  gsl_eigen_symmv(s->algebra.work, s->algebra.values, s->algebra.vectors, s->algebra.eigen);
  gsl_eigen_symmv_sort(s->algebra.values, s->algebra.vectors, GSL_EIGEN_SORT_VAL_ASC);
}

/* The soft eigenvalues are contiguous: index of the first and their number, nearest to zero. */
static size_t find_soft(const strut_path_system *s, double below, size_t *first) {
  size_t count = 0, nearest = 0;
  for (size_t i = 1; i < (size_t)s->n; i++)
    if (fabs(gsl_vector_get(s->algebra.values, i)) <
        fabs(gsl_vector_get(s->algebra.values, nearest)))
      nearest = i;
  *first = nearest;
  if (fabs(gsl_vector_get(s->algebra.values, nearest)) > below) return 0;
  while (*first > 0 && nearest - *first < MOST_SOFT / 2 &&
         fabs(gsl_vector_get(s->algebra.values, *first - 1)) <= below)
    --*first;
  while (*first + count < (size_t)s->n && count < MOST_SOFT &&
         fabs(gsl_vector_get(s->algebra.values, *first + count)) <= below)
    count++;
  return count;
}

/* Where a contact slides: eigenvalues by their real parts, which are those that pass through zero. */
static bool find_unsymmetric(strut_path_system *s) {
  size_t n = (size_t)s->n;
  gsl_vector_complex *values = gsl_vector_complex_alloc(n);
  gsl_matrix_complex *vectors = gsl_matrix_complex_alloc(n, n);
  gsl_eigen_nonsymmv_workspace *eigen = gsl_eigen_nonsymmv_alloc(n);
  gsl_permutation *order = gsl_permutation_alloc(n);
  bool found = values && vectors && eigen && order;
  gsl_matrix_memcpy(s->algebra.work, s->algebra.hessian);
  found = found && gsl_eigen_nonsymmv(s->algebra.work, values, vectors, eigen) == 0;
  if (found) {
    const gsl_vector_view real = gsl_vector_complex_real(values);
    gsl_sort_vector_index(order, &real.vector);
    for (size_t k = 0; k < n; k++) {
      size_t from = gsl_permutation_get(order, k);
      gsl_vector_complex_view column = gsl_matrix_complex_column(vectors, from);
      const gsl_vector_view vector = gsl_vector_complex_real(&column.vector);
      gsl_vector_set(s->algebra.values, k, gsl_vector_get(&real.vector, from));
      gsl_matrix_set_col(s->algebra.vectors, k, &vector.vector);
    }
    double largest = fmax(fabs(gsl_vector_get(s->algebra.values, 0)),
                          fabs(gsl_vector_get(s->algebra.values, n - 1)));
    s->spectrum.noise = ROUNDING * largest;
    for (size_t k = 0; k < n; k++)
      s->spectrum.negative += gsl_vector_get(s->algebra.values, k) < -s->spectrum.noise;
  }
  gsl_vector_complex_free(values);
  gsl_matrix_complex_free(vectors);
  gsl_eigen_nonsymmv_free(eigen);
  gsl_permutation_free(order);
  return found;
}

bool strut_path_spectrum(strut_path_system *s, const double *y, strut_path_spectrum_detail wanted) {
  size_t first;
  if (!strut_path_evaluate(s, y)) return false;
  s->spectrum.negative = s->spectrum.folded = strut_path_count_folded(s);
  if (s->n == 0) return true;
  if (strut_path_slides(s) || strut_path_has_rubbing(s)) return find_unsymmetric(s);
  if (wanted == STRUT_PATH_VECTORS) {
    find_vectors(s);
  } else {
    gsl_matrix_memcpy(s->algebra.work, s->algebra.hessian);
    gsl_eigen_symm(s->algebra.work, s->algebra.values, s->algebra.values_only);
    gsl_sort_vector(s->algebra.values);
  }
  double largest = fmax(fabs(gsl_vector_get(s->algebra.values, 0)),
                        fabs(gsl_vector_get(s->algebra.values, (size_t)s->n - 1)));
  double below = (wanted == STRUT_PATH_SIGNS ? UNSIGNED : SOFT) * largest;
  size_t soft = find_soft(s, below, &first);
  if (soft && wanted != STRUT_PATH_VECTORS) {
    find_vectors(s);
    soft = find_soft(s, below, &first);
  }
  if (soft && !refine(s, first, soft)) return false;
  double parts = fmax(largest_across(s), soft ? s->spectrum.soft_parts : 0.0);
  double zero = fmax(ZERO_VALUE * parts, NO_VALUE * largest);
  s->spectrum.noise = ROUNDING * largest;
  for (size_t i = 0; i < (size_t)s->n; i++) {
    bool is_soft = i >= first && i < first + soft;
    if (gsl_vector_get(s->algebra.values, i) < (is_soft ? -zero : 0.0)) s->spectrum.negative++;
  }
  return true;
}

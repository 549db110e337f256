/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One periodic motion: Newton's method, its multipliers, its tangent. */
#include <gsl/gsl_eigen.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/run/follow/follow_parts.h"

/* Residuals of an orbit: wanted, and accepted where rounding or kinks prevent that. */
static const double CONVERGED = 1e-7, ACCEPTED = 2e-6;
/* Residual that suffices where the derivative of the orbit itself follows and corrects it once more. */
static const double NEAR = 2e-6, FARTHEST = 1e-2;
/* Residual that suffices while events are located; reduction of a step that is slow. */
static const double ROUGH = 1e-5, SLOW = 0.5;
/* Newton's step that is too long to trust, in unknowns of order one. */
static const double LONGEST = 3.0;
/* Pairs outside the unit circle by less than this count as on it: rounding. */
static const double ON_CIRCLE = 1e-6;
enum { MOST_ROUNDS = 14, MOST_HALVINGS = 4, MOST_DERIVATIVES = 2 };

strut_follow_orbit *strut_follow_orbit_new(strut_follow_walk *w) {
  strut_arena *a = &w->branch->arena;
  size_t n = w->s->n;
  strut_follow_orbit *o = strut_arena_allocate(a, 1, sizeof *o);
  bool good = o && (o->y = strut_arena_allocate(a, w->s->both, sizeof(double))) &&
              (o->tangent = strut_arena_allocate(a, n + 1, sizeof(double))) &&
              (o->multiplier = strut_arena_allocate(a, n, sizeof *o->multiplier));
  if (!good) w->status = strut_no_memory(w->error, "");
  return good ? o : NULL;
}

static bool set_value(strut_follow_walk *w, double value) {
  w->status = strut_follow_set_value(w->s, value, w->error);
  return w->status == STRUT_OK;
}

static bool interrupted(strut_follow_walk *w) {
  if (!w->s->how.interrupt || !*w->s->how.interrupt) return false;
  w->status =
      strut_fail(w->error, STRUT_INTERRUPTED, "interrupted at %.9g of the parameter", w->s->value);
  return true;
}

/* normal . (x - base) - distance */
static double off_plane(const strut_follow_walk *w, const double *y, double value,
                        const double *normal, const double *base_y, double base_value,
                        double distance) {
  const strut_follow_system *s = w->s;
  double sum = normal[s->n] * (value - base_value) / (s->high - s->low) - distance;
  for (size_t i = 0; i < s->n; i++)
    sum += normal[i] * (y[s->place[i]] - base_y[s->place[i]]) / strut_follow_unit(s, i);
  return sum;
}

/* A trial of Newton's method: a state and a value, and what is left there. */
typedef struct trial {
  double *y, *f; /* (both), (n) */
  double value, left, plane;
} trial;

/* Evaluates t. False: interrupted, or the value has no scene; a lost motion has left = HUGE_VAL. */
static bool evaluate(strut_follow_walk *w, const strut_follow_section *p, trial *t) {
  if (interrupted(w) || !set_value(w, t->value)) return false;
  t->left = strut_follow_residual(w->s, t->y, t->f);
  t->plane = fabs(off_plane(w, t->y, t->value, p->normal, p->base_y, p->base_value, p->distance));
  return !interrupted(w);
}

static double size_of(const trial *t) { return fmax(t->left, t->plane); }

/* Fills w->right with Newton's step at t. False: singular, or too long to trust. */
static bool find_step(strut_follow_walk *w, const strut_follow_section *p, const trial *t) {
  const strut_follow_system *s = w->s;
  double most = 0.0;
  for (size_t i = 0; i < s->n; i++) w->right[i] = -t->f[i];
  w->right[s->n] = -off_plane(w, t->y, t->value, p->normal, p->base_y, p->base_value, p->distance);
  if (!strut_follow_solve(w->s, p->normal, w->right)) return false;
  for (size_t i = 0; i <= s->n; i++) most = fmax(most, fabs(w->right[i]));
  return most <= LONGEST;
}

/* Takes a part of the step from t to `next`. */
static bool take_step(strut_follow_walk *w, const strut_follow_section *p, const trial *t,
                      double part, trial *next) {
  strut_follow_system *s = w->s;
  memcpy(next->y, t->y, s->both * sizeof(double));
  strut_follow_move(s, next->y, w->right, part);
  next->value = t->value + part * w->right[s->n] * (s->high - s->low);
  return evaluate(w, p, next);
}

static bool differentiate_at(strut_follow_walk *w, const trial *t) {
  bool lost = false;
  if (!set_value(w, t->value)) return false;
  w->status = strut_follow_differentiate(w->s, t->y, t->f, &lost, w->error);
  return !w->status && !lost;
}

/*
 * The derivative of an earlier point serves, updated, while it makes the residual fall; where it does not,
 * a new one is made at the best point so far, and its steps are halved until the residual falls.
 */
static bool iterate(strut_follow_walk *w, const strut_follow_section *p, trial *here, trial *next,
                    int *rounds) {
  const double enough = w->rough ? ROUGH : w->s->variation && !w->exact ? NEAR : CONVERGED;
  bool wanted = !w->s->derivative.known;
  int slow = 0, made = 0;
  if (!evaluate(w, p, here) || !isfinite(here->left)) return false;
  for (*rounds = 0; *rounds < MOST_ROUNDS; ++*rounds) {
    if (size_of(here) <= enough) return true;
    bool own = wanted;
    if (own && (made++ == MOST_DERIVATIVES || !differentiate_at(w, here)))
      return size_of(here) <= ACCEPTED;
    wanted = false;
    if (!find_step(w, p, here)) {
      if (own) return false;
      wanted = true;
      continue;
    }
    double part = 1.0;
    if (!take_step(w, p, here, part, next)) return false;
    for (int k = 0; k < MOST_HALVINGS && own && !(size_of(next) < size_of(here)); k++)
      if (!take_step(w, p, here, part *= 0.5, next)) return false;
    if (!(size_of(next) < size_of(here))) {
      if (own) return size_of(here) <= ACCEPTED;
      wanted = true; /* at the better point, before this step */
      continue;
    }
    if (part == 1.0) {
      const strut_follow_border border = {1, {w->s->derivative.column}, {p->normal}};
      strut_follow_update(w->s, &border, next->f, w->right);
    }
    slow = size_of(next) > SLOW * size_of(here) ? slow + 1 : 0;
    trial keep = *here;
    *here = *next, *next = keep;
    if (slow >= 2 && size_of(here) <= ACCEPTED) return true;
    wanted = slow >= 2;
  }
  return size_of(here) <= ACCEPTED;
}

bool strut_follow_newton(strut_follow_walk *w, double *y, double *value,
                         const strut_follow_section *plane, int *rounds) {
  const strut_follow_system *s = w->s;
  trial here = {.y = w->trials, .f = w->trials + 2 * s->both, .value = *value};
  trial next = {.y = w->trials + s->both, .f = w->trials + 2 * s->both + s->n};
  memcpy(here.y, y, s->both * sizeof(double));
  *rounds = 0;
  if (!iterate(w, plane, &here, &next, rounds)) return false;
  memcpy(y, here.y, s->both * sizeof(double));
  *value = here.value;
  return true;
}

/* Travel, work and word of the orbit; `carry`: and the derivative there, and in w->f the residual. */
static bool measure(strut_follow_walk *w, strut_follow_orbit *o, bool carry) {
  strut_follow_system *s = w->s;
  if (!set_value(w, o->value)) return false;
  strut_follow_centre(s, o->y);
  memcpy(w->try_y, o->y, s->both * sizeof(double));
  strut_follow_period p =
      carry ? strut_follow_carry(s, w->try_y, true) : strut_follow_apply(s, w->try_y, true);
  if (carry) strut_follow_change(s, o->y, w->try_y, w->f);
  if (interrupted(w) || !isfinite(p.travel)) return false;
  o->velocity = p.travel / (s->period * s->how.repeats);
  o->work = p.work / s->how.repeats;
  o->amplitude = p.amplitude;
  if (!strut_follow_word_read(s, &w->branch->arena, &o->word)) {
    w->status = strut_no_memory(w->error, "");
    return false;
  }
  return true;
}

bool strut_follow_measure(strut_follow_walk *w, strut_follow_orbit *o) {
  return measure(w, o, false);
}

bool strut_follow_multipliers(const strut_follow_system *s, double *scratch,
                              double (*multiplier)[2], size_t *count) {
  size_t n = s->n;
  gsl_matrix_view view = gsl_matrix_view_array(scratch, n, n);
  gsl_eigen_nonsymm_workspace *space = gsl_eigen_nonsymm_alloc(n);
  gsl_vector_complex *values = gsl_vector_complex_alloc(n);
  memcpy(scratch, s->derivative.jacobian, n * n * sizeof(double));
  bool good = space && values;
  bool found = good && gsl_eigen_nonsymm(&view.matrix, values, space) == 0;
  *count = 0;
  for (size_t i = 0; i < n && found; i++) { /* insertion by size */
    double re = GSL_REAL(gsl_vector_complex_get(values, i));
    double im = GSL_IMAG(gsl_vector_complex_get(values, i)), size = hypot(re, im);
    size_t at = (*count)++;
    for (; at > 0 && size > hypot(multiplier[at - 1][0], multiplier[at - 1][1]); at--)
      memcpy(multiplier[at], multiplier[at - 1], sizeof multiplier[0]);
    multiplier[at][0] = re, multiplier[at][1] = im;
  }
  if (*count && s->travels) --*count;
  gsl_eigen_nonsymm_free(space);
  gsl_vector_complex_free(values);
  return good;
}

static bool find_multipliers(strut_follow_walk *w, strut_follow_orbit *o) {
  bool good = strut_follow_multipliers(w->s, w->eigen, o->multiplier, &o->multipliers);
  if (!good) w->status = strut_no_memory(w->error, "");
  return good;
}

static strut_follow_signature signature_of(const strut_follow_orbit *o, double along) {
  strut_follow_signature g = {.turn = along < 0.0 ? -1 : 1};
  int32_t complex = 0;
  for (size_t i = 0; i < o->multipliers; i++) {
    double re = o->multiplier[i][0], im = o->multiplier[i][1];
    if (!(hypot(re, im) > (im != 0.0 ? 1.0 + ON_CIRCLE : 1.0))) continue;
    if (im != 0.0)
      complex++;
    else if (re > 0.0)
      g.plus++;
    else
      g.minus++;
  }
  g.pairs = complex / 2;
  return g;
}

/* Multipliers and tangent from the derivative, which is there but for the parameter's. */
static bool complete(strut_follow_walk *w, strut_follow_orbit *o, const double *before) {
  strut_follow_system *s = w->s;
  double length = 0.0;
  bool lost = false;
  w->status = strut_follow_differentiate_parameter(s, o->y, w->f, &lost, w->error);
  if (w->status || lost || interrupted(w) || !find_multipliers(w, o)) return false;
  memset(w->right, 0, (s->n + 1) * sizeof(double));
  w->right[s->n] = 1.0;
  if (!strut_follow_solve(s, before, w->right)) return false;
  for (size_t i = 0; i <= s->n; i++) length += w->right[i] * w->right[i];
  length = sqrt(length);
  if (!(length > 0.0) || !isfinite(length)) return false;
  for (size_t i = 0; i <= s->n; i++) o->tangent[i] = w->right[i] / length;
  o->signature = signature_of(o, o->tangent[s->n]);
  o->complete = true;
  return true;
}

bool strut_follow_complete(strut_follow_walk *w, strut_follow_orbit *o, const double *before) {
  strut_follow_system *s = w->s;
  bool lost = false;
  if (o->complete) return true;
  if (!set_value(w, o->value)) return false;
  if (s->variation) {
    memcpy(w->try_y, o->y, s->both * sizeof(double));
    lost = !isfinite(strut_follow_carry(s, w->try_y, false).travel);
    strut_follow_change(s, o->y, w->try_y, w->f);
    return !lost && !interrupted(w) && complete(w, o, before);
  }
  if (!isfinite(strut_follow_residual(s, o->y, w->f))) return false;
  strut_follow_difference(s, o->y, &lost);
  return !lost && complete(w, o, before);
}

/* Moves the orbit by Newton's step from the residual w->f on the plane normal to `before`. */
static void polish(strut_follow_walk *w, strut_follow_orbit *o, const double *before) {
  strut_follow_system *s = w->s;
  double most = 0.0;
  for (size_t i = 0; i < s->n; i++) w->right[i] = -w->f[i];
  w->right[s->n] = 0.0;
  if (!strut_follow_solve(s, before, w->right)) return;
  for (size_t i = 0; i <= s->n; i++) most = fmax(most, fabs(w->right[i]));
  if (!(most < FARTHEST)) return;
  strut_follow_move(s, o->y, w->right, 1.0);
  o->value += w->right[s->n] * (s->high - s->low);
}

bool strut_follow_examine(strut_follow_walk *w, strut_follow_orbit *o, const double *before) {
  if (!w->s->variation) return measure(w, o, false) && strut_follow_complete(w, o, before);
  if (!measure(w, o, true) || !complete(w, o, before)) return false;
  polish(w, o, before);
  return true;
}

/* By inverse iteration on jacobian - value. */
bool strut_follow_eigenvector(strut_follow_walk *w, const strut_follow_orbit *o, double value,
                              double *direction) {
  strut_follow_system *s = w->s;
  size_t n = s->n;
  bool lost = false;
  if (!set_value(w, o->value) || !isfinite(strut_follow_residual(s, o->y, w->f))) return false;
  w->status = strut_follow_differentiate(s, o->y, w->f, &lost, w->error);
  if (w->status || lost) return false;
  s->derivative.known = false;
  double *matrix =
      s->derivative
          .jacobian; /* jacobian - 1 must be jacobian - value: shifted, and back by the next */
  for (size_t i = 0; i < n; i++) matrix[i * n + i] += 1.0 - value - 1e-7;
  memset(s->derivative.column, 0, n * sizeof(double));
  for (size_t i = 0; i < n; i++) direction[i] = 1.0 / (double)(i + 1);
  double *unit = strut_arena_allocate(&w->branch->arena, n + 1, sizeof(double));
  if (!unit) w->status = strut_no_memory(w->error, "");
  if (!unit) return false;
  unit[n] = 1.0;
  for (int k = 0; k < 4; k++) {
    double length = 0.0;
    memcpy(w->right, direction, n * sizeof(double));
    w->right[n] = 0.0;
    if (!strut_follow_solve(s, unit, w->right)) return false;
    for (size_t i = 0; i < n; i++) length += w->right[i] * w->right[i];
    length = sqrt(length);
    if (!(length > 0.0) || !isfinite(length)) return false;
    for (size_t i = 0; i < n; i++) direction[i] = w->right[i] / length;
  }
  return true;
}

strut_status strut_follow_correct(strut_follow_system *s, double *y, bool *found, char *reason,
                                  strut_error *error) {
  strut_follow_branch scratch = {0};
  strut_follow_walk w = {.s = s, .branch = &scratch, .error = error};
  size_t n = s->n;
  double value = s->value;
  int rounds = 0;
  *found = false;
  double *normal = strut_arena_allocate(&scratch.arena, n + 1, sizeof(double));
  double *base = strut_arena_allocate(&scratch.arena, s->both, sizeof(double));
  w.right = strut_arena_allocate(&scratch.arena, n + 1, sizeof(double));
  w.trials = strut_arena_allocate(&scratch.arena, 2 * (s->both + n), sizeof(double));
  if (!normal || !base || !w.right || !w.trials) {
    strut_arena_free(&scratch.arena);
    return strut_no_memory(error, "");
  }
  memcpy(base, y, s->both * sizeof(double));
  normal[n] = 1.0;
  s->derivative.known = false;
  w.exact = true;
  *found = strut_follow_newton(&w, base, &value, &(strut_follow_section){normal, y, value, 0.0},
                               &rounds);
  if (*found) memcpy(y, base, s->both * sizeof(double));
  if (!*found)
    snprintf(reason, 200,
             "Newton's method on the period map did not converge in %d rounds; the motion may be "
             "irregular, or one of a family, such as at rest",
             rounds);
  strut_arena_free(&scratch.arena);
  return w.status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One periodic motion: Newton's method, its multipliers, its tangents. */
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/run/follow/follow_parts.h"

/*
 * Residuals of an orbit that suffice: where the derivative of the orbit itself follows and corrects it once more; while
 * events are located; and otherwise.
 */
static const double ENOUGH[] = {
    [STRUT_FOLLOW_CLOSE] = 2e-6, [STRUT_FOLLOW_ROUGH] = 1e-5, [STRUT_FOLLOW_EXACT] = 1e-7};
/* That where rounding or kinks prevent a smaller one, and that which is too far to be corrected once more. */
static const double ACCEPTED = 2e-6, FARTHEST = 1e-2;
/* Reduction of a step that is slow; Newton's step that is too long to trust, in unknowns of order one. */
static const double SLOW = 0.5, LONGEST = 3.0;
/* Pairs outside the unit circle by less than this count as on it: rounding. */
static const double ON_CIRCLE = 1e-6;
enum { MOST_ROUNDS = 14, MOST_HALVINGS = 4, MOST_DERIVATIVES = 2 };

strut_follow_orbit *strut_follow_orbit_new(strut_follow_system *system, strut_arena *arena,
                                           const strut_follow_motion *from) {
  strut_follow_orbit *orbit = strut_follow_allocate(system, arena, 1, sizeof *orbit);
  if (!orbit) return NULL;
  orbit->at.y = strut_follow_allocate(system, arena, system->both, sizeof(double));
  orbit->multiplier = strut_follow_allocate(system, arena, system->n, sizeof *orbit->multiplier);
  for (size_t k = 0; k < system->parameters; k++)
    orbit->tangent[k] = strut_follow_allocate(system, arena, system->m, sizeof(double));
  if (system->status) return NULL;
  memcpy(orbit->at.value, from ? from->value : system->value, sizeof orbit->at.value);
  if (from) memcpy(orbit->at.y, from->y, system->both * sizeof(double));
  return orbit;
}

/* A trial of Newton's method: a motion, and what is left there of the equations and the planes. */
typedef struct trial {
  strut_follow_motion at;
  double *f; /* (n) */
  double left, off[2];
} trial;

/* Evaluates t. False: interrupted, or the value has no scene; a lost motion has left = HUGE_VAL. */
static bool evaluate(strut_follow_system *system, const strut_follow_planes *planes, trial *self) {
  double *between = system->buffers.x;
  if (strut_follow_interrupted(system) || !strut_follow_set_value(system, self->at.value))
    return false;
  self->left = strut_follow_residual(system, self->at.y, self->f);
  strut_follow_between(system, planes->base, &self->at, between);
  for (size_t k = 0; k < system->parameters; k++) {
    self->off[k] = strut_dot(planes->row[k], between, (ptrdiff_t)system->m) - planes->offset[k];
    self->left = fmax(self->left, fabs(self->off[k]));
  }
  return !strut_follow_interrupted(system);
}

static double largest_of(const strut_follow_system *system, const double *x) {
  double most = 0.0;
  for (size_t i = 0; i < system->m; i++) most = isnan(x[i]) ? HUGE_VAL : fmax(most, fabs(x[i]));
  return most;
}

/* Newton's step at t, in the buffer x. False: singular, or too long to trust. */
static bool find_step(strut_follow_system *system, const strut_follow_planes *planes,
                      const trial *self) {
  double *x = system->buffers.x;
  for (size_t i = 0; i < system->n; i++) x[i] = -self->f[i];
  for (size_t k = 0; k < system->parameters; k++) x[system->n + k] = -self->off[k];
  return strut_follow_solve(system, planes->row, x) && largest_of(system, x) <= LONGEST;
}

/* Takes a part of the step from t to `next`. */
static bool take_step(strut_follow_system *system, const strut_follow_planes *planes,
                      const trial *self, const double *step, double part, trial *next) {
  memcpy(next->at.y, self->at.y, system->both * sizeof(double));
  memcpy(next->at.value, self->at.value, sizeof next->at.value);
  strut_follow_move(system, &next->at, step, part);
  return evaluate(system, planes, next);
}

/*
 * The derivative of an earlier point serves, updated, while it makes the residual fall; where it does not,
 * a new one is made at the best point so far, and its steps are halved until the residual falls.
 */
static bool iterate(strut_follow_system *system, const strut_follow_planes *planes, trial *here,
                    trial *next, int *rounds) {
  const double enough =
      ENOUGH[system->variation || system->precision ? system->precision : STRUT_FOLLOW_EXACT];
  double step[STRUT_FOLLOW_MOST + 2];
  bool wanted = !system->derivative.known;
  int slow = 0, made = 0;
  if (!evaluate(system, planes, here) || !isfinite(here->left)) return false;
  for (*rounds = 0; *rounds < MOST_ROUNDS; ++*rounds) {
    if (here->left <= enough) return true;
    bool own = wanted;
    if (own && (made++ == MOST_DERIVATIVES ||
                !strut_follow_differentiate_states(system, &here->at, here->f) ||
                !strut_follow_differentiate_parameters(system, &here->at, here->f)))
      return here->left <= ACCEPTED;
    wanted = false;
    if (!find_step(system, planes, here)) {
      if (own) return false;
      wanted = true;
      continue;
    }
    memcpy(step, system->buffers.x, system->m * sizeof(double));
    double part = 1.0;
    if (!take_step(system, planes, here, step, part, next)) return false;
    for (int k = 0; k < MOST_HALVINGS && own && !(next->left < here->left); k++)
      if (!take_step(system, planes, here, step, part *= 0.5, next)) return false;
    if (!(next->left < here->left)) {
      if (own) return here->left <= ACCEPTED;
      wanted = true; /* at the better point, before this step */
      continue;
    }
    if (part == 1.0) strut_follow_update(system, next->f, step);
    slow = next->left > SLOW * here->left ? slow + 1 : 0;
    trial keep = *here;
    *here = *next, *next = keep;
    if (slow >= 2 && here->left <= ACCEPTED) return true;
    wanted = slow >= 2;
  }
  return here->left <= ACCEPTED;
}

bool strut_follow_newton(strut_follow_system *system, const strut_follow_planes *planes,
                         strut_follow_motion *motion, int *rounds) {
  size_t both = system->both;
  double *trials = system->buffers.trials;
  trial here = {.at = {{motion->value[0], motion->value[1]}, trials}, .f = trials + 2 * both};
  trial next = {.at.y = trials + both, .f = trials + 2 * both + system->n};
  memcpy(here.at.y, motion->y, both * sizeof(double));
  *rounds = 0;
  if (!iterate(system, planes, &here, &next, rounds)) return false;
  memcpy(motion->y, here.at.y, both * sizeof(double));
  memcpy(motion->value, here.at.value, sizeof motion->value);
  return true;
}

/* Travel, work and word of the orbit; `carry`: and the derivative there, with the residual in the buffer f. */
static bool measure(strut_follow_system *system, strut_arena *arena, strut_follow_orbit *orbit,
                    bool carry) {
  double *end = system->buffers.end;
  if (!strut_follow_set_value(system, orbit->at.value)) return false;
  strut_follow_centre(system, orbit->at.y);
  memcpy(end, orbit->at.y, system->both * sizeof(double));
  strut_follow_period p =
      carry ? strut_follow_carry(system, end, true) : strut_follow_apply(system, end, true);
  if (carry) strut_follow_change(system, orbit->at.y, end, system->buffers.f);
  if (strut_follow_interrupted(system) || !isfinite(p.travel)) return false;
  orbit->velocity = p.travel / (system->period * system->how.repeats);
  orbit->work = p.work / system->how.repeats;
  orbit->amplitude = p.amplitude;
  if (!strut_follow_word_read(system, arena, &orbit->word))
    system->status = strut_no_memory(system->error, "");
  return !system->status;
}

bool strut_follow_measure(strut_follow_system *system, strut_arena *arena,
                          strut_follow_orbit *orbit) {
  return measure(system, arena, orbit, false);
}

/*
 * Multipliers of the derivative by size; the one of shifts, 0 in it, is left out. direction (n), unless NULL:
 * eigenvector of the real one nearest to `value`.
 */
static bool find_multipliers(strut_follow_system *system, strut_follow_orbit *orbit, double value,
                             double *direction) {
  size_t n = system->n;
  gsl_matrix_view view = gsl_matrix_view_array(system->buffers.matrix, n, n);
  gsl_eigen_nonsymmv_workspace *space = gsl_eigen_nonsymmv_alloc(n);
  gsl_vector_complex *values = gsl_vector_complex_alloc(n);
  gsl_matrix_complex *vectors = gsl_matrix_complex_alloc(n, n);
  memcpy(system->buffers.matrix, system->derivative.jacobian, n * n * sizeof(double));
  bool good = space && values && vectors;
  if (!good) system->status = strut_no_memory(system->error, "");
  bool found = good && gsl_eigen_nonsymmv(&view.matrix, values, vectors, space) == 0;
  double nearest = HUGE_VAL;
  orbit->multipliers = 0;
  for (size_t i = 0; i < n && found; i++) { /* insertion by size */
    double re = GSL_REAL(gsl_vector_complex_get(values, i));
    double im = GSL_IMAG(gsl_vector_complex_get(values, i)), size = hypot(re, im);
    size_t at = orbit->multipliers++;
    double(*list)[2] = orbit->multiplier;
    for (; at > 0 && size > hypot(list[at - 1][0], list[at - 1][1]); at--)
      memcpy(list[at], list[at - 1], sizeof list[0]);
    list[at][0] = re, list[at][1] = im;
    if (!direction || im != 0.0 || !(fabs(re - value) < nearest)) continue;
    nearest = fabs(re - value);
    for (size_t j = 0; j < n; j++) direction[j] = GSL_REAL(gsl_matrix_complex_get(vectors, j, i));
  }
  if (orbit->multipliers && system->travels) orbit->multipliers--;
  gsl_eigen_nonsymmv_free(space);
  gsl_vector_complex_free(values);
  gsl_matrix_complex_free(vectors);
  return good && (!direction || isfinite(nearest));
}

static strut_follow_signature signature_of(const strut_follow_orbit *orbit, double along) {
  strut_follow_signature g = {.turn = along < 0.0 ? -1 : 1};
  int32_t complex = 0;
  for (size_t i = 0; i < orbit->multipliers; i++) {
    double re = orbit->multiplier[i][0], im = orbit->multiplier[i][1];
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

/* The null space of [jacobian - 1, columns]: the last columns of Q in the factors Q R of the transpose. */
static bool find_tangents(strut_follow_system *system, strut_follow_orbit *orbit) {
  size_t n = system->n, m = system->m;
  gsl_matrix *transpose = gsl_matrix_alloc(m, n), *q = gsl_matrix_alloc(m, m);
  gsl_matrix *r = gsl_matrix_alloc(m, n);
  gsl_vector *scale = gsl_vector_alloc(n);
  bool good = transpose && q && r && scale;
  for (size_t i = 0; i < n && good; i++) {
    for (size_t j = 0; j < n; j++)
      gsl_matrix_set(transpose, j, i, system->derivative.jacobian[i * n + j] - (i == j));
    for (size_t k = 0; n + k < m; k++)
      gsl_matrix_set(transpose, n + k, i, system->derivative.column[k][i]);
  }
  if (good) {
    gsl_linalg_QR_decomp(transpose, scale);
    gsl_linalg_QR_unpack(transpose, scale, q, r);
    for (size_t i = 0; i < m; i++)
      for (size_t k = 0; n + k < m; k++) orbit->tangent[k][i] = gsl_matrix_get(q, i, n + k);
  } else {
    system->status = strut_no_memory(system->error, "");
  }
  gsl_matrix_free(transpose);
  gsl_matrix_free(q);
  gsl_matrix_free(r);
  gsl_vector_free(scale);
  return good;
}

/* Multipliers and tangents from the derivative, which is there but for the parameters'. */
static bool complete(strut_follow_system *system, strut_follow_orbit *orbit, const double *before) {
  double *tangent = orbit->tangent[0];
  if (!strut_follow_differentiate_parameters(system, &orbit->at, system->buffers.f) ||
      !find_multipliers(system, orbit, 0.0, NULL) || !find_tangents(system, orbit))
    return false;
  bool back = before && strut_dot(tangent, before, (ptrdiff_t)system->m) < 0.0;
  for (size_t i = 0; i < system->m && back; i++) tangent[i] = -tangent[i];
  orbit->signature = signature_of(orbit, tangent[system->n]);
  return orbit->complete = largest_of(system, tangent) <= 1.0 + 1e-9;
}

bool strut_follow_complete(strut_follow_system *system, strut_follow_orbit *orbit,
                           const double *before) {
  return orbit->complete ||
         (strut_follow_differentiate_states(system, &orbit->at, system->buffers.f) &&
          !strut_follow_interrupted(system) && complete(system, orbit, before));
}

/* Moves the orbit by Newton's step from the residual in the buffer f on the plane normal to `before`. */
static void polish(strut_follow_system *system, strut_follow_orbit *orbit, const double *before) {
  const double *const rows[2] = {before};
  double *x = system->buffers.x;
  for (size_t i = 0; i < system->n; i++) x[i] = -system->buffers.f[i];
  x[system->n] = 0.0;
  if (strut_follow_solve(system, rows, x) && largest_of(system, x) < FARTHEST)
    strut_follow_move(system, &orbit->at, x, 1.0);
}

bool strut_follow_examine(strut_follow_system *system, strut_arena *arena,
                          strut_follow_orbit *orbit, const double *before) {
  if (!system->variation)
    return measure(system, arena, orbit, false) && strut_follow_complete(system, orbit, before);
  if (!measure(system, arena, orbit, true) || !complete(system, orbit, before)) return false;
  polish(system, orbit, before);
  return true;
}

bool strut_follow_eigenvector(strut_follow_system *system, const strut_follow_orbit *orbit,
                              double value, double *direction) {
  strut_follow_orbit there = *orbit;
  return strut_follow_differentiate_states(system, &orbit->at, system->buffers.f) &&
         find_multipliers(system, &there, value, direction);
}

bool strut_follow_correct(strut_follow_system *system, double *unknowns, char *reason) {
  strut_follow_motion motion = {{system->value[0], system->value[1]}, unknowns};
  const strut_follow_precision precision = system->precision;
  int rounds = 0;
  system->derivative.known = false;
  system->precision = STRUT_FOLLOW_EXACT;
  bool found = strut_follow_newton(system, &(strut_follow_planes){&motion, {system->upward}, {0.0}},
                                   &motion, &rounds);
  system->precision = precision;
  if (!found)
    snprintf(reason, 200,
             "Newton's method on the period map did not converge in %d rounds; the motion may be "
             "irregular, or one of a family, such as at rest",
             rounds);
  return found;
}

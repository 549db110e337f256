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

strut_follow_orbit *strut_follow_orbit_new(strut_follow_walk *walk) {
  strut_arena *arena = &walk->branch->arena;
  size_t n = walk->s->n;
  strut_follow_orbit *orbit = strut_arena_allocate(arena, 1, sizeof *orbit);
  bool good = orbit && (orbit->y = strut_arena_allocate(arena, walk->s->both, sizeof(double))) &&
              (orbit->tangent = strut_arena_allocate(arena, n + 1, sizeof(double))) &&
              (orbit->multiplier = strut_arena_allocate(arena, n, sizeof *orbit->multiplier));
  if (!good) walk->status = strut_no_memory(walk->error, "");
  return good ? orbit : NULL;
}

static bool set_value(strut_follow_walk *walk, double value) {
  walk->status = strut_follow_set_value(walk->s, value, walk->error);
  return walk->status == STRUT_OK;
}

static bool interrupted(strut_follow_walk *walk) {
  if (!walk->s->how.interrupt || !*walk->s->how.interrupt) return false;
  walk->status = strut_fail(walk->error, STRUT_INTERRUPTED, "interrupted at %.9g of the parameter",
                            walk->s->value);
  return true;
}

/* normal . (x - base) - distance */
static double off_plane(const strut_follow_walk *walk, const double *unknowns, double value,
                        const double *normal, const double *base_y, double base_value,
                        double distance) {
  const strut_follow_system *system = walk->s;
  double sum = normal[system->n] * (value - base_value) / (system->high - system->low) - distance;
  for (size_t i = 0; i < system->n; i++)
    sum += normal[i] * (unknowns[system->place[i]] - base_y[system->place[i]]) /
           strut_follow_unit(system, i);
  return sum;
}

/* A trial of Newton's method: a state and a value, and what is left there. */
typedef struct trial {
  double *y, *f; /* (both), (n) */
  double value, left, plane;
} trial;

/* Evaluates t. False: interrupted, or the value has no scene; a lost motion has left = HUGE_VAL. */
static bool evaluate(strut_follow_walk *walk, const strut_follow_section *section, trial *self) {
  if (interrupted(walk) || !set_value(walk, self->value)) return false;
  self->left = strut_follow_residual(walk->s, self->y, self->f);
  self->plane = fabs(off_plane(walk, self->y, self->value, section->normal, section->base_y,
                               section->base_value, section->distance));
  return !interrupted(walk);
}

static double size_of(const trial *self) { return fmax(self->left, self->plane); }

/* Fills w->right with Newton's step at t. False: singular, or too long to trust. */
static bool find_step(strut_follow_walk *walk, const strut_follow_section *section,
                      const trial *self) {
  const strut_follow_system *system = walk->s;
  double most = 0.0;
  for (size_t i = 0; i < system->n; i++) walk->right[i] = -self->f[i];
  walk->right[system->n] = -off_plane(walk, self->y, self->value, section->normal, section->base_y,
                                      section->base_value, section->distance);
  if (!strut_follow_solve(walk->s, section->normal, walk->right)) return false;
  for (size_t i = 0; i <= system->n; i++) most = fmax(most, fabs(walk->right[i]));
  return most <= LONGEST;
}

/* Takes a part of the step from t to `next`. */
static bool take_step(strut_follow_walk *walk, const strut_follow_section *section,
                      const trial *self, double part, trial *next) {
  strut_follow_system *system = walk->s;
  memcpy(next->y, self->y, system->both * sizeof(double));
  strut_follow_move(system, next->y, walk->right, part);
  next->value = self->value + part * walk->right[system->n] * (system->high - system->low);
  return evaluate(walk, section, next);
}

static bool differentiate_at(strut_follow_walk *walk, const trial *self) {
  bool lost = false;
  if (!set_value(walk, self->value)) return false;
  walk->status = strut_follow_differentiate(walk->s, self->y, self->f, &lost, walk->error);
  return !walk->status && !lost;
}

/*
 * The derivative of an earlier point serves, updated, while it makes the residual fall; where it does not,
 * a new one is made at the best point so far, and its steps are halved until the residual falls.
 */
static bool iterate(strut_follow_walk *walk, const strut_follow_section *section, trial *here,
                    trial *next, int *rounds) {
  const double enough = walk->rough ? ROUGH : walk->s->variation && !walk->exact ? NEAR : CONVERGED;
  bool wanted = !walk->s->derivative.known;
  int slow = 0, made = 0;
  if (!evaluate(walk, section, here) || !isfinite(here->left)) return false;
  for (*rounds = 0; *rounds < MOST_ROUNDS; ++*rounds) {
    if (size_of(here) <= enough) return true;
    bool own = wanted;
    if (own && (made++ == MOST_DERIVATIVES || !differentiate_at(walk, here)))
      return size_of(here) <= ACCEPTED;
    wanted = false;
    if (!find_step(walk, section, here)) {
      if (own) return false;
      wanted = true;
      continue;
    }
    double part = 1.0;
    if (!take_step(walk, section, here, part, next)) return false;
    for (int k = 0; k < MOST_HALVINGS && own && !(size_of(next) < size_of(here)); k++)
      if (!take_step(walk, section, here, part *= 0.5, next)) return false;
    if (!(size_of(next) < size_of(here))) {
      if (own) return size_of(here) <= ACCEPTED;
      wanted = true; /* at the better point, before this step */
      continue;
    }
    if (part == 1.0) {
      const strut_follow_border border = {1, {walk->s->derivative.column}, {section->normal}};
      strut_follow_update(walk->s, &border, next->f, walk->right);
    }
    slow = size_of(next) > SLOW * size_of(here) ? slow + 1 : 0;
    trial keep = *here;
    *here = *next, *next = keep;
    if (slow >= 2 && size_of(here) <= ACCEPTED) return true;
    wanted = slow >= 2;
  }
  return size_of(here) <= ACCEPTED;
}

bool strut_follow_newton(strut_follow_walk *walk, double *unknowns, double *value,
                         const strut_follow_section *plane, int *rounds) {
  const strut_follow_system *system = walk->s;
  trial here = {.y = walk->trials, .f = walk->trials + 2 * system->both, .value = *value};
  trial next = {.y = walk->trials + system->both, .f = walk->trials + 2 * system->both + system->n};
  memcpy(here.y, unknowns, system->both * sizeof(double));
  *rounds = 0;
  if (!iterate(walk, plane, &here, &next, rounds)) return false;
  memcpy(unknowns, here.y, system->both * sizeof(double));
  *value = here.value;
  return true;
}

/* Travel, work and word of the orbit; `carry`: and the derivative there, and in w->f the residual. */
static bool measure(strut_follow_walk *walk, strut_follow_orbit *orbit, bool carry) {
  strut_follow_system *system = walk->s;
  if (!set_value(walk, orbit->value)) return false;
  strut_follow_centre(system, orbit->y);
  memcpy(walk->try_y, orbit->y, system->both * sizeof(double));
  strut_follow_period p = carry ? strut_follow_carry(system, walk->try_y, true)
                                : strut_follow_apply(system, walk->try_y, true);
  if (carry) strut_follow_change(system, orbit->y, walk->try_y, walk->f);
  if (interrupted(walk) || !isfinite(p.travel)) return false;
  orbit->velocity = p.travel / (system->period * system->how.repeats);
  orbit->work = p.work / system->how.repeats;
  orbit->amplitude = p.amplitude;
  if (!strut_follow_word_read(system, &walk->branch->arena, &orbit->word)) {
    walk->status = strut_no_memory(walk->error, "");
    return false;
  }
  return true;
}

bool strut_follow_measure(strut_follow_walk *walk, strut_follow_orbit *orbit) {
  return measure(walk, orbit, false);
}

bool strut_follow_multipliers(const strut_follow_system *system, double *scratch,
                              double (*multiplier)[2], size_t *count) {
  size_t n = system->n;
  gsl_matrix_view view = gsl_matrix_view_array(scratch, n, n);
  gsl_eigen_nonsymm_workspace *space = gsl_eigen_nonsymm_alloc(n);
  gsl_vector_complex *values = gsl_vector_complex_alloc(n);
  memcpy(scratch, system->derivative.jacobian, n * n * sizeof(double));
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
  if (*count && system->travels) --*count;
  gsl_eigen_nonsymm_free(space);
  gsl_vector_complex_free(values);
  return good;
}

static bool find_multipliers(strut_follow_walk *walk, strut_follow_orbit *orbit) {
  bool good =
      strut_follow_multipliers(walk->s, walk->eigen, orbit->multiplier, &orbit->multipliers);
  if (!good) walk->status = strut_no_memory(walk->error, "");
  return good;
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

/* Multipliers and tangent from the derivative, which is there but for the parameter's. */
static bool complete(strut_follow_walk *walk, strut_follow_orbit *orbit, const double *before) {
  strut_follow_system *system = walk->s;
  double length = 0.0;
  bool lost = false;
  walk->status =
      strut_follow_differentiate_parameter(system, orbit->y, walk->f, &lost, walk->error);
  if (walk->status || lost || interrupted(walk) || !find_multipliers(walk, orbit)) return false;
  memset(walk->right, 0, (system->n + 1) * sizeof(double));
  walk->right[system->n] = 1.0;
  if (!strut_follow_solve(system, before, walk->right)) return false;
  for (size_t i = 0; i <= system->n; i++) length += walk->right[i] * walk->right[i];
  length = sqrt(length);
  if (!(length > 0.0) || !isfinite(length)) return false;
  for (size_t i = 0; i <= system->n; i++) orbit->tangent[i] = walk->right[i] / length;
  orbit->signature = signature_of(orbit, orbit->tangent[system->n]);
  orbit->complete = true;
  return true;
}

bool strut_follow_complete(strut_follow_walk *walk, strut_follow_orbit *orbit,
                           const double *before) {
  strut_follow_system *system = walk->s;
  bool lost = false;
  if (orbit->complete) return true;
  if (!set_value(walk, orbit->value)) return false;
  if (system->variation) {
    memcpy(walk->try_y, orbit->y, system->both * sizeof(double));
    lost = !isfinite(strut_follow_carry(system, walk->try_y, false).travel);
    strut_follow_change(system, orbit->y, walk->try_y, walk->f);
    return !lost && !interrupted(walk) && complete(walk, orbit, before);
  }
  if (!isfinite(strut_follow_residual(system, orbit->y, walk->f))) return false;
  strut_follow_difference(system, orbit->y, &lost);
  return !lost && complete(walk, orbit, before);
}

/* Moves the orbit by Newton's step from the residual w->f on the plane normal to `before`. */
static void polish(strut_follow_walk *walk, strut_follow_orbit *orbit, const double *before) {
  strut_follow_system *system = walk->s;
  double most = 0.0;
  for (size_t i = 0; i < system->n; i++) walk->right[i] = -walk->f[i];
  walk->right[system->n] = 0.0;
  if (!strut_follow_solve(system, before, walk->right)) return;
  for (size_t i = 0; i <= system->n; i++) most = fmax(most, fabs(walk->right[i]));
  if (!(most < FARTHEST)) return;
  strut_follow_move(system, orbit->y, walk->right, 1.0);
  orbit->value += walk->right[system->n] * (system->high - system->low);
}

bool strut_follow_examine(strut_follow_walk *walk, strut_follow_orbit *orbit,
                          const double *before) {
  if (!walk->s->variation)
    return measure(walk, orbit, false) && strut_follow_complete(walk, orbit, before);
  if (!measure(walk, orbit, true) || !complete(walk, orbit, before)) return false;
  polish(walk, orbit, before);
  return true;
}

/* By inverse iteration on jacobian - value. */
bool strut_follow_eigenvector(strut_follow_walk *walk, const strut_follow_orbit *orbit,
                              double value, double *direction) {
  strut_follow_system *system = walk->s;
  size_t n = system->n;
  bool lost = false;
  if (!set_value(walk, orbit->value) || !isfinite(strut_follow_residual(system, orbit->y, walk->f)))
    return false;
  walk->status = strut_follow_differentiate(system, orbit->y, walk->f, &lost, walk->error);
  if (walk->status || lost) return false;
  system->derivative.known = false;
  double *matrix =
      system->derivative
          .jacobian; /* jacobian - 1 must be jacobian - value: shifted, and back by the next */
  for (size_t i = 0; i < n; i++) matrix[i * n + i] += 1.0 - value - 1e-7;
  memset(system->derivative.column, 0, n * sizeof(double));
  for (size_t i = 0; i < n; i++) direction[i] = 1.0 / (double)(i + 1);
  double *unit = strut_arena_allocate(&walk->branch->arena, n + 1, sizeof(double));
  if (!unit) walk->status = strut_no_memory(walk->error, "");
  if (!unit) return false;
  unit[n] = 1.0;
  for (int k = 0; k < 4; k++) {
    double length = 0.0;
    memcpy(walk->right, direction, n * sizeof(double));
    walk->right[n] = 0.0;
    if (!strut_follow_solve(system, unit, walk->right)) return false;
    for (size_t i = 0; i < n; i++) length += walk->right[i] * walk->right[i];
    length = sqrt(length);
    if (!(length > 0.0) || !isfinite(length)) return false;
    for (size_t i = 0; i < n; i++) direction[i] = walk->right[i] / length;
  }
  return true;
}

strut_status strut_follow_correct(strut_follow_system *system, double *unknowns, bool *found,
                                  char *reason, strut_error *error) {
  strut_follow_branch scratch = {0};
  strut_follow_walk w = {.s = system, .branch = &scratch, .error = error};
  size_t n = system->n;
  double value = system->value;
  int rounds = 0;
  *found = false;
  double *normal = strut_arena_allocate(&scratch.arena, n + 1, sizeof(double));
  double *base = strut_arena_allocate(&scratch.arena, system->both, sizeof(double));
  w.right = strut_arena_allocate(&scratch.arena, n + 1, sizeof(double));
  w.trials = strut_arena_allocate(&scratch.arena, 2 * (system->both + n), sizeof(double));
  if (!normal || !base || !w.right || !w.trials) {
    strut_arena_free(&scratch.arena);
    return strut_no_memory(error, "");
  }
  memcpy(base, unknowns, system->both * sizeof(double));
  normal[n] = 1.0;
  system->derivative.known = false;
  w.exact = true;
  *found = strut_follow_newton(&w, base, &value,
                               &(strut_follow_section){normal, unknowns, value, 0.0}, &rounds);
  if (*found) memcpy(unknowns, base, system->both * sizeof(double));
  if (!*found)
    snprintf(reason, 200,
             "Newton's method on the period map did not converge in %d rounds; the motion may be "
             "irregular, or one of a family, such as at rest",
             rounds);
  strut_arena_free(&scratch.arena);
  return w.status;
}

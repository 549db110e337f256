/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Limit points and bifurcations: where eigenvalues of the stiffness pass zero on a piece of a path. */
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_sort_vector.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/statics/algebra.h"
#include "engine/statics/path/path_parts.h"

static const double COUPLED = 1e-6;  /* of the load: what a null vector feels at a limit point */
static const double WEAKLY = 1e-2;   /* likewise, at a bifurcation that is one but for rounding */
static const double TOGETHER = 1e-9; /* [units of y] what vanishes so near does so at once */
static const double VANISHED = 1e-5; /* of its value at the ends: an eigenvalue that is zero */
static const double LEVEL = 1e-3;  /* rate of the parameter along a path that may be at its limit */
static const double ONWARD = 0.02; /* change of the parameter over a branch that continues */

int32_t strut_path_most_moved(const strut_path_system *system, const double *mode) {
  int32_t best = 0;
  double most = -1;
  for (int32_t i = 0; i < system->n; i++) {
    int32_t at = system->potential->coordinate[i];
    double square = mode[i] * mode[i];
    if (i > 0 && system->potential->coordinate[i - 1] == at - 1 && at % 2 == 1)
      square += mode[i - 1] * mode[i - 1];
    if (square > most * (1 + 1e-9)) most = square, best = at / 2;
  }
  return best;
}

/* The share of a unit vector that the parameter works on. */
static double coupling(const strut_path_system *system, const double *mode) {
  const double *slope = system->latest.slope;
  double load = strut_dot(slope, slope, system->n);
  return load > 0 ? fabs(strut_dot(slope, mode, system->n)) / sqrt(load) : 0;
}

bool strut_path_turns_back(const strut_path_walk *walk) {
  double a = walk->tangent[walk->system.n], b = walk->next_tangent[walk->system.n], level = 1e-9;
  return (a > level && b < -level) || (a < -level && b > level);
}

const char *strut_path_subject(const strut_path_walk *walk) {
  return walk->path->over == STRUT_PATH_OVER_LOAD ? "the factor" : walk->path->name;
}

const char *strut_path_turn(const strut_path_walk *walk, double turn) {
  bool grew = (turn > 0) == (walk->system.parameter.range > 0);
  if (turn > 0) return grew ? "can grow no further" : "can fall no further";
  return grew ? "falls again from" : "grows again from";
}

/* Eigenvalues that are zero at y, beside what they are at the ends of the piece; `vectors` remain. */
static int32_t count_null(strut_path_walk *walk, const strut_path_piece *piece,
                          const double *unknowns, int32_t *first) {
  strut_path_system *system = &walk->system;
  int32_t count = 0;
  for (int32_t i = 0; i < system->n; i++) walk->scale[i] = 0;
  for (int end = 0; end < 2; end++) {
    if (!strut_path_spectrum(system, end ? piece->to : piece->from)) return 0;
    for (int32_t i = 0; i < system->n; i++)
      walk->scale[i] = fmax(walk->scale[i], fabs(system->spectrum.value[i]));
  }
  if (!strut_path_spectrum(system, unknowns)) return 0;
  for (int32_t i = 0; i < system->n; i++)
    if (fabs(system->spectrum.value[i]) <= VANISHED * walk->scale[i])
      if (!count++) *first = i;
  return count;
}

/* What is known of a place where eigenvalues vanish. */
typedef struct critical {
  int32_t null, node; /* dimension of the kernel; the node that moves most in it */
  bool limit;         /* the parameter works on the kernel, and turns back */
  int32_t before, after;
} critical;

/* Does no contact slide, and no cable rub? Then the stiffness is symmetric. */
static bool is_symmetric(const strut_path_system *system) {
  for (int32_t i = 0; i < system->model->contacts.count; i++) {
    const strut_path_contact *own = &system->contacts.contact[i];
    if (own->grips && own->touches && !own->sticks) return false;
  }
  return !strut_path_has_rubbing(system);
}

/* Where the parameter turns back though no load works on what vanishes, another path may lead on. */
static const strut_path_ray *find_way_on(const strut_path_walk *walk, const strut_path_rays *rays) {
  const strut_path_ray *best = NULL;
  double sense = walk->tangent[walk->system.n] > 0 ? 1 : -1;
  for (int32_t k = 0; k < rays->count; k++) {
    const strut_path_ray *ray = &rays->ray[k];
    if (ray->own || !(sense * ray->direction[walk->system.n] > ONWARD)) continue;
    if (!best || ray->negative < best->negative) best = ray;
  }
  return best;
}

static void report(strut_path_walk *walk, const double *unknowns, const critical *self,
                   bool leads_on) {
  char detail[300], kernel[80] = "";
  const char *name = walk->system.model->scene->nodes[self->node].name;
  const char *stable = self->before == 0 && self->after > 0   ? ", unstable from here"
                       : self->after == 0 && self->before > 0 ? ", stable from here"
                                                              : "";
  if (self->null > 1)
    snprintf(kernel, sizeof kernel, " (the kernel has %d dimensions)", (int)self->null);
  if (self->limit)
    snprintf(detail, sizeof detail, "%s %s here%s; %s moves most%s", strut_path_subject(walk),
             strut_path_turn(walk, walk->tangent[walk->system.n]), kernel, name, stable);
  else if (leads_on)
    snprintf(detail, sizeof detail,
             "the path ends in another one%s and goes on along it: %s moves most on the one that "
             "ends%s",
             kernel, name, stable);
  else
    snprintf(detail, sizeof detail, "%s%s: %s moves most on %s%s",
             self->null > 1 ? "other paths branch off" : "another path branches off", kernel, name,
             self->null > 1 ? "one" : "it", stable);
  strut_path_add_event(walk, self->limit ? STRUT_PATH_LIMIT : STRUT_PATH_BIFURCATION, unknowns,
                       self->node, self->before, self->after, detail);
}

/* Eigenvalues that vanish together at y: a limit point or a fork. True: the path goes on along `way`. */
static bool meet_critical(strut_path_walk *walk, const strut_path_piece *piece,
                          const double *unknowns, critical *self, strut_path_ray *way) {
  strut_path_system *system = &walk->system;
  int32_t crossed = self->after - self->before, first = 0;
  double works = 0;
  self->null = count_null(walk, piece, unknowns, &first);
  if (!self->null) { /* it passes within rounding: nearest to zero */
    self->null = 1;
    for (int32_t i = 1; i < system->n; i++)
      if (fabs(system->spectrum.value[i]) < fabs(system->spectrum.value[first])) first = i;
  }
  if (self->null < abs(crossed)) self->null = abs(crossed);
  for (int32_t k = first; k < first + self->null && k < system->n; k++) {
    works = fmax(works, coupling(system, strut_path_mode(system, k)));
    if (k == first) self->node = strut_path_most_moved(system, strut_path_mode(system, k));
  }
  /* what the parameter works on turns it back, though by less than rounding where a kink is near */
  double rate = fmin(fabs(walk->tangent[system->n]), fabs(walk->next_tangent[system->n]));
  bool turned = strut_path_turns_back(walk) ||
                (rate < LEVEL && works > WEAKLY && self->null == 1 && is_symmetric(system));
  bool fork = !turned || works < WEAKLY; /* at a limit point that rounding makes of one, too */
  bool ends = turned && fork && walk->forks.path == 0; /* branches go on smoothly */
  strut_path_rays rays = {0};
  if (ends || ((fork || self->null > 1) && strut_path_wants_fork(walk, unknowns)))
    strut_path_find_rays(walk, unknowns, &rays);
  const strut_path_ray *on = ends ? find_way_on(walk, &rays) : NULL;
  if (on) *way = *on, self->after = on->negative, self->null = rays.null;
  self->limit = turned && works > COUPLED && !on;
  report(walk, unknowns, self, on != NULL);
  if (rays.count) strut_path_keep_fork(walk, unknowns, &rays, on);
  return on != NULL;
}

double strut_path_measure_turn(strut_path_system *system, const double *unknowns,
                               const strut_path_piece *piece, int32_t which) {
  (void)which;
  if (!strut_path_tangent(system, unknowns, piece->tangent, system->latest.row)) return (double)NAN;
  return system->latest.row[system->n];
}

/* The part of a piece that is known to have all that changes on it, or all of it. */
static strut_path_piece narrowed(const strut_path_walk *walk, const strut_path_piece *piece) {
  const double *row = walk->part.tangent;
  strut_path_piece part = {walk->part.from, row, walk->part.to, 0};
  part.length = strut_path_dot(walk, row, part.to) - strut_path_dot(walk, row, part.from);
  double end = strut_path_dot(walk, piece->tangent, part.to) -
               strut_path_dot(walk, piece->tangent, piece->from);
  return walk->part.known && end <= piece->length ? part : *piece;
}

bool strut_path_find_criticals(strut_path_walk *walk, const strut_path_piece *whole,
                               strut_path_ray *way) {
  strut_path_system *system = &walk->system;
  const strut_path_piece part = narrowed(walk, whole), *piece = &part;
  if (!strut_path_spectrum(system, whole->to)) return false;
  int32_t before = walk->negative, after = system->spectrum.negative,
          folded = system->spectrum.folded;
  int32_t sense = after > before ? 1 : -1, count = sense * (after - before), i = 0;
  bool turned = strut_path_turns_back(walk), leads_on = false, met = false;
  for (int32_t k = 0; k < system->n; k++) walk->earlier_values[k] = walk->values[k];
  strut_path_keep_values(walk);
  walk->earlier = walk->negative < 0 ? 0.0 : strut_path_distance(walk, whole->from, whole->to);
  walk->negative = after;
  if (before < 0 || !(piece->length > 0)) return false;
  while (i < count && !leads_on) {
    int32_t which = (sense > 0 ? before + i : before - 1 - i) - folded, last = i + 1;
    double place =
               strut_path_locate(system, piece, strut_path_measure_eigenvalue, which, walk->fork),
           next;
    for (; place >= 0 && last < count; last++) {
      next = strut_path_locate(system, piece, strut_path_measure_eigenvalue,
                               which + sense * (last - i), walk->trial);
      if (!(fabs(next - place) <= TOGETHER)) break;
    }
    critical c = {.before = before + sense * i, .after = before + sense * last};
    i = last;
    /* no sign at one end: a loose part, neutral there, and no branch */
    if (place < 0) continue;
    leads_on = meet_critical(walk, piece, walk->fork, &c, way);
    met = true;
  }
  if (turned && !met &&
      strut_path_locate(system, piece, strut_path_measure_turn, -1, walk->fork) >= 0) {
    critical c = {.before = before, .after = after};
    leads_on = meet_critical(walk, piece, walk->fork, &c, way);
  }
  return leads_on;
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
static const double ZERO_VALUE = 1e-13; /* of a soft mode's largest parts: no sign below this */
static const double NO_VALUE = 1e-15;   /* of the largest eigenvalue, likewise */
static const double ROUNDING = 2e-16;   /* of a double */
static const double NEUTRAL =
    1e-9; /* likewise: a motion that an event has found without stiffness */
static const double UNSTRESSED =
    1e-10; /* of the largest eigenvalue: what rounding lends to a mechanism */

/* The stiffness seen by the modes first, first + 1, ...; returns the largest part that one force has in one of them. */
static double project(strut_path_system *system, int32_t first, int32_t count, double *sum) {
  double parts = 0.0, noise[MOST_SOFT] = {0}, along[MOST_SOFT], across[MOST_SOFT];
  memset(sum, 0, (size_t)(count * count) * sizeof *sum);
  strut_mode_form form = {.model = system->model,
                          .row_of = system->potential->row_of,
                          .count = count,
                          .vector = strut_path_mode(system, first),
                          .mode_step = (size_t)system->n,
                          .row_step = 1,
                          .sum = sum,
                          .noise = noise,
                          .along = along,
                          .across = across};
  for (int32_t i = 0; i < strut_force_count(system->model, true); i++) {
    const strut_force *force = &system->force[i];
    if (!force->pose.acts) continue;
    strut_mode_form_add(&form, force, system->latest.q);
    for (int32_t k = 0; k < count; k++)
      parts = fmax(parts, fmax(fabs(force->pose.slope) * along[k] * along[k],
                               fabs(force->across) * across[k] * across[k]));
  }
  for (int32_t i = 0; i < system->held.count; i++)
    for (int32_t k = 0; k < count; k++) {
      along[k] = strut_dot(system->held.motion + i * system->n, strut_path_mode(system, first + k),
                           system->n);
      for (int32_t l = 0; l <= k; l++) sum[k * count + l] += system->held.by * along[k] * along[l];
    }
  for (int32_t k = 0; k < count; k++)
    for (int32_t l = 0; l < k; l++) sum[l * count + k] = sum[k * count + l];
  system->spectrum.soft_parts = form.part;
  return fmax(form.part, parts);
}

/* Ritz values and vectors in place of the soft eigenvalues; false: out of memory. */
static bool refine(strut_path_system *system, int32_t first, int32_t count) {
  double form[MOST_SOFT * MOST_SOFT], turn[MOST_SOFT * MOST_SOFT], column[MOST_SOFT];
  double *soft = strut_path_mode(system, first);
  project(system, first, count, form);
  if (!strut_symmetric_eigen(form, (size_t)count, system->spectrum.value + first, turn))
    return false;
  for (int32_t i = 0; i < system->n; i++) {
    for (int32_t k = 0; k < count; k++) column[k] = soft[k * system->n + i];
    for (int32_t k = 0; k < count; k++)
      soft[k * system->n + i] = strut_dot(turn + k * count, column, count);
  }
  return true;
}

/* The largest stiffness that tension lends: what a soft eigenvalue is a difference of. */
static double largest_across(const strut_path_system *system) {
  double most = 0;
  for (int32_t j = 0; j < system->model->members.count; j++)
    if (system->force[j].pose.acts) most = fmax(most, fabs(system->force[j].across));
  return most;
}

/* The soft eigenvalues are contiguous: index of the first and their number, nearest to zero. */
static int32_t find_soft(const strut_path_system *system, double below, int32_t *first) {
  const double *value = system->spectrum.value;
  int32_t count = 0, nearest = 0;
  for (int32_t i = 1; i < system->n; i++)
    if (fabs(value[i]) < fabs(value[nearest])) nearest = i;
  *first = nearest;
  if (fabs(value[nearest]) > below) return 0;
  while (*first > 0 && nearest - *first < MOST_SOFT / 2 && fabs(value[*first - 1]) <= below)
    --*first;
  while (*first + count < system->n && count < MOST_SOFT && fabs(value[*first + count]) <= below)
    count++;
  return count;
}

void strut_path_keep_values(strut_path_walk *walk) {
  strut_path_system *system = &walk->system;
  memcpy(walk->values, system->spectrum.value, (size_t)system->n * sizeof *walk->values);
  if (!strut_path_is_loose(system, NEUTRAL)) system->lends = false;
}

bool strut_path_is_loose(const strut_path_system *system, double share) {
  double least = HUGE_VAL;
  for (int32_t i = 0; i < system->n; i++) least = fmin(least, fabs(system->spectrum.value[i]));
  return least <= share * strut_path_largest_value(system);
}

int32_t strut_path_find_mechanisms(strut_path_system *system, const double *unknowns,
                                   int32_t *first) {
  double sum[MOST_SOFT * MOST_SOFT];
  int32_t count = 0;
  if (!strut_path_spectrum(system, unknowns)) return 0;
  double most = strut_path_largest_value(system);
  for (int32_t i = 0; i < system->n && count < MOST_SOFT; i++) {
    if (system->spectrum.value[i] < -NEUTRAL * most) return 0;
    if (system->spectrum.value[i] <= NEUTRAL * most && !count++) *first = i;
  }
  bool stressed = count && project(system, *first, count, sum) > UNSTRESSED * most;
  return stressed ? 0 : count;
}

/* Where a contact slides: eigenvalues by their real parts, which are those that pass through zero. */
static bool find_unsymmetric(strut_path_system *system) {
  size_t n = (size_t)system->n;
  gsl_vector_complex *values = gsl_vector_complex_alloc(n);
  gsl_matrix_complex *vectors = gsl_matrix_complex_alloc(n, n);
  gsl_eigen_nonsymmv_workspace *eigen = gsl_eigen_nonsymmv_alloc(n);
  gsl_permutation *order = gsl_permutation_alloc(n);
  gsl_matrix_view work = gsl_matrix_view_array(system->spectrum.work, n, n);
  bool found = values && vectors && eigen && order;
  found = found && gsl_eigen_nonsymmv(&work.matrix, values, vectors, eigen) == 0;
  if (found) {
    const gsl_vector_view real = gsl_vector_complex_real(values);
    gsl_sort_vector_index(order, &real.vector);
    for (size_t k = 0; k < n; k++) {
      size_t from = gsl_permutation_get(order, k);
      system->spectrum.value[k] = gsl_vector_get(&real.vector, from);
      for (size_t i = 0; i < n; i++)
        strut_path_mode(system, (int32_t)k)[i] = GSL_REAL(gsl_matrix_complex_get(vectors, i, from));
    }
    double largest = fmax(fabs(system->spectrum.value[0]), fabs(system->spectrum.value[n - 1]));
    system->spectrum.noise = ROUNDING * largest;
    for (size_t k = 0; k < n; k++)
      system->spectrum.negative += system->spectrum.value[k] < -system->spectrum.noise;
  }
  gsl_vector_complex_free(values);
  gsl_matrix_complex_free(vectors);
  gsl_eigen_nonsymmv_free(eigen);
  gsl_permutation_free(order);
  return found;
}

/* Elements on a piece of their law that goes back: each is unstable by itself, whatever holds its ends. */
static int32_t count_folded(const strut_path_system *system) {
  int32_t count = 0;
  for (int32_t i = 0; i < system->model->elements.count; i++) {
    const strut_element *element = &system->model->elements.element[i];
    const strut_path_element *own = &system->elements.element[i];
    count += own->acts && strut_law_way(element->law, &element->numbers, own->piece) < 0;
  }
  return count;
}

bool strut_path_spectrum(strut_path_system *system, const double *unknowns) {
  int32_t n = system->n, first;
  double *value = system->spectrum.value;
  if (!strut_path_evaluate(system, unknowns)) return false;
  system->spectrum.negative = system->spectrum.folded = count_folded(system);
  if (n == 0) return true;
  memcpy(system->spectrum.work, system->algebra.hessian->data, (size_t)(n * n) * sizeof(double));
  if (!is_symmetric(system)) return find_unsymmetric(system);
  if (!strut_eigen_ascending(system->spectrum.work, n, value, system->spectrum.vector))
    return false;
  double largest = fmax(fabs(value[0]), fabs(value[n - 1]));
  int32_t soft = find_soft(system, SOFT * largest, &first);
  if (soft && !refine(system, first, soft)) return false;
  double parts = fmax(largest_across(system), soft ? system->spectrum.soft_parts : 0.0);
  double zero = fmax(ZERO_VALUE * parts, NO_VALUE * largest);
  system->spectrum.noise = ROUNDING * largest;
  for (int32_t i = 0; i < n; i++) {
    bool is_soft = i >= first && i < first + soft;
    system->spectrum.negative += value[i] < (is_soft ? -zero : 0.0);
  }
  return true;
}

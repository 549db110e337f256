/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * All paths that leave a point where eigenvalues of the stiffness vanish (Lyapunov and Schmidt's reduction).
 *
 * With the forces N b allowed, N the kernel, each small z along kernel and parameter has one solution of
 * F(y) + N b = 0; where b(z) = 0 there is equilibrium. On a sphere |z| = r the function b is a polynomial of
 * third order but for r^4: fitted to its values, its zeros are found from many starts, always the same ones,
 * and each is corrected by the full equations.
 */
#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/statics/algebra.h"
#include "engine/statics/path/path_parts.h"

enum {
  MOST_NULL = STRUT_PATH_KERNEL,
  MOST_SPACE = MOST_NULL + 1,
  MOST_TERMS = 84 + 28, /* products of three and of two of seven numbers */
  ROOT_ITERATIONS = 40,
  STARTS = 300 /* for each dimension twice as many */
};

static const double RADII[] = {2e-3, 5e-4, 1e-4, 2e-5, 4e-6}; /* of spheres tried [units of y] */
static const double ROUNDED = 3.0; /* roundings of the stiffness, over the size */
static const double WITHIN = 2.0;  /* changes over a radius: an eigenvalue that vanishes inside */
static const double FITTED = 3e-4; /* of its largest coefficient: what the polynomial may miss */
static const double ROOT = 1e-11,
                    SMALL_STEP = 0.4; /* of the polynomial's zeros, on the unit sphere */
static const double APART = 0.02;     /* of the radius: zeros that are not one */
static const double OWN = 0.4; /* of the radius: farthest from the path that is walked, its own */

typedef struct reduction {
  strut_path_walk *w;
  const double *centre; /* (2 n + 2) */
  int32_t null, space;  /* dimensions of the kernel; with the parameter */
  double radius, stiff; /* stiff: the largest eigenvalue, times the size [N] */
  double *basis;        /* (space, n + 1), orthonormal: the kernel, then the rest of the plane */
  double *y, *own[2];   /* (2 n + 2) scratch; the path that is walked, before and after */
  strut_arena arena;
  int terms;  /* of the polynomial */
  bool rough; /* it misses b */
  double polynomial[MOST_NULL][MOST_TERMS];
} reduction;

/* self->y becomes the solution over centre + radius z, and b (null) what equilibrium lacks there. */
static bool reduce(reduction *self, const double *z, double *b) {
  int32_t count = self->w->system.n + 1;
  double place[MOST_SPACE];
  memcpy(self->y, self->centre, strut_path_bytes(self->w));
  for (int32_t k = 0; k < self->space; k++) {
    const double *row = self->basis + k * count;
    place[k] = strut_dot(row, self->centre, count) + strut_dot(row, self->centre + count, count) +
               self->radius * z[k];
    for (int32_t j = 0; j < count; j++) self->y[j] += self->radius * z[k] * row[j];
  }
  const strut_path_planes planes = {self->null, self->basis, place, self->stiff, self->radius, b};
  return strut_path_correct_on(&self->w->system, &planes, self->y) >= 0;
}

/* Products of three and of two of the numbers z, and their derivatives; returns how many. */
static int list_terms(int d, const double *z, double *value, double (*rate)[MOST_SPACE]) {
  int count = 0;
  for (int i = 0; i < d; i++)
    for (int j = i; j < d; j++)
      for (int k = j; k <= d; k++, count++) { /* k = d: a product of two */
        double third = k < d ? z[k] : 1.0;
        value[count] = z[i] * z[j] * third;
        if (!rate) continue;
        memset(rate[count], 0, sizeof rate[count]);
        rate[count][i] += z[j] * third;
        rate[count][j] += z[i] * third;
        if (k < d) rate[count][k] += z[i] * z[j];
      }
  return count;
}

/* Unit vectors that are the same in each run. */
static void choose_direction(uint64_t *seed, int d, double *z) {
  double square;
  do {
    square = 0;
    for (int k = 0; k < d; k++) {
      *seed = *seed * 6364136223846793005u + 1442695040888963407u;
      z[k] = (double)(*seed >> 11) / 4503599627370496.0 - 1.0;
      square += z[k] * z[k];
    }
  } while (!(square > 0.01 && square <= 1.0));
  for (int k = 0; k < d; k++) z[k] /= sqrt(square);
}

/* Fits the polynomial to b at pairs of opposite points on the sphere; false: somewhere there is none. */
static bool fit_polynomial(reduction *self) {
  int d = self->space;
  double z[MOST_SPACE] = {0}, b[MOST_NULL], terms[MOST_TERMS];
  self->terms = list_terms(d, z, terms, NULL);
  size_t pairs = (size_t)self->terms, rows = 2 * pairs, columns = (size_t)self->terms;
  gsl_matrix *matrix = strut_arena_matrix(&self->arena, rows, columns);
  gsl_matrix *values = strut_arena_matrix(&self->arena, rows, MOST_NULL);
  gsl_vector *tau = strut_arena_vector(&self->arena, columns);
  gsl_vector *vector = strut_arena_vector(&self->arena, columns);
  gsl_vector *left = strut_arena_vector(&self->arena, rows);
  bool made = matrix && values && tau && vector && left;
  self->w->failed = self->w->failed || !made;
  uint64_t seed = 59;
  for (size_t i = 0; i < rows && made; i++) {
    if (i % 2 == 0) choose_direction(&seed, d, z);
    for (int k = 0; k < d && i % 2; k++) z[k] = -z[k];
    made = reduce(self, z, b);
    list_terms(d, z, terms, NULL);
    for (size_t k = 0; k < columns; k++) gsl_matrix_set(matrix, i, k, terms[k]);
    for (int32_t k = 0; k < self->null && made; k++) gsl_matrix_set(values, i, (size_t)k, b[k]);
  }
  if (made) gsl_linalg_QR_decomp(matrix, tau);
  for (int32_t k = 0; k < self->null && made; k++) {
    gsl_vector_const_view column = gsl_matrix_const_column(values, (size_t)k);
    double most = 0;
    made = gsl_linalg_QR_lssolve(matrix, tau, &column.vector, vector, left) == 0;
    for (size_t i = 0; i < columns; i++) most = fmax(most, fabs(gsl_vector_get(vector, i)));
    self->rough = self->rough || gsl_blas_dnrm2(left) > FITTED * most;
    for (size_t i = 0; i < columns && made; i++)
      self->polynomial[k][i] = gsl_vector_get(vector, i) / (most > 0 ? most : 1.0);
  }
  return made;
}

/* Newton's method for a zero of the polynomial on the unit sphere. */
static bool find_root(const reduction *self, double *z) {
  int d = self->space;
  double terms[MOST_TERMS], rate[MOST_TERMS][MOST_SPACE];
  double a[MOST_SPACE * MOST_SPACE], right[MOST_SPACE], change[MOST_SPACE];
  size_t rows[MOST_SPACE];
  gsl_permutation order = {(size_t)d, rows};
  for (int turn = 0; turn < ROOT_ITERATIONS; turn++) {
    double step = 0, square = 0;
    list_terms(d, z, terms, rate);
    memset(a, 0, sizeof a);
    memset(right, 0, sizeof right);
    for (int k = 0; k < self->null; k++)
      for (int t = 0; t < self->terms; t++) {
        right[k] -= self->polynomial[k][t] * terms[t];
        for (int c = 0; c < d; c++) a[k * d + c] += self->polynomial[k][t] * rate[t][c];
      }
    for (int c = 0; c < d; c++) a[(d - 1) * d + c] = z[c];
    gsl_matrix_view matrix = gsl_matrix_view_array(a, (size_t)d, (size_t)d);
    gsl_vector_view b = gsl_vector_view_array(right, (size_t)d);
    gsl_vector_view x = gsl_vector_view_array(change, (size_t)d);
    if (!strut_solve_rows(&matrix.matrix, &b.vector, &order, &x.vector)) return false;
    for (int c = 0; c < d; c++) step += change[c] * change[c];
    step = sqrt(step);
    if (!isfinite(step)) return false;
    for (int c = 0; c < d; c++) {
      z[c] += change[c] * fmin(1.0, SMALL_STEP / step);
      square += z[c] * z[c];
    }
    for (int c = 0; c < d; c++) z[c] /= sqrt(square);
    if (step < ROOT) return true;
  }
  return false;
}

/* Has an element, a cable or a contact to change before the point? */
static bool is_switched(strut_path_walk *walk, const double *unknowns) {
  strut_path_system *system = &walk->system;
  for (int32_t k = 0; k < strut_path_switch_count(system); k++) {
    double value = strut_path_switch_value(system, k, unknowns);
    if (!isfinite(value) || fabs(value) <= STRUT_PATH_EVEN * system->size) continue;
    if ((value > 0) != strut_path_switch_is_on(system, k)) return true;
  }
  return false;
}

/* Corrects a zero of the polynomial, by the full equations, and keeps it unless it is known. */
static bool keep_ray(reduction *self, const double *z, strut_path_rays *rays) {
  strut_path_walk *walk = self->w;
  strut_path_system *system = &walk->system;
  double b[MOST_NULL], *direction = walk->spare, value = 0;
  if (!reduce(self, z, b)) return false;
  for (int32_t j = 0; j <= system->n; j++) {
    direction[j] = 0;
    for (int32_t k = 0; k < self->space; k++)
      direction[j] += z[k] * self->basis[k * (system->n + 1) + j];
    value += direction[j] * self->centre[j];
  }
  if (strut_path_correct(system, direction, value + self->radius, self->y) < 0) return false;
  double length = strut_path_distance(walk, self->y, self->centre);
  if (!(length < 1.5 * self->radius)) return false;
  for (int32_t k = 0; k < rays->count; k++)
    if (strut_path_distance(walk, self->y, rays->ray[k].y) < APART * self->radius) return true;
  if (is_switched(walk, self->y)) return false;
  if (rays->count == STRUT_PATH_RAYS) return true;
  strut_path_ray ray = {.y = strut_arena_copy(&system->arena, self->y, 1, strut_path_bytes(walk))};
  walk->failed =
      walk->failed || !ray.y || !STRUT_NUMBERS(&system->arena, system->n + 1, &ray.direction);
  if (walk->failed || !strut_path_spectrum(system, self->y)) return false;
  ray.negative = system->spectrum.negative;
  for (int32_t j = 0; j <= system->n; j++)
    ray.direction[j] = (self->y[j] - self->centre[j]) / length;
  int32_t at = rays->count++;
  for (; at > 0 && rays->ray[at - 1].negative > ray.negative; at--)
    rays->ray[at] = rays->ray[at - 1];
  rays->ray[at] = ray;
  return true;
}

/* Marks the path that is walked, before and after: nearest to its own points, or else to its tangent. */
static void mark_own(const reduction *self, strut_path_rays *rays) {
  for (int side = -1; side <= 1; side += 2) {
    const double *own = self->own[side > 0];
    double least = OWN;
    int32_t best = -1;
    for (int32_t k = 0; k < rays->count; k++) {
      const strut_path_ray *ray = &rays->ray[k];
      double off = own ? strut_path_distance(self->w, ray->y, own) / self->radius
                       : 1.0 - side * strut_path_dot(self->w, ray->direction, self->w->tangent);
      if (off < least) least = off, best = k;
    }
    if (best >= 0) rays->ray[best].own = side;
  }
}

/* All zeros on the sphere; false: some could not be had. */
static bool search_sphere(reduction *self, strut_path_rays *rays) {
  int d = self->space, starts = STARTS << d;
  double z[MOST_SPACE];
  uint64_t seed = 1;
  double(*root)[MOST_SPACE] = strut_arena_allocate(&self->arena, STRUT_PATH_RAYS, sizeof *root);
  int32_t count = 0;
  bool all = true;
  self->w->failed = self->w->failed || !root;
  for (int k = 0; k < starts && root && count < STRUT_PATH_RAYS; k++) {
    choose_direction(&seed, d, z);
    if (!find_root(self, z)) continue;
    bool known = false;
    for (int32_t i = 0; i < count && !known; i++) {
      double square = 0;
      for (int c = 0; c < d; c++) square += (z[c] - root[i][c]) * (z[c] - root[i][c]);
      known = square < APART * APART / 4;
    }
    if (!known) memcpy(root[count++], z, sizeof z);
  }
  for (int32_t i = 0; i < count && !self->w->failed; i++)
    all = keep_ray(self, root[i], rays) && all;
  mark_own(self, rays);
  return all;
}

/* How many eigenvalues vanish at the centre, or at a point of the path not much more than a radius away; their modes. */
static int32_t count_kernel(reduction *self, int32_t *first) {
  strut_path_walk *walk = self->w;
  strut_path_system *system = &walk->system;
  double *side[2] = {walk->scale, walk->spare}; /* eigenvalues before and after; NAN: not known */
  int32_t count = 0;
  for (int k = 0; k < 2; k++) {
    double step = k ? self->radius : -self->radius;
    double value = strut_path_dot(walk, walk->tangent, self->centre) + step;
    memcpy(self->y, self->centre, strut_path_bytes(walk));
    for (int32_t j = 0; j <= system->n; j++) self->y[j] += step * walk->tangent[j];
    bool found = strut_path_correct(system, walk->tangent, value, self->y) >= 0;
    if (found) self->own[k] = strut_arena_copy(&self->arena, self->y, 1, strut_path_bytes(walk));
    found = found && strut_path_spectrum(system, self->y);
    for (int32_t i = 0; i < system->n; i++)
      side[k][i] = found ? system->spectrum.value[i] : (double)NAN;
  }
  if (!strut_path_spectrum(system, self->centre)) return 0;
  self->stiff = system->size * strut_path_largest_value(system);
  for (int32_t i = 0; i < system->n; i++) {
    double value = system->spectrum.value[i];
    double change = fmax(0.0, fmax(fabs(side[0][i] - value), fabs(side[1][i] - value)));
    if (fabs(value) <= WITHIN * change && !count++) *first = i;
  }
  return count < MOST_NULL ? count : MOST_NULL;
}

/* The kernel from mode `first` on, and the direction in which parameter and structure change together. */
static bool make_basis(reduction *self, int32_t first) {
  strut_path_system *system = &self->w->system;
  int32_t n = system->n, count = n + 1;
  double bottom[MOST_SPACE] = {0};
  self->space = self->null + 1;
  self->basis = strut_arena_allocate(&self->arena, (size_t)(self->space * count), sizeof(double));
  self->w->failed = self->w->failed || !self->basis;
  if (self->w->failed) return false;
  double *last = self->basis + self->null * count;
  for (int32_t k = 0; k < self->null; k++) {
    double *row = self->basis + k * count;
    memcpy(row, strut_path_mode(system, first + k), (size_t)n * sizeof *row);
    /* they have other directions where the stiffness has no symmetry */
    double square = strut_remove_shares(self->basis, (size_t)k, (size_t)count, row);
    for (int32_t j = 0; j < n; j++) row[j] /= sqrt(square);
    if (!(square > 0)) return false;
  }
  last[n] = bottom[self->null] = 1.0; /* the parameter changes by 1, nothing along the kernel */
  const strut_path_planes planes = {.null = self->null, .row = self->basis, .stiff = self->stiff};
  if (!strut_path_evaluate(system, self->centre) ||
      !strut_path_solve(system, &planes, NULL, bottom, 0.0))
    return false;
  memcpy(last, system->algebra.solution->data, (size_t)count * sizeof *last);
  double length = sqrt(strut_dot(last, last, count));
  for (int32_t j = 0; j < count; j++) last[j] /= length;
  return true;
}

/*
 * A symmetric structure whose numbers are rounded has an imperfect bifurcation, whose branches pass one another at
 * the cube root of a rounding: half way between them a force of that rounding is all that lacks.
 */
bool strut_path_is_rounding(strut_path_walk *walk, const double *from, const double *to) {
  strut_path_system *system = &walk->system;
  double b[MOST_NULL], z[MOST_SPACE] = {0}, *centre = walk->trial;
  reduction r = {.w = walk, .centre = centre, .radius = RADII[0], .null = 1};
  int32_t first = 0;
  for (int32_t i = 0; i < 2 * (system->n + 1); i++) centre[i] = 0.5 * (from[i] + to[i]);
  if (!strut_path_spectrum(system, centre)) return false;
  double level = system->spectrum.noise * system->size;
  for (int32_t i = 1; i < system->n; i++)
    if (fabs(system->spectrum.value[i]) < fabs(system->spectrum.value[first])) first = i;
  r.stiff = system->size * strut_path_largest_value(system);
  r.y = strut_arena_allocate(&r.arena, 1, strut_path_bytes(walk));
  walk->failed = walk->failed || !r.y;
  bool found = r.y && make_basis(&r, first) && reduce(&r, z, b);
  strut_arena_free(&r.arena);
  return found && fabs(b[0]) * r.stiff <= ROUNDED * level;
}

/* All rays of one radius; false: some could not be had. */
static bool find_at_radius(reduction *self, strut_path_rays *rays) {
  int32_t first = 0;
  self->null = rays->null = count_kernel(self, &first);
  return self->null && make_basis(self, first) && fit_polynomial(self) &&
         search_sphere(self, rays) && !self->rough;
}

void strut_path_find_rays(strut_path_walk *walk, const double *y, strut_path_rays *rays) {
  *rays = (strut_path_rays){0};
  bool all = false;
  for (size_t i = 0; i < sizeof RADII / sizeof *RADII && !all && !walk->failed; i++) {
    reduction r = {.w = walk, .centre = y, .radius = RADII[i]};
    strut_path_rays found = {.radius = RADII[i]};
    bool made = STRUT_ALLOCATE(&walk->system.arena, STRUT_NEW(found.ray, STRUT_PATH_RAYS)) &&
                STRUT_NUMBERS(&r.arena, 2 * (walk->system.n + 1), &r.y);
    walk->failed = walk->failed || !made;
    all = made && find_at_radius(&r, &found);
    strut_arena_free(&r.arena);
    if (found.count > rays->count) *rays = found;
  }
}

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
#include <stdlib.h>
#include <string.h>

#include "engine/statics/algebra.h"
#include "engine/statics/path/path_parts.h"

enum {
  MOST_NULL = 6, /* dimension of a kernel that is searched */
  MOST_SPACE = MOST_NULL + 1,
  MOST_TERMS = 84 + 28, /* products of three and of two of seven numbers */
  ITERATIONS = 12,
  ROOT_ITERATIONS = 40,
  STARTS = 300 /* for each dimension twice as many */
};

static const double RADII[] = {2e-3, 5e-4, 1e-4, 2e-5, 4e-6}; /* of spheres tried [units of y] */
static const double ROUNDED = 3.0; /* roundings of the stiffness, over the size */
static const double WITHIN = 2.0;  /* changes over a radius: an eigenvalue that vanishes inside */
static const double CONVERGED = 1e-13, NEAR = 1e-8; /* of a step of Newton's method [units of y] */
static const double ROOT = 1e-11,
                    SMALL_STEP = 0.4; /* of the polynomial's zeros, on the unit sphere */
static const double APART = 0.02;     /* of the radius: zeros that are not one */
static const double OWN = 0.4; /* of the radius: farthest from the path that is walked, its own */

typedef struct reduction {
  strut_path_walk *w;
  const double *centre; /* (2 n + 2) */
  int32_t null, space;  /* dimensions of the kernel; with the parameter */
  double radius;
  gsl_matrix
      *basis; /* (n + 1, space), orthonormal: the kernel, then the rest of the path's plane */
  gsl_matrix *system; /* (n + space, n + space) */
  gsl_vector *right, *solution;
  gsl_permutation *order;
  double *y, *own[2]; /* (2 n + 2) scratch; the path that is walked, before and after */
  strut_arena arena;
  int terms; /* of the polynomial */
  double polynomial[MOST_NULL][MOST_TERMS];
} reduction;

/* F + N b = 0 on the plane basis' (y - centre) = z: the matrix [s K, slope, N; basis', 0] at y. */
static bool fill_system(reduction *r, const double *y) {
  strut_path_system *s = &r->w->system;
  size_t n = (size_t)s->n, d = (size_t)r->space, m = (size_t)r->null;
  if (!strut_path_evaluate(s, y)) return false;
  gsl_matrix_set_zero(r->system);
  for (size_t i = 0; i < n; i++) {
    for (size_t j = 0; j < n; j++)
      gsl_matrix_set(r->system, i, j, s->size * gsl_matrix_get(s->algebra.hessian, i, j));
    gsl_matrix_set(r->system, i, n, s->latest.slope[i]);
    for (size_t k = 0; k < m; k++)
      gsl_matrix_set(r->system, i, n + 1 + k, r->w->stiff * gsl_matrix_get(r->basis, i, k));
  }
  for (size_t k = 0; k < d; k++)
    for (size_t j = 0; j <= n; j++)
      gsl_matrix_set(r->system, n + k, j, gsl_matrix_get(r->basis, j, k));
  return true;
}

/* r->y becomes the solution over centre + radius z, and b (null) what equilibrium lacks there. */
static bool reduce(reduction *r, const double *z, double *b) {
  strut_path_system *s = &r->w->system;
  size_t n = (size_t)s->n, count = n + 1, d = (size_t)r->space, m = (size_t)r->null;
  double before = HUGE_VAL;
  memcpy(r->y, r->centre, strut_path_bytes(r->w));
  for (size_t j = 0; j < count; j++)
    for (size_t k = 0; k < d; k++) r->y[j] += r->radius * z[k] * gsl_matrix_get(r->basis, j, k);
  for (int turn = 0; turn < ITERATIONS; turn++) {
    double change = 0;
    if (!fill_system(r, r->y)) return false;
    for (size_t i = 0; i < n; i++) gsl_vector_set(r->right, i, -s->latest.g[i]);
    for (size_t k = 0; k < d; k++) {
      double left = r->radius * z[k];
      for (size_t j = 0; j < count; j++)
        left -= gsl_matrix_get(r->basis, j, k) *
                ((r->y[j] - r->centre[j]) + (r->y[count + j] - r->centre[count + j]));
      gsl_vector_set(r->right, n + k, left);
    }
    if (!strut_solve_rows(r->system, r->right, r->order, r->solution)) return false;
    for (size_t j = 0; j < count; j++) {
      double step = gsl_vector_get(r->solution, j);
      change = fmax(change, fabs(step));
      strut_dd sum = dd_add((strut_dd){r->y[j], r->y[count + j]}, dd_of(step));
      r->y[j] = sum.hi, r->y[count + j] = sum.lo;
    }
    for (size_t k = 0; k < m; k++) b[k] = gsl_vector_get(r->solution, count + k);
    if (!isfinite(change) || change > r->radius) return false;
    if (change <= CONVERGED || (before <= NEAR && change > 0.3 * before)) return true;
    before = change;
  }
  return false;
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
static bool fit_polynomial(reduction *r) {
  int d = r->space;
  double z[MOST_SPACE] = {0}, b[MOST_NULL], terms[MOST_TERMS];
  r->terms = list_terms(d, z, terms, NULL);
  size_t pairs = (size_t)r->terms, rows = 2 * pairs, columns = (size_t)r->terms;
  gsl_matrix *a = strut_arena_matrix(&r->arena, rows, columns);
  gsl_matrix *values = strut_arena_matrix(&r->arena, rows, MOST_NULL);
  gsl_vector *tau = strut_arena_vector(&r->arena, columns);
  gsl_vector *x = strut_arena_vector(&r->arena, columns);
  gsl_vector *left = strut_arena_vector(&r->arena, rows);
  bool made = a && values && tau && x && left;
  r->w->failed = r->w->failed || !made;
  uint64_t seed = 59;
  for (size_t i = 0; i < rows && made; i++) {
    if (i % 2 == 0) choose_direction(&seed, d, z);
    for (int k = 0; k < d && i % 2; k++) z[k] = -z[k];
    made = reduce(r, z, b);
    list_terms(d, z, terms, NULL);
    for (size_t k = 0; k < columns; k++) gsl_matrix_set(a, i, k, terms[k]);
    for (int32_t k = 0; k < r->null && made; k++) gsl_matrix_set(values, i, (size_t)k, b[k]);
  }
  if (made) gsl_linalg_QR_decomp(a, tau);
  for (int32_t k = 0; k < r->null && made; k++) {
    gsl_vector_const_view column = gsl_matrix_const_column(values, (size_t)k);
    double most = 0;
    made = gsl_linalg_QR_lssolve(a, tau, &column.vector, x, left) == 0;
    for (size_t i = 0; i < columns; i++) most = fmax(most, fabs(gsl_vector_get(x, i)));
    for (size_t i = 0; i < columns && made; i++)
      r->polynomial[k][i] = gsl_vector_get(x, i) / (most > 0 ? most : 1.0);
  }
  return made;
}

/* Newton's method for a zero of the polynomial on the unit sphere. */
static bool find_root(const reduction *r, double *z) {
  int d = r->space;
  double terms[MOST_TERMS], rate[MOST_TERMS][MOST_SPACE];
  double a[MOST_SPACE * MOST_SPACE], right[MOST_SPACE], change[MOST_SPACE];
  size_t rows[MOST_SPACE];
  gsl_permutation order = {(size_t)d, rows};
  for (int turn = 0; turn < ROOT_ITERATIONS; turn++) {
    double step = 0, square = 0;
    list_terms(d, z, terms, rate);
    memset(a, 0, sizeof a);
    memset(right, 0, sizeof right);
    for (int k = 0; k < r->null; k++)
      for (int t = 0; t < r->terms; t++) {
        right[k] -= r->polynomial[k][t] * terms[t];
        for (int c = 0; c < d; c++) a[k * d + c] += r->polynomial[k][t] * rate[t][c];
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

/* Corrects a zero of the polynomial, by the full equations, and keeps it unless it is known. */
static bool keep_ray(reduction *r, const double *z, strut_path_rays *rays) {
  strut_path_walk *w = r->w;
  strut_path_system *s = &w->system;
  double b[MOST_NULL], *direction = w->spare, value = 0;
  if (!reduce(r, z, b)) return false;
  for (int32_t j = 0; j <= s->n; j++) {
    direction[j] = 0;
    for (int32_t k = 0; k < r->space; k++)
      direction[j] += z[k] * gsl_matrix_get(r->basis, (size_t)j, (size_t)k);
    value += direction[j] * r->centre[j];
  }
  if (strut_path_correct(s, direction, value + r->radius, r->y) < 0) return false;
  double length = strut_path_distance(w, r->y, r->centre);
  if (!(length < 1.5 * r->radius)) return false;
  for (int32_t k = 0; k < rays->count; k++)
    if (strut_path_distance(w, r->y, rays->ray[k].y) < APART * r->radius) return true;
  if (strut_path_is_switched(w, r->y)) return false;
  if (rays->count == STRUT_PATH_RAYS) return true;
  strut_path_ray *ray = &rays->ray[rays->count];
  ray->y = strut_arena_copy(&s->arena, r->y, 1, strut_path_bytes(w));
  ray->direction = strut_arena_allocate(&s->arena, (size_t)s->n + 1, sizeof(double));
  w->failed = w->failed || !ray->y || !ray->direction;
  if (w->failed) return false;
  for (int32_t j = 0; j <= s->n; j++) ray->direction[j] = (r->y[j] - r->centre[j]) / length;
  ray->done = false, ray->own = 0;
  if (!strut_path_spectrum(s, r->y, STRUT_PATH_SIGNS)) return false;
  ray->negative = s->spectrum.negative;
  rays->count++;
  return true;
}

/* Marks the path that is walked, before and after: nearest to its own points, or else to its tangent. */
static void mark_own(const reduction *r, strut_path_rays *rays) {
  for (int side = -1; side <= 1; side += 2) {
    const double *own = r->own[side > 0];
    double least = OWN;
    int32_t best = -1;
    for (int32_t k = 0; k < rays->count; k++) {
      const strut_path_ray *ray = &rays->ray[k];
      double off = own ? strut_path_distance(r->w, ray->y, own) / r->radius
                       : 1.0 - side * strut_path_dot(r->w, ray->direction, r->w->tangent);
      if (off < least) least = off, best = k;
    }
    if (best >= 0) rays->ray[best].own = side;
  }
}

/* All zeros on the sphere; false: some could not be had. */
static bool search_sphere(reduction *r, strut_path_rays *rays) {
  int d = r->space, starts = STARTS << d;
  double z[MOST_SPACE];
  uint64_t seed = 1;
  double(*root)[MOST_SPACE] = strut_arena_allocate(&r->arena, STRUT_PATH_RAYS, sizeof *root);
  int32_t count = 0;
  bool all = true;
  r->w->failed = r->w->failed || !root;
  for (int k = 0; k < starts && root && count < STRUT_PATH_RAYS; k++) {
    choose_direction(&seed, d, z);
    if (!find_root(r, z)) continue;
    bool known = false;
    for (int32_t i = 0; i < count && !known; i++) {
      double square = 0;
      for (int c = 0; c < d; c++) square += (z[c] - root[i][c]) * (z[c] - root[i][c]);
      known = square < APART * APART / 4;
    }
    if (!known) memcpy(root[count++], z, sizeof z);
  }
  for (int32_t i = 0; i < count && !r->w->failed; i++) all = keep_ray(r, root[i], rays) && all;
  mark_own(r, rays);
  return all;
}

/* How many eigenvalues vanish at the centre, or at a point of the path not much more than a radius away. */
static int32_t count_kernel(reduction *r, int32_t *first) {
  strut_path_walk *w = r->w;
  strut_path_system *s = &w->system;
  double *change = w->scale, *here = w->spare;
  int32_t count = 0;
  if (!strut_path_spectrum(s, r->centre, STRUT_PATH_VALUES)) return 0;
  for (int32_t i = 0; i < s->n; i++) here[i] = s->spectrum.value[i], change[i] = 0;
  for (int side = -1; side <= 1; side += 2) {
    double value = side * r->radius;
    memcpy(r->y, r->centre, strut_path_bytes(w));
    for (int32_t j = 0; j <= s->n; j++) {
      value += w->tangent[j] * r->centre[j];
      r->y[j] += side * r->radius * w->tangent[j];
    }
    if (strut_path_correct(s, w->tangent, value, r->y) < 0) continue;
    r->own[side > 0] = strut_arena_copy(&r->arena, r->y, 1, strut_path_bytes(w));
    if (!strut_path_spectrum(s, r->y, STRUT_PATH_VALUES)) continue;
    for (int32_t i = 0; i < s->n; i++)
      change[i] = fmax(change[i], fabs(s->spectrum.value[i] - here[i]));
  }
  if (!strut_path_spectrum(s, r->centre, STRUT_PATH_VECTORS)) return 0;
  w->stiff = 0;
  for (int32_t i = 0; i < s->n; i++) {
    double value = s->spectrum.value[i];
    w->stiff = fmax(w->stiff, fabs(value));
    if (fabs(value) > WITHIN * change[i]) continue;
    if (!count++) *first = i;
  }
  w->stiff *= s->size;
  return count < MOST_NULL ? count : MOST_NULL;
}

/* The kernel, and the direction in which parameter and structure change together. */
static bool make_basis(reduction *r, int32_t first) {
  strut_path_system *s = &r->w->system;
  size_t n = (size_t)s->n, m = (size_t)r->null;
  gsl_matrix_set_zero(r->basis);
  for (size_t k = 0; k < m; k++) {
    gsl_vector_view own = gsl_matrix_subcolumn(r->basis, k, 0, n);
    gsl_vector_const_view null = gsl_matrix_const_column(s->algebra.vectors, (size_t)first + k);
    gsl_vector_memcpy(&own.vector, &null.vector);
    for (size_t l = 0; l < k; l++) { /* where the stiffness has no symmetry */
      gsl_vector_const_view other = gsl_matrix_const_subcolumn(r->basis, l, 0, n);
      double along;
      gsl_blas_ddot(&own.vector, &other.vector, &along);
      gsl_blas_daxpy(-along, &other.vector, &own.vector);
    }
    double length = gsl_blas_dnrm2(&own.vector);
    if (!(length > 0)) return false;
    gsl_vector_scale(&own.vector, 1.0 / length);
  }
  gsl_matrix_set(r->basis, n, m, 1.0);
  if (!fill_system(r, r->centre)) return false;
  gsl_vector_set_zero(r->right);
  gsl_vector_set(r->right, n + m, 1.0); /* the parameter changes by 1, nothing along the kernel */
  if (!strut_solve_rows(r->system, r->right, r->order, r->solution)) return false;
  gsl_vector_const_view change = gsl_vector_const_subvector(r->solution, 0, n + 1);
  double length = gsl_blas_dnrm2(&change.vector);
  for (size_t j = 0; j <= n; j++)
    gsl_matrix_set(r->basis, j, m, gsl_vector_get(&change.vector, j) / length);
  return true;
}

static bool allocate_reduction(reduction *r) {
  size_t n = (size_t)r->w->system.n, d = (size_t)r->space;
  r->basis = strut_arena_matrix(&r->arena, n + 1, d);
  r->system = strut_arena_matrix(&r->arena, n + d, n + d);
  r->right = strut_arena_vector(&r->arena, n + d);
  r->solution = strut_arena_vector(&r->arena, n + d);
  r->order = strut_arena_order(&r->arena, n + d);
  if (!r->basis || !r->system || !r->right || !r->solution || !r->order) r->w->failed = true;
  return !r->w->failed;
}

/*
 * A symmetric structure whose numbers are rounded has an imperfect bifurcation, whose branches pass one another at
 * the cube root of a rounding: half way between them a force of that rounding is all that lacks.
 */
bool strut_path_is_rounding(strut_path_walk *w, const double *from, const double *to) {
  strut_path_system *s = &w->system;
  double b[MOST_NULL], z[MOST_SPACE] = {0}, lack = 0, *centre = w->trial;
  reduction r = {.w = w, .centre = centre, .radius = RADII[0], .null = 1, .space = 2};
  int32_t first = 0;
  for (int32_t i = 0; i < 2 * (s->n + 1); i++) centre[i] = 0.5 * (from[i] + to[i]);
  if (!strut_path_spectrum(s, centre, STRUT_PATH_VECTORS)) return false;
  double level = s->spectrum.noise * s->size, stiff = 0;
  for (int32_t i = 0; i < s->n; i++) {
    double value = fabs(s->spectrum.value[i]);
    stiff = fmax(stiff, value);
    if (value < fabs(s->spectrum.value[first])) first = i;
  }
  w->stiff = stiff * s->size;
  r.y = strut_arena_allocate(&r.arena, 1, strut_path_bytes(w));
  w->failed = w->failed || !r.y;
  bool found = !w->failed && allocate_reduction(&r) && make_basis(&r, first) && reduce(&r, z, b);
  if (found) lack = fabs(b[0]) * w->stiff;
  strut_arena_free(&r.arena);
  return found && lack <= ROUNDED * level;
}

/* All rays of one radius; false: some could not be had. */
static bool find_at_radius(reduction *r, strut_path_rays *rays) {
  int32_t first = 0;
  r->null = count_kernel(r, &first);
  r->space = r->null + 1;
  rays->null = r->null;
  return r->null && allocate_reduction(r) && make_basis(r, first) && fit_polynomial(r) &&
         search_sphere(r, rays);
}

static int compare_rays(const void *a, const void *b) {
  const strut_path_ray *s = a, *t = b;
  return s->negative != t->negative ? (s->negative > t->negative) - (s->negative < t->negative)
                                    : (s->order > t->order) - (s->order < t->order);
}

void strut_path_find_rays(strut_path_walk *w, const double *y, strut_path_rays *rays) {
  strut_path_rays best = {0};
  strut_path_ray *room[2] = {0};
  for (int k = 0; k < 2; k++) {
    room[k] = strut_arena_allocate(&w->system.arena, STRUT_PATH_RAYS, sizeof *room[k]);
    w->failed = w->failed || !room[k];
  }
  int other = 0;
  for (size_t i = 0; i < sizeof RADII / sizeof *RADII && !w->failed; i++) {
    reduction r = {.w = w, .centre = y, .radius = RADII[i]};
    strut_path_rays found = {.ray = room[other], .radius = RADII[i]};
    r.y = strut_arena_allocate(&r.arena, 1, strut_path_bytes(w));
    w->failed = w->failed || !r.y;
    bool all = r.y && find_at_radius(&r, &found);
    strut_arena_free(&r.arena);
    if (found.count > best.count) best = found, other = 1 - other;
    if (all) break;
  }
  for (int32_t k = 0; k < best.count; k++) best.ray[k].order = k;
  qsort(best.ray, (size_t)best.count, sizeof *best.ray, compare_rays);
  *rays = best;
}

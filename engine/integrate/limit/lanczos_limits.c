/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/limit/tangent_limits.h"

#include <gsl/gsl_eigen.h>
#include <math.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/vec.h"
#include "engine/forces/rigid.h"
#include "engine/model/mass.h"

bool strut_krylov_basis_create(const strut_model *model, const strut_tangent *tangent, int most,
                               strut_arena *arena, strut_krylov_basis *space) {
  size_t n = (size_t)tangent->n, m = (size_t)most;
  *space = (strut_krylov_basis){.model = model, .tangent = tangent, .most = most};
  return STRUT_NUMBERS(arena, m * m, &space->stiffness, &space->damping) &&
         STRUT_ALLOCATE(arena, STRUT_NEW(space->vector, m * n), STRUT_NEW(space->image, n),
                        STRUT_NEW(space->node, 3 * (size_t)model->length));
}

/* What rigid bars leave of it; nothing where they hold all of it and only rounding is left. */
static void hold_rigid(const strut_model *model, strut_rigid *rigid, double *acceleration,
                       double *scratch) {
  double before = strut_largest_magnitude(acceleration, model->length);
  strut_rigid_filter(model, rigid, acceleration, scratch);
  if (strut_largest_magnitude(acceleration, model->length) < 1e-12 * before)
    memset(acceleration, 0, (size_t)model->length * sizeof *acceleration);
}

void strut_apply_inverse_mass(strut_krylov_basis *space, double *vector) {
  const strut_model *model = space->model;
  const strut_tangent *tangent = space->tangent;
  size_t both = (size_t)model->length;
  double *force = space->node, *acceleration = force + both, *scratch = force + 2 * both;
  memset(force, 0, 2 * both * sizeof *force);
  for (int32_t i = 0; i < tangent->n; i++) force[tangent->coordinate[i]] = vector[i];
  strut_mass_solve(model, force, acceleration, scratch);
  if (tangent->rigid) hold_rigid(model, tangent->rigid, acceleration, scratch);
  for (int32_t i = 0; i < tangent->n; i++) vector[i] = acceleration[tangent->coordinate[i]];
}

/* y = M x. */
static void apply_mass(strut_krylov_basis *space, const double *vector, double *y) {
  const strut_model *model = space->model;
  const strut_tangent *tangent = space->tangent;
  size_t both = (size_t)model->length;
  double *full = space->node, *gathered = full + both, *product = full + 2 * both;
  memset(full, 0, both * sizeof *full);
  for (int32_t i = 0; i < tangent->n; i++) full[tangent->coordinate[i]] = vector[i];
  for (int c = 0; c < 2; c++) {
    const strut_mass_operator *op = &model->mass->coordinate[c];
    for (int32_t i = 0; i < op->matrix->n; i++) gathered[i] = full[2 * op->matrix_node[i] + c];
    strut_sparse_multiply(op->matrix, gathered, product);
    for (int32_t i = 0; i < op->matrix->n; i++) full[2 * op->matrix_node[i] + c] = product[i];
  }
  for (int32_t i = 0; i < tangent->n; i++) y[i] = full[tangent->coordinate[i]];
}

void strut_tangent_apply(strut_krylov_basis *space, double a, double b, const double *vector,
                         double *y) {
  int32_t n = space->tangent->n;
  double *other = space->node;
  if (a != 0.0)
    strut_sparse_multiply(space->tangent->stiffness, vector, y);
  else
    memset(y, 0, (size_t)n * sizeof *y);
  if (a != 1.0)
    for (int32_t i = 0; i < n; i++) y[i] *= a;
  if (b == 0.0) return;
  strut_sparse_multiply(space->tangent->damping, vector, other);
  for (int32_t i = 0; i < n; i++) y[i] += b * other[i];
}

/* Scales x to size 1 in the mass; its size before, 0 where it has none. `image` is then M x. */
static double normalise(strut_krylov_basis *space, double *vector) {
  int32_t n = space->tangent->n;
  double largest = strut_largest_magnitude(vector, n);
  if (!(largest > 0.0 && largest < HUGE_VAL)) return 0.0;
  for (int32_t i = 0; i < n; i++) vector[i] /= largest;
  apply_mass(space, vector, space->image);
  double size = sqrt(fmax(0.0, strut_dot(vector, space->image, n)));
  if (!(size > 0.0)) return 0.0;
  for (int32_t i = 0; i < n; i++) vector[i] /= size, space->image[i] /= size;
  return size * largest;
}

/* Rows and columns of the last vector in the projected matrices. */
static void project_last(strut_krylov_basis *space) {
  int32_t n = space->tangent->n;
  int last = space->count - 1;
  const double *x = space->vector + (size_t)last * (size_t)n;
  for (int which = 0; which < 2; which++) {
    double *small = which ? space->damping : space->stiffness;
    strut_tangent_apply(space, which ? 0.0 : 1.0, which ? 1.0 : 0.0, x, space->image);
    for (int j = 0; j <= last; j++) {
      double value = strut_dot(space->vector + (size_t)j * (size_t)n, space->image, n);
      small[j * space->most + last] = small[last * space->most + j] = value;
    }
  }
}

bool strut_krylov_basis_add(strut_krylov_basis *space, double *vector) {
  int32_t n = space->tangent->n;
  if (space->count >= space->most || !(normalise(space, vector) > 0.0)) return false;
  for (int pass = 0; pass < 3; pass++) {
    for (int j = 0; j < space->count; j++) {
      const double *v = space->vector + (size_t)j * (size_t)n;
      double part = strut_dot(v, space->image, n);
      for (int32_t i = 0; i < n; i++) vector[i] -= part * v[i];
    }
    double left = normalise(space, vector);
    if (!(left > 1e-8)) return false; /* what is left is rounding */
    if (left > 0.5) break;
  }
  memmove(space->vector + (size_t)space->count * (size_t)n, vector, (size_t)n * sizeof *vector);
  space->count++;
  project_last(space);
  return true;
}

void strut_krylov_basis_combine(const strut_krylov_basis *space, const double *c, double *vector) {
  int32_t n = space->tangent->n;
  memset(vector, 0, (size_t)n * sizeof *vector);
  for (int j = 0; j < space->count; j++) {
    const double *v = space->vector + (size_t)j * (size_t)n;
    for (int32_t i = 0; i < n; i++) vector[i] += c[j] * v[i];
  }
}

void strut_krylov_basis_shrink(strut_krylov_basis *space, const double *c, int rows, double *work) {
  size_t n = (size_t)space->tangent->n;
  int columns = space->count;
  for (size_t i = 0; i < n; i++) {
    for (int r = 0; r < rows; r++) {
      work[r] = 0.0;
      for (int j = 0; j < columns; j++)
        work[r] += c[r * columns + j] * space->vector[(size_t)j * n + i];
    }
    for (int r = 0; r < rows; r++) space->vector[(size_t)r * n + i] = work[r];
  }
  space->count = 0;
  for (int r = 0; r < rows; r++) strut_krylov_basis_add(space, space->vector + (size_t)r * n);
}

/* Lanczos's method for the largest eigenvalues of a tangent matrix: where to look for motions. */

/* Steps at most; and of its motions, how many are kept. */
enum { MOST_STEPS = 80, KEPT = 3 };

typedef struct lanczos {
  strut_krylov_basis *space;
  double a, b;                                /* the matrix is a K + b D */
  double *v, *u, *before, *r;                 /* v, u = M v, the u before, residual; (n) */
  double *kept;                               /* (KEPT, n) */
  double alpha[MOST_STEPS], beta[MOST_STEPS]; /* of the tridiagonal matrix */
  double mix[KEPT][MOST_STEPS];               /* its eigenvectors */
  int steps, wanted;
} lanczos;

/* Are all eigenvalues of the leading n rows below x? Then all pivots of T - x are negative. */
static bool all_below(const lanczos *self, int n, double x) {
  double pivot = self->alpha[0] - x;
  for (int j = 1; j < n && pivot < 0; j++)
    pivot = self->alpha[j] - x - self->beta[j - 1] * self->beta[j - 1] / pivot;
  return pivot < 0;
}

/* The largest eigenvalue of the leading n rows, at least 0. */
static double largest_of_tridiagonal(const lanczos *self, int n) {
  double low = 0.0, high = 0.0;
  for (int j = 0; j < n; j++)
    high = fmax(high, fabs(self->alpha[j]) + self->beta[j] + (j ? self->beta[j - 1] : 0.0));
  for (int i = 0; i < 50; i++) {
    double middle = 0.5 * (low + high);
    *(all_below(self, n, middle) ? &high : &low) = middle;
  }
  return high;
}

/* A start that leans on no motion: bits stirred from the index. */
static double stirred(uint64_t i) {
  uint64_t z = (i + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  return (double)((z ^ (z >> 27)) >> 11) * 0x1p-53 - 0.5;
}

/* The next v and u from the residual over its size in the mass, which is returned; 0: no more motions. */
static double next_vector(lanczos *self) {
  int32_t n = self->space->tangent->n;
  double square = 0.0;
  memcpy(self->v, self->r, (size_t)n * sizeof *self->v);
  strut_apply_inverse_mass(self->space, self->v);
  for (int32_t i = 0; i < n; i++) square += self->r[i] * self->v[i];
  if (!(square > 0)) return 0.0;
  double size = sqrt(square), *swap = self->before;
  self->before = self->u, self->u = swap;
  for (int32_t i = 0; i < n; i++) self->u[i] = self->r[i] / size, self->v[i] /= size;
  return size;
}

/* Begins at the start; its entries are weighed, so that light nodes move as much as heavy ones. */
static bool first_vector(lanczos *self) {
  int32_t n = self->space->tangent->n;
  for (int32_t i = 0; i < n; i++)
    self->v[i] = stirred((uint64_t)i), self->u[i] = self->before[i] = 0.0;
  apply_mass(self->space, self->v, self->r);
  return next_vector(self) > 0;
}

/* r becomes the matrix times v less what v and the one before have of it; alpha of this step. */
static double next_residual(lanczos *self, double size) {
  int32_t n = self->space->tangent->n;
  double alpha = 0.0;
  strut_tangent_apply(self->space, self->a, self->b, self->v, self->r);
  for (int32_t i = 0; i < n; i++) alpha += self->v[i] * self->r[i];
  for (int32_t i = 0; i < n; i++) self->r[i] -= alpha * self->u[i] + size * self->before[i];
  return alpha;
}

/* The tridiagonal matrix. False where nothing has a positive eigenvalue. */
static bool walk(lanczos *self) {
  int32_t n = self->space->tangent->n;
  int most = n < MOST_STEPS ? n : MOST_STEPS;
  double value = 0.0, size = 0.0;
  if (!first_vector(self)) return false;
  for (int j = 0; j < most; j++) {
    double earlier = value;
    self->alpha[j] = next_residual(self, size);
    self->beta[j] = 0.0;
    self->steps = j + 1;
    value = largest_of_tridiagonal(self, j + 1);
    size = next_vector(self);
    if (size <= 1e-10 * value || (j > 40 && value - earlier < 1e-9 * value)) break;
    self->beta[j] = size;
  }
  return value > 0.0;
}

/* Eigenvectors of the tridiagonal matrix for its largest eigenvalues. */
static bool mix(lanczos *self) {
  size_t m = (size_t)self->steps;
  gsl_matrix *matrix = gsl_matrix_calloc(m, m), *x = gsl_matrix_alloc(m, m);
  gsl_vector *value = gsl_vector_alloc(m);
  gsl_eigen_symmv_workspace *workspace = gsl_eigen_symmv_alloc(m);
  bool good = matrix && x && value && workspace;
  for (size_t j = 0; good && j < m; j++) {
    gsl_matrix_set(matrix, j, j, self->alpha[j]);
    if (j + 1 == m) break;
    gsl_matrix_set(matrix, j, j + 1, self->beta[j]);
    gsl_matrix_set(matrix, j + 1, j, self->beta[j]);
  }
  good = good && !gsl_eigen_symmv(matrix, value, x, workspace);
  if (good) gsl_eigen_symmv_sort(value, x, GSL_EIGEN_SORT_VAL_DESC);
  self->wanted = self->steps < KEPT ? self->steps : KEPT;
  for (int k = 0; good && k < self->wanted; k++)
    for (size_t j = 0; j < m; j++) self->mix[k][j] = gsl_matrix_get(x, j, (size_t)k);
  gsl_eigen_symmv_free(workspace);
  gsl_vector_free(value);
  gsl_matrix_free(x);
  gsl_matrix_free(matrix);
  return good;
}

/* The same walk again, which sums up the motions. */
static void gather(lanczos *self) {
  int32_t n = self->space->tangent->n;
  double size = 0.0;
  if (!first_vector(self)) return;
  for (int j = 0; j < self->steps; j++) {
    for (int k = 0; k < self->wanted; k++) {
      double *x = self->kept + (size_t)k * (size_t)n;
      for (int32_t i = 0; i < n; i++) x[i] += self->mix[k][j] * self->v[i];
    }
    next_residual(self, size);
    if (j + 1 < self->steps) size = next_vector(self);
  }
}

bool strut_lanczos_limits(strut_krylov_basis *space, double a, double b) {
  strut_arena arena = {0};
  lanczos *self = strut_arena_allocate(&arena, 1, sizeof *self);
  if (self) *self = (lanczos){.space = space, .a = a, .b = b};
  size_t n = (size_t)space->tangent->n;
  bool good = self && STRUT_NUMBERS(&arena, n, &self->v, &self->u, &self->before, &self->r) &&
              STRUT_NUMBERS(&arena, KEPT * n, &self->kept);
  if (good && walk(self)) {
    good = mix(self);
    if (good) gather(self);
    for (int k = 0; good && k < self->wanted; k++)
      strut_krylov_basis_add(space, self->kept + (size_t)k * n);
  }
  strut_arena_free(&arena);
  return good;
}

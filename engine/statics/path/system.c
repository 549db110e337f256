/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/path/system.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_sort_vector.h>
#include <math.h>
#include <string.h>

enum { MOST_ITERATIONS = 14, MOTIONS = 3 };

static const double CONVERGED = 1e-14;  /* of a Newton step, in units of size and factor */
static const double FAR = 2.0;          /* a step longer than this leads nowhere */
static const double NEAR = 1e-8;        /* from here on a step that shrinks no more is rounding */
static const double RIGID = 1e-10;      /* of the stiffness: what a rigid motion may meet */
static const double ZERO_VALUE = 1e-13; /* of the largest eigenvalue: no sign below this */

static bool make_matrices(strut_path_system *s) {
  size_t n = (size_t)s->n;
  s->hessian = gsl_matrix_alloc(n, n);
  s->vectors = gsl_matrix_alloc(n, n);
  s->values = gsl_vector_alloc(n);
  s->eigen = gsl_eigen_symmv_alloc(n);
  s->values_only = gsl_eigen_symm_alloc(n);
  s->bordered = gsl_matrix_alloc(n + 1, n + 1);
  s->right = gsl_vector_alloc(n + 1);
  s->solution = gsl_vector_alloc(n + 1);
  s->order = gsl_permutation_alloc(n + 1);
  return s->hessian && s->vectors && s->values && s->eigen && s->values_only && s->bordered &&
         s->right && s->solution && s->order;
}

static bool make_arrays(strut_path_system *s, const strut_model *model) {
  size_t length = (size_t)model->length, slots = (size_t)model->members.slots;
  s->base = strut_arena_allocate(&s->arena, length, sizeof(double));
  s->load = strut_arena_allocate(&s->arena, length, sizeof(double));
  s->q = strut_arena_allocate(&s->arena, length, sizeof(double));
  s->g = strut_arena_allocate(&s->arena, length, sizeof(double));
  s->row = strut_arena_allocate(&s->arena, length + 1, sizeof(double));
  s->slack = strut_arena_allocate(&s->arena, slots, sizeof(double));
  s->touching = strut_arena_allocate(&s->arena, (size_t)model->contacts.count, 1);
  return s->base && s->load && s->q && s->g && s->row && s->slack && s->touching;
}

strut_status strut_path_system_create(const strut_model *model, const double *base,
                                      const double *load, double unit, strut_path_system *s,
                                      strut_error *error) {
  *s = (strut_path_system){.model = *model, .unit = unit};
  s->size = model->size > 0 ? model->size : 1.0;
  if (!make_arrays(s, model)) return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  memcpy(s->slack, model->members.slack, (size_t)model->members.slots * sizeof *s->slack);
  s->model.members.slack = s->slack;
  strut_status status = strut_potential_create(&s->model, NULL, false, &s->potential, error);
  if (status) return status;
  s->n = s->potential->n;
  memcpy(s->base, base, (size_t)model->length * sizeof *s->base);
  memcpy(s->load, load, (size_t)model->length * sizeof *s->load);
  memcpy(s->q, model->start, (size_t)model->length * sizeof *s->q);
  if (s->n == 0) return STRUT_OK;
  s->sparse = strut_potential_matrix(s->potential, &s->arena);
  if (s->sparse && make_matrices(s)) return STRUT_OK;
  return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
}

void strut_path_system_free(strut_path_system *s) {
  gsl_matrix_free(s->hessian);
  gsl_matrix_free(s->vectors);
  gsl_matrix_free(s->bordered);
  gsl_vector_free(s->values);
  gsl_vector_free(s->right);
  gsl_vector_free(s->solution);
  gsl_permutation_free(s->order);
  gsl_eigen_symmv_free(s->eigen);
  gsl_eigen_symm_free(s->values_only);
  strut_potential_free(s->potential);
  strut_arena_free(&s->arena);
  *s = (strut_path_system){0};
}

void strut_path_place(strut_path_system *s, const double *y, double *q) {
  if (q != s->q) memcpy(q, s->model.start, (size_t)s->model.length * sizeof *q);
  for (int32_t i = 0; i < s->n; i++) q[s->potential->coordinate[i]] = s->size * y[i];
}

void strut_path_unplace(const strut_path_system *s, const double *q, double *y) {
  for (int32_t i = 0; i < s->n; i++) y[i] = q[s->potential->coordinate[i]] / s->size;
}

static double gap_of(const strut_contact_table *c, int32_t i, const double *q) {
  const double *at = q + c->at[i];
  return at[0] * c->normal[0] + (at[1] - c->height) * c->normal[1];
}

/* The ground as a spring that is there or not, whatever the sign of the gap. */
static void add_contacts(strut_path_system *s) {
  const strut_contact_table *c = &s->model.contacts;
  for (int32_t i = 0; i < c->count; i++) {
    const int32_t *row = s->potential->row_of + c->at[i];
    double gap = gap_of(c, i, s->q), stiffness = c->entry[i].stiffness;
    if (!s->touching[i]) continue;
    for (int a = 0; a < 2; a++) {
      if (row[a] < 0) continue;
      s->g[row[a]] += stiffness * gap * c->normal[a];
      for (int b = 0; b < 2; b++)
        if (row[b] >= 0)
          *gsl_matrix_ptr(s->hessian, (size_t)row[a], (size_t)row[b]) +=
              stiffness * c->normal[a] * c->normal[b];
    }
  }
}

/* A unit motion of the whole: along the ground, out of it, or a turn. False: supports forbid it. */
static bool rigid_motion(const strut_path_system *s, int which, double *motion) {
  const double axis[2][2] = {{1, 0}, {0, 1}};
  bool sloped = s->model.contacts.count > 0;
  const double *along = sloped ? s->model.contacts.tangent : axis[0];
  const double *out = sloped ? s->model.contacts.normal : axis[1];
  double centre[2] = {0, 0}, sum = 0;
  int32_t nodes = s->model.node_count, pins = 0;
  for (int32_t i = 0; i < nodes; i++)
    for (int c = 0; c < 2; c++) centre[c] += s->q[2 * i + c] / nodes;
  for (int32_t i = 0; i < nodes; i++)
    if (s->model.fixed[2 * i] && s->model.fixed[2 * i + 1] && pins++ == 0)
      centre[0] = s->q[2 * i], centre[1] = s->q[2 * i + 1];
  bool possible = true;
  for (int32_t at = 0; at < 2 * nodes; at++) {
    double turn = at % 2 == 0 ? -(s->q[at + 1] - centre[1]) : s->q[at - 1] - centre[0];
    double there = which == 0 ? along[at % 2] : which == 1 ? out[at % 2] : turn / s->size;
    int32_t row = s->potential->row_of[at];
    if (row < 0 && fabs(there) > RIGID) possible = false;
    if (row >= 0) motion[row] = there, sum += there * there;
  }
  for (int32_t k = 0; k < s->n && sum > 0; k++) motion[k] /= sqrt(sum);
  return possible;
}

/* Holds rigid motions that meet no stiffness and no load: they would make every matrix singular. */
static void hold_rigid_motions(strut_path_system *s) {
  size_t n = (size_t)s->n;
  double low, high, work = 0, load = 0;
  s->drifts = false;
  gsl_matrix_minmax(s->hessian, &low, &high);
  double stiff = fmax(-low, high), scale = stiff > 0 ? stiff : 1.0;
  gsl_vector_view motion = gsl_vector_view_array(s->row, n);
  gsl_vector_view product = gsl_vector_subvector(s->solution, 0, n);
  for (int k = 0; k < MOTIONS; k++) {
    if (!rigid_motion(s, k, s->row)) continue;
    work = load = 0;
    for (int32_t i = 0; i < s->n; i++) {
      double p = s->load[s->potential->coordinate[i]];
      work += p * s->row[i], load += p * p;
    }
    gsl_blas_dsymv(CblasLower, 1.0, s->hessian, &motion.vector, 0.0, &product.vector);
    if (gsl_blas_dnrm2(&product.vector) > RIGID * stiff) continue;
    if (fabs(work) > RIGID * sqrt(load))
      s->drifts = true;
    else
      gsl_blas_dger(scale, &motion.vector, &motion.vector, s->hessian);
  }
}

/* Residual g and stiffness at y. */
static void evaluate(strut_path_system *s, const double *y) {
  strut_potential *p = s->potential;
  double factor = s->unit * y[s->n];
  strut_path_place(s, y, s->q);
  for (int32_t at = 0; at < s->model.length; at++)
    p->force[at] = s->base[at] + factor * s->load[at];
  strut_potential_gradient(p, s->q, s->g);
  strut_potential_hessian(p, s->q, s->sparse);
  gsl_matrix_set_zero(s->hessian);
  for (int32_t j = 0; j < s->n; j++)
    for (int32_t at = s->sparse->start[j]; at < s->sparse->start[j + 1]; at++) {
      size_t row = (size_t)s->sparse->row[at], column = (size_t)j;
      gsl_matrix_set(s->hessian, row, column, s->sparse->value[at]);
      gsl_matrix_set(s->hessian, column, row, s->sparse->value[at]);
    }
  add_contacts(s);
  hold_rigid_motions(s);
}

/* Solves [K -p; row] x = (top, bottom), rows brought to one size; false: singular. */
static bool solve(strut_path_system *s, const double *row, const double *top, double bottom) {
  size_t n = (size_t)s->n;
  int sign;
  for (size_t i = 0; i <= n; i++) {
    double most = 0;
    for (size_t j = 0; j <= n; j++) {
      double entry = i == n  ? row[j]
                     : j < n ? s->size * gsl_matrix_get(s->hessian, i, j)
                             : -s->unit * s->load[s->potential->coordinate[i]];
      gsl_matrix_set(s->bordered, i, j, entry);
      most = fmax(most, fabs(entry));
    }
    if (!(most > 0) || !isfinite(most)) return false;
    gsl_vector_set(s->right, i, (i == n ? bottom : top ? top[i] : 0.0) / most);
    for (size_t j = 0; j <= n; j++) *gsl_matrix_ptr(s->bordered, i, j) /= most;
  }
  if (gsl_linalg_LU_decomp(s->bordered, s->order, &sign)) return false;
  for (size_t i = 0; i <= n; i++)
    if (gsl_matrix_get(s->bordered, i, i) == 0.0) return false;
  return gsl_linalg_LU_solve(s->bordered, s->order, s->right, s->solution) == 0;
}

int strut_path_correct(strut_path_system *s, const double *row, double value, double *y) {
  double before = HUGE_VAL;
  for (int k = 1; k <= MOST_ITERATIONS; k++) {
    double bottom = value, change = 0;
    evaluate(s, y);
    for (int32_t i = 0; i <= s->n; i++) bottom -= row[i] * y[i];
    for (int32_t i = 0; i < s->n; i++) s->g[i] = -s->g[i];
    if (!solve(s, row, s->g, bottom)) return -1;
    for (int32_t i = 0; i <= s->n; i++) {
      double step = gsl_vector_get(s->solution, (size_t)i);
      change = fmax(change, fabs(step));
      y[i] += step;
    }
    if (change <= CONVERGED || (before <= NEAR && change <= NEAR && change > 0.3 * before))
      return k;
    if (!isfinite(change) || change > FAR || (k > 2 && change > 4 * before)) return -1;
    before = change;
  }
  return before <= NEAR ? MOST_ITERATIONS : -1;
}

bool strut_path_tangent(strut_path_system *s, const double *y, const double *row, double *tangent) {
  double sum = 0;
  evaluate(s, y);
  if (!solve(s, row, NULL, 1.0)) return false;
  for (int32_t i = 0; i <= s->n; i++) {
    tangent[i] = gsl_vector_get(s->solution, (size_t)i);
    sum += tangent[i] * tangent[i];
  }
  if (!isfinite(sum) || sum == 0) return false;
  for (int32_t i = 0; i <= s->n; i++) tangent[i] /= sqrt(sum);
  return true;
}

void strut_path_spectrum(strut_path_system *s, const double *y, bool vectors) {
  evaluate(s, y);
  if (!vectors) {
    gsl_eigen_symm(s->hessian, s->values, s->values_only);
    gsl_sort_vector(s->values);
    return;
  }
  gsl_eigen_symmv(s->hessian, s->values, s->vectors, s->eigen);
  gsl_eigen_symmv_sort(s->values, s->vectors, GSL_EIGEN_SORT_VAL_ASC);
}

int32_t strut_path_negative(const strut_path_system *s) {
  int32_t count = 0;
  double largest = 0;
  for (int32_t i = 0; i < s->n; i++)
    largest = fmax(largest, fabs(gsl_vector_get(s->values, (size_t)i)));
  for (int32_t i = 0; i < s->n; i++)
    if (gsl_vector_get(s->values, (size_t)i) < -ZERO_VALUE * largest) count++;
  return count;
}

int32_t strut_path_switch_count(const strut_path_system *s) {
  return s->model.members.count + s->model.contacts.count;
}

double strut_path_switch_value(const strut_path_system *s, int32_t which, const double *q) {
  const strut_member_table *t = &s->model.members;
  if (which >= t->count) return -gap_of(&s->model.contacts, which - t->count, q);
  if (s->model.scene->members[which].kind != STRUT_CABLE) return -HUGE_VAL;
  const double *a = q + t->from[which], *b = q + t->to[which];
  return hypot(b[0] - a[0], b[1] - a[1]) - t->rest[which];
}

bool strut_path_switch_is_on(const strut_path_system *s, int32_t which) {
  int32_t members = s->model.members.count;
  return which < members ? s->slack[which] < 0 : s->touching[which - members] != 0;
}

void strut_path_switch_set(strut_path_system *s, int32_t which, bool on) {
  int32_t members = s->model.members.count;
  if (which < members)
    s->slack[which] = on ? -HUGE_VAL : HUGE_VAL;
  else
    s->touching[which - members] = on;
}

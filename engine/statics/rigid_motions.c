/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/rigid_motions.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"

/* Turns rows and columns p, q so that their common entry becomes 0. */
static void rotate(double a[3][3], double v[3][3], int p, int q) {
  if (a[p][q] == 0.0) return;
  double theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
  double t = (theta < 0 ? -1.0 : 1.0) / (fabs(theta) + sqrt(theta * theta + 1.0));
  double c = 1.0 / sqrt(t * t + 1.0), s = t * c;
  for (int i = 0; i < 3; i++) {
    double x = a[i][p], y = a[i][q];
    a[i][p] = c * x - s * y, a[i][q] = s * x + c * y;
  }
  for (int i = 0; i < 3; i++) {
    double x = a[p][i], y = a[q][i];
    a[p][i] = c * x - s * y, a[q][i] = s * x + c * y;
    x = v[p][i], y = v[q][i];
    v[p][i] = c * x - s * y, v[q][i] = s * x + c * y;
  }
}

void strut_symmetric_3(double matrix[3][3], double value[3], double vector[3][3]) {
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) vector[i][k] = i == k ? 1.0 : 0.0;
  for (int sweep = 0; sweep < 30; sweep++) {
    rotate(matrix, vector, 0, 1);
    rotate(matrix, vector, 0, 2);
    rotate(matrix, vector, 1, 2);
  }
  for (int i = 0; i < 3; i++) value[i] = matrix[i][i];
  for (int i = 1; i < 3; i++)
    for (int k = i; k > 0 && value[k - 1] > value[k]; k--) {
      double swap = value[k], row[3];
      value[k] = value[k - 1], value[k - 1] = swap;
      memcpy(row, vector[k], sizeof row);
      memcpy(vector[k], vector[k - 1], sizeof row);
      memcpy(vector[k - 1], row, sizeof row);
    }
}

/* Displacement of coordinate `at` per unit of (along x, along y, rotation about the centre by 1/size). */
typedef struct frame {
  double centre[2], size;
} frame;

static frame frame_of(const strut_model *model, const double *q) {
  frame f = {{0.0, 0.0}, model->size > 0 ? model->size : 1.0};
  for (int32_t at = 0; at < 2 * model->node_count; at++) f.centre[at % 2] += q[at];
  for (int c = 0; c < 2; c++) f.centre[c] /= model->node_count;
  return f;
}

static void motion_at(const frame *f, const double *q, int32_t at, double row[3]) {
  int32_t node = at / 2;
  row[0] = at % 2 == 0, row[1] = at % 2 == 1;
  row[2] = at % 2 == 0 ? -(q[2 * node + 1] - f->centre[1]) / f->size
                       : (q[2 * node] - f->centre[0]) / f->size;
}

/* Takes the directions of the earlier ones out of row `count`; false where nothing is left. */
static bool make_orthonormal(double *motion, int32_t n, int32_t count) {
  double *row = motion + (size_t)count * (size_t)n;
  double before = sqrt(strut_dot(row, row, n));
  for (int again = 0; again < 2; again++)
    for (int32_t k = 0; k < count; k++) {
      const double *other = motion + (size_t)k * (size_t)n;
      double share = strut_dot(row, other, n);
      for (int32_t i = 0; i < n; i++) row[i] -= share * other[i];
    }
  double length = sqrt(strut_dot(row, row, n));
  if (!(length > 1e-9 * before)) return false;
  for (int32_t i = 0; i < n; i++) row[i] /= length;
  return true;
}

int32_t strut_rigid_motions(const strut_potential *p, const double *q, double *motion) {
  const strut_model *model = p->model;
  frame f = frame_of(model, q);
  double held[3][3] = {{0}}, value[3], vector[3][3], row[3];
  for (int32_t at = 0; at < 2 * model->node_count; at++) {
    if (p->row_of[at] >= 0) continue;
    motion_at(&f, q, at, row);
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++) held[i][k] += row[i] * row[k];
  }
  strut_symmetric_3(held, value, vector);
  int32_t count = 0;
  for (int i = 0; i < 3 && p->n > 0; i++) {
    if (value[i] > 1e-14 * (1.0 + value[2])) continue;
    double *to = motion + (size_t)count * (size_t)p->n;
    for (int32_t k = 0; k < p->n; k++) {
      motion_at(&f, q, p->coordinate[k], row);
      to[k] = vector[i][0] * row[0] + vector[i][1] * row[1] + vector[i][2] * row[2];
    }
    if (make_orthonormal(motion, p->n, count)) count++;
  }
  return count;
}

int32_t strut_rigid_motions_free(const strut_sparse *hessian, double tolerance, int32_t count,
                                 double *motion, double *work) {
  assert(count >= 0 && count <= 3);
  size_t n = (size_t)hessian->n, kept = 0;
  double form[3][3] = {{0}}, value[3], vector[3][3];
  for (size_t i = 0; i < (size_t)count; i++)
    strut_sparse_multiply(hessian, motion + i * n, work + i * n);
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      form[i][k] = i < count && k < count
                       ? strut_dot(work + (size_t)i * n, work + (size_t)k * n, hessian->n)
                   : i == k ? HUGE_VAL
                            : 0.0;
  for (int i = 0; i < 3; i++)
    if (form[i][i] == HUGE_VAL) form[i][i] = 1e300; /* no motion: sorted to the end */
  strut_symmetric_3(form, value, vector);
  memcpy(work, motion, (size_t)count * n * sizeof *work);
  for (int i = 0; i < 3 && value[i] <= tolerance * tolerance; i++, kept++)
    for (size_t at = 0; at < n; at++) {
      double sum = 0.0;
      for (size_t k = 0; k < (size_t)count; k++) sum += vector[i][k] * work[k * n + at];
      motion[kept * n + at] = sum;
    }
  return (int32_t)kept;
}

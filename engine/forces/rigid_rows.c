/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of constraints, the matrix J M^-1 J' between them and its Cholesky factor. See rigid.h. */
#include <math.h>

#include "engine/forces/rigid.h"

/* A pivot this small against its diagonal is what rounding leaves of a dependent row. */
static const double DEPENDENT = 1e-11;
/* Contacts give way by so much, so that friction is shared where rigid bars join stuck nodes. */
static const double SHARING = 1e-9;

void strut_rigid_rows(strut_rigid *rigid, const double *q) {
  rigid->rows = rigid->bars;
  for (int32_t r = 0; r < rigid->bars; r++) {
    const double *a = q + rigid->at[rigid->end[r][0]], *b = q + rigid->at[rigid->end[r][1]];
    strut_vec2 span = strut_vec2_between(a, b);
    rigid->row[r][0] = rigid->end[r][0], rigid->row[r][1] = rigid->end[r][1];
    rigid->direction[r] = strut_vec2_unit(span, strut_vec2_length(span));
  }
}

void strut_rigid_add_foot(const strut_model *model, strut_rigid *rigid, int32_t contact) {
  int32_t r = rigid->rows++;
  rigid->row[r][0] = -1, rigid->row[r][1] = rigid->foot[contact];
  rigid->direction[r] = (strut_vec2){model->contacts.tangent[0], model->contacts.tangent[1]};
}

double strut_rigid_along(const strut_rigid *rigid, int32_t r, const double *x) {
  const strut_vec2 u = rigid->direction[r];
  const double *b = x + rigid->at[rigid->row[r][1]];
  double sum = b[0] * u.x + b[1] * u.y;
  if (rigid->row[r][0] < 0) return sum;
  const double *a = x + rigid->at[rigid->row[r][0]];
  return sum - (a[0] * u.x + a[1] * u.y);
}

/* The entry of J M^-1 J' between two rows. */
static double between(const strut_rigid *rigid, int32_t r, int32_t s) {
  const strut_vec2 u = rigid->direction[r], w = rigid->direction[s];
  double sum = 0.0;
  for (int e = 0; e < 2; e++)
    for (int f = 0; f < 2; f++) {
      int32_t i = rigid->row[r][e], j = rigid->row[s][f];
      if (i < 0 || j < 0) continue;
      size_t place = (size_t)i * (size_t)rigid->nodes + (size_t)j;
      double part = u.x * w.x * rigid->inverse[0][place] + u.y * w.y * rigid->inverse[1][place];
      sum += e == f ? part : -part;
    }
  return sum;
}

int32_t strut_rigid_factorise(strut_rigid *rigid) {
  size_t n = (size_t)rigid->most;
  double *m = rigid->matrix;
  for (int32_t r = 0; r < rigid->rows; r++) {
    double *row = m + (size_t)r * n;
    double whole = between(rigid, r, r), pivot = r < rigid->bars ? whole : whole * (1.0 + SHARING);
    for (int32_t s = 0; s < r; s++) {
      const double *other = m + (size_t)s * n;
      double sum = between(rigid, r, s);
      for (int32_t k = 0; k < s; k++) sum -= row[k] * other[k];
      row[s] = other[s] > 0.0 ? sum / other[s] : 0.0;
      pivot -= row[s] * row[s];
    }
    bool fine = pivot > DEPENDENT * whole;
    row[r] = fine ? sqrt(pivot) : 0.0; /* of a contact: it gets no friction */
    if (!fine && r < rigid->bars) return r;
  }
  return -1;
}

void strut_rigid_solve(strut_rigid *rigid) {
  size_t n = (size_t)rigid->most;
  double *x = rigid->right;
  for (int32_t r = 0; r < rigid->rows; r++) {
    const double *row = rigid->matrix + (size_t)r * n;
    double sum = x[r];
    for (int32_t k = 0; k < r; k++) sum -= row[k] * x[k];
    x[r] = row[r] > 0.0 ? sum / row[r] : 0.0;
  }
  for (int32_t r = rigid->rows - 1; r >= 0; r--) {
    double sum = x[r];
    for (int32_t k = r + 1; k < rigid->rows; k++)
      sum -= rigid->matrix[(size_t)k * n + (size_t)r] * x[k];
    double pivot = rigid->matrix[(size_t)r * n + (size_t)r];
    x[r] = pivot > 0.0 ? sum / pivot : 0.0;
  }
}

void strut_rigid_spread(const strut_rigid *rigid, double *force) {
  for (int32_t r = 0; r < rigid->rows; r++)
    for (int e = 0; e < 2; e++) {
      if (rigid->row[r][e] < 0) continue;
      double *f = force + rigid->at[rigid->row[r][e]],
             push = e ? rigid->right[r] : -rigid->right[r];
      f[0] += push * rigid->direction[r].x;
      f[1] += push * rigid->direction[r].y;
    }
}

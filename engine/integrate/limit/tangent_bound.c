/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/limit/tangent_bound.h"

#include <math.h>
#include <string.h>

#include "engine/model/mass.h"

/* Passes that improve the weights; rays along which RK4's region is sampled. */
enum { PASSES = 24, RAYS = 256 };
/* Weights and masses never fall below; what rays between those looked at may be short of; and for
   the rounding of sums. */
static const double LEAST = 1e-200, BETWEEN = 0.999, ROUNDING = 1.0 - 1e-12;

typedef struct bounding {
  const strut_tangent *tangent;
  double *mass, *weight, *stiff, *damp; /* (n) */
} bounding;

/* Those in M, which is no smaller with them than without, and not always diagonally dominant. */
static void leave_out_sliding_masses(const strut_model *model, double *full) {
  for (int32_t i = 0; i < model->sliding.count; i++) {
    const strut_sliding_item *s = &model->sliding.item[i];
    double part[2] = {1.0 - s->start, s->start};
    for (uint32_t c = 0; c < 2 && s->signal < 0; c++) {
      bool both = !model->fixed[s->at[0] + c] && !model->fixed[s->at[1] + c];
      for (int e = 0; e < 2; e++)
        full[s->at[e] + c] -= s->mass * part[e] * (part[e] - (both ? part[1 - e] : 0.0));
    }
  }
}

/*
 * What is left of each row of M when the sizes of the others are taken off its diagonal: then M less
 * this diagonal is diagonally dominant. Of a consistent rod it is a sixth at each end.
 */
static bool least_masses(const strut_model *model, strut_arena *arena, bounding *b) {
  double *full = strut_arena_allocate(arena, (size_t)model->length, sizeof *full);
  if (!full) return false;
  for (int c = 0; c < 2; c++) {
    const strut_mass_operator *op = &model->mass->coordinate[c];
    const strut_sparse *m = op->matrix;
    for (int32_t j = 0; j < m->n; j++) {
      double *to = &full[2 * op->matrix_node[j] + c];
      *to += m->value[m->start[j]];
      for (int32_t k = m->start[j] + 1; k < m->start[j + 1]; k++) {
        double size = fabs(m->value[k]);
        *to -= size;
        full[2 * op->matrix_node[m->row[k]] + c] -= size;
      }
    }
  }
  leave_out_sliding_masses(model, full);
  for (int32_t i = 0; i < b->tangent->n; i++)
    b->mass[i] = fmax(full[b->tangent->coordinate[i]], LEAST);
  return true;
}

/* y = |A| z / mass / z. */
static void ratios(const bounding *b, const strut_sparse *a, double *y) {
  const double *z = b->weight;
  memset(y, 0, (size_t)a->n * sizeof *y);
  for (int32_t j = 0; j < a->n; j++) {
    double sum = fabs(a->value[a->start[j]]) * z[j];
    for (int32_t k = a->start[j] + 1; k < a->start[j + 1]; k++) {
      double size = fabs(a->value[k]);
      y[a->row[k]] += size * z[j];
      sum += size * z[a->row[k]];
    }
    y[j] += sum;
  }
  for (int32_t i = 0; i < a->n; i++) y[i] /= b->mass[i] * z[i];
}

/* The step at which c h d + h^2/4 k is 1. */
static double flip(double c, double k, double d) {
  double sum = c * d + sqrt(c * c * d * d + k);
  return sum > 0.0 ? 2.0 / sum : HUGE_VAL;
}

/* What these weights say, where it is better than what was known. */
static void take(const bounding *b, strut_tangent_bound *bound) {
  double square = 0.0, rate = 0.0, verlet = HUGE_VAL, euler = HUGE_VAL;
  for (int32_t i = 0; i < b->tangent->n; i++) {
    square = fmax(square, b->stiff[i]), rate = fmax(rate, b->damp[i]);
    verlet = fmin(verlet, flip(1.0, b->stiff[i], b->damp[i]));
    euler = fmin(euler, flip(0.5, b->stiff[i], b->damp[i]));
  }
  double *of = bound->of;
  bound->frequency = fmin(bound->frequency, sqrt(square) / ROUNDING);
  bound->rate = fmin(bound->rate, rate / ROUNDING);
  of[STRUT_REGION_VERLET] = fmax(of[STRUT_REGION_VERLET], ROUNDING * verlet);
  of[STRUT_REGION_EULER] = fmax(of[STRUT_REGION_EULER], ROUNDING * euler);
}

/* The weights times the matrix that binds Verlet, the largest becoming 1. */
static void improve(bounding *b, double h) {
  double largest = 0.0;
  for (int32_t i = 0; i < b->tangent->n; i++) {
    b->weight[i] *= 0.25 * h * h * b->stiff[i] + h * b->damp[i];
    largest = fmax(largest, b->weight[i]);
  }
  for (int32_t i = 0; i < b->tangent->n; i++) b->weight[i] = fmax(b->weight[i] / largest, LEAST);
}

/*
 * RK4 from both: an eigenvalue of z^2 + d z + k is real and above -rate, or complex, no larger than
 * the frequency and no farther to the left than half the rate.
 */
static double rk4_bound(double frequency, double rate) {
  const double quarter = 1.57079632679489661923;
  double h = strut_rk4_limit(-rate, 0.0);
  if (!(frequency > 0.0)) return h;
  h = fmin(h, strut_rk4_limit(0.0, frequency));
  for (int i = 0; i < RAYS && rate > 0.0; i++) {
    double angle = quarter * (i + 1) / (RAYS + 1), x = cos(angle), y = sin(angle);
    double size = fmin(frequency, 0.5 * rate / x);
    h = fmin(h, BETWEEN * strut_rk4_limit(-size * x, size * y));
  }
  return h;
}

bool strut_tangent_bound_find(const strut_model *model, const strut_tangent *tangent,
                              strut_arena *arena, strut_tangent_bound *bound) {
  size_t n = (size_t)tangent->n;
  bounding b = {.tangent = tangent};
  double **const all[] = {&b.mass, &b.weight, &b.stiff, &b.damp};
  *bound = (strut_tangent_bound){.frequency = HUGE_VAL, .rate = HUGE_VAL};
  bound->of[STRUT_REGION_ALL] = HUGE_VAL;
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
    if (!(*all[i] = strut_arena_allocate(arena, n, sizeof(double)))) return false;
  if (!least_masses(model, arena, &b)) return false;
  for (size_t i = 0; i < n; i++) b.weight[i] = 1.0;
  for (int pass = 0; pass < PASSES; pass++) {
    ratios(&b, tangent->stiffness, b.stiff);
    ratios(&b, tangent->damping, b.damp);
    take(&b, bound);
    double h = bound->of[STRUT_REGION_VERLET];
    if (!(h > 0.0 && h < HUGE_VAL)) break;
    improve(&b, h);
  }
  bound->of[STRUT_REGION_RK4] = rk4_bound(bound->frequency, bound->rate);
  return true;
}

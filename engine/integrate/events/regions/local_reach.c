/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far what happens at a node reaches within a step: see local_region.h. */
#include <math.h>

#include "engine/base/memory.h"
#include "engine/integrate/events/regions/local_region.h"

/* Regions that must reach farther do not pay. */
enum { FARTHEST = 40 };
/*
 * Steps of the Lanczos iteration for the least eigenvalue of the scaled mass matrix; and the part of the
 * spectrum by which what they find may be too large.
 */
enum { LANCZOS_STEPS = 24 };
static const double UNCERTAIN = 0.05;

/*
 * Largest sums at a node: stiffnesses and dampings over its mass, and of the scaled mass matrix beside its
 * diagonal.
 */
typedef struct largest_sums {
  double stiffness, damping, coupled;
} largest_sums;

static largest_sums find_sums(const strut_model *model, const strut_local_region_map *map) {
  const strut_member_table *t = &model->members;
  largest_sums most = {0};
  for (int32_t i = 0; i < model->node_count; i++) {
    double stiffness = 0.0, damping = 0.0, sum = 0.0, own = map->diagonal[i];
    if (!(own > 0.0)) continue;
    for (int32_t e = map->member_start[i]; e < map->member_start[i + 1]; e++)
      stiffness += t->stiffness[map->member[e]], damping += t->damping[map->member[e]];
    for (int32_t e = map->mass_start[i]; e < map->mass_start[i + 1]; e++)
      sum += fabs(map->mass_value[e]) / sqrt(own * map->diagonal[map->mass_node[e]]);
    most.stiffness = fmax(most.stiffness, stiffness / own);
    most.damping = fmax(most.damping, damping / own);
    most.coupled = fmax(most.coupled, sum);
  }
  return most;
}

/* ---- the least eigenvalue of the mass matrix scaled to a diagonal of ones ---- */

/* y = S x; returns x' y. */
static double multiply_scaled(const strut_model *model, const strut_local_region_map *map,
                              const double *x, double *y) {
  double product = 0.0;
  for (int32_t i = 0; i < model->node_count; i++) {
    double own = map->diagonal[i], sum = x[i];
    for (int32_t e = map->mass_start[i]; e < map->mass_start[i + 1]; e++) {
      int32_t other = map->mass_node[e];
      sum += map->mass_value[e] / sqrt(own * map->diagonal[other]) * x[other];
    }
    y[i] = sum;
    product += x[i] * sum;
  }
  return product;
}

/* Scales x to length 1; returns its length. */
static double normalise(int32_t n, double *x) {
  double square = 0.0;
  for (int32_t i = 0; i < n; i++) square += x[i] * x[i];
  double length = sqrt(square);
  for (int32_t i = 0; i < n && length > 0.0; i++) x[i] /= length;
  return length;
}

/* Is an eigenvalue of the tridiagonal matrix below x? By the signs of its pivots. */
static bool has_below(const double *diagonal, const double *beside, int count, double x) {
  double pivot = 1.0;
  for (int k = 0; k < count; k++) {
    pivot = diagonal[k] - x - (k ? beside[k - 1] * beside[k - 1] / pivot : 0.0);
    if (pivot < 0.0) return true;
    if (pivot == 0.0) pivot = 1e-300;
  }
  return false;
}

/* By Lanczos from above, within [low, 1]. */
static strut_status find_least_eigenvalue(const strut_model *model,
                                          const strut_local_region_map *map, double low,
                                          double *least) {
  int32_t n = model->node_count;
  double diagonal[LANCZOS_STEPS], beside[LANCZOS_STEPS], high = 1.0;
  double *x = strut_allocate((size_t)n, sizeof *x), *y = strut_allocate((size_t)n, sizeof *y);
  double *before = strut_allocate((size_t)n, sizeof *before);
  bool good = x && y && before;
  uint64_t noise = 1;
  for (int32_t i = 0; i < n && good; i++) {
    noise = noise * 6364136223846793005u + 1442695040888963407u;
    x[i] = map->diagonal[i] > 0.0 ? (double)(noise >> 11) * 0x1p-52 - 1.0 : 0.0;
  }
  int count = 0;
  if (good) normalise(n, x);
  while (count < LANCZOS_STEPS && good) {
    double a = multiply_scaled(model, map, x, y), b = count ? beside[count - 1] : 0.0;
    for (int32_t i = 0; i < n; i++) y[i] -= a * x[i] + b * before[i];
    diagonal[count] = a, beside[count] = normalise(n, y);
    double *old = before;
    before = x, x = y, y = old;
    if (!(beside[count++] > 1e-6)) break;
  }
  for (int k = 0; k < 30 && good; k++) {
    double middle = 0.5 * (low + high);
    *(has_below(diagonal, beside, count, middle) ? &high : &low) = middle;
  }
  *least = low;
  strut_release(x);
  strut_release(y);
  strut_release(before);
  return good ? STRUT_OK : STRUT_NO_MEMORY;
}

/* ---- bounds ---- */

strut_status strut_local_passing_find(const strut_model *model, const strut_local_region_map *map,
                                      strut_local_passing *p) {
  largest_sums most = find_sums(model, map);
  double surely = 1.0 - most.coupled, most_of_all = 1.0 + most.coupled, least = 1.0;
  *p = (strut_local_passing){.mass = 1.0};
  if (!(surely > 0.0)) return STRUT_OK;
  if (!model->mass->diagonal) {
    if (find_least_eigenvalue(model, map, surely, &least)) return STRUT_NO_MEMORY;
    least = fmax(surely, least - UNCERTAIN * (most_of_all - least));
  }
  double root = sqrt(most_of_all / least);
  p->stiffness = most.stiffness / least;
  p->damping = most.damping / least;
  p->mass = (root - 1.0) / (root + 1.0);
  return STRUT_OK;
}

static double choose(int n, int k) {
  double ways = 1.0;
  for (int i = 1; i <= k; i++) ways *= (double)(n - k + i) / i;
  return ways;
}

/* What is left behind `layers` neighbours: s of them passed by members, in any order, the others by masses. */
static double left_behind(const strut_local_passing *p, int layers) {
  double left = 0.0, over_factorial = 1.0; /* 1 / (s + 1)! */
  for (int s = 0; s <= layers; s++, over_factorial /= s + 1.0) {
    double members = 0.0, part = over_factorial; /* C(s, j) / (s + j + 1)! */
    for (int j = 0; j <= s; j++) {
      members += part * pow(p->stiffness, j) * pow(p->damping, s - j);
      part *= (double)(s - j) / ((j + 1.0) * (s + j + 2.0));
    }
    left += members * choose(layers, s) * pow(p->mass, layers - s);
  }
  return left;
}

/*
 * The part of that which a member passes on still farther out: what masses alone do there is not left out.
 * Each layer leaves a smaller part than the one before.
 */
static double passed_beyond(const strut_local_passing *p, int layers) {
  double left = left_behind(p, layers), part = left_behind(p, layers + 1) / left;
  if (!(part < 1.0)) return 1.0;
  return (p->stiffness / 6.0 + p->damping / 2.0) * left / (1.0 - part);
}

int strut_local_reach(const strut_local_passing *passing, double h, double left) {
  strut_local_passing p = {passing->stiffness * h * h, passing->damping * h, passing->mass};
  for (int layers = 1; layers <= FARTHEST; layers++) {
    bool within = p.mass == 0.0
                      ? left_behind(&p, layers) <= left
                      : passed_beyond(&p, layers) <= left && pow(p.mass, 2 * layers) <= left;
    if (within) return layers;
  }
  return 0;
}

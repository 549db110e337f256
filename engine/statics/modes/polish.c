/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shape to twice a double's precision, and what last bits do to a stiffness. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/statics/modes/parts.h"

enum { MOST_STEPS = 8, SAMPLES = 3 };

/* Shares of the largest eigenvalue: one that a plain factor bears, and next to none. */
static const double FIRM = 1.01e-10, HARDLY = 1e-24;

static double largest(const strut_dd *x, int32_t n) {
  double size = 0.0;
  for (int32_t i = 0; i < n; i++) size = fmax(size, fabs(x[i].hi));
  return size;
}

static void move(strut_vibration *v, const strut_dd *step, double sign) {
  for (int32_t i = 0; i < v->n; i++) {
    strut_dd *q = &v->q[v->shape->coordinate[i]];
    *q = dd_add(*q, dd_scale(step[i], sign));
  }
  strut_vibration_update(v);
}

/*
 * Newton's method from the shape as doubles give it, whose last bits leave forces of c times a bit.
 * It is that close already; a step that is not tiny is taken back. `firm` makes K regular where
 * something moves freely, and slows down what is softer. Returns true when nothing is left to do.
 */
static bool settle(strut_modes_work *work, double firm, strut_dd *step) {
  strut_vibration *v = work->v;
  strut_vibration_force(v, step);
  double force = largest(step, v->n);
  for (int i = 0; i < MOST_STEPS && force > 0; i++) {
    strut_modes_factorise(&work->solver, firm * v->largest);
    strut_modes_solve(&work->solver, step);
    double size = largest(step, v->n);
    if (!(size < 1e-6 * v->model->size)) return true;
    move(v, step, 1.0);
    strut_dd *after = v->work;
    strut_vibration_force(v, after);
    double left = largest(after, v->n);
    if (!(left < force)) {
      move(v, step, -1.0);
      return size < 1e-20 * v->model->size;
    }
    memcpy(step, after, (size_t)v->n * sizeof *step);
    if (left < 1e-25 * v->shape->force_scale || size < 1e-22 * v->model->size) return true;
    if (left > 1e-2 * force && i > 0) return false;
    force = left;
  }
  return !(force > 0);
}

/* -1 to 1, from an index. */
static double stirred(uint64_t i) {
  uint64_t z = (i + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1.0;
}

/*
 * Rest lengths off by up to half of their last bit: how the forces follow once it has come to rest
 * again; or, in a shape that is not at rest, lengths off by their last bits.
 */
static void sample_noise(strut_modes_work *work, bool at_rest, uint64_t sample, double *noise,
                         strut_dd *x) {
  const strut_vibration *v = work->v;
  const strut_member_table *t = &v->model->members;
  uint64_t first = sample * (uint64_t)t->count;
  for (int32_t i = 0; i < v->n; i++) x[i] = dd_of(0.0);
  for (int32_t j = 0; j < t->count; j++) {
    const strut_vibration_member *m = &v->member[j];
    double bits = 0.5 * DBL_EPSILON * t->rest[j] * stirred(first + (uint64_t)j);
    if (!at_rest) bits = DBL_EPSILON * (m->length + t->rest[j]) * stirred(first + (uint64_t)j);
    noise[j] = m->taut ? -t->stiffness[j] * bits : 0.0;
    if (!at_rest || !m->taut) continue;
    double pull[2] = {noise[j] * m->ux.hi, noise[j] * m->uy.hi};
    for (uint32_t c = 0; c < 2; c++) {
      int32_t a = v->shape->row_of[t->from[j] + c], b = v->shape->row_of[t->to[j] + c];
      if (a >= 0) x[a] = dd_add(x[a], dd_of(pull[c]));
      if (b >= 0) x[b] = dd_sub(x[b], dd_of(pull[c]));
    }
  }
  if (at_rest) {
    strut_modes_solve(&work->solver, x);
    double *moved = (double *)v->work;
    for (int32_t i = 0; i < v->n; i++) moved[i] = dd_double(x[i]);
    for (int32_t j = 0; j < t->count; j++)
      if (v->member[j].taut)
        noise[j] += t->stiffness[j] * strut_vibration_spread(v, j, moved).along;
  }
  for (int32_t j = 0; j < t->count; j++)
    noise[j] = v->member[j].length > 0 ? noise[j] / v->member[j].length : 0.0;
}

static void measure_noise(strut_modes_work *work, const double *noise) {
  const strut_vibration *v = work->v;
  strut_eigen_set *set = &work->set;
  for (int32_t i = 0; i < set->count; i++) {
    double sum = 0.0;
    for (int32_t j = 0; j < v->model->members.count; j++) {
      if (noise[j] == 0) continue;
      double across = strut_vibration_spread(v, j, set->vector + (size_t)i * (size_t)v->n).across;
      sum += noise[j] * across * across;
    }
    set->noise[i] = fmax(set->noise[i], 2.0 * fabs(sum)); /* twice: there are few samples */
  }
}

strut_status strut_modes_settle(strut_modes_work *work, strut_error *error) {
  strut_dd *step = strut_arena_allocate(work->arena, (size_t)work->v->n, sizeof *step);
  if (!step) return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  if (!settle(work, FIRM, step)) settle(work, HARDLY, step);
  return STRUT_OK;
}

/* A shift that leaves all but the motions without stiffness as they are. */
static double find_soft(const strut_modes_work *work) {
  const strut_eigen_set *set = &work->set;
  double low = work->v->largest;
  for (int32_t i = 0; i < set->count; i++)
    if (fabs(set->value[i]) > 1e-20 * work->v->largest) low = fmin(low, fabs(set->value[i]));
  return 1e-3 * low;
}

strut_status strut_modes_noise(strut_modes_work *work, bool at_rest, strut_error *error) {
  strut_vibration *v = work->v;
  strut_dd *step = strut_arena_allocate(work->arena, (size_t)v->n, sizeof *step);
  double *noise = strut_arena_allocate(work->arena, (size_t)v->model->members.count, sizeof *noise);
  if (!step || !noise) return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  if (at_rest) strut_modes_factorise(&work->solver, find_soft(work));
  for (uint64_t sample = 0; sample < SAMPLES; sample++) {
    sample_noise(work, at_rest, sample, noise, step);
    measure_noise(work, noise);
  }
  return STRUT_OK;
}

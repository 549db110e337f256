/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/events/location/variation.h"

#include <math.h>
#include <string.h>

#include "engine/integrate/events/event_kernel.h"

enum { MOST_STAGES = 6 };
/* Differences of an event's value: in time, in grid steps; along columns, relative to size and size per
   step. */
static const double TIME_DIFFERENCE = 1e-4, DIFFERENCE = 1e-7;

bool strut_variation_possible(const strut_model *model, const strut_integrator *method) {
  return method->tangent && strut_mode_tangent_possible(model);
}

strut_variation *strut_variation_create(const strut_model *model, strut_state *state) {
  strut_arena *arena = &state->arena;
  strut_variation *variation = strut_arena_allocate(arena, 1, sizeof *variation);
  if (!variation || !(variation->tangent = strut_mode_tangent_create(model, state))) return NULL;
  variation->n = variation->tangent->n, variation->stride = variation->tangent->width;
  variation->place = variation->tangent->coordinate;
  size_t rows = 2 * (size_t)variation->n, all = rows * (size_t)variation->stride,
         length = (size_t)model->length;
  bool good = STRUT_NUMBERS(arena, all, &variation->columns, &variation->middle) &&
              STRUT_NUMBERS(arena, variation->stride, &variation->delay, &variation->gradient) &&
              STRUT_NUMBERS(arena, variation->n, &variation->before) &&
              STRUT_NUMBERS(arena, length, &variation->stage_q, &variation->drift) &&
              STRUT_ALLOCATE(arena, STRUT_NEW(variation->slope, MOST_STAGES));
  for (int k = 0; k < MOST_STAGES && good; k++)
    good = (variation->slope[k] = strut_arena_allocate(arena, all, sizeof(double)));
  return good ? variation : NULL;
}

void strut_variation_reset(strut_variation *variation) {
  size_t all = 2 * (size_t)variation->n * (size_t)variation->stride;
  memset(variation->columns, 0, all * sizeof(double));
  for (int32_t i = 0; i < 2 * variation->n; i++)
    variation->columns[i * variation->stride + i] = 1.0;
}

static double *velocities(const strut_variation *variation) {
  return variation->columns + variation->n * variation->stride;
}

void strut_variation_begin(const strut_model *model, const strut_state *state,
                           const strut_event_stepper *stepper) {
  strut_variation *variation = state->watched.variation;
  memset(variation->delay, 0, (size_t)variation->stride * sizeof(double));
  strut_mode_tangent_hold(model, stepper, variation->tangent);
  strut_mode_tangent_project(variation->tangent, velocities(variation), variation->stride);
}

/* ---- steps ---- */

/* Two rows of the product of (n, width) and (2 n, stride), in `vectors` vectors from a column on. */
STRUT_INLINE void multiply_rows(int32_t inner, const double *restrict one,
                                const double *restrict two, const double *restrict z,
                                int32_t stride, double *to_one, double *to_two, int vectors) {
  strut_lanes a[4] = {{0}}, b[4] = {{0}};
  for (int32_t k = 0; k < inner; k++) {
    const double *row = z + k * stride;
#pragma GCC unroll 4
    for (int c = 0; c < vectors; c++) {
      strut_lanes x = strut_lanes_load(row + c * STRUT_LANES);
      a[c] += one[k] * x;
      b[c] += two[k] * x;
    }
  }
#pragma GCC unroll 4
  for (int c = 0; c < vectors; c++) {
    strut_lanes_store(to_one + c * STRUT_LANES, a[c]);
    strut_lanes_store(to_two + c * STRUT_LANES, b[c]);
  }
}

/* out (n, stride) = rate (n, width) z (2 n, stride) */
STRUT_CLONES
static void multiply(int32_t n, int32_t stride, const double *restrict rate,
                     const double *restrict z, double *restrict out) {
  enum { BLOCK = 4 * STRUT_LANES };
  for (int32_t i = 0; i < n; i += 2) {
    int32_t next = i + 1 < n ? i + 1 : i, c = 0;
    const double *one = rate + i * stride, *two = rate + next * stride;
    double *to_one = out + i * stride, *to_two = out + next * stride;
    for (; c + BLOCK <= stride; c += BLOCK)
      multiply_rows(2 * n, one, two, z + c, stride, to_one + c, to_two + c, 4);
    for (; c < stride; c += STRUT_LANES)
      multiply_rows(2 * n, one, two, z + c, stride, to_one + c, to_two + c, 1);
  }
}

/* A vector of z + h sum_j weight[j] slope[j], from i on. */
STRUT_INLINE void combine_vector(int32_t i, double h, const double *weight, int count,
                                 double *const *slope, const double *restrict z,
                                 double *restrict out) {
  strut_lanes sum = {0};
  for (int j = 0; j < count; j++)
    if (weight[j] != 0.0) sum += weight[j] * strut_lanes_load(slope[j] + i);
  strut_lanes_store(out + i, strut_lanes_load(z + i) + h * sum);
}

/* out = z + h sum_j weight[j] slope[j] */
STRUT_CLONES
static void combine(int32_t all, double h, const double *weight, int count, double *const *slope,
                    const double *restrict z, double *restrict out) {
  for (int32_t i = 0; i < all; i += STRUT_LANES) combine_vector(i, h, weight, count, slope, z, out);
}

/* Positions and velocities of the motion itself at stage k. */
static const double *place_stage(const strut_model *model, const strut_event_stepper *stepper,
                                 int k, double h, double *positions) {
  const strut_tableau *tableau = stepper->formula->tableau;
  if (k == 0) return stepper->now->v;
  const double *weight = tableau->weight[k];
  for (int32_t i = 0; i < model->length; i++) {
    double sum = weight[0] * stepper->now->v[i];
    for (int j = 1; j < k; j++) sum += weight[j] * stepper->stage[j][i];
    positions[i] = stepper->now->q[i] + h * sum;
  }
  return stepper->stage[k];
}

void strut_variation_step(const strut_model *model, strut_state *state,
                          const strut_event_stepper *stepper, double t, double h) {
  strut_variation *variation = state->watched.variation;
  const strut_tableau *tableau = stepper->formula->tableau;
  int32_t half = variation->n * variation->stride;
  size_t bytes = (size_t)half * sizeof(double);
  for (int k = 0; k < tableau->stages; k++) {
    const double *z = k ? variation->middle : variation->columns;
    const double *v = place_stage(model, stepper, k, h, variation->stage_q);
    if (k)
      combine(2 * half, h, tableau->weight[k], k, variation->slope, variation->columns,
              variation->middle);
    strut_mode_tangent_evaluate(model, state, stepper, t + tableau->ahead[k] * h,
                                k ? variation->stage_q : stepper->now->q, v, variation->tangent);
    memcpy(variation->slope[k], z + half, bytes);
    multiply(variation->n, variation->stride, variation->tangent->rate, z,
             variation->slope[k] + half);
  }
  combine(2 * half, h, tableau->weight[tableau->stages], tableau->stages, variation->slope,
          variation->columns, variation->middle);
  double *swap = variation->columns;
  variation->columns = variation->middle, variation->middle = swap;
  memset(variation->delay, 0, (size_t)variation->stride * sizeof(double));
  if ((model->terms & STRUT_TERM_DRIVE) && state->latest->drive_time != t + h)
    strut_drive_apply(model, state, t + h);
}

/* ---- events ---- */

/*
 * Of events that positions and speeds of a contact decide: the value's slopes along normal and tangent,
 * which act on speeds, or with TOUCH and OPEN on positions. False of others.
 */
static bool contact_slopes(const strut_event_stepper *stepper, const strut_event *event,
                           double *normal, double *tangent, bool *positions) {
  *normal = *tangent = 0.0, *positions = false;
  switch (event->kind) {
    case STRUT_EVENT_TOUCH: *normal = 1.0, *positions = true; return true;
    case STRUT_EVENT_OPEN: *normal = -1.0, *positions = true; return true;
    case STRUT_EVENT_SLIP_ENDS: *tangent = stepper->modes.side[event->index]; return true;
    case STRUT_EVENT_LEAVES_STICK_BAND:
      *tangent = stepper->now->touch[event->index].slip < 0.0 ? 1.0 : -1.0;
      return true;
    case STRUT_EVENT_DAMPER:
      *normal = stepper->modes.damper[event->index] > 0 ? -1.0 : 1.0;
      return true;
    case STRUT_EVENT_STICK_BREAKS:
    case STRUT_EVENT_CREEP_OUT:
    case STRUT_EVENT_CREEP_IN:
    case STRUT_EVENT_PUSH:
    case STRUT_EVENT_YIELDED:
    case STRUT_EVENT_ACTS:
    case STRUT_EVENT_KINK:
    case STRUT_EVENT_SLIDER:
    case STRUT_EVENT_BREAK:
    case STRUT_EVENT_FACET:
    case STRUT_EVENT_THRESHOLD:
    case STRUT_EVENT_TURN:
    case STRUT_EVENT_NONE: break;
  }
  return false;
}

static double contact_gradient(const strut_model *model, const strut_event_stepper *stepper,
                               const strut_event *event, double normal, double tangent,
                               bool positions, strut_variation *variation) {
  const strut_contact_table *contacts = &model->contacts;
  uint32_t at = contacts->at[event->index];
  const double *rows = positions ? variation->columns : velocities(variation);
  const double *rate = positions ? stepper->now->v : stepper->now->a;
  double sum = 0.0;
  for (uint32_t k = 0; k < 2; k++) {
    int32_t row = variation->tangent->row_of[at + k];
    double slope = normal * contacts->normal[k] + tangent * contacts->tangent[k];
    sum += slope * rate[at + k];
    for (int32_t j = 0; j < variation->stride && row >= 0; j++)
      variation->gradient[j] += slope * rows[row * variation->stride + j];
  }
  return sum;
}

/* The event's value at stepper->next, after it has been moved, in the present modes. */
static double value_beside(const strut_model *model, const strut_state *state,
                           strut_event_stepper *stepper, const strut_event *event, double t) {
  evaluate_step_end(model, state, stepper, t, stepper->next, STRUT_TERMS_ALL, false);
  strut_event_measure(model, state, stepper, stepper->next);
  return strut_event_value(model, stepper, stepper->next, event->kind, event->index);
}

/* By central differences along the motion, which gives the rate, and along each column. */
static double differenced_gradient(const strut_model *model, const strut_state *state,
                                   strut_event_stepper *stepper, const strut_event *event, double t,
                                   double dt, strut_variation *variation) {
  const strut_step_end *now = stepper->now;
  double value[2], step = TIME_DIFFERENCE * dt;
  double length = model->size, speed = model->size / dt;
  for (int side = 0; side < 2; side++) {
    double h = side ? step : -step;
    for (int32_t i = 0; i < model->length; i++) {
      stepper->next->q[i] = now->q[i] + h * (now->v[i] + 0.5 * h * now->a[i]);
      stepper->next->v[i] = now->v[i] + h * now->a[i];
    }
    value[side] = value_beside(model, state, stepper, event, t + h);
  }
  double rate = (value[1] - value[0]) / (2.0 * step);
  for (int32_t j = 0; j < 2 * variation->n; j++) {
    double most = 0.0;
    for (int32_t i = 0; i < 2 * variation->n; i++)
      most = fmax(most, fabs(variation->columns[i * variation->stride + j]) /
                            (i < variation->n ? length : speed));
    if (!(most > 0.0)) continue;
    double part = DIFFERENCE / most;
    for (int side = 0; side < 2; side++) {
      double factor = side ? part : -part;
      memcpy(stepper->next->q, now->q, (size_t)model->length * sizeof(double));
      memcpy(stepper->next->v, now->v, (size_t)model->length * sizeof(double));
      for (int32_t i = 0; i < variation->n; i++) {
        stepper->next->q[variation->place[i]] +=
            factor * variation->columns[i * variation->stride + j];
        stepper->next->v[variation->place[i]] +=
            factor * variation->columns[(variation->n + i) * variation->stride + j];
      }
      value[side] = value_beside(model, state, stepper, event, t);
    }
    variation->gradient[j] = (value[1] - value[0]) / (2.0 * part);
  }
  if ((model->terms & STRUT_TERM_DRIVE) && state->latest->drive_time != t)
    strut_drive_apply(model, state, t);
  return rate;
}

void strut_variation_meet(const strut_model *model, const strut_state *state,
                          strut_event_stepper *stepper, const strut_event *event, double t,
                          double dt, bool stepped) {
  strut_variation *variation = state->watched.variation;
  double normal, tangent;
  bool positions;
  for (int32_t i = 0; i < variation->n; i++)
    variation->before[i] = stepper->now->a[variation->place[i]];
  if (!stepped) return;
  memset(variation->gradient, 0, (size_t)variation->stride * sizeof(double));
  double rate = contact_slopes(stepper, event, &normal, &tangent, &positions)
                    ? contact_gradient(model, stepper, event, normal, tangent, positions, variation)
                    : differenced_gradient(model, state, stepper, event, t, dt, variation);
  for (int32_t j = 0; j < variation->stride; j++) {
    double delay = -variation->gradient[j] / rate;
    variation->delay[j] = isfinite(delay) ? delay : 0.0;
  }
}

void strut_variation_pass(const strut_model *model, const strut_state *state,
                          const strut_event_stepper *stepper, bool event) {
  strut_variation *variation = state->watched.variation;
  double *v = velocities(variation);
  if (!event) memset(variation->delay, 0, (size_t)variation->stride * sizeof(double));
  for (int32_t i = 0; i < variation->n && event; i++) {
    double jump = variation->before[i] - stepper->now->a[variation->place[i]];
    for (int32_t j = 0; j < variation->stride && jump != 0.0; j++)
      v[i * variation->stride + j] += jump * variation->delay[j];
  }
  strut_mode_tangent_hold(model, stepper, variation->tangent);
  strut_mode_tangent_project(variation->tangent, v, variation->stride);
}

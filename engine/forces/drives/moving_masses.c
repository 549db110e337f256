/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/drives/moving_masses.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/forces.h"
#include "engine/model/algebra/dense_cholesky.h"
#include "engine/model/mass.h"
#include "engine/scene/signal.h"

/* A moving mass at one instant: its item, its place, and what the motion of its member's nodes is. */
typedef struct slide {
  const strut_sliding_item *item;
  const strut_sliding_motion *at;
  double near;                /* 1 - share */
  strut_vec2 span, span_rate; /* from the first node to the second */
} slide;

static slide slide_at(const strut_model *model, const strut_state *state, int32_t k,
                      const double *q, const double *velocity) {
  assert(k >= 0 && k < model->sliding.moving_count);
  const strut_sliding_item *item = &model->sliding.item[model->sliding.moving[k]];
  const strut_sliding_motion *at = &state->latest->sliding[k];
  return (slide){.item = item,
                 .at = at,
                 .near = 1.0 - at->share,
                 .span = strut_vec2_between(q + item->at[0], q + item->at[1]),
                 .span_rate = strut_vec2_between(velocity + item->at[0], velocity + item->at[1])};
}

/* N z at a mass, for x and y. */
static strut_vec2 interpolate(const slide *self, const double *z) {
  const double *a = z + self->item->at[0], *b = z + self->item->at[1];
  return (strut_vec2){self->near * a[0] + self->at->share * b[0],
                      self->near * a[1] + self->at->share * b[1]};
}

static strut_vec2 velocity(const slide *self, const double *velocity) {
  strut_vec2 u = interpolate(self, velocity);
  return (strut_vec2){u.x + self->at->rate * self->span.x, u.y + self->at->rate * self->span.y};
}

/* Acceleration of the mass but for that of the nodes. */
static strut_vec2 drift(const slide *self) {
  double twice = 2.0 * self->at->rate, bend = self->at->bend;
  return (strut_vec2){twice * self->span_rate.x + bend * self->span.x,
                      twice * self->span_rate.y + bend * self->span.y};
}

/* Adds N' (x, y) to a coordinate array. */
static void spread(const slide *self, double x, double y, double *z) {
  double *a = z + self->item->at[0], *b = z + self->item->at[1];
  a[0] += self->near * x;
  a[1] += self->near * y;
  b[0] += self->at->share * x;
  b[1] += self->at->share * y;
}

/* 1/m + N M^-1 N' of all moving masses, lower triangle, for one coordinate. */
static void fill(const strut_sliding_table *table, const strut_sliding_motion *at,
                 const double *between, double *matrix) {
  int32_t n = table->moving_count;
  for (int32_t i = 0; i < n; i++)
    for (int32_t j = 0; j <= i; j++) {
      const double *row = between + 4 * i * n + 2 * j;
      double by_first = (1.0 - at[j].share) * row[0] + at[j].share * row[1];
      double by_second = (1.0 - at[j].share) * row[2 * n] + at[j].share * row[2 * n + 1];
      matrix[i * n + j] = (1.0 - at[i].share) * by_first + at[i].share * by_second;
      if (i == j) matrix[i * n + j] += 1.0 / table->item[table->moving[i]].mass;
    }
}

void strut_sliding_masses_place(const strut_model *model, const strut_state *state, double t) {
  const strut_sliding_table *table = &model->sliding;
  const strut_signal *signals = model->scene->signals;
  int32_t n = table->moving_count;
  double when = t + state->time_offset;
  for (int32_t k = 0; k < n; k++) {
    const strut_sliding_item *item = &table->item[table->moving[k]];
    strut_sliding_motion *at = &state->latest->sliding[k];
    double value, rate;
    strut_signal_evaluate(signals, item->signal, when, &value, &rate);
    at->share = item->base + item->scale * value;
    at->rate = item->scale * rate;
    at->bend = item->scale * strut_signal_acceleration(signals, item->signal, when);
  }
  for (int c = 0; c < 2 && table->between; c++) {
    double *matrix = state->buffers->sliding_factor + c * n * n;
    fill(table, state->latest->sliding, table->between + 4 * c * n * n, matrix);
    if (!strut_cholesky_factor(n, matrix)) matrix[0] = NAN; /* as the motion is, too */
  }
}

void strut_sliding_masses_correct(const strut_model *model, const strut_state *state,
                                  double *acceleration) {
  const strut_sliding_table *table = &model->sliding;
  int32_t n = table->moving_count;
  double *push[2] = {state->buffers->sliding_push, state->buffers->sliding_push + n};
  for (int32_t k = 0; k < n; k++) {
    const strut_sliding_item *item = &table->item[table->moving[k]];
    double far = state->latest->sliding[k].share, near = 1.0 - far;
    for (uint32_t c = 0; c < 2; c++)
      push[c][k] = near * acceleration[item->at[0] + c] + far * acceleration[item->at[1] + c];
  }
  for (int c = 0; c < 2; c++)
    strut_cholesky_solve(n, state->buffers->sliding_factor + c * n * n, push[c]);
  for (int32_t k = 0; k < n; k++) {
    const strut_sliding_answer *answer = &table->answer[k];
    double far = state->latest->sliding[k].share, near = 1.0 - far;
    for (int32_t i = 0; i < answer->count; i++) {
      const double *xy = answer->xy + 4 * i;
      acceleration[answer->at[i]] -= push[0][k] * (near * xy[0] + far * xy[2]);
      acceleration[answer->at[i] + 1] -= push[1][k] * (near * xy[1] + far * xy[3]);
    }
  }
}

void strut_sliding_masses_apply(const strut_model *model, const strut_state *state, double t,
                                const double *q, const double *v) {
  const double *g = model->scene->gravity, alpha = model->mass_damping;
  strut_sliding_masses_place(model, state, t);
  for (int32_t k = 0; k < model->sliding.moving_count; k++) {
    slide s = slide_at(model, state, k, q, v);
    const strut_sliding_item *item = s.item;
    double m = item->mass, moved = s.at->share - item->start;
    strut_vec2 d = drift(&s), u = velocity(&s, v);
    spread(&s, -m * (d.x + alpha * u.x), -m * (d.y + alpha * u.y), state->latest->force);
    for (uint32_t c = 0; c < 2; c++) { /* the weights have its own where it started */
      state->latest->force[item->at[0] + c] -= m * moved * g[c];
      state->latest->force[item->at[1] + c] += m * moved * g[c];
    }
    if (!state->balance || alpha == 0.0) continue;
    double lost = alpha * m * (u.x * u.x + u.y * u.y);
    strut_power_add(state->latest->power, STRUT_POWER_MEMBERS, lost);
  }
}

void strut_sliding_masses_add_power(const strut_model *model, const strut_state *state,
                                    const double *q, const double *v, const double *acceleration) {
  const double *g = model->scene->gravity, alpha = model->mass_damping;
  for (int32_t k = 0; k < model->sliding.moving_count; k++) {
    slide s = slide_at(model, state, k, q, v);
    strut_vec2 d = drift(&s), u = velocity(&s, v), bend = interpolate(&s, acceleration);
    double x = bend.x + d.x + alpha * u.x - g[0], y = bend.y + d.y + alpha * u.y - g[1];
    double power = s.item->mass * s.at->rate * (x * s.span.x + y * s.span.y);
    strut_power_add(state->latest->power, STRUT_POWER_DRIVE, power);
  }
}

void strut_sliding_masses_add_energies(const strut_model *model, const strut_state *state,
                                       const double *q, const double *v, double *kinetic,
                                       double *gravity) {
  const double *g = model->scene->gravity;
  for (int32_t k = 0; k < model->sliding.moving_count; k++) {
    slide s = slide_at(model, state, k, q, v);
    strut_vec2 u = velocity(&s, v);
    double moved = s.at->share - s.item->start;
    *kinetic += 0.5 * s.item->mass * (u.x * u.x + u.y * u.y);
    *gravity -= s.item->mass * moved * (g[0] * s.span.x + g[1] * s.span.y);
  }
}

/* Sum of the jumps of a signal's rate after `from` and up to `to`. */
static double jump_of_rate(const strut_signal *signals, int32_t signal, double from, double to) {
  double sum = 0.0, at = strut_signal_next_break(signals, signal, from);
  for (; at <= to; at = strut_signal_next_break(signals, signal, at)) {
    double value, before, after, moment = 8.0 * DBL_EPSILON * fmax(fabs(at), to - from);
    strut_signal_evaluate(signals, signal, at - moment, &value, &before);
    strut_signal_evaluate(signals, signal, at + moment, &value, &after);
    sum += after - before;
  }
  return sum;
}

/* Impulses of the jumps into state->latest->force, the jumps into their motions. True if there are any. */
static bool find_impulses(const strut_model *model, const strut_state *state, double from,
                          double to) {
  bool any = false;
  memset(state->latest->force, 0, (size_t)model->length * sizeof *state->latest->force);
  for (int32_t k = 0; k < model->sliding.moving_count; k++) {
    slide s = slide_at(model, state, k, state->q, state->v);
    double jump = s.item->scale * jump_of_rate(model->scene->signals, s.item->signal,
                                               from + state->time_offset, to + state->time_offset);
    double push = -s.item->mass * jump;
    state->latest->sliding[k].jump = jump;
    any = any || jump != 0.0;
    spread(&s, push * s.span.x, push * s.span.y, state->latest->force);
  }
  return any;
}

/* Impulse along the member times the mean of the speeds along it, before and after. */
static double work_of_jumps(const strut_model *model, const strut_state *state,
                            const double *change) {
  double work = 0.0;
  for (int32_t k = 0; k < model->sliding.moving_count; k++) {
    slide s = slide_at(model, state, k, state->q, state->v);
    double jump = s.at->jump, mean = s.at->rate - 0.5 * jump;
    strut_vec2 more = interpolate(&s, change);
    work += s.item->mass * mean *
            ((more.x + jump * s.span.x) * s.span.x + (more.y + jump * s.span.y) * s.span.y);
  }
  return work;
}

static bool kick_sliding_masses(const strut_model *model, strut_state *state, double from,
                                double to) {
  double *change = state->buffers->support_answer;
  if (!(model->terms & STRUT_TERM_SLIDING_MASS)) return false;
  strut_sliding_masses_place(model, state, to);
  if (!model->sliding.corners || !find_impulses(model, state, from, to)) return false;
  strut_mass_solve(model, state->latest->force, change, state->buffers->mass_solve);
  strut_sliding_masses_correct(model, state, change);
  double work = work_of_jumps(model, state, change);
  for (int32_t i = 0; i < model->length; i++) state->v[i] += change[i];
  if (!state->balance) return true;
  strut_power_add(state->work, STRUT_POWER_DRIVE, work);
  return true;
}

double strut_sliding_masses_moment(const strut_model *model, const strut_state *state, int axis,
                                   const double *q) {
  double sum = 0.0;
  for (int32_t k = 0; k < model->sliding.moving_count; k++) {
    const strut_sliding_item *item = &model->sliding.item[model->sliding.moving[k]];
    double span = q[item->at[1] + (uint32_t)axis] - q[item->at[0] + (uint32_t)axis];
    sum += item->mass * (state->latest->sliding[k].share - item->start) * span;
  }
  return sum;
}

double strut_sliding_masses_momentum(const strut_model *model, const strut_state *state, int axis,
                                     const double *q, const double *velocity) {
  double sum = strut_sliding_masses_moment(model, state, axis, velocity);
  for (int32_t k = 0; k < model->sliding.moving_count; k++) {
    const strut_sliding_item *item = &model->sliding.item[model->sliding.moving[k]];
    sum += item->mass * state->latest->sliding[k].rate *
           (q[item->at[1] + (uint32_t)axis] - q[item->at[0] + (uint32_t)axis]);
  }
  return sum;
}

/* Direction of the mass, and the first and second derivatives of its angle. */
typedef struct rotation {
  double cosine, sine, rate, acceleration;
} rotation;

static rotation rotate_by_signal(const strut_signal *signals, const strut_unbalance *unbalance,
                                 double t) {
  rotation r;
  double angle;
  strut_signal_evaluate(signals, unbalance->signal, t, &angle, &r.rate);
  strut_sincos_turns((unbalance->phase + angle) / STRUT_TAU, &r.sine, &r.cosine);
  r.acceleration = strut_signal_acceleration(signals, unbalance->signal, t);
  return r;
}

static rotation rotate(const strut_signal *signals, const strut_unbalance *unbalance, double t) {
  if (unbalance->signal >= 0) return rotate_by_signal(signals, unbalance, t);
  rotation r = {.rate = unbalance->speed};
  strut_sincos_turns(unbalance->phase / STRUT_TAU + unbalance->speed / STRUT_TAU * t, &r.sine,
                     &r.cosine);
  return r;
}

static void push(const strut_state *state, const strut_unbalance *unbalance, double fx, double fy,
                 const double *velocity) {
  int32_t at = 2 * unbalance->node;
  state->latest->force[at] += fx;
  state->latest->force[at + 1] += fy;
  if (!state->balance) return;
  double power = fx * velocity[at] + fy * velocity[at + 1];
  strut_power_add(state->latest->power, STRUT_POWER_DRIVE, power);
}

void strut_unbalance_apply(const strut_model *model, const strut_state *state, double t,
                           const double *velocity) {
  const strut_scene *scene = model->scene;
  for (size_t i = 0; i < scene->unbalance_count; i++) {
    const strut_unbalance *unbalance = &scene->unbalances[i];
    rotation r = rotate(scene->signals, unbalance, t + state->time_offset);
    double arm = unbalance->mass * unbalance->radius, square = r.rate * r.rate;
    push(state, unbalance, arm * (square * r.cosine + r.acceleration * r.sine),
         arm * (square * r.sine - r.acceleration * r.cosine), velocity);
  }
}

void strut_unbalance_apply_mean(const strut_model *model, const strut_state *state, double t,
                                double h, const double *velocity) {
  const strut_scene *scene = model->scene;
  for (size_t i = 0; i < scene->unbalance_count; i++) {
    const strut_unbalance *unbalance = &scene->unbalances[i];
    rotation a = rotate(scene->signals, unbalance, t + state->time_offset);
    rotation b = rotate(scene->signals, unbalance, t + h + state->time_offset);
    double arm = unbalance->mass * unbalance->radius / h;
    push(state, unbalance, arm * (b.rate * b.sine - a.rate * a.sine),
         -arm * (b.rate * b.cosine - a.rate * a.cosine), velocity);
  }
}

/* Adds to state->latest->force the impulses of one mass. True if there are any. */
static bool add_impulses(const strut_model *model, const strut_state *state,
                         const strut_unbalance *unbalance, double from, double to) {
  const strut_signal *signals = model->scene->signals;
  bool any = false;
  double at =
      unbalance->signal >= 0 ? strut_signal_next_break(signals, unbalance->signal, from) : HUGE_VAL;
  for (; at <= to; at = strut_signal_next_break(signals, unbalance->signal, at)) {
    double moment = 8.0 * DBL_EPSILON * fmax(fabs(at), to - from);
    rotation before = rotate(signals, unbalance, at - moment),
             after = rotate(signals, unbalance, at + moment);
    double jump = unbalance->mass * unbalance->radius * (after.rate - before.rate);
    state->latest->force[2 * unbalance->node] += jump * after.sine;
    state->latest->force[2 * unbalance->node + 1] -= jump * after.cosine;
    any = any || jump != 0.0;
  }
  return any;
}

static bool kick_unbalances(const strut_model *model, strut_state *state, double from, double to) {
  const strut_scene *scene = model->scene;
  bool any = false;
  if (!model->unbalance_corners) return false;
  memset(state->latest->force, 0, (size_t)model->length * sizeof *state->latest->force);
  for (size_t i = 0; i < scene->unbalance_count; i++)
    any = add_impulses(model, state, &scene->unbalances[i], from + state->time_offset,
                       to + state->time_offset) ||
          any;
  if (!any) return false;
  strut_impulse_apply(model, state, STRUT_POWER_DRIVE);
  return true;
}

void strut_support_motion_place(const strut_model *model, const strut_state *state, double t,
                                double *q, double *velocity) {
  const strut_support_motion_table *table = &model->support_motion;
  for (int32_t i = 0; i < table->count; i++) {
    const strut_moved_coordinate *coordinate = &table->item[i];
    double value;
    strut_signal_evaluate(model->scene->signals, coordinate->signal, t + state->time_offset, &value,
                          &velocity[coordinate->at]);
    q[coordinate->at] = coordinate->base + value;
  }
}

static void add_reaction_power(const strut_model *model, const strut_state *state, double power,
                               const double *velocity) {
  const strut_support_motion_table *table = &model->support_motion;
  for (int32_t i = 0; i < table->count; i++)
    power -= state->latest->force[table->item[i].at] * velocity[table->item[i].at];
  strut_power_add(state->latest->power, STRUT_POWER_SUPPORT, power);
}

void strut_support_motion_apply(const strut_model *model, const strut_state *state, double t,
                                const double *velocity) {
  const strut_support_motion_table *table = &model->support_motion;
  const strut_signal *signals = model->scene->signals;
  double power = 0.0, *acceleration = state->buffers->support_rates;
  for (int32_t i = 0; i < table->count && table->coupling_count; i++)
    acceleration[i] =
        strut_signal_acceleration(signals, table->item[i].signal, t + state->time_offset);
  for (int32_t k = 0; k < table->coupling_count; k++) {
    const strut_support_coupling *coupling = &table->coupling[k];
    double push = -coupling->mass * acceleration[coupling->item];
    state->latest->force[coupling->at] += push;
    power += push * velocity[coupling->at];
  }
  if (state->balance) add_reaction_power(model, state, power, velocity);
}

void strut_support_motion_apply_mean(const strut_model *model, const strut_state *state, double h,
                                     const double *before, const double *after, const double *u) {
  const strut_support_motion_table *table = &model->support_motion;
  double power = 0.0;
  for (int32_t k = 0; k < table->coupling_count; k++) {
    const strut_support_coupling *coupling = &table->coupling[k];
    double push = -coupling->mass * (after[coupling->item] - before[coupling->item]) / h;
    state->latest->force[coupling->at] += push;
    power += push * u[coupling->at];
  }
  if (state->balance) add_reaction_power(model, state, power, u);
}

/* Impulses of the jumps into state->latest->force. True if there are any. */
static bool find_reactions(const strut_model *model, const strut_state *state, double from,
                           double to) {
  const strut_support_motion_table *table = &model->support_motion;
  bool any = false;
  for (int32_t i = 0; i < table->count; i++) {
    state->buffers->support_rates[i] =
        jump_of_rate(model->scene->signals, table->item[i].signal, from + state->time_offset,
                     to + state->time_offset);
    any = any || state->buffers->support_rates[i] != 0.0;
  }
  if (!any) return false;
  memset(state->latest->force, 0, (size_t)model->length * sizeof *state->latest->force);
  for (int32_t k = 0; k < table->coupling_count; k++) {
    const strut_support_coupling *coupling = &table->coupling[k];
    state->latest->force[coupling->at] -=
        coupling->mass * state->buffers->support_rates[coupling->item];
  }
  return true;
}

bool strut_moving_kick(const strut_model *model, strut_state *state, double from, double to) {
  bool kicked = kick_sliding_masses(model, state, from, to);
  if (model->support_motion.corners && find_reactions(model, state, from, to)) {
    strut_impulse_apply(model, state, STRUT_POWER_SUPPORT);
    kicked = true;
  }
  return kick_unbalances(model, state, from, to) || kicked;
}

/* The part of the kinetic energy to which moved velocities contribute. */
static double moved_energy(const strut_model *model, const strut_state *state) {
  const strut_support_motion_table *table = &model->support_motion;
  double whole = strut_energy_kinetic(model, state->v);
  memcpy(state->buffers->support_answer, state->v, (size_t)model->length * sizeof *state->v);
  for (int32_t i = 0; i < table->count; i++)
    state->buffers->support_answer[table->item[i].at] = 0.0;
  double rest = strut_energy_kinetic(model, state->buffers->support_answer);
  memset(state->buffers->support_answer, 0, (size_t)model->length * sizeof *state->v);
  return whole - rest;
}

double strut_support_motion_work(const strut_model *model, const strut_state *state) {
  if (!(model->terms & STRUT_TERM_SUPPORT_MOTION)) return 0.0;
  return state->work[STRUT_POWER_SUPPORT] + moved_energy(model, state) - state->support_work_origin;
}

void strut_support_motion_reset_work(const strut_model *model, strut_state *state) {
  if (model->terms & STRUT_TERM_SUPPORT_MOTION)
    state->support_work_origin = moved_energy(model, state) + state->work[STRUT_POWER_SUPPORT];
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: the forces of STRUT_LANE_WIDTH models at once, a vector register of lanes for each number.
 *
 * The order of operations is that of members_kernel.h, ground_kernel.h and mass_kernel.h lane by
 * lane, so that each lane has the bits of a single run. What is a branch there is a choice here. A file
 * includes this once, and before that may define STRUT_LANE_WIDTH and the functions' STRUT_LANE_TARGET.
 */
#ifndef STRUT_ENGINE_FORCES_LANE_KERNEL_H
#define STRUT_ENGINE_FORCES_LANE_KERNEL_H

#include <math.h>

#include "engine/base/trig.h"
#include "engine/forces/lane_tables.h"
#include "engine/model/hot.h"

#ifndef STRUT_LANE_WIDTH
#define STRUT_LANE_WIDTH 2
#endif
#ifndef STRUT_LANE_TARGET
#define STRUT_LANE_TARGET
#endif
#define STRUT_LANE_INLINE static inline __attribute__((always_inline)) STRUT_LANE_TARGET

enum { LANE_WIDTH = STRUT_LANE_WIDTH };

/* One number of each lane; arrays of them are aligned to whole vectors. */
typedef double lane_real __attribute__((vector_size(8 * STRUT_LANE_WIDTH)));
typedef long long lane_mask __attribute__((vector_size(8 * STRUT_LANE_WIDTH)));

STRUT_LANE_INLINE lane_real lane_load(const double *p) { return *(const lane_real *)p; }
STRUT_LANE_INLINE void lane_store(double *p, lane_real x) { *(lane_real *)p = x; }
/* Row i of a table. */
STRUT_LANE_INLINE lane_real lane_row(const double *table, size_t i) {
  return lane_load(table + i * LANE_WIDTH);
}
STRUT_LANE_INLINE void lane_put(double *table, size_t i, lane_real x) {
  lane_store(table + i * LANE_WIDTH, x);
}

/* mask ? x : y */
STRUT_LANE_INLINE lane_real lane_choose(lane_mask mask, lane_real x, lane_real y) {
  return (lane_real)((mask & (lane_mask)x) | (~mask & (lane_mask)y));
}
STRUT_LANE_INLINE lane_real lane_magnitude(lane_real x) {
  return (lane_real)((lane_mask)x & 0x7fffffffffffffffLL);
}
STRUT_LANE_INLINE lane_real lane_sign(lane_real x) {
  lane_real zero = {0}, one = zero + 1.0;
  return lane_choose(x > zero, one, lane_choose(x < zero, -one, zero));
}
STRUT_LANE_INLINE bool lane_any(lane_mask mask) {
  long long any = 0;
  for (int l = 0; l < LANE_WIDTH; l++) any |= mask[l];
  return any != 0;
}
STRUT_LANE_INLINE lane_real lane_root(lane_real x) {
  lane_real root;
  for (int l = 0; l < LANE_WIDTH; l++) root[l] = sqrt(x[l]);
  return root;
}

/* Signals */

STRUT_DEFINE_TRIG(STRUT_LANE_INLINE, lane_real, lane_sine_of_small, lane_cosine_of_small)

/* See strut_sincos_turns; the quarter turns are read from the last bits of the rounded number. */
STRUT_LANE_INLINE void lane_sincos(lane_real turns, lane_real *sine, lane_real *cosine) {
  const double rounder = 6755399441055744.0;
  lane_mask far = ~((turns > -0x1p49) & (turns < 0x1p49));
  if (lane_any(far))
    for (int l = 0; l < LANE_WIDTH; l++)
      if (far[l]) turns[l] -= floor(turns[l]);
  lane_real rounded = 4.0 * turns + rounder, quarter = rounded - rounder;
  lane_real x = 6.283185307179586476925 * (turns - 0.25 * quarter);
  lane_real s = lane_sine_of_small(x), c = lane_cosine_of_small(x);
  lane_mask quadrant = (lane_mask)rounded, odd = -(quadrant & 1);
  lane_real first = lane_choose(odd, c, s), second = lane_choose(odd, s, c);
  *sine = lane_choose(-((quadrant >> 1) & 1), -first, first);
  *cosine = lane_choose(-(((quadrant + 1) >> 1) & 1), -second, second);
}

/* Value and rate of the signal of drive or load i at the lanes' times. */
STRUT_LANE_INLINE void lane_signal(const strut_lane_tables *t, bool load, int32_t i, lane_real time,
                                   lane_real *value, lane_real *rate) {
  size_t at = (size_t)(load ? t->first->drives.count + i : i);
  const double *wave = t->wave + at * STRUT_LANE_WAVE_ROWS * LANE_WIDTH;
  lane_real zero = {0}, sine, cosine;
  if (!t->all_waves[at]) {
    *value = *rate = zero;
    for (int l = 0; l < LANE_WIDTH; l++) {
      const strut_model *m = t->model[l];
      double one, its_rate;
      strut_signal_evaluate(m->scene->signals, load ? m->loads.signal[i] : m->drives.signal[i],
                            time[l], &one, &its_rate);
      (*value)[l] = one, (*rate)[l] = its_rate;
    }
    return;
  }
  lane_real start = lane_row(wave, STRUT_LANE_START);
  lane_real turns =
      lane_row(wave, STRUT_LANE_FREQUENCY) * (time - start) + lane_row(wave, STRUT_LANE_PHASE);
  lane_mask on = (time >= start) & (time < lane_row(wave, STRUT_LANE_STOP)) &
                 (turns < lane_row(wave, STRUT_LANE_MOST_TURNS));
  lane_sincos(turns, &sine, &cosine);
  *value = lane_choose(on, lane_row(wave, STRUT_LANE_AMPLITUDE) * sine, zero);
  *rate = lane_choose(on, lane_row(wave, STRUT_LANE_RATE) * cosine, zero);
}

/* All that depends on time alone, at the lanes' times [s]. */
STRUT_LANE_INLINE void lane_drive(strut_lane_tables *t, lane_real time) {
  const strut_drive_table *d = &t->first->drives;
  lane_real value, rate;
  for (int32_t i = 0; i < d->count; i++) {
    size_t j = (size_t)d->member[i];
    lane_signal(t, false, i, time, &value, &rate);
    lane_put(t->rest, j, lane_row(d->first[i] ? t->rest0 : t->rest, j) + value);
    lane_put(t->rest_rate, j, d->first[i] ? rate : lane_row(t->rest_rate, j) + rate);
  }
  for (int32_t i = 0; i < t->first->loads.count; i++) {
    lane_signal(t, true, i, time, &value, &rate);
    lane_put(t->load_factor, (size_t)i, value);
  }
}

STRUT_LANE_INLINE void lane_loads(strut_lane_tables *t, const double *restrict v, bool ledger) {
  const strut_load_table *loads = &t->first->loads;
  for (int32_t i = 0; i < loads->count; i++) {
    size_t k = (size_t)i, at = 2 * (size_t)loads->node[i];
    lane_real factor = lane_row(t->load_factor, k);
    lane_real px = factor * lane_row(t->load_x, k), py = factor * lane_row(t->load_y, k);
    lane_put(t->force, at, lane_row(t->force, at) + px);
    lane_put(t->force, at + 1, lane_row(t->force, at + 1) + py);
    if (!ledger) continue;
    lane_real power = px * lane_row(v, at) + py * lane_row(v, at + 1);
    lane_put(t->power, STRUT_POWER_LOAD, lane_row(t->power, STRUT_POWER_LOAD) + power);
    lane_put(t->power, STRUT_POWER_MOVED,
             lane_row(t->power, STRUT_POWER_MOVED) + lane_magnitude(power));
  }
}

/* Members */

/* Powers of a place within groups of STRUT_LANES members. */
typedef struct lane_powers {
  lane_real drive, moved, lost;
} lane_powers;

/* See members_tension. */
STRUT_LANE_INLINE lane_real lane_tension(const strut_lane_tables *t, size_t j, unsigned terms,
                                         bool ledger, lane_real length, lane_real rate,
                                         lane_powers *powers) {
  bool driven = terms & STRUT_TERM_DRIVE;
  lane_real stretch = length - lane_row(t->rest, j), zero = {0};
  lane_real elastic = lane_row(t->stiffness, j) * stretch, tension = elastic;
  lane_real own_rate = driven ? rate - lane_row(t->rest_rate, j) : rate;
  if (terms & STRUT_TERM_DAMPING) tension = elastic + lane_row(t->damping, j) * own_rate;
  if (terms & STRUT_TERM_SLACK) {
    lane_mask taut = stretch > lane_row(t->taut_stretch, j);
    lane_mask pulling = taut & (tension > lane_row(t->taut_tension, j));
    tension = lane_choose(pulling, tension, zero);
    if (ledger) elastic = lane_choose(taut, elastic, zero);
  }
  if (ledger && driven) {
    lane_real power = -tension * lane_row(t->rest_rate, j);
    powers->drive += power;
    powers->moved += lane_magnitude(power);
  }
  if (ledger && (terms & STRUT_TERM_DAMPING)) powers->lost += (tension - elastic) * own_rate;
  return tension;
}

/* Roots and quotients take long and wait for nothing: they are begun so many members ahead. */
enum { LANE_AHEAD = 2 };

/* Vector from the first to the second node, length, and its inverse or 0. */
typedef struct lane_span {
  lane_real x, y, length, inverse;
} lane_span;

STRUT_LANE_INLINE void lane_measure(const strut_member_table *m, const double *restrict q, size_t j,
                                    lane_span *d) {
  size_t a = m->from[j], b = m->to[j];
  lane_real zero = {0};
  d->x = lane_row(q, b) - lane_row(q, a), d->y = lane_row(q, b + 1) - lane_row(q, a + 1);
  d->length = lane_root(d->x * d->x + d->y * d->y);
  d->inverse = lane_choose(d->length > zero, 1.0 / d->length, zero);
}

STRUT_LANE_INLINE void lane_pull(const strut_lane_tables *t, const strut_member_table *m,
                                 const lane_span *d, const double *restrict v,
                                 double *restrict force, size_t j, unsigned terms, bool ledger,
                                 lane_powers *powers) {
  size_t a = m->from[j], b = m->to[j];
  lane_real rate = {0};
  if ((terms & STRUT_TERM_DAMPING) || (ledger && (terms & STRUT_TERM_DRIVE))) {
    lane_real wx = lane_row(v, b) - lane_row(v, a), wy = lane_row(v, b + 1) - lane_row(v, a + 1);
    rate = (wx * d->x + wy * d->y) * d->inverse;
  }
  lane_real tension = lane_tension(t, j, terms, ledger, d->length, rate, powers);
  lane_real density = tension * d->inverse, px = density * d->x, py = density * d->y;
  lane_put(force, a, lane_row(force, a) + px);
  lane_put(force, a + 1, lane_row(force, a + 1) + py);
  lane_put(force, b, lane_row(force, b) - px);
  lane_put(force, b + 1, lane_row(force, b + 1) - py);
}

STRUT_LANE_INLINE void lane_block(const strut_lane_tables *t, const double *restrict q,
                                  const double *restrict v, double *restrict force, int32_t begin,
                                  int32_t end, unsigned terms, bool ledger, lane_powers *powers) {
  const strut_member_table m = t->first->members;
  lane_span spans[LANE_AHEAD];
  for (int32_t j = begin; j < end && j < begin + LANE_AHEAD; j++)
    lane_measure(&m, q, (size_t)j, &spans[j % LANE_AHEAD]);
  for (int32_t j = begin; j < end; j++) {
    lane_span *d = &spans[j % LANE_AHEAD];
    lane_pull(t, &m, d, v, force, (size_t)j, terms, ledger, &powers[ledger ? j % STRUT_LANES : 0]);
    if (j + LANE_AHEAD < end) lane_measure(&m, q, (size_t)(j + LANE_AHEAD), d);
  }
}

/* Slots of padding pull with no force, and no one asks for the place where they do. */
STRUT_LANE_INLINE void lane_members(strut_lane_tables *t, const double *restrict q,
                                    const double *restrict v, bool ledger) {
  enum { K = STRUT_TERM_DAMPING, S = STRUT_TERM_SLACK, D = STRUT_TERM_DRIVE };
  const strut_member_table *m = &t->first->members;
  lane_powers powers[STRUT_LANES];
  lane_real none = {0};
  for (int l = 0; l < STRUT_LANES && ledger; l++) powers[l] = (lane_powers){none, none, none};
  for (int32_t b = 0; b < m->blocks; b++) {
    int32_t begin = b * STRUT_BLOCK,
            end = begin + STRUT_BLOCK < m->count ? begin + STRUT_BLOCK : m->count;
#define STRUT_CASE(set)                                                                            \
  case set:                                                                                        \
    lane_block(t, q, v, t->force, begin, end, set, ledger, powers);                                \
    break
    switch (m->block_terms[b] & (K | S | D)) {
      STRUT_CASE(0);
      STRUT_CASE(K);
      STRUT_CASE(S);
      STRUT_CASE(K | S);
      STRUT_CASE(D);
      STRUT_CASE(D | K);
      STRUT_CASE(D | S);
      STRUT_CASE(D | K | S);
    }
#undef STRUT_CASE
  }
  if (!ledger) return;
  lane_real drive = {0}, lost = {0}, zero = {0}, moved = lane_row(t->power, STRUT_POWER_MOVED);
  for (int l = 0; l < STRUT_LANES; l++) {
    drive += powers[l].drive;
    lost += powers[l].lost;
    moved += powers[l].moved + powers[l].lost;
  }
  lane_put(t->power, STRUT_POWER_DRIVE, drive);
  lane_put(t->power, STRUT_POWER_BELT, zero);
  lane_put(t->power, STRUT_POWER_MEMBERS, lost);
  lane_put(t->power, STRUT_POWER_CONTACT, zero);
  lane_put(t->power, STRUT_POWER_FRICTION, zero);
  lane_put(t->power, STRUT_POWER_MOVED, moved);
}

/* Ground */

/* See strut_friction_force. */
STRUT_LANE_INLINE lane_real lane_friction(const double *entry, lane_real normal, lane_real slip,
                                          lane_real applied) {
  lane_mask slides = lane_magnitude(slip) >= lane_row(entry, STRUT_LANE_STICK);
  lane_mask pushed = lane_magnitude(applied) >= lane_row(entry, STRUT_LANE_MU_STATIC) * normal;
  lane_real most = -lane_row(entry, STRUT_LANE_MU_KINETIC) * normal;
  return lane_choose(slides | pushed, most * lane_sign(lane_choose(slides, slip, applied)),
                     -applied);
}

STRUT_LANE_INLINE void lane_add(double *table, size_t i, lane_mask where, lane_real x) {
  lane_real before = lane_row(table, i);
  lane_put(table, i, lane_choose(where, before + x, before));
}

/* See ground_touch; where: the lanes in which it does. */
STRUT_LANE_INLINE void lane_touch(strut_lane_tables *t, const double *restrict v, size_t at,
                                  const double *entry, lane_mask where, lane_real gap, bool sloped,
                                  bool rough, bool ledger) {
  const double *g = t->ground;
  lane_real tx = lane_row(g, STRUT_LANE_TANGENT_X), ty = lane_row(g, STRUT_LANE_TANGENT_Y);
  lane_real nx = lane_row(g, STRUT_LANE_NORMAL_X), ny = lane_row(g, STRUT_LANE_NORMAL_Y);
  lane_real vx = lane_row(v, at), vy = lane_row(v, at + 1), zero = {0}, friction = zero;
  lane_real fx = lane_row(t->force, at), fy = lane_row(t->force, at + 1);
  lane_real into = sloped ? vx * nx + vy * ny : vy, along = sloped ? vx * tx + vy * ty : vx;
  lane_real belt_speed = lane_row(g, STRUT_LANE_BELT), slip = along - belt_speed;
  lane_real damper = lane_choose(into < zero, -lane_row(entry, STRUT_LANE_DAMPING) * into, zero);
  lane_real normal = -lane_row(entry, STRUT_LANE_STIFFNESS) * gap + damper;
  if (rough) friction = lane_friction(entry, normal, slip, sloped ? fx * tx + fy * ty : fx);
  lane_add(t->force, at, where, sloped ? friction * tx + normal * nx : friction);
  lane_add(t->force, at + 1, where, sloped ? friction * ty + normal * ny : normal);
  if (!ledger) return;
  lane_real damped = -damper * into, rubbed = -friction * slip, belt = friction * belt_speed;
  lane_add(t->power, STRUT_POWER_CONTACT, where, damped);
  lane_add(t->power, STRUT_POWER_FRICTION, where, rubbed);
  lane_add(t->power, STRUT_POWER_BELT, where, belt);
  lane_add(t->power, STRUT_POWER_MOVED, where,
           damped + lane_magnitude(rubbed) + lane_magnitude(belt));
}

STRUT_LANE_INLINE void lane_ground(strut_lane_tables *t, const double *restrict q,
                                   const double *restrict v, bool sloped, bool rough, bool ledger) {
  const strut_contact_table *c = &t->first->contacts;
  lane_real height = lane_row(t->ground, STRUT_LANE_HEIGHT), zero = {0};
  for (int32_t i = 0; i < c->count; i++) {
    size_t at = c->at[i];
    lane_real gap = lane_row(q, at + 1) - height;
    if (sloped)
      gap = lane_row(q, at) * lane_row(t->ground, STRUT_LANE_NORMAL_X) +
            gap * lane_row(t->ground, STRUT_LANE_NORMAL_Y);
    lane_mask touches = gap < zero;
    if (lane_any(touches))
      lane_touch(t, v, at, t->contact + i * STRUT_LANE_CONTACT_ROWS * LANE_WIDTH, touches, gap,
                 sloped, rough, ledger);
  }
}

/* All forces at positions q and velocities v, with rest lengths and loads as lane_drive left them. */
STRUT_LANE_INLINE void lane_forces(strut_lane_tables *t, const double *restrict q,
                                   const double *restrict v, bool ledger) {
  const strut_model *m = t->first;
  lane_real zero = {0};
  for (size_t p = 0; p < STRUT_POWER_COUNT && ledger; p++) lane_put(t->power, p, zero);
  for (size_t i = 0; i < 2 * (size_t)m->node_count; i++)
    lane_put(t->force, i, (m->plan & STRUT_TERM_CONSTANT) ? lane_row(t->constant, i) : zero);
  if (m->plan & STRUT_TERM_LOADS) lane_loads(t, v, ledger);
  if (m->plan & STRUT_TERM_MEMBERS) lane_members(t, q, v, ledger);
  if (!(m->plan & STRUT_TERM_CONTACT)) return;
  if (m->plan & STRUT_TERM_SLOPE)
    lane_ground(t, q, v, true, m->plan & STRUT_TERM_FRICTION, ledger);
  else if (m->plan & STRUT_TERM_FRICTION)
    lane_ground(t, q, v, false, true, ledger);
  else
    lane_ground(t, q, v, false, false, ledger);
}

/* Masses */

/* One coordinate of a dense block of n nodes; f and a are those of that coordinate of node 0. */
STRUT_LANE_INLINE void lane_mass_block(int32_t n, const double *restrict inverse,
                                       const uint32_t *restrict at, const double *restrict f,
                                       double *restrict a) {
  for (int32_t i = 0; i < n; i++) {
    lane_real sum = lane_row(inverse, (size_t)(i * n)) * lane_row(f, at[0]);
    for (int32_t j = 1; j < n; j++)
      sum += lane_row(inverse, (size_t)(i * n + j)) * lane_row(f, at[j]);
    lane_put(a, at[i], sum);
  }
}

/* a = M^-1 f; see mass_kernel. */
STRUT_LANE_INLINE void lane_mass(const strut_lane_tables *t, double *restrict a) {
  const strut_mass *mass = t->first->mass;
  const double *restrict f = t->force;
  for (size_t i = 0; i < 2 * (size_t)t->first->node_count && mass->any_single; i++)
    lane_put(a, i, lane_row(f, i) * lane_row(t->inverse, i));
  if (mass->diagonal) return;
  for (size_t c = 0; c < 2; c++) {
    const strut_mass_operator *op = &mass->coordinate[c];
    const uint32_t *restrict at = op->block_at;
    const double *restrict inverse = t->block_inverse[c];
    for (int32_t b = 0; b < op->block_count; b++) {
      int32_t n = op->block_size[b];
      const double *from = f + c * LANE_WIDTH;
      double *to = a + c * LANE_WIDTH;
      if (n == 2)
        lane_mass_block(2, inverse, at, from, to);
      else if (n == 3)
        lane_mass_block(3, inverse, at, from, to);
      else
        lane_mass_block(n, inverse, at, from, to);
      at += n;
      inverse += (size_t)(n * n) * LANE_WIDTH;
    }
  }
}

#endif

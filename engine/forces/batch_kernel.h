/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: the forces of STRUT_BATCH_WIDTH models at once; see batch_vector.h.
 *
 * The order of operations is that of members_kernel.h, ground_kernel.h and mass_kernel.h lane by
 * lane, so that each lane has the bits of a single run. What is a branch there is a choice here.
 */
#ifndef STRUT_ENGINE_FORCES_BATCH_KERNEL_H
#define STRUT_ENGINE_FORCES_BATCH_KERNEL_H

#include "engine/forces/batch_balance.h"
#include "engine/forces/batch_elements.h"
#include "engine/forces/batch_vector.h"

/* Signals */

STRUT_DEFINE_TRIG(STRUT_BATCH_INLINE, batch_real, batch_sine_of_small, batch_cosine_of_small)

/* See strut_sincos_turns; the quarter turns are read from the last bits of the rounded number. */
STRUT_BATCH_INLINE void batch_sincos(batch_real turns, batch_real *sine, batch_real *cosine) {
  const double rounder = 6755399441055744.0;
  batch_mask far = ~((turns > -0x1p49) & (turns < 0x1p49));
  if (batch_some(far))
    for (int l = 0; l < BATCH_WIDTH; l++)
      if (far[l]) turns[l] -= floor(turns[l]);
  batch_real rounded = 4.0 * turns + rounder, quarter = rounded - rounder;
  batch_real x = STRUT_TAU * (turns - 0.25 * quarter);
  batch_real s = batch_sine_of_small(x), c = batch_cosine_of_small(x);
  batch_mask quadrant = (batch_mask)rounded, odd = -(quadrant & 1);
  batch_real first = batch_choose(odd, c, s), second = batch_choose(odd, s, c);
  *sine = batch_choose(-((quadrant >> 1) & 1), -first, first);
  *cosine = batch_choose(-(((quadrant + 1) >> 1) & 1), -second, second);
}

/* Value and rate of the signal of drive or load i at the times of a part's lanes. */
STRUT_BATCH_INLINE void batch_signal(const strut_batch_tables *t, bool load, int32_t i, int p,
                                     batch_real time, batch_real *value, batch_real *rate) {
  size_t at = (size_t)(load ? t->first->drives.count + i : i);
  const double *wave = t->signals.wave + at * STRUT_BATCH_WAVE_ROWS * BATCH_ROW;
  batch_real zero = {0}, sine, cosine;
  if (!t->signals.all_waves[at]) {
    *value = *rate = zero;
    for (int l = 0; l < BATCH_WIDTH; l++) {
      const strut_model *m = t->model[p * BATCH_WIDTH + l];
      double one, its_rate;
      strut_signal_evaluate(m->scene->signals, load ? m->loads.signal[i] : m->drives.signal[i],
                            time[l], &one, &its_rate);
      (*value)[l] = one, (*rate)[l] = its_rate;
    }
    return;
  }
  batch_real start = batch_row(wave, STRUT_BATCH_START, p);
  batch_real turns = batch_row(wave, STRUT_BATCH_FREQUENCY, p) * (time - start) +
                     batch_row(wave, STRUT_BATCH_PHASE, p);
  batch_mask on = (time >= start) & (time < batch_row(wave, STRUT_BATCH_STOP, p)) &
                  (turns < batch_row(wave, STRUT_BATCH_MOST_TURNS, p));
  batch_sincos(turns, &sine, &cosine);
  *value = batch_choose(on, batch_row(wave, STRUT_BATCH_AMPLITUDE, p) * sine, zero);
  *rate = batch_choose(on, batch_row(wave, STRUT_BATCH_RATE, p) * cosine, zero);
}

STRUT_BATCH_INLINE void batch_drive_part(strut_batch_tables *t, int p, batch_real time) {
  const strut_drive_table *d = &t->first->drives;
  batch_real value, rate;
  for (int32_t i = 0; i < d->count; i++) {
    size_t j = (size_t)d->member[i];
    batch_signal(t, false, i, p, time, &value, &rate);
    batch_put(t->members.rest, j, p,
              batch_row(d->first[i] ? t->members.rest0 : t->members.rest, j, p) + value);
    batch_put(t->members.rest_rate, j, p,
              d->first[i] ? rate : batch_row(t->members.rest_rate, j, p) + rate);
  }
  for (int32_t i = 0; i < t->first->loads.count; i++) {
    batch_signal(t, true, i, p, time, &value, &rate);
    batch_put(t->signals.load_factor, (size_t)i, p, value);
  }
}

/* All that depends on time alone, at the times (step + ahead) dt [s]. */
STRUT_BATCH_INLINE void batch_drive(strut_batch_tables *t, const batch_real *step, double ahead,
                                    const batch_real *dt) {
  BATCH_EACH(batch_drive_part(t, p, (step[p] + ahead) * dt[p]));
}

STRUT_BATCH_INLINE void batch_loads(strut_batch_tables *t, int p, const double *restrict v,
                                    bool balance) {
  const strut_load_table *loads = &t->first->loads;
  for (int32_t i = 0; i < loads->count; i++) {
    size_t k = (size_t)i, at = 2 * (size_t)loads->node[i];
    batch_real factor = batch_row(t->signals.load_factor, k, p);
    batch_real px = factor * batch_row(t->signals.load_x, k, p),
               py = factor * batch_row(t->signals.load_y, k, p);
    batch_put(t->force, at, p, batch_row(t->force, at, p) + px);
    batch_put(t->force, at + 1, p, batch_row(t->force, at + 1, p) + py);
    if (!balance) continue;
    batch_real power = px * batch_row(v, at, p) + py * batch_row(v, at + 1, p);
    batch_put(t->power, STRUT_POWER_LOAD, p, batch_row(t->power, STRUT_POWER_LOAD, p) + power);
    batch_put(t->power, STRUT_POWER_EXCHANGED, p,
              batch_row(t->power, STRUT_POWER_EXCHANGED, p) + batch_magnitude(power));
  }
}

/* Members */

/* What the law asks of member j; `rate`: of its length [m/s]. */
STRUT_BATCH_INLINE batch_member_values batch_values_of(const strut_batch_tables *t, size_t j, int p,
                                                       batch_real length, batch_real rate) {
  return (batch_member_values){
      .length = length,
      .rate = rate,
      .rest = batch_row(t->members.rest, j, p),
      .rest_rate = batch_row(t->members.rest_rate, j, p),
      .stiffness = batch_row(t->members.stiffness, j, p),
      .damping = batch_row(t->members.damping, j, p),
      .slack_length_threshold = batch_row(t->members.slack_length_threshold, j, p),
      .slack_force_threshold = batch_row(t->members.slack_force_threshold, j, p)};
}

/* Vector from the first to the second node, length, and its inverse or 0. */
typedef struct batch_span {
  batch_real x, y, length, inverse;
} batch_span;

STRUT_BATCH_INLINE void batch_measure(const strut_member_table *m, const double *restrict q,
                                      size_t j, int p, batch_span *d) {
  size_t a = m->from[j], b = m->to[j];
  batch_real zero = {0};
  d->x = batch_row(q, b, p) - batch_row(q, a, p),
  d->y = batch_row(q, b + 1, p) - batch_row(q, a + 1, p);
  d->length = batch_root(d->x * d->x + d->y * d->y);
  d->inverse = batch_choose(d->length > zero, 1.0 / d->length, zero);
}

STRUT_BATCH_INLINE void batch_pull(const strut_batch_tables *t, const strut_member_table *m,
                                   const batch_span *d, const double *restrict v,
                                   double *restrict force, size_t j, int p, unsigned terms,
                                   bool balance, batch_member_powers *powers) {
  size_t a = m->from[j], b = m->to[j];
  batch_real rate = {0};
  if ((terms & STRUT_TERM_DAMPING) || (balance && (terms & STRUT_TERM_DRIVE))) {
    batch_real wx = batch_row(v, b, p) - batch_row(v, a, p),
               wy = batch_row(v, b + 1, p) - batch_row(v, a + 1, p);
    rate = (wx * d->x + wy * d->y) * d->inverse;
  }
  batch_member_values values = batch_values_of(t, j, p, d->length, rate);
  bool damped = terms & STRUT_TERM_DAMPING, slack = terms & STRUT_TERM_SLACK;
  bool driven = terms & STRUT_TERM_DRIVE;
  batch_real damper,
      tension = batch_member_tension(&values, damped, slack, driven, balance, &damper);
  if (balance) batch_member_add_powers(&values, damped, driven, tension, damper, powers);
  batch_real density = tension * d->inverse, px = density * d->x, py = density * d->y;
  batch_put(force, a, p, batch_row(force, a, p) + px);
  batch_put(force, a + 1, p, batch_row(force, a + 1, p) + py);
  batch_put(force, b, p, batch_row(force, b, p) - px);
  batch_put(force, b + 1, p, batch_row(force, b + 1, p) - py);
}

STRUT_BATCH_INLINE void batch_block(const strut_batch_tables *t, const double *restrict q,
                                    const double *restrict v, double *restrict force, int32_t begin,
                                    int32_t end, unsigned terms, bool balance,
                                    batch_member_powers (*powers)[BATCH_PARTS]) {
  const strut_member_table m = t->first->members;
  for (int32_t j = begin; j < end; j++) {
    batch_span d[BATCH_PARTS];
    batch_member_powers *sums = powers[balance ? j % STRUT_LANES : 0];
    BATCH_EACH(batch_measure(&m, q, (size_t)j, p, d + p));
    BATCH_EACH(batch_pull(t, &m, d + p, v, force, (size_t)j, p, terms, balance, sums + p));
  }
}

/* The members' powers, place by place within groups as a single run sums them. */
STRUT_BATCH_INLINE void batch_sum_powers(strut_batch_tables *t, int p,
                                         batch_member_powers (*powers)[BATCH_PARTS]) {
  batch_real drive = {0}, lost = {0}, zero = {0},
             exchanged = batch_row(t->power, STRUT_POWER_EXCHANGED, p);
  for (int l = 0; l < STRUT_LANES; l++) {
    drive += powers[l][p].drive;
    lost += powers[l][p].lost;
    exchanged += powers[l][p].exchanged + powers[l][p].lost;
  }
  batch_put(t->power, STRUT_POWER_DRIVE, p, drive);
  batch_put(t->power, STRUT_POWER_BELT, p, zero);
  batch_put(t->power, STRUT_POWER_MEMBERS, p, lost);
  batch_put(t->power, STRUT_POWER_CONTACT, p, zero);
  batch_put(t->power, STRUT_POWER_FRICTION, p, zero);
  batch_put(t->power, STRUT_POWER_EXCHANGED, p, exchanged);
}

/*
 * Slots of padding pull with no force, and no one asks for the place where they do. sums: where powers are
 * accumulated; NULL: in t->power.
 */
STRUT_BATCH_INLINE void batch_members(strut_batch_tables *t, const double *restrict q,
                                      const double *restrict v, bool balance,
                                      const batch_sums *sums) {
  enum { K = STRUT_TERM_DAMPING, S = STRUT_TERM_SLACK, D = STRUT_TERM_DRIVE };
  const strut_member_table *m = &t->first->members;
  batch_member_powers own[STRUT_LANES][BATCH_PARTS],
      (*powers)[BATCH_PARTS] = sums ? sums->member : own;
  if (balance) batch_clear_members(powers);
  for (int32_t b = 0; b < m->blocks; b++) {
    int32_t begin = b * STRUT_BLOCK,
            end = begin + STRUT_BLOCK < m->count ? begin + STRUT_BLOCK : m->count;
#define STRUT_CASE(set)                                                                            \
  case set: batch_block(t, q, v, t->force, begin, end, set, balance, powers); break
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
  if (balance && !sums) BATCH_EACH(batch_sum_powers(t, p, powers));
}

/* Ground */

/* The numbers of a contact's laws in the runs of part p. */
STRUT_BATCH_INLINE batch_ground_numbers batch_ground_at(const double *entry, int p) {
  return (batch_ground_numbers){batch_row(entry, STRUT_BATCH_MINUS_STIFFNESS, p),
                                batch_row(entry, STRUT_BATCH_MINUS_DAMPING, p),
                                batch_row(entry, STRUT_BATCH_DISSIPATION, p)};
}
STRUT_BATCH_INLINE batch_friction_numbers batch_friction_at(const double *entry, int p) {
  return (batch_friction_numbers){
#define STRUT_FRICTION_ROW(NAME, field, range)                                                     \
  .field = batch_row(entry, STRUT_BATCH_FRICTION_##NAME, p),
      STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
          .mu_static_backward = batch_row(entry, STRUT_BATCH_FRICTION_MU_STATIC_BACKWARD, p),
      .mu_kinetic_backward = batch_row(entry, STRUT_BATCH_FRICTION_MU_KINETIC_BACKWARD, p)};
}
STRUT_BATCH_INLINE batch_friction_choice batch_choice_at(const double *entry, int p) {
  batch_real law = batch_row(entry, STRUT_BATCH_FRICTION_LAW, p);
  return (batch_friction_choice){
#define STRUT_FRICTION_ROW(NAME, name, ...) .name = law == batch_all(STRUT_FRICTION_##NAME),
      STRUT_FRICTION_LAWS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
  };
}

STRUT_BATCH_INLINE void batch_add(double *table, size_t i, int p, batch_mask where, batch_real x) {
  batch_real before = batch_row(table, i, p);
  batch_put(table, i, p, batch_choose(where, before + x, before));
}

/* Whether the ground is inclined, rough, has other laws than (8) and (9), and moves. */
typedef struct batch_ground_terms {
  bool sloped, rough, laws, moves;
} batch_ground_terms;

/* See ground_touch; where: the lanes in which it does. */
STRUT_BATCH_INLINE void batch_touch(strut_batch_tables *t, const double *restrict v, size_t at,
                                    const double *entry, int p, batch_mask where, batch_real gap,
                                    batch_ground_terms has, batch_contact_sums *sums) {
  bool sloped = has.sloped, rough = has.rough, laws = has.laws;
  const double *g = t->ground.line;
  batch_real tx = batch_row(g, STRUT_BATCH_TANGENT_X, p),
             ty = batch_row(g, STRUT_BATCH_TANGENT_Y, p);
  batch_real nx = batch_row(g, STRUT_BATCH_NORMAL_X, p), ny = batch_row(g, STRUT_BATCH_NORMAL_Y, p);
  batch_real vx = batch_row(v, at, p), vy = batch_row(v, at + 1, p), zero = {0}, friction = zero;
  batch_real fx = batch_row(t->force, at, p), fy = batch_row(t->force, at + 1, p);
  batch_real into = sloped ? vx * nx + vy * ny : vy, along = sloped ? vx * tx + vy * ty : vx;
  batch_real belt_speed = batch_row(g, STRUT_BATCH_BELT, p), slip = along - belt_speed;
  const batch_ground_numbers ground = batch_ground_at(entry, p);
  const batch_friction_numbers rubs = batch_friction_at(entry, p);
  batch_real spring = batch_ground_spring(&ground, gap);
  batch_real damper = batch_ground_damper(&ground, spring, into, laws), normal = spring + damper;
  if (rough) {
    batch_real applied = sloped ? fx * tx + fy * ty : fx;
    const batch_friction_choice which = batch_choice_at(entry, p);
    friction = laws ? batch_friction(&rubs, &which, normal, slip, applied)
                    : batch_friction_karnopp(&rubs, normal, slip, applied);
  }
  batch_add(t->force, at, p, where, sloped ? friction * tx + normal * nx : friction);
  batch_add(t->force, at + 1, p, where, sloped ? friction * ty + normal * ny : normal);
  if (!sums) return;
  batch_contact_powers powers = batch_contact_power(damper, into, friction, slip, belt_speed);
  if (has.moves)
    batch_accumulate_belt(sums, where, belt_speed != zero, powers);
  else
    batch_accumulate_contact(sums, where, powers);
}

/* One node, in those lanes of a part in which it touches. */
STRUT_BATCH_INLINE void batch_contact(strut_batch_tables *t, const double *restrict q,
                                      const double *restrict v, size_t at, const double *entry,
                                      int p, batch_ground_terms has, batch_contact_sums *sums) {
  batch_real zero = {0},
             gap = batch_row(q, at + 1, p) - batch_row(t->ground.line, STRUT_BATCH_HEIGHT, p);
  if (has.sloped)
    gap = batch_row(q, at, p) * batch_row(t->ground.line, STRUT_BATCH_NORMAL_X, p) +
          gap * batch_row(t->ground.line, STRUT_BATCH_NORMAL_Y, p);
  batch_mask touches = gap < zero;
  if (batch_some(touches)) batch_touch(t, v, at, entry, p, touches, gap, has, sums);
}

STRUT_BATCH_INLINE void batch_ground(strut_batch_tables *t, const double *restrict q,
                                     const double *restrict v, batch_ground_terms has,
                                     const batch_sums *sums) {
  const strut_contact_table *c = &t->first->contacts;
  has.moves = sums && sums->moves;
  for (int32_t i = 0; i < c->count; i++) {
    const double *entry = t->ground.contact + i * STRUT_BATCH_CONTACT_ROWS * BATCH_ROW;
    batch_contact_sums *to = sums ? sums->contact[c->entry[i].lane] : NULL;
    BATCH_EACH(batch_contact(t, q, v, c->at[i], entry, p, has, to ? to + p : NULL));
  }
}

/* All forces but the ground's at positions q and velocities v, with rest lengths and loads as
   batch_drive left them. */
STRUT_BATCH_INLINE void batch_structure(strut_batch_tables *t, const double *restrict q,
                                        const double *restrict v, bool balance,
                                        const batch_sums *sums) {
  const strut_model *m = t->first;
  batch_real zero = {0};
  bool powers = balance && (!sums || m->terms & (STRUT_TERM_LOADS | STRUT_TERM_ELEMENTS));
  for (size_t k = 0; k < STRUT_BATCH_POWERS && powers; k++)
    BATCH_EACH(batch_put(t->power, k, p, zero));
  for (size_t i = 0; i < 2 * (size_t)m->node_count; i++)
    BATCH_EACH(batch_put(t->force, i, p,
                         (m->terms & STRUT_TERM_CONSTANT) ? batch_row(t->constant, i, p) : zero));
  if (m->terms & STRUT_TERM_LOADS) BATCH_EACH(batch_loads(t, p, v, balance));
  if (m->terms & STRUT_TERM_MEMBERS) batch_members(t, q, v, balance, sums);
  if (m->terms & STRUT_TERM_ELEMENTS) batch_elements(t, q, v, balance);
}

/* All forces, the same way. sums: where the energy balance is kept; NULL: nowhere. */
STRUT_BATCH_INLINE void batch_forces(strut_batch_tables *t, const double *restrict q,
                                     const double *restrict v, const batch_sums *sums) {
  const strut_model *m = t->first;
  batch_structure(t, q, v, sums != NULL, sums);
  if (!(m->terms & STRUT_TERM_CONTACT)) return;
  if (m->terms & STRUT_TERM_LAWS)
    batch_ground(t, q, v, (batch_ground_terms){true, true, true, false}, sums);
  else if (m->terms & STRUT_TERM_SLOPE)
    batch_ground(t, q, v, (batch_ground_terms){true, m->terms & STRUT_TERM_FRICTION, false, false},
                 sums);
  else
    batch_ground(t, q, v, (batch_ground_terms){false, m->terms & STRUT_TERM_FRICTION, false, false},
                 sums);
}

/* Masses */

/* A row of a dense block's inverse times the forces of one coordinate, or of x and y together. */
STRUT_BATCH_INLINE void batch_mass_row(int32_t n, bool pair, const double *restrict inverse,
                                       const uint32_t *restrict at, const double *restrict f,
                                       double *restrict a, int p) {
  batch_real one = batch_row(inverse, 0, p), zero = {0};
  batch_real x = one * batch_row(f, at[0], p), y = pair ? one * batch_row(f, at[0] + 1, p) : zero;
  for (int32_t j = 1; j < n; j++) {
    one = batch_row(inverse, (size_t)j, p);
    x += one * batch_row(f, at[j], p);
    if (pair) y += one * batch_row(f, at[j] + 1, p);
  }
  batch_put(a, 0, p, x);
  if (pair) batch_put(a, 1, p, y);
}

STRUT_BATCH_INLINE void batch_mass_block(int32_t n, bool pair, const double *restrict inverse,
                                         const uint32_t *restrict at, const double *restrict f,
                                         double *restrict a) {
  for (int32_t i = 0; i < n; i++) {
    const double *row = inverse + i * n * BATCH_ROW;
    double *to = a + (size_t)at[i] * BATCH_ROW;
    BATCH_EACH(batch_mass_row(n, pair, row, at, f, to, p));
  }
}

/* f and a are those of the coordinate of node 0, or of both of them. */
STRUT_BATCH_INLINE void batch_mass_blocks(const strut_mass_operator *op, bool pair,
                                          const double *restrict inverse, const double *restrict f,
                                          double *restrict a) {
  const uint32_t *restrict at = op->block_at;
  for (int32_t b = 0, count = op->block_count; b < count; b++) {
    int32_t n = op->block_size[b];
    if (n == 2)
      batch_mass_block(2, pair, inverse, at, f, a);
    else if (n == 3)
      batch_mass_block(3, pair, inverse, at, f, a);
    else
      batch_mass_block(n, pair, inverse, at, f, a);
    at += n;
    inverse += (size_t)(n * n) * BATCH_ROW;
  }
}

/* a = M^-1 f; see mass_kernel. */
STRUT_BATCH_INLINE void batch_mass(const strut_batch_tables *t, double *restrict a) {
  const strut_mass *mass = t->first->mass;
  const double *restrict f = t->force;
  for (size_t i = 0; i < 2 * (size_t)t->first->node_count && mass->any_single; i++)
    BATCH_EACH(batch_put(a, i, p, batch_row(f, i, p) * batch_row(t->mass.inverse, i, p)));
  if (mass->diagonal) return;
  if (mass->shared) {
    batch_mass_blocks(&mass->coordinate[0], true, t->mass.block_inverse[0], f, a);
    return;
  }
  for (size_t c = 0; c < 2; c++)
    batch_mass_blocks(&mass->coordinate[c], false, t->mass.block_inverse[c], f + c * BATCH_ROW,
                      a + c * BATCH_ROW);
}

#endif

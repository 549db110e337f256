/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: the forces of STRUT_LANE_WIDTH models at once; see lane_vector.h.
 *
 * The order of operations is that of members_kernel.h, ground_kernel.h and mass_kernel.h lane by
 * lane, so that each lane has the bits of a single run. What is a branch there is a choice here.
 */
#ifndef STRUT_ENGINE_FORCES_LANE_KERNEL_H
#define STRUT_ENGINE_FORCES_LANE_KERNEL_H

#include "engine/forces/lane_elements.h"
#include "engine/forces/lane_ledger.h"
#include "engine/forces/lane_vector.h"

/* Signals */

STRUT_DEFINE_TRIG(STRUT_LANE_INLINE, lane_real, lane_sine_of_small, lane_cosine_of_small)

/* See strut_sincos_turns; the quarter turns are read from the last bits of the rounded number. */
STRUT_LANE_INLINE void lane_sincos(lane_real turns, lane_real *sine, lane_real *cosine) {
  const double rounder = 6755399441055744.0;
  lane_mask far = ~((turns > -0x1p49) & (turns < 0x1p49));
  if (lane_some(far))
    for (int l = 0; l < LANE_WIDTH; l++)
      if (far[l]) turns[l] -= floor(turns[l]);
  lane_real rounded = 4.0 * turns + rounder, quarter = rounded - rounder;
  lane_real x = STRUT_TAU * (turns - 0.25 * quarter);
  lane_real s = lane_sine_of_small(x), c = lane_cosine_of_small(x);
  lane_mask quadrant = (lane_mask)rounded, odd = -(quadrant & 1);
  lane_real first = lane_choose(odd, c, s), second = lane_choose(odd, s, c);
  *sine = lane_choose(-((quadrant >> 1) & 1), -first, first);
  *cosine = lane_choose(-(((quadrant + 1) >> 1) & 1), -second, second);
}

/* Value and rate of the signal of drive or load i at the times of a part's lanes. */
STRUT_LANE_INLINE void lane_signal(const strut_lane_tables *t, bool load, int32_t i, int p,
                                   lane_real time, lane_real *value, lane_real *rate) {
  size_t at = (size_t)(load ? t->first->drives.count + i : i);
  const double *wave = t->wave + at * STRUT_LANE_WAVE_ROWS * LANE_ROW;
  lane_real zero = {0}, sine, cosine;
  if (!t->all_waves[at]) {
    *value = *rate = zero;
    for (int l = 0; l < LANE_WIDTH; l++) {
      const strut_model *m = t->model[p * LANE_WIDTH + l];
      double one, its_rate;
      strut_signal_evaluate(m->scene->signals, load ? m->loads.signal[i] : m->drives.signal[i],
                            time[l], &one, &its_rate);
      (*value)[l] = one, (*rate)[l] = its_rate;
    }
    return;
  }
  lane_real start = lane_row(wave, STRUT_LANE_START, p);
  lane_real turns = lane_row(wave, STRUT_LANE_FREQUENCY, p) * (time - start) +
                    lane_row(wave, STRUT_LANE_PHASE, p);
  lane_mask on = (time >= start) & (time < lane_row(wave, STRUT_LANE_STOP, p)) &
                 (turns < lane_row(wave, STRUT_LANE_MOST_TURNS, p));
  lane_sincos(turns, &sine, &cosine);
  *value = lane_choose(on, lane_row(wave, STRUT_LANE_AMPLITUDE, p) * sine, zero);
  *rate = lane_choose(on, lane_row(wave, STRUT_LANE_RATE, p) * cosine, zero);
}

STRUT_LANE_INLINE void lane_drive_part(strut_lane_tables *t, int p, lane_real time) {
  const strut_drive_table *d = &t->first->drives;
  lane_real value, rate;
  for (int32_t i = 0; i < d->count; i++) {
    size_t j = (size_t)d->member[i];
    lane_signal(t, false, i, p, time, &value, &rate);
    lane_put(t->rest, j, p, lane_row(d->first[i] ? t->rest0 : t->rest, j, p) + value);
    lane_put(t->rest_rate, j, p, d->first[i] ? rate : lane_row(t->rest_rate, j, p) + rate);
  }
  for (int32_t i = 0; i < t->first->loads.count; i++) {
    lane_signal(t, true, i, p, time, &value, &rate);
    lane_put(t->load_factor, (size_t)i, p, value);
  }
}

/* All that depends on time alone, at the times (step + ahead) dt [s]. */
STRUT_LANE_INLINE void lane_drive(strut_lane_tables *t, const lane_real *step, double ahead,
                                  const lane_real *dt) {
  LANE_EACH(lane_drive_part(t, p, (step[p] + ahead) * dt[p]));
}

STRUT_LANE_INLINE void lane_loads(strut_lane_tables *t, int p, const double *restrict v,
                                  bool ledger) {
  const strut_load_table *loads = &t->first->loads;
  for (int32_t i = 0; i < loads->count; i++) {
    size_t k = (size_t)i, at = 2 * (size_t)loads->node[i];
    lane_real factor = lane_row(t->load_factor, k, p);
    lane_real px = factor * lane_row(t->load_x, k, p), py = factor * lane_row(t->load_y, k, p);
    lane_put(t->force, at, p, lane_row(t->force, at, p) + px);
    lane_put(t->force, at + 1, p, lane_row(t->force, at + 1, p) + py);
    if (!ledger) continue;
    lane_real power = px * lane_row(v, at, p) + py * lane_row(v, at + 1, p);
    lane_put(t->power, STRUT_POWER_LOAD, p, lane_row(t->power, STRUT_POWER_LOAD, p) + power);
    lane_put(t->power, STRUT_POWER_EXCHANGED, p,
             lane_row(t->power, STRUT_POWER_EXCHANGED, p) + lane_magnitude(power));
  }
}

/* Members */

/* What the law asks of member j; `rate`: of its length [m/s]. */
STRUT_LANE_INLINE lane_member_values lane_values_of(const strut_lane_tables *t, size_t j, int p,
                                                    lane_real length, lane_real rate) {
  return (lane_member_values){.length = length,
                              .rate = rate,
                              .rest = lane_row(t->rest, j, p),
                              .rest_rate = lane_row(t->rest_rate, j, p),
                              .stiffness = lane_row(t->stiffness, j, p),
                              .damping = lane_row(t->damping, j, p),
                              .slack_length_threshold = lane_row(t->slack_length_threshold, j, p),
                              .slack_force_threshold = lane_row(t->slack_force_threshold, j, p)};
}

/* Vector from the first to the second node, length, and its inverse or 0. */
typedef struct lane_span {
  lane_real x, y, length, inverse;
} lane_span;

STRUT_LANE_INLINE void lane_measure(const strut_member_table *m, const double *restrict q, size_t j,
                                    int p, lane_span *d) {
  size_t a = m->from[j], b = m->to[j];
  lane_real zero = {0};
  d->x = lane_row(q, b, p) - lane_row(q, a, p),
  d->y = lane_row(q, b + 1, p) - lane_row(q, a + 1, p);
  d->length = lane_root(d->x * d->x + d->y * d->y);
  d->inverse = lane_choose(d->length > zero, 1.0 / d->length, zero);
}

STRUT_LANE_INLINE void lane_pull(const strut_lane_tables *t, const strut_member_table *m,
                                 const lane_span *d, const double *restrict v,
                                 double *restrict force, size_t j, int p, unsigned terms,
                                 bool ledger, lane_member_powers *powers) {
  size_t a = m->from[j], b = m->to[j];
  lane_real rate = {0};
  if ((terms & STRUT_TERM_DAMPING) || (ledger && (terms & STRUT_TERM_DRIVE))) {
    lane_real wx = lane_row(v, b, p) - lane_row(v, a, p),
              wy = lane_row(v, b + 1, p) - lane_row(v, a + 1, p);
    rate = (wx * d->x + wy * d->y) * d->inverse;
  }
  lane_member_values values = lane_values_of(t, j, p, d->length, rate);
  bool damped = terms & STRUT_TERM_DAMPING, slack = terms & STRUT_TERM_SLACK;
  bool driven = terms & STRUT_TERM_DRIVE;
  lane_real damper, tension = lane_member_tension(&values, damped, slack, driven, ledger, &damper);
  if (ledger) lane_member_add_powers(&values, damped, driven, tension, damper, powers);
  lane_real density = tension * d->inverse, px = density * d->x, py = density * d->y;
  lane_put(force, a, p, lane_row(force, a, p) + px);
  lane_put(force, a + 1, p, lane_row(force, a + 1, p) + py);
  lane_put(force, b, p, lane_row(force, b, p) - px);
  lane_put(force, b + 1, p, lane_row(force, b + 1, p) - py);
}

STRUT_LANE_INLINE void lane_block(const strut_lane_tables *t, const double *restrict q,
                                  const double *restrict v, double *restrict force, int32_t begin,
                                  int32_t end, unsigned terms, bool ledger,
                                  lane_member_powers (*powers)[LANE_PARTS]) {
  const strut_member_table m = t->first->members;
  for (int32_t j = begin; j < end; j++) {
    lane_span d[LANE_PARTS];
    lane_member_powers *sums = powers[ledger ? j % STRUT_LANES : 0];
    LANE_EACH(lane_measure(&m, q, (size_t)j, p, d + p));
    LANE_EACH(lane_pull(t, &m, d + p, v, force, (size_t)j, p, terms, ledger, sums + p));
  }
}

/* The members' powers, place by place within groups as a single run sums them. */
STRUT_LANE_INLINE void lane_sum_powers(strut_lane_tables *t, int p,
                                       lane_member_powers (*powers)[LANE_PARTS]) {
  lane_real drive = {0}, lost = {0}, zero = {0},
            exchanged = lane_row(t->power, STRUT_POWER_EXCHANGED, p);
  for (int l = 0; l < STRUT_LANES; l++) {
    drive += powers[l][p].drive;
    lost += powers[l][p].lost;
    exchanged += powers[l][p].exchanged + powers[l][p].lost;
  }
  lane_put(t->power, STRUT_POWER_DRIVE, p, drive);
  lane_put(t->power, STRUT_POWER_BELT, p, zero);
  lane_put(t->power, STRUT_POWER_MEMBERS, p, lost);
  lane_put(t->power, STRUT_POWER_CONTACT, p, zero);
  lane_put(t->power, STRUT_POWER_FRICTION, p, zero);
  lane_put(t->power, STRUT_POWER_EXCHANGED, p, exchanged);
}

/* Slots of padding pull with no force, and no one asks for the place where they do. book: where powers are booked;
   NULL: in t->power. */
STRUT_LANE_INLINE void lane_members(strut_lane_tables *t, const double *restrict q,
                                    const double *restrict v, bool ledger, const lane_book *book) {
  enum { K = STRUT_TERM_DAMPING, S = STRUT_TERM_SLACK, D = STRUT_TERM_DRIVE };
  const strut_member_table *m = &t->first->members;
  lane_member_powers own[STRUT_LANES][LANE_PARTS],
      (*powers)[LANE_PARTS] = book ? book->member : own;
  if (ledger) lane_clear_members(powers);
  for (int32_t b = 0; b < m->blocks; b++) {
    int32_t begin = b * STRUT_BLOCK,
            end = begin + STRUT_BLOCK < m->count ? begin + STRUT_BLOCK : m->count;
#define STRUT_CASE(set)                                                                            \
  case set: lane_block(t, q, v, t->force, begin, end, set, ledger, powers); break
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
  if (ledger && !book) LANE_EACH(lane_sum_powers(t, p, powers));
}

/* Ground */

/* The numbers of a contact's laws in the runs of part p. */
STRUT_LANE_INLINE lane_ground_numbers lane_ground_at(const double *entry, int p) {
  return (lane_ground_numbers){lane_row(entry, STRUT_LANE_MINUS_STIFFNESS, p),
                               lane_row(entry, STRUT_LANE_MINUS_DAMPING, p),
                               lane_row(entry, STRUT_LANE_DISSIPATION, p)};
}
STRUT_LANE_INLINE lane_friction_numbers lane_friction_at(const double *entry, int p) {
  return (lane_friction_numbers){
#define STRUT_FRICTION_ROW(NAME, field, range)                                                     \
  .field = lane_row(entry, STRUT_LANE_FRICTION_##NAME, p),
      STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
          .mu_static_backward = lane_row(entry, STRUT_LANE_FRICTION_MU_STATIC_BACKWARD, p),
      .mu_kinetic_backward = lane_row(entry, STRUT_LANE_FRICTION_MU_KINETIC_BACKWARD, p)};
}
STRUT_LANE_INLINE lane_friction_choice lane_choice_at(const double *entry, int p) {
  lane_real law = lane_row(entry, STRUT_LANE_FRICTION_LAW, p);
  return (lane_friction_choice){
#define STRUT_FRICTION_ROW(NAME, name, ...) .name = law == lane_all(STRUT_FRICTION_##NAME),
      STRUT_FRICTION_LAWS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
  };
}

STRUT_LANE_INLINE void lane_add(double *table, size_t i, int p, lane_mask where, lane_real x) {
  lane_real before = lane_row(table, i, p);
  lane_put(table, i, p, lane_choose(where, before + x, before));
}

/* Whether the ground is inclined, rough, has other laws than (8) and (9), and moves. */
typedef struct lane_ground_terms {
  bool sloped, rough, laws, moves;
} lane_ground_terms;

/* See ground_touch; where: the lanes in which it does. */
STRUT_LANE_INLINE void lane_touch(strut_lane_tables *t, const double *restrict v, size_t at,
                                  const double *entry, int p, lane_mask where, lane_real gap,
                                  lane_ground_terms has, lane_contact_sums *book) {
  bool sloped = has.sloped, rough = has.rough, laws = has.laws;
  const double *g = t->ground;
  lane_real tx = lane_row(g, STRUT_LANE_TANGENT_X, p), ty = lane_row(g, STRUT_LANE_TANGENT_Y, p);
  lane_real nx = lane_row(g, STRUT_LANE_NORMAL_X, p), ny = lane_row(g, STRUT_LANE_NORMAL_Y, p);
  lane_real vx = lane_row(v, at, p), vy = lane_row(v, at + 1, p), zero = {0}, friction = zero;
  lane_real fx = lane_row(t->force, at, p), fy = lane_row(t->force, at + 1, p);
  lane_real into = sloped ? vx * nx + vy * ny : vy, along = sloped ? vx * tx + vy * ty : vx;
  lane_real belt_speed = lane_row(g, STRUT_LANE_BELT, p), slip = along - belt_speed;
  const lane_ground_numbers ground = lane_ground_at(entry, p);
  const lane_friction_numbers rubs = lane_friction_at(entry, p);
  lane_real spring = lane_ground_spring(&ground, gap);
  lane_real damper = lane_ground_damper(&ground, spring, into, laws), normal = spring + damper;
  if (rough) {
    lane_real applied = sloped ? fx * tx + fy * ty : fx;
    const lane_friction_choice which = lane_choice_at(entry, p);
    friction = laws ? lane_friction(&rubs, &which, normal, slip, applied)
                    : lane_friction_karnopp(&rubs, normal, slip, applied);
  }
  lane_add(t->force, at, p, where, sloped ? friction * tx + normal * nx : friction);
  lane_add(t->force, at + 1, p, where, sloped ? friction * ty + normal * ny : normal);
  if (!book) return;
  lane_contact_powers powers = lane_contact_power(damper, into, friction, slip, belt_speed);
  if (has.moves)
    lane_book_belt(book, where, belt_speed != zero, powers);
  else
    lane_book_contact(book, where, powers);
}

/* One node, in those lanes of a part in which it touches. */
STRUT_LANE_INLINE void lane_contact(strut_lane_tables *t, const double *restrict q,
                                    const double *restrict v, size_t at, const double *entry, int p,
                                    lane_ground_terms has, lane_contact_sums *book) {
  lane_real zero = {0}, gap = lane_row(q, at + 1, p) - lane_row(t->ground, STRUT_LANE_HEIGHT, p);
  if (has.sloped)
    gap = lane_row(q, at, p) * lane_row(t->ground, STRUT_LANE_NORMAL_X, p) +
          gap * lane_row(t->ground, STRUT_LANE_NORMAL_Y, p);
  lane_mask touches = gap < zero;
  if (lane_some(touches)) lane_touch(t, v, at, entry, p, touches, gap, has, book);
}

STRUT_LANE_INLINE void lane_ground(strut_lane_tables *t, const double *restrict q,
                                   const double *restrict v, lane_ground_terms has,
                                   const lane_book *book) {
  const strut_contact_table *c = &t->first->contacts;
  has.moves = book && book->moves;
  for (int32_t i = 0; i < c->count; i++) {
    const double *entry = t->contact + i * STRUT_LANE_CONTACT_ROWS * LANE_ROW;
    lane_contact_sums *to = book ? book->contact[c->entry[i].lane] : NULL;
    LANE_EACH(lane_contact(t, q, v, c->at[i], entry, p, has, to ? to + p : NULL));
  }
}

/* All forces but the ground's at positions q and velocities v, with rest lengths and loads as
   lane_drive left them. */
STRUT_LANE_INLINE void lane_structure(strut_lane_tables *t, const double *restrict q,
                                      const double *restrict v, bool ledger,
                                      const lane_book *book) {
  const strut_model *m = t->first;
  lane_real zero = {0};
  bool powers = ledger && (!book || m->plan & (STRUT_TERM_LOADS | STRUT_TERM_ELEMENTS));
  for (size_t k = 0; k < STRUT_LANE_POWERS && powers; k++)
    LANE_EACH(lane_put(t->power, k, p, zero));
  for (size_t i = 0; i < 2 * (size_t)m->node_count; i++)
    LANE_EACH(lane_put(t->force, i, p,
                       (m->plan & STRUT_TERM_CONSTANT) ? lane_row(t->constant, i, p) : zero));
  if (m->plan & STRUT_TERM_LOADS) LANE_EACH(lane_loads(t, p, v, ledger));
  if (m->plan & STRUT_TERM_MEMBERS) lane_members(t, q, v, ledger, book);
  if (m->plan & STRUT_TERM_ELEMENTS) lane_elements(t, q, v, ledger);
}

/* All forces, the same way. book: where the ledger is kept; NULL: nowhere. */
STRUT_LANE_INLINE void lane_forces(strut_lane_tables *t, const double *restrict q,
                                   const double *restrict v, const lane_book *book) {
  const strut_model *m = t->first;
  lane_structure(t, q, v, book != NULL, book);
  if (!(m->plan & STRUT_TERM_CONTACT)) return;
  if (m->plan & STRUT_TERM_LAWS)
    lane_ground(t, q, v, (lane_ground_terms){true, true, true, false}, book);
  else if (m->plan & STRUT_TERM_SLOPE)
    lane_ground(t, q, v, (lane_ground_terms){true, m->plan & STRUT_TERM_FRICTION, false, false},
                book);
  else
    lane_ground(t, q, v, (lane_ground_terms){false, m->plan & STRUT_TERM_FRICTION, false, false},
                book);
}

/* Masses */

/* A row of a dense block's inverse times the forces of one coordinate, or of x and y together. */
STRUT_LANE_INLINE void lane_mass_row(int32_t n, bool pair, const double *restrict inverse,
                                     const uint32_t *restrict at, const double *restrict f,
                                     double *restrict a, int p) {
  lane_real one = lane_row(inverse, 0, p), zero = {0};
  lane_real x = one * lane_row(f, at[0], p), y = pair ? one * lane_row(f, at[0] + 1, p) : zero;
  for (int32_t j = 1; j < n; j++) {
    one = lane_row(inverse, (size_t)j, p);
    x += one * lane_row(f, at[j], p);
    if (pair) y += one * lane_row(f, at[j] + 1, p);
  }
  lane_put(a, 0, p, x);
  if (pair) lane_put(a, 1, p, y);
}

STRUT_LANE_INLINE void lane_mass_block(int32_t n, bool pair, const double *restrict inverse,
                                       const uint32_t *restrict at, const double *restrict f,
                                       double *restrict a) {
  for (int32_t i = 0; i < n; i++) {
    const double *row = inverse + i * n * LANE_ROW;
    double *to = a + (size_t)at[i] * LANE_ROW;
    LANE_EACH(lane_mass_row(n, pair, row, at, f, to, p));
  }
}

/* f and a are those of the coordinate of node 0, or of both of them. */
STRUT_LANE_INLINE void lane_mass_blocks(const strut_mass_operator *op, bool pair,
                                        const double *restrict inverse, const double *restrict f,
                                        double *restrict a) {
  const uint32_t *restrict at = op->block_at;
  for (int32_t b = 0, count = op->block_count; b < count; b++) {
    int32_t n = op->block_size[b];
    if (n == 2)
      lane_mass_block(2, pair, inverse, at, f, a);
    else if (n == 3)
      lane_mass_block(3, pair, inverse, at, f, a);
    else
      lane_mass_block(n, pair, inverse, at, f, a);
    at += n;
    inverse += (size_t)(n * n) * LANE_ROW;
  }
}

/* a = M^-1 f; see mass_kernel. */
STRUT_LANE_INLINE void lane_mass(const strut_lane_tables *t, double *restrict a) {
  const strut_mass *mass = t->first->mass;
  const double *restrict f = t->force;
  for (size_t i = 0; i < 2 * (size_t)t->first->node_count && mass->any_single; i++)
    LANE_EACH(lane_put(a, i, p, lane_row(f, i, p) * lane_row(t->inverse, i, p)));
  if (mass->diagonal) return;
  if (mass->shared) {
    lane_mass_blocks(&mass->coordinate[0], true, t->block_inverse[0], f, a);
    return;
  }
  for (size_t c = 0; c < 2; c++)
    lane_mass_blocks(&mass->coordinate[c], false, t->block_inverse[c], f + c * LANE_ROW,
                     a + c * LANE_ROW);
}

#endif

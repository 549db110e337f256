/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: forces and accelerations of a small model with all of its state in vector registers.
 *
 * Every number goes through the operations of members_kernel.h, ground_kernel.h and mass_kernel.h in their
 * order, so that it has the same bits: nodes are lanes, a mask leaves out the lanes in which nothing is
 * added, and sums over members, rows of the mass matrix and contacts keep the scene's order.
 */
#ifndef STRUT_ENGINE_FORCES_SMALL_KERNEL_H
#define STRUT_ENGINE_FORCES_SMALL_KERNEL_H

#include "engine/forces/small_inputs.h"
#include "engine/forces/small_vector.h"
#include "engine/model/state.h"

/* What a run of steps reads beside the tables: of the model as it now is, and of the drives. */
typedef struct small_run {
  const strut_small_model *tables;
  const strut_contact_table *contacts;
  const strut_small_inputs *inputs;
  unsigned terms;  /* with the terms that a copy knows; see small_terms_in_copy */
  unsigned driven; /* bit g: some of the members 4 g to 4 g + 3 is */
} small_run;

/* A term of this kernel alone: the ground moves. */
#define STRUT_SMALL_BELT (1u << 31)
/*
 * Copies know all terms, or those of most models, or are for models with exactly these, which they need not
 * ask for.
 */
#define STRUT_SMALL_COMMON (~(unsigned)(STRUT_TERM_SLACK | STRUT_TERM_SLOPE | STRUT_TERM_LAWS))
#define STRUT_SMALL_USUAL                                                                          \
  ((unsigned)(STRUT_TERM_MEMBERS | STRUT_TERM_DAMPING | STRUT_TERM_DRIVE | STRUT_TERM_CONTACT |    \
              STRUT_TERM_FRICTION))

/* The terms of the model that forces ask for. */
static inline unsigned small_terms_of(const strut_model *model) {
  unsigned belt = model->contacts.belt_speed != 0.0 ? STRUT_SMALL_BELT : 0;
  return (model->terms & ~(unsigned)(STRUT_TERM_CONSTANT | STRUT_TERM_SOLVE)) | belt;
}
/*
 * Which of the three kinds of copies steps the model: 0 for all terms, 1 for common ones, 2 for exactly the
 * usual.
 */
static inline int small_copy_of(const strut_model *model) {
  unsigned terms = small_terms_of(model);
  return terms == STRUT_SMALL_USUAL ? 2 : !(terms & ~STRUT_SMALL_COMMON);
}
/* What a copy that knows these terms reads of them. */
STRUT_SMALL_INLINE unsigned small_terms_in_copy(const strut_model *model, unsigned terms) {
  return terms == STRUT_SMALL_USUAL ? terms : small_terms_of(model) & terms;
}

/* The speed of the ground; 0 is known to copies without one. */
STRUT_SMALL_INLINE double small_belt(const small_run *r) {
  return r->terms & STRUT_SMALL_BELT ? r->contacts->belt_speed : 0.0;
}

/* Along the members: differences of the ends' positions and velocities, pulls. */
#define STRUT_DEFINE_SMALL_GROUP(number, mask, PREFIX, law, load, root)                                                     \
  STRUT_SMALL_INLINE law##_member_values PREFIX##_values_at(                                                                \
      const small_run *r, const small_rest *rest, int j, number length, number rate) {                                      \
    const strut_small_model *s = r->tables;                                                                                 \
    return (law##_member_values){                                                                                           \
        .length = length,                                                                                                   \
        .rate = rate,                                                                                                       \
        .rest = load(rest->rest + j),                                                                                       \
        .rest_rate = load(rest->rate + j),                                                                                  \
        .stiffness = load(s->stiffness + j),                                                                                \
        .damping = load(s->damping + j),                                                                                    \
        .slack_length_threshold = load(r->inputs->slack_length_threshold + j),                                              \
        .slack_force_threshold = load(r->inputs->slack_force_threshold + j)};                                               \
  }                                                                                                                         \
                                                                                                                            \
  /* What follows from positions alone. */                                                                                  \
  typedef struct PREFIX##_shape {                                                                                           \
    number x, y, length, inverse;                                                                                           \
  } PREFIX##_shape;                                                                                                         \
                                                                                                                            \
  STRUT_SMALL_INLINE PREFIX##_shape PREFIX##_measure(number x, number y) {                                                  \
    PREFIX##_shape d = {.x = x, .y = y, .length = root(x * x + y * y)};                                                     \
    d.inverse = (number)((d.length > 0.0) & (mask)(1.0 / d.length));                                                        \
    return d;                                                                                                               \
  }                                                                                                                         \
                                                                                                                            \
  /* Pulls of the members from j on, at differences u and w of their ends' velocities, which they replace; their tensions \
     and, for the energy balance, what their dampers lose. */ \
  STRUT_SMALL_INLINE number PREFIX##_pull(const small_run *r, const small_rest *rest, int j,                                \
                                          const PREFIX##_shape *d, number *u, number *w,                                    \
                                          bool balance, number *lost) {                                                     \
    number rate = {0}, damper;                                                                                              \
    if (r->terms & STRUT_TERM_DAMPING) rate = (*u * d->x + *w * d->y) * d->inverse;                                         \
    law##_member_values m = PREFIX##_values_at(r, rest, j, d->length, rate);                                                \
    bool damped = r->terms & STRUT_TERM_DAMPING, driven = r->terms & STRUT_TERM_DRIVE;                                      \
    number tension =                                                                                                        \
        law##_member_tension(&m, damped, r->terms & STRUT_TERM_SLACK, driven, balance, &damper);                            \
    number density = tension * d->inverse;                                                                                  \
    *u = density * d->x, *w = density * d->y;                                                                               \
    if (balance && damped) *lost = damper * law##_member_stretch_rate(&m, driven);                                          \
    return tension;                                                                                                         \
  }

STRUT_DEFINE_SMALL_GROUP(strut_lanes, strut_lane_mask, small4, small4, small4_load, small_root_of_4)

/* Adds what drives take from 4 members whose rest lengths change at these rates. */
STRUT_SMALL_INLINE void small_add_drive(small4_member_powers *sum, strut_lanes tension,
                                        const double *rate) {
  strut_lanes power = tension * small4_load(rate);
  sum->drive += power;
  sum->exchanged += (strut_lanes)((strut_lane_mask)power & INT64_MAX);
}

#if STRUT_SMALL_WIDTH == 8
STRUT_DEFINE_SMALL_GROUP(small_real, small_bits, small8, small, small_load, small_root)

STRUT_SMALL_INLINE small_real small_gather(const int64_t *lane, small_row x) {
  return _mm512_permutexvar_pd((__m512i)small_bits_load(lane), x.part[0]);
}
STRUT_SMALL_INLINE small_row small_permute(const strut_small_column *column, small_row x) {
  return (small_row){{small_gather(column->lane, x)}};
}
STRUT_SMALL_INLINE small_real small_difference(const strut_small_model *s, int j, small_row x) {
  return small_gather(s->to + j, x) - small_gather(s->from + j, x);
}
STRUT_SMALL_INLINE strut_lanes small_half(small_real x, int half) {
  return half ? _mm512_extractf64x4_pd(x, 1) : _mm512_castpd512_pd256(x);
}
/* What the members pull with, at each node's k-th; -0, which changes no bit, where there is none. */
STRUT_SMALL_INLINE small_row small_gather_pulls(const strut_small_pull *at, const small_pulls *p) {
  __m512d last = _mm512_zextpd256_pd512(p->last);
  return (small_row){{_mm512_permutex2var_pd(p->first, (__m512i)small_bits_load(at->slot), last)}};
}

/* All members at positions q; 0 where there are none. */
typedef struct small_shapes {
  small8_shape first;
  small4_shape last;
} small_shapes;

STRUT_SMALL_INLINE void small_measure_members(const strut_small_model *s, const small_points *q,
                                              small_shapes *d) {
  if (s->members > 8)
    d->last = small4_measure(small_half(small_difference(s, 8, q->x), 0),
                             small_half(small_difference(s, 8, q->y), 0));
  d->first = small8_measure(small_difference(s, 0, q->x), small_difference(s, 0, q->y));
}

/*
 * Pulls of the members, whose shapes are those at the positions; sum: their powers for the energy balance,
 * added up in the order of groups of 4; drive: what drives take. The shapes become those at next_q, the
 * positions that are wanted next, where these are known already: roots and divisions take long, and are there
 * when velocities are.
 */
STRUT_SMALL_INLINE void small_members(const small_run *r, const small_rest *rest,
                                      small_shapes *shapes, const small_points *next_q,
                                      const small_points *v, bool balance, small_pulls *px,
                                      small_pulls *py, small4_member_powers *sum) {
  const strut_small_model *s = r->tables;
  small_shapes d = *shapes;
  small_real lost = {0}, tension;
  strut_lanes lost_last = {0}, tension_last = {0};
  *px = *py = (small_pulls){0};
  if (r->terms & STRUT_TERM_DAMPING)
    px->first = small_difference(s, 0, v->x), py->first = small_difference(s, 0, v->y);
  if (s->members > 8) {
    if (r->terms & STRUT_TERM_DAMPING) {
      px->last = small_half(small_difference(s, 8, v->x), 0);
      py->last = small_half(small_difference(s, 8, v->y), 0);
    }
    tension_last = small4_pull(r, rest, 8, &d.last, &px->last, &py->last, balance, &lost_last);
  }
  tension = small8_pull(r, rest, 0, &d.first, &px->first, &py->first, balance, &lost);
  if (balance) {
    sum->lost = small_half(lost, 0) + small_half(lost, 1) + lost_last;
    small_real drive = tension * small_load(rest->rate), size = small_magnitude(drive);
    sum->drive = small_half(drive, 0) + small_half(drive, 1);
    sum->exchanged = small_half(size, 0) + small_half(size, 1);
    if (r->driven & 4) small_add_drive(sum, tension_last, rest->rate + 8);
  }
  if (next_q) small_measure_members(s, next_q, shapes);
}
#else
STRUT_SMALL_INLINE strut_lanes small_halves(strut_lanes x, small_bits halves) {
  return (strut_lanes)_mm256_permutevar8x32_ps((__m256)x, (__m256i)halves);
}
STRUT_SMALL_INLINE strut_lanes small_gather(const int64_t *halves, small_row x) {
  small_bits at = small_bits_load(halves);
  return _mm256_blendv_pd(small_halves(x.part[0], at), small_halves(x.part[1], at),
                          (strut_lanes)at);
}
STRUT_SMALL_INLINE small_row small_permute(const strut_small_column *column, small_row x) {
  return (small_row){
      {small_gather(column->batch_halves, x), small_gather(column->batch_halves + 4, x)}};
}
STRUT_SMALL_INLINE strut_lanes small_difference(const strut_small_model *s, int j, small_row x) {
  return small_gather(s->to_halves + j, x) - small_gather(s->from_halves + j, x);
}

/* The ends of 4 members. */
STRUT_SMALL_INLINE void small_ends(const int64_t *halves, strut_small_source source,
                                   const small_points *z, strut_lanes *x, strut_lanes *y) {
  small_bits at = small_bits_load(halves);
  if (source == STRUT_SMALL_FIRST)
    *x = small_halves(z->x.part[0], at), *y = small_halves(z->y.part[0], at);
  else if (source == STRUT_SMALL_SECOND)
    *x = small_halves(z->x.part[1], at), *y = small_halves(z->y.part[1], at);
  else
    *x = small_gather(halves, z->x), *y = small_gather(halves, z->y);
}
/* The differences of their ends, group g. */
STRUT_SMALL_INLINE void small_group_differences(const strut_small_model *s, int g,
                                                const small_points *z, strut_lanes *x,
                                                strut_lanes *y) {
  strut_lanes x0, y0;
  small_ends(s->from_halves + 4 * g, s->from_source[g], z, &x0, &y0);
  small_ends(s->to_halves + 4 * g, s->to_source[g], z, x, y);
  *x -= x0, *y -= y0;
}

/* All members at positions q; 0 where there are none. */
typedef struct small_shapes {
  small4_shape part[3];
} small_shapes;

STRUT_SMALL_INLINE void small_measure_members(const strut_small_model *s, const small_points *q,
                                              small_shapes *d) {
#pragma GCC unroll 3
  for (int g = 0; g < 3; g++) {
    strut_lanes x, y;
    if (4 * g >= s->members) break;
    small_group_differences(s, g, q, &x, &y);
    d->part[g] = small4_measure(x, y);
  }
}

STRUT_SMALL_INLINE void small_members(const small_run *r, const small_rest *rest,
                                      small_shapes *shapes, const small_points *next_q,
                                      const small_points *v, bool balance, small_pulls *px,
                                      small_pulls *py, small4_member_powers *sum) {
  const strut_small_model *s = r->tables;
  small_shapes d = *shapes;
  *px = *py = (small_pulls){0};
  if (balance) sum->drive = sum->exchanged = (strut_lanes){0};
#pragma GCC unroll 3
  for (int g = 0; g < 3; g++) {
    strut_lanes u = {0}, w = {0}, lost = {0}, tension;
    if (4 * g >= s->members) break;
    if (r->terms & STRUT_TERM_DAMPING) small_group_differences(s, g, v, &u, &w);
    tension = small4_pull(r, rest, 4 * g, &d.part[g], &u, &w, balance, &lost);
    px->part[g] = u, py->part[g] = w;
    if (!balance) continue;
    sum->lost = g ? sum->lost + lost : lost;
    if (r->driven >> g & 1) small_add_drive(sum, tension, rest->rate + 4 * g);
  }
  if (next_q) small_measure_members(s, next_q, shapes);
}
#endif

/* Constant forces, and then the pulls of the members in the scene's order. */
#if STRUT_SMALL_WIDTH == 8
STRUT_SMALL_INLINE small_points small_sum_pulls(const small_run *r, const small_pulls *px,
                                                const small_pulls *py) {
  const strut_small_model *s = r->tables;
  small_points f = {small_row_load(r->inputs->constant[0]), small_row_load(r->inputs->constant[1])};
  for (int32_t k = 0, degree = s->degree; k < degree; k++) {
    const strut_small_pull *at = &s->pull[k];
    small_row x = small_gather_pulls(at, px), y = small_gather_pulls(at, py);
    small_bits sign = small_bits_load(at->sign);
    f.x.part[0] += small_flip(x.part[0], sign), f.y.part[0] += small_flip(y.part[0], sign);
  }
  return f;
}
#else
STRUT_SMALL_INLINE small_points small_sum_pulls(const small_run *r, const small_pulls *px,
                                                const small_pulls *py) {
  small_points f = {small_row_load(r->inputs->constant[0]), small_row_load(r->inputs->constant[1])};
  const strut_small_pull_turns *t = &r->tables->pull_turns;
  int64_t k = 0;
#pragma GCC unroll 3
  for (int g = 0; g < 3; g++)
    for (int64_t end = t->end[g]; k < end; k++) {
      const strut_small_pull_turn *turn = &t->turn[k];
      SMALL_EACH(h) {
        small_bits at = small_bits_load(turn->halves + 4 * h);
        small_bits sign = small_bits_load(turn->sign + 4 * h);
        small_bits has = small_bits_load(turn->has + 4 * h);
        small_bits x = (small_bits)small_halves(px->part[g], at) & has;
        small_bits y = (small_bits)small_halves(py->part[g], at) & has;
        f.x.part[h] += (strut_lanes)(x ^ sign), f.y.part[h] += (strut_lanes)(y ^ sign);
      }
    }
  return f;
}
#endif

/* What the ground takes from the nodes that touch it, where it is accumulated; 0 at all others. */
typedef struct small_touch {
  unsigned touching; /* a bit of each lane */
  small_row minus_damped, minus_rubbed, belt, exchanged;
} small_touch;

/* What the powers of one evaluation are made of, see small_balance.h. */
typedef struct small_entries {
  small4_member_powers members;
  small_touch touch;
} small_entries;

/* The numbers of contact law at part p. */
#define SMALL_CONTACT(field) small_load(c->field + p * SMALL_WIDTH)
#define SMALL_CONTACT_MASK(field) small_mask_load(c->field + p * SMALL_WIDTH)

/* What the laws take of the contacts of part p. */
STRUT_SMALL_INLINE small_ground_numbers small_ground_at(const strut_small_contacts *c, int p) {
  return (small_ground_numbers){SMALL_CONTACT(minus_stiffness), SMALL_CONTACT(minus_damping),
                                SMALL_CONTACT(dissipation)};
}
STRUT_SMALL_INLINE small_friction_numbers small_friction_at(const strut_small_contacts *c, int p) {
  return (small_friction_numbers){
#define STRUT_FRICTION_ROW(NAME, field, range) .field = SMALL_CONTACT(field),
      STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
          .mu_static_backward = SMALL_CONTACT(mu_static_backward),
      .mu_kinetic_backward = SMALL_CONTACT(mu_kinetic_backward)};
}
STRUT_SMALL_INLINE small_friction_choice small_choice_at(const strut_small_contacts *c, int p) {
  return (small_friction_choice){
#define STRUT_FRICTION_ROW(NAME, name, ...) .name = SMALL_CONTACT_MASK(name),
      STRUT_FRICTION_LAWS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
  };
}

/* See ground_balance; both_signs: what dampers do is exchanged by its size. */
STRUT_SMALL_INLINE void small_accumulate_contacts(const small_run *r, small_mask closed,
                                                  small_contact_powers powers, bool both_signs,
                                                  int p, small_touch *touch) {
  small_real damped = small_keep(closed, powers.damper);
  small_real rubbed = small_keep(closed, powers.friction);
  touch->minus_damped.part[p] = damped, touch->minus_rubbed.part[p] = rubbed;
  touch->exchanged.part[p] = both_signs ? small_magnitude(damped) + small_magnitude(rubbed)
                                        : small_magnitude(rubbed) - damped;
  if (!(r->terms & STRUT_SMALL_BELT)) return;
  touch->belt.part[p] = small_keep(closed, powers.belt);
  touch->exchanged.part[p] += small_magnitude(touch->belt.part[p]);
}

/* See ground_touch: adds the ground's forces on the nodes of part p. */
STRUT_SMALL_INLINE void small_ground_part(const small_run *r, int p, small_real x, small_real y,
                                          small_real u, small_real w, small_points *f, bool balance,
                                          small_touch *touch) {
  const strut_small_contacts *c = &r->tables->contact;
  const strut_contact_table *t = r->contacts;
  bool laws = r->terms & STRUT_TERM_LAWS, sloped = r->terms & (STRUT_TERM_SLOPE | STRUT_TERM_LAWS);
  bool rough = r->terms & (STRUT_TERM_FRICTION | STRUT_TERM_LAWS);
  small_real nx = small_all(t->normal[0]), ny = small_all(t->normal[1]);
  small_real tx = small_all(t->tangent[0]), ty = small_all(t->tangent[1]), zero = {0};
  small_real gap = y - t->height, into = w, along = u;
  if (sloped) gap = x * nx + gap * ny, into = u * nx + w * ny, along = u * tx + w * ty;
  small_mask closed = small_less(gap, zero) & SMALL_CONTACT_MASK(touches);
  unsigned closed_bits = small_set_bits(closed);
  touch->touching |= closed_bits << (p * SMALL_WIDTH);
  if (SMALL_PARTS > 1 && !closed_bits) return;
  const small_ground_numbers ground = small_ground_at(c, p);
  const small_friction_numbers rubs = small_friction_at(c, p);
  small_real spring = small_ground_spring(&ground, gap);
  small_real damper = small_ground_damper(&ground, spring, into, laws);
  small_real normal = spring + damper, slip = along - small_belt(r), friction = zero;
  small_real fx = f->x.part[p], fy = f->y.part[p];
  if (rough) { /* the applied force comes last of all, so that nothing else waits for it */
    small_real applied = sloped ? fx * tx + fy * ty : fx;
    const small_friction_choice has = small_choice_at(c, p);
    friction = laws ? small_friction(&rubs, &has, normal, slip, applied)
                    : small_friction_karnopp(&rubs, normal, slip, applied);
  }
  f->x.part[p] = small_add_where(closed, fx, sloped ? friction * tx + normal * nx : friction);
  f->y.part[p] = small_add_where(closed, fy, sloped ? friction * ty + normal * ny : normal);
  if (!balance) return;
  small_contact_powers powers =
      small_contact_power(damper, into, friction, slip, small_all(r->contacts->belt_speed));
  small_accumulate_contacts(r, closed, powers, false, p, touch);
}

/* a = M^-1 f, and 0 where there is no mass to divide by. */
#if STRUT_SMALL_WIDTH == 8
STRUT_SMALL_INLINE small_points small_divide_points(const strut_small_model *s,
                                                    const small_points *f) {
  const strut_small_column *column[2] = {s->column[0], s->column[1]};
  small_real a[2], force[2] = {f->x.part[0], f->y.part[0]};
#pragma GCC unroll 2
  for (int c = 0; c < 2; c++)
    a[c] = small_keep(column[c]->bits, small_load(column[c]->inverse) *
                                           small_gather(column[c]->lane, (small_row){{force[c]}}));
  for (int32_t j = 1, columns = s->columns; j < columns; j++)
#pragma GCC unroll 2
    for (int c = 0; c < 2; c++) {
      const strut_small_column *at = &column[c][j];
      small_real x = small_gather(at->lane, (small_row){{force[c]}});
      a[c] = small_add_where(at->bits, a[c], small_load(at->inverse) * x);
    }
  return (small_points){{{a[0]}}, {{a[1]}}};
}
#else
STRUT_SMALL_INLINE strut_lanes small_share(const strut_small_mass_turn *turn, int c, int h,
                                           strut_lanes f) {
  strut_lanes x = small_halves(f, small_bits_load(turn->halves[c] + 4 * h));
  x *= small4_load(turn->minus_inverse[c] + 4 * h);
  return (strut_lanes)((small_bits)x & small_bits_load(turn->has[c] + 4 * h));
}
/* Shares are taken off, of -0 first, so that lanes without one keep their bits. */
STRUT_SMALL_INLINE small_points small_divide_points(const strut_small_model *s,
                                                    const small_points *f) {
  const strut_small_mass_turns *t = &s->mass_turns;
  strut_lanes zero = small_all(-0.0);
  small_points a = {{{zero, zero}}, {{zero, zero}}};
  int64_t k = 0;
#pragma GCC unroll 2
  for (int g = 0; g < 2; g++)
    for (int64_t end = t->end[g]; k < end; k++) SMALL_EACH(h) {
        a.x.part[h] -= small_share(&t->turn[k], 0, h, f->x.part[g]);
        a.y.part[h] -= small_share(&t->turn[k], 1, h, f->y.part[g]);
      }
  return a;
}
#endif

/* The ground's forces on all nodes. */
STRUT_SMALL_INLINE void small_ground(const small_run *r, const small_points *q,
                                     const small_points *v, small_points *f, bool balance,
                                     small_touch *touch) {
  if (!(r->terms & STRUT_TERM_CONTACT)) return;
  SMALL_EACH(p)
  small_ground_part(r, p, q->x.part[p], q->y.part[p], v->x.part[p], v->y.part[p], f, balance,
                    touch);
}

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hot: one sweep over a subdomain. See domain_parts.h. */
#include <assert.h>
#include <string.h>

#include "engine/forces/ground_kernel.h"
#include "engine/integrate/domain_parts.h"

/* ---- nodes ---- */

/* The forces that do not depend on members, for the pass after this one; loads come later. */
STRUT_INLINE strut_lanes node_base(const domain_part *p, int32_t at) {
  return p->base ? strut_lanes_load(p->base + at) : (strut_lanes){0};
}

STRUT_INLINE strut_lanes node_acceleration(const domain_part *p, int32_t at) {
  return strut_lanes_load_pairs(p->force + at) * strut_lanes_load(p->inverse + at);
}

/* Nodes from `begin` on, two by two, at the begin of the first pass. */
STRUT_CLONES
static void begin_nodes(const domain_part *p, domain_method stepping, double h, int32_t begin,
                        int32_t end) {
  double half = 0.5 * h;
  for (int32_t i = 2 * begin; i < 2 * end; i += STRUT_LANES) {
    strut_lanes_store(p->force + i, node_base(p, i));
    if (stepping == DOMAIN_RK4) {
      strut_lanes_store(p->q + i, strut_lanes_load(p->q0 + i));
      strut_lanes_store(p->v + i, strut_lanes_load(p->v0 + i));
    } else if (stepping == DOMAIN_VERLET) {
      strut_lanes rate = strut_lanes_load(p->v0 + i), bend = strut_lanes_load(p->a[0] + i);
      strut_lanes_store(p->q + i, strut_lanes_load(p->q + i) + h * (rate + half * bend));
      strut_lanes_store(p->v + i, rate + h * bend);
    }
  }
}

/* The next stage of rk4 from stage k < 3: velocities of stages follow from the accelerations before. */
STRUT_INLINE void rk4_next(const domain_part *p, double h, double before, int k, bool moves,
                           int32_t i) {
  strut_lanes a = node_acceleration(p, i), v0 = strut_lanes_load(p->v0 + i), speed = v0;
  strut_lanes step = four_all(h);
  if (k > 0) speed = four_rk4_stage(v0, four_all(before), strut_lanes_load(p->a[k - 1] + i));
  strut_lanes_store(p->a[k] + i, a);
  strut_lanes_store(p->q + i, four_rk4_stage(strut_lanes_load(p->q0 + i), step, speed));
  if (moves) strut_lanes_store(p->v + i, four_rk4_stage(v0, step, a));
  strut_lanes_store(p->force + i, node_base(p, i));
}

STRUT_INLINE void rk4_last(const domain_part *p, double h, int32_t i) {
  strut_lanes half = four_all(0.5 * h), step = four_all(h), sixth = four_all(h / 6.0);
  strut_lanes a = node_acceleration(p, i), v0 = strut_lanes_load(p->v0 + i);
  strut_lanes a0 = strut_lanes_load(p->a[0] + i), a1 = strut_lanes_load(p->a[1] + i);
  strut_lanes a2 = strut_lanes_load(p->a[2] + i), q0 = strut_lanes_load(p->q0 + i);
  strut_lanes v1 = four_rk4_stage(v0, half, a0), v2 = four_rk4_stage(v0, half, a1);
  strut_lanes_store(p->q0 + i, four_rk4_end(q0, sixth, v0, v1 + v2, four_rk4_stage(v0, step, a2)));
  strut_lanes_store(p->v0 + i, four_rk4_end(v0, sixth, a0, a1 + a2, a));
}

STRUT_CLONES
static void finish_rk4(const domain_part *p, int k, double h, bool moves, int32_t begin,
                       int32_t end) {
  double half = 0.5 * h;
  if (k == 0)
    for (int32_t i = 2 * begin; i < 2 * end; i += STRUT_LANES) rk4_next(p, half, 0.0, 0, moves, i);
  else if (k == 1)
    for (int32_t i = 2 * begin; i < 2 * end; i += STRUT_LANES) rk4_next(p, half, half, 1, moves, i);
  else if (k == 2)
    for (int32_t i = 2 * begin; i < 2 * end; i += STRUT_LANES) rk4_next(p, h, half, 2, moves, i);
  else
    for (int32_t i = 2 * begin; i < 2 * end; i += STRUT_LANES) rk4_last(p, h, i);
}

/* The end of a step, and the begin of the next one where it is not the last. */
STRUT_CLONES
static void finish_verlet(const domain_part *p, double h, bool last, int32_t begin, int32_t end) {
  double half = 0.5 * h;
  for (int32_t i = 2 * begin; i < 2 * end; i += STRUT_LANES) {
    strut_lanes a = node_acceleration(p, i);
    strut_lanes v = strut_lanes_load(p->v0 + i) + half * (strut_lanes_load(p->a[0] + i) + a);
    strut_lanes_store(p->v0 + i, v);
    strut_lanes_store(p->a[0] + i, a);
    if (last) continue;
    strut_lanes_store(p->q + i, strut_lanes_load(p->q + i) + h * (v + half * a));
    strut_lanes_store(p->v + i, v + h * a);
    strut_lanes_store(p->force + i, node_base(p, i));
  }
}

STRUT_CLONES
static void finish_euler(const domain_part *p, double h, bool last, int32_t begin, int32_t end) {
  for (int32_t i = 2 * begin; i < 2 * end; i += STRUT_LANES) {
    strut_lanes v = strut_lanes_load(p->v + i) + h * node_acceleration(p, i);
    strut_lanes_store(p->v + i, v);
    strut_lanes_store(p->q + i, strut_lanes_load(p->q + i) + h * v);
    if (!last) strut_lanes_store(p->force + i, node_base(p, i));
  }
}

/* ---- what acts on nodes beside members ---- */

/* Loads of pass k on nodes before `end` that have none of it yet. */
static void add_loads(domain_part *p, int k, int32_t end) {
  assert(k >= 0 && k < STRUT_PASSES);
  const strut_load_table *l = &p->domain.model.loads;
  for (; p->loaded[k] < l->count && l->node[p->loaded[k]] < end; p->loaded[k]++) {
    int32_t i = p->loaded[k];
    double *force = p->force + 2 * l->node[i];
    const double *load = p->load + 2 * (k * l->count + i);
    strut_pair_store(force, strut_pair_load(force) + strut_pair_load(load));
  }
}

/* Their powers, while the node still has the velocity of pass k. */

static void pay_loads(const strut_domain_steps *s, domain_part *p, int k, int side, int32_t end) {
  const strut_load_table *l = &p->domain.model.loads;
  for (; p->paid[k] < l->count && l->node[p->paid[k]] < end; p->paid[k]++) {
    int32_t i = p->paid[k], at = 2 * l->node[i];
    const double *load = p->load + 2 * (k * l->count + i);
    if (!domain_part_owns(&p->domain, l->node[i])) continue;
    s->balance[side].load[k * s->model->loads.count + p->domain.load[i]] =
        load[0] * p->v[at] + load[1] * p->v[at + 1];
  }
}

/* The ground's forces of pass k, one contact after the other where the energy balance asks what each one does. */
static void touch_ground(const strut_domain_steps *s, domain_part *p, int k, int side,
                         int32_t end) {
  assert(k >= 0 && k < STRUT_PASSES);
  strut_subdomain *d = &p->domain;
  const strut_contact_table *c = &d->model.contacts;
  bool balance = d->state.balance;
  int32_t i = p->contact[k], all = s->model->contacts.count;
  int32_t blocks = (all + DOMAIN_CONTACT_BLOCK - 1) / DOMAIN_CONTACT_BLOCK;
  for (; i < c->count && c->entry[i].node < end; i++) {
    double *power = d->state.latest.power;
    int32_t of = d->contact[i];
    for (int32_t w = 0; w < STRUT_POWER_COUNT; w++) power[w] = 0.0;
    ground_kernel_range(&d->model, &d->state, p->q, p->v, p->force, i, i + 1, balance);
    if (!balance || !domain_part_owns(d, c->entry[i].node)) continue;
    double *to =
        s->balance[side].contact + DOMAIN_CONTACT_POWERS * ((size_t)k * (size_t)all + (size_t)of);
    const double now[DOMAIN_CONTACT_POWERS] = {power[STRUT_POWER_CONTACT],
                                               power[STRUT_POWER_FRICTION], power[STRUT_POWER_BELT],
                                               power[STRUT_POWER_EXCHANGED]};
    if (now[0] == 0.0 && now[1] == 0.0 && now[2] == 0.0)
      continue; /* as it is in the energy balance */
    memcpy(to, now, sizeof now);
    atomic_store_explicit(&s->balance[side].touched[k * blocks + of / DOMAIN_CONTACT_BLOCK], 1,
                          memory_order_relaxed);
  }
  p->contact[k] = i;
}

/* ---- one sweep ---- */

static void begin_to(const strut_domain_steps *s, domain_part *p, int32_t end) {
  if (end <= p->begun) return;
  begin_nodes(p, s->stepping, s->dt, p->begun, end);
  p->begun = end;
  add_loads(p, 0, end);
}

/* What acts on nodes before `end` beside members, and the powers of it. */
static void act_to(const strut_domain_steps *s, domain_part *p, int k, int side, int32_t end) {
  const strut_subdomain *d = &p->domain;
  if (d->model.contacts.count) touch_ground(s, p, k, side, end);
  if (d->model.loads.count && d->state.balance) pay_loads(s, p, k, side, end);
}

static void move_to(const strut_domain_steps *s, domain_part *p, int k, bool last, int32_t end) {
  assert(k >= 0 && k < STRUT_PASSES);
  int32_t begin = p->done[k];
  switch (s->stepping) {
    case DOMAIN_RK4: finish_rk4(p, k, s->dt, s->needs_velocity, begin, end); break;
    case DOMAIN_VERLET: finish_verlet(p, s->dt, last, begin, end); break;
    case DOMAIN_EULER: finish_euler(p, s->dt, last, begin, end); break;
  }
  p->done[k] = end;
  if (!last) add_loads(p, k + 1, end);
}

static void finish_to(const strut_domain_steps *s, domain_part *p, int k, int passes, int side,
                      int32_t end) {
  assert(k >= 0 && k < passes && passes <= STRUT_PASSES);
  if (end <= p->done[k]) return;
  act_to(s, p, k, side, end);
  move_to(s, p, k, k + 1 == passes, end);
}

STRUT_CLONES
static void work_on_members(const strut_subdomain *d, const double *q, const double *v,
                            double *force, int32_t block, bool balance,
                            four_member_powers *powers) {
  const strut_member_table t = d->model.members;
  if (balance)
    members_of_block(&t, &d->state, q, v, force, block, true, powers);
  else
    members_of_block(&t, &d->state, q, v, force, block, false, powers);
}

static void drive_block(domain_part *p, int k, int32_t block) {
  assert(k >= 0 && k < STRUT_PASSES && block >= 0);
  strut_subdomain *d = &p->domain;
  const strut_drive_table *t = &d->model.drives;
  int32_t end = (block + 1) * STRUT_BLOCK;
  for (; p->drive[k] < t->count && t->member[d->drive_order[p->drive[k]]] < end; p->drive[k]++) {
    int32_t i = d->drive_order[p->drive[k]];
    d->state.latest.rest[t->member[i]] = p->rest[k * t->count + i];
    d->state.latest.rest_rate[t->member[i]] = p->rest_rate[k * t->count + i];
  }
}

/* A block of members at pass k. */
static void add_block(const strut_domain_steps *s, domain_part *p, int k, int side, int32_t block) {
  assert(k >= 0 && k < STRUT_PASSES && block >= 0);
  strut_subdomain *d = &p->domain;
  bool counted = d->state.balance && block >= d->block_begin && block < d->block_end;
  if (d->model.drives.count) drive_block(p, k, block);
  work_on_members(d, p->q, p->v, p->force, block, counted, &p->power[k]);
  int32_t own = block + 1 - d->block_begin;
  if (counted && (own % STRUT_BALANCE_BLOCKS == 0 || block + 1 == d->block_end)) {
    int32_t to = d->balance_begin + (own - 1) / STRUT_BALANCE_BLOCKS;
    s->balance[side].member[k * s->balance_blocks + to] = p->power[k];
    p->power[k] = (four_member_powers){0};
  }
}

/* The next block of members at pass k, and the nodes that are done then. */
static void work_on_block(const strut_domain_steps *s, domain_part *p, int k, int passes,
                          int side) {
  int32_t block = p->block[k]++;
  if (k == 0) begin_to(s, p, p->domain.need[block]);
  add_block(s, p, k, side, block);
  finish_to(s, p, k, passes, side, p->domain.ready[block]);
}

static void begin_sweep(domain_part *p) {
  p->begun = 0;
  for (int k = 0; k < STRUT_PASSES; k++) {
    p->done[k] = p->block[k] = p->contact[k] = p->loaded[k] = p->paid[k] = p->drive[k] = 0;
    p->power[k] = (four_member_powers){0};
  }
}

/* As many passes as there are steps left, at most STRUT_PASSES: each runs behind the one before. */
void strut_domain_sweep(const strut_domain_steps *s, domain_part *p, int passes, int side) {
  const strut_subdomain *d = &p->domain;
  int32_t blocks = d->model.members.blocks;
  begin_sweep(p);
  for (int32_t b = 0; b < blocks; b++) {
    work_on_block(s, p, 0, passes, side);
    for (int k = 1; k < passes; k++)
      while (p->block[k] < blocks && d->need[p->block[k]] <= p->done[k - 1])
        work_on_block(s, p, k, passes, side);
  }
}

/* Forces on own nodes to all, and accelerations of all to this subdomain. */
static void solve_for_accelerations(const strut_domain_steps *s, domain_part *p, int thread) {
  const strut_subdomain *d = &p->domain;
  for (int32_t i = d->own_begin; i < d->own_end; i++)
    strut_pair_store(s->sum + 2 * d->node[i], strut_pair_load(p->force + 2 * i));
  strut_thread_pool_meet(s->pool);
  strut_mass_shares_solve(s->mass, s->pool, thread, s->sum, s->shared);
  strut_thread_pool_meet(s->pool);
  for (int32_t i = 0; i < d->count; i++)
    strut_pair_store(p->force + 2 * i, strut_pair_load(s->shared + 2 * d->node[i]));
}

void strut_domain_coupled_sweep(const strut_domain_steps *s, domain_part *p, int thread, int passes,
                                int side) {
  const strut_subdomain *d = &p->domain;
  int32_t end = (d->count + 1) / 2 * 2;
  begin_sweep(p);
  begin_to(s, p, end);
  for (int k = 0; k < passes; k++) {
    for (int32_t b = 0; b < d->model.members.blocks; b++) add_block(s, p, k, side, b);
    act_to(s, p, k, side, end);
    solve_for_accelerations(s, p, thread);
    move_to(s, p, k, k + 1 == passes, end);
  }
}

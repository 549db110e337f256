/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/domain_parts.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/base/subnormals.h"
#include "engine/forces/drives.h"
#include "engine/forces/forces.h"
#include "engine/forces/step_balance.h"
#include "engine/model/mass.h"

static const unsigned POSSIBLE = STRUT_TERM_MEMBERS | STRUT_TERM_DAMPING | STRUT_TERM_SLACK |
                                 STRUT_TERM_DRIVE | STRUT_TERM_CONSTANT | STRUT_TERM_LOADS |
                                 STRUT_TERM_CONTACT | STRUT_TERM_FRICTION | STRUT_TERM_SLOPE |
                                 STRUT_TERM_LAWS | STRUT_TERM_DIRECTION | STRUT_TERM_SOLVE;

/* Beyond, fewer threads are as fast. */
static const double MOST_OVERLAP = 1.25;

static const char *const names[] = {
    [DOMAIN_RK4] = "rk4", [DOMAIN_VERLET] = "verlet", [DOMAIN_EULER] = "euler"};

static bool find_stepping(const strut_integrator *method, domain_method *found) {
  for (int i = DOMAIN_RK4; i <= DOMAIN_EULER; i++)
    if (method == strut_integrator_find(names[i])) {
      *found = (domain_method)i;
      return true;
    }
  return false;
}

bool strut_domain_steps_possible(const strut_model *model, const strut_integrator *method) {
  const strut_feedback_table *f = &model->feedback;
  domain_method kind;
  if (!find_stepping(method, &kind) || f->sampled_count || f->trigger_count || f->relay_count)
    return false;
  return (model->terms & STRUT_TERM_MEMBERS) && !(model->terms & ~POSSIBLE) && model->mass;
}

/* ---- memory ---- */

static double *numbers(domain_part *p, size_t count) {
  double *block = strut_arena_allocate(&p->arena, count, sizeof *block);
  if (!block) p->good = false;
  return block;
}

/* Two numbers of each node. */
static double *copy_coordinates(domain_part *p, const double *from) {
  const strut_subdomain *d = &p->domain;
  double *to = numbers(p, (size_t)d->model.length);
  for (int32_t i = 0; i < d->count && to; i++)
    strut_pair_store(to + 2 * i, strut_pair_load(from + 2 * d->node[i]));
  return to;
}

static double *ones(domain_part *p) {
  double *to = numbers(p, (size_t)p->domain.model.length);
  for (int32_t i = 0; i < 2 * p->domain.count && to; i++) to[i] = 1.0;
  return to;
}

static void make_arrays(const strut_domain_steps *s, domain_part *p) {
  const strut_model *model = s->model;
  size_t n = (size_t)p->domain.model.length;
  p->q = numbers(p, n), p->v = numbers(p, n), p->force = numbers(p, n);
  if (s->mass)
    p->inverse = ones(p); /* forces are replaced by accelerations */
  else
    p->inverse = copy_coordinates(p, model->mass->inverse);
  if (model->terms & STRUT_TERM_CONSTANT) p->base = copy_coordinates(p, model->constant_force);
  p->position = p->q, p->velocity = p->v;
  if (s->stepping != DOMAIN_EULER) p->velocity = p->v0 = numbers(p, n);
  if (s->stepping != DOMAIN_EULER) p->a[0] = numbers(p, n);
  if (s->stepping == DOMAIN_VERLET) p->acceleration = p->a[0];
  if (s->stepping == DOMAIN_RK4) p->position = p->q0 = numbers(p, n);
  if (s->stepping == DOMAIN_RK4) p->a[1] = numbers(p, n), p->a[2] = numbers(p, n);
  p->load = numbers(p, 2 * STRUT_PASSES * (size_t)p->domain.model.loads.count);
  p->rest = numbers(p, STRUT_PASSES * (size_t)p->domain.model.drives.count);
  p->rest_rate = numbers(p, STRUT_PASSES * (size_t)p->domain.model.drives.count);
  p->domain.state.latest.force = p->force;
}

/* By the thread that works on it, so that its memory is near. */
static void create_part(void *context, int thread) {
  assert(thread >= 0);
  strut_domain_steps *s = context;
  domain_part *p = s->part[thread];
  p->good = strut_subdomain_create(&s->division, thread, &p->arena, &p->domain);
  if (p->good) make_arrays(s, p);
}

static void connect_part(void *context, int thread) {
  strut_domain_steps *s = context;
  domain_part *p = s->part[thread];
  p->good = strut_subdomain_connect(&s->division, &p->arena, &p->domain);
}

static bool parts_are_good(const strut_domain_steps *s) {
  for (int i = 0; i < s->division.parts; i++)
    if (!s->part[i]->good) return false;
  return true;
}

static bool make_balance(strut_domain_steps *s, domain_balance *l) {
  const strut_model *model = s->model;
  size_t blocks = ((size_t)model->contacts.count + DOMAIN_CONTACT_BLOCK - 1) / DOMAIN_CONTACT_BLOCK;
  s->balance_blocks = (model->members.blocks + STRUT_BALANCE_BLOCKS - 1) / STRUT_BALANCE_BLOCKS;
  l->member =
      strut_arena_allocate(&s->arena, STRUT_PASSES * (size_t)s->balance_blocks, sizeof *l->member);
  l->contact = strut_arena_allocate(
      &s->arena, DOMAIN_CONTACT_POWERS * STRUT_PASSES * (size_t)model->contacts.count,
      sizeof *l->contact);
  l->load =
      strut_arena_allocate(&s->arena, STRUT_PASSES * (size_t)model->loads.count, sizeof *l->load);
  l->touched = strut_arena_allocate(&s->arena, STRUT_PASSES * blocks, sizeof *l->touched);
  return l->member && l->contact && l->load && l->touched;
}

/* Members that all subdomains work on, over those that there are. */
static double overlap(const strut_domain_steps *s) {
  double sum = 0.0;
  for (int i = 0; i < s->division.parts; i++) sum += s->part[i]->domain.model.members.count;
  return sum / s->model->members.slots;
}

static void free_parts(strut_domain_steps *s) {
  strut_mass_shares_free(s->mass);
  s->mass = NULL;
  for (int i = 0; i < s->division.parts && s->part; i++)
    if (s->part[i]) strut_arena_free(&s->part[i]->arena);
  strut_thread_pool_free(s->pool);
  s->pool = NULL;
}

/* A subdomain for each thread that there is. False: out of memory. */
static bool make_parts(strut_domain_steps *s, const int32_t *member, int threads) {
  s->pool = strut_thread_pool_create(threads);
  threads = strut_thread_pool_size(s->pool);
  bool coupled = !s->model->mass->diagonal;
  int depth = coupled ? 1 : STRUT_PASSES;
  if (!strut_subdivision_create(s->model, member, threads, depth, &s->arena, &s->division))
    return false;
  s->part = strut_arena_allocate(&s->arena, (size_t)threads, sizeof(domain_part *));
  for (int i = 0; i < threads && s->part; i++) /* vectors in it want an arena's alignment */
    if (!(s->part[i] = strut_arena_allocate(&s->arena, 1, sizeof(domain_part)))) return false;
  if (!s->part) return false;
  if (threads > 1 && strut_subdivision_overlap(&s->division) > MOST_OVERLAP) return true;
  if (coupled && !(s->mass = strut_mass_shares_create(s->model, threads))) return false;
  strut_thread_pool_run(s->pool, create_part, s);
  return parts_are_good(s);
}

/* As many as do not work on the same members too often. */
static bool make_fitting_parts(strut_domain_steps *s, const int32_t *member, int threads) {
  for (;; free_parts(s), threads /= 2) {
    if (!make_parts(s, member, threads)) return false;
    threads = s->division.parts;
    if (threads == 1) return true;
    if (s->part[0]->good && overlap(s) <= MOST_OVERLAP) return true;
  }
}

static bool make_all(strut_domain_steps *s, const int32_t *member, int threads) {
  if (!make_fitting_parts(s, member, threads)) return false;
  threads = s->division.parts;
  strut_subdomain **domain = strut_arena_allocate(&s->arena, (size_t)threads, sizeof *domain);
  for (int i = 0; i < threads && domain; i++) domain[i] = &s->part[i]->domain;
  if (!domain) return false;
  strut_subdivision_share(&s->division, domain);
  strut_thread_pool_run(s->pool, connect_part, s);
  if (!parts_are_good(s)) return false;
  for (int i = 0; i < DOMAIN_SIDES; i++) {
    size_t shared = DOMAIN_EXCHANGED * (size_t)s->division.shared_count;
    s->exchange[i] = strut_arena_allocate(&s->arena, shared, sizeof(double));
    if (!s->exchange[i] || !make_balance(s, &s->balance[i])) return false;
  }
  if (s->mass) {
    s->sum = strut_arena_allocate(&s->arena, (size_t)s->model->length, sizeof(double));
    s->shared = strut_arena_allocate(&s->arena, (size_t)s->model->length, sizeof(double));
    if (!s->sum || !s->shared) return false;
  }
  if (s->stepping != DOMAIN_VERLET) return true;
  s->acceleration = strut_arena_allocate(&s->arena, (size_t)s->model->length, sizeof(double));
  return s->acceleration;
}

strut_domain_steps *strut_domain_steps_create(const strut_model *model,
                                              const strut_integrator *method, const int32_t *member,
                                              int threads) {
  strut_domain_steps *s = strut_allocate(1, sizeof *s);
  if (!s) return NULL;
  s->model = model;
  find_stepping(method, &s->stepping);
  s->needs_velocity = model->terms & (STRUT_TERM_DAMPING | STRUT_TERM_DRIVE | STRUT_TERM_LOADS |
                                      STRUT_TERM_CONTACT);
  if (make_all(s, member, threads)) return s;
  strut_domain_steps_free(s);
  return NULL;
}

void strut_domain_steps_free(strut_domain_steps *s) {
  if (!s) return;
  free_parts(s);
  strut_arena_free(&s->arena);
  strut_release(s);
}

/* ---- between sweeps ---- */

static double time_of_pass(const strut_domain_steps *s, int64_t n, int k) {
  static const double ahead[STRUT_PASSES] = {0.0, 0.5, 0.5, 1.0};
  switch (s->stepping) {
    case DOMAIN_RK4: return ((double)n + ahead[k]) * s->dt;
    case DOMAIN_VERLET: return ((double)(n + k) + 1.0) * s->dt;
    case DOMAIN_EULER: break;
  }
  return (double)(n + k) * s->dt;
}

/* What follows from time alone, for all passes. */
static void evaluate_signals(const strut_domain_steps *s, domain_part *p, int64_t n, int passes) {
  strut_subdomain *d = &p->domain;
  const strut_signal *signals = s->model->scene->signals;
  const strut_drive_table *drives = &d->model.drives;
  const strut_load_table *l = &d->model.loads;
  for (int k = 0; k < passes && (drives->count || l->count); k++) {
    double t = time_of_pass(s, n, k), rate, factor;
    if (drives->count && t != d->state.latest.drive_time)
      strut_drive_apply(&d->model, &d->state, t);
    for (int32_t i = 0; i < drives->count; i++) {
      p->rest[k * drives->count + i] = d->state.latest.rest[drives->member[i]];
      p->rest_rate[k * drives->count + i] = d->state.latest.rest_rate[drives->member[i]];
    }
    for (int32_t i = 0; i < l->count; i++) {
      double *load = p->load + 2 * (k * l->count + i);
      strut_signal_evaluate(signals, l->signal[i], t + d->state.time_offset, &factor, &rate);
      load[0] = factor * l->x[i], load[1] = factor * l->y[i];
    }
  }
  d->state.latest.drive_time =
      (double)NAN; /* blocks of members set the rest lengths of their own pass */
}

static void publish(const strut_domain_steps *s, const domain_part *p, int side) {
  assert(side == 0 || side == 1);
  for (int32_t i = 0; i < p->domain.published_count; i++) {
    int32_t at = 2 * p->domain.published[i];
    double *to = s->exchange[side] + DOMAIN_EXCHANGED * s->division.shared[p->domain.node[at / 2]];
    strut_pair_store(to, strut_pair_load(p->position + at));
    strut_pair_store(to + 2, strut_pair_load(p->velocity + at));
    if (p->acceleration) strut_pair_store(to + 4, strut_pair_load(p->acceleration + at));
  }
}

static void take_ghosts(const strut_domain_steps *s, const domain_part *p, int side) {
  assert(side == 0 || side == 1);
  for (int32_t i = 0; i < p->domain.ghost_count; i++) {
    int32_t at = 2 * p->domain.ghost[i];
    const double *from =
        s->exchange[side] + DOMAIN_EXCHANGED * s->division.shared[p->domain.node[at / 2]];
    strut_pair_store(p->position + at, strut_pair_load(from));
    strut_pair_store(p->velocity + at, strut_pair_load(from + 2));
    if (p->acceleration) strut_pair_store(p->acceleration + at, strut_pair_load(from + 4));
  }
}

static void load_motion(const strut_domain_steps *s, const domain_part *p) {
  const strut_subdomain *d = &p->domain;
  const strut_state *state = s->state;
  for (int32_t i = 0; i < d->count; i++) {
    int32_t from = 2 * d->node[i], at = 2 * i;
    strut_pair_store(p->position + at, strut_pair_load(state->q + from));
    strut_pair_store(p->velocity + at, strut_pair_load(state->v + from));
    if (p->acceleration)
      strut_pair_store(p->acceleration + at, strut_pair_load(s->acceleration + from));
  }
}

/* What others may have changed without a restart. */
static void load_rest(const strut_domain_steps *s, domain_part *p) {
  strut_subdomain *d = &p->domain;
  const strut_state *state = s->state;
  for (int32_t i = 0; i < d->model.contacts.count; i++) {
    d->state.latest.normal[i] = state->latest.normal[d->contact[i]];
    d->state.latest.friction[i] = state->latest.friction[d->contact[i]];
  }
  d->state.balance = state->balance;
  d->state.time_offset = state->time_offset;
  d->state.latest.drive_time = (double)NAN;
}

/* Own nodes, and what contacts leave. */
static void store_state(const strut_domain_steps *s, const domain_part *p) {
  const strut_subdomain *d = &p->domain;
  strut_state *state = s->state;
  for (int32_t i = d->own_begin; i < d->own_end; i++) {
    int32_t to = 2 * d->node[i], at = 2 * i;
    strut_pair_store(state->q + to, strut_pair_load(p->position + at));
    strut_pair_store(state->v + to, strut_pair_load(p->velocity + at));
  }
  for (int32_t i = 0; i < d->model.contacts.count; i++) {
    int32_t node = d->model.contacts.entry[i].node;
    if (!domain_part_owns(d, node)) continue;
    state->latest.normal[d->contact[i]] = d->state.latest.normal[i];
    state->latest.friction[d->contact[i]] = d->state.latest.friction[i];
    const double *force = s->mass ? s->sum + 2 * d->node[node] : p->force + 2 * node;
    strut_pair_store(state->latest.force + 2 * d->node[node], strut_pair_load(force));
  }
}

/* ---- balance ---- */

/* Of all blocks of the energy balance, in their order. */
static four_member_powers sum_member_powers(const strut_domain_steps *s,
                                            const four_member_powers *block) {
  four_member_powers sum = {0};
  for (int32_t b = 0; b < s->balance_blocks; b++) members_add_powers(&sum, &block[b]);
  return sum;
}

/* The sums that forces_of_members makes, in its order. */
static void add_member_powers(const strut_domain_steps *s, const four_member_powers *block,
                              double *power) {
  four_member_powers sum = sum_member_powers(s, block);
  double drive = 0.0, lost = 0.0, exchanged = power[STRUT_POWER_EXCHANGED];
  for (int l = 0; l < STRUT_LANES; l++) {
    drive += sum.drive[l];
    lost += sum.lost[l];
    exchanged += sum.exchanged[l] + sum.lost[l];
  }
  power[STRUT_POWER_DRIVE] = drive, power[STRUT_POWER_MEMBERS] = lost;
  power[STRUT_POWER_EXCHANGED] = exchanged;
}

static void add_contact_to_powers(strut_state *state, const double *of) {
  static const int which[DOMAIN_CONTACT_POWERS] = {STRUT_POWER_CONTACT, STRUT_POWER_FRICTION,
                                                   STRUT_POWER_BELT, STRUT_POWER_EXCHANGED};
  for (int w = 0; w < DOMAIN_CONTACT_POWERS; w++) state->latest.power[which[w]] += of[w];
}

/* As ground_accumulate_lanes does. */
static void add_contact_to_lanes(strut_power_lanes *to, int32_t lane, bool moves,
                                 const double *of) {
  to->minus_damped[lane] -= of[0], to->minus_rubbed[lane] -= of[1];
  if (moves) to->belt[lane] += of[2];
  to->turnover[lane] += moves ? fabs(of[1]) + fabs(of[2]) : fabs(of[1]);
}

/* Those of ground_kernel; what was noted is cleared for the sweep after next. */
static void add_contact_powers(const strut_domain_steps *s, int side, int k) {
  bool moves = s->model->contacts.belt_speed != 0.0;
  int32_t all = s->model->contacts.count,
          blocks = (all + DOMAIN_CONTACT_BLOCK - 1) / DOMAIN_CONTACT_BLOCK;
  for (int32_t b = 0; b < blocks; b++) {
    atomic_uchar *touched = &s->balance[side].touched[k * blocks + b];
    if (!atomic_load_explicit(touched, memory_order_relaxed)) continue;
    atomic_store_explicit(touched, 0, memory_order_relaxed);
    int32_t end = (b + 1) * DOMAIN_CONTACT_BLOCK < all ? (b + 1) * DOMAIN_CONTACT_BLOCK : all;
    for (int32_t i = b * DOMAIN_CONTACT_BLOCK; i < end; i++) {
      double *of =
          s->balance[side].contact + DOMAIN_CONTACT_POWERS * ((size_t)k * (size_t)all + (size_t)i);
      if (s->stepping == DOMAIN_RK4)
        add_contact_to_lanes(&s->state->latest.lanes[strut_weight_side(k)],
                             s->model->contacts.entry[i].lane, moves, of);
      else
        add_contact_to_powers(s->state, of);
      memset(of, 0, DOMAIN_CONTACT_POWERS * sizeof *of);
    }
  }
}

static void add_works(strut_domain_steps *s, int k) {
  static const double weight[STRUT_PASSES] = {1, 2, 2, 1};
  strut_state *state = s->state;
  for (int p = 0; p < STRUT_POWER_COUNT; p++) switch (s->stepping) {
      case DOMAIN_RK4: state->work[p] += weight[k] * (s->dt / 6.0) * state->latest.power[p]; break;
      case DOMAIN_VERLET:
        state->work[p] += 0.5 * s->dt * (s->kept[p] + state->latest.power[p]);
        s->kept[p] = state->latest.power[p];
        break;
      case DOMAIN_EULER: state->work[p] += s->dt * state->latest.power[p]; break;
    }
}

static void keep_balance(strut_domain_steps *s, int passes, int side) {
  assert((side == 0 || side == 1) && passes > 0);
  strut_state *state = s->state;
  bool lanes = s->stepping == DOMAIN_RK4;
  const domain_balance *l = &s->balance[side];
  int32_t loads = s->model->loads.count;
  if (lanes) strut_step_balance_begin(s->model, state);
  for (int k = 0; k < passes; k++) {
    double *power = state->latest.power;
    const four_member_powers *members = l->member + k * s->balance_blocks;
    for (int p = 0; p < STRUT_POWER_COUNT; p++) power[p] = 0.0;
    for (int32_t i = 0; i < loads; i++) {
      power[STRUT_POWER_LOAD] += l->load[k * loads + i];
      power[STRUT_POWER_EXCHANGED] += fabs(l->load[k * loads + i]);
    }
    if (lanes) {
      four_member_powers sum = sum_member_powers(s, members);
      strut_accumulate_members(&state->latest.lanes[strut_weight_side(k)], &sum);
    } else {
      add_member_powers(s, members, power);
    }
    add_contact_powers(s, side, k);
    if (!lanes || loads) add_works(s, k);
  }
  if (lanes) strut_step_balance_end(s->model, state, s->dt / 6.0);
}

/* ---- steps ---- */

static void work(void *context, int thread) {
  strut_domain_steps *s = context;
  domain_part *p = s->part[thread];
  int64_t n = s->state->step, end = n + s->count;
  int side = s->side;
  bool loaded = s->loaded;
  unsigned before = strut_subnormals_mode();
  strut_subnormals_restore(s->subnormals);
  load_rest(s, p);
  if (!loaded) load_motion(s, p);
  for (; n < end; loaded = true) {
    int64_t steps = s->stepping == DOMAIN_RK4 ? 1 : end - n < STRUT_PASSES ? end - n : STRUT_PASSES;
    int passes = s->stepping == DOMAIN_RK4 ? STRUT_PASSES : (int)steps;
    if (loaded) take_ghosts(s, p, side);
    side = !side;
    evaluate_signals(s, p, n, passes);
    if (s->mass)
      strut_domain_coupled_sweep(s, p, thread, passes, side);
    else
      strut_domain_sweep(s, p, passes, side);
    publish(s, p, side);
    strut_thread_pool_meet(s->pool);
    n += steps;
    if (thread != 0) continue;
    if (s->state->balance) keep_balance(s, passes, side);
    s->state->evaluations += passes;
    s->state->step = n;
    s->side = side;
    s->loaded = true;
  }
  store_state(s, p);
  strut_subnormals_restore(before);
}

void strut_domain_steps_restart(strut_domain_steps *s, strut_state *state, double dt) {
  s->started = true;
  s->loaded = false;
  if (s->stepping != DOMAIN_VERLET) return;
  strut_forces_acceleration(s->model, state, (double)state->step * dt, state->q, state->v,
                            s->acceleration);
  memcpy(s->kept, state->latest.power, sizeof s->kept);
}

void strut_domain_steps_advance(strut_domain_steps *s, strut_state *state, double dt,
                                int64_t count) {
  if (!s->started) strut_domain_steps_restart(s, state, dt);
  s->state = state, s->dt = dt, s->count = count;
  s->subnormals = strut_subnormals_mode();
  strut_thread_pool_run(s->pool, work, s);
}

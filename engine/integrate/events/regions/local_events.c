/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/events/regions/local_events.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/integrate/events/event_kernel.h"
#include "engine/integrate/events/regions/local_kernel.h"
#include "engine/model/dense_cholesky.h"

/* Regions with more contacts are not stepped alone. */
enum { MOST_CONTACTS = 512 };
/* So many stuck contacts keep their columns of M^-1. */
enum { FEW_STUCK = 12 };
/* Answers of contacts to each other below this part of their own are rounding. */
static const double NEGLIGIBLE = 1e-18;
/* What is left of an event where its region ends, and at most so much of the tolerance of error control. */
static const double LEFT = 1e-8, OF_TOLERANCE = 1e-2;
/* Regions that turn out to overlap are joined so often; pieces of a step of one region. */
enum { MOST_ATTEMPTS = 8, MOST_PIECES = 20000 };

/* ---- memory ---- */

static bool make_members(const strut_model *model, strut_arena *arena, strut_local_events *p) {
  const strut_member_table *t = &model->members;
  size_t slots = (size_t)t->slots + STRUT_LANES;
  p->members.from = strut_arena_allocate(arena, slots, sizeof *p->members.from);
  p->members.to = strut_arena_allocate(arena, slots, sizeof *p->members.to);
  double **all[] = {&p->members.stiffness,
                    &p->members.damping,
                    &p->members.rest,
                    &p->shell.latest.rest_rate,
                    &p->shell.modes.slack_length_threshold,
                    &p->shell.modes.slack_force_threshold};
  bool good = p->members.from && p->members.to;
  for (size_t k = 0; k < sizeof all / sizeof *all && good; k++)
    good = (*all[k] = strut_arena_allocate(arena, slots, sizeof(double)));
  p->shell.latest.rest = p->members.rest;
  p->members.table = (strut_member_table){.from = p->members.from,
                                          .to = p->members.to,
                                          .stiffness = p->members.stiffness,
                                          .damping = p->members.damping,
                                          .rest = p->members.rest};
  return good;
}

static bool make_laws(const strut_model *model, strut_arena *arena, const strut_event_stepper *l,
                      strut_local_events *p) {
  size_t members = (size_t)model->members.count, laws = (size_t)l->law_count;
  p->members.law_of = strut_arena_allocate(arena, members, sizeof *p->members.law_of);
  p->members.law = strut_arena_allocate(arena, laws, sizeof *p->members.law);
  p->before.acting = strut_arena_allocate(arena, laws, 1);
  if (!p->members.law_of || !p->members.law || !p->before.acting) return false;
  for (size_t j = 0; j < members; j++) p->members.law_of[j] = -1;
  for (int32_t k = 0; k < l->law_count; k++) p->members.law_of[l->laws[k].member] = k;
  return true;
}

static bool make_scratch(const strut_model *model, strut_arena *arena, strut_local_events *p) {
  size_t contacts = (size_t)model->contacts.count, nodes = (size_t)model->node_count;
  double **all[] = {&p->motion.quiet_q, &p->motion.quiet_v, &p->motion.more_q, &p->motion.more_v,
                    &p->motion.own_q,   &p->motion.own_v,   &p->motion.push_q, &p->motion.push_v,
                    &p->motion.far_q,   &p->motion.far_v};
  uint8_t **marks[] = {&p->nodes.seed, &p->nodes.joined, &p->nodes.regions, &p->nodes.inside};
  bool good = true;
  for (size_t k = 0; k < sizeof all / sizeof *all && good; k++)
    good = (*all[k] = strut_arena_allocate(arena, (size_t)model->length, sizeof(double)));
  for (size_t k = 0; k < sizeof marks / sizeof *marks && good; k++)
    good = (*marks[k] = strut_arena_allocate(arena, nodes, 1));
  p->nodes.written = strut_arena_allocate(arena, nodes, sizeof *p->nodes.written);
  p->nodes.seeds = strut_arena_allocate(arena, nodes, sizeof *p->nodes.seeds);
  p->nodes.changed = strut_arena_allocate(arena, nodes, sizeof *p->nodes.changed);
  p->before.mode = strut_arena_allocate(arena, contacts, 1);
  p->before.side = strut_arena_allocate(arena, contacts, 1);
  p->before.damper = strut_arena_allocate(arena, contacts, 1);
  return good && p->nodes.written && p->nodes.seeds && p->nodes.changed && p->before.mode &&
         p->before.side && p->before.damper;
}

/* The stepper of regions: it shares modes with that of the whole structure. */
static bool make_stepper(const strut_model *model, strut_arena *arena, const strut_event_stepper *l,
                         strut_local_events *p) {
  strut_event_stepper *own = &p->own;
  size_t contacts = (size_t)model->contacts.count, room = contacts;
  if (room > MOST_CONTACTS) room = MOST_CONTACTS;
  *own = *l;
  memset(own->end, 0, sizeof own->end);
  own->now = &own->end[0], own->next = &own->end[1];
  p->formula = *l->stepper;
  p->formula.trial = strut_local_trial;
  own->stepper = &p->formula;
  own->coupling = NULL;
  own->small = NULL;
  own->local = NULL;
  own->within = p;
  own->contact_list = p->region.contact;
  own->law_list = p->members.law;
  own->stuck_room = (int32_t)room;
  own->closed = strut_arena_allocate(arena, contacts, sizeof *own->closed);
  own->stuck = strut_arena_allocate(arena, contacts, sizeof *own->stuck);
  own->stuck_factor = strut_arena_allocate(arena, room * room, sizeof(double));
  own->stuck_work = strut_arena_allocate(arena, contacts, sizeof(double));
  p->answers.of = strut_arena_allocate(arena, room * room, sizeof *p->answers.of);
  p->answers.columns =
      strut_arena_allocate(arena, FEW_STUCK * (size_t)model->length, sizeof *p->answers.columns);
  p->answers.known = strut_arena_allocate(arena, room, 1);
  p->answers.place = strut_arena_allocate(arena, contacts, sizeof *p->answers.place);
  p->answers.first = strut_arena_allocate(arena, room, sizeof *p->answers.first);
  p->answers.factored = strut_arena_allocate(arena, contacts, sizeof *p->answers.factored);
  own->body_seen = strut_arena_allocate(arena, contacts, sizeof *own->body_seen);
  own->sliding = strut_arena_allocate(arena, contacts, sizeof *own->sliding);
  return own->closed && own->stuck && own->stuck_factor && own->stuck_work && own->body_seen &&
         own->sliding && p->answers.of && p->answers.columns && p->answers.known &&
         p->answers.place && p->answers.first && p->answers.factored &&
         strut_switch_counts_create(model, arena, own) &&
         strut_step_end_create(model, arena, own->now, false) &&
         strut_step_end_create(model, arena, own->next, false);
}

static bool is_possible(const strut_model *model, const strut_event_stepper *l) {
  if (!l->stepper->tableau || !strut_local_region_possible(model)) return false;
  for (int32_t k = 0; k < l->law_count; k++)
    if (l->laws[k].member < 0) return false;
  return true;
}

strut_status strut_local_events_create(const strut_model *model, strut_state *state,
                                       const strut_integrator_settings *settings,
                                       strut_event_stepper *l) {
  int32_t from = settings->local_from ? settings->local_from : STRUT_LOCAL_FROM;
  strut_arena *arena = &state->arena;
  if (model->node_count < from || !is_possible(model, l)) return STRUT_OK;
  strut_local_events *p = strut_arena_allocate(arena, 1, sizeof *p);
  if (!p || strut_local_region_map_create(model, arena, &p->map) ||
      strut_local_region_create(model, &p->map, arena, &p->region) ||
      !make_members(model, arena, p) || !make_laws(model, arena, l, p) ||
      !make_scratch(model, arena, p) || !make_stepper(model, arena, l, p))
    return STRUT_NO_MEMORY;
  double left = LEFT;
  if (l->stepper->adaptive) left = fmin(left, OF_TOLERANCE * settings->tolerance);
  strut_local_passing passing;
  if (strut_local_passing_find(model, &p->map, &passing)) return STRUT_NO_MEMORY;
  p->longest = settings->step;
  for (int k = 0; k < STRUT_LOCAL_HALVINGS; k++)
    p->reach[k] = strut_local_reach(&passing, ldexp(p->longest, -k), left);
  if (!p->reach[STRUT_LOCAL_HALVINGS - 1]) return STRUT_OK;
  l->local = p;
  return STRUT_OK;
}

/* ---- stuck contacts of a region ---- */

static void push_along(const strut_contact_table *c, const strut_local_region *r, int32_t contact,
                       double force) {
  int32_t slot = r->slot[c->at[contact] / 2] - 1;
  r->pair[2 * slot] += force * c->tangent[0];
  r->pair[2 * slot + 1] += force * c->tangent[1];
}

static void clear_pair(const strut_local_region *r) {
  memset(r->pair, 0, 2 * (size_t)r->node_count * sizeof *r->pair);
}

/* Accelerations along the ground of the region's contacts under a unit force on contact i, once for each. */
static const double *find_answers(const strut_model *model, strut_local_events *p, int32_t i) {
  assert(i >= 0 && i < model->contacts.count);
  const strut_local_region *r = &p->region;
  const strut_contact_table *c = &model->contacts;
  int32_t n = r->contact_count;
  double *row = p->answers.of + (size_t)p->answers.place[i] * (size_t)n;
  if (p->answers.known[p->answers.place[i]]) return row;
  p->answers.known[p->answers.place[i]] = 1;
  clear_pair(r);
  push_along(c, r, i, 1.0);
  strut_local_region_solve(model, r);
  for (int32_t k = 0; k < n; k++) {
    int32_t slot = r->slot[c->at[r->contact[k]] / 2] - 1;
    row[k] = r->pair[2 * slot] * c->tangent[0] + r->pair[2 * slot + 1] * c->tangent[1];
  }
  return row;
}

/* T' M^-1 T of the stuck contacts, each row from its first entry that matters. */
static void assemble_stuck(const strut_model *model, const strut_event_stepper *l,
                           strut_local_events *p) {
  int32_t n = l->stuck_count;
  for (int32_t i = 0; i < n; i++) {
    const double *answers = find_answers(model, p, l->stuck[i]);
    double *row = l->stuck_factor + (size_t)i * (size_t)n;
    double least = NEGLIGIBLE * answers[p->answers.place[l->stuck[i]]];
    for (int32_t j = 0; j <= i; j++) row[j] = answers[p->answers.place[l->stuck[j]]];
    p->answers.first[i] = 0;
    while (p->answers.first[i] < i && fabs(row[p->answers.first[i]]) <= least)
      p->answers.first[i]++;
  }
}

static void find_column(const strut_model *model, const strut_event_stepper *l, int32_t k) {
  const strut_local_events *p = l->within;
  const strut_local_region *r = &p->region;
  size_t nodes = 2 * (size_t)r->node_count;
  clear_pair(r);
  push_along(&model->contacts, r, l->stuck[k], 1.0);
  strut_local_region_solve(model, r);
  memcpy(p->answers.columns + (size_t)k * nodes, r->pair, nodes * sizeof *r->pair);
}

void strut_local_factor(const strut_model *model, strut_event_stepper *l) {
  strut_local_events *p = l->within;
  int32_t n = l->stuck_count;
  size_t bytes = (size_t)n * sizeof *p->answers.factored;
  if (n == p->answers.factored_count && memcmp(p->answers.factored, l->stuck, bytes) == 0) return;
  p->failed = p->failed || n > l->stuck_room;
  if (p->failed) return;
  assemble_stuck(model, l, p);
  if (!strut_cholesky_factor(n, p->answers.first, l->stuck_factor)) p->failed = true;
  for (int32_t k = 0; k < n && n <= FEW_STUCK; k++) find_column(model, l, k);
  memcpy(p->answers.factored, l->stuck, bytes);
  p->answers.factored_count = n;
}

/* a += M^-1 T x by the columns of M^-1 T. */
static void add_columns(const strut_local_events *p, int32_t n, const double *x, double *a) {
  const strut_local_region *r = &p->region;
  size_t nodes = 2 * (size_t)r->node_count;
  for (int32_t k = 0; k < r->node_count; k++) {
    double ax = 0.0, ay = 0.0;
    for (int32_t i = 0; i < n; i++) {
      const double *column = p->answers.columns + (size_t)i * nodes + 2 * (size_t)k;
      ax += column[0] * x[i], ay += column[1] * x[i];
    }
    a[2 * r->node[k]] += ax;
    a[2 * r->node[k] + 1] += ay;
  }
}

/* The same by one solution with M. */
static void push_together(const strut_model *model, const strut_event_stepper *l, const double *x,
                          double *a) {
  const strut_local_region *r = &l->within->region;
  clear_pair(r);
  for (int32_t k = 0; k < l->stuck_count; k++) push_along(&model->contacts, r, l->stuck[k], x[k]);
  strut_local_region_solve(model, r);
  for (int32_t k = 0; k < r->node_count; k++) {
    a[2 * r->node[k]] += r->pair[2 * k];
    a[2 * r->node[k] + 1] += r->pair[2 * k + 1];
  }
}

void strut_local_hold(const strut_model *model, strut_event_stepper *l, double *a,
                      strut_step_end *end) {
  const strut_local_events *p = l->within;
  const strut_contact_table *c = &model->contacts;
  int32_t n = l->stuck_count;
  double *x = l->stuck_work;
  if (p->failed) return;
  for (int32_t i = 0; i < n; i++) x[i] = -strut_contact_along_ground(c, l->stuck[i], a);
  strut_cholesky_solve_rows(n, p->answers.first, l->stuck_factor, x);
  for (int32_t k = 0; k < n; k++) end->touch[l->stuck[k]].friction += x[k];
  if (n <= FEW_STUCK)
    add_columns(p, n, x, a);
  else
    push_together(model, l, x, a);
  for (int32_t k = 0; k < n; k++) { /* nothing of what rounding leaves, so that they do not creep */
    double rest = strut_contact_along_ground(c, l->stuck[k], a);
    a[c->at[l->stuck[k]]] -= rest * c->tangent[0];
    a[c->at[l->stuck[k]] + 1] -= rest * c->tangent[1];
  }
}

/* ---- one region over the step ---- */

static void copy_pairs(const int32_t *node, int32_t count, const double *from, double *to) {
  for (int32_t k = 0; k < count; k++) {
    to[2 * node[k]] = from[2 * node[k]];
    to[2 * node[k] + 1] = from[2 * node[k] + 1];
  }
}

static void list_items(const strut_model *model, strut_local_events *p) {
  const strut_local_region *r = &p->region;
  p->own.law_list_count = 0;
  for (int32_t k = 0; k < r->member_count; k++)
    if (p->members.law_of[r->member[k]] >= 0)
      p->members.law[p->own.law_list_count++] = p->members.law_of[r->member[k]];
  p->own.contact_list_count = r->contact_count;
  p->answers.factored_count = -1;
  p->failed = r->contact_count > p->own.stuck_room;
  for (int32_t k = 0; k < r->contact_count && !p->failed; k++)
    p->answers.place[r->contact[k]] = k, p->answers.known[k] = 0;
  strut_local_load_members(model, p);
}

/* The region's part of the beginning of the step. */
static void begin_region(const strut_model *model, strut_state *state, const strut_event_stepper *l,
                         strut_local_events *p, double t) {
  const strut_local_region *r = &p->region;
  strut_event_stepper *own = &p->own;
  own->fresh = false;
  own->at_once = own->switches = 0;
  own->pushed = -1;
  own->tried = false;
  own->h = 0.0, own->fastest = l->fastest, own->longest = l->longest;
  copy_pairs(r->node, r->node_count, l->now->q, own->now->q);
  copy_pairs(r->node, r->node_count, l->now->v, own->now->v);
  strut_local_place_halo(p, 0.0, own->now->q, own->now->v);
  strut_update_active_set(model, own);
  strut_evaluate_acceleration(model, state, own, t);
  copy_pairs(r->node, r->node_count, l->now->a, own->now->a);
  for (int32_t k = 0; k < r->contact_count; k++)
    own->now->touch[r->contact[k]] = l->now->touch[r->contact[k]];
  for (int32_t k = 0; k < own->law_list_count; k++) {
    int32_t i = own->law_list[k];
    own->now->tension[i] = l->now->tension[i];
    own->now->stretch[i] = l->now->stretch[i];
    own->now->stretch_rate[i] = l->now->stretch_rate[i];
  }
}

/* The step without events, by which the one with them is compared. */
static void step_quietly(const strut_model *model, strut_state *state, strut_local_events *p,
                         double t, double *gained) {
  const strut_local_region *r = &p->region;
  strut_event_stepper *own = &p->own;
  strut_local_trial(model, state, own, t, p->whole.span);
  copy_pairs(r->node, r->node_count, own->next->q, p->motion.quiet_q);
  copy_pairs(r->node, r->node_count, own->next->v, p->motion.quiet_v);
  memcpy(gained, own->gained, sizeof own->gained);
  own->tried = true;
  if (p->formula.adaptive) own->h = p->whole.span;
}

/* Piece by piece to the end of the step; false: it could not. */
static bool step_with_events(const strut_model *model, strut_state *state, strut_local_events *p,
                             double t, double dt) {
  strut_event_stepper *own = &p->own;
  double done = 0.0;
  for (int piece = 0; piece < MOST_PIECES && !state->trouble && !p->failed; piece++) {
    double rest = p->whole.span - done, h = rest;
    if (p->formula.adaptive && own->h < rest) h = own->h > 0.5 * rest ? 0.5 * rest : own->h;
    double gone = strut_event_stepper_piece(model, state, own, t + done, h, dt);
    if (gone == rest || rest - gone <= 1e-12 * dt) return true;
    done += gone;
  }
  return false;
}

/* By how much the region's end differs from that without events; and what its masses do to its halo. */
static void pass_on(const strut_local_region *r, const double *end, const double *quiet,
                    double *push) {
  for (int32_t k = 0; k < r->node_count && r->coupling_count; k++)
    for (int32_t c = 0; c < 2; c++)
      r->pair[2 * k + c] = end[2 * r->node[k] + c] - quiet[2 * r->node[k] + c];
  strut_local_region_pass_on(r, r->pair, push);
}

/* What the region adds to the step of the whole. */
static void keep_result(strut_local_events *p) {
  const strut_local_region *r = &p->region;
  pass_on(r, p->own.now->q, p->motion.quiet_q, p->motion.push_q);
  pass_on(r, p->own.now->v, p->motion.quiet_v, p->motion.push_v);
  const strut_step_end *end = p->own.now;
  for (int32_t k = 0; k < r->node_count; k++) {
    int32_t node = r->node[k];
    bool first = p->nodes.regions[node] == 0;
    if (first) p->nodes.written[p->nodes.written_count++] = node;
    if (p->nodes.regions[node] < 2) p->nodes.regions[node]++;
    p->nodes.inside[node] = !strut_local_region_is_far(r, node);
    for (int32_t i = 2 * node; i < 2 * node + 2; i++) {
      p->motion.more_q[i] =
          (first ? 0.0 : p->motion.more_q[i]) + (end->q[i] - p->motion.quiet_q[i]);
      p->motion.more_v[i] =
          (first ? 0.0 : p->motion.more_v[i]) + (end->v[i] - p->motion.quiet_v[i]);
      p->motion.own_q[i] = end->q[i], p->motion.own_v[i] = end->v[i];
    }
  }
}

/* Notes the nodes at which something changes its mode, where the region has not been grown from. */
static void note_changes(const strut_model *model, strut_local_events *p) {
  const strut_event_stepper *own = &p->own;
  const strut_local_region *r = &p->region;
  for (int32_t k = 0; k < r->contact_count; k++) {
    int32_t i = r->contact[k], node = (int32_t)(model->contacts.at[i] / 2);
    bool same = own->mode[i] == p->before.mode[i] && own->side[i] == p->before.side[i] &&
                own->damper[i] == p->before.damper[i];
    if (same || p->nodes.seed[node] || p->nodes.changed_count >= model->node_count) continue;
    p->nodes.changed[p->nodes.changed_count++] = node;
    p->far = p->far || strut_local_region_is_far(r, node);
  }
  for (int32_t k = 0; k < own->law_list_count; k++) {
    int32_t i = own->law_list[k], j = own->laws[i].member;
    if (own->acting[i] == p->before.acting[i]) continue;
    int32_t node = (int32_t)(model->members.from[j] / 2);
    if (r->slot[node] <= 0) node = (int32_t)(model->members.to[j] / 2);
    if (p->nodes.seed[node] || p->nodes.changed_count >= model->node_count) continue;
    p->nodes.changed[p->nodes.changed_count++] = node;
    p->far = p->far || strut_local_region_is_far(r, node);
  }
}

static bool step_region(const strut_model *model, strut_state *state, const strut_event_stepper *l,
                        strut_local_events *p, double t, double dt, double *works) {
  double before[STRUT_POWER_ROOM], quiet[STRUT_POWER_ROOM] = {0};
  memcpy(before, state->work, sizeof before);
  list_items(model, p);
  if (p->failed) return false;
  begin_region(model, state, l, p, t);
  step_quietly(model, state, p, t, quiet);
  bool good = step_with_events(model, state, p, t, dt);
  for (int k = 0; k < STRUT_POWER_COUNT && state->balance; k++)
    works[k] += state->work[k] - before[k] - quiet[k];
  memcpy(state->work, before, sizeof before);
  keep_result(p);
  note_changes(model, p);
  return good && !p->failed;
}

/* ---- all regions of a step ---- */

static void save_modes(const strut_model *model, const strut_event_stepper *l,
                       strut_local_events *p) {
  size_t contacts = (size_t)model->contacts.count;
  memcpy(p->before.mode, l->mode, contacts);
  memcpy(p->before.side, l->side, contacts);
  memcpy(p->before.damper, l->damper, contacts);
  if (l->law_count) memcpy(p->before.acting, l->acting, (size_t)l->law_count);
}

static void restore_modes(const strut_model *model, strut_state *state, strut_event_stepper *l,
                          const strut_local_events *p) {
  size_t contacts = (size_t)model->contacts.count;
  memcpy(l->mode, p->before.mode, contacts);
  memcpy(l->side, p->before.side, contacts);
  memcpy(l->damper, p->before.damper, contacts);
  for (int32_t k = 0; k < l->law_count; k++)
    if (l->acting[k] != p->before.acting[k])
      strut_cable_set_acting(state, l, k, p->before.acting[k]);
}

static void add_seed(strut_local_events *p, int32_t node) {
  if (p->nodes.seed[node] || !(p->map.diagonal[node] > 0.0)) return;
  p->nodes.seed[node] = 1;
  p->nodes.seeds[p->nodes.seed_count++] = node;
}

static void find_seeds(const strut_model *model, const strut_event_stepper *l, double h,
                       strut_local_events *p) {
  for (int32_t i = 0; i < model->contacts.count; i++)
    if (strut_event_of_contact(model, l, i, h).kind)
      add_seed(p, (int32_t)(model->contacts.at[i] / 2));
  for (int32_t k = 0; k < l->law_count; k++) {
    if (strut_event_value(model, l, l->next, l->laws[k].event, k) >= 0.0) continue;
    add_seed(p, (int32_t)(model->members.from[l->laws[k].member] / 2));
    add_seed(p, (int32_t)(model->members.to[l->laws[k].member] / 2));
  }
}

static void forget_results(strut_local_events *p) {
  for (int32_t k = 0; k < p->nodes.written_count; k++) p->nodes.regions[p->nodes.written[k]] = 0;
  for (int32_t k = 0; k < p->nodes.seed_count; k++) p->nodes.joined[p->nodes.seeds[k]] = 0;
  p->nodes.written_count = p->nodes.changed_count = 0;
  p->far = p->failed = false;
}

/* Do changes reach what another region has stepped, or where the region is no longer wide enough? They become
   seeds. */
static bool must_widen(strut_local_events *p) {
  bool more = p->far;
  for (int32_t k = 0; k < p->nodes.changed_count; k++)
    more = more || p->nodes.regions[p->nodes.changed[k]] > 1;
  for (int32_t k = 0; k < p->nodes.changed_count && more; k++) add_seed(p, p->nodes.changed[k]);
  return more;
}

static bool step_regions(const strut_model *model, strut_state *state, strut_event_stepper *l,
                         strut_local_events *p, double t, double dt, double *works) {
  int64_t events = state->events;
  for (int attempt = 0; attempt < MOST_ATTEMPTS; attempt++) {
    state->events = events;
    memset(works, 0, STRUT_POWER_ROOM * sizeof *works);
    memset(p->motion.push_q, 0, (size_t)model->length * sizeof *p->motion.push_q);
    memset(p->motion.push_v, 0, (size_t)model->length * sizeof *p->motion.push_v);
    forget_results(p);
    bool good = true;
    for (int32_t k = 0; k < p->nodes.seed_count && good; k++)
      if (!p->nodes.joined[p->nodes.seeds[k]])
        good = strut_local_region_grow(model, &p->map, p->nodes.seeds[k], p->nodes.seed,
                                       p->nodes.joined, &p->region) &&
               step_region(model, state, l, p, t, dt, works);
    if (good && !must_widen(p)) return true;
    restore_modes(model, state, l, p);
    if (!good) break;
  }
  state->events = events;
  return false;
}

/*
 * x += M^-1 push, where what sticks keeps its place: regions have been stepped with their rims as they move
 * without events, and this lets go of them.
 */
static void add_far_motion(const strut_model *model, strut_state *state, strut_event_stepper *l,
                           const double *push, double *far, double *x) {
  strut_mass_solve(model, push, far, state->buffers.mass_solve);
  if (l->stuck_count) strut_solve_stick_constraints(model, l, far, l->next);
  for (int32_t i = 0; i < 2 * model->node_count; i++) x[i] += far[i];
}

static void write_results(const strut_local_events *p, const strut_step_end *next) {
  for (int32_t k = 0; k < p->nodes.written_count; k++) {
    int32_t node = p->nodes.written[k];
    /* what sticks does so exactly */
    bool own = p->map.contact[node] >= 0 && p->nodes.regions[node] == 1 && p->nodes.inside[node];
    for (int32_t i = 2 * node; i < 2 * node + 2; i++) {
      next->q[i] = own ? p->motion.own_q[i] : next->q[i] + p->motion.more_q[i];
      next->v[i] = own ? p->motion.own_v[i] : next->v[i] + p->motion.more_v[i];
    }
  }
}

STRUT_CLONES
static void evaluate_whole_end(const strut_model *model, strut_state *state, strut_event_stepper *l,
                               double t) {
  evaluate_step_end(model, state, l, t, l->next, STRUT_TERMS_COMMON, state->balance);
}

/* The region's reach for a step of h, by the next longer one that has been prepared; 0: too far. */
static int find_reach(const strut_local_events *p, double h) {
  int k = 0;
  while (k + 1 < STRUT_LOCAL_HALVINGS && h <= ldexp(p->longest, -k - 1)) k++;
  return p->reach[k] ? p->reach[k] + STRUT_LOCAL_MARGIN : 0;
}

bool strut_local_events_take(const strut_model *model, strut_state *state, strut_event_stepper *l,
                             double t, double h, double dt) {
  strut_local_events *p = l->local;
  double works[STRUT_POWER_ROOM];
  if (state->watched.event_log || state->watched.variation || !(p->region.reach = find_reach(p, h)))
    return false;
  p->whole.begin = l->now, p->whole.end = l->next;
  p->whole.start = t, p->whole.span = h;
  p->nodes.seed_count = p->nodes.written_count = 0;
  find_seeds(model, l, h, p);
  save_modes(model, l, p);
  bool good = p->nodes.seed_count > 0 && step_regions(model, state, l, p, t, dt, works);
  if (good) {
    strut_update_active_set(model, l);
    if (!model->mass->diagonal) {
      add_far_motion(model, state, l, p->motion.push_q, p->motion.far_q, l->next->q);
      add_far_motion(model, state, l, p->motion.push_v, p->motion.far_v, l->next->v);
    }
    write_results(p, l->next);
    evaluate_whole_end(model, state, l, t + h);
    strut_event_measure(model, state, l, l->next);
    for (int k = 0; k < STRUT_POWER_COUNT && state->balance; k++) l->gained[k] += works[k];
  } else {
    state->trouble = STRUT_FAILURE_NONE; /* that of a region, which the whole does not share */
    strut_update_active_set(model, l);
  }
  forget_results(p);
  for (int32_t k = 0; k < p->nodes.seed_count; k++) p->nodes.seed[p->nodes.seeds[k]] = 0;
  return good;
}

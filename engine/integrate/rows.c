/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/rows.h"

#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/subnormals.h"
#include "engine/base/team.h"
#include "engine/forces/drive.h"
#include "engine/forces/ground_kernel.h"
#include "engine/forces/members_kernel.h"
#include "engine/model/mass_kernel.h"

/* What one thread works on: blocks of members, nodes; the ends are the next thread's begins. */
typedef struct share {
  int32_t block, node, late;
} share;

enum { LATE = INT32_MAX };

struct strut_rows {
  const strut_model *model;
  strut_team *team;
  share *shares;   /* (threads + 1) */
  int32_t *start;  /* (nodes + 1) rows */
  uint32_t *entry; /* (2 members) 2 * where the member is stored, + 1 at its second node */
  double *pull;    /* (slots, 2) of members on their first nodes [N] */
  double *base;    /* (length) constant forces and loads; NULL: none */
  double *drive, *exchanged, *lost; /* (slots) powers [W]; NULL where no member has any */
  double *q, *v[4], *a[4];          /* (length) as in rk4.c */
  bool fused; /* masses are not coupled: a node moves as soon as its members have been worked on */
  int32_t
      *ready; /* (nodes) the block behind which it and those before it in the share do; or LATE */
  int32_t *late;                   /* nodes with members in other shares, share by share */
  int32_t *contact, contact_count; /* nodes in contacts: the first thread's */
  strut_arena arena;
  /* of the present call */
  strut_state *state;
  double dt;
  int64_t count;
  unsigned subnormals;
};

static const unsigned POSSIBLE = STRUT_TERM_MEMBERS | STRUT_TERM_DAMPING | STRUT_TERM_SLACK |
                                 STRUT_TERM_DRIVE | STRUT_TERM_CONSTANT | STRUT_TERM_LOADS |
                                 STRUT_TERM_CONTACT | STRUT_TERM_FRICTION | STRUT_TERM_SLOPE |
                                 STRUT_TERM_SOLVE | STRUT_TERM_LAWS | STRUT_TERM_DIRECTION;

bool strut_rows_possible(const strut_model *model) {
  const strut_feedback_table *f = &model->feedback;
  if (f->sampled_count || f->trigger_count || f->relay_count) return false;
  return (model->plan & STRUT_TERM_MEMBERS) && !(model->plan & ~POSSIBLE) && model->mass &&
         (model->mass->any_single || !model->mass->diagonal);
}

static bool make_rows(strut_rows *r, const int32_t *stored) {
  const strut_member_table *t = &r->model->members;
  size_t nodes = (size_t)r->model->node_count, members = (size_t)t->count;
  r->start = strut_arena_allocate(&r->arena, nodes + 2, sizeof *r->start);
  r->entry = strut_arena_allocate(&r->arena, 2 * members, sizeof *r->entry);
  if (!r->start || !r->entry) return false;
  for (size_t j = 0; j < members; j++) r->start[t->from[j] / 2 + 2]++, r->start[t->to[j] / 2 + 2]++;
  for (size_t i = 2; i < nodes + 2; i++) r->start[i] += r->start[i - 1];
  for (size_t j = 0; j < members; j++) { /* in the scene's order */
    uint32_t k = stored ? (uint32_t)stored[j] : (uint32_t)j;
    r->entry[r->start[t->from[k] / 2 + 1]++] = 2 * k;
    r->entry[r->start[t->to[k] / 2 + 1]++] = 2 * k + 1;
  }
  return true;
}

static bool make_arrays(strut_rows *r) {
  const strut_model *m = r->model;
  size_t length = (size_t)m->length, slots = (size_t)m->members.slots;
  double **all[] = {&r->q, &r->v[1], &r->v[2], &r->v[3], &r->a[0], &r->a[1], &r->a[2], &r->a[3]};
  r->pull = strut_arena_allocate(&r->arena, 2 * slots, sizeof *r->pull);
  bool good = r->pull;
  for (size_t i = 0; i < sizeof all / sizeof *all && good; i++)
    good = (*all[i] = strut_arena_allocate(&r->arena, length, sizeof(double)));
  if (good && (m->plan & (STRUT_TERM_DAMPING | STRUT_TERM_DRIVE))) {
    r->drive = strut_arena_allocate(&r->arena, slots, sizeof *r->drive);
    r->exchanged = strut_arena_allocate(&r->arena, slots, sizeof *r->exchanged);
    r->lost = strut_arena_allocate(&r->arena, slots, sizeof *r->lost);
    good = r->drive && r->exchanged && r->lost;
  }
  if (good && (m->plan & (STRUT_TERM_CONSTANT | STRUT_TERM_LOADS))) {
    good = (r->base = strut_arena_allocate(&r->arena, length, sizeof *r->base));
    if (good && m->constant_force) memcpy(r->base, m->constant_force, length * sizeof *r->base);
  }
  return good;
}

/* Equal numbers of members and of nodes; nodes two by two. */
static bool make_shares(strut_rows *r) {
  int threads = strut_team_size(r->team);
  int64_t blocks = r->model->members.blocks, nodes = r->model->node_count;
  r->shares = strut_arena_allocate(&r->arena, (size_t)threads + 1, sizeof *r->shares);
  for (int i = 0; i <= threads && r->shares; i++)
    r->shares[i] = (share){(int32_t)(blocks * i / threads),
                           (int32_t)(i < threads ? nodes * i / threads / 4 * 4 : nodes), 0};
  return r->shares;
}

/* Which nodes of each share move when. */
static bool order_moves(strut_rows *r) {
  const strut_model *model = r->model;
  int32_t nodes = model->node_count, late = 0;
  int threads = strut_team_size(r->team);
  r->fused = model->mass->diagonal;
  r->ready = strut_arena_allocate(&r->arena, (size_t)nodes, sizeof *r->ready);
  r->late = strut_arena_allocate(&r->arena, (size_t)nodes, sizeof *r->late);
  r->contact = strut_arena_allocate(&r->arena, (size_t)model->contacts.count, sizeof *r->contact);
  if (!r->ready || !r->late || !r->contact) return false;
  for (int32_t i = 0; i < model->contacts.count; i++) {
    int32_t node = (int32_t)(model->contacts.at[i] / 2);
    if (r->ready[node] != LATE) r->contact[r->contact_count++] = node;
    r->ready[node] = LATE;
  }
  for (int p = 0; p < threads; p++) {
    int32_t ready = r->shares[p].block, begin = ready, end = r->shares[p + 1].block;
    r->shares[p].late = late;
    for (int32_t i = r->shares[p].node; i < r->shares[p + 1].node; i++) {
      bool own = true;
      if (r->ready[i] == LATE) continue;
      int32_t last = ready;
      for (int32_t k = r->start[i]; k < r->start[i + 1]; k++) {
        int32_t block = (int32_t)(r->entry[k] / 2 / STRUT_BLOCK);
        own = own && block >= begin && block < end;
        if (block > last) last = block;
      }
      r->ready[i] = own ? last : LATE;
      if (own)
        ready = last;
      else
        r->late[late++] = i;
    }
  }
  r->shares[threads].late = late;
  return true;
}

strut_rows *strut_rows_create(const strut_model *model, const int32_t *stored, int threads) {
  strut_rows *r = strut_allocate(1, sizeof *r);
  if (!r) return NULL;
  r->model = model;
  r->team = strut_team_create(threads);
  if (make_rows(r, stored) && make_arrays(r) && make_shares(r) && order_moves(r)) return r;
  strut_rows_free(r);
  return NULL;
}

void strut_rows_free(strut_rows *rows) {
  if (!rows) return;
  strut_team_free(rows->team);
  strut_arena_free(&rows->arena);
  strut_release(rows);
}

/* ---- members ---- */

STRUT_INLINE void row_group(const strut_rows *r, const strut_member_table *t,
                            const strut_state *state, const double *restrict q,
                            const double *restrict v, double *restrict pull, int32_t j,
                            unsigned terms, bool ledger) {
  const uint32_t *restrict from = t->from + j, *restrict to = t->to + j;
  member_vectors d = members_gather(q, from, to);
  strut_lanes length = members_root(d.x * d.x + d.y * d.y);
  strut_lanes inverse = strut_lanes_choose(length > 0.0, 1.0 / length, (strut_lanes){0}),
              rate = {0};
  if ((terms & STRUT_TERM_DAMPING) || (ledger && (terms & STRUT_TERM_DRIVE))) {
    member_vectors w = members_gather(v, from, to);
    rate = (w.x * d.x + w.y * d.y) * inverse;
  }
  member_powers powers = {0};
  member_values m = members_values(t, state, j, terms & STRUT_TERM_DRIVE, length, rate);
  strut_lanes tension = member_tension(&m, terms, ledger, &powers);
  strut_lanes density = tension * inverse, px = density * d.x, py = density * d.y;
  strut_lanes_store(pull + 2 * j, __builtin_shufflevector(px, py, 0, 4, 1, 5));
  strut_lanes_store(pull + 2 * j + 4, __builtin_shufflevector(px, py, 2, 6, 3, 7));
  if (!ledger || !(terms & (STRUT_TERM_DAMPING | STRUT_TERM_DRIVE))) return;
  strut_lanes_store(r->drive + j, powers.drive);
  strut_lanes_store(r->exchanged + j, powers.exchanged);
  strut_lanes_store(r->lost + j, powers.lost);
}

/* The sums that forces_of_members makes, in its order. */
static void sum_powers(const strut_rows *r) {
  double *power = r->state->power;
  member_powers sum = {0};
  for (int32_t j = 0; j < r->model->members.slots && r->lost; j += STRUT_LANES) {
    sum.drive += strut_lanes_load(r->drive + j);
    sum.exchanged += strut_lanes_load(r->exchanged + j);
    sum.lost += strut_lanes_load(r->lost + j);
  }
  double drive = 0.0, lost = 0.0, exchanged = power[STRUT_POWER_EXCHANGED];
  for (int l = 0; l < STRUT_LANES; l++) {
    drive += sum.drive[l];
    lost += sum.lost[l];
    exchanged += sum.exchanged[l] + sum.lost[l];
  }
  power[STRUT_POWER_DRIVE] = drive, power[STRUT_POWER_MEMBERS] = lost;
  power[STRUT_POWER_EXCHANGED] = exchanged;
}

/* ---- nodes ---- */

/* What a member adds to the sum of one of its nodes. */
STRUT_INLINE strut_pair row_entry(const double *restrict pull, uint32_t entry) {
  typedef long long bits __attribute__((vector_size(16)));
  static const double signs[2][2] = {{0.0, 0.0}, {-0.0, -0.0}};
  return (strut_pair)((bits)strut_pair_load(pull + (entry & ~1u)) ^
                      (bits)strut_pair_load(signs[entry & 1u]));
}

STRUT_INLINE strut_pair row_sum(const strut_rows *r, int32_t i) {
  strut_pair sum = r->base ? strut_pair_load(r->base + 2 * i) : (strut_pair){0.0, 0.0};
  for (int32_t k = r->start[i], end = r->start[i + 1]; k < end; k++)
    sum += row_entry(r->pull, r->entry[k]);
  return sum;
}

/* Those of nodes i and i + 1 side by side. */
STRUT_INLINE strut_lanes row_sums(const strut_rows *r, int32_t i) {
  const uint32_t *restrict entry = r->entry;
  int32_t a = r->start[i], middle = r->start[i + 1], b = middle, end = r->start[i + 2];
  strut_lanes sum = r->base ? strut_lanes_load(r->base + 2 * i) : (strut_lanes){0};
  for (; a < middle && b < end; a++, b++)
    sum += __builtin_shufflevector(row_entry(r->pull, entry[a]), row_entry(r->pull, entry[b]), 0, 1,
                                   2, 3);
  if (a == middle && b == end) return sum;
  strut_pair x = __builtin_shufflevector(sum, sum, 0, 1);
  strut_pair y = __builtin_shufflevector(sum, sum, 2, 3);
  for (; a < middle; a++) x += row_entry(r->pull, entry[a]);
  for (; b < end; b++) y += row_entry(r->pull, entry[b]);
  return __builtin_shufflevector(x, y, 0, 1, 2, 3);
}

/* What follows from the acceleration of stage k at one node: the next stage, or the end of the step. */
STRUT_INLINE void row_stage(const strut_rows *r, int k, double h, int32_t at, strut_pair a) {
  double *restrict q0 = r->state->q, *restrict v0 = r->state->v;
  strut_pair v = strut_pair_load(v0 + at);
  if (k < 3) {
    strut_pair speed = k == 0 ? v : strut_pair_load(r->v[k] + at);
    strut_pair_store(r->q + at, strut_pair_load(q0 + at) + h * speed);
    strut_pair_store(r->v[k + 1] + at, v + h * a);
    return;
  }
  double sixth = h / 6.0;
  strut_pair inner = strut_pair_load(r->v[1] + at) + strut_pair_load(r->v[2] + at);
  strut_pair sum = v + 2.0 * inner + strut_pair_load(r->v[3] + at);
  strut_pair_store(q0 + at, strut_pair_load(q0 + at) + sixth * sum);
  inner = strut_pair_load(r->a[1] + at) + strut_pair_load(r->a[2] + at);
  sum = strut_pair_load(r->a[0] + at) + 2.0 * inner + a;
  strut_pair_store(v0 + at, v + sixth * sum);
}

/* The same at two nodes side by side. */
STRUT_INLINE void row_stages(const strut_rows *r, int k, double h, int32_t at, strut_lanes a) {
  double *restrict q0 = r->state->q, *restrict v0 = r->state->v;
  strut_lanes v = strut_lanes_load(v0 + at);
  if (k < 3) {
    strut_lanes speed = k == 0 ? v : strut_lanes_load(r->v[k] + at);
    strut_lanes_store(r->q + at, strut_lanes_load(q0 + at) + h * speed);
    strut_lanes_store(r->v[k + 1] + at, v + h * a);
    return;
  }
  double sixth = h / 6.0;
  strut_lanes inner = strut_lanes_load(r->v[1] + at) + strut_lanes_load(r->v[2] + at);
  strut_lanes sum = v + 2.0 * inner + strut_lanes_load(r->v[3] + at);
  strut_lanes_store(q0 + at, strut_lanes_load(q0 + at) + sixth * sum);
  inner = strut_lanes_load(r->a[1] + at) + strut_lanes_load(r->a[2] + at);
  sum = strut_lanes_load(r->a[0] + at) + 2.0 * inner + a;
  strut_lanes_store(v0 + at, v + sixth * sum);
}

STRUT_INLINE void row_two_nodes(const strut_rows *r, int32_t i, int k, double h) {
  strut_lanes a = row_sums(r, i) * strut_lanes_load(r->model->mass->inverse + 2 * i);
  strut_lanes_store(r->a[k] + 2 * i, a);
  row_stages(r, k, h, 2 * i, a);
}

STRUT_INLINE void row_node(const strut_rows *r, int32_t i, int k, double h) {
  strut_pair a = row_sum(r, i) * strut_pair_load(r->model->mass->inverse + 2 * i);
  strut_pair_store(r->a[k] + 2 * i, a);
  row_stage(r, k, h, 2 * i, a);
}

/* Members, and each node as soon as the last of its members has been worked on, while what they pull with is
   still in the cache. */
STRUT_CLONES
static void row_members(const strut_rows *r, int thread, const double *q, const double *v, int k,
                        double h, bool ledger) {
  enum { K = STRUT_TERM_DAMPING, S = STRUT_TERM_SLACK, D = STRUT_TERM_DRIVE };
  const strut_member_table t = r->model->members;
  const strut_state *state = r->state;
  double *restrict pull = r->pull;
  const int32_t *restrict ready = r->ready;
  int32_t i = r->shares[thread].node, nodes = r->shares[thread + 1].node;
  for (int32_t b = r->shares[thread].block; b < r->shares[thread + 1].block; b++) {
    int32_t begin = b * STRUT_BLOCK;
    int32_t end = begin + STRUT_BLOCK < t.slots ? begin + STRUT_BLOCK : t.slots;
#define STRUT_CASE(set)                                                                            \
  case set:                                                                                        \
    for (int32_t j = begin; j < end; j += STRUT_LANES)                                             \
      if (ledger)                                                                                  \
        row_group(r, &t, state, q, v, pull, j, set, true);                                         \
      else                                                                                         \
        row_group(r, &t, state, q, v, pull, j, set, false);                                        \
    break
    switch (t.block_terms[b] & (K | S | D)) {
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
    while (r->fused && i < nodes && (ready[i] <= b || ready[i] == LATE)) {
      if (i + 1 < nodes && ready[i] <= b && ready[i + 1] <= b) {
        row_two_nodes(r, i, k, h);
        i += 2;
      } else {
        if (ready[i] != LATE) row_node(r, i, k, h);
        i++;
      }
    }
  }
  for (; r->fused && i < nodes; i++) /* a share without members */
    if (ready[i] != LATE) row_node(r, i, k, h);
}

/* Nodes that waited for the members of others, and by the first thread those in contact with the ground. */
static void row_late_nodes(const strut_rows *r, int thread, const double *q, const double *v, int k,
                           double h) {
  const strut_model *model = r->model;
  for (int32_t l = r->shares[thread].late; l < r->shares[thread + 1].late; l++)
    row_node(r, r->late[l], k, h);
  if (thread != 0 || !(model->plan & STRUT_TERM_CONTACT)) return;
  double *force = r->state->force;
  const double *inverse = model->mass->inverse;
  for (int32_t c = 0; c < r->contact_count; c++)
    strut_pair_store(force + 2 * r->contact[c], row_sum(r, r->contact[c]));
  ground_kernel(model, r->state, q, v, force, r->state->ledger);
  for (int32_t c = 0; c < r->contact_count; c++) {
    int32_t at = 2 * r->contact[c];
    strut_pair a = strut_pair_load(force + at) * strut_pair_load(inverse + at);
    strut_pair_store(r->a[k] + at, a);
    row_stage(r, k, h, at, a);
  }
}

STRUT_CLONES
static void row_nodes_sum(const strut_rows *r, int thread) {
  for (int32_t i = r->shares[thread].node; i < r->shares[thread + 1].node; i++)
    strut_pair_store(r->state->force + 2 * i, row_sum(r, i));
}

static void row_nodes_move(const strut_rows *r, int thread, int k, double h) {
  for (int32_t i = r->shares[thread].node; i < r->shares[thread + 1].node; i++)
    row_stage(r, k, h, 2 * i, strut_pair_load(r->a[k] + 2 * i));
}

/* ---- steps ---- */

/* Loads and drives at a stage, by one thread. */
static void begin_stage(strut_rows *r, double t, const double *v) {
  const strut_model *model = r->model;
  const strut_load_table *loads = &model->loads;
  strut_state *state = r->state;
  state->evaluations++;
  for (int p = 0; p < STRUT_POWER_COUNT && state->ledger; p++) state->power[p] = 0.0;
  if (model->plan & STRUT_TERM_LOADS) {
    double *force = state->force;
    for (int32_t i = 0; i < loads->count; i++)
      for (int c = 0; c < 2; c++) {
        int32_t at = 2 * loads->node[i] + c;
        r->base[at] = model->constant_force ? model->constant_force[at] : 0.0;
      }
    state->force = r->base;
    strut_loads_apply(model, state, t, v);
    state->force = force;
  }
  if ((model->plan & STRUT_TERM_DRIVE) && t != state->drive_time)
    strut_drive_apply(model, state, t);
}

static void add_works(const strut_rows *r, int k) {
  static const double weight[4] = {1, 2, 2, 1};
  strut_state *state = r->state;
  for (int p = 0; p < STRUT_POWER_COUNT && state->ledger; p++)
    state->work[p] += weight[k] * (r->dt / 6.0) * state->power[p];
}

/* The ground and the coupled masses, by one thread. */
static void middle_of_stage(const strut_rows *r, int k, const double *q, const double *v) {
  const strut_model *model = r->model;
  strut_state *state = r->state;
  if (model->plan & STRUT_TERM_CONTACT)
    ground_kernel(model, state, q, v, state->force, state->ledger);
  mass_kernel(model, state->force, r->a[k], state->scratch);
}

static void work(void *context, int thread) {
  static const double ahead[4] = {0.0, 0.5, 0.5, 1.0};
  strut_rows *r = context;
  const strut_model *model = r->model;
  const double *const at[4] = {r->state->q, r->q, r->q, r->q};
  const double *const speed[4] = {r->state->v, r->v[1], r->v[2], r->v[3]};
  bool ledger = r->state->ledger;
  unsigned before = strut_subnormals_mode();
  int64_t first = r->state->step;
  strut_subnormals_restore(r->subnormals);
  strut_team_meet(r->team); /* all have read where the run is */
  for (int64_t n = first; n < first + r->count; n++)
    for (int k = 0; k < 4; k++) {
      double h = k < 3 ? ahead[k + 1] * r->dt : r->dt;
      if (thread == 0) begin_stage(r, ((double)n + ahead[k]) * r->dt, speed[k]);
      strut_team_meet(r->team);
      row_members(r, thread, at[k], speed[k], k, h, ledger);
      strut_team_meet(r->team);
      if (thread == 0 && ledger) sum_powers(r);
      if (r->fused) {
        row_late_nodes(r, thread, at[k], speed[k], k, h);
      } else {
        row_nodes_sum(r, thread);
        strut_team_meet(r->team);
        if (thread == 0) middle_of_stage(r, k, at[k], speed[k]);
        strut_team_meet(r->team);
        row_nodes_move(r, thread, k, h);
      }
      if (thread == 0) add_works(r, k);
      if (model->plan & STRUT_TERM_LOADS) strut_team_meet(r->team); /* their sums are read */
      if (thread == 0 && k == 3) r->state->step = n + 1;
    }
  strut_subnormals_restore(before);
}

void strut_rows_advance(strut_rows *rows, strut_state *state, double dt, int64_t count) {
  rows->state = state, rows->dt = dt, rows->count = count;
  rows->subnormals = strut_subnormals_mode();
  strut_team_run(rows->team, work, rows);
}

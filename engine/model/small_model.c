/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/small_model.h"

#include "engine/model/mass.h"

static strut_small_level level_here(void) {
#if defined(__x86_64__) && defined(__gnu_linux__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return STRUT_SMALL_AVX512;
  if (__builtin_cpu_supports("avx2")) return STRUT_SMALL_AVX2;
#endif
  return STRUT_SMALL_NONE;
}

static bool is_small(const strut_model *model) {
  return !(model->terms & ~(unsigned)STRUT_TERMS_SMALL) && model->terms & STRUT_TERM_MEMBERS &&
         model->node_count <= STRUT_SMALL_NODES && model->members.count <= STRUT_SMALL_MEMBERS &&
         model->members.slots <= STRUT_SMALL_SLOTS && model->drives.count <= STRUT_SMALL_DRIVES &&
         model->mass && !model->mass->coordinate[0].factor && !model->mass->coordinate[1].factor;
}

static void begin_pulls(strut_small_pull *p) {
  for (int l = 0; l < STRUT_SMALL_NODES; l++)
    p->slot[l] = STRUT_SMALL_MEMBERS, p->sign[l] = INT64_MIN;
}

/* The next pull at a lane: members come in the scene's order. */
static void add_pull(strut_small_model *s, int64_t lane, int32_t member, int64_t sign) {
  int32_t k = 0;
  while (k < s->degree && s->pull[k].has[lane]) k++;
  if (k == s->degree) begin_pulls(&s->pull[s->degree++]);
  s->pull[k].has[lane] = -1;
  s->pull[k].slot[lane] = member;
  s->pull[k].slot_halves[lane] = strut_small_halves(member);
  s->pull[k].sign[lane] = sign;
}

static void list_members(const strut_model *model, strut_small_model *s) {
  const strut_member_table *t = &model->members;
  s->members = t->count;
  for (int32_t j = 0; j < t->count; j++) {
    s->from[j] = t->from[j] / 2, s->to[j] = t->to[j] / 2;
    s->from_halves[j] = strut_small_halves(s->from[j]);
    s->to_halves[j] = strut_small_halves(s->to[j]);
    s->stiffness[j] = t->stiffness[j], s->damping[j] = t->damping[j];
    add_pull(s, s->from[j], j, 0);
    add_pull(s, s->to[j], j, INT64_MIN);
  }
  /* slots without a member, which have no stiffness, find their ends where the last member does */
  for (int32_t j = t->count; j < STRUT_SMALL_SLOTS; j++) {
    s->from_halves[j] = strut_small_halves(s->from[t->count - 1]);
    s->to_halves[j] = strut_small_halves(s->to[t->count - 1]);
  }
}

static strut_small_source source_of(const int64_t halves[4]) {
  int second = 0;
  for (int l = 0; l < 4; l++) second += halves[l] < 0;
  return second == 0 ? STRUT_SMALL_FIRST : second == 4 ? STRUT_SMALL_SECOND : STRUT_SMALL_BOTH;
}

static int64_t larger(int64_t a, int64_t b) { return a > b ? a : b; }

/* The turns of AVX2, from what is listed for whole rows. */
static void list_pull_turns(strut_small_model *s) {
  strut_small_pull_turns *t = &s->pull_turns;
  for (int64_t g = 0, begin = 0; g < 3; begin = t->end[g++]) {
    t->end[g] = begin;
    for (int32_t l = 0; l < STRUT_SMALL_NODES; l++)
      for (int64_t k = 0, at = begin; k < s->degree; k++) {
        const strut_small_pull *p = &s->pull[k];
        if (!p->has[l] || p->slot[l] / 4 != g) continue;
        t->turn[at].halves[l] = p->slot_halves[l];
        t->turn[at].sign[l] = p->sign[l];
        t->turn[at++].has[l] = -1;
        t->end[g] = larger(t->end[g], at);
      }
  }
  /* where nothing pulls, -0 is added, which changes no bit */
  for (int32_t k = 0; k < t->end[2]; k++)
    for (int l = 0; l < STRUT_SMALL_NODES; l++)
      if (!t->turn[k].has[l]) t->turn[k].sign[l] = INT64_MIN;
}

static void list_mass_turns(strut_small_model *s) {
  strut_small_mass_turns *t = &s->mass_turns;
  for (int64_t g = 0, begin = 0; g < 2; begin = t->end[g++]) {
    t->end[g] = begin;
    for (int32_t i = 0; i < 2 * STRUT_SMALL_NODES; i++)
      for (int64_t c = i % 2, l = i / 2, k = 0, at = begin; k < s->columns; k++) {
        const strut_small_column *p = &s->column[c][k];
        if (!p->has[l] || p->lane[l] / 4 != g) continue;
        t->turn[at].halves[c][l] = p->batch_halves[l];
        t->turn[at].minus_inverse[c][l] = -p->inverse[l];
        t->turn[at++].has[c][l] = -1;
        t->end[g] = larger(t->end[g], at);
      }
  }
}

static void list_turns(strut_small_model *s) {
  for (int32_t g = 0; g < STRUT_SMALL_SLOTS / 4; g++) {
    s->from_source[g] = source_of(s->from_halves + 4 * g);
    s->to_source[g] = source_of(s->to_halves + 4 * g);
  }
  list_pull_turns(s);
  list_mass_turns(s);
}

static void add_entry(strut_small_model *s, int c, int32_t j, int64_t row, int64_t column,
                      double inverse) {
  strut_small_column *to = &s->column[c][j];
  if (j >= s->columns) s->columns = j + 1;
  to->lane[row] = column, to->batch_halves[row] = strut_small_halves(column);
  to->inverse[row] = inverse, to->has[row] = -1;
  to->bits = (uint8_t)(to->bits | 1u << row);
}

/* The inverse masses of one coordinate. Rows of blocks replace the diagonal entries. */
static void list_masses(const strut_model *model, strut_small_model *s, int c) {
  const strut_mass *mass = model->mass;
  const strut_mass_operator *op = &mass->coordinate[c];
  const uint32_t *at = op->block_at;
  const double *inverse = op->block_inverse;
  for (int32_t i = 0; i < s->nodes && mass->any_single; i++)
    add_entry(s, c, 0, i, i, mass->inverse[2 * i + c]);
  for (int32_t b = 0; b < op->block_count && !mass->diagonal; b++) {
    int32_t n = op->block_size[b];
    for (int32_t i = 0; i < n; i++)
      for (int32_t j = 0; j < n; j++) add_entry(s, c, j, at[i] / 2, at[j] / 2, inverse[i * n + j]);
    at += n, inverse += n * n;
  }
}

static void list_contacts(const strut_model *model, strut_small_contacts *t) {
  for (int32_t i = 0; i < model->contacts.count; i++) {
    const strut_contact_entry *e = &model->contacts.entry[i];
    const strut_friction *f = &e->friction;
    int32_t n = e->node;
    t->minus_stiffness[n] = -e->stiffness, t->minus_damping[n] = -e->damping;
    t->dissipation[n] = e->dissipation;
#define STRUT_FRICTION_ROW(NAME, field, range) t->field[n] = f->field;
    STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
    t->mu_static_backward[n] = strut_friction_static(f, -1.0);
    t->mu_kinetic_backward[n] = strut_friction_kinetic(f, -1.0);
    t->touches[n] = -1;
#define STRUT_FRICTION_ROW(NAME, name, ...) t->name[n] = f->law == STRUT_FRICTION_##NAME ? -1 : 0;
    STRUT_FRICTION_LAWS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
  }
}

bool strut_small_model_compile(strut_model *model) {
  strut_small_level level = level_here();
  if (level == STRUT_SMALL_NONE || !is_small(model)) return true;
  strut_small_model *s = strut_arena_allocate(&model->arena, 1, sizeof *s);
  if (!s) return false;
  s->level = level;
  s->nodes = model->node_count;
  list_members(model, s);
  for (int c = 0; c < 2; c++) list_masses(model, s, c);
  list_turns(s);
  list_contacts(model, &s->contact);
  model->small = s;
  return true;
}

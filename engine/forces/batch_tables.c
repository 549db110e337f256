/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/batch_tables.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/model/mass.h"

/* The laws and strains of batch_kernel.h and batch_elements.h. */
static const strut_law_set known = {.friction = STRUT_HAS_ALL,
                                    .damping = STRUT_HAS_ALL,
                                    .law = STRUT_HAS_ALL,
                                    .strain = STRUT_HAS(STRUT_STRAIN, LENGTH) |
                                              STRUT_HAS(STRUT_STRAIN, PATH) |
                                              STRUT_HAS(STRUT_STRAIN, ANGLE)};

bool strut_batch_takes_model(const strut_model *model) {
  const strut_mass *mass = model->mass;
  const unsigned one_by_one = STRUT_TERM_RIGID | STRUT_TERM_ACTUATOR_FORCES |
                              STRUT_TERM_MASS_DAMPING | STRUT_TERM_SUPPORT_MOTION |
                              STRUT_TERM_UNBALANCE | STRUT_TERM_MEMORY | STRUT_TERM_SURFACES |
                              STRUT_TERM_FEEDBACK | STRUT_TERM_SLIDING_MASS | STRUT_TERM_RUBBING;
  if (!mass || (model->terms & one_by_one) || !strut_laws_within(model->laws, known)) return false;
  if (model->elements.scattered) return false;
  /* the energy balance of one run adds up so many members in parts */
  bool powers = model->terms & (STRUT_TERM_DAMPING | STRUT_TERM_DRIVE);
  if (powers && model->members.blocks > STRUT_BALANCE_BLOCKS) return false;
  return !mass->coordinate[0].factor && !mass->coordinate[1].factor;
}

static bool same(const void *a, const void *b, int32_t count, size_t size) {
  return count == 0 || memcmp(a, b, (size_t)count * size) == 0;
}

static int32_t rows_of(const strut_mass_operator *op) {
  int32_t rows = 0;
  for (int32_t b = 0; b < op->block_count; b++) rows += op->block_size[b];
  return rows;
}

static int32_t entries_of(const strut_mass_operator *op) {
  int32_t entries = 0;
  for (int32_t b = 0; b < op->block_count; b++) entries += op->block_size[b] * op->block_size[b];
  return entries;
}

static bool masses_alike(const strut_mass *a, const strut_mass *b) {
  if (a->shared != b->shared || a->diagonal != b->diagonal || a->any_single != b->any_single)
    return false;
  for (int c = 0; c < 2 && !a->diagonal; c++) {
    const strut_mass_operator *x = &a->coordinate[c], *y = &b->coordinate[c];
    if (x->block_count != y->block_count ||
        !same(x->block_size, y->block_size, x->block_count, sizeof *x->block_size) ||
        !same(x->block_at, y->block_at, rows_of(x), sizeof *x->block_at))
      return false;
  }
  return true;
}

static bool elements_alike(const strut_element_table *a, const strut_element_table *b) {
  if (a->count != b->count) return false;
  for (int32_t i = 0; i < a->count; i++) {
    const strut_element *x = &a->element[i], *y = &b->element[i];
    bool damped = (x->damping > 0.0) == (y->damping > 0.0);
    bool kinked = !strut_law_kinks(x->law, &x->numbers) == !strut_law_kinks(y->law, &y->numbers);
    if (x->strain != y->strain || x->law != y->law || x->nodes != y->nodes || x->slot != y->slot ||
        x->carries != y->carries || !damped || !kinked ||
        !same(a->at + x->first, b->at + y->first, x->nodes, sizeof *a->at))
      return false;
  }
  return true;
}

bool strut_batch_takes_both(const strut_model *a, const strut_model *b) {
  const strut_member_table *s = &a->members, *t = &b->members;
  if (a->terms != b->terms || a->length != b->length || a->node_count != b->node_count ||
      s->slots != t->slots || s->count != t->count || a->contacts.count != b->contacts.count ||
      a->drives.count != b->drives.count || a->loads.count != b->loads.count || !a->mass ||
      !b->mass)
    return false;
  return same(s->from, t->from, s->slots, sizeof *s->from) &&
         same(s->to, t->to, s->slots, sizeof *s->to) &&
         same(s->block_terms, t->block_terms, s->blocks, sizeof *s->block_terms) &&
         same(a->contacts.at, b->contacts.at, a->contacts.count, sizeof *a->contacts.at) &&
         same(a->drives.member, b->drives.member, a->drives.count, sizeof *a->drives.member) &&
         same(a->drives.first, b->drives.first, a->drives.count, sizeof *a->drives.first) &&
         same(a->loads.node, b->loads.node, a->loads.count, sizeof *a->loads.node) &&
         masses_alike(a->mass, b->mass) && elements_alike(&a->elements, &b->elements);
}

/* A table of (rows, width). */
typedef struct table {
  double **at;
  int32_t rows;
} table;

enum { TABLES = 25 };

static void list_tables(strut_batch_tables *t, table *list) {
  const strut_model *m = t->first;
  int32_t slots = m->members.slots, length = m->length, loads = m->loads.count;
  int32_t elements = m->elements.count;
  const strut_mass *mass = m->mass;
  int32_t blocks[2];
  for (int c = 0; c < 2; c++) blocks[c] = mass->diagonal ? 0 : entries_of(&mass->coordinate[c]);
  const table all[TABLES] = {{&t->members.stiffness, slots},
                             {&t->members.damping, slots},
                             {&t->members.rest0, slots},
                             {&t->members.rest, slots},
                             {&t->members.rest_rate, slots},
                             {&t->members.slack_length_threshold, slots},
                             {&t->members.slack_force_threshold, slots},
                             {&t->constant, length},
                             {&t->ground.contact, m->contacts.count * STRUT_BATCH_CONTACT_ROWS},
                             {&t->ground.line, STRUT_BATCH_GROUND_ROWS},
                             {&t->signals.wave, (m->drives.count + loads) * STRUT_BATCH_WAVE_ROWS},
                             {&t->signals.load_factor, loads},
                             {&t->signals.load_x, loads},
                             {&t->signals.load_y, loads},
                             {&t->mass.inverse, length},
                             {&t->mass.block_inverse[0], blocks[0]},
                             {&t->mass.block_inverse[1], blocks[1]},
                             {&t->force, length},
                             {&t->power, STRUT_BATCH_POWERS},
                             {&t->elements.stiffness, elements},
                             {&t->elements.damping, elements},
                             {&t->elements.natural, elements},
                             {&t->elements.turn, elements},
                             {&t->elements.acts, elements},
                             {&t->elements.piece, elements}};
  memcpy(list, all, sizeof all);
}

bool strut_batch_tables_create(const strut_model *first, int32_t width, strut_arena *arena,
                               strut_batch_tables *tables) {
  table list[TABLES];
  *tables = (strut_batch_tables){.width = width, .first = first};
  list_tables(tables, list);
  for (int i = 0; i < TABLES; i++) {
    size_t count = (size_t)list[i].rows * (size_t)width;
    *list[i].at = strut_arena_allocate(arena, count, sizeof **list[i].at);
    if (!*list[i].at) return false;
  }
  size_t signals = (size_t)(first->drives.count + first->loads.count);
  tables->signals.all_waves =
      strut_arena_allocate(arena, signals, sizeof *tables->signals.all_waves);
  return tables->signals.all_waves != NULL;
}

/* A slot of a table from an array; NULL: zeros. */
static void spread(double *to, int32_t width, int32_t slot, const double *from, int32_t rows) {
  for (int32_t i = 0; i < rows; i++) to[i * width + slot] = from ? from[i] : 0.0;
}

static void fill_wave(double *to, int32_t width, int32_t slot, const strut_signal *s) {
  const double row[STRUT_BATCH_WAVE_ROWS] = {
      [STRUT_BATCH_AMPLITUDE] = s->amplitude,
      [STRUT_BATCH_RATE] = s->amplitude * STRUT_TAU * s->frequency,
      [STRUT_BATCH_FREQUENCY] = s->frequency,
      [STRUT_BATCH_PHASE] = s->phase,
      [STRUT_BATCH_START] = s->start,
      [STRUT_BATCH_STOP] = s->stop,
      [STRUT_BATCH_MOST_TURNS] = s->kind == STRUT_HALF_SINE ? 0.5 : HUGE_VAL};
  spread(to, width, slot, row, STRUT_BATCH_WAVE_ROWS);
}

/* The i-th of a model's signals: those of its drives, then those of its loads. */
static const strut_signal *signal_at(const strut_model *m, int32_t i) {
  assert(i >= 0 && i < m->drives.count + m->loads.count);
  int32_t drives = m->drives.count;
  return &m->scene->signals[i < drives ? m->drives.signal[i] : m->loads.signal[i - drives]];
}

static void fill_signals(strut_batch_tables *t, int32_t slot, const strut_model *m) {
  int32_t count = m->drives.count + m->loads.count, rows = STRUT_BATCH_WAVE_ROWS * t->width;
  for (int32_t i = 0; i < count; i++) {
    fill_wave(t->signals.wave + i * rows, t->width, slot, signal_at(m, i));
    t->signals.all_waves[i] = true;
    for (int32_t l = 0; l < t->width; l++) {
      strut_signal_kind kind = t->model[l] ? signal_at(t->model[l], i)->kind : STRUT_SINE;
      if (kind != STRUT_SINE && kind != STRUT_HALF_SINE) t->signals.all_waves[i] = false;
    }
  }
}

static void fill_ground(strut_batch_tables *t, int32_t slot, const strut_contact_table *c) {
  for (int32_t i = 0; i < c->count; i++) {
    const strut_contact_entry *e = &c->entry[i];
    const double row[STRUT_BATCH_CONTACT_ROWS] = {
        [STRUT_BATCH_MINUS_STIFFNESS] = -e->stiffness,
        [STRUT_BATCH_MINUS_DAMPING] = -e->damping,
        [STRUT_BATCH_DISSIPATION] = e->dissipation,
#define STRUT_FRICTION_ROW(NAME, field, range) [STRUT_BATCH_FRICTION_##NAME] = e->friction.field,
        STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
            [STRUT_BATCH_FRICTION_MU_STATIC_BACKWARD] = strut_friction_static(&e->friction, -1.0),
        [STRUT_BATCH_FRICTION_MU_KINETIC_BACKWARD] = strut_friction_kinetic(&e->friction, -1.0),
        [STRUT_BATCH_FRICTION_LAW] = e->friction.law};
    spread(t->ground.contact + i * STRUT_BATCH_CONTACT_ROWS * t->width, t->width, slot, row,
           STRUT_BATCH_CONTACT_ROWS);
  }
  const double ground[STRUT_BATCH_GROUND_ROWS] = {c->tangent[0], c->tangent[1], c->normal[0],
                                                  c->normal[1],  c->height,     c->belt_speed};
  spread(t->ground.line, t->width, slot, ground, STRUT_BATCH_GROUND_ROWS);
}

static void fill_elements(strut_batch_tables *t, int32_t slot, const strut_element_table *e) {
  for (int32_t i = 0; i < e->count; i++) {
    int32_t at = i * t->width + slot;
    t->elements.stiffness[at] = e->element[i].numbers.stiffness;
    t->elements.damping[at] = e->element[i].damping;
    t->elements.natural[at] = e->element[i].natural;
  }
}

void strut_batch_tables_put_elements(strut_batch_tables *t, int32_t slot,
                                     const strut_state *state) {
  for (int32_t i = 0; i < t->first->elements.count; i++) {
    int32_t at = i * t->width + slot;
    t->elements.turn[at] = state->history.turn[i];
    t->elements.acts[at] = state->modes.element_acts[i];
    t->elements.piece[at] = state->modes.element_piece[i];
  }
}

void strut_batch_tables_get_elements(const strut_batch_tables *t, int32_t slot,
                                     strut_state *state) {
  for (int32_t i = 0; i < t->first->elements.count; i++)
    state->history.turn[i] = t->elements.turn[i * t->width + slot];
}

void strut_batch_tables_fill(strut_batch_tables *t, int32_t slot, const strut_model *m) {
  const strut_member_table *s = &m->members;
  int32_t width = t->width;
  assert(strut_laws_within(m->laws, known));
  t->model[slot] = m;
  spread(t->members.stiffness, width, slot, s->stiffness, s->slots);
  spread(t->members.damping, width, slot, s->damping, s->slots);
  spread(t->members.rest0, width, slot, s->rest, s->slots);
  spread(t->members.rest, width, slot, s->rest, s->slots);
  spread(t->members.rest_rate, width, slot, NULL, s->slots);
  spread(t->members.slack_length_threshold, width, slot, s->slack, s->slots);
  spread(t->members.slack_force_threshold, width, slot, s->slack, s->slots);
  spread(t->constant, width, slot, m->constant_force, m->length);
  spread(t->signals.load_x, width, slot, m->loads.x, m->loads.count);
  spread(t->signals.load_y, width, slot, m->loads.y, m->loads.count);
  spread(t->mass.inverse, width, slot, m->mass->inverse, m->length);
  for (int c = 0; c < 2 && !m->mass->diagonal; c++) {
    const strut_mass_operator *op = &m->mass->coordinate[c];
    spread(t->mass.block_inverse[c], width, slot, op->block_inverse, entries_of(op));
  }
  fill_elements(t, slot, &m->elements);
  fill_ground(t, slot, &m->contacts);
  fill_signals(t, slot, m);
}

void strut_batch_tables_copy(strut_batch_tables *t, int32_t to, int32_t from) {
  assert(to >= 0 && to < t->width && from >= 0 && from < t->width);
  table list[TABLES];
  list_tables(t, list);
  t->model[to] = t->model[from];
  for (int i = 0; i < TABLES; i++)
    for (int32_t row = 0; row < list[i].rows; row++) {
      double *slots = *list[i].at + row * t->width;
      slots[to] = slots[from];
    }
}

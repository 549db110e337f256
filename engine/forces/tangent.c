/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/tangent.h"

#include <assert.h>

void strut_block_add(const strut_block *b, int count, const int32_t *row, strut_triplets *sum) {
  for (int k = 0; k < count; k++) {
    const strut_block_entry *e = &strut_block_entries[k];
    if (row[e->row] < 0 || row[e->column] < 0) continue;
    strut_triplets_add(sum, row[e->row], row[e->column],
                       e->opposite ? -b->part[e->part] : b->part[e->part]);
  }
}

int32_t strut_number_free(const strut_model *model, const uint8_t *held, int32_t *row_of,
                          int32_t *coordinate) {
  int32_t n = 0;
  for (int32_t at = 0; at < model->length; at++) {
    bool free = at < 2 * model->node_count && !model->fixed[at] && !(held && held[at]);
    row_of[at] = free ? n : -1;
    if (free) coordinate[n++] = at;
  }
  return n;
}

void strut_tangent_add_pattern(const strut_model *model, const int32_t *row_of, bool contacts,
                               strut_triplets *sum) {
  const strut_block zero = {{0}};
  for (int32_t j = 0; j < model->members.count; j++) {
    int32_t row[4];
    strut_member_rows(model, row_of, j, row);
    strut_block_add(&zero, STRUT_MEMBER_ENTRIES, row, sum);
  }
  for (int32_t i = 0; i < model->contacts.count && contacts; i++)
    strut_block_add(&zero, STRUT_CONTACT_ENTRIES, row_of + model->contacts.at[i], sum);
}

/* Index of entry (row, column) among the pattern's values; the entry exists. */
static int32_t find_place(const strut_sparse *pattern, int32_t row, int32_t column) {
  int32_t low = pattern->start[column], high = pattern->start[column + 1] - 1;
  while (low < high) {
    int32_t middle = low + (high - low) / 2;
    if (pattern->row[middle] < row)
      low = middle + 1;
    else
      high = middle;
  }
  assert(pattern->row[low] == row);
  return low;
}

static int32_t *find_places(const strut_sparse *pattern, int count, const int32_t *row,
                            int32_t *place) {
  for (int k = 0; k < count; k++) {
    int32_t a = row[strut_block_entries[k].row], b = row[strut_block_entries[k].column];
    *place++ = a < 0 || b < 0 ? -1 : a > b ? find_place(pattern, a, b) : find_place(pattern, b, a);
  }
  return place;
}

void strut_tangent_find_places(const strut_model *model, const int32_t *row_of, bool contacts,
                               const strut_sparse *pattern, int32_t *place) {
  for (int32_t j = 0; j < model->members.count; j++) {
    int32_t row[4];
    strut_member_rows(model, row_of, j, row);
    place = find_places(pattern, STRUT_MEMBER_ENTRIES, row, place);
  }
  for (int32_t i = 0; i < model->contacts.count && contacts; i++)
    place = find_places(pattern, STRUT_CONTACT_ENTRIES, row_of + model->contacts.at[i], place);
}

/* Normal force of a contact at rest, for the largest step: a body rests on two of them. */
static double resting_force(const strut_model *model) {
  const strut_contact_table *c = &model->contacts;
  const double *g = model->scene->gravity;
  double mass = 0.0, down = -(g[0] * c->normal[0] + g[1] * c->normal[1]);
  for (int32_t i = 0; i < model->node_count; i++) mass += model->weight[i];
  return down > 0.0 ? mass * down / (c->count > 1 ? 2.0 : 1.0) : 0.0;
}

typedef struct assembly {
  const strut_model *model;
  const int32_t *row_of;
  strut_triplets stiffness, damping;
  double weight; /* on each contact [N] */
  bool undamped;
} assembly;

static void add_member(void *context, int32_t j, const strut_member_tangent *m) {
  assembly *a = context;
  double k = a->model->members.damping[j];
  strut_block stiffness = strut_block_of(m->along, m->across, m->pose.unit);
  strut_block damper = strut_block_of(k, 0.0, m->pose.unit);
  int32_t row[4];
  strut_member_rows(a->model, a->row_of, j, row);
  strut_block_add(&stiffness, STRUT_MEMBER_ENTRIES, row, &a->stiffness);
  if (k > 0) strut_block_add(&damper, STRUT_MEMBER_ENTRIES, row, &a->damping);
}

static void add_contact(void *context, int32_t i, const strut_closed_contact *contact) {
  assembly *a = context;
  const strut_contact_table *c = &a->model->contacts;
  const strut_contact_entry *e = &c->entry[i];
  const int32_t *row = a->row_of + c->at[i];
  double damper = a->undamped ? 0.0 : e->damping + a->weight * e->dissipation;
  double slide = e->law == STRUT_FRICTION_SMOOTH ? a->weight * e->mu_kinetic / e->width : 0.0;
  const double *n = c->normal, *t = c->tangent;
  strut_block stiffness = strut_block_of_contact(contact->stiffness, n), damping;
  for (int k = 0; k < STRUT_CONTACT_ENTRIES; k++) {
    const strut_block_entry *at = &strut_block_entries[k];
    damping.part[k] = damper * (n[at->row] * n[at->column]) + slide * t[at->row] * t[at->column];
  }
  strut_block_add(&stiffness, STRUT_CONTACT_ENTRIES, row, &a->stiffness);
  if (!a->undamped || slide > 0.0)
    strut_block_add(&damping, STRUT_CONTACT_ENTRIES, row, &a->damping);
}

strut_status strut_tangent_assemble(const strut_model *model, const double *q, const double *rest,
                                    strut_closed closed, strut_arena *arena,
                                    strut_tangent *tangent) {
  strut_arena scratch = {0};
  bool resting = closed == STRUT_CLOSED_ALL || closed == STRUT_CLOSED_UNDAMPED;
  size_t both = (size_t)model->length;
  size_t most = STRUT_MEMBER_ENTRIES * (size_t)model->members.count +
                STRUT_CONTACT_ENTRIES * (size_t)model->contacts.count;
  int32_t *row_of = strut_arena_allocate(&scratch, both, sizeof *row_of);
  assembly a = {.model = model, .row_of = row_of, .undamped = closed == STRUT_CLOSED_UNDAMPED};
  if (resting && (model->plan & STRUT_TERM_LAWS)) a.weight = resting_force(model);
  tangent->coordinate = strut_arena_allocate(arena, both, sizeof *tangent->coordinate);
  tangent->rigid = NULL;
  strut_status status = STRUT_NO_MEMORY;
  if (row_of && tangent->coordinate && strut_triplets_reserve(&a.stiffness, most, &scratch) &&
      strut_triplets_reserve(&a.damping, most, &scratch)) {
    tangent->n = strut_number_free(model, NULL, row_of, tangent->coordinate);
    strut_tangent_visit(model, q, rest, -HUGE_VAL, closed, &a, add_member, add_contact);
    tangent->stiffness = strut_sparse_build(tangent->n, &a.stiffness, arena);
    tangent->damping = strut_sparse_build(tangent->n, &a.damping, arena);
    if (tangent->stiffness && tangent->damping) status = STRUT_OK;
  }
  strut_arena_free(&scratch);
  return status;
}

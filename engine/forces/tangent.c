/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/tangent.h"

#include "engine/forces/capstan.h"
#include "engine/forces/rubbing.h"

#include <assert.h>

#include "engine/forces/mass_damping.h"

void strut_block_add(const strut_stiffness_block *b, int count, const int32_t *row,
                     strut_triplets *sum) {
  for (int k = 0; k < count; k++) {
    const strut_block_entry *e = &strut_block_entries[k];
    if (row[e->row] < 0 || row[e->column] < 0) continue;
    strut_triplets_add(sum, row[e->row], row[e->column],
                       e->opposite ? -b->part[e->part] : b->part[e->part]);
  }
}

void strut_element_add(const strut_model *model, int32_t element, const double *k,
                       const int32_t *row_of, strut_triplets *sum) {
  assert(element >= 0 && element < model->elements.count);
  const strut_element *e = &model->elements.element[element];
  const uint32_t *at = model->elements.at + e->first;
  int32_t n = 2 * e->nodes;
  for (int32_t r = 0; r < n; r++)
    for (int32_t c = 0; c <= r; c++) {
      int32_t row = row_of[at[r / 2] + (uint32_t)(r % 2)];
      int32_t column = row_of[at[c / 2] + (uint32_t)(c % 2)];
      if (row < 0 || column < 0) continue;
      /* a cable that comes back to a node meets the diagonal from both sides */
      strut_triplets_add(sum, row, column, (row == column && r != c ? 2.0 : 1.0) * k[r * n + c]);
    }
}

void strut_element_scatter(const strut_model *model, int32_t element, const double *k,
                           const int32_t *place, double *value) {
  assert(element >= 0 && element < model->elements.count);
  const strut_element *e = &model->elements.element[element];
  const uint32_t *at = model->elements.at + e->first;
  int32_t n = 2 * e->nodes;
  place += e->place;
  for (int32_t r = 0; r < n; r++)
    for (int32_t c = 0; c <= r; c++, place++) {
      bool both = r != c && at[r / 2] == at[c / 2] && r % 2 == c % 2;
      if (*place >= 0) value[*place] += (both ? 2.0 : 1.0) * k[r * n + c];
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
  const strut_stiffness_block zero = {{0}};
  for (int32_t j = 0; j < model->members.count; j++) {
    int32_t row[4];
    strut_member_rows(model, row_of, j, row);
    strut_block_add(&zero, STRUT_MEMBER_ENTRIES, row, sum);
  }
  const double none[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT] = {0};
  for (int32_t i = 0; i < model->elements.count; i++)
    strut_element_add(model, i, none, row_of, sum);
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

static int32_t place_of(const strut_sparse *pattern, int32_t a, int32_t b) {
  return a < 0 || b < 0 ? -1 : a > b ? find_place(pattern, a, b) : find_place(pattern, b, a);
}

static int32_t *find_places(const strut_sparse *pattern, int count, const int32_t *row,
                            int32_t *place) {
  for (int k = 0; k < count; k++) {
    *place++ =
        place_of(pattern, row[strut_block_entries[k].row], row[strut_block_entries[k].column]);
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
  for (int32_t i = 0; i < model->elements.count; i++) {
    const strut_element *e = &model->elements.element[i];
    const uint32_t *at = model->elements.at + e->first;
    for (int32_t r = 0; r < 2 * e->nodes; r++)
      for (int32_t c = 0; c <= r; c++)
        *place++ = place_of(pattern, row_of[at[r / 2] + (uint32_t)(r % 2)],
                            row_of[at[c / 2] + (uint32_t)(c % 2)]);
  }
  for (int32_t i = 0; i < model->contacts.count && contacts; i++)
    place = find_places(pattern, STRUT_CONTACT_ENTRIES, row_of + model->contacts.at[i], place);
}

/* Normal force of a contact at rest, for the largest step: a body rests on two of them. */
static double resting_force(const strut_model *model) {
  const strut_contact_table *c = &model->contacts;
  const double *g = model->scene->gravity;
  double mass = 0.0, down = -(g[0] * c->normal[0] + g[1] * c->normal[1]);
  if (c->surface) down = hypot(g[0], g[1]);
  for (int32_t i = 0; i < model->node_count; i++) mass += model->weight[i];
  return down > 0.0 ? mass * down / (c->count > 1 ? 2.0 : 1.0) : 0.0;
}

typedef struct assembly {
  const strut_model *model;
  const double *q;
  const int32_t *row_of;
  strut_triplets stiffness, damping;
  double weight; /* on each contact [N] */
  bool undamped;
  bool stiffest; /* whatever may hold does */
} assembly;

static void add_member(void *context, int32_t j, const strut_member_tangent *m) {
  assert(j >= 0 && m);
  assembly *a = context;
  double k = a->model->members.damping[j];
  strut_stiffness_block stiffness = strut_block_of(m->along, m->across, m->pose.unit);
  strut_stiffness_block damper = strut_block_of(k, 0.0, m->pose.unit);
  int32_t row[4];
  strut_member_rows(a->model, a->row_of, j, row);
  strut_block_add(&stiffness, STRUT_MEMBER_ENTRIES, row, &a->stiffness);
  if (k > 0) strut_block_add(&damper, STRUT_MEMBER_ENTRIES, row, &a->damping);
}

static void add_element(void *context, int32_t i, const strut_element_pose *pose) {
  assert(i >= 0 && pose);
  assembly *a = context;
  const strut_element *e = &a->model->elements.element[i];
  double k[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT];
  int32_t n = 2 * e->nodes;
  strut_element_stiffness(a->model, i, pose, a->q, k);
  if (a->stiffest && strut_has_capstan(e)) { /* a cable that sticks at its guides */
    strut_capstan_stiffness(a->model, i, a->q, k);
    strut_element_bend(a->model, i, a->q, pose->force, k);
  }
  strut_element_add(a->model, i, k, a->row_of, &a->stiffness);
  if (!(e->damping > 0.0)) return;
  for (int32_t r = 0; r < n; r++)
    for (int32_t c = 0; c < n; c++) k[r * n + c] = e->damping * pose->b[r] * pose->b[c];
  strut_element_add(a->model, i, k, a->row_of, &a->damping);
}

static void add_contact(void *context, int32_t i, const strut_closed_contact *contact) {
  assert(i >= 0 && contact);
  assembly *a = context;
  const strut_contact_table *c = &a->model->contacts;
  const strut_contact_entry *e = &c->entry[i];
  const int32_t *row = a->row_of + c->at[i];
  double damper = a->undamped ? 0.0 : e->damping + a->weight * e->dissipation;
  double slide = strut_friction_slope(&e->friction, a->weight);
  const double *n = contact->axes.normal, *t = contact->axes.tangent;
  strut_stiffness_block damping,
      stiffness = strut_block_of_pose(contact->stiffness, contact->across, &contact->axes);
  for (int k = 0; k < STRUT_CONTACT_ENTRIES; k++) {
    const strut_block_entry *at = &strut_block_entries[k];
    damping.part[k] = damper * (n[at->row] * n[at->column]) + slide * t[at->row] * t[at->column];
  }
  strut_block_add(&stiffness, STRUT_CONTACT_ENTRIES, row, &a->stiffness);
  if (!a->undamped || slide > 0.0)
    strut_block_add(&damping, STRUT_CONTACT_ENTRIES, row, &a->damping);
}

/* Maxwell branches, as stiff as they are in fast motions. */
static void add_maxwell(assembly *a, const double *rest) {
  const strut_feedback_table *f = &a->model->feedback;
  for (int32_t i = 0; i < f->maxwell_count; i++) {
    strut_member_pose pose =
        strut_member_pose_at(&a->model->members, rest, f->maxwell[i].member, a->q);
    strut_stiffness_block stiffness = strut_block_of(f->maxwell[i].stiffness, 0.0, pose.unit);
    int32_t row[4];
    strut_member_rows(a->model, a->row_of, f->maxwell[i].member, row);
    strut_block_add(&stiffness, STRUT_MEMBER_ENTRIES, row, &a->stiffness);
  }
}

/* Of the lower triangle of an element that rubs. */
enum { RUBBING_ENTRIES = STRUT_MOST_RUBBING * (STRUT_MOST_RUBBING + 1) / 2 };

/* Friction of feet, nodes and collisions that rest, as far as it is a damper or bristles. */
static void add_rubbing(assembly *a) {
  for (int32_t i = 0; i < a->model->rubbing.count; i++) {
    const strut_rubbing_entry *f = &a->model->rubbing.item[i];
    double b[STRUT_MOST_RUBBING], k[STRUT_MOST_RUBBING * STRUT_MOST_RUBBING];
    double slide = strut_friction_slope(&f->friction, resting_force(a->model));
    int32_t side = 2 * strut_rubbing_slide(a->model, i, a->q, b);
    for (int32_t r = 0; r < side * side; r++) k[r] = slide * b[r / side] * b[r % side];
    strut_element_add(a->model, f->element, k, a->row_of, &a->damping);
    double bend = strut_friction_stiffness(&f->friction, resting_force(a->model));
    for (int32_t r = 0; r < side * side; r++) k[r] = bend * b[r / side] * b[r % side];
    if (bend > 0.0) strut_element_add(a->model, f->element, k, a->row_of, &a->stiffness);
  }
}

/*
 * Contributions that are in memory at once: they take three times as much as the matrix that they add up to.
 * More are visited again for each stretch of columns.
 */
enum { MOST_AT_ONCE = 1 << 20 };

/* Collects the contributions to the columns [first, end). */
static void collect_columns(assembly *a, const double *rest, strut_closed closed, int32_t first,
                            int32_t end) {
  a->stiffness.count = a->damping.count = 0;
  a->stiffness.first = a->damping.first = first;
  a->stiffness.end = a->damping.end = end;
  strut_tangent_visit(a->model, a->q, rest, -HUGE_VAL, closed, a, add_member, add_element,
                      add_contact);
  if (a->stiffest) add_maxwell(a, rest);
  if (a->stiffest) add_rubbing(a);
  strut_mass_damping_add(a->model, a->row_of, &a->damping);
}

/* Builds both matrices a stretch of columns at a time. */
static bool build_by_stretches(assembly *a, const double *rest, strut_closed closed,
                               strut_arena *arena, strut_tangent *tangent) {
  a->stiffness.counting = a->damping.counting = true;
  collect_columns(a, rest, closed, 0, tangent->n);
  a->stiffness.counting = a->damping.counting = false;
  int32_t n = tangent->n, stretches = (int32_t)(a->stiffness.count / MOST_AT_ONCE) + 1;
  int32_t columns = n / stretches + 1;
  tangent->stiffness = strut_sparse_begin(n, a->stiffness.count, arena);
  tangent->damping = strut_sparse_begin(n, a->damping.count, arena);
  if (!tangent->stiffness || !tangent->damping) return false;
  for (int32_t first = 0; first < n; first += columns) {
    collect_columns(a, rest, closed, first, n - first < columns ? n : first + columns);
    strut_sparse_append(tangent->stiffness, &a->stiffness);
    strut_sparse_append(tangent->damping, &a->damping);
  }
  return true;
}

static bool build_at_once(assembly *a, const double *rest, strut_closed closed, strut_arena *arena,
                          strut_tangent *tangent) {
  collect_columns(a, rest, closed, 0, tangent->n);
  tangent->stiffness = strut_sparse_build(tangent->n, &a->stiffness, arena);
  tangent->damping = strut_sparse_build(tangent->n, &a->damping, arena);
  return tangent->stiffness && tangent->damping;
}

strut_status strut_tangent_assemble(const strut_model *model, const double *q, const double *rest,
                                    strut_closed closed, strut_arena *arena,
                                    strut_tangent *tangent) {
  strut_arena scratch = {0};
  bool resting = closed == STRUT_CLOSED_ALL || closed == STRUT_CLOSED_UNDAMPED;
  size_t both = (size_t)model->length;
  size_t most = strut_tangent_entries(model, true) + strut_mass_damping_entries(model) +
                STRUT_MEMBER_ENTRIES * (size_t)model->feedback.maxwell_count +
                RUBBING_ENTRIES * (size_t)model->rubbing.count;
  int32_t *row_of = strut_arena_allocate(&scratch, both, sizeof *row_of);
  assembly a = {
      .model = model, .q = q, .row_of = row_of, .undamped = closed == STRUT_CLOSED_UNDAMPED};
  a.stiffest = closed == STRUT_CLOSED_ALL || closed == STRUT_CLOSED_UNDAMPED;
  if (resting && (model->terms & STRUT_TERM_LAWS)) a.weight = resting_force(model);
  tangent->coordinate = strut_arena_allocate(arena, both, sizeof *tangent->coordinate);
  tangent->rigid = NULL;
  strut_status status = STRUT_NO_MEMORY;
  if (row_of && tangent->coordinate && strut_triplets_reserve(&a.stiffness, most, &scratch) &&
      strut_triplets_reserve(&a.damping, most, &scratch)) {
    tangent->n = strut_number_free(model, NULL, row_of, tangent->coordinate);
    if (most > MOST_AT_ONCE ? build_by_stretches(&a, rest, closed, arena, tangent)
                            : build_at_once(&a, rest, closed, arena, tangent))
      status = STRUT_OK;
  }
  strut_arena_free(&scratch);
  return status;
}

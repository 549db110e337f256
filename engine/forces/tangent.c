/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/tangent.h"

#include <assert.h>
#include <string.h>

#include "engine/forces/capstan.h"
#include "engine/forces/surfaces.h"

#include "engine/base/indices.h"
#include "engine/forces/nearby.h"
#include "engine/model/mass.h"

void strut_force_begin(const strut_model *model, int32_t number, strut_force *force) {
  int32_t members = model->members.count, element = number - members;
  int32_t contact = element - model->elements.count;
  if (number < members) {
    force->kind = STRUT_FORCE_MEMBER, force->index = number, force->nodes = 2;
    force->end[0] = model->members.from[number], force->end[1] = model->members.to[number];
    force->at = force->end;
    force->place = 10 * number, force->damping = model->members.damping[number];
  } else if (contact < 0) {
    const strut_element *own = &model->elements.element[element];
    force->kind = STRUT_FORCE_ELEMENT, force->index = element, force->nodes = own->nodes;
    force->at = model->elements.at + own->first;
    force->place = 10 * members + own->place, force->damping = own->damping;
    force->across = 0.0;
  } else {
    force->kind = STRUT_FORCE_CONTACT, force->index = contact, force->nodes = 1;
    force->at = &model->contacts.at[contact];
    force->place = (int32_t)strut_tangent_entries(model, false) + 3 * contact;
    force->damping = model->contacts.entry[contact].damping;
  }
}

void strut_force_set_member(double stiffness, double across, strut_vec2 unit, double length,
                            double stretch, strut_force *force) {
  const double side[4] = {unit.y, -unit.x, -unit.y, unit.x};
  force->pose.strain = length, force->pose.natural = length - stretch;
  force->pose.force = stiffness * stretch, force->pose.slope = stiffness;
  force->pose.b[0] = -unit.x, force->pose.b[1] = -unit.y;
  force->pose.b[2] = unit.x, force->pose.b[3] = unit.y;
  memcpy(force->side, side, sizeof side);
  force->across = across;
}

void strut_force_set_contact(double stiffness, const strut_contact_pose *pose, strut_force *force) {
  force->pose.strain = pose->gap, force->pose.natural = 0.0;
  force->pose.force = stiffness * pose->gap, force->pose.slope = stiffness;
  memcpy(force->pose.b, pose->axes.normal, 2 * sizeof(double));
  memcpy(force->side, pose->axes.tangent, 2 * sizeof(double));
  bool bends = pose->gap < 0.0 && pose->curvature != 0.0;
  force->across = bends ? stiffness * pose->gap * pose->curvature : 0.0;
}

/* Does the member carry a force, of more than `least` if it is a cable? */
static bool visit_member(const strut_force_visit *visit, strut_force *force) {
  const strut_member_table *members = &visit->model->members;
  int32_t j = force->index;
  strut_member_pose pose = strut_member_pose_at(members, visit->rest, j, visit->q);
  if (!pose.taut ||
      (members->slack[j] == 0.0 && members->stiffness[j] * pose.stretch <= visit->least))
    return false;
  strut_force_set_member(members->stiffness[j],
                         strut_member_across_stiffness(members, visit->rest, j, &pose), pose.unit,
                         pose.length, pose.stretch, force);
  return true;
}

/* Stops and collisions that count as closed but do not act are as if at their kink. */
static bool visit_element(const strut_force_visit *visit, strut_force *force) {
  const strut_model *model = visit->model;
  const strut_element *own = &model->elements.element[force->index];
  bool stops = visit->closed == STRUT_CLOSED_ALL || visit->closed == STRUT_CLOSED_UNDAMPED;
  if (model->elements.scattered && !(stops && own->crowds) &&
      strut_nearby_is_far(model, force->index, visit->q, stops))
    return false;
  strut_element_evaluate(model, force->index, visit->rest, visit->q, (double)NAN, &force->pose);
  bool stop = own->role == STRUT_ELEMENT_LONGEST || own->role == STRUT_ELEMENT_SHORTEST ||
              own->role == STRUT_ELEMENT_COLLISION || own->strain == STRUT_STRAIN_FOOT;
  if (stops && stop && !force->pose.acts) {
    force->pose.acts = true;
    force->pose.slope = own->numbers.stiffness;
    return true;
  }
  return force->pose.acts && !(own->carries && fabs(force->pose.force) <= visit->least);
}

static bool visit_contact(strut_force_visit *visit, strut_force *force) {
  const strut_contact_table *contacts = &visit->model->contacts;
  int32_t i = force->index;
  bool touching = visit->closed == STRUT_CLOSED_TOUCHING;
  if (contacts->surface && !touching) {
    if (i == visit->surface_end)
      visit->surface_end = strut_contacts_nearest(contacts, i, visit->q, visit->near);
    if (i != visit->near[0] && i != visit->near[1]) return false;
  }
  strut_contact_pose pose = strut_contact_pose_at(contacts, i, visit->q, NULL, -1);
  if (touching && (!(pose.gap < 0.0) || -contacts->entry[i].stiffness * pose.gap <= visit->least))
    return false;
  strut_force_set_contact(contacts->entry[i].stiffness, &pose, force);
  return true;
}

const strut_force *strut_force_next(strut_force_visit *visit) {
  strut_force *force = &visit->now;
  int32_t count = strut_force_count(visit->model, visit->closed != STRUT_CLOSED_NONE);
  while (visit->next < count) {
    strut_force_begin(visit->model, visit->next++, force);
    if (force->kind == STRUT_FORCE_MEMBER    ? visit_member(visit, force)
        : force->kind == STRUT_FORCE_ELEMENT ? visit_element(visit, force)
                                             : visit_contact(visit, force))
      return force;
  }
  return NULL;
}

/* The products of members and contacts are made in the order that their steps have always had. */
void strut_force_square(const strut_force *force, double factor, double *matrix) {
  const double *b = force->pose.b;
  bool turned = force->kind != STRUT_FORCE_ELEMENT;
  int32_t n = 2 * force->nodes;
  for (int32_t r = 0; r < n; r++)
    for (int32_t c = 0; c < n; c++)
      matrix[r * n + c] = turned ? factor * b[c] * b[r] : factor * b[r] * b[c];
}

void strut_force_bend(const strut_model *model, const strut_force *force, const double *q,
                      double factor, double *matrix) {
  const double *side = force->side;
  int32_t n = 2 * force->nodes;
  if (force->kind == STRUT_FORCE_ELEMENT)
    strut_element_bend(model, force->index, q, factor * force->pose.force, matrix);
  else if (force->across != 0.0)
    for (int32_t r = 0; r < n; r++)
      for (int32_t c = 0; c < n; c++)
        matrix[r * n + c] += factor * force->across * side[c] * side[r];
}

void strut_force_stiffness(const strut_model *model, const strut_force *force, const double *q,
                           double *matrix) {
  const strut_vec2 unit = {force->pose.b[2], force->pose.b[3]};
  if (force->kind == STRUT_FORCE_MEMBER) {
    strut_member_stiffness(force->pose.slope, force->across, unit, matrix);
    return;
  }
  strut_force_square(force, force->pose.slope, matrix);
  strut_force_bend(model, force, q, 1.0, matrix);
}

void strut_force_add(const strut_force *force, const double *matrix, const int32_t *row_of,
                     strut_triplets *sum) {
  int32_t n = 2 * force->nodes;
  for (int32_t r = 0; r < n; r++)
    for (int32_t c = 0; c <= r; c++) {
      int32_t row = row_of[strut_force_coordinate(force, r)];
      int32_t column = row_of[strut_force_coordinate(force, c)];
      if (row < 0 || column < 0) continue;
      /* a cable that comes back to a node meets the diagonal from both sides */
      double both = row == column && r != c ? 2.0 : 1.0;
      strut_triplets_add(sum, row, column, both * matrix[r * n + c]);
    }
}

/* A place k on the diagonal that an entry meets from both sides is BOTH - k. */
enum { BOTH = -2 };

void strut_force_scatter(const strut_force *force, const double *matrix, const int32_t *place,
                         double *value) {
  int32_t n = 2 * force->nodes;
  place += force->place;
  for (int32_t r = 0; r < n; r++)
    for (int32_t c = 0; c <= r; c++, place++)
      if (*place >= 0)
        value[*place] += matrix[r * n + c];
      else if (*place <= BOTH)
        value[BOTH - *place] += 2.0 * matrix[r * n + c];
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
  const double none[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT] = {0};
  strut_force force;
  for (int32_t k = 0; k < strut_force_count(model, contacts); k++) {
    strut_force_begin(model, k, &force);
    strut_force_add(&force, none, row_of, sum);
  }
}

/* Index of entry (row, column) among the pattern's values; the entry exists. */
static int32_t find_place(const strut_sparse *pattern, int32_t row, int32_t column) {
  int32_t begin = pattern->start[column], end = pattern->start[column + 1];
  int32_t place = begin + strut_index_find(pattern->row + begin, end - begin, row);
  assert(place < end && pattern->row[place] == row);
  return place;
}

static int32_t place_of(const strut_sparse *pattern, int32_t a, int32_t b, bool diagonal) {
  if (a < 0 || b < 0) return -1;
  int32_t place = a > b ? find_place(pattern, a, b) : find_place(pattern, b, a);
  return a == b && !diagonal ? BOTH - place : place;
}

void strut_tangent_find_places(const strut_model *model, const int32_t *row_of, bool contacts,
                               const strut_sparse *pattern, int32_t *place) {
  strut_force force;
  for (int32_t k = 0; k < strut_force_count(model, contacts); k++) {
    strut_force_begin(model, k, &force);
    for (int32_t r = 0; r < 2 * force.nodes; r++)
      for (int32_t c = 0; c <= r; c++)
        *place++ = place_of(pattern, row_of[strut_force_coordinate(&force, r)],
                            row_of[strut_force_coordinate(&force, c)], r == c);
  }
}

/* Normal force of a contact at rest, for the largest step: a body rests on two of them. */
static double resting_force(const strut_model *model) {
  const strut_contact_table *contacts = &model->contacts;
  const double *g = model->scene->gravity;
  double mass = 0.0, down = -(g[0] * contacts->normal[0] + g[1] * contacts->normal[1]);
  if (contacts->surface) down = hypot(g[0], g[1]);
  for (int32_t i = 0; i < model->node_count; i++) mass += model->weight[i];
  return down > 0.0 ? mass * down / (contacts->count > 1 ? 2.0 : 1.0) : 0.0;
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

/* matrix: what damps a contact with the node's weight on it; false: nothing does. */
static bool damp_contact(const assembly *self, const strut_force *contact, double *matrix) {
  const strut_contact_entry *e = &self->model->contacts.entry[contact->index];
  double damper = self->undamped ? 0.0 : contact->damping + self->weight * e->dissipation;
  double slide = strut_friction_slope(&e->friction, self->weight);
  const double *n = contact->pose.b, *t = contact->side;
  for (int r = 0; r < 2; r++)
    for (int c = 0; c < 2; c++) matrix[2 * r + c] = damper * (n[r] * n[c]) + slide * t[r] * t[c];
  return !self->undamped || slide > 0.0;
}

static void add_force(assembly *self, const strut_force *force) {
  double matrix[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT];
  const strut_element *element =
      force->kind == STRUT_FORCE_ELEMENT ? &self->model->elements.element[force->index] : NULL;
  strut_force_stiffness(self->model, force, self->q, matrix);
  if (self->stiffest && element && strut_has_capstan(element)) { /* sticks at guides */
    strut_capstan_stiffness(self->model, force->index, self->q, matrix);
    strut_force_bend(self->model, force, self->q, 1.0, matrix);
  }
  strut_force_add(force, matrix, self->row_of, &self->stiffness);
  bool damps =
      force->kind == STRUT_FORCE_CONTACT ? damp_contact(self, force, matrix) : force->damping > 0.0;
  if (damps && force->kind != STRUT_FORCE_CONTACT)
    strut_force_square(force, force->damping, matrix);
  if (damps) strut_force_add(force, matrix, self->row_of, &self->damping);
}

/* Maxwell branches, as stiff as they are in fast motions. */
static void add_maxwell(assembly *self, const double *rest) {
  const strut_feedback_table *feedback = &self->model->feedback;
  strut_force force;
  double matrix[16];
  for (int32_t i = 0; i < feedback->maxwell_count; i++) {
    strut_force_begin(self->model, feedback->maxwell[i].member, &force);
    strut_member_pose pose =
        strut_member_pose_at(&self->model->members, rest, force.index, self->q);
    strut_member_stiffness(feedback->maxwell[i].stiffness, 0.0, pose.unit, matrix);
    strut_force_add(&force, matrix, self->row_of, &self->stiffness);
  }
}

/* Of the lower triangle of an element that rubs. */
enum { RUBBING_ENTRIES = STRUT_MOST_RUBBING * (STRUT_MOST_RUBBING + 1) / 2 };

/* Friction of feet, nodes and collisions that rest, as far as it is a damper or bristles. */
static void add_rubbing(assembly *self) {
  for (int32_t i = 0; i < self->model->rubbing.count; i++) {
    const strut_rubbing_entry *entry = &self->model->rubbing.item[i];
    double b[STRUT_MOST_RUBBING], k[STRUT_MOST_RUBBING * STRUT_MOST_RUBBING];
    double slide = strut_friction_slope(&entry->friction, resting_force(self->model));
    strut_force force;
    strut_force_begin(self->model, self->model->members.count + entry->element, &force);
    int32_t side = 2 * strut_rubbing_slide(self->model, i, self->q, b);
    for (int32_t r = 0; r < side * side; r++) k[r] = slide * b[r / side] * b[r % side];
    strut_force_add(&force, k, self->row_of, &self->damping);
    double bend = strut_friction_stiffness(&entry->friction, resting_force(self->model));
    for (int32_t r = 0; r < side * side; r++) k[r] = bend * b[r / side] * b[r % side];
    if (bend > 0.0) strut_force_add(&force, k, self->row_of, &self->stiffness);
  }
}

static bool build(assembly *self, const double *rest, strut_closed closed, strut_arena *arena,
                  strut_tangent *tangent) {
  strut_force_visit visit = {
      .model = self->model, .q = self->q, .rest = rest, .least = -HUGE_VAL, .closed = closed};
  for (const strut_force *force; (force = strut_force_next(&visit));) add_force(self, force);
  if (self->stiffest) add_maxwell(self, rest);
  if (self->stiffest) add_rubbing(self);
  if (self->model->terms & STRUT_TERM_MASS_DAMPING)
    strut_mass_add(self->model, self->row_of, self->model->mass_damping, true, &self->damping);
  tangent->stiffness = strut_sparse_build(tangent->n, &self->stiffness, arena);
  tangent->damping = strut_sparse_build(tangent->n, &self->damping, arena);
  return tangent->stiffness && tangent->damping;
}

strut_status strut_tangent_assemble(const strut_model *model, const double *q, const double *rest,
                                    strut_closed closed, strut_arena *arena,
                                    strut_tangent *tangent) {
  strut_arena scratch = {0};
  size_t both = (size_t)model->length;
  size_t most = strut_tangent_entries(model, true) + strut_mass_entries(model) +
                10 * (size_t)model->feedback.maxwell_count +
                RUBBING_ENTRIES * (size_t)model->rubbing.count;
  int32_t *row_of = strut_arena_allocate(&scratch, both, sizeof *row_of);
  assembly a = {
      .model = model, .q = q, .row_of = row_of, .undamped = closed == STRUT_CLOSED_UNDAMPED};
  a.stiffest = closed == STRUT_CLOSED_ALL || closed == STRUT_CLOSED_UNDAMPED;
  if (a.stiffest && (model->terms & STRUT_TERM_LAWS)) a.weight = resting_force(model);
  tangent->coordinate = strut_arena_allocate(arena, both, sizeof *tangent->coordinate);
  tangent->rigid = NULL;
  strut_status status = STRUT_NO_MEMORY;
  if (row_of && tangent->coordinate && strut_triplets_reserve(&a.stiffness, most, &scratch) &&
      strut_triplets_reserve(&a.damping, most, &scratch)) {
    tangent->n = strut_number_free(model, NULL, row_of, tangent->coordinate);
    if (build(&a, rest, closed, arena, tangent)) status = STRUT_OK;
  }
  strut_arena_free(&scratch);
  return status;
}

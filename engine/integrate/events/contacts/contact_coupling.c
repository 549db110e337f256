/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/events/contacts/contact_coupling.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/integrate/events/contacts/implicit_ground.h"
#include "engine/model/dense_cholesky.h"

/* 1 + the contact of each node, or 0, into `owner`; false where a node has two. */
static bool find_owners(const strut_model *model, int32_t *owner) {
  const strut_contact_table *c = &model->contacts;
  for (int32_t i = 0; i < c->count; i++) {
    if (owner[c->at[i] / 2]) return false;
    owner[c->at[i] / 2] = i + 1;
  }
  return true;
}

static bool make_rows(const strut_model *model, strut_arena *arena, const strut_event_stepper *l,
                      const int32_t *owner, struct strut_contact_coupling *p) {
  int32_t contacts = model->contacts.count;
  p->start = strut_arena_allocate(arena, (size_t)contacts + 1, sizeof *p->start);
  for (int32_t i = 0; i < contacts && p->start; i++) {
    p->start[i + 1] = p->start[i];
    for (int32_t k = 0; k < l->response[i].count; k++)
      p->start[i + 1] += owner[l->response[i].at[k] / 2] > 0;
  }
  if (!p->start) return false;
  p->other = strut_arena_allocate(arena, p->start[contacts], sizeof *p->other);
  p->xy = strut_arena_allocate(arena, 2 * p->start[contacts], sizeof *p->xy);
  if (!p->other || !p->xy) return false;
  for (int32_t i = 0; i < contacts; i++) {
    const strut_contact_compliance *r = &l->response[i];
    size_t e = p->start[i];
    for (int32_t k = 0; k < r->count; k++) {
      int32_t other = owner[r->at[k] / 2] - 1;
      if (other < 0) continue;
      p->other[e] = other;
      p->xy[2 * e] = r->xy[2 * k], p->xy[2 * e + 1] = r->xy[2 * k + 1];
      e++;
    }
  }
  return true;
}

static bool make_scratch(const strut_model *model, strut_arena *arena, const strut_event_stepper *l,
                         struct strut_contact_coupling *p) {
  size_t contacts = (size_t)model->contacts.count, length = (size_t)model->length,
         room = (size_t)l->stuck_room;
  double **several[] = {&p->into, &p->along, &p->normal, &p->shear};
  double **whole[] = {&p->force, &p->answer, &p->work};
  bool good = true;
  for (size_t k = 0; k < sizeof several / sizeof *several && good; k++)
    good = (*several[k] = strut_arena_allocate(arena, contacts, sizeof(double)));
  for (size_t k = 0; k < sizeof whole / sizeof *whole && good; k++)
    good = (*whole[k] = strut_arena_allocate(arena, length, sizeof(double)));
  p->place = strut_arena_allocate(arena, contacts, sizeof *p->place);
  p->first = strut_arena_allocate(arena, room, sizeof *p->first);
  p->factored = strut_arena_allocate(arena, room, sizeof *p->factored);
  return good && p->place && p->first && p->factored;
}

strut_status strut_contact_coupling_create(const strut_model *model, strut_state *state,
                                           strut_event_stepper *l) {
  bool fixed = !model->contacts.surface && !(model->terms & STRUT_TERM_SLIDING_MASS);
  if (model->contacts.count < STRUT_MANY_CONTACTS || !fixed) return STRUT_OK;
  int32_t *owner = strut_allocate((size_t)model->node_count, sizeof *owner);
  struct strut_contact_coupling *p = strut_arena_allocate(&state->arena, 1, sizeof *p);
  bool good = owner && p;
  bool single = good && find_owners(model, owner);
  if (single) good = make_rows(model, &state->arena, l, owner, p);
  if (single && good) good = make_scratch(model, &state->arena, l, p);
  if (single && good) l->coupling = p;
  strut_release(owner);
  return good ? STRUT_OK : STRUT_NO_MEMORY;
}

/* ---- T' M^-1 T of the stuck contacts, row by row from the first entry that is not 0 ---- */

static bool is_factored(const struct strut_contact_coupling *p, const strut_event_stepper *l) {
  size_t bytes = (size_t)l->stuck_count * sizeof *l->stuck;
  return p->factored_count == l->stuck_count && memcmp(p->factored, l->stuck, bytes) == 0;
}

/* The matrix into the factor's place; p->place must be 0, and is again. */
static void assemble_stuck(const strut_contact_table *c, const strut_event_stepper *l,
                           struct strut_contact_coupling *p) {
  int32_t n = l->stuck_count;
  double *f = l->stuck_factor;
  const double *t = c->tangent;
  for (int32_t j = 0; j < n; j++) p->place[l->stuck[j]] = j + 1, p->first[j] = j;
  for (int32_t j = 0; j < n; j++)
    for (size_t e = p->start[l->stuck[j]]; e < p->start[l->stuck[j] + 1]; e++) {
      int32_t i = p->place[p->other[e]] - 1;
      if (i >= j && j < p->first[i]) p->first[i] = j;
    }
  for (int32_t i = 0; i < n; i++)
    for (int32_t j = p->first[i]; j <= i; j++) f[i * n + j] = 0.0;
  for (int32_t j = 0; j < n; j++)
    for (size_t e = p->start[l->stuck[j]]; e < p->start[l->stuck[j] + 1]; e++) {
      int32_t i = p->place[p->other[e]] - 1;
      const double *xy = p->xy + 2 * e;
      if (i >= j) f[i * n + j] = xy[0] * t[0] * t[0] + xy[1] * t[1] * t[1];
    }
  for (int32_t j = 0; j < n; j++) p->place[l->stuck[j]] = 0;
}

void strut_contact_coupling_factor(const strut_model *model, strut_event_stepper *l) {
  struct strut_contact_coupling *p = l->coupling;
  if (is_factored(p, l)) return;
  assemble_stuck(&model->contacts, l, p);
  p->factored_count = l->stuck_count;
  memcpy(p->factored, l->stuck, (size_t)l->stuck_count * sizeof *l->stuck);
  if (strut_cholesky_factor(l->stuck_count, p->first, l->stuck_factor)) return;
  p->factored_count = 0;
  l->stuck_count = -l->stuck_count; /* singular: by sweeps */
}

void strut_contact_coupling_solve(const strut_event_stepper *l, double *x) {
  strut_cholesky_solve_rows(l->stuck_count, l->coupling->first, l->stuck_factor, x);
}

/* ---- forces on contacts, to the whole structure ---- */

static void add_force(const strut_contact_table *c, int32_t i, double normal, double shear,
                      double *force) {
  assert(i >= 0 && i < c->count);
  force[c->at[i]] += shear * c->tangent[0] + normal * c->normal[0];
  force[c->at[i] + 1] += shear * c->tangent[1] + normal * c->normal[1];
}

/* a += M^-1 p->force, which is 0 afterwards but for what is not on closed contacts. */
static void answer(const strut_model *model, const strut_event_stepper *l, double *a) {
  const struct strut_contact_coupling *p = l->coupling;
  strut_mass_solve(model, p->force, p->answer, p->work);
  for (int32_t i = 0; i < model->length; i++) a[i] += p->answer[i];
  for (int32_t k = 0; k < l->closed_count; k++) {
    uint32_t at = model->contacts.at[l->closed[k]];
    p->force[at] = p->force[at + 1] = 0.0;
  }
}

void strut_contact_coupling_push(const strut_model *model, const strut_event_stepper *l,
                                 const double *x, double *a) {
  const struct strut_contact_coupling *p = l->coupling;
  for (int32_t k = 0; k < l->stuck_count; k++)
    add_force(&model->contacts, l->stuck[k], 0.0, x[k], p->force);
  answer(model, l, a);
}

/* ---- implicit ground dampers ---- */

/* Contact i is pushed by so much more: the accelerations of all contacts answer. */
static void push_contact(const strut_contact_table *c, struct strut_contact_coupling *p, int32_t i,
                         double normal, double shear) {
  assert(i >= 0 && i < c->count);
  const double *n = c->normal, *t = c->tangent;
  double fx = shear * t[0] + normal * n[0], fy = shear * t[1] + normal * n[1];
  p->normal[i] += normal, p->shear[i] += shear;
  for (size_t e = p->start[i]; e < p->start[i + 1]; e++) {
    double x = p->xy[2 * e] * fx, y = p->xy[2 * e + 1] * fy;
    p->into[p->other[e]] += x * n[0] + y * n[1];
    p->along[p->other[e]] += x * t[0] + y * t[1];
  }
}

static void sweep_dampers(const strut_model *model, strut_event_stepper *l, double h) {
  const strut_contact_table *c = &model->contacts;
  struct strut_contact_coupling *p = l->coupling;
  const strut_touch *touch = l->next->touch, *before = l->now->touch;
  for (int sweep = 0; sweep < 40; sweep++) {
    double changed = 0.0, largest = 0.0;
    for (int32_t k = 0; k < l->closed_count; k++) {
      int32_t i = l->closed[k];
      const strut_contact_entry *e = &l->entry[i];
      double half = 0.5 * h * l->response[i].normal;
      double speed = before[i].into + 0.5 * h * (before[i].into_rate + p->into[i]);
      double damped =
          implicit_damper(e, -e->stiffness * touch[i].gap, speed - half * l->damped[i], half);
      double more = damped - l->damped[i];
      l->damped[i] = damped;
      if (more != 0.0) push_contact(c, p, i, more, 0.0);
      changed = fmax(changed, fabs(more));
      largest = fmax(largest, fabs(touch[i].normal));
    }
    if (changed <= 1e-15 * largest) break;
  }
}

/* Friction again with the whole normal force. */
static void renew_friction(const strut_model *model, strut_event_stepper *l) {
  const strut_contact_table *c = &model->contacts;
  for (int32_t k = 0; k < l->closed_count; k++) {
    int32_t i = l->closed[k];
    strut_touch *o = &l->next->touch[i];
    o->normal = -l->entry[i].stiffness * o->gap + l->damped[i];
    if (l->mode[i] == STRUT_MODE_STICK || l->mode[i] == STRUT_MODE_CREEP) continue;
    double friction =
        friction_in_mode(&l->entry[i], l->mode[i], l->side[i], o->normal, o->slip, o->applied);
    if (friction != o->friction) push_contact(c, l->coupling, i, 0.0, friction - o->friction);
    o->friction = friction;
  }
}

/* The multipliers of stuck contacts, among the contacts alone. */
static void hold_contacts(const strut_model *model, strut_event_stepper *l) {
  struct strut_contact_coupling *p = l->coupling;
  int32_t n = l->stuck_count;
  double *x = l->stuck_work;
  for (int32_t k = 0; k < n; k++) x[k] = -p->along[l->stuck[k]];
  if (n == 1)
    x[0] /= l->response[l->stuck[0]].tangent;
  else
    strut_contact_coupling_solve(l, x);
  for (int32_t k = 0; k < n; k++) {
    l->next->touch[l->stuck[k]].friction += x[k];
    push_contact(&model->contacts, p, l->stuck[k], 0.0, x[k]);
  }
}

void strut_contact_coupling_ground(const strut_model *model, strut_event_stepper *l, double h,
                                   double *a1) {
  const strut_contact_table *c = &model->contacts;
  struct strut_contact_coupling *p = l->coupling;
  for (int32_t k = 0; k < l->closed_count; k++) {
    int32_t i = l->closed[k];
    p->into[i] = strut_contact_along_normal(c, i, a1);
    p->along[i] = strut_contact_along_ground(c, i, a1);
    p->normal[i] = p->shear[i] = l->damped[i] = 0.0;
  }
  for (int pass = 0; pass < l->passes; pass++) {
    sweep_dampers(model, l, h);
    renew_friction(model, l);
    if (l->stuck_count > 0) hold_contacts(model, l);
  }
  for (int32_t k = 0; k < l->closed_count; k++)
    add_force(c, l->closed[k], p->normal[l->closed[k]], p->shear[l->closed[k]], p->force);
  answer(model, l, a1);
  if (l->stuck_count) strut_solve_stick_constraints(model, l, a1, l->next); /* what rounding left */
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/events/contacts/contact_coupling.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/integrate/events/contacts/implicit_ground.h"
#include "engine/model/algebra/dense_cholesky.h"

/* 1 + the contact of each node, or 0, into `owner`; false where a node has two. */
static bool find_owners(const strut_model *model, int32_t *owner) {
  const strut_contact_table *c = &model->contacts;
  for (int32_t i = 0; i < c->count; i++) {
    if (owner[c->at[i] / 2]) return false;
    owner[c->at[i] / 2] = i + 1;
  }
  return true;
}

static bool make_rows(const strut_model *model, strut_arena *arena,
                      const strut_event_stepper *stepper, const int32_t *owner,
                      struct strut_contact_coupling *p) {
  int32_t contacts = model->contacts.count;
  p->start = strut_arena_allocate(arena, (size_t)contacts + 1, sizeof *p->start);
  for (int32_t i = 0; i < contacts && p->start; i++) {
    p->start[i + 1] = p->start[i];
    for (int32_t k = 0; k < stepper->contacts.compliance[i].count; k++)
      p->start[i + 1] += owner[stepper->contacts.compliance[i].at[k] / 2] > 0;
  }
  if (!p->start) return false;
  p->other = strut_arena_allocate(arena, p->start[contacts], sizeof *p->other);
  p->xy = strut_arena_allocate(arena, 2 * p->start[contacts], sizeof *p->xy);
  if (!p->other || !p->xy) return false;
  for (int32_t i = 0; i < contacts; i++) {
    const strut_contact_compliance *r = &stepper->contacts.compliance[i];
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

static bool make_scratch(const strut_model *model, strut_arena *arena,
                         const strut_event_stepper *stepper, struct strut_contact_coupling *p) {
  size_t contacts = (size_t)model->contacts.count, length = (size_t)model->length,
         room = (size_t)stepper->active.stuck_room;
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
                                           strut_event_stepper *stepper) {
  bool fixed = !model->contacts.surface && !(model->terms & STRUT_TERM_SLIDING_MASS);
  if (model->contacts.count < STRUT_MANY_CONTACTS || !fixed) return STRUT_OK;
  int32_t *owner = strut_allocate((size_t)model->node_count, sizeof *owner);
  struct strut_contact_coupling *p = strut_arena_allocate(&state->arena, 1, sizeof *p);
  bool good = owner && p;
  bool single = good && find_owners(model, owner);
  if (single) good = make_rows(model, &state->arena, stepper, owner, p);
  if (single && good) good = make_scratch(model, &state->arena, stepper, p);
  if (single && good) stepper->contacts.coupling = p;
  strut_release(owner);
  return good ? STRUT_OK : STRUT_NO_MEMORY;
}

/* ---- T' M^-1 T of the stuck contacts, row by row from the first entry that is not 0 ---- */

static bool is_factored(const struct strut_contact_coupling *p,
                        const strut_event_stepper *stepper) {
  const strut_active_set *active = &stepper->active;
  size_t bytes = (size_t)active->stuck_count * sizeof *active->stuck;
  return p->factored_count == active->stuck_count && memcmp(p->factored, active->stuck, bytes) == 0;
}

/* The matrix into the factor's place; p->place must be 0, and is again. */
static void assemble_stuck(const strut_contact_table *c, const strut_event_stepper *stepper,
                           struct strut_contact_coupling *p) {
  const strut_active_set *active = &stepper->active;
  int32_t n = active->stuck_count;
  double *f = active->factor;
  const double *t = c->tangent;
  for (int32_t j = 0; j < n; j++) p->place[active->stuck[j]] = j + 1, p->first[j] = j;
  for (int32_t j = 0; j < n; j++)
    for (size_t e = p->start[active->stuck[j]]; e < p->start[active->stuck[j] + 1]; e++) {
      int32_t i = p->place[p->other[e]] - 1;
      if (i >= j && j < p->first[i]) p->first[i] = j;
    }
  for (int32_t i = 0; i < n; i++)
    for (int32_t j = p->first[i]; j <= i; j++) f[i * n + j] = 0.0;
  for (int32_t j = 0; j < n; j++)
    for (size_t e = p->start[active->stuck[j]]; e < p->start[active->stuck[j] + 1]; e++) {
      int32_t i = p->place[p->other[e]] - 1;
      const double *xy = p->xy + 2 * e;
      if (i >= j) f[i * n + j] = xy[0] * t[0] * t[0] + xy[1] * t[1] * t[1];
    }
  for (int32_t j = 0; j < n; j++) p->place[active->stuck[j]] = 0;
}

void strut_contact_coupling_factor(const strut_model *model, strut_event_stepper *stepper) {
  strut_active_set *active = &stepper->active;
  struct strut_contact_coupling *p = stepper->contacts.coupling;
  if (is_factored(p, stepper)) return;
  assemble_stuck(&model->contacts, stepper, p);
  p->factored_count = active->stuck_count;
  memcpy(p->factored, active->stuck, (size_t)active->stuck_count * sizeof *active->stuck);
  if (strut_cholesky_factor(active->stuck_count, p->first, active->factor)) return;
  p->factored_count = 0;
  active->stuck_count = -active->stuck_count; /* singular: by sweeps */
}

void strut_contact_coupling_solve(const strut_event_stepper *stepper, double *x) {
  strut_cholesky_solve_rows(stepper->active.stuck_count, stepper->contacts.coupling->first,
                            stepper->active.factor, x);
}

/* ---- forces on contacts, to the whole structure ---- */

static void add_force(const strut_contact_table *c, int32_t i, double normal, double shear,
                      double *force) {
  assert(i >= 0 && i < c->count);
  force[c->at[i]] += shear * c->tangent[0] + normal * c->normal[0];
  force[c->at[i] + 1] += shear * c->tangent[1] + normal * c->normal[1];
}

/* a += M^-1 p->force, which is 0 afterwards but for what is not on closed contacts. */
static void answer(const strut_model *model, const strut_event_stepper *stepper, double *a) {
  const struct strut_contact_coupling *p = stepper->contacts.coupling;
  strut_mass_solve(model, p->force, p->answer, p->work);
  for (int32_t i = 0; i < model->length; i++) a[i] += p->answer[i];
  for (int32_t k = 0; k < stepper->active.closed_count; k++) {
    uint32_t at = model->contacts.at[stepper->active.closed[k]];
    p->force[at] = p->force[at + 1] = 0.0;
  }
}

void strut_contact_coupling_push(const strut_model *model, const strut_event_stepper *stepper,
                                 const double *x, double *a) {
  const struct strut_contact_coupling *p = stepper->contacts.coupling;
  for (int32_t k = 0; k < stepper->active.stuck_count; k++)
    add_force(&model->contacts, stepper->active.stuck[k], 0.0, x[k], p->force);
  answer(model, stepper, a);
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

static void sweep_dampers(const strut_model *model, strut_event_stepper *stepper, double h) {
  const strut_contact_table *c = &model->contacts;
  struct strut_contact_coupling *p = stepper->contacts.coupling;
  const strut_touch *touch = stepper->next->touch, *before = stepper->now->touch;
  for (int sweep = 0; sweep < 40; sweep++) {
    double changed = 0.0, largest = 0.0;
    for (int32_t k = 0; k < stepper->active.closed_count; k++) {
      int32_t i = stepper->active.closed[k];
      const strut_contact_entry *e = &stepper->contacts.entry[i];
      double half = 0.5 * h * stepper->contacts.compliance[i].normal;
      double speed = before[i].into + 0.5 * h * (before[i].into_rate + p->into[i]);
      double damped = implicit_damper(e, -e->stiffness * touch[i].gap,
                                      speed - half * stepper->contacts.damped[i], half);
      double more = damped - stepper->contacts.damped[i];
      stepper->contacts.damped[i] = damped;
      if (more != 0.0) push_contact(c, p, i, more, 0.0);
      changed = fmax(changed, fabs(more));
      largest = fmax(largest, fabs(touch[i].normal));
    }
    if (changed <= 1e-15 * largest) break;
  }
}

/* Friction again with the whole normal force. */
static void renew_friction(const strut_model *model, strut_event_stepper *stepper) {
  const strut_contact_table *c = &model->contacts;
  for (int32_t k = 0; k < stepper->active.closed_count; k++) {
    int32_t i = stepper->active.closed[k];
    strut_touch *o = &stepper->next->touch[i];
    o->normal = -stepper->contacts.entry[i].stiffness * o->gap + stepper->contacts.damped[i];
    if (stepper->modes.of[i] == STRUT_MODE_STICK || stepper->modes.of[i] == STRUT_MODE_CREEP)
      continue;
    double friction = friction_in_mode(&stepper->contacts.entry[i], &stepper->modes, i, o);
    if (friction != o->friction)
      push_contact(c, stepper->contacts.coupling, i, 0.0, friction - o->friction);
    o->friction = friction;
  }
}

/* The multipliers of stuck contacts, among the contacts alone. */
static void hold_contacts(const strut_model *model, strut_event_stepper *stepper) {
  struct strut_contact_coupling *p = stepper->contacts.coupling;
  int32_t n = stepper->active.stuck_count;
  double *x = stepper->active.work;
  for (int32_t k = 0; k < n; k++) x[k] = -p->along[stepper->active.stuck[k]];
  if (n == 1)
    x[0] /= stepper->contacts.compliance[stepper->active.stuck[0]].tangent;
  else
    strut_contact_coupling_solve(stepper, x);
  for (int32_t k = 0; k < n; k++) {
    stepper->next->touch[stepper->active.stuck[k]].friction += x[k];
    push_contact(&model->contacts, p, stepper->active.stuck[k], 0.0, x[k]);
  }
}

void strut_contact_coupling_ground(const strut_model *model, strut_event_stepper *stepper, double h,
                                   double *a1) {
  const strut_contact_table *c = &model->contacts;
  struct strut_contact_coupling *p = stepper->contacts.coupling;
  for (int32_t k = 0; k < stepper->active.closed_count; k++) {
    int32_t i = stepper->active.closed[k];
    p->into[i] = strut_contact_along_normal(c, i, a1);
    p->along[i] = strut_contact_along_ground(c, i, a1);
    p->normal[i] = p->shear[i] = stepper->contacts.damped[i] = 0.0;
  }
  for (int pass = 0; pass < stepper->contacts.passes; pass++) {
    sweep_dampers(model, stepper, h);
    renew_friction(model, stepper);
    if (stepper->active.stuck_count > 0) hold_contacts(model, stepper);
  }
  for (int32_t k = 0; k < stepper->active.closed_count; k++)
    add_force(c, stepper->active.closed[k], p->normal[stepper->active.closed[k]],
              p->shear[stepper->active.closed[k]], p->force);
  answer(model, stepper, a1);
  if (stepper->active.stuck_count)
    strut_solve_stick_constraints(model, stepper, a1, stepper->next); /* what rounding left */
}

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
  const strut_contact_table *contacts = &model->contacts;
  for (int32_t i = 0; i < contacts->count; i++) {
    if (owner[contacts->at[i] / 2]) return false;
    owner[contacts->at[i] / 2] = i + 1;
  }
  return true;
}

static bool make_rows(const strut_model *model, strut_arena *arena,
                      const strut_event_stepper *stepper, const int32_t *owner,
                      struct strut_contact_coupling *coupling) {
  int32_t contacts = model->contacts.count;
  coupling->start = strut_arena_allocate(arena, (size_t)contacts + 1, sizeof *coupling->start);
  for (int32_t i = 0; i < contacts && coupling->start; i++) {
    coupling->start[i + 1] = coupling->start[i];
    for (int32_t k = 0; k < stepper->contacts.compliance[i].count; k++)
      coupling->start[i + 1] += owner[stepper->contacts.compliance[i].at[k] / 2] > 0;
  }
  if (!coupling->start) return false;
  coupling->other = strut_arena_allocate(arena, coupling->start[contacts], sizeof *coupling->other);
  coupling->xy = strut_arena_allocate(arena, 2 * coupling->start[contacts], sizeof *coupling->xy);
  if (!coupling->other || !coupling->xy) return false;
  for (int32_t i = 0; i < contacts; i++) {
    const strut_contact_compliance *compliance = &stepper->contacts.compliance[i];
    size_t e = coupling->start[i];
    for (int32_t k = 0; k < compliance->count; k++) {
      int32_t other = owner[compliance->at[k] / 2] - 1;
      if (other < 0) continue;
      coupling->other[e] = other;
      coupling->xy[2 * e] = compliance->xy[2 * k],
                       coupling->xy[2 * e + 1] = compliance->xy[2 * k + 1];
      e++;
    }
  }
  return true;
}

static bool make_scratch(const strut_model *model, strut_arena *arena,
                         const strut_event_stepper *stepper,
                         struct strut_contact_coupling *coupling) {
  size_t contacts = (size_t)model->contacts.count, length = (size_t)model->length,
         room = (size_t)stepper->active.stuck_room;
  double **several[] = {&coupling->into, &coupling->along, &coupling->normal, &coupling->shear};
  double **whole[] = {&coupling->force, &coupling->answer, &coupling->work};
  bool good = true;
  for (size_t k = 0; k < sizeof several / sizeof *several && good; k++)
    good = (*several[k] = strut_arena_allocate(arena, contacts, sizeof(double)));
  for (size_t k = 0; k < sizeof whole / sizeof *whole && good; k++)
    good = (*whole[k] = strut_arena_allocate(arena, length, sizeof(double)));
  coupling->place = strut_arena_allocate(arena, contacts, sizeof *coupling->place);
  coupling->first = strut_arena_allocate(arena, room, sizeof *coupling->first);
  coupling->factored = strut_arena_allocate(arena, room, sizeof *coupling->factored);
  return good && coupling->place && coupling->first && coupling->factored;
}

strut_status strut_contact_coupling_create(const strut_model *model, strut_state *state,
                                           strut_event_stepper *stepper) {
  bool fixed = !model->contacts.surface && !(model->terms & STRUT_TERM_SLIDING_MASS);
  if (model->contacts.count < STRUT_MANY_CONTACTS || !fixed) return STRUT_OK;
  int32_t *owner = strut_allocate((size_t)model->node_count, sizeof *owner);
  struct strut_contact_coupling *coupling =
      strut_arena_allocate(&state->arena, 1, sizeof *coupling);
  bool good = owner && coupling;
  bool single = good && find_owners(model, owner);
  if (single) good = make_rows(model, &state->arena, stepper, owner, coupling);
  if (single && good) good = make_scratch(model, &state->arena, stepper, coupling);
  if (single && good) stepper->contacts.coupling = coupling;
  strut_release(owner);
  return good ? STRUT_OK : STRUT_NO_MEMORY;
}

/* ---- T' M^-1 T of the stuck contacts, row by row from the first entry that is not 0 ---- */

static bool is_factored(const struct strut_contact_coupling *coupling,
                        const strut_event_stepper *stepper) {
  const strut_active_set *active = &stepper->active;
  size_t bytes = (size_t)active->stuck_count * sizeof *active->stuck;
  return coupling->factored_count == active->stuck_count &&
         memcmp(coupling->factored, active->stuck, bytes) == 0;
}

/* The matrix into the factor's place; p->place must be 0, and is again. */
static void assemble_stuck(const strut_contact_table *contacts, const strut_event_stepper *stepper,
                           struct strut_contact_coupling *coupling) {
  const strut_active_set *active = &stepper->active;
  int32_t n = active->stuck_count;
  double *f = active->factor;
  const double *t = contacts->tangent;
  for (int32_t j = 0; j < n; j++) coupling->place[active->stuck[j]] = j + 1, coupling->first[j] = j;
  for (int32_t j = 0; j < n; j++)
    for (size_t e = coupling->start[active->stuck[j]]; e < coupling->start[active->stuck[j] + 1];
         e++) {
      int32_t i = coupling->place[coupling->other[e]] - 1;
      if (i >= j && j < coupling->first[i]) coupling->first[i] = j;
    }
  for (int32_t i = 0; i < n; i++)
    for (int32_t j = coupling->first[i]; j <= i; j++) f[i * n + j] = 0.0;
  for (int32_t j = 0; j < n; j++)
    for (size_t e = coupling->start[active->stuck[j]]; e < coupling->start[active->stuck[j] + 1];
         e++) {
      int32_t i = coupling->place[coupling->other[e]] - 1;
      const double *xy = coupling->xy + 2 * e;
      if (i >= j) f[i * n + j] = xy[0] * t[0] * t[0] + xy[1] * t[1] * t[1];
    }
  for (int32_t j = 0; j < n; j++) coupling->place[active->stuck[j]] = 0;
}

void strut_contact_coupling_factor(const strut_model *model, strut_event_stepper *stepper) {
  strut_active_set *active = &stepper->active;
  struct strut_contact_coupling *coupling = stepper->contacts.coupling;
  if (is_factored(coupling, stepper)) return;
  assemble_stuck(&model->contacts, stepper, coupling);
  coupling->factored_count = active->stuck_count;
  memcpy(coupling->factored, active->stuck, (size_t)active->stuck_count * sizeof *active->stuck);
  if (strut_cholesky_factor(active->stuck_count, coupling->first, active->factor)) return;
  coupling->factored_count = 0;
  active->stuck_count = -active->stuck_count; /* singular: by sweeps */
}

void strut_contact_coupling_solve(const strut_event_stepper *stepper, double *vector) {
  strut_cholesky_solve_rows(stepper->active.stuck_count, stepper->contacts.coupling->first,
                            stepper->active.factor, vector);
}

/* ---- forces on contacts, to the whole structure ---- */

static void add_force(const strut_contact_table *contacts, int32_t i, double normal, double shear,
                      double *force) {
  assert(i >= 0 && i < contacts->count);
  force[contacts->at[i]] += shear * contacts->tangent[0] + normal * contacts->normal[0];
  force[contacts->at[i] + 1] += shear * contacts->tangent[1] + normal * contacts->normal[1];
}

/* a += M^-1 p->force, which is 0 afterwards but for what is not on closed contacts. */
static void answer(const strut_model *model, const strut_event_stepper *stepper,
                   double *acceleration) {
  const struct strut_contact_coupling *coupling = stepper->contacts.coupling;
  strut_mass_solve(model, coupling->force, coupling->answer, coupling->work);
  for (int32_t i = 0; i < model->length; i++) acceleration[i] += coupling->answer[i];
  for (int32_t k = 0; k < stepper->active.closed_count; k++) {
    uint32_t at = model->contacts.at[stepper->active.closed[k]];
    coupling->force[at] = coupling->force[at + 1] = 0.0;
  }
}

void strut_contact_coupling_push(const strut_model *model, const strut_event_stepper *stepper,
                                 const double *vector, double *acceleration) {
  const struct strut_contact_coupling *coupling = stepper->contacts.coupling;
  for (int32_t k = 0; k < stepper->active.stuck_count; k++)
    add_force(&model->contacts, stepper->active.stuck[k], 0.0, vector[k], coupling->force);
  answer(model, stepper, acceleration);
}

/* ---- implicit ground dampers ---- */

/* Contact i is pushed by so much more: the accelerations of all contacts answer. */
static void push_contact(const strut_contact_table *contacts,
                         struct strut_contact_coupling *coupling, int32_t i, double normal,
                         double shear) {
  assert(i >= 0 && i < contacts->count);
  const double *n = contacts->normal, *t = contacts->tangent;
  double fx = shear * t[0] + normal * n[0], fy = shear * t[1] + normal * n[1];
  coupling->normal[i] += normal, coupling->shear[i] += shear;
  for (size_t e = coupling->start[i]; e < coupling->start[i + 1]; e++) {
    double x = coupling->xy[2 * e] * fx, y = coupling->xy[2 * e + 1] * fy;
    coupling->into[coupling->other[e]] += x * n[0] + y * n[1];
    coupling->along[coupling->other[e]] += x * t[0] + y * t[1];
  }
}

static void sweep_dampers(const strut_model *model, strut_event_stepper *stepper, double h) {
  const strut_contact_table *contacts = &model->contacts;
  struct strut_contact_coupling *coupling = stepper->contacts.coupling;
  const strut_touch *touch = stepper->next->touch, *before = stepper->now->touch;
  for (int sweep = 0; sweep < 40; sweep++) {
    double changed = 0.0, largest = 0.0;
    for (int32_t k = 0; k < stepper->active.closed_count; k++) {
      int32_t i = stepper->active.closed[k];
      const strut_contact_entry *contact = &stepper->contacts.entry[i];
      double half = 0.5 * h * stepper->contacts.compliance[i].normal;
      double speed = before[i].into + 0.5 * h * (before[i].into_rate + coupling->into[i]);
      double damped = implicit_damper(contact, -contact->stiffness * touch[i].gap,
                                      speed - half * stepper->contacts.damped[i], half);
      double more = damped - stepper->contacts.damped[i];
      stepper->contacts.damped[i] = damped;
      if (more != 0.0) push_contact(contacts, coupling, i, more, 0.0);
      changed = fmax(changed, fabs(more));
      largest = fmax(largest, fabs(touch[i].normal));
    }
    if (changed <= 1e-15 * largest) break;
  }
}

/* Friction again with the whole normal force. */
static void renew_friction(const strut_model *model, strut_event_stepper *stepper) {
  const strut_contact_table *contacts = &model->contacts;
  for (int32_t k = 0; k < stepper->active.closed_count; k++) {
    int32_t i = stepper->active.closed[k];
    strut_touch *touch = &stepper->next->touch[i];
    touch->normal =
        -stepper->contacts.entry[i].stiffness * touch->gap + stepper->contacts.damped[i];
    if (stepper->modes.of[i] == STRUT_MODE_STICK || stepper->modes.of[i] == STRUT_MODE_CREEP)
      continue;
    double friction = friction_in_mode(&stepper->contacts.entry[i], &stepper->modes, i, touch);
    if (friction != touch->friction)
      push_contact(contacts, stepper->contacts.coupling, i, 0.0, friction - touch->friction);
    touch->friction = friction;
  }
}

/* The multipliers of stuck contacts, among the contacts alone. */
static void hold_contacts(const strut_model *model, strut_event_stepper *stepper) {
  struct strut_contact_coupling *coupling = stepper->contacts.coupling;
  int32_t n = stepper->active.stuck_count;
  double *x = stepper->active.work;
  for (int32_t k = 0; k < n; k++) x[k] = -coupling->along[stepper->active.stuck[k]];
  if (n == 1)
    x[0] /= stepper->contacts.compliance[stepper->active.stuck[0]].tangent;
  else
    strut_contact_coupling_solve(stepper, x);
  for (int32_t k = 0; k < n; k++) {
    stepper->next->touch[stepper->active.stuck[k]].friction += x[k];
    push_contact(&model->contacts, coupling, stepper->active.stuck[k], 0.0, x[k]);
  }
}

void strut_contact_coupling_ground(const strut_model *model, strut_event_stepper *stepper, double h,
                                   double *a1) {
  const strut_contact_table *contacts = &model->contacts;
  struct strut_contact_coupling *coupling = stepper->contacts.coupling;
  for (int32_t k = 0; k < stepper->active.closed_count; k++) {
    int32_t i = stepper->active.closed[k];
    coupling->into[i] = strut_contact_along_normal(contacts, i, a1);
    coupling->along[i] = strut_contact_along_ground(contacts, i, a1);
    coupling->normal[i] = coupling->shear[i] = stepper->contacts.damped[i] = 0.0;
  }
  for (int pass = 0; pass < stepper->contacts.passes; pass++) {
    sweep_dampers(model, stepper, h);
    renew_friction(model, stepper);
    if (stepper->active.stuck_count > 0) hold_contacts(model, stepper);
  }
  for (int32_t k = 0; k < stepper->active.closed_count; k++)
    add_force(contacts, stepper->active.closed[k], coupling->normal[stepper->active.closed[k]],
              coupling->shear[stepper->active.closed[k]], coupling->force);
  answer(model, stepper, a1);
  if (stepper->active.stuck_count)
    strut_solve_stick_constraints(model, stepper, a1, stepper->next); /* what rounding left */
}

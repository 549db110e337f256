/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/events/location/variation.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/forces/tangent.h"
#include "engine/integrate/events/event_kernel.h"

/* Terms that a tangent knows; those among them that it differentiates by differences. */
enum {
  KNOWN = STRUT_TERM_MEMBERS | STRUT_TERM_DAMPING | STRUT_TERM_SLACK | STRUT_TERM_DRIVE |
          STRUT_TERM_CONSTANT | STRUT_TERM_LOADS | STRUT_TERM_CONTACT | STRUT_TERM_FRICTION |
          STRUT_TERM_SLOPE | STRUT_TERM_SOLVE | STRUT_TERM_LAWS | STRUT_TERM_DIRECTION |
          STRUT_TERM_ELEMENTS | STRUT_TERM_ACTUATOR_FORCES | STRUT_TERM_MASS_DAMPING,
  DIFFERENCED = STRUT_TERM_ELEMENTS | STRUT_TERM_ACTUATOR_FORCES | STRUT_TERM_MASS_DAMPING
};
/* Steps of central differences: of positions over the size, of speeds over size per step, and of the
   arguments of friction laws. */
static const double DIFFERENCE = 1e-6;
/* Where a damper of the approach gives less than this part of the reaction the contact rests: it acts for
   half of the small motions about rest. */
static const double RESTING = 1e-9;
/* A contact that others hold already adds nothing. */
static const double DEPENDENT = 1e-12;

bool strut_mode_tangent_possible(const strut_model *model) {
  return !(model->terms & ~(unsigned)KNOWN) && model->mass && !model->contacts.surface;
}

static bool allocate(const strut_model *model, strut_arena *arena, strut_mode_tangent *tangent) {
  size_t n = (size_t)tangent->n, wide = n * (size_t)tangent->width, length = (size_t)model->length;
  size_t contacts = (size_t)model->contacts.count;
  return STRUT_NUMBERS(arena, n * n, &tangent->inverse) &&
         STRUT_NUMBERS(arena, wide, &tangent->force, &tangent->rate) &&
         STRUT_NUMBERS(arena, contacts * n, &tangent->functional, &tangent->response) &&
         STRUT_NUMBERS(arena, length, &tangent->place, &tangent->speed) &&
         STRUT_NUMBERS(arena, tangent->width, &tangent->pull);
}

/* M^-1, a column a free coordinate. */
static void invert_mass(const strut_model *model, const strut_state *state,
                        strut_mode_tangent *tangent) {
  memset(tangent->place, 0, (size_t)model->length * sizeof(double));
  for (int32_t j = 0; j < tangent->n; j++) {
    memset(state->latest->force, 0, (size_t)model->length * sizeof(double));
    state->latest->force[tangent->coordinate[j]] = 1.0;
    strut_mass_solve(model, state->latest->force, tangent->place, state->buffers->mass_solve);
    for (int32_t i = 0; i < tangent->n; i++)
      tangent->inverse[i * tangent->n + j] = tangent->place[tangent->coordinate[i]];
  }
}

strut_mode_tangent *strut_mode_tangent_create(const strut_model *model, strut_state *state) {
  strut_arena *arena = &state->arena;
  size_t length = (size_t)model->length;
  strut_mode_tangent *tangent = strut_arena_allocate(arena, 1, sizeof *tangent);
  if (!tangent || !STRUT_ALLOCATE(arena, STRUT_NEW(tangent->coordinate, length),
                                  STRUT_NEW(tangent->row_of, length)))
    return NULL;
  tangent->n = strut_number_free(model, NULL, tangent->row_of, tangent->coordinate);
  tangent->width = (2 * tangent->n + STRUT_LANES - 1) / STRUT_LANES * STRUT_LANES;
  tangent->plain = !(model->terms & DIFFERENCED);
  if (!allocate(model, arena, tangent)) return NULL;
  invert_mass(model, state, tangent);
  return tangent;
}

/* ---- contacts that stick ---- */

static double product(int32_t n, const double *first, const double *second) {
  double sum = 0.0;
  for (int32_t i = 0; i < n; i++) sum += first[i] * second[i];
  return sum;
}

/* Adds a contact: its tangent, made orthogonal with respect to M^-1 to those before. */
static void hold_contact(const strut_model *model, int32_t contact, strut_mode_tangent *tangent) {
  assert(contact >= 0 && contact < model->contacts.count);
  int32_t n = tangent->n;
  double *f = tangent->functional + tangent->held * n, *r = tangent->response + tangent->held * n;
  memset(f, 0, (size_t)n * sizeof(double));
  for (uint32_t c = 0; c < 2; c++) {
    int32_t row = tangent->row_of[model->contacts.at[contact] + c];
    if (row >= 0) f[row] = model->contacts.tangent[c];
  }
  for (int32_t i = 0; i < n; i++) r[i] = product(n, tangent->inverse + i * n, f);
  double whole = product(n, f, r);
  for (int32_t k = 0; k < tangent->held; k++) {
    const double *g = tangent->functional + k * n, *s = tangent->response + k * n;
    double part = product(n, g, r);
    for (int32_t i = 0; i < n; i++) f[i] -= part * g[i], r[i] -= part * s[i];
  }
  double left = product(n, f, r);
  if (!(left > DEPENDENT * whole)) return;
  double root = sqrt(left);
  for (int32_t i = 0; i < n; i++) f[i] /= root, r[i] /= root;
  tangent->held++;
}

void strut_mode_tangent_hold(const strut_model *model, const strut_event_stepper *stepper,
                             strut_mode_tangent *tangent) {
  tangent->held = 0;
  for (int32_t k = 0; k < stepper->active.closed_count; k++) {
    uint8_t mode = stepper->modes.of[stepper->active.closed[k]];
    if (mode == STRUT_MODE_STICK || mode == STRUT_MODE_CREEP)
      hold_contact(model, stepper->active.closed[k], tangent);
  }
}

STRUT_CLONES
static void remove_motion(int32_t n, int32_t width, const double *restrict functional,
                          const double *restrict response, double *restrict vector,
                          double *restrict amount) {
  for (int32_t c = 0; c < width; c++) amount[c] = 0.0;
  for (int32_t i = 0; i < n; i++)
    for (int32_t c = 0; c < width && functional[i] != 0.0; c++)
      amount[c] += functional[i] * vector[i * width + c];
  for (int32_t i = 0; i < n; i++)
    for (int32_t c = 0; c < width; c++) vector[i * width + c] -= response[i] * amount[c];
}

void strut_mode_tangent_project(const strut_mode_tangent *tangent, double *vector, int32_t width) {
  for (int32_t k = 0; k < tangent->held; k++)
    remove_motion(tangent->n, width, tangent->functional + k * tangent->n,
                  tangent->response + k * tangent->n, vector, tangent->pull);
}

/* ---- forces ---- */

/* Adds `block` (2, 2), of the force on node a to what b has more than a, at columns `first` on. */
STRUT_INLINE void add_block(strut_mode_tangent *tangent, const int32_t a[2], const int32_t b[2],
                            double block[2][2], int32_t first) {
  for (int r = 0; r < 2; r++)
    for (int c = 0; c < 2; c++) {
      double x = block[r][c];
      int32_t ca = first + a[c], cb = first + b[c];
      if (a[r] >= 0 && a[c] >= 0) tangent->force[a[r] * tangent->width + ca] -= x;
      if (a[r] >= 0 && b[c] >= 0) tangent->force[a[r] * tangent->width + cb] += x;
      if (b[r] >= 0 && a[c] >= 0) tangent->force[b[r] * tangent->width + ca] += x;
      if (b[r] >= 0 && b[c] >= 0) tangent->force[b[r] * tangent->width + cb] -= x;
    }
}

/* Member j: with d from end to end and w its rate, tension c (L - rest) + k (L' - rest'), L' = u . w. */
STRUT_INLINE void add_member(const strut_model *model, const strut_state *state, int32_t j,
                             const double *positions, const double *velocity,
                             strut_mode_tangent *tangent) {
  const strut_member_table *members = &model->members;
  uint32_t from = members->from[j], to = members->to[j];
  double x = positions[to] - positions[from], y = positions[to + 1] - positions[from + 1],
         length = sqrt(x * x + y * y);
  if (!(length > 0.0)) return;
  double u[2] = {x / length, y / length},
         w[2] = {velocity[to] - velocity[from], velocity[to + 1] - velocity[from + 1]};
  double rate = u[0] * w[0] + u[1] * w[1], c = members->stiffness[j], k = members->damping[j];
  double stretch = length - state->latest->rest[j];
  double tension = c * stretch + k * (rate - state->latest->rest_rate[j]);
  if (!(stretch > state->modes.slack_length_threshold[j] &&
        tension > state->modes.slack_force_threshold[j]))
    return;
  const int32_t *a = tangent->row_of + from, *b = tangent->row_of + to;
  double stiffness[2][2], damping[2][2], across = tension / length;
  for (int r = 0; r < 2; r++)
    for (int s = 0; s < 2; s++) {
      double turn = k * (w[s] - rate * u[s]) / length; /* of the rate as the member turns */
      stiffness[r][s] = u[r] * (c * u[s] + turn) + across * ((r == s) - u[r] * u[s]);
      damping[r][s] = k * u[r] * u[s];
    }
  add_block(tangent, a, b, stiffness, 0);
  if (k != 0.0) add_block(tangent, a, b, damping, tangent->n);
}

/* The same of all forces but the ground's, by differences. */
static void difference_forces(const strut_model *model, strut_state *state,
                              const strut_event_stepper *stepper, double time,
                              const double *positions, const double *velocity,
                              strut_mode_tangent *tangent) {
  bool balance = state->balance;
  const double unit[2] = {DIFFERENCE * model->size,
                          DIFFERENCE * model->size / stepper->control.wanted_step};
  state->balance = false;
  memcpy(tangent->place, positions, (size_t)model->length * sizeof(double));
  memcpy(tangent->speed, velocity, (size_t)model->length * sizeof(double));
  for (int32_t j = 0; j < 2 * tangent->n; j++) {
    int32_t of = j / tangent->n, at = tangent->coordinate[j % tangent->n];
    double *x = of ? &tangent->speed[at] : &tangent->place[at], keep = *x, two = 2.0 * unit[of];
    for (int side = -1; side <= 1; side += 2) {
      *x = keep + side * unit[of];
      forces_of_structure(model, state, time, tangent->place, tangent->speed, STRUT_TERMS_ALL,
                          false);
      for (int32_t i = 0; i < tangent->n; i++)
        tangent->force[i * tangent->width + j] +=
            side * state->latest->force[tangent->coordinate[i]] / two;
    }
    *x = keep;
  }
  state->balance = balance;
}

/* ---- the ground ---- */

/* Derivatives of the friction to normal force, slip and applied force. */
typedef struct friction_slopes {
  double normal, slip, applied;
} friction_slopes;

/* By a number of the touch, which is put back. */
static double slope_of(const strut_contact_entry *contact, const strut_contact_modes *modes,
                       int32_t i, const strut_touch *touch, double *number, double step) {
  assert(step > 0.0);
  double value = *number;
  *number = value + step;
  double more = friction_in_mode(contact, modes, i, touch);
  *number = value - step;
  double less = friction_in_mode(contact, modes, i, touch);
  *number = value;
  return (more - less) / (2.0 * step);
}

static friction_slopes slopes_of(const strut_contact_entry *contact,
                                 const strut_contact_modes *modes, int32_t i, strut_touch *touch) {
  int8_t side = modes->side[i];
  switch ((strut_contact_mode)modes->of[i]) {
    case STRUT_MODE_SLIP:
    case STRUT_MODE_PUSH:
      return (friction_slopes){.normal = -side * strut_friction_kinetic(&contact->friction, side)};
    case STRUT_MODE_BAND: {
      double most = strut_friction_static(&contact->friction, touch->applied);
      if (touch->applied > most * touch->normal) return (friction_slopes){.normal = -most};
      if (touch->applied < -most * touch->normal) return (friction_slopes){.normal = most};
      return (friction_slopes){.applied = -1.0};
    }
    case STRUT_MODE_SLIDE:
    case STRUT_MODE_YIELD: {
      double force = DIFFERENCE * (fabs(touch->normal) + fabs(touch->applied)) + 1e-300;
      double speed = DIFFERENCE * (fabs(touch->slip) + contact->friction.stick_velocity) + 1e-12;
      return (friction_slopes){
          .normal = slope_of(contact, modes, i, touch, &touch->normal, force),
          .slip = slope_of(contact, modes, i, touch, &touch->slip, speed),
          .applied = slope_of(contact, modes, i, touch, &touch->applied, force)};
    }
    case STRUT_MODE_OPEN:
    case STRUT_MODE_STICK:
    case STRUT_MODE_CREEP: break;
  }
  return (friction_slopes){0};
}

/* Does the friction of some closed contact depend on the other forces on its node? */
static bool asks_applied(const strut_event_stepper *stepper) {
  for (int32_t k = 0; k < stepper->active.closed_count; k++) {
    uint8_t mode = stepper->modes.of[stepper->active.closed[k]];
    if (mode == STRUT_MODE_BAND || mode == STRUT_MODE_YIELD || mode == STRUT_MODE_SLIDE)
      return true;
  }
  return false;
}

/* Does contact i stay where it is through the step, but for rounding? */
static bool is_resting(const strut_contact_entry *contact, const strut_event_stepper *stepper,
                       int32_t i) {
  const strut_touch *from = &stepper->now->touch[i], *to = &stepper->next->touch[i];
  double most = RESTING * fabs(to->normal);
  return contact->damping * fabs(from->into) <= most && contact->damping * fabs(to->into) <= most;
}

/* Derivatives of the normal force to gap and speed out of the ground. */
static void differentiate_normal(const strut_contact_entry *contact, int8_t damper, bool resting,
                                 const strut_touch *touch, double *gap, double *into) {
  if (contact->dissipation > 0.0) {
    bool acts = touch->normal > 0.0 || touch->gap >= 0.0;
    *gap = acts ? -contact->stiffness * (1.0 - contact->dissipation * touch->into) : 0.0;
    *into = acts ? contact->stiffness * touch->gap * contact->dissipation : 0.0;
    return;
  }
  bool acts = damper ? damper > 0 : touch->into < 0.0;
  *gap = -contact->stiffness;
  *into = resting ? -0.5 * contact->damping : acts ? -contact->damping : 0.0;
}

static void add_contact(const strut_model *model, const strut_state *state,
                        const strut_event_stepper *stepper, int32_t i, const double *positions,
                        const double *velocity, strut_mode_tangent *tangent) {
  assert(i >= 0 && i < model->contacts.count);
  const strut_contact_table *contacts = &model->contacts;
  const strut_contact_entry *contact = &stepper->contacts.entry[i];
  const int32_t *row = tangent->row_of + contacts->at[i];
  double gap, into, *pull = tangent->pull, *x[2] = {NULL, NULL};
  strut_touch o;
  for (int k = 0; k < 2; k++)
    if (row[k] >= 0) x[k] = tangent->force + row[k] * tangent->width;
  measure_on_line(contacts, i, positions, velocity, &o);
  o.applied = strut_contact_along_ground(contacts, i, state->latest->force);
  o.normal = contact_normal_force(contact, stepper->modes.damper[i], o.gap, o.into, true);
  friction_slopes f = slopes_of(contact, &stepper->modes, i, &o);
  differentiate_normal(contact, stepper->modes.damper[i], is_resting(contact, stepper, i), &o, &gap,
                       &into);
  for (int32_t k = 0; k < tangent->width; k++) {
    double along = (x[0] ? contacts->tangent[0] * x[0][k] : 0.0) +
                   (x[1] ? contacts->tangent[1] * x[1][k] : 0.0);
    pull[k] = f.applied * along;
  }
  for (int k = 0; k < 2; k++) {
    if (row[k] < 0) continue;
    pull[row[k]] += f.normal * gap * contacts->normal[k];
    pull[tangent->n + row[k]] +=
        f.normal * into * contacts->normal[k] + f.slip * contacts->tangent[k];
  }
  for (int k = 0; k < 2; k++) {
    if (!x[k]) continue;
    for (int32_t j = 0; j < tangent->width; j++) x[k][j] += pull[j] * contacts->tangent[k];
    for (int j = 0; j < 2; j++) {
      if (row[j] < 0) continue;
      x[k][row[j]] += gap * contacts->normal[j] * contacts->normal[k];
      x[k][tangent->n + row[j]] += into * contacts->normal[j] * contacts->normal[k];
    }
  }
}

/* rate = inverse force, row by row; half of the inverse is zeros, between x and y. */
STRUT_CLONES
static void divide_rows(int32_t n, int32_t width, const double *restrict inverse,
                        const double *restrict force, double *restrict rate) {
  for (int32_t i = 0; i < n; i++) {
    double *restrict row = rate + i * width;
    for (int32_t c = 0; c < width; c++) row[c] = 0.0;
    for (int32_t k = 0; k < n; k++) {
      double part = inverse[i * n + k];
      if (part == 0.0) continue;
      for (int32_t c = 0; c < width; c++) row[c] += part * force[k * width + c];
    }
  }
}

void strut_mode_tangent_evaluate(const strut_model *model, strut_state *state,
                                 const strut_event_stepper *stepper, double time,
                                 const double *positions, const double *velocity,
                                 strut_mode_tangent *tangent) {
  memset(tangent->force, 0, (size_t)(tangent->n * tangent->width) * sizeof(double));
  if (!tangent->plain) difference_forces(model, state, stepper, time, positions, velocity, tangent);
  if (!tangent->plain || asks_applied(stepper))
    forces_of_structure(model, state, time, positions, velocity, STRUT_TERMS_ALL, false);
  else if ((model->terms & STRUT_TERM_DRIVE) && time != state->latest->drive_time)
    strut_drive_apply(model, state, time);
  for (int32_t j = 0; j < model->members.count && tangent->plain; j++)
    add_member(model, state, j, positions, velocity, tangent);
  for (int32_t k = 0; k < stepper->active.closed_count; k++)
    add_contact(model, state, stepper, stepper->active.closed[k], positions, velocity, tangent);
  divide_rows(tangent->n, tangent->width, tangent->inverse, tangent->force, tangent->rate);
  strut_mode_tangent_project(tangent, tangent->rate, tangent->width);
}

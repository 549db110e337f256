/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/discrete_gradient.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/elements.h"
#include "engine/forces/history.h"
#include "engine/forces/tangent.h"
#include "engine/model/pose.h"

bool strut_discrete_gradient_create(const strut_model *model, strut_state *state,
                                    strut_discrete_gradient *step) {
  size_t slots = (size_t)model->members.slots;
  if (!STRUT_NUMBERS(&state->arena, slots, &step->length0, &step->rest0, &step->rest_rate,
                     &step->sum[0], &step->sum[1], &step->lengths, &step->tension, &step->slope) ||
      !STRUT_NUMBERS(&state->arena, model->length, &step->middle, &step->end_velocity) ||
      !STRUT_NUMBERS(&state->arena, model->elements.count, &step->strain0, &step->energy0,
                     &step->element_slope))
    return false;
  memcpy(step->rest0, model->members.rest, slots * sizeof(double));
  return true;
}

void strut_discrete_gradient_begin(const strut_model *model, const strut_state *state,
                                   const double *positions, double begin, double h,
                                   strut_discrete_gradient *step) {
  const strut_member_table *members = &model->members;
  step->begin = begin, step->h = h;
  if (model->terms & STRUT_TERM_FEEDBACK) {
    strut_feedback_apply(model, state, begin, positions, state->v);
    memcpy(step->rest0, state->latest->rest, (size_t)members->slots * sizeof(double));
  } else if (model->terms & STRUT_TERM_DRIVE) {
    if (begin != state->latest->drive_time) strut_drive_apply(model, state, begin);
    memcpy(step->rest0, state->latest->rest, (size_t)members->slots * sizeof(double));
    strut_drive_apply(model, state, begin + 0.5 * h);
    memcpy(step->rest_rate, state->latest->rest_rate, (size_t)members->slots * sizeof(double));
    strut_drive_apply(model, state, begin + h);
  }
  for (int32_t j = 0; j < members->count; j++)
    step->length0[j] = strut_member_length(members, j, positions);
  for (int32_t i = 0; i < model->elements.count; i++) {
    strut_element_pose pose;
    strut_element_evaluate(model, i, step->rest0, positions, state->history.turn[i], &pose);
    step->strain0[i] = pose.strain;
    step->energy0[i] = pose.energy;
  }
}

/* Tension of a member on average, its elastic part, and what the first changes by with the end. */
typedef struct average {
  double tension, elastic, slope;
} average;

/* A member's stretches at both ends, c, k, and the rate of its stretching less jumps of the drive. */
typedef struct stretching {
  double s0, s1, stiffness, damping, rate, h;
} stretching;

static average of_taut(const stretching *self) {
  double elastic = 0.5 * self->stiffness * (self->s0 + self->s1);
  return (average){elastic + self->damping * self->rate, elastic,
                   0.5 * self->stiffness + self->damping / self->h};
}

/* Slack at one end it pulls for a part of the step, in which it has half of that end's stretch. */
static average of_cable(const stretching *self) {
  if (!(self->s0 > 0.0 || self->s1 > 0.0)) return (average){0.0, 0.0, 0.0};
  average a;
  if (self->s0 > 0.0 && self->s1 > 0.0) {
    a = of_taut(self);
  } else {
    bool tightens = self->s1 > 0.0;
    double change = self->s1 - self->s0, end = tightens ? self->s1 : self->s0,
           part = end / fabs(change);
    double elastic = 0.5 * self->stiffness * end * part;
    double grows = tightens ? part * (2.0 - part) : part * part;
    double part_grows = (tightens ? 1.0 - part : -part) / change;
    a = (average){
        elastic + self->damping * self->rate * part, elastic,
        0.5 * self->stiffness * grows + self->damping * (part / self->h + self->rate * part_grows)};
    a.slope = fmax(a.slope, 0.0);
  }
  return a.tension > 0.0 ? a : (average){0.0, a.elastic, 0.0};
}

/* The drive moves the spring's rest length by all of its change, the damper's by its rate. */
static void add_powers(const strut_state *state, const average *self, const stretching *m,
                       double change, double rest_rate) {
  double damped = self->tension - self->elastic, lost = damped * m->rate;
  double drive = -self->elastic * change / m->h - damped * rest_rate;
  strut_power_add_two(state->latest->power, STRUT_POWER_DRIVE, drive, STRUT_POWER_MEMBERS, lost);
}

static void add_members(const strut_model *model, const strut_state *state,
                        strut_discrete_gradient *step, const double *restrict q0,
                        const double *restrict q1) {
  const strut_member_table *members = &model->members;
  double *restrict force = state->latest->force;
  for (int32_t j = 0; j < members->count; j++) {
    uint32_t a = members->from[j], b = members->to[j];
    strut_vec2 d = strut_member_span(members, j, q1);
    double length = strut_vec2_length(d);
    const stretching m = {.s0 = step->length0[j] - step->rest0[j],
                          .s1 = length - state->latest->rest[j],
                          .stiffness = members->stiffness[j],
                          .damping = members->damping[j],
                          .rate = (length - step->length0[j]) / step->h - step->rest_rate[j],
                          .h = step->h};
    average now = members->slack[j] < 0.0 ? of_taut(&m) : of_cable(&m);
    double x = d.x + (q0[b] - q0[a]), y = d.y + (q0[b + 1] - q0[a + 1]);
    double lengths = step->length0[j] + length;
    double density = lengths > 0.0 ? now.tension / lengths : 0.0;
    step->sum[0][j] = x, step->sum[1][j] = y, step->lengths[j] = lengths;
    step->tension[j] = now.tension, step->slope[j] = now.slope;
    force[a] += density * x, force[a + 1] += density * y;
    force[b] -= density * x, force[b + 1] -= density * y;
    if (state->balance)
      add_powers(state, &now, &m, state->latest->rest[j] - step->rest0[j], step->rest_rate[j]);
  }
}

/* Energy of an element at a stretch from a natural strain. */
static double energy_at(const strut_element *element, double natural, double stretch) {
  if (element->carries && !(element->carries * stretch > 0.0)) return 0.0;
  double strain = strut_element_origin(element, natural) + stretch;
  return strut_law_respond(element->law, &element->numbers, strain, natural, -1).energy;
}

/*
 * The end of a step at which the element's force is averaged. A law that does not depend on the stretch alone
 * has the natural strain half-way, so that the method keeps its order.
 */
static strut_element_pose averaged_end(const strut_element *element, const strut_element_pose *end,
                                       double natural0) {
  strut_element_pose at = {.strain = end->strain,
                           .natural = end->natural,
                           .force = end->force,
                           .energy = end->energy,
                           .slope = end->slope};
  bool scales = element->law == STRUT_LAW_LOGARITHMIC || element->law >= STRUT_LAW_AXIAL;
  if (!scales || natural0 == end->natural) return at;
  double stretch = end->strain - strut_element_origin(element, end->natural);
  at.natural = 0.5 * (natural0 + end->natural);
  at.strain = strut_element_origin(element, at.natural) + stretch;
  strut_law_response r =
      strut_law_respond(element->law, &element->numbers, at.strain, at.natural, -1);
  bool beyond = !element->carries || element->carries * stretch > 0.0;
  bool acts = beyond && (!element->carries || element->carries * r.force > 0.0);
  at.energy = beyond ? r.energy : 0.0;
  at.force = acts ? r.force : 0.0, at.slope = acts ? r.slope : 0.0;
  return at;
}

/* The energy's change over the stretch's; where that is rounding, the force half-way. */
static double average_force(const strut_element *element, const strut_element_pose *end,
                            double stretch0, double energy0) {
  double origin = strut_element_origin(element, end->natural);
  double stretch1 = end->strain - origin, change = stretch1 - stretch0;
  double scale = fmax(fabs(stretch0), fabs(stretch1)) + 1e-300;
  if (fabs(change) > 1e-6 * scale) return (end->energy - energy0) / change;
  double middle = origin + 0.5 * (stretch0 + stretch1);
  if (element->carries && !(element->carries * (middle - origin) > 0.0)) return 0.0;
  return strut_law_respond(element->law, &element->numbers, middle, end->natural, -1).force;
}

/* What that changes by with the strain at the end: exact, but where it would be rounding. */
static double average_slope(const strut_element *element, const strut_element_pose *end,
                            double stretch0, double elastic) {
  double stretch1 = end->strain - strut_element_origin(element, end->natural);
  double change = stretch1 - stretch0;
  double scale = fmax(fabs(stretch0), fabs(stretch1));
  return fabs(change) > 1e-3 * scale ? (end->force - elastic) / change : 0.5 * end->slope;
}

/* The part of the step in which an element that carries one sign is beyond its natural strain. */
static double part_beyond(const strut_element *element, double stretch0, double stretch1) {
  double s0 = element->carries * stretch0, s1 = element->carries * stretch1;
  if (!element->carries || (s0 > 0.0 && s1 > 0.0)) return 1.0;
  return s0 > 0.0 || s1 > 0.0 ? fmax(s0, s1) / fabs(s1 - s0) : 0.0;
}

/* Gonzalez's discrete gradient of a strain: that half-way, corrected so that its work is the change of the strain. */
static void add_element(const strut_model *model, const strut_state *state,
                        strut_discrete_gradient *step, int32_t i, const double *restrict q0,
                        const double *restrict q1) {
  assert(i >= 0 && i < model->elements.count);
  const strut_element *element = &model->elements.element[i];
  const uint32_t *at = model->elements.at + element->first;
  strut_element_pose end, middle;
  strut_element_evaluate(model, i, state->latest->rest, q1, step->strain0[i], &end);
  strut_element_evaluate(model, i, state->latest->rest, step->middle, step->strain0[i], &middle);
  bool load = element->role == STRUT_ELEMENT_LOAD; /* its moment is that half-way */
  double natural0 = element->slot >= 0 && !load ? step->rest0[element->slot] : end.natural;
  double square = 0.0, work = 0.0;
  double rest_rate = element->slot >= 0 ? step->rest_rate[element->slot] : 0.0;
  double origin0 = strut_element_origin(element, natural0),
         origin1 = strut_element_origin(element, end.natural);
  if (strut_law_is_of_cells(element->law)) rest_rate = 0.0; /* its drive is all excess */
  double change = end.strain - step->strain0[i], rate = change / step->h - rest_rate;
  for (int32_t k = 0; k < 2 * element->nodes; k++) {
    uint32_t c = at[k / 2] + (uint32_t)(k % 2);
    double d = q1[c] - q0[c];
    square += d * d, work += middle.b[k] * d;
  }
  double more = square > 0.0 ? (change - work) / square : 0.0;
  double stretch0 = step->strain0[i] - origin0, stretch1 = end.strain - origin1;
  strut_element_pose at1 = averaged_end(element, &end, natural0);
  double energy0 = energy_at(element, at1.natural, stretch0);
  double elastic = average_force(element, &at1, stretch0, energy0);
  double damping = element->damping * part_beyond(element, stretch0, stretch1);
  double force = elastic + damping * rate;
  bool none = element->carries && !(element->carries * force > 0.0);
  if (none) force = 0.0;
  double slope = average_slope(element, &at1, stretch0, elastic) + damping / step->h;
  step->element_slope[i] = none ? 0.0 : fmax(slope, 0.0);
  for (int32_t k = 0; k < 2 * element->nodes; k++) {
    uint32_t c = at[k / 2] + (uint32_t)(k % 2);
    state->latest->force[c] -= force * (middle.b[k] + more * (q1[c] - q0[c]));
  }
  if (!state->balance) return;
  if (load) {
    strut_power_add(state->latest->power, STRUT_POWER_LOAD, -force * rate);
    return;
  }
  const average now = {.tension = force, .elastic = elastic};
  const stretching m = {.rate = rate, .h = step->h};
  add_powers(state, &now, &m, origin1 - origin0, rest_rate);
  /* what the drive does to the energy at the same stretch, of a law that depends on more */
  double excess = (energy0 - step->energy0[i] + (end.energy - at1.energy)) / step->h;
  strut_power_add(state->latest->power, STRUT_POWER_DRIVE, excess);
}

/* Drives that follow the motion: their rates half-way, with the loads and the rates of internal states
   there, and their values at the end. */
static void follow(const strut_model *model, const strut_state *state,
                   strut_discrete_gradient *step, const double *q1, const double *u) {
  for (int32_t i = 0; i < model->length; i++) {
    step->middle[i] = 0.5 * (state->q[i] + q1[i]);
    step->end_velocity[i] = 2.0 * u[i] - state->v[i];
  }
  double middle = step->begin + 0.5 * step->h;
  strut_feedback_apply(model, state, middle, step->middle, u);
  memcpy(step->rest_rate, state->latest->rest_rate, (size_t)model->members.slots * sizeof(double));
  strut_feedback_add_rates(model, state, middle, u, state->latest->force);
  if (model->terms & STRUT_TERM_LOADS) strut_loads_apply(model, state, middle, u);
  strut_actuator_forces_apply(model, state, middle, step->middle, u);
  strut_maxwell_apply(model, state, step->middle, u, state->latest->force);
  strut_feedback_apply(model, state, step->begin + step->h, q1, step->end_velocity);
}

void strut_discrete_gradient_forces(const strut_model *model, const strut_state *state,
                                    strut_discrete_gradient *step, const double *q1,
                                    const double *u) {
  size_t bytes = (size_t)model->length * sizeof(double);
  state->latest->evaluations++;
  memset(state->latest->power, 0, sizeof state->latest->power);
  if (model->terms & STRUT_TERM_CONSTANT)
    memcpy(state->latest->force, model->constant_force, bytes);
  else
    memset(state->latest->force, 0, bytes);
  if (model->terms & STRUT_TERM_FEEDBACK)
    follow(model, state, step, q1, u);
  else if (model->terms & STRUT_TERM_LOADS)
    strut_loads_apply(model, state, step->begin + 0.5 * step->h, u);
  add_members(model, state, step, state->q, q1);
  if (model->terms & STRUT_TERM_UNBALANCE)
    strut_unbalance_apply_mean(model, state, step->begin, step->h, u);
  if (model->terms & STRUT_TERM_MASS_DAMPING) strut_mass_damping_apply(model, state, u);
  if (!(model->terms & (STRUT_TERM_ELEMENTS | STRUT_TERM_ACTUATOR_FORCES))) return;
  for (int32_t i = 0; i < model->length; i++) step->middle[i] = 0.5 * (state->q[i] + q1[i]);
  for (int32_t i = 0; i < model->elements.count; i++)
    add_element(model, state, step, i, state->q, q1);
  if (!(model->terms & STRUT_TERM_FEEDBACK))
    strut_actuator_forces_apply(model, state, step->begin + 0.5 * step->h, step->middle, u);
}

void strut_discrete_gradient_tensions(const strut_model *model, const strut_state *state,
                                      double *tension) {
  const strut_member_table *members = &model->members;
  for (int32_t j = 0; j < members->count; j++) {
    strut_member_pose pose = strut_member_pose_at(members, state->latest->rest, j, state->q);
    tension[j] = strut_member_elastic_force(members, j, &pose);
  }
}

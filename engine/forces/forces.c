/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forces for single evaluations; integrators have the kernel in their own loops. */
#include "engine/forces/forces.h"

#include <assert.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/forces_kernel.h"
#include "engine/forces/history.h"
#include "engine/forces/members_kernel.h"
#include "engine/forces/nearby.h"
#include "engine/forces/rigid.h"
#include "engine/forces/surfaces.h"
#include "engine/forces/tangent.h"
#include "engine/model/mass.h"

void strut_forces_add_rare(const strut_model *model, const strut_state *state, double t,
                           const double *q, const double *velocity) {
  unsigned terms = model->terms;
  if (terms & STRUT_TERM_FEEDBACK)
    strut_maxwell_apply(model, state, q, velocity, state->latest->force);
  if (terms & STRUT_TERM_ACTUATOR_FORCES) strut_actuator_forces_apply(model, state, t, q, velocity);
  if (terms & STRUT_TERM_UNBALANCE) strut_unbalance_apply(model, state, t, velocity);
  if (terms & STRUT_TERM_MASS_DAMPING) strut_mass_damping_apply(model, state, velocity);
  if (terms & STRUT_TERM_SLIDING_MASS) strut_sliding_masses_apply(model, state, t, q, velocity);
  if (terms & STRUT_TERM_SUPPORT_MOTION) strut_support_motion_apply(model, state, t, velocity);
  if (terms & STRUT_TERM_RUBBING) strut_rubbing_add_forces(model, state, q, velocity);
}

STRUT_CLONES
static void sum_once(const strut_model *model, const strut_state *state, double t,
                     const double *restrict q, const double *restrict velocity) {
  if (state->balance)
    forces_sum(model, state, t, q, velocity, STRUT_TERMS_ALL, STRUT_ACCUMULATE_POWERS);
  else
    forces_sum(model, state, t, q, velocity, STRUT_TERMS_ALL, STRUT_ACCUMULATE_NOTHING);
}

void strut_forces_evaluate(const strut_model *model, const strut_state *state, double t,
                           const double *restrict q, const double *restrict velocity) {
  for (int32_t i = 0; i < model->contacts.count; i++)
    state->latest->normal[i] = state->latest->friction[i] =
        0.0; /* the sum fills those that touch, and only them */
  sum_once(model, state, t, q, velocity);
  if (model->rubbing.count) strut_rubbing_show_feet(model, state, q, velocity);
  if (state->rigid) strut_rigid_constrain(model, state, q, velocity);
}

bool strut_forces_show_held(const strut_model *model, const strut_state *state) {
  if (!state->modes.held_normal) return false;
  for (int32_t i = 0; i < model->contacts.count; i++) {
    state->latest->normal[i] = state->modes.held_normal[i];
    state->latest->friction[i] = state->modes.held_friction[i];
  }
  if (model->rubbing.count) strut_rubbing_show_feet(model, state, state->q, state->v);
  return true;
}

void strut_forces_observe(const strut_model *model, const strut_state *state, double t) {
  int64_t evaluations = state->latest->evaluations;
  strut_forces_evaluate(model, state, t, state->q, state->v);
  state->latest->evaluations = evaluations; /* observing is not part of the run's cost */
  strut_forces_show_held(model, state);
}

void strut_forces_acceleration(const strut_model *model, const strut_state *state, double t,
                               const double *restrict q, const double *restrict velocity,
                               double *restrict acceleration) {
  assert(model->mass && "a model without mass is for statics only");
  strut_forces_evaluate(model, state, t, q, velocity);
  divide_by_mass(model, state, acceleration, STRUT_TERMS_ALL);
  if (state->balance && model->terms & STRUT_TERM_SLIDING_MASS)
    strut_sliding_masses_add_power(model, state, q, velocity, acceleration);
}

/* Of the mass of a member at each of its ends, and between them. */
typedef struct mass_shares {
  double own, other;
} mass_shares;

static mass_shares shares_of(const strut_model *model) {
  bool consistent = model->scene->mass_model == STRUT_MASS_CONSISTENT;
  return consistent ? (mass_shares){1.0 / 3.0, 1.0 / 6.0} : (mass_shares){0.5, 0.0};
}

/* Of masses that rest on their members; returns what is lost. */
static double damp_sliding_masses(const strut_model *model, const double *velocity, double *force) {
  double lost = 0.0;
  for (int32_t i = 0; i < model->sliding.count; i++) {
    const strut_sliding_item *item = &model->sliding.item[i];
    double far = item->start, near = 1.0 - far;
    for (int c = 0; c < 2 && item->signal < 0; c++) {
      uint32_t a = item->at[0] + (uint32_t)c, b = item->at[1] + (uint32_t)c;
      double u = near * velocity[a] + far * velocity[b],
             drag = model->mass_damping * item->mass * u;
      force[a] -= near * drag;
      force[b] -= far * drag;
      lost += drag * u;
    }
  }
  return lost;
}

void strut_mass_damping_apply(const strut_model *model, const strut_state *state,
                              const double *velocity) {
  const strut_member_table *members = &model->members;
  const mass_shares share = shares_of(model);
  double alpha = model->mass_damping, lost = 0.0, *force = state->latest->force;
  for (int c = 0; c < 2; c++, velocity++, force++) {
    for (int32_t i = 0; i < model->node_count; i++) {
      double drag = alpha * model->point_mass[i] * velocity[2 * i];
      force[2 * i] -= drag;
      lost += drag * velocity[2 * i];
    }
    for (int32_t j = 0; j < members->count; j++) {
      double a = velocity[members->from[j]], b = velocity[members->to[j]],
             m = alpha * members->mass[j];
      double at_a = m * (share.own * a + share.other * b);
      double at_b = m * (share.other * a + share.own * b);
      force[members->from[j]] -= at_a;
      force[members->to[j]] -= at_b;
      lost += at_a * a + at_b * b;
    }
  }
  if (model->sliding.count) lost += damp_sliding_masses(model, velocity - 2, force - 2);
  if (!state->balance) return;
  strut_power_add(state->latest->power, STRUT_POWER_MEMBERS, lost);
}

/* Lengths and forces of members, hinges and cells for observers (recording, measuring). The step's own loop:
   members_kernel.h. */

/* Adds the forces of a member's elements; a running cable's length is theirs, too. */
static void measure_elements(const strut_model *model, const strut_state *state,
                             const strut_element *element, const double *q, const double *velocity,
                             strut_member_values *values) {
  strut_element_pose pose;
  for (; element;
       element = element->sibling >= 0 ? &model->elements.element[element->sibling] : NULL) {
    int32_t i = (int32_t)(element - model->elements.element);
    values->force += strut_element_measure_at(model, state, i, q, velocity, &pose);
    values->length = pose.strain;
    values->rate = strut_element_rate(model, i, &pose, velocity);
  }
}

strut_member_values strut_member_measure_at(const strut_model *model, const strut_state *state,
                                            int32_t j, const double *q, const double *velocity) {
  assert(j >= 0 && j < model->members.count);
  const strut_member_table *members = &model->members;
  strut_member_pose pose = strut_member_pose_at(members, state->latest->rest, j, q);
  double rate = strut_member_rate(members, j, &pose, velocity);
  double force = members->stiffness[j] * pose.stretch +
                 members->damping[j] * (rate - state->latest->rest_rate[j]);
  bool pulls = pose.taut && force > members->slack[j];
  strut_member_values values = {pose.length, rate, pulls ? force : members->slack[j]};
  const strut_element *element = strut_element_of_member(&model->elements, j);
  if (element) measure_elements(model, state, element, q, velocity, &values);
  if (model->feedback.maxwell_count) values.force += strut_maxwell_force(model, velocity, j);
  return values;
}

/*
 * Forces of more members than the energy balance adds up in one sum: called, so that smaller structures do
 * not pay for it.
 */

STRUT_CLONES
static void add_forces_of_many(const strut_model *model, const strut_state *state,
                               const double *restrict q, const double *restrict velocity,
                               double *restrict force, four_member_powers *powers) {
  const strut_member_table t = model->members;
  four_member_powers sum = {0}, part = {0};
  for (int32_t b = 0; b < t.blocks; b++) {
    members_of_block(&t, state, q, velocity, force, b, true, &part);
    if ((b + 1) % STRUT_BALANCE_BLOCKS && b + 1 < t.blocks) continue;
    members_add_powers(&sum, &part);
    part = (four_member_powers){0};
  }
  *powers = sum;
}

void strut_many_members_add_forces(const strut_model *model, const strut_state *state,
                                   const double *q, const double *velocity, double *force,
                                   four_member_powers *powers) {
  add_forces_of_many(model, state, q, velocity, force, powers);
}

/* Of masses that rest on their members. */
static double sliding_at_rest(const strut_model *model, const double *velocity) {
  double sum = 0.0;
  for (int32_t i = 0; i < model->sliding.count; i++) {
    const strut_sliding_item *item = &model->sliding.item[i];
    double far = item->start, near = 1.0 - far;
    for (int c = 0; c < 2 && item->signal < 0; c++) {
      double u =
          near * velocity[item->at[0] + (uint32_t)c] + far * velocity[item->at[1] + (uint32_t)c];
      sum += 0.5 * item->mass * u * u;
    }
  }
  return sum;
}

double strut_energy_kinetic(const strut_model *model, const double *velocity) {
  const strut_member_table *members = &model->members;
  bool consistent = model->scene->mass_model == STRUT_MASS_CONSISTENT;
  double sum = 0.0;
  for (int c = 0; c < 2; c++, velocity++) {
    for (int32_t i = 0; i < model->node_count; i++)
      sum += 0.5 * model->point_mass[i] * velocity[2 * i] * velocity[2 * i];
    for (int32_t j = 0; j < members->count; j++) {
      double a = velocity[members->from[j]], b = velocity[members->to[j]];
      sum += consistent ? members->mass[j] / 6.0 * (a * a + a * b + b * b)
                        : members->mass[j] / 4.0 * (a * a + b * b);
    }
  }
  return sum + (model->sliding.count ? sliding_at_rest(model, velocity - 2) : 0.0);
}

static double elastic(const strut_model *model, const strut_state *state, const double *q) {
  const strut_member_table *members = &model->members;
  const strut_member *member = model->scene->members;
  bool rigid = model->terms & STRUT_TERM_RIGID; /* rigid bars store nothing */
  double sum = 0.0;
  for (int32_t j = 0; j < members->count; j++) {
    if (rigid && member[j].kind == STRUT_BAR) continue;
    strut_member_pose pose = strut_member_pose_at(members, state->latest->rest, j, q);
    sum += strut_member_elastic_energy(members, j, &pose);
  }
  if (model->elements.count)
    sum += strut_elements_energy(model, state->latest->rest, state->history.turn, q,
                                 strut_nearby_serving(model, state, q));
  return sum;
}

static double gravity(const strut_model *model, const double *q) {
  const double *g = model->scene->gravity;
  double sum = 0.0;
  for (int c = 0; c < 2; c++, q++)
    for (int32_t i = 0; i < model->node_count && g[c] != 0.0; i++)
      sum -= model->weight[i] * g[c] * q[2 * i];
  return sum;
}

static double contact(const strut_model *model, const strut_state *state, const double *q) {
  const strut_contact_table *contacts = &model->contacts;
  double sum = 0.0;
  int32_t count =
      contacts->surface
          ? strut_contacts_all_near(contacts, q, state->latest->ground_motion, state->buffers->near)
          : contacts->count;
  for (int32_t k = 0; k < count; k++) {
    int32_t i = contacts->surface ? state->buffers->near[k] : k;
    double gap = strut_contact_gap_at(contacts, i, q, state->latest->ground_motion);
    if (gap < 0.0) sum += 0.5 * contacts->entry[i].stiffness * gap * gap;
  }
  return sum;
}

strut_energies strut_energy_evaluate(const strut_model *model, const strut_state *state, double t) {
  strut_drive_apply(model, state, t);
  return strut_energy_evaluate_at(model, state, state->q, state->v);
}

strut_energies strut_energy_evaluate_at(const strut_model *model, const strut_state *state,
                                        const double *q, const double *velocity) {
  strut_energies e = {strut_energy_kinetic(model, velocity),
                      elastic(model, state, q) + strut_maxwell_energy(model, velocity),
                      gravity(model, q), contact(model, state, q)};
  if (model->terms & STRUT_TERM_SLIDING_MASS)
    strut_sliding_masses_add_energies(model, state, q, velocity, &e.kinetic, &e.gravity);
  return e;
}

double strut_energy_load_potential(const strut_model *model, const strut_state *state) {
  const strut_scene *scene = model->scene;
  double sum = 0.0;
  for (size_t i = 0; i < scene->load_count; i++) {
    const strut_load *load = &scene->loads[i];
    for (int c = 0; c < 2 && load->signal < 0 && !load->couple; c++) {
      int32_t at = 2 * load->node + c;
      sum += load->force[c] * state->q[at];
    }
  }
  return sum;
}

double strut_energy_load_work(const strut_model *model, const strut_state *state) {
  return strut_energy_load_potential(model, state) - state->load_work_origin;
}

void strut_energy_reset_load_work(const strut_model *model, strut_state *state) {
  state->load_work_origin = strut_energy_load_potential(model, state);
  strut_support_motion_reset_work(model, state);
}

void strut_impulse_apply(const strut_model *model, strut_state *state, strut_power power) {
  double work = 0.0, *change = state->buffers->support_answer;
  strut_mass_solve(model, state->latest->force, change, state->buffers->mass_solve);
  if (model->terms & STRUT_TERM_SLIDING_MASS) strut_sliding_masses_correct(model, state, change);
  for (int32_t i = 0; i < model->length; i++) {
    work += state->latest->force[i] * (state->v[i] + 0.5 * change[i]);
    state->v[i] += change[i];
  }
  if (!state->balance) return;
  strut_power_add(state->work, power, work);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/energy.h"

#include <math.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/elements.h"
#include "engine/forces/history.h"
#include "engine/forces/nearby.h"
#include "engine/model/mass.h"
#include "engine/model/pose.h"

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

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/plan.h"

#include "engine/integrate/limit/step_limit.h"
#include "engine/model/mass.h"

static const strut_plan_term terms[STRUT_PLAN_TERMS] = {
    {STRUT_TERM_MEMBERS, "member springs", "a member", false},
    {STRUT_TERM_DAMPING, "member dampers", "a member with damping", false},
    {STRUT_TERM_SLACK, "slack test", "a cable", false},
    {STRUT_TERM_DRIVE, "driven rest lengths", "an actuator", false},
    {STRUT_TERM_CONSTANT, "constant forces", "gravity, or a load without a signal", false},
    {STRUT_TERM_LOADS, "driven loads", "a load with a signal", false},
    {STRUT_TERM_CONTACT, "ground contact", "a ground that nodes may touch", false},
    {STRUT_TERM_FRICTION, "friction", "a ground with friction", false},
    {STRUT_TERM_SLOPE, "inclined ground", "a ground with a slope", false},
    {STRUT_TERM_SOLVE, "mass solve", "consistent masses of members", false},
};

static void count_elements(const strut_model *model, strut_plan *plan) {
  const strut_scene *scene = model->scene;
  plan->nodes = scene->node_count;
  for (int32_t i = 0; i < 2 * model->node_count; i++) plan->degrees_of_freedom += !model->fixed[i];
  for (size_t j = 0; j < scene->member_count; j++) {
    plan->bars += scene->members[j].kind == STRUT_BAR;
    plan->springs += scene->members[j].kind == STRUT_SPRING;
    plan->cables += scene->members[j].kind == STRUT_CABLE;
  }
  plan->contacts = (size_t)model->contacts.count;
  plan->actuators = scene->actuator_count;
  plan->loads = scene->load_count;
  plan->bytes = model->arena.bytes + sizeof *model;
}

strut_status strut_plan_describe(const strut_model *model, strut_plan *plan, strut_error *error) {
  *plan = (strut_plan){0};
  count_elements(model, plan);
  for (int i = 0; i < STRUT_PLAN_TERMS; i++) {
    plan->terms[i] = terms[i];
    plan->terms[i].in = model->plan & terms[i].term;
  }
  if (!model->mass) return STRUT_OK;
  plan->runnable = true;
  plan->mass_nonzeros = model->mass->matrix_nonzeros;
  plan->factor_nonzeros = model->mass->factor_nonzeros;
  plan->dense_entries = model->mass->dense_entries;
  strut_step_limit limit;
  strut_status status = strut_step_limit_estimate(model, &limit, error);
  plan->largest_frequency = limit.largest_frequency;
  plan->step_limit = limit.limit;
  plan->limits = limit;
  plan->step_limit_exact = limit.exact;
  return status;
}

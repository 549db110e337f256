/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/cost_estimate.h"

#include "engine/integrate/limit/step_limit.h"
#include "engine/model/mass.h"
#include "engine/scene/signal_program.h"

static void count_elements(const strut_model *model, strut_cost_estimate *estimate) {
  const strut_scene *scene = model->scene;
  estimate->count.nodes = scene->node_count;
  for (int32_t i = 0; i < 2 * model->node_count; i++)
    estimate->count.degrees_of_freedom += !model->fixed[i];
  for (size_t j = 0; j < scene->member_count; j++) {
    estimate->count.bars += scene->members[j].kind == STRUT_BAR;
    estimate->count.springs += scene->members[j].kind == STRUT_SPRING;
    estimate->count.cables += scene->members[j].kind == STRUT_CABLE;
  }
  for (size_t j = 0; j < scene->member_count; j++) {
    const strut_member *member = &scene->members[j];
    estimate->count.running_cables += member->guide_count > 0;
    estimate->count.laws +=
        member->law.kind != STRUT_LAW_LINEAR || member->law.carries == STRUT_CARRIES_COMPRESSION;
    estimate->count.stops += (size_t)(member->shortest > 0.0) + (size_t)(member->longest > 0.0);
  }
  estimate->count.hinges = scene->hinge_count;
  estimate->count.cells = scene->cell_count;
  estimate->count.collisions = scene->collision_count;
  estimate->count.contacts = (size_t)model->contacts.count;
  estimate->count.actuators = scene->actuator_count;
  estimate->count.loads = scene->load_count;
  estimate->bytes = model->arena.bytes + sizeof *model;
}

strut_status strut_cost_estimate_describe(const strut_model *model, strut_cost_estimate *estimate,
                                          strut_error *error) {
  *estimate = (strut_cost_estimate){0};
  count_elements(model, estimate);
  if (!model->mass) return STRUT_OK;
  estimate->runnable = true;
  estimate->feedback = strut_scene_has_feedback(model->scene);
  estimate->matrix.mass_nonzeros = model->mass->matrix_nonzeros;
  estimate->matrix.factor_nonzeros = model->mass->factor_nonzeros;
  estimate->matrix.dense_entries = model->mass->dense_entries;
  strut_step_limit limit;
  strut_status status = strut_step_limit_estimate(model, &limit, error);
  estimate->largest_frequency = limit.largest_frequency;
  estimate->step_limit = limit.limit;
  estimate->limits = limit;
  estimate->step_limit_exact = limit.exact;
  return status;
}

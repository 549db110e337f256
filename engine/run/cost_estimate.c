/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/cost_estimate.h"

#include <string.h>

#include "engine/integrate/limit/step_limit.h"
#include "engine/model/mass.h"
#include "engine/scene/signal_program.h"

static const strut_cost_term terms[] = {
    {STRUT_TERM_MEMBERS, "member springs", "a member", false},
    {STRUT_TERM_DAMPING, "member dampers", "a member with damping", false},
    {STRUT_TERM_SLACK, "slack test", "a cable", false},
    {STRUT_TERM_ELEMENTS, "running cables", "a cable that runs over guides", false},
    {STRUT_TERM_ELEMENTS, "member laws", "a member with another law than the linear one", false},
    {STRUT_TERM_ELEMENTS, "reeled members", "an actuator on a member with axial_stiffness", false},
    {STRUT_TERM_ELEMENTS, "stops", "a member with a shortest or longest length", false},
    {STRUT_TERM_ELEMENTS, "hinges", "a hinge", false},
    {STRUT_TERM_ELEMENTS, "cells", "a cell", false},
    {STRUT_TERM_ELEMENTS, "collisions", "a collision", false},
    {STRUT_TERM_FEEDBACK, "sensors", "a sensor", false},
    {STRUT_TERM_MEMORY, "breaks and releases", "something with breaks_at or released_at", false},
    {STRUT_TERM_DRIVE, "driven rest lengths", "an actuator", false},
    {STRUT_TERM_CONSTANT, "constant forces", "gravity, or a load without a signal", false},
    {STRUT_TERM_LOADS, "driven loads", "a load with a signal", false},
    {STRUT_TERM_CONTACT, "ground contact", "a ground that nodes may touch", false},
    {STRUT_TERM_FRICTION, "friction", "a ground with friction", false},
    {STRUT_TERM_SLOPE, "inclined ground", "a ground with a slope", false},
    {STRUT_TERM_SURFACES, "ground surfaces", "several grounds, or one that is no line at rest",
     false},
    {STRUT_TERM_SOLVE, "mass solve", "consistent masses of members", false},
    {STRUT_TERM_ACTUATOR_FORCES, "actuator forces", "an actuator with a force or moment", false},
    {STRUT_TERM_MASS_DAMPING, "damping by mass", "rayleigh with mass", false},
    {STRUT_TERM_SUPPORT_MOTION, "moving supports", "a node that moves", false},
    {STRUT_TERM_UNBALANCE, "unbalances", "a rotating mass", false},
    {STRUT_TERM_SLIDING_MASS, "sliding masses", "a slider that moves", false},
    {STRUT_TERM_RUBBING, "feet and collisions that rub", "a foot", false},
};
_Static_assert(sizeof terms / sizeof terms[0] == STRUT_COST_TERMS, "one for each term");

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
    const strut_member *m = &scene->members[j];
    estimate->count.running_cables += m->guide_count > 0;
    estimate->count.laws +=
        m->law.kind != STRUT_LAW_LINEAR || m->law.carries == STRUT_CARRIES_COMPRESSION;
    estimate->count.stops += (size_t)(m->shortest > 0.0) + (size_t)(m->longest > 0.0);
  }
  for (int32_t i = 0; i < model->elements.count; i++)
    estimate->count.reeled += model->elements.element[i].law == STRUT_LAW_AXIAL;
  estimate->count.hinges = scene->hinge_count;
  estimate->count.cells = scene->cell_count;
  estimate->count.collisions = scene->collision_count;
  estimate->count.breakables = (size_t)model->elements.breakable_count;
  estimate->count.contacts = (size_t)model->contacts.count;
  estimate->count.actuators = scene->actuator_count;
  estimate->count.loads = scene->load_count;
  estimate->bytes = model->arena.bytes + sizeof *model;
}

/* Elements are one term of the model, and one line here for each kind of them. */
static bool has_element(const strut_cost_estimate *estimate, const char *name) {
  const struct {
    const char *name;
    size_t count;
  } kinds[] = {{"running cables", estimate->count.running_cables},
               {"member laws", estimate->count.laws},
               {"reeled members", estimate->count.reeled},
               {"stops", estimate->count.stops},
               {"hinges", estimate->count.hinges},
               {"cells", estimate->count.cells},
               {"collisions", estimate->count.collisions},
               {"driven rest lengths", estimate->count.actuators},
               {"breaks and releases", estimate->count.breakables}};
  for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
    if (strcmp(kinds[i].name, name) == 0) return kinds[i].count > 0;
  return true;
}

strut_status strut_cost_estimate_describe(const strut_model *model, strut_cost_estimate *estimate,
                                          strut_error *error) {
  *estimate = (strut_cost_estimate){0};
  count_elements(model, estimate);
  for (int i = 0; i < STRUT_COST_TERMS; i++) {
    estimate->terms[i] = terms[i];
    estimate->terms[i].in = model->terms & terms[i].term && has_element(estimate, terms[i].name);
  }
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

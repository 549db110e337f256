/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/integrator.h"

#include <string.h>

#include "engine/forces/rigid.h"

static const strut_integrator *const table[] = {
    &strut_integrator_rk4,        &strut_integrator_euler,        &strut_integrator_verlet,
    &strut_integrator_rk4_events, &strut_integrator_euler_events, &strut_integrator_verlet_events,
    &strut_integrator_adaptive,   &strut_integrator_midpoint};

const strut_integrator *strut_integrator_at(size_t i) {
  return i < sizeof table / sizeof table[0] ? table[i] : NULL;
}

const strut_integrator *strut_integrator_find(const char *name) {
  for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
    if (!strcmp(table[i]->name, name)) return table[i];
  return NULL;
}

/* The first contact with exact sticking, or -1. */
static int32_t sticking(const strut_model *model) {
  for (int32_t i = 0; i < model->contacts.count; i++)
    if (model->contacts.entry[i].law == STRUT_FRICTION_COULOMB) return i;
  return -1;
}

strut_status strut_integrator_check(const strut_model *model, const strut_experiment *experiment,
                                    strut_error *error) {
  const strut_scene *scene = model->scene;
  const char *name = experiment->integrator;
  const strut_integrator *method = strut_integrator_find(name);
  if (!method) return strut_fail(error, STRUT_USAGE, "there is no integrator '%s'", name);
  int32_t exact = sticking(model);
  if (exact >= 0 && !method->events)
    return strut_fail(error, STRUT_USAGE,
                      "friction law coulomb at node '%s' needs a method with events; use "
                      "solver.integrator rk4-events, verlet-events or adaptive instead of %s, or "
                      "the law karnopp",
                      scene->nodes[model->contacts.entry[exact].node].name, name);
  if (method->no_ground && model->contacts.count > 0)
    return strut_fail(error, STRUT_USAGE,
                      "%s cannot step over contacts, and node '%s' may touch the ground; use "
                      "solver.integrator verlet-events, rk4-events or adaptive",
                      name, scene->nodes[model->contacts.entry[0].node].name);
  if (!(model->plan & STRUT_TERM_RIGID)) return STRUT_OK;
  if (!method->rigid)
    return strut_fail(error, STRUT_USAGE,
                      "%s does not keep the lengths of rigid bars; use solver.integrator rk4, or "
                      "bars: elastic",
                      name);
  return model->mass ? strut_rigid_check(model, error) : STRUT_OK;
}

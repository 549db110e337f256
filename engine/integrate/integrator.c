/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/integrator.h"

#include <string.h>

static const strut_integrator *const table[] = {
    &strut_integrator_rk4,        &strut_integrator_euler,        &strut_integrator_verlet,
    &strut_integrator_rk4_events, &strut_integrator_euler_events, &strut_integrator_verlet_events,
    &strut_integrator_adaptive};

const strut_integrator *strut_integrator_at(size_t i) {
  return i < sizeof table / sizeof table[0] ? table[i] : NULL;
}

const strut_integrator *strut_integrator_find(const char *name) {
  for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
    if (!strcmp(table[i]->name, name)) return table[i];
  return NULL;
}

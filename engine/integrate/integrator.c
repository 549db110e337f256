/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/integrator.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/forces.h"
#include "engine/forces/rigid.h"
#include "engine/model/algebra/linear_solver.h"

/* The rows, each defined in its method's own file. */
#define STRUT_INTEGRATOR_ROW(row, word, steps) extern const strut_integrator strut_integrator_##row;
STRUT_INTEGRATORS(STRUT_INTEGRATOR_ROW)
#undef STRUT_INTEGRATOR_ROW

static const strut_integrator *const table[] = {
#define STRUT_INTEGRATOR_ROW(row, word, steps) &strut_integrator_##row,
    STRUT_INTEGRATORS(STRUT_INTEGRATOR_ROW)
#undef STRUT_INTEGRATOR_ROW
};
enum { COUNT = sizeof table / sizeof table[0] };

const strut_integrator *strut_integrator_at(size_t i) { return i < COUNT ? table[i] : NULL; }

const strut_integrator *strut_integrator_find(const char *name) {
  for (size_t i = 0; i < COUNT; i++)
    if (!strcmp(table[i]->name, name)) return table[i];
  return NULL;
}

const strut_integrator *strut_integrator_for(strut_integrator_role role) {
  assert(role != STRUT_ROLE_NONE);
  for (size_t i = 0; i < COUNT; i++)
    if (table[i]->role == role) return table[i];
  assert(false && "every role has a method");
  return NULL;
}

int32_t strut_first_exact_contact(const strut_model *model) {
  for (int32_t i = 0; i < model->contacts.count; i++)
    if (strut_friction_is_exact(model->contacts.entry[i].friction.law)) return i;
  return -1;
}

const strut_integrator *strut_integrator_for_settling(const strut_model *model) {
  bool exact = strut_first_exact_contact(model) >= 0;
  return strut_integrator_for(exact ? STRUT_ROLE_EXACT_STICK : STRUT_ROLE_PLAIN);
}

strut_status strut_integrator_check(const strut_model *model, const strut_experiment *experiment,
                                    strut_error *error) {
  const strut_scene *scene = model->scene;
  const char *name = experiment->integrator;
  const strut_integrator *method = strut_integrator_find(name);
  if (!method) return strut_fail(error, STRUT_USAGE, "there is no integrator '%s'", name);
  int32_t exact = strut_first_exact_contact(model);
  if (exact >= 0 && !method->events)
    return strut_fail(error, STRUT_USAGE,
                      "friction law %s at node '%s' needs a method with events; use "
                      "solver.integrator rk4-events, verlet-events or adaptive instead of %s, or "
                      "the law karnopp",
                      strut_friction_law_at(model->contacts.entry[exact].friction.law)->word,
                      scene->nodes[model->contacts.entry[exact].node].name, name);
  if (method->no_ground && model->contacts.count > 0)
    return strut_fail(error, STRUT_USAGE,
                      "%s cannot step over contacts, and node '%s' may touch the ground; use "
                      "solver.integrator verlet-events, rk4-events or adaptive",
                      name, scene->nodes[model->contacts.entry[0].node].name);
  if (method->no_ground && model->terms & STRUT_TERM_RUBBING)
    return strut_fail(error, STRUT_USAGE,
                      "%s does not know the friction of collisions; use solver.integrator verlet, "
                      "rk4-events or adaptive",
                      name);
  if (method->no_memory && model->terms & STRUT_TERM_MEMORY)
    return strut_fail(error, STRUT_USAGE,
                      "%s cannot step over what breaks, is released, yields or folds; use "
                      "solver.integrator rk4-events, verlet-events or adaptive",
                      name);
  if (method->no_sliding_masses && model->terms & STRUT_TERM_SLIDING_MASS)
    return strut_fail(error, STRUT_USAGE,
                      "%s has no varying mass matrix, and slider '%s' moves; use solver.integrator "
                      "rk4, verlet or adaptive",
                      name, scene->sliding_masses[model->sliding.moving[0]].name);
  if (method->solves) {
    strut_status status = strut_linear_solver_load(error);
    if (status) return status;
  }
  if (!(model->terms & STRUT_TERM_RIGID)) return STRUT_OK;
  if (model->terms & STRUT_TERM_SURFACES)
    return strut_fail(
        error, STRUT_USAGE,
        "rigid bars need a ground that is one straight line at rest; use bars: elastic");
  if (!method->rigid)
    return strut_fail(error, STRUT_USAGE,
                      "%s does not keep the lengths of rigid bars; use solver.integrator rk4, or "
                      "bars: elastic",
                      name);
  return model->mass ? strut_rigid_check(model, error) : STRUT_OK;
}

/* Samples this close to a grid point, in steps, are on it. */
static const double ON_GRID = 1e-6;

/*
 * Samples, starts and switches signals at the present grid point, and accumulates what that does to the elastic
 * energy. Methods with events take samples, touchdowns and relays where they are.
 */
static void update_on_grid(const strut_integrator *method, const strut_model *model,
                           strut_state *state, void *workspace, double dt) {
  double t = (double)state->step * dt, before = 0.0;
  if (state->balance) before = strut_energy_evaluate(model, state, t).elastic;
  bool changed = !method->events && strut_feedback_sample(model, state, t, ON_GRID * dt);
  if (model->feedback.trigger_count && !method->events && strut_feedback_watch(model, state, t))
    changed = true;
  if (model->feedback.relay_count && !method->events && strut_relays_follow(model, state, t))
    changed = true;
  if (!changed) return;
  if (state->balance) {
    double gained = strut_energy_evaluate(model, state, t).elastic - before;
    strut_power_add(state->work, STRUT_POWER_DRIVE, gained);
  }
  if (method->restart) method->restart(model, state, workspace, dt);
}

void strut_integrator_advance(const strut_integrator *method, const strut_model *model,
                              strut_state *state, void *workspace, double dt, int64_t count) {
  const strut_feedback_table *feedback = &model->feedback;
  bool watched = (feedback->trigger_count || feedback->relay_count) && !method->events;
  if (!watched && (!feedback->sampled_count || method->events)) {
    method->advance(model, state, workspace, dt, count);
    return;
  }
  for (int64_t end = state->step + count; state->step < end && !state->trouble;) {
    double t = (double)state->step * dt + state->time_offset;
    update_on_grid(method, model, state, workspace, dt);
    if (state->trouble) break;
    double next = strut_feedback_next_sample(model, t + ON_GRID * dt);
    int64_t steps = (int64_t)fmin((next - t) / dt + 0.5, (double)(end - state->step));
    method->advance(model, state, workspace, dt, steps < 1 || watched ? 1 : steps);
  }
}

strut_status strut_integrator_check_samples(const strut_integrator *method,
                                            const strut_model *model, double dt,
                                            strut_error *error) {
  for (int32_t i = 0; i < model->feedback.sampled_count && !method->events; i++) {
    const strut_signal *signal = &model->scene->signals[model->feedback.sampled[i]];
    double steps = signal->every / dt, whole = round(steps);
    if (whole >= 1.0 && fabs(steps - whole) <= 1e-9 * whole) continue;
    return strut_fail(
        error, STRUT_USAGE,
        "%s%s%s is sampled every %g s, which is no multiple of the step of %.9g s that %s "
        "takes; choose a step of %.9g s, or a method with events, such as rk4-events",
        signal->name ? "signal '" : "a signal", signal->name ? signal->name : "",
        signal->name ? "'" : "", signal->every, dt, method->name,
        signal->every / fmax(1.0, ceil(steps - 1e-9)));
  }
  return STRUT_OK;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/settle.h"

#include <math.h>
#include <string.h>

#include "engine/forces/energy.h"
#include "engine/integrate/integrator.h"

/* The scene with all that moves or holds by itself taken out. Shares texts and arrays. */
static strut_status quiet_scene(const strut_scene *scene, strut_scene *quiet, strut_arena *arena) {
  *quiet = *scene;
  quiet->actuator_count = 0;
  quiet->ground.belt_speed = 0.0;
  quiet->bar_model = STRUT_BARS_ELASTIC; /* rigid from where they have come to rest under load */
  quiet->loads = strut_arena_allocate(arena, scene->load_count, sizeof *quiet->loads);
  quiet->contacts = strut_arena_allocate(arena, scene->contact_count, sizeof *quiet->contacts);
  if (!quiet->loads || !quiet->contacts) return STRUT_NO_MEMORY;
  quiet->load_count = 0;
  for (size_t i = 0; i < scene->load_count; i++)
    if (scene->loads[i].signal < 0) quiet->loads[quiet->load_count++] = scene->loads[i];
  for (size_t i = 0; i < scene->contact_count; i++) {
    quiet->contacts[i] = scene->contacts[i];
    if (!scene->settle.friction) quiet->contacts[i].friction.law = STRUT_FRICTION_NONE;
  }
  return STRUT_OK;
}

static double largest(const double *x, int32_t n) {
  double most = 0.0;
  for (int32_t i = 0; i < n; i++) {
    if (!(fabs(x[i]) <= most)) most = fabs(x[i]);
    if (isnan(x[i])) return HUGE_VAL;
  }
  return most;
}

/* Steps until at rest. acceleration: (length) scratch. */
static strut_status relax(const strut_model *model, strut_state *state,
                          const strut_integrator *method, void *workspace, double *acceleration,
                          const volatile sig_atomic_t *interrupt, strut_error *error) {
  const strut_settle *wanted = &model->scene->settle;
  double dt = model->scene->experiment.step, previous = 0.0;
  int32_t both = model->length;
  size_t bytes = (size_t)both * sizeof(double);
  double speed = HUGE_VAL, push = HUGE_VAL;
  memset(state->v, 0, bytes);
  state->interrupt = interrupt;
  if (method->restart) method->restart(model, state, workspace, dt);
  while ((double)state->step * dt < wanted->limit) {
    if (interrupt && *interrupt)
      return strut_fail(error, STRUT_INTERRUPTED, "interrupted while coming to rest");
    method->advance(model, state, workspace, dt, 1);
    if (state->trouble == STRUT_TROUBLE_INTERRUPT) continue;
    if (state->trouble)
      return strut_fail(error, STRUT_DIVERGED,
                        "%s could not go on while coming to rest, after %g s; settle by another "
                        "method or look for a member of zero length",
                        method->name, (double)state->step * dt);
    double kinetic = strut_energy_kinetic(model, state->v);
    if (!isfinite(kinetic))
      return strut_fail(error, STRUT_DIVERGED,
                        "coming to rest before the run diverged after %g s with a step of %g s; "
                        "use a smaller step",
                        (double)state->step * dt, dt);
    if (kinetic < previous) {
      memset(state->v, 0, bytes);
      if (method->restart) method->restart(model, state, workspace, dt);
      kinetic = 0.0;
    }
    previous = kinetic;
    speed = largest(state->v, both);
    if (!(speed < wanted->speed)) continue;
    strut_forces_acceleration(model, state, 0.0, state->q, state->v, acceleration);
    push = largest(acceleration, both);
    if (push < wanted->acceleration) return STRUT_OK;
  }
  bool slides = model->scene->contact_count && !wanted->friction;
  return strut_fail(error, STRUT_NOT_SETTLED,
                    "the structure did not come to rest within %g s: largest speed %.3g m/s, "
                    "largest acceleration %.3g m/s^2; give a larger initial.settle.limit or "
                    "looser speed and acceleration%s",
                    wanted->limit, speed, push,
                    slides ? ", or let it hold by initial.settle.friction: kept" : "");
}

strut_status strut_settle_state(const strut_model *model, strut_state *state,
                                const volatile sig_atomic_t *interrupt, double *time,
                                strut_error *error) {
  const strut_integrator *method = strut_integrator_find(model->scene->experiment.integrator);
  strut_arena arena = {0};
  strut_scene scene;
  strut_model *quiet = NULL;
  strut_state *rest = NULL;
  void *workspace = NULL;
  size_t bytes = (size_t)model->length * sizeof(double);
  double *acceleration = strut_arena_allocate(&arena, 1, bytes);
  strut_status status = quiet_scene(model->scene, &scene, &arena);
  if (!acceleration) status = STRUT_NO_MEMORY;
  if (status) strut_fail(error, status, "out of memory");
  if (!status) status = strut_model_compile(&scene, &quiet, error);
  if (!status) status = strut_state_create(quiet, &rest, error);
  if (!status && !(workspace = method->create(quiet, rest)))
    status = strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  if (!status) status = relax(quiet, rest, method, workspace, acceleration, interrupt, error);
  if (!status) {
    *time = (double)rest->step * scene.experiment.step;
    memcpy(state->q, rest->q, bytes);
    memset(state->v, 0, bytes);
  }
  strut_state_free(rest);
  strut_model_free(quiet);
  strut_arena_free(&arena);
  return status;
}

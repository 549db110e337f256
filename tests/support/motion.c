/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/support/motion.h"

#include "engine/forces/observe.h"
#include "engine/scene/checks/check.h"

static void check(const strut_scene *scene) {
  OWN(strut_findings) findings = {0};
  const strut_setup setup = {.scene = *scene, .experiment = strut_experiment_default()};
  strut_status status = strut_setup_check(&setup, STRUT_FOR_STATICS, &findings);
  for (size_t i = 0; i < findings.count; i++) print_error("%s\n", findings.items[i].message);
  assert_ok(status);
}

strut_model *motion_compile(const strut_scene *scene) {
  strut_model *model = NULL;
  strut_error error = {0};
  check(scene);
  strut_status status = strut_model_compile(scene, &model, &error);
  if (status) print_error("%s\n", error.message);
  assert_ok(status);
  return model;
}

static motion begin(const strut_scene *scene, const strut_experiment *experiment,
                    const char *method, double step) {
  const strut_integrator_settings settings = strut_integrator_settings_of(experiment);
  motion m = {
      .model = motion_compile(scene), .method = strut_integrator_find(method), .step = step};
  assert_non_null(m.model->mass);
  assert_ok(strut_state_create(m.model, &m.state, NULL));
  assert_non_null(m.method);
  m.workspace = m.method->create(m.model, m.state, &settings);
  assert_non_null(m.workspace);
  return m;
}

motion motion_begin(const strut_scene *scene, double step) {
  const strut_experiment experiment = strut_experiment_default();
  return begin(scene, &experiment, "rk4", step);
}

motion motion_begin_by(const strut_setup *setup, const char *method, double step) {
  return begin(&setup->scene, &setup->experiment, method, step);
}

void motion_steps(motion *m, int64_t count) {
  m->method->advance(m->model, m->state, m->workspace, m->step, count);
}

void motion_members(const strut_model *model, const strut_state *state, double *length,
                    double *force) {
  strut_instant instant = {.model = model, .state = state, .q = state->q, .v = state->v};
  for (int32_t j = 0; j < model->members.count; j++) {
    length[j] = strut_observe_item(&instant, STRUT_COLUMN_LENGTH, j);
    force[j] = strut_observe_item(&instant, STRUT_COLUMN_FORCE, j);
  }
}

void motion_free(motion *m) {
  strut_state_free(m->state);
  strut_model_free(m->model);
}

void motion_experiment(strut_setup *setup, double step, double duration) {
  setup->experiment.step = step, setup->experiment.duration = duration;
}

void motion_experiment_by(strut_setup *setup, double step, double duration, const char *method) {
  motion_experiment(setup, step, duration);
  setup->experiment.integrator = method;
}

strut_status motion_try(const strut_setup *setup, strut_run_options options, strut_summary *summary,
                        strut_error *error) {
  OWN_POINTER(strut_model) model = motion_compile(&setup->scene);
  return strut_simulate(model, &setup->experiment, &options, summary, error);
}

strut_summary motion_simulate(const strut_setup *setup) {
  strut_summary summary;
  strut_error error = {0};
  strut_status status = motion_try(setup, (strut_run_options){0}, &summary, &error);
  if (status) print_error("%s\n", error.message);
  assert_ok(status);
  return summary;
}

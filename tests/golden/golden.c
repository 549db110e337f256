/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Prints two hashes of a run of a model for each of two methods, over every hundredth step: of the motion
 * (positions, velocities, forces) and of the works, so that another order of the energy balance's sums shows as
 * that only. Whatever compiled it, the same file must give the same hashes.
 * Usage: golden MODEL STEPS
 *
 * The table of methods is this file's own: the others are slow to compile and never run here.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/forces/forces.h"
#include "engine/integrate/integrator.h"
#include "parser/language/read/read_scene.h"
#include "tests/support/relax.h"

/* FNV-1a over bytes. */
static uint64_t add(uint64_t hash, const void *data, size_t size) {
  const unsigned char *byte = data;
  for (size_t i = 0; i < size; i++) hash = (hash ^ byte[i]) * 1099511628211u;
  return hash;
}

extern const strut_integrator strut_integrator_rk4, strut_integrator_verlet_events;

static const strut_integrator *const methods[] = {&strut_integrator_rk4,
                                                  &strut_integrator_verlet_events};

const strut_integrator *strut_integrator_find(const char *name) {
  for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++)
    if (!strcmp(methods[i]->name, name)) return methods[i];
  return NULL;
}

const strut_integrator *strut_integrator_for_settling(const strut_model *model) {
  (void)model;
  return &strut_integrator_rk4;
}

typedef struct run_hashes {
  uint64_t motion, works;
} run_hashes;

static run_hashes hash_run(const strut_model *model, const strut_experiment *experiment,
                           strut_state *state, const strut_integrator *method, int64_t steps) {
  const uint64_t empty = 14695981039346656037u;
  const strut_integrator_settings settings = strut_integrator_settings_of(experiment);
  void *workspace = method->create(model, state, &settings);
  size_t length = 2 * (size_t)model->node_count * sizeof(double);
  run_hashes hash = {empty, empty};
  for (int64_t n = 0; workspace && n < steps; n += 100) {
    method->advance(model, state, workspace, experiment->step, 100);
    hash.motion = add(hash.motion, state->q, length);
    hash.motion = add(hash.motion, state->v, length);
    hash.motion = add(hash.motion, state->latest->force, length);
    /* those that the model has: a row that is added behind them changes no hash */
    hash.works = add(hash.works, state->work, (STRUT_POWER_EXCHANGED + 1) * sizeof state->work[0]);
  }
  return hash;
}

/* From the same rest, a state of its own for each method. */
static strut_status hash_methods(const strut_model *model, const strut_experiment *experiment,
                                 int64_t steps, strut_error *error) {
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < sizeof methods / sizeof methods[0] && !status; i++) {
    strut_state *state = NULL;
    status = strut_state_create(model, &state, error);
    if (!status && !(relax(model, experiment, state, error) > 0.0)) status = STRUT_NOT_SETTLED;
    if (!status) {
      state->balance = true;
      run_hashes hash = hash_run(model, experiment, state, methods[i], steps);
      printf("%s motion %016llx\n%s works %016llx\n", methods[i]->name,
             (unsigned long long)hash.motion, methods[i]->name, (unsigned long long)hash.works);
    }
    strut_state_free(state);
  }
  return status;
}

int main(int count, char **argument) {
  strut_error error = {0};
  strut_diagnostics diagnostics = {0};
  strut_setup setup;
  strut_model *model = NULL;
  char *text = NULL;
  size_t length = 0;
  if (count != 3 || strut_file_read(argument[1], &text, &length, &error) ||
      strut_setup_read(&setup, argument[1], text, length, NULL, 0, STRUT_FOR_RUN, &diagnostics) ||
      strut_model_compile(&setup.scene, &model, &error) ||
      hash_methods(model, &setup.experiment, atoll(argument[2]), &error)) {
    fprintf(stderr, "golden: %s\n", error.message);
    return 1;
  }
  strut_model_free(model);
  strut_setup_free(&setup);
  strut_diagnostics_free(&diagnostics);
  strut_release(text);
  return 0;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/command/run_settings.h"

#include "engine/integrate/integrator.h"
#include "parser/command/option_values.h"

static strut_status refuse(const strut_arguments *arguments, const char *message) {
  strut_tell(arguments->listener, STRUT_MESSAGE_ERROR, NULL, "%s", message);
  return STRUT_USAGE;
}

static strut_status set_method(const strut_command *command, const strut_arguments *arguments,
                               strut_experiment *e) {
  const char *words[32] = {0};
  int word = -1;
  for (size_t i = 0; strut_integrator_at(i) && i + 1 < sizeof words / sizeof words[0]; i++)
    words[i] = strut_integrator_at(i)->name;
  strut_status status =
      strut_option_word(command, arguments, STRUT_OPTION_INTEGRATOR, words, &word);
  if (status == STRUT_OK && word >= 0) e->integrator = words[word];
  return status;
}

strut_status strut_run_settings_apply(const strut_command *command,
                                      const strut_arguments *arguments, strut_experiment *e) {
  double steady = 0.0;
  const struct {
    strut_option_id id;
    strut_dimension dimension;
    double *value;
  } numbers[] = {{STRUT_OPTION_ACCURACY, STRUT_DIM_NONE, &e->accuracy},
                 {STRUT_OPTION_STEP, STRUT_DIM_TIME, &e->step},
                 {STRUT_OPTION_TOLERANCE, STRUT_DIM_NONE, &e->tolerance},
                 {STRUT_OPTION_BUDGET, STRUT_DIM_NONE, &e->budget},
                 {STRUT_OPTION_STEADY, STRUT_DIM_NONE, &steady}};
  strut_status status = set_method(command, arguments, e);
  bool by_hand = strut_option_text(arguments, STRUT_OPTION_INTEGRATOR) ||
                 strut_option_text(arguments, STRUT_OPTION_STEP);
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0] && status == STRUT_OK; i++) {
    status = strut_option_number(command, arguments, numbers[i].id, numbers[i].dimension,
                                 numbers[i].value);
    bool given = strut_option_text(arguments, numbers[i].id);
    if (status == STRUT_OK && given && !(*numbers[i].value > 0.0))
      return refuse(
          arguments,
          "--accuracy, --budget, --step, --tolerance and --steady must be greater than 0");
  }
  if (status != STRUT_OK) return status;
  if (strut_option_text(arguments, STRUT_OPTION_STEADY)) {
    if (!(e->periods > 0.0))
      return refuse(arguments, "--steady compares periods: the run must be given in periods");
    e->steady.wanted = true;
    e->steady.tolerance = steady;
  }
  if (by_hand && strut_option_text(arguments, STRUT_OPTION_ACCURACY))
    return refuse(
        arguments,
        "--accuracy chooses method and step: give either --accuracy, or --integrator and --step");
  if (by_hand) e->accuracy = 0.0;
  if (e->accuracy > 1.0) return refuse(arguments, "--accuracy must be at most 1, that is 100%");
  return STRUT_OK;
}

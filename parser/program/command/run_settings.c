/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/command/run_settings.h"

#include "engine/base/text.h"
#include "engine/integrate/integrator.h"

const strut_option strut_method_options[] = {
    {STRUT_FILLS(integrator), "integrator", "NAME",
     "integration method, instead of that of the file", .words = STRUT_INTEGRATOR_WORDS},
    {STRUT_FILLS(step), "step", "TIME", "time step, instead of that of the file",
     .measure = STRUT_MEASURE_TIME, STRUT_ABOVE_ZERO},
    {STRUT_FILLS(tolerance), "tolerance", "X", "error tolerance of adaptive and adaptive8",
     STRUT_ABOVE_ZERO},
    {.name = NULL}};

const strut_option strut_run_setting_options[] = {
    {STRUT_FILLS(accuracy), "accuracy", "X",
     "choose method and step for a relative error of the velocity of X, such as 1%",
     STRUT_ACCURACY_RANGE},
    {STRUT_FILLS(budget), "budget", "N",
     "limit on the work of --accuracy, in units of one fine fixed-step run "
     "(default " STRUT_TEXT_OF(STRUT_USUAL_BUDGET) ")",
     STRUT_ABOVE_ZERO},
    {.table = strut_method_options},
    {STRUT_FILLS(steady), "steady", "TOLERANCE",
     "stop once the motion repeats within TOLERANCE, such as 0.5%", STRUT_ABOVE_ZERO},
    {.name = NULL}};

const strut_option strut_fidelity_options[] = {
    {STRUT_FILLS(bars), "bars", "MODEL", "elastic or rigid, instead of the file's",
     .key = STRUT_KEY_SCENE_BARS},
    {STRUT_FILLS(mass_model), "mass-model", "MODEL", "consistent or lumped, instead of the file's",
     .key = STRUT_KEY_SCENE_MASS_MODEL},
    {STRUT_FILLS(friction_law), "friction-law", "LAW",
     "none, karnopp, coulomb, smooth, stribeck or lugre, instead of the file's",
     .key = STRUT_KEY_FRICTION_LAW},
    {STRUT_FILLS(damping_law), "damping-law", "LAW",
     "of the ground: approach_only or hunt_crossley, instead of the file's",
     .key = STRUT_KEY_GROUND_DAMPING_LAW},
    {.name = NULL}};

const strut_option strut_experiment_options[] = {
    {.table = strut_run_setting_options}, {.table = strut_fidelity_options}, {.name = NULL}};

static strut_status apply_settings(const strut_arguments *arguments, strut_experiment *experiment) {
  bool by_hand = arguments->integrator.text || arguments->step.text;
  if (arguments->integrator.text)
    experiment->integrator = strut_integrator_find(arguments->integrator.text)->name;
  if (arguments->accuracy.text)
    experiment->accuracy = arguments->accuracy.value, experiment->accuracy_assumed = false;
  if (arguments->step.text) experiment->step = arguments->step.value;
  if (arguments->tolerance.text) experiment->tolerance = arguments->tolerance.value;
  if (arguments->budget.text) experiment->budget = arguments->budget.value;
  if (arguments->steady.text && !(experiment->periods > 0.0))
    return strut_usage_error(arguments,
                             "--steady compares periods: the run must be given in periods");
  if (arguments->steady.text)
    experiment->steady.wanted = true, experiment->steady.tolerance = arguments->steady.value;
  if (by_hand && arguments->accuracy.text)
    return strut_usage_error(
        arguments,
        "--accuracy chooses method and step: give either --accuracy, or --integrator and --step");
  if (by_hand) experiment->accuracy = 0.0;
  bool stepless = experiment->step_chosen || (by_hand && experiment->step == 0.0);
  if (stepless && !strut_experiment_is_adaptive(experiment->integrator) &&
      !(experiment->accuracy > 0.0) && !arguments->step.text)
    return strut_usage_error(
        arguments,
        "the solver has no step, which only adaptive and adaptive8 do without: give --step");
  if (experiment->accuracy > 1.0)
    return strut_usage_error(arguments, "--accuracy must be at most 1, that is 100%%");
  return STRUT_OK;
}

static strut_status set_friction(const strut_arguments *arguments, strut_scene *scene,
                                 strut_friction_law law) {
  bool any = false;
  for (size_t i = 0; i < scene->contact_count; i++) {
    strut_friction *friction = &scene->contacts[i].friction;
    if (friction->law == STRUT_FRICTION_NONE) continue;
    any = true;
    for (int p = 0; p < STRUT_FRICTION_PARAMETER_COUNT; p++) {
      if (!strut_friction_needs(law, p) || !strut_friction_above_zero(p)) continue;
      if (strut_friction_value(friction, p) > 0.0) continue;
      return strut_usage_error(arguments, "--friction-law %s needs ground.friction.%s in the model",
                               strut_friction_law_at(law)->word, strut_friction_key(p));
    }
    friction->law = law;
  }
  if (any) return STRUT_OK;
  return strut_usage_error(arguments, "--friction-law needs a ground with friction in the model");
}

static strut_status set_damping(const strut_arguments *arguments, strut_scene *scene,
                                strut_ground_damping law) {
  bool damped = false, other = false;
  if (!strut_scene_has_ground(scene))
    return strut_usage_error(arguments, "--damping-law needs a ground in the model");
  for (size_t i = 0; i < scene->contact_count; i++) {
    bool crossley = law == STRUT_DAMPING_HUNT_CROSSLEY;
    damped = damped || (crossley ? scene->contacts[i].dissipation : scene->contacts[i].damping) > 0;
    other = other || (crossley ? scene->contacts[i].damping : scene->contacts[i].dissipation) > 0;
  }
  if (other && !damped)
    return strut_usage_error(arguments, "--damping-law %s in the model",
                             law == STRUT_DAMPING_HUNT_CROSSLEY
                                 ? "hunt_crossley needs ground.dissipation"
                                 : "approach_only needs ground.damping");
  scene->ground.damping_law = law;
  for (size_t g = 0; g < scene->ground_count; g++) scene->grounds[g].damping_law = law;
  return STRUT_OK;
}

const strut_option *strut_run_option_given(const strut_arguments *arguments, size_t i) {
  const strut_option *row;
  for (size_t k = 0; (row = strut_option_row(strut_experiment_options, k)); k++)
    if (strut_given_text(row, arguments) && !i--) break;
  return row;
}

strut_purpose strut_run_options_purpose(const strut_arguments *arguments) {
  const char *method = arguments->integrator.text;
  bool later = arguments->accuracy.text || arguments->step.text ||
               (method && strut_experiment_is_adaptive(method));
  return later ? STRUT_FOR_RUN_STEP_LATER : STRUT_FOR_RUN;
}

strut_status strut_run_options_apply(const strut_arguments *arguments, strut_setup *setup) {
  strut_scene *scene = &setup->scene;
  strut_status status = apply_settings(arguments, &setup->experiment);
  if (status) return status;
  if (arguments->bars.text) scene->bar_model = (strut_bar_model)arguments->bars.index;
  if (arguments->mass_model.text) scene->mass_model = (strut_mass_model)arguments->mass_model.index;
  if (arguments->friction_law.text)
    status = set_friction(arguments, scene, (strut_friction_law)arguments->friction_law.index);
  if (!status && arguments->damping_law.text)
    status = set_damping(arguments, scene, (strut_ground_damping)arguments->damping_law.index);
  if (!status) strut_experiment_choose_step(&setup->experiment, scene);
  return status;
}

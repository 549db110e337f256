/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/command/run_settings.h"

#include <stdio.h>

#include "engine/integrate/integrator.h"
#include "parser/command/arguments.h"
#include "parser/language/keys.h"

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

static strut_status apply_settings(const strut_command *command, const strut_arguments *arguments,
                                   strut_experiment *e) {
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
  bool stepless = e->step_chosen || (by_hand && e->step == 0.0);
  if (stepless && !strut_experiment_is_adaptive(e->integrator) && !(e->accuracy > 0.0) &&
      !strut_option_text(arguments, STRUT_OPTION_STEP))
    return refuse(
        arguments,
        "the solver has no step, which only adaptive and adaptive8 do without: give --step");
  if (e->accuracy > 1.0) return refuse(arguments, "--accuracy must be at most 1, that is 100%");
  return STRUT_OK;
}

/* Reads an option whose words are those of a key: the word's index, as the reader stores it too. */
static strut_status read_word(const strut_command *command, const strut_arguments *arguments,
                              strut_option_id id, int key, int *word) {
  enum { MOST = 8, LONGEST = 24 };
  char text[MOST][LONGEST];
  const char *words[MOST + 1] = {0};
  for (int i = 0; i < MOST; i++)
    if (!(words[i] = strut_word_at(strut_key_at(key)->words, i, text[i], LONGEST))) break;
  const char *given = strut_option_text(arguments, id);
  const strut_spelling *other =
      given ? strut_spelling_find(strut_key_at(key)->section, strut_key_at(key)->name, given)
            : NULL;
  if (!other || other->kind == STRUT_SPELLING_MISTAKE)
    return strut_option_word(command, arguments, id, words, word);
  if (other->kind == STRUT_SPELLING_FORMER)
    strut_tell(arguments->listener, STRUT_MESSAGE_NOTE, command->name, "'%s' is now called '%s'",
               other->other, other->current);
  *word = strut_word_find(strut_key_at(key)->words, other->current);
  return STRUT_OK;
}

static strut_status refuse_fidelity(const strut_arguments *arguments, const char *option,
                                    const char *needs) {
  strut_tell(arguments->listener, STRUT_MESSAGE_ERROR, NULL, "--%s %s", option, needs);
  return STRUT_USAGE;
}

static strut_status set_friction(const strut_arguments *arguments, strut_scene *scene,
                                 strut_friction_law law) {
  bool any = false;
  for (size_t i = 0; i < scene->contact_count; i++) {
    strut_friction *f = &scene->contacts[i].friction;
    if (f->law == STRUT_FRICTION_NONE) continue;
    any = true;
    for (int p = 0; p < STRUT_FRICTION_PARAMETER_COUNT; p++) {
      char needs[120];
      if (!strut_friction_needs(law, p) || !strut_friction_above_zero(p)) continue;
      if (strut_friction_value(f, p) > 0.0) continue;
      snprintf(needs, sizeof needs, "%s needs ground.friction.%s in the model",
               strut_friction_law_at(law)->word, strut_friction_key(p));
      return refuse_fidelity(arguments, "friction-law", needs);
    }
    f->law = law;
  }
  return any ? STRUT_OK
             : refuse_fidelity(arguments, "friction-law",
                               "needs a ground with friction in the model");
}

static strut_status set_damping(const strut_arguments *arguments, strut_scene *scene,
                                strut_ground_damping law) {
  bool damped = false, other = false;
  if (!strut_scene_has_ground(scene))
    return refuse_fidelity(arguments, "damping-law", "needs a ground in the model");
  for (size_t i = 0; i < scene->contact_count; i++) {
    bool crossley = law == STRUT_DAMPING_HUNT_CROSSLEY;
    damped = damped || (crossley ? scene->contacts[i].dissipation : scene->contacts[i].damping) > 0;
    other = other || (crossley ? scene->contacts[i].damping : scene->contacts[i].dissipation) > 0;
  }
  if (other && !damped)
    return refuse_fidelity(arguments, "damping-law",
                           law == STRUT_DAMPING_HUNT_CROSSLEY
                               ? "hunt_crossley needs ground.dissipation in the model"
                               : "approach_only needs ground.damping in the model");
  scene->ground.damping_law = law;
  for (size_t g = 0; g < scene->ground_count; g++) scene->grounds[g].damping_law = law;
  return STRUT_OK;
}

static strut_status apply_fidelity(const strut_command *command, const strut_arguments *arguments,
                                   strut_scene *scene) {
  int bars = -1, mass = -1, friction = -1, damping = -1;
  const struct {
    strut_option_id id;
    int key, *word;
  } words[] = {{STRUT_OPTION_BARS, STRUT_KEY_SCENE_BARS, &bars},
               {STRUT_OPTION_MASS_MODEL, STRUT_KEY_SCENE_MASS_MODEL, &mass},
               {STRUT_OPTION_FRICTION_LAW, STRUT_KEY_FRICTION_LAW, &friction},
               {STRUT_OPTION_DAMPING_LAW, STRUT_KEY_GROUND_DAMPING_LAW, &damping}};
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < sizeof words / sizeof words[0] && status == STRUT_OK; i++)
    status = read_word(command, arguments, words[i].id, words[i].key, words[i].word);
  if (status != STRUT_OK) return status;
  if (bars >= 0) scene->bar_model = (strut_bar_model)bars;
  if (mass >= 0) scene->mass_model = (strut_mass_model)mass;
  if (friction >= 0) status = set_friction(arguments, scene, (strut_friction_law)friction);
  if (status == STRUT_OK && damping >= 0)
    status = set_damping(arguments, scene, (strut_ground_damping)damping);
  return status;
}

const strut_option *strut_run_option_given(const strut_arguments *arguments, size_t i) {
  static const strut_option rows[] = {STRUT_RUN_SETTING_OPTIONS, STRUT_FIDELITY_OPTIONS};
  for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++)
    if (strut_option_text(arguments, rows[k].id) && !i--) return &rows[k];
  return NULL;
}

strut_purpose strut_run_options_purpose(const strut_arguments *arguments) {
  const char *method = strut_option_text(arguments, STRUT_OPTION_INTEGRATOR);
  bool later = strut_option_text(arguments, STRUT_OPTION_ACCURACY) ||
               strut_option_text(arguments, STRUT_OPTION_STEP) ||
               (method && strut_experiment_is_adaptive(method));
  return later ? STRUT_FOR_RUN_STEP_LATER : STRUT_FOR_RUN;
}

strut_status strut_run_options_apply(const strut_command *command, const strut_arguments *arguments,
                                     strut_setup *setup) {
  strut_status status = apply_settings(command, arguments, &setup->experiment);
  if (status == STRUT_OK) status = apply_fidelity(command, arguments, &setup->scene);
  if (status == STRUT_OK) strut_experiment_choose_step(&setup->experiment, &setup->scene);
  return status;
}

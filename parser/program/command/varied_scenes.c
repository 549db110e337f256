/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/command/varied_scenes.h"

#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/scene/things.h"
#include "parser/program/command/run_settings.h"

const char *strut_unit_of(strut_dimension dimension) {
  const char *unit = strut_dimension_unit(dimension);
  return strcmp(unit, "1") == 0 || strcmp(unit, "SI") == 0 ? "" : unit;
}

static bool is_varied(const char *const *names, size_t count, const char *name) {
  bool found = false;
  for (size_t i = 0; i < count; i++) found = found || strcmp(names[i], name) == 0;
  return found;
}

/* Appends the setting of a varied parameter. False: the tree is not there. */
static bool add_varied(strut_varied_scenes *scenes, const char *name, strut_dimension *dimension) {
  const strut_declared *declared =
      scenes->source ? strut_scene_source_parameter(scenes->source, name) : NULL;
  if (!declared) return false;
  scenes->settings[scenes->setting_count++] = (strut_setting){.name = name,
                                                              .text = "",
                                                              .known = !declared->text,
                                                              .bare = declared->bare,
                                                              .dimension = declared->dimension};
  scenes->varied++;
  if (dimension) *dimension = declared->bare ? STRUT_DIM_NONE : declared->dimension;
  return true;
}

strut_status strut_varied_scenes_open(const strut_arguments *arguments, const char *const *names,
                                      size_t count, strut_varied_scenes *scenes,
                                      strut_dimension *dimensions) {
  strut_diagnostics unused = {0};
  if (!scenes->source) {
    strut_scene_source_open(scenes->file, scenes->text, scenes->length, &unused, &scenes->own);
    scenes->source = scenes->own;
  }
  strut_diagnostics_free(&unused);
  scenes->settings = strut_allocate(arguments->override_count + count, sizeof *scenes->settings);
  bool fine = scenes->settings && scenes->source;
  for (size_t i = 0; i < arguments->override_count && fine; i++)
    if (!is_varied(names, count, arguments->overrides[i].name))
      scenes->settings[scenes->setting_count++] = (strut_setting){
          .name = arguments->overrides[i].name, .text = arguments->overrides[i].value};
  for (size_t i = 0; i < count && fine; i++)
    fine = add_varied(scenes, names[i], dimensions ? &dimensions[i] : NULL);
  if (fine) return STRUT_OK;
  strut_tell(arguments->listener, STRUT_MESSAGE_ERROR, NULL, "out of memory");
  return STRUT_NO_MEMORY;
}

/* The first finding by its place, without the "--set NAME=VALUE: " of a varied parameter. */
static strut_status report_first(const strut_varied_scenes *scenes, const strut_setting *settings,
                                 const strut_diagnostics *diagnostics, strut_error *error) {
  char set[300], at[300];
  if (diagnostics->count == 0) return strut_fail(error, STRUT_BAD_SCENE, "the scene is not valid");
  const strut_diagnostic *first = &diagnostics->items[0];
  for (size_t i = 1; i < diagnostics->count; i++)
    if (diagnostics->items[i].place.line < first->place.line) first = &diagnostics->items[i];
  const char *message = first->message;
  size_t used = 0;
  for (size_t i = scenes->setting_count - scenes->varied; i < scenes->setting_count; i++) {
    const strut_setting *setting = &settings[i];
    snprintf(set, sizeof set, "--set %.100s=%.100s: ", setting->name, setting->text);
    if (strncmp(message, set, strlen(set)) == 0) message += strlen(set);
    int n = snprintf(at + used, sizeof at - used, "%s%.80s = %.40s", used ? ", " : "",
                     setting->name, setting->text);
    used += n > 0 ? (size_t)n : 0;
    if (used > sizeof at - 1) used = sizeof at - 1;
  }
  const char *between = used ? ": " : "", *where = used ? "at " : "";
  if (!used) *at = '\0';
  if (first->place.line == 0)
    return strut_fail(error, STRUT_BAD_SCENE, "%s%s%s%s", where, at, between, message);
  return strut_fail(error, STRUT_BAD_SCENE, "%s:%u:%u: %s%s%s%s",
                    strut_diagnostics_file(diagnostics, first->place), first->place.line,
                    first->place.column, where, at, between, message);
}

strut_status strut_varied_scenes_vary(const strut_varied_scenes *scenes,
                                      const strut_study_value *values, const strut_derived_by *by,
                                      size_t more, const double *numbers, strut_setup *setup,
                                      strut_error *error) {
  strut_diagnostics diagnostics = {0};
  const size_t fixed = scenes->setting_count - scenes->varied;
  size_t count = scenes->setting_count, most = count + more;
  strut_setting *settings = strut_allocate(most, sizeof *settings + STRUT_NUMBER_TEXT);
  if (!settings) return strut_no_memory(error, "");
  char(*texts)[STRUT_NUMBER_TEXT] = (char(*)[STRUT_NUMBER_TEXT])(settings + most);
  if (count) memcpy(settings, scenes->settings, count * sizeof *settings);
  for (size_t i = fixed; i < count; i++) {
    const strut_study_value *value = &values[i - fixed];
    strut_number_text(value->number, texts[i]);
    settings[i].text = settings[i].known ? texts[i] : value->word;
    settings[i].value = value->number;
  }
  for (size_t i = 0; i < more; i++)
    strut_setting_put(scenes->source, by[i].name, numbers[i], texts[most - 1 - i], settings,
                      &count);
  strut_status status = strut_scene_source_read(scenes->source, settings, count, scenes->purpose,
                                                &diagnostics, setup);
  if (status == STRUT_BAD_SCENE)
    status = report_first(scenes, settings, &diagnostics, error);
  else if (status != STRUT_OK)
    strut_no_memory(error, "");
  strut_diagnostics_free(&diagnostics);
  strut_release(settings);
  return status;
}

strut_status strut_varied_scenes_read(const strut_varied_scenes *scenes,
                                      const strut_study_value *values, strut_setup *setup,
                                      strut_error *error) {
  return strut_varied_scenes_vary(scenes, values, NULL, 0, NULL, setup, error);
}

strut_status strut_varied_scenes_at(void *context, double value, strut_setup *setup,
                                    strut_error *error) {
  return strut_varied_scenes_read(context, &(strut_study_value){.number = value}, setup, error);
}

void strut_varied_scenes_free(strut_varied_scenes *scenes) {
  strut_scene_source_free(scenes->own);
  strut_release(scenes->settings);
  *scenes = (strut_varied_scenes){0};
}

/* A run whose derivatives are taken. */
typedef struct varied_run {
  const strut_varied_scenes *scenes;
  strut_arguments arguments; /* without messages */
} varied_run;

static strut_status vary_run(void *context, const strut_study_value *values,
                             const strut_derived_by *by, size_t count, const double *numbers,
                             strut_setup *setup, strut_error *error) {
  const varied_run *self = context;
  strut_status status =
      strut_varied_scenes_vary(self->scenes, values, by, count, numbers, setup, error);
  if (status) return status;
  status = strut_run_options_apply(&self->arguments, setup);
  if (status) strut_setup_free(setup);
  return status;
}

static strut_status setup_run(void *context, const strut_study_value *values, strut_setup *setup,
                              strut_error *error) {
  return vary_run(context, values, NULL, 0, NULL, setup, error);
}

strut_status strut_varied_scenes_derive(const strut_arguments *arguments,
                                        strut_varied_scenes *scenes, const strut_setup *setup,
                                        const strut_flag *interrupt, strut_summary *summary,
                                        strut_error *error) {
  varied_run self = {scenes, *arguments};
  const strut_sweep_scenes made = {.setup = setup_run, .vary = vary_run, .context = &self};
  const strut_sweep_options how = {.threads = (int)arguments->threads.value,
                                   .interrupt = interrupt};
  if (!setup->experiment.derivative_count) return STRUT_OK;
  self.arguments.listener = NULL;
  strut_status status = strut_varied_scenes_open(arguments, NULL, 0, scenes, NULL);
  if (!status) status = strut_sweep_derive_run(&made, setup, &how, summary, error);
  strut_varied_scenes_free(scenes);
  return status;
}

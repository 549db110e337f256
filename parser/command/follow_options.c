/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/command/follow_options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/number_text.h"
#include "parser/command/option_values.h"

enum { MOST_STEPS = 100000, MOST_AT = 8 };

/* The first message about a scene, with its place. */
static strut_status report_first(const strut_follow_source *source,
                                 const strut_diagnostics *diagnostics, strut_error *error) {
  const strut_setting *followed = &source->settings[source->setting_count - 1];
  if (diagnostics->count == 0) return strut_fail(error, STRUT_BAD_SCENE, "the scene is not valid");
  const strut_diagnostic *first = &diagnostics->items[0];
  return strut_fail(error, STRUT_BAD_SCENE, "%s:%u:%u: at %s = %.17g: %s", source->file,
                    first->place.line, first->place.column, followed->name, followed->value,
                    first->message);
}

static strut_status make_setup(void *context, double value, strut_setup *setup,
                               strut_error *error) {
  strut_follow_source *source = context;
  strut_diagnostics diagnostics = {0};
  char text[STRUT_NUMBER_TEXT];
  strut_setting *followed = &source->settings[source->setting_count - 1];
  strut_number_text(value, text);
  followed->text = text;
  followed->value = value;
  strut_status status =
      strut_scene_source_read(source->source, source->settings, source->setting_count,
                              STRUT_FOR_RUN_STEP_LATER, &diagnostics, setup);
  if (status == STRUT_BAD_SCENE)
    status = report_first(source, &diagnostics, error);
  else if (status != STRUT_OK)
    strut_fail(error, status, "out of memory");
  strut_diagnostics_free(&diagnostics);
  followed->text = "";
  return status;
}

void strut_follow_source_free(strut_follow_source *source) {
  strut_scene_source_free(source->source);
  strut_release(source->settings);
  source->source = NULL;
  source->settings = NULL;
}

static const char *parameter_at(const void *context, size_t i) {
  const strut_scene *scene = context;
  return i < scene->parameter_count ? scene->parameters[i].name : NULL;
}

static const strut_parameter *find_parameter(const strut_scene *scene, const char *name) {
  for (size_t i = 0; i < scene->parameter_count; i++)
    if (strcmp(scene->parameters[i].name, name) == 0) return &scene->parameters[i];
  return NULL;
}

/* The file's tree, and the settings with which scenes are made of it. */
static strut_status open_source(const strut_arguments *arguments, strut_follow_source *source,
                                strut_dimension *dimension) {
  strut_diagnostics unused = {0};
  strut_scene_source_open(source->file, source->text, source->length, &unused, &source->source);
  strut_diagnostics_free(&unused);
  source->settings = strut_allocate(arguments->override_count + 1, sizeof *source->settings);
  const strut_declared *declared =
      source->source ? strut_scene_source_parameter(source->source, source->name) : NULL;
  if (!declared || !source->settings) {
    strut_tell(arguments->listener, STRUT_MESSAGE_ERROR, NULL, "out of memory");
    return STRUT_NO_MEMORY;
  }
  for (size_t i = 0; i < arguments->override_count; i++)
    if (strcmp(arguments->overrides[i].name, source->name) != 0)
      source->settings[source->setting_count++] = (strut_setting){
          .name = arguments->overrides[i].name, .text = arguments->overrides[i].value};
  source->settings[source->setting_count++] = (strut_setting){.name = source->name,
                                                              .text = "",
                                                              .known = true,
                                                              .bare = declared->bare,
                                                              .dimension = declared->dimension};
  *dimension = declared->bare ? STRUT_DIM_NONE : declared->dimension;
  return STRUT_OK;
}

static const char *unit_of(strut_dimension dimension) {
  const char *unit = strut_dimension_unit(dimension);
  return strcmp(unit, "1") == 0 || strcmp(unit, "SI") == 0 ? "" : unit;
}

/* NAME=LOW..HIGH */
static strut_status read_range(const strut_command *command, const strut_arguments *arguments,
                               const strut_scene *scene, strut_follow_source *source,
                               strut_follow_options *wanted, strut_dimension *dimension) {
  const char *over = strut_option_text(arguments, STRUT_OPTION_OVER);
  const char *equals = over ? strchr(over, '=') : NULL,
             *dots = equals ? strstr(equals, "..") : NULL;
  char low[200];
  if (!over || !dots || equals == over || (size_t)(equals - over) >= sizeof source->name ||
      (size_t)(dots - equals) >= sizeof low)
    return strut_usage_error(command, arguments,
                             "missing --over NAME=LOW..HIGH, such as --over frequency=8Hz..12Hz");
  snprintf(source->name, sizeof source->name, "%.*s", (int)(equals - over), over);
  snprintf(low, sizeof low, "%.*s", (int)(dots - equals - 1), equals + 1);
  const strut_parameter *parameter = find_parameter(scene, source->name);
  if (!parameter) {
    const char *near = strut_did_you_mean(source->name, parameter_at, scene);
    return strut_usage_error(command, arguments, "--over: the model has no parameter '%s'%s%s%s",
                             source->name, near ? "; did you mean '" : "", near ? near : "",
                             near ? "'?" : "");
  }
  if (!isfinite(parameter->value))
    return strut_usage_error(command, arguments,
                             "--over: parameter '%s' is a text, expected a number", source->name);
  strut_status status = open_source(arguments, source, dimension);
  if (status) return status;
  if (strut_option_numbers(low, *dimension, &wanted->low, 1) != 1 ||
      strut_option_numbers(dots + 2, *dimension, &wanted->high, 1) != 1 ||
      !(wanted->low < wanted->high) || !isfinite(wanted->low) || !isfinite(wanted->high)) {
    const char *example = strut_dimension_example(*dimension);
    return strut_usage_error(
        command, arguments, "--over %s: expected two values LOW..HIGH, the lower one first%s%s",
        source->name, example ? ", each such as " : "", example ? example : "");
  }
  wanted->name = source->name;
  wanted->unit = unit_of(*dimension);
  return STRUT_OK;
}

/* Values of --at, or the scene's own where it is within the range, or the middle. */
static strut_status read_values(const strut_command *command, const strut_arguments *arguments,
                                const strut_scene *scene, strut_dimension dimension,
                                const strut_follow_options *wanted, double values[MOST_AT],
                                size_t *count) {
  const char *at = strut_option_text(arguments, STRUT_OPTION_AT);
  double own = find_parameter(scene, wanted->name)->value;
  *count = 1;
  values[0] = own >= wanted->low && own <= wanted->high ? own : 0.5 * (wanted->low + wanted->high);
  if (!at) return STRUT_OK;
  *count = strut_option_numbers(at, dimension, values, MOST_AT);
  bool good = *count > 0;
  for (size_t i = 0; i < *count; i++)
    good = good && values[i] >= wanted->low && values[i] <= wanted->high;
  if (good) return STRUT_OK;
  return strut_usage_error(command, arguments,
                           "--at expects values of %s within the range, with commas between",
                           wanted->name);
}

/* Names of --from into source->from; returns how many, 0 where there are none. */
static size_t read_names(const strut_arguments *arguments, strut_follow_source *source,
                         const char *names[STRUT_FOLLOW_MOST_STARTS]) {
  const char *from = strut_option_text(arguments, STRUT_OPTION_FROM);
  size_t count = 0, used = 0;
  while (from && *from && count < STRUT_FOLLOW_MOST_STARTS / MOST_AT) {
    while (*from == ' ') from++;
    size_t length = strcspn(from, ","), kept = length;
    while (kept > 0 && from[kept - 1] == ' ') kept--;
    if (used + kept + 1 > sizeof source->from) break;
    memcpy(source->from + used, from, kept);
    source->from[used + kept] = '\0';
    names[count++] = source->from + used;
    used += kept + 1;
    from += length + (from[length] == ',');
  }
  return count;
}

static strut_status check_names(const strut_command *command, const strut_arguments *arguments,
                                const strut_scene *scene, const char *const *names, size_t count) {
  for (size_t i = 0; i < count; i++) {
    bool known = false;
    for (size_t k = 0; k < scene->configuration_count; k++)
      known = known || strcmp(scene->configurations[k].name, names[i]) == 0;
    if (!known)
      return strut_usage_error(command, arguments, "--from: the model has no configuration '%s'",
                               names[i]);
  }
  return STRUT_OK;
}

strut_status strut_follow_options_read(const strut_command *command,
                                       const strut_arguments *arguments, const strut_scene *scene,
                                       strut_follow_source *source, strut_follow_options *wanted) {
  strut_dimension dimension = STRUT_DIM_NONE;
  const char *names[STRUT_FOLLOW_MOST_STARTS] = {NULL};
  double values[MOST_AT];
  size_t value_count = 0, name_count = read_names(arguments, source, names);
  int64_t steps = 0;
  strut_status status = read_range(command, arguments, scene, source, wanted, &dimension);
  if (!status)
    status = read_values(command, arguments, scene, dimension, wanted, values, &value_count);
  if (!status) status = check_names(command, arguments, scene, names, name_count);
  if (!status)
    status = strut_option_integer(command, arguments, STRUT_OPTION_STEPS, 1, MOST_STEPS, &steps);
  if (!status)
    status = strut_option_number(command, arguments, STRUT_OPTION_ACCURACY, STRUT_DIM_NONE,
                                 &wanted->accuracy);
  if (!status && strut_option_text(arguments, STRUT_OPTION_ACCURACY) &&
      !(wanted->accuracy > 0.0 && wanted->accuracy <= 0.1))
    status = strut_usage_error(command, arguments, "--accuracy expects a value up to 10 %%");
  if (status) return status;
  for (size_t v = 0; v < value_count; v++)
    for (size_t k = 0; k < (name_count ? name_count : 1); k++)
      source->starts[wanted->start_count++] = (strut_follow_start){values[v], names[k]};
  wanted->starts = source->starts;
  wanted->steps = (int32_t)steps;
  wanted->basins = arguments->basins;
  wanted->method = strut_option_text(arguments, STRUT_OPTION_INTEGRATOR);
  wanted->scenes = (strut_follow_scenes){make_setup, source};
  return STRUT_OK;
}

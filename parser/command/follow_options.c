/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/command/follow_options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "parser/command/option_values.h"

enum { MOST_STEPS = 100000, MOST_AT = 8 };

void strut_follow_source_free(strut_follow_source *source) {
  strut_varied_scenes_free(&source->scenes);
}

static const char *parameter_at(const void *context, size_t i) {
  const strut_scene *scene = context;
  return i < scene->parameter_count ? scene->parameters[i].name : NULL;
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
  const strut_parameter *parameter = strut_find_parameter(scene, source->name);
  if (!parameter) {
    const char *near = strut_did_you_mean(source->name, parameter_at, scene);
    return strut_usage_error(command, arguments, "--over: the model has no parameter '%s'%s%s%s",
                             source->name, near ? "; did you mean '" : "", near ? near : "",
                             near ? "'?" : "");
  }
  if (!isfinite(parameter->value))
    return strut_usage_error(command, arguments,
                             "--over: parameter '%s' is a text, expected a number", source->name);
  const char *const name = source->name;
  source->scenes.purpose = STRUT_FOR_RUN_STEP_LATER;
  strut_status status = strut_varied_scenes_open(arguments, &name, 1, &source->scenes, dimension);
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
  wanted->unit = strut_unit_of(*dimension);
  return STRUT_OK;
}

/* Values of --at, or the scene's own where it is within the range, or the middle. */
static strut_status read_values(const strut_command *command, const strut_arguments *arguments,
                                const strut_scene *scene, strut_dimension dimension,
                                const strut_follow_options *wanted, double values[MOST_AT],
                                size_t *count) {
  const char *at = strut_option_text(arguments, STRUT_OPTION_AT);
  double own = strut_find_parameter(scene, wanted->name)->value;
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
  wanted->scenes = (strut_follow_scenes){strut_varied_scenes_at, &source->scenes};
  return STRUT_OK;
}

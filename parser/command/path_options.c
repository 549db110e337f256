/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/command/path_options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/number_text.h"
#include "parser/command/option_values.h"

enum { MOST_STEPS = 1000000 };

/* Reports the first message about a scene with its place, without the "--set" of the varied value. */
static strut_status report_first(const strut_followed *source, const strut_diagnostics *diagnostics,
                                 strut_error *error) {
  const strut_setting *followed = &source->settings[source->setting_count - 1];
  char set[300];
  if (diagnostics->count == 0) return strut_fail(error, STRUT_BAD_SCENE, "the scene is not valid");
  const strut_diagnostic *first = &diagnostics->items[0];
  for (size_t i = 1; i < diagnostics->count; i++)
    if (diagnostics->items[i].place.line < first->place.line) first = &diagnostics->items[i];
  snprintf(set, sizeof set, "--set %.100s=%.100s: ", followed->name, followed->text);
  const char *message = first->message;
  if (strncmp(message, set, strlen(set)) == 0) message += strlen(set);
  if (first->place.line == 0) return strut_fail(error, STRUT_BAD_SCENE, "%s", message);
  return strut_fail(error, STRUT_BAD_SCENE, "%s:%u:%u: %s", source->file, first->place.line,
                    first->place.column, message);
}

static strut_status make_setup(void *context, double value, strut_setup *setup,
                               strut_error *error) {
  strut_followed *source = context;
  strut_diagnostics diagnostics = {0};
  char text[STRUT_NUMBER_TEXT];
  strut_setting *followed = &source->settings[source->setting_count - 1];
  strut_number_text(value, text);
  followed->text = text;
  followed->value = value;
  strut_status status =
      strut_scene_source_read(source->source, source->settings, source->setting_count,
                              STRUT_FOR_STATICS, &diagnostics, setup);
  if (status == STRUT_BAD_SCENE)
    status = report_first(source, &diagnostics, error);
  else if (status != STRUT_OK)
    strut_fail(error, status, "out of memory");
  strut_diagnostics_free(&diagnostics);
  return status;
}

void strut_followed_free(strut_followed *source) {
  strut_scene_source_free(source->own);
  strut_release(source->settings);
  *source = (strut_followed){0};
}

/* Everything that --over may name: candidates for suggestions. */
typedef struct candidates {
  const strut_scene *scene;
  strut_arena *arena; /* for "node.x" */
} candidates;

static const char *candidate_at(const void *context, size_t i) {
  const candidates *c = context;
  const strut_scene *scene = c->scene;
  if (i < scene->parameter_count) return scene->parameters[i].name;
  i -= scene->parameter_count;
  if (i < scene->actuator_count) return scene->actuators[i].name;
  i -= scene->actuator_count;
  if (i >= 2 * scene->node_count) return NULL;
  return strut_arena_format(c->arena, "%s.%c", scene->nodes[i / 2].name, i % 2 ? 'y' : 'x');
}

static strut_status reject_name(const strut_command *command, const strut_arguments *arguments,
                                const strut_scene *scene, const char *name) {
  strut_arena arena = {0};
  const candidates all = {.scene = scene, .arena = &arena};
  for (size_t i = 0; i < scene->load_count; i++)
    if (strcmp(scene->loads[i].name, name) == 0)
      return strut_usage_error(command, arguments, "--over: '%s' is a load; use --load %s", name,
                               name);
  const char *near = strut_did_you_mean(name, candidate_at, &all);
  strut_usage_error(command, arguments,
                    "--over: no parameter, actuator, or coordinate of a node (such as '%s.x') is "
                    "called '%s'%s%s%s",
                    scene->node_count ? scene->nodes[0].name : "node", name,
                    near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
  strut_arena_free(&arena);
  return STRUT_USAGE;
}

static const strut_parameter *find_parameter(const strut_scene *scene, const char *name) {
  for (size_t i = 0; i < scene->parameter_count; i++)
    if (strcmp(scene->parameters[i].name, name) == 0) return &scene->parameters[i];
  return NULL;
}

static int32_t find_actuator(const strut_scene *scene, const char *name) {
  for (size_t i = 0; i < scene->actuator_count; i++)
    if (strcmp(scene->actuators[i].name, name) == 0) return (int32_t)i;
  return -1;
}

static const strut_declared *find_declared(const strut_scene_source *source, const char *name) {
  size_t count;
  const strut_declared *all = strut_scene_source_parameters(source, &count);
  for (size_t i = 0; i < count; i++)
    if (strcmp(all[i].name, name) == 0) return &all[i];
  return NULL;
}

/* The file's tree, and the settings with which scenes are made of it. */
static strut_status open_source(const strut_arguments *arguments, const char *name,
                                strut_followed *source, strut_dimension *dimension) {
  strut_diagnostics unused = {0};
  if (!source->source) {
    strut_scene_source_open(source->file, source->text, source->length, &unused, &source->own);
    source->source = source->own;
  }
  strut_diagnostics_free(&unused);
  source->settings = strut_allocate(arguments->override_count + 1, sizeof *source->settings);
  const strut_declared *declared = source->source ? find_declared(source->source, name) : NULL;
  if (!declared || !source->settings) {
    strut_tell(arguments->listener, STRUT_MESSAGE_ERROR, NULL, "out of memory");
    return STRUT_NO_MEMORY;
  }
  for (size_t i = 0; i < arguments->override_count; i++)
    if (strcmp(arguments->overrides[i].name, name) != 0)
      source->settings[source->setting_count++] = (strut_setting){
          .name = arguments->overrides[i].name, .text = arguments->overrides[i].value};
  source->settings[source->setting_count++] = (strut_setting){
      .name = name, .known = true, .bare = declared->bare, .dimension = declared->dimension};
  *dimension = declared->bare ? STRUT_DIM_NONE : declared->dimension;
  return STRUT_OK;
}

/* The unit to print after a value, or "". */
static const char *unit_of(strut_dimension dimension) {
  const char *unit = strut_dimension_unit(dimension);
  return strcmp(unit, "1") == 0 || strcmp(unit, "SI") == 0 ? "" : unit;
}

static strut_status choose_followed(const strut_command *command, const strut_arguments *arguments,
                                    const strut_scene *scene, const char *name,
                                    strut_followed *source, strut_path_options *wanted,
                                    strut_dimension *dimension) {
  const strut_parameter *parameter = find_parameter(scene, name);
  *dimension = STRUT_DIM_LENGTH;
  if (parameter && !isfinite(parameter->value))
    return strut_usage_error(command, arguments,
                             "--over: parameter '%s' is a text, expected a number", name);
  if (parameter) {
    wanted->over = STRUT_PATH_OVER_SCENE;
    wanted->name = name;
    wanted->from = parameter->value;
    wanted->scene_at = make_setup;
    wanted->context = source;
    strut_status status = open_source(arguments, name, source, dimension);
    wanted->unit = unit_of(*dimension);
    return status;
  }
  wanted->over = STRUT_PATH_OVER_ACTUATOR;
  wanted->index = find_actuator(scene, name);
  if (wanted->index >= 0) {
    const strut_actuator *a = &scene->actuators[wanted->index];
    if (a->member < 0) *dimension = a->hinge >= 0 ? STRUT_DIM_ANGLE : STRUT_DIM_STIFFNESS;
    return STRUT_OK;
  }
  wanted->over = STRUT_PATH_OVER_COORDINATE;
  wanted->index = strut_path_coordinate(scene, name);
  return wanted->index >= 0 ? STRUT_OK : reject_name(command, arguments, scene, name);
}

strut_status strut_path_options_read(const strut_command *command, const strut_arguments *arguments,
                                     strut_path_options *wanted) {
  int64_t steps = 0;
  strut_status status =
      strut_option_integer(command, arguments, STRUT_OPTION_STEPS, 1, MOST_STEPS, &steps);
  *wanted = (strut_path_options){.at = strut_option_text(arguments, STRUT_OPTION_AT),
                                 .steps = (int32_t)steps};
  return status;
}

strut_status strut_path_followed_read(const strut_command *command,
                                      const strut_arguments *arguments, const strut_scene *scene,
                                      strut_followed *source, strut_path_options *wanted) {
  const char *name = strut_option_text(arguments, STRUT_OPTION_OVER);
  strut_dimension dimension = STRUT_DIM_NONE;
  strut_status status = STRUT_OK;
  wanted->load = strut_option_text(arguments, STRUT_OPTION_LOAD);
  wanted->until = 1.0;
  if (name && wanted->load)
    return strut_usage_error(command, arguments, "give either --load or --over, not both");
  if (name) status = choose_followed(command, arguments, scene, name, source, wanted, &dimension);
  if (status == STRUT_OK && name && !strut_option_text(arguments, STRUT_OPTION_UNTIL)) {
    const char *example = strut_dimension_example(dimension);
    return strut_usage_error(command, arguments, "missing --until VALUE, the end value of %s%s%s%s",
                             name, example ? ": such as --until \"" : "", example ? example : "",
                             example ? "\"" : "");
  }
  if (status == STRUT_OK)
    status = strut_option_number(command, arguments, STRUT_OPTION_FROM, dimension, &wanted->from);
  if (status == STRUT_OK)
    status = strut_option_number(command, arguments, STRUT_OPTION_UNTIL, dimension, &wanted->until);
  if (status == STRUT_OK &&
      !(isfinite(wanted->from) && isfinite(wanted->until) && wanted->from != wanted->until))
    return strut_usage_error(command, arguments, "--from and --until are equal");
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/command/path_options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "parser/command/option_values.h"

enum { MOST_STEPS = 1000000 };

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

static int32_t find_actuator(const strut_scene *scene, const char *name) {
  for (size_t i = 0; i < scene->actuator_count; i++)
    if (strcmp(scene->actuators[i].name, name) == 0) return (int32_t)i;
  return -1;
}

static strut_status choose_followed(const strut_command *command, const strut_arguments *arguments,
                                    const strut_scene *scene, const char *name,
                                    strut_varied_scenes *scenes, strut_path_options *wanted,
                                    strut_dimension *dimension) {
  const strut_parameter *parameter = strut_find_parameter(scene, name);
  *dimension = STRUT_DIM_LENGTH;
  if (parameter && !isfinite(parameter->value))
    return strut_usage_error(command, arguments,
                             "--over: parameter '%s' is a text, expected a number", name);
  if (parameter) {
    wanted->over = STRUT_PATH_OVER_SCENE;
    wanted->name = name;
    wanted->from = parameter->value;
    wanted->scene_at = strut_varied_scenes_at;
    wanted->context = scenes;
    scenes->purpose = STRUT_FOR_STATICS;
    strut_status status = strut_varied_scenes_open(arguments, &name, 1, scenes, dimension);
    wanted->unit = strut_unit_of(*dimension);
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
                                      strut_varied_scenes *scenes, strut_path_options *wanted) {
  const char *name = strut_option_text(arguments, STRUT_OPTION_OVER);
  strut_dimension dimension = STRUT_DIM_NONE;
  strut_status status = STRUT_OK;
  wanted->load = strut_option_text(arguments, STRUT_OPTION_LOAD);
  wanted->until = 1.0;
  if (name && wanted->load)
    return strut_usage_error(command, arguments, "give either --load or --over, not both");
  if (name) status = choose_followed(command, arguments, scene, name, scenes, wanted, &dimension);
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

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/command/statics_options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/statics/equilibria/equilibria.h"
#include "parser/command/arguments.h"
#include "parser/yaml/diagnostics.h"

enum { MOST_MODES = 1000 };
/* JSON readers represent integers exactly up to here. */
static const int64_t MOST_STARTS = 1000000000, MOST_SEED = 9007199254740992;

static const char *node_name_at(const void *context, size_t i) {
  const strut_scene *scene = context;
  return i < scene->node_count ? scene->nodes[i].name : NULL;
}

static strut_status refuse_node(const strut_command *command, const strut_arguments *arguments,
                                const strut_scene *scene, const char *name, const char *why) {
  const char *near = strut_did_you_mean(name, node_name_at, scene);
  if (near && strcmp(near, name) == 0) near = NULL;
  return strut_usage_error(command, arguments, "--supports: %s '%s'%s%s%s", why, name,
                           near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

/* "n1,n4" as nodes, in the scene's arena; *set stays NULL without --supports. */
static strut_status read_supports(const strut_command *command, const strut_arguments *arguments,
                                  strut_scene *scene, strut_node_set **set) {
  const char *text = strut_option_text(arguments, STRUT_OPTION_SUPPORTS);
  if (!text) return STRUT_OK;
  size_t most = strlen(text) + 1;
  strut_node_set *to = strut_arena_allocate(&scene->arena, 1, sizeof *to);
  char *word = strut_arena_allocate(&scene->arena, most, 1);
  if (to) to->node = strut_arena_allocate(&scene->arena, most, sizeof *to->node);
  if (!to || !word || !to->node) {
    strut_tell(arguments->listener, STRUT_MESSAGE_ERROR, NULL, "out of memory");
    return STRUT_NO_MEMORY;
  }
  for (const char *at = text;; at++) {
    size_t length = strcspn(at, ","), found = 0;
    memcpy(word, at, length);
    word[length] = '\0';
    while (found < scene->node_count && strcmp(scene->nodes[found].name, word) != 0) found++;
    if (found == scene->node_count)
      return refuse_node(command, arguments, scene, word, "there is no node");
    for (size_t i = 0; i < to->count; i++)
      if (to->node[i] == (int32_t)found)
        return refuse_node(command, arguments, scene, word, "named twice:");
    to->node[to->count++] = (int32_t)found;
    at += length;
    if (!*at) break;
  }
  *set = to;
  return STRUT_OK;
}

strut_status strut_equilibria_options_read(const strut_command *command,
                                           const strut_arguments *arguments, strut_setup *setup,
                                           strut_equilibria_options *to, uint64_t *seed) {
  int64_t starts = 0, chosen = (int64_t)setup->experiment.search.seed;
  strut_node_set *set = NULL;
  strut_status status =
      strut_option_integer(command, arguments, STRUT_OPTION_STARTS, 0, MOST_STARTS, &starts);
  if (!status)
    status = strut_option_integer(command, arguments, STRUT_OPTION_SEED, 0, MOST_SEED, &chosen);
  if (!status) status = read_supports(command, arguments, &setup->scene, &set);
  *seed = (uint64_t)chosen;
  *to = (strut_equilibria_options){.starts = starts, .seed = seed, .supports = set};
  return status;
}

strut_status strut_modes_options_read(const strut_command *command,
                                      const strut_arguments *arguments, strut_modes_options *to) {
  int64_t count = 0;
  strut_status status =
      strut_option_integer(command, arguments, STRUT_OPTION_COUNT, 1, MOST_MODES, &count);
  *to = (strut_modes_options){.at = strut_option_text(arguments, STRUT_OPTION_AT),
                              .count = (int32_t)count,
                              .stuck = arguments->stuck};
  return status;
}

strut_status strut_form_options_read(const strut_command *command, const strut_arguments *arguments,
                                     strut_form_options *wanted) {
  static const char *const sources[] = {"densities", "lengths", "prestress", NULL};
  static const char *const objectives[] = {"largest", "sum", "squares", NULL};
  int source = -1, objective = 0;
  strut_status status = strut_option_word(command, arguments, STRUT_OPTION_FROM, sources, &source);
  if (status == STRUT_OK)
    status = strut_option_word(command, arguments, STRUT_OPTION_OBJECTIVE, objectives, &objective);
  if (status == STRUT_OK)
    status = strut_option_number(command, arguments, STRUT_OPTION_LEAST_TENSION, STRUT_DIM_FORCE,
                                 &wanted->least_tension);
  if (status == STRUT_OK)
    status = strut_option_number(command, arguments, STRUT_OPTION_LEAST_DENSITY,
                                 STRUT_DIM_STIFFNESS, &wanted->least_density);
  if (status == STRUT_OK && (wanted->least_tension < 0 || wanted->least_density < 0))
    status = strut_usage_error(
        command, arguments,
        "--least-tension and --least-density must not be negative: cables only pull");
  wanted->from = (strut_form_source)(source + 1);
  wanted->objective = (strut_form_objective)objective;
  return status;
}

strut_status strut_named_shape_find(const strut_arguments *arguments, const strut_model *model,
                                    const strut_experiment *experiment, strut_arena *arena,
                                    strut_named_shape *shape, strut_error *error) {
  const char *name = strut_option_text(arguments, STRUT_OPTION_AT);
  strut_rest_state stand = {0};
  strut_status status =
      strut_rest_state_find(model, experiment, name ? name : "drawn", arena, &stand, error);
  if (status != STRUT_OK) return status;
  *shape = (strut_named_shape){.name = stand.name, .q = stand.q};
  return STRUT_OK;
}

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

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/command/analyses.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/figures/statics_figures.h"
#include "engine/output/report/reports.h"
#include "engine/output/result_values.h"
#include "engine/scene/things.h"
#include "parser/yaml/diagnostics.h"

strut_status strut_analysis_compute(strut_analysis *a, strut_error *error) {
  a->all = a->arguments->all;
  strut_status status = a->kind->compute(a, error);
  a->arguments = NULL;
  return status;
}

void strut_analysis_free(strut_analysis *a) {
  if (a->kind && a->kind->release) a->kind->release(a);
  strut_varied_scenes_free(&a->scenes);
  strut_arena_free(&a->arena);
}

/* ---- options ---- */

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

static strut_status read_equilibria_options(const strut_command *command,
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

static strut_status read_modes_options(const strut_command *command,
                                       const strut_arguments *arguments, strut_modes_options *to) {
  int64_t count = 0;
  strut_status status =
      strut_option_integer(command, arguments, STRUT_OPTION_COUNT, 1, MOST_MODES, &count);
  *to = (strut_modes_options){.at = strut_option_text(arguments, STRUT_OPTION_AT),
                              .count = (int32_t)count,
                              .stuck = arguments->stuck};
  return status;
}

static strut_status read_form_options(const strut_command *command,
                                      const strut_arguments *arguments,
                                      strut_form_options *wanted) {
  static const char *const sources[] = {"densities", "lengths", "prestress", NULL};
  static const char *const objectives[] = {"largest", "sum", "squares", NULL};
  int source = -1, objective = 0;
  double least = NAN;
  strut_status status = strut_option_word(command, arguments, STRUT_OPTION_GIVEN, sources, &source);
  if (status == STRUT_OK)
    status = strut_option_word(command, arguments, STRUT_OPTION_OBJECTIVE, objectives, &objective);
  if (status == STRUT_OK)
    status = strut_option_number(command, arguments, STRUT_OPTION_LEAST_TENSION, STRUT_DIM_FORCE,
                                 &least);
  /* 0 asks for none, while without the option a part of the forces is taken */
  wanted->least_tension = isnan(least) ? 0.0 : least == 0.0 ? DBL_MIN : least;
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

enum { MOST_STEPS = 1000000, DEEPEST = 10 };

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
  if (strut_thing_find(scene, STRUT_THING_LOAD, name) >= 0)
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
  wanted->index = strut_thing_find(scene, STRUT_THING_ACTUATOR, name);
  if (wanted->index >= 0) {
    const strut_actuator *a = &scene->actuators[wanted->index];
    if (a->member < 0) *dimension = a->hinge >= 0 ? STRUT_DIM_ANGLE : STRUT_DIM_STIFFNESS;
    return STRUT_OK;
  }
  wanted->over = STRUT_PATH_OVER_COORDINATE;
  wanted->index = strut_coordinate_find(scene, name);
  return wanted->index >= 0 ? STRUT_OK : reject_name(command, arguments, scene, name);
}

/* --friction, or what the file says. */
static strut_status read_friction(const strut_command *command, const strut_arguments *arguments,
                                  bool *kept) {
  const char *word = strut_option_text(arguments, STRUT_OPTION_FRICTION);
  if (!word) return STRUT_OK;
  *kept = strcmp(word, "kept") == 0;
  if (*kept || strcmp(word, "none") == 0) return STRUT_OK;
  return strut_usage_error(command, arguments, "--friction expects 'none' or 'kept', not '%s'",
                           word);
}

static strut_status read_path_options(const strut_command *command,
                                      const strut_arguments *arguments, bool friction,
                                      strut_path_options *wanted) {
  int64_t steps = 0, branches = 0;
  strut_status status =
      strut_option_integer(command, arguments, STRUT_OPTION_STEPS, 1, MOST_STEPS, &steps);
  if (status == STRUT_OK)
    status = strut_option_integer(command, arguments, STRUT_OPTION_BRANCHES, 1, DEEPEST, &branches);
  *wanted = (strut_path_options){.at = strut_option_text(arguments, STRUT_OPTION_AT),
                                 .steps = (int32_t)steps,
                                 .branches = (int32_t)branches,
                                 .friction = friction};
  return status ? status : read_friction(command, arguments, &wanted->friction);
}

/* NODE.x=VALUE */
static strut_status read_stop(const strut_command *command, const strut_arguments *arguments,
                              const strut_scene *scene, strut_path_stop *stop) {
  const char *text = strut_option_text(arguments, STRUT_OPTION_STOP);
  strut_arena arena = {0};
  if (!text) return STRUT_OK;
  const char *equal = strrchr(text, '=');
  const char *name = equal ? strut_arena_text(&arena, text, (size_t)(equal - text)) : NULL;
  stop->coordinate = name ? strut_coordinate_find(scene, name) : -1;
  stop->given = true;
  bool number = equal &&
                strut_option_numbers(equal + 1, STRUT_DIM_LENGTH, &stop->displacement, 1) == 1 &&
                isfinite(stop->displacement) && stop->displacement != 0.0;
  strut_arena_free(&arena);
  if (stop->coordinate >= 0 && number) return STRUT_OK;
  return strut_usage_error(command, arguments,
                           "--stop expects a node's displacement, not 0, such as %s.x=10mm, not "
                           "'%s'",
                           scene->node_count ? scene->nodes[0].name : "node", text);
}

/* --over WHAT, or WHAT=FROM..UNTIL; texts in the arena, NULL where none is given. */
typedef struct over_text {
  const char *name, *from, *until;
} over_text;

static strut_status read_over(const strut_command *command, const strut_arguments *arguments,
                              strut_arena *arena, over_text *over) {
  const char *text = strut_option_text(arguments, STRUT_OPTION_OVER);
  strut_range_text r;
  *over = (over_text){.name = NULL};
  if (!text) return STRUT_OK;
  if (!strut_range_text_split(text, &r))
    return strut_usage_error(command, arguments, "--over expects WHAT or WHAT=FROM..UNTIL");
  if (r.low && (strut_option_text(arguments, STRUT_OPTION_FROM) ||
                strut_option_text(arguments, STRUT_OPTION_UNTIL)))
    return strut_usage_error(command, arguments,
                             "give either --over WHAT=FROM..UNTIL, or --from and --until");
  over->name = strut_arena_text(arena, r.name, r.name_length);
  if (r.low) over->from = strut_arena_text(arena, r.low, r.low_length);
  over->until = r.high;
  if (over->name && (over->from || !r.low)) return STRUT_OK;
  strut_tell(arguments->listener, STRUT_MESSAGE_ERROR, NULL, "out of memory");
  return STRUT_NO_MEMORY;
}

/* A value of --over WHAT=FROM..UNTIL. */
static strut_status read_over_end(const strut_command *command, const strut_arguments *arguments,
                                  strut_dimension dimension, const char *text, double *value) {
  const char *example = strut_dimension_example(dimension);
  if (!text || strut_option_numbers(text, dimension, value, 1) == 1) return STRUT_OK;
  return strut_usage_error(command, arguments, "--over: expected a value%s%s, not '%s'",
                           example ? " such as " : "", example ? example : "", text);
}

static strut_status read_followed(const strut_command *command, const strut_arguments *arguments,
                                  strut_scene *scene, strut_varied_scenes *scenes,
                                  strut_path_options *wanted) {
  over_text over;
  strut_status early = read_over(command, arguments, &scene->arena, &over);
  if (early != STRUT_OK) return early;
  const char *name = over.name;
  strut_dimension dimension = STRUT_DIM_NONE;
  strut_status status = STRUT_OK;
  wanted->load = strut_option_text(arguments, STRUT_OPTION_LOAD);
  wanted->until = 1.0;
  if (name && wanted->load)
    return strut_usage_error(command, arguments, "give either --load or --over, not both");
  if (name) status = choose_followed(command, arguments, scene, name, scenes, wanted, &dimension);
  if (status == STRUT_OK && name && !over.until &&
      !strut_option_text(arguments, STRUT_OPTION_UNTIL)) {
    const char *example = strut_dimension_example(dimension);
    return strut_usage_error(command, arguments, "missing --until VALUE, the end value of %s%s%s%s",
                             name, example ? ": such as --until \"" : "", example ? example : "",
                             example ? "\"" : "");
  }
  if (status == STRUT_OK)
    status = strut_option_number(command, arguments, STRUT_OPTION_FROM, dimension, &wanted->from);
  if (status == STRUT_OK)
    status = strut_option_number(command, arguments, STRUT_OPTION_UNTIL, dimension, &wanted->until);
  if (status == STRUT_OK)
    status = read_over_end(command, arguments, dimension, over.from, &wanted->from);
  if (status == STRUT_OK)
    status = read_over_end(command, arguments, dimension, over.until, &wanted->until);
  if (status == STRUT_OK &&
      !(isfinite(wanted->from) && isfinite(wanted->until) && wanted->from != wanted->until))
    return strut_usage_error(command, arguments, "--from and --until are equal");
  return status == STRUT_OK ? read_stop(command, arguments, scene, &wanted->stop) : status;
}

#define END                                                                                        \
  { STRUT_OPTION_END, NULL, NULL, NULL }

/* ---- equilibria ---- */

static strut_status compute_equilibria(strut_analysis *a, strut_error *error) {
  strut_equilibria_options wanted;
  uint64_t seed;
  strut_status status = read_equilibria_options(a->command, a->arguments, a->setup, &wanted, &seed);
  if (status != STRUT_OK) return status;
  wanted.interrupt = a->setup->experiment.interrupt;
  return strut_equilibria_find(a->model, &a->setup->experiment, &wanted, &a->result.equilibria,
                               error);
}

static strut_status judge_equilibria(const strut_analysis *a, strut_error *error) {
  const strut_equilibria *all = &a->result.equilibria;
  return all->count > 0 ? STRUT_OK : strut_fail(error, STRUT_NOT_SETTLED, "%s", all->remark);
}

static const strut_value_rows *equilibria_values(const strut_analysis *a, const void **result) {
  *result = &a->result.equilibria;
  return &strut_equilibria_values;
}

static char *equilibria_table(const strut_analysis *a) {
  return strut_equilibria_table(&a->result.equilibria, a->model, a->all);
}

static void warn_of_equilibria(const strut_analysis *a, const strut_listener *listener) {
  strut_warn_of_equilibria(listener, a->model, &a->result.equilibria);
}

static strut_status draw_equilibria(const strut_analysis *a, const strut_plot *plot,
                                    strut_error *error) {
  if (a->result.equilibria.count == 0) return STRUT_OK;
  return strut_equilibria_figure(plot, a->model, &a->result.equilibria, error);
}

static void free_equilibria(strut_analysis *a) { strut_equilibria_free(&a->result.equilibria); }

const strut_option strut_equilibria_analysis_options[] = {STRUT_EQUILIBRIA_OPTIONS, END};

const strut_analysis_kind strut_equilibria_analysis = {.files = {"equilibria.json"},
                                                       .asks = true,
                                                       .compute = compute_equilibria,
                                                       .verdict = judge_equilibria,
                                                       .values = equilibria_values,
                                                       .table = equilibria_table,
                                                       .warn = warn_of_equilibria,
                                                       .draw = draw_equilibria,
                                                       .release = free_equilibria};

/* ---- modes ---- */

static strut_status compute_modes(strut_analysis *a, strut_error *error) {
  strut_modes_options wanted;
  strut_status status = read_modes_options(a->command, a->arguments, &wanted);
  if (status == STRUT_OK && a->arguments->wave && wanted.stuck)
    status = strut_usage_error(a->command, a->arguments,
                               "--stuck holds contacts with the ground; --wave knows no ground");
  if (status != STRUT_OK) return status;
  a->result.modes.count = (size_t)wanted.count;
  a->result.modes.wave = a->arguments->wave;
  const strut_waves_options waves = {.at = wanted.at, .count = wanted.count};
  if (a->result.modes.wave)
    return strut_waves_find(a->model, &a->setup->experiment, &waves, &a->result.modes.waves, error);
  return strut_modes_find(a->model, &a->setup->experiment, &wanted, &a->result.modes.found, error);
}

static const strut_value_rows *modes_values(const strut_analysis *a, const void **result) {
  bool wave = a->result.modes.wave;
  *result = wave ? (const void *)&a->result.modes.waves : &a->result.modes.found;
  return wave ? &strut_waves_values : &strut_modes_values;
}

static char *modes_csv(const strut_analysis *a) {
  const void *result;
  const strut_value_rows *rows = modes_values(a, &result);
  bool wave = a->result.modes.wave;
  return strut_values_csv(rows, wave ? "waves" : "modes", NULL, result, &a->setup->scene);
}

static char *modes_table(const strut_analysis *a) {
  return a->result.modes.wave ? strut_waves_table(a->model, &a->result.modes.waves)
                              : strut_modes_table(a->model, &a->result.modes.found);
}

static void warn_of_modes(const strut_analysis *a, const strut_listener *listener) {
  const double *q = a->result.modes.wave ? a->result.modes.waves.q : a->result.modes.found.q;
  strut_warn_of_overload(listener, a->model, q, "in this shape");
}

static strut_status draw_modes(const strut_analysis *a, const strut_plot *plot,
                               strut_error *error) {
  if (a->result.modes.wave)
    return strut_waves_figure(plot, a->model, &a->result.modes.waves, error);
  return strut_modes_figure(plot, a->model, &a->result.modes.found, a->result.modes.count, error);
}

static void free_modes(strut_analysis *a) {
  strut_modes_free(&a->result.modes.found);
  strut_waves_free(&a->result.modes.waves);
}

const strut_option strut_modes_analysis_options[] = {STRUT_MODES_OPTIONS, END};

const strut_analysis_kind strut_modes_analysis = {.files = {"modes.json", "modes.csv"},
                                                  .compute = compute_modes,
                                                  .values = modes_values,
                                                  .csv = modes_csv,
                                                  .table = modes_table,
                                                  .warn = warn_of_modes,
                                                  .draw = draw_modes,
                                                  .release = free_modes};

/* ---- rigidity ---- */

static strut_status compute_rigidity(strut_analysis *a, strut_error *error) {
  const strut_named_shape *shape = &a->result.rigidity.shape;
  strut_status status = strut_named_shape_find(a->arguments, a->model, &a->setup->experiment,
                                               &a->arena, &a->result.rigidity.shape, error);
  if (status != STRUT_OK) return status;
  strut_status found = strut_rigidity_find(a->model, shape->q, &a->result.rigidity.found, error);
  a->result.rigidity.found.at = shape->name;
  return found;
}

static const strut_value_rows *rigidity_values(const strut_analysis *a, const void **result) {
  *result = &a->result.rigidity.found;
  return &strut_rigidity_values;
}

static char *rigidity_table(const strut_analysis *a) {
  return strut_rigidity_table(&a->result.rigidity.found, a->model, a->result.rigidity.shape.name);
}

static strut_status draw_rigidity(const strut_analysis *a, const strut_plot *plot,
                                  strut_error *error) {
  const strut_named_shape *shape = &a->result.rigidity.shape;
  return strut_rigidity_figure(plot, a->model, shape->q, shape->name, &a->result.rigidity.found,
                               error);
}

static void free_rigidity(strut_analysis *a) { strut_rigidity_free(&a->result.rigidity.found); }

const strut_option strut_rigidity_analysis_options[] = {STRUT_SHAPE_OPTIONS, END};

const strut_analysis_kind strut_rigidity_analysis = {.files = {"rigidity.json"},
                                                     .compute = compute_rigidity,
                                                     .values = rigidity_values,
                                                     .table = rigidity_table,
                                                     .draw = draw_rigidity,
                                                     .release = free_rigidity};

/* ---- form: the setup becomes that of the form ---- */

static strut_status compute_form(strut_analysis *a, strut_error *error) {
  const strut_scene *scene = &a->setup->scene;
  strut_form_options wanted = {0};
  strut_status status = read_form_options(a->command, a->arguments, &wanted);
  if (status != STRUT_OK) return status;
  double(*drawn)[2] = strut_arena_allocate(&a->arena, scene->node_count, sizeof *drawn);
  if (!drawn) return strut_no_memory(error, "");
  for (size_t i = 0; i < scene->node_count; i++)
    memcpy(drawn[i], scene->nodes[i].position, sizeof *drawn);
  a->result.form.drawn = drawn;
  return strut_form_find(a->setup, &wanted, &a->result.form.found, error);
}

static const strut_value_rows *form_values(const strut_analysis *a, const void **result) {
  *result = &a->result.form.found;
  return &strut_form_values;
}

static char *form_table(const strut_analysis *a) {
  return strut_form_table(&a->result.form.found, a->setup);
}

static strut_status draw_form(const strut_analysis *a, const strut_plot *plot, strut_error *error) {
  strut_model *model = NULL;
  strut_status status = strut_model_compile(&a->setup->scene, &model, error);
  if (status == STRUT_OK)
    status = strut_form_figure(plot, model, (const double(*)[2])a->result.form.drawn, error);
  strut_model_free(model);
  return status;
}

const strut_option strut_form_analysis_options[] = {STRUT_FORM_OPTIONS, END};

const strut_analysis_kind strut_form_analysis = {.uncompiled = true,
                                                 .compute = compute_form,
                                                 .values = form_values,
                                                 .table = form_table,
                                                 .draw = draw_form};

/* ---- path ---- */

/* The file's stages are followed unless the command says what to follow. */
static bool has_stages(const strut_analysis *a) {
  static const strut_option_id others[] = {STRUT_OPTION_LOAD, STRUT_OPTION_OVER, STRUT_OPTION_FROM,
                                           STRUT_OPTION_UNTIL, STRUT_OPTION_STOP};
  for (size_t i = 0; i < sizeof others / sizeof *others; i++)
    if (strut_option_text(a->arguments, others[i])) return false;
  return a->setup->experiment.stage_count > 0;
}

static strut_status compute_path(strut_analysis *a, strut_error *error) {
  strut_path_options wanted;
  strut_status status =
      read_path_options(a->command, a->arguments, a->setup->experiment.path_friction, &wanted);
  if (status == STRUT_OK && has_stages(a))
    return strut_path_follow_stages(a->model, &a->setup->experiment, &wanted, &a->result.path,
                                    error);
  if (status == STRUT_OK)
    status = read_followed(a->command, a->arguments, &a->setup->scene, &a->scenes, &wanted);
  if (status != STRUT_OK) return status;
  return strut_path_follow(a->model, &a->setup->experiment, &wanted, &a->result.path, error);
}

static const strut_value_rows *path_values(const strut_analysis *a, const void **result) {
  *result = &a->result.path;
  return &strut_path_values;
}

static char *path_csv(const strut_analysis *a) {
  return strut_path_csv(&a->result.path, &a->setup->scene);
}

static char *path_table(const strut_analysis *a) {
  return strut_path_table(&a->result.path, &a->setup->scene);
}

static void warn_of_path(const strut_analysis *a, const strut_listener *listener) {
  strut_warn_of_path(listener, &a->setup->scene, &a->result.path);
}

static strut_status draw_path(const strut_analysis *a, const strut_plot *plot, strut_error *error) {
  return strut_path_figure(plot, a->model, &a->result.path, error);
}

static void free_path(strut_analysis *a) { strut_path_free(&a->result.path); }

const strut_option strut_path_analysis_options[] = {STRUT_PATH_OPTIONS, END};

const strut_analysis_kind strut_path_analysis = {.files = {"path.json", "path.csv"},
                                                 .compute = compute_path,
                                                 .values = path_values,
                                                 .csv = path_csv,
                                                 .table = path_table,
                                                 .warn = warn_of_path,
                                                 .draw = draw_path,
                                                 .release = free_path};

char *strut_analysis_json(const strut_analysis *a) {
  const void *result;
  const strut_value_rows *rows = a->kind->values(a, &result);
  return strut_values_json(rows, result, &a->setup->scene);
}

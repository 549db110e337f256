/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/analysis.h"
#include "parser/cli/commands.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/number_text.h"
#include "engine/output/figures/statics_figures.h"
#include "engine/output/report/path_report.h"
#include "engine/statics/path/path.h"
#include "parser/cli/options.h"
#include "parser/cli/streams.h"

/* ---- what --over follows ---- */

/* The model's file, read once. Zero-initialise; free_over releases it. */
typedef struct over_source {
  const char *file;
  char *text;
  size_t length;
  strut_scene_source *source;
  strut_setting *settings; /* (setting_count) those of --set, and last the one that is followed */
  size_t setting_count;
} over_source;

/* Reports the first message about a scene with its place, without the "--set" of the varied value. */
static strut_status report_first(const over_source *source, const strut_diagnostics *diagnostics,
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
  over_source *source = context;
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

static void free_over(over_source *source) {
  strut_scene_source_free(source->source);
  strut_release(source->settings);
  strut_release(source->text);
  *source = (over_source){0};
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

static strut_status reject_name(const strut_scene *scene, const char *name) {
  strut_arena arena = {0};
  const candidates all = {.scene = scene, .arena = &arena};
  for (size_t i = 0; i < scene->load_count; i++)
    if (strcmp(scene->loads[i].name, name) == 0) {
      fprintf(stderr, "strut path: --over: '%s' is a load; use --load %s\n", name, name);
      return STRUT_USAGE;
    }
  const char *near = strut_did_you_mean(name, candidate_at, &all);
  fprintf(stderr,
          "strut path: --over: no parameter, actuator, or coordinate of a node (such as '%s.x') is "
          "called '%s'",
          scene->node_count ? scene->nodes[0].name : "node", name);
  if (near) fprintf(stderr, "; did you mean '%s'?", near);
  fputc('\n', stderr);
  strut_arena_free(&arena);
  return STRUT_USAGE;
}

static const strut_parameter *find_parameter(const strut_scene *scene, const char *name) {
  for (size_t i = 0; i < scene->parameter_count; i++)
    if (strcmp(scene->parameters[i].name, name) == 0) return &scene->parameters[i];
  return NULL;
}

/* "node.x" as 2 node, "node.y" as 2 node + 1; -1: no such node. */
static int32_t find_coordinate(const strut_scene *scene, const char *name) {
  const char *dot = strrchr(name, '.');
  if (!dot || (strcmp(dot, ".x") != 0 && strcmp(dot, ".y") != 0)) return -1;
  size_t length = (size_t)(dot - name);
  for (size_t i = 0; i < scene->node_count; i++)
    if (strlen(scene->nodes[i].name) == length && strncmp(scene->nodes[i].name, name, length) == 0)
      return (int32_t)(2 * i) + (dot[1] == 'y');
  return -1;
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
                                over_source *source, strut_dimension *dimension) {
  strut_diagnostics unused = {0};
  source->file = strcmp(arguments->model, "-") == 0 ? "<stdin>" : arguments->model;
  strut_status status =
      strut_scene_source_open(source->file, source->text, source->length, &unused, &source->source);
  strut_diagnostics_free(&unused);
  source->settings = strut_allocate(arguments->override_count + 1, sizeof *source->settings);
  const strut_declared *declared = status ? NULL : find_declared(source->source, name);
  if (!declared || !source->settings) return strut_print_out_of_memory();
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

static strut_status choose_followed(const strut_arguments *arguments, const strut_scene *scene,
                                    const char *name, over_source *source,
                                    strut_path_options *wanted, strut_dimension *dimension) {
  const strut_parameter *parameter = find_parameter(scene, name);
  *dimension = STRUT_DIM_LENGTH;
  if (parameter && !isfinite(parameter->value)) {
    fprintf(stderr, "strut path: --over: parameter '%s' is a text, expected a number\n", name);
    return STRUT_USAGE;
  }
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
    if (scene->actuators[wanted->index].member < 0) *dimension = STRUT_DIM_ANGLE;
    return STRUT_OK;
  }
  wanted->over = STRUT_PATH_OVER_COORDINATE;
  wanted->index = find_coordinate(scene, name);
  return wanted->index >= 0 ? STRUT_OK : reject_name(scene, name);
}

static strut_status read_over(const strut_command *command, const strut_arguments *arguments,
                              const strut_scene *scene, over_source *source,
                              strut_path_options *wanted) {
  const char *name = strut_option_text(arguments, STRUT_OPTION_OVER);
  strut_dimension dimension = STRUT_DIM_NONE;
  strut_status status = STRUT_OK;
  wanted->load = strut_option_text(arguments, STRUT_OPTION_LOAD);
  wanted->until = 1.0;
  if (name && wanted->load) {
    fprintf(stderr, "strut path: give either --load or --over, not both\n");
    return STRUT_USAGE;
  }
  if (name) status = choose_followed(arguments, scene, name, source, wanted, &dimension);
  if (status == STRUT_OK && name && !strut_option_text(arguments, STRUT_OPTION_UNTIL)) {
    const char *example = strut_dimension_example(dimension);
    fprintf(stderr, "strut path: missing --until VALUE, the end value of %s%s%s%s\n", name,
            example ? ": such as --until \"" : "", example ? example : "", example ? "\"" : "");
    return STRUT_USAGE;
  }
  if (status == STRUT_OK)
    status = strut_option_number(command, arguments, STRUT_OPTION_FROM, dimension, &wanted->from);
  if (status == STRUT_OK)
    status = strut_option_number(command, arguments, STRUT_OPTION_UNTIL, dimension, &wanted->until);
  if (status == STRUT_OK &&
      !(isfinite(wanted->from) && isfinite(wanted->until) && wanted->from != wanted->until)) {
    fprintf(stderr, "strut path: --from and --until are equal\n");
    return STRUT_USAGE;
  }
  return status;
}

enum { MOST_STEPS = 1000000 };

static const char *const file_names[] = {"path.json", "path.csv", NULL};

static const strut_option options[] = {
    {STRUT_OPTION_LOAD, "load", "NAME", "load to scale (default: all loads without a signal)"},
    {STRUT_OPTION_OVER, "over", "WHAT",
     "vary a parameter, an actuator, or a displacement NODE.x or NODE.y"},
    {STRUT_OPTION_FROM, "from", "VALUE", "start value: a load factor, or in the unit of WHAT"},
    {STRUT_OPTION_UNTIL, "until", "VALUE", "end value, likewise (default: load factor 1)"},
    {STRUT_OPTION_AT, "at", "NAME", "equilibrium to start from (default: that of the start)"},
    {STRUT_OPTION_STEPS, "steps", "N", "maximum number of steps (default 400)"},
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    {STRUT_OPTION_OUTPUT, "output", "DIR", "write path.json and path.csv into DIR"},
    {STRUT_OPTION_JSON, "json", NULL, "print everything as one JSON object"},
    STRUT_PLOT_OPTIONS,
    STRUT_AXIS_OPTIONS,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

/* Does something carry more than it can? What that is. */
static const char *overloaded_at(const strut_scene *scene, const strut_path_point *at) {
  for (size_t j = 0; j < scene->member_count; j++) {
    const strut_member *m = &scene->members[j];
    bool yields = m->law.kind == STRUT_LAW_ELASTIC_PLASTIC && fabs(at->force[j]) > m->law.yield;
    if (yields || (m->breaks_at > 0.0 && at->force[j] > m->breaks_at)) return m->name;
  }
  for (size_t i = 0; i < scene->hinge_count; i++) {
    const strut_hinge *h = &scene->hinges[i];
    double moment = fabs(at->moment[i]);
    bool yields = h->law.kind == STRUT_LAW_ELASTIC_PLASTIC && moment > h->law.yield;
    if (yields || (h->breaks_at > 0.0 && moment > h->breaks_at)) return h->name;
  }
  return NULL;
}

static void warn_of_overload(const strut_scene *scene, const strut_path *path) {
  for (size_t i = 0; i < path->point_count; i++) {
    const char *name = overloaded_at(scene, &path->points[i]);
    if (!name) continue;
    fprintf(
        stderr,
        "strut: warning: from the factor %.4g on '%s' carries more than it can; paths take what "
        "breaks as whole and what yields as elastic\n",
        path->points[i].factor, name);
    return;
  }
}

/* Writes, prints and draws the path; reports what fails on stderr. */
static strut_status report_path(const strut_arguments *arguments, const strut_plot *plot,
                                const strut_model *model, const strut_path *path) {
  strut_error error = {0};
  strut_status status = strut_report(arguments, file_names, strut_path_json(path, model->scene),
                                     strut_path_csv(path, model->scene),
                                     strut_path_table(path, model->scene), &error);
  if (status == STRUT_OK) warn_of_overload(model->scene, path);
  if (status == STRUT_OK && plot->path) status = strut_path_figure(plot, model, path, &error);
  if (status != STRUT_OK && error.message[0]) strut_print_error(&error);
  return status;
}

static strut_status follow_path(const strut_arguments *arguments, const strut_plot *plot,
                                const strut_path_options *wanted, const strut_setup *setup) {
  strut_path path = {0};
  strut_model *model = NULL;
  strut_error error = {0};
  strut_status status = strut_model_compile(&setup->scene, &model, &error);
  if (status == STRUT_OK)
    status = strut_path_follow(model, &setup->experiment, wanted, &path, &error);
  if (status == STRUT_OK)
    status = report_path(arguments, plot, model, &path);
  else
    strut_print_error(&error);
  strut_path_free(&path);
  strut_model_free(model);
  return status;
}

static strut_status run_path(const strut_arguments *arguments) {
  strut_setup setup;
  strut_path_options wanted = {.at = strut_option_text(arguments, STRUT_OPTION_AT)};
  over_source source = {0};
  strut_plot plot;
  int64_t steps = 0;
  strut_status status = strut_option_integer(&strut_command_path, arguments, STRUT_OPTION_STEPS, 1,
                                             MOST_STEPS, &steps);
  wanted.steps = (int32_t)steps;
  if (status == STRUT_OK) status = strut_plot_read(&strut_command_path, arguments, 0, &plot);
  if (status != STRUT_OK) return status;
  status = strut_check_output_writable(arguments, file_names);
  if (status != STRUT_OK) return status;
  status = strut_open_model_text(arguments, &source.text, &source.length, &setup);
  if (status != STRUT_OK) return status;
  status = read_over(&strut_command_path, arguments, &setup.scene, &source, &wanted);
  if (status == STRUT_OK) status = follow_path(arguments, &plot, &wanted, &setup);
  free_over(&source);
  strut_setup_free(&setup);
  return status;
}

const strut_command strut_command_path = {
    .name = "path",
    .model = "MODEL",
    .summary = "follows an equilibrium as a load, an actuator or a parameter changes",
    .details =
        "\nStarts without the load at the equilibrium in which the start comes to rest, and "
        "follows\n"
        "the equilibria as the load factor grows, past limit points, to the factor VALUE. Detects\n"
        "limit points, bifurcations, cables that become slack or taut, and nodes that touch or\n"
        "leave the ground, each with its effect on stability. Friction and drives are ignored.\n"
        "--over varies something else at constant loads: a number under 'parameters' (from its\n"
        "value in the file), an actuator (the change of its member's rest length or its hinge's\n"
        "rest angle), or the prescribed displacement of a node along x or y.\n",
    .options = options,
    .run = run_path,
    .timed = true,
};

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/command/analyses.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/forces/history.h"
#include "engine/output/figures/statics_figures.h"
#include "engine/output/record_files.h"
#include "engine/output/result_values.h"
#include "engine/scene/things.h"
#include "parser/language/yaml/document.h"

strut_status strut_analysis_compute(strut_analysis *analysis, strut_error *error) {
  strut_experiment *experiment = analysis->setup ? &analysis->setup->experiment : NULL;
  analysis->found = &analysis->result;
  if (experiment) {
    analysis->scene = &analysis->setup->scene;
    experiment->interrupt = analysis->interrupt;
    experiment->progress = analysis->progress;
    experiment->progress_context = analysis->progress_context;
  }
  strut_status status = analysis->kind->compute(analysis, error);
  if (experiment) experiment->progress = NULL;
  analysis->arguments = NULL;
  return status;
}

void strut_analysis_free(strut_analysis *analysis) {
  if (analysis->kind && analysis->kind->release) analysis->kind->release(analysis);
  strut_varied_scenes_free(&analysis->scenes);
  strut_arena_free(&analysis->arena);
}

/* The files of a kind. */
#define FILES(...) ((const strut_output_file[]){__VA_ARGS__, {.name = NULL}})

/* ---- options ---- */

/* "n1,n4" as nodes, in the scene's arena; *set stays NULL without --supports. */
static strut_status read_supports(const strut_arguments *arguments, strut_scene *scene,
                                  strut_node_set **set) {
  const char *text = arguments->supports;
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
    size_t length = strcspn(at, ",");
    memcpy(word, at, length);
    word[length] = '\0';
    const strut_named_rows *nodes = STRUT_NAMED(scene->nodes, scene->node_count);
    size_t found = strut_row_find(nodes, word);
    if (found == scene->node_count)
      return strut_usage_error(arguments, "--supports: there is no node '%s'%s", word,
                               strut_near_to(word, strut_row_name, nodes).text);
    for (size_t i = 0; i < to->count; i++)
      if (to->node[i] == (int32_t)found)
        return strut_usage_error(arguments, "--supports: named twice: '%s'", word);
    to->node[to->count++] = (int32_t)found;
    at += length;
    if (!*at) break;
  }
  *set = to;
  return STRUT_OK;
}

/* Everything that --over may name: candidates for suggestions. */
typedef struct candidates {
  const strut_scene *scene;
  strut_arena *arena; /* for "node.x" */
} candidates;

static const char *candidate_at(const void *context, size_t i) {
  const candidates *self = context;
  const strut_scene *scene = self->scene;
  if (i < scene->parameter_count) return scene->parameters[i].name;
  i -= scene->parameter_count;
  if (i < scene->actuator_count) return scene->actuators[i].name;
  i -= scene->actuator_count;
  if (i >= 2 * scene->node_count) return NULL;
  return strut_arena_format(self->arena, "%s.%c", scene->nodes[i / 2].name, i % 2 ? 'y' : 'x');
}

static strut_status reject_name(const strut_arguments *arguments, const strut_scene *scene,
                                const char *name) {
  strut_arena arena = {0};
  const candidates all = {.scene = scene, .arena = &arena};
  if (strut_thing_find(scene, STRUT_THING_LOAD, name) >= 0)
    return strut_usage_error(arguments, "--over: '%s' is a load; use --load %s", name, name);
  strut_usage_error(arguments,
                    "--over: no parameter, actuator, or coordinate of a node (such as '%s.x') is "
                    "called '%s'%s",
                    scene->node_count ? scene->nodes[0].name : "node", name,
                    strut_near_to(name, candidate_at, &all).text);
  strut_arena_free(&arena);
  return STRUT_USAGE;
}

static strut_status choose_followed(const strut_arguments *arguments, const strut_scene *scene,
                                    const char *name, strut_varied_scenes *scenes,
                                    strut_path_options *wanted, strut_dimension *dimension) {
  const strut_parameter *parameter = strut_parameter_named(scene, name);
  *dimension = STRUT_DIM_LENGTH;
  if (parameter && !isfinite(parameter->value))
    return strut_usage_error(arguments, "--over: parameter '%s' is a text, expected a number",
                             name);
  if (parameter) {
    wanted->over = STRUT_PATH_OVER_SCENE;
    wanted->name = parameter->name;
    wanted->from = parameter->value;
    wanted->scene_at = strut_varied_scenes_at;
    wanted->context = scenes;
    scenes->purpose = STRUT_FOR_STATICS;
    strut_status status = strut_varied_scenes_open(arguments, &wanted->name, 1, scenes, dimension);
    wanted->unit = strut_unit_of(*dimension);
    return status;
  }
  wanted->over = STRUT_PATH_OVER_ACTUATOR;
  wanted->index = strut_thing_find(scene, STRUT_THING_ACTUATOR, name);
  if (wanted->index >= 0) {
    const strut_actuator *actuator = &scene->actuators[wanted->index];
    if (actuator->member < 0)
      *dimension = actuator->hinge >= 0 ? STRUT_DIM_ANGLE : STRUT_DIM_STIFFNESS;
    return STRUT_OK;
  }
  wanted->over = STRUT_PATH_OVER_COORDINATE;
  wanted->index = strut_coordinate_find(scene, name);
  return wanted->index >= 0 ? STRUT_OK : reject_name(arguments, scene, name);
}

/* NODE.x=VALUE */
static strut_status read_stop(const strut_arguments *arguments, const strut_scene *scene,
                              strut_path_stop *stop) {
  const char *text = arguments->stop;
  strut_arena arena = {0};
  if (!text) return STRUT_OK;
  const char *equal = strrchr(text, '=');
  const char *name = equal ? strut_arena_text(&arena, text, (size_t)(equal - text)) : NULL;
  stop->coordinate = name ? strut_coordinate_find(scene, name) : -1;
  stop->given = true;
  bool number = equal &&
                strut_quantities_read(equal + 1, STRUT_DIM_LENGTH, &stop->displacement, 1) == 1 &&
                isfinite(stop->displacement) && stop->displacement != 0.0;
  strut_arena_free(&arena);
  if (stop->coordinate >= 0 && number) return STRUT_OK;
  return strut_usage_error(arguments,
                           "--stop expects a node's displacement, not 0, such as %s.x=10mm, not "
                           "'%s'",
                           scene->node_count ? scene->nodes[0].name : "node", text);
}

static strut_status read_followed(const strut_arguments *arguments, const strut_scene *scene,
                                  strut_varied_scenes *scenes, strut_path_options *wanted) {
  const strut_given_range *over = &arguments->over;
  const char *name = over->text ? over->name : NULL;
  const char *from = over->high ? over->low : arguments->from;
  const char *until = over->high ? over->high : arguments->until;
  strut_dimension dimension = STRUT_DIM_NONE;
  strut_status status = STRUT_OK;
  wanted->load = arguments->load;
  wanted->until = 1.0;
  if (over->high && (arguments->from || arguments->until))
    return strut_usage_error(arguments,
                             "give either --over WHAT=FROM..UNTIL, or --from and --until");
  if (name && wanted->load)
    return strut_usage_error(arguments, "give either --load or --over, not both");
  if (name) status = choose_followed(arguments, scene, name, scenes, wanted, &dimension);
  if (!status && name && !until) {
    const char *example = strut_dimension_example(dimension);
    return strut_usage_error(arguments, "missing --until VALUE, the end value of %s%s%s%s", name,
                             example ? ": such as --until \"" : "", example ? example : "",
                             example ? "\"" : "");
  }
  if (!status)
    status = strut_quantity_read(arguments, over->high ? "over" : "from", from, dimension,
                                 &wanted->from);
  if (!status)
    status = strut_quantity_read(arguments, over->high ? "over" : "until", until, dimension,
                                 &wanted->until);
  if (!status &&
      !(isfinite(wanted->from) && isfinite(wanted->until) && wanted->from != wanted->until))
    return strut_usage_error(arguments, "--from and --until are equal");
  return status ? status : read_stop(arguments, scene, &wanted->stop);
}

/* ---- warnings of structures at rest in which something carries more than it can (forces/history.h) ---- */

/* Of the shape, at `where`. */
static void warn_of_overload(const strut_listener *listener, const strut_model *model,
                             const double *positions, const char *where) {
  strut_overload worst;
  if (!strut_history_overload(model, positions, &worst)) return;
  const char *unit = worst.hinge ? "N m" : "N";
  strut_tell(listener, STRUT_MESSAGE_WARNING, NULL,
             "%s %s '%s' carries %.4g %s, above the %.4g %s at which it %s; statics take it as %s",
             where, worst.kind, worst.name, worst.force, unit, worst.limit, unit,
             worst.breaks ? "breaks" : "yields", worst.breaks ? "whole" : "elastic");
}

/* Says what a search has left out: on a curve that folds one branch is taken at each elongation. */
static void warn_of_folds(const strut_listener *listener, const strut_model *model) {
  for (int32_t i = 0; i < model->elements.count; i++) {
    const strut_element *element = &model->elements.element[i];
    if (element->law != STRUT_LAW_FOLDING) continue;
    strut_tell(
        listener, STRUT_MESSAGE_WARNING, NULL,
        "the law of '%s' may fold back: a search takes it as it is when it comes from the rest "
        "length, and finds no state on another branch; strut path follows them",
        strut_element_name(model->scene, element));
    return;
  }
}

/* Does something carry more than it can? What that is. */
static const char *overloaded_at(const strut_scene *scene, const strut_path_point *at) {
  for (size_t j = 0; j < scene->member_count; j++) {
    const strut_member *member = &scene->members[j];
    bool yields =
        member->law.kind == STRUT_LAW_ELASTIC_PLASTIC && fabs(at->at.force[j]) > member->law.yield;
    if (yields || (member->breaks_at > 0.0 && at->at.force[j] > member->breaks_at))
      return member->name;
  }
  for (size_t i = 0; i < scene->hinge_count; i++) {
    const strut_hinge *hinge = &scene->hinges[i];
    double moment = fabs(at->at.moment[i]);
    bool yields = hinge->law.kind == STRUT_LAW_ELASTIC_PLASTIC && moment > hinge->law.yield;
    if (yields || (hinge->breaks_at > 0.0 && moment > hinge->breaks_at)) return hinge->name;
  }
  return NULL;
}

/* Warns of the first point where something carries more than it can; false: there is none. */
static bool warn_of_points(const strut_listener *listener, const strut_scene *scene,
                           const strut_path *path) {
  for (size_t i = 0; i < path->point_count; i++) {
    const char *name = overloaded_at(scene, &path->points[i]);
    if (!name) continue;
    strut_tell(listener, STRUT_MESSAGE_WARNING, NULL,
               "from the factor %.4g on '%s' carries more than it can; paths take what "
               "breaks as whole and what yields as elastic",
               path->points[i].at.factor, name);
    return true;
  }
  return false;
}

/* ---- equilibria ---- */

static strut_status compute_equilibria(strut_analysis *analysis, strut_error *error) {
  const strut_arguments *arguments = analysis->arguments;
  const uint64_t seed = arguments->seed.text ? (uint64_t)arguments->seed.value
                                             : analysis->setup->experiment.search.seed;
  strut_node_set *set = NULL;
  strut_status status = read_supports(arguments, &analysis->setup->scene, &set);
  if (status != STRUT_OK) return status;
  const strut_equilibria_options wanted = {.starts = arguments->starts.value,
                                           .seed = &seed,
                                           .supports = set,
                                           .interrupt = analysis->setup->experiment.interrupt};
  status = strut_equilibria_find(analysis->model, &analysis->setup->experiment, &wanted,
                                 &analysis->result.equilibria, error);
  analysis->result.equilibria.shows_all = arguments->all;
  return status;
}

static strut_status judge_equilibria(const strut_analysis *analysis, strut_error *error) {
  const strut_equilibria *all = &analysis->result.equilibria;
  return all->count > 0 ? STRUT_OK : strut_fail(error, STRUT_NOT_SETTLED, "%s", all->remark);
}

static void warn_of_equilibria(const strut_analysis *analysis, const strut_listener *listener) {
  const strut_equilibria *all = &analysis->result.equilibria;
  warn_of_folds(listener, analysis->model);
  for (size_t i = 0; i < all->count; i++) {
    const strut_equilibrium *equilibrium = &all->list[i];
    char where[200];
    if (equilibrium->point.label != STRUT_STABLE) continue;
    snprintf(where, sizeof where, "in %.180s", equilibrium->name);
    warn_of_overload(listener, analysis->model, equilibrium->point.q, where);
  }
}

static strut_status draw_equilibria(const strut_analysis *analysis, const strut_plot *plot,
                                    strut_error *error) {
  if (analysis->result.equilibria.count == 0) return STRUT_OK;
  return strut_equilibria_figure(plot, analysis->model, &analysis->result.equilibria, error);
}

static void free_equilibria(strut_analysis *analysis) {
  strut_equilibria_free(&analysis->result.equilibria);
}

/* JSON readers represent integers exactly up to here. */
#define MOST_SEED INT64_C(9007199254740992)

const strut_option strut_equilibria_analysis_options[] = {
    {STRUT_FILLS(supports), "supports", "NODES", "hold only these contact nodes, such as n1,n4"},
    {STRUT_FILLS(starts), "starts", "N", "number of random starts per search (default automatic)",
     .most = 1000000000},
    {STRUT_FILLS(seed), "seed", "S", "seed of the random starts (default as the scene says)",
     .most = MOST_SEED},
    {STRUT_FILLS(all), "all", NULL,
     "list every equilibrium, and the positions of those that stand"},
    {.name = NULL}};

const strut_analysis_kind strut_equilibria_analysis = {.files = FILES({.name = "equilibria.json"}),
                                                       .rows = &strut_equilibria_values,
                                                       .asks = true,
                                                       .compute = compute_equilibria,
                                                       .verdict = judge_equilibria,
                                                       .warn = warn_of_equilibria,
                                                       .draw = draw_equilibria,
                                                       .release = free_equilibria};

/* ---- modes ---- */

static void warn_of_modes(const strut_analysis *analysis, const strut_listener *listener) {
  warn_of_overload(listener, analysis->model, analysis->result.modes.q, "in this shape");
}

static strut_status draw_modes(const strut_analysis *analysis, const strut_plot *plot,
                               strut_error *error) {
  return strut_modes_figure(plot, analysis->model, &analysis->result.modes, analysis->count, error);
}

static void free_modes(strut_analysis *analysis) { strut_modes_free(&analysis->result.modes); }

static void warn_of_waves(const strut_analysis *analysis, const strut_listener *listener) {
  warn_of_overload(listener, analysis->model, analysis->result.waves.q, "in this shape");
}

static strut_status draw_waves(const strut_analysis *analysis, const strut_plot *plot,
                               strut_error *error) {
  return strut_waves_figure(plot, analysis->model, &analysis->result.waves, error);
}

static void free_waves(strut_analysis *analysis) { strut_waves_free(&analysis->result.waves); }

/* What modes are with --wave. */
static const strut_analysis_kind waves_analysis = {
    .files = FILES({.name = "modes.json"}, {.name = "modes.csv", .list = "waves"}),
    .rows = &strut_waves_values,
    .warn = warn_of_waves,
    .draw = draw_waves,
    .release = free_waves};

static strut_status compute_modes(strut_analysis *analysis, strut_error *error) {
  const strut_arguments *arguments = analysis->arguments;
  const strut_experiment *experiment = &analysis->setup->experiment;
  const int32_t count = (int32_t)arguments->count.value;
  const strut_waves_options waves = {.at = arguments->at, .count = count};
  const strut_modes_options modes = {
      .at = arguments->at, .count = count, .stuck = arguments->stuck};
  analysis->count = (size_t)count;
  if (!arguments->wave)
    return strut_modes_find(analysis->model, experiment, &modes, &analysis->result.modes, error);
  if (arguments->stuck)
    return strut_usage_error(arguments,
                             "--stuck holds contacts with the ground; --wave knows no ground");
  analysis->kind = &waves_analysis;
  return strut_waves_find(analysis->model, experiment, &waves, &analysis->result.waves, error);
}

const strut_option strut_modes_analysis_options[] = {
    {STRUT_FILLS(at), "at", "NAME",
     "equilibrium to linearise about (default: that of the start), or drawn"},
    {STRUT_FILLS(count), "count", "N", "number of modes or bands, lowest first", .least = 1,
     .most = 1000},
    {STRUT_FILLS(wave), "wave", NULL,
     "instead: waves of the structure repeated by its lattice, bands and gaps"},
    {STRUT_FILLS(stuck), "stuck", NULL, "treat closed contacts as stuck instead of frictionless"},
    {.name = NULL}};

const strut_analysis_kind strut_modes_analysis = {
    .files = FILES({.name = "modes.json"}, {.name = "modes.csv", .list = "modes"}),
    .rows = &strut_modes_values,
    .compute = compute_modes,
    .warn = warn_of_modes,
    .draw = draw_modes,
    .release = free_modes};

/* ---- rigidity ---- */

static strut_status compute_rigidity(strut_analysis *analysis, strut_error *error) {
  const char *at = analysis->arguments->at;
  strut_rest_state *shape = &analysis->result.rigidity.shape;
  strut_rigidity *found = &analysis->result.rigidity.found;
  strut_status status = strut_rest_state_find(analysis->model, &analysis->setup->experiment,
                                              at ? at : "drawn", &analysis->arena, shape, error);
  if (!status) status = strut_rigidity_find(analysis->model, shape->q, found, error);
  found->at = shape->name;
  return status;
}

static strut_status draw_rigidity(const strut_analysis *analysis, const strut_plot *plot,
                                  strut_error *error) {
  const strut_rest_state *shape = &analysis->result.rigidity.shape;
  return strut_rigidity_figure(plot, analysis->model, shape->q, shape->name,
                               &analysis->result.rigidity.found, error);
}

static void free_rigidity(strut_analysis *analysis) {
  strut_rigidity_free(&analysis->result.rigidity.found);
}

const strut_option strut_rigidity_analysis_options[] = {
    {STRUT_FILLS(at), "at", "NAME", "the shape: drawn (default), start, or an equilibrium"},
    {.name = NULL}};

const strut_analysis_kind strut_rigidity_analysis = {.files = FILES({.name = "rigidity.json"}),
                                                     .rows = &strut_rigidity_values,
                                                     .compute = compute_rigidity,
                                                     .draw = draw_rigidity,
                                                     .release = free_rigidity};

/* ---- form: the setup becomes that of the form ---- */

static strut_status compute_form(strut_analysis *analysis, strut_error *error) {
  const strut_scene *scene = &analysis->setup->scene;
  const strut_arguments *arguments = analysis->arguments;
  const double least = arguments->least_tension.value;
  /* 0 asks for none, while without the option a part of the forces is taken */
  const strut_form_options wanted = {
      .least_tension = arguments->least_tension.text && least == 0.0 ? DBL_MIN : least,
      .least_density = arguments->least_density.value,
      .from = (strut_form_source)(arguments->given.text ? arguments->given.index + 1 : 0),
      .objective = (strut_form_objective)arguments->objective.index};
  if (wanted.least_tension < 0 || wanted.least_density < 0)
    return strut_usage_error(
        arguments, "--least-tension and --least-density must not be negative: cables only pull");
  double(*drawn)[2] = strut_arena_allocate(&analysis->arena, scene->node_count, sizeof *drawn);
  if (!drawn) return strut_no_memory(error, "");
  for (size_t i = 0; i < scene->node_count; i++)
    memcpy(drawn[i], scene->nodes[i].position, sizeof *drawn);
  analysis->result.form.drawn = drawn;
  return strut_form_find(analysis->setup, &wanted, &analysis->result.form.found, error);
}

static strut_status draw_form(const strut_analysis *analysis, const strut_plot *plot,
                              strut_error *error) {
  strut_model *model = NULL;
  strut_status status = strut_model_compile(&analysis->setup->scene, &model, error);
  if (status == STRUT_OK)
    status = strut_form_figure(plot, model, (const double(*)[2])analysis->result.form.drawn, error);
  strut_model_free(model);
  return status;
}

static void free_form(strut_analysis *analysis) { strut_release(analysis->result.form.before); }

const strut_option strut_form_analysis_options[] = {
    {STRUT_FILLS(given), "given", "WHAT",
     "densities, lengths or prestress (default: by what the model gives)",
     .words = "densities|lengths|prestress"},
    {STRUT_FILLS(least_tension), "least-tension", "FORCE",
     "lower bound on the tension of every cable", .measure = STRUT_MEASURE_FORCE},
    {STRUT_FILLS(least_density), "least-density", "DENSITY",
     "lower bound on the force density of every cable", .measure = STRUT_MEASURE_STIFFNESS},
    {STRUT_FILLS(objective), "objective", "WHAT",
     "which prestress: minimal largest (default), sum or squares", .words = "largest|sum|squares"},
    {.name = NULL}};

const strut_analysis_kind strut_form_analysis = {.rows = &strut_form_values,
                                                 .uncompiled = true,
                                                 .compute = compute_form,
                                                 .draw = draw_form,
                                                 .release = free_form};

/* ---- path ---- */

static strut_status compute_path(strut_analysis *analysis, strut_error *error) {
  const strut_arguments *arguments = analysis->arguments;
  strut_path_options wanted = {.at = arguments->at,
                               .steps = (int32_t)arguments->steps.value,
                               .branches = (int32_t)arguments->branches.value,
                               .friction = arguments->friction.text
                                               ? arguments->friction.index == 1
                                               : analysis->setup->experiment.path_friction};
  /* The file's stages are followed unless the command says what to follow. */
  const bool given = arguments->load || arguments->over.text || arguments->from ||
                     arguments->until || arguments->stop;
  if (analysis->setup->experiment.stage_count > 0 && !given)
    return strut_path_follow_stages(analysis->model, &analysis->setup->experiment, &wanted,
                                    &analysis->result.path, error);
  strut_status status =
      read_followed(arguments, &analysis->setup->scene, &analysis->scenes, &wanted);
  if (status != STRUT_OK) return status;
  return strut_path_follow(analysis->model, &analysis->setup->experiment, &wanted,
                           &analysis->result.path, error);
}

static char *path_csv(const strut_analysis *analysis) {
  return strut_path_csv(&analysis->result.path, &analysis->setup->scene);
}

static void warn_of_path(const strut_analysis *analysis, const strut_listener *listener) {
  const strut_scene *scene = &analysis->setup->scene;
  const strut_path *path = &analysis->result.path;
  bool warned = false;
  if (path->friction && !path->grips)
    strut_tell(listener, STRUT_MESSAGE_WARNING, NULL,
               "friction is kept, but no contact has a static coefficient, and no cable rubs: "
               "the laws 'smooth' and 'stribeck' vanish at rest");
  for (size_t i = 0; i < path->stage_count && !warned; i++)
    warned = warn_of_points(listener, scene, &path->stages[i]);
  warned = warned || warn_of_points(listener, scene, path);
  for (size_t i = 0; i < path->branch_count && !warned; i++)
    warned = warn_of_points(listener, scene, &path->branches[i]);
}

static strut_status draw_path(const strut_analysis *analysis, const strut_plot *plot,
                              strut_error *error) {
  return strut_path_figure(plot, analysis->model, &analysis->result.path, error);
}

static void free_path(strut_analysis *analysis) { strut_path_free(&analysis->result.path); }

const strut_option strut_path_analysis_options[] = {
    {STRUT_FILLS(load), "load", "NAME",
     "load to scale, or several: P,Q (default: all without a signal)"},
    {STRUT_FILLS(over), "over", "WHAT",
     "vary a parameter, an actuator, or a displacement NODE.x or NODE.y; also WHAT=FROM..UNTIL",
     .expected = "WHAT or WHAT=FROM..UNTIL"},
    {STRUT_FILLS(from), "from", "VALUE", "start value: a load factor, or in the unit of WHAT"},
    {STRUT_FILLS(until), "until", "VALUE", "end value, likewise (default: load factor 1)"},
    {STRUT_FILLS(stop), "stop", "NODE.x=VALUE",
     "or end earlier, where a node has moved so far along x or y"},
    {STRUT_FILLS(at), "at", "NAME", "equilibrium to start from (default: that of the start)"},
    {STRUT_FILLS(friction), "friction", "none|kept",
     "kept: contacts stick and slide along the path (default: as the file says)",
     .words = "none|kept"},
    {STRUT_FILLS(branches), "branches", "DEPTH",
     "follow paths that leave at bifurcations: 1 of this path, 2 of its branches too, ...",
     .least = 1, .most = 10},
    {STRUT_FILLS(steps), "steps", "N",
     "maximum number of steps (default " STRUT_TEXT_OF(STRUT_PATH_USUAL_STEPS) ")", .least = 1,
     .most = 1000000},
    {.name = NULL}};

const strut_analysis_kind strut_path_analysis = {
    .files = FILES({.name = "path.json"}, {.name = "path.csv", .csv = path_csv}),
    .rows = &strut_path_values,
    .compute = compute_path,
    .warn = warn_of_path,
    .draw = draw_path,
    .release = free_path};

char *strut_analysis_json(const strut_analysis *analysis) {
  return strut_values_json(analysis->kind->rows, analysis->found, analysis->scene);
}

char *strut_analysis_text(const strut_analysis *analysis, int width) {
  bool all = analysis->kind == &strut_equilibria_analysis && analysis->result.equilibria.shows_all;
  return strut_values_text(analysis->kind->rows, analysis->found, analysis->scene, width,
                           all ? SIZE_MAX : STRUT_REPORT_ROWS);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The columns of what a point computes; points of a study that computes what is at rest, by the functions of the
 * commands. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/forces/history.h"
#include "engine/scene/things.h"
#include "engine/statics/form/form.h"
#include "engine/statics/rigidity/rigidity.h"
#include "engine/study/sweep/sweep_parts.h"

/* Results of one point; those of the study's computation are filled. */
typedef struct rest_result {
  const strut_model *model;
  const strut_setup *setup;     /* of a run, */
  const strut_summary *summary; /* and what it gave; NULL: nothing */
  strut_equilibria equilibria;
  size_t stable_count;
  int32_t *stable; /* (stable_count) equilibria that stand, by energy; in the arena */
  strut_modes modes;
  strut_rigidity rigidity;
  strut_path path;
  strut_form form;
  strut_arena arena;
  const strut_study *study;
  double stiffness; /* of the study's node [N/m] */
} rest_result;

/* ---- single numbers ---- */

static double state_energy(const rest_result *result, size_t i) {
  return i < result->stable_count ? result->equilibria.list[result->stable[i]].energy : (double)NAN;
}

/* The lowest barrier out of a stable state. */
static double state_barrier(const rest_result *result, size_t i) {
  double lowest = (double)NAN;
  for (size_t k = 0; k < result->equilibria.barrier_count && i < result->stable_count; k++) {
    const strut_barrier *barrier = &result->equilibria.barriers[k];
    if (barrier->from == result->stable[i]) lowest = fmin(lowest, barrier->height);
  }
  return lowest;
}

/* The lowest barrier out of any stable state. */
static double lowest_barrier(const rest_result *result) {
  double lowest = (double)NAN;
  for (size_t i = 0; i < result->stable_count; i++) lowest = fmin(lowest, state_barrier(result, i));
  return lowest;
}

/* Distance of positions from the shape that the study wants. */
static double shape_distance(const rest_result *result, const double *positions) {
  return positions ? strut_goals_shape_distance(result->study, result->model->scene, positions)
                   : (double)NAN;
}

/* That of the stable state nearest to it. */
static double nearest_shape(const rest_result *result) {
  double least = (double)NAN;
  for (size_t i = 0; i < result->stable_count; i++)
    least = fmin(least, shape_distance(result, result->equilibria.list[result->stable[i]].point.q));
  return least;
}

static double count_modes(const strut_modes *modes, strut_mode_kind kind) {
  double count = 0.0;
  for (size_t i = 0; i < modes->count; i++) count += modes->list[i].kind == kind;
  return count;
}

static double frequency_of(const strut_mode *mode) {
  return mode ? mode->angular_frequency / STRUT_TAU : (double)NAN;
}

static bool is_limit(const strut_path_event *event) {
  return event->kind == STRUT_PATH_LIMIT || event->kind == STRUT_PATH_KINK_LIMIT;
}

static bool is_bifurcation(const strut_path_event *event) {
  return event->kind == STRUT_PATH_BIFURCATION || event->kind == STRUT_PATH_KINK_BIFURCATION;
}

static bool loses_stability(const strut_path_event *event) {
  return event->before == 0 && event->after > 0;
}

/* The factor of the first event of a kind. */
static double first_factor(const strut_path *path, bool (*matches)(const strut_path_event *)) {
  for (size_t i = 0; i < path->event_count; i++)
    if (matches(&path->events[i])) return path->events[i].at.factor;
  return (double)NAN;
}

static double last_factor(const strut_path *path) {
  return path->point_count ? path->points[path->point_count - 1].at.factor : (double)NAN;
}

/* 0 or 1; missing where another combination of several states might be super stable. */
static double super_stability(const strut_rigidity *rigidity) {
  bool known =
      rigidity->states.count == 0 ||
      (rigidity->stress.tested && (rigidity->states.count == 1 || rigidity->stress.super_stable));
  return known ? (double)rigidity->stress.super_stable : (double)NAN;
}

/* The value of a run's summary at a path of keys. */
static strut_value value_at(const rest_result *result, const strut_value_rows *rows,
                            const char *path) {
  strut_value value = {0};
  if (result->summary)
    strut_value_at(rows, path,
                   &(strut_result_object){.at = result->summary, .scene = &result->setup->scene},
                   &value);
  return value;
}

/* NAN if the summary has none. */
static double number_at(const rest_result *result, const strut_value_rows *rows, const char *path) {
  strut_value value = value_at(result, rows, path);
  bool number = value.kind == STRUT_VALUE_NUMBER || value.kind == STRUT_VALUE_COUNT ||
                value.kind == STRUT_VALUE_FLAG;
  return number ? value.number : (double)NAN;
}

static double found(const rest_result *result, const char *path) {
  return number_at(result, &strut_summary_values, path);
}

static double run_cost(const rest_result *result, const char *path) {
  return number_at(result, &strut_summary_column_values, path);
}

/* Drive periods of a run, or the distance that it travels in one; NAN: it has none. */
static double over_periods(const rest_result *result, bool distance) {
  const strut_summary *summary = result->summary;
  if (!summary) return (double)NAN;
  double period = strut_experiment_span(&result->setup->experiment, &result->setup->scene).period;
  if (!distance && summary->steady.kind != STRUT_MOTION_NOT_WATCHED)
    return (double)summary->steady.periods;
  if (!(period > 0.0)) return (double)NAN;
  return distance ? summary->velocity * period : summary->duration / period;
}

static double count_freedoms(const strut_model *model) {
  double count = 0.0;
  for (int32_t i = 0; i < 2 * model->node_count; i++) count += !model->fixed[i];
  return count;
}

/* ---- the columns ---- */

typedef enum column_shape {
  NUMBER,
  WORD,
  NUMBERS, /* NAME_1, NAME_2, ...: the lowest */
  WORDS
} column_shape;

/*
 * The columns: computation (COUNT: any; then of the structure), word, name, unit (NULL: that of a path's parameter),
 * shape, value of a number (the i-th).
 */
#define COLUMN_TABLE(X)                                                                            \
  X(COUNT, NODES, "node_count", "1", NUMBER, (double)model->scene->node_count)                     \
  X(COUNT, MEMBERS, "member_count", "1", NUMBER, (double)model->scene->member_count)               \
  X(COUNT, FREEDOMS, "degrees_of_freedom", "1", NUMBER, count_freedoms(model))                     \
  X(COUNT, TOTAL_MASS, "total_mass", "kg", NUMBER, strut_scene_mass(model->scene))                 \
  X(RUN, VELOCITY, "velocity", "m/s", NUMBER, found(result, "velocity"))                           \
  X(RUN, SPREAD, "velocity_spread", "m/s", NUMBER, found(result, "velocity_spread"))               \
  X(RUN, INTERVAL, "velocity_interval", "m/s", NUMBER, found(result, "steady.velocity_interval"))  \
  X(RUN, MOTION, "motion", "1", WORD, (double)NAN)                                                 \
  X(RUN, REPEATS, "repeats", "1", NUMBER, found(result, "steady.repeats"))                         \
  X(RUN, PERIODS, "periods", "1", NUMBER, over_periods(result, false))                             \
  X(RUN, DISTANCE, "distance", "m", NUMBER, over_periods(result, true))                            \
  X(RUN, DURATION, "duration", "s", NUMBER, found(result, "duration"))                             \
  X(RUN, SETTLE_TIME, "settle_time", "s", NUMBER, found(result, "settle_time"))                    \
  X(RUN, STEPS, "steps", "1", NUMBER, found(result, "steps"))                                      \
  X(RUN, EVALUATIONS, "force_evaluations", "1", NUMBER, found(result, "force_evaluations"))        \
  X(RUN, CHECKS, "check_evaluations", "1", NUMBER,                                                 \
    result->summary ? (double)result->summary->accuracy.check_evaluations : (double)NAN)           \
  X(RUN, EVENTS, "events", "1", NUMBER, found(result, "events"))                                   \
  X(RUN, METHOD, "method", "1", WORD, (double)NAN)                                                 \
  X(RUN, STEP, "step", "s", NUMBER, found(result, "step"))                                         \
  X(RUN, STEP_LIMIT, "step_limit", "s", NUMBER, found(result, "step_limit"))                       \
  X(RUN, EXPECTED, "expected_error", "1", NUMBER, found(result, "accuracy.expected"))              \
  X(RUN, KEPT, STRUT_KEPT_COLUMN, "1", NUMBER, found(result, "accuracy.kept"))                     \
  STRUT_ENERGY_TABLE(ENERGY_OF_##X)                                                                \
  X(RUN, RESIDUAL, "residual", "J", NUMBER, found(result, "energy.residual"))                      \
  X(RUN, COST, "cost_of_transport", "1", NUMBER, run_cost(result, "cost_of_transport"))            \
  X(RUN, COST, "work_per_distance", "N", NUMBER, run_cost(result, "work_per_distance"))            \
  X(EQUILIBRIA, STABLE, "stable_count", "1", NUMBER, (double)result->stable_count)                 \
  X(EQUILIBRIA, FOUND, "equilibrium_count", "1", NUMBER, (double)result->equilibria.count)         \
  X(EQUILIBRIA, STATES, "state", "1", WORDS, (double)NAN)                                          \
  X(EQUILIBRIA, ENERGIES, "energy", "J", NUMBERS, state_energy(result, i))                         \
  X(EQUILIBRIA, BARRIERS, "barrier", "J", NUMBERS, state_barrier(result, i))                       \
  X(EQUILIBRIA, STARTS, "starts", "1", NUMBER, (double)result->equilibria.starts)                  \
  X(EQUILIBRIA, MISSED, "missed_probability", "1", NUMBER, result->equilibria.missed.probability)  \
  X(EQUILIBRIA, LOWEST_BARRIER, "lowest_barrier", "J", NUMBER, lowest_barrier(result))             \
  X(EQUILIBRIA, SHAPE, "shape_distance", "m", NUMBER, nearest_shape(result))                       \
  X(MODES, AT, "at", "1", WORD, (double)NAN)                                                       \
  X(MODES, FREQUENCIES, "frequency", "Hz", NUMBERS,                                                \
    frequency_of(strut_elastic_mode(&result->modes, i)))                                           \
  X(MODES, DAMPING_RATIOS, "damping_ratio", "1", NUMBERS,                                          \
    strut_elastic_mode(&result->modes, i) ? strut_elastic_mode(&result->modes, i)->damping_ratio   \
                                          : (double)NAN)                                           \
  X(MODES, MODE_COUNTS, "rigid_body_modes", "1", NUMBER,                                           \
    count_modes(&result->modes, STRUT_MODE_RIGID))                                                 \
  X(MODES, MODE_COUNTS, "mechanism_modes", "1", NUMBER,                                            \
    count_modes(&result->modes, STRUT_MODE_MECHANISM))                                             \
  X(MODES, MODE_COUNTS, "unstable_modes", "1", NUMBER,                                             \
    count_modes(&result->modes, STRUT_MODE_UNSTABLE))                                              \
  X(MODES, CONDITION, "condition", "1", NUMBER, result->modes.condition)                           \
  X(MODES, STIFFNESS, "stiffness", "N/m", NUMBER, result->stiffness)                               \
  X(MODES, SHAPE, "shape_distance", "m", NUMBER, shape_distance(result, result->modes.q))          \
  X(RIGIDITY, RANK, "rank", "1", NUMBER, (double)result->rigidity.spaces.rank)                     \
  X(RIGIDITY, SELF_STRESS, "self_stress_count", "1", NUMBER,                                       \
    (double)result->rigidity.states.count)                                                         \
  X(RIGIDITY, MECHANISMS, "mechanism_count", "1", NUMBER,                                          \
    (double)result->rigidity.mechanisms.count)                                                     \
  X(RIGIDITY, MECHANISM_KINDS, "rigid_body", "1", NUMBER,                                          \
    (double)result->rigidity.mechanisms.rigid_body)                                                \
  X(RIGIDITY, MECHANISM_KINDS, "infinitesimal", "1", NUMBER,                                       \
    (double)result->rigidity.mechanisms.infinitesimal)                                             \
  X(RIGIDITY, MECHANISM_KINDS, "finite", "1", NUMBER, (double)result->rigidity.mechanisms.finite)  \
  X(RIGIDITY, MECHANISM_KINDS, "undecided", "1", NUMBER,                                           \
    (double)result->rigidity.mechanisms.undecided)                                                 \
  X(RIGIDITY, SUPER_STABLE, "super_stable", "1", NUMBER, super_stability(&result->rigidity))       \
  X(RIGIDITY, LABEL, "label", "1", WORD, (double)NAN)                                              \
  X(RIGIDITY, RESIDUAL, "residual", "N", NUMBER, result->rigidity.residual)                        \
  X(PATH, LIMIT, "limit_factor", NULL, NUMBER, first_factor(&result->path, is_limit))              \
  X(PATH, BIFURCATION, "bifurcation_factor", NULL, NUMBER,                                         \
    first_factor(&result->path, is_bifurcation))                                                   \
  X(PATH, CRITICAL, "critical_factor", NULL, NUMBER, first_factor(&result->path, loses_stability)) \
  X(PATH, LAST_FACTOR, "last_factor", NULL, NUMBER, last_factor(&result->path))                    \
  X(PATH, PATH_EVENTS, "event_count", "1", NUMBER, (double)result->path.event_count)               \
  X(PATH, END, "end", "1", WORD, (double)NAN)                                                      \
  X(PATH, CURVE, "curve_distance", "N", NUMBER,                                                    \
    strut_goals_curve_distance(result->study, &result->path))                                      \
  X(FORM, MOVED, "moved", "m", NUMBER, result->form.moved)                                         \
  X(FORM, RESIDUAL, "residual", "N", NUMBER, result->form.residual)                                \
  X(FORM, DENSITY_CHANGE, "density_change", "1", NUMBER, result->form.density_change)              \
  X(FORM, LEAST_TENSION, "least_tension", "N", NUMBER, result->form.least_tension)                 \
  X(FORM, LARGEST_FORCE, "largest_force", "N", NUMBER, result->form.largest_force)

typedef struct column {
  strut_compute compute;
  strut_keep keep;
  const char *name, *unit;
  column_shape shape;
} column;

static const column columns[] = {
#define ENERGY_OF_COLUMN(name, kind, label) COLUMN(RUN, kind, #name, "J", NUMBER, )
#define COLUMN(compute, keep, name, unit, shape, value)                                            \
  {STRUT_COMPUTE_##compute, STRUT_KEEP_##keep, name, unit, shape},
    COLUMN_TABLE(COLUMN)};
enum { COLUMNS = sizeof columns / sizeof columns[0] };

/* The i-th value of the k-th column. */
static double value_of(const rest_result *result, size_t k, size_t i) {
  const strut_model *model = result->model;
  if (columns[k].compute == STRUT_COMPUTE_COUNT && !model) return (double)NAN;
#define ENERGY_OF_VALUE(name, kind, label)                                                         \
  VALUE(RUN, kind, #name, "J", NUMBER, found(result, "energy." #name))
#define VALUE(compute, keep, name, unit, shape, value)                                             \
  if (k-- == 0) return value;
  COLUMN_TABLE(VALUE)
  return (double)NAN;
}

/* "class 1" of "structure with tensegrity features of class 1"; reasons are left out. */
static const char *short_label(const char *label, char word[STRUT_SLOT_WORD]) {
  const char *class = strstr(label, "class ");
  if (!class) class = label;
  snprintf(word, STRUT_SLOT_WORD, "%.*s", (int)strcspn(class, ":"), class);
  return word;
}

/* The i-th word of a column. */
static const char *word_of(const rest_result *result, strut_keep keep, size_t i,
                           char word[STRUT_SLOT_WORD]) {
  if (keep == STRUT_KEEP_STATES)
    return i < result->stable_count ? result->equilibria.list[result->stable[i]].name : "";
  if (keep == STRUT_KEEP_AT) return result->modes.at;
  if (keep == STRUT_KEEP_MOTION || keep == STRUT_KEEP_METHOD) {
    const char *path = keep == STRUT_KEEP_MOTION ? "steady.kind" : "method";
    const char *text = value_at(result, &strut_summary_values, path).text;
    return text ? text : "";
  }
  if (keep == STRUT_KEEP_LABEL) return short_label(result->rigidity.tensegrity.label, word);
  return strut_path_end_word(result->path.end);
}

/* Columns that only a study which asks for them has. */
static bool is_goal(strut_keep keep) {
  return keep == STRUT_KEEP_LOWEST_BARRIER || keep == STRUT_KEEP_STIFFNESS ||
         keep == STRUT_KEEP_SHAPE || keep == STRUT_KEEP_CURVE;
}

strut_keep_set strut_statics_usual(strut_compute compute) {
  strut_keep_set usual = {{0}};
  for (size_t i = 0; i < COLUMNS; i++)
    if (columns[i].compute == compute && !is_goal(columns[i].keep))
      strut_keep_add(&usual, columns[i].keep);
  return usual;
}

static size_t lowest_of(const strut_study *study) {
  return study->lowest > 0 ? (size_t)study->lowest : STRUT_STUDY_LOWEST;
}

static bool is_kept(const strut_sweep_plan *plan, const column *self) {
  bool computed =
      self->compute == STRUT_COMPUTE_COUNT || self->compute == (strut_compute)plan->study->compute;
  return computed && strut_keep_has(&plan->keep, self->keep);
}

/* ---- what a path follows ---- */

static const char *unit_of_actuator(const strut_actuator *actuator) {
  return actuator->member >= 0 ? "m" : actuator->hinge >= 0 ? "rad" : "N/m";
}

/* Does it follow the stages of the model's file? */
static bool follows_stages(const strut_study *study, const strut_setup *setup) {
  bool told =
      study->path.load || study->path.over || study->path.from_given || study->path.until_given;
  return setup->experiment.stage_count && !told;
}

/* Unit of the parameter of the last stage, of which events and factors are told. */
static const char *unit_of_stages(const strut_setup *setup) {
  const char *over = setup->experiment.stages[setup->experiment.stage_count - 1].over;
  int32_t actuator = over ? strut_thing_find(&setup->scene, STRUT_THING_ACTUATOR, over) : -1;
  return !over ? "1" : actuator < 0 ? "m" : unit_of_actuator(&setup->scene.actuators[actuator]);
}

/* The path's options, and the unit of its parameter ("1": none). */
static strut_status choose_path(const strut_study *study, const strut_setup *setup,
                                strut_path_options *to, const char **unit, strut_error *error) {
  const strut_scene *scene = &setup->scene;
  *to = (strut_path_options){.over = STRUT_PATH_OVER_LOAD,
                             .load = study->path.load,
                             .at = study->at,
                             .from = study->path.from,
                             .until = study->path.until_given ? study->path.until : 1.0,
                             .steps = study->path.steps,
                             .friction = setup->experiment.path_friction};
  *unit = "1";
  if (follows_stages(study, setup)) {
    *unit = unit_of_stages(setup);
    return STRUT_OK;
  }
  if (study->path.over) {
    to->over = STRUT_PATH_OVER_ACTUATOR;
    to->index = strut_thing_find(scene, STRUT_THING_ACTUATOR, study->path.over);
    if (to->index >= 0) *unit = unit_of_actuator(&scene->actuators[to->index]);
    if (to->index < 0) {
      to->over = STRUT_PATH_OVER_COORDINATE;
      to->index = strut_coordinate_find(scene, study->path.over);
      *unit = "m";
    }
    if (to->index < 0)
      return strut_fail(error, STRUT_BAD_SCENE,
                        "path: 'over' expects an actuator or a coordinate of a node, such as "
                        "'%.60s.x', not '%.60s'; parameters are axes of the study",
                        scene->node_count ? scene->nodes[0].name : "node", study->path.over);
  }
  const char *given[] = {study->path.from_unit, study->path.until_unit};
  for (int i = 0; i < 2; i++)
    if (given[i] && strcmp(given[i], *unit) != 0)
      return strut_fail(error, STRUT_BAD_SCENE, "path: '%s' is in %s, expected %s%s",
                        i == 0 ? "from" : "until", given[i],
                        strcmp(*unit, "1") == 0 ? "a load factor without unit" : "",
                        strcmp(*unit, "1") == 0 ? "" : *unit);
  return STRUT_OK;
}

strut_status strut_statics_check(const strut_study *study, const strut_setup *setup,
                                 strut_error *error) {
  strut_path_options options;
  const char *unit;
  return study->compute == STRUT_COMPUTE_PATH ? choose_path(study, setup, &options, &unit, error)
                                              : STRUT_OK;
}

bool strut_kept_columns(strut_sweep_plan *plan, const strut_setup *setup) {
  strut_path_options options;
  strut_error error = {0};
  const char *factor = "1";
  bool fine = true;
  if (plan->study->compute == STRUT_COMPUTE_PATH)
    choose_path(plan->study, setup, &options, &factor, &error);
  for (size_t k = 0; k < COLUMNS && fine; k++) {
    const column *self = &columns[k];
    bool word = self->shape == WORD || self->shape == WORDS;
    bool several = self->shape == NUMBERS || self->shape == WORDS;
    const char *unit = self->unit ? self->unit : factor;
    if (!is_kept(plan, self)) continue;
    strut_sweep_begin_smooth(plan, self->keep);
    if (!several) fine = strut_sweep_add_column(plan, "", self->name, unit, word);
    for (size_t i = 0; several && i < lowest_of(plan->study) && fine; i++) {
      const char *name = strut_arena_format(&plan->arena, "%s_%zu", self->name, i + 1);
      fine = name && strut_sweep_add_column(plan, "", name, unit, word);
    }
  }
  return fine;
}

/* ---- computing ---- */

/* Warns where something carries more than it can, as the commands do. */
static void warn_of_overload(strut_sweep_job *job, const strut_model *model,
                             const double *positions, const char *where) {
  strut_overload worst;
  if (job->warning_count > 0 || !strut_history_overload(model, positions, &worst)) return;
  strut_sweep_warn(
      job, "overload",
      "in %.60s %s '%.60s' carries %.4g %s, above the %.4g at which it %s; statics take it as "
      "%s",
      where, worst.kind, worst.name, worst.force, worst.hinge ? "N m" : "N", worst.limit,
      worst.breaks ? "breaks" : "yields", worst.breaks ? "whole" : "elastic");
}

static strut_status find_equilibria(const strut_sweep_worker *worker, strut_sweep_job *job,
                                    rest_result *result) {
  const strut_equilibria_options options = {.interrupt = strut_sweep_interrupt_of(worker, job)};
  strut_equilibria *all = &result->equilibria;
  strut_status status =
      strut_equilibria_find(result->model, &job->setup.experiment, &options, all, &job->error);
  if (status) return status;
  result->stable = strut_standing_states(all, &result->arena, &result->stable_count);
  if (!result->stable) return strut_fail(&job->error, STRUT_NO_MEMORY, "out of memory");
  for (size_t i = 0; i < result->stable_count; i++)
    warn_of_overload(job, result->model, all->list[result->stable[i]].point.q,
                     all->list[result->stable[i]].name);
  if (!all->count) /* that there is none is a result, and this is why */
    snprintf(job->cells.message, sizeof job->cells.message, "%.*s",
             (int)sizeof job->cells.message - 1, all->remark);
  return STRUT_OK;
}

static strut_status find_modes(const strut_study *study, strut_sweep_job *job,
                               rest_result *result) {
  int32_t wanted = (int32_t)lowest_of(study) + 3; /* motions of the whole come first */
  strut_modes_options options = {.at = study->at, .count = 0};
  bool sparse = count_freedoms(result->model) > STRUT_DENSE_MODES;
  if (sparse && wanted > STRUT_SPARSE_MODES) options.count = wanted;
  strut_status status = strut_modes_find(result->model, &job->setup.experiment, &options,
                                         &result->modes, &job->error);
  if (!status) warn_of_overload(job, result->model, result->modes.q, result->modes.at);
  if (!status && study->goal.stiffness_node)
    status = strut_goals_stiffness(study, result->model, result->modes.q, &result->stiffness,
                                   &job->error);
  return status;
}

static strut_status find_rigidity(const strut_study *study, strut_sweep_job *job,
                                  rest_result *result) {
  strut_rest_state shape;
  strut_status status =
      strut_rest_state_find(result->model, &job->setup.experiment, study->at ? study->at : "drawn",
                            &result->arena, &shape, &job->error);
  if (!status) status = strut_rigidity_find(result->model, shape.q, &result->rigidity, &job->error);
  return status;
}

strut_status strut_statics_path(const strut_study *study, const strut_setup *setup,
                                const strut_model *model, strut_path *path, strut_error *error) {
  strut_path_options options;
  const char *unit;
  strut_status status = choose_path(study, setup, &options, &unit, error);
  if (status) return status;
  return (follows_stages(study, setup) ? strut_path_follow_stages : strut_path_follow)(
      model, &setup->experiment, &options, path, error);
}

static strut_status follow_path(const strut_study *study, strut_sweep_job *job,
                                rest_result *result) {
  strut_status status =
      strut_statics_path(study, &job->setup, result->model, &result->path, &job->error);
  if (!status && result->path.remark[0]) /* why it ended early */
    snprintf(job->cells.message, sizeof job->cells.message, "%.*s",
             (int)sizeof job->cells.message - 1, result->path.remark);
  return status;
}

static strut_status find_form(const strut_study *study, strut_sweep_job *job, rest_result *result) {
  const strut_form_options options = {.from = (strut_form_source)study->form.from,
                                      .objective = (strut_form_objective)study->form.objective,
                                      .least_tension = study->form.least_tension,
                                      .least_density = study->form.least_density};
  return strut_form_find(&job->setup, &options, &result->form, &job->error);
}

static strut_status compute(const strut_sweep_worker *worker, strut_sweep_job *job,
                            rest_result *result) {
  const strut_study *study = worker->plan->study;
  switch ((strut_compute)study->compute) {
    case STRUT_COMPUTE_EQUILIBRIA: return find_equilibria(worker, job, result);
    case STRUT_COMPUTE_MODES: return find_modes(study, job, result);
    case STRUT_COMPUTE_RIGIDITY: return find_rigidity(study, job, result);
    case STRUT_COMPUTE_PATH: return follow_path(study, job, result);
    case STRUT_COMPUTE_FORM: return find_form(study, job, result);
    case STRUT_COMPUTE_RUN:
    case STRUT_COMPUTE_COUNT: break;
  }
  return STRUT_OK;
}

/* The cells of the structure, or of what is computed. */
static void fill_columns(const strut_sweep_plan *plan, const rest_result *result, bool structure,
                         strut_row_buffer *cells) {
  for (size_t k = 0; k < COLUMNS; k++) {
    const column *self = &columns[k];
    size_t count = self->shape == NUMBERS || self->shape == WORDS ? lowest_of(plan->study) : 1;
    char word[STRUT_SLOT_WORD];
    if (!is_kept(plan, self) || (self->compute == STRUT_COMPUTE_COUNT) != structure) continue;
    for (size_t i = 0; i < count; i++) {
      if (self->shape == WORD || self->shape == WORDS)
        strut_sweep_word(cells, word_of(result, self->keep, i, word));
      else
        strut_sweep_number(cells, value_of(result, k, i));
    }
  }
}

void strut_sweep_fill_counts(const strut_sweep_plan *plan, const strut_model *model,
                             strut_row_buffer *cells) {
  fill_columns(plan, &(rest_result){.model = model}, true, cells);
}

void strut_kept_fill_run(const strut_sweep_plan *plan, const strut_setup *setup,
                         const strut_summary *summary, strut_row_buffer *cells) {
  fill_columns(plan, &(rest_result){.setup = setup, .summary = summary}, false, cells);
}

/* Positions and lengths of a form: its start, which a new model has. */
static strut_status fill_form(const strut_sweep_plan *plan, strut_sweep_job *job) {
  strut_model *model = NULL;
  const strut_scene *scene = &job->setup.scene;
  if (!plan->node_count && !plan->member_count) return STRUT_OK;
  strut_status status = strut_model_compile(scene, &model, &job->error);
  if (status) return status;
  strut_sweep_fill_positions(plan, scene, model->start, &job->cells);
  for (size_t i = 0; i < plan->member_count; i++) {
    int64_t at = strut_sweep_named(plan->members[i], i, scene, STRUT_OWNER_MEMBER);
    strut_sweep_number(&job->cells, at >= 0
                                        ? strut_member_path_length(model, (int32_t)at, model->start)
                                        : (double)NAN);
  }
  strut_model_free(model);
  return STRUT_OK;
}

strut_status strut_statics_point(const strut_sweep_worker *worker, strut_sweep_job *job) {
  strut_model *model = NULL;
  rest_result *result = strut_allocate(1, sizeof *result);
  if (!result) return strut_fail(&job->error, STRUT_NO_MEMORY, "out of memory");
  strut_status status = strut_model_compile(&job->setup.scene, &model, &job->error);
  result->model = model;
  result->study = worker->plan->study;
  result->stiffness = (double)NAN;
  job->setup.experiment.interrupt = strut_sweep_interrupt_of(worker, job);
  strut_sweep_fill_counts(worker->plan, model, &job->cells);
  if (!status) status = compute(worker, job, result);
  if (!status) fill_columns(worker->plan, result, false, &job->cells);
  if (!status && worker->plan->study->compute == STRUT_COMPUTE_FORM)
    status = fill_form(worker->plan, job);
  strut_equilibria_free(&result->equilibria);
  strut_modes_free(&result->modes);
  strut_rigidity_free(&result->rigidity);
  strut_path_free(&result->path);
  strut_arena_free(&result->arena);
  strut_model_free(model);
  strut_release(result);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The facts of a structure, at rest and moving, and its column of them. */
#include "engine/study/compare/compare.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/forces/history.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/model/pose.h"
#include "engine/run/accuracy/accuracy.h"
#include "engine/statics/modes/modes.h"
#include "engine/statics/potential.h"
#include "engine/statics/rigidity/rigidity.h"
#include "engine/statics/rigidity/rigidity_parts.h"
#include "engine/study/sweep/sweep_parts.h"
#include "engine/study/tradeoff/tradeoff_parts.h"

/* What is computed at once: counts of parts; rigidity; states; at rest; the step; the motion; its window. */
typedef enum group {
  STRUCTURE,
  RIGIDITY,
  STABLE,
  FORCES,
  FREQUENCIES,
  STIFFNESS,
  LIMIT,
  MOTION,
  WINDOW,
  GROUPS
} group;

/* What is known of a structure. */
typedef struct facts {
  const strut_compare_options *options;
  strut_compare_column *column;
  strut_arena *arena; /* of the result */
  const strut_scene *scene;
  strut_experiment *experiment;
  const char *missing[GROUPS]; /* why nothing of a group is known; NULL: it is */
  strut_error error;           /* of the latest computation */
  strut_rest_state rest;       /* q is NULL if there is none */
  strut_rigidity rigidity;     /* in the shape of the column */
  int32_t start;               /* of them, in which a run starts; -1: none */
  strut_modes modes;
  strut_cost_estimate plan;
  strut_summary run;
  double period, power, cpu; /* NAN: the run is not given in periods; there is no drive */
} facts;

/* ---- numbers ---- */

static const char no_members[] = "there are no members", no_drive[] = "there is no drive",
                  no_periods[] = "the run is not given in periods",
                  held[] = "no node can move in that direction",
                  fewer_modes[] = "the model has fewer elastic modes";

static double count_members(const facts *f, strut_member_kind kind) {
  double count = 0.0;
  for (size_t j = 0; j < f->scene->member_count; j++) count += f->scene->members[j].kind == kind;
  return count;
}

static double free_coordinates(const strut_scene *scene) {
  double count = 0.0;
  for (size_t i = 0; i < scene->node_count; i++)
    for (int d = 0; d < 2; d++) count += !scene->nodes[i].fixed[d];
  return count;
}

/* The coefficient of sliding friction, if all contacts agree. */
static double common_friction(const strut_scene *scene) {
  double mu[2] = {HUGE_VAL, 0.0};
  for (size_t i = 0; i < scene->contact_count; i++) {
    const strut_friction *friction = &scene->contacts[i].friction;
    double here = friction->law == STRUT_FRICTION_NONE ? 0.0 : friction->mu_kinetic;
    mu[0] = fmin(mu[0], here);
    mu[1] = fmax(mu[1], here);
  }
  return mu[0] == mu[1] ? mu[0] : (double)NAN;
}

/* The drive: the signal that defines the period, else that of the only actuator; -1: none. */
static int32_t drive_of(const facts *f) {
  int32_t signal = f->experiment->period_signal;
  return signal < 0 && f->scene->actuator_count == 1 ? f->scene->actuators[0].signal : signal;
}

static double drive_frequency(const facts *f) {
  int32_t drive = drive_of(f);
  double period = drive < 0 ? 0.0 : strut_signal_period(f->scene->signals, drive);
  return period > 0.0 ? 1.0 / period : (double)NAN;
}

static double drive_amplitude(const facts *f) {
  int32_t drive = drive_of(f);
  const strut_signal *s = drive < 0 ? NULL : &f->scene->signals[drive];
  bool waves =
      s && (s->kind == STRUT_SINE || s->kind == STRUT_SQUARE || s->kind == STRUT_HALF_SINE);
  return waves ? s->amplitude : (double)NAN;
}

static const char *why_no_drive(const facts *f, const char *lacks) {
  return drive_of(f) >= 0 ? lacks : f->scene->actuator_count ? "more than one drive" : "no drive";
}

static double state_energy(const strut_compare_column *c, size_t i) {
  return i < c->state_count ? c->equilibria.list[c->states[i]].energy : (double)NAN;
}

static const char *why_no_state(const facts *f) {
  const strut_compare_column *c = f->column;
  const char *remark = c->equilibria.remark[0]
                           ? strut_arena_format(f->arena, "%s", c->equilibria.remark)
                           : "there is no state in which it stands";
  return remark ? remark : "there is none";
}

static double lowest_barrier(const facts *f) {
  double lowest = (double)NAN;
  const strut_equilibria *all = &f->column->equilibria;
  for (size_t i = 0; f->start >= 0 && i < all->barrier_count; i++)
    if (all->barriers[i].from == f->start) lowest = fmin(lowest, all->barriers[i].height);
  return f->column->state_count ? lowest : (double)NAN;
}

static double root_mean_square(const facts *f) {
  double squares = 0.0, count = (double)f->scene->member_count;
  for (size_t j = 0; j < f->scene->member_count; j++)
    squares += f->rigidity.force[j] * f->rigidity.force[j];
  return sqrt(squares / count);
}

static double largest_force(const facts *f, double sign) {
  double most = 0.0;
  for (size_t j = 0; j < f->scene->member_count; j++)
    most = fmax(most, sign * f->rigidity.force[j]);
  return f->scene->member_count ? most : (double)NAN;
}

static double frequency(const facts *f, size_t i) {
  const strut_mode *mode = strut_elastic_mode(&f->modes, i);
  return mode ? mode->angular_frequency / STRUT_TAU : (double)NAN;
}

static double least_stiffness(const strut_compare_column *c, int axis) {
  return c->softest[axis] < 0 ? (double)NAN : c->stiffness[c->softest[axis]][axis];
}

static double weight(const strut_scene *scene) {
  return strut_scene_mass(scene) * hypot(scene->gravity[0], scene->gravity[1]);
}

static double cost_of_transport(const facts *f) {
  double speed = fabs(f->run.velocity);
  bool known = weight(f->scene) > 0.0 && !f->column->still && speed > 0.0 && f->power > 0.0;
  return known ? f->power / (weight(f->scene) * speed) : (double)NAN;
}

static double mean_duty(const strut_compare_column *c) {
  double sum = 0.0, touching = 0.0;
  for (size_t i = 0; i < c->contact_count; i++) {
    sum += c->contacts[i].duty;
    touching += c->contacts[i].duty > 0.0;
  }
  return touching > 0.0 ? sum / touching : (double)NAN;
}

static double evaluations(const strut_summary *run) {
  return (double)(run->spent.evaluations + run->accuracy.check_evaluations);
}

/* ---- the column ---- */

strut_compare_row strut_compare_row_of(strut_compare_quantity quantity) {
  static const strut_compare_row rows[STRUT_COMPARE_QUANTITIES] = {
#define ROW(name, key, unit, ...) {key, unit},
      STRUT_COMPARE_TABLE(ROW)};
  return rows[quantity];
}

static strut_compare_cell make_cell(const char *missing, double value, const char *reason) {
  if (missing) return (strut_compare_cell){(double)NAN, missing};
  if (isfinite(value)) return (strut_compare_cell){value, NULL};
  return (strut_compare_cell){(double)NAN, reason ? reason : "not finite"};
}

/* Cells of a group that is not known look at nothing of it. */
static void fill_cells(const facts *f) {
  strut_compare_column *c = f->column;
  strut_compare_cell *cell = c->cell;
#define CELL(name, key, unit, group, value, reason)                                                \
  *cell++ = f->missing[group] ? make_cell(f->missing[group], 0.0, NULL)                            \
                              : make_cell(NULL, value, reason);
  STRUT_COMPARE_TABLE(CELL)
}

/*
 * Nothing is known of groups first .. last, for the latest error; returns STRUT_OK unless memory is out or the user
 * interrupts. `failed`: the column reports it, as this should have worked.
 */
static strut_status miss(facts *f, group first, group last, strut_status status, bool failed) {
  if (status == STRUT_NO_MEMORY || status == STRUT_INTERRUPTED) return status;
  const char *text = f->error.message[0] ? f->error.message : strut_status_text(status);
  const char *kept = strut_arena_format(f->arena, "%s", text);
  if (!kept) return STRUT_NO_MEMORY;
  for (int i = first; i <= (int)last; i++) f->missing[i] = kept;
  if (failed && f->column->status == STRUT_OK) {
    f->column->status = status;
    snprintf(f->column->message, sizeof f->column->message, "%s", text);
  }
  f->error = (strut_error){0};
  return STRUT_OK;
}

/* What a computation of a group came to. */
static strut_status know(facts *f, group of, strut_status status, bool failed) {
  if (status) return miss(f, of, of, status, failed);
  f->missing[of] = NULL;
  return STRUT_OK;
}

/* ---- at rest ---- */

/* Without a rest state the drawn shape is shown and the values at rest stay empty. */
static strut_status find_rest(facts *f, const strut_model *model) {
  strut_compare_column *column = f->column;
  strut_status status =
      strut_rest_state_find(model, f->experiment, NULL, f->arena, &f->rest, &f->error);
  if (!status) {
    column->shape = f->rest.name;
    column->q = f->rest.q;
    return STRUT_OK;
  }
  f->rest = (strut_rest_state){0};
  status = miss(f, FORCES, STIFFNESS, status, false);
  double *q = strut_arena_allocate(f->arena, (size_t)model->length, sizeof *q);
  if (!q) return STRUT_NO_MEMORY;
  for (size_t i = 0; i < model->scene->node_count; i++)
    memcpy(q + 2 * i, model->scene->nodes[i].position, 2 * sizeof *q);
  column->shape = "drawn";
  column->q = q;
  return status;
}

/* The equilibrium of the list that a run starts in, or -1. */
static int32_t find_start(const facts *f, const strut_model *model) {
  const double *q = f->rest.q;
  for (size_t i = 0; q && i < f->column->equilibria.count; i++) {
    const strut_equilibrium *equilibrium = &f->column->equilibria.list[i];
    const double *p = equilibrium->rest ? equilibrium->rest : equilibrium->point.q;
    if (equilibrium->outcome != STRUT_OUTCOME_STANDS) continue;
    double shift = p[0] - q[0], apart = 0.0; /* along the ground it may lie anywhere */
    if (!strut_contacts_allow_travel(&model->contacts)) shift = 0.0;
    for (int32_t k = 0; k < 2 * model->node_count; k++)
      apart = fmax(apart, fabs(p[k] - q[k] - (k % 2 ? 0.0 : shift)));
    if (apart <= 1e-3 * model->size) return (int32_t)i;
  }
  return -1;
}

/* States in which it stands, with energies and barriers. */
static strut_status find_states(facts *f, const strut_model *model) {
  const strut_equilibria_options wanted = {.interrupt = f->options->interrupt};
  f->missing[STABLE] = "not requested";
  if (f->options->no_states) return STRUT_OK;
  strut_compare_column *c = f->column;
  strut_status status =
      strut_equilibria_find(model, f->experiment, &wanted, &c->equilibria, &f->error);
  if (!status) c->states = strut_standing_states(&c->equilibria, f->arena, &c->state_count);
  if (!status && !c->states) status = STRUT_NO_MEMORY;
  if (!status) f->start = find_start(f, model);
  if (status) strut_equilibria_free(&c->equilibria);
  return know(f, STABLE, status, true);
}

/* Stiffness of every node under a unit load in x and in y where it stands. */
static strut_status find_stiffness(facts *f, const strut_model *model) {
  static const double axes[2][2] = {{1.0, 0.0}, {0.0, 1.0}};
  strut_node_stiffness *found = NULL;
  strut_compare_column *column = f->column;
  strut_status status =
      strut_node_stiffness_create(model, f->rest.q, &found, &f->missing[STIFFNESS], &f->error);
  if (status || !found) return status;
  column->stiffness =
      strut_arena_allocate(f->arena, (size_t)model->node_count, sizeof *column->stiffness);
  for (int32_t i = 0; i < model->node_count && column->stiffness; i++)
    for (int d = 0; d < 2; d++) {
      int32_t *softest = &column->softest[d];
      double here = strut_node_stiffness_along(found, i, axes[d]);
      column->stiffness[i][d] = here;
      if (isfinite(here) && (*softest < 0 || here < column->stiffness[*softest][d])) *softest = i;
    }
  strut_node_stiffness_free(found);
  f->missing[STIFFNESS] = NULL;
  return column->stiffness ? STRUT_OK : STRUT_NO_MEMORY;
}

static strut_status study_rest(facts *f) {
  const strut_modes_options lowest = {.at = NULL};
  strut_model *model = NULL;
  strut_status status = strut_model_compile(f->scene, &model, &f->error);
  f->missing[STRUCTURE] = NULL;
  if (!status) status = find_rest(f, model);
  if (!status)
    status =
        know(f, RIGIDITY, strut_rigidity_find(model, f->column->q, &f->rigidity, &f->error), true);
  if (!status && f->rest.q) f->missing[FORCES] = f->missing[RIGIDITY];
  if (!status) status = find_states(f, model);
  if (!status && f->rest.q)
    status = know(f, FREQUENCIES,
                  strut_modes_find(model, f->experiment, &lowest, &f->modes, &f->error), false);
  if (!status && f->rest.q) status = find_stiffness(f, model);
  strut_model_free(model);
  return status;
}

/* ---- moving ---- */

enum { LONG_WINDOW = 20 }; /* periods of a motion that is not periodic */
static const double WINDOW_TOLERANCE = 1e-6, STEPS = 50.0;

/* The steady motion over whole periods, from where the run ended. */
static strut_status run_window(const facts *f, const strut_snapshot *end, double *seconds,
                               strut_summary *window, strut_error *error) {
  strut_experiment e = *f->experiment;
  bool periodic = f->run.steady.kind == STRUT_MOTION_PERIODIC;
  if (f->scene->bar_model == STRUT_BARS_RIGID) { /* which error control does not support */
    e.step = f->run.step;
  } else {
    e.integrator = strut_integrator_for(STRUT_ROLE_REFERENCE)->name;
    e.tolerance = WINDOW_TOLERANCE;
    e.step = f->period / STEPS;
  }
  e.accuracy = 0.0;
  e.refine = e.refine_time = 0.0;
  e.steady.wanted = false;
  e.periods = periodic ? f->run.steady.repeats : LONG_WINDOW;
  e.measure_last = 0.0;
  e.output_last = 0.0;
  *seconds = e.periods * f->period;
  const strut_run_options wanted = {.interrupt = f->options->interrupt, .from = end};
  return strut_simulate(f->column->model, &e, &wanted, window, error);
}

/* Energies and contacts, over whole periods where there are some. */
static strut_status study_window(facts *f, const strut_snapshot *end) {
  strut_compare_column *column = f->column;
  strut_summary window = {0};
  const strut_summary *from = isfinite(f->period) ? &window : &f->run;
  double seconds = f->run.duration;
  strut_status status = STRUT_OK;
  if (from == &window) status = run_window(f, end, &seconds, &window, &f->error);
  if (!status) {
    size_t count = from->end.contact_count;
    column->contacts = strut_arena_allocate(f->arena, count + 1, sizeof *column->contacts);
    if (!column->contacts) status = STRUT_NO_MEMORY;
    for (size_t i = 0; i < count && !status; i++)
      column->contacts[column->contact_count++] = from->end.contacts[i];
    f->power = f->scene->actuator_count ? from->energy.drive_work / seconds : (double)NAN;
  }
  strut_summary_free(&window);
  return know(f, WINDOW, status, true);
}

static strut_status describe_motion(const facts *f) {
  strut_compare_column *column = f->column;
  const strut_summary *run = &f->run;
  strut_motion kind = run->steady.kind;
  column->motion = kind == STRUT_MOTION_NOT_WATCHED
                       ? strut_arena_format(f->arena, "mean over %.4g s", run->window.time)
                       : strut_motion_name(kind);
  column->repeats = kind == STRUT_MOTION_PERIODIC ? run->steady.repeats : 0;
  column->how = strut_arena_format(f->arena, "%s", run->accuracy.why);
  column->inaccurate = strut_summary_is_inaccurate(run);
  column->still = fabs(run->velocity) <=
                  run->accuracy.expected * fmax(fabs(run->velocity), run->accuracy.scale);
  return column->motion && column->how ? STRUT_OK : STRUT_NO_MEMORY;
}

/*
 * The run to a wanted accuracy, which for a driven structure ends when the motion is steady; then whole periods of that
 * motion.
 */
static strut_status study_motion(facts *f, const strut_model *model) {
  strut_experiment *experiment = f->experiment;
  const char *none = f->options->no_motion ? "not requested"
                     : !(experiment->duration > 0 || experiment->periods > 0)
                         ? "the model has no run"
                         : NULL;
  f->missing[MOTION] = f->missing[WINDOW] = none;
  if (none) return STRUT_OK;
  strut_snapshot end = {0};
  if (!STRUT_NUMBERS(f->arena, model->length, &end.q, &end.v) ||
      !STRUT_NUMBERS(f->arena, strut_history_count(model), &end.memory))
    return STRUT_NO_MEMORY;
  experiment->accuracy = f->options->accuracy;
  experiment->steady.wanted = experiment->periods > 0.0;
  experiment->quantity_count = 0; /* the accuracy is that of the velocity */
  const double period = strut_experiment_span(experiment, f->scene).period;
  f->period = period > 0.0 ? period : (double)NAN;
  const strut_run_options wanted = {.interrupt = f->options->interrupt, .to = &end};
  double began = strut_tradeoff_cpu_clock();
  strut_status status = strut_simulate_accurately(model, experiment, &wanted, &f->run, &f->error);
  f->cpu = strut_tradeoff_cpu_clock() - began;
  if (status) return miss(f, MOTION, WINDOW, status, true);
  status = describe_motion(f);
  return status ? status : study_window(f, &end);
}

/* Resolves the equilibrium that the scene starts from, then evaluates the motion. */
static strut_status study_run(facts *f) {
  strut_setup *setup = f->column->input->setup;
  strut_model **model = &f->column->model;
  strut_status status = strut_resolve_start_equilibrium(setup, &f->error);
  bool resolved = !status;
  if (!resolved) status = miss(f, MOTION, WINDOW, status, true);
  if (!status) status = strut_model_compile(&setup->scene, model, &f->error);
  if (!status)
    status = know(f, LIMIT, strut_cost_estimate_describe(*model, &f->plan, &f->error), false);
  return !status && resolved ? study_motion(f, *model) : status;
}

static strut_status fill_column(const strut_compare_input *input,
                                const strut_compare_options *options, strut_compare_column *column,
                                strut_arena *arena, strut_error *error) {
  facts f = {.options = options,
             .column = column,
             .arena = arena,
             .scene = &input->setup->scene,
             .experiment = &input->setup->experiment};
  *column = (strut_compare_column){.input = input, .softest = {-1, -1}};
  for (int i = 0; i < GROUPS; i++) f.missing[i] = "not computed";
  strut_status status = study_rest(&f);
  if (!status) status = study_run(&f);
  if (!status) fill_cells(&f);
  if (status && error) *error = f.error;
  strut_rigidity_free(&f.rigidity);
  strut_modes_free(&f.modes);
  strut_summary_free(&f.run);
  return status;
}

strut_status strut_compare_make(const strut_compare_input *inputs, size_t count,
                                const strut_compare_options *options, strut_compare *result,
                                strut_error *error) {
  strut_compare_options wanted = *options;
  if (!(wanted.accuracy > 0.0)) wanted.accuracy = STRUT_COMPARE_USUAL_PERCENT / 100;
  *result = (strut_compare){.count = count,
                            .accuracy = wanted.accuracy,
                            .no_motion = wanted.no_motion,
                            .no_states = wanted.no_states};
  result->columns = strut_arena_allocate(&result->arena, count, sizeof *result->columns);
  strut_status status = result->columns ? STRUT_OK : STRUT_NO_MEMORY;
  for (size_t i = 0; i < count && status == STRUT_OK; i++) {
    status = fill_column(&inputs[i], &wanted, &result->columns[i], &result->arena, error);
    if (wanted.interrupt && *wanted.interrupt) status = STRUT_INTERRUPTED;
    if (wanted.progress) wanted.progress(wanted.progress_context, (double)(i + 1) / (double)count);
  }
  if (status != STRUT_OK && error && error->status != status)
    strut_fail(error, status, "%s", strut_status_text(status));
  return status;
}

void strut_compare_free(strut_compare *result) {
  for (size_t i = 0; result->columns && i < result->count; i++) {
    strut_model_free(result->columns[i].model);
    strut_equilibria_free(&result->columns[i].equilibria);
  }
  strut_arena_free(&result->arena);
  *result = (strut_compare){0};
}

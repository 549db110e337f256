/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts of a structure's parts, and its drive. */
#include "engine/study/compare/compare.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/run/cost_estimate.h"
#include "engine/study/compare/compare_parts.h"

/* ---- structure and drive ---- */

static double total_mass(const strut_scene *scene) {
  double mass = 0.0;
  for (size_t i = 0; i < scene->node_count; i++) mass += scene->nodes[i].mass;
  for (size_t j = 0; j < scene->member_count; j++) mass += scene->members[j].mass;
  for (size_t i = 0; i < scene->sliding_count; i++) mass += scene->sliding_masses[i].mass;
  return mass;
}

static double free_coordinates(const strut_scene *scene) {
  double count = 0.0;
  for (size_t i = 0; i < scene->node_count; i++)
    for (int d = 0; d < 2; d++) count += !scene->nodes[i].fixed[d];
  return count;
}

/* The coefficient of sliding friction, if all contacts agree. */
static void put_friction(strut_compare_work *work, const strut_scene *scene) {
  const strut_compare_quantity at = STRUT_COMPARE_FRICTION;
  if (scene->contact_count == 0) {
    strut_compare_leave(work, at, at, "no contact nodes");
    return;
  }
  double mu[2] = {HUGE_VAL, 0.0};
  for (size_t i = 0; i < scene->contact_count; i++) {
    const strut_friction *friction = &scene->contacts[i].friction;
    double here = friction->law == STRUT_FRICTION_NONE ? 0.0 : friction->mu_kinetic;
    mu[0] = fmin(mu[0], here);
    mu[1] = fmax(mu[1], here);
  }
  if (mu[0] < mu[1])
    strut_compare_leave(work, at, at, "friction differs between contacts");
  else
    strut_compare_put(work, at, mu[0]);
}

/* The drive: the signal that defines the period, else that of the only actuator. */
static void put_drive(strut_compare_work *work, const strut_scene *scene) {
  int32_t signal = work->column->input->setup->experiment.period_signal;
  if (signal < 0 && scene->actuator_count == 1) signal = scene->actuators[0].signal;
  if (signal < 0) {
    strut_compare_leave(work, STRUT_COMPARE_DRIVE_FREQUENCY, STRUT_COMPARE_DRIVE_AMPLITUDE,
                        scene->actuator_count ? "more than one drive" : "no drive");
    return;
  }
  double period = strut_signal_period(scene->signals, signal);
  const strut_signal *s = &scene->signals[signal];
  if (period > 0.0)
    strut_compare_put(work, STRUT_COMPARE_DRIVE_FREQUENCY, 1.0 / period);
  else
    strut_compare_leave(work, STRUT_COMPARE_DRIVE_FREQUENCY, STRUT_COMPARE_DRIVE_FREQUENCY,
                        "the drive is not periodic");
  if (s->kind == STRUT_SINE || s->kind == STRUT_SQUARE || s->kind == STRUT_HALF_SINE)
    strut_compare_put(work, STRUT_COMPARE_DRIVE_AMPLITUDE, s->amplitude);
  else
    strut_compare_leave(work, STRUT_COMPARE_DRIVE_AMPLITUDE, STRUT_COMPARE_DRIVE_AMPLITUDE,
                        "the drive has no single amplitude");
}

strut_status strut_compare_structure(strut_compare_work *work, const strut_model *model) {
  const strut_scene *scene = model->scene;
  double kinds[3] = {0, 0, 0};
  for (size_t j = 0; j < scene->member_count; j++) kinds[scene->members[j].kind]++;
  strut_compare_put(work, STRUT_COMPARE_NODES, (double)scene->node_count);
  strut_compare_put(work, STRUT_COMPARE_MEMBERS, (double)scene->member_count);
  strut_compare_put(work, STRUT_COMPARE_BARS, kinds[STRUT_BAR]);
  strut_compare_put(work, STRUT_COMPARE_SPRINGS, kinds[STRUT_SPRING]);
  strut_compare_put(work, STRUT_COMPARE_CABLES, kinds[STRUT_CABLE]);
  strut_compare_put(work, STRUT_COMPARE_CONTACTS, (double)scene->contact_count);
  strut_compare_put(work, STRUT_COMPARE_ACTUATORS, (double)scene->actuator_count);
  strut_compare_put(work, STRUT_COMPARE_MASS, total_mass(scene));
  strut_compare_put(work, STRUT_COMPARE_FREEDOMS, free_coordinates(scene));
  put_friction(work, scene);
  put_drive(work, scene);
  return STRUT_OK;
}

/* ---- columns ---- */

static const strut_compare_row rows[STRUT_COMPARE_QUANTITIES] = {
#define ROW(name, key, unit) {key, unit},
    STRUT_COMPARE_TABLE(ROW)};

strut_compare_row strut_compare_row_of(strut_compare_quantity quantity) { return rows[quantity]; }

void strut_compare_put(strut_compare_work *work, strut_compare_quantity quantity, double value) {
  bool there = isfinite(value);
  work->column->cell[quantity] =
      (strut_compare_cell){there ? value : (double)NAN, there ? NULL : "not finite"};
}

void strut_compare_leave(strut_compare_work *work, strut_compare_quantity first,
                         strut_compare_quantity last, const char *reason) {
  for (int i = (int)first; i <= (int)last; i++)
    work->column->cell[i] = (strut_compare_cell){(double)NAN, reason};
}

strut_status strut_compare_leave_failed(strut_compare_work *work, strut_compare_quantity first,
                                        strut_compare_quantity last, const strut_error *error,
                                        strut_status status, bool failed) {
  if (status == STRUT_NO_MEMORY || status == STRUT_INTERRUPTED) return status;
  const char *text = error->message[0] ? error->message : strut_status_text(status);
  const char *kept = strut_arena_format(work->arena, "%s", text);
  if (!kept) return STRUT_NO_MEMORY;
  strut_compare_leave(work, first, last, kept);
  if (failed && work->column->status == STRUT_OK) {
    work->column->status = status;
    snprintf(work->column->message, sizeof work->column->message, "%s", text);
  }
  return STRUT_OK;
}

/* Finds the rest state; without one, the drawn shape is shown and the values at rest stay empty. */
static strut_status find_rest(strut_compare_work *work, const strut_model *model) {
  strut_error error = {0};
  strut_compare_column *column = work->column;
  strut_status status = strut_rest_state_find(model, &work->column->input->setup->experiment, NULL,
                                              work->arena, &work->rest, &error);
  if (status == STRUT_OK) {
    column->shape = work->rest.name;
    column->q = work->rest.q;
    return STRUT_OK;
  }
  work->rest = (strut_rest_state){0};
  status = strut_compare_leave_failed(work, STRUT_COMPARE_PRESTRESS, STRUT_COMPARE_STIFFNESS_Y,
                                      &error, status, false);
  double *q = strut_arena_allocate(work->arena, (size_t)model->length, sizeof *q);
  if (!q) return STRUT_NO_MEMORY;
  for (size_t i = 0; i < model->scene->node_count; i++)
    memcpy(q + 2 * i, model->scene->nodes[i].position, 2 * sizeof *q);
  column->shape = "drawn";
  column->q = q;
  return status;
}

static strut_status find_limit(strut_compare_work *work, const strut_model *model) {
  strut_cost_estimate plan;
  strut_error error = {0};
  strut_status status = strut_cost_estimate_describe(model, &plan, &error);
  if (status != STRUT_OK)
    return strut_compare_leave_failed(work, STRUT_COMPARE_STEP_LIMIT, STRUT_COMPARE_STEP_LIMIT,
                                      &error, status, false);
  if (!plan.runnable)
    strut_compare_leave(work, STRUT_COMPARE_STEP_LIMIT, STRUT_COMPARE_STEP_LIMIT,
                        "a free node has no mass");
  else if (isinf(plan.step_limit))
    strut_compare_leave(work, STRUT_COMPARE_STEP_LIMIT, STRUT_COMPARE_STEP_LIMIT,
                        "the step is not limited");
  else
    strut_compare_put(work, STRUT_COMPARE_STEP_LIMIT, plan.step_limit);
  return STRUT_OK;
}

static strut_status evaluate_rest(strut_compare_work *work, const strut_model *model) {
  strut_status status = strut_compare_structure(work, model);
  if (status == STRUT_OK) status = find_rest(work, model);
  if (status == STRUT_OK) status = strut_compare_rigidity(work, model);
  if (status == STRUT_OK) status = strut_compare_states(work, model);
  if (status == STRUT_OK && work->rest.q) status = strut_compare_frequencies(work, model);
  if (status == STRUT_OK && work->rest.q) status = strut_compare_stiffness(work, model);
  return status;
}

/* Resolves the equilibrium that the scene starts from, then evaluates the motion. */
static strut_status evaluate_motion(strut_compare_work *work) {
  strut_setup *setup = work->column->input->setup;
  strut_error error = {0};
  strut_status status = strut_resolve_start_equilibrium(setup, &error);
  bool resolved = status == STRUT_OK;
  if (!resolved)
    status = strut_compare_leave_failed(work, STRUT_COMPARE_VELOCITY, STRUT_COMPARE_CPU, &error,
                                        status, true);
  if (status == STRUT_OK) status = strut_model_compile(&setup->scene, &work->column->model, &error);
  if (status == STRUT_OK) status = find_limit(work, work->column->model);
  if (status == STRUT_OK && resolved) status = strut_compare_motion(work, work->column->model);
  return status;
}

static strut_status fill_column(const strut_compare_input *input,
                                const strut_compare_options *options, strut_compare_column *column,
                                strut_arena *arena, strut_error *error) {
  strut_compare_work work = {.options = options, .column = column, .arena = arena};
  strut_model *model = NULL;
  *column = (strut_compare_column){.input = input, .softest = {-1, -1}};
  strut_compare_leave(&work, 0, STRUT_COMPARE_QUANTITIES - 1, "not computed");
  strut_status status = strut_model_compile(&input->setup->scene, &model, error);
  if (status == STRUT_OK) status = evaluate_rest(&work, model);
  strut_model_free(model);
  if (status == STRUT_OK) status = evaluate_motion(&work);
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
  for (size_t i = 0; result->columns && i < result->count; i++)
    strut_model_free(result->columns[i].model);
  strut_arena_free(&result->arena);
  *result = (strut_compare){0};
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The whole study, from the base to the Pareto front. */
#include "engine/study/tradeoff/tradeoff.h"

#include <gsl/gsl_sort_double.h>
#include <math.h>
#include <stdio.h>

#include "engine/model/model.h"
#include "engine/study/tradeoff/tradeoff_parts.h"

/* ---- errors, spreads over the operating points, and the Pareto front ---- */

static const double levels[] = {0.02, 0.01, 0.005, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
static const double SURE = 0.1; /* an error is known where the floor is this part of it */

size_t strut_tradeoff_level_count(const strut_tradeoff *tradeoff) {
  return tradeoff->accuracy > 0 ? 1 : sizeof levels / sizeof levels[0];
}

double strut_tradeoff_level(const strut_tradeoff *tradeoff, size_t i) {
  return tradeoff->accuracy > 0 ? tradeoff->accuracy : levels[i];
}

strut_spread strut_spread_of(const double *values, size_t count, double *scratch) {
  if (count == 0) return (strut_spread){(double)NAN, (double)NAN, (double)NAN, NULL, 0};
  for (size_t i = 0; i < count; i++) scratch[i] = values[i];
  gsl_sort(scratch, 1, count);
  size_t half = count / 2, rank = (9 * count + 9) / 10;
  double median = count % 2 ? scratch[half] : 0.5 * (scratch[half - 1] + scratch[half]);
  return (strut_spread){median, scratch[rank - 1], scratch[count - 1], values, count};
}

void strut_tradeoff_judge_row(tradeoff_study *study, strut_tradeoff_row *row) {
  strut_tradeoff *tradeoff = study->result;
  const strut_model_variant *own = &tradeoff->variants[0], *f = &tradeoff->variants[row->variant];
  for (size_t p = 0; p < tradeoff->point_count; p++) {
    const double *value = row->value + p * tradeoff->value_count;
    double error = strut_tradeoff_distance(study, p, value, f->value + p * tradeoff->value_count);
    double total = strut_tradeoff_distance(study, p, value, own->value + p * tradeoff->value_count);
    row->error[p] = fmax(error, f->floor[p]);
    row->total[p] = fmax(total, own->floor[p]);
  }
  row->error_spread = strut_spread_of(row->error, tradeoff->point_count, study->scratch);
  row->total_spread = strut_spread_of(row->total, tradeoff->point_count, study->scratch);
}

/* Costs of a row: medians over the points at which it did not diverge, or else what was planned. */
static void evaluate_cost(tradeoff_study *study, strut_tradeoff_row *row,
                          const strut_tradeoff_row *base) {
  strut_tradeoff *tradeoff = study->result;
  double *ratio = study->spare, *rate = ratio + tradeoff->point_count;
  size_t count = 0;
  for (int planned = 0; planned < 2 && count == 0; planned++)
    for (size_t p = 0; p < tradeoff->point_count; p++) {
      double forces = planned ? strut_tradeoff_planned(study, p, row->setting) : row->forces[p];
      double unit = base && isfinite(base->forces[p])
                        ? base->forces[p]
                        : strut_tradeoff_planned(study, p, study->base);
      if (p == 0) tradeoff->base_evaluations = unit;
      if (!isfinite(forces)) continue;
      ratio[count] = forces / unit;
      rate[count++] = forces / study->points[p].span.duration;
    }
  row->evaluations = strut_spread_of(ratio, count, study->scratch).median;
  row->rate = strut_spread_of(rate, count, study->scratch).median;
  row->cpu = base ? row->seconds / base->seconds : (double)NAN;
}

static void evaluate_costs(tradeoff_study *study) {
  strut_tradeoff *tradeoff = study->result;
  const strut_tradeoff_row *base = NULL;
  for (size_t i = 0; i < tradeoff->row_count; i++)
    if (tradeoff->rows[i].base) base = &tradeoff->rows[i];
  tradeoff->base_seconds = base ? base->seconds : (double)NAN;
  for (size_t i = 0; i < tradeoff->row_count; i++) evaluate_cost(study, &tradeoff->rows[i], base);
}

void strut_pareto_front(const double (*points)[2], size_t count, bool *front) {
  for (size_t i = 0; i < count; i++) {
    const double *own = points[i];
    front[i] = isfinite(own[0]) && isfinite(own[1]);
    for (size_t k = 0; k < count && front[i]; k++) {
      const double *other = points[k];
      bool no_worse = other[0] <= own[0] && other[1] <= own[1];
      front[i] = !(no_worse && (other[0] < own[0] || other[1] < own[1]));
    }
  }
}

/* The fronts of each variant. */
static void find_fronts(tradeoff_study *study) {
  strut_tradeoff *tradeoff = study->result;
  size_t count = tradeoff->row_count;
  double(*points)[2] = strut_tradeoff_allocate(study, count + 1, sizeof *points);
  bool *front = strut_tradeoff_allocate(study, count + 1, sizeof *front);
  for (size_t k = 0; k < 2 * tradeoff->variant_count && points && front; k++) {
    for (size_t i = 0; i < count; i++) {
      const strut_tradeoff_row *row = &tradeoff->rows[i];
      points[i][0] = row->variant == (int)(k / 2) ? row->evaluations : (double)NAN;
      points[i][1] = k % 2 ? row->total_spread.worst : row->error_spread.worst;
    }
    strut_pareto_front((const double(*)[2])points, count, front);
    for (size_t i = 0; i < count; i++)
      if (front[i]) *(k % 2 ? &tradeoff->rows[i].total_front : &tradeoff->rows[i].front) = true;
  }
}

/* Errors, spreads, costs and fronts of all rows, from values and references. */
static void judge(tradeoff_study *study) {
  strut_tradeoff *tradeoff = study->result;
  for (size_t i = 0; i < tradeoff->variant_count; i++) {
    strut_model_variant *variant = &tradeoff->variants[i];
    for (size_t p = 0; p < tradeoff->point_count && i > 0 && variant->run; p++)
      variant->model_error[p] =
          strut_tradeoff_distance(study, p, variant->value + p * tradeoff->value_count,
                                  tradeoff->variants[0].value + p * tradeoff->value_count);
    variant->model_spread =
        strut_spread_of(variant->model_error, tradeoff->point_count, study->scratch);
    variant->floor_spread = strut_spread_of(variant->floor, tradeoff->point_count, study->scratch);
  }
  for (size_t i = 0; i < tradeoff->row_count; i++)
    strut_tradeoff_judge_row(study, &tradeoff->rows[i]);
  evaluate_costs(study);
  find_fronts(study);
}

/* The smallest worst error of a row of the unchanged model, not counting what a floor hides; 1 where there is none. */
static double smallest_error(const strut_tradeoff *tradeoff) {
  double smallest = 1;
  for (size_t i = 0; i < tradeoff->row_count; i++) {
    double worst = tradeoff->rows[i].error_spread.worst;
    if (tradeoff->rows[i].variant == 0 && worst > 0 && worst < smallest) smallest = worst;
  }
  return smallest;
}

/* Is b a finer setting of the same group, or a itself? */
static bool is_finer(const strut_tradeoff_row *first, const strut_tradeoff_row *second) {
  if (first->group != second->group) return false;
  const tradeoff_setting *coarse = &first->setting, *fine = &second->setting;
  return isfinite(coarse->tolerance) ? fine->tolerance <= coarse->tolerance
                                     : fine->step <= coarse->step;
}

double strut_tradeoff_promise(const strut_tradeoff *tradeoff, int row) {
  double most = 0;
  for (size_t k = 0; k < tradeoff->row_count; k++)
    if (is_finer(&tradeoff->rows[row], &tradeoff->rows[k]))
      most = fmax(most, tradeoff->rows[k].total_spread.worst);
  return most;
}

static bool is_confirmed(const strut_tradeoff *tradeoff, const strut_tradeoff_row *row) {
  bool finer = false;
  for (size_t k = 0; k < tradeoff->row_count; k++)
    finer = finer || (&tradeoff->rows[k] != row && is_finer(row, &tradeoff->rows[k]));
  return finer;
}

/* The cheapest confirmed row of the unchanged model that keeps a level, of any method but one; -1: none. */
static int best_but(const strut_tradeoff *tradeoff, double level,
                    const strut_integrator *excluded) {
  int best = -1;
  for (size_t i = 0; i < tradeoff->row_count; i++) {
    const strut_tradeoff_row *row = &tradeoff->rows[i];
    if (row->variant != 0 || row->setting.method == excluded || row->above) continue;
    if (!is_confirmed(tradeoff, row) || !(strut_tradeoff_promise(tradeoff, (int)i) <= level))
      continue;
    if (best < 0 || row->evaluations < tradeoff->rows[best].evaluations) best = (int)i;
  }
  return best;
}

/*
 * Cost of an error between a row that keeps it and the next coarser one of its group, on a line of
 * logarithms.
 */
static double interpolate_cost(const strut_tradeoff *tradeoff, int row, double error) {
  const strut_tradeoff_row *fine = &tradeoff->rows[row], *coarse = NULL;
  for (size_t i = 0; i < tradeoff->row_count; i++) {
    const strut_tradeoff_row *other = &tradeoff->rows[i];
    if (other == fine || !is_finer(other, fine)) continue;
    if (!coarse || is_finer(coarse, other)) coarse = other;
  }
  double high =
      coarse ? strut_tradeoff_promise(tradeoff, (int)(coarse - tradeoff->rows)) : HUGE_VAL;
  double low = strut_tradeoff_promise(tradeoff, row);
  if (!isfinite(high) || !(high > low)) return fine->evaluations;
  double part = log(high / error) / log(high / low);
  return coarse->evaluations * pow(fine->evaluations / coarse->evaluations, part);
}

strut_tradeoff_advice strut_tradeoff_advise(const strut_tradeoff *tradeoff, double error) {
  strut_tradeoff_advice a = {.error = error, .cost = (double)NAN};
  a.known = tradeoff->variants[0].floor_spread.worst <= SURE * 0.5 * error;
  a.row = a.known ? best_but(tradeoff, error, NULL) : -1;
  a.half = a.row < 0 ? -1 : best_but(tradeoff, 0.5 * error, NULL);
  a.other = a.row < 0 ? -1 : best_but(tradeoff, error, tradeoff->rows[a.row].setting.method);
  if (a.half >= 0)
    a.cost = a.half == a.row ? 1
                             : fmax(1, interpolate_cost(tradeoff, a.half, 0.5 * error) /
                                           tradeoff->rows[a.row].evaluations);
  return a;
}

/* ---- the study: base, references, rows, other models ---- */

enum { BEST_METHODS = 2 };
static const double SPEED_SHARE = 1e-3, COARSE = 0.2; /* of the limit */
/*
 * Floors to reach: parts of the accuracy, or without one; of the unchanged model and of variants.
 */
static const double OWN_PART = 0.01, OWN_FLOOR = 1e-6, OTHER_PART = 0.1, OTHER_FLOOR = 1e-4;
/* The former without an accuracy, while a level costs less than so many of the scene's own runs. */
static const double CHEAP_FLOOR = 1e-10, CHEAP = 8;
/*
 * Parts of the work: at most of the base, kept for variants, of finer references relative to that
 * done.
 */
static const double FOR_BASE = 0.5, FOR_VARIANTS = 0.35, FOR_REFERENCE = 0.5;

static void free_models(tradeoff_study *study) {
  size_t count = study->models ? study->result->point_count * TRADEOFF_VARIANTS : 0;
  for (size_t i = 0; i < count; i++) {
    strut_model_free(study->models[i].model);
    strut_arena_free(&study->models[i].arena);
  }
}

/* The experiment of a point, cut to the periods that are wanted. */
static strut_experiment cut_experiment(const tradeoff_study *study, size_t point) {
  strut_experiment e = study->setups[point]->experiment;
  e.quantity_count = 0; /* only velocity and positions are compared */
  double most =
      study->options->periods > 0 ? study->options->periods : STRUT_TRADEOFF_USUAL_PERIODS;
  e.accuracy = 0;
  e.steady = (strut_steady){.wanted = false};
  if (e.periods > most) {
    double window = e.measure_last > 0 ? e.measure_last : e.periods;
    e.periods = most;
    e.measure_last = fmin(window, fmax(1, floor(most / 3)));
  }
  e.output_last = 0;
  e.channels = STRUT_CHANNEL_POSITION;
  return e;
}

static void measure_points(tradeoff_study *study) {
  for (size_t p = 0; p < study->result->point_count && !study->status; p++) {
    const strut_setup *setup = study->setups[p];
    const strut_model *model = NULL;
    tradeoff_point *point = &study->points[p];
    strut_span span = strut_experiment_span(&setup->experiment, &setup->scene);
    double most = span.period > 0 ? span.period : span.duration;
    study->status = strut_tradeoff_compile(study, p, 0, &model);
    if (study->status) return;
    point->experiment = cut_experiment(study, p);
    point->span = strut_experiment_span(&point->experiment, &setup->scene);
    point->longest = most / 20;
    point->size = model->size;
    point->scale = SPEED_SHARE * model->size / most;
  }
  study->result->scale = study->points[0].scale;
}

static void prepare(tradeoff_study *study, size_t count) {
  strut_tradeoff *tradeoff = study->result;
  const strut_scene *scene = &study->setups[0]->scene;
  tradeoff->name = scene->name;
  tradeoff->point_count = count;
  tradeoff->accuracy = study->options->accuracy;
  bool walks = scene->contact_count > 0 || study->setups[0]->experiment.periods > 0;
  tradeoff->measure = study->options->measure;
  if (tradeoff->measure == STRUT_TRADEOFF_AUTOMATIC)
    tradeoff->measure = walks ? STRUT_TRADEOFF_VELOCITY : STRUT_TRADEOFF_POSITION;
  tradeoff->value_count = tradeoff->measure == STRUT_TRADEOFF_POSITION ? 2 * scene->node_count : 1;
  size_t most = count > 2 * scene->node_count ? count : 2 * scene->node_count;
  if (!STRUT_ALLOCATE(&tradeoff->arena, STRUT_NEW(study->points, count),
                      STRUT_NEW(study->scratch, most), STRUT_NEW(study->spare, 2 * count),
                      STRUT_NEW(study->coarse_value, most),
                      STRUT_NEW(study->models, count * TRADEOFF_VARIANTS)))
    study->status = strut_no_memory(study->error, "");
  if (!study->status && !(strut_experiment_span(&study->setups[0]->experiment, scene).duration > 0))
    study->status = strut_fail(study->error, STRUT_USAGE,
                               "the scene has no run: add 'run' with a duration or periods");
  if (!study->status) measure_points(study);
}

/* rk4 at the scene's step, or the first method in the table that can run the scene. */
static void choose_base(tradeoff_study *study) {
  strut_tradeoff *tradeoff = study->result;
  strut_experiment e = study->points[0].experiment;
  strut_span span = study->points[0].span;
  tradeoff->periods = e.periods;
  tradeoff->duration = span.duration;
  const strut_integrator *method;
  for (size_t i = 0; (method = strut_integrator_at(i)) && !study->status; i++) {
    if (strut_tradeoff_is_adaptive(method) || !strut_tradeoff_can_run(study, method, 0)) continue;
    double step = e.step > 0 ? e.step : span.duration / 1000, limit = 0;
    if (!strut_tradeoff_limit(study, 0, method, &limit)) continue;
    bool wild = !(e.step > 0) || e.step > limit;
    if (wild && isfinite(limit)) step = 0.5 * limit;
    step = strut_tradeoff_fit_step(study, 0, step);
    study->base = study->coarse = (tradeoff_setting){method, step, (double)NAN, (double)NAN};
    study->limit = isfinite(limit) ? limit : 0;
    study->coarse.step = fmax(step, COARSE * study->limit);
    tradeoff->base_setting = study->base;
    return;
  }
  if (!study->status) study->status = study->error->status;
  if (!study->status)
    study->status = strut_fail(study->error, STRUT_USAGE, "no method can run this scene");
}

/* The coarse run, and positions as measure instead if the structure does not travel. */
static void run_coarse(tradeoff_study *study) {
  strut_tradeoff *tradeoff = study->result;
  double *value = study->coarse_value;
  tradeoff_outcome outcome = strut_tradeoff_run(study, 0, 0, study->coarse, value);
  if (outcome.cannot) study->status = study->error->status;
  bool still = tradeoff->measure == STRUT_TRADEOFF_VELOCITY &&
               fabs(value[0]) < 1e-9 * study->points[0].scale;
  if (study->status || study->options->measure != STRUT_TRADEOFF_AUTOMATIC || !still) return;
  tradeoff->measure = STRUT_TRADEOFF_POSITION;
  tradeoff->value_count = 2 * study->setups[0]->scene.node_count;
  strut_tradeoff_run(study, 0, 0, study->coarse, value);
}

/* Without an accuracy, or a reference as for energies, the scene's own run bounds the work too. */
static void make_reference(tradeoff_study *study, tradeoff_reference *reference) {
  strut_tradeoff *tradeoff = study->result;
  bool asked = tradeoff->accuracy > 0, balance = tradeoff->measure == STRUT_TRADEOFF_ENERGY;
  double target = asked ? OWN_PART * tradeoff->accuracy : OWN_FLOOR;
  double own = strut_tradeoff_planned_at_all(study, study->base);
  study->least_unit = tradeoff->work_unit = asked && !balance ? 0 : own;
  strut_tradeoff_reference_begin(study, 0, reference);
  strut_tradeoff_reference_refine(study, reference, target, HUGE_VAL);
  if (!study->status && !tradeoff->variants[0].run)
    study->status = strut_fail(study->error, STRUT_DIVERGED, "no reference solution: %s",
                               tradeoff->variants[0].remark);
  if (!asked) strut_tradeoff_reference_refine(study, reference, CHEAP_FLOOR, CHEAP * own);
}

/* Do the options not exclude the method? */
static bool is_wanted(const tradeoff_study *study, const strut_integrator *method) {
  bool wanted = study->options->method_count == 0;
  for (size_t i = 0; i < study->options->method_count; i++)
    wanted = wanted || study->options->methods[i] == method;
  return wanted;
}

static void study_own_model(tradeoff_study *study) {
  strut_tradeoff *tradeoff = study->result;
  step_series_list own = {.count = 0};
  tradeoff_reference reference;
  const strut_integrator *method;
  make_reference(study, &reference);
  for (size_t i = 0; (method = strut_integrator_at(i)); i++)
    if (is_wanted(study, method) && strut_tradeoff_can_run(study, method, 0))
      strut_tradeoff_add_method(study, &own, 0, method);
  strut_tradeoff_run_base(study, &own, FOR_BASE);
  strut_tradeoff_run_series(study, &own, tradeoff->variant_count > 1 ? 1 - FOR_VARIANTS : 1, 0.2,
                            0.6);
  for (int i = 0; i < 4 && !study->status; i++) {
    judge(study);
    if (tradeoff->accuracy > 0 || i == 3) return;
    /* a smaller floor uncovers more */
    strut_tradeoff_reference_refine(study, &reference, 0.01 * smallest_error(tradeoff),
                                    FOR_REFERENCE * tradeoff->work);
  }
}

/* Methods of the unchanged model that are cheapest at some error level. */
static size_t best_methods(const strut_tradeoff *tradeoff,
                           const strut_integrator *best[BEST_METHODS]) {
  size_t count = 0;
  for (size_t i = 0; i < strut_tradeoff_level_count(tradeoff); i++) {
    int row = best_but(tradeoff, strut_tradeoff_level(tradeoff, i), NULL);
    bool is_known = row < 0;
    for (size_t k = 0; k < count && !is_known; k++)
      is_known = best[k] == tradeoff->rows[row].setting.method;
    if (!is_known && count < BEST_METHODS) best[count++] = tradeoff->rows[row].setting.method;
  }
  return count;
}

/* Does the variant change the coarse run? */
static bool differs(tradeoff_study *study, int variant) {
  if (!strut_tradeoff_can_run(study, study->coarse.method, variant)) return true;
  tradeoff_outcome outcome = strut_tradeoff_run(study, 0, variant, study->coarse, study->scratch);
  bool different = !outcome.good;
  for (size_t i = 0; i < study->result->value_count; i++)
    different = different || study->scratch[i] != study->coarse_value[i];
  return different;
}

/* The rows of a variant whose reference is known, unless it is farther off than the accuracy. */
static void run_variant(tradeoff_study *study, const tradeoff_reference *reference, double share,
                        double from, double to) {
  strut_tradeoff *tradeoff = study->result;
  int variant = reference->variant;
  const strut_integrator *best[BEST_METHODS];
  size_t count = best_methods(tradeoff, best);
  step_series_list all = {.count = 0};
  judge(study);
  if (tradeoff->accuracy > 0 && tradeoff->variants[variant].model_spread.worst > tradeoff->accuracy)
    return;
  study->allowed = fmax(1, strut_tradeoff_work_left(study, share));
  for (size_t i = 0; i < count; i++)
    if (strut_tradeoff_can_run(study, best[i], variant))
      strut_tradeoff_add_method(study, &all, variant, best[i]);
  if (all.count == 0 && reference->method[0])
    strut_tradeoff_add_method(study, &all, variant, reference->method[0]);
  strut_tradeoff_run_series(study, &all, share, from, to);
}

static void study_variant(tradeoff_study *study, int variant, double share, double from,
                          double to) {
  strut_tradeoff *tradeoff = study->result;
  strut_model_variant *f = &tradeoff->variants[variant];
  double left = strut_tradeoff_work_left(study, share);
  double target = tradeoff->accuracy > 0 ? OTHER_PART * tradeoff->accuracy : OTHER_FLOOR;
  const char *remark = tradeoff->cut              ? STRUT_TRADEOFF_NO_TIME
                       : left <= 0                ? STRUT_TRADEOFF_NO_WORK
                       : !differs(study, variant) ? "the motion does not depend on it"
                                                  : NULL;
  if (remark) snprintf(f->remark, sizeof f->remark, "%s", remark);
  if (remark || study->status) return;
  tradeoff_reference reference;
  strut_tradeoff_reference_begin(study, variant, &reference);
  strut_tradeoff_reference_refine(study, &reference, target, 0.5 * left);
  if (!study->status && f->run) run_variant(study, &reference, share, from, to);
}

/* Order of rows: by group, coarse before fine. */
static bool before(const strut_tradeoff_row *first, const strut_tradeoff_row *second) {
  if (first->group != second->group) return first->group < second->group;
  const tradeoff_setting *a = &first->setting, *b = &second->setting;
  if (isfinite(a->tolerance) && a->tolerance != b->tolerance) return a->tolerance > b->tolerance;
  return a->step > b->step;
}

static void sort_rows(strut_tradeoff *tradeoff) {
  for (size_t i = 1; i < tradeoff->row_count; i++) {
    strut_tradeoff_row row = tradeoff->rows[i];
    size_t k = i;
    for (; k > 0 && before(&row, &tradeoff->rows[k - 1]); k--)
      tradeoff->rows[k] = tradeoff->rows[k - 1];
    tradeoff->rows[k] = row;
  }
  tradeoff->base = -1;
  for (size_t i = 0; i < tradeoff->row_count; i++)
    if (tradeoff->rows[i].base) tradeoff->base = (int)i;
}

static void make(tradeoff_study *study, size_t count) {
  strut_tradeoff *tradeoff = study->result;
  prepare(study, count);
  if (!study->status) choose_base(study);
  if (!study->status) run_coarse(study);
  if (!study->status) strut_tradeoff_list_variants(study);
  if (!study->status) study_own_model(study);
  double others = (double)(tradeoff->variant_count - 1);
  for (size_t i = 1; i < tradeoff->variant_count && !study->status; i++) {
    double begin = ((double)i - 1) / others, end = (double)i / others;
    double left =
        strut_tradeoff_work_left(study, 1) / (STRUT_TRADEOFF_MOST_WORK * tradeoff->work_unit);
    double share = 1 - left + fmax(0, left) / (double)(tradeoff->variant_count - i);
    study_variant(study, (int)i, share, 0.6 + 0.4 * begin, 0.6 + 0.4 * end);
  }
  if (study->status) return;
  judge(study);
  sort_rows(tradeoff);
  tradeoff->spent = strut_tradeoff_cpu_clock() - study->began;
}

strut_status strut_tradeoff_make(const strut_setup *const *setups, size_t count,
                                 const strut_tradeoff_options *options, strut_tradeoff *result,
                                 strut_error *error) {
  strut_error own = {0};
  *result = (strut_tradeoff){.name = "", .setups = setups};
  tradeoff_study s = {
      .setups = setups,
      .options = options,
      .result = result,
      .error = error ? error : &own,
      .began = strut_tradeoff_cpu_clock(),
      .budget = options->budget > 0 ? options->budget : STRUT_TRADEOFF_USUAL_BUDGET};
  make(&s, count);
  free_models(&s);
  return s.status;
}

void strut_tradeoff_free(strut_tradeoff *result) {
  strut_release(result->rows);
  strut_arena_free(&result->arena);
  *result = (strut_tradeoff){.name = ""};
}

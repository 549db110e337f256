/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The whole study, from the base to the Pareto front. */
#include "engine/study/tradeoff/tradeoff.h"

#include <assert.h>
#include <gsl/gsl_sort_double.h>
#include <math.h>
#include <stdio.h>

#include "engine/model/model.h"
#include "engine/study/tradeoff/tradeoff_parts.h"

/* ---- errors, spreads over the operating points, and the Pareto front ---- */

static const double levels[] = {0.02, 0.01, 0.005, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
static const double SURE = 0.1; /* an error is known where the floor is this part of it */

size_t strut_tradeoff_level_count(const strut_tradeoff *r) {
  return r->accuracy > 0 ? 1 : sizeof levels / sizeof levels[0];
}

double strut_tradeoff_level(const strut_tradeoff *r, size_t i) {
  return r->accuracy > 0 ? r->accuracy : levels[i];
}

strut_spread strut_spread_of(const double *values, size_t count, double *scratch) {
  if (count == 0) return (strut_spread){(double)NAN, (double)NAN, (double)NAN, NULL, 0};
  for (size_t i = 0; i < count; i++) scratch[i] = values[i];
  gsl_sort(scratch, 1, count);
  size_t half = count / 2, rank = (9 * count + 9) / 10;
  double median = count % 2 ? scratch[half] : 0.5 * (scratch[half - 1] + scratch[half]);
  return (strut_spread){median, scratch[rank - 1], scratch[count - 1], values, count};
}

void strut_tradeoff_judge_row(tradeoff_study *s, strut_tradeoff_row *row) {
  strut_tradeoff *r = s->result;
  const strut_model_variant *own = &r->variants[0], *f = &r->variants[row->variant];
  for (size_t p = 0; p < r->point_count; p++) {
    const double *value = row->value + p * r->value_count;
    double error = strut_tradeoff_distance(s, p, value, f->value + p * r->value_count);
    double total = strut_tradeoff_distance(s, p, value, own->value + p * r->value_count);
    row->error[p] = fmax(error, f->floor[p]);
    row->total[p] = fmax(total, own->floor[p]);
  }
  row->error_spread = strut_spread_of(row->error, r->point_count, s->scratch);
  row->total_spread = strut_spread_of(row->total, r->point_count, s->scratch);
}

/* Costs of a row: medians over the points at which it did not diverge, or else what was planned. */
static void evaluate_cost(tradeoff_study *s, strut_tradeoff_row *row,
                          const strut_tradeoff_row *base) {
  strut_tradeoff *r = s->result;
  double *ratio = s->spare, *rate = ratio + r->point_count;
  size_t count = 0;
  for (int planned = 0; planned < 2 && count == 0; planned++)
    for (size_t p = 0; p < r->point_count; p++) {
      const tradeoff_setting own = {row->method, row->step, row->tolerance, row->refine};
      double forces = planned ? strut_tradeoff_planned(s, p, own) : row->forces[p];
      double unit = base && isfinite(base->forces[p]) ? base->forces[p]
                                                      : strut_tradeoff_planned(s, p, s->base);
      if (p == 0) r->base_evaluations = unit;
      if (!isfinite(forces)) continue;
      ratio[count] = forces / unit;
      rate[count++] = forces / strut_tradeoff_span(s, p).duration;
    }
  row->evaluations = strut_spread_of(ratio, count, s->scratch).median;
  row->rate = strut_spread_of(rate, count, s->scratch).median;
  row->cpu = base ? row->seconds / base->seconds : (double)NAN;
}

static void evaluate_costs(tradeoff_study *s) {
  strut_tradeoff *r = s->result;
  const strut_tradeoff_row *base = NULL;
  for (size_t i = 0; i < r->row_count; i++)
    if (r->rows[i].base) base = &r->rows[i];
  r->base_seconds = base ? base->seconds : (double)NAN;
  for (size_t i = 0; i < r->row_count; i++) evaluate_cost(s, &r->rows[i], base);
}

static void find_fronts(strut_tradeoff *r) {
  for (size_t i = 0; i < r->row_count; i++) {
    strut_tradeoff_row *a = &r->rows[i];
    a->front = isfinite(a->error_spread.worst);
    for (size_t k = 0; k < r->row_count && a->front; k++) {
      const strut_tradeoff_row *b = &r->rows[k];
      if (b->variant != a->variant || !isfinite(b->error_spread.worst)) continue;
      bool no_worse =
          b->evaluations <= a->evaluations && b->error_spread.worst <= a->error_spread.worst;
      bool better =
          b->evaluations < a->evaluations || b->error_spread.worst < a->error_spread.worst;
      a->front = !(no_worse && better);
    }
  }
}

void strut_tradeoff_judge(tradeoff_study *s) {
  strut_tradeoff *r = s->result;
  for (size_t i = 0; i < r->variant_count; i++) {
    strut_model_variant *f = &r->variants[i];
    for (size_t p = 0; p < r->point_count && i > 0 && f->run; p++)
      f->model_error[p] = strut_tradeoff_distance(s, p, f->value + p * r->value_count,
                                                  r->variants[0].value + p * r->value_count);
    f->model_spread = strut_spread_of(f->model_error, r->point_count, s->scratch);
    f->floor_spread = strut_spread_of(f->floor, r->point_count, s->scratch);
  }
  for (size_t i = 0; i < r->row_count; i++) strut_tradeoff_judge_row(s, &r->rows[i]);
  evaluate_costs(s);
  find_fronts(r);
}

double strut_tradeoff_smallest_error(const tradeoff_study *s, int variant) {
  const strut_tradeoff *r = s->result;
  double smallest = 1;
  for (size_t i = 0; i < r->row_count; i++) {
    double worst = r->rows[i].error_spread.worst;
    if (r->rows[i].variant == variant && worst > 0 && worst < smallest) smallest = worst;
  }
  return smallest;
}

/* Is b a finer setting of the same group, or a itself? */
static bool is_finer(const strut_tradeoff_row *a, const strut_tradeoff_row *b) {
  if (a->group != b->group) return false;
  return isfinite(a->tolerance) ? b->tolerance <= a->tolerance : b->step <= a->step;
}

double strut_tradeoff_promise(const strut_tradeoff *r, int row) {
  double most = 0;
  for (size_t k = 0; k < r->row_count; k++)
    if (is_finer(&r->rows[row], &r->rows[k])) most = fmax(most, r->rows[k].total_spread.worst);
  return most;
}

static bool is_confirmed(const strut_tradeoff *r, const strut_tradeoff_row *row) {
  bool finer = false;
  for (size_t k = 0; k < r->row_count; k++)
    finer = finer || (&r->rows[k] != row && is_finer(row, &r->rows[k]));
  return finer;
}

/* The cheapest confirmed row that keeps a level, of any method but one. */
static int best_but(const strut_tradeoff *r, int variant, double level,
                    const strut_integrator *excluded) {
  int best = -1;
  for (size_t i = 0; i < r->row_count; i++) {
    const strut_tradeoff_row *row = &r->rows[i];
    if (row->variant != variant || row->method == excluded || row->above) continue;
    if (!is_confirmed(r, row) || !(strut_tradeoff_promise(r, (int)i) <= level)) continue;
    if (best < 0 || row->evaluations < r->rows[best].evaluations) best = (int)i;
  }
  return best;
}

int strut_tradeoff_best(const strut_tradeoff *r, int variant, double level) {
  return best_but(r, variant, level, NULL);
}

/*
 * Cost of an error between a row that keeps it and the next coarser one of its group, on a line of
 * logarithms.
 */
static double interpolate_cost(const strut_tradeoff *r, int row, double error) {
  const strut_tradeoff_row *fine = &r->rows[row], *coarse = NULL;
  for (size_t i = 0; i < r->row_count; i++) {
    const strut_tradeoff_row *other = &r->rows[i];
    if (other == fine || !is_finer(other, fine)) continue;
    if (!coarse || is_finer(coarse, other)) coarse = other;
  }
  double high = coarse ? strut_tradeoff_promise(r, (int)(coarse - r->rows)) : HUGE_VAL;
  double low = strut_tradeoff_promise(r, row);
  if (!isfinite(high) || !(high > low)) return fine->evaluations;
  double part = log(high / error) / log(high / low);
  return coarse->evaluations * pow(fine->evaluations / coarse->evaluations, part);
}

strut_tradeoff_advice strut_tradeoff_advise(const strut_tradeoff *r, double error) {
  strut_tradeoff_advice a = {.error = error, .cost = (double)NAN};
  a.known = r->variants[0].floor_spread.worst <= SURE * 0.5 * error;
  a.row = a.known ? strut_tradeoff_best(r, 0, error) : -1;
  a.half = a.row < 0 ? -1 : strut_tradeoff_best(r, 0, 0.5 * error);
  a.other = a.row < 0 ? -1 : best_but(r, 0, error, r->rows[a.row].method);
  if (a.half >= 0)
    a.cost = a.half == a.row
                 ? 1
                 : fmax(1, interpolate_cost(r, a.half, 0.5 * error) / r->rows[a.row].evaluations);
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

static strut_status out_of_memory(tradeoff_study *s) { return strut_no_memory(s->error, ""); }

strut_status strut_tradeoff_compile(const tradeoff_study *s, size_t point, int variant,
                                    const strut_model **model) {
  assert(point < s->result->point_count && variant >= 0 && variant < TRADEOFF_VARIANTS);
  tradeoff_model *m = &s->models[point * TRADEOFF_VARIANTS + (size_t)variant];
  strut_status status = STRUT_OK;
  if (!m->model) {
    m->scene = s->setups[point]->scene;
    status = strut_tradeoff_change_scene(s, variant, &m->scene, &m->arena)
                 ? strut_no_memory(s->error, "")
                 : strut_model_compile(&m->scene, &m->model, s->error);
  }
  *model = m->model;
  return status;
}

static void free_models(tradeoff_study *s) {
  size_t count = s->models ? s->result->point_count * TRADEOFF_VARIANTS : 0;
  for (size_t i = 0; i < count; i++) {
    strut_model_free(s->models[i].model);
    strut_arena_free(&s->models[i].arena);
  }
  strut_release(s->models);
}

static strut_tradeoff_measure choose_measure(const strut_setup *setup, strut_tradeoff_measure m) {
  if (m != STRUT_TRADEOFF_AUTOMATIC) return m;
  bool walks = setup->scene.contact_count > 0 || setup->experiment.periods > 0;
  return walks ? STRUT_TRADEOFF_VELOCITY : STRUT_TRADEOFF_POSITION;
}

static strut_status measure_points(tradeoff_study *s) {
  for (size_t p = 0; p < s->result->point_count; p++) {
    const strut_setup *setup = s->setups[p];
    const strut_model *model = NULL;
    strut_status status = strut_tradeoff_compile(s, p, 0, &model);
    if (status != STRUT_OK) return status;
    strut_span span = strut_experiment_span(&setup->experiment, &setup->scene);
    s->size[p] = model->size;
    s->scale[p] = SPEED_SHARE * model->size / (span.period > 0 ? span.period : span.duration);
  }
  return STRUT_OK;
}

static strut_status prepare(tradeoff_study *s, size_t count) {
  strut_tradeoff *r = s->result;
  const strut_scene *scene = &s->setups[0]->scene;
  r->name = scene->name;
  r->point_count = count;
  r->accuracy = s->options->accuracy;
  r->measure = choose_measure(s->setups[0], s->options->measure);
  r->value_count = r->measure == STRUT_TRADEOFF_POSITION ? 2 * scene->node_count : 1;
  size_t most = count > 2 * scene->node_count ? count : 2 * scene->node_count;
  s->size = strut_arena_allocate(&r->arena, count, sizeof *s->size);
  s->scale = strut_arena_allocate(&r->arena, count, sizeof *s->scale);
  s->scratch = strut_arena_allocate(&r->arena, most, sizeof *s->scratch);
  s->spare = strut_arena_allocate(&r->arena, 2 * count, sizeof *s->spare);
  s->coarse_value = strut_arena_allocate(&r->arena, most, sizeof *s->coarse_value);
  s->models = strut_allocate(count * TRADEOFF_VARIANTS, sizeof *s->models);
  if (!s->models || !s->size || !s->scale || !s->scratch || !s->spare || !s->coarse_value)
    return out_of_memory(s);
  if (!(strut_experiment_span(&s->setups[0]->experiment, scene).duration > 0))
    return strut_fail(s->error, STRUT_USAGE,
                      "the scene has no run: add 'run' with a duration or periods");
  strut_status status = measure_points(s);
  if (status != STRUT_OK) return status;
  r->scale = s->scale[0];
  return STRUT_OK;
}

/* rk4 at the scene's step, or the first method in the table that can run the scene. */
static strut_status choose_base(tradeoff_study *s) {
  strut_tradeoff *r = s->result;
  strut_experiment e = strut_tradeoff_experiment(s, 0);
  strut_span span = strut_tradeoff_span(s, 0);
  r->periods = e.periods;
  r->duration = span.duration;
  for (size_t i = 0; strut_integrator_at(i); i++) {
    const strut_integrator *method = strut_integrator_at(i);
    if (strut_tradeoff_is_adaptive(method) || !strut_tradeoff_can_run(s, method, 0)) continue;
    double step = e.step > 0 ? e.step : span.duration / 1000, limit = 0;
    bool cannot = false;
    strut_status status = strut_tradeoff_limit(s, 0, method, &limit, &cannot);
    if (status != STRUT_OK) return status;
    if (cannot) continue;
    bool wild = !(e.step > 0) || e.step > limit;
    if (wild && isfinite(limit)) step = 0.5 * limit;
    step = strut_tradeoff_fit_step(s, 0, step);
    s->base = s->coarse = (tradeoff_setting){method, step, (double)NAN, (double)NAN};
    s->limit = isfinite(limit) ? limit : 0;
    s->coarse.step = fmax(step, COARSE * s->limit);
    r->base_method = method;
    r->base_step = step;
    return STRUT_OK;
  }
  return s->error->status != STRUT_OK
             ? s->error->status
             : strut_fail(s->error, STRUT_USAGE, "no method can run this scene");
}

/* The coarse run, and positions as measure instead if the structure does not travel. */
static strut_status run_coarse(tradeoff_study *s) {
  strut_tradeoff *r = s->result;
  tradeoff_outcome outcome;
  double *value = s->coarse_value;
  strut_status status = strut_tradeoff_run(s, 0, 0, s->coarse, value, &outcome);
  if (status != STRUT_OK) return status;
  if (outcome.cannot) return s->error->status;
  bool still = r->measure == STRUT_TRADEOFF_VELOCITY && fabs(value[0]) < 1e-9 * s->scale[0];
  if (s->options->measure != STRUT_TRADEOFF_AUTOMATIC || !still) return STRUT_OK;
  r->measure = STRUT_TRADEOFF_POSITION;
  r->value_count = 2 * s->setups[0]->scene.node_count;
  return strut_tradeoff_run(s, 0, 0, s->coarse, value, &outcome);
}

/* Without an accuracy, or a reference as for energies, the scene's own run bounds the work too. */
static strut_status make_reference(tradeoff_study *s, tradeoff_reference *reference) {
  strut_tradeoff *r = s->result;
  bool asked = r->accuracy > 0, balance = r->measure == STRUT_TRADEOFF_ENERGY;
  double target = asked ? OWN_PART * r->accuracy : OWN_FLOOR, own = 0;
  for (size_t p = 0; p < r->point_count; p++) own += strut_tradeoff_planned(s, p, s->base);
  s->least_unit = r->work_unit = asked && !balance ? 0 : own;
  strut_status status = strut_tradeoff_reference_begin(s, 0, reference);
  if (status == STRUT_OK) status = strut_tradeoff_reference_refine(s, reference, target, HUGE_VAL);
  if (status == STRUT_OK && !r->variants[0].run)
    status =
        strut_fail(s->error, STRUT_DIVERGED, "no reference solution: %s", r->variants[0].remark);
  if (status == STRUT_OK && !asked)
    status = strut_tradeoff_reference_refine(s, reference, CHEAP_FLOOR, CHEAP * own);
  return status;
}

static strut_status study_own_model(tradeoff_study *s, step_series_list *own) {
  strut_tradeoff *r = s->result;
  tradeoff_reference reference;
  strut_status status = make_reference(s, &reference);
  for (size_t i = 0; strut_integrator_at(i) && status == STRUT_OK; i++)
    if (strut_tradeoff_is_wanted(s, strut_integrator_at(i), 0))
      status = strut_tradeoff_add_method(s, own, 0, strut_integrator_at(i));
  double share = r->variant_count > 1 ? 1 - FOR_VARIANTS : 1;
  if (status == STRUT_OK) status = strut_tradeoff_run_base(s, own, FOR_BASE);
  if (status == STRUT_OK) status = strut_tradeoff_run_series(s, own, share, 0.2, 0.6);
  strut_tradeoff_judge(s);
  for (int i = 0; i < 3 && status == STRUT_OK && !(r->accuracy > 0); i++) {
    double target = 0.01 * strut_tradeoff_smallest_error(s, 0); /* a smaller floor uncovers more */
    status = strut_tradeoff_reference_refine(s, &reference, target, FOR_REFERENCE * r->work);
    strut_tradeoff_judge(s);
  }
  return status;
}

/* Methods of the unchanged model that are cheapest at some error level. */
static size_t best_methods(const strut_tradeoff *r, const strut_integrator *best[BEST_METHODS]) {
  size_t count = 0;
  for (size_t i = 0; i < strut_tradeoff_level_count(r); i++) {
    int row = strut_tradeoff_best(r, 0, strut_tradeoff_level(r, i));
    bool is_known = row < 0;
    for (size_t k = 0; k < count && !is_known; k++) is_known = best[k] == r->rows[row].method;
    if (!is_known && count < BEST_METHODS) best[count++] = r->rows[row].method;
  }
  return count;
}

/* Does the variant change the coarse run? */
static strut_status differs(tradeoff_study *s, int variant, bool *different) {
  const strut_tradeoff *r = s->result;
  tradeoff_outcome outcome;
  *different = true;
  if (!strut_tradeoff_can_run(s, s->coarse.method, variant)) return STRUT_OK;
  strut_status status = strut_tradeoff_run(s, 0, variant, s->coarse, s->scratch, &outcome);
  if (status != STRUT_OK || outcome.cannot || outcome.status != STRUT_OK) return status;
  *different = false;
  for (size_t i = 0; i < r->value_count; i++)
    if (s->scratch[i] != s->coarse_value[i]) *different = true;
  return STRUT_OK;
}

/* The rows of a variant whose reference is known, unless it is farther off than the accuracy. */
static strut_status run_variant(tradeoff_study *s, const tradeoff_reference *reference,
                                double share, double from, double to) {
  strut_tradeoff *r = s->result;
  int variant = reference->variant;
  const strut_integrator *best[BEST_METHODS];
  size_t count = best_methods(r, best);
  step_series_list all = {.count = 0};
  strut_status status = STRUT_OK;
  strut_tradeoff_judge(s);
  if (r->accuracy > 0 && r->variants[variant].model_spread.worst > r->accuracy) return STRUT_OK;
  s->allowed = fmax(1, strut_tradeoff_work_left(s, share));
  for (size_t i = 0; i < count && status == STRUT_OK; i++)
    if (strut_tradeoff_can_run(s, best[i], variant))
      status = strut_tradeoff_add_method(s, &all, variant, best[i]);
  if (status == STRUT_OK && all.count == 0 && reference->method[0])
    status = strut_tradeoff_add_method(s, &all, variant, reference->method[0]);
  return status == STRUT_OK ? strut_tradeoff_run_series(s, &all, share, from, to) : status;
}

static strut_status study_variant(tradeoff_study *s, int variant, double share, double from,
                                  double to) {
  strut_tradeoff *r = s->result;
  strut_model_variant *f = &r->variants[variant];
  double left = strut_tradeoff_work_left(s, share);
  double target = r->accuracy > 0 ? OTHER_PART * r->accuracy : OTHER_FLOOR;
  if (left <= 0 || r->cut) {
    snprintf(f->remark, sizeof f->remark, "%s",
             r->cut ? STRUT_TRADEOFF_NO_TIME : STRUT_TRADEOFF_NO_WORK);
    return STRUT_OK;
  }
  tradeoff_reference reference;
  bool different = true;
  strut_status status = differs(s, variant, &different);
  if (status == STRUT_OK && !different)
    snprintf(f->remark, sizeof f->remark, "the motion does not depend on it");
  if (status != STRUT_OK || !different) return status;
  status = strut_tradeoff_reference_begin(s, variant, &reference);
  if (status == STRUT_OK)
    status = strut_tradeoff_reference_refine(s, &reference, target, 0.5 * left);
  if (status != STRUT_OK || !f->run) return status;
  return run_variant(s, &reference, share, from, to);
}

/* Order of rows: by group, coarse before fine. */
static bool before(const strut_tradeoff_row *a, const strut_tradeoff_row *b) {
  if (a->group != b->group) return a->group < b->group;
  if (isfinite(a->tolerance) && a->tolerance != b->tolerance) return a->tolerance > b->tolerance;
  return a->step > b->step;
}

static void sort_rows(strut_tradeoff *r) {
  for (size_t i = 1; i < r->row_count; i++) {
    strut_tradeoff_row row = r->rows[i];
    size_t k = i;
    for (; k > 0 && before(&row, &r->rows[k - 1]); k--) r->rows[k] = r->rows[k - 1];
    r->rows[k] = row;
  }
  r->base = -1;
  for (size_t i = 0; i < r->row_count; i++)
    if (r->rows[i].base) r->base = (int)i;
}

static strut_status make(tradeoff_study *s, size_t count) {
  strut_tradeoff *r = s->result;
  step_series_list own = {.count = 0};
  strut_status status = prepare(s, count);
  if (status == STRUT_OK) status = choose_base(s);
  if (status == STRUT_OK) status = run_coarse(s);
  if (status == STRUT_OK && strut_tradeoff_list_variants(s) != STRUT_OK) status = out_of_memory(s);
  if (status == STRUT_OK) status = study_own_model(s, &own);
  double others = (double)(r->variant_count - 1);
  for (size_t i = 1; i < r->variant_count && status == STRUT_OK; i++) {
    double begin = ((double)i - 1) / others, end = (double)i / others;
    double left = strut_tradeoff_work_left(s, 1) / (STRUT_TRADEOFF_MOST_WORK * r->work_unit);
    double share = 1 - left + fmax(0, left) / (double)(r->variant_count - i); /* shared evenly */
    status = study_variant(s, (int)i, share, 0.6 + 0.4 * begin, 0.6 + 0.4 * end);
  }
  if (status != STRUT_OK) return status;
  strut_tradeoff_judge(s);
  sort_rows(r);
  r->spent = strut_tradeoff_cpu_clock() - s->began;
  return STRUT_OK;
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
  strut_status status = make(&s, count);
  free_models(&s);
  return status;
}

void strut_tradeoff_free(strut_tradeoff *result) {
  strut_arena_free(&result->arena);
  *result = (strut_tradeoff){.name = ""};
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The order of things: the base, the references, the ladders, other models. */
#include "engine/study/tradeoff/tradeoff.h"

#include <math.h>
#include <stdio.h>

#include "engine/model/model.h"
#include "engine/study/tradeoff/step_refinement.h"

enum { BEST_METHODS = 2 };
static const double USUAL_BUDGET = 120, FIRST_TARGET = 1e-4, SPEED_SHARE = 1e-3; /* [s], [1], [1] */
/* Of the budget: the own references, the own rows, their refinement; other models have the rest. */
static const double OWN_REFERENCE = 0.3, OWN_ROWS = 0.6, OWN_REFINED = 0.75;

static strut_status out_of_memory(study *s) {
  return strut_fail(s->error, STRUT_NO_MEMORY, "out of memory");
}

static strut_tradeoff_measure choose_measure(const strut_setup *setup, strut_tradeoff_measure m) {
  if (m != STRUT_TRADEOFF_AUTOMATIC) return m;
  bool walks = setup->scene.contact_count > 0 || setup->experiment.periods > 0;
  return walks ? STRUT_TRADEOFF_VELOCITY : STRUT_TRADEOFF_POSITION;
}

static strut_status measure_points(study *s) {
  for (size_t p = 0; p < s->result->point_count; p++) {
    const strut_model *model = NULL;
    strut_status status = strut_study_model(s, p, 0, &model);
    if (status != STRUT_OK) return status;
    const strut_setup *setup = s->setups[p];
    strut_span span = strut_experiment_span(&setup->experiment, &setup->scene);
    s->size[p] = model->size;
    s->scale[p] = SPEED_SHARE * model->size / (span.period > 0 ? span.period : span.duration);
  }
  return STRUT_OK;
}

static strut_status prepare(study *s, size_t count) {
  strut_tradeoff *r = s->result;
  const strut_scene *scene = &s->setups[0]->scene;
  r->name = scene->name;
  r->point_count = count;
  r->measure = choose_measure(s->setups[0], s->options->measure);
  r->value_count = r->measure == STRUT_TRADEOFF_POSITION ? 2 * scene->node_count : 1;
  size_t most = count > 2 * scene->node_count ? count : 2 * scene->node_count;
  s->size = strut_arena_allocate(&r->arena, count, sizeof *s->size);
  s->scale = strut_arena_allocate(&r->arena, count, sizeof *s->scale);
  s->base_evaluations = strut_arena_allocate(&r->arena, count, sizeof *s->base_evaluations);
  s->base_seconds = strut_arena_allocate(&r->arena, count, sizeof *s->base_seconds);
  s->base_timed = strut_arena_allocate(&r->arena, count, sizeof *s->base_timed);
  s->scratch = strut_arena_allocate(&r->arena, most, sizeof *s->scratch);
  s->variants = strut_allocate(count * STRUT_STUDY_VARIANTS, sizeof *s->variants);
  if (!s->variants || !s->size || !s->scale || !s->base_evaluations || !s->base_seconds ||
      !s->base_timed || !s->scratch)
    return out_of_memory(s);
  if (!(strut_experiment_span(&s->setups[0]->experiment, scene).duration > 0))
    return strut_fail(s->error, STRUT_USAGE,
                      "the scene has no run to compare: it needs 'run' with a duration or periods");
  strut_status status = measure_points(s);
  if (status != STRUT_OK) return status;
  r->scale = s->scale[0];
  return STRUT_OK;
}

/* What stays where it is, or only goes up and down, has no velocity to be measured by. */
static void look_elsewhere(study *s) {
  strut_tradeoff *r = s->result;
  bool still = r->measure == STRUT_TRADEOFF_VELOCITY && fabs(s->scratch[0]) < 1e-9 * s->scale[0];
  if (s->options->measure != STRUT_TRADEOFF_AUTOMATIC || !still) return;
  r->measure = STRUT_TRADEOFF_POSITION;
  r->value_count = 2 * s->setups[0]->scene.node_count;
}

/* rk4 at the scene's step, or the first method in the table that can run the scene. */
static strut_status choose_base(study *s) {
  strut_tradeoff *r = s->result;
  study_outcome outcome = {0};
  strut_status status = STRUT_OK;
  strut_experiment e = strut_study_experiment(s, 0);
  strut_span span = strut_study_span(s, 0);
  r->periods = e.periods;
  r->duration = span.duration;
  for (size_t i = 0; strut_integrator_at(i); i++) {
    const strut_integrator *method = strut_integrator_at(i);
    if (strut_study_adaptive(method) || !strut_study_able(s, method, 0)) continue;
    double step = e.step > 0 ? e.step : span.duration / 1000;
    s->base = (study_setting){method, step, (double)NAN, 1};
    status = strut_study_probe(s, 0, s->base, &outcome);
    if (status != STRUT_OK) return status;
    if (outcome.cannot) continue;
    bool wild = !(e.step > 0) || e.step > outcome.step_limit;
    if (wild && isfinite(outcome.step_limit)) s->base.step = 0.5 * outcome.step_limit;
    s->base.step = strut_study_fit(s, 0, s->base.step);
    s->base.refine = (double)NAN;
    s->limit = isfinite(outcome.step_limit) ? outcome.step_limit : 0;
    return STRUT_OK;
  }
  return s->error->status != STRUT_OK
             ? s->error->status
             : strut_fail(s->error, STRUT_USAGE, "no method can run this scene");
}

static strut_status run_base(study *s, study_ladders *own) {
  strut_tradeoff *r = s->result;
  study_ladder alone = {.group = -1, .first = s->base}, *in = &alone;
  for (size_t i = own->count; i-- > 0;)
    if (own->at[i].first.method == s->base.method && !isfinite(own->at[i].first.refine))
      in = &own->at[i];
  if (in == &alone) alone.group = (int)r->group_count++;
  for (size_t p = 0; p < r->point_count; p++)
    s->base_evaluations[p] =
        strut_study_span(s, p).duration / s->base.step * s->base.method->evaluations;
  bool cannot = false;
  strut_status status = strut_study_run_row(s, in, s->base, true, &cannot);
  in->last_cost = 0;
  if (status != STRUT_OK) return status;
  if (cannot || r->row_count == 0) return s->error->status;
  r->base_evaluations = (int64_t)s->base_evaluations[0];
  r->base_seconds = r->rows[0].seconds;
  return STRUT_OK;
}

static strut_status own_model(study *s, study_ladders *own) {
  study_reference reference;
  strut_status status = STRUT_OK;
  for (size_t i = 0; strut_integrator_at(i) && status == STRUT_OK; i++)
    if (strut_study_allowed(s, strut_integrator_at(i), 0))
      status = strut_study_add_method(s, own, 0, strut_integrator_at(i));
  if (status == STRUT_OK) status = run_base(s, own);
  if (status == STRUT_OK) status = strut_study_reference_begin(s, 0, &reference);
  if (status == STRUT_OK)
    status = strut_study_reference_refine(s, &reference, FIRST_TARGET, OWN_REFERENCE);
  if (status != STRUT_OK) return status;
  if (!s->result->fidelities[0].run)
    return strut_fail(s->error, STRUT_DIVERGED, "there is no reference: %s",
                      s->result->fidelities[0].remark);
  status = strut_study_climb(s, own, OWN_ROWS, 0.2, 0.6);
  strut_study_judge(s);
  for (int i = 0; i < 3 && status == STRUT_OK; i++) { /* a smaller floor uncovers smaller errors */
    double target = 0.01 * strut_study_smallest(s, 0);
    status = strut_study_reference_refine(s, &reference, target, OWN_REFINED);
    strut_study_judge(s);
  }
  return status;
}

/* The methods of the own model's best bargains, the cheapest for each level first. */
static size_t best_methods(const strut_tradeoff *r, const strut_integrator *best[BEST_METHODS]) {
  size_t count = 0;
  for (int i = 0; i < STRUT_TRADEOFF_LEVELS; i++) {
    int row = strut_tradeoff_best(r, 0, strut_tradeoff_level(i));
    bool known = row < 0;
    for (size_t k = 0; k < count && !known; k++) known = best[k] == r->rows[row].method;
    if (!known && count < BEST_METHODS) best[count++] = r->rows[row].method;
  }
  return count;
}

/* Whether the base's run at the first point is another one in another model. */
static strut_status differs(study *s, int fidelity, bool *different) {
  const strut_tradeoff *r = s->result;
  study_outcome outcome;
  *different = true;
  if (!strut_study_able(s, s->base.method, fidelity)) return STRUT_OK;
  strut_status status = strut_study_probe(s, fidelity, s->base, &outcome);
  if (status != STRUT_OK || outcome.cannot || outcome.status != STRUT_OK) return status;
  *different = false;
  for (size_t i = 0; i < r->value_count; i++)
    if (s->scratch[i] != r->rows[r->base].value[i]) *different = true;
  return STRUT_OK;
}

static strut_status other_model(study *s, int fidelity, double share, double from, double to) {
  strut_tradeoff *r = s->result;
  const strut_integrator *best[BEST_METHODS];
  size_t count = best_methods(r, best);
  double before = strut_study_left(s, share);
  if (before <= 0) {
    snprintf(r->fidelities[fidelity].remark, sizeof r->fidelities[fidelity].remark,
             "the budget did not suffice");
    return STRUT_OK;
  }
  study_reference reference;
  study_ladders all = {.count = 0};
  bool different = true;
  strut_status status = differs(s, fidelity, &different);
  if (status == STRUT_OK && !different)
    snprintf(r->fidelities[fidelity].remark, sizeof r->fidelities[fidelity].remark,
             "the motion does not depend on it");
  if (status != STRUT_OK || !different) return status;
  status = strut_study_reference_begin(s, fidelity, &reference);
  if (status == STRUT_OK)
    status = strut_study_reference_refine(s, &reference, FIRST_TARGET,
                                          share - 0.5 * fmax(0, before) / s->budget);
  for (size_t i = 0; i < count && status == STRUT_OK && r->fidelities[fidelity].run; i++)
    if (strut_study_able(s, best[i], fidelity))
      status = strut_study_add_method(s, &all, fidelity, best[i]);
  if (status == STRUT_OK && all.count == 0 && r->fidelities[fidelity].run && reference.method[0])
    status = strut_study_add_method(s, &all, fidelity, reference.method[0]);
  if (status == STRUT_OK) status = strut_study_climb(s, &all, share, from, to);
  return status;
}

/* By group, coarse before fine. */
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
  for (size_t i = 0; i < r->row_count; i++)
    if (r->rows[i].base) r->base = i;
}

static strut_status make(study *s, size_t count) {
  strut_tradeoff *r = s->result;
  study_ladders own = {.count = 0};
  strut_status status = prepare(s, count);
  if (status == STRUT_OK) status = choose_base(s);
  if (status == STRUT_OK) look_elsewhere(s);
  if (status == STRUT_OK && strut_study_list_fidelities(s) != STRUT_OK) status = out_of_memory(s);
  if (status == STRUT_OK) status = own_model(s, &own);
  double others = (double)(r->fidelity_count - 1);
  for (size_t i = 1; i < r->fidelity_count && status == STRUT_OK; i++) {
    double begin = ((double)i - 1) / others, end = (double)i / others;
    double spent = 1 - strut_study_left(s, 1) / s->budget; /* what is left goes to all alike */
    double share = spent + fmax(0, 1 - spent) / (double)(r->fidelity_count - i);
    status = other_model(s, (int)i, share, 0.6 + 0.4 * begin, 0.6 + 0.4 * end);
  }
  if (status != STRUT_OK) return status;
  strut_study_judge(s);
  sort_rows(r);
  r->spent = strut_study_clock() - s->began;
  return STRUT_OK;
}

strut_status strut_tradeoff_make(const strut_setup *const *setups, size_t count,
                                 const strut_tradeoff_options *options, strut_tradeoff *result,
                                 strut_error *error) {
  strut_error own = {0};
  *result = (strut_tradeoff){.name = ""};
  study s = {.setups = setups,
             .options = options,
             .result = result,
             .error = error ? error : &own,
             .began = strut_study_clock(),
             .budget = options->budget > 0 ? options->budget : USUAL_BUDGET};
  strut_status status = make(&s, count);
  strut_study_free_models(&s);
  return status;
}

void strut_tradeoff_free(strut_tradeoff *result) {
  strut_arena_free(&result->arena);
  *result = (strut_tradeoff){.name = ""};
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The order of things: the base, the references, ladders of steps from coarse to fine. */
#include "engine/study/tradeoff.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/model/model.h"
#include "engine/study/tradeoff_parts.h"

enum { USUAL_STEPS = 8, USUAL_REPEATS = 5, MOST_GROUPS = 64, ABOVE = 3, BEST_METHODS = 2 };
static const double USUAL_BUDGET = 120, FIRST_TARGET = 1e-4, SHORT = 0.05; /* [s], [1], [s] */
static const double BELOW = 0.95, IN_DECADE = 5, SPEED_SHARE = 1e-3;
static const double above[ABOVE] = {2.5, 1.5, 1.1};
/* Of the budget: the own references, the own rows, their refinement; other models have the rest. */
static const double OWN_REFERENCE = 0.3, OWN_ROWS = 0.6, OWN_REFINED = 0.75;

/* Settings that differ by their step alone. */
typedef struct ladder {
  int fidelity, group;
  study_setting first; /* its step is the method's limit */
  bool limited;        /* there is one */
  double last_cost;    /* CPU time of the latest row [s]; 0: none yet */
  bool over;           /* the budget does not suffice for the next */
} ladder;

typedef struct ladders {
  ladder at[MOST_GROUPS];
  size_t count;
} ladders;

static int step_count(const study *s) {
  return s->options->steps > 0 ? s->options->steps : USUAL_STEPS;
}

static void tell(const study *s, double fraction) {
  if (s->options->progress) s->options->progress(s->options->progress_context, fraction);
}

static strut_status out_of_memory(study *s) {
  return strut_fail(s->error, STRUT_NO_MEMORY, "out of memory");
}

/* ---- rows ---- */

static strut_tradeoff_row *new_row(study *s, const ladder *from, study_setting setting) {
  strut_tradeoff *r = s->result;
  if (r->row_count == s->row_room) {
    size_t room = s->row_room ? 2 * s->row_room : 64;
    strut_tradeoff_row *rows = strut_arena_allocate(&r->arena, room, sizeof *rows);
    if (!rows) return NULL;
    for (size_t i = 0; i < r->row_count; i++) rows[i] = r->rows[i];
    r->rows = rows;
    s->row_room = room;
  }
  strut_tradeoff_row *row = &r->rows[r->row_count];
  *row = (strut_tradeoff_row){.fidelity = from->fidelity,
                              .group = from->group,
                              .method = setting.method,
                              .step = strut_study_fit(s, 0, setting.step),
                              .tolerance = setting.tolerance,
                              .refine = setting.refine,
                              .cpu = (double)NAN,
                              .seconds = (double)NAN};
  row->value = strut_arena_allocate(&r->arena, r->point_count * r->value_count, sizeof(double));
  row->error = strut_arena_allocate(&r->arena, r->point_count, sizeof(double));
  row->total = strut_arena_allocate(&r->arena, r->point_count, sizeof(double));
  if (!row->value || !row->error || !row->total) return NULL;
  r->row_count++;
  return row;
}

enum { MOST_TIMES = 64 };

/* CPU times of a setting and of the base, in turn. */
typedef struct timing {
  double own[MOST_TIMES], ratio[MOST_TIMES];
  size_t count;
} timing;

static strut_status time_point(study *s, const strut_tradeoff_row *row, study_setting setting,
                               size_t p, double seconds, timing *times) {
  size_t repeats = (size_t)(s->options->repeats > 0 ? s->options->repeats : USUAL_REPEATS);
  size_t points = s->result->point_count < repeats ? s->result->point_count : repeats;
  size_t here = seconds > SHORT ? 1 : (repeats + points - 1) / points;
  study_outcome outcome, base;
  double *value = s->scratch;
  for (size_t i = 0; i < here && p < points && times->count < MOST_TIMES; i++) {
    strut_status status = strut_study_run(s, p, 0, s->base, value, &base);
    if (status == STRUT_OK && i > 0)
      status = strut_study_run(s, p, row->fidelity, setting, value, &outcome);
    if (status != STRUT_OK) return status;
    if (i > 0) seconds = outcome.seconds;
    times->own[times->count] = seconds;
    times->ratio[times->count] = base.status == STRUT_OK ? seconds / base.seconds : (double)NAN;
    times->count++;
  }
  return STRUT_OK;
}

/* Evaluations that a row would need if it did not diverge, over those of the base. */
static double planned(const study *s, const strut_tradeoff_row *row) {
  return s->base.step / row->step * row->method->evaluations / s->base.method->evaluations;
}

static void cost_row(study *s, strut_tradeoff_row *row, double *ratios, size_t count,
                     const timing *times) {
  row->evaluations = count ? strut_spread_of(ratios, count, s->scratch).median : planned(s, row);
  if (times->count == 0) return;
  double sorted[MOST_TIMES];
  row->seconds = strut_spread_of(times->own, times->count, sorted).median;
  row->cpu = strut_spread_of(times->ratio, times->count, sorted).median;
}

/* Runs a setting at every point. Where its method cannot, the row is taken back. */
static strut_status run_row(study *s, ladder *from, study_setting setting, bool base,
                            bool *cannot) {
  strut_tradeoff *r = s->result;
  double began = strut_study_clock();
  strut_tradeoff_row *row = new_row(s, from, setting);
  double *ratios = strut_arena_allocate(&r->arena, r->point_count, sizeof *ratios);
  if (!row || !ratios) return out_of_memory(s);
  timing times = {.count = 0};
  size_t finished = 0;
  strut_status status = STRUT_OK;
  *cannot = false;
  for (size_t p = 0; p < r->point_count; p++) {
    study_outcome outcome;
    status = strut_study_run(s, p, row->fidelity, setting, row->value + p * r->value_count,
                             &outcome);
    if (status != STRUT_OK) return status;
    *cannot = outcome.cannot;
    if (outcome.cannot) break;
    if (outcome.status != STRUT_OK) row->diverged++;
    if (outcome.status != STRUT_OK) continue;
    if (base) s->base_evaluations[p] = (double)outcome.evaluations;
    ratios[finished++] = (double)outcome.evaluations / s->base_evaluations[p];
    status = time_point(s, row, setting, p, outcome.seconds, &times);
    if (status != STRUT_OK) return status;
  }
  cost_row(s, row, ratios, finished, &times);
  row->base = base;
  if (*cannot) r->row_count--;
  from->last_cost = strut_study_clock() - began;
  return STRUT_OK;
}

/* ---- ladders ---- */

/* The k-th setting of a ladder, the coarsest first. False after the last. */
static bool setting_at(const study *s, const ladder *l, int k, study_setting *setting) {
  int extra = l->limited ? ABOVE : 0;
  if (k >= step_count(s) + extra) return false;
  *setting = l->first;
  if (strut_study_adaptive(l->first.method))
    setting->tolerance = 1e-2 * pow(0.1, k);
  else if (k < extra)
    setting->step *= above[k];
  else
    setting->step *= BELOW * pow(10, -(k - extra) / IN_DECADE);
  return true;
}

static strut_status probe(const study *s, int fidelity, study_setting setting,
                          study_outcome *outcome) {
  return strut_study_run(s, 0, fidelity, setting, s->scratch, outcome);
}

static ladder *add_ladder(study *s, ladders *all, int fidelity, study_setting first, bool limited) {
  if (all->count == MOST_GROUPS) return NULL;
  ladder *l = &all->at[all->count++];
  *l = (ladder){.fidelity = fidelity,
                .group = (int)s->result->group_count++,
                .first = first,
                .limited = limited};
  return l;
}

/* Ladders of one method: one for each way to refine that makes a difference in this scene. */
static strut_status add_method(study *s, ladders *all, int fidelity,
                               const strut_integrator *method) {
  study_outcome outcome, refined;
  study_setting first = {method, s->base.step, (double)NAN, 1};
  bool adaptive = strut_study_adaptive(method);
  if (adaptive) first.step = fmax(10 * first.step, s->limit), first.tolerance = 1e-2;
  strut_status status = probe(s, fidelity, first, &outcome);
  if (status != STRUT_OK || outcome.cannot) return status;
  bool limited = !adaptive && isfinite(outcome.step_limit) && outcome.step_limit > 0;
  if (limited) first.step = outcome.step_limit;
  if (!limited && !adaptive) first.step *= 10;
  study_setting below = first;
  below.step *= 0.8;
  status = probe(s, fidelity, below, &outcome);
  static const double ways[] = {0, 8};
  int64_t known[2] = {outcome.evaluations, outcome.evaluations};
  first.refine = (double)NAN;
  if (!add_ladder(s, all, fidelity, first, limited)) return status;
  for (int i = 0; i < 2 && status == STRUT_OK && method->events && !adaptive; i++) {
    below.refine = ways[i];
    status = probe(s, fidelity, below, &refined);
    bool same = refined.evaluations == known[0] || refined.evaluations == known[1];
    if (status != STRUT_OK || same || refined.status != outcome.status) continue;
    known[1] = refined.evaluations;
    first.refine = ways[i];
    if (!add_ladder(s, all, fidelity, first, limited)) break;
  }
  return status;
}

/* Whether a setting has been run: few steps in a period leave few choices. */
static bool known(const strut_tradeoff *r, const ladder *l, const study_setting *setting,
                  double step) {
  for (size_t i = 0; i < r->row_count; i++) {
    const strut_tradeoff_row *row = &r->rows[i];
    if (row->group != l->group || fabs(row->step / step - 1) > 1e-9) continue;
    if (!isfinite(setting->tolerance) || row->tolerance == setting->tolerance) return true;
  }
  return false;
}

/* From coarse to fine, all ladders side by side, as far as the share of the budget goes. */
static strut_status climb(study *s, ladders *all, double share, double from, double to) {
  int most = step_count(s) + ABOVE;
  for (int k = 0; k < most; k++) {
    tell(s, from + (to - from) * k / most);
    for (size_t i = 0; i < all->count; i++) {
      ladder *l = &all->at[i];
      study_setting setting;
      bool cannot = false, left = setting_at(s, l, k, &setting);
      if (!left || known(s->result, l, &setting, strut_study_fit(s, 0, setting.step))) continue;
      if (l->last_cost > 0 && 1.6 * l->last_cost > strut_study_left(s, share)) l->over = true;
      if (l->over) s->result->left_out++;
      if (l->over) continue;
      strut_status status = run_row(s, l, setting, false, &cannot);
      if (status != STRUT_OK) return status;
    }
  }
  return STRUT_OK;
}

/* ---- the whole ---- */

static strut_tradeoff_measure choose_measure(const strut_scene *scene, strut_tradeoff_measure m) {
  if (m != STRUT_TRADEOFF_AUTOMATIC) return m;
  bool walks = scene->contact_count > 0 || scene->experiment.periods > 0;
  return walks ? STRUT_TRADEOFF_VELOCITY : STRUT_TRADEOFF_POSITION;
}

static strut_status measure_points(study *s) {
  for (size_t p = 0; p < s->result->point_count; p++) {
    strut_model *model = NULL;
    strut_status status = strut_model_compile(s->scenes[p], &model, s->error);
    if (status != STRUT_OK) return status;
    strut_span span = strut_scene_span(s->scenes[p]);
    s->size[p] = model->size;
    s->scale[p] = SPEED_SHARE * model->size / (span.period > 0 ? span.period : span.duration);
    strut_model_free(model);
  }
  return STRUT_OK;
}

static strut_status prepare(study *s, size_t count) {
  strut_tradeoff *r = s->result;
  const strut_scene *scene = s->scenes[0];
  r->name = scene->name;
  r->point_count = count;
  r->measure = choose_measure(scene, s->options->measure);
  r->value_count = r->measure == STRUT_TRADEOFF_POSITION ? 2 * scene->node_count : 1;
  size_t most = count > 2 * scene->node_count ? count : 2 * scene->node_count;
  s->size = strut_arena_allocate(&r->arena, count, sizeof *s->size);
  s->scale = strut_arena_allocate(&r->arena, count, sizeof *s->scale);
  s->base_evaluations = strut_arena_allocate(&r->arena, count, sizeof *s->base_evaluations);
  s->scratch = strut_arena_allocate(&r->arena, most, sizeof *s->scratch);
  if (!s->size || !s->scale || !s->base_evaluations || !s->scratch) return out_of_memory(s);
  if (!(strut_scene_span(scene).duration > 0))
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
  r->value_count = 2 * s->scenes[0]->node_count;
}

/* rk4 at the scene's step, or the first method in the table that can run the scene. */
static strut_status choose_base(study *s) {
  strut_tradeoff *r = s->result;
  study_outcome outcome = {0};
  strut_status status = STRUT_OK;
  strut_experiment e = strut_study_experiment(s, 0);
  strut_scene scene = *s->scenes[0];
  scene.experiment = e;
  strut_span span = strut_scene_span(&scene);
  r->periods = e.periods;
  r->duration = span.duration;
  for (size_t i = 0; strut_integrator_at(i); i++) {
    const strut_integrator *method = strut_integrator_at(i);
    if (strut_study_adaptive(method) || !strut_study_able(s, method, 0)) continue;
    double step = e.step > 0 ? e.step : span.duration / 1000;
    s->base = (study_setting){method, step, (double)NAN, 1};
    status = probe(s, 0, s->base, &outcome);
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

static strut_status run_base(study *s, ladders *own) {
  strut_tradeoff *r = s->result;
  ladder alone = {.group = -1, .first = s->base}, *in = &alone;
  for (size_t i = own->count; i-- > 0;)
    if (own->at[i].first.method == s->base.method && !isfinite(own->at[i].first.refine))
      in = &own->at[i];
  if (in == &alone) alone.group = (int)r->group_count++;
  for (size_t p = 0; p < r->point_count; p++) {
    strut_scene scene = *s->scenes[p];
    scene.experiment = strut_study_experiment(s, p);
    s->base_evaluations[p] = strut_scene_span(&scene).duration / s->base.step *
                             s->base.method->evaluations;
  }
  bool cannot = false;
  strut_status status = run_row(s, in, s->base, true, &cannot);
  in->last_cost = 0;
  if (status != STRUT_OK) return status;
  if (cannot || r->row_count == 0) return s->error->status;
  r->base_evaluations = (int64_t)s->base_evaluations[0];
  r->base_seconds = r->rows[0].seconds;
  return STRUT_OK;
}

static strut_status own_model(study *s, ladders *own) {
  study_reference reference;
  strut_status status = STRUT_OK;
  for (size_t i = 0; strut_integrator_at(i) && status == STRUT_OK; i++)
    if (strut_study_allowed(s, strut_integrator_at(i), 0))
      status = add_method(s, own, 0, strut_integrator_at(i));
  if (status == STRUT_OK) status = run_base(s, own);
  if (status == STRUT_OK) status = strut_study_reference_begin(s, 0, &reference);
  if (status == STRUT_OK)
    status = strut_study_reference_refine(s, &reference, FIRST_TARGET, OWN_REFERENCE);
  if (status != STRUT_OK) return status;
  if (!s->result->fidelities[0].run)
    return strut_fail(s->error, STRUT_DIVERGED, "there is no reference: %s",
                      s->result->fidelities[0].remark);
  status = climb(s, own, OWN_ROWS, 0.2, 0.6);
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

static strut_status other_model(study *s, int fidelity, double share, double from, double to) {
  strut_tradeoff *r = s->result;
  const strut_integrator *best[BEST_METHODS];
  size_t count = best_methods(r, best);
  double before = strut_study_left(s, share);
  study_reference reference;
  ladders all = {.count = 0};
  strut_status status = strut_study_reference_begin(s, fidelity, &reference);
  if (status == STRUT_OK)
    status = strut_study_reference_refine(s, &reference, FIRST_TARGET,
                                          share - 0.5 * fmax(0, before) / s->budget);
  for (size_t i = 0; i < count && status == STRUT_OK && r->fidelities[fidelity].run; i++)
    if (strut_study_able(s, best[i], fidelity)) status = add_method(s, &all, fidelity, best[i]);
  if (status == STRUT_OK && all.count == 0 && r->fidelities[fidelity].run && reference.method[0])
    status = add_method(s, &all, fidelity, reference.method[0]);
  if (status == STRUT_OK) status = climb(s, &all, share, from, to);
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
  ladders own = {.count = 0};
  strut_status status = prepare(s, count);
  if (status == STRUT_OK) status = choose_base(s);
  if (status == STRUT_OK) look_elsewhere(s);
  if (status == STRUT_OK && strut_study_list_fidelities(s) != STRUT_OK) status = out_of_memory(s);
  if (status == STRUT_OK) status = own_model(s, &own);
  double others = (double)(r->fidelity_count - 1);
  for (size_t i = 1; i < r->fidelity_count && status == STRUT_OK; i++) {
    double begin = ((double)i - 1) / others, end = (double)i / others;
    status = other_model(s, (int)i, OWN_REFINED + (1 - OWN_REFINED) * end, 0.6 + 0.4 * begin,
                         0.6 + 0.4 * end);
  }
  if (status != STRUT_OK) return status;
  strut_study_judge(s);
  sort_rows(r);
  r->spent = strut_study_clock() - s->began;
  return STRUT_OK;
}

strut_status strut_tradeoff_make(const strut_scene *const *scenes, size_t count,
                                 const strut_tradeoff_options *options, strut_tradeoff *result,
                                 strut_error *error) {
  strut_error own = {0};
  *result = (strut_tradeoff){.name = ""};
  study s = {.scenes = scenes,
             .options = options,
             .result = result,
             .error = error ? error : &own,
             .began = strut_study_clock(),
             .budget = options->budget > 0 ? options->budget : USUAL_BUDGET};
  return make(&s, count);
}

void strut_tradeoff_free(strut_tradeoff *result) {
  strut_arena_free(&result->arena);
  *result = (strut_tradeoff){.name = ""};
}

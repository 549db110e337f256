/* SPDX-License-Identifier: GPL-3.0-or-later */
/* References: two methods refined until they agree. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/study/tradeoff/tradeoff_parts.h"

enum { MOST_LEVELS = 14, MOST_IDLE = 2 };
static const double FIRST_TOLERANCE = 1e-5;

/* Rank of a method as a reference. */
static int merit(const tradeoff_study *s, const strut_integrator *method) {
  int merit = method->order;
  if (method->events && strut_tradeoff_has_switches(&s->setups[0]->scene)) merit += 10;
  return merit;
}

static tradeoff_setting setting_of(const tradeoff_study *s, const tradeoff_reference *r, int which,
                                   int level) {
  if (which == 1 && r->method[0] == r->method[1])
    level++; /* a single method is confirmed by its own next level */
  tradeoff_setting setting = {r->method[which], r->limit * pow(0.5, level + 1), (double)NAN, 1};
  if (strut_tradeoff_is_adaptive(r->method[which])) {
    setting.step = fmax(10 * r->limit, s->limit);
    setting.tolerance = FIRST_TOLERANCE * pow(0.1, level);
  }
  return setting;
}

/* The best method that can run it, other than `not`; its step limit into r->limit. */
static strut_status choose(tradeoff_study *s, tradeoff_reference *r, int which,
                           const strut_integrator * not ) {
  bool tried[64] = {false};
  for (;;) {
    const strut_integrator *best = NULL;
    size_t at = 0;
    for (size_t i = 0; i < 64 && strut_integrator_at(i); i++) {
      const strut_integrator *method = strut_integrator_at(i);
      bool wanted = which == 0 ? !strut_tradeoff_is_adaptive(method)
                               : method != not &&(!best || !strut_tradeoff_is_adaptive(best));
      if (tried[i] || !wanted || !strut_tradeoff_can_run(s, method, r->variant)) continue;
      bool better = !best || (which == 1 && strut_tradeoff_is_adaptive(method)) ||
                    merit(s, method) > merit(s, best);
      if (better) best = method, at = i;
    }
    if (!best) return STRUT_OK;
    tried[at] = true;
    r->method[which] = best;
    double limit = 0;
    bool cannot = false;
    strut_status status = strut_tradeoff_limit(s, r->variant, best, &limit, &cannot);
    if (status != STRUT_OK) return status;
    if (!isfinite(limit)) limit = strut_tradeoff_longest_step(s, 0);
    if (which == 0 && limit > 0 && !cannot) r->limit = 0.5 * limit;
    if (!cannot) return STRUT_OK;
    r->method[which] = NULL;
  }
}

static void mark_not_run(strut_model_variant *f, const char *why) {
  f->run = false;
  snprintf(f->remark, sizeof f->remark, "%s", why);
}

strut_status strut_tradeoff_reference_begin(tradeoff_study *s, int variant, tradeoff_reference *r) {
  strut_tradeoff *result = s->result;
  strut_model_variant *f = &result->variants[variant];
  *r = (tradeoff_reference){.variant = variant, .limit = s->base.step};
  r->level = strut_arena_allocate(&result->arena, result->point_count, sizeof *r->level);
  r->idle = strut_arena_allocate(&result->arena, result->point_count, sizeof *r->idle);
  r->latest = strut_arena_allocate(&result->arena, 2 * result->value_count, sizeof *r->latest);
  r->before = strut_arena_allocate(&result->arena, 2 * result->value_count * result->point_count,
                                   sizeof *r->before);
  for (int k = 0; k < 2; k++)
    r->work[k] = strut_arena_allocate(&result->arena, result->point_count, sizeof *r->work[k]);
  if (!r->level || !r->idle || !r->latest || !r->before || !r->work[0] || !r->work[1])
    return strut_no_memory(s->error, "");
  f->run = true;
  for (size_t p = 0; p < result->point_count; p++) f->floor[p] = HUGE_VAL;
  if (result->measure == STRUT_TRADEOFF_ENERGY) {
    for (size_t p = 0; p < result->point_count; p++) f->floor[p] = 0;
    snprintf(f->reference[0], sizeof f->reference[0], "none: an exact balance closes at 0");
    return STRUT_OK;
  }
  strut_status status = choose(s, r, 0, NULL);
  if (status == STRUT_OK && r->method[0]) status = choose(s, r, 1, r->method[0]);
  if (status == STRUT_OK && !r->method[0]) mark_not_run(f, s->error->message);
  if (status == STRUT_OK && r->method[0] && !r->method[1]) {
    r->method[1] = r->method[0];
    size_t used = strlen(f->remark);
    snprintf(f->remark + used, sizeof f->remark - used,
             "%sonly one method can run it: no second method confirms the answer",
             used ? "; " : "");
  }
  return status;
}

static void name_setting(tradeoff_setting setting, char name[100]) {
  if (strut_tradeoff_is_adaptive(setting.method))
    snprintf(name, 100, "%s, tolerance %.0e", setting.method->name, setting.tolerance);
  else
    snprintf(name, 100, "%s, %s", setting.method->name,
             strut_quantity_of(setting.step, 3, "s").text);
}

/*
 * How far a pair of answers is from what is sought: their distance, or a tenth of what either
 * changed by since the level before, if that is more. Two coarse answers may agree by chance.
 */
static double estimate_error(const tradeoff_study *s, const tradeoff_reference *r, size_t p) {
  size_t count = s->result->value_count;
  const double *now = r->latest, *before = r->before + 2 * p * count;
  if (r->level[p] == 0) return HUGE_VAL;
  double apart = strut_tradeoff_distance(s, p, now, now + count);
  for (size_t k = 0; k < 2; k++)
    apart = fmax(apart, 0.1 * strut_tradeoff_distance(s, p, now + k * count, before + k * count));
  return apart;
}

/* The unit of the bound on work: a run of the method that takes more. */
static void count_reference(strut_tradeoff *result, const tradeoff_reference *r, double least) {
  double work[2] = {0};
  for (size_t p = 0; p < result->point_count; p++)
    for (int k = 0; k < 2; k++) work[k] += r->work[k][p];
  if (r->variant == 0) result->work_unit = fmax(least, fmax(work[0], work[1]));
}

/*
 * Refines the reference of one point by one level, until the study has made `end` force
 * evaluations.
 */
static strut_status refine_point(tradeoff_study *s, tradeoff_reference *r, size_t p, double end) {
  strut_tradeoff *result = s->result;
  strut_model_variant *f = &result->variants[r->variant];
  size_t count = result->value_count;
  double *a = r->latest, *b = r->latest + count, *kept = f->value + p * count;
  strut_status status = STRUT_OK;
  for (int k = 0; k < 2 && status == STRUT_OK; k++) {
    tradeoff_outcome outcome;
    s->allowed = isfinite(end) ? fmax(1, end - result->work) : 0;
    status =
        strut_tradeoff_run(s, p, r->variant, setting_of(s, r, k, r->level[p]), k ? b : a, &outcome);
    r->work[k][p] = outcome.evaluations;
    if (outcome.cut) r->level[p] = MOST_LEVELS;
  }
  s->allowed = 0;
  if (status != STRUT_OK || r->level[p] == MOST_LEVELS) return status;
  count_reference(result, r, s->least_unit);
  double apart = estimate_error(s, r, p);
  memcpy(r->before + 2 * p * count, r->latest, 2 * count * sizeof *r->latest);
  bool idle = r->level[p] > 1 && !(apart < 0.5 * f->floor[p]);
  r->idle[p] = idle ? r->idle[p] + 1 : 0;
  if (apart < f->floor[p]) {
    f->floor[p] = apart;
    for (size_t i = 0; i < count; i++) kept[i] = 0.5 * (a[i] + b[i]);
    for (int k = 0; k < 2 && p == 0; k++)
      name_setting(setting_of(s, r, k, r->level[p]), f->reference[k]);
  }
  r->level[p]++;
  return STRUT_OK;
}

strut_status strut_tradeoff_reference_refine(tradeoff_study *s, tradeoff_reference *r,
                                             double target, double most) {
  strut_tradeoff *result = s->result;
  strut_model_variant *f = &result->variants[r->variant];
  if (!f->run || !r->method[0]) return STRUT_OK;
  double end = result->work + most;
  for (bool more = true; more;) {
    more = false;
    for (size_t p = 0; p < result->point_count; p++) {
      double next = 2 * (r->work[0][p] + r->work[1][p]);
      if (f->floor[p] <= target || r->level[p] >= MOST_LEVELS || r->idle[p] >= MOST_IDLE) continue;
      if (r->level[p] >= 2 && result->work + next > end) continue;
      if (!strut_tradeoff_has_time(s, next)) continue;
      strut_status status = refine_point(s, r, p, end);
      if (status != STRUT_OK) return status;
      more = true;
    }
  }
  for (size_t p = 0; p < result->point_count; p++)
    if (!isfinite(f->floor[p]))
      mark_not_run(f, result->cut               ? STRUT_TRADEOFF_NO_TIME
                      : result->work + 1 >= end ? STRUT_TRADEOFF_NO_WORK
                                                : "no two methods complete the run");
  return STRUT_OK;
}

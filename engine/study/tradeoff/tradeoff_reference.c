/* SPDX-License-Identifier: GPL-3.0-or-later */
/* References: two methods refined in turn until they agree, or until no more is to be had. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/quantity_text.h"
#include "engine/study/tradeoff/tradeoff_parts.h"

enum { MOST_LEVELS = 14, MOST_IDLE = 3 };
static const double FIRST_TOLERANCE = 1e-5;

/* How promising a method is. */
static int merit(const study *s, const strut_integrator *method) {
  int merit = method->order;
  if (method->events && strut_study_switches(&s->setups[0]->scene)) merit += 10;
  return merit;
}

static study_setting setting_of(const study *s, const study_reference *r, int which, int level) {
  if (which == 1 && r->method[0] == r->method[1]) level++; /* alone, it confirms itself */
  study_setting setting = {r->method[which], r->limit * pow(0.5, level + 1), (double)NAN, 1};
  if (strut_study_adaptive(r->method[which])) {
    setting.step = fmax(10 * r->limit, s->limit);
    setting.tolerance = FIRST_TOLERANCE * pow(0.1, level);
  }
  return setting;
}

/* The best method that can run it, other than `not`; its step limit into r->limit. */
static strut_status choose(const study *s, study_reference *r, int which,
                           const strut_integrator * not ) {
  bool tried[64] = {false};
  for (;;) {
    const strut_integrator *best = NULL;
    size_t at = 0;
    for (size_t i = 0; i < 64 && strut_integrator_at(i); i++) {
      const strut_integrator *method = strut_integrator_at(i);
      bool wanted = which == 0 ? !strut_study_adaptive(method)
                               : method != not &&(!best || !strut_study_adaptive(best));
      if (tried[i] || !wanted || !strut_study_able(s, method, r->fidelity)) continue;
      bool better = !best || (which == 1 && strut_study_adaptive(method)) ||
                    merit(s, method) > merit(s, best);
      if (better) best = method, at = i;
    }
    if (!best) return STRUT_OK;
    tried[at] = true;
    r->method[which] = best;
    study_outcome outcome;
    strut_status status =
        strut_study_run(s, 0, r->fidelity, setting_of(s, r, which, 0), r->latest, &outcome);
    if (status != STRUT_OK) return status;
    if (which == 0 && outcome.step_limit > 0 && !outcome.cannot)
      r->limit = isfinite(outcome.step_limit) ? 0.5 * outcome.step_limit : s->base.step;
    if (!outcome.cannot) return STRUT_OK;
    r->method[which] = NULL;
  }
}

static void give_up(strut_model_variant *f, const char *why) {
  f->run = false;
  snprintf(f->remark, sizeof f->remark, "%s", why);
}

strut_status strut_study_reference_begin(study *s, int fidelity, study_reference *r) {
  strut_tradeoff *result = s->result;
  strut_model_variant *f = &result->fidelities[fidelity];
  *r = (study_reference){.fidelity = fidelity, .limit = s->base.step};
  r->level = strut_arena_allocate(&result->arena, result->point_count, sizeof *r->level);
  r->idle = strut_arena_allocate(&result->arena, result->point_count, sizeof *r->idle);
  r->latest = strut_arena_allocate(&result->arena, 2 * result->value_count, sizeof *r->latest);
  r->before = strut_arena_allocate(&result->arena, 2 * result->value_count * result->point_count,
                                   sizeof *r->before);
  if (!r->level || !r->idle || !r->latest || !r->before)
    return strut_fail(s->error, STRUT_NO_MEMORY, "out of memory");
  f->run = true;
  for (size_t p = 0; p < result->point_count; p++) f->floor[p] = HUGE_VAL;
  if (result->measure == STRUT_TRADEOFF_ENERGY) {
    for (size_t p = 0; p < result->point_count; p++) f->floor[p] = 0;
    snprintf(f->reference[0], sizeof f->reference[0], "none: a balance closes at 0");
    return STRUT_OK;
  }
  strut_status status = choose(s, r, 0, NULL);
  if (status == STRUT_OK && r->method[0]) status = choose(s, r, 1, r->method[0]);
  if (status == STRUT_OK && !r->method[0]) give_up(f, s->error->message);
  if (status == STRUT_OK && r->method[0] && !r->method[1]) {
    r->method[1] = r->method[0];
    size_t used = strlen(f->remark);
    snprintf(f->remark + used, sizeof f->remark - used,
             "%sonly one method can run it: no other confirms its answer", used ? "; " : "");
  }
  return status;
}

static void name_setting(study_setting setting, char name[100]) {
  if (strut_study_adaptive(setting.method))
    snprintf(name, 100, "%s, tolerance %.0e", setting.method->name, setting.tolerance);
  else
    snprintf(name, 100, "%s, %s", setting.method->name,
             strut_quantity_of(setting.step, 3, "s").text);
}

/*
 * How far a pair of answers is from what is sought: their distance, or a tenth of what either changed
 * by since the level before, if that is more. Two coarse answers may agree by chance.
 */
static double doubt(const study *s, const study_reference *r, size_t p) {
  size_t count = s->result->value_count;
  const double *now = r->latest, *before = r->before + 2 * p * count;
  if (r->level[p] == 0) return HUGE_VAL;
  double apart = strut_study_distance(s, p, now, now + count);
  for (size_t k = 0; k < 2; k++)
    apart = fmax(apart, 0.1 * strut_study_distance(s, p, now + k * count, before + k * count));
  return apart;
}

/* One level more at one point. */
static strut_status refine_point(study *s, study_reference *r, size_t p) {
  strut_tradeoff *result = s->result;
  strut_model_variant *f = &result->fidelities[r->fidelity];
  size_t count = result->value_count;
  double *a = r->latest, *b = r->latest + count, *kept = f->value + p * count;
  double before = strut_study_clock();
  study_outcome outcome;
  strut_status status =
      strut_study_run(s, p, r->fidelity, setting_of(s, r, 0, r->level[p]), a, &outcome);
  if (status == STRUT_OK)
    status = strut_study_run(s, p, r->fidelity, setting_of(s, r, 1, r->level[p]), b, &outcome);
  if (status != STRUT_OK) return status;
  r->last_cost = strut_study_clock() - before;
  double apart = doubt(s, r, p);
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

strut_status strut_study_reference_refine(study *s, study_reference *r, double target,
                                          double share) {
  strut_tradeoff *result = s->result;
  strut_model_variant *f = &result->fidelities[r->fidelity];
  if (!f->run || !r->method[0]) return STRUT_OK;
  for (bool more = true; more;) {
    more = false;
    for (size_t p = 0; p < result->point_count; p++) {
      bool first = r->level[p] < 2;
      if (f->floor[p] <= target || r->level[p] >= MOST_LEVELS || r->idle[p] >= MOST_IDLE) continue;
      if (!first && strut_study_left(s, share) < 2.5 * r->last_cost) continue;
      strut_status status = refine_point(s, r, p);
      if (status != STRUT_OK) return status;
      more = true;
    }
  }
  for (size_t p = 0; p < result->point_count; p++)
    if (!isfinite(f->floor[p])) give_up(f, "no two methods give an answer");
  return STRUT_OK;
}

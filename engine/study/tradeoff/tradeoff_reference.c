/* SPDX-License-Identifier: GPL-3.0-or-later */
/* References: two methods refined until they agree. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/study/tradeoff/tradeoff_parts.h"

enum { MOST_LEVELS = 14, MOST_IDLE = 2 };
static const double FIRST_TOLERANCE = 1e-5;

/* Rank of a method as a reference. */
static int merit(const tradeoff_study *study, const strut_integrator *method) {
  int merit = method->order;
  if (method->events && strut_tradeoff_has_switches(&study->setups[0]->scene)) merit += 10;
  return merit;
}

static tradeoff_setting setting_of(const tradeoff_study *study, const tradeoff_reference *self,
                                   int which, int level) {
  if (which == 1 && self->method[0] == self->method[1])
    level++; /* confirms itself by its next level */
  tradeoff_setting setting = {self->method[which], self->limit * pow(0.5, level + 1), (double)NAN,
                              1};
  if (strut_tradeoff_is_adaptive(self->method[which])) {
    setting.step = fmax(10 * self->limit, study->limit);
    setting.tolerance = FIRST_TOLERANCE * pow(0.1, level);
  }
  return setting;
}

/* The best method that can run it, other than the first; of that its step limit into r->limit. */
static void choose(tradeoff_study *study, tradeoff_reference *self, int which) {
  bool tried[64] = {false};
  while (!study->status) {
    const strut_integrator *best = NULL, *method;
    size_t at = 0;
    for (size_t i = 0; i < 64 && (method = strut_integrator_at(i)); i++) {
      bool adaptive = strut_tradeoff_is_adaptive(method);
      bool wanted = which == 0
                        ? !adaptive
                        : method != self->method[0] && (!best || !strut_tradeoff_is_adaptive(best));
      if (tried[i] || !wanted || !strut_tradeoff_can_run(study, method, self->variant)) continue;
      if (!best || (which == 1 && adaptive) || merit(study, method) > merit(study, best))
        best = method, at = i;
    }
    if (!best) return;
    tried[at] = true;
    double limit = 0;
    if (!strut_tradeoff_limit(study, self->variant, best, &limit)) continue;
    if (!isfinite(limit)) limit = study->points[0].longest;
    if (which == 0 && limit > 0) self->limit = 0.5 * limit;
    self->method[which] = best;
    return;
  }
}

static void mark_not_run(strut_model_variant *variant, const char *why) {
  variant->run = false;
  snprintf(variant->remark, sizeof variant->remark, "%s", why);
}

void strut_tradeoff_reference_begin(tradeoff_study *study, int variant, tradeoff_reference *self) {
  const strut_tradeoff *result = study->result;
  strut_model_variant *f = &study->result->variants[variant];
  const size_t points = result->point_count, values = 2 * result->value_count;
  const bool balance = result->measure == STRUT_TRADEOFF_ENERGY;
  *self = (tradeoff_reference){.variant = variant, .limit = study->base.step};
  self->level = strut_tradeoff_allocate(study, 2 * points, sizeof *self->level);
  self->work[0] =
      strut_tradeoff_allocate(study, 2 * points + values * (points + 1), sizeof *self->latest);
  if (study->status) return;
  self->idle = self->level + points;
  self->work[1] = self->work[0] + points;
  self->latest = self->work[1] + points;
  self->before = self->latest + values;
  f->run = true;
  for (size_t p = 0; p < points; p++) f->floor[p] = balance ? 0 : HUGE_VAL;
  if (balance) {
    snprintf(f->reference[0], sizeof f->reference[0], "none: an exact balance closes at 0");
    return;
  }
  choose(study, self, 0);
  if (self->method[0]) choose(study, self, 1);
  if (!study->status && !self->method[0]) mark_not_run(f, study->error->message);
  if (study->status || !self->method[0] || self->method[1]) return;
  self->method[1] = self->method[0];
  size_t used = strlen(f->remark);
  snprintf(f->remark + used, sizeof f->remark - used,
           "%sonly one method can run it: no second method confirms the answer", used ? "; " : "");
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
static double estimate_error(const tradeoff_study *study, const tradeoff_reference *self,
                             size_t p) {
  size_t count = study->result->value_count;
  const double *now = self->latest, *before = self->before + 2 * p * count;
  if (self->level[p] == 0) return HUGE_VAL;
  double apart = strut_tradeoff_distance(study, p, now, now + count);
  for (size_t k = 0; k < 2; k++)
    apart =
        fmax(apart, 0.1 * strut_tradeoff_distance(study, p, now + k * count, before + k * count));
  return apart;
}

/* The unit of the bound on work: a run of the method that takes more. */
static void count_reference(strut_tradeoff *result, const tradeoff_reference *self, double least) {
  double work[2] = {0};
  for (size_t p = 0; p < result->point_count; p++)
    for (int k = 0; k < 2; k++) work[k] += self->work[k][p];
  if (self->variant == 0) result->work_unit = fmax(least, fmax(work[0], work[1]));
}

/*
 * Refines the reference of one point by one level, until the study has made `end` force
 * evaluations.
 */
static void refine_point(tradeoff_study *study, tradeoff_reference *self, size_t p, double end) {
  strut_tradeoff *result = study->result;
  strut_model_variant *variant = &result->variants[self->variant];
  size_t count = result->value_count;
  double *a = self->latest, *b = self->latest + count, *kept = variant->value + p * count;
  for (int k = 0; k < 2 && !study->status; k++) {
    study->allowed = isfinite(end) ? fmax(1, end - result->work) : 0;
    tradeoff_outcome outcome = strut_tradeoff_run(
        study, p, self->variant, setting_of(study, self, k, self->level[p]), k ? b : a);
    self->work[k][p] = outcome.evaluations;
    if (outcome.cut) self->level[p] = MOST_LEVELS;
  }
  study->allowed = 0;
  if (study->status || self->level[p] == MOST_LEVELS) return;
  count_reference(result, self, study->least_unit);
  double apart = estimate_error(study, self, p);
  memcpy(self->before + 2 * p * count, self->latest, 2 * count * sizeof *self->latest);
  bool idle = self->level[p] > 1 && !(apart < 0.5 * variant->floor[p]);
  self->idle[p] = idle ? self->idle[p] + 1 : 0;
  if (apart < variant->floor[p]) {
    variant->floor[p] = apart;
    for (size_t i = 0; i < count; i++) kept[i] = 0.5 * (a[i] + b[i]);
    for (int k = 0; k < 2 && p == 0; k++)
      name_setting(setting_of(study, self, k, self->level[p]), variant->reference[k]);
  }
  self->level[p]++;
}

void strut_tradeoff_reference_refine(tradeoff_study *study, tradeoff_reference *self, double target,
                                     double most) {
  strut_tradeoff *result = study->result;
  if (study->status) return;
  strut_model_variant *variant = &result->variants[self->variant];
  if (!variant->run || !self->method[0]) return;
  double end = result->work + most;
  for (bool more = true; more;) {
    more = false;
    for (size_t p = 0; p < result->point_count && !study->status; p++) {
      double next = 2 * (self->work[0][p] + self->work[1][p]);
      if (variant->floor[p] <= target || self->level[p] >= MOST_LEVELS ||
          self->idle[p] >= MOST_IDLE || (self->level[p] >= 2 && result->work + next > end) ||
          !strut_tradeoff_has_time(study, next))
        continue;
      refine_point(study, self, p, end);
      more = !study->status;
    }
  }
  for (size_t p = 0; p < result->point_count; p++)
    if (!isfinite(variant->floor[p]))
      mark_not_run(variant, result->cut               ? STRUT_TRADEOFF_NO_TIME
                            : result->work + 1 >= end ? STRUT_TRADEOFF_NO_WORK
                                                      : "no two methods complete the run");
}

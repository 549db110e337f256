/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/tradeoff/step_refinement.h"

#include <math.h>

enum { USUAL_STEPS = 8, USUAL_REPEATS = 5, ABOVE = 3, MOST_TIMES = 64, LOOKED_AT = 5 };
static const double SHORT = 0.05; /* a run that is repeated for its CPU time [s] */
static const double BELOW = 0.95, IN_DECADE = 5;
/* Steps that nothing limits begin at so many times the explicit limit, or the base's step. */
static const double FREE = 100, FREE_OF_BASE = 10;
static const double above[ABOVE] = {2.5, 1.5, 1.1};

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

static strut_tradeoff_row *new_row(study *s, const study_ladder *from, study_setting setting) {
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

/* CPU times of a setting and of the base, in turn. */
typedef struct timing {
  double own[MOST_TIMES], ratio[MOST_TIMES];
  size_t count;
} timing;

/* The base's own time again, unless it is a long run that was timed a moment ago. */
static strut_status time_base(study *s, size_t p) {
  study_outcome base;
  double now = strut_study_clock(), known = s->base_seconds[p];
  bool fresh = s->base_timed[p] > 0 && now - s->base_timed[p] < 10 * known;
  if (fresh && !(known < SHORT)) return STRUT_OK;
  strut_status status = strut_study_run(s, p, 0, s->base, s->scratch, &base);
  s->base_seconds[p] = base.status == STRUT_OK ? base.seconds : (double)NAN;
  s->base_timed[p] = strut_study_clock();
  return status;
}

static strut_status time_point(study *s, const strut_tradeoff_row *row, study_setting setting,
                               size_t p, double seconds, timing *times) {
  size_t repeats = (size_t)(s->options->repeats > 0 ? s->options->repeats : USUAL_REPEATS);
  size_t points = s->result->point_count < repeats ? s->result->point_count : repeats;
  size_t here = seconds > SHORT ? 1 : (repeats + points - 1) / points;
  study_outcome outcome;
  double *value = s->scratch;
  for (size_t i = 0; i < here && p < points && times->count < MOST_TIMES; i++) {
    strut_status status = time_base(s, p);
    if (status == STRUT_OK && i > 0)
      status = strut_study_run(s, p, row->fidelity, setting, value, &outcome);
    if (status != STRUT_OK) return status;
    if (i > 0) seconds = outcome.seconds;
    times->own[times->count] = seconds;
    times->ratio[times->count] = seconds / s->base_seconds[p];
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

strut_status strut_study_run_row(study *s, study_ladder *from, study_setting setting, bool base,
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
    status =
        strut_study_run(s, p, row->fidelity, setting, row->value + p * r->value_count, &outcome);
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

/* ---- study_ladders ---- */

/* The k-th setting of a ladder, the coarsest first. False after the last. */
static bool setting_at(const study *s, const study_ladder *l, int k, study_setting *setting) {
  bool adaptive = strut_study_adaptive(l->first.method);
  int extra = l->limited ? ABOVE : 0;
  if (k >= step_count(s) + (adaptive ? 0 : ABOVE)) return false;
  *setting = l->first;
  if (adaptive)
    setting->tolerance = 1e-2 * pow(0.1, k);
  else if (k < extra)
    setting->step *= above[k];
  else
    setting->step *= BELOW * pow(10, -(k - extra) / IN_DECADE);
  return true;
}

strut_status strut_study_probe(const study *s, int fidelity, study_setting setting,
                               study_outcome *outcome) {
  return strut_study_run(s, 0, fidelity, setting, s->scratch, outcome);
}

static study_ladder *add_ladder(study *s, study_ladders *all, int fidelity, study_setting first,
                                bool limited) {
  if (all->count == STUDY_MOST_LADDERS) return NULL;
  study_ladder *l = &all->at[all->count++];
  *l = (study_ladder){.fidelity = fidelity,
                      .group = (int)s->result->group_count++,
                      .first = first,
                      .limited = limited};
  return l;
}

/* Whether two ways to refine differ at one of the first points: not everywhere is there a touchdown. */
static strut_status differ(const study *s, int fidelity, study_setting a, study_setting b,
                           bool *different) {
  study_outcome one = {0}, other = {0};
  strut_status status = STRUT_OK;
  *different = false;
  for (size_t p = 0; p < s->result->point_count && p < LOOKED_AT && !*different && !status; p++) {
    status = strut_study_run(s, p, fidelity, a, s->scratch, &one);
    if (!status) status = strut_study_run(s, p, fidelity, b, s->scratch, &other);
    bool both = one.status == STRUT_OK && other.status == STRUT_OK;
    *different =
        !status && (one.status != other.status || (both && one.evaluations != other.evaluations));
  }
  return status;
}

/* Further ladders of a method with events, `first` being that without refinement. */
static strut_status add_refined(study *s, study_ladders *all, int fidelity, study_setting first,
                                bool limited) {
  static const double ways[] = {(double)NAN, 0, 8};
  study_setting setting[3];
  strut_status status = STRUT_OK;
  for (int i = 0; i < 3; i++) {
    setting[i] = first;
    setting[i].step *= 0.8;
    setting[i].refine = ways[i];
  }
  for (int i = 1; i < 3 && !status; i++) {
    bool new = true;
    for (int k = 0; k < i && new && !status; k++)
      status = differ(s, fidelity, setting[k], setting[i], &new);
    first.refine = ways[i];
    if (!status && new && !add_ladder(s, all, fidelity, first, limited)) break;
  }
  return status;
}

/* Ladders of one method: one for each way to refine that makes a difference in this scene. */
strut_status strut_study_add_method(study *s, study_ladders *all, int fidelity,
                                    const strut_integrator *method) {
  study_outcome outcome;
  study_setting first = {method, s->base.step, (double)NAN, 1};
  bool adaptive = strut_study_adaptive(method);
  if (adaptive) first.step = fmax(10 * first.step, s->limit), first.tolerance = 1e-2;
  strut_status status = strut_study_probe(s, fidelity, first, &outcome);
  if (status != STRUT_OK || outcome.cannot) return status;
  bool limited = !adaptive && isfinite(outcome.step_limit) && outcome.step_limit > 0;
  if (limited) first.step = outcome.step_limit;
  if (!limited && !adaptive) {
    double most = s->limit > 0 ? FREE * s->limit : FREE_OF_BASE * first.step;
    first.step = fmin(most, strut_study_longest(s, 0));
  }
  first.refine = (double)NAN;
  if (!add_ladder(s, all, fidelity, first, limited)) return status;
  return method->events && !adaptive ? add_refined(s, all, fidelity, first, limited) : status;
}

/* Whether a setting has been run: few steps in a period leave few choices. */
static bool known(const strut_tradeoff *r, const study_ladder *l, const study_setting *setting,
                  double step) {
  for (size_t i = 0; i < r->row_count; i++) {
    const strut_tradeoff_row *row = &r->rows[i];
    if (row->group != l->group || fabs(row->step / step - 1) > 1e-9) continue;
    if (!isfinite(setting->tolerance) || row->tolerance == setting->tolerance) return true;
  }
  return false;
}

/* From coarse to fine, all study_ladders side by side, as far as the share of the budget goes. */
strut_status strut_study_climb(study *s, study_ladders *all, double share, double from, double to) {
  int most = step_count(s) + ABOVE;
  for (int k = 0; k < most; k++) {
    tell(s, from + (to - from) * k / most);
    for (size_t i = 0; i < all->count; i++) {
      study_ladder *l = &all->at[i];
      study_setting setting;
      bool cannot = false, left = setting_at(s, l, k, &setting);
      if (!left || known(s->result, l, &setting, strut_study_fit(s, 0, setting.step))) continue;
      if (l->last_cost > 0 && 1.6 * l->last_cost > strut_study_left(s, share)) l->over = true;
      if (l->over) s->result->left_out++;
      if (l->over) continue;
      strut_status status = strut_study_run_row(s, l, setting, false, &cannot);
      if (status != STRUT_OK) return status;
    }
  }
  return STRUT_OK;
}

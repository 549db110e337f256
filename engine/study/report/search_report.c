/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a search has found, and what it is worth. */
#include "engine/study/report/study_report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/memory.h"
#include "engine/base/number_text.h"
#include "engine/output/buffer.h"
#include "engine/output/json_value.h"
#include "engine/study/sweep/grid.h"

/* Changes of the objective that count: of a more exact run, and among the best points. */
static const double STANDS = 0.02, FLAT = 1e-3;

typedef struct report {
  strut_buffer text;
  const strut_sweep_plan *plan;
  const strut_study_search *search;
  const strut_search_result *result;
} report;

static const char *unit_of(const char *unit) { return !unit || strcmp(unit, "1") == 0 ? "" : unit; }

static void add_number(strut_buffer *b, double number, const char *unit) {
  strut_buffer_add(b, "%.6g%s%s", number, *unit_of(unit) ? " " : "", unit_of(unit));
}

static void add_value(strut_buffer *b, strut_study_value value, const char *unit) {
  if (value.word)
    strut_buffer_add(b, "%s", value.word);
  else
    add_number(b, value.number, unit);
}

/* A change of the best objective: relative where this has a size, "-0.2 %", else in its unit. */
static void add_change(report *r, const strut_search_outcome *o, double change, bool sign) {
  double size = strut_search_size(o);
  if (size > 0.0)
    strut_buffer_add(&r->text, sign ? "%+.3g %%" : "%.3g %%", 100.0 * change / size);
  else
    strut_buffer_add(&r->text, sign ? "%+.3g%s%s" : "%.3g%s%s", change,
                     *unit_of(r->search->goal.program.unit) ? " " : "",
                     unit_of(r->search->goal.program.unit));
}

/* Is a change small, compared with the best objective or the range of all? */
static bool is_small(const strut_search_outcome *o, double change, double share) {
  double size = strut_search_size(o);
  return fabs(change) <= share * (size > 0.0 ? size : o->most - o->least);
}

/* "friction = 0.1, start = I: " of a point of the study's axes. */
static void add_outer(report *r, int64_t point) {
  strut_study_value values[64];
  size_t count = 0;
  for (size_t i = 0; i < r->search->axis; i++) count += r->plan->study->axes[i].column_count;
  if (count == 0 || r->plan->axis_columns > sizeof values / sizeof values[0]) return;
  strut_grid_values(r->plan->study, point, values);
  for (size_t i = 0; i < count; i++) {
    strut_buffer_add(&r->text, "%s%s = ", i ? ", " : "", r->plan->columns[i].name);
    add_value(&r->text, values[i], r->plan->columns[i].unit);
  }
  strut_buffer_add(&r->text, ":\n");
}

static const char *end_text(strut_search_end end) {
  switch (end) {
    case STRUT_SEARCH_USED_UP: return "all evaluations used";
    case STRUT_SEARCH_CONVERGED: return "converged";
    case STRUT_SEARCH_REPEATS: return "asked for known points only";
    case STRUT_SEARCH_ENUMERATED: return "all points computed";
  }
  return "";
}

static void add_check(report *r, const strut_search_worth *w, const strut_search_outcome *o) {
  const strut_study *study = r->plan->study;
  const char *how = study->check_accuracy > 0.0 ? "with the accuracy of the check"
                    : study->half_step          ? "with half the step or error"
                                                : "with a tenth of the error, or half the step";
  if (!w->checked) return;
  strut_buffer_add(&r->text, "  %s: ", how);
  if (isnan(w->check.objective)) {
    strut_buffer_add(&r->text, "it fails: do not trust it\n");
    return;
  }
  double apart = w->check.objective - o->best.objective;
  bool broken = w->check.violation > 0.0 && o->best.violation <= 0.0;
  add_number(&r->text, w->check.objective, r->search->goal.program.unit);
  strut_buffer_add(&r->text, " (");
  add_change(r, o, apart, true);
  strut_buffer_add(&r->text, ")%s: %s\n", broken ? ", conditions are broken" : "",
                   is_small(o, apart, STANDS) && !broken ? "it stands" : "it does not stand");
}

/* The worst of the two neighbours along each variable. */
static void add_neighbours(report *r, const strut_search_worth *w, const strut_search_outcome *o) {
  strut_buffer *b = &r->text;
  bool any = false;
  for (size_t i = 0; i < r->search->variable_count; i++) {
    double worst = HUGE_VAL;
    bool there = false, failed = false, broken = false;
    for (int side = 0; side < 2; side++) {
      const strut_search_neighbour *n = &w->neighbours[i][side];
      if (!n->there) continue;
      there = true;
      failed = failed || isnan(n->point.objective);
      broken = broken || (n->point.violation > 0.0 && o->best.violation <= 0.0);
      double apart = n->point.objective - o->best.objective;
      worst = fmin(worst, r->search->maximise ? apart : -apart);
    }
    if (!there) continue;
    if (!any) strut_buffer_add(b, "  1 %% of the range aside:");
    strut_buffer_add(b, "%s %s ", any ? "," : "", r->search->variables[i].name);
    if (failed)
      strut_buffer_add(b, "fails");
    else
      add_change(r, o, r->search->maximise ? worst : -worst, true);
    if (broken) strut_buffer_add(b, " and breaks a condition");
    any = true;
  }
  if (any) strut_buffer_add(b, "\n");
}

static void add_verdicts(report *r, const strut_search_worth *w, const strut_search_outcome *o) {
  strut_buffer *b = &r->text;
  size_t last = o->top_count ? o->top_count - 1 : 0;
  double spread = o->top_count > 1 ? fabs(o->top[last] - o->top[0]) : 0.0;
  if (o->constant && o->evaluations > 1)
    strut_buffer_add(b, "  the objective is the same at all points: nothing was to be found\n");
  else if (o->top_count > 1) {
    strut_buffer_add(b, "  the %zu best points are within ", o->top_count);
    add_change(r, o, spread, false);
    strut_buffer_add(b, "%s\n",
                     is_small(o, spread, FLAT) ? ": the optimum is flat, or well found" : "");
  }
  if (r->search->starts > 1)
    strut_buffer_add(b, "  %d of %d searches agree within 1 %%\n", (int)w->agreeing,
                     (int)r->search->starts);
  if (o->failed || o->valueless)
    strut_buffer_add(b, "  %lld of %lld evaluations failed, %lld have no objective\n",
                     (long long)o->failed, (long long)o->evaluations, (long long)o->valueless);
  if (r->search->condition_count && o->best.violation <= 0.0)
    strut_buffer_add(b, "  %lld of %lld evaluations meet all conditions\n", (long long)o->feasible,
                     (long long)o->evaluations);
}

static void add_best(report *r, const strut_search_worth *w) {
  const strut_search_outcome *o = &r->result->outcomes[w->best];
  strut_buffer *b = &r->text;
  add_outer(r, o->best.worst);
  strut_buffer_add(b, "%s %s = ", r->search->maximise ? "greatest" : "least", r->search->goal.text);
  add_number(b, o->best.objective, r->search->goal.program.unit);
  if (r->search->scenario_axes) strut_buffer_add(b, " in the worst scenario");
  strut_buffer_add(b, " (search %d, evaluation %lld of %lld; %s)\n", (int)o->start + 1,
                   (long long)(o->best.evaluation - o->start * r->search->evaluations) + 1,
                   (long long)o->evaluations, end_text(o->end));
  if (o->best.violation > 0.0)
    strut_buffer_add(
        b, "  infeasible: no point meets all conditions; this one breaks them least, by %.3g\n",
        o->best.violation);
  for (size_t i = 0; i < r->search->variable_count; i++) {
    const strut_search_variable *v = &r->search->variables[i];
    strut_buffer_add(b, "  %s = ", v->name);
    add_value(b, o->best.values[i], v->unit);
    if (w->bound[i])
      strut_buffer_add(b, ", its %s bound: the optimum may lie beyond",
                       w->bound[i] > 0 ? "upper" : "lower");
    strut_buffer_add(b, "\n");
  }
  add_check(r, w, o);
  add_neighbours(r, w, o);
  add_verdicts(r, w, o);
}

/* The points of a front, at most some. */
static void add_front(report *r, const strut_search_front *front) {
  enum { SHOWN = 12 };
  const strut_study_search *search = r->search;
  strut_buffer *b = &r->text;
  if (!front->count) return;
  add_outer(r, front->points[0].worst);
  strut_buffer_add(b, "%zu points are beaten by no other in both %s and %s%s; best.csv has all\n",
                   front->count, search->goal.text, search->second.text,
                   search->scenario_axes ? ", each in its worst scenario" : "");
  size_t shown = front->count < SHOWN ? front->count : SHOWN;
  for (size_t i = 0; i < shown; i++) {
    size_t at = shown > 1 ? i * (front->count - 1) / (shown - 1) : 0;
    const strut_search_point *p = &front->points[at];
    strut_buffer_add(b, "  ");
    add_number(b, p->objective, search->goal.program.unit);
    strut_buffer_add(b, ", ");
    add_number(b, p->second, search->second.program.unit);
    for (size_t k = 0; k < search->variable_count; k++) {
      strut_buffer_add(b, "%s%s = ", k ? ", " : " at ", search->variables[k].name);
      add_value(b, p->values[k], search->variables[k].unit);
    }
    strut_buffer_add(b, "\n");
  }
}

/* ---- JSON ---- */

static void add_json_point(strut_json *j, struct cJSON *to, const strut_study_search *search,
                           const strut_search_point *p) {
  strut_json_integer(j, to, "point", p->worst);
  strut_json_number(j, to, "objective", p->objective);
  if (search->second.text) strut_json_number(j, to, "objective_2", p->second);
  strut_json_number(j, to, "violation", p->violation);
  struct cJSON *values = strut_json_object(j, to, "values");
  for (size_t i = 0; i < search->variable_count; i++) {
    if (p->values[i].word)
      strut_json_text(j, values, search->variables[i].name, p->values[i].word);
    else
      strut_json_number(j, values, search->variables[i].name, p->values[i].number);
  }
}

static void add_json_outcome(strut_json *j, struct cJSON *list, const strut_study_search *search,
                             const strut_search_outcome *o) {
  static const char *const ends[] = {"used up", "converged", "repeats", "enumerated"};
  struct cJSON *item = strut_json_object(j, list, NULL);
  strut_json_integer(j, item, "outer", o->outer);
  strut_json_integer(j, item, "search", o->start + 1);
  strut_json_integer(j, item, "evaluations", o->evaluations);
  strut_json_integer(j, item, "repeated", o->repeated);
  strut_json_integer(j, item, "failed", o->failed);
  strut_json_integer(j, item, "without_objective", o->valueless);
  strut_json_integer(j, item, "feasible", o->feasible);
  strut_json_bool(j, item, "constant", o->constant);
  strut_json_text(j, item, "end", ends[o->end]);
  strut_json_numbers(j, item, "top", o->top, o->top_count);
  if (o->best.evaluation >= 0)
    add_json_point(j, strut_json_object(j, item, "best"), search, &o->best);
}

static void add_json_worth(strut_json *j, struct cJSON *list, const report *r,
                           const strut_search_worth *w) {
  const strut_search_outcome *o = &r->result->outcomes[w->best];
  struct cJSON *item = strut_json_object(j, list, NULL);
  strut_json_integer(j, item, "outer", o->outer);
  strut_json_integer(j, item, "search", o->start + 1);
  strut_json_bool(j, item, "feasible", o->best.violation <= 0.0);
  strut_json_integer(j, item, "agreeing", w->agreeing);
  add_json_point(j, item, r->search, &o->best);
  if (w->checked) strut_json_number(j, item, "check", w->check.objective);
  struct cJSON *bounds = strut_json_object(j, item, "bounds");
  struct cJSON *neighbours = strut_json_object(j, item, "neighbours");
  for (size_t i = 0; i < r->search->variable_count; i++) {
    const char *name = r->search->variables[i].name;
    if (w->bound[i]) strut_json_text(j, bounds, name, w->bound[i] > 0 ? "upper" : "lower");
    double near[2];
    for (int side = 0; side < 2; side++)
      near[side] =
          w->neighbours[i][side].there ? w->neighbours[i][side].point.objective : (double)NAN;
    strut_json_numbers(j, neighbours, name, near, 2);
  }
}

static char *make_json(const report *r, const strut_sweep_state *state, const char *table) {
  strut_json j = strut_json_begin();
  strut_json_integer(&j, j.root, "points", state->points);
  strut_json_integer(&j, j.root, "failed", state->failed);
  strut_json_integer(&j, j.root, "computed", state->computed);
  strut_json_text(&j, j.root, "table", table);
  strut_json_text(&j, j.root, r->search->maximise ? "maximise" : "minimise", r->search->goal.text);
  strut_json_text(&j, j.root, "unit", r->search->goal.program.unit);
  struct cJSON *best = strut_json_array(&j, j.root, "best");
  for (size_t i = 0; i < r->result->worth_count; i++)
    add_json_worth(&j, best, r, &r->result->worths[i]);
  struct cJSON *fronts = r->result->front_count ? strut_json_array(&j, j.root, "fronts") : NULL;
  for (size_t i = 0; i < r->result->front_count; i++) {
    struct cJSON *front = strut_json_array(&j, fronts, NULL);
    for (size_t k = 0; k < r->result->fronts[i].count; k++)
      add_json_point(&j, strut_json_object(&j, front, NULL), r->search,
                     &r->result->fronts[i].points[k]);
  }
  struct cJSON *searches = strut_json_array(&j, j.root, "searches");
  for (size_t i = 0; i < r->result->outcome_count; i++)
    add_json_outcome(&j, searches, r->search, &r->result->outcomes[i]);
  struct cJSON *warnings = strut_json_array(&j, j.root, "warnings");
  for (size_t i = 0; i < state->warning_count; i++) {
    struct cJSON *item = strut_json_object(&j, warnings, NULL);
    strut_json_text(&j, item, "code", state->warnings[i].code);
    strut_json_integer(&j, item, "runs", state->warnings[i].runs);
    strut_json_integer(&j, item, "point", state->warnings[i].point);
    strut_json_text(&j, item, "text", state->warnings[i].text);
  }
  return strut_json_end_line(&j);
}

char *strut_search_report(const strut_sweep_plan *plan, const strut_search_result *result,
                          const strut_sweep_state *state, const char *table, bool json) {
  report r = {.plan = plan, .search = plan->study->search, .result = result};
  char time[STRUT_DURATION_TEXT], *text;
  strut_c_locale locale = strut_c_locale_enter();
  if (json) {
    text = make_json(&r, state, table);
  } else {
    for (size_t i = 0; i < result->worth_count; i++) add_best(&r, &result->worths[i]);
    for (size_t i = 0; i < result->front_count; i++) add_front(&r, &result->fronts[i]);
    strut_duration_text(state->seconds, time);
    strut_buffer_add(&r.text, "%lld points, %lld failed; %lld computed in %s\n%s\n",
                     (long long)state->points, (long long)state->failed, (long long)state->computed,
                     time, table);
    text = strut_buffer_take(&r.text);
  }
  strut_c_locale_leave(locale);
  return text;
}

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
#include "engine/output/result_values.h"
#include "engine/study/sweep/grid.h"

/* Changes of the objective that count: of a more exact run, and among the best points. */
static const double STANDS = 0.02, FLAT = 1e-3;

typedef struct report {
  strut_buffer text;
  const strut_sweep_plan *plan;
  const strut_study_search *search;
  const strut_search_result *result;
  const strut_sweep_state *state;
  const char *table; /* its path */
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

static const strut_study_search *search_of(const strut_result_object *of) {
  return ((const report *)strut_result_whole(of))->search;
}

static const char *variable_name(const strut_result_object *of, size_t i) {
  return search_of(of)->variables[i].name;
}

static strut_value variable_value(const strut_result_object *of, size_t i) {
  const strut_study_value *value = &((const strut_search_point *)of->at)->values[i];
  return value->word ? STRUT_VALUE_AS_TEXT(value->word) : STRUT_VALUE_AS_NUMBER(value->number);
}

#define POINT(X)                                                                                   \
  X("point", "", COUNT(p->worst), "of the study: its worst scenario")                              \
  X("objective", "", NUMBER(p->objective), "there; null: it failed")                               \
  X("objective_2", "", IF(search_of(of)->second.text, NUMBER(p->second)), "of the second goal")    \
  X("violation", "1", NUMBER(p->violation), "of conditions, at worst; 0: they hold")               \
  X("values", "", MAP(search_of(of)->variable_count, variable_name, variable_value),               \
    "of the variables, SI")
STRUT_VALUES_HERE(point_values, POINT, const strut_search_point *p = of->at)

#define OUTCOME(X)                                                                                 \
  X("outer", "", COUNT(o->outer), "point of the axes before the searches")                         \
  X("search", "", COUNT(o->start + 1), "its number")                                               \
  X("evaluations", "", COUNT(o->evaluations), "of the objective")                                  \
  X("repeated", "", COUNT(o->repeated), "that were known")                                         \
  X("failed", "", COUNT(o->failed), "of them")                                                     \
  X("without_objective", "", COUNT(o->valueless), "of them")                                       \
  X("feasible", "", COUNT(o->feasible), "of them")                                                 \
  X("constant", "", FLAG(o->constant), "whether all objectives are the same")                      \
  X("end", "", TEXT(ends[o->end]), "why it ended")                                                 \
  X("top", "", NUMBERS(o->top, o->top_count), "its best objectives")                               \
  X("best", "", IF(o->best.evaluation >= 0, PART(&o->best)), "its best point",                     \
    .rows = &point_values)
static const char *const ends[] = {"used up", "converged", "repeats", "enumerated"};
STRUT_VALUES_HERE(outcome_values, OUTCOME, const strut_search_outcome *o = of->at)

static strut_value bound_of(const strut_result_object *of, size_t i) {
  int bound = ((const strut_search_worth *)of->at)->bound[i];
  return STRUT_VALUE_AS_IF(bound, TEXT(bound > 0 ? "upper" : "lower"));
}

static strut_value neighbours_of(const strut_result_object *of, size_t i) {
  const strut_search_neighbour *near = ((const strut_search_worth *)of->at)->neighbours[i];
  return STRUT_VALUE_AS_OF_STRUCTS(&near->point.objective, 2, sizeof *near);
}

#define WORTH(X)                                                                                   \
  X("outer", "", COUNT(o->outer), "point of the axes before the searches")                         \
  X("search", "", COUNT(o->start + 1), "that found it")                                            \
  X("feasible", "", FLAG(o->best.violation <= 0.0), "whether all conditions hold")                 \
  X("agreeing", "", COUNT(w->agreeing), "searches whose best is within 1 % of it")                 \
  X(NULL, "", PART(&o->best), "", .rows = &point_values)                                           \
  X("check", "", IF(w->checked, NUMBER(w->check.objective)), "the objective, more exactly")        \
  X("bounds", "", MAP(r->search->variable_count, variable_name, bound_of),                         \
    "on which variables are: upper, lower")                                                        \
  X("neighbours", "", MAP(r->search->variable_count, variable_name, neighbours_of),                \
    "objectives 1 % of the range below and above")
STRUT_VALUES_HERE(worth_values, WORTH, const strut_search_worth *w = of->at;
                  const report *r = of->outer->at;
                  const strut_search_outcome *o = &r->result->outcomes[w->best])

static strut_value front_of(const strut_result_object *of, size_t i) {
  const strut_search_front *front = &((const report *)of->at)->result->fronts[i];
  return STRUT_VALUE_AS_LIST(front->points, front->count);
}

#define WARNING(X)                                                                                 \
  X("code", "", TEXT(warning->code), "for programs")                                               \
  X("runs", "", COUNT(warning->runs), "that it is about")                                          \
  X("point", "", COUNT(warning->point), "the first of them")                                       \
  X("text", "", TEXT(warning->text), "finding, likely cause and remedy")
STRUT_VALUES_HERE(warning_values, WARNING, const strut_sweep_warning *warning = of->at)

#define SEARCH(X)                                                                                  \
  X("points", "", COUNT(r->state->points), "of the table")                                         \
  X("failed", "", COUNT(r->state->failed), "of them")                                              \
  X("computed", "", COUNT(r->state->computed), "of them, by this call")                            \
  X("table", "", TEXT(r->table), "its path")                                                       \
  X("maximise", "", IF(r->search->maximise, TEXT(r->search->goal.text)), "the objective")          \
  X("minimise", "", IF(!r->search->maximise, TEXT(r->search->goal.text)), "the objective")         \
  X("unit", "", TEXT(r->search->goal.program.unit), "of it")                                       \
  X("best", "", LIST(r->result->worths, r->result->worth_count), "points", .rows = &worth_values)  \
  X("fronts", "", IF(r->result->front_count, ARRAY(r->result->front_count, front_of)),             \
    "of two objectives: lists of points", .rows = &point_values)                                   \
  X("searches", "", LIST(r->result->outcomes, r->result->outcome_count), "one by one",             \
    .rows = &outcome_values)                                                                       \
  X("warnings", "", LIST(r->state->warnings, r->state->warning_count), "of runs",                  \
    .rows = &warning_values)
STRUT_VALUES(strut_search_report_values, SEARCH, const report *r = of->at)

char *strut_search_report(const strut_sweep_plan *plan, const strut_search_result *result,
                          const strut_sweep_state *state, const char *table, bool json) {
  report r = {{0}, plan, plan->study->search, result, state, table};
  char time[STRUT_DURATION_TEXT], *text;
  strut_c_locale locale = strut_c_locale_enter();
  if (json) {
    text = strut_values_json(&strut_search_report_values, &r, NULL);
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

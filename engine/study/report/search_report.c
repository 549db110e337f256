/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a search has found, and what it is worth. */
#include <stdio.h>

#include "engine/base/text.h"
#include "engine/output/result_values.h"
#include "engine/study/report/study_report.h"
#include "engine/study/sweep/grid.h"

/* A number in the unit of a goal. */
#define STRUT_VALUE_AS_IN(UNIT, NUMBER) STRUT_VALUE_AS_CALLED(NULL, UNIT, NUMBER)

static const char *goal_unit(strut_search_formula goal) { return goal.program.unit; }

static const strut_study_search *search_of(const strut_result_object *of) {
  return ((const strut_search_report *)strut_result_whole(of))->search;
}

static const char *variable_name(const strut_result_object *of, size_t i) {
  return search_of(of)->variables[i].name;
}

static strut_value variable_value(const strut_result_object *of, size_t i) {
  const strut_study_value *value = &((const strut_search_point *)of->at)->values[i];
  strut_value own = STRUT_VALUE_AS_CALLED(NULL, search_of(of)->variables[i].unit, value->number);
  return value->word ? STRUT_VALUE_AS_TEXT(value->word) : own;
}

/* "friction = 0.1, start = I": the axes before the searches, at a best point. */
static void write_outer(const strut_result_object *of, char text[STRUT_VALUE_ROOM]) {
  const strut_search_worth *worth = of->at;
  const strut_search_report *report = strut_result_whole(of);
  const strut_study *study = report->plan->study;
  strut_study_value values[64];
  size_t count = 0, used = 0;
  for (size_t i = 0; i < report->search->axis; i++) count += study->axes[i].column_count;
  if (!count || report->plan->axis_columns > sizeof values / sizeof values[0]) return;
  strut_grid_values(study, report->result->outcomes[worth->best].best.worst, values);
  for (size_t i = 0; i < count && used < STRUT_VALUE_ROOM; i++)
    used += (size_t)snprintf(
        text + used, STRUT_VALUE_ROOM - used, "%s%s = %s", i ? ", " : "",
        report->plan->columns[i].name,
        values[i].word
            ? values[i].word
            : strut_quantity_of_any(values[i].number, 6, report->plan->columns[i].unit).text);
}

#define POINT(X)                                                                                   \
  X("point", "", COUNT(p->worst), "of the study: its worst scenario")                              \
  X("objective", "", IN(goal_unit(search_of(of)->goal), p->objective), "there; null: it failed",   \
    .label = {""})                                                                                 \
  X("objective_2", "",                                                                             \
    IF(search_of(of)->second.text, IN(goal_unit(search_of(of)->second), p->second)),               \
    "of the second goal", .label = {""})                                                           \
  X("violation", "1", NUMBER(p->violation), "of conditions, at worst; 0: they hold",               \
    .label = {""})                                                                                 \
  X("values", "", MAP(search_of(of)->variable_count, variable_name, variable_value),               \
    "of the variables, SI", .label = {""})
STRUT_VALUES_HERE(point_values, POINT, const strut_search_point *p = of->at)

#define OUTCOME(X)                                                                                 \
  X("outer", "", COUNT(o->outer), "point of the axes before the searches")                         \
  X("search", "", COUNT(o->start + 1), "its number", .label = {""})                                \
  X("evaluations", "", COUNT(o->evaluations), "of the objective", .label = {""})                   \
  X("repeated", "", COUNT(o->repeated), "that were known")                                         \
  X("failed", "", COUNT(o->failed), "of them", .label = {""})                                      \
  X("without_objective", "", COUNT(o->valueless), "of them")                                       \
  X("feasible", "", COUNT(o->feasible), "of them", .label = {""})                                  \
  X("constant", "", FLAG(o->constant), "whether all objectives are the same")                      \
  X("end", "", TEXT(ends[o->end]), "why it ended", .label = {""})                                  \
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
  X(NULL, "", WORDS(write_outer), "", .label = {"at"})                                             \
  X("search", "", COUNT(o->start + 1), "that found it", .label = {""})                             \
  X("feasible", "", FLAG(o->best.violation <= 0.0), "whether all conditions hold", .label = {""})  \
  X("agreeing", "", COUNT(w->agreeing), "searches whose best is within 1 % of it",                 \
    .label = {"searches that agree"})                                                              \
  X(NULL, "", PART(&o->best), "", .rows = &point_values)                                           \
  X("check", "", IF(w->checked, IN(goal_unit(r->search->goal), w->check.objective)),               \
    "the objective, more exactly", .label = {"more exactly"})                                      \
  X("bounds", "", MAP(r->search->variable_count, variable_name, bound_of),                         \
    "on which variables are: upper, lower", .label = {"bound"})                                    \
  X("neighbours", "", MAP(r->search->variable_count, variable_name, neighbours_of),                \
    "objectives 1 % of the range below and above", .label = {"beside"})
STRUT_VALUES_HERE(worth_values, WORTH, const strut_search_worth *w = of->at;
                  const strut_search_report *r = of->outer->at;
                  const strut_search_outcome *o = &r->result->outcomes[w->best])

static strut_value front_of(const strut_result_object *of, size_t i) {
  const strut_search_front *front = &((const strut_search_report *)of->at)->result->fronts[i];
  return STRUT_VALUE_AS_LIST(front->points, front->count);
}

#define SEARCH(X)                                                                                  \
  X(NULL, "", PART(&r->end), "", .rows = &strut_sweep_end_values)                                  \
  X("maximise", "", IF(r->search->maximise, TEXT(r->search->goal.text)), "the objective",          \
    .label = {""})                                                                                 \
  X("minimise", "", IF(!r->search->maximise, TEXT(r->search->goal.text)), "the objective",         \
    .label = {""})                                                                                 \
  X("unit", "", TEXT(r->search->goal.program.unit), "of it")                                       \
  X("best", "", LIST(r->result->worths, r->result->worth_count), "points", .rows = &worth_values,  \
    .label = {""})                                                                                 \
  X("fronts", "", IF(r->result->front_count, ARRAY(r->result->front_count, front_of)),             \
    "of two objectives: lists of points", .rows = &point_values, .label = {"front"})               \
  X("searches", "", LIST(r->result->outcomes, r->result->outcome_count), "one by one",             \
    .rows = &outcome_values, .label = {""})
STRUT_VALUES(strut_search_report_values, SEARCH, const strut_search_report *r = of->at)

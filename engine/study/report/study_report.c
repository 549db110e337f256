/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is told of a sweep, its points and columns, how far it is, its end; and what a search has found. */
#include "engine/study/report/study_report.h"

#include <stdio.h>

#include "engine/base/text.h"

static strut_value column_of(const strut_result_object *of, size_t i) {
  return STRUT_VALUE_AS_TEXT(((const strut_sweep_plan *)of->at)->columns[i].name);
}

#define COUNTED(X)                                                                                 \
  X("points", "", IF(!open, COUNT(refined ? strut_refinement_coarse(plan) : plan->points)),        \
    "of a map before it is refined", .label = {""})                                                \
  X("points", "", IF(open, COUNT(plan->points)), "at most, of a search or a fit",                  \
    .label = {"points at most"})                                                                   \
  X("most_points", "", IF(refined, COUNT(plan->points)), "of the finest grid", .label = {""})      \
  X("columns", "", ARRAY(plan->column_count, column_of), "of the table", .label = {""})
STRUT_VALUES(strut_sweep_count_values, COUNTED, const strut_sweep_plan *plan = of->at;
             bool refined = plan->study->refine.depth > 0;
             bool open = plan->study->search || plan->study->fit)

/* ---- how far it is ---- */

/* Ranges of missing points, and the failed ones, the first few of both. */
void strut_slots_progress_find(strut_slots *slots, strut_slots_progress *p) {
  const int64_t count = strut_slots_description_of(slots)->count;
  *p = (strut_slots_progress){.points = count,
                              .missing = strut_slots_missing(slots),
                              .failed = strut_slots_failed(slots),
                              .started = true};
  p->done = count - p->missing;
  for (int64_t i = 0; i < count && p->gap_count < STRUT_STATUS_GAPS; i++) {
    int64_t first = i;
    while (i < count && !strut_slots_done(slots, strut_slots_point(slots, i))) i++;
    if (i == first) continue;
    p->gaps[p->gap_count][0] = (double)strut_slots_point(slots, first);
    p->gaps[p->gap_count++][1] = (double)strut_slots_point(slots, i - 1);
  }
  for (int64_t i = 0; i < count && p->failed && p->failure_count < STRUT_STATUS_FAILURES; i++) {
    strut_result_slot row;
    const int64_t point = strut_slots_point(slots, i);
    if (!strut_slots_get(slots, point, &row) || row.status == STRUT_OK) continue;
    struct strut_failed_point *failure = &p->failures[p->failure_count++];
    failure->point = point, failure->status = row.status;
    snprintf(failure->message, sizeof failure->message, "%s", row.message ? row.message : "");
  }
}

#define FAILURE(X)                                                                                 \
  X("point", "", COUNT(f->point), "of the study", .label = {""})                                   \
  X("status", "", TEXT(strut_status_text(f->status)), "why", .label = {""})                        \
  X("message", "", TEXT(f->message), "a sentence", .label = {""})
STRUT_VALUES_HERE(failure_values, FAILURE, const struct strut_failed_point *f = of->at)

#define PROGRESS(X)                                                                                \
  X("done", "", COUNT(p->done), "of them, failed ones too", .label = {""})                         \
  X("missing", "", IF(p->started && !open, COUNT(p->missing)), "of them", .label = {""})           \
  X("failed", "", IF(p->started, COUNT(p->failed)), "of the done", .label = {""})
STRUT_VALUES_HERE(counted_values, PROGRESS, const strut_slots_progress *p = of->at;
                  bool open = p->searches || p->most_points)

/* "3, 7 to 9": the first ranges of missing points. */
static void write_gaps(const strut_result_object *of, char text[STRUT_VALUE_ROOM]) {
  const strut_slots_progress *progress = of->at;
  for (size_t i = 0, used = 0; i < progress->gap_count && used < STRUT_VALUE_ROOM; i++)
    used +=
        (size_t)snprintf(text + used, STRUT_VALUE_ROOM - used,
                         progress->gaps[i][0] < progress->gaps[i][1] ? "%s%.0f to %.0f" : "%s%.0f",
                         i ? ", " : "", progress->gaps[i][0], progress->gaps[i][1]);
}

#define STATUS(X)                                                                                  \
  X("points", "", COUNT(p->points), "of the file", .label = {""})                                  \
  X(NULL, "", SAME, "", .rows = &counted_values)                                                   \
  X("finished", "", IF(p->searches, FLAG(p->finished)), "whether the searches are", .label = {""}) \
  X("most_points", "", IF(p->most_points, COUNT(p->most_points)), "of the finest grid",            \
    .label = {""})                                                                                 \
  X("gaps", "", IF(!open, TABLE(p->gaps, p->gap_count, 2)), "first and last of missing points")    \
  X(NULL, "", IF(!open, WORDS(write_gaps)), "", .label = {"gaps"})                                 \
  X("failures", "", IF(!open, LIST(p->failures, p->failure_count)), "the first",                   \
    .rows = &failure_values, .label = {""})
STRUT_VALUES(strut_slots_progress_values, STATUS, const strut_slots_progress *p = of->at;
             bool open = p->searches || p->most_points)

/* ---- shards ---- */

strut_status strut_shards_progress_find(const char *directory, const strut_shards_found *found,
                                        strut_arena *arena, strut_shards_progress *progress,
                                        strut_error *error) {
  size_t count = (size_t)found->count;
  *progress =
      (strut_shards_progress){count, strut_arena_allocate(arena, count, sizeof *progress->shards)};
  if (!progress->shards) return strut_no_memory(error, "");
  for (size_t i = 0; i < count; i++) {
    strut_slots *slots = NULL;
    strut_slots_description plan;
    if (found->there[i]) {
      const char *path =
          strut_shard_path(directory, (strut_shard){(int64_t)i, found->count}, arena);
      strut_status status =
          path ? strut_slots_read(path, &slots, &plan, error) : strut_no_memory(error, "");
      if (status) return status;
      strut_slots_progress_find(slots, &progress->shards[i]);
      strut_slots_close(slots);
    }
    progress->shards[i].shard = (int64_t)i;
  }
  return STRUT_OK;
}

#define SHARD(X)                                                                                   \
  X("shard", "", COUNT(p->shard), "its number, from 0", .label = {""})                             \
  X("points", "", IF(p->started, COUNT(p->points)), "of it", .label = {""})                        \
  X(NULL, "", SAME, "", .rows = &counted_values)
STRUT_VALUES_HERE(shard_values, SHARD, const strut_slots_progress *p = of->at)

#define SHARDS(X)                                                                                  \
  X("shard_count", "", COUNT(s->count), "of the study")                                            \
  X("shards", "", LIST(s->shards, s->count), "one by one", .rows = &shard_values, .label = {""})
STRUT_VALUES(strut_shards_progress_values, SHARDS, const strut_shards_progress *s = of->at)

/* ---- the end ---- */

#define WARNING(X)                                                                                 \
  X("code", "", TEXT(warning->code), "for programs")                                               \
  X("runs", "", COUNT(warning->runs), "that it is about")                                          \
  X("point", "", COUNT(warning->point), "the first of them")                                       \
  X("text", "", TEXT(warning->text), "finding, likely cause and remedy")
STRUT_VALUES_HERE(warning_values, WARNING, const strut_sweep_warning *warning = of->at)

static void write_seconds(const strut_result_object *of, char text[STRUT_VALUE_ROOM]) {
  strut_duration_text(((const strut_sweep_end *)of->at)->state->seconds, text);
}

#define END(X)                                                                                     \
  X("points", "", COUNT(state->points), "of the table", .label = {""})                             \
  X("failed", "", COUNT(state->failed), "of them", .label = {""})                                  \
  X("computed", "", COUNT(state->computed), "of them, by this call", .label = {""})                \
  X(NULL, "", WORDS(write_seconds), "", .label = {"in"})                                           \
  X("table", "", TEXT(((const strut_sweep_end *)of->at)->table), "its path", .label = {""})        \
  X("warnings", "", LIST(state->warnings, state->warning_count), "of runs", .rows = &warning_values)
STRUT_VALUES(strut_sweep_end_values, END,
             const strut_sweep_state *state = ((const strut_sweep_end *)of->at)->state)

/* What a search has found, and what it is worth. */

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
  strut_value both = STRUT_VALUE_AS_OF_STRUCTS(&near->point.objective, 2, sizeof *near);
  both.own_unit = goal_unit(search_of(of)->goal);
  return both;
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

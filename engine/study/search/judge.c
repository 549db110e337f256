/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <string.h>

#include "engine/run/measure/quantities.h"
#include "engine/study/search/search_parts.h"

/* Numbers on the stack of a program and its columns, at most: the reader bounds the text. */
enum { MOST = 1024 };

/* The columns of a program become ranks, once the table is known. */
static bool resolve(const strut_sweep_plan *plan, strut_search_formula *formula) {
  if (formula->program.length > MOST || formula->program.depth > MOST) return false;
  for (size_t i = 0; i < formula->program.length; i++) {
    strut_instruction *instruction = &formula->program.program[i];
    if (instruction->operation != STRUT_OPERATION_COLUMN) continue;
    instruction->column.item =
        (int32_t)strut_slot_place(plan->columns, (size_t)instruction->column.item);
  }
  return true;
}

strut_status strut_search_add_columns(strut_sweep_plan *plan, strut_error *error) {
  strut_study_search *search = plan->study->search;
  bool two = search->second.text != NULL;
  bool fine = resolve(plan, &search->goal) && (!two || resolve(plan, &search->second));
  for (size_t i = 0; i < search->condition_count && fine; i++) {
    strut_search_condition *condition = &search->conditions[i];
    if (condition->word)
      condition->column = strut_slot_place(plan->columns, condition->column);
    else
      fine = resolve(plan, &condition->left) && resolve(plan, &condition->right);
  }
  if (!fine) return strut_fail(error, STRUT_USAGE, "an expression of the search is too long");
  const char *unit = search->second.program.unit;
  if (!strut_sweep_add_column(plan, "", "objective", search->goal.program.unit, false) ||
      (two && !strut_sweep_add_column(plan, "", "objective_2", unit, false)) ||
      !strut_sweep_add_column(plan, "", "violation", "1", false))
    return strut_no_memory(error, "");
  return STRUT_OK;
}

/* A way along derivatives, in widths of the box. */
static const double NEARBY = 1e-6;

static double evaluate(const strut_search_formula *formula, const double *numbers) {
  size_t index[MOST];
  double stack[MOST];
  for (size_t i = 0; i < formula->program.length; i++)
    index[i] = formula->program.program[i].operation == STRUT_OPERATION_COLUMN
                   ? (size_t)formula->program.program[i].column.item
                   : 0;
  return strut_quantity_program_evaluate(&formula->program, index, numbers, stack, NULL);
}

static double broken_by(const strut_search_condition *condition, const double *numbers,
                        const char (*words)[STRUT_SLOT_WORD]) {
  if (condition->word) {
    bool same = strcmp(words[condition->column], condition->word) == 0;
    return same == (condition->relation == STRUT_SEARCH_IS) ? 0.0 : 1.0;
  }
  double left = evaluate(&condition->left, numbers), right = evaluate(&condition->right, numbers);
  double size = fabs(right) > 0.0 ? fabs(right) : 1.0;
  double excess = (condition->relation == STRUT_SEARCH_BELOW ? left - right : right - left) / size;
  return isfinite(excess) ? excess : 1.0;
}

double strut_search_score(const strut_sweep_plan *plan, const double *numbers,
                          const char (*words)[STRUT_SLOT_WORD], double *second, double *broken) {
  const strut_study_search *search = plan->study->search;
  for (size_t i = 0; i < search->condition_count; i++)
    broken[i] = broken_by(&search->conditions[i], numbers, words);
  double goal = evaluate(&search->goal, numbers);
  *second = search->second.text ? evaluate(&search->second, numbers) : 0.0;
  if (!isfinite(*second)) *second = (double)NAN;
  return isfinite(goal) ? goal : (double)NAN;
}

double strut_search_violation(const strut_study_search *search, const double *broken) {
  double most = 0.0;
  for (size_t i = 0; i < search->condition_count; i++) most = fmax(most, broken[i]);
  return most;
}

/* Rows of the table as points of a search. See search_parts.h. */

/* Has the row these values of the variables? */
static bool has_values(const strut_sweep_plan *plan, const strut_result_slot *row,
                       const strut_study_value *values) {
  const strut_study_search *search = plan->study->search;
  size_t numbers = 0, words = 0;
  bool same = true;
  for (size_t i = 0; i < plan->axis_columns; i++) {
    bool ours = i >= search->column;
    if (plan->columns[i].word) {
      const char *word = row->words[words++];
      same = same && (!ours || strcmp(word, values[i - search->column].word) == 0);
    } else {
      double number = row->numbers[numbers++];
      same = same && (!ours || number == values[i - search->column].number);
    }
  }
  return same;
}

bool strut_search_better(const strut_study_search *search, const strut_search_point *first,
                         const strut_search_point *second) {
  bool known = first->evaluation >= 0 && !isnan(first->objective);
  bool other = second->evaluation >= 0 && !isnan(second->objective);
  if (!known || !other) return known && !other;
  if (first->violation != second->violation && (first->violation > 0.0 || second->violation > 0.0))
    return first->violation < second->violation;
  return search->maximise ? first->objective > second->objective
                          : first->objective < second->objective;
}

strut_status strut_search_judge(const strut_sweep_plan *plan, strut_slots *slots, int64_t outer,
                                int64_t row, strut_search_point *point, double *broken,
                                strut_error *error) {
  const strut_study_search *search = plan->study->search;
  const strut_search_layout l = strut_search_layout_of(plan);
  int64_t first = (outer * l.rows + row) * l.scenarios;
  *point = (strut_search_point){.evaluation = row,
                                .worst = first,
                                .objective = (double)NAN,
                                .second = (double)NAN,
                                .values = point->values};
  for (size_t i = 0; i < l.conditions; i++) broken[i] = -HUGE_VAL;
  for (int64_t i = 0; i < l.scenarios; i++) {
    strut_result_slot slot;
    double own[STRUT_SEARCH_MOST_CONDITIONS], second;
    if (!strut_slots_get(slots, first + i, &slot))
      return strut_fail(error, STRUT_FILE_TROUBLE, "point %lld cannot be read",
                        (long long)(first + i));
    if (!has_values(plan, &slot, point->values))
      return strut_fail(error, STRUT_FILE_TROUBLE,
                        "point %lld of the results there is not what this search asks for, as by "
                        "another version of NLopt: remove points.slots to start afresh",
                        (long long)(first + i));
    if (slot.status) {
      point->failed = true;
      continue;
    }
    double goal = strut_search_score(plan, slot.numbers, slot.words, &second, own);
    point->valueless = point->valueless || isnan(goal) || isnan(second);
    point->violation = fmax(point->violation, strut_search_violation(search, own));
    for (size_t k = 0; k < l.conditions; k++) broken[k] = fmax(broken[k], own[k]);
    bool worse = search->maximise ? goal < point->objective : goal > point->objective;
    bool worse_second = search->maximise ? second < point->second : second > point->second;
    if (worse_second || isnan(point->second)) point->second = second;
    if (worse || isnan(point->objective)) point->objective = goal, point->worst = first + i;
  }
  if (point->failed || point->valueless) point->objective = (double)NAN;
  return STRUT_OK;
}

/* The goal where all numbers of a row have gone on along their derivatives by a variable. */
static double goal_along(const strut_sweep_plan *plan, const double *numbers, size_t variable,
                         double way, double *moved) {
  const strut_study_search *search = plan->study->search;
  memcpy(moved, numbers, plan->column_count * sizeof *moved);
  moved[strut_slot_place(plan->columns, search->column + variable)] += way;
  for (size_t j = 0; j < plan->derived_count; j++) {
    size_t at = strut_slot_place(plan->columns, plan->first_derivative) +
                2 * (j * plan->by_count + variable);
    moved[strut_slot_place(plan->columns, plan->derived[j].column)] += way * numbers[at];
  }
  return evaluate(&search->goal, moved);
}

strut_status strut_search_gradient(const strut_sweep_plan *plan, strut_slots *slots,
                                   const strut_search_point *point, double *gradient,
                                   strut_error *error) {
  const strut_study_search *search = plan->study->search;
  strut_result_slot slot;
  double *numbers = strut_allocate(2 * plan->column_count, sizeof *numbers);
  bool there = strut_slots_get(slots, point->worst, &slot) && !slot.status;
  if (!numbers) return strut_no_memory(error, "");
  size_t count = strut_slot_place(plan->columns, plan->column_count - 1) + 1;
  if (there) memcpy(numbers, slot.numbers, count * sizeof *numbers);
  for (size_t i = 0; i < search->variable_count; i++) {
    const strut_search_variable *variable = &search->variables[i];
    double range = variable->to - variable->from, way = NEARBY * range;
    double forth = goal_along(plan, numbers, i, way, numbers + plan->column_count);
    double back = goal_along(plan, numbers, i, -way, numbers + plan->column_count);
    if (variable->logarithmic) range = point->values[i].number * log(variable->to / variable->from);
    gradient[i] = there ? (forth - back) / (2.0 * way) * range : (double)NAN;
  }
  strut_release(numbers);
  return STRUT_OK;
}

void strut_search_values(const strut_sweep_plan *plan, int64_t point,
                         const strut_study_value *values, strut_study_value *all) {
  const strut_study_search *search = plan->study->search;
  strut_grid_values(plan->study, point, all);
  for (size_t i = 0; i < search->variable_count; i++) all[search->column + i] = values[i];
}

/* What a best point is worth: computed more exactly, and beside its neighbours. See search_parts.h. */

/* How far neighbours are, in widths of the box, and which starts agree, of the best's size. */
static const double BESIDE = 0.01, AGREEING = 0.01;

/* A value beside another. False: there is none. */
static bool beside(const strut_search_variable *variable, strut_study_value at, int side,
                   strut_study_value *value) {
  double number = strut_search_number(variable, at), step = BESIDE;
  if (variable->choice_count) return false;
  if (variable->integer) step = 1.0 / (double)strut_search_count(variable);
  number += side * step;
  if (!variable->wraps && (number < 0.0 || number > 1.0)) return false;
  *value = strut_search_value(variable, number);
  return !strut_search_same(*value, at);
}

/* The best search of an outer point, or SIZE_MAX. */
static size_t best_of(const strut_search_batch *batch, const strut_search_result *result,
                      int64_t outer) {
  const strut_study_search *search = batch->plan->study->search;
  size_t best = SIZE_MAX;
  for (size_t i = 0; i < result->outcome_count; i++) {
    const strut_search_outcome *outcome = &result->outcomes[i];
    if (outcome->outer != outer || outcome->best.evaluation < 0) continue;
    if (best == SIZE_MAX ||
        strut_search_better(search, &outcome->best, &result->outcomes[best].best))
      best = i;
  }
  return best;
}

static int32_t count_agreeing(const strut_search_result *result, size_t best) {
  const strut_search_outcome *first = &result->outcomes[best];
  double size = strut_search_size(first);
  int32_t count = 0;
  if (size == 0.0) size = first->most - first->least;
  for (size_t i = 0; i < result->outcome_count; i++) {
    const strut_search_outcome *outcome = &result->outcomes[i];
    double apart = fabs(outcome->best.objective - first->best.objective);
    bool alike = (outcome->best.violation > 0.0) == (first->best.violation > 0.0);
    count += outcome->outer == first->outer && outcome->best.evaluation >= 0 && alike &&
             apart <= AGREEING * size;
  }
  return count;
}

static strut_study_value *copy_values(strut_search_batch *batch, strut_search_result *result,
                                      const strut_study_value *values) {
  size_t n = batch->plan->study->search->variable_count;
  strut_study_value *copy = strut_arena_allocate(&result->arena, n, sizeof *copy);
  if (copy) memcpy(copy, values, n * sizeof *copy);
  return copy;
}

/* Lists the points to be computed about a best one. False: no memory. */
static bool list_points(strut_search_batch *batch, strut_search_result *result,
                        strut_search_worth *worth) {
  const strut_study_search *search = batch->plan->study->search;
  const strut_search_outcome *outcome = &result->outcomes[worth->best];
  size_t n = search->variable_count;
  worth->agreeing = count_agreeing(result, worth->best);
  worth->checked = batch->plan->study->compute == STRUT_COMPUTE_RUN;
  if (!STRUT_ALLOCATE(&result->arena, STRUT_NEW(worth->bound, n), STRUT_NEW(worth->neighbours, n)))
    return false;
  worth->check.values = outcome->best.values;
  bool fine = !worth->checked || strut_search_batch_add(batch, outcome->outer, batch->first_check,
                                                        outcome->best.values);
  for (size_t i = 0; i < n && fine; i++) {
    worth->bound[i] = strut_search_bound(&search->variables[i], outcome->best.values[i]);
    for (int side = 0; side < 2 && fine; side++) {
      strut_search_neighbour *near = &worth->neighbours[i][side];
      strut_study_value value;
      near->point.objective = (double)NAN;
      near->there = beside(&search->variables[i], outcome->best.values[i], side ? 1 : -1, &value);
      if (!near->there) continue;
      strut_study_value *values = copy_values(batch, result, outcome->best.values);
      if (!values) return false;
      values[i] = value;
      near->point.values = values;
      fine = strut_search_batch_add(batch, outcome->outer,
                                    batch->first_check + 1 + 2 * (int64_t)i + side, values);
    }
  }
  return fine;
}

static strut_status judge(strut_search_batch *batch, int64_t outer, int64_t row,
                          strut_search_point *point) {
  double broken[STRUT_SEARCH_MOST_CONDITIONS];
  return strut_search_judge(batch->plan, batch->points.slots, outer, row, point, broken,
                            batch->points.error);
}

static strut_status judge_points(strut_search_batch *batch, strut_search_result *result,
                                 strut_search_worth *worth) {
  int64_t outer = result->outcomes[worth->best].outer;
  strut_status status = STRUT_OK;
  if (worth->checked) status = judge(batch, outer, batch->first_check, &worth->check);
  for (size_t i = 0; i < batch->plan->study->search->variable_count && !status; i++)
    for (int side = 0; side < 2 && !status; side++)
      if (worth->neighbours[i][side].there)
        status = judge(batch, outer, batch->first_check + 1 + 2 * (int64_t)i + side,
                       &worth->neighbours[i][side].point);
  return status;
}

strut_status strut_search_find_worth(strut_search_batch *batch, strut_search_result *result) {
  const strut_search_layout l = strut_search_layout_of(batch->plan);
  result->worths = strut_arena_allocate(&result->arena, (size_t)l.outers, sizeof *result->worths);
  if (!result->worths) return strut_no_memory(batch->points.error, "");
  if (result->front_count) return STRUT_OK; /* there is no one best */
  for (int64_t outer = 0; outer < l.outers; outer++) {
    size_t best = best_of(batch, result, outer);
    if (best == SIZE_MAX) continue;
    strut_search_worth *worth = &result->worths[result->worth_count++];
    worth->best = best;
    if (!list_points(batch, result, worth)) return strut_no_memory(batch->points.error, "");
  }
  strut_status status = strut_search_batch_run(batch);
  for (size_t i = 0; i < result->worth_count && !status; i++)
    status = judge_points(batch, result, &result->worths[i]);
  return status;
}

/* The points of two goals that no other point is better than in both. See search_parts.h. */

/* Is a at least as good as b in both goals? */
static bool covers(const strut_study_search *search, const strut_search_point *first,
                   const strut_search_point *second) {
  if (search->maximise)
    return first->objective >= second->objective && first->second >= second->second;
  return first->objective <= second->objective && first->second <= second->second;
}

static bool make_room(strut_search_front *front, strut_arena *arena) {
  if (front->count < front->room) return true;
  size_t room = front->room ? 2 * front->room : 32;
  strut_search_point *points = strut_arena_allocate(arena, room, sizeof *points);
  if (!points) return false;
  if (front->count) memcpy(points, front->points, front->count * sizeof *points);
  front->points = points;
  front->room = room;
  return true;
}

bool strut_search_front_take(const strut_study_search *search, strut_search_front *front,
                             const strut_search_point *point, strut_arena *arena) {
  size_t n = search->variable_count, kept = 0, at = 0;
  for (size_t i = 0; i < front->count; i++)
    if (covers(search, &front->points[i], point)) return true;
  strut_study_value *values = strut_arena_allocate(arena, n, sizeof *values);
  if (!values || !make_room(front, arena)) return false;
  memcpy(values, point->values, n * sizeof *values);
  for (size_t i = 0; i < front->count; i++)
    if (!covers(search, point, &front->points[i])) front->points[kept++] = front->points[i];
  front->count = kept;
  while (at < kept && front->points[at].objective < point->objective) at++;
  if (!make_room(front, arena)) return false;
  memmove(front->points + at + 1, front->points + at, (kept - at) * sizeof *front->points);
  front->points[at] = *point;
  front->points[at].values = values;
  front->count++;
  return true;
}

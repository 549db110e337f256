/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/search/score.h"

#include <math.h>
#include <string.h>

#include "engine/run/measure/quantities.h"
#include "engine/study/sweep/sweep_parts.h"

/* Numbers on the stack of a program and its columns, at most: the reader bounds the text. */
enum { MOST = 1024 };

/* Rank of a column among those with numbers, or among those with words. */
static size_t rank_of(const strut_sweep_plan *plan, size_t column) {
  size_t rank = 0;
  for (size_t i = 0; i < column; i++) rank += plan->columns[i].word == plan->columns[column].word;
  return rank;
}

/* The columns of a program become ranks, once the table is known. */
static bool resolve(const strut_sweep_plan *plan, strut_search_formula *f) {
  if (f->program.length > MOST || f->program.depth > MOST) return false;
  for (size_t i = 0; i < f->program.length; i++) {
    strut_instruction *p = &f->program.program[i];
    if (p->operation != STRUT_OPERATION_COLUMN) continue;
    p->column.item = (int32_t)rank_of(plan, (size_t)p->column.item);
  }
  return true;
}

strut_status strut_search_add_columns(strut_sweep_plan *plan, strut_error *error) {
  strut_study_search *search = plan->study->search;
  bool two = search->second.text != NULL;
  bool fine = resolve(plan, &search->goal) && (!two || resolve(plan, &search->second));
  for (size_t i = 0; i < search->condition_count && fine; i++) {
    strut_search_condition *c = &search->conditions[i];
    if (c->word)
      c->column = rank_of(plan, c->column);
    else
      fine = resolve(plan, &c->left) && resolve(plan, &c->right);
  }
  if (!fine) return strut_fail(error, STRUT_USAGE, "an expression of the search is too long");
  const char *unit = search->second.program.unit;
  if (!strut_sweep_add_column(plan, "", "objective", search->goal.program.unit, false) ||
      (two && !strut_sweep_add_column(plan, "", "objective_2", unit, false)) ||
      !strut_sweep_add_column(plan, "", "violation", "1", false))
    return strut_no_memory(error, "");
  return STRUT_OK;
}

static double evaluate(const strut_search_formula *f, const double *numbers) {
  size_t index[MOST];
  double stack[MOST];
  for (size_t i = 0; i < f->program.length; i++)
    index[i] = f->program.program[i].operation == STRUT_OPERATION_COLUMN
                   ? (size_t)f->program.program[i].column.item
                   : 0;
  return strut_quantity_program_evaluate(&f->program, index, numbers, stack);
}

static double broken_by(const strut_search_condition *c, const double *numbers,
                        const char (*words)[STRUT_SLOT_WORD]) {
  if (c->word) {
    bool same = strcmp(words[c->column], c->word) == 0;
    return same == (c->relation == STRUT_SEARCH_IS) ? 0.0 : 1.0;
  }
  double left = evaluate(&c->left, numbers), right = evaluate(&c->right, numbers);
  double size = fabs(right) > 0.0 ? fabs(right) : 1.0;
  double excess = (c->relation == STRUT_SEARCH_BELOW ? left - right : right - left) / size;
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

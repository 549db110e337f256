/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of the table as points of a search. See search_parts.h. */
#include <math.h>
#include <string.h>

#include "engine/study/search/box.h"
#include "engine/study/search/search_parts.h"
#include "engine/study/sweep/grid.h"

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

bool strut_search_better(const strut_study_search *search, const strut_search_point *a,
                         const strut_search_point *b) {
  bool known = a->evaluation >= 0 && !isnan(a->objective);
  bool other = b->evaluation >= 0 && !isnan(b->objective);
  if (!known || !other) return known && !other;
  if (a->violation != b->violation && (a->violation > 0.0 || b->violation > 0.0))
    return a->violation < b->violation;
  return search->maximise ? a->objective > b->objective : a->objective < b->objective;
}

strut_status strut_search_judge(const strut_sweep_plan *plan, strut_slots *slots, int64_t outer,
                                int64_t row, const strut_study_value *values,
                                strut_search_point *point, double *broken, bool *failed,
                                bool *valueless, strut_error *error) {
  const strut_study_search *search = plan->study->search;
  const strut_search_layout l = strut_search_layout_of(plan);
  int64_t first = (outer * l.rows + row) * l.scenarios;
  *point = (strut_search_point){.evaluation = row,
                                .worst = first,
                                .objective = (double)NAN,
                                .second = (double)NAN,
                                .values = values};
  *failed = *valueless = false;
  for (size_t i = 0; i < l.conditions; i++) broken[i] = -HUGE_VAL;
  for (int64_t i = 0; i < l.scenarios; i++) {
    strut_result_slot slot;
    double own[STRUT_SEARCH_MOST_CONDITIONS], second;
    if (!strut_slots_get(slots, first + i, &slot))
      return strut_fail(error, STRUT_FILE_TROUBLE, "point %lld cannot be read",
                        (long long)(first + i));
    if (!has_values(plan, &slot, values))
      return strut_fail(error, STRUT_FILE_TROUBLE,
                        "point %lld of the results there is not what this search asks for, as by "
                        "another version of NLopt: remove points.slots to start afresh",
                        (long long)(first + i));
    if (slot.status) {
      *failed = true;
      continue;
    }
    double goal = strut_search_score(plan, slot.numbers, slot.words, &second, own);
    *valueless = *valueless || isnan(goal) || isnan(second);
    point->violation = fmax(point->violation, strut_search_violation(search, own));
    for (size_t k = 0; k < l.conditions; k++) broken[k] = fmax(broken[k], own[k]);
    bool worse = search->maximise ? goal < point->objective : goal > point->objective;
    bool worse_second = search->maximise ? second < point->second : second > point->second;
    if (worse_second || isnan(point->second)) point->second = second;
    if (worse || isnan(point->objective)) point->objective = goal, point->worst = first + i;
  }
  if (*failed || *valueless) point->objective = (double)NAN;
  return STRUT_OK;
}

void strut_search_values(const strut_sweep_plan *plan, int64_t point,
                         const strut_study_value *values, strut_study_value *all) {
  const strut_study_search *search = plan->study->search;
  strut_grid_values(plan->study, point, all);
  for (size_t i = 0; i < search->variable_count; i++) all[search->column + i] = values[i];
}

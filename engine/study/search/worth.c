/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a best point is worth: computed more exactly, and beside its neighbours. See search_parts.h. */
#include <math.h>
#include <string.h>

#include "engine/study/search/box.h"
#include "engine/study/search/search_parts.h"

/* How far neighbours are, in widths of the box, and which starts agree, of the best's size. */
static const double BESIDE = 0.01, AGREEING = 0.01;

/* A value beside another. False: there is none. */
static bool beside(const strut_search_variable *v, strut_study_value at, int side,
                   strut_study_value *value) {
  double number = strut_search_number(v, at), step = BESIDE;
  if (v->choice_count) return false;
  if (v->integer) step = 1.0 / (double)strut_search_count(v);
  number += side * step;
  if (!v->wraps && (number < 0.0 || number > 1.0)) return false;
  *value = strut_search_value(v, number);
  return !strut_search_same(*value, at);
}

/* The best search of an outer point, or SIZE_MAX. */
static size_t best_of(const strut_search_batch *b, const strut_search_result *r, int64_t outer) {
  const strut_study_search *search = b->plan->study->search;
  size_t best = SIZE_MAX;
  for (size_t i = 0; i < r->outcome_count; i++) {
    const strut_search_outcome *o = &r->outcomes[i];
    if (o->outer != outer || o->best.evaluation < 0) continue;
    if (best == SIZE_MAX || strut_search_better(search, &o->best, &r->outcomes[best].best))
      best = i;
  }
  return best;
}

static int32_t count_agreeing(const strut_search_result *r, size_t best) {
  const strut_search_outcome *first = &r->outcomes[best];
  double size = strut_search_size(first);
  int32_t count = 0;
  if (size == 0.0) size = first->most - first->least;
  for (size_t i = 0; i < r->outcome_count; i++) {
    const strut_search_outcome *o = &r->outcomes[i];
    double apart = fabs(o->best.objective - first->best.objective);
    bool alike = (o->best.violation > 0.0) == (first->best.violation > 0.0);
    count +=
        o->outer == first->outer && o->best.evaluation >= 0 && alike && apart <= AGREEING * size;
  }
  return count;
}

static strut_study_value *copy_values(strut_search_batch *b, strut_search_result *r,
                                      const strut_study_value *values) {
  size_t n = b->plan->study->search->variable_count;
  strut_study_value *copy = strut_arena_allocate(&r->arena, n, sizeof *copy);
  if (copy) memcpy(copy, values, n * sizeof *copy);
  return copy;
}

/* Lists the points to be computed about a best one. False: no memory. */
static bool list_points(strut_search_batch *b, strut_search_result *r, strut_search_worth *w) {
  const strut_study_search *search = b->plan->study->search;
  const strut_search_outcome *o = &r->outcomes[w->best];
  size_t n = search->variable_count;
  w->agreeing = count_agreeing(r, w->best);
  w->checked = b->plan->study->compute == STRUT_COMPUTE_RUN;
  w->bound = strut_arena_allocate(&r->arena, n, sizeof *w->bound);
  w->neighbours = strut_arena_allocate(&r->arena, n, sizeof *w->neighbours);
  if (!w->bound || !w->neighbours) return false;
  w->check.values = o->best.values;
  bool fine = !w->checked || strut_search_batch_add(b, o->outer, b->first_check, o->best.values);
  for (size_t i = 0; i < n && fine; i++) {
    w->bound[i] = strut_search_bound(&search->variables[i], o->best.values[i]);
    for (int side = 0; side < 2 && fine; side++) {
      strut_search_neighbour *near = &w->neighbours[i][side];
      strut_study_value value;
      near->there = beside(&search->variables[i], o->best.values[i], side ? 1 : -1, &value);
      if (!near->there) continue;
      strut_study_value *values = copy_values(b, r, o->best.values);
      if (!values) return false;
      values[i] = value;
      near->point.values = values;
      fine =
          strut_search_batch_add(b, o->outer, b->first_check + 1 + 2 * (int64_t)i + side, values);
    }
  }
  return fine;
}

static strut_status judge(strut_search_batch *b, int64_t outer, int64_t row,
                          strut_search_point *point) {
  double broken[STRUT_SEARCH_MOST_CONDITIONS];
  bool failed, valueless;
  return strut_search_judge(b->plan, b->slots, outer, row, point->values, point, broken, &failed,
                            &valueless, b->error);
}

static strut_status judge_points(strut_search_batch *b, strut_search_result *r,
                                 strut_search_worth *w) {
  int64_t outer = r->outcomes[w->best].outer;
  strut_status status = STRUT_OK;
  if (w->checked) status = judge(b, outer, b->first_check, &w->check);
  for (size_t i = 0; i < b->plan->study->search->variable_count && !status; i++)
    for (int side = 0; side < 2 && !status; side++)
      if (w->neighbours[i][side].there)
        status = judge(b, outer, b->first_check + 1 + 2 * (int64_t)i + side,
                       &w->neighbours[i][side].point);
  return status;
}

strut_status strut_search_find_worth(strut_search_batch *b, strut_search_result *r) {
  const strut_search_layout l = strut_search_layout_of(b->plan);
  r->worths = strut_arena_allocate(&r->arena, (size_t)l.outers, sizeof *r->worths);
  if (!r->worths) return strut_no_memory(b->error, "");
  if (r->front_count) return STRUT_OK; /* there is no one best */
  for (int64_t outer = 0; outer < l.outers; outer++) {
    size_t best = best_of(b, r, outer);
    if (best == SIZE_MAX) continue;
    strut_search_worth *w = &r->worths[r->worth_count++];
    w->best = best;
    if (!list_points(b, r, w)) return strut_no_memory(b->error, "");
  }
  strut_status status = strut_search_batch_run(b);
  for (size_t i = 0; i < r->worth_count && !status; i++) status = judge_points(b, r, &r->worths[i]);
  return status;
}

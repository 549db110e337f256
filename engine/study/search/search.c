/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/search/search.h"

#include <math.h>
#include <string.h>

#include "engine/base/checksum.h"
#include "engine/study/search/search_parts.h"

/* Optimisers at the same time, and known points that one may ask for in a row. */
enum { MOST_ACTIVE = 64, MOST_REPEATS = 5000 };

/* A point that was evaluated, or is about to be. */
typedef struct known {
  strut_study_value *values; /* (variables) */
  double *broken;            /* (conditions) */
  double *gradient;          /* (variables) in the box, of a method that follows it; else NULL */
  strut_search_point point;
  int32_t same_hash; /* the one before it with the same hash, or -1 */
} known;

/* One search in progress. */
typedef struct search {
  strut_search_outcome *outcome;
  strut_search_task task;
  strut_dialogue *dialogue;
  strut_question question;
  int32_t *answers; /* (question.count) of the known points, -1: no evaluation is left for it */
  size_t answer_room;
  known *list;        /* (count) in the order of their evaluation */
  int32_t count, new; /* new: first that has not been judged */
  int32_t *heads;     /* (hashes) latest known point of a hash, or -1 */
  uint32_t hashes;    /* a power of two */
  int64_t all;        /* points that there are; 0: a continuum, or too many to count */
  int64_t repeats;    /* in a row */
  double first, scale, second_scale,
      worst; /* the first objective, its size, and the worst that was passed on */
  bool over;
  strut_arena arena;
} search;

typedef struct conductor {
  const strut_sweep_plan *plan;
  const strut_study_search *what;
  strut_search_layout layout;
  strut_search_batch batch;
  strut_search_result *result;
  search *active[MOST_ACTIVE];
  size_t active_count, next; /* next: outcome to be begun */
  bool penalise;             /* broken conditions make values worse */
} conductor;

/* ---- beginning and ending a search ---- */

/* The first search begins where the study says, the others anywhere. */
static void choose_start(const conductor *self, const search *s, double *start) {
  uint64_t state = (uint64_t)s->task.seed;
  for (size_t i = 0; i < self->layout.variables; i++) {
    double share = strut_search_share(&state);
    start[i] = s->outcome->start == 0 ? strut_search_start(&self->what->variables[i]) : share;
  }
}

/*
 * How many points there are in all, of so many values of each variable; 0: a continuum, or too many to count. *names:
 * their values have no order.
 */
static int64_t count_all(const conductor *self, int64_t *counts, bool *names) {
  int64_t all = 1;
  *names = true;
  for (size_t i = 0; i < self->layout.variables; i++) {
    counts[i] = strut_search_count(&self->what->variables[i]);
    all = counts[i] > 0 && all < INT32_MAX / counts[i] ? all * counts[i] : 0;
    *names = *names && self->what->variables[i].word;
  }
  return all;
}

static void free_search(search *self) {
  strut_dialogue_end(self->dialogue);
  strut_release(self->answers);
  strut_arena_free(&self->arena);
  strut_release(self);
}

static search *begin_search(conductor *self, strut_search_outcome *outcome) {
  search *s = strut_allocate(1, sizeof *s);
  if (!s) return NULL;
  size_t n = self->layout.variables;
  int64_t most = self->what->evaluations;
  double *start;
  bool *wraps, names;
  int64_t *counts;
  for (s->hashes = 64; s->hashes < 2 * most;) s->hashes *= 2;
  bool ready =
      STRUT_ALLOCATE(&s->arena, STRUT_NEW(start, n), STRUT_NEW(wraps, n), STRUT_NEW(counts, n),
                     STRUT_NEW(s->list, most), STRUT_NEW(s->heads, s->hashes));
  s->outcome = outcome;
  s->task = (strut_search_task){.method = (strut_search_method)self->what->method,
                                .dimension = n,
                                .conditions = self->penalise ? 0 : self->layout.conditions,
                                .start = start,
                                .wraps = wraps,
                                .evaluations = most,
                                .seed = (uint32_t)(self->what->seed + outcome->start)};
  if (ready) {
    s->all = count_all(self, counts, &names);
    if (s->all && (s->all <= most || names)) s->task.counts = counts;
    for (uint32_t i = 0; i < s->hashes; i++) s->heads[i] = -1;
    for (size_t i = 0; i < n; i++) wraps[i] = self->what->variables[i].wraps;
    choose_start(self, s, start);
    s->dialogue = strut_dialogue_begin(&s->task);
    if (s->dialogue) return s;
  }
  free_search(s);
  return NULL;
}

/* What the result keeps of a search: the values of its best point, and its steps. */
static bool keep_outcome(conductor *self, search *s) {
  strut_search_outcome *outcome = s->outcome;
  strut_arena *arena = &self->result->arena;
  size_t n = self->layout.variables, count = (size_t)outcome->evaluations;
  strut_study_value *values = strut_arena_allocate(arena, n, sizeof *values);
  outcome->steps = strut_arena_allocate(arena, count + 1, sizeof *outcome->steps);
  if (!values || !outcome->steps) return false;
  if (outcome->best.evaluation >= 0) memcpy(values, outcome->best.values, n * sizeof *values);
  outcome->best.values = values;
  strut_search_point best = {.evaluation = -1, .objective = (double)NAN};
  for (size_t i = 0; i < count; i++) {
    const strut_search_point *point = &s->list[i].point;
    if (point->violation <= 0.0 && strut_search_better(self->what, point, &best)) best = *point;
    outcome->steps[i] = (strut_search_step){point->worst, best.objective};
  }
  return true;
}

/* ---- known points ---- */

static uint32_t hash_of(const conductor *self, const strut_study_value *values) {
  uint64_t sum = 0;
  for (size_t i = 0; i < self->layout.variables; i++)
    sum = values[i].word ? strut_checksum(values[i].word, strlen(values[i].word), sum)
                         : strut_checksum(&values[i].number, sizeof values[i].number, sum);
  return (uint32_t)(sum ^ sum >> 32);
}

static bool same_values(const conductor *self, const strut_study_value *first,
                        const strut_study_value *second) {
  bool same = true;
  for (size_t i = 0; i < self->layout.variables && same; i++)
    same = strut_search_same(first[i], second[i]);
  return same;
}

/* The point with these values, a new one if necessary; -1: no evaluation is left; -2: no memory. */
static int32_t find_point(const conductor *self, search *s, const strut_study_value *values) {
  uint32_t hash = hash_of(self, values) & (s->hashes - 1);
  int32_t i = s->heads[hash];
  while (i >= 0 && !same_values(self, s->list[i].values, values)) i = s->list[i].same_hash;
  if (i >= 0) return i;
  if (s->count >= self->what->evaluations) return -1;
  known *k = &s->list[s->count];
  k->values = strut_arena_allocate(&s->arena, self->layout.variables, sizeof *k->values);
  k->broken = strut_arena_allocate(&s->arena, self->layout.conditions + 1, sizeof *k->broken);
  bool follows = self->what->method == STRUT_SEARCH_BFGS;
  k->gradient =
      follows ? strut_arena_allocate(&s->arena, self->layout.variables, sizeof(double)) : NULL;
  if (!k->values || !k->broken || (follows && !k->gradient)) return -2;
  memcpy(k->values, values, self->layout.variables * sizeof *values);
  k->same_hash = s->heads[hash];
  return s->heads[hash] = s->count++;
}

/* ---- questions ---- */

/* Finds the points of the question, and lists those that are to be computed. */
static bool take_question(conductor *self, search *s) {
  size_t n = self->layout.variables;
  strut_study_value values[STRUT_SEARCH_MOST_VARIABLES];
  if (s->question.count > s->answer_room) {
    strut_release(s->answers);
    s->answer_room = s->question.count;
    s->answers = strut_allocate(s->answer_room, sizeof *s->answers);
    if (!s->answers) return false;
  }
  s->new = s->count;
  for (size_t i = 0; i < s->question.count; i++) {
    int32_t before = s->count;
    for (size_t k = 0; k < n; k++)
      values[k] = strut_search_value(&self->what->variables[k], s->question.points[i * n + k]);
    s->answers[i] = find_point(self, s, values);
    if (s->answers[i] == -2) return false;
    bool repeated = s->answers[i] >= 0 && s->count == before;
    s->repeats = repeated ? s->repeats + 1 : 0;
    s->outcome->repeated += repeated;
    if (s->count == before) continue;
    int64_t row = s->outcome->start * self->what->evaluations + before;
    if (!strut_search_batch_add(&self->batch, s->outcome->outer, row, s->list[before].values))
      return false;
  }
  return true;
}

/* Puts an objective among the best ones of a search. */
static void rank_objective(const conductor *self, strut_search_outcome *outcome, double objective) {
  size_t at = 0;
  while (at < outcome->top_count &&
         (self->what->maximise ? outcome->top[at] >= objective : outcome->top[at] <= objective))
    at++;
  if (at == STRUT_SEARCH_LATEST) return;
  if (outcome->top_count < STRUT_SEARCH_LATEST) outcome->top_count++;
  memmove(outcome->top + at + 1, outcome->top + at,
          (outcome->top_count - at - 1) * sizeof *outcome->top);
  outcome->top[at] = objective;
}

/* Takes the rows of a new point in. */
static strut_status judge_point(conductor *self, search *s, int32_t i) {
  strut_search_outcome *outcome = s->outcome;
  known *k = &s->list[i];
  strut_sweep_state *state = self->batch.points.state;
  int64_t row = outcome->start * self->what->evaluations + i;
  k->point.values = k->values;
  strut_status status = strut_search_judge(self->plan, self->batch.points.slots, outcome->outer,
                                           row, &k->point, k->broken, self->batch.points.error);
  if (!status && k->gradient)
    status = strut_search_gradient(self->plan, self->batch.points.slots, &k->point, k->gradient,
                                   self->batch.points.error);
  if (status) return status;
  outcome->evaluations++;
  outcome->failed += k->point.failed;
  outcome->valueless += !k->point.failed && k->point.valueless;
  if (isnan(k->point.objective)) return STRUT_OK;
  bool feasible = k->point.violation <= 0.0;
  outcome->feasible += feasible;
  if (s->scale == 0.0) {
    s->scale = k->point.objective != 0.0 ? fabs(k->point.objective) : 1.0;
    s->first = k->point.objective;
    s->second_scale = k->point.second != 0.0 ? fabs(k->point.second) : 1.0;
    outcome->constant = true;
    outcome->least = outcome->most = s->first;
  }
  outcome->least = fmin(outcome->least, k->point.objective);
  outcome->most = fmax(outcome->most, k->point.objective);
  outcome->constant = outcome->constant && k->point.objective == s->first;
  if (feasible) rank_objective(self, outcome, k->point.objective);
  if (feasible && self->result->front_count &&
      !strut_search_front_take(self->what, &self->result->fronts[outcome->outer], &k->point,
                               &self->result->arena))
    return strut_no_memory(self->batch.points.error, "");
  if (strut_search_better(self->what, &k->point, &outcome->best)) outcome->best = k->point;
  bool best =
      feasible && (!state->has_best || (self->what->maximise ? k->point.objective > state->best
                                                             : k->point.objective < state->best));
  if (best) state->best = k->point.objective, state->has_best = true;
  return STRUT_OK;
}

/*
 * What the optimiser minimises: the objective in units of the first one. Where it does not know the conditions
 * itself, those of feasible points are pressed into (-1, 1), and the others are above. A failed point is
 * worse than all before it.
 */
static double as_asked(const conductor *self, search *s, const known *k, bool second) {
  double value = second ? k->point.second / s->second_scale : k->point.objective / s->scale;
  if (isnan(k->point.objective)) return s->worst + 1.0;
  if (self->what->maximise) value = -value;
  if (self->penalise && self->layout.conditions > 0)
    value = k->point.violation > 0.0 ? 1.0 + fmin(k->point.violation, 1e9)
                                     : value / (1.0 + fabs(value));
  value = fmin(fmax(value, -1e300), 1e300);
  s->worst = fmax(s->worst, value);
  return value;
}

double strut_search_size(const strut_search_outcome *outcome) {
  double size = fabs(outcome->best.objective);
  double last = outcome->top_count ? fabs(outcome->top[outcome->top_count - 1]) : size;
  return size >= 0.05 * last ? size : 0.0;
}

/* Why the search must end now, if it must. */
static bool must_end(const conductor *self, search *s) {
  strut_search_outcome *outcome = s->outcome;
  bool used_up = false;
  for (size_t i = 0; i < s->question.count; i++) used_up = used_up || s->answers[i] < 0;
  if (s->all > 0 && s->count >= s->all)
    outcome->end = STRUT_SEARCH_ENUMERATED;
  else if (used_up || s->count >= self->what->evaluations)
    outcome->end = STRUT_SEARCH_USED_UP;
  else if (s->repeats > MOST_REPEATS)
    outcome->end = STRUT_SEARCH_REPEATS;
  else
    return false;
  return true;
}

/* Answers the question of a search whose points are all in the file. */
static strut_status answer_question(conductor *self, search *s) {
  const strut_question *question = &s->question;
  size_t m = s->task.conditions;
  for (int32_t i = s->new; i < s->count; i++) {
    strut_status status = judge_point(self, s, i);
    if (status) return status;
  }
  s->over = must_end(self, s);
  for (size_t i = 0; i < question->count && !s->over; i++) {
    const known *k = &s->list[s->answers[i]];
    if (self->result->front_count) {
      question->values[2 * i] = as_asked(self, s, k, false);
      question->values[2 * i + 1] = as_asked(self, s, k, true);
    } else if (k->gradient) {
      double *to = question->values + i * (1 + self->layout.variables);
      double unit = self->what->maximise ? -s->scale : s->scale;
      to[0] = as_asked(self, s, k, false);
      for (size_t v = 0; v < self->layout.variables; v++) to[1 + v] = k->gradient[v] / unit;
    } else {
      question->values[i] = as_asked(self, s, k, false);
    }
    for (size_t j = 0; j < m; j++)
      question->broken[i * m + j] =
          isnan(k->point.objective) ? 1.0 : fmin(fmax(k->broken[j], -1e9), 1e9);
  }
  if (!s->over) strut_dialogue_answer(s->dialogue);
  return STRUT_OK;
}

/* ---- all searches ---- */

static bool fill_active(conductor *self) {
  while (self->active_count < MOST_ACTIVE && self->next < self->result->outcome_count) {
    search *s = begin_search(self, &self->result->outcomes[self->next]);
    if (!s) return false;
    self->active[self->active_count++] = s;
    self->next++;
  }
  return true;
}

/* Waits for all questions; searches without one have ended. */
static bool collect_questions(conductor *self) {
  size_t left = 0;
  bool fine = true;
  for (size_t i = 0; i < self->active_count; i++) {
    search *s = self->active[i];
    if (!s->over && fine && strut_dialogue_question(s->dialogue, &s->question)) {
      self->active[left++] = s;
      fine = take_question(self, s);
      continue;
    }
    if (!s->over) s->outcome->end = STRUT_SEARCH_CONVERGED;
    fine = keep_outcome(self, s) && fine;
    fine = strut_dialogue_end(s->dialogue) && fine;
    s->dialogue = NULL;
    free_search(s);
  }
  self->active_count = left;
  return fine;
}

static strut_status run_searches(conductor *self) {
  strut_status status = STRUT_OK;
  while (!status && (self->active_count > 0 || self->next < self->result->outcome_count)) {
    if (!fill_active(self) || !collect_questions(self))
      return strut_no_memory(self->batch.points.error, "");
    status = strut_search_batch_run(&self->batch);
    for (size_t i = 0; i < self->active_count && !status; i++)
      status = answer_question(self, self->active[i]);
  }
  return status;
}

static bool make_outcomes(conductor *self) {
  size_t starts = (size_t)self->what->starts;
  strut_search_result *result = self->result;
  result->outcome_count = (size_t)self->layout.outers * starts;
  result->outcomes =
      strut_arena_allocate(&result->arena, result->outcome_count, sizeof *result->outcomes);
  for (size_t i = 0; result->outcomes && i < result->outcome_count; i++) {
    result->outcomes[i].outer = (int64_t)(i / starts);
    result->outcomes[i].start = (int32_t)(i % starts);
    result->outcomes[i].best = (strut_search_point){.evaluation = -1, .objective = (double)NAN};
  }
  result->front_count = self->what->second.text ? (size_t)self->layout.outers : 0;
  result->fronts =
      strut_arena_allocate(&result->arena, result->front_count + 1, sizeof *result->fronts);
  return result->outcomes != NULL && result->fronts != NULL;
}

strut_status strut_search_run(const strut_sweep_plan *plan, strut_slots *slots,
                              const strut_sweep_options *options, strut_sweep_state *state,
                              strut_search_result *result, strut_error *error) {
  strut_error own = {0};
  conductor c = {
      .plan = plan,
      .what = plan->study->search,
      .layout = strut_search_layout_of(plan),
      .result = result,
      .batch = {.plan = plan,
                .given = options,
                .points = {.slots = slots, .state = state, .error = error ? error : &own}}};
  c.penalise = !strut_search_knows_conditions((strut_search_method)c.what->method);
  *result = (strut_search_result){0};
  strut_status status = strut_search_batch_begin(&c.batch);
  if (!status && !make_outcomes(&c)) status = strut_no_memory(c.batch.points.error, "");
  if (!status) status = run_searches(&c);
  for (size_t i = 0; i < c.active_count; i++) free_search(c.active[i]);
  if (!status) status = strut_search_find_worth(&c.batch, result);
  if (!status) state->points = state->done;
  state->seconds = strut_run_clock() - c.batch.points.began;
  state->row = NULL;
  strut_search_batch_free(&c.batch);
  return status;
}

bool strut_search_is_parallel(const strut_sweep_plan *plan) {
  const strut_study_search *what = plan->study->search;
  const strut_search_layout l = strut_search_layout_of(plan);
  return strut_search_has_generations((strut_search_method)what->method) ||
         l.outers * what->starts * l.scenarios > 1;
}

void strut_search_result_free(strut_search_result *result) {
  strut_arena_free(&result->arena);
  *result = (strut_search_result){0};
}

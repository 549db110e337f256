/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Combinations of states of self-stress that pull all cables or stiffen all mechanisms. */
#include <math.h>
#include <string.h>

#include "engine/statics/rigidity/self_stress.h"
#include "engine/statics/symmetric.h"

enum { MOST_ROUNDS = 20000, MOST_FORM_ROUNDS = 2000 };

/* How much of the largest a force or an eigenvalue must have to count as positive. */
static const double MARGIN = 1e-7;

typedef struct search {
  const strut_model *model;
  const strut_self_stress *states;
  const strut_stress_wish *wish;
  size_t states_count, members, motions;
  double *weight; /* (states) the combination */
  double *pull;   /* (states) a demand's coefficients: it wants weight . pull > 0 */
  double *cable;  /* (members) norm of a member's coefficients, 0 where nothing is asked of it */
  double *form, *value, *vector; /* (motions, motions), (motions), (motions, motions) */
} search;

static bool allocate(search *s, strut_arena *scratch) {
  size_t square = s->motions * s->motions + 1;
  s->weight = strut_arena_allocate(scratch, s->states_count, sizeof(double));
  s->pull = strut_arena_allocate(scratch, s->states_count, sizeof(double));
  s->cable = strut_arena_allocate(scratch, s->members, sizeof(double));
  s->form = strut_arena_allocate(scratch, square, sizeof(double));
  s->value = strut_arena_allocate(scratch, s->motions + 1, sizeof(double));
  s->vector = strut_arena_allocate(scratch, square, sizeof(double));
  return s->weight && s->pull && s->cable && s->form && s->value && s->vector;
}

static void measure_cables(search *s) {
  for (size_t j = 0; j < s->members; j++) {
    if (!s->wish->cables || s->model->scene->members[j].kind != STRUT_CABLE) continue;
    for (size_t i = 0; i < s->states_count; i++) {
      double t = s->states->force[i * s->members + j];
      s->cable[j] += t * t;
    }
    s->cable[j] = sqrt(s->cable[j]);
  }
}

static double norm(const double *x, size_t n) {
  double sum = 0.0;
  for (size_t i = 0; i < n; i++) sum += x[i] * x[i];
  return sqrt(sum);
}

/* The demand of the cable that is pressed most, relative to its coefficients; false: none is. */
static bool worst_cable(search *s) {
  double worst = MARGIN * norm(s->weight, s->states_count);
  size_t at = s->members;
  for (size_t j = 0; j < s->members; j++) {
    if (s->cable[j] == 0.0) continue;
    double force = 0.0;
    for (size_t i = 0; i < s->states_count; i++)
      force += s->weight[i] * s->states->force[i * s->members + j];
    if (force / s->cable[j] > worst) continue;
    worst = force / s->cable[j];
    at = j;
  }
  if (at == s->members) return false;
  for (size_t i = 0; i < s->states_count; i++)
    s->pull[i] = s->states->force[i * s->members + at] / s->cable[at];
  return true;
}

static void set_pull_of_forms(search *s, const double *v) {
  size_t m = s->motions;
  for (size_t i = 0; i < s->states_count; i++) {
    const double *form = s->wish->forms + i * m * m;
    s->pull[i] = 0.0;
    for (size_t r = 0; r < m; r++)
      for (size_t c = 0; c < m; c++) s->pull[i] += v[r] * form[r * m + c] * v[c];
  }
  double size = norm(s->pull, s->states_count);
  for (size_t i = 0; i < s->states_count && size > 0; i++) s->pull[i] /= size;
}

/* The demand of the softest motion; *failed: it has none, so that nothing helps. */
static bool softest_motion(search *s, bool *failed) {
  size_t m = s->motions;
  if (m == 0) return false;
  memset(s->form, 0, m * m * sizeof *s->form);
  for (size_t i = 0; i < s->states_count; i++)
    for (size_t k = 0; k < m * m; k++) s->form[k] += s->weight[i] * s->wish->forms[i * m * m + k];
  if (!strut_symmetric_eigen(s->form, m, s->value, s->vector)) {
    *failed = true;
    return true;
  }
  double scale = 0.0;
  for (size_t i = 0; i < s->states_count; i++) scale += fabs(s->weight[i]) * s->wish->scale[i];
  if (s->value[0] > MARGIN * scale) return false;
  set_pull_of_forms(s, s->vector);
  *failed = norm(s->pull, s->states_count) == 0.0;
  return true;
}

static bool look(search *s) {
  bool failed = false;
  int most = s->motions > 0 ? MOST_FORM_ROUNDS : MOST_ROUNDS;
  /* begin with what all demands have in common: each state's own force on the cables */
  for (size_t i = 0; i < s->states_count; i++) s->weight[i] = s->states->cables_pull[i] ? 1 : 0.1;
  for (int round = 0; round < most && !failed; round++) {
    if (!worst_cable(s) && !softest_motion(s, &failed)) return true;
    for (size_t i = 0; i < s->states_count; i++) s->weight[i] += s->pull[i];
  }
  return false;
}

static void combine(const search *s, double *force) {
  double largest = 0.0;
  memset(force, 0, s->members * sizeof *force);
  for (size_t i = 0; i < s->states_count; i++)
    for (size_t j = 0; j < s->members; j++)
      force[j] += s->weight[i] * s->states->force[i * s->members + j];
  for (size_t j = 0; j < s->members; j++) largest = fmax(largest, fabs(force[j]));
  for (size_t j = 0; j < s->members && largest > 0; j++) force[j] /= largest;
}

strut_status strut_self_stress_combine(const strut_model *model, const strut_self_stress *states,
                                       const strut_stress_wish *wish, double *force, bool *found) {
  *found = false;
  if (states->count == 0 || !states->force) return STRUT_OK;
  strut_arena scratch = {0};
  search s = {.model = model, .states = states, .wish = wish};
  s.states_count = (size_t)states->count, s.members = (size_t)model->members.count;
  s.motions = (size_t)wish->motions;
  bool good = allocate(&s, &scratch);
  if (good) {
    measure_cables(&s);
    *found = look(&s);
    if (*found) combine(&s, force);
  }
  strut_arena_free(&scratch);
  return good ? STRUT_OK : STRUT_NO_MEMORY;
}

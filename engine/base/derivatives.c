/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/base/derivatives.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "engine/base/memory.h"

/* Relative errors by which steps are chosen, that of outputs which do not know theirs first; and what is no kink. */
static const double LEAST_NOISE = 3e-17, MOST_NOISE = 1e-6, USUAL_NOISE = 1e-11;
/* Steps along all parameters, in parts of those along one; by how much they are varied. */
static const double PART = 0.125, LEAST_PART = 1.0 / 128.0, SPREAD = 0.3;
/* In parts of the change: a bend to be looked at, and that of what seems straight. */
static const double BENT = 0.1, SLIGHT = 0.01, GOLDEN = 0.6180339887498949;
/* Deviation of a second difference of noise, in those of a half of a first one. */
static const double OF_BEND = 3.4641016151377544;

/* Two points along a direction: `central` at 1 and -1, else at 1 and 2 steps. */
typedef struct pair {
  bool central;
  double *step;                  /* (parameters) 0: another one's */
  double *values[2], *errors[2]; /* (outputs) */
  strut_status status[2];
  strut_error error[2];
} pair;

typedef struct differences {
  const strut_derivatives_task *task;
  double *outputs, *errors; /* (outputs) of the point */
  pair *pairs;              /* (parameters + 1) the last along all */
  strut_arena arena;
} differences;

const char *strut_derivative_words(strut_derivative_verdict verdict) {
  static const char *const words[] = {
#define WORDS(name, words) words,
      STRUT_DERIVATIVE_VERDICTS(WORDS)};
  return words[verdict];
}

/* Outputs so many steps away from the point, and errors; NAN where there are none. */
static strut_status evaluate(const differences *self, const double *step, double length,
                             double *outputs, double *errors, strut_error *error) {
  const strut_derivatives_task *task = self->task;
  double *at = strut_allocate(task->parameter_count, sizeof *at);
  if (!at) return strut_no_memory(error, "");
  for (size_t i = 0; i < task->parameter_count; i++)
    at[i] = task->parameters[i].value + length * step[i];
  for (size_t j = 0; j < task->output_count; j++) outputs[j] = errors[j] = (double)NAN;
  strut_status status = task->evaluate(task->context, at, outputs, errors, error);
  for (size_t j = 0; j < task->output_count && status; j++) outputs[j] = (double)NAN;
  strut_release(at);
  return status == STRUT_NO_MEMORY || status == STRUT_INTERRUPTED ? status : STRUT_OK;
}

/* What is no more than noise of an output. */
static double noise_of(const differences *self, size_t j) {
  double own = self->errors[j];
  return isfinite(own) ? own : USUAL_NOISE * fabs(self->outputs[j]);
}

/* The largest relative noise of an output, which all steps are chosen by. */
static double largest_noise(const differences *self) {
  double noise = 0.0;
  for (size_t j = 0; j < self->task->output_count; j++) {
    double own = self->errors[j] / fabs(self->outputs[j]);
    noise = fmax(noise, isfinite(own) ? fmin(fmax(own, LEAST_NOISE), MOST_NOISE) : LEAST_NOISE);
  }
  return noise;
}

static double scale_of(const strut_derivatives_parameter *by) {
  return by->scale > 0.0 ? by->scale : by->value != 0.0 ? fabs(by->value) : 1.0;
}

/* The step along a parameter that balances rounding and curvature, exact in binary; *central: to both sides. */
static double choose_step(const strut_derivatives_parameter *by, double noise, bool *central) {
  double h = exp2(floor(log2(scale_of(by) * cbrt(noise)) + 0.5));
  double below = by->value - by->low, above = by->high - by->value, room = fmin(below, above);
  *central = room >= h / 64.0;
  if (*central) h = fmin(h, room);
  if (!*central) h = below > above ? -fmin(h, below / 2.0) : fmin(h, above / 2.0);
  return by->value + h - by->value;
}

/* Evaluates pairs from the first on. */
static strut_status evaluate_pairs(const differences *self, size_t first, size_t pairs,
                                   strut_error *error) {
  const int64_t begin = 2 * (int64_t)first, count = begin + 2 * (int64_t)pairs;
  int threads = self->task->threads;
  (void)threads; /* without OpenMP */
#ifdef _OPENMP
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads) if (threads > 1)
#endif
  for (int64_t k = begin; k < count; k++) {
    pair *along = &self->pairs[k / 2];
    double length = k % 2 == 0 ? 1.0 : along->central ? -1.0 : 2.0;
    along->status[k % 2] = evaluate(self, along->step, length, along->values[k % 2],
                                    along->errors[k % 2], &along->error[k % 2]);
  }
  for (int64_t k = begin; k < count; k++) {
    const pair *along = &self->pairs[k / 2];
    if (!along->status[k % 2]) continue;
    if (error) *error = along->error[k % 2];
    return along->status[k % 2];
  }
  return STRUT_OK;
}

/* What an output does along a pair. */
typedef struct change {
  double slope; /* by one step */
  double bend;  /* twice its difference from that, on both sides of the point */
  double jump;  /* by which it changes to one side, while it stays as it is on the other; or 0 */
} change;

static change change_of(const differences *self, const pair *along, size_t j) {
  double here = self->outputs[j], first = along->values[0][j], second = along->values[1][j];
  double one = fabs(first - here), other = fabs(second - (along->central ? here : first));
  double size = fmax(one, other), least = fmax(MOST_NOISE * fabs(here), 32.0 * noise_of(self, j));
  bool central = along->central;
  return (change){central ? (first - second) / 2.0 : (4.0 * (first - here) - (second - here)) / 2.0,
                  central ? first - here + (second - here) : second - first - (first - here),
                  fmin(one, other) <= BENT * size && size > least ? size : 0.0};
}

/* Does a pair change no output from `j` to before `end` by a bit? */
static bool is_idle(const differences *self, size_t i, size_t j, size_t end) {
  const pair *along = &self->pairs[i];
  size_t bytes = (end - j) * sizeof *self->outputs;
  return memcmp(along->values[0] + j, self->outputs + j, bytes) == 0 &&
         memcmp(along->values[1] + j, self->outputs + j, bytes) == 0;
}

/* How much an output bends along a parameter: the more, the more its differences are likely to be wrong. */
static double bend_of(const differences *self, size_t i, size_t j) {
  change own = change_of(self, &self->pairs[i], j);
  return fabs(own.bend) + SLIGHT * fabs(own.slope) + noise_of(self, j);
}

/*
 * Chooses the steps along all parameters, as parts of those along each: the smaller, the more it bends the outputs,
 * lest one hides what the others' differences get wrong; and different ones, lest kinks cancel.
 */
static void join_steps(differences *self) {
  const strut_derivatives_task *task = self->task;
  size_t n = task->parameter_count;
  pair *all = &self->pairs[n];
  all->central = true;
  for (size_t i = 0; i < n; i++) {
    double most = 0.0, h = self->pairs[i].step[i], value = task->parameters[i].value;
    for (size_t j = 0; j < task->output_count; j++) {
      double own = bend_of(self, i, j), least = own;
      for (size_t k = 0; k < n; k++) least = fmin(least, bend_of(self, k, j));
      most = fmax(most, own / least);
    }
    double part = fmax(PART / fmax(most, 1.0), LEAST_PART);
    part *= 1.0 + SPREAD * fmod((double)i * GOLDEN, 1.0);
    all->step[i] = value + part * h - value;
    all->central = all->central && self->pairs[i].central;
  }
}

/*
 * The derivatives of one output. A bend comes from a kink at the point where it shrinks with the steps: a smooth one
 * shrinks with their square, those along all parameters adding up to `most`, and noise does not.
 */
static void conclude(const differences *self, size_t j, strut_derivative *to) {
  const size_t n = self->task->parameter_count;
  const pair *all = &self->pairs[n];
  const change together = change_of(self, all, j);
  double roots = 0.0, bends = 0.0, off = together.slope;
  double own = isfinite(self->errors[j]) ? self->errors[j] : 0.0, noise = noise_of(self, j);
  for (size_t i = 0; i < n; i++) {
    double part = all->step[i] / self->pairs[i].step[i];
    change along = change_of(self, &self->pairs[i], j);
    off -= part * along.slope;
    roots += part * sqrt(fabs(along.bend)), bends += part * fabs(along.bend);
  }
  double rounding = 2.0 * DBL_EPSILON * fabs(self->outputs[j]);
  double uneven =
      fmax(fabs(together.bend) - roots * roots, 0.0); /* by noise, or by mixed curvature */
  if (isfinite(self->errors[j])) uneven = fmin(uneven, 4.0 * own);
  off = hypot(off, uneven / OF_BEND) + rounding;
  double most = fmax(fmin(2.0 * roots * roots, bends / 2.0), 8.0 * noise);
  for (size_t i = 0; i < n; i++) {
    const change along = change_of(self, &self->pairs[i], j);
    double h = self->pairs[i].step[i], bend = along.bend;
    double error = 2.0 * off / fabs(all->step[i]); /* whose it is, is not known */
    bool bent = fabs(bend) > BENT * fabs(along.slope);
    bool lasts = fabs(together.bend) > most && fabs(together.bend) < 1.5 * bends;
    bool jumps = along.jump > 0.0 && fabs(together.jump - along.jump) <= BENT * along.jump;
    if (!all->central) lasts = error * fabs(h) > fabs(bend) / 2.0; /* which differ in all steps */
    if (n > 1 && bent) error += fabs(bend / h);                    /* not told apart for certain */
    to[i].value = along.slope / h;
    to[i].error = error + own / scale_of(&self->task->parameters[i]);
    to[i].verdict = STRUT_DERIVATIVE_THERE;
    if ((bent && lasts && fabs(bend) > 32.0 * noise) || jumps)
      to[i].verdict = STRUT_DERIVATIVE_NONE;
    if (!isfinite(to[i].value + to[i].error)) to[i].verdict = STRUT_DERIVATIVE_UNKNOWN;
    if (to[i].verdict != STRUT_DERIVATIVE_THERE) to[i].value = to[i].error = (double)NAN;
    if (!is_idle(self, i, j, j + 1) || isnan(self->outputs[j])) continue;
    bool exact = self->errors[j] == 0.0 ||
                 (is_idle(self, i, 0, self->task->output_count) && rounding < MOST_NOISE * fabs(h));
    to[i] = (strut_derivative){0.0, exact ? 0.0 : rounding / fabs(h), STRUT_DERIVATIVE_THERE};
  }
}

static strut_status find(differences *self, strut_error *error) {
  const strut_derivatives_task *task = self->task;
  size_t n = task->parameter_count, m = task->output_count;
  strut_arena *arena = &self->arena;
  bool fine = STRUT_NUMBERS(arena, m, &self->outputs, &self->errors) &&
              STRUT_ALLOCATE(arena, STRUT_NEW(self->pairs, n + 1));
  for (size_t i = 0; i <= n && fine; i++) {
    pair *along = &self->pairs[i];
    fine = STRUT_NUMBERS(arena, n, &along->step) &&
           STRUT_NUMBERS(arena, m, &along->values[0], &along->values[1], &along->errors[0],
                         &along->errors[1]);
  }
  if (!fine) return strut_no_memory(error, "");
  for (size_t j = 0; j < m && task->outputs; j++) {
    self->outputs[j] = task->outputs[j];
    self->errors[j] = task->errors ? task->errors[j] : (double)NAN;
  }
  strut_status status =
      task->outputs ? STRUT_OK
                    : evaluate(self, self->pairs[0].step, 0.0, self->outputs, self->errors, error);
  for (size_t i = 0; i < n && !status; i++)
    self->pairs[i].step[i] =
        choose_step(&task->parameters[i], largest_noise(self), &self->pairs[i].central);
  if (!status) status = evaluate_pairs(self, 0, n, error);
  if (status) return status;
  join_steps(self);
  status = evaluate_pairs(self, n, 1, error);
  for (size_t k = 2 * n + 2; k-- > 0 && !status && error;)
    if (*self->pairs[k / 2].error[k % 2].message) *error = self->pairs[k / 2].error[k % 2];
  return status;
}

strut_status strut_derivatives_find(const strut_derivatives_task *task,
                                    strut_derivative *derivatives, strut_error *error) {
  differences self = {.task = task};
  strut_status status = find(&self, error);
  for (size_t j = 0; j < task->output_count && !status; j++)
    conclude(&self, j, derivatives + j * task->parameter_count);
  strut_arena_free(&self.arena);
  return status;
}

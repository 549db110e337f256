/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/sensitivity/sensitivity.h"

#include <gsl/gsl_rng.h>
#include <gsl/gsl_sort_double.h>
#include <math.h>
#include <string.h>

#include "engine/base/text.h"
#include "engine/output/file.h"
#include "engine/output/result_values.h"
#include "engine/scene/sample.h"

enum { MOST_TEXTS = 12 };
static const strut_estimate MISSING = {(double)NAN, (double)NAN, (double)NAN, (double)NAN};

static const char *const words[] = {
#define WORD(name, word) word,
    STRUT_SENSITIVITY_MEASURES(WORD)};

/* What is analysed: a column, or a condition on it, which is 0 or 1. */
typedef struct target {
  const char *name;
  size_t column;                              /* of the table */
  size_t place;                               /* among its numbers, or among its words */
  const char *text;                           /* the column has it; NULL: a column of numbers */
  enum { NUMBER, ABOVE, WITHIN, BELOW } kind; /* the number, or where it lies to the threshold */
} target;

typedef struct analysis {
  const strut_study *study;
  const strut_study_sensitivity *s;
  const strut_study_axis *axis;
  strut_slots *slots;
  const strut_slot_column *columns;
  size_t column_count;
  int64_t block; /* points of one analysis */
  target *targets;
  size_t target_count, target_room;
  double *values; /* (block) of a target */
  double *design; /* (samples, parameters + 2) or (2 samples) */
  strut_sensitivity_result *result;
  size_t room; /* for rows */
  strut_arena scratch;
} analysis;

static bool add_target(analysis *self, target t) {
  if (self->target_count == self->target_room) return true; /* more texts than are described */
  self->targets[self->target_count++] = t;
  return t.name != NULL;
}

/* Adds a text to a sorted list without twins. */
static size_t note_text(char texts[][STRUT_SLOT_WORD], size_t count, const char *text) {
  size_t at = 0;
  while (at < count && strcmp(texts[at], text) < 0) at++;
  if (!*text || (at < count && strcmp(texts[at], text) == 0) || count == MOST_TEXTS) return count;
  memmove(texts[at + 1], texts[at], (count - at) * sizeof *texts);
  memcpy(texts[at], text, STRUT_SLOT_WORD);
  return count + 1;
}

/* A target for each text that a column has at any point. */
static bool add_texts(analysis *self, target t) {
  char texts[MOST_TEXTS + 1][STRUT_SLOT_WORD];
  size_t count = 0;
  strut_result_slot row;
  for (int64_t p = 0; p < strut_slots_description_of(self->slots)->points; p++)
    if (strut_slots_get(self->slots, p, &row) && row.status == STRUT_OK)
      count = note_text(texts, count, row.words[t.place]);
  for (size_t i = 0; i < count; i++) {
    t.text = strut_arena_format(&self->scratch, "%s", texts[i]);
    t.name =
        strut_arena_format(&self->result->arena, "%s = %s", self->columns[t.column].name, texts[i]);
    if (!t.text || !add_target(self, t)) return false;
  }
  return true;
}

/*
 * Targets for the sign of a column: whether it is above 0; or above, within and below a threshold in both
 * directions.
 */
static bool add_signs(analysis *self, target t) {
  strut_arena *arena = &self->result->arena;
  const char *name = self->columns[t.column].name;
  char text[STRUT_NUMBER_TEXT];
  strut_number_text(self->s->threshold, text);
  t.kind = ABOVE;
  t.name = strut_arena_format(arena, "%s > %s", name, text);
  bool fine = add_target(self, t);
  if (!fine || self->s->threshold == 0.0) return fine;
  t.kind = WITHIN;
  t.name = strut_arena_format(arena, "|%s| <= %s", name, text);
  fine = add_target(self, t);
  t.kind = BELOW;
  t.name = strut_arena_format(arena, "%s < -%s", name, text);
  return fine && add_target(self, t);
}

static bool list_targets(analysis *self) {
  bool fine = true;
  self->target_room = self->s->of_count * MOST_TEXTS;
  self->targets =
      strut_arena_allocate(&self->scratch, self->target_room + 1, sizeof *self->targets);
  for (size_t i = 0; i < self->s->of_count && fine && self->targets; i++) {
    target t = {.column = strut_slot_named(self->columns, self->column_count, self->s->of[i])};
    const strut_slot_column *column = &self->columns[t.column];
    t.place = strut_slot_place(self->columns, t.column);
    if (column->word) {
      fine = add_texts(self, t);
      continue;
    }
    t.name = strut_arena_format(&self->result->arena, "%s", column->name);
    fine = add_target(self, t);
    if (self->s->samples > 0) fine = fine && add_signs(self, t);
  }
  return fine && self->targets;
}

static bool is_condition(const target *self) { return self->text || self->kind != NUMBER; }

static double value_of(const target *self, double threshold, const strut_result_slot *row) {
  if (row->status != STRUT_OK) return (double)NAN;
  if (self->text)
    return *row->words[self->place] ? strcmp(row->words[self->place], self->text) == 0
                                    : (double)NAN;
  double number = row->numbers[self->place];
  if (self->kind == NUMBER || !isfinite(number)) return number;
  return self->kind == ABOVE   ? number > threshold
         : self->kind == BELOW ? number < -threshold
                               : fabs(number) <= threshold;
}

/* The values of a target at the points from `first` on. */
static void read_values(analysis *self, int64_t first, const target *t) {
  for (int64_t p = 0; p < self->block; p++) {
    strut_result_slot row;
    bool there = strut_slots_get(self->slots, first + p, &row);
    self->values[p] = there ? value_of(t, self->s->threshold, &row) : (double)NAN;
  }
}

static bool add_row(analysis *self, strut_sensitivity_row row) {
  if (self->result->count == self->room) return false;
  self->result->rows[self->result->count++] = row;
  return row.unit != NULL;
}

static strut_estimate scaled(strut_estimate e, double factor) {
  double low = e.low * factor, high = e.high * factor;
  return (strut_estimate){e.value * factor, e.error * fabs(factor), fmin(low, high),
                          fmax(low, high)};
}

/* What the sweep has found at the medians. */
static bool add_derivatives(analysis *self, int64_t first, const target *t) {
  const strut_slot_column *columns = self->columns;
  strut_result_slot slot;
  bool there = strut_slots_get(self->slots, first, &slot) && slot.status == STRUT_OK;
  for (size_t k = 0; k < self->axis->column_count; k++) {
    const strut_study_column *column = &self->axis->columns[k];
    const char *name = strut_arena_format(&self->scratch, "%s.d.%s", t->name, column->name);
    size_t at = name ? strut_slot_named(columns, self->column_count, name) : self->column_count;
    if (!name) return false;
    if (at + 2 >= self->column_count) continue; /* a result of the check, which is no function */
    strut_sensitivity_row row = {.point = first,
                                 .of = t->name,
                                 .parameter = column->name,
                                 .measure = STRUT_SENSITIVITY_DERIVATIVE,
                                 .estimate = MISSING,
                                 .unit = columns[at].unit};
    row.verdict = strut_derivative_words(STRUT_DERIVATIVE_UNKNOWN);
    if (there) {
      const double *found = &slot.numbers[strut_slot_place(columns, at)];
      row.estimate = (strut_estimate){found[0], found[1], found[0] - found[1], found[0] + found[1]};
      row.verdict = strut_arena_format(&self->result->arena, "%s",
                                       slot.words[strut_slot_place(columns, at + 2)]);
    }
    row.used = isfinite(row.estimate.value) ? 2 : 0;
    if (!row.verdict || !add_row(self, row)) return false;
    row.measure = STRUT_SENSITIVITY_ELASTICITY;
    row.estimate = self->values[0] != 0.0
                       ? scaled(row.estimate, column->number[0] / self->values[0])
                       : MISSING;
    row.unit = "1";
    if (!add_row(self, row)) return false;
  }
  return true;
}

static const double NORMAL_95 = 1.959963984540054;

/* Mean of values with its standard error as of independent ones, and their own deviation; NANs are left out. */
static strut_estimate mean_of(const double *values, size_t count, double *deviation) {
  double sum = 0.0, square = 0.0, known = 0.0;
  for (size_t i = 0; i < count; i++)
    if (isfinite(values[i])) sum += values[i], known += 1.0;
  double mean = sum / known;
  for (size_t i = 0; i < count; i++)
    if (isfinite(values[i])) square += (values[i] - mean) * (values[i] - mean);
  *deviation = known < 2.0 ? (double)NAN : sqrt(square / (known - 1.0));
  double error = *deviation / sqrt(known);
  return known == 0.0
             ? MISSING
             : (strut_estimate){mean, error, mean - NORMAL_95 * error, mean + NORMAL_95 * error};
}

/* Share of ones among values that are 0 or 1, with Wilson's interval; NANs are left out. */
static strut_estimate share_of(const double *values, size_t count) {
  double n = 0.0, ones = 0.0, z = NORMAL_95;
  for (size_t i = 0; i < count; i++)
    if (isfinite(values[i])) n += 1.0, ones += values[i] != 0.0;
  if (n == 0.0) return MISSING;
  double p = ones / n, scale = 1.0 + z * z / n, middle = (p + z * z / (2.0 * n)) / scale;
  double half = z * sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n)) / scale;
  return (strut_estimate){p, sqrt(p * (1.0 - p) / n), fmax(0.0, middle - half),
                          fmin(1.0, middle + half)};
}

/* Mean and deviation, or the share, of the independent samples A and B. */
static bool add_statistics(analysis *self, int64_t first, const target *t) {
  size_t count = self->axis->column_count, n = 0;
  for (int64_t j = 0; j < self->s->samples; j++) {
    int64_t at = strut_sensitivity_sample(self->s, count, j);
    self->design[n++] = self->values[at];
    self->design[n++] = self->values[at + (int64_t)count + 1];
  }
  size_t used = 0;
  for (size_t i = 0; i < n; i++) used += isfinite(self->design[i]) ? 1 : 0;
  strut_sensitivity_row row = {.point = first, .of = t->name, .unit = "1", .used = used};
  if (is_condition(t)) {
    row.measure = STRUT_SENSITIVITY_SHARE;
    row.estimate = share_of(self->design, n);
    return add_row(self, row);
  }
  row.unit = self->columns[t->column].unit;
  row.measure = STRUT_SENSITIVITY_MEAN;
  double deviation;
  row.estimate = mean_of(self->design, n, &deviation);
  if (!add_row(self, row)) return false;
  row.measure = STRUT_SENSITIVITY_DEVIATION;
  row.estimate = MISSING;
  row.estimate.value = deviation;
  return add_row(self, row);
}

static strut_status add_indices(analysis *self, int64_t first, const target *t) {
  strut_estimate of_first[STRUT_SENSITIVITY_MOST], of_total[STRUT_SENSITIVITY_MOST];
  size_t count = self->axis->column_count, used;
  const double *design = self->values + strut_sensitivity_sample(self->s, count, 0);
  strut_status status = strut_sensitivity_indices(design, (size_t)self->s->samples, count,
                                                  self->s->seed, of_first, of_total, &used);
  for (size_t k = 0; k < count && !status; k++) {
    strut_sensitivity_row row = {.point = first,
                                 .of = t->name,
                                 .parameter = self->axis->columns[k].name,
                                 .unit = "1",
                                 .used = used,
                                 .measure = STRUT_SENSITIVITY_FIRST_ORDER,
                                 .estimate = of_first[k]};
    bool fine = add_row(self, row);
    row.measure = STRUT_SENSITIVITY_TOTAL;
    row.estimate = of_total[k];
    if (!fine || !add_row(self, row)) status = STRUT_NO_MEMORY;
  }
  return status;
}

static strut_status analyse_target(analysis *self, int64_t first, const target *t) {
  read_values(self, first, t);
  if (self->s->derivatives && !is_condition(t) && !add_derivatives(self, first, t))
    return STRUT_NO_MEMORY;
  if (self->s->samples == 0) return STRUT_OK;
  return add_statistics(self, first, t) ? add_indices(self, first, t) : STRUT_NO_MEMORY;
}

strut_status strut_sensitivity_find(const strut_study *study, strut_slots *slots,
                                    strut_sensitivity_result *result, strut_error *error) {
  const strut_slots_description *plan = strut_slots_description_of(slots);
  analysis a = {.study = study,
                .s = &study->sensitivity,
                .axis = &study->axes[study->sensitivity.axis],
                .slots = slots,
                .columns = plan->columns,
                .column_count = plan->column_count,
                .result = result};
  *result = (strut_sensitivity_result){.study = study, .slots = slots};
  size_t count = a.axis->column_count;
  a.block = a.axis->count;
  bool fine = STRUT_ALLOCATE(&a.scratch, STRUT_NEW(a.values, a.block),
                             STRUT_NEW(a.design, 2 * a.s->samples + 1)) &&
              list_targets(&a);
  a.room = (size_t)(plan->points / a.block) * a.target_count * (4 * count + 2);
  if (fine) result->rows = strut_arena_allocate(&result->arena, a.room + 1, sizeof *result->rows);
  strut_status status = fine && result->rows ? STRUT_OK : STRUT_NO_MEMORY;
  for (int64_t first = 0; first < plan->points && !status; first += a.block)
    for (size_t i = 0; i < a.target_count && !status; i++)
      status = analyse_target(&a, first, &a.targets[i]);
  strut_arena_free(&a.scratch);
  return status ? strut_no_memory(error, "") : STRUT_OK;
}

/* ---- the table ---- */

/* Columns of the other axes: all before that of the analysis. */
static size_t other_columns(const strut_study *study) {
  size_t count = 0;
  for (size_t i = 0; i < study->sensitivity.axis; i++) count += study->axes[i].column_count;
  return count;
}

static const char *axis_name(const strut_result_object *of, size_t i) {
  const strut_sensitivity_result *result = of->outer->at;
  return strut_slots_description_of(result->slots)->columns[i].name;
}

static strut_value axis_value(const strut_result_object *of, size_t i) {
  const strut_sensitivity_result *result = of->outer->at;
  strut_result_slot row;
  return strut_slots_get(result->slots, ((const strut_sensitivity_row *)of->at)->point, &row)
             ? strut_slot_value(strut_slots_description_of(result->slots)->columns, &row, i)
             : STRUT_VALUE_AS_TEXT(NULL);
}

static double finite(double value) { return isfinite(value) ? value : (double)NAN; }

/* What is missing, and that a number never changes its sign, is in the file only. */
static bool is_shown(const strut_result_object *of, size_t i) {
  const strut_sensitivity_row *row = &((const strut_sensitivity_result *)of->at)->rows[i];
  double value = row->estimate.value;
  return isfinite(value) && !(strstr(row->of, " > 0") && (value == 0.0 || value == 1.0));
}

#define EFFECT(X)                                                                                  \
  X(NULL, "", MAP(other_columns(study), axis_name, axis_value), "", .column = {""}, .label = {""}) \
  X(NULL, "", TEXT(r->of), "", .column = {"of"}, .label = {"of"})                                  \
  X(NULL, "", TEXT(words[r->measure]), "", .column = {"measure"}, .label = {"measure"})            \
  X(NULL, "", TEXT(r->parameter), "", .column = {"parameter"}, .label = {"parameter"})             \
  X(NULL, "", NUMBER(finite(e->value)), "", .column = {"value"})                                   \
  X(NULL, "", CALLED("value", r->unit, e->value), "", .label = {"value"})                          \
  X(NULL, "", NUMBER(finite(e->error)), "", .column = {"error"})                                   \
  X(NULL, "", CALLED("error", r->unit, e->error), "", .label = {"error"})                          \
  X(NULL, "", NUMBER(finite(e->low)), "", .column = {"low"}, .label = {"low"})                     \
  X(NULL, "", NUMBER(finite(e->high)), "", .column = {"high"}, .label = {"high"})                  \
  X(NULL, "", TEXT(r->unit &&strcmp(r->unit, "1") != 0 ? r->unit : ""), "", .column = {"unit"})    \
  X(NULL, "", COUNT(r->used), "", .column = {"used"}, .label = {"used"})                           \
  X(NULL, "", TEXT(r->verdict), "", .column = {"verdict"}, .label = {"verdict"})
STRUT_VALUES_HERE(
    effect_values, EFFECT,
    const strut_study *study = ((const strut_sensitivity_result *)of->outer->at)->study;
    const strut_sensitivity_row *r = of->at; const strut_estimate *e = &r->estimate)

#define SENSITIVITY(X)                                                                             \
  X("effects", "", LIST_WHERE(result->rows, result->count, is_shown), "", .rows = &effect_values,  \
    .label = {""})
STRUT_VALUES(strut_sensitivity_values, SENSITIVITY, const strut_sensitivity_result *result = of->at)

strut_status strut_sensitivity_write(const strut_sensitivity_result *result, const char *directory,
                                     strut_error *error) {
  char *csv = strut_values_csv(&strut_sensitivity_values, "effects", NULL, result, NULL);
  return strut_file_write_block(directory, "sensitivity.csv", csv, error);
}

enum { BOOTSTRAPS = 500 };

/* One base sample after the other, without missing ones, and less their mean. */
typedef struct samples {
  size_t used, count;
  double *result; /* (used, count + 2) */
} samples;

static bool is_whole(const double *row, size_t width) {
  for (size_t k = 0; k < width; k++)
    if (!isfinite(row[k])) return false;
  return true;
}

static bool take_whole(const double *result, size_t all, size_t count, strut_arena *arena,
                       samples *self) {
  size_t width = count + 2;
  double sum = 0.0;
  *self = (samples){.count = count};
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(self->result, all * width + 1))) return false;
  for (size_t j = 0; j < all; j++) {
    const double *row = result + j * width;
    if (!is_whole(row, width)) continue;
    memcpy(self->result + self->used++ * width, row, width * sizeof *row);
    sum += row[0] + row[width - 1];
  }
  double mean = self->used ? sum / (2.0 * (double)self->used) : 0.0;
  for (size_t i = 0; i < self->used * width; i++) self->result[i] -= mean;
  return true;
}

/* Indices of the base samples that `pick` (used) lists; index (2, count). False: no variance. */
static bool estimate_indices(const samples *self, const size_t *pick, double *index) {
  size_t width = self->count + 2, n = self->used;
  double sum = 0.0, square = 0.0;
  memset(index, 0, 2 * self->count * sizeof *index);
  for (size_t j = 0; j < n; j++) {
    const double *row = self->result + pick[j] * width;
    double a = row[0], b = row[width - 1];
    sum += a + b;
    square += a * a + b * b;
    for (size_t k = 0; k < self->count; k++) {
      double mixed = row[1 + k];
      index[k] += b * (mixed - a);
      index[self->count + k] += 0.5 * (a - mixed) * (a - mixed);
    }
  }
  double mean = sum / (2.0 * (double)n), variance = square / (2.0 * (double)n) - mean * mean;
  for (size_t k = 0; k < 2 * self->count; k++) index[k] /= (double)n * variance;
  return variance > 1e-12 * square / (2.0 * (double)n) && variance > 0.0;
}

static strut_estimate describe(double value, double *drawn, size_t count) {
  double deviation;
  if (count < BOOTSTRAPS / 2) return (strut_estimate){value, (double)NAN, (double)NAN, (double)NAN};
  mean_of(drawn, count, &deviation);
  gsl_sort(drawn, 1, count);
  return (strut_estimate){value, deviation, drawn[(size_t)(0.025 * (double)(count - 1))],
                          drawn[(size_t)(0.975 * (double)(count - 1))]};
}

/* Estimates again from base samples drawn with replacement; drawn (2 count, BOOTSTRAPS). */
static size_t bootstrap(const samples *self, uint32_t seed, size_t *pick, double *index,
                        double *drawn) {
  gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
  size_t count = 0;
  if (!rng) return 0;
  gsl_rng_set(rng, seed ? seed : 1);
  for (int b = 0; b < BOOTSTRAPS; b++) {
    for (size_t j = 0; j < self->used; j++)
      pick[j] = (size_t)gsl_rng_uniform_int(rng, (unsigned long)self->used);
    if (!estimate_indices(self, pick, index)) continue;
    for (size_t k = 0; k < 2 * self->count; k++) drawn[k * BOOTSTRAPS + count] = index[k];
    count++;
  }
  gsl_rng_free(rng);
  return count;
}

strut_status strut_sensitivity_indices(const double *result, size_t all, size_t count,
                                       uint32_t seed, strut_estimate *first, strut_estimate *total,
                                       size_t *used) {
  strut_arena arena = {0};
  samples s;
  double *value, *index, *drawn;
  size_t *pick;
  bool ready = STRUT_ALLOCATE(&arena, STRUT_NEW(value, 2 * count), STRUT_NEW(index, 2 * count),
                              STRUT_NEW(drawn, 2 * count * BOOTSTRAPS), STRUT_NEW(pick, all + 1)) &&
               take_whole(result, all, count, &arena, &s);
  for (size_t k = 0; k < count; k++) first[k] = total[k] = MISSING;
  *used = ready ? s.used : 0;
  for (size_t j = 0; j < *used; j++) pick[j] = j;
  if (*used > 1 && estimate_indices(&s, pick, value)) {
    size_t drawings = bootstrap(&s, seed, pick, index, drawn);
    for (size_t k = 0; k < count; k++) {
      first[k] = describe(value[k], drawn + k * BOOTSTRAPS, drawings);
      total[k] = describe(value[count + k], drawn + (count + k) * BOOTSTRAPS, drawings);
    }
  }
  strut_arena_free(&arena);
  return ready ? STRUT_OK : STRUT_NO_MEMORY;
}

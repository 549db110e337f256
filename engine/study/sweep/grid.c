/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/checksum.h"
#include "engine/study/sweep/sweep_parts.h"

int64_t strut_grid_points(const strut_study *study) {
  int64_t points = 1;
  for (size_t i = 0; i < study->axis_count; i++) {
    int64_t count = study->axes[i].count;
    if (count < 1 || count > STRUT_STUDY_MOST_POINTS / points) return -1;
    points *= count;
  }
  return points;
}

size_t strut_grid_columns(const strut_study *study) {
  size_t columns = 0;
  for (size_t i = 0; i < study->axis_count; i++) columns += study->axes[i].column_count;
  return columns;
}

const strut_study_column *strut_grid_column(const strut_study *study, size_t k, size_t *axis) {
  size_t i = 0;
  while (k >= study->axes[i].column_count) k -= study->axes[i++].column_count;
  assert(i < study->axis_count);
  if (axis) *axis = i;
  return &study->axes[i].columns[k];
}

/* So that 0.1 + 0.2 is 0.3. */
double strut_grid_rounded(double value, double scale) {
  static const double tens[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22}; /* all exact */
  enum { EXACT = sizeof tens / sizeof tens[0] };
  char text[48];
  if (!(scale > 1e-280) || !isfinite(scale)) return value;
  int k = 14 - (int)floor(log10(scale));
  double power = abs(k) < EXACT ? tens[abs(k)] : pow(10.0, abs(k));
  double digits = rint(k > 0 ? value * power : value / power);
  if (digits == 0.0) return 0.0;                                      /* not -0 */
  if (abs(k) < EXACT) return k > 0 ? digits / power : digits * power; /* rounded once */
  snprintf(text, sizeof text, "%.0fe%d", digits, -k); /* no decimal point: locale-independent */
  return strtod(text, NULL);
}

double strut_grid_value(const strut_study_column *column, int64_t i, int64_t count) {
  double from = column->from, to = column->to, sum, last = (double)(count - 1);
  if (column->kind == STRUT_RANGE_LIST) return column->number[i];
  if (i == 0) return from;
  if (column->kind == STRUT_RANGE_STEP) {
    sum = from + (double)i * column->step;
    return strut_grid_rounded(sum, fmax(fabs(from), fabs(sum)));
  }
  if (i == count - 1) return to; /* exactly */
  if (column->kind == STRUT_RANGE_EVEN) {
    sum = from + (to - from) * (double)i / last;
    return strut_grid_rounded(sum, fmax(fabs(from), fabs(sum)));
  }
  long double first = (long double)from, part = (long double)i / (long double)last;
  long double ratio = powl((long double)to / first, part);
  double value = (double)(first * ratio);
  return strut_grid_rounded(value, fabs(value));
}

void strut_grid_values(const strut_study *study, int64_t point, strut_study_value *values) {
  size_t k = strut_grid_columns(study);
  assert(point >= 0);
  for (size_t a = study->axis_count; a-- > 0;) {
    const strut_study_axis *axis = &study->axes[a];
    int64_t i = point % axis->count;
    point /= axis->count;
    for (size_t c = axis->column_count; c-- > 0;) {
      const strut_study_column *column = &axis->columns[c];
      strut_study_value *value = &values[--k];
      *value = (strut_study_value){.number = (double)NAN};
      if (column->word)
        value->word = column->words[i];
      else
        value->number = strut_grid_value(column, i, axis->count);
    }
  }
  assert(k == 0 && point == 0);
}

struct strut_refinement {
  const strut_sweep_plan *plan;
  bool word;               /* the column has words */
  size_t cell;             /* its number among the words, or the numbers, of a row */
  double by;               /* by how much numbers must differ */
  int64_t count[2];        /* values of the two axes in the finest grid */
  int64_t stride[2];       /* of point numbers along them */
  int64_t side;            /* of the coarsest cells, in steps of the finest grid */
  uint8_t *known, *wanted; /* (points) */
  uint64_t *value;         /* (points) bits of a number, checksum of a word or of a failure */
};

static int64_t stride_of(const strut_study *study, size_t axis) {
  int64_t stride = 1;
  for (size_t i = axis + 1; i < study->axis_count; i++) stride *= study->axes[i].count;
  return stride;
}

static strut_status find_column(strut_refinement *refinement, strut_error *error) {
  const strut_sweep_plan *plan = refinement->plan;
  const size_t column =
      strut_slot_named(plan->columns, plan->column_count, plan->study->refine.where);
  if (column < plan->column_count) {
    refinement->word = plan->columns[column].word;
    refinement->cell = strut_slot_place(plan->columns, column);
    return STRUT_OK;
  }
  return strut_fail(error, STRUT_BAD_SCENE,
                    "refine: the table has no column '%.60s'; 'keep' chooses the columns",
                    plan->study->refine.where);
}

strut_status strut_refinement_create(const strut_sweep_plan *plan, strut_refinement **refinement,
                                     strut_error *error) {
  const strut_study *study = plan->study;
  strut_refinement *r = strut_allocate(1, sizeof *r);
  *refinement = r;
  if (!r) return strut_no_memory(error, "");
  r->plan = plan;
  r->by = study->refine.by;
  r->side = (int64_t)1 << study->refine.depth;
  for (int i = 0; i < 2; i++) {
    r->count[i] = study->axes[study->refine.axes[i]].count;
    r->stride[i] = stride_of(study, study->refine.axes[i]);
  }
  strut_status status = find_column(r, error);
  if (!status) {
    r->known = strut_allocate((size_t)plan->points, sizeof *r->known);
    r->wanted = strut_allocate((size_t)plan->points, sizeof *r->wanted);
    r->value = strut_allocate((size_t)plan->points, sizeof *r->value);
    if (!r->known || !r->wanted || !r->value) status = strut_no_memory(error, "");
  }
  if (!status) return STRUT_OK;
  strut_refinement_free(r);
  *refinement = NULL;
  return status;
}

void strut_refinement_free(strut_refinement *refinement) {
  if (!refinement) return;
  strut_release(refinement->known);
  strut_release(refinement->wanted);
  strut_release(refinement->value);
  strut_release(refinement);
}

/* What two rows are compared by. */
static uint64_t value_of(const strut_refinement *refinement, const strut_result_slot *row) {
  uint64_t bits;
  if (row->status) return strut_checksum(&row->status, sizeof row->status, 1);
  if (refinement->word)
    return strut_checksum(row->words[refinement->cell], strlen(row->words[refinement->cell]), 0);
  memcpy(&bits, &row->numbers[refinement->cell], sizeof bits);
  return bits;
}

void strut_refinement_learn(strut_refinement *refinement, strut_slots *slots) {
  int64_t count = strut_slots_description_of(slots)->count;
  for (int64_t i = 0; i < count; i++) {
    strut_result_slot row;
    int64_t point = strut_slots_point(slots, i);
    if (refinement->known[point] || !strut_slots_done(slots, point)) continue;
    if (!strut_slots_get(slots, point, &row)) continue;
    refinement->value[point] = value_of(refinement, &row);
    refinement->known[point] = 1 + (row.status != STRUT_OK);
  }
}

/* The range of the known values on the edges of a cell. */
typedef struct seen {
  bool any, mixed; /* words, failures or missing numbers that are not all alike */
  uint64_t first;
  uint8_t kind;
  double low, high;
} seen;

static void look_at(const strut_refinement *refinement, int64_t point, seen *self) {
  if (!refinement->known[point]) return;
  double number = (double)NAN;
  bool failed = refinement->known[point] == 2;
  if (!refinement->word && !failed) memcpy(&number, &refinement->value[point], sizeof number);
  bool plain = !refinement->word && !failed && !isnan(number);
  uint8_t kind = failed ? 2 : plain ? 1 : 0;
  uint64_t value = plain || (!failed && !refinement->word) ? 0 : refinement->value[point];
  if (self->any && (self->kind != kind || self->first != value)) self->mixed = true;
  if (plain) {
    self->low = self->any ? fmin(self->low, number) : number;
    self->high = self->any ? fmax(self->high, number) : number;
  }
  if (!self->any) self->first = value, self->kind = kind;
  self->any = true;
}

static bool differs(const strut_refinement *refinement, int64_t corner, int64_t side) {
  int64_t a = refinement->stride[0], b = refinement->stride[1];
  seen s = {.any = false};
  for (int64_t i = 0; i <= side; i++) {
    look_at(refinement, corner + i * a, &s);
    look_at(refinement, corner + i * a + side * b, &s);
    look_at(refinement, corner + i * b, &s);
    look_at(refinement, corner + i * b + side * a, &s);
  }
  return s.mixed || (s.kind == 1 && s.high - s.low > refinement->by);
}

/* Wants the points that divide the cell, if it has to be, and its quarters'. */
static void divide(strut_refinement *refinement, int64_t corner, int64_t side) {
  int64_t half = side / 2, a = half * refinement->stride[0], b = half * refinement->stride[1];
  const int64_t middle[5] = {corner + a, corner + b, corner + a + b, corner + a + 2 * b,
                             corner + 2 * a + b};
  bool all = true;
  if (side == 1 || !differs(refinement, corner, side)) return;
  for (int i = 0; i < 5; i++) {
    refinement->wanted[middle[i]] = 1;
    all = all && refinement->known[middle[i]];
  }
  if (!all) return; /* their values first */
  divide(refinement, corner, half);
  divide(refinement, corner + a, half);
  divide(refinement, corner + b, half);
  divide(refinement, corner + a + b, half);
}

/* The place of a point on one of the two axes. */
static int64_t place(const strut_refinement *refinement, int64_t point, int axis) {
  return point / refinement->stride[axis] % refinement->count[axis];
}

int64_t strut_refinement_choose(strut_refinement *refinement) {
  int64_t unknown = 0;
  for (int64_t point = 0; point < refinement->plan->points; point++) {
    int64_t i = place(refinement, point, 0), k = place(refinement, point, 1);
    if (i % refinement->side || k % refinement->side) continue;
    refinement->wanted[point] = 1;
    if (i + refinement->side < refinement->count[0] && k + refinement->side < refinement->count[1])
      divide(refinement, point, refinement->side);
  }
  for (int64_t point = 0; point < refinement->plan->points; point++)
    unknown += refinement->wanted[point] && !refinement->known[point];
  return unknown;
}

bool strut_refinement_wants(const void *refinement, int64_t point) {
  const strut_refinement *r = refinement;
  return r->wanted[point];
}

void strut_refinement_count(const strut_refinement *refinement, strut_slots *slots, int64_t *wanted,
                            int64_t *done) {
  int64_t count = strut_slots_description_of(slots)->count;
  *wanted = *done = 0;
  for (int64_t i = 0; i < count; i++) {
    int64_t point = strut_slots_point(slots, i);
    if (!refinement->wanted[point]) continue;
    ++*wanted;
    *done += strut_slots_done(slots, point);
  }
}

int64_t strut_refinement_coarse(const strut_sweep_plan *plan) {
  const strut_study *study = plan->study;
  int64_t points = plan->points;
  for (int i = 0; i < 2; i++) {
    int64_t count = study->axes[study->refine.axes[i]].count;
    points = points / count * ((count - 1) / ((int64_t)1 << study->refine.depth) + 1);
  }
  return points;
}

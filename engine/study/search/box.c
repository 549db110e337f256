/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/search/box.h"

#include <math.h>
#include <string.h>

#include "engine/study/sweep/grid.h"

int64_t strut_search_count(const strut_search_variable *v) {
  if (v->choice_count) return (int64_t)v->choice_count;
  return v->integer ? (int64_t)(floor(v->to) - ceil(v->from)) + 1 : 0;
}

static double bring_in(const strut_search_variable *v, double number) {
  if (v->wraps) number -= floor(number);
  return fmin(fmax(number, 0.0), 1.0); /* NaN becomes 0 */
}

/* Which of `count` equal parts of the box. */
static int64_t part_of(double number, int64_t count) {
  int64_t part = (int64_t)floor(number * (double)count);
  return part < count ? part : count - 1;
}

/* A value between the bounds, to 15 digits, so that tables have round numbers where they are. */
static double between(const strut_search_variable *v, double value) {
  value = strut_grid_rounded(value, fmax(fabs(v->from), fabs(value)));
  return fmin(fmax(value, v->from), v->to);
}

strut_study_value strut_search_value(const strut_search_variable *v, double number) {
  strut_study_value value = {.number = (double)NAN};
  int64_t count = strut_search_count(v);
  number = bring_in(v, number);
  if (v->choice_count) {
    int64_t i = part_of(number, count);
    if (v->word)
      value.word = v->words[i];
    else
      value.number = v->numbers[i];
  } else if (v->integer) {
    value.number = ceil(v->from) + (double)part_of(number, count);
  } else if (number == 0.0) {
    value.number = v->from; /* its own bits */
  } else if (number == 1.0) {
    value.number = v->wraps ? v->from : v->to;
  } else if (v->logarithmic) {
    value.number = between(v, v->from * pow(v->to / v->from, number));
  } else {
    value.number = between(v, v->from + (v->to - v->from) * number);
  }
  return value;
}

bool strut_search_same(strut_study_value a, strut_study_value b) {
  if (a.word || b.word) return a.word && b.word && strcmp(a.word, b.word) == 0;
  return a.number == b.number;
}

double strut_search_number(const strut_search_variable *v, strut_study_value value) {
  int64_t count = strut_search_count(v);
  if (v->choice_count) {
    int64_t i = 0;
    while (i + 1 < count &&
           !(v->word ? strcmp(v->words[i], value.word) == 0 : v->numbers[i] == value.number))
      i++;
    return ((double)i + 0.5) / (double)count;
  }
  if (v->integer) return (value.number - ceil(v->from) + 0.5) / (double)count;
  if (v->logarithmic) return log(value.number / v->from) / log(v->to / v->from);
  return (value.number - v->from) / (v->to - v->from);
}

double strut_search_start(const strut_search_variable *v) {
  strut_study_value value = {.number = v->start};
  if (v->choice_count) value = strut_search_value(v, 0.0);
  return strut_search_number(v, value);
}

int strut_search_bound(const strut_search_variable *v, strut_study_value value) {
  if (v->choice_count || v->wraps) return 0;
  if (value.number <= (v->integer ? ceil(v->from) : v->from)) return -1;
  return value.number >= (v->integer ? floor(v->to) : v->to) ? 1 : 0;
}

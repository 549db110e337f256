/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/expression/expression_parts.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Beyond this no exponent of a dimension means anything. */
static const float POWER_MOST = 100;

typedef enum function_kind {
  OF_NUMBER,     /* a number without unit; so is the result */
  OF_ANGLE,      /* an angle or a bare number; a bare result */
  TO_ANGLE,      /* a number without unit; the result is an angle */
  OF_ROOT,       /* any dimension, halved */
  OF_ANY,        /* any dimension, kept */
  OF_LIKE,       /* arguments of one dimension, kept */
  LIKE_TO_ANGLE, /* two arguments of one dimension; the result is an angle */
} function_kind;

struct strut_function {
  const char *name;
  function_kind kind;
  size_t least, most; /* arguments */
  double (*one)(double);
  double (*two)(double, double);
  strut_operation operation;
};

static double lesser(double a, double b) { return b < a ? b : a; }
static double greater(double a, double b) { return b > a ? b : a; }

static const strut_function functions[] = {
    {"sin", OF_ANGLE, 1, 1, sin, NULL, STRUT_OPERATION_SIN},
    {"cos", OF_ANGLE, 1, 1, cos, NULL, STRUT_OPERATION_COS},
    {"tan", OF_ANGLE, 1, 1, tan, NULL, STRUT_OPERATION_TAN},
    {"asin", TO_ANGLE, 1, 1, asin, NULL, STRUT_OPERATION_ASIN},
    {"acos", TO_ANGLE, 1, 1, acos, NULL, STRUT_OPERATION_ACOS},
    {"atan", TO_ANGLE, 1, 1, atan, NULL, STRUT_OPERATION_ATAN},
    {"atan2", LIKE_TO_ANGLE, 2, 2, NULL, atan2, STRUT_OPERATION_ATAN2},
    {"sqrt", OF_ROOT, 1, 1, sqrt, NULL, STRUT_OPERATION_SQRT},
    {"exp", OF_NUMBER, 1, 1, exp, NULL, STRUT_OPERATION_EXP},
    {"log", OF_NUMBER, 1, 1, log, NULL, STRUT_OPERATION_LOG},
    {"log10", OF_NUMBER, 1, 1, log10, NULL, STRUT_OPERATION_LOG10},
    {"abs", OF_ANY, 1, 1, fabs, NULL, STRUT_OPERATION_ABS},
    {"min", OF_LIKE, 2, STRUT_ARGUMENT_MOST, NULL, lesser, STRUT_OPERATION_MIN},
    {"max", OF_LIKE, 2, STRUT_ARGUMENT_MOST, NULL, greater, STRUT_OPERATION_MAX},
    {"floor", OF_NUMBER, 1, 1, floor, NULL, STRUT_OPERATION_FLOOR},
    {"ceil", OF_NUMBER, 1, 1, ceil, NULL, STRUT_OPERATION_CEIL},
    {"round", OF_NUMBER, 1, 1, round, NULL, STRUT_OPERATION_ROUND},
    {"hypot", OF_LIKE, 2, 2, NULL, hypot, STRUT_OPERATION_HYPOT},
};
enum { FUNCTION_COUNT = sizeof functions / sizeof functions[0] };

static bool refuse(strut_reason *reason, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static bool refuse(strut_reason *reason, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(reason->text, sizeof reason->text, format, arguments);
  va_end(arguments);
  return false;
}

static bool dimensionless(strut_quantity q) {
  return q.bare || strut_dimension_equal(q.dimension, STRUT_DIM_NONE);
}

static strut_dimension combine(strut_dimension a, strut_dimension b, float times) {
  return (strut_dimension){a.kg + times * b.kg, a.m + times * b.m, a.s + times * b.s,
                           a.angle + times * b.angle};
}

static bool in_range(strut_dimension d) {
  return fabsf(d.kg) <= POWER_MOST && fabsf(d.m) <= POWER_MOST && fabsf(d.s) <= POWER_MOST &&
         fabsf(d.angle) <= POWER_MOST;
}

/* Makes a and b of one dimension, where they are or one is bare. */
static bool agree(strut_quantity *a, strut_quantity b, const char *what, strut_reason *reason) {
  if (b.bare) return true;
  if (a->bare) {
    a->dimension = b.dimension;
    a->bare = false;
    return true;
  }
  if (strut_dimension_equal(a->dimension, b.dimension)) return true;
  char first[64], second[64];
  return refuse(reason, "%s joins %s and %s, expected equal dimensions", what,
                strut_dimension_name(a->dimension, first, sizeof first),
                strut_dimension_name(b.dimension, second, sizeof second));
}

static bool raise(strut_quantity *a, strut_quantity b, strut_reason *reason) {
  char name[64];
  if (!dimensionless(b))
    return refuse(reason, "the exponent is %s, expected a number without unit",
                  strut_dimension_name(b.dimension, name, sizeof name));
  if (b.varies && !dimensionless(*a))
    return refuse(reason, "the exponent varies in time, so %s cannot be raised to it",
                  strut_dimension_name(a->dimension, name, sizeof name));
  if (!a->bare && !b.varies) a->dimension = combine(STRUT_DIM_NONE, a->dimension, (float)b.value);
  if (!in_range(a->dimension)) return refuse(reason, "the power of a unit is too high");
  a->bare = a->bare && b.bare;
  a->value = pow(a->value, b.value);
  return true;
}

bool strut_quantity_operate(char operation, strut_quantity *a, strut_quantity b,
                            strut_reason *reason) {
  bool varies = a->varies || b.varies;
  switch (operation) {
    case '+':
    case '-':
      if (!agree(a, b, operation == '+' ? "'+'" : "'-'", reason)) return false;
      a->value = operation == '+' ? a->value + b.value : a->value - b.value;
      break;
    case '*':
    case '/':
      a->dimension = combine(a->dimension, b.dimension, operation == '*' ? 1 : -1);
      a->bare = a->bare && b.bare;
      if (!in_range(a->dimension)) return refuse(reason, "the power of a unit is too high");
      if (operation == '/' && b.value == 0) return refuse(reason, "division by zero");
      a->value = operation == '*' ? a->value * b.value : a->value / b.value;
      break;
    default:
      if (!raise(a, b, reason)) return false;
  }
  a->varies = varies;
  if (varies) a->value = 1; /* not known */
  if (isnan(a->value)) return refuse(reason, "the result of '%c' is not a real number", operation);
  if (isinf(a->value)) return refuse(reason, "the result of '%c' is not finite", operation);
  return true;
}

const strut_function *strut_function_find(const char *name, size_t length) {
  for (size_t i = 0; i < FUNCTION_COUNT; i++)
    if (strlen(functions[i].name) == length && memcmp(functions[i].name, name, length) == 0)
      return &functions[i];
  return NULL;
}

const char *strut_function_name(size_t i) { return i < FUNCTION_COUNT ? functions[i].name : NULL; }

strut_operation strut_function_operation(const strut_function *f) { return f->operation; }

static bool check_argument(const strut_function *f, strut_quantity argument, strut_reason *reason) {
  bool angle = strut_dimension_equal(argument.dimension, STRUT_DIM_ANGLE);
  bool free_kind =
      f->kind == OF_ROOT || f->kind == OF_ANY || f->kind == OF_LIKE || f->kind == LIKE_TO_ANGLE;
  if (free_kind || dimensionless(argument) || (f->kind == OF_ANGLE && angle)) return true;
  char name[64];
  return refuse(reason, "'%s' takes %s, got %s", f->name,
                f->kind == OF_ANGLE ? "an angle" : "a number without unit",
                strut_dimension_name(argument.dimension, name, sizeof name));
}

static bool check_count(const strut_function *f, size_t count, strut_reason *reason) {
  if (count >= f->least && count <= f->most) return true;
  if (f->least == f->most)
    return refuse(reason, "'%s' takes %zu argument%s, got %zu", f->name, f->least,
                  f->least == 1 ? "" : "s", count);
  return refuse(reason, "'%s' takes %zu to %zu arguments, got %zu", f->name, f->least, f->most,
                count);
}

bool strut_function_apply(const strut_function *f, const strut_quantity *arguments, size_t count,
                          strut_quantity *result, strut_reason *reason) {
  if (!check_count(f, count, reason)) return false;
  strut_quantity q = arguments[0];
  char what[32];
  snprintf(what, sizeof what, "'%s'", f->name);
  if (!check_argument(f, q, reason)) return false;
  bool varies = q.varies;
  if (f->one) q.value = f->one(q.value);
  for (size_t i = 1; i < count; i++) {
    if (!agree(&q, arguments[i], what, reason)) return false;
    q.value = f->two(q.value, arguments[i].value);
    varies = varies || arguments[i].varies;
  }
  if (f->kind == OF_ROOT) q.dimension = combine(STRUT_DIM_NONE, q.dimension, 0.5f);
  if (f->kind == OF_ANGLE) {
    /* A sine is a plain number whatever its angle was written in: 0.1*cos(30 deg) is a length. */
    q.dimension = STRUT_DIM_NONE;
    q.bare = true;
  } else if (f->kind == TO_ANGLE || f->kind == LIKE_TO_ANGLE) {
    q.dimension = STRUT_DIM_ANGLE;
    q.bare = false;
  }
  q.varies = varies;
  if (varies) q.value = 1; /* not known */
  if (isnan(q.value)) return refuse(reason, "the result of '%s' is not a real number", f->name);
  if (isinf(q.value)) return refuse(reason, "the result of '%s' is not finite", f->name);
  *result = q;
  return true;
}

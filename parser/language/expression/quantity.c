/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/language/expression/expression.h"
#include "parser/language/expression/expression_parts.h"

/* Largest meaningful exponent of a dimension. */
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
    {"tanh", OF_NUMBER, 1, 1, tanh, NULL, STRUT_OPERATION_TANH},
    {"abs", OF_ANY, 1, 1, fabs, NULL, STRUT_OPERATION_ABS},
    {"min", OF_LIKE, 2, STRUT_ARGUMENT_MOST, NULL, lesser, STRUT_OPERATION_MIN},
    {"max", OF_LIKE, 2, STRUT_ARGUMENT_MOST, NULL, greater, STRUT_OPERATION_MAX},
    {"floor", OF_NUMBER, 1, 1, floor, NULL, STRUT_OPERATION_FLOOR},
    {"ceil", OF_NUMBER, 1, 1, ceil, NULL, STRUT_OPERATION_CEIL},
    {"round", OF_NUMBER, 1, 1, round, NULL, STRUT_OPERATION_ROUND},
    {"hypot", OF_LIKE, 2, 2, NULL, hypot, STRUT_OPERATION_HYPOT},
};
enum { FUNCTION_COUNT = sizeof functions / sizeof functions[0] };

static bool fail_with_reason(strut_reason *reason, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static bool fail_with_reason(strut_reason *reason, const char *format, ...) {
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

/* Gives a and b one dimension, if they have the same or one is bare. */
static bool unify_dimensions(strut_quantity *quantity, strut_quantity b, const char *what,
                             strut_reason *reason) {
  if (b.bare) return true;
  if (quantity->bare) {
    quantity->dimension = b.dimension;
    quantity->bare = false;
    return true;
  }
  if (strut_dimension_equal(quantity->dimension, b.dimension)) return true;
  char first[64], second[64];
  return fail_with_reason(reason, "%s joins %s and %s, expected equal dimensions", what,
                          strut_dimension_name(quantity->dimension, first, sizeof first),
                          strut_dimension_name(b.dimension, second, sizeof second));
}

static bool raise_to_power(strut_quantity *quantity, strut_quantity b, strut_reason *reason) {
  char name[64];
  if (!dimensionless(b))
    return fail_with_reason(reason, "the exponent is %s, expected a number without unit",
                            strut_dimension_name(b.dimension, name, sizeof name));
  if (b.varies && !dimensionless(*quantity))
    return fail_with_reason(reason, "the exponent varies in time, so %s cannot be raised to it",
                            strut_dimension_name(quantity->dimension, name, sizeof name));
  if (!quantity->bare && !b.varies)
    quantity->dimension = combine(STRUT_DIM_NONE, quantity->dimension, (float)b.value);
  if (!in_range(quantity->dimension))
    return fail_with_reason(reason, "the power of a unit is too high");
  quantity->bare = quantity->bare && b.bare;
  quantity->value = pow(quantity->value, b.value);
  return true;
}

/* The value of a result; 1 where it varies, since it is not known. False: it is no finite number. */
static bool check_result(strut_quantity *quantity, bool varies, const char *what,
                         strut_reason *reason) {
  quantity->varies = varies;
  if (varies) quantity->value = 1;
  if (isfinite(quantity->value)) return true;
  return fail_with_reason(reason, "the result of %s is not %s", what,
                          isnan(quantity->value) ? "a real number" : "finite");
}

bool strut_quantity_operate(char operation, strut_quantity *quantity, strut_quantity b,
                            strut_reason *reason) {
  const char what[] = {'\'', operation, '\'', '\0'};
  bool varies = quantity->varies || b.varies;
  switch (operation) {
    case '+':
    case '-':
      if (!unify_dimensions(quantity, b, what, reason)) return false;
      quantity->value = operation == '+' ? quantity->value + b.value : quantity->value - b.value;
      break;
    case '*':
    case '/':
      quantity->dimension = combine(quantity->dimension, b.dimension, operation == '*' ? 1 : -1);
      quantity->bare = quantity->bare && b.bare;
      if (!in_range(quantity->dimension))
        return fail_with_reason(reason, "the power of a unit is too high");
      if (operation == '/' && b.value == 0) return fail_with_reason(reason, "division by zero");
      quantity->value = operation == '*' ? quantity->value * b.value : quantity->value / b.value;
      break;
    default:
      if (!raise_to_power(quantity, b, reason)) return false;
  }
  return check_result(quantity, varies, what, reason);
}

const strut_function *strut_function_find(const char *name, size_t length) {
  for (size_t i = 0; i < FUNCTION_COUNT; i++)
    if (strlen(functions[i].name) == length && memcmp(functions[i].name, name, length) == 0)
      return &functions[i];
  return NULL;
}

const char *strut_function_name(size_t i) { return i < FUNCTION_COUNT ? functions[i].name : NULL; }

strut_operation strut_function_operation(const strut_function *function) {
  return function->operation;
}

static bool check_argument(const strut_function *function, strut_quantity argument,
                           strut_reason *reason) {
  bool angle = strut_dimension_equal(argument.dimension, STRUT_DIM_ANGLE);
  bool free_kind = function->kind == OF_ROOT || function->kind == OF_ANY ||
                   function->kind == OF_LIKE || function->kind == LIKE_TO_ANGLE;
  if (free_kind || dimensionless(argument) || (function->kind == OF_ANGLE && angle)) return true;
  char name[64];
  return fail_with_reason(reason, "'%s' takes %s, got %s", function->name,
                          function->kind == OF_ANGLE ? "an angle" : "a number without unit",
                          strut_dimension_name(argument.dimension, name, sizeof name));
}

static bool check_count(const strut_function *function, size_t count, strut_reason *reason) {
  if (count >= function->least && count <= function->most) return true;
  if (function->least == function->most)
    return fail_with_reason(reason, "'%s' takes %zu argument%s, got %zu", function->name,
                            function->least, function->least == 1 ? "" : "s", count);
  return fail_with_reason(reason, "'%s' takes %zu to %zu arguments, got %zu", function->name,
                          function->least, function->most, count);
}

bool strut_function_apply(const strut_function *function, const strut_quantity *arguments,
                          size_t count, strut_quantity *result, strut_reason *reason) {
  if (!check_count(function, count, reason)) return false;
  strut_quantity q = arguments[0];
  char what[32];
  snprintf(what, sizeof what, "'%s'", function->name);
  if (!check_argument(function, q, reason)) return false;
  bool varies = q.varies;
  if (function->one) q.value = function->one(q.value);
  for (size_t i = 1; i < count; i++) {
    if (!unify_dimensions(&q, arguments[i], what, reason)) return false;
    q.value = function->two(q.value, arguments[i].value);
    varies = varies || arguments[i].varies;
  }
  if (function->kind == OF_ROOT) q.dimension = combine(STRUT_DIM_NONE, q.dimension, 0.5f);
  if (function->kind == OF_ANGLE) {
    /* A sine is a plain number whatever its angle was written in: 0.1*cos(30 deg) is a length. */
    q.dimension = STRUT_DIM_NONE;
    q.bare = true;
  } else if (function->kind == TO_ANGLE || function->kind == LIKE_TO_ANGLE) {
    q.dimension = STRUT_DIM_ANGLE;
    q.bare = false;
  }
  if (!check_result(&q, varies, what, reason)) return false;
  *result = q;
  return true;
}

/* clang-format off */
#define ENERGY {1, 2, -2, 0}
#define FORCE {1, 1, -2, 0}
#define FREQUENCY {0, 0, -1, 0}
#define LENGTH {0, 1, 0, 0}
#define MASS {1, 0, 0, 0}
#define PRESSURE {1, -1, -2, 0}
#define POWER {1, 2, -3, 0}
#define TIME {0, 0, 1, 0}
#define ANGLE {0, 0, 0, 1}
#define NONE {0, 0, 0, 0}
/* clang-format on */

/* In the order of strcmp, for the binary search. */
static const strut_unit units[] = {
    {"%", 1e-2, NONE, 1, -2},
    {"GPa", 1e9, PRESSURE, 1, 9},
    {"Hz", 1, FREQUENCY, 1, 0},
    {"J", 1, ENERGY, 1, 0},
    {"MHz", 1e6, FREQUENCY, 1, 6},
    {"MJ", 1e6, ENERGY, 1, 6},
    {"MN", 1e6, FORCE, 1, 6},
    {"MPa", 1e6, PRESSURE, 1, 6},
    {"N", 1, FORCE, 1, 0},
    {"Pa", 1, PRESSURE, 1, 0},
    {"W", 1, POWER, 1, 0},
    {"cm", 1e-2, LENGTH, 1, -2},
    {"deg", STRUT_PI / 180, ANGLE, STRUT_PI / 180, 0},
    {"g", 1e-3, MASS, 1, -3},
    {"h", 3600, TIME, 3600, 0},
    {"kHz", 1e3, FREQUENCY, 1, 3},
    {"kJ", 1e3, ENERGY, 1, 3},
    {"kN", 1e3, FORCE, 1, 3},
    {"kPa", 1e3, PRESSURE, 1, 3},
    {"kW", 1e3, POWER, 1, 3},
    {"kg", 1, MASS, 1, 0},
    {"km", 1e3, LENGTH, 1, 3},
    {"m", 1, LENGTH, 1, 0},
    {"mHz", 1e-3, FREQUENCY, 1, -3},
    {"mJ", 1e-3, ENERGY, 1, -3},
    {"mN", 1e-3, FORCE, 1, -3},
    {"mW", 1e-3, POWER, 1, -3},
    {"mg", 1e-6, MASS, 1, -6},
    {"min", 60, TIME, 60, 0},
    {"mm", 1e-3, LENGTH, 1, -3},
    {"mrad", 1e-3, ANGLE, 1, -3},
    {"ms", 1e-3, TIME, 1, -3},
    {"nm", 1e-9, LENGTH, 1, -9},
    {"ns", 1e-9, TIME, 1, -9},
    {"percent", 1e-2, NONE, 1, -2},
    {"rad", 1, ANGLE, 1, 0},
    {"s", 1, TIME, 1, 0},
    {"t", 1e3, MASS, 1, 3},
    {"turn", 2 * STRUT_PI, ANGLE, 2 * STRUT_PI, 0},
    {"uN", 1e-6, FORCE, 1, -6},
    {"um", 1e-6, LENGTH, 1, -6},
    {"us", 1e-6, TIME, 1, -6},
};
enum { UNIT_COUNT = sizeof units / sizeof units[0] };

/* Name of a dimension in messages, an example of a value, and its SI unit. */
static const struct dimension_words {
  strut_dimension dimension;
  const char *name, *example, *unit;
} words[] = {
    {NONE, "a number without unit", "0.5", "1"},
    {LENGTH, "a length", "10 mm", "m"},
    {MASS, "a mass", "100 g", "kg"},
    {TIME, "a time", "0.1 ms", "s"},
    {FREQUENCY, "a frequency", "10 Hz", "Hz"},
    {ANGLE, "an angle", "30 deg", "rad"},
    {{0, 1, -1, 0}, "a velocity", "5 mm/s", "m/s"},
    {{0, 1, -2, 0}, "an acceleration", "9.81 m/s^2", "m/s^2"},
    {FORCE, "a force", "10 N", "N"},
    {{1, 0, -2, 0}, "a stiffness", "20 N/cm", "N/m"},
    {{1, 0, -1, 0}, "a damping", "0.2 N s/m", "N s/m"},
    {{0, -1, 1, 0}, "a dissipation", "0.5 s/m", "s/m"},
    {{0, 2, 0, 0}, "an area", "10 mm^2", "m^2"},
    {{0, 3, 0, 0}, "a volume", "10 cm^3", "m^3"},
    {{1, -3, 0, 0}, "a density", "1000 kg/m^3", "kg/m^3"},
    {ENERGY, "an energy", "1 J", "J"},
    {POWER, "a power", "1 W", "W"},
    {PRESSURE, "a pressure", "1 MPa", "Pa"},
    {{0, 0, -1, 1}, "an angular velocity", "10 rad/s", "rad/s"},
    {{0, 2, -1, 0}, "a conductance", "1 cm^2/s", "m^2/s"},
    {{1, -2, -2, 0}, "a value in N/m^3", "5 N/m^3", "N/m^3"},
    {{1, -2, -1, 0}, "a value in N s/m^3", "0.1 N s/m^3", "N s/m^3"},
    {{1, 3, -2, 0}, "a bending stiffness", "2 N m^2", "N m^2"},
    {{1, 2, -2, -1}, "an angular stiffness", "3 N m/rad", "N m/rad"},
    {{1, 2, -1, -1}, "an angular damping", "0.01 N m s/rad", "N m s/rad"},
};
enum { WORD_COUNT = sizeof words / sizeof words[0] };

/* The order of a word and of a unit's name, of which the word may be the beginning. */
static int compare_unit(const void *word, const void *unit) {
  const strut_piece *piece = word;
  const char *name = ((const strut_unit *)unit)->name;
  int order = strncmp(piece->text, name, piece->length);
  return order || !name[piece->length] ? order : -1;
}

const strut_unit *strut_unit_find(const char *name, size_t length) {
  const strut_piece word = {name, length};
  return bsearch(&word, units, UNIT_COUNT, sizeof units[0], compare_unit);
}

const strut_unit *strut_unit_at(size_t i) { return i < UNIT_COUNT ? &units[i] : NULL; }

strut_file_unit strut_unit_of_text(const char *text, strut_arena *arena) {
  strut_file_unit unit = {0};
  strut_quantity one;
  strut_expression_error unused;
  char whole[40];
  text += *text == '-' || *text == '+';
  const char *rest = text + strut_number_scan(text, strlen(text));
  bool number = rest > text;
  rest += strspn(rest, " ");
  bool word = number && *rest && !strpbrk(rest, "+-*(),");
  if (word && snprintf(whole, sizeof whole, "1 %s", rest) < (int)sizeof whole &&
      strut_expression_evaluate(whole, NULL, &one, &unused))
    unit = (strut_file_unit){arena ? strut_arena_text(arena, rest, strlen(rest)) : rest, one.value};
  return unit;
}

/* Exponents result from roots and powers: in floats, 3 * (1/3) is only nearly 1. */
static bool same(float a, float b) { return fabsf(a - b) < 1e-4f; }

bool strut_dimension_equal(strut_dimension a, strut_dimension b) {
  return same(a.kg, b.kg) && same(a.m, b.m) && same(a.s, b.s) && same(a.angle, b.angle);
}

static const struct dimension_words *find_words(strut_dimension dimension) {
  for (size_t i = 0; i < WORD_COUNT; i++)
    if (strut_dimension_equal(words[i].dimension, dimension)) return &words[i];
  return NULL;
}

/* Appends " name^exponent" as far as there is room; exponent in thousandths keeps locales out. */
static size_t append_power(char *buffer, size_t size, size_t used, const char *name,
                           float exponent) {
  if (same(exponent, 0) || used >= size) return used;
  long thousandths = lroundf(exponent * 1000);
  const char *space = used ? " " : "";
  int added;
  if (thousandths == 1000) {
    added = snprintf(buffer + used, size - used, "%s%s", space, name);
  } else if (thousandths % 1000 == 0) {
    added = snprintf(buffer + used, size - used, "%s%s^%ld", space, name, thousandths / 1000);
  } else {
    long magnitude = labs(thousandths), fraction = magnitude % 1000;
    int digits = 3;
    for (; fraction % 10 == 0; digits--) fraction /= 10;
    added = snprintf(buffer + used, size - used, "%s%s^%s%ld.%0*ld", space, name,
                     thousandths < 0 ? "-" : "", magnitude / 1000, digits, fraction);
  }
  return added < 0 ? used : used + (size_t)added;
}

const char *strut_dimension_name(strut_dimension dimension, char *buffer, size_t size) {
  const struct dimension_words *known = find_words(dimension);
  if (!size) return buffer;
  if (known) {
    snprintf(buffer, size, "%s", known->name);
    return buffer;
  }
  buffer[0] = '\0';
  size_t used = append_power(buffer, size, 0, "kg", dimension.kg);
  used = append_power(buffer, size, used, "m", dimension.m);
  used = append_power(buffer, size, used, "s", dimension.s);
  append_power(buffer, size, used, "rad", dimension.angle);
  return buffer;
}

/* Appends " kg^2", or " * (1 kg)^0.5" for a power that units cannot have. */
static size_t append_unit(char *buffer, size_t size, size_t used, const char *unit, float power) {
  if (same(power, 0) || used >= size) return used;
  bool whole = same(power, roundf(power)) && fabsf(power) <= 12;
  if (whole) return append_power(buffer, size, used, unit, power);
  int added = snprintf(buffer + used, size - used, " * (1 %s)^(%.7g)", unit, (double)power);
  return added < 0 ? used : used + (size_t)added;
}

const char *strut_dimension_suffix(strut_dimension dimension, char *buffer, size_t size) {
  const struct dimension_words *known = find_words(dimension);
  if (!size) return buffer;
  buffer[0] = '\0';
  if (strut_dimension_equal(dimension, STRUT_DIM_NONE)) return buffer;
  if (known) {
    snprintf(buffer, size, "%s", known->unit);
    return buffer;
  }
  const struct {
    const char *unit;
    float power;
  } parts[] = {
      {"kg", dimension.kg}, {"m", dimension.m}, {"s", dimension.s}, {"rad", dimension.angle}};
  size_t used = 0; /* units first, so that they follow the number */
  for (int pass = 0; pass < 2; pass++)
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
      bool whole = same(parts[i].power, roundf(parts[i].power)) && fabsf(parts[i].power) <= 12;
      if (whole == (pass == 0))
        used = append_unit(buffer, size, used, parts[i].unit, parts[i].power);
    }
  return buffer;
}

const char *strut_dimension_example(strut_dimension dimension) {
  const struct dimension_words *known = find_words(dimension);
  return known ? known->example : NULL;
}

const char *strut_dimension_unit(strut_dimension dimension) {
  const struct dimension_words *known = find_words(dimension);
  return known ? known->unit : "SI";
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/expression/units.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/vec.h"

#define ENERGY                                                                                     \
  { 1, 2, -2, 0 }
#define FORCE                                                                                      \
  { 1, 1, -2, 0 }
#define FREQUENCY                                                                                  \
  { 0, 0, -1, 0 }
#define LENGTH                                                                                     \
  { 0, 1, 0, 0 }
#define MASS                                                                                       \
  { 1, 0, 0, 0 }
#define PRESSURE                                                                                   \
  { 1, -1, -2, 0 }
#define POWER                                                                                      \
  { 1, 2, -3, 0 }
#define TIME                                                                                       \
  { 0, 0, 1, 0 }
#define ANGLE                                                                                      \
  { 0, 0, 0, 1 }
#define NONE                                                                                       \
  { 0, 0, 0, 0 }

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
    {{1, 3, -2, 0}, "a bending stiffness", "2 N m^2", "N m^2"},
    {{1, 2, -2, -1}, "an angular stiffness", "3 N m/rad", "N m/rad"},
    {{1, 2, -1, -1}, "an angular damping", "0.01 N m s/rad", "N m s/rad"},
};
enum { WORD_COUNT = sizeof words / sizeof words[0] };

const strut_unit *strut_unit_find(const char *name, size_t length) {
  size_t low = 0, high = UNIT_COUNT;
  while (low < high) {
    size_t middle = (low + high) / 2;
    int order = strncmp(units[middle].name, name, length);
    if (order == 0 && units[middle].name[length] == '\0') return &units[middle];
    if (order < 0)
      low = middle + 1;
    else
      high = middle;
  }
  return NULL;
}

const strut_unit *strut_unit_at(size_t i) { return i < UNIT_COUNT ? &units[i] : NULL; }

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

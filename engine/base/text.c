/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/base/text.h"

#include <float.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/vec.h"

strut_c_locale strut_c_locale_enter(void) {
  locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  strut_c_locale result = {(void *)c, NULL};
  if (c) result.previous = (void *)uselocale(c);
  return result;
}

void strut_c_locale_leave(strut_c_locale locale) {
  if (!locale.c) return;
  uselocale((locale_t)locale.previous);
  freelocale((locale_t)locale.c);
}

/* The digits that identify a positive number, without trailing zeros; 10^exponent is the place of
 * the first. Both C functions use the decimal point of the same locale, so any locale will do. */
static int shortest_digits(double value, char digits[STRUT_NUMBER_TEXT], int *exponent) {
  char text[STRUT_NUMBER_TEXT];
  int count = 0, wanted = value < DBL_MIN ? 1 : DBL_DIG; /* a subnormal number has fewer */
  do {
    snprintf(text, sizeof text, "%.*e", wanted - 1, value);
  } while (wanted++ < DBL_DECIMAL_DIG && strtod(text, NULL) != value);
  const char *at = text;
  for (; *at != 'e'; at++) {
    if (*at >= '0' && *at <= '9') digits[count++] = *at;
  }
  *exponent = (int)strtol(at + 1, NULL, 10);
  while (digits[count - 1] == '0') count--;
  return count;
}

/* Digits with a point after the first `point` of them; point may lie outside. */
static int write_decimal(double value, char *text, size_t size) {
  char digits[STRUT_NUMBER_TEXT];
  int exponent, count = shortest_digits(value, digits, &exponent), point = exponent + 1;
  if (point < -3 || point > 17) {
    return snprintf(text, size, "%.1s%s%.*se%d", digits, count > 1 ? "." : "", count - 1,
                    digits + 1, exponent);
  }
  if (point <= 0) return snprintf(text, size, "0.%.*s%.*s", -point, "000", count, digits);
  if (point < count) {
    return snprintf(text, size, "%.*s.%.*s", point, digits, count - point, digits + point);
  }
  return snprintf(text, size, "%.*s%.*s", count, digits, point - count, "0000000000000000");
}

size_t strut_number_text(double value, char text[STRUT_NUMBER_TEXT]) {
  const size_t size = STRUT_NUMBER_TEXT;
  if (isnan(value)) return (size_t)snprintf(text, size, "nan");
  int sign = snprintf(text, size, "%s", signbit(value) ? "-" : "");
  char *at = text + sign;
  value = fabs(value);
  if (value == 0.0) return (size_t)(sign + snprintf(at, size - 1, "0"));
  if (isinf(value)) return (size_t)(sign + snprintf(at, size - 1, "inf"));
  return (size_t)(sign + write_decimal(value, at, size - 1));
}

void strut_duration_text(double seconds, char text[STRUT_DURATION_TEXT]) {
  const size_t size = STRUT_DURATION_TEXT;
  double whole = ceil(seconds);
  if (!(whole < 1e7)) {
    snprintf(text, size, "?");
  } else if (whole < 60) {
    snprintf(text, size, "%.0f s", whole);
  } else if (whole < 3600) {
    snprintf(text, size, "%d min %02d s", (int)whole / 60, (int)whole % 60);
  } else {
    snprintf(text, size, "%d h %02d min", (int)whole / 3600, (int)whole / 60 % 60);
  }
}

/* ---- quantities ---- */

enum { FIRST = -3, LAST = 3 }; /* nano to giga; smaller values have an exponent */

static const char *const prefixes[] = {"n", "u", "m", "", "k", "M", "G"};

strut_rounded_quantity strut_quantity_of(double value, int digits, const char *unit) {
  strut_rounded_quantity quantity = {"none"};
  char *text = quantity.text;
  if (isinf(value)) strcpy(text, "no limit");
  if (!isfinite(value)) return quantity;
  strut_c_locale locale = strut_c_locale_enter();
  /* Rounded first: 0.99996 m to four digits is 1 m, not 1000 mm. */
  snprintf(text, STRUT_QUANTITY_TEXT, "%.*e", digits - 1, value);
  double rounded = strtod(text, NULL);
  int thousands = rounded != 0.0 ? (int)floor(log10(fabs(rounded)) / 3.0 + 1e-12) : 0;
  if (thousands < FIRST) thousands = 0;
  if (thousands > LAST) thousands = LAST;
  double scaled = rounded;
  for (int i = thousands; i < 0; i++) scaled *= 1000.0;
  for (int i = thousands; i > 0; i--) scaled /= 1000.0;
  /* and with three digits at least: 680 us to two digits is not 6.8e+02 us */
  snprintf(text, STRUT_QUANTITY_TEXT, "%.*g %s%s", digits < 3 ? 3 : digits, scaled,
           prefixes[thousands - FIRST], unit);
  strut_c_locale_leave(locale);
  return quantity;
}

/* A prefix belongs to the unit's first word, whose power it would get. */
bool strut_unit_takes_prefix(const char *unit) {
  static const char *const words[] = {"m", "s", "N", "J", "W", "Hz", "Pa", "rad", "B", "V", "A"};
  size_t length = strspn(unit, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ");
  for (size_t i = 0; i < sizeof words / sizeof *words && unit[length] != '^'; i++)
    if (strlen(words[i]) == length && strncmp(unit, words[i], length) == 0) return true;
  return false;
}

/* In a unit as it is; "1": none. */
static strut_rounded_quantity plain_quantity(double value, int digits, const char *unit) {
  strut_rounded_quantity quantity;
  bool none = strcmp(unit, "1") == 0;
  strut_c_locale locale = strut_c_locale_enter();
  snprintf(quantity.text, sizeof quantity.text, "%.*g%s%.40s", digits, value, none ? "" : " ",
           none ? "" : unit);
  strut_c_locale_leave(locale);
  return quantity;
}

strut_rounded_quantity strut_quantity_of_any(double value, int digits, const char *unit) {
  return !isfinite(value) || strut_unit_takes_prefix(unit) ? strut_quantity_of(value, digits, unit)
                                                           : plain_quantity(value, digits, unit);
}

strut_file_unit strut_unit_shown(const char *unit, strut_file_unit given) {
  bool angle = !given.name && unit && strcmp(unit, "rad") == 0;
  return angle ? (strut_file_unit){"deg", STRUT_PI / 180} : given;
}

strut_rounded_quantity strut_quantity_shown(double value, int digits, const char *unit,
                                            strut_file_unit given) {
  const strut_file_unit shown = strut_unit_shown(unit, given);
  return shown.name && isfinite(value) ? plain_quantity(value / shown.size, digits, shown.name)
                                       : strut_quantity_of_any(value, digits, unit);
}

bool strut_buffer_reserve(strut_buffer *buffer, size_t more) {
  if (!buffer->failed && buffer->length + more < buffer->room) return true;
  size_t room = 2 * (buffer->length + more) + 256;
  char *text = buffer->failed ? NULL : strut_reallocate(buffer->text, room, 1);
  buffer->failed = !text;
  if (!text) return false;
  buffer->text = text;
  buffer->room = room;
  return true;
}

void strut_buffer_put(strut_buffer *buffer, const char *text, size_t length) {
  if (!strut_buffer_reserve(buffer, length)) return;
  memcpy(buffer->text + buffer->length, text, length);
  buffer->length += length;
  buffer->text[buffer->length] = '\0';
}

void strut_buffer_add_list(strut_buffer *buffer, const char *format, va_list arguments) {
  va_list again;
  va_copy(again, arguments);
  int length = vsnprintf(NULL, 0, format, arguments);
  if (length < 0) buffer->failed = true;
  if (strut_buffer_reserve(buffer, (size_t)length)) {
    vsnprintf(buffer->text + buffer->length, buffer->room - buffer->length, format, again);
    buffer->length += (size_t)length;
  }
  va_end(again);
}

void strut_buffer_add(strut_buffer *buffer, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  strut_buffer_add_list(buffer, format, arguments);
  va_end(arguments);
}

char *strut_buffer_take(strut_buffer *buffer) {
  char *text = buffer->text;
  if (buffer->failed) {
    strut_release(text);
    text = NULL;
  }
  *buffer = (strut_buffer){0};
  return text;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/quantity_text.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/c_locale.h"

enum { FIRST = -5, LAST = 3 }; /* femto to giga */

static const char *const prefixes[] = {"f", "p", "n", "u", "m", "", "k", "M", "G"};

const char *strut_quantity_text(double value, int digits, const char *unit,
                                char text[STRUT_QUANTITY_TEXT]) {
  if (isnan(value)) {
    snprintf(text, STRUT_QUANTITY_TEXT, "none");
    return text;
  }
  if (isinf(value)) {
    snprintf(text, STRUT_QUANTITY_TEXT, "no limit");
    return text;
  }
  strut_c_locale locale = strut_c_locale_enter();
  /* Rounded first: 0.99996 m to four digits is 1 m, not 1000 mm. */
  snprintf(text, STRUT_QUANTITY_TEXT, "%.*e", digits - 1, value);
  double rounded = strtod(text, NULL);
  int thousands = rounded != 0.0 ? (int)floor(log10(fabs(rounded)) / 3.0 + 1e-12) : 0;
  if (thousands < FIRST) thousands = FIRST;
  if (thousands > LAST) thousands = LAST;
  double scaled = rounded;
  for (int i = thousands; i < 0; i++) scaled *= 1000.0;
  for (int i = thousands; i > 0; i--) scaled /= 1000.0;
  /* and with three digits at least: 680 us to two digits is not 6.8e+02 us */
  snprintf(text, STRUT_QUANTITY_TEXT, "%.*g %s%s", digits < 3 ? 3 : digits, scaled,
           prefixes[thousands - FIRST], unit);
  strut_c_locale_leave(locale);
  return text;
}

strut_rounded_quantity strut_quantity_of(double value, int digits, const char *unit) {
  strut_rounded_quantity quantity;
  strut_quantity_text(value, digits, unit, quantity.text);
  return quantity;
}

/* A prefix belongs to the unit's first word, whose power it would get. */
static bool takes_prefix(const char *unit) {
  size_t word = strspn(unit, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ");
  return word > 0 && unit[word] != '^' && strncmp(unit, "kg", 2) != 0;
}

strut_rounded_quantity strut_quantity_of_any(double value, int digits, const char *unit) {
  if (!isfinite(value) || takes_prefix(unit)) return strut_quantity_of(value, digits, unit);
  strut_rounded_quantity quantity;
  bool none = strcmp(unit, "1") == 0;
  strut_c_locale locale = strut_c_locale_enter();
  snprintf(quantity.text, sizeof quantity.text, "%.*g%s%.40s", digits, value, none ? "" : " ",
           none ? "" : unit);
  strut_c_locale_leave(locale);
  return quantity;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Round numbers on axes, and how they are written. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/output/draw/axes.h"

/* More significant digits than this are an offset's business. */
enum { MOST_DIGITS = 5 };

static double round_step(double rough) {
  double power = pow(10.0, floor(log10(rough))), part = rough / power;
  return power * (part < 1.5 ? 1 : part < 3.5 ? 2 : part < 7.5 ? 5 : 10);
}

/* The number with the fewest digits that is no farther from the middle than five ranges. */
static double common_part(double low, double high) {
  double middle = low + 0.5 * (high - low), near = middle;
  for (int k = (int)floor(log10(fabs(middle))); k >= (int)floor(log10(high - low)); k--) {
    double power = pow(10.0, k);
    near = round(middle / power) * power;
    if (fabs(near - middle) <= 5 * (high - low)) break;
  }
  return near;
}

size_t strut_ticks(double low, double high, int wanted, double ticks[STRUT_MOST_TICKS]) {
  size_t count = 0;
  if (!(high > low) || !isfinite(high - low) || wanted < 1) return 0;
  if (wanted > STRUT_MOST_TICKS / 3) wanted = STRUT_MOST_TICKS / 3;
  double step = round_step((high - low) / wanted);
  double first = ceil(low / step - 1e-9);
  for (double k = first; k * step <= high + 1e-9 * step && count < STRUT_MOST_TICKS; k++) {
    if (count && k * step <= ticks[count - 1]) break; /* below what doubles tell apart */
    ticks[count++] = k == 0 ? 0 : k * step;
  }
  return count;
}

const char *strut_prefix(double largest, const char *unit, double *factor) {
  static const char *const plain[] = {"", "%", "kg", "deg", "°"};
  static const char *const names[] = {"f", "p", "n", "µ", "m", "", "k", "M", "G", "T", "P"};
  *factor = 1;
  for (size_t i = 0; i < sizeof plain / sizeof *plain; i++)
    if (strcmp(unit, plain[i]) == 0) return "";
  if (!(largest > 0) || !isfinite(largest)) return "";
  double group = floor(log10(largest) / 3 + 1e-12);
  if (group < -5 || group > 5) return "";
  *factor = pow(1000.0, group);
  return names[(int)group + 5];
}

static void write_power(char *text, size_t size, int exponent) {
  static const char *const raised[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  char digits[16];
  int used = snprintf(text, size, "10%s", exponent < 0 ? "⁻" : "");
  snprintf(digits, sizeof digits, "%d", exponent < 0 ? -exponent : exponent);
  for (const char *d = digits; *d; d++)
    used += snprintf(text + used, size - (size_t)used, "%s", raised[*d - '0']);
}

/* With a real minus sign, and powers of ten as print writes them. */
static void write_number(char *text, size_t size, const char *format, int decimals, double value) {
  char plain[64];
  if (value == 0) value = 0; /* no minus zero */
  snprintf(plain, sizeof plain, format, decimals, value);
  char *power = strchr(plain, 'e');
  int exponent = power ? atoi(power + 1) : 0;
  if (power) *power = '\0';
  snprintf(text, size, "%s%s", plain[0] == '-' ? "\xe2\x88\x92" : "", plain + (plain[0] == '-'));
  if (!power) return;
  size_t used = strlen(text);
  snprintf(text + used, size - used, "×");
  used = strlen(text);
  write_power(text + used, size - used, exponent);
}

strut_quantity strut_drawn_quantity(double value, int digits, const char *unit) {
  strut_quantity plain = strut_quantity_of(value, digits, unit), drawn = {{0}};
  const char *space = strchr(plain.text, ' ');
  bool micro = space && space[1] == 'u' && strcmp(space + 2, unit) == 0;
  snprintf(drawn.text, sizeof drawn.text, "%s%.*s%s%s", plain.text[0] == '-' ? "\xe2\x88\x92" : "",
           space ? (int)(space - plain.text) - (plain.text[0] == '-') : STRUT_QUANTITY_TEXT,
           plain.text + (plain.text[0] == '-'), micro ? " µ" : "", space ? space + 2 * micro : "");
  return drawn;
}

static void write_label(const strut_axis *axis, const char *prefix, const char *offset,
                        strut_tick_set *set) {
  const char *name = axis->name ? axis->name : "", *unit = axis->unit ? axis->unit : "";
  snprintf(set->label, sizeof set->label, "%s%s%s%s%s", name, offset,
           *unit ? (*name ? " in " : "in ") : "", *unit ? prefix : "", unit);
}

static void linear_ticks(const strut_axis *axis, int wanted, strut_tick_set *set) {
  double factor, largest = fmax(fabs(axis->low), fabs(axis->high)), offset = 0;
  char offset_text[64] = "";
  set->count = strut_ticks(axis->low, axis->high, wanted, set->at);
  double step = set->count > 1 ? set->at[1] - set->at[0] : axis->high - axis->low;
  bool far = largest / step > 2 * pow(10.0, MOST_DIGITS);
  if (far) { /* what all ticks have in common is said once */
    offset = common_part(axis->low, axis->high);
    largest = fmax(fabs(axis->low - offset), fabs(axis->high - offset));
  }
  const char *prefix = strut_prefix(largest, axis->unit ? axis->unit : "", &factor);
  if (far) {
    char number[48];
    write_number(number, sizeof number, "%.*g", 12, fabs(offset));
    snprintf(offset_text, sizeof offset_text, " %s %s%s%s", offset > 0 ? "\xe2\x88\x92" : "+",
             number, axis->unit && *axis->unit ? " " : "", axis->unit ? axis->unit : "");
  }
  write_label(axis, prefix, offset_text, set);
  step /= factor;
  double size = largest / factor;
  bool plain = size < 1e5 && step > 1e-6;
  int decimals = plain ? (int)fmax(0, ceil(-log10(step) - 1e-6)) : 3;
  for (size_t i = 0; i < set->count; i++)
    write_number(set->text[i], STRUT_TICK_TEXT, plain ? "%.*f" : "%.*g", decimals,
                 (set->at[i] - offset) / factor);
}

/* Decades; within few of them also 2 and 5 times, as plain numbers. */
static void logarithmic_ticks(const strut_axis *axis, int wanted, strut_tick_set *set) {
  double from = log10(axis->low), to = log10(axis->high);
  int each = (int)fmax(1, ceil((to - from) / fmax(wanted, 1)));
  bool few = to - from < 1.5;
  write_label(axis, "", "", set);
  for (int k = (int)floor(from); k <= (int)ceil(to); k++) {
    double decade = pow(10.0, k);
    for (int m = 1; m <= 9; m++) {
      double value = m * decade;
      if (value < axis->low * (1 - 1e-9) || value > axis->high * (1 + 1e-9)) continue;
      bool major = few ? m == 1 || m == 2 || m == 5 : m == 1 && k % each == 0;
      if (major && set->count < STRUT_MOST_TICKS) {
        char *text = set->text[set->count];
        set->at[set->count++] = value;
        if (few && value >= 1e-4 && value < 1e5) {
          write_number(text, STRUT_TICK_TEXT, "%.*g", 6, value);
        } else if (m == 1) {
          write_power(text, STRUT_TICK_TEXT, k);
        }
      } else if (!major && to - from < 12 && set->minor_count < STRUT_MOST_MINOR) {
        set->minor[set->minor_count++] = value;
      }
    }
  }
}

void strut_axis_ticks(const strut_axis *axis, int wanted, strut_tick_set *set) {
  strut_c_locale locale = strut_c_locale_enter();
  *set = (strut_tick_set){0};
  if (axis->logarithmic) {
    logarithmic_ticks(axis, wanted, set);
  } else {
    linear_ticks(axis, wanted, set);
  }
  strut_c_locale_leave(locale);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run's summary as rows of a page, read back from summary.json. */
#include "engine/output/run_report.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/memory.h"
#include "engine/output/buffer.h"

enum { DIGITS = 4, MOST_CONTACTS = 12, LABEL = 300, VALUE = 800 };

static strut_rounded_quantity in(double value, const char *unit) {
  return strut_quantity_of(value, DIGITS, unit);
}

typedef struct rows {
  strut_shown *to;
  const cJSON *from; /* the summary */
} rows;

void strut_show(strut_shown *to, const char *label, const char *value) {
  strut_shown_row *list = strut_reallocate(to->list, to->count + 1, sizeof *list);
  const strut_shown_row row = {strut_arena_format(&to->arena, "%s", label),
                               strut_arena_format(&to->arena, "%s", value)};
  to->failed = to->failed || !list || !row.label || !row.value;
  if (list) to->list = list, list[to->count++] = row;
}

void strut_shown_free(strut_shown *shown) {
  strut_release(shown->list);
  strut_arena_free(&shown->arena);
}

/* NAN if there is no such number. */
static double number(const cJSON *from, const char *key) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(from, key);
  return cJSON_IsNumber(item) ? item->valuedouble : (double)NAN;
}

static const char *text(const cJSON *from, const char *key) {
  return cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(from, key));
}

static void show_quantity(rows *self, const char *label, const char *key, const char *unit) {
  double value = number(self->from, key);
  if (isfinite(value)) strut_show(self->to, label, in(value, unit).text);
}

static void show_status(rows *self) {
  const char *status = text(self->from, "status"), *reason = text(self->from, "reason");
  char value[VALUE];
  if (!status) return;
  bool twice = reason && strncmp(reason, status, strlen(status)) == 0;
  snprintf(value, sizeof value, "%s%s%s", twice ? "" : status, reason && !twice ? ": " : "",
           reason ? reason : "");
  strut_show(self->to, "run", value);
}

static void show_warnings(rows *self) {
  const cJSON *warnings = cJSON_GetObjectItemCaseSensitive(self->from, "warnings"), *warning;
  cJSON_ArrayForEach(warning, warnings) {
    const char *said = text(warning, "text");
    if (said) strut_show(self->to, "warning", said);
  }
}

/* What the numbers are worth, and why; of version 0.1 only the latter. */
static void show_worth(rows *self) {
  const cJSON *accuracy = cJSON_GetObjectItemCaseSensitive(self->from, "accuracy");
  const char *worth = text(self->from, "worth"), *caveat = text(self->from, "caveat");
  const char *why = accuracy ? text(accuracy, "why") : caveat;
  if (worth) strut_show(self->to, "accuracy", worth);
  if (why) strut_show(self->to, worth ? "because" : "accuracy", why);
}

static void show_velocity(rows *self, const strut_experiment *experiment,
                          const strut_scene *scene) {
  int32_t node = experiment->measure_node;
  char label[LABEL], value[VALUE];
  double spread = number(self->from, "velocity_spread"), from = number(self->from, "window_start");
  if (!isfinite(number(self->from, "velocity"))) return;
  snprintf(label, sizeof label, "mean velocity of %s",
           node >= 0 ? scene->nodes[node].name : "the centre of mass");
  snprintf(value, sizeof value, "%s%s%s, from %s", in(number(self->from, "velocity"), "m/s").text,
           isfinite(spread) ? ", spread " : "", isfinite(spread) ? in(spread, "m/s").text : "",
           isfinite(from) ? in(from, "s").text : "the start");
  strut_show(self->to, label, value);
}

/* What is known of a measured value: spread, member, error. */
static void show_measured_value(rows *self, const cJSON *item, const char *unit) {
  const char *member = text(item, "member"), *arrival = text(item, "arrival");
  double value = number(item, "value"), spread = number(item, "spread");
  double expected = number(item, "expected");
  bool kept = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(item, "kept"));
  strut_buffer shown = {0};
  strut_buffer_add(&shown, "%s", strut_quantity_of_any(value, DIGITS, unit).text);
  if (isfinite(spread))
    strut_buffer_add(&shown, ", spread %s", strut_quantity_of_any(spread, DIGITS, unit).text);
  if (cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(item, "zero")))
    strut_buffer_add(&shown, ", zero up to rounding");
  if (member) strut_buffer_add(&shown, ", in %s", member);
  if (arrival && strcmp(arrival, "reached") != 0) strut_buffer_add(&shown, ", %s", arrival);
  if (isfinite(expected))
    strut_buffer_add(&shown, ", %s within %s",
                     kept ? "known" : "not as accurate as requested, but known",
                     strut_quantity_of_any(expected, 2, unit).text);
  char *row = strut_buffer_take(&shown);
  if (row) strut_show(self->to, item->string, row);
  if (!row) self->to->failed = true;
  strut_release(row);
}

/* A value that there is not, such as an arrival that did not happen, is "none". */
static void show_measured(rows *self) {
  const cJSON *measured = cJSON_GetObjectItemCaseSensitive(self->from, "measured"), *item;
  cJSON_ArrayForEach(item, measured) {
    const char *unit = text(item, "unit");
    if (unit && item->string) show_measured_value(self, item, unit);
  }
}

static void show_steps(rows *self) {
  char value[VALUE];
  double step = number(self->from, "step"), limit = number(self->from, "step_limit");
  double steps = number(self->from, "steps"), settled = number(self->from, "settle_time");
  show_quantity(self, "duration", "duration", "s");
  if (settled > 0) strut_show(self->to, "settling time", in(settled, "s").text);
  if (!isfinite(step) || !isfinite(steps)) return;
  snprintf(value, sizeof value, "%.0f of %s", steps, in(step, "s").text);
  strut_show(self->to, "steps", value);
  strut_show(self->to, "largest stable step", isfinite(limit) ? in(limit, "s").text : "no limit");
}

static void show_contacts(rows *self) {
  const cJSON *contacts = cJSON_GetObjectItemCaseSensitive(self->from, "contacts"), *contact;
  char label[LABEL], value[VALUE];
  int shown = 0;
  cJSON_ArrayForEach(contact, contacts) {
    double duty = number(contact, "duty"), height = number(contact, "max_height");
    if (!isfinite(duty) || !contact->string) continue;
    if (shown++ == MOST_CONTACTS) {
      snprintf(value, sizeof value, "%d more", cJSON_GetArraySize(contacts) - MOST_CONTACTS);
      strut_show(self->to, "contacts", value);
      return;
    }
    snprintf(label, sizeof label, "contact of %s", contact->string);
    snprintf(value, sizeof value, "%.1f %% of the time, at most %s high", 100 * duty,
             in(height, "m").text);
    strut_show(self->to, label, value);
  }
}

/* Works and losses that are not zero, and the residual of the balance. */
static void show_energy(rows *self) {
  enum { ENERGY, WORK, LOSSES };
  static const struct {
    int kind;
    const char *key, *label;
  } parts[] = {
#define PART_ROW(name, kind, label) {kind, #name, label},
      STRUT_ENERGY_TABLE(PART_ROW)
#undef PART_ROW
  };
  const cJSON *energy = cJSON_GetObjectItemCaseSensitive(self->from, "energy");
  char value[VALUE];
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
    double amount = number(energy, parts[i].key);
    if (parts[i].kind != ENERGY && isfinite(amount) && amount != 0)
      strut_show(self->to, parts[i].label, in(amount, "J").text);
  }
  double residual = number(energy, "residual"), moved = number(energy, "exchanged");
  if (!isfinite(moved)) moved = number(energy, "moved"); /* its name up to version 0.1 */
  const char *balance = text(energy, "balance");
  bool open = balance && strcmp(balance, "open") == 0;
  if (!isfinite(residual)) return;
  if (moved > 0)
    snprintf(value, sizeof value, "%s, %.1e of the energy exchanged%s", in(residual, "J").text,
             fabs(residual) / moved,
             open                            ? ": the balance does not close"
             : fabs(residual) > 0.01 * moved ? ", which is rounding of the stored energy"
                                             : "");
  else
    snprintf(value, sizeof value, "%s", in(residual, "J").text);
  strut_show(self->to, "energy residual", value);
}

void strut_summary_rows(strut_shown *to, const char *summary, const strut_experiment *experiment,
                        const strut_scene *scene) {
  rows r = {.to = to};
  if (!summary) return;
  strut_c_locale locale = strut_c_locale_enter();
  cJSON *root = cJSON_Parse(summary);
  r.from = root;
  if (cJSON_IsObject(root)) {
    show_status(&r);
    show_warnings(&r);
    show_velocity(&r, experiment, scene);
    show_worth(&r);
    show_measured(&r);
    show_steps(&r);
    show_contacts(&r);
    show_energy(&r);
  } else {
    strut_show(to, "summary", "summary.json cannot be read");
  }
  cJSON_Delete(root);
  strut_c_locale_leave(locale);
}

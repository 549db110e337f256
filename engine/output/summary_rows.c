/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/summary_rows.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/output/quantity_text.h"
#include "engine/run/measure/summary.h"

enum { DIGITS = 4, MOST_CONTACTS = 12, LABEL = 300, VALUE = 800 };

typedef struct rows {
  strut_json *json;
  cJSON *to;
  const cJSON *from; /* the summary */
} rows;

static void add_row(rows *r, const char *label, const char *value) {
  cJSON *row = strut_json_object(r->json, r->to, NULL);
  strut_json_text(r->json, row, "label", label);
  strut_json_text(r->json, row, "value", value);
}

/* NAN if there is no such number. */
static double number(const cJSON *from, const char *key) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(from, key);
  return cJSON_IsNumber(item) ? item->valuedouble : (double)NAN;
}

static const char *text(const cJSON *from, const char *key) {
  return cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(from, key));
}

static strut_rounded_quantity in(double value, const char *unit) {
  return strut_quantity_of(value, DIGITS, unit);
}

static void add_quantity(rows *r, const char *label, const char *key, const char *unit) {
  double value = number(r->from, key);
  if (isfinite(value)) add_row(r, label, in(value, unit).text);
}

static void add_status(rows *r) {
  const char *status = text(r->from, "status"), *reason = text(r->from, "reason");
  char value[VALUE];
  if (!status) return;
  bool twice = reason && strncmp(reason, status, strlen(status)) == 0;
  snprintf(value, sizeof value, "%s%s%s", twice ? "" : status, reason && !twice ? ": " : "",
           reason ? reason : "");
  add_row(r, "run", value);
}

static void add_warnings(rows *r) {
  const cJSON *warnings = cJSON_GetObjectItemCaseSensitive(r->from, "warnings"), *warning;
  cJSON_ArrayForEach(warning, warnings) {
    const char *said = text(warning, "text");
    if (said) add_row(r, "warning", said);
  }
}

/* What the numbers are worth, and why; of version 0.1 only the latter. */
static void add_worth(rows *r) {
  const cJSON *accuracy = cJSON_GetObjectItemCaseSensitive(r->from, "accuracy");
  const char *worth = text(r->from, "worth"), *caveat = text(r->from, "caveat");
  const char *why = accuracy ? text(accuracy, "why") : caveat;
  if (worth) add_row(r, "accuracy", worth);
  if (why) add_row(r, worth ? "because" : "accuracy", why);
}

static void add_velocity(rows *r, const strut_experiment *experiment, const strut_scene *scene) {
  int32_t node = experiment->measure_node;
  char label[LABEL], value[VALUE];
  double spread = number(r->from, "velocity_spread"), from = number(r->from, "window_start");
  if (!isfinite(number(r->from, "velocity"))) return;
  snprintf(label, sizeof label, "mean velocity of %s",
           node >= 0 ? scene->nodes[node].name : "the centre of mass");
  snprintf(value, sizeof value, "%s%s%s, from %s", in(number(r->from, "velocity"), "m/s").text,
           isfinite(spread) ? ", spread " : "", isfinite(spread) ? in(spread, "m/s").text : "",
           isfinite(from) ? in(from, "s").text : "the start");
  add_row(r, label, value);
}

static void add_measured(rows *r) {
  const cJSON *measured = cJSON_GetObjectItemCaseSensitive(r->from, "measured"), *item;
  char value[VALUE];
  cJSON_ArrayForEach(item, measured) {
    const char *unit = text(item, "unit");
    double number_of = number(item, "value"), spread = number(item, "spread");
    if (!unit || !item->string || !isfinite(number_of)) continue;
    snprintf(value, sizeof value, "%s%s%s%s", strut_quantity_of_any(number_of, DIGITS, unit).text,
             isfinite(spread) ? ", spread " : "",
             isfinite(spread) ? strut_quantity_of_any(spread, DIGITS, unit).text : "",
             cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(item, "zero")) ? ", zero up to rounding"
                                                                          : "");
    add_row(r, item->string, value);
  }
}

static void add_steps(rows *r) {
  char value[VALUE];
  double step = number(r->from, "step"), limit = number(r->from, "step_limit");
  double steps = number(r->from, "steps"), settled = number(r->from, "settle_time");
  add_quantity(r, "duration", "duration", "s");
  if (settled > 0) add_row(r, "settling time", in(settled, "s").text);
  if (!isfinite(step) || !isfinite(steps)) return;
  snprintf(value, sizeof value, "%.0f of %s", steps, in(step, "s").text);
  add_row(r, "steps", value);
  add_row(r, "largest stable step", isfinite(limit) ? in(limit, "s").text : "no limit");
}

static void add_contacts(rows *r) {
  const cJSON *contacts = cJSON_GetObjectItemCaseSensitive(r->from, "contacts"), *contact;
  char label[LABEL], value[VALUE];
  int shown = 0;
  cJSON_ArrayForEach(contact, contacts) {
    double duty = number(contact, "duty"), height = number(contact, "max_height");
    if (!isfinite(duty) || !contact->string) continue;
    if (shown++ == MOST_CONTACTS) {
      snprintf(value, sizeof value, "%d more", cJSON_GetArraySize(contacts) - MOST_CONTACTS);
      add_row(r, "contacts", value);
      return;
    }
    snprintf(label, sizeof label, "contact of %s", contact->string);
    snprintf(value, sizeof value, "%.1f %% of the time, at most %s high", 100 * duty,
             in(height, "m").text);
    add_row(r, label, value);
  }
}

/* Works and losses that are not zero, and the residual of the balance. */
static void add_energy(rows *r) {
  enum { ENERGY, WORK, LOSSES };
  static const struct {
    int kind;
    const char *key, *label;
  } parts[] = {
#define ENERGY_ROW(name, kind, label) {kind, #name, label},
      STRUT_ENERGY_TABLE(ENERGY_ROW)
#undef ENERGY_ROW
  };
  const cJSON *energy = cJSON_GetObjectItemCaseSensitive(r->from, "energy");
  char value[VALUE];
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
    double amount = number(energy, parts[i].key);
    if (parts[i].kind != ENERGY && isfinite(amount) && amount != 0)
      add_row(r, parts[i].label, in(amount, "J").text);
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
  add_row(r, "energy residual", value);
}

void strut_summary_rows(strut_json *json, cJSON *to, const char *summary,
                        const strut_experiment *experiment, const strut_scene *scene) {
  rows r = {.json = json, .to = to};
  if (!summary) return;
  strut_c_locale locale = strut_c_locale_enter();
  cJSON *root = cJSON_Parse(summary);
  r.from = root;
  if (cJSON_IsObject(root)) {
    add_status(&r);
    add_warnings(&r);
    add_velocity(&r, experiment, scene);
    add_worth(&r);
    add_measured(&r);
    add_steps(&r);
    add_contacts(&r);
    add_energy(&r);
  } else {
    add_row(&r, "summary", "summary.json cannot be read");
  }
  cJSON_Delete(root);
  strut_c_locale_leave(locale);
}

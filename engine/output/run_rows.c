/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run's summary as rows of a page, read back from summary.json. */
#include "engine/output/run_report.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/memory.h"
#include "engine/base/number_text.h"

enum { DIGITS = 4, MOST_CONTACTS = 12 };

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

static const cJSON *find(const cJSON *from, const char *key) {
  return cJSON_GetObjectItemCaseSensitive(from, key);
}

/* NAN if there is no such number. */
static double number(const cJSON *from, const char *key) {
  const cJSON *item = find(from, key);
  return cJSON_IsNumber(item) ? item->valuedouble : (double)NAN;
}

/* A text in the arena of the rows, which is asked for failure at the end. */
#define TEXT(...) text_or_none(to, strut_arena_format(&to->arena, __VA_ARGS__))
static const char *text_or_none(strut_shown *to, const char *text) {
  to->failed = to->failed || !text;
  return text ? text : "";
}

/* A text or a number as it is, if there is one. */
static void show(strut_shown *to, const cJSON *from, const char *key, const char *label,
                 const char *unit) {
  const char *said = cJSON_GetStringValue(find(from, key));
  double value = number(from, key);
  if (said) strut_show(to, label, said);
  if (isfinite(value)) strut_show(to, label, strut_quantity_of_any(value, DIGITS, unit).text);
}

/* A measured value, its spread, and what else is known of it. */
static void show_measured(strut_shown *to, const cJSON *item) {
  const char *unit = cJSON_GetStringValue(find(item, "unit"));
  const char *note = cJSON_GetStringValue(find(item, "note"));
  double value = number(item, "value"), spread = number(item, "spread");
  if (!unit || !item->string) return;
  bool missing = isnan(value) && note;
  const char *text = TEXT("%s", missing ? note : strut_quantity_of_any(value, DIGITS, unit).text);
  if (isfinite(spread))
    text = TEXT("%s, spread %s", text, strut_quantity_of_any(spread, DIGITS, unit).text);
  strut_show(to, item->string, note && !missing ? TEXT("%s, %s", text, note) : text);
}

static void show_contacts(strut_shown *to, const cJSON *contacts) {
  const cJSON *contact;
  int shown = 0;
  cJSON_ArrayForEach(contact, contacts) {
    double duty = number(contact, "duty"), height = number(contact, "max_height");
    if (!isfinite(duty) || !contact->string) continue;
    if (shown++ == MOST_CONTACTS) {
      strut_show(to, "contacts", TEXT("%d more", cJSON_GetArraySize(contacts) - MOST_CONTACTS));
      return;
    }
    strut_show(to, TEXT("contact of %s", contact->string),
               TEXT("%.1f %% of the time, at most %s high", 100 * duty,
                    strut_quantity_of(height, DIGITS, "m").text));
  }
}

/* Works and losses that are not zero, and the residual of the balance. */
static void show_energy(strut_shown *to, const cJSON *energy) {
#define SHOW_PART(name, kind, label)                                                               \
  if (strcmp(#kind, "ENERGY") != 0 && number(energy, #name) != 0)                                  \
    show(to, energy, #name, label, "J");
  STRUT_ENERGY_TABLE(SHOW_PART)
#undef SHOW_PART
  show(to, energy, "note", "energy residual", "J");
}

static void show_all(strut_shown *to, const cJSON *summary, const strut_experiment *experiment,
                     const strut_scene *scene) {
  const cJSON *item, *accuracy = find(summary, "accuracy");
  int32_t node = experiment->measure_node;
  const char *status = cJSON_GetStringValue(find(summary, "status"));
  const char *reason = cJSON_GetStringValue(find(summary, "reason"));
  if (status && reason && strncmp(reason, status, strlen(status)) != 0)
    reason = TEXT("%s: %s", status, reason);
  if (status) strut_show(to, "run", reason ? reason : status);
  cJSON_ArrayForEach(item, find(summary, "warnings")) show(to, item, "text", "warning", "");
  show(to, summary, "velocity",
       TEXT("mean velocity of %s", node >= 0 ? scene->nodes[node].name : "the centre of mass"),
       "m/s");
  show(to, summary, "velocity_spread", "spread of the velocity", "m/s");
  show(to, summary, "window_start", "measured from", "s");
  show(to, summary, "worth", "accuracy", "");
  show(to, accuracy ? accuracy : summary, accuracy ? "why" : "caveat",
       find(summary, "worth") ? "because" : "accuracy", "");
  cJSON_ArrayForEach(item, find(summary, "measured")) show_measured(to, item);
  show(to, summary, "duration", "duration", "s");
  if (number(summary, "settle_time") > 0) show(to, summary, "settle_time", "settling time", "s");
  if (isfinite(number(summary, "steps")))
    strut_show(to, "steps", TEXT("%.0f", number(summary, "steps")));
  show(to, summary, "step", "step", "s");
  show(to, summary, "step_limit", "largest stable step", "s");
  if (isfinite(number(summary, "step")) && !isfinite(number(summary, "step_limit")))
    strut_show(to, "largest stable step", "no limit");
  show_contacts(to, find(summary, "contacts"));
  show_energy(to, find(summary, "energy"));
}

void strut_summary_rows(strut_shown *to, const char *summary, const strut_experiment *experiment,
                        const strut_scene *scene) {
  if (!summary) return;
  strut_c_locale locale = strut_c_locale_enter();
  cJSON *root = cJSON_Parse(summary);
  if (cJSON_IsObject(root))
    show_all(to, root, experiment, scene);
  else
    strut_show(to, "summary", "summary.json cannot be read");
  cJSON_Delete(root);
  strut_c_locale_leave(locale);
}

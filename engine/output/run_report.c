/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run's summary as rows of text, on a page and in the terminal, read back from summary.json. */
#include "engine/output/run_report.h"

#include <cjson/cJSON.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/output/result_values.h"

enum { DIGITS = 4, MOST_CONTACTS = 12, MOST_TABLE_ROWS = 10 };

/* Energies below this part of all of them are rounding. */
static const double ENERGY_ROUNDING = 4.0 * DBL_EPSILON;

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

/* Energies at the end, works and losses that are not zero, and the residual of the balance. */
static void show_energy(strut_shown *to, const cJSON *energy) {
  double moved = number(energy, "exchanged");
  if (!isfinite(moved)) moved = number(energy, "moved"); /* its name up to version 0.1 */
  double most = moved + fabs(number(energy, "initial"));
#define LARGEST(name, kind, label) most = fmax(most, fabs(number(energy, #name)));
#define SHOW_PART(name, kind, label)                                                               \
  if (fabs(number(energy, #name)) > ENERGY_ROUNDING * most)                                        \
    show(to, energy, #name, strcmp(#kind, "ENERGY") ? label : "energy, " label, "J");
  STRUT_ENERGY_TABLE(LARGEST)
  STRUT_ENERGY_TABLE(SHOW_PART)
  show(to, energy, "note", "energy residual", "J");
}

/* Steady motion, and what is known of it. */
static void show_steady(strut_shown *to, const cJSON *steady, bool checked) {
  const char *kind = cJSON_GetStringValue(find(steady, "kind"));
  double periods = number(steady, "periods"), repeats = number(steady, "repeats");
  if (!kind) return;
  const char *within =
      TEXT("%s", strut_quantity_of(number(steady, "velocity_interval"), DIGITS, "m/s").text);
  if (strcmp(kind, "periodic") == 0)
    within = TEXT("after %.0f periods, repeating every %s%s within %s", periods,
                  repeats > 1 ? TEXT("%.0f periods", repeats) : "period",
                  checked ? "; velocity known" : "", within);
  else if (strcmp(kind, "transient") == 0)
    within = TEXT("not within %.0f periods", periods);
  else
    within = TEXT("%s after %.0f periods; mean velocity known within %s", kind, periods, within);
  strut_show(to, "steady motion", within);
}

static void show_cost(strut_shown *to, const cJSON *summary) {
  double seconds = number(summary, "wall_time"), steps = number(summary, "steps");
  double events = number(summary, "events"), evaluations = number(summary, "force_evaluations");
  show(to, summary, "method", "method", "");
  if (isfinite(steps)) strut_show(to, "steps", TEXT("%.0f", steps));
  show(to, summary, "step", "step", "s");
  if (isfinite(number(summary, "step")))
    strut_show(
        to, "largest stable step",
        TEXT("%s%s",
             strut_quantity_of(fmin(number(summary, "step_limit"), HUGE_VAL), DIGITS, "s").text,
             find(summary, "feedback") ? " without feedback" : ""));
  show(to, find(summary, "step_limit_violation"), "since", "STEP TOO LARGE since", "s");
  if (!isfinite(evaluations)) return;
  const char *text = TEXT("%.0f force evaluations", evaluations);
  if (isfinite(seconds))
    text = TEXT("%s in %s", text, strut_quantity_of(seconds, DIGITS, "s").text);
  if (isfinite(seconds) && steps > 0)
    text = TEXT("%s, %s per step", text, strut_quantity_of(seconds / steps, DIGITS, "s").text);
  if (events > 0) text = TEXT("%s, %.0f events located", text, events);
  strut_show(to, "computed", text);
}

/* Of a page: with warnings, measured quantities and contacts, which a terminal shows elsewhere. */
static void show_all(strut_shown *to, const cJSON *summary, const char *node, bool page) {
  const cJSON *item, *accuracy = find(summary, "accuracy");
  const char *status = cJSON_GetStringValue(find(summary, "status"));
  const char *reason = cJSON_GetStringValue(find(summary, "reason"));
  if (status && reason && strncmp(reason, status, strlen(status)) != 0)
    reason = TEXT("%s: %s", status, reason);
  if (status) strut_show(to, "run", reason ? reason : status);
  if (page)
    cJSON_ArrayForEach(item, find(summary, "warnings")) show(to, item, "text", "warning", "");
  if (!page) show(to, find(summary, "settle"), "warning", "UNSTABLE START", "");
  show(to, summary, "velocity",
       TEXT("mean velocity of %s along x", node ? node : "the centre of mass"), "m/s");
  show(to, summary, "velocity_spread", "spread of the velocity", "m/s");
  if (find(summary, "velocity_zero") && !accuracy)
    strut_show(to, "the velocity is", "zero up to rounding");
  show(to, summary, "window_start", "measured from", "s");
  show_steady(to, find(summary, "steady"), accuracy);
  show(to, summary, "worth", "accuracy", "");
  if (accuracy)
    show(to, accuracy, "why", find(summary, "worth") ? "because" : "accuracy", "");
  else if (!find(summary, "worth"))
    show(to, summary, "caveat", "accuracy", "");
  if (page) cJSON_ArrayForEach(item, find(summary, "measured")) show_measured(to, item);
  show(to, summary, "duration", "duration", "s");
  if (number(summary, "settle_time") > 0) show(to, summary, "settle_time", "settling time", "s");
  show_cost(to, summary);
  if (page) show_contacts(to, find(summary, "contacts"));
  show_energy(to, find(summary, "energy"));
}

/* False: it is no JSON, or memory is out. */
static bool show_summary(strut_shown *to, const char *summary, const char *node, bool page) {
  cJSON *root = cJSON_Parse(summary);
  bool read = cJSON_IsObject(root);
  if (read) show_all(to, root, node, page);
  cJSON_Delete(root);
  return read;
}

void strut_summary_rows(strut_shown *to, const char *summary, const strut_experiment *experiment,
                        const strut_scene *scene) {
  if (!summary) return;
  int32_t node = experiment->measure_node;
  strut_c_locale locale = strut_c_locale_enter();
  if (!show_summary(to, summary, node >= 0 ? scene->nodes[node].name : NULL, true))
    strut_show(to, "summary", "summary.json cannot be read");
  strut_c_locale_leave(locale);
}

char *strut_summary_json(const strut_summary *summary, const strut_scene *scene,
                         bool with_wall_time) {
  return strut_values_json(with_wall_time ? &strut_timed_summary_values : &strut_summary_values,
                           summary, scene);
}

char *strut_summary_table(const strut_summary *summary, const strut_scene *scene, int width) {
  const bool latex = width == STRUT_REPORT_LATEX;
  const char *before = latex ? "% " : "";
  strut_buffer table = {0};
  strut_shown rows = {0};
  size_t widest = 0;
  strut_c_locale locale = strut_c_locale_enter();
  char *json = strut_summary_json(summary, scene, true);
  table.failed = !json || !show_summary(&rows, json, summary->measured_node, false) || rows.failed;
  for (size_t i = 1; i < rows.count && !table.failed; i++)
    if (strlen(rows.list[i].label) > widest) widest = strlen(rows.list[i].label);
  for (size_t i = 0; i < rows.count && !table.failed; i++)
    if (i == 0)
      strut_buffer_add(&table, "%s%s%s%s\n", before, scene->name, *scene->name ? ": " : "",
                       rows.list[0].value);
    else
      strut_buffer_add(&table, "%s  %-*s  %s\n", before, (int)widest, rows.list[i].label,
                       rows.list[i].value);
  strut_values_add_tables(
      &table, &strut_summary_values, &(strut_result_object){summary, NULL, scene, 0},
      &(strut_table_page){latex ? width : STRUT_REPORT_WIDTH, MOST_TABLE_ROWS, DIGITS});
  strut_c_locale_leave(locale);
  strut_shown_free(&rows);
  strut_release(json);
  return strut_buffer_take(&table);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/run_report.h"

#include <cjson/cJSON.h>
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/base/vec.h"
#include "engine/output/buffer.h"
#include "engine/output/result_values.h"
#include "engine/run/measure/summary.h"

char *strut_summary_json(const strut_summary *summary, const strut_scene *scene,
                         bool with_wall_time) {
  return strut_values_json(with_wall_time ? &strut_timed_summary_values : &strut_summary_values,
                           summary, scene);
}

/* ---- a table that fits a screen ---- */

enum { MOST_ROWS = 10, DIGITS = 4 };

static strut_rounded_quantity in(double value, const char *unit) {
  return strut_quantity_of(value, DIGITS, unit);
}

/* What the numbers are worth, in one line; then why, where that is not what was asked for. */
static void add_worth(strut_buffer *table, const strut_summary *summary) {
  const strut_accuracy_summary *accuracy_summary = &summary->accuracy;
  char worth[200];
  strut_summary_worth(summary, worth, sizeof worth);
  if (*worth) strut_buffer_add(table, "  accuracy    %s\n", worth);
  if (accuracy_summary->wanted > 0.0 && !accuracy_summary->kept)
    strut_buffer_add(table, "              %s\n", accuracy_summary->why);
}

/* Steady motion, and what is known of it. */
static void add_claims(strut_buffer *table, const strut_summary *summary) {
  const strut_steady_summary *steady_summary = &summary->steady;
  bool checked = summary->accuracy.wanted > 0.0;
  if (steady_summary->kind == STRUT_MOTION_PERIODIC) {
    strut_buffer_add(table, "  steady      after %" PRId64 " periods, every ",
                     steady_summary->periods);
    if (steady_summary->repeats > 1)
      strut_buffer_add(table, "%d of them repeating", (int)steady_summary->repeats);
    else
      strut_buffer_add(table, "one repeating");
    strut_buffer_add(table, checked ? "; velocity known within %s\n" : " within %s\n",
                     in(steady_summary->interval, "m/s").text);
  } else if (steady_summary->kind == STRUT_MOTION_TRANSIENT) {
    strut_buffer_add(table, "  steady      not within %" PRId64 " periods\n",
                     steady_summary->periods);
  } else if (steady_summary->kind == STRUT_MOTION_IRREGULAR) {
    strut_buffer_add(table, "  irregular   mean velocity known within %s\n",
                     in(steady_summary->interval, "m/s").text);
  } else if (steady_summary->kind == STRUT_MOTION_CREEPING) {
    strut_buffer_add(table,
                     "  creeping    over %" PRId64 " periods; mean velocity known within %s\n",
                     steady_summary->periods, in(steady_summary->interval, "m/s").text);
  }
  add_worth(table, summary);
}

static void add_head(strut_buffer *table, const strut_summary *summary, const strut_scene *scene) {
  strut_buffer_add(table, "%s%s%s", scene->name, *scene->name ? ": " : "",
                   strut_status_text(summary->status));
  if (summary->reason[0]) strut_buffer_add(table, ": %s", summary->reason);
  strut_buffer_add(table, "\n  velocity    %s%s along x, of %s", summary->velocity > 0.0 ? "+" : "",
                   in(summary->velocity, "m/s").text,
                   summary->measured_node ? summary->measured_node : "the centre of mass");
  if (isfinite(summary->velocity_spread)) {
    strut_buffer_add(table, ", spread %s", in(summary->velocity_spread, "m/s").text);
  }
  strut_buffer_add(
      table, ", from %s%s\n", in(summary->window.start, "s").text,
      summary->velocity_zero && summary->velocity != 0.0 && !(summary->accuracy.wanted > 0.0)
          ? ", zero up to rounding"
          : "");
  strut_buffer_add(table, "  duration    %s, %" PRId64 " steps", in(summary->duration, "s").text,
                   summary->spent.steps);
  if (summary->settle_time > 0.0) {
    strut_buffer_add(table, ", after %s of settling", in(summary->settle_time, "s").text);
  }
  if (summary->settle.unstable)
    strut_buffer_add(table,
                     "\n  start       settled on an UNSTABLE equilibrium; node %s moves most in "
                     "the unstable direction",
                     summary->settle.node);
  strut_buffer_add(table, "\n  step        %s", in(summary->step, "s").text);
  if (isinf(summary->step_limit))
    strut_buffer_add(table, ", no stability limit\n");
  else
    strut_buffer_add(table, ", stable up to %s%s\n", in(summary->step_limit, "s").text,
                     summary->feedback ? " without feedback" : "");
  if (summary->limit_fell.limit > 0.0)
    strut_buffer_add(table, "              TOO LARGE since %s: the stability limit fell to %s\n",
                     in(summary->limit_fell.since, "s").text,
                     in(summary->limit_fell.limit, "s").text);
  strut_buffer_add(table, "  computed    %" PRId64 " force evaluations in %s",
                   summary->spent.evaluations, in(summary->spent.wall_time, "s").text);
  if (summary->spent.steps > 0) {
    strut_buffer_add(table, ", %s per step",
                     in(summary->spent.wall_time / (double)summary->spent.steps, "s").text);
  }
  if (summary->spent.events > 0)
    strut_buffer_add(table, ", %" PRId64 " events located", summary->spent.events);
  strut_buffer_add(table, "\n");
  add_claims(table, summary);
}

/* Why a quantity has no value. */
static const char *missing(const strut_summary *summary, const strut_measured *measured) {
  if (strut_measured_arrival(measured) && summary->status == STRUT_OK)
    return "the target was not reached";
  return summary->status == STRUT_OK ? "not finite" : "the window was not reached";
}

static void add_measured(strut_buffer *table, const strut_summary *summary) {
  if (summary->measured_count)
    strut_buffer_add(table, "\n  %-16s %14s %14s\n", "measured", "value", "spread");
  for (size_t i = 0; i < summary->measured_count; i++) {
    const strut_measured *measured = &summary->measured[i];
    strut_buffer_add(table, "  %-16s %14s", measured->name,
                     strut_quantity_of_any(measured->value, DIGITS, measured->unit).text);
    if (isfinite(measured->spread))
      strut_buffer_add(table, " %14s",
                       strut_quantity_of_any(measured->spread, DIGITS, measured->unit).text);
    if (measured->undecided)
      strut_buffer_add(table, "  not decided");
    else if (isnan(measured->value))
      strut_buffer_add(table, "  %s", missing(summary, measured));
    if (measured->zero) strut_buffer_add(table, "  zero up to rounding");
    if (measured->member) strut_buffer_add(table, "  in %.40s", measured->member);
    if (isfinite(measured->expected))
      strut_buffer_add(table, "  %s within %s",
                       measured->kept ? "known" : "NOT as accurate as requested, but",
                       strut_quantity_of_any(measured->expected, 2, measured->unit).text);
    strut_buffer_add(table, "\n");
  }
}

/* The residual of the balance and what it means, in one statement. */
static void add_balance(strut_buffer *table, const strut_summary *summary) {
  const strut_energy *energy = &summary->energy;
  strut_rounded_quantity residual = in(energy->residual, "J");
  if (summary->balance == STRUT_BALANCE_NOT_KEPT || !(energy->moved > 0.0)) {
    if (energy->residual != 0.0)
      strut_buffer_add(table, "  %-16s %14s\n", "residual", residual.text);
    return;
  }
  double part = fabs(energy->residual) / energy->moved;
  if (summary->balance == STRUT_BALANCE_OPEN)
    strut_buffer_add(table, "  %-16s %14s   balance NOT closed: %.2g %% of the energy exchanged\n",
                     "residual", residual.text, 100.0 * part);
  else
    strut_buffer_add(table, "  %-16s %14s   balance closed%s\n", "residual", residual.text,
                     part <= 0.01 ? " within 1 % of the energy exchanged"
                                  : " up to the rounding of the stored energy");
}

/* Energies below this part of all of them are rounding. */
static const double ENERGY_ROUNDING = 4.0 * DBL_EPSILON;

static void add_energy(strut_buffer *table, const strut_summary *summary) {
  const strut_energy *energy = &summary->energy;
  const struct {
    const char *name;
    double value;
  } rows[] = {
#define ENERGY_ROW(name, kind, label) {label, energy->name},
      STRUT_ENERGY_TABLE(ENERGY_ROW)
#undef ENERGY_ROW
  };
  double most = energy->moved + fabs(energy->initial);
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) most = fmax(most, fabs(rows[i].value));
  strut_buffer_add(table, "\n  energy after %s, works and losses until then\n",
                   in(summary->duration, "s").text);
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    if (!(fabs(rows[i].value) > ENERGY_ROUNDING * most)) continue; /* not in this scene */
    strut_buffer_add(table, "  %-16s %14s\n", rows[i].name, in(rows[i].value, "J").text);
  }
}

char *strut_summary_table(const strut_summary *summary, const strut_scene *scene) {
  strut_buffer table = {0};
  strut_c_locale locale = strut_c_locale_enter();
  add_head(&table, summary, scene);
  add_measured(&table, summary);
  strut_values_add_tables(&table, &strut_summary_values,
                          &(strut_result_object){summary, NULL, scene, 0},
                          &(strut_table_page){STRUT_REPORT_WIDTH, MOST_ROWS, DIGITS});
  add_energy(&table, summary);
  add_balance(&table, summary);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}

/* A run's summary as rows of a page, read back from summary.json. */

enum { MOST_CONTACTS = 12 };

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

/* A measured value and what is known of it: spread, member, error. One that there is not is "none". */
static void show_measured(strut_shown *to, const cJSON *item) {
  const char *unit = cJSON_GetStringValue(find(item, "unit"));
  const char *member = cJSON_GetStringValue(find(item, "member"));
  const char *arrival = cJSON_GetStringValue(find(item, "arrival"));
  double spread = number(item, "spread"), expected = number(item, "expected");
  if (!unit || !item->string) return;
  const char *text = TEXT("%s", strut_quantity_of_any(number(item, "value"), DIGITS, unit).text);
  if (isfinite(spread))
    text = TEXT("%s, spread %s", text, strut_quantity_of_any(spread, DIGITS, unit).text);
  if (cJSON_IsTrue(find(item, "zero"))) text = TEXT("%s, zero up to rounding", text);
  if (member) text = TEXT("%s, in %s", text, member);
  if (arrival && strcmp(arrival, "reached") != 0) text = TEXT("%s, %s", text, arrival);
  if (isfinite(expected))
    text =
        TEXT("%s, %s within %s", text,
             cJSON_IsTrue(find(item, "kept")) ? "known" : "not as accurate as requested, but known",
             strut_quantity_of_any(expected, 2, unit).text);
  strut_show(to, item->string, text);
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
  double residual = number(energy, "residual"), moved = number(energy, "exchanged");
  if (!isfinite(moved)) moved = number(energy, "moved"); /* its name up to version 0.1 */
  const char *balance = cJSON_GetStringValue(find(energy, "balance"));
  bool open = balance && strcmp(balance, "open") == 0;
  if (!isfinite(residual)) return;
  const char *text = TEXT("%s", strut_quantity_of(residual, DIGITS, "J").text);
  if (moved > 0)
    text = TEXT("%s, %.1e of the energy exchanged%s", text, fabs(residual) / moved,
                open                            ? ": the balance does not close"
                : fabs(residual) > 0.01 * moved ? ", which is rounding of the stored energy"
                                                : "");
  strut_show(to, "energy residual", text);
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

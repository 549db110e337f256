/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/run_report.h"

#include <cjson/cJSON.h>
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
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

/* Energies below this part of all of them are rounding. */
static const double ENERGY_ROUNDING = 4.0 * DBL_EPSILON;

static double largest_energy(const strut_energy *energy) {
  double most = energy->moved + fabs(energy->initial);
#define WIDEN(name, kind, label) most = fmax(most, fabs(energy->name));
  STRUT_ENERGY_TABLE(WIDEN)
#undef WIDEN
  return most;
}

/* Energies of what the scene has. */
#define ENERGY(X)                                                                                  \
  STRUT_ENERGY_TABLE(ENERGY_OF_##X)                                                                \
  X(NULL, "", WORDS(strut_write_residual), "", .label = {"residual"})
#define ENERGY_OF_STRUT_VALUE_ROW(NAME, KIND, LABEL)                                               \
  STRUT_VALUE_ROW(NULL, "J", , LABEL, .label = {LABEL})
#define ENERGY_OF_STRUT_VALUE_FILL(NAME, KIND, LABEL)                                              \
  STRUT_VALUE_FILL(NULL, "J",                                                                      \
                   IF(fabs(energy->NAME) > ENERGY_ROUNDING * most, NUMBER(energy->NAME)), LABEL)
STRUT_VALUES_HERE(energy_values, ENERGY,
                  const strut_energy *energy = &((const strut_summary *)of->at)->energy;
                  double most = largest_energy(energy))

/* Appends a text, in LaTeX as a comment. */
static void add_text(strut_buffer *table, const char *text, bool latex) {
  for (const char *c = text; c && *c; c++)
    strut_buffer_add(table, latex && (c == text || c[-1] == '\n') && *c != '\n' ? "%% %c" : "%c",
                     *c);
}

char *strut_summary_table(const strut_summary *summary, const strut_scene *scene, int width) {
  strut_buffer table = {0}, head = {0}, energy = {0};
  strut_c_locale locale = strut_c_locale_enter();
  const strut_result_object whole = {summary, NULL, scene, 0};
  const strut_table_page page = {width == STRUT_REPORT_LATEX ? width : STRUT_REPORT_WIDTH,
                                 MOST_ROWS, DIGITS};
  bool latex = width == STRUT_REPORT_LATEX;
  add_head(&head, summary, scene);
  strut_buffer_add(&energy, "\n  energy after %s, works and losses until then\n",
                   in(summary->duration, "s").text);
  char *texts[] = {strut_buffer_take(&head), strut_buffer_take(&energy)};
  table.failed = !texts[0] || !texts[1];
  add_text(&table, texts[0], latex);
  strut_values_add_tables(&table, &strut_summary_values, &whole, &page);
  add_text(&table, texts[1], latex);
  strut_values_add_tables(&table, &energy_values, &whole, &page);
  for (int i = 0; i < 2; i++) strut_release(texts[i]);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}

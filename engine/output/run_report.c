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
static void add_worth(strut_buffer *table, const strut_summary *s) {
  const strut_accuracy_summary *a = &s->accuracy;
  char worth[200];
  strut_summary_worth(s, worth, sizeof worth);
  if (*worth) strut_buffer_add(table, "  accuracy    %s\n", worth);
  if (a->wanted > 0.0 && !a->kept) strut_buffer_add(table, "              %s\n", a->why);
}

/* Steady motion, and what is known of it. */
static void add_claims(strut_buffer *table, const strut_summary *s) {
  const strut_steady_summary *m = &s->steady;
  bool checked = s->accuracy.wanted > 0.0;
  if (m->kind == STRUT_MOTION_PERIODIC) {
    strut_buffer_add(table, "  steady      after %" PRId64 " periods, every ", m->periods);
    if (m->repeats > 1)
      strut_buffer_add(table, "%d of them repeating", (int)m->repeats);
    else
      strut_buffer_add(table, "one repeating");
    strut_buffer_add(table, checked ? "; velocity known within %s\n" : " within %s\n",
                     in(m->interval, "m/s").text);
  } else if (m->kind == STRUT_MOTION_TRANSIENT) {
    strut_buffer_add(table, "  steady      not within %" PRId64 " periods\n", m->periods);
  } else if (m->kind == STRUT_MOTION_IRREGULAR) {
    strut_buffer_add(table, "  irregular   mean velocity known within %s\n",
                     in(m->interval, "m/s").text);
  } else if (m->kind == STRUT_MOTION_CREEPING) {
    strut_buffer_add(table,
                     "  creeping    over %" PRId64 " periods; mean velocity known within %s\n",
                     m->periods, in(m->interval, "m/s").text);
  }
  add_worth(table, s);
}

static void add_head(strut_buffer *table, const strut_summary *s, const strut_scene *scene) {
  strut_buffer_add(table, "%s%s%s", scene->name, *scene->name ? ": " : "",
                   strut_status_text(s->status));
  if (s->reason[0]) strut_buffer_add(table, ": %s", s->reason);
  strut_buffer_add(table, "\n  velocity    %s%s along x, of %s", s->velocity > 0.0 ? "+" : "",
                   in(s->velocity, "m/s").text,
                   s->measured_node ? s->measured_node : "the centre of mass");
  if (isfinite(s->velocity_spread)) {
    strut_buffer_add(table, ", spread %s", in(s->velocity_spread, "m/s").text);
  }
  strut_buffer_add(table, ", from %s%s\n", in(s->window.start, "s").text,
                   s->velocity_zero && s->velocity != 0.0 && !(s->accuracy.wanted > 0.0)
                       ? ", zero up to rounding"
                       : "");
  strut_buffer_add(table, "  duration    %s, %" PRId64 " steps", in(s->duration, "s").text,
                   s->spent.steps);
  if (s->settle_time > 0.0) {
    strut_buffer_add(table, ", after %s of settling", in(s->settle_time, "s").text);
  }
  if (s->settle.unstable)
    strut_buffer_add(table,
                     "\n  start       settled on an UNSTABLE equilibrium; node %s moves most in "
                     "the unstable direction",
                     s->settle.node);
  strut_buffer_add(table, "\n  step        %s", in(s->step, "s").text);
  if (isinf(s->step_limit))
    strut_buffer_add(table, ", no stability limit\n");
  else
    strut_buffer_add(table, ", stable up to %s%s\n", in(s->step_limit, "s").text,
                     s->feedback ? " without feedback" : "");
  if (s->limit_fell.limit > 0.0)
    strut_buffer_add(table, "              TOO LARGE since %s: the stability limit fell to %s\n",
                     in(s->limit_fell.since, "s").text, in(s->limit_fell.limit, "s").text);
  strut_buffer_add(table, "  computed    %" PRId64 " force evaluations in %s", s->spent.evaluations,
                   in(s->spent.wall_time, "s").text);
  if (s->spent.steps > 0) {
    strut_buffer_add(table, ", %s per step",
                     in(s->spent.wall_time / (double)s->spent.steps, "s").text);
  }
  if (s->spent.events > 0) strut_buffer_add(table, ", %" PRId64 " events located", s->spent.events);
  strut_buffer_add(table, "\n");
  add_claims(table, s);
}

/* Why a quantity has no value. */
static const char *missing(const strut_summary *s, const strut_measured *m) {
  if (strut_measured_arrival(m) && s->status == STRUT_OK) return "the target was not reached";
  return s->status == STRUT_OK ? "not finite" : "the window was not reached";
}

static void add_measured(strut_buffer *table, const strut_summary *s) {
  if (s->measured_count)
    strut_buffer_add(table, "\n  %-16s %14s %14s\n", "measured", "value", "spread");
  for (size_t i = 0; i < s->measured_count; i++) {
    const strut_measured *m = &s->measured[i];
    strut_buffer_add(table, "  %-16s %14s", m->name,
                     strut_quantity_of_any(m->value, DIGITS, m->unit).text);
    if (isfinite(m->spread))
      strut_buffer_add(table, " %14s", strut_quantity_of_any(m->spread, DIGITS, m->unit).text);
    if (m->undecided)
      strut_buffer_add(table, "  not decided");
    else if (isnan(m->value))
      strut_buffer_add(table, "  %s", missing(s, m));
    if (m->zero) strut_buffer_add(table, "  zero up to rounding");
    if (m->member) strut_buffer_add(table, "  in %.40s", m->member);
    if (isfinite(m->expected))
      strut_buffer_add(table, "  %s within %s",
                       m->kept ? "known" : "NOT as accurate as requested, but",
                       strut_quantity_of_any(m->expected, 2, m->unit).text);
    strut_buffer_add(table, "\n");
  }
}

/* The residual of the balance and what it means, in one statement. */
static void add_balance(strut_buffer *table, const strut_summary *s) {
  const strut_energy *e = &s->energy;
  strut_rounded_quantity residual = in(e->residual, "J");
  if (s->balance == STRUT_BALANCE_NOT_KEPT || !(e->moved > 0.0)) {
    if (e->residual != 0.0) strut_buffer_add(table, "  %-16s %14s\n", "residual", residual.text);
    return;
  }
  double part = fabs(e->residual) / e->moved;
  if (s->balance == STRUT_BALANCE_OPEN)
    strut_buffer_add(table, "  %-16s %14s   balance NOT closed: %.2g %% of the energy exchanged\n",
                     "residual", residual.text, 100.0 * part);
  else
    strut_buffer_add(table, "  %-16s %14s   balance closed%s\n", "residual", residual.text,
                     part <= 0.01 ? " within 1 % of the energy exchanged"
                                  : " up to the rounding of the stored energy");
}

/* Energies below this part of all of them are rounding. */
static const double ENERGY_ROUNDING = 4.0 * DBL_EPSILON;

static void add_energy(strut_buffer *table, const strut_summary *s) {
  const strut_energy *e = &s->energy;
  const struct {
    const char *name;
    double value;
  } rows[] = {
#define ENERGY_ROW(name, kind, label) {label, e->name},
      STRUT_ENERGY_TABLE(ENERGY_ROW)
#undef ENERGY_ROW
  };
  double most = e->moved + fabs(e->initial);
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) most = fmax(most, fabs(rows[i].value));
  strut_buffer_add(table, "\n  energy after %s, works and losses until then\n",
                   in(s->duration, "s").text);
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

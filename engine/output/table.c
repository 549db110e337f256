/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The summary of a run as a table that fits a screen. */
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/vec.h"
#include "engine/output/buffer.h"
#include "engine/output/json.h"
#include "engine/output/quantity_text.h"

enum { MOST_ROWS = 10, DIGITS = 4 };

static strut_rounded_quantity in(double value, const char *unit) {
  return strut_quantity_of(value, DIGITS, unit);
}

/* What the numbers are worth in one line, then why. */
static void add_worth(strut_buffer *table, const strut_summary *s) {
  const strut_accuracy_summary *a = &s->accuracy;
  char worth[200];
  strut_summary_worth(s, worth, sizeof worth);
  if (*worth) strut_buffer_add(table, "  accuracy    %s\n", worth);
  if (a->wanted > 0.0)
    strut_buffer_add(table, "              %s; checked with %" PRId64 " more force evaluations\n",
                     a->why, a->check_evaluations);
  else if (s->caveat[0])
    strut_buffer_add(table, "              %s\n", s->caveat);
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
  if (m->shot) {
    double most = 0.0;
    for (size_t i = 0; i < m->multiplier_count; i++)
      most = fmax(most, hypot(m->multiplier[i][0], m->multiplier[i][1]));
    const char *kind = most < 1.0 - 1e-6 ? "stable" : most > 1.0 + 1e-6 ? "unstable" : "neutral";
    strut_buffer_add(table, "  orbit       closed within %.2g of the size; %s, multipliers of size",
                     m->residual, kind);
    for (size_t i = 0; i < m->multiplier_count; i++)
      strut_buffer_add(table, " %.4g", hypot(m->multiplier[i][0], m->multiplier[i][1]));
    strut_buffer_add(table, "\n");
  } else if (m->reason[0]) {
    strut_buffer_add(table, "  orbit       not computed: %s\n", m->reason);
  }
  add_worth(table, s);
}

static void add_head(strut_buffer *table, const strut_summary *s, const strut_scene *scene) {
  strut_buffer_add(table, "%s%s%s", scene->name, *scene->name ? ": " : "",
                   strut_status_text(s->status));
  if (s->reason[0]) strut_buffer_add(table, ": %s", s->reason);
  strut_buffer_add(table, "\n  velocity    %s of %s", in(s->velocity, "m/s").text,
                   s->measured_node ? s->measured_node : "the centre of mass");
  if (isfinite(s->velocity_spread)) {
    strut_buffer_add(table, ", spread %s", in(s->velocity_spread, "m/s").text);
  }
  strut_buffer_add(table, ", from %s%s\n", in(s->window_start, "s").text,
                   s->velocity_zero && s->velocity != 0.0 && !(s->accuracy.wanted > 0.0)
                       ? ", zero up to rounding"
                       : "");
  strut_buffer_add(table, "  duration    %s, %" PRId64 " steps", in(s->duration, "s").text,
                   s->steps);
  if (s->settle_time > 0.0) {
    strut_buffer_add(table, ", after %s of settling", in(s->settle_time, "s").text);
  }
  if (s->settle.unstable)
    strut_buffer_add(table,
                     "\n  start       settled on an UNSTABLE equilibrium; node %s moves most in "
                     "the unstable direction",
                     s->settle.node);
  strut_buffer_add(table, "\n  step        %s, stable up to %s%s\n", in(s->step, "s").text,
                   in(s->step_limit, "s").text, s->feedback ? " without feedback" : "");
  if (s->limit_fell.limit > 0.0)
    strut_buffer_add(table, "              TOO LARGE since %s: the stability limit fell to %s\n",
                     in(s->limit_fell.since, "s").text, in(s->limit_fell.limit, "s").text);
  strut_buffer_add(table, "  computed    %" PRId64 " force evaluations in %s", s->force_evaluations,
                   in(s->wall_time, "s").text);
  if (s->steps > 0) {
    strut_buffer_add(table, ", %s per step", in(s->wall_time / (double)s->steps, "s").text);
  }
  if (s->events > 0) strut_buffer_add(table, ", %" PRId64 " events located", s->events);
  strut_buffer_add(table, "\n");
  add_claims(table, s);
}

/* Why a quantity has no value. */
static const char *missing(const strut_summary *s, const strut_measured *m) {
  if (m->arrival && s->status == STRUT_OK) return "the target was not reached";
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
    if (isnan(m->value)) strut_buffer_add(table, "  %s", missing(s, m));
    if (m->zero) strut_buffer_add(table, "  zero up to rounding");
    if (m->member) strut_buffer_add(table, "  in %.40s", m->member);
    if (isfinite(m->expected))
      strut_buffer_add(table, "  %s within %s",
                       m->kept ? "known" : "NOT as accurate as requested, but",
                       strut_quantity_of_any(m->expected, 2, m->unit).text);
    strut_buffer_add(table, "\n");
  }
}

static void add_more(strut_buffer *table, size_t count) {
  if (count > MOST_ROWS) strut_buffer_add(table, "  ... and %zu more\n", count - MOST_ROWS);
}

static void add_positions(strut_buffer *table, const strut_summary *s) {
  if (s->node_count)
    strut_buffer_add(table, "\n  %-16s %14s %14s   after %s\n", "node", "x", "y",
                     in(s->duration, "s").text);
  for (size_t i = 0; i < s->node_count && i < MOST_ROWS; i++) {
    strut_buffer_add(table, "  %-16s %14s %14s\n", s->node_names[i],
                     in(s->positions[2 * i], "m").text, in(s->positions[2 * i + 1], "m").text);
  }
  add_more(table, s->node_count);
}

static void add_hinges(strut_buffer *table, const strut_summary *s) {
  if (s->hinge_count) strut_buffer_add(table, "\n  %-16s %14s %14s\n", "hinge", "angle", "moment");
  for (size_t i = 0; i < s->hinge_count && i < MOST_ROWS; i++)
    strut_buffer_add(table, "  %-16s %10.5g deg %14s\n", s->hinges[i].hinge,
                     s->hinges[i].angle * (180.0 / STRUT_PI), in(s->hinges[i].moment, "N m").text);
  add_more(table, s->hinge_count);
}

static void add_cells(strut_buffer *table, const strut_summary *s) {
  if (s->cell_count) strut_buffer_add(table, "\n  %-16s %14s %14s\n", "cell", "area", "pressure");
  for (size_t i = 0; i < s->cell_count && i < MOST_ROWS; i++)
    strut_buffer_add(table, "  %-16s %10.4g m^2 %14s\n", s->cells[i].cell, s->cells[i].area,
                     in(s->cells[i].pressure, "N/m").text);
  add_more(table, s->cell_count);
}

static void add_breaks(strut_buffer *table, const strut_summary *s) {
  if (s->break_count) strut_buffer_add(table, "\n  %-16s %14s\n", "carries nothing", "from");
  for (size_t i = 0; i < s->break_count && i < MOST_ROWS; i++)
    strut_buffer_add(table, "  %-16s %14s   %s\n", s->breaks[i].name,
                     in(s->breaks[i].time, "s").text, s->breaks[i].released ? "released" : "broke");
  add_more(table, s->break_count);
}

static void add_contacts(strut_buffer *table, const strut_summary *s) {
  if (s->contact_count) {
    strut_buffer_add(table, "\n  %-16s %14s %14s\n", "contact", "contact time", "max. height");
  }
  for (size_t i = 0; i < s->contact_count && i < MOST_ROWS; i++) {
    const strut_contact_summary *contact = &s->contacts[i];
    if (isnan(contact->duty)) { /* the run ended before its window */
      strut_buffer_add(table, "  %-16s %14s %14s\n", contact->node, "none", "none");
      continue;
    }
    strut_buffer_add(table, "  %-16s %12.1f %% %14s\n", contact->node, 100.0 * contact->duty,
                     in(contact->max_height, "m").text);
  }
  add_more(table, s->contact_count);
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
  add_positions(&table, summary);
  add_hinges(&table, summary);
  add_cells(&table, summary);
  add_breaks(&table, summary);
  add_contacts(&table, summary);
  add_energy(&table, summary);
  add_balance(&table, summary);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}

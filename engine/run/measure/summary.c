/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure/summary.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"

const char *strut_motion_name(strut_motion motion) {
  static const char *const names[] = {"", "periodic", "irregular", "transient", "creeping"};
  return names[motion];
}

const char *strut_measured_arrival(const strut_measured *measured) {
  if (!measured->arrival || isnan(measured->margin)) return NULL;
  return measured->undecided ? "not decided" : isnan(measured->value) ? "never" : "reached";
}

void strut_summary_warn(strut_summary *summary, const char *code, const char *format, ...) {
  size_t i = 0;
  assert(summary->warning_count <= STRUT_MOST_WARNINGS);
  while (i < summary->warning_count && strcmp(summary->warnings[i].code, code) != 0) i++;
  if (i == STRUT_MOST_WARNINGS) return;
  if (i == summary->warning_count) summary->warning_count++;
  strut_warning *warning = &summary->warnings[i];
  warning->code = code;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(warning->text, sizeof warning->text, format, arguments);
  va_end(arguments);
}

void strut_summary_withdraw(strut_summary *summary, const char *code) {
  size_t kept = 0;
  for (size_t i = 0; i < summary->warning_count; i++)
    if (strcmp(summary->warnings[i].code, code) != 0)
      summary->warnings[kept++] = summary->warnings[i];
  summary->warning_count = kept;
}

void strut_summary_free(strut_summary *summary) {
  strut_arena_free(&summary->arena);
  memset(&summary->end, 0, sizeof summary->end);
  summary->measured = NULL, summary->measured_count = 0;
  summary->derivatives = NULL, summary->derivative_count = 0;
}

bool strut_summary_is_inaccurate(const strut_summary *summary) {
  return summary->status == STRUT_OK && summary->accuracy.wanted > 0.0 && !summary->accuracy.kept;
}

/* What is known of the error where an accuracy was requested. */
static void describe_error(const strut_summary *summary, char *text, size_t size) {
  const strut_accuracy_summary *accuracy_summary = &summary->accuracy;
  bool velocity = summary->measured_count == 0;
  char error[80] = "the error is not known";
  char asked[60];
  snprintf(asked, sizeof asked, "%.2g %% %s", 100.0 * accuracy_summary->wanted,
           accuracy_summary->assumed ? "taken, as the model has no solver" : "requested");
  if (isfinite(accuracy_summary->expected) && velocity &&
      fabs(summary->velocity) < accuracy_summary->scale)
    snprintf(
        error, sizeof error, "to within %s",
        strut_quantity_of(accuracy_summary->expected * accuracy_summary->scale, 2, "m/s").text);
  else if (isfinite(accuracy_summary->expected))
    snprintf(error, sizeof error, "to within %.2g %%", 100.0 * accuracy_summary->expected);
  if (accuracy_summary->kept && summary->steady.kind == STRUT_MOTION_CREEPING)
    snprintf(text, size, "accurate %s for this model: it only creeps", error);
  else if (accuracy_summary->kept && velocity && summary->velocity_zero)
    snprintf(text, size, "exact for this model: the velocity is zero by symmetry%s%s",
             accuracy_summary->assumed ? "; " : "", accuracy_summary->assumed ? asked : "");
  else if (accuracy_summary->kept)
    snprintf(text, size, "accurate %s for this model; %s", error, asked);
  else
    snprintf(text, size, "NOT kept: %s%s, but %s",
             isfinite(accuracy_summary->expected) ? "accurate only " : "", error, asked);
}

void strut_summary_worth(const strut_summary *summary, char *text, size_t size) {
  if (size) *text = '\0';
  if (summary->status != STRUT_OK) return;
  if (summary->accuracy.wanted > 0.0)
    describe_error(summary, text, size);
  else
    snprintf(text, size, "not known: %s; --accuracy 1%% estimates the error",
             summary->caveat[0] ? summary->caveat : "no error was estimated");
}

void strut_summary_warn_of_accuracy(strut_summary *summary) {
  char text[200];
  if (!strut_summary_is_inaccurate(summary)) return;
  strut_summary_worth(summary, text, sizeof text);
  strut_summary_warn(summary, "accuracy", "the requested accuracy is %s: %s", text,
                     summary->accuracy.why);
}

void strut_summary_warn_of_start(strut_summary *summary) {
  char text[300];
  if (strut_settle_warning(&summary->settle, text, sizeof text))
    strut_summary_warn(summary, "unstable_start", "%s", text);
}

bool strut_settle_warning(const strut_settle_summary *how, char *text, size_t size) {
  if (!how->unstable) return false;
  char remedy[80] = "initial.settle.perturb: yes leaves it";
  if (how->perturbations)
    snprintf(remedy, sizeof remedy, "%d unstable equilibria were already left", how->perturbations);
  snprintf(text, size,
           "the settled start is an unstable equilibrium: a perturbation grows by a factor of e in "
           "%.3g s and moves node '%.60s' most; %s",
           1.0 / how->growth_rate, how->node, remedy);
  return true;
}

/* ---- results by the rows of their table ---- */

const char *strut_balance_name(strut_balance balance) {
  static const char *const names[] = {NULL, "closed", "open"};
  return names[balance];
}

double strut_summary_work_per_distance(const strut_summary *summary) {
  double distance = fabs(summary->velocity) * summary->window.time;
  bool moves = !summary->velocity_zero && distance > 0.0;
  return moves ? summary->window.work / distance : (double)NAN;
}

double strut_summary_cost_of_transport(const strut_summary *summary) {
  double cost = strut_summary_work_per_distance(summary) / summary->weight;
  return summary->weight > 0.0 && cost > 0.0 ? cost : (double)NAN;
}

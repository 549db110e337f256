/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/measure/summary.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"

const char *strut_motion_name(strut_motion motion) {
  static const char *const names[] = {"", "periodic", "irregular", "transient", "creeping"};
  return names[motion];
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

void strut_summary_free(strut_summary *summary) {
  strut_release(summary->node_names);
  strut_release(summary->positions);
  strut_release(summary->contacts);
  strut_release(summary->hinges);
  strut_release(summary->cells);
  strut_release(summary->breaks);
  summary->breaks = NULL;
  summary->break_count = 0;
  strut_release(summary->measured);
  summary->node_names = NULL;
  summary->positions = NULL;
  summary->contacts = NULL;
  summary->hinges = NULL;
  summary->cells = NULL;
  summary->measured = NULL;
  summary->node_count = summary->contact_count = summary->hinge_count = summary->cell_count = 0;
  summary->measured_count = 0;
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

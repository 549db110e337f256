/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Work-precision diagrams: error over cost, both logarithmic, with the Pareto front.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_WORK_PRECISION_H
#define STRUT_ENGINE_OUTPUT_FIGURES_WORK_PRECISION_H

#include "engine/output/draw/figure.h"

typedef struct strut_saving {
  int group;         /* index into groups: one method, joined by a line in the order given */
  const char *label; /* text beside a point of the front, such as the step; or NULL */
  double cost;       /* > 0 */
  double error;      /* > 0; not finite: diverged, drawn at the upper edge */
  double low, high;  /* range of the error over several cases; NAN: none */
} strut_saving;

typedef struct strut_work_precision {
  const char *title;
  strut_axis cost, error; /* made logarithmic */
  size_t group_count, count;
  const char *const *groups;    /* (group_count) */
  const strut_saving *bargains; /* (count) */
} strut_work_precision;

/** Flags (count) the Pareto-optimal points: no other is better in both. Diverged ones never are. */
STRUT_API void strut_pareto_front(const strut_saving *bargains, size_t count, bool *front);
/** Adds a panel. */
STRUT_API strut_panel *strut_add_work_precision(strut_figure *figure,
                                                const strut_work_precision *diagram);

#endif

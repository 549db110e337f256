/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Work-precision diagrams: error over cost, both logarithmic, with the Pareto front. */
#pragma once

#include "engine/output/draw/figure.h"

typedef struct strut_saving {
  const char *group; /* one method: those that follow each other are joined by a line */
  const char *label; /* text beside a point of the front, such as the step; or NULL */
  double cost;       /* > 0 */
  double error;      /* > 0; not finite: diverged, drawn at the upper edge */
  double low, high;  /* range of the error over several cases; NAN: none */
} strut_saving;

/** Flags (count) the Pareto-optimal points: no other is better in both. Diverged ones never are. */
STRUT_API void strut_pareto_front(const strut_saving *savings, size_t count, bool *front);
/** Adds a panel with logarithmic axes. */
STRUT_API strut_panel *strut_add_work_precision(strut_figure *figure, strut_axis cost,
                                                strut_axis error, const strut_saving *savings,
                                                size_t count);

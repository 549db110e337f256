/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a summary has, a row for each value. */
#include <math.h>

#include "engine/run/measure/summary.h"

static strut_value warning_of(const strut_settle_summary *how) {
  strut_value value = {.kind = STRUT_VALUE_WORDS};
  strut_settle_warning(how, value.words, sizeof value.words);
  return value;
}

#define SETTLE(X)                                                                                  \
  X("step", "s", NUMBER(how->step), "of the method that settled")                                  \
  X("evaluations", "", COUNT(how->evaluations), "of the forces; not among the run's")              \
  X("perturbations", "", COUNT(how->perturbations), "off an unstable equilibrium")                 \
  X("stable", "", FLAG(!how->unstable), "whether the equilibrium is")                              \
  X("node", "", TEXT(how->node), "that moves most where it is not")                                \
  X("stiffness", "N/m", NUMBER(how->unstable ? how->stiffness : (double)NAN),                      \
    "lowest eigenvalue where it is not")                                                           \
  X("growth_rate", "1/s", NUMBER(how->unstable ? how->growth_rate : (double)NAN),                  \
    "of that motion without damping")                                                              \
  X("warning", "", BY(warning_of(how)), "in words")
STRUT_VALUES(strut_settle_values, SETTLE, const strut_settle_summary *how = of->at)

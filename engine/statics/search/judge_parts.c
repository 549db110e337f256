/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The softest motion that is not a rigid one. See judge_parts.h. */
#include "engine/statics/search/judge_parts.h"

#include <math.h>
#include <string.h>

/* The direction of a mode without its share of rigid-body motions; false where little is left. */
static bool without_rigid(const strut_judgement *j, const double *mode, double *direction) {
  size_t n = (size_t)j->potential->n;
  double square = 0.0;
  memcpy(direction, mode, n * sizeof *direction);
  for (size_t k = 0; k < (size_t)j->rigid; k++) {
    const double *motion = j->motion + k * n;
    double share = 0.0;
    for (size_t i = 0; i < n; i++) share += motion[i] * mode[i];
    for (size_t i = 0; i < n; i++) direction[i] -= share * motion[i];
  }
  for (size_t i = 0; i < n; i++) square += direction[i] * direction[i];
  if (square < 0.25) return false;
  for (size_t i = 0; i < n; i++) direction[i] /= sqrt(square);
  return true;
}

void strut_judge_softest(const strut_judgement *j, const double *modes, int32_t count,
                         double *direction, strut_critical_point *point) {
  const strut_potential *p = j->potential;
  for (size_t i = 0; i < (size_t)count; i++) {
    if (!without_rigid(j, modes + i * (size_t)p->n, direction)) continue;
    for (int32_t k = 0; k < p->n; k++) point->softest[p->coordinate[k]] = direction[k];
    return;
  }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Free play: no force up to |x| = gap (`first`), and k (|x| - gap) towards the gap beyond. */
#ifndef STRUT_ENGINE_SCENE_LAWS_PLAY_H
#define STRUT_ENGINE_SCENE_LAWS_PLAY_H

#include "engine/scene/laws/numbers.h"

static inline strut_law_response strut_law_play(const strut_law_numbers *n, double e, double e0,
                                                int piece) {
  double x = e - e0, gap = n->first;
  if (piece < 0) piece = x > gap ? 2 : x > -gap ? 1 : 0;
  if (piece == 1) return (strut_law_response){0};
  double beyond = piece == 2 ? x - gap : x + gap, force = n->stiffness * beyond;
  return (strut_law_response){force, 0.5 * force * beyond, n->stiffness, 0.0};
}
static inline int strut_law_play_kinks(const strut_law_numbers *n) {
  (void)n;
  return 2;
}
static inline double strut_law_play_kink(const strut_law_numbers *n, int k) {
  return k ? n->first : -n->first;
}

#endif

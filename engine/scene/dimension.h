/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What a number measures. */
#ifndef STRUT_ENGINE_SCENE_DIMENSION_H
#define STRUT_ENGINE_SCENE_DIMENSION_H

/** Exponents of kg, m, s and angle. */
typedef struct strut_dimension {
  float kg, m, s, angle;
} strut_dimension;

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Where something happens on one piece of a path, to rounding.
 */
#ifndef STRUT_ENGINE_STATICS_PATH_EVENTS_H
#define STRUT_ENGINE_STATICS_PATH_EVENTS_H

#include "engine/statics/path/system.h"

/**
 * A step: from one point (2 n + 2) of the path to the next, and the tangent (n + 1) it began with.
 */
typedef struct strut_path_piece {
  const double *from, *tangent, *to;
  double length; /* tangent . (to - from) */
} strut_path_piece;

/** A number that changes along the path; `which` is the caller's. */
typedef double (*strut_path_measure)(strut_path_system *system, const double *y,
                                     const strut_path_piece *piece, int32_t which);

/** The value of a switch, strut_path_switch_value. */
double strut_path_measure_switch(strut_path_system *system, const double *y,
                                 const strut_path_piece *piece, int32_t which);
/** An eigenvalue of the stiffness, counted from the lowest. */
double strut_path_measure_eigenvalue(strut_path_system *system, const double *y,
                                     const strut_path_piece *piece, int32_t which);

/**
 * The point y (2 n + 2) of the piece where the measure is 0; it must have different signs at the
 * ends. Returns the place along the tangent, 0 to piece->length, or -1: no such change of sign.
 */
double strut_path_locate(strut_path_system *system, const strut_path_piece *piece,
                         strut_path_measure measure, int32_t which, double *y);

#endif

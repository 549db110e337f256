/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The points of a law `table` or `curve`: those given, or of the Bezier curve or the rounded corners that they
 * describe, and their mirror images.
 */
#ifndef STRUT_ENGINE_SCENE_CURVE_H
#define STRUT_ENGINE_SCENE_CURVE_H

#include "engine/base/library.h"
#include "engine/scene/law.h"

/** Control points that a Bezier curve has at most. */
enum { STRUT_MOST_CONTROL_POINTS = 64 };

/** A point with its elongation and its force; slope: of the force there, NAN where the law is straight. */
typedef struct strut_curve_point {
  double x, force, slope;
} strut_curve_point;

/** At least as many as strut_curve_trace fills in. */
size_t strut_curve_room(const strut_law *law);
/**
 * Fills in the points of a law that strut_curve_fault finds no fault in, from one end to the other, and
 * returns how many there are. Folds are among them. Between two of which a slope is NAN the law is straight.
 */
size_t strut_curve_trace(const strut_law *law, strut_curve_point *point);
/** What is wrong with the points of a law that has some, at least two, if their numbers are finite, or NULL. */
const char *strut_curve_fault(const strut_law *law);

#endif

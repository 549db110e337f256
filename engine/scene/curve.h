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

/** Number of points; the law must have as many as it needs. */
size_t strut_curve_points(const strut_law *law);
/** Point i of them, with its elongation and its force. */
void strut_curve_point(const strut_law *law, size_t i, double point[2]);
/** What is wrong with the points of a law that has some, if their numbers are finite, or NULL. */
const char *strut_curve_fault(const strut_law *law);

#endif

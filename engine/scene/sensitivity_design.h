/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The points of a sensitivity analysis, as the values of one axis whose parameters go together.
 *
 * First, where derivatives are wanted, the medians of all distributions, and for each parameter four
 * points around them: a step up and down, and half a step up and down. Then, for each of `samples`
 * base samples, Saltelli's design: the point A, for each parameter A with that parameter of B, and the
 * point B, where A and B are two halves of a sample of twice as many numbers.
 */
#ifndef STRUT_ENGINE_SCENE_SENSITIVITY_DESIGN_H
#define STRUT_ENGINE_SCENE_SENSITIVITY_DESIGN_H

#include "engine/scene/sample.h"
#include "engine/scene/study.h"

/** Most parameters: A and B are one sample. */
enum { STRUT_SENSITIVITY_MOST = STRUT_SAMPLE_MOST_NUMBERS / 2 };

/** Points of one analysis of `count` parameters. */
STRUT_API int64_t strut_sensitivity_points(const strut_study_sensitivity *s, size_t count);
/** First point of base sample `j`: A; then the mixed points in the order of parameters; then B. */
STRUT_API int64_t strut_sensitivity_sample(const strut_study_sensitivity *s, size_t count,
                                           int64_t j);
/**
 * Point at which parameter `i` is moved: k 0 a step up, 1 a step down, 2 and 3 half a step. Point 0 is
 * that between them.
 */
STRUT_API int64_t strut_sensitivity_moved(size_t i, int k);
/**
 * values[i] (strut_sensitivity_points) from distribution i. A step is accuracy^(1/3) of the distance
 * between the median and the 84th percentile, at which the error of a difference of numbers with that
 * relative accuracy balances the curvature of the curve. False: memory is out.
 */
STRUT_API bool strut_sensitivity_fill(const strut_study_sensitivity *s, size_t count,
                                      const strut_distribution *distributions,
                                      double *const *values);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The numbers that laws may need; see engine/scene/law.h. */
#ifndef STRUT_ENGINE_SCENE_LAWS_PARAMETERS_H
#define STRUT_ENGINE_SCENE_LAWS_PARAMETERS_H

/**
 * X(NAME, field, range, measure): field is the key, too; range: what is allowed where a law needs the
 * number, ANY_NUMBER or ABOVE_ZERO; measure: it is a STRAIN, a SLOPE, force per strain, or a FORCE.
 */
#define STRUT_LAW_PARAMETERS(X)                                                                    \
  X(KNEE, knee, ABOVE_ZERO, STRAIN) /* |x| at which a bilinear law changes its slope */            \
  X(SECOND_STIFFNESS, second_stiffness, ANY_NUMBER, SLOPE) /* slope beyond it */                   \
  X(GAP, gap, ABOVE_ZERO, STRAIN)     /* free play on either side of the natural strain */         \
  X(SCALE, scale, ABOVE_ZERO, STRAIN) /* x over which an exponential law grows by e */             \
  X(YIELD, yield, ABOVE_ZERO, FORCE)  /* force at which an elastic-plastic law gives way */

/** Lists that laws may need: X(NAME, key, LIST). */
#define STRUT_LAW_LISTS(X)                                                                         \
  X(COEFFICIENTS, coefficients, LIST)     /* of x, x^2, ... of a polynomial */                     \
  X(POINTS, points, LIST)                 /* of a table or a curve */                              \
  X(CONTROL_POINTS, control_points, LIST) /* of a curve */

#endif

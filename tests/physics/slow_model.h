/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The equations of the paper once more: dense, slow, in long double, and sharing no code with the
 * engine. It reads a scene's plain numbers and nothing else.
 *
 * Coordinates are (x1, y1, x2, y2, ...), n = 2 * node_count of them; the caller frees the arrays.
 */
#pragma once

#include "engine/scene/scene.h"
#include "tests/support/widening.h"

typedef struct slow_model {
  size_t n;
  long double *mass;              /* (n, n) of all coordinates, supports not yet eliminated */
  long double *force;             /* (n) */
  long double *acceleration;      /* (n) 0 where supported */
  long double *tension;           /* (members) */
  long double *normal, *friction; /* (contacts) */
  long double drive, load, belt, members, contact, rubbed; /* powers [W] */
} slow_model;

/** Everything at time t [s], positions q and velocities v. */
void slow_evaluate(slow_model *slow, const strut_scene *scene, double t, const double *q,
                   const double *v);
void slow_free(slow_model *slow);

/** Value and rate of a signal, by its definition. */
void slow_signal(const strut_scene *scene, int32_t signal, long double t, long double *value,
                 long double *rate);
/** lambda_0 and c of a member, over its guides, from the shape as drawn. */
void slow_member_rest(const strut_scene *scene, const strut_member *m, long double *rest,
                      long double *stiffness);
/** x[n] of a (n, n + 1) row by row, whose last column is the right-hand side; a is destroyed. */
void slow_solve(long double *a, size_t n, long double *x);
/** The largest size of n numbers. */
double slow_largest(const long double *x, size_t n);

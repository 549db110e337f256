/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The words of laws (laws/words.h) for single doubles. */
#pragma once

#include <math.h>
#include <stdbool.h>

typedef double strut_law_real;
typedef bool strut_law_mask;

static inline double strut_law_all(double x) { return x; }
static inline bool strut_law_less(double a, double b) { return a < b; }
static inline bool strut_law_at_least(double a, double b) { return a >= b; }
static inline bool strut_law_both(bool m, bool n) { return m && n; }
static inline bool strut_law_either(bool m, bool n) { return m || n; }
static inline bool strut_law_some(bool m) { return m; }
static inline double strut_law_choose(bool m, double a, double b) { return m ? a : b; }
static inline double strut_law_keep(bool m, double a) { return m ? a : 0.0; }
static inline double strut_law_add_where(bool m, double sum, double a) { return m ? sum + a : sum; }
static inline double strut_law_magnitude(double a) { return fabs(a); }
/** Of numbers of the size of 1.5 2^52 the units are the last bits. */
#define STRUT_ROUNDER 6755399441055744.0
static inline double strut_law_whole(double a) { return (a + STRUT_ROUNDER) - STRUT_ROUNDER; }
static inline double strut_law_root(double a) { return sqrt(a); }

/** Sign of x: -1, 0 or 1. */
static inline double strut_sign(double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; }
static inline double strut_law_against(double a, double b) { return -a * strut_sign(b); }

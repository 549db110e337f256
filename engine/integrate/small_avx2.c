/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps of small models with two registers for each coordinate of all nodes. */
#if defined(__x86_64__)
#define STRUT_SMALL_WIDTH 4
#define STRUT_SMALL_NAME(method) strut_small_##method##_avx2
#include "engine/integrate/small_copies.h"

STRUT_SMALL_METHOD(rk4)
STRUT_SMALL_METHOD(verlet)
#else
extern int strut_small_avx2_is_empty;
#endif

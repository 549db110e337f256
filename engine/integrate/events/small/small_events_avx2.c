/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps of small models between events with two registers for each coordinate of all nodes. */
#if defined(__x86_64__)
#define STRUT_SMALL_WIDTH 4
#define STRUT_SMALL_NAME(method) strut_small_##method##_avx2
#include "engine/integrate/events/small/small_exact.h"
#include "engine/integrate/events/small/small_verlet_events.h"

STRUT_SMALL_EXACT(adaptive, true)
STRUT_SMALL_EXACT(rk4_events, false)
STRUT_SMALL_QUIET(verlet_events, small_verlet_events)
#else
extern int strut_small_events_avx2_is_empty;
#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * How much memory the process may have at all, and the refusal of what needs more.
 *
 * What is taken already is not counted: freed blocks serve again, so that only a need above the whole
 * certainly cannot be met. If memory runs out below the limit, strut_memory_fail reports it.
 */
#ifndef STRUT_ENGINE_BASE_MEMORY_LIMIT_H
#define STRUT_ENGINE_BASE_MEMORY_LIMIT_H

#include "engine/base/status.h"

/**
 * The least of what the machine has, its control group (Linux) and the process may have (RLIMIT_AS,
 * RLIMIT_DATA) [B]; INFINITY where nothing is known. *whose: in words, before the figure.
 */
STRUT_API double strut_memory_most(const char **whose);

/**
 * STRUT_OK where `bytes` are not above that. Else STRUT_NO_MEMORY with one sentence: `what` needs at
 * least so much, and there is so much.
 */
STRUT_API strut_status strut_memory_check(double bytes, const char *what, strut_error *error);

/** STRUT_NO_MEMORY with that sentence after memory did run out. */
STRUT_API strut_status strut_memory_fail(double bytes, const char *what, strut_error *error);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Counts every allocation of the whole process, those of foreign libraries too.
 */
#pragma once

#include <stdint.h>

/** Calls of malloc, calloc, realloc and their kin so far; only the differences mean anything. */
uint64_t allocations_so_far(void);
/** Most memory that the process has had [kB]. */
long resident(void);

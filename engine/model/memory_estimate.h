/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Is there memory for a scene, and for the factor of its masses? Asked before it is allocated.
 */
#ifndef STRUT_ENGINE_MODEL_MEMORY_ESTIMATE_H
#define STRUT_ENGINE_MODEL_MEMORY_ESTIMATE_H

#include "engine/scene/scene.h"

/** What the scene, compiling it and finding its largest step take at least, from its counts [B]. */
STRUT_API double strut_memory_needed(const strut_scene *scene);

/**
 * STRUT_NO_MEMORY, with the memory needed and available, where the process may not have so much or
 * the machine has not (memory_limit.h); STRUT_OK otherwise.
 */
STRUT_API strut_status strut_memory_check_model(const strut_scene *scene, strut_error *error);
/** STRUT_NO_MEMORY in the same words, where memory has run out all the same. */
STRUT_API strut_status strut_memory_fail_model(const strut_scene *scene, strut_error *error);

/** The same of a factor whose nonzeros have been counted, but not yet computed. */
STRUT_API strut_status strut_memory_check_factor(int32_t rows, double nonzeros, strut_error *error);
STRUT_API strut_status strut_memory_fail_factor(int32_t rows, double nonzeros, strut_error *error);

#endif

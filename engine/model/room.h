/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Is there memory for a scene? Asked before anything is allocated for it.
 */
#ifndef STRUT_ENGINE_MODEL_ROOM_H
#define STRUT_ENGINE_MODEL_ROOM_H

#include "engine/scene/scene.h"

/** What compiling the scene and finding its largest step take at least, from its counts [B]. */
STRUT_API double strut_room_needed(const strut_scene *scene);

/**
 * STRUT_NO_MEMORY, with what is needed and what there is, where the process may not have so much
 * (RLIMIT_AS, RLIMIT_DATA) or the machine has not; STRUT_OK otherwise.
 */
STRUT_API strut_status strut_room_check(const strut_scene *scene, strut_error *error);

#endif

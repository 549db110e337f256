/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A scene without what makes it move by itself, for settling and statics. */
#ifndef STRUT_ENGINE_SCENE_PASSIVE_H
#define STRUT_ENGINE_SCENE_PASSIVE_H

#include "engine/scene/scene.h"

/**
 * Removes sensors, signals, internal states and Maxwell branches, which have relaxed at rest, from a copy of
 * a scene that has no driven loads any more. Members are copied into the arena where that changes them.
 * False: out of memory.
 */
STRUT_API bool strut_scene_remove_feedback(strut_scene *scene, strut_arena *arena);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * How two scenes differ: what was added, removed and changed, from their texts as strut writes them.
 */
#ifndef STRUT_PARSER_READ_DIFFERENCE_H
#define STRUT_PARSER_READ_DIFFERENCE_H

#include <stddef.h>

#include "engine/base/export.h"
#include "engine/base/memory.h"
#include "engine/base/status.h"
#include "engine/scene/difference.h"

/**
 * Compares two texts of strut_setup_write (or any YAML) key by key in the order of the first, then lists
 * what only the second has. A list counts as one value, and so does a node or member that only one
 * has; a copy of a part that only one has is one difference, too. The scenes' name, description and source are left out. The results belong to the arena.
 * STRUT_OK, STRUT_BAD_SCENE if a text is not YAML, or STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_text_differences(const char *first, const char *second,
                                              strut_arena *arena, strut_difference **list,
                                              size_t *count);

#endif

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
 * Compares two texts of strut_setup_write (or any YAML), key by key in the order of the first, then
 * what only the second has; what is a list counts as one value. A member or node that only one has is
 * one difference. The scenes' own name, description and source are left out. All in the arena. STRUT_OK, STRUT_BAD_SCENE for no YAML, STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_text_differences(const char *first, const char *second,
                                              strut_arena *arena, strut_difference **list,
                                              size_t *count);

#endif

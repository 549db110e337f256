/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Differences between two scenes, as texts; those of many copies of a part as one.
 */
#ifndef STRUT_PARSER_READ_DIFFERENCE_H
#define STRUT_PARSER_READ_DIFFERENCE_H

#include <stddef.h>

#include "engine/base/export.h"
#include "engine/base/memory.h"
#include "engine/base/status.h"
#include "engine/scene/things.h"
#include "parser/yaml/document.h"

/**
 * Compares two texts of strut_setup_write (or any YAML) key by key in the order of the first, then lists
 * what only the second has. A list counts as one value, and so does a node or member that only one
 * has; a copy of a part that only one has is one difference, too. The scenes' name, description and source are left out. The results belong to the arena.
 * STRUT_OK, STRUT_BAD_SCENE if a text is not YAML, or STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_text_differences(const char *first, const char *second,
                                              strut_arena *arena, strut_difference **list,
                                              size_t *count);

/**
 * Joins what only one of two scenes has and belongs to one copy that the other lacks: "cell.5", with the
 * value "2 nodes, 5 members"; copies in a row that are alike become "cell.5 to cell.9". Shortens the
 * list. STRUT_OK or STRUT_NO_MEMORY.
 */
strut_status strut_differences_join_copies(const strut_tree *first, const strut_tree *second,
                                           strut_arena *arena, strut_difference *list,
                                           size_t *count);

#endif

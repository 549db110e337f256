/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Differences of scenes, told in copies of parts. Internal to parser/. */
#ifndef STRUT_PARSER_READ_DIFFERENCE_COPIES_H
#define STRUT_PARSER_READ_DIFFERENCE_COPIES_H

#include "engine/base/memory.h"
#include "engine/scene/difference.h"
#include "parser/yaml/document.h"

/**
 * Joins what only one of two scenes has and belongs to one copy that the other lacks: "cell.5", with the
 * value "2 nodes, 5 members"; copies in a row that are alike become "cell.5 to cell.9". Shortens the
 * list. STRUT_OK or STRUT_NO_MEMORY.
 */
strut_status strut_differences_join_copies(const strut_tree *first, const strut_tree *second,
                                           strut_arena *arena, strut_difference *list,
                                           size_t *count);

#endif

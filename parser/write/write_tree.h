/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A tree as text, in one layout: what fits is on one line, the rest has a line for each key.
 */
#ifndef STRUT_PARSER_WRITE_WRITE_TREE_H
#define STRUT_PARSER_WRITE_WRITE_TREE_H

#include "engine/base/export.h"
#include "parser/yaml/document.h"

/**
 * The text, a block of strut_allocate, that reads as this tree again; NULL: memory is out. Only texts of
 * several lines that were not quoted become quoted. Aliases are written out. `comment`: the first line.
 */
STRUT_API char *strut_tree_write(const strut_tree *root, const char *comment);

#endif

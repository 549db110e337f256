/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A YAML text in a canonical layout: indentation, blanks and blank lines change, nothing else.
 *
 * Block collections are indented by two, flow collections have one blank behind a comma and a colon and
 * none within their brackets; lines break where they did. Comments, quotes, the order of keys and the
 * characters of every value stay.
 */
#ifndef STRUT_PARSER_YAML_LAYOUT_H
#define STRUT_PARSER_YAML_LAYOUT_H

#include <stddef.h>

#include "engine/base/export.h"
#include "engine/base/status.h"

/**
 * The text in its layout, a block of strut_allocate. It has been read again: its values and comments are
 * those of `text`, and its own layout is itself. STRUT_BAD_SCENE with the reason in `error` where that
 * cannot be had, as with tags, explicit keys ("? key") or text that is not YAML; or STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_layout_text(const char *text, size_t length, char **result,
                                         strut_error *error);

#endif

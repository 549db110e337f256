/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A scene as short as it was given: with parameters, groups and parts, in place of all that these make.
 */
#ifndef STRUT_PARSER_WRITE_WRITE_SHORT_H
#define STRUT_PARSER_WRITE_WRITE_SHORT_H

#include "parser/read/read_scene.h"

/**
 * The text of the source, in a block of strut_allocate, with its files written out, its parameters as they
 * were set, and what has been changed since laid over it: the differences between `before`, the text of
 * strut_setup_write of the scene as read, and `setup` as it is now. Reading it gives the same scene to
 * the bit, which is checked: *text is NULL with STRUT_OK where that cannot be had, as where a node of a
 * copy has moved. STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_short_write(strut_scene_source *source,
                                         const strut_override *overrides, size_t override_count,
                                         const char *before, const strut_setup *setup, char **text);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Scenes as YAML. */
#pragma once

#include "engine/base/status.h"
#include "engine/scene/experiment.h"
#include "parser/language/read/read_scene.h"
#include "parser/language/yaml/document.h"

/**
 * The effective scene and experiment as YAML text in a block of strut_allocate (release it); NULL: no memory.
 * Its parameters are a record, without effect.
 */
STRUT_API char *strut_setup_write(const strut_setup *setup);

/**
 * The text of the source, in a block of strut_allocate, with its files written out, its parameters as they
 * were set, and what has been changed since laid over it: the differences between `before`, the text of
 * strut_setup_write of the scene as read, and `setup` as it is now. Reading it gives the same scene to
 * the bit, which is checked as of a file `name`: *text is NULL with STRUT_OK where the text would differ, as
 * where a node of a copy has moved. STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_short_write(strut_scene_source *source, const strut_setting *overrides,
                                         size_t override_count, const char *before,
                                         const strut_setup *setup, const char *name, char **text);

/**
 * The text, a block of strut_allocate, that reads as this tree again; NULL: memory is out. Only texts of
 * several lines that were not quoted become quoted. Aliases are written out. `comment`: the first line.
 */
STRUT_API char *strut_tree_write(const strut_tree *root, const char *comment);

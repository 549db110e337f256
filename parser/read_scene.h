/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * From YAML text to a checked scene.
 */
#ifndef STRUT_PARSER_READ_SCENE_H
#define STRUT_PARSER_READ_SCENE_H

#include "engine/scene/check.h"
#include "engine/scene/scene.h"
#include "parser/diagnostics.h"

/** One --set name=value. */
typedef struct strut_override {
  const char *name, *value;
} strut_override;

/**
 * Reads and checks the scene in text[0..length). On STRUT_OK the scene is complete and valid for
 * its purpose. On STRUT_BAD_SCENE diagnostics holds every finding and the scene is empty. `file` is
 * the name that messages show. Neither file nor text is copied: diagnostics refers to both.
 */
STRUT_API strut_status strut_scene_read(strut_scene *scene, const char *file, const char *text,
                                        size_t length, const strut_override *overrides,
                                        size_t override_count, strut_purpose purpose,
                                        strut_diagnostics *diagnostics);

/**
 * Reads a whole file into a block of strut_allocate (NUL-terminated; *length without it); "-" is
 * standard input. STRUT_FILE_TROUBLE with the reason, or STRUT_BAD_SCENE above the size limit.
 */
STRUT_API strut_status strut_file_read(const char *path, char **text, size_t *length,
                                       strut_error *error);

#endif

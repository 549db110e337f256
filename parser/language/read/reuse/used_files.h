/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Files that scenes and studies name: only those below the folder of the file that names them. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "engine/base/memory.h"
#include "engine/base/status.h"
#include "parser/language/yaml/document.h"

/** Most levels of files that use files. */
enum { STRUT_DEEPEST_FILE = 16 };

/**
 * Reads all files that the document's tree names, directly or not. diagnostics, whose `file` is the path of
 * the document, own their texts. STRUT_BAD_SCENE: some file or name in it was reported; the root is NULL
 * where the base is missing, and parts whose file is missing keep their `use`.
 */
STRUT_API strut_status strut_read_used_files(strut_document *document,
                                             strut_diagnostics *diagnostics);

/** A file as read. strut_safe_text_free releases it. */
typedef struct strut_safe_text {
  char *path;             /* as a message names it: the folder of the naming file, then the name */
  char *text;             /* NUL-terminated */
  size_t length;          /* without the NUL */
  uint64_t device, inode; /* equal for two names of one file: a circle of files */
} strut_safe_text;

/** The folder of a file: "." where the path has none, and for "-". NULL when memory is out. */
STRUT_API char *strut_folder_of(const char *path, strut_arena *arena);
/**
 * Reads the file that the file `from` names as `name`, where all must lie below the folder `root`.
 * STRUT_BAD_SCENE: the name is absolute, empty or has a "..", leads out of the folder, is no regular
 * file, or the file has more than `most` bytes. STRUT_FILE_TROUBLE: it cannot be read. Nothing that is
 * not a regular file is opened, so that a pipe or a device neither blocks nor notices.
 */
STRUT_API strut_status strut_safe_read(const char *root, const char *from, const char *name,
                                       size_t most, strut_safe_text *file, strut_error *error);
STRUT_API void strut_safe_text_free(strut_safe_text *file);

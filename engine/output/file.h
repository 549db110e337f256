/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Files that appear whole or not at all: written in a folder of their own, synchronised, moved. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "engine/base/status.h"

/*
 * Folders in which results are gathered before they move to where they belong.
 *
 * A process that is killed cannot remove its own; the next one that writes into the same place does. Each
 * such folder names its machine in a file and is locked for as long as its process lives, so that one
 * without a lock, of this machine, is abandoned. All others stay.
 */

/** Prefix of their names. */
#define STRUT_STAGE_PREFIX ".strut-stage-"

typedef struct strut_stage {
  char *path; /* of the folder, or NULL */
  int lock;   /* its descriptor, which holds the lock */
} strut_stage;

/** Creates one inside the directory, after removing those of killed processes. 0 or an errno. */
STRUT_API int strut_stage_create(strut_stage *stage, const char *directory);
/** Removes it with its contents. A zeroed struct is allowed. */
STRUT_API void strut_stage_remove(strut_stage *stage);
/** Removes the folders that killed processes left in the directory; true if there were any. */
STRUT_API bool strut_stage_sweep(const char *directory);

/** A file being written. Zero-initialise. */
typedef struct strut_file {
  FILE *stream;      /* write here; its error flag is checked on commit */
  char *path, *part; /* the final name, and the name while it is written */
  strut_stage held;  /* the folder of the part; none where the file is one of a stage */
} strut_file;

/** Creates a directory and what is missing above it, as mkdir -p. */
STRUT_API strut_status strut_directory_create(const char *directory, strut_error *error);
/** Opens directory/name for writing; the directory exists. */
STRUT_API strut_status strut_file_open(strut_file *file, const char *directory, const char *name,
                                       strut_error *error);
/** As strut_file_open, for a path. */
STRUT_API strut_status strut_file_open_path(strut_file *file, const char *path, strut_error *error);
/** Flushes, synchronises and moves; on failure nothing of it is left. */
STRUT_API strut_status strut_file_commit(strut_file *file, strut_error *error);
/** Closes and removes what was written. Does nothing on a committed or zeroed file. */
STRUT_API void strut_file_abandon(strut_file *file);
/** Reports that writing into the open file failed, with the reason in errno; returns the status. */
STRUT_API strut_status strut_file_trouble(const strut_file *file, strut_error *error);
/** The folder of a path in a block of strut_allocate, and its name within. NULL: memory is out. */
STRUT_API char *strut_file_folder(const char *path, const char **name);
/** Removes directory/name if it is there. */
STRUT_API void strut_file_remove(const char *directory, const char *name);
/** Writes a whole text as a file. */
STRUT_API strut_status strut_file_write_text(const char *directory, const char *name,
                                             const char *text, strut_error *error);
/** As strut_file_write_text, but releases the text (of strut_allocate); NULL means memory is out. */
STRUT_API strut_status strut_file_write_block(const char *directory, const char *name, char *text,
                                              strut_error *error);
/** As strut_file_write_text, for a path. */
STRUT_API strut_status strut_file_write_path(const char *path, const char *text,
                                             strut_error *error);

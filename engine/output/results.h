/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A directory of results that changes as a whole: all files of a run, or none.
 *
 * The files are written into a hidden directory inside the final one and moved at the end. Files of
 * an earlier run that this run does not have are removed then, so that no two runs get mixed.
 */
#pragma once

#include <stdbool.h>

#include "engine/base/status.h"
#include "engine/output/file.h"
#include "engine/scene/data.h"

/** Results being written. Zero-initialise. */
typedef struct strut_results {
  char *directory;          /* where they will be */
  const char *stage;        /* where they are written until the commit: pass this to the writers */
  strut_stage held;         /* the same folder, as this process holds it */
  bool made;                /* the directory did not exist before */
  const char *const *names; /* of all possible files, NULL after the last */
} strut_results;

/** Creates the directory and checks that it is writable. */
STRUT_API strut_status strut_results_begin(strut_results *results, const char *directory,
                                           strut_error *error);
/** As strut_results_begin, for other file names than those of a run: `names` ends with NULL and is kept. */
STRUT_API strut_status strut_results_begin_named(strut_results *results, const char *directory,
                                                 const char *const *names, strut_error *error);
/** Moves the files to their directory; on failure as strut_results_abandon. */
STRUT_API strut_status strut_results_commit(strut_results *results, strut_error *error);
/** Removes all written files, and the directory if it is new. A zeroed struct is allowed. */
STRUT_API void strut_results_abandon(strut_results *results);

/*
 * Which files of a directory strut wrote itself: the others it never overwrites.
 *
 * The directory keeps a list of size, checksum and name of every file that strut put there, hidden as
 * `.strut-files`. A file belongs to strut as long as its bytes are those of an entry of its name: what
 * somebody else wrote does not, nor does what was edited since. An entry is written before its file
 * appears, so that a run that is killed never leaves a file that strut does not know again.
 */

#define STRUT_OWNERSHIP_LIST ".strut-files"

/**
 * Fails with STRUT_FILE_TROUBLE, and the first such name, where one of the files `names` (NULL after
 * the last) of the directory exists and does not belong to strut. An empty file may always be replaced.
 */
STRUT_API strut_status strut_ownership_check(const char *directory, const char *const *names,
                                             strut_error *error);
/**
 * Moves the files of a stage to its directory after that check, and removes what the stage has not of the
 * names. They are listed first; where the list cannot be written to, as in a folder of several users, they
 * are simply not listed: strut will not overwrite them later.
 */
STRUT_API strut_status strut_stage_move(const char *stage, const char *directory,
                                        const char *const *names, strut_error *error);

/**
 * Copies the files of measured data to where a scene in the directory names them. STRUT_USAGE where one is
 * called as a file of results, or another file is there.
 */
STRUT_API strut_status strut_data_copy(const strut_data_table *tables, size_t count,
                                       const char *directory, strut_error *error);

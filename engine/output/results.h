/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A directory of results that changes as a whole: all files of a run, or none.
 *
 * The files are written into a hidden directory inside the final one and moved at the end. Files of
 * an earlier run that this run does not have are removed then, so that no two runs get mixed.
 */
#ifndef STRUT_ENGINE_OUTPUT_RESULTS_H
#define STRUT_ENGINE_OUTPUT_RESULTS_H

#include <stdbool.h>

#include "engine/base/status.h"
#include "engine/output/stage.h"

/** Results being gathered. Zero-initialise. */
typedef struct strut_results {
  char *directory;          /* where they will be */
  const char *stage;        /* where they are written: give this one to the writers */
  strut_stage held;         /* the same folder, as this process holds it */
  bool made;                /* the directory did not exist before */
  const char *const *names; /* of all files that may be among them, NULL after the last */
} strut_results;

/** The i-th name of a file of results, or NULL after the last. */
STRUT_API const char *strut_results_name(int i);
/** Creates the directory and finds out whether it can be written to. */
STRUT_API strut_status strut_results_begin(strut_results *results, const char *directory,
                                           strut_error *error);
/** The same for files of other names than those of a run: `names` ends with NULL and is kept. */
STRUT_API strut_status strut_results_begin_named(strut_results *results, const char *directory,
                                                 const char *const *names, strut_error *error);
/** Moves the files to where they belong; on failure as strut_results_abandon. */
STRUT_API strut_status strut_results_commit(strut_results *results, strut_error *error);
/** Removes all that was written, and the directory if it is new. A zeroed struct is allowed. */
STRUT_API void strut_results_abandon(strut_results *results);

#endif

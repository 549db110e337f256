/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Which files of a directory strut wrote itself: the others it never overwrites.
 *
 * The directory keeps a list of size, checksum and name of every file that strut put there, hidden as
 * `.strut-files`. A file belongs to strut as long as its bytes are those of an entry of its name: what
 * somebody else wrote does not, nor does what was edited since. An entry is written before its file
 * appears, so that a run that is killed never leaves a file that strut does not know again.
 */
#ifndef STRUT_ENGINE_OUTPUT_OWNERSHIP_H
#define STRUT_ENGINE_OUTPUT_OWNERSHIP_H

#include "engine/base/status.h"

#define STRUT_OWNERSHIP_LIST ".strut-files"

/**
 * Fails with STRUT_FILE_TROUBLE, and the first such name, where one of the files `names` (NULL after
 * the last) of the directory exists and does not belong to strut. An empty file may always be replaced.
 */
STRUT_API strut_status strut_ownership_check(const char *directory, const char *const *names,
                                             strut_error *error);
/**
 * Lists the files of `stage` that have one of the names as strut's own in `directory`, where they will
 * be moved. Where the list cannot be written to, as in a folder of several users, the files are simply
 * not listed: strut will not overwrite them later.
 */
STRUT_API strut_status strut_ownership_claim(const char *directory, const char *stage,
                                             const char *const *names, strut_error *error);
/** The same two for a path; the claimed bytes are those of the file `part`. */
STRUT_API strut_status strut_ownership_check_path(const char *path, strut_error *error);
STRUT_API strut_status strut_ownership_claim_path(const char *path, const char *part,
                                                  strut_error *error);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A folder for what is made as a file and shown as a text or as arrays: it is gone when the call returns. */
#ifndef STRUT_PARSER_ABI_SCRATCH_H
#define STRUT_PARSER_ABI_SCRATCH_H

#include "engine/base/status.h"

typedef struct abi_scratch {
  char folder[300], path[340]; /* path: of the one file in it */
} abi_scratch;

/** Makes the folder below TMPDIR or /tmp, for a file of that name. STRUT_FILE_TROUBLE. */
strut_status abi_scratch_begin(abi_scratch *scratch, const char *name, strut_error *error);
/** Its file, or another one in it, as a text of strut_allocate; NULL with the error. */
char *abi_scratch_read(const abi_scratch *scratch, const char *name, strut_error *error);
/** Removes the folder and these files in it; NULL after the last. */
void abi_scratch_end(const abi_scratch *scratch, const char *const *names);

#endif

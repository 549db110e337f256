/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Folders in which results are gathered before they move to where they belong.
 *
 * A process that is killed cannot remove its own. Whoever writes into the same place later does: each
 * such folder names its machine in a file and is locked for as long as its process lives, so that one
 * without a lock, of this machine, is nobody's any more. All others stay.
 */
#ifndef STRUT_ENGINE_OUTPUT_STAGE_H
#define STRUT_ENGINE_OUTPUT_STAGE_H

#include <stdbool.h>

#include "engine/base/status.h"

/** Prefix of their names. */
#define STRUT_STAGE_PREFIX ".strut-stage-"

typedef struct strut_stage {
  char *path; /* of the folder, or NULL */
  int lock;   /* its descriptor, which holds the lock */
} strut_stage;

/** Creates one inside the directory, after removing those of killed processes. */
strut_status strut_stage_create(strut_stage *stage, const char *directory, strut_error *error);
/** Removes it with its contents. A zeroed struct is allowed. */
void strut_stage_remove(strut_stage *stage);
/** Removes the folders that killed processes left in the directory; true if there were any. */
bool strut_stage_sweep(const char *directory);

#endif

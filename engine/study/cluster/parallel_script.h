/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The script that runs the shards of a study by GNU parallel, and merges them.
 */
#ifndef STRUT_ENGINE_STUDY_CLUSTER_PARALLEL_SCRIPT_H
#define STRUT_ENGINE_STUDY_CLUSTER_PARALLEL_SCRIPT_H

#include <stddef.h>
#include <stdint.h>

#include "engine/base/status.h"

/** What the script is to do. Texts may hold any characters. */
typedef struct strut_parallel_script {
  const char *program;        /* the path of strut */
  const char *folder;         /* where the paths below begin, an absolute path */
  const char *study, *output; /* as for strut sweep */
  const char *const *words;   /* (word_count) further words for it */
  size_t word_count;
  int64_t shards; /* in all */
  int64_t cpus;   /* threads of a shard, 1 or more */
} strut_parallel_script;

/** The script as a text of strut_allocate. STRUT_USAGE where the number of shards is none. */
STRUT_API strut_status strut_parallel_script_write(const strut_parallel_script *script, char **text,
                                                   strut_error *error);

#endif

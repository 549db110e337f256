/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A shell script that runs the shards of a study as a job array of Slurm and merges them. Its text is
 * slurm.sh, embedded at build time.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "engine/base/status.h"

/** The values of a template. Texts may hold any characters unless noted. */
typedef struct strut_cluster_script {
  const char *name;           /* of the study */
  const char *program;        /* path of strut */
  const char *folder;         /* absolute path that the paths below are relative to */
  const char *study, *output; /* arguments of strut sweep */
  const char *const *words;   /* (word_count) further arguments */
  size_t word_count;
  int64_t shards;     /* number of shards */
  int64_t cpus;       /* threads per shard, 1 or more */
  const char *time;   /* per task in Slurm's notation, such as 1-12:00:00; NULL: its default */
  const char *memory; /* per task, such as 2G; NULL: the system's default */
} strut_cluster_script;

/**
 * Writes the script into a text of strut_allocate. STRUT_USAGE where the number of shards, the time
 * or the memory is invalid.
 */
STRUT_API strut_status strut_cluster_script_write(const strut_cluster_script *script, char **text,
                                                  strut_error *error);

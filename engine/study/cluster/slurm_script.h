/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The script that runs a study on a cluster with Slurm: a job array of shards, and their merge.
 */
#ifndef STRUT_ENGINE_STUDY_CLUSTER_SLURM_SCRIPT_H
#define STRUT_ENGINE_STUDY_CLUSTER_SLURM_SCRIPT_H

#include <stddef.h>
#include <stdint.h>

#include "engine/base/status.h"

/** What the script is to do. Texts may hold any characters, unless said otherwise. */
typedef struct strut_slurm_script {
  const char *name;           /* of the study */
  const char *program;        /* the path of strut */
  const char *folder;         /* where the paths below begin, an absolute path */
  const char *study, *output; /* as for strut sweep */
  const char *const *words;   /* (word_count) further words for it */
  size_t word_count;
  int64_t shards;     /* tasks of the array */
  int64_t cpus;       /* of a task; 0: left to the cluster */
  const char *time;   /* of a task, as Slurm takes it, such as 1-12:00:00; NULL: the cluster's */
  const char *memory; /* of a task, such as 2G; NULL: the cluster's */
} strut_slurm_script;

/**
 * The script as a text of strut_allocate. STRUT_USAGE where the number of shards, time or memory is
 * none that Slurm takes.
 */
STRUT_API strut_status strut_slurm_script_write(const strut_slurm_script *script, char **text,
                                                strut_error *error);

#endif

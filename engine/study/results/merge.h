/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Shards of a study become its table, byte for byte that of the study in one piece.
 */
#ifndef STRUT_ENGINE_STUDY_RESULTS_MERGE_H
#define STRUT_ENGINE_STUDY_RESULTS_MERGE_H

#include "engine/study/results/shard.h"

/** What was merged. */
typedef struct strut_merged {
  int64_t shards; /* 0: the study was in one piece */
  int64_t points, failed;
} strut_merged;

/**
 * Writes directory/table.csv from all shards in directory/shards, or from directory/points.slots.
 * STRUT_FILE_TROUBLE, saying which, where shards or points of them are missing; STRUT_USAGE where the
 * files are not of one study, or cover points twice. Nothing is written then.
 */
STRUT_API strut_status strut_merge(const char *directory, strut_merged *merged, strut_error *error);

#endif

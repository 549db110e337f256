/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The table of a study, a CSV file (RFC 4180) with units in its header such as "velocity [m/s]".
 *
 * One row for each point in their order: its number as `point`, the columns of the study, and
 * `status` and `message`, "completed" and nothing or why it failed. A number that there is not is an
 * empty cell; every other reads back to the same bits.
 */
#pragma once

#include "engine/base/memory.h"
#include "engine/study/results/slots.h"

/** The rows of a table. Point p is in sources[p % count], as shards are; one source holds all. */
typedef struct strut_slot_rows {
  strut_slots *const *sources; /* (count) */
  size_t count;
  const int64_t *points; /* (point_count) which ones, in this order; NULL: all */
  int64_t point_count;
  bool partial; /* only those that there are; others may write the sources meanwhile */
} strut_slot_rows;

/**
 * Writes the table as directory/name, whole or not at all; *rows (may be NULL) receives their number. The bytes depend
 * on the rows only. STRUT_USAGE where a point is missing.
 */
STRUT_API strut_status strut_study_table_write(const char *directory, const char *name,
                                               const strut_slot_rows *of, int64_t *rows,
                                               strut_error *error);

/* Parts of a study that are computed apart, on as many machines: shard k of n, counted from 0.
 *
 * Shard k has the points k, k + n, k + 2n, ...: what costs more at one end of an axis is spread over
 * all of them, and half of the shards are a coarser map of the whole. The file of a shard is
 * DIR/shards/shard-KKKK-of-NNNN.slots, that of a study in one piece DIR/points.slots.
 */

enum { STRUT_MOST_SHARDS = 9999 };

/** One of `count` shards; count 0: the study in one piece. */
typedef struct strut_shard {
  int64_t index, count;
} strut_shard;

/** Environment of a task of a job array. Slurm's: SLURM_ARRAY_TASK_ID, ... NULL if not set. */
typedef struct strut_array_task {
  const char *id, *min, *max, *step, *count;
  char *(*variable)(const char *name); /* any other, as getenv; NULL: none is set */
} strut_array_task;

/**
 * Reads "k/n"; "slurm/n", where k is the task's number, and so for pbs, torque, lsf, sge and kubernetes,
 * whose variables and first numbers are in one table, and "env:NAME/n" for any variable that counts from
 * 0; or "slurm", where the array has a task for each shard and numbers them without gaps. STRUT_USAGE with
 * the reason otherwise: a part of an array that is sent again must not be taken for the whole.
 */
STRUT_API strut_status strut_shard_read(const char *text, const strut_array_task *task,
                                        strut_shard *shard, strut_error *error);
/** Sets the plan's first, count and stride to the points of a shard. */
STRUT_API void strut_shard_points(strut_shard shard, strut_slots_description *plan);
/** The path of a shard's file, in the arena; NULL when memory is out. */
STRUT_API char *strut_shard_path(const char *directory, strut_shard shard, strut_arena *arena);
/**
 * Creates the directories of a shard's file. STRUT_USAGE where `directory` holds shards of another
 * count, or the study in one piece beside shards: they could never be merged.
 */
STRUT_API strut_status strut_shard_begin(const char *directory, strut_shard shard,
                                         strut_error *error);

/** The files of slots in a directory. */
typedef struct strut_shards_found {
  bool whole;     /* DIR/points.slots exists */
  int64_t count;  /* number of shards of the study; 0: no shard exists */
  int64_t other;  /* a conflicting number of shards, or 0 */
  uint8_t *there; /* (count) 1 if the file exists; owned by the arena */
} strut_shards_found;

/** Lists the files; a missing directory has none. */
STRUT_API strut_status strut_shards_find(const char *directory, strut_shards_found *found,
                                         strut_arena *arena, strut_error *error);

/** Report of a merge. */
typedef struct strut_merged {
  int64_t shards; /* 0: the study was in one piece */
  int64_t points, failed, inaccurate;
} strut_merged;

/** Says whether the files, NULL where a shard is missing, have what a table needs. */
typedef strut_status strut_merge_check(void *context, strut_slots *const *sources, size_t count,
                                       strut_error *error);
/**
 * Writes directory/table.csv from all shards in directory/shards, or from directory/points.slots; with `check`, which
 * accepts them, of the rows that there are. STRUT_FILE_TROUBLE, saying which, where shards or points of them are
 * missing; STRUT_USAGE where the files are not of one study, or cover points twice. Nothing is written then.
 */
STRUT_API strut_status strut_merge(const char *directory, strut_merge_check *check, void *context,
                                   strut_merged *merged, strut_error *error);

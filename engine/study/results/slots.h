/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The results of a study on disk while it runs: one slot of fixed size for each point.
 *
 * A file begins with a header that names the study by a hash of all that decides its results
 * (effective model, axes, what is kept, program version), the columns, the number of points and
 * which of them this file (a shard) is for. A slot is written once, in one piece, with a checksum
 * that covers the study, the number of its point and all that it holds: whatever stops the program,
 * a slot is complete or counts as missing. The bits of a slot depend on its point alone, never on
 * threads, shards or order, so that a finished file has the same bytes however it came about.
 *
 * Numbers are in the machine's own byte order, which the header tells; a machine of another order
 * refuses the file. The file grows as slots are written, and memory is a bit for each point.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/scene/value_rows.h"

enum {
  STRUT_SLOT_MESSAGE = 160, /* bytes of a message, its NUL included */
  STRUT_SLOT_WORD = 24,     /* bytes of a word, its NUL included */
  STRUT_SLOT_MOST = 8192,   /* bytes of a slot: about a thousand columns */
  STRUT_STUDY_HASH = 16
};

/** A column of the table. Words are short texts without control characters. */
typedef struct strut_slot_column {
  const char *name, *unit; /* unit "" or "1": none */
  bool word;               /* STRUT_SLOT_WORD bytes in place of a number */
} strut_slot_column;

/** The place of a column's cell among the numbers of a row, or among its words. */
STRUT_API size_t strut_slot_place(const strut_slot_column *columns, size_t column);
/** The column of that name; `count`: there is none. */
STRUT_API size_t strut_slot_named(const strut_slot_column *columns, size_t count, const char *name);

/** Everything that must agree before results may be combined. */
typedef struct strut_slots_description {
  uint8_t hash[STRUT_STUDY_HASH]; /* of the study */
  const char *version;            /* of the program */
  const char *name;               /* of the study */
  int64_t points;                 /* of the whole study; they are numbered from 0 */
  int64_t first, count;           /* this file's: first, first + stride, ..., count of them */
  int64_t stride;                 /* 0 means 1 */
  const strut_slot_column *columns;
  size_t column_count;
} strut_slots_description;

/** A row: numbers and words in the order of their columns. */
typedef struct strut_result_slot {
  strut_status status;                  /* STRUT_OK, or why the point failed */
  const double *numbers;                /* (columns that are numbers); NAN: missing */
  const char (*words)[STRUT_SLOT_WORD]; /* (columns that are words) */
  const char *message;                  /* of a failed point, or NULL; cut at STRUT_SLOT_MESSAGE */
} strut_result_slot;

/** A cell of a row, with the unit of its column. */
STRUT_API strut_value strut_slot_value(const strut_slot_column *columns,
                                       const strut_result_slot *row, size_t column);

/** An open file of slots. */
typedef struct strut_slots strut_slots;

/**
 * Opens or creates the file of slots at `path` for writing, and finds out by reading it through
 * which points are done. STRUT_USAGE, with a message that says what differs (version, points,
 * columns, or the model and axes) and what to do, where the file there is of another study or for
 * other points; STRUT_FILE_TROUBLE where another process has it open for writing, where it cannot be
 * written, or is no such file. A process opens a file once at a time: the lock is the process's.
 * *slots is NULL on failure.
 */
STRUT_API strut_status strut_slots_open(const char *path, const strut_slots_description *plan,
                                        strut_slots **slots, strut_error *error);
/**
 * The same for a file that several processes, on machines that share a disk, write at the same time, all of
 * which open it so. Each claims a point before it computes it.
 */
STRUT_API strut_status strut_slots_open_shared(const char *path,
                                               const strut_slots_description *plan,
                                               strut_slots **slots, strut_error *error);
/**
 * Opens a file of slots for reading only, beside one who writes it or not. Its header goes into
 * *plan, good until closed. STRUT_FILE_TROUBLE where it cannot be read or is no such file.
 */
STRUT_API strut_status strut_slots_read(const char *path, strut_slots **slots,
                                        strut_slots_description *plan, strut_error *error);
/** Closes the file. NULL is allowed. */
STRUT_API void strut_slots_close(strut_slots *slots);

/** The header of an open file. */
STRUT_API const strut_slots_description *strut_slots_description_of(const strut_slots *slots);
/** The number of the file's i-th point, 0 <= i < count. */
STRUT_API int64_t strut_slots_point(const strut_slots *slots, int64_t i);
/** Does a point of this file have a result? Cheap; thread-safe. */
STRUT_API bool strut_slots_done(const strut_slots *slots, int64_t point);
/** Number of points of this file without a result, and number of failed ones. */
STRUT_API int64_t strut_slots_missing(const strut_slots *slots);
STRUT_API int64_t strut_slots_failed(const strut_slots *slots);
/** Is the point completed, and its column STRUT_KEPT_COLUMN 0? One thread at a time. */
STRUT_API bool strut_slots_is_inaccurate(strut_slots *slots, int64_t point);
/** Number of such points. */
STRUT_API int64_t strut_slots_inaccurate(strut_slots *slots);
/** The column that says whether a requested accuracy was reached: 1 or 0. */
#define STRUT_KEPT_COLUMN "accuracy_kept"

/**
 * True: the point has no row, and in a shared file no other process can claim it until this one has put its
 * row or has ended, killed or not. False: it has a row, which strut_slots_done then says, or is claimed by
 * another process. On a disk without file locks every claim of a point without a row succeeds, and several
 * processes write the same bytes. One thread at a time for each point.
 */
STRUT_API bool strut_slots_claim(strut_slots *slots, int64_t point);
/**
 * Writes the row of a point of this file; safe from several threads for different points, and free
 * of allocations. STRUT_USAGE where the point has its result already or is not this file's;
 * STRUT_FILE_TROUBLE on a full disk: the point counts as missing then.
 */
STRUT_API strut_status strut_slots_put(strut_slots *slots, int64_t point,
                                       const strut_result_slot *row, strut_error *error);
/**
 * Points that failed count as missing from now on. Their rows stay in the file until they have others,
 * so that the next process that opens the file finds them, unless they were computed meanwhile.
 */
STRUT_API strut_status strut_slots_retry(strut_slots *slots, strut_error *error);
/** Waits until all rows have reached the disk. */
STRUT_API strut_status strut_slots_sync(strut_slots *slots, strut_error *error);
/**
 * False where the slot is missing; the row is good until the next call for the same file. One thread
 * at a time.
 */
STRUT_API bool strut_slots_get(strut_slots *slots, int64_t point, strut_result_slot *row);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Sinks that write what a run records: CSV and HDF5. */
#pragma once

#include <stddef.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/run/recorder.h"

/* ---- CSV: nodes.csv, members.csv, ..., energy.csv, as far as they have channels ---- */

/** A sink that writes into directory (which exists). NULL when memory is out. */
STRUT_API strut_sink *strut_csv_create(const char *directory);
/** Frees the sink; abandons what was not ended. */
STRUT_API void strut_csv_free(strut_sink *sink);

/* ---- CSV: a path of equilibria as a curve ---- */

struct strut_path;
/**
 * In a block of strut_allocate, NULL where memory was out: one row per point: the parameter ("factor" and, of
 * loads that are alike, "force [N]"; else "value" with its unit), arc, eigenvalues below zero beyond the
 * point; x and y of every node [m], tension of every member, reactions of what is held, normal forces of
 * contacts [N]. Events stand among the points with their kind in the column "event".
 */
STRUT_API char *strut_path_csv(const struct strut_path *path, const strut_scene *scene);

/* ---- HDF5: trajectory.h5, a dataset for each channel, with dimension scales ---- */

/**
 * A sink that writes directory/trajectory.h5; `scene_text` is kept in it as an attribute. Both texts outlive it. Other
 * sinks may be used by other threads. NULL where the HDF5 library cannot be loaded, or memory is out.
 */
STRUT_API strut_sink *strut_hdf5_create(const char *directory, const char *scene_text,
                                        strut_error *error);
/**
 * For a program that uses the HDF5 library through strut only: the library does not tidy up at exit,
 * where it would crash after memory was out. All files are closed by then.
 */
STRUT_API void strut_hdf5_leave_at_exit(void);
/** Frees the sink; abandons what was not ended. */
STRUT_API void strut_hdf5_free(strut_sink *sink);

/* A table as figures take it: named columns of numbers or texts. */

typedef struct strut_table_column {
  const char *name, *unit; /* unit may be "" */
  strut_file_unit shown;   /* what figures show its numbers in */
  const char *const *text; /* (rows) as written; NULL, or NULL entries, if only values are known */
  const double *value;     /* (rows), NAN for empty cells; NULL: not all are numbers */
} strut_table_column;

/** Owned by its arena. Zero-initialise. */
typedef struct strut_table {
  size_t column_count, row_count;
  strut_table_column *columns;
  strut_arena arena;
} strut_table;

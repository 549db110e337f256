/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Measured data: tables with named columns, read from files that a scene or a study names under `data`.
 *
 * Tables are constant. They are read once, and all scenes that are made of one text share them; the memory is
 * that of the scene, of the source of scenes, or of the study.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "engine/scene/observables.h"

typedef struct strut_data_column {
  const char *name; /* within its table: "x1", "snout.x" */
  const char *unit; /* as in the header or under `units`, "mm"; "1": none; NULL: not known */
  strut_dimension dimension; /* of the values, where the unit is known */
  const double *values;      /* (row_count) in SI, NAN: a gap; NULL: some cell is no number */
  const double *weights;     /* (row_count) >= 0, 0 at gaps; NULL: all are 1 */
  size_t gap_count;          /* of the values */
  double least, most;        /* of the values; NAN where all are gaps */
  size_t flaw;               /* without values: the row of the cell that is no number */
} strut_data_column;

typedef struct strut_data_table {
  const char *name, *file; /* file: as the text names it */
  size_t row_count, column_count;
  const strut_data_column *columns;
  int32_t time;            /* column of the time: the first with such a unit; -1: none */
  const char *path, *text; /* of the file, as messages name it; its content */
  /* as given, so that they can be written again */
  int32_t header, skip;   /* lines, 0: as the file shows; rows below them that are left out */
  uint32_t flip;          /* 1 x, 2 y, 3 both */
  double scale;           /* of coordinates */
  const char *scale_unit; /* "m": for each unit of coordinates without one; NULL: a factor */
  double rotate;          /* [rad] */
  double shift[2];        /* [m] */
  const char *weights;    /* a column's name, or the last part of some; "": none */
  size_t unit_count;
  const char **units; /* (unit_count, 2) of a column: its name, its unit */
} strut_data_table;

/** Numbers and weights up to this have a finite sum of squares. */
#define STRUT_DATA_MOST_NUMBER 1e150

/** Defaults of what is given. */
#define STRUT_DATA_USUAL                                                                           \
  { .name = "", .file = "", .weights = "", .scale = 1.0, .time = -1 }

/**
 * The column that "TABLE.COLUMN" names among `count` tables, or NULL; *table, unless NULL, is the table, also
 * where only that was found, or NULL. Names of tables have no dot, names of columns may.
 */
STRUT_API const strut_data_column *strut_data_find(const strut_data_table *tables, size_t count,
                                                   const char *name,
                                                   const strut_data_table **table);

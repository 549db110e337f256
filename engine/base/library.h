/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * How strut reaches the foreign libraries that take long to load: HDF5, Cairo and Pango, CHOLMOD, SPQR and
 * ARPACK with their BLAS.
 *
 * One file of strut uses each of them and offers what it does as a table of strut's own functions, which a
 * function strut_NAME_load gives. Programs that link strut's libraries have the table linked in. The program
 * strut is not linked to these libraries: it has a strut_NAME_load of its own for each (parser/program/
 * installed.c), which loads a module with that file and its library when a command first needs one. What
 * such a file calls of strut has STRUT_API: a module finds it in the program.
 */
#pragma once

#include <stddef.h>

#include "engine/base/status.h"

/** Head of every table: who made it. A table with another head belongs to another strut. */
typedef struct strut_library_stamp {
  const char *version; /* STRUT_VERSION */
  size_t size;         /* of the table, in bytes */
} strut_library_stamp;

#define STRUT_LIBRARY_STAMP(table_type)                                                            \
  { STRUT_VERSION, sizeof(table_type) }

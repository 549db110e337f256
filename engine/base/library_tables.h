/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Where the tables of functions of large foreign libraries come from. Loading HDF5, Cairo and Pango, or CHOLMOD
 * and ARPACK with their BLAS takes longer than checking a scene, so the program strut is not linked to them: it
 * has definitions of the functions below (parser/cli/library_modules.c) that load a table with its libraries
 * when it is first needed. Every other program that links strut's libraries takes the definitions in
 * them (*_linked.c), which return a table that was linked in.
 */
#ifndef STRUT_ENGINE_BASE_LIBRARY_TABLES_H
#define STRUT_ENGINE_BASE_LIBRARY_TABLES_H

#include <stddef.h>

#include "engine/base/status.h"

/** Head of every table: who made it. A table with another head belongs to another strut. */
typedef struct strut_library_stamp {
  const char *version; /* STRUT_VERSION */
  size_t size;         /* of the table, in bytes */
} strut_library_stamp;

/** A strut_algebra_library, or NULL with an error. */
const void *strut_algebra_table_find(strut_error *error);
/** A strut_hdf5_library, or NULL with an error. */
const void *strut_hdf5_table_find(strut_error *error);
/** A strut_drawing_library, or NULL with an error. */
const void *strut_drawing_table_find(strut_error *error);

/**
 * Sets *table, NULL before, to what `find` gives, once; any thread may call it. An error where there is none,
 * or one of another version or size.
 */
strut_status strut_library_load(const void **table, const void *(*find)(strut_error *), size_t size,
                                strut_error *error);

#endif

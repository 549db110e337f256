/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The functions of the HDF5 library that strut calls, as one table, so that a program may load the library
 * when it first writes or reads a trajectory instead of at its start (engine/base/library_tables.h). For files of this
 * folder that call HDF5: hdf5_calls.h.
 */
#ifndef STRUT_ENGINE_OUTPUT_HDF5_LIBRARY_H
#define STRUT_ENGINE_OUTPUT_HDF5_LIBRARY_H

#include <hdf5.h>

#include "engine/base/library_tables.h"

#define STRUT_HDF5_FUNCTIONS(X)                                                                    \
  X(H5Aclose)                                                                                      \
  X(H5Acreate2)                                                                                    \
  X(H5Aexists)                                                                                     \
  X(H5Aget_type)                                                                                   \
  X(H5Aopen)                                                                                       \
  X(H5Aread)                                                                                       \
  X(H5Awrite)                                                                                      \
  X(H5Dclose)                                                                                      \
  X(H5Dcreate2)                                                                                    \
  X(H5Dget_space)                                                                                  \
  X(H5Dget_type)                                                                                   \
  X(H5Dopen2)                                                                                      \
  X(H5Dread)                                                                                       \
  X(H5Dset_extent)                                                                                 \
  X(H5Dwrite)                                                                                      \
  X(H5Eget_auto2)                                                                                  \
  X(H5Eset_auto2)                                                                                  \
  X(H5FDregister)                                                                                  \
  X(H5FDunregister)                                                                                \
  X(H5Fclose)                                                                                      \
  X(H5Fcreate)                                                                                     \
  X(H5Fopen)                                                                                       \
  X(H5Lexists)                                                                                     \
  X(H5Pclose)                                                                                      \
  X(H5Pcreate)                                                                                     \
  X(H5Pget_driver_info)                                                                            \
  X(H5Pset_chunk)                                                                                  \
  X(H5Pset_deflate)                                                                                \
  X(H5Pset_driver)                                                                                 \
  X(H5Pset_fclose_degree)                                                                          \
  X(H5Pset_obj_track_times)                                                                        \
  X(H5Pset_shuffle)                                                                                \
  X(H5Rcreate)                                                                                     \
  X(H5Sclose)                                                                                      \
  X(H5Screate)                                                                                     \
  X(H5Screate_simple)                                                                              \
  X(H5Sget_simple_extent_dims)                                                                     \
  X(H5Sget_simple_extent_ndims)                                                                    \
  X(H5Sget_simple_extent_npoints)                                                                  \
  X(H5Sselect_hyperslab)                                                                           \
  X(H5Tclose)                                                                                      \
  X(H5Tcopy)                                                                                       \
  X(H5Tcreate)                                                                                     \
  X(H5Tget_class)                                                                                  \
  X(H5Tget_size)                                                                                   \
  X(H5Tinsert)                                                                                     \
  X(H5Tis_variable_str)                                                                            \
  X(H5Tset_cset)                                                                                   \
  X(H5Tset_size)                                                                                   \
  X(H5Tset_strpad)                                                                                 \
  X(H5Tvlen_create)                                                                                \
  X(H5check_version)                                                                               \
  X(H5dont_atexit)                                                                                 \
  X(H5free_memory)                                                                                 \
  X(H5open)

/* Identifiers of types and classes, which the library sets when it starts. */
#define STRUT_HDF5_IDENTIFIERS(X)                                                                  \
  X(H5P_CLS_DATASET_CREATE_ID_g)                                                                   \
  X(H5P_CLS_FILE_ACCESS_ID_g)                                                                      \
  X(H5P_CLS_FILE_CREATE_ID_g)                                                                      \
  X(H5T_C_S1_g)                                                                                    \
  X(H5T_IEEE_F64LE_g)                                                                              \
  X(H5T_NATIVE_DOUBLE_g)                                                                           \
  X(H5T_NATIVE_INT_g)                                                                              \
  X(H5T_STD_I32LE_g)                                                                               \
  X(H5T_STD_REF_OBJ_g)

typedef struct strut_hdf5_library {
  strut_library_stamp stamp;
#define FUNCTION(name) __typeof__(name) *name;
#define IDENTIFIER(name) hid_t *name;
  STRUT_HDF5_FUNCTIONS(FUNCTION)
  STRUT_HDF5_IDENTIFIERS(IDENTIFIER)
#undef FUNCTION
#undef IDENTIFIER
} strut_hdf5_library;

/** The table of the HDF5 that this program was linked to, or that a module of it was. */
extern STRUT_API const strut_hdf5_library strut_hdf5_table;

#endif

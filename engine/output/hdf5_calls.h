/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * HDF5's functions under their own names, called through the table. Whoever calls one has had STRUT_OK from
 * strut_hdf5_load before. A name that is missing here is missing in hdf5_library.h, too.
 */
#ifndef STRUT_ENGINE_OUTPUT_HDF5_CALLS_H
#define STRUT_ENGINE_OUTPUT_HDF5_CALLS_H

#include "engine/output/hdf5_library.h"

/** NULL before strut_hdf5_load. */
extern const void *strut_hdf5_loaded;
#define strut_hdf5 ((const strut_hdf5_library *)strut_hdf5_loaded)

/** Makes the library ready, once; fails where it is not installed, or memory is out. */
strut_status strut_hdf5_load(strut_error *error);

#define H5Aclose (strut_hdf5->H5Aclose)
#define H5Acreate2 (strut_hdf5->H5Acreate2)
#define H5Aexists (strut_hdf5->H5Aexists)
#define H5Aget_type (strut_hdf5->H5Aget_type)
#define H5Aopen (strut_hdf5->H5Aopen)
#define H5Aread (strut_hdf5->H5Aread)
#define H5Awrite (strut_hdf5->H5Awrite)
#define H5Dclose (strut_hdf5->H5Dclose)
#define H5Dcreate2 (strut_hdf5->H5Dcreate2)
#define H5Dget_space (strut_hdf5->H5Dget_space)
#define H5Dget_type (strut_hdf5->H5Dget_type)
#define H5Dopen2 (strut_hdf5->H5Dopen2)
#define H5Dread (strut_hdf5->H5Dread)
#define H5Dset_extent (strut_hdf5->H5Dset_extent)
#define H5Dwrite (strut_hdf5->H5Dwrite)
#define H5Eget_auto2 (strut_hdf5->H5Eget_auto2)
#define H5Eset_auto2 (strut_hdf5->H5Eset_auto2)
#define H5FDregister (strut_hdf5->H5FDregister)
#define H5FDunregister (strut_hdf5->H5FDunregister)
#define H5Fclose (strut_hdf5->H5Fclose)
#define H5Fcreate (strut_hdf5->H5Fcreate)
#define H5Fopen (strut_hdf5->H5Fopen)
#define H5Lexists (strut_hdf5->H5Lexists)
#define H5Pclose (strut_hdf5->H5Pclose)
#define H5Pcreate (strut_hdf5->H5Pcreate)
#define H5Pget_driver_info (strut_hdf5->H5Pget_driver_info)
#define H5Pset_chunk (strut_hdf5->H5Pset_chunk)
#define H5Pset_deflate (strut_hdf5->H5Pset_deflate)
#define H5Pset_driver (strut_hdf5->H5Pset_driver)
#define H5Pset_fclose_degree (strut_hdf5->H5Pset_fclose_degree)
#define H5Pset_obj_track_times (strut_hdf5->H5Pset_obj_track_times)
#define H5Pset_shuffle (strut_hdf5->H5Pset_shuffle)
#define H5Rcreate (strut_hdf5->H5Rcreate)
#define H5Sclose (strut_hdf5->H5Sclose)
#define H5Screate (strut_hdf5->H5Screate)
#define H5Screate_simple (strut_hdf5->H5Screate_simple)
#define H5Sget_simple_extent_dims (strut_hdf5->H5Sget_simple_extent_dims)
#define H5Sget_simple_extent_ndims (strut_hdf5->H5Sget_simple_extent_ndims)
#define H5Sget_simple_extent_npoints (strut_hdf5->H5Sget_simple_extent_npoints)
#define H5Sselect_hyperslab (strut_hdf5->H5Sselect_hyperslab)
#define H5Tclose (strut_hdf5->H5Tclose)
#define H5Tcopy (strut_hdf5->H5Tcopy)
#define H5Tcreate (strut_hdf5->H5Tcreate)
#define H5Tget_class (strut_hdf5->H5Tget_class)
#define H5Tget_size (strut_hdf5->H5Tget_size)
#define H5Tinsert (strut_hdf5->H5Tinsert)
#define H5Tis_variable_str (strut_hdf5->H5Tis_variable_str)
#define H5Tset_cset (strut_hdf5->H5Tset_cset)
#define H5Tset_size (strut_hdf5->H5Tset_size)
#define H5Tset_strpad (strut_hdf5->H5Tset_strpad)
#define H5Tvlen_create (strut_hdf5->H5Tvlen_create)
#define H5check_version (strut_hdf5->H5check_version)
#define H5dont_atexit (strut_hdf5->H5dont_atexit)
#define H5free_memory (strut_hdf5->H5free_memory)
#define H5open (strut_hdf5->H5open)
#define H5P_CLS_DATASET_CREATE_ID_g (*strut_hdf5->H5P_CLS_DATASET_CREATE_ID_g)
#define H5P_CLS_FILE_ACCESS_ID_g (*strut_hdf5->H5P_CLS_FILE_ACCESS_ID_g)
#define H5P_CLS_FILE_CREATE_ID_g (*strut_hdf5->H5P_CLS_FILE_CREATE_ID_g)
#define H5T_C_S1_g (*strut_hdf5->H5T_C_S1_g)
#define H5T_IEEE_F64LE_g (*strut_hdf5->H5T_IEEE_F64LE_g)
#define H5T_NATIVE_DOUBLE_g (*strut_hdf5->H5T_NATIVE_DOUBLE_g)
#define H5T_NATIVE_INT_g (*strut_hdf5->H5T_NATIVE_INT_g)
#define H5T_STD_I32LE_g (*strut_hdf5->H5T_STD_I32LE_g)
#define H5T_STD_REF_OBJ_g (*strut_hdf5->H5T_STD_REF_OBJ_g)

#endif

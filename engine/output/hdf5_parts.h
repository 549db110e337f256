/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The pieces of an HDF5 file of results: datasets, texts, dimension scales; for
 * hdf5_file.c and trajectory_file.c.
 *
 * Scales follow the HDF5 Dimension Scale specification, so that netCDF-4 and xarray see named axes.
 * The library's own H5DS functions would copy the padding of a C struct into the file, and two
 * equal runs would differ; here the attributes are written packed. Functions return false (or a
 * negative id) when the library fails.
 */
#pragma once

#include <stdbool.h>

#include <hdf5.h>

#include "engine/base/status.h"
#include "engine/output/trajectory.h"
#include "engine/scene/channels.h"

enum { STRUT_HDF5_RANK = 3, STRUT_HDF5_USERS = STRUT_CHANNEL_COUNT };

/** Switches HDF5's printing of errors off and back on; between them no other thread is in the library. */
typedef struct strut_hdf5_quiet {
  H5E_auto2_t function;
  void *data;
} strut_hdf5_quiet;
strut_hdf5_quiet strut_hdf5_hush(void);
void strut_hdf5_unhush(strut_hdf5_quiet quiet);

/** The `read` of strut_hdf5_library. */
strut_status strut_trajectory_read_file(const char *path, const strut_scene *scene, size_t room,
                                        strut_trajectory *trajectory, strut_error *error);

/** An attribute that holds a UTF-8 text of any length. */
bool strut_hdf5_text(hid_t object, const char *name, const char *text);
/** A dataset of doubles of any number of rows, in compressed chunks of the given shape. */
hid_t strut_hdf5_series(hid_t file, const char *name, int rank, const hsize_t *shape,
                        const hsize_t *chunk);
/** A dataset of `count` texts. Negative also when memory is out, with ENOMEM in errno. */
hid_t strut_hdf5_names(hid_t file, const char *name, const char *const *names, size_t count);

/** A dimension scale and who uses it along which dimension. */
typedef struct strut_hdf5_scale {
  const char *name; /* not owned; also the dataset's name */
  hid_t dataset;    /* owned by the function that opened it */
  hobj_ref_t reference;
  int user_count;
  struct {
    hobj_ref_t dataset;
    int dimension;
  } users[STRUT_HDF5_USERS];
} strut_hdf5_scale;

/** Makes a dataset a scale. */
bool strut_hdf5_scale_begin(strut_hdf5_scale *scale, hid_t file, hid_t dataset, const char *name);
/** Attaches a scale, or none for NULL, to each dimension of a dataset. */
bool strut_hdf5_scale_attach(hid_t file, hid_t dataset, const char *name, int rank,
                             strut_hdf5_scale *scales[STRUT_HDF5_RANK]);
/** Stores the list of users of the scale, after the last attach. */
bool strut_hdf5_scale_end(const strut_hdf5_scale *scale);

/** A new HDF5 file, without times in it, in place of an empty one. Negative on failure. */
hid_t strut_hdf5_create_file(const char *path);

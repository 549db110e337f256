/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What strut needs of the HDF5 library: trajectory.h5 written by a sink, and read back.
 *
 * Only the files named hdf5_* and trajectory.c see hdf5.h.
 */
#pragma once

#include <stdbool.h>

#include "engine/base/library.h"
#include "engine/output/trajectory.h"
#include "engine/run/recorder.h"

typedef struct strut_hdf5_library {
  strut_library_stamp stamp;
  /** As strut_hdf5_create. NULL: out of memory. */
  strut_sink *(*create)(const char *directory, const char *scene_text);
  void (*free)(strut_sink *sink);
  /**
   * Reads the file `path` into a trajectory whose counts and contacts are those of the scene; see
   * strut_trajectory_read.
   */
  strut_status (*read)(const char *path, const strut_scene *scene, size_t room,
                       strut_trajectory *trajectory, strut_error *error);
  /** The library does not tidy up at exit. */
  void (*leave_at_exit)(void);
} strut_hdf5_library;

/** Fails where the library cannot be loaded (engine/base/library.h). */
strut_status strut_hdf5_load(const strut_hdf5_library **library, strut_error *error);
/** The same, and does what strut_hdf5_leave_at_exit has asked for. */
strut_status strut_hdf5_ready(const strut_hdf5_library **library, strut_error *error);

/** What a few calls of the library take, chunks and filters included, for strut_has_memory [bytes]. */
enum { STRUT_HDF5_MEMORY = 8 << 20 };

/* Of trajectory.c, for the reader. */

/** The array of a channel. */
STRUT_API double **strut_trajectory_array(strut_trajectory *trajectory, strut_channels id);
/** STRUT_FILE_TROUBLE: the file cannot be read, for that reason. */
STRUT_API strut_status strut_trajectory_trouble(const char *path, const char *reason,
                                                strut_error *error);

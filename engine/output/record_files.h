/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Sinks that write what a run records: CSV and HDF5. */
#ifndef STRUT_ENGINE_OUTPUT_RECORD_FILES_H
#define STRUT_ENGINE_OUTPUT_RECORD_FILES_H

#include "engine/run/recorder.h"

/* ---- CSV: nodes.csv, members.csv, ..., energy.csv, as far as they have channels ---- */

/** A sink that writes into directory (which exists). NULL when memory is out. */
STRUT_API strut_sink *strut_csv_create(const char *directory);
/** Frees the sink; abandons what was not ended. */
STRUT_API void strut_csv_free(strut_sink *sink);

/* ---- HDF5: trajectory.h5, a dataset for each channel, with dimension scales ---- */

/** A sink that writes directory/trajectory.h5; `scene_text` is kept in it as an attribute. */
STRUT_API strut_sink *strut_hdf5_create(const char *directory, const char *scene_text);
/**
 * For a program that uses the HDF5 library through strut only: the library does not tidy up at exit,
 * where it would crash after memory was out. All files are closed by then.
 */
STRUT_API void strut_hdf5_leave_at_exit(void);
/** Frees the sink; abandons what was not ended. */
STRUT_API void strut_hdf5_free(strut_sink *sink);

#endif

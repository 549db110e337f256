/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Trajectories as one HDF5 file, trajectory.h5, one dataset per channel with dimension scales.
 */
#ifndef STRUT_ENGINE_OUTPUT_HDF5_H
#define STRUT_ENGINE_OUTPUT_HDF5_H

#include "engine/run/recorder.h"

/** A sink that writes directory/trajectory.h5; `scene_text` is kept in it as an attribute. */
STRUT_API strut_sink *strut_hdf5_create(const char *directory, const char *scene_text);
/** Frees the sink; abandons what was not ended. */
STRUT_API void strut_hdf5_free(strut_sink *sink);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A recorded motion in memory: taken while a run records, or read back from its directory. */
#pragma once

#include "engine/run/measure/summary.h"
#include "engine/run/recorder.h"
#include "engine/scene/channels.h"

/** Frames over time, SI. What was not recorded is NULL. Zero-initialise. */
typedef struct strut_trajectory {
  size_t frames, node_count, member_count, hinge_count, cell_count, contact_count;
  size_t every;          /* stride of the frames in the recorded samples; 1: all */
  size_t recorded;       /* number of recorded samples */
  double *time;          /* (frames) */
  int32_t *contact_node; /* (contacts) index of the node in the scene */
  strut_status status;   /* of the run: STRUT_OK, STRUT_DIVERGED or STRUT_INTERRUPTED */
  strut_arena arena;
  /* (frames, items, components) of each channel, by its name, as `position`, or its place in the table */
  union {
    struct {
#define STRUT_TRAJECTORY_FIELD(NAME, name, ...) double *name;
      STRUT_CHANNEL_TABLE(STRUT_TRAJECTORY_FIELD)
    };
    double *channel[STRUT_CHANNEL_COUNT];
  };
} strut_trajectory;
/** Its values of a channel, (frames, items, components); NULL where it was not recorded. */
STRUT_API const double *strut_trajectory_channel(const strut_trajectory *trajectory,
                                                 strut_channels id);

/** Default limit on the doubles of a trajectory: half a gigabyte. */
#define STRUT_TRAJECTORY_ROOM ((size_t)1 << 26)

/**
 * A sink that fills `trajectory`: with all samples, or evenly with every second, fourth ... of them
 * once more than `room` doubles would be needed. `channels` are those it asks for, whatever the
 * scene records into files. It is ready when the run has ended. NULL when memory is out.
 */
STRUT_API strut_sink *strut_trajectory_sink(strut_trajectory *trajectory, const strut_scene *scene,
                                            strut_channels channels, size_t room);
/** Forgets the frames of such a sink, which none was left out of, from that number on. */
STRUT_API void strut_trajectory_cut(strut_trajectory *trajectory, size_t frames);
/** Frees the sink, not the trajectory. */
STRUT_API void strut_trajectory_sink_free(strut_sink *sink);
/**
 * Reads directory/trajectory.h5 of a run of `scene`. STRUT_FILE_TROUBLE where it is not there,
 * cannot be read or is of another scene (other nodes or members), with what to do; STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_trajectory_read(const char *directory, const strut_scene *scene,
                                             size_t room, strut_trajectory *trajectory,
                                             strut_error *error);
STRUT_API void strut_trajectory_free(strut_trajectory *trajectory);

/** Dots of measured data at most. */
enum { STRUT_DATA_DOTS = 1000 };
/**
 * Measured data beside column k of a channel: those that are named like it in the run's files, "n1.x", and of its
 * dimension. `dots` [s, SI], which may be NULL, are rows from span[0] to span[1], evenly chosen where a table has many.
 * Returns how many there are.
 */
STRUT_API size_t strut_data_dots(const strut_scene *scene, const strut_channel_row *row, size_t k,
                                 const double span[2], double (*dots)[2]);

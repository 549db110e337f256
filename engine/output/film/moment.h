/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * One moment of a recorded motion, between its frames.
 */
#ifndef STRUT_ENGINE_OUTPUT_FILM_MOMENT_H
#define STRUT_ENGINE_OUTPUT_FILM_MOMENT_H

#include "engine/model/model.h"
#include "engine/output/trajectory.h"

typedef struct strut_moment {
  double time;     /* [s] */
  double *q;       /* (model->length) */
  double *force;   /* (members) [N], or NULL where not recorded */
  double *contact; /* (contacts, 2) normal and friction [N], or NULL */
  size_t frame;    /* the recorded one at or before it: times are asked for in ascending order */
} strut_moment;

/** Frames that show the structure: those of a run that diverged end before it flies apart. */
size_t strut_frames_to_show(const strut_model *model, const strut_trajectory *motion);
/** Takes the room from an arena; false when there is none. */
bool strut_moment_create(strut_moment *moment, const strut_model *model,
                         const strut_trajectory *motion, strut_arena *arena);
/** Fills it for a time not before the last one asked for; beyond the last frame it is that one. */
void strut_moment_at(strut_moment *moment, const strut_trajectory *motion, size_t frames,
                     double time);
/** Where the point is whose velocity is measured, a node or the centre of mass: its x [m]. */
double strut_moment_travel(const strut_moment *moment, const strut_model *model, int32_t node);

#endif

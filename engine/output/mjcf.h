/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A scene as a model of MuJoCo (MJCF), in its plane x z.
 *
 * A node is a body with a slide joint for each free coordinate, "NODE.x" and "NODE.y", 0 where the run
 * begins, and a site; a member is a spatial tendon with stiffness, damping and spring length, of a cable
 * from 0 to its rest length. Rest lengths that are driven, loads and forces of actuators are motors, whose
 * controls are the signals; those of constant loads are in the key frame "start".
 */
#ifndef STRUT_ENGINE_OUTPUT_MJCF_H
#define STRUT_ENGINE_OUTPUT_MJCF_H

#include "engine/model/model.h"
#include "engine/scene/experiment.h"

enum { STRUT_MJCF_MOST_NOTES = 8 };

/** Zero-initialise; strut_mjcf_free releases it. */
typedef struct strut_mjcf {
  char *text; /* the file; a block of strut_allocate */
  size_t note_count;
  const char *notes[STRUT_MJCF_MOST_NOTES]; /* what the file does not say */
} strut_mjcf;

/**
 * STRUT_BAD_SCENE, with all reasons in one sentence, where the scene has what MJCF has no word for;
 * STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_mjcf_make(const strut_model *model, const strut_experiment *experiment,
                                       strut_mjcf *mjcf, strut_error *error);
STRUT_API void strut_mjcf_free(strut_mjcf *mjcf);

#endif

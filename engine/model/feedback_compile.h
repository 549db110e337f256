/* SPDX-License-Identifier: GPL-3.0-or-later */
/** From the scene's sensors to the model's. */
#ifndef STRUT_ENGINE_MODEL_FEEDBACK_COMPILE_H
#define STRUT_ENGINE_MODEL_FEEDBACK_COMPILE_H

#include "engine/model/model.h"

/** Coordinates that internal states need. */
size_t strut_feedback_states(const strut_scene *scene);
/** Fills model->feedback, after elements and contacts. False: out of memory. */
bool strut_feedback_compile(strut_model *model);

#endif

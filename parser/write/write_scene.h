/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * From a scene back to YAML: every value written out in SI, so that reading it gives the same bits.
 */
#ifndef STRUT_PARSER_WRITE_WRITE_SCENE_H
#define STRUT_PARSER_WRITE_WRITE_SCENE_H

#include "engine/scene/experiment.h"

/** The effective scene and experiment as YAML text in a block of strut_allocate (release it); NULL: no memory. */
STRUT_API char *strut_setup_write(const strut_setup *setup);

#endif

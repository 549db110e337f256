/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The shape that --at names, for commands that look at the drawn one unless told otherwise.
 */
#ifndef STRUT_PARSER_CLI_NAMED_SHAPE_H
#define STRUT_PARSER_CLI_NAMED_SHAPE_H

#include "engine/model/model.h"
#include "engine/scene/experiment.h"
#include "parser/cli/options.h"

typedef struct strut_named_shape {
  const char *name; /* "drawn", or what --at says */
  const double *q;  /* (length) positions [m], in the arena */
} strut_named_shape;

/** STRUT_OK, or what strut_rest_state_find fails with. */
strut_status strut_named_shape_find(const strut_arguments *arguments, const strut_model *model,
                                    const strut_experiment *experiment, strut_arena *arena,
                                    strut_named_shape *shape, strut_error *error);

#endif

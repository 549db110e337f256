/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What a command with a RUN|MODEL begins with: a model, and its recorded motion if there is one.
 */
#ifndef STRUT_PARSER_CLI_OPEN_RUN_H
#define STRUT_PARSER_CLI_OPEN_RUN_H

#include "engine/model/model.h"
#include "engine/output/trajectory.h"
#include "parser/cli/open_model.h"

/** Stays where it is while in use: the model refers to the scene. Zero-initialise. */
typedef struct strut_opened {
  bool run; /* the argument was a directory that `strut run -o` made */
  strut_setup setup;
  strut_model *model;
  strut_trajectory motion; /* of a run: positions are there, in one frame or more */
  char *summary;           /* of a run: the text of its summary.json, or NULL where there is none */
} strut_opened;

/**
 * Opens what the command's argument names. A directory is a run: its scene.yaml is read, and as
 * many frames of its trajectory.h5 as fit into `room` doubles; --set is refused then. Anything else is a
 * model, opened for `purpose`. Messages go to stderr; on failure nothing is left to free.
 */
strut_status strut_open_run(const strut_command *command, const strut_arguments *arguments,
                            strut_open_purpose purpose, size_t room, strut_opened *opened);
/** A zeroed struct is allowed. */
void strut_opened_free(strut_opened *opened);

#endif

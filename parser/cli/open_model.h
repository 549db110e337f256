/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What every command with a MODEL begins with: the scene, or all that is wrong with it.
 */
#ifndef STRUT_PARSER_CLI_OPEN_MODEL_H
#define STRUT_PARSER_CLI_OPEN_MODEL_H

#include "engine/model/model.h"
#include "engine/output/trajectory.h"
#include "engine/scene/check.h"
#include "engine/scene/experiment.h"
#include "parser/cli/options.h"

/** How a command wants its scene. */
typedef enum strut_open_purpose {
  STRUT_OPEN_FOR_RUN, /* an equilibrium to start from is found and put into the start positions */
  STRUT_OPEN_AS_RUN,  /* the same for a run if the file says anything about one, else for statics */
  STRUT_OPEN_FOR_ANY  /* like that, but an equilibrium to start from remains a wish */
} strut_open_purpose;

/** Reads the model that the arguments name; messages go to stderr. strut_setup_free frees it. */
strut_status strut_open_model(const strut_arguments *arguments, strut_open_purpose purpose,
                              strut_setup *setup);

/**
 * The same, STRUT_OPEN_FOR_ANY, which keeps the file's text[0..length) for who reads it again; a block of
 * strut_allocate. *text is NULL after a failure.
 */
strut_status strut_open_model_text(const strut_arguments *arguments, char **text, size_t *length,
                                   strut_setup *setup);

/** Says on stderr what a valid scene has that is hardly meant: see strut_setup_warn. */
strut_status strut_warn_of_scene(const strut_setup *setup);

/**
 * Finds out, before anything is computed, whether files of these names (NULL after the last) can go
 * where -o wants them; leaves no trace.
 */
strut_status strut_check_output_writable(const strut_arguments *arguments,
                                         const char *const *names);
/** The same for one file; a path of NULL is none. */
strut_status strut_try_file(const char *path);

typedef struct strut_named_shape {
  const char *name; /* "drawn", or what --at says */
  const double *q;  /* (length) positions [m], in the arena */
} strut_named_shape;

/** STRUT_OK, or what strut_rest_state_find fails with. */
strut_status strut_named_shape_find(const strut_arguments *arguments, const strut_model *model,
                                    const strut_experiment *experiment, strut_arena *arena,
                                    strut_named_shape *shape, strut_error *error);

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

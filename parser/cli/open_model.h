/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What every command with a MODEL begins with: the scene, or all that is wrong with it.
 */
#ifndef STRUT_PARSER_CLI_OPEN_MODEL_H
#define STRUT_PARSER_CLI_OPEN_MODEL_H

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

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What every command with a MODEL begins with: the scene, or all that is wrong with it. */
#pragma once

#include "engine/model/model.h"
#include "engine/output/trajectory.h"
#include "engine/scene/checks/check.h"
#include "engine/scene/experiment.h"
#include "parser/language/yaml/diagnostics.h"
#include "parser/program/options.h"

/** Purpose of opening a scene. */
typedef enum strut_open_purpose {
  STRUT_OPEN_FOR_RUN,    /* for a run; a start equilibrium is resolved into start positions */
  STRUT_OPEN_AS_RUN,     /* as above if the file describes a run, else for statics */
  STRUT_OPEN_FOR_ANY,    /* as STRUT_OPEN_AS_RUN, but a start equilibrium stays unresolved */
  STRUT_OPEN_FOR_STATICS /* likewise; a run needs no step */
} strut_open_purpose;

/** The text of an opened scene, and what was found. Zero-initialise; strut_open_report_free releases it. */
typedef struct strut_open_report {
  bool prints; /* print what is found; only the text is kept then, NULL after a failure */
  strut_diagnostics diagnostics; /* of the text below */
  char *text;
  size_t length;
  strut_error error; /* what has no place; empty message: nothing */
} strut_open_report;

/**
 * Reads the model that the arguments name. Where `report` is NULL or prints, messages go to stderr; those about the
 * file always do. strut_setup_free frees the setup.
 */
strut_status strut_open_model(const strut_arguments *arguments, strut_open_purpose purpose,
                              strut_setup *setup, strut_open_report *report);
void strut_open_report_free(strut_open_report *report);

/**
 * The scene as short as the file gave it, see strut_short_write; `text` is the file's, `before` the scene
 * as it was read. *result is NULL, which stderr tells, where only the flat scene can be written; and
 * where the file has no parameters, groups or parts, unless `all` are wanted.
 */
strut_status strut_write_short(const strut_arguments *arguments, const char *text, size_t length,
                               const char *before, const strut_setup *setup, bool all,
                               char **result);

/** The model's name in messages. */
const char *strut_model_name(const strut_arguments *arguments);

/** Prints the warnings of a valid scene on stderr: see strut_setup_warn. */
strut_status strut_warn_of_scene(const strut_setup *setup);

/**
 * Finds out, before anything is computed, whether files of these names (NULL after the last) can go
 * where -o wants them; leaves no trace.
 */
strut_status strut_check_output_writable(const strut_arguments *arguments,
                                         const char *const *names);
/** As above for one file; does nothing for NULL. */
strut_status strut_try_file(const char *path);

/** Must not move in memory: the model refers to the scene. Zero-initialise. */
typedef struct strut_opened {
  bool run; /* the argument was a directory that `strut run -o` made */
  strut_setup setup;
  strut_model *model;
  strut_trajectory motion; /* of a run: positions of one frame or more */
  char *summary;           /* of a run: the text of its summary.json, or NULL */
} strut_opened;

/**
 * Opens what the command's argument names. A directory is a run: its scene.yaml is read, and as
 * many frames of its trajectory.h5 as fit into `room` doubles; --set is refused then. Anything else is a
 * model, opened STRUT_OPEN_AS_RUN. Messages go to stderr; on failure nothing is left to free.
 */
strut_status strut_open_run(const strut_arguments *arguments, size_t room, strut_opened *opened);
/** A zeroed struct is allowed. */
void strut_opened_free(strut_opened *opened);

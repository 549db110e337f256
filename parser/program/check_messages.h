/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What `strut check` prints of a scene's messages, and of a study. */
#ifndef STRUT_PARSER_PROGRAM_CHECK_MESSAGES_H
#define STRUT_PARSER_PROGRAM_CHECK_MESSAGES_H

#include "engine/output/json_value.h"
#include "engine/scene/check.h"
#include "parser/program/options.h"
#include "parser/yaml/diagnostics.h"

/* Messages with their places as JSON, for editors: `strut check --json`.
 *
 * Each has file, line, column, length (code points, from 1), severity (error, warning, note), message,
 * hint or null, and notes, which have places of their own. Messages about a whole file point to its
 * first character with the length 0.
 */

/** Appends all errors and notes to the array `to`; sorts them. */
void strut_add_diagnostics(strut_json *json, struct cJSON *to, strut_diagnostics *diagnostics);
/** Appends one message about a file as a whole. */
void strut_add_message(strut_json *json, struct cJSON *to, const char *file, const char *severity,
                       const char *message);
/** Appends the warnings of a scene, at the names of their things in its text. */
void strut_add_warnings(strut_json *json, struct cJSON *to, const strut_findings *found,
                        const strut_scene *scene, const strut_diagnostics *source);

/* `strut check STUDY`: studies are edited beside models, and are checked likewise. */

/** Is the file a study? False too where it cannot be read. */
bool strut_is_study(const char *path);
/** Checks the study that the arguments name and reports on it. */
strut_status strut_check_study(const strut_command *command, const strut_arguments *arguments);

#endif

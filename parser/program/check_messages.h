/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Messages with their places as JSON, for editors: `strut check --json`.
 *
 * Each has file, line, column, length (code points, from 1), severity (error, warning, note), message,
 * hint or null, and notes, which have places of their own. What is about a file as a whole stands at its
 * first character with the length 0.
 */
#ifndef STRUT_PARSER_PROGRAM_CHECK_MESSAGES_H
#define STRUT_PARSER_PROGRAM_CHECK_MESSAGES_H

#include "engine/output/json_value.h"
#include "engine/scene/check.h"
#include "parser/yaml/diagnostics.h"

/** Appends all errors and notes to the array `to`; sorts them. */
void strut_add_diagnostics(strut_json *json, struct cJSON *to, strut_diagnostics *diagnostics);
/** Appends one message about a file as a whole. */
void strut_add_message(strut_json *json, struct cJSON *to, const char *file, const char *severity,
                       const char *message);
/** Appends the warnings of a scene, at the names of their things in its text. */
void strut_add_warnings(strut_json *json, struct cJSON *to, const strut_findings *found,
                        const strut_scene *scene, const strut_diagnostics *source);

#endif

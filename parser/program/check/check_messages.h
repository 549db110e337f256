/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What `strut check` prints of a scene's messages, and of a study. */
#pragma once

#include "engine/integrate/limit/step_limit.h"
#include "engine/scene/checks/check.h"
#include "engine/scene/value_rows.h"
#include "parser/language/yaml/document.h"
#include "parser/program/commands.h"

/* Messages with their places, for editors: `strut check --json`. */

typedef struct strut_located {
  const char *file, *text;
  strut_place place;
} strut_located;

typedef struct strut_message {
  strut_located at;
  const char *severity; /* error, warning, note */
  const char *hint;     /* or NULL */
  size_t note_count;
  strut_located note[STRUT_MESSAGE_NOTES];
} strut_message;

/** Texts of others, which outlive it, and of its own. Zero-initialise. */
typedef struct strut_messages {
  size_t count;
  strut_message *list; /* (count) */
  bool failed;         /* memory was out */
  strut_arena arena;
} strut_messages;

extern const strut_value_rows strut_message_values;

/** Appends all errors and notes; sorts them. */
void strut_messages_add_diagnostics(strut_messages *to, strut_diagnostics *diagnostics);
/** Appends one error about a file as a whole, unless it is empty. */
void strut_messages_add_error(strut_messages *to, const char *file, const char *message);
/** Appends the warnings of a scene, at the names of their things in its text. */
void strut_messages_add_warnings(strut_messages *to, const strut_findings *found,
                                 const strut_scene *scene, const strut_diagnostics *source);

/** Warns on stderr of stick bands that a step passes over, in one line for all nodes. */
void strut_check_bands(const strut_model *model, const strut_experiment *experiment);

/* ---- what is found, as data ---- */

struct strut_sweep_study;

typedef struct strut_check_result {
  bool valid;
  strut_messages messages;
  size_t unlisted;                       /* messages that were only counted */
  const struct strut_sweep_study *study; /* NULL: it is a model */
  /* Of a valid model; else NULL. */
  const strut_setup *setup;
  const strut_model *model;
  const strut_cost_estimate *estimate;
  double *drawn;        /* (length) the drawn shape */
  strut_findings found; /* warnings */
} strut_check_result;

extern const strut_value_rows strut_check_values;

/** Prints it as JSON and releases what it has found. */
strut_status strut_check_print(strut_check_result *checked);

/* `strut check STUDY`: studies are edited beside models, and are checked likewise. */

/** Is the file a study? False too where it cannot be read. */
bool strut_is_study(const char *path);
/** Checks the study that the arguments name and reports on it. */
strut_status strut_check_study(const strut_arguments *arguments);

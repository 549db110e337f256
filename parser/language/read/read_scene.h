/* SPDX-License-Identifier: GPL-3.0-or-later */
/** From YAML text to a checked scene. */
#pragma once

#include "engine/base/text.h"
#include "engine/scene/checks/check.h"
#include "engine/scene/experiment.h"
#include "parser/language/expression/expression.h"
#include "parser/language/yaml/document.h"

/** A parameter given from outside of the scene's text: by --set, of which there are name and text, or by a study. */
typedef struct strut_setting {
  const char *name, *text; /* an expression in the scene's own parameters, or a text */
  bool known, bare;        /* known: what the text says is the value below */
  double value;            /* SI; with bare it takes the dimension that the scene declares */
  strut_dimension dimension;
  strut_place place; /* where it is given; line 0: on the command line */
} strut_setting;

/**
 * Reads and checks a scene and its experiment in text[0..length). On STRUT_OK both are complete and valid for its
 * purpose. On STRUT_BAD_SCENE diagnostics holds every finding and both are empty. `file` is the name that messages
 * show. Neither file nor text is copied: diagnostics refers to both.
 */
STRUT_API strut_status strut_setup_read(strut_setup *setup, const char *file, const char *text,
                                        size_t length, const strut_setting *settings,
                                        size_t setting_count, strut_purpose purpose,
                                        strut_diagnostics *diagnostics);

/** The declaration of a parameter in a scene's text. */
typedef struct strut_declared {
  const char *name;
  bool text, bare; /* a text; a number that fits any dimension */
  strut_dimension dimension;
  strut_file_unit shown;
} strut_declared;

/** A text as a tree, read once, of which scenes are made again and again. Constant: threads share it. */
typedef struct strut_scene_source {
  strut_document document; /* may be changed until the first scene is made */
  strut_arena arena;
  const char *file, *text;
  size_t length, parameter_count;
  strut_declared *parameters; /* (parameter_count) in the text's order */
  size_t used_count;
  strut_used_file *used; /* (used_count) files that the text names; owned */
  size_t table_count;
  const strut_data_table *tables; /* (table_count) which all its scenes share */
} strut_scene_source;

/**
 * Reads the text as a tree and its parameters. STRUT_BAD_SCENE with every finding about the whole
 * scene where the tree or a parameter cannot be read. file, text and diagnostics as strut_setup_read.
 */
STRUT_API strut_status strut_scene_source_open(const char *file, const char *text, size_t length,
                                               strut_diagnostics *diagnostics,
                                               strut_scene_source **source);
STRUT_API void strut_scene_source_free(strut_scene_source *source); /* NULL is allowed */
/** The parameter of that name, or NULL. */
STRUT_API const strut_declared *strut_scene_source_parameter(const strut_scene_source *source,
                                                             const char *name);
/** Enters one more file, which outlives the source; its number for places, 0: there are too many. */
STRUT_API unsigned strut_scene_source_use(strut_scene_source *source, const char *file,
                                          const char *text, size_t length);
/** As strut_setup_read, from the tree. */
STRUT_API strut_status strut_scene_source_read(const strut_scene_source *source,
                                               const strut_setting *settings, size_t setting_count,
                                               strut_purpose purpose,
                                               strut_diagnostics *diagnostics, strut_setup *setup);

/**
 * Adds the setting of a number of the source's parameters to `settings`, in place of another of that name; its text
 * goes to `text`. *count, unless it was there. False: there is no such number.
 */
STRUT_API bool strut_setting_put(const strut_scene_source *source, const char *name, double value,
                                 char text[STRUT_NUMBER_TEXT], strut_setting *settings,
                                 size_t *count);

/**
 * Reads a whole file into a block of strut_allocate (NUL-terminated; *length without it); "-" is
 * standard input. STRUT_FILE_TROUBLE with the reason, or STRUT_BAD_SCENE above the size limit.
 */
STRUT_API strut_status strut_file_read(const char *path, char **text, size_t *length,
                                       strut_error *error);

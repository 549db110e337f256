/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Scenes of other programs: their files to a scene's text.
 *
 * What a scene cannot say is a note with its place; what cannot be read is an error with its place, and
 * then there is no scene. The text that comes out has been read and checked as a scene.
 */
#ifndef STRUT_PARSER_IMPORT_IMPORT_H
#define STRUT_PARSER_IMPORT_IMPORT_H

#include "parser/yaml/diagnostics.h"

/** Formats: X(NAME, word of the command line, what it is called). */
#define STRUT_IMPORT_FORMATS(X)                                                                    \
  X(NTRT, "ntrt", "YAML of NASA's Tensegrity Robotics Toolkit")                                    \
  X(TENSEGRITYSIM, "tensegritysim", "YAML of TensegritySim")                                       \
  X(SPRINGABLE, "springable", "CSV of springable")                                                 \
  X(TABLES, "tables", "tables of nodes and members")

typedef enum strut_import_format {
#define STRUT_IMPORT_ENUM(name, word, title) STRUT_IMPORT_##name,
  STRUT_IMPORT_FORMATS(STRUT_IMPORT_ENUM)
#undef STRUT_IMPORT_ENUM
      STRUT_IMPORT_COUNT
} strut_import_format;

/** A file to import. */
typedef struct strut_import_file {
  const char *name;
  char *text; /* a block of strut_allocate, which strut_import_files_free releases */
  size_t length;
  strut_diagnostics diagnostics; /* what is said about it: errors and notes */
} strut_import_file;

/** What the text looks like, or -1. */
STRUT_API int strut_import_guess(const char *text, size_t length);
/**
 * Makes the scene: one file, of NTRT's those of the structures in it behind it, or of tables
 * those of nodes and of members in either order. unit: metres in
 * the file's unit of length; 0: a decimetre in NTRT's files, otherwise a metre. *scene is a block of
 * strut_allocate. STRUT_BAD_SCENE with the findings of the files, and what the scene's own text gives in
 * `result`, whose source it becomes.
 */
STRUT_API strut_status strut_import(strut_import_format format, strut_import_file *files,
                                    size_t count, double unit, char **scene,
                                    strut_diagnostics *result, strut_error *error);
STRUT_API void strut_import_files_free(strut_import_file *files, size_t count);

#endif

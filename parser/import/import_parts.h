/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the readers of foreign formats share: a scene's text in sections, and places. Internal to parser/.
 */
#ifndef STRUT_PARSER_IMPORT_IMPORT_PARTS_H
#define STRUT_PARSER_IMPORT_IMPORT_PARTS_H

#include "engine/base/name_map.h"
#include "parser/import/import.h"
#include "parser/write/writer.h"
#include "parser/yaml/document.h"

/** Sections of the scene, in the order in which they are written: X(NAME, key). */
#define STRUT_IMPORT_SECTIONS(X)                                                                   \
  X(PARAMETERS, "parameters")                                                                      \
  X(GROUPS, "groups")                                                                              \
  X(NODES, "nodes") /* by strut_import_node_add */                                                 \
  X(MEMBERS, "members")                                                                            \
  X(HINGES, "hinges")                                                                              \
  X(CELLS, "cells")                                                                                \
  X(DISTANCES, "distances")                                                                        \
  X(LOADS, "loads")                                                                                \
  X(PATH, "path")

typedef enum strut_import_section {
#define STRUT_IMPORT_SECTION_ENUM(name, key) STRUT_IMPORT_##name,
  STRUT_IMPORT_SECTIONS(STRUT_IMPORT_SECTION_ENUM)
#undef STRUT_IMPORT_SECTION_ENUM
      STRUT_IMPORT_SECTION_COUNT
} strut_import_section;

/** A node, which is written where something uses it. */
typedef struct strut_import_node {
  const char *name, *value; /* as written */
  strut_place place;        /* in the file `said` is about */
  strut_diagnostics *said;
  bool used;
} strut_import_node;

typedef struct strut_import_scene {
  strut_import_file *files;
  size_t file_count;
  double unit;                                      /* [m] */
  strut_writer head;                                /* keys of the scene itself, a line each */
  strut_writer section[STRUT_IMPORT_SECTION_COUNT]; /* their entries, a line each */
  size_t node_count, node_room;
  strut_import_node *nodes; /* in the arena */
  strut_name_map node_names;
  strut_arena arena;
  bool out_of_memory;
} strut_import_scene;

/** Adds a node: its name in the file, and its mapping as written. A scene refuses nodes without use. */
void strut_import_node_add(strut_import_scene *s, strut_diagnostics *said, strut_place place,
                           const char *name, const char *value);
/** The node's name as written; it is used. */
const char *strut_import_node_use(strut_import_scene *s, const char *name);

/** Adds a line to a section; the format names no user's text but by strut_import_name. */
void strut_import_line(strut_import_scene *s, strut_writer *to, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/** printf into the scene's arena; "" when memory is out. */
const char *strut_import_text(strut_import_scene *s, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/** The name as a scene may have it: other characters are underscores. */
const char *strut_import_name(strut_import_scene *s, const char *name);
/** A number as the shortest text with its bits. */
const char *strut_import_number(strut_import_scene *s, double value);
/** A length of the file as a text in metres; decimal units leave decimal numbers. */
const char *strut_import_length(strut_import_scene *s, double value);
/** A plain finite number; otherwise that is reported, what it should be and where. */
bool strut_import_read_number(strut_diagnostics *d, const strut_tree *value, const char *what,
                              double *number);

strut_status strut_import_ntrt(strut_import_scene *s);
strut_status strut_import_tensegritysim(strut_import_scene *s);
strut_status strut_import_springable(strut_import_scene *s);
strut_status strut_import_tables(strut_import_scene *s);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Structures of NTRT's files, and structures within them: their nodes in space and the pairs between these. Internal
 * to the importer.
 */
#ifndef STRUT_PARSER_IMPORT_NTRT_H
#define STRUT_PARSER_IMPORT_NTRT_H

#include "parser/import/import_parts.h"

typedef struct strut_ntrt_node {
  const char *name; /* behind those of the structures around it: outer.inner.node */
  double p[3];      /* in the file's unit; y is up */
  strut_place place;
  strut_diagnostics *said; /* of the file that it is in */
} strut_ntrt_node;

typedef struct strut_ntrt_pair {
  const char *base, *tags; /* base: of its member's name */
  int32_t end[2];          /* nodes */
  strut_place place;
  strut_diagnostics *said;
} strut_ntrt_pair;

/** A builder: its tags and, as its value, class and parameters. */
typedef struct strut_ntrt_builder {
  const strut_tree *key;
  strut_diagnostics *said;
} strut_ntrt_builder;

typedef struct strut_ntrt {
  strut_import_scene *scene;
  strut_document *documents; /* one for each file; read where `root` is not NULL */
  size_t node_count, node_room, pair_count, pair_room, builder_count, builder_room;
  int structures;         /* so far */
  strut_ntrt_node *nodes; /* those of a structure follow each other */
  strut_ntrt_pair *pairs;
  strut_ntrt_builder *builders; /* those of outer structures replace those of inner ones */
} strut_ntrt;

/** Reads the first file with the structures in it. What cannot be read is reported. */
strut_status strut_ntrt_read(strut_ntrt *n);
void strut_ntrt_free(strut_ntrt *n);

#endif

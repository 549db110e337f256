/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the files of the document reader share; nobody else includes it.
 */
#ifndef STRUT_PARSER_YAML_DOCUMENT_PARTS_H
#define STRUT_PARSER_YAML_DOCUMENT_PARTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <yaml.h>

#include "parser/yaml/document.h"

/** A hash that an author of texts cannot aim at: seed differs from run to run. */
uint64_t strut_text_hash(const char *text, size_t length, uint64_t seed);

/** Finds what libyaml must not see: bad UTF-8, controls, directives. False with the messages. */
bool strut_document_scan(strut_diagnostics *diagnostics);

/**
 * Turns libyaml's error into one located message. `open` is the innermost bracketed list or mapping
 * that is open, or NULL. False: memory was out.
 */
bool strut_document_syntax_error(const yaml_parser_t *parser, const strut_tree *open,
                                 strut_diagnostics *diagnostics);

/** Anchored nodes by name. Zero-initialise; release with strut_anchors_free. */
typedef struct strut_anchor {
  const char *name;
  strut_tree *node;
  uint64_t weight; /* nodes it stands for, aliases inside counted in full; 0: still open */
  size_t height;   /* levels of lists and mappings in it, aliases inside counted in full */
} strut_anchor;

enum { STRUT_ANCHOR_MOST = 1000 };

typedef struct strut_anchors {
  strut_anchor *items;
  uint16_t *slots; /* 1 + index of the latest of its name */
  size_t count;
  uint64_t seed;
} strut_anchors;

/** The latest anchor of that name, or NULL. */
strut_anchor *strut_anchors_find(const strut_anchors *anchors, const char *name);
/** One more; name is not copied. NULL: memory is out. There must be fewer than ANCHOR_MOST. */
strut_anchor *strut_anchors_add(strut_anchors *anchors, const char *name, strut_tree *node);
void strut_anchors_free(strut_anchors *anchors);

/** Room for a hash table of keys, kept from map to map. Zero-initialise; release `slots`. */
typedef struct strut_key_table {
  strut_tree **slots;
  size_t capacity;
  uint64_t seed;
} strut_key_table;

/** Reports and unlinks the keys that a map must not have: empty, '<<', twice. False: no memory. */
bool strut_document_check_keys(strut_tree *map, strut_key_table *table,
                               strut_diagnostics *diagnostics);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A YAML text as a tree in which every value knows its place.
 *
 * libyaml's events become nodes in one arena. Nothing is interpreted here: scalars stay text. Limits
 * (depth, bytes, nodes, anchors, expansion of aliases) are enforced while reading, so that a hostile
 * text is refused at once. An alias is a copy of the anchored node that shares its children: branches
 * may be shared but there is no cycle, and no way down has more than 64 levels.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/memory.h"
#include "parser/language/yaml/diagnostics.h"

typedef enum strut_tree_kind { STRUT_TREE_SCALAR, STRUT_TREE_LIST, STRUT_TREE_MAP } strut_tree_kind;

/** Most bytes of a text. */
#define STRUT_TEXT_MOST ((size_t)256 << 20)

/** One value: 40 bytes. A map's children alternate key, value; keys are scalars. */
typedef struct strut_tree {
  strut_place place;   /* of its first character (an alias: of the alias), its length */
  uint32_t count : 27; /* list: items; map: pairs */
  uint32_t kind : 2;   /* a strut_tree_kind */
  bool quoted : 1;     /* scalar: written in quotes or as a block */
  bool placed : 1;     /* it belongs to a copy of a part, see parser/language/read/reuse/copies.h */
  const char *text;    /* scalar: NUL-terminated, no NUL inside, "" for nothing */
  struct strut_tree *first, *next; /* first child; next sibling */
} strut_tree;

/** Mask that fits a number into `count`, which the limits on values keep below it. */
#define STRUT_TREE_COUNT_MASK 0x7FFFFFFu

/** The tree and the arena that owns it. Zero-initialise; release with strut_document_free. */
typedef struct strut_document {
  strut_arena arena;
  strut_tree *root; /* NULL when the text could not be read to its end */
} strut_document;

/**
 * Reads the text that `diagnostics` holds (see strut_diagnostics_source). Problems are added to
 * diagnostics; returns STRUT_OK, STRUT_BAD_SCENE or STRUT_NO_MEMORY. With STRUT_BAD_SCENE there is a
 * root where the rest of the text still makes sense (a duplicate key or '<<' is left out, a tag is
 * ignored), so that a caller can go on to find all errors at once.
 */
STRUT_API strut_status strut_document_read(strut_document *document,
                                           strut_diagnostics *diagnostics);
STRUT_API void strut_document_free(strut_document *document);

/** Value of `key` in a map, or NULL; key_node (may be NULL) receives the key itself. */
STRUT_API strut_tree *strut_tree_find(const strut_tree *map, const char *key,
                                      strut_tree **key_node);

/** True for a plain empty scalar, ~ and null. */
STRUT_API bool strut_is_null(const strut_tree *value);

/* ---- trees made of others, in an arena; NULL or false: memory is out ---- */

/** An entry, or a value, that belongs to a copy of a part (parser/language/read/reuse/copies.h); NULL: to the scene. */
typedef struct strut_placed_tree {
  strut_tree tree; /* `placed` is set */
  struct strut_copy *scope;
} strut_placed_tree;

/** A copy of one node, by itself, that shares its children. */
STRUT_API strut_tree *strut_tree_copy(strut_arena *arena, const strut_tree *node);
/** A plain text that stands where `like` does; NULL where the text is NULL, too. */
STRUT_API strut_tree *strut_tree_scalar(strut_arena *arena, const strut_tree *like,
                                        const char *text);

/** A mapping that grows. */
typedef struct strut_tree_builder {
  strut_tree *map, **end;
} strut_tree_builder;

/** A mapping without entries, where `like` stands. Appending to one that could not be made fails. */
STRUT_API strut_tree_builder strut_tree_begin(strut_arena *arena, const strut_tree *like);
/** Appends an entry, whose nodes are not shared; fails where one of them is NULL. */
STRUT_API bool strut_tree_append(strut_tree_builder *builder, strut_tree *key, strut_tree *value);
/** Appends copies of a key and of a value. */
STRUT_API bool strut_tree_share(strut_tree_builder *builder, strut_arena *arena,
                                const strut_tree *key, const strut_tree *value);
/** Takes a key out of a mapping whose entries are not shared. */
STRUT_API void strut_tree_drop(strut_tree *map, const char *key);
/** Do two values say the same, wherever they stand? */
STRUT_API bool strut_tree_equal(const strut_tree *first, const strut_tree *second);

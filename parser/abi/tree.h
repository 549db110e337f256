/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A tree of named values, by dotted names: what JSON texts and scenes hold.
 *
 * A name may itself contain dots, as those of things in copies do: the longest one that fits is taken.
 * Items of lists are called by their number, from 0.
 */
#ifndef STRUT_PARSER_ABI_TREE_H
#define STRUT_PARSER_ABI_TREE_H

#include <stdbool.h>
#include <stddef.h>

#include "engine/base/memory.h"
#include "parser/yaml/document.h"

typedef struct cJSON abi_tree;

/** The tree of a JSON text; NULL: memory is out. */
abi_tree *abi_tree_read(const char *json);
/** The tree of a resolved scene: texts in quotes stay texts, plain ones become numbers or flags if they are. */
abi_tree *abi_tree_of(const strut_tree *root);
/** As a JSON text in a block of strut_allocate; NULL: memory is out. */
char *abi_tree_write(const abi_tree *tree);
void abi_tree_free(abi_tree *tree); /* NULL is allowed */

bool abi_tree_number(const abi_tree *tree, const char *name, double *value);
bool abi_tree_flag(const abi_tree *tree, const char *name, int *value);
const char *abi_tree_text(const abi_tree *tree, const char *name);
/** Number of items of a list or mapping; "" is the whole. */
size_t abi_tree_count(const abi_tree *tree, const char *name);
/** The i-th key of a mapping, or NULL. */
const char *abi_tree_key(const abi_tree *tree, const char *name, size_t i);
/** Replaces a value of the mapping called `name` by a number or, where text is not NULL, by a text. False: no memory. */
bool abi_tree_set(abi_tree *tree, const char *name, const char *key, double number,
                  const char *text);

/**
 * The numbers behind a name as an array, row by row: each list on the way is a dimension, and so is what lies behind. NULL where
 * there is none, or more than `most` dimensions; *no_memory says whether memory was out.
 */
double *abi_tree_array(const abi_tree *tree, const char *name, int most, strut_arena *arena,
                       int *dimensions, size_t *shape, bool *no_memory);

#endif

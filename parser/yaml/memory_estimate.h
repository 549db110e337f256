/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Memory needed to read a text, estimated before its tree is built.
 */
#ifndef STRUT_PARSER_YAML_MEMORY_ESTIMATE_H
#define STRUT_PARSER_YAML_MEMORY_ESTIMATE_H

#include <stddef.h>

#include "engine/base/status.h"

/**
 * A lower estimate of the size of the text and its tree [B], from its brackets, colons and commas. A
 * colon in running text counts as a pair, which is negligible in texts large enough to matter.
 */
STRUT_API double strut_document_needs(const char *text, size_t length);

/**
 * STRUT_OK, or STRUT_NO_MEMORY with the needed and the available memory (memory_limit.h). Needed is what the tree
 * takes where rows are deferred (rows.h).
 */
STRUT_API strut_status strut_memory_check_document(const char *name, const char *text,
                                                   size_t length, strut_error *error);
/** STRUT_NO_MEMORY with the same message, for memory that ran out in spite of the check. */
STRUT_API strut_status strut_memory_fail_document(const char *name, const char *text, size_t length,
                                                  strut_error *error);

#endif

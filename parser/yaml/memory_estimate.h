/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Is there memory to read a text? Asked before its tree is begun.
 */
#ifndef STRUT_PARSER_YAML_MEMORY_ESTIMATE_H
#define STRUT_PARSER_YAML_MEMORY_ESTIMATE_H

#include <stddef.h>

#include "engine/base/status.h"

/**
 * What the text and its tree take at least [B], from one look at its brackets, colons and commas. A
 * colon in running text counts for a pair: not much in a text so large that it matters.
 */
STRUT_API double strut_document_needs(const char *text, size_t length);

/** STRUT_NO_MEMORY with what is needed and what there is (memory_limit.h), or STRUT_OK. */
STRUT_API strut_status strut_memory_check_document(const char *name, const char *text,
                                                   size_t length, strut_error *error);
/** STRUT_NO_MEMORY in the same words, where memory has run out all the same. */
STRUT_API strut_status strut_memory_fail_document(const char *name, const char *text, size_t length,
                                                  strut_error *error);

#endif

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

/** Finds what libyaml must not see: bad UTF-8, controls, directives. False with the messages. */
bool strut_document_scan(strut_diagnostics *diagnostics);

/**
 * Turns libyaml's error into one located message. `open` is the innermost bracketed list or mapping
 * that is open, or NULL. False: memory was out.
 */
bool strut_document_syntax_error(const yaml_parser_t *parser, const strut_tree *open,
                                 strut_diagnostics *diagnostics);

#endif

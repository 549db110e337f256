/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What the files of the document reader share; nobody else includes it. */
#pragma once

#include <stdbool.h>
#include <yaml.h>

#include "parser/language/yaml/document.h"

/** Reports what must not reach libyaml: bad UTF-8, control characters, directives. False if any. */
bool strut_document_scan(strut_diagnostics *diagnostics);

/**
 * Turns libyaml's error into one located message. `open` is the innermost bracketed list or mapping
 * that is open, or NULL. False: memory was out.
 */
bool strut_document_syntax_error(const yaml_parser_t *parser, const strut_tree *open,
                                 strut_diagnostics *diagnostics);

/** Reports keys that may not be, and takes them out of the map. False: memory is out. */
bool strut_document_check_keys(strut_tree *map, strut_diagnostics *diagnostics);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The keys of single sections as plain text for a terminal.
 */
#ifndef STRUT_PARSER_WRITE_KEYS_TEXT_H
#define STRUT_PARSER_WRITE_KEYS_TEXT_H

#include "engine/base/export.h"
#include "parser/language/keys.h"

/** A section in a block of strut_allocate (release it); NULL: no memory. */
STRUT_API char *strut_keys_text(strut_section section);

#endif

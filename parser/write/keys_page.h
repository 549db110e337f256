/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The reference page of the language, made from the table of keys.
 */
#ifndef STRUT_PARSER_WRITE_KEYS_PAGE_H
#define STRUT_PARSER_WRITE_KEYS_PAGE_H

#include "engine/base/export.h"

/** The page as Markdown in a block of strut_allocate (release it); NULL: no memory. */
STRUT_API char *strut_keys_page(void);

#endif

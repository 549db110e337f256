/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Keys of the language in words, for the reference page, the schema and the manual. Internal to parser/.
 */
#ifndef STRUT_PARSER_WRITE_KEY_TEXT_H
#define STRUT_PARSER_WRITE_KEY_TEXT_H

#include "parser/language/keys.h"
#include "parser/write/writer.h"

/** The text above the table of a section's keys, as Markdown. */
const char *strut_section_introduction(strut_section section);
/** Appends what a key's value is, as Markdown: "number [N/m], not negative". */
void strut_put_key_type(strut_writer *writer, const strut_key *key);
/** Is a default a sentence about a value, rather than a value? */
bool strut_default_is_described(const strut_key *key);
/**
 * Appends Markdown as plain text: `[text](link)` becomes its text; backticks are kept where `ticks`.
 */
void strut_put_without_links(strut_writer *writer, const char *markdown, bool ticks);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a YAML text must become: its tree in short, and its messages. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "parser/language/yaml/document.h"

/** What reading the text, called "t" in messages, returns. */
strut_status read_text(const char *text, strut_document *document, strut_diagnostics *diagnostics);
/** text[0..length) gives this tree (with places where asked) and these messages, else the test fails. */
void expect_of(const char *text, size_t length, bool places, const char *tree,
               const char *messages);
void expect_tree(const char *text, const char *tree);
void expect_places(const char *text, const char *tree);
/** Nothing but this "line:column: message". */
void expect_error(const char *text, const char *message);

/** The end of a text that grows. */
char *shown_end(char *out);
/** before, count times part, after; free it. */
char *repeat(const char *before, const char *part, size_t count, const char *after);

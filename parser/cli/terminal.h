/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the terminal can show.
 */
#ifndef STRUT_PARSER_CLI_TERMINAL_H
#define STRUT_PARSER_CLI_TERMINAL_H

#include <stdbool.h>

/** Whether the user's locale writes UTF-8. */
bool strut_terminal_unicode(void);
/** Columns of the terminal on that descriptor, else what COLUMNS says, else `usual`. */
int strut_terminal_columns(int descriptor, int usual);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A table of numbers and texts, from a file or the standard input. */
#ifndef STRUT_PARSER_PROGRAM_COMMAND_TABLE_FILE_H
#define STRUT_PARSER_PROGRAM_COMMAND_TABLE_FILE_H

#include "engine/output/record_files.h"
#include "parser/program/command/messages.h"

/**
 * Reads the file, "-" being the standard input. The listener hears messages, with line and column;
 * STRUT_BAD_SCENE where it is not a table. The table is freed by strut_arena_free(&table->arena).
 */
strut_status strut_table_read(const strut_listener *listener, const char *path, strut_table *table);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Reading a CSV table (RFC 4180) with a header such as "frequency [Hz],velocity [m/s],start".
 */
#ifndef STRUT_PARSER_PROGRAM_TABLE_FILE_H
#define STRUT_PARSER_PROGRAM_TABLE_FILE_H

#include "engine/base/status.h"
#include "engine/output/record_files.h"

/**
 * Reads the file, "-" being the standard input. Messages go to stderr with file, line and column;
 * STRUT_BAD_SCENE where it is not a table. The table is freed by strut_arena_free(&table->arena).
 */
strut_status strut_table_read(const char *path, strut_table *table);

#endif

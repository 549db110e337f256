/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Options that are numbers, with units where they have a dimension; and options that are words.
 */
#ifndef STRUT_PARSER_COMMAND_OPTION_VALUES_H
#define STRUT_PARSER_COMMAND_OPTION_VALUES_H

#include <stdint.h>

#include "parser/command/arguments.h"
#include "parser/expression/units.h"

/**
 * Reads an option such as --least-tension "5 N" into *value [SI], which keeps what it holds where the
 * option was not given. STRUT_USAGE; the listener hears why.
 */
strut_status strut_option_number(const strut_command *command, const strut_arguments *arguments,
                                 strut_option_id id, strut_dimension dimension, double *value);
/**
 * Reads up to `most` values with commas between, such as "0 s, 80 ms", into values. Returns how many,
 * or 0 where the text is something else.
 */
size_t strut_option_numbers(const char *text, strut_dimension dimension, double *values,
                            size_t most);
/** As strut_option_number, for whole numbers from low to high. */
strut_status strut_option_integer(const strut_command *command, const strut_arguments *arguments,
                                  strut_option_id id, int64_t low, int64_t high, int64_t *value);
/** As strut_option_number, for one of `words` (ended by NULL): its index into *value. */
strut_status strut_option_word(const strut_command *command, const strut_arguments *arguments,
                               strut_option_id id, const char *const *words, int *value);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Options that are numbers, with units where they have a dimension; and options that are words.
 */
#ifndef STRUT_PARSER_CLI_OPTION_VALUES_H
#define STRUT_PARSER_CLI_OPTION_VALUES_H

#include <stdint.h>

#include "parser/cli/options.h"
#include "parser/expression/units.h"

/**
 * Reads an option such as --least-tension "5 N" into *value [SI], which keeps what it holds where the
 * option was not given. STRUT_USAGE with the reason on stderr.
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

/** Where a figure goes, and how wide it is. path is NULL where none is asked for. */
typedef struct strut_plot {
  const char *path;
  double width; /* [pt] */
} strut_plot;

/** Rows for a command's table of options. */
#define STRUT_PLOT_OPTIONS                                                                         \
  {STRUT_OPTION_PLOT, "plot", "FILE", "draw a figure into FILE (.svg, .pdf or .png)"}, {           \
    STRUT_OPTION_WIDTH, "width", "WIDTH",                                                          \
        "width of the figure: page (180 mm, default), column (88 mm) or a "                        \
        "length such as 120 mm"                                                                    \
  }

/**
 * Reads both before anything is computed, and finds out whether FILE can be written: STRUT_USAGE or
 * STRUT_FILE_TROUBLE with the reason on stderr, --width without --plot included. Leaves no trace.
 * Where `usual` is 0 the usual width is a page's, else `usual` [pt].
 */
strut_status strut_plot_read(const strut_command *command, const strut_arguments *arguments,
                             double usual, strut_plot *plot);

#endif

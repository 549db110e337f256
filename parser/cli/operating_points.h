/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Operating points: parameters drawn at random, the same from the same seed.
 */
#ifndef STRUT_PARSER_CLI_OPERATING_POINTS_H
#define STRUT_PARSER_CLI_OPERATING_POINTS_H

#include <stdint.h>

#include "parser/cli/options.h"

/** Scenes of one model. Zero-initialise. */
typedef struct strut_operating_points {
  strut_setup *setups;      /* (count) */
  const strut_setup **list; /* (count) them */
  size_t count;
} strut_operating_points;

/**
 * Opens the model `count` times, each --vary NAME=LOW..HIGH drawn uniformly between the two, each
 * --vary NAME=WORD,WORD one of the words. Without --vary it is opened once, as it stands. Messages go
 * to stderr; on failure nothing is left to free.
 */
strut_status strut_operating_points_open(const strut_command *command,
                                         const strut_arguments *arguments, size_t count,
                                         uint64_t seed, strut_operating_points *points);
void strut_operating_points_free(strut_operating_points *points);

#endif

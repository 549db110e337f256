/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What `strut path --periodic` follows: a number under `parameters`, its range, and where branches start.
 */
#ifndef STRUT_PARSER_PROGRAM_COMMAND_FOLLOW_OPTIONS_H
#define STRUT_PARSER_PROGRAM_COMMAND_FOLLOW_OPTIONS_H

#include "engine/study/follow/follow_study.h"
#include "parser/program/command/varied_scenes.h"

enum { STRUT_FOLLOW_MOST_STARTS = 64 };

/** Scenes over the parameter, and the options that refer to them. Must not move. Zero-initialise. */
typedef struct strut_follow_source {
  strut_varied_scenes scenes;
  char from[1024]; /* names of configurations, each ended by NUL */
  strut_follow_start starts[STRUT_FOLLOW_MOST_STARTS];
} strut_follow_source;

/**
 * Reads --over, --and, --values, --at, --steps, --accuracy and --integrator for the scene as it was read.
 * STRUT_USAGE; the listener hears why. Free `source` in any case.
 */
strut_status strut_follow_options_read(const strut_arguments *arguments, const strut_scene *scene,
                                       strut_follow_source *source, strut_follow_options *wanted);
void strut_follow_source_free(strut_follow_source *source);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Options of a path, and what it follows: a load, a parameter of the scene, an actuator, a coordinate.
 */
#ifndef STRUT_PARSER_COMMAND_PATH_OPTIONS_H
#define STRUT_PARSER_COMMAND_PATH_OPTIONS_H

#include "engine/base/number_text.h"
#include "engine/statics/path/path.h"
#include "parser/command/varied_scenes.h"

/** Rows for a table of options. */
#define STRUT_PATH_OPTIONS                                                                         \
  {STRUT_OPTION_LOAD, "load", "NAME", "load to scale (default: all loads without a signal)"},      \
      {STRUT_OPTION_OVER, "over", "WHAT",                                                          \
       "vary a parameter, an actuator, or a displacement NODE.x or NODE.y"},                       \
      {STRUT_OPTION_FROM, "from", "VALUE", "start value: a load factor, or in the unit of WHAT"},  \
      {STRUT_OPTION_UNTIL, "until", "VALUE", "end value, likewise (default: load factor 1)"},      \
      {STRUT_OPTION_AT, "at", "NAME", "equilibrium to start from (default: that of the start)"}, { \
    STRUT_OPTION_STEPS, "steps", "N",                                                              \
        "maximum number of steps (default " STRUT_TEXT_OF(STRUT_PATH_USUAL_STEPS) ")"              \
  }

/** Reads --at and --steps. STRUT_USAGE; the listener hears why. */
strut_status strut_path_options_read(const strut_command *command, const strut_arguments *arguments,
                                     strut_path_options *wanted);
/**
 * Reads what is followed, and from where to where. As above; `scenes`, which make those over a parameter,
 * must stay in place while the path is followed. Free them in any case.
 */
strut_status strut_path_followed_read(const strut_command *command,
                                      const strut_arguments *arguments, const strut_scene *scene,
                                      strut_varied_scenes *scenes, strut_path_options *wanted);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Options of the commands of statics, and of paths. */
#ifndef STRUT_PARSER_COMMAND_STATICS_OPTIONS_H
#define STRUT_PARSER_COMMAND_STATICS_OPTIONS_H

#include "engine/base/number_text.h"
#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/form/form.h"
#include "engine/statics/modes/modes.h"
#include "engine/statics/path/path.h"
#include "parser/command/arguments.h"
#include "parser/command/varied_scenes.h"

/* Options of what is computed at rest: equilibria, modes, rigidity, form. */

/** Rows for tables of options. */
#define STRUT_EQUILIBRIA_OPTIONS                                                                   \
  {STRUT_OPTION_SUPPORTS, "supports", "NODES", "hold only these contact nodes, such as n1,n4"},    \
      {STRUT_OPTION_STARTS, "starts", "N",                                                         \
       "number of random starts per search (default automatic)"},                                  \
      {STRUT_OPTION_SEED, "seed", "S", "seed of the random starts (default as the scene says)"}, { \
    STRUT_OPTION_ALL, "all", NULL, "list every equilibrium, and the positions of those that stand" \
  }

#define STRUT_MODES_OPTIONS                                                                        \
  {STRUT_OPTION_AT, "at", "NAME",                                                                  \
   "equilibrium to linearise about (default: that of the start), or drawn"},                       \
      {STRUT_OPTION_COUNT, "count", "N", "number of modes, lowest first"}, {                       \
    STRUT_OPTION_STUCK, "stuck", NULL, "treat closed contacts as stuck instead of frictionless"    \
  }

#define STRUT_FORM_OPTIONS                                                                         \
  {STRUT_OPTION_FROM, "from", "WHAT",                                                              \
   "densities, lengths or prestress (default: by what the model gives)"},                          \
      {STRUT_OPTION_LEAST_TENSION, "least-tension", "FORCE",                                       \
       "lower bound on the tension of every cable"},                                               \
      {STRUT_OPTION_LEAST_DENSITY, "least-density", "DENSITY",                                     \
       "lower bound on the force density of every cable"},                                         \
  {                                                                                                \
    STRUT_OPTION_OBJECTIVE, "objective", "WHAT",                                                   \
        "which prestress: minimal largest (default), sum or squares"                               \
  }

#define STRUT_SHAPE_OPTIONS                                                                        \
  { STRUT_OPTION_AT, "at", "NAME", "the shape: drawn (default), start, or an equilibrium" }

/**
 * Each reads the options of its command; STRUT_USAGE or STRUT_NO_MEMORY, of which the listener hears. The nodes
 * of --supports are in the scene's arena; `seed` must stay as long as the options.
 */
strut_status strut_equilibria_options_read(const strut_command *command,
                                           const strut_arguments *arguments, strut_setup *setup,
                                           strut_equilibria_options *to, uint64_t *seed);
strut_status strut_modes_options_read(const strut_command *command,
                                      const strut_arguments *arguments, strut_modes_options *to);
strut_status strut_form_options_read(const strut_command *command, const strut_arguments *arguments,
                                     strut_form_options *wanted);

typedef struct strut_named_shape {
  const char *name; /* "drawn", or the value of --at */
  const double *q;  /* (length) positions [m], in the arena */
} strut_named_shape;

/** Finds the shape that --at names, by default the drawn one; errors as strut_rest_state_find. */
strut_status strut_named_shape_find(const strut_arguments *arguments, const strut_model *model,
                                    const strut_experiment *experiment, strut_arena *arena,
                                    strut_named_shape *shape, strut_error *error);

/* Options of a path, and what it follows: a load, a parameter of the scene, an actuator, a coordinate. */

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

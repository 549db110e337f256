/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Options of what is computed at rest: equilibria, modes, rigidity, form.
 */
#ifndef STRUT_PARSER_COMMAND_STATICS_OPTIONS_H
#define STRUT_PARSER_COMMAND_STATICS_OPTIONS_H

#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/form/form.h"
#include "engine/statics/modes/modes.h"
#include "parser/command/option_values.h"

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

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Commands and the options that they are called with, from the command line or by the library.
 */
#ifndef STRUT_PARSER_COMMAND_ARGUMENTS_H
#define STRUT_PARSER_COMMAND_ARGUMENTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/status.h"
#include "parser/command/messages.h"
#include "parser/expression/units.h"
#include "parser/read/read_scene.h"

/** Names an option; its value is the option's letter where it has one. */
typedef enum strut_option_id {
  STRUT_OPTION_END = 0,
  STRUT_OPTION_HELP = 'h',
  STRUT_OPTION_OUTPUT = 'o',
  STRUT_OPTION_QUIET = 'q',
  STRUT_OPTION_SET = 256, /* no letters from here on */
  STRUT_OPTION_JSON,
  STRUT_OPTION_FORCE,
  STRUT_OPTION_STUCK,
  STRUT_OPTION_WAVE,
  STRUT_OPTION_OWN_MODEL,
  STRUT_OPTION_ALL,
  STRUT_OPTION_CSV,
  STRUT_OPTION_NO_MOTION,
  STRUT_OPTION_NO_STATES,
  STRUT_OPTION_VARY,
  STRUT_OPTION_COUNT_POINTS,
  STRUT_OPTION_STATUS,
  STRUT_OPTION_RETRY,
  STRUT_OPTION_PARTS,    /* of exported scenes: the short one */
  STRUT_OPTION_STUDY,    /* of keys --schema: that of a study */
  STRUT_OPTION_BASINS,   /* of periodic motions */
  STRUT_OPTION_SELECTOR, /* only selects a form of the command */
  /* kept as text: strut_option_text, and arguments.h for numbers */
  STRUT_OPTION_TEXTS,
  STRUT_OPTION_AT = STRUT_OPTION_TEXTS,
  STRUT_OPTION_COUNT,
  STRUT_OPTION_SUPPORTS,
  STRUT_OPTION_STARTS,
  STRUT_OPTION_SEED,
  STRUT_OPTION_LOAD,
  STRUT_OPTION_OVER, /* the parameter of a path */
  STRUT_OPTION_UNTIL,
  STRUT_OPTION_STOP, /* of a path: the displacement at which it ends */
  STRUT_OPTION_STEPS,
  STRUT_OPTION_BRANCHES,
  STRUT_OPTION_FRICTION,
  STRUT_OPTION_FROM,
  STRUT_OPTION_GIVEN, /* of form: what determines it */
  STRUT_OPTION_LEAST_TENSION,
  STRUT_OPTION_LEAST_DENSITY,
  STRUT_OPTION_OBJECTIVE,
  STRUT_OPTION_PLOT,    /* FILE.svg|pdf|png: see plot_options.h */
  STRUT_OPTION_WIDTH,   /* of a figure: column, page or a length */
  STRUT_OPTION_DRAW,    /* which figure of a run */
  STRUT_OPTION_SCALE,   /* X,Y: how much motion is exaggerated */
  STRUT_OPTION_TIMES,   /* of snapshots */
  STRUT_OPTION_ANIMATE, /* FILE.mp4|gif|webm */
  STRUT_OPTION_SPEED,
  STRUT_OPTION_FPS,
  STRUT_OPTION_KIND, /* of a diagram from a table */
  STRUT_OPTION_X,
  STRUT_OPTION_Y,
  STRUT_OPTION_BY,
  STRUT_OPTION_PANELS,
  STRUT_OPTION_BAND,
  STRUT_OPTION_ONLY,
  STRUT_OPTION_DIFFERENCE,
  STRUT_OPTION_LABEL,
  STRUT_OPTION_DOUBT,
  STRUT_OPTION_TITLE,
  STRUT_OPTION_X_LABEL,
  STRUT_OPTION_Y_LABEL,
  STRUT_OPTION_X_LIMITS,
  STRUT_OPTION_Y_LIMITS,
  STRUT_OPTION_COLORS, /* of a map */
  STRUT_OPTION_ACCURACY,
  STRUT_OPTION_INTEGRATOR,
  STRUT_OPTION_STEP,
  STRUT_OPTION_TOLERANCE,
  STRUT_OPTION_STEADY,
  STRUT_OPTION_BARS,
  STRUT_OPTION_MASS_MODEL,
  STRUT_OPTION_FRICTION_LAW,
  STRUT_OPTION_DAMPING_LAW,
  STRUT_OPTION_LOG,
  STRUT_OPTION_EQUILIBRIA,
  STRUT_OPTION_MEASURE, /* of a tradeoff */
  STRUT_OPTION_STEP_SIZES,
  STRUT_OPTION_CPU_TIME,
  STRUT_OPTION_PERIODS,
  STRUT_OPTION_POINTS,
  STRUT_OPTION_BUDGET,
  STRUT_OPTION_THREADS,
  STRUT_OPTION_EMIT, /* a script for a cluster, and what it asks for: see sweep_emit.h */
  STRUT_OPTION_SHARDS,
  STRUT_OPTION_CPUS,
  STRUT_OPTION_TIME,
  STRUT_OPTION_MEMORY,
  STRUT_OPTION_SHARD,
  STRUT_OPTION_CHANNELS, /* of the library's run, and whether it records */
  STRUT_OPTION_RECORD,
  STRUT_OPTION_COMPUTE, /* of the library's sweep: what */
  STRUT_OPTION_LOWEST,
  STRUT_OPTION_LIMIT_EVALUATIONS,
  STRUT_OPTION_LIMIT_TIME,
  STRUT_OPTION_AND, /* of periodic motions: the second parameter, and where branches start */
  STRUT_OPTION_VALUES,
  STRUT_OPTION_TEXTS_END
} strut_option_id;

/** One row of a command's option table, which ends with STRUT_OPTION_END. */
typedef struct strut_option {
  strut_option_id id;
  const char *name;     /* without the two dashes */
  const char *argument; /* placeholder in the help; NULL: takes no argument */
  const char *help;
} strut_option;

/** The options of a call. Texts belong to who gave them. Zero-initialise. */
typedef struct strut_arguments {
  const char *model;   /* the first positional argument, or NULL */
  const char **models; /* (model_count) all positional arguments */
  size_t model_count;
  const char *output;
  bool help, json, quiet, force, stuck, wave, own_model, csv, no_motion, no_states;
  bool all, count_points, status, retry;
  bool no_notes; /* a model's notes have been printed */
  const char *texts[STRUT_OPTION_TEXTS_END - STRUT_OPTION_TEXTS]; /* NULL where not given */
  strut_override *overrides;                                      /* (override_count) of --set */
  size_t *override_model; /* (override_count) how many models stand before each */
  size_t override_count;
  strut_override *varied; /* (varied_count) of --vary */
  size_t varied_count;
  bool parts, study;
  const strut_listener *listener; /* hears what is wrong with an option, warnings and notes */
  bool basins;
} strut_arguments;

/** What a command computes of one model: analyses.h. */
typedef struct strut_analysis_kind strut_analysis_kind;

/** An option of other commands that a command has no use for, and why. */
typedef struct strut_refused_option {
  const char *name, *reason;
} strut_refused_option;

/** What a command does instead where an option is given. */
typedef struct strut_command_variant {
  const char *selector; /* the option's name; NULL ends a list of forms */
  const struct strut_command *command;
} strut_command_variant;

/** A command, or a form of one: how it is called, explained and run. */
typedef struct strut_command {
  const char *name;            /* of a form "COMMAND --SELECTOR" */
  const char *model;           /* its one argument, such as "MODEL", or NULL */
  bool model_optional, many;   /* many: one or more models */
  const char *summary;         /* half a sentence for the list of commands */
  const char *details;         /* lines for its own help; may be NULL */
  const strut_option *options; /* besides --quiet and --help, which every command has; or NULL */
  const strut_analysis_kind *analysis; /* what it computes and reports, where `run` is NULL */
  strut_status (*run)(const strut_arguments *arguments);
  bool timed;                          /* print the elapsed time below the report */
  const strut_command_variant *forms;  /* NULL: none */
  const strut_refused_option *refused; /* ended by a row of NULL; NULL: none */
} strut_command;

/** The value given for an option that is kept as text, or NULL. */
const char *strut_option_text(const strut_arguments *arguments, strut_option_id id);

/**
 * Sets an option of the command's table by name: "accuracy", "0.5 %". Options without value have "yes" or
 * "no". STRUT_USAGE where there is no such option, or no such value; the listener hears why.
 */
strut_status strut_argument_set(const strut_command *command, const char *name, const char *value,
                                strut_arguments *arguments);

/** Tells the listener "COMMAND: TEXT"; returns STRUT_USAGE. */
strut_status strut_usage_error(const strut_command *command, const strut_arguments *arguments,
                               const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Options that are numbers, with units where they have a dimension; and options that are words. */

/**
 * Reads an option such as --least-tension "5 N" into *value [SI], which keeps what it holds where the
 * option was not given. STRUT_USAGE; the listener hears why.
 */
strut_status strut_option_number(const strut_command *command, const strut_arguments *arguments,
                                 strut_option_id id, strut_dimension dimension, double *value);
/** As strut_option_number, for a value from low to high [SI]. */
strut_status strut_option_within(const strut_command *command, const strut_arguments *arguments,
                                 strut_option_id id, strut_dimension dimension, double low,
                                 double high, double *value);
/**
 * Reads up to `most` values with commas between, such as "0 s, 80 ms", into values. Returns how many,
 * or 0 where the text is something else.
 */
size_t strut_option_numbers(const char *text, strut_dimension dimension, double *values,
                            size_t most);
/** The parts of "NAME=LOW..HIGH" within an option's text, or of "NAME" alone. */
typedef struct strut_range_text {
  const char *name, *low,
      *high; /* low, high: NULL without a range; `high` goes to the text's end */
  size_t name_length, low_length;
} strut_range_text;
/** False where the text is neither, or a part of it is empty. */
bool strut_range_text_split(const char *text, strut_range_text *range);
/** As strut_option_number, for whole numbers from low to high. */
strut_status strut_option_integer(const strut_command *command, const strut_arguments *arguments,
                                  strut_option_id id, int64_t low, int64_t high, int64_t *value);
/** As strut_option_number, for one of `words` (ended by NULL): its index into *value. */
strut_status strut_option_word(const strut_command *command, const strut_arguments *arguments,
                               strut_option_id id, const char *const *words, int *value);

#endif

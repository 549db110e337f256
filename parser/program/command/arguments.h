/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Commands and the options that they are called with, from the command line or by the library. */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/status.h"
#include "engine/scene/study.h"
#include "parser/language/keys/keys.h"
#include "parser/language/read/read_scene.h"

/* Messages of a call to a listener: the program prints them, the library collects them. */

typedef enum strut_message_kind {
  STRUT_MESSAGE_USAGE,   /* an option is wrong */
  STRUT_MESSAGE_ERROR,   /* a computation failed */
  STRUT_MESSAGE_WARNING, /* a result exists but may not be what was meant */
  STRUT_MESSAGE_NOTE,    /* an outdated word */
  STRUT_MESSAGE_REMARK,  /* how something was done */
  STRUT_MESSAGE_LINES    /* of any length, with their ends: located errors or notes */
} strut_message_kind;

/** Longest message, its NUL included. */
enum { STRUT_MESSAGE_MOST = 900 };

typedef struct strut_listener {
  void *context;
  /** One sentence without a full stop. `command`: the command that it is about, or NULL. */
  void (*hear)(void *context, strut_message_kind kind, const char *command, const char *text);
} strut_listener;

/** Tells a message of at most STRUT_MESSAGE_MOST bytes. NULL: no one listens. */
void strut_tell(const strut_listener *listener, strut_message_kind kind, const char *command,
                const char *format, ...) __attribute__((format(printf, 4, 5)));

/** Tells the error, or out of memory, unless `status` is STRUT_OK; returns `status`. */
strut_status strut_tell_failure(const strut_listener *listener, strut_status status,
                                const strut_error *error);
/** Tells lines; NULL: memory is out, which is told and returned. */
strut_status strut_tell_lines(const strut_listener *listener, const char *lines);

/** A number, a whole number, one of several words, or some of them that an option gives. Zero-initialise. */
typedef struct strut_given_number {
  const char *text; /* as it was given; NULL: it was not */
  double value;     /* [SI] */
} strut_given_number;
typedef struct strut_given_whole {
  const char *text;
  int64_t value;
} strut_given_whole;
typedef struct strut_given_word {
  const char *text;
  int index;
} strut_given_word;
typedef struct strut_given_range { /* NAME=LOW..HIGH, or NAME alone */
  const char *text;
  char name[128], low[128]; /* copies */
  const char *high;         /* NULL: no range */
} strut_given_range;
typedef struct strut_given_words {
  const char *text; /* with commas between */
  uint64_t set;     /* a bit for each */
} strut_given_words;

/**
 * The options of a call, each as its row of an option table reads it: one that was not given is false, NULL or has no
 * text. Texts belong to who gave them. Zero-initialise.
 */
typedef struct strut_arguments {
  const struct strut_command *command;
  const strut_listener *listener; /* hears what is wrong with an option, warnings and notes */
  const char *model;              /* the first positional argument, or NULL */
  const char **models;            /* (model_count) all positional arguments */
  size_t model_count;
  strut_setting *overrides; /* (override_count) of --set */
  size_t *override_model;   /* (override_count) how many models stand before each */
  size_t override_count;
  strut_setting *varied; /* (varied_count) of --vary */
  size_t varied_count;
  bool no_notes; /* a model's notes have been printed */

  bool help, json, csv, quiet, all, force, stuck, wave, basins, own_model, no_motion, no_states;
  bool count_points, plan, status, retry, parts, study;
  const char *output, *plot, *animate, *width, *title, *scale, *times;
  const char *at, *supports, *load, *from, *until, *stop, *values;
  const char *shard, *time, *memory;
  const char *labels;
  strut_study_figure drawn; /* of a table */
  bool svg_text;
  const char *x_label, *y_label, *x_limits, *y_limits;
  strut_given_word integrator, bars, mass_model, friction_law, damping_law, friction, given;
  strut_given_word objective, draw, kind, colors, log, equilibria, measure, emit, record, compute;
  strut_given_word format;
  strut_given_words channels;
  strut_given_range over, and_over;
  strut_given_number accuracy, budget, step, tolerance, steady, speed, fps, periods, cpu_time, mass;
  strut_given_number least_tension, least_density, limit_time;
  strut_given_whole count, starts, seed, steps, branches, points, step_sizes, threads, shards, cpus;
  strut_given_whole lowest, limit_evaluations;
} strut_arguments;

/** How an option is read; that of a row follows from the type of the member that it fills. */
typedef enum strut_option_kind {
  STRUT_OPTION_SELECTOR, /* only selects a form of the command */
  STRUT_OPTION_FLAG,
  STRUT_OPTION_SETTING, /* NAME=VALUE, and again */
  STRUT_OPTION_TEXT,
  STRUT_OPTION_NUMBER,
  STRUT_OPTION_WHOLE,
  STRUT_OPTION_WORD,
  STRUT_OPTION_WORDS,
  STRUT_OPTION_RANGE
} strut_option_kind;

/** One row of an option table, which ends with a row without name. */
typedef struct strut_option {
  strut_option_kind kind;
  size_t member;        /* of strut_arguments; there a text is first, but of flags and settings */
  const char *name;     /* without the two dashes */
  const char *argument; /* placeholder in the help; NULL: takes no argument */
  const char *help;
  char letter;                      /* or 0 */
  bool of_figure;                   /* needs --plot */
  strut_measure measure;            /* of a number */
  strut_key_limits limits;          /* of a number [SI] */
  double low, high;                 /* its ends, too; both 0: any */
  const char *expected;             /* of a range, what messages say */
  int64_t least, most;              /* range of a whole number */
  const char *words;                /* "bar|cable": one of them; of a text, what completes it */
  int key;                          /* of the language, whose words they are; 0: none */
  const struct strut_option *table; /* instead of all this: the rows of another table */
} strut_option;

/** The beginning of a row: the member of strut_arguments that it fills. */
#define STRUT_FILLS(MEMBER)                                                                        \
  .kind = _Generic(((strut_arguments *)0)->MEMBER,                       \
                   bool: STRUT_OPTION_FLAG,                              \
                   strut_setting *: STRUT_OPTION_SETTING,               \
                   const char *: STRUT_OPTION_TEXT,                      \
                   strut_given_number: STRUT_OPTION_NUMBER,              \
                   strut_given_whole: STRUT_OPTION_WHOLE,                \
                   strut_given_word: STRUT_OPTION_WORD, \
                   strut_given_words: STRUT_OPTION_WORDS, \
                   strut_given_range: STRUT_OPTION_RANGE),                 \
  .member = offsetof(strut_arguments, MEMBER)
/** The same for a member of which only the text is read. */
#define STRUT_FILLS_TEXT(MEMBER)                                                                   \
  .kind = STRUT_OPTION_TEXT, .member = offsetof(strut_arguments, MEMBER.text)

/** What a command computes of one model: analyses.h. */
typedef struct strut_analysis_kind strut_analysis_kind;
struct strut_analysis;

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
  /** Opens what it computes, *text becoming the model's; NULL: a model for statics. */
  strut_status (*open)(struct strut_analysis *analysis, char **text);
  /** Instead of writing and printing what the kind says; may be NULL. */
  strut_status (*report)(const struct strut_analysis *analysis, const strut_arguments *arguments,
                         strut_error *error);
  strut_status (*run)(const strut_arguments *arguments);
  bool timed;                          /* print the elapsed time below the report */
  const strut_command_variant *forms;  /* NULL: none */
  const strut_refused_option *refused; /* ended by a row of NULL; NULL: none */
} strut_command;

/* Ranges of numbers. */
#define STRUT_ABOVE_ZERO .limits = STRUT_LIMITS_ABOVE_ZERO
#define STRUT_ACCURACY_RANGE .limits = STRUT_LIMITS_SHARE(STRUT_MOST_ACCURACY)

/** The i-th row of a table (or NULL), those of its tables included; NULL after the last. */
const strut_option *strut_option_row(const strut_option *table, size_t i);
/** The text given for the option of a row; NULL where it was not, and of flags and settings. */
const char *strut_given_text(const strut_option *option, const strut_arguments *arguments);

/** Reads the value given for an option other than a setting. STRUT_USAGE; the listener hears why. */
strut_status strut_argument_read(const strut_option *option, const char *text,
                                 strut_arguments *arguments);
/**
 * Sets an option of the command's table by name: "accuracy", "0.5 %". Options without value have "yes" or
 * "no". STRUT_USAGE where there is no such option, or no such value; the listener hears why.
 */
strut_status strut_argument_set(const char *name, const char *value, strut_arguments *arguments);
/** The words that an option takes, "bar|cable"; NULL: any, or none. */
const char *strut_option_words(const strut_option *option);
/** The i-th word of an option, copied into buffer; NULL after the last. */
const char *strut_option_word(const strut_option *option, int i, char *buffer, size_t size);

/** Tells the listener "COMMAND: TEXT"; returns STRUT_USAGE. */
strut_status strut_usage_error(const strut_arguments *arguments, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/** The value [SI] of --NAME where its dimension is known only now; *value stays where text is NULL. As above. */
strut_status strut_quantity_read(const strut_arguments *arguments, const char *name,
                                 const char *text, strut_dimension dimension, double *value);
/**
 * Reads up to `most` values with commas between, such as "0 s, 80 ms", into values. Returns how many,
 * or 0 where the text is something else.
 */
size_t strut_quantities_read(const char *text, strut_dimension dimension, double *values,
                             size_t most);

/** The language as a JSON Schema, for editors: of a scene or a study. A block of strut_allocate, or NULL. */
char *strut_schema_write(bool study);

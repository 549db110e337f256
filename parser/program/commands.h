/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What commands (in files command_*.c) share: their table, the command line, standard streams, opening models. */
#pragma once

#include <signal.h>

#include "engine/base/flag.h"
#include "engine/model/model.h"
#include "engine/output/trajectory.h"
#include "engine/scene/value_rows.h"
#include "parser/program/command/scene_options.h"

/** Commands in the order of the help: a new one is a row here and a file. */
#define STRUT_COMMAND_TABLE(COMMAND)                                                               \
  COMMAND(run, "Simulate")                                                                         \
  COMMAND(sweep, "Simulate")                                                                       \
  COMMAND(compare, "Simulate")                                                                     \
  COMMAND(tradeoff, "Simulate")                                                                    \
  COMMAND(equilibria, "Analyse equilibria")                                                        \
  COMMAND(path, "Analyse equilibria")                                                              \
  COMMAND(modes, "Analyse equilibria")                                                             \
  COMMAND(rigidity, "Analyse equilibria")                                                          \
  COMMAND(form, "Analyse equilibria")                                                              \
  COMMAND(check, "Inspect, draw and convert")                                                      \
  COMMAND(view, "Inspect, draw and convert")                                                       \
  COMMAND(plot, "Inspect, draw and convert")                                                       \
  COMMAND(export, "Inspect, draw and convert")                                                     \
  COMMAND(examples, "Learn")                                                                       \
  COMMAND(keys, "Learn")                                                                           \
  COMMAND(help, "Learn")
#define STRUT_COMMAND_DECLARED(name, group) extern const strut_command strut_command_##name;
STRUT_COMMAND_TABLE(STRUT_COMMAND_DECLARED)
/* Forms of commands. */
extern const strut_command strut_command_merge, strut_command_periodic, strut_command_schema;

/** The command of that name, or NULL. */
const strut_command *strut_command_named(const char *name);
/** The same, with the reason and a suggestion on stderr. */
const strut_command *strut_command_find(const char *name);

/** Is it the name of a section or a key of the language, which `strut keys` explains? */
bool strut_keys_know(const char *name);

/** Calls `each` with FOLDER/NAME.yaml of every model that comes with strut, in order. */
void strut_examples_list(void (*each)(void *context, const char *model), void *context);

/** Width of what is printed. */
int strut_report_width(const strut_arguments *arguments);
/** Prints a result as JSON where that is wanted, or else as text unless --quiet suppresses it. */
strut_status strut_print_values(const strut_arguments *arguments, const strut_value_rows *rows,
                                const void *result, const struct strut_scene *scene);

/**
 * Runs a command by its analysis: finds out whether all results can be written, opens and compiles the model,
 * computes, writes, prints and draws. Messages go to stderr.
 */
strut_status strut_analysis_run(const strut_arguments *arguments);

/** Prints the words that complete the last of `words` (count >= 0), which may be empty. */
strut_status strut_complete(int count, char **words);

/*
 * The command line: one table of options per command defines both its parsing and the help text. Abbreviated option
 * names are rejected: accepting one today could make a new option ambiguous.
 */

/** Parses argv[1..] of a command. STRUT_USAGE with the reason on stderr. */
strut_status strut_arguments_read(const strut_command *command, int argc, char **argv,
                                  strut_arguments *arguments);
void strut_arguments_free(strut_arguments *arguments);

/** The i-th option of a command, those of every command last; NULL after them. */
const strut_option *strut_option_at(const strut_command *command, size_t i);

/** The option that "--NAME", "--NAME=VALUE" or "-LETTER" is, and in *value what follows the name; NULL: none. */
const strut_option *strut_option_of(const strut_command *command, char *word, char **value);

/** The form of the command that one of its arguments words[0..count) selects, or the command itself. */
const strut_command *strut_command_variant_of(const strut_command *command, int count,
                                              char **words);

/** Prints the help of a command on stdout. */
void strut_command_explain(const strut_command *command);

/* Rows that tables of several commands have. */

#define STRUT_SET_OPTION                                                                           \
  { STRUT_FILLS(overrides), "set", "NAME=VALUE", "change a parameter; may be repeated" }
#define STRUT_PRINT_OPTIONS                                                                        \
  {STRUT_FILLS(json), "json", NULL, "print everything as one JSON object"}, {                      \
    STRUT_FILLS(format), "format", "FORMAT", "print tables as text (default) or latex",            \
        .words = "text|latex"                                                                      \
  }
#define STRUT_THREADS_OPTION                                                                       \
  {                                                                                                \
    STRUT_FILLS(threads), "threads", "N",                                                          \
        "maximum number of threads (default: one per processor)", .least = 1, .most = 4096         \
  }
#define STRUT_OUTPUT_OPTION(ARGUMENT, HELP)                                                        \
  { STRUT_FILLS(output), "output", ARGUMENT, HELP, .letter = 'o' }
/** The figure of a command: its file, width and title. */
extern const strut_option strut_plot_options[];

/**
 * Reads all before anything is computed, and checks that FILE can be written: STRUT_USAGE or
 * STRUT_FILE_TROUBLE with the reason on stderr, an option without --plot included. Leaves no trace.
 * `usual` is the default width [pt]; 0: a page's.
 */
strut_status strut_plot_read(const strut_arguments *arguments, double usual, strut_plot *plot);

/* Standard streams: reports on stdout, messages on stderr, and whether all of it was written. */

/**
 * Opens /dev/null for standard streams that are closed, so that no file of results gets their place. Hidden
 * characters of names (strut_text_hidden) appear on stderr, and on stdout where that is a terminal, as "\u202E".
 */
void strut_streams_open(void);
/**
 * Flushes stdout and returns the program's exit code: that of `status`, or of file trouble instead of
 * 0 where not everything could be written, with a message on stderr.
 */
int strut_streams_close(strut_status status);
/** Prints a text on stdout; a failure is reported on stderr and returned as STRUT_FILE_TROUBLE. */
strut_status strut_print(const char *text);
/** Prints a block of strut_allocate and releases it; NULL is reported as out of memory. */
strut_status strut_print_block(char *text);
/** As strut_print_block, but --quiet suppresses the text unless it is JSON or CSV. */
strut_status strut_print_report(const strut_arguments *arguments, char *text);
/** Prints a sentence on stderr as the program's error. */
void strut_print_error(const strut_error *error);
/** Prints the error unless `status` is STRUT_OK; returns `status`. */
strut_status strut_print_failure(strut_status status, const strut_error *error);
/** Reports on stderr that memory is out; returns STRUT_NO_MEMORY. */
strut_status strut_print_out_of_memory(void);

/** Prints every message on stderr. */
const strut_listener *strut_stderr_listener(void);

/** From now on SIGINT and SIGTERM set the flag that is returned; a moment later they kill. */
const strut_flag *strut_interrupt_watch(void);

/*
 * A progress bar on a terminal: one line with the share done and the time left. Work in several parts
 * shows the current part in words with its share and the time spent, as the number of parts is unknown.
 */

/** Columns of the terminal on that descriptor, else the value of COLUMNS, else `usual`. */
int strut_terminal_columns(int descriptor, int usual);

typedef struct strut_progress {
  bool wanted;            /* stderr is a terminal, and --quiet is not given */
  bool colour;            /* the terminal knows escape sequences and NO_COLOR is not set */
  bool shown;             /* there is a bar to erase */
  const char *phase;      /* part of the work that the bar shows, in words; NULL: the whole */
  double run_start, last; /* of the phase's present run: clock [s] and the last fraction */
  double start;           /* [s] of the monotonic clock */
  double span;            /* simulated time of the whole [s]; 0: not shown */
  int columns;            /* of the terminal */
} strut_progress;

strut_progress strut_progress_begin(bool quiet);
/** Draws; `context` is the strut_progress, fraction 0 to 1. */
void strut_progress_show(void *context, double fraction);
/** Starts another part of the work: `context` is the strut_progress, `name` a constant text. */
void strut_progress_phase(void *context, const char *name);
/** Writes a bar of `width` columns into width + 1 bytes. */
void strut_progress_bar(char *bar, int width, double fraction);
/** Erases the bar. */
void strut_progress_end(strut_progress *progress);

/* What every command with a MODEL begins with: the scene, or all that is wrong with it. */

/** Purpose of opening a scene. */
typedef enum strut_open_purpose {
  STRUT_OPEN_FOR_RUN,    /* for a run; a start equilibrium is resolved into start positions */
  STRUT_OPEN_AS_RUN,     /* as above if the file describes a run, else for statics */
  STRUT_OPEN_FOR_ANY,    /* as STRUT_OPEN_AS_RUN, but a start equilibrium stays unresolved */
  STRUT_OPEN_FOR_STATICS /* likewise; a run needs no step */
} strut_open_purpose;

/** The text of an opened scene, and what was found. Zero-initialise; strut_open_report_free releases it. */
typedef struct strut_open_report {
  bool prints; /* print what is found; only the text is kept then, NULL after a failure */
  strut_diagnostics diagnostics; /* of the text below */
  char *text;
  size_t length;
  strut_error error; /* what has no place; empty message: nothing */
} strut_open_report;

/**
 * Reads the model that the arguments name. Where `report` is NULL or prints, messages go to stderr; those about the
 * file always do. strut_setup_free frees the setup.
 */
strut_status strut_open_model(const strut_arguments *arguments, strut_open_purpose purpose,
                              strut_setup *setup, strut_open_report *report);
void strut_open_report_free(strut_open_report *report);
/** Prints messages, and the notes unless they are printed already; on failure nothing is left of the setup. */
strut_status strut_print_found(strut_diagnostics *diagnostics, strut_status status, bool noted,
                               strut_setup *setup);

/**
 * The scene as short as the file gave it, see strut_short_write; `text` is the file's, `before` the scene
 * as it was read. *result is NULL, which stderr tells, where only the flat scene can be written; and
 * where the file has no parameters, groups or parts, unless `all` are wanted.
 */
strut_status strut_write_short(const strut_arguments *arguments, const char *text, size_t length,
                               const char *before, const strut_setup *setup, bool all,
                               char **result);

/** The model's name in messages. */
const char *strut_model_name(const strut_arguments *arguments);

/** Prints the warnings of a valid scene on stderr: see strut_setup_warn. */
strut_status strut_warn_of_scene(const strut_setup *setup);

/**
 * Finds out, before anything is computed, whether files of these names (NULL after the last) can go
 * where -o wants them; leaves no trace.
 */
strut_status strut_check_output_writable(const strut_arguments *arguments,
                                         const char *const *names);
/** As above for one file; does nothing for NULL. */
strut_status strut_try_file(const char *path);

/** Must not move in memory: the model refers to the scene. Zero-initialise. */
typedef struct strut_opened {
  bool run; /* the argument was a directory that `strut run -o` made */
  strut_setup setup;
  strut_model *model;
  strut_trajectory motion; /* of a run: positions of one frame or more */
  char *summary;           /* of a run: the text of its summary.json, or NULL */
} strut_opened;

/**
 * Opens what the command's argument names. A directory is a run: its scene.yaml is read, and as
 * many frames of its trajectory.h5 as fit into `room` doubles; --set is refused then. Anything else is a
 * model, opened STRUT_OPEN_AS_RUN. Messages go to stderr; on failure nothing is left to free.
 */
strut_status strut_open_run(const strut_arguments *arguments, size_t room, strut_opened *opened);
/** A zeroed struct is allowed. */
void strut_opened_free(strut_opened *opened);

/* What is installed with the program: found from where the program is, so that all may be moved. */

enum { STRUT_LONGEST_PATH = 4096 };

/**
 * The path of `name` below share/strut, or of `built` beside a program that is not installed; false where
 * neither exists.
 */
bool strut_find_installed(const char *name, const char *built, char path[STRUT_LONGEST_PATH]);

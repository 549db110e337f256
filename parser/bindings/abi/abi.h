/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * strut as a shared library with a stable binary interface: libstrut.so.0, installed as strut/abi.h.
 *
 * Every call does what the program's command of that name does, with the same names, checks, messages and bits. Handles
 * are opaque; what they show are texts, numbers by dotted name, and arrays of doubles with shape and stride. Programs
 * that were built against this header run with every later libstrut.so.0.
 *
 * Names: of things as in the scene's file, of results as in the program's JSON, of recorded channels as in the scene's
 * `output`. Numbers are in SI units and radians. Settings and options are pairs of texts: "frequency", "10 Hz", as in
 * `--set frequency="10 Hz"`; a number without unit is in SI units.
 *
 * NULL: an argument must not be NULL unless its function says that it may, or releases it. A call that can fail then
 * does, with STRUTLIB_USAGE; any other answers as if there were nothing: NULL, 0, -1 or NAN.
 *
 * Errors: the last argument of a call that can fail is `strutlib_error **error`. NULL: the caller does not want to
 * know. Otherwise *error becomes NULL on success, and on failure an error to be released by strutlib_error_free. Lack
 * of memory is such an error; no call aborts, exits, prints, or sets a locale, a signal handler or an error handler.
 *
 * Texts: a `const char *` belongs to its handle and lives as long. A `char *` belongs to the caller, who releases it by
 * strutlib_release. All are UTF-8, and NULL-terminated.
 *
 * Arrays: `data` points at doubles owned by the handle; element (i, j, k) of an array is
 * data[i * stride[0] + j * stride[1] + k * stride[2]], strides counted in doubles. `shape` and `stride` have room for
 * STRUTLIB_DIMENSIONS. A pointer is good until the handle is released. Values that do not exist are NAN. Arrays of
 * scenes and results never change; those of a simulation are live.
 *
 * Threads: scenes and results are constant, and any number of threads may use one at the same time. A simulation
 * belongs to one thread at a time. Sweeps and searches for equilibria use OpenMP inside; after fork() without exec the
 * child must not start them. While a call computes, GSL's error handler is off; the host's is put back. Figures and
 * sweeps use a temporary folder below TMPDIR or /tmp, which is gone when the call returns; figures are drawn by Pango
 * and GLib, which abort where memory is out.
 */
#ifndef STRUT_PARSER_BINDINGS_ABI_ABI_H
#define STRUT_PARSER_BINDINGS_ABI_ABI_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define STRUTLIB_API __attribute__((visibility("default")))
#else
#define STRUTLIB_API
#endif

/** Most dimensions of an array. */
#define STRUTLIB_DIMENSIONS 4

/**
 * Status of a call or a result. The numbers are part of the interface; the program's exit code is strutlib_exit_code.
 */
#define STRUTLIB_OK 0
#define STRUTLIB_USAGE 1          /* wrong use of a function: an unknown option, a bad value */
#define STRUTLIB_BAD_SCENE 2      /* the scene is not valid: see the located messages */
#define STRUTLIB_DIVERGED 3       /* a run; its result is there up to that time */
#define STRUTLIB_STEP_TOO_LARGE 4 /* the step is above the stability limit */
#define STRUTLIB_NOT_SETTLED 5    /* the structure did not come to rest */
#define STRUTLIB_SINGULAR 6       /* a matrix is singular */
#define STRUTLIB_WORK_LIMIT 7     /* the work allowed was used up */
#define STRUTLIB_FILE_TROUBLE 8   /* a file could not be read or written */
#define STRUTLIB_NO_MEMORY 9      /* memory is out */
#define STRUTLIB_INTERRUPTED 10   /* by strutlib_interrupt; partial results are returned */
#define STRUTLIB_INACCURATE 11    /* of studies: less accurate than wanted, or not identified */

/** A scene as it was opened, with its settings: constant. */
typedef struct strutlib_scene strutlib_scene;
/** What a call computed: constant. It does not need its scene to stay open. */
typedef struct strutlib_result strutlib_result;
/** A run that is advanced from outside. It does not need its scene to stay open. */
typedef struct strutlib_simulation strutlib_simulation;
/** A stored state of a simulation. */
typedef struct strutlib_snapshot strutlib_snapshot;
/** Why a call failed. */
typedef struct strutlib_error strutlib_error;
/** By which other threads and signal handlers see and stop calls under way. */
typedef struct strutlib_control strutlib_control;

/* ---- versions, texts, codes ---- */

/** Counts additions to this interface: a program that needs a function may ask whether it is there. */
#define STRUTLIB_ABI_VERSION 4
/** STRUTLIB_ABI_VERSION of the library that is loaded. */
STRUTLIB_API int strutlib_abi_version(void);
/** Version of the program that the library belongs to, such as "0.1.0". */
STRUTLIB_API const char *strutlib_version(void);
/** The language as a JSON Schema, as `strut keys --schema` prints it; with `study` other than 0 that of studies. */
STRUTLIB_API char *strutlib_schema(int study, strutlib_error **error);
/**
 * Any YAML text as JSON with places: [line, column, value, ...] of a scalar with its text, of a list or a mapping with
 * a list of such values, those of a mapping alternately keys and values, with true behind them. `name` stands for
 * the file in messages.
 */
STRUTLIB_API char *strutlib_yaml_places(const char *name, const char *text, strutlib_error **error);
/** Releases a text that belongs to the caller. */
STRUTLIB_API void strutlib_release(char *text);
/** A status as a word: "ok", "usage", "bad_scene", "diverged", ... Never NULL. */
STRUTLIB_API const char *strutlib_status_name(int status);
/** A status as a few words, such as "the scene is not valid". Never NULL. */
STRUTLIB_API const char *strutlib_status_text(int status);
/** The program's exit code for a status: 0, 1, 2, 3, 4, 5 or 130. */
STRUTLIB_API int strutlib_exit_code(int status);

/* ---- errors ---- */

/** The status that is not STRUTLIB_OK. */
STRUTLIB_API int strutlib_error_status(const strutlib_error *error);
/**
 * One sentence: what failed, where, and what to do. Of a scene with several located messages the
 * first, with its place: "arm.yaml:12:9: ...".
 */
STRUTLIB_API const char *strutlib_error_message(const strutlib_error *error);
/** Everything there is to say, as the program shows it: lines with carets, all messages. Ends with a newline. */
STRUTLIB_API const char *strutlib_error_report(const strutlib_error *error);
/** Number of located messages; they are sorted by place. 0 for an error without a place in a text. */
STRUTLIB_API size_t strutlib_error_count(const strutlib_error *error);
/** Text of located message i, without its place; NULL beyond the last. */
STRUTLIB_API const char *strutlib_error_text(const strutlib_error *error, size_t i);
/** Its file, or the name that strutlib_open_text was given. */
STRUTLIB_API const char *strutlib_error_file(const strutlib_error *error, size_t i);
/** Its line, counted from 1; 0: the file as a whole, or a setting. */
STRUTLIB_API size_t strutlib_error_line(const strutlib_error *error, size_t i);
/** Its column, counted from 1 in code points. */
STRUTLIB_API size_t strutlib_error_column(const strutlib_error *error, size_t i);
/** Length of what is wrong, in code points of that line. */
STRUTLIB_API size_t strutlib_error_length(const strutlib_error *error, size_t i);
/** The line's text, without its end; "" where there is no line. */
STRUTLIB_API const char *strutlib_error_source(const strutlib_error *error, size_t i);
/** The word that was probably meant ("did you mean ..."), or NULL. */
STRUTLIB_API const char *strutlib_error_hint(const strutlib_error *error, size_t i);
/**
 * The scene's key at that place, dotted, such as "nodes.n3.mass"; "" where there is none. For
 * scenes that were made from dictionaries rather than written by hand.
 */
STRUTLIB_API const char *strutlib_error_key(const strutlib_error *error, size_t i);
STRUTLIB_API void strutlib_error_free(strutlib_error *error);

/* ---- control: progress and interrupts ---- */

/**
 * Called a few times a second, `fraction` from 0 to 1: by a run from the thread that made the
 * call, by a sweep from one thread at a time. Non-zero interrupts.
 */
typedef int (*strutlib_progress)(void *context, double fraction);

/** A control that is not interrupted. NULL: memory is out. It may serve any number of calls and threads. */
STRUTLIB_API strutlib_control *strutlib_control_create(void);
/** No call may be using it. */
STRUTLIB_API void strutlib_control_free(strutlib_control *control);
/**
 * Ends runs, sweeps, searches for equilibria and simulations with this control within 0.2 s, and calls that are made
 * later at once, until strutlib_control_reset: they return what they have, with STRUTLIB_INTERRUPTED. Other calls end
 * by themselves soon, or when a structure of thousands of nodes is done. From any thread and from signal handlers.
 */
STRUTLIB_API void strutlib_interrupt(strutlib_control *control);
/** Takes an interrupt back. */
STRUTLIB_API void strutlib_control_reset(strutlib_control *control);
/** Was it interrupted? */
STRUTLIB_API int strutlib_control_interrupted(const strutlib_control *control);
/** Sets a function for calls that tell their progress: strutlib_run, strutlib_sweep, strutlib_study. NULL: none. */
STRUTLIB_API void strutlib_control_on_progress(strutlib_control *control,
                                               strutlib_progress progress, void *context);

/* ---- scenes ---- */

/**
 * Opens a scene's file with `count` settings of parameters, names[i] = values[i], as --set has
 * them. NULL with the error.
 */
STRUTLIB_API strutlib_scene *strutlib_open(const char *path, size_t count, const char *const *names,
                                           const char *const *values, strutlib_error **error);
/**
 * The same of a text[0..length) in the scene's language or in JSON, which is a part of it. `name`
 * stands for the file in messages, and files that the text names are looked for beside it.
 */
STRUTLIB_API strutlib_scene *strutlib_open_text(const char *name, const char *text, size_t length,
                                                size_t count, const char *const *names,
                                                const char *const *values, strutlib_error **error);
/** The same scene with further settings, without reading its text again: cheap. Those made before stay. */
STRUTLIB_API strutlib_scene *strutlib_scene_with(const strutlib_scene *scene, size_t count,
                                                 const char *const *names,
                                                 const char *const *values, strutlib_error **error);
/** Releases a scene; results and simulations made of it stay. */
STRUTLIB_API void strutlib_close(strutlib_scene *scene);

/**
 * Names of the things of a kind, which is a key of the scene: "parameters", "nodes", "members", "hinges", "cells",
 * "contacts", "collisions", "actuators", "loads", "sensors", "states", "configurations", "quantities", "grounds",
 * "unbalances" or "sliders"; or "channels": those that the scene records; "energies": the components of the channel
 * "energy"; "kinds": all these words; or a channel: what its array counts behind the samples, such as the nodes and
 * "total" of "angular_momentum". How many there are; 0 for any other word.
 */
STRUTLIB_API size_t strutlib_name_count(const strutlib_scene *scene, const char *kind);
/** The i-th of these names, NULL beyond the last. The order is that of every array over the kind. */
STRUTLIB_API const char *strutlib_name(const strutlib_scene *scene, const char *kind, size_t i);
/** Its index, or -1. */
STRUTLIB_API long strutlib_index(const strutlib_scene *scene, const char *kind, const char *name);

/** The i-th channel that a run can record, such as "position"; NULL beyond the last. */
STRUTLIB_API const char *strutlib_channel(size_t i);
/** The kind of the things it belongs to: "nodes", "members", ...; "energies" of "energy". */
STRUTLIB_API const char *strutlib_channel_kind(const char *channel);
/** The i-th component of each thing's: "x", "normal", ...; NULL beyond the last, and of single numbers. */
STRUTLIB_API const char *strutlib_channel_component(const char *channel, size_t i);
/** The i-th name in a table with a column for each number of a thing: "x", "vx", "length", ... */
STRUTLIB_API const char *strutlib_channel_column(const char *channel, size_t i);
/** The unit of its numbers: "m", "m/s", ... */
STRUTLIB_API const char *strutlib_channel_unit(const char *channel);

/**
 * Values of the scene by dotted name, as strutlib_scene_yaml shows it: "run.duration", "members.m8.stiffness",
 * "nodes.n1.0" (an item of a list, counted from 0), "parameters.friction" (its value in SI units). 1 where there is
 * such a value, and *value is it; 0 where there is none, as for keys that keep their default.
 */
STRUTLIB_API int strutlib_scene_number(const strutlib_scene *scene, const char *name,
                                       double *value);
/** The same for yes and no: *value is 1 or 0. */
STRUTLIB_API int strutlib_scene_flag(const strutlib_scene *scene, const char *name, int *value);
/** The same for texts; NULL where there is none. "name", "source", "solver.integrator". */
STRUTLIB_API const char *strutlib_scene_text(const strutlib_scene *scene, const char *name);
/**
 * Arrays of the drawn structure: "nodes.position" (nodes, 2) [m], "nodes.mass" (nodes) [kg], "members.nodes" (members,
 * 2) indices of nodes, "members.length" as drawn [m], "members.rest_length" [m], "members.stiffness" [N/m],
 * "members.damping" [N s/m], "members.mass" [kg], "members.pretension" as drawn [N]; each (members). 1 where there is
 * such an array, else 0.
 */
STRUTLIB_API int strutlib_scene_array(const strutlib_scene *scene, const char *name,
                                      const double **data, int *dimensions, size_t *shape,
                                      size_t *stride);

/** Warnings about a scene that is valid but implausible, and notes about outdated words. NULL beyond the last. */
STRUTLIB_API const char *strutlib_scene_warning(const strutlib_scene *scene, size_t i);

/**
 * The scene with every value resolved, in SI units, as `strut export` prints it; short: with its
 * parameters, groups and parts, as --parts.
 */
STRUTLIB_API char *strutlib_scene_yaml(const strutlib_scene *scene, int parts,
                                       strutlib_error **error);
/** The same resolved scene as one JSON object, with the same numbers. */
STRUTLIB_API char *strutlib_scene_json(const strutlib_scene *scene, strutlib_error **error);
/** The structure at its start as an SVG picture, with names. */
STRUTLIB_API char *strutlib_scene_svg(const strutlib_scene *scene, strutlib_error **error);
/** The page that `strut view MODEL` writes; where `equilibria` is 0 none are searched. */
STRUTLIB_API char *strutlib_scene_html(const strutlib_scene *scene, int equilibria,
                                       strutlib_control *control, strutlib_error **error);
/** The data of that page alone, as a JSON object that engine/output/page/page.h describes. */
STRUTLIB_API char *strutlib_scene_page_data(const strutlib_scene *scene, int equilibria,
                                            strutlib_control *control, strutlib_error **error);

/* ---- computing ---- */

/**
 * Options of a call: `count` pairs names[i], values[i], with names as the program has them without the two dashes:
 * "accuracy", "0.5 %". Options of the program without value, such as force, have "yes" or "no". The i-th option that
 * the command (the part of the function's name after strutlib_) has, and what it means; NULL beyond the last.
 */
STRUTLIB_API const char *strutlib_option_name(const char *command, size_t i);
STRUTLIB_API const char *strutlib_option_help(const char *command, size_t i);
/** What it takes: "flag", "text", "number", "whole" (a number), "word", "words" or "range"; NULL beyond the last. */
STRUTLIB_API const char *strutlib_option_kind(const char *command, size_t i);
/** The words that it takes, as "elastic|rigid"; NULL: any, or none. */
STRUTLIB_API const char *strutlib_option_words(const char *command, size_t i);

/**
 * The functions below return a result, or NULL with the error. Where something is there in spite
 * of a failure, they return it and set *error too: a run that diverged or was interrupted, up to
 * then; its strutlib_result_status says so. `control` may be NULL.
 */

/**
 * `strut run`. Arrays: "time" (samples) [s], and each channel that is recorded: "position", "velocity" (samples, nodes,
 * 2), "length", "force" (samples, members), "contact" (samples, contacts, 2: normal, friction), "energy" (samples,
 * energies), and whatever else strutlib_channel lists, as (samples, things) or (samples, things, components). Behind a
 * dot one thing of it, and behind another one component: "position.n1" (samples, 2), "position.n1.x" (samples),
 * "force.m8", "contact.n1.normal", "energy.kinetic", "angular_momentum.total". Recorded are the scene's channels and
 * what figures and pages show, at the times that the scene's `output` gives. Two options are the library's own:
 * "channels", a list with commas of channels to record instead; and "record": yes (default) or no.
 */
STRUTLIB_API strutlib_result *strutlib_run(const strutlib_scene *scene, size_t count,
                                           const char *const *names, const char *const *values,
                                           strutlib_control *control, strutlib_error **error);
/**
 * `strut equilibria`. Arrays such as "equilibria.energy" (equilibria), "equilibria.nodes"
 * (equilibria, nodes, 2), "equilibria.forces" (equilibria, members).
 */
STRUTLIB_API strutlib_result *strutlib_equilibria(const strutlib_scene *scene, size_t count,
                                                  const char *const *names,
                                                  const char *const *values,
                                                  strutlib_control *control,
                                                  strutlib_error **error);
/** `strut modes`. Arrays such as "modes.frequency" (modes) [Hz], "modes.shape" (modes, nodes, 2). */
STRUTLIB_API strutlib_result *strutlib_modes(const strutlib_scene *scene, size_t count,
                                             const char *const *names, const char *const *values,
                                             strutlib_control *control, strutlib_error **error);
/** `strut rigidity`. Arrays such as "self_stress.states.forces" (states, members). */
STRUTLIB_API strutlib_result *strutlib_rigidity(const strutlib_scene *scene, size_t count,
                                                const char *const *names, const char *const *values,
                                                strutlib_control *control, strutlib_error **error);
/** `strut form`. Arrays such as "nodes" (nodes, 2), "forces" (members); strutlib_result_yaml is the new model. */
STRUTLIB_API strutlib_result *strutlib_form(const strutlib_scene *scene, size_t count,
                                            const char *const *names, const char *const *values,
                                            strutlib_control *control, strutlib_error **error);
/**
 * `strut path`. Arrays such as "points.factor" (points; "points.value" with "over"), "points.nodes" (points, nodes, 2).
 */
STRUTLIB_API strutlib_result *strutlib_path(const strutlib_scene *scene, size_t count,
                                            const char *const *names, const char *const *values,
                                            strutlib_control *control, strutlib_error **error);
/**
 * Matrices of the shape that the option "at" names (default drawn). Arrays of each: "mass.row", "mass.column",
 * "mass.value" (entries; indices from 0; symmetric ones in full), "mass.size" (2: rows, columns); likewise
 * "connectivity", "equilibrium", "stiffness_elastic", "stiffness_geometric", "damping" and "stiffness_contact"; and
 * "coordinates" (rows): of each row of all but connectivity 2 times its node, + 1 for y. Of the shape: "position"
 * (nodes, 2) and "weight" (nodes), the mass with half of each member's; (members): "length", "rest_length" without
 * drives, of a rigid bar its length at the start, "tension" of the spring alone, "damping_coefficient".
 */
STRUTLIB_API strutlib_result *strutlib_matrices(const strutlib_scene *scene, size_t count,
                                                const char *const *names, const char *const *values,
                                                strutlib_control *control, strutlib_error **error);
/** X(name) for each of these functions, strutlib_run to strutlib_matrices, which are called alike. */
#define STRUTLIB_CALLS(X) X(run) X(equilibria) X(modes) X(rigidity) X(form) X(path) X(matrices)

/**
 * A row of a sweep is done. Called once for each row, some rows at a time, from one thread at a
 * time, which may be another than the caller's. Non-zero interrupts the sweep.
 */
typedef int (*strutlib_row)(void *context, size_t point, int status);

/**
 * `strut sweep` over any points: axes[0..axis_count) are parameters, `points` their values [SI], row by row
 * (point_count, axis_count). Values of parameters that are texts are in `words`, of the same shape, which may be NULL
 * where there is none, as may each of its texts. With axis_count 0 there is one point, the scene as it is.
 * keep[0..keep_count): columns to keep, words as in a study's `keep`, or names of measured quantities; none: the usual
 * ones. Options: "compute" (run, equilibria, modes, rigidity, path or form), "threads" (default automatic),
 * "limit_evaluations", "limit_time", "at", "lowest" as in a study, and those of method and model as of strutlib_run:
 * "accuracy", "step", "integrator", "bars", ... Arrays: each column of numbers by its name, of the axes first, (points)
 * [SI]; "status" (points): STRUTLIB_OK or why the point failed. Columns of words: strutlib_result_cell. A failed point
 * is a row of NAN with its status and message, no error. The bits of a row depend on its point alone, not on threads.
 * Points that an interrupt left out have the status STRUTLIB_INTERRUPTED.
 */
STRUTLIB_API strutlib_result *strutlib_sweep(
    const strutlib_scene *scene, size_t axis_count, const char *const *axes, size_t point_count,
    const double *points, const char *const *words, size_t keep_count, const char *const *keep,
    size_t count, const char *const *names, const char *const *values, strutlib_row row,
    void *context, strutlib_control *control, strutlib_error **error);

/**
 * `strut sweep` of a study's file, of any form: sweep, search, fit, follow, sensitivity analysis. `directory` gets
 * the program's files; a study that was interrupted resumes there. Settings are those of --set, settings[i] =
 * set[i]. Options: "threads", "retry", and those of method and model as of strutlib_sweep.
 * Values are those of --json, such as "parameters.0.value" of a fit or "best.0.objective" of a search. Arrays,
 * cells and table: those of table.csv, as of strutlib_sweep. strutlib_result_status: STRUTLIB_DIVERGED where points
 * failed or nothing was found, STRUTLIB_INACCURATE where a number is less accurate than requested, or not all
 * parameters of a fit are identified; these are no errors. Where a study is interrupted there is no result.
 */
STRUTLIB_API strutlib_result *strutlib_study(const char *path, const char *directory,
                                             size_t setting_count, const char *const *settings,
                                             const char *const *set, size_t count,
                                             const char *const *names, const char *const *values,
                                             strutlib_control *control, strutlib_error **error);

/* ---- results ---- */

/** STRUTLIB_OK, or why the result is not whole: STRUTLIB_DIVERGED, STRUTLIB_INTERRUPTED, ... */
STRUTLIB_API int strutlib_result_status(const strutlib_result *result);
/** The command that made it: "run", "equilibria", ... */
STRUTLIB_API const char *strutlib_result_command(const strutlib_result *result);
/**
 * The program's --json, byte for byte; of a run without wall_time, as in summary.json; of a sweep
 * and of matrices "{}". Ends with a newline.
 */
STRUTLIB_API const char *strutlib_result_json(const strutlib_result *result);
/** The table that the program prints; of a sweep table.csv. */
STRUTLIB_API const char *strutlib_result_table(const strutlib_result *result);
/** Warnings that the program would print, without "strut: warning: "; NULL beyond the last. */
STRUTLIB_API const char *strutlib_result_warning(const strutlib_result *result, size_t i);
/**
 * Values by dotted name, as in the JSON: "velocity", "energy.residual", "steady.kind", "nodes.n1.position.0",
 * "equilibria.3.name". 1 where there is such a value, 0 where there is none or it is null.
 */
STRUTLIB_API int strutlib_result_number(const strutlib_result *result, const char *name,
                                        double *value);
STRUTLIB_API int strutlib_result_flag(const strutlib_result *result, const char *name, int *value);
STRUTLIB_API const char *strutlib_result_text(const strutlib_result *result, const char *name);
/** Number of items of a list or a mapping of the JSON; 0 where there is none. */
STRUTLIB_API size_t strutlib_result_count(const strutlib_result *result, const char *name);
/** The i-th name of a mapping of the JSON, such as "energy"; NULL beyond the last. `name` "": the whole. */
STRUTLIB_API const char *strutlib_result_key(const strutlib_result *result, const char *name,
                                             size_t i);
/**
 * An array of the result. Besides those that the functions above name, all numbers of the JSON are arrays by dotted
 * name: every list on the way is a dimension, and so is what lies behind the name, lists as well as mappings from names
 * to numbers: "modes.shape" is (modes, nodes, 2). Shorter ones are filled up with NAN, null is NAN. 1 where there is
 * such an array, else 0 (also where memory is out).
 */
STRUTLIB_API int strutlib_result_array(const strutlib_result *result, const char *name,
                                       const double **data, int *dimensions, size_t *shape,
                                       size_t *stride);
/**
 * The i-th name of the arrays that are not in the JSON: recorded channels, columns of a sweep; NULL beyond the last.
 */
STRUTLIB_API const char *strutlib_result_array_name(const strutlib_result *result, size_t i);
/** The unit of such an array, such as "m/s"; "1" or "" without; NULL where there is no such array. */
STRUTLIB_API const char *strutlib_result_array_unit(const strutlib_result *result,
                                                    const char *name);
/** A word of a sweep: column "outcome", "method", "message", ... at a point; NULL where there is none. */
STRUTLIB_API const char *strutlib_result_cell(const strutlib_result *result, const char *column,
                                              size_t point);
/** The i-th column of a sweep's table, of numbers or of words, in its order; NULL beyond the last. */
STRUTLIB_API const char *strutlib_result_column(const strutlib_result *result, size_t i);
/** The scene as it was run, or the model that a form is; others: NULL with the error. */
STRUTLIB_API char *strutlib_result_yaml(const strutlib_result *result, strutlib_error **error);
/**
 * The figure of --plot FILE.svg as a text, with options "draw", "title", "width", "scale",
 * "times" as there. A run must have recorded what it shows.
 */
STRUTLIB_API char *strutlib_result_svg(const strutlib_result *result, size_t count,
                                       const char *const *names, const char *const *values,
                                       strutlib_error **error);
/** The page that `strut view` writes of a run, or of equilibria; others: NULL with the error. */
STRUTLIB_API char *strutlib_result_html(const strutlib_result *result, strutlib_error **error);
/**
 * The data of that page alone, as a JSON object that engine/output/page/page.h describes. Of modes, rigidity, a form
 * and a path, which have no page, it is that of the structure: strutlib_result_json has their numbers.
 */
STRUTLIB_API char *strutlib_result_page_data(const strutlib_result *result, strutlib_error **error);
STRUTLIB_API void strutlib_result_free(strutlib_result *result);

/* ---- simulation: a run that is advanced from outside ---- */

/**
 * A simulation at the start of the scene's run, settled if the scene says so. Options: "step",
 * "integrator", "tolerance", "force" and those of the model ("bars", "mass-model",
 * "friction-law", "damping-law") as of strutlib_run. The duration of the scene's run is no limit, unless the
 * simulation records by "record" or "channels": then it ends there.
 * `control` stays in use by every advance until the simulation is closed; it may be NULL.
 */
STRUTLIB_API strutlib_simulation *strutlib_simulation_open(const strutlib_scene *scene,
                                                           size_t count, const char *const *names,
                                                           const char *const *values,
                                                           strutlib_control *control,
                                                           strutlib_error **error);
/** Snapshots of it stay, but can only be released. */
STRUTLIB_API void strutlib_simulation_close(strutlib_simulation *simulation);
/**
 * Makes `steps` steps and updates the arrays. STRUTLIB_OK, or STRUTLIB_DIVERGED, STRUTLIB_INTERRUPTED, ...: the
 * simulation then stands where it came to. The steps have the bits of a run's, however they are divided into calls.
 */
STRUTLIB_API int strutlib_simulation_advance(strutlib_simulation *simulation, long steps,
                                             strutlib_error **error);
/**
 * Ends a simulation that records and returns its run, as of strutlib_run, with the status STRUTLIB_INTERRUPTED before
 * its end; it stays where it is. NULL: it records nothing, it was finished before, or memory is out.
 */
STRUTLIB_API strutlib_result *strutlib_simulation_finish(strutlib_simulation *simulation,
                                                         strutlib_error **error);
/** Time reached [s]. */
STRUTLIB_API double strutlib_simulation_time(const strutlib_simulation *simulation);
/** The step [s]: of an adaptive method the time between two stops. */
STRUTLIB_API double strutlib_simulation_step(const strutlib_simulation *simulation);
/**
 * Live arrays, which follow every advance, set and restore: channels as of strutlib_run, without
 * samples, such as "position" (nodes, 2), "force" (members), "energy" (energies). What no one asks for costs
 * nothing. 1 where there is such an array, else 0.
 */
STRUTLIB_API int strutlib_simulation_array(strutlib_simulation *simulation, const char *name,
                                           const double **data, int *dimensions, size_t *shape,
                                           size_t *stride);
/**
 * Inputs: arrays that the caller writes, at any time between two calls. They hold from the next advance on, until they
 * are written again. A change is an event: methods with events begin anew there, and the energy balance counts its
 * work.
 *   "rest" (members): rest lengths [m], to which a driven member's signal is added;
 *   "actuators" (actuators): what the signal is, in its unit; NAN (as at the beginning): as the
 *     scene says;
 *   "rates" (actuators): how fast these values move [per second], 0 at the beginning; a damper uses it;
 *   "load" (nodes, 2): forces on nodes besides those of the scene [N], 0 at the beginning.
 * Values that are not finite, or rest lengths below 0, make the next advance fail with STRUTLIB_USAGE, without a step.
 */
STRUTLIB_API int strutlib_simulation_input(strutlib_simulation *simulation, const char *name,
                                           double **data, int *dimensions, size_t *shape,
                                           size_t *stride);
/** Sets one number of an input by name: "rest", "m8"; "load", "n1.x". STRUTLIB_OK or STRUTLIB_USAGE. */
STRUTLIB_API int strutlib_simulation_set(strutlib_simulation *simulation, const char *input,
                                         const char *name, double value, strutlib_error **error);
/** Work that changes of inputs have done so far [J]; part of the energy's balance. */
STRUTLIB_API double strutlib_simulation_input_work(const strutlib_simulation *simulation);
/** Stores all of the state, inputs too. NULL: memory is out. */
STRUTLIB_API strutlib_snapshot *strutlib_simulation_snapshot(const strutlib_simulation *simulation,
                                                             strutlib_error **error);
/**
 * Puts a simulation where it was at a snapshot of its own; what follows has the same bits.
 * STRUTLIB_OK, or STRUTLIB_USAGE for another simulation's snapshot.
 */
STRUTLIB_API int strutlib_simulation_restore(strutlib_simulation *simulation,
                                             const strutlib_snapshot *snapshot,
                                             strutlib_error **error);
STRUTLIB_API void strutlib_snapshot_free(strutlib_snapshot *snapshot);

#ifdef __cplusplus
}
#endif

#endif

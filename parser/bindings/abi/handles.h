/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What the handles of abi.h are, and what all calls share: errors, messages, entering and leaving. */
#pragma once

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

#include "engine/base/flag.h"
#include "engine/base/memory.h"
#include "engine/base/status.h"
#include "engine/model/model.h"
#include "engine/output/draw/chart.h"
#include "engine/output/figures/run_figure.h"
#include "engine/output/trajectory.h"
#include "engine/statics/equilibria/equilibria.h"
#include "parser/bindings/abi/abi.h"
#include "parser/language/yaml/document.h"
#include "parser/program/command/arguments.h"

/*
 * A tree of named values, by dotted names: what JSON texts and scenes hold.
 *
 * A name may itself contain dots, as those of things in copies do: the longest one that fits is taken.
 * Items of lists are called by their number, from 0.
 */

typedef struct cJSON abi_tree;

/** The tree of a resolved scene: texts in quotes stay texts, plain ones become numbers or flags if they are. */
abi_tree *abi_tree_of(const strut_tree *root);
/** As a JSON text in a block of strut_allocate; NULL: memory is out. */
char *abi_tree_write(const abi_tree *tree);
void abi_tree_free(abi_tree *tree); /* NULL is allowed */

bool abi_tree_number(const abi_tree *tree, const char *name, double *value);
bool abi_tree_flag(const abi_tree *tree, const char *name, int *value);
const char *abi_tree_text(const abi_tree *tree, const char *name);
/** The functions of the header that find a value by name in tree_of(handle). */
#define ABI_TREE_VALUES(OF)                                                                        \
  int strutlib_##OF##_number(const strutlib_##OF *OF, const char *name, double *value) {           \
    return abi_tree_number(tree_of(OF), name, value);                                              \
  }                                                                                                \
  int strutlib_##OF##_flag(const strutlib_##OF *OF, const char *name, int *value) {                \
    return abi_tree_flag(tree_of(OF), name, value);                                                \
  }                                                                                                \
  const char *strutlib_##OF##_text(const strutlib_##OF *OF, const char *name) {                    \
    return abi_tree_text(tree_of(OF), name);                                                       \
  }
/**
 * Replaces a value of the mapping called `name` by a number or, where text is not NULL, by a text. False: no memory.
 */
bool abi_tree_set(abi_tree *tree, const char *name, const char *key, double number,
                  const char *text);

/** Fills DATA (COUNT, PARTS) with the VALUE of i and c. The function returns false where DATA is NULL. */
#define ABI_FILL(DATA, COUNT, PARTS, VALUE)                                                        \
  do {                                                                                             \
    double *data_ = DATA;                                                                          \
    if (!data_) return false;                                                                      \
    for (size_t i = 0; i < (COUNT); i++)                                                           \
      for (size_t c = 0; c < (PARTS); c++) data_[(PARTS)*i + c] = VALUE;                           \
  } while (0)

/* ---- control ---- */

struct strutlib_control {
  strut_flag interrupt;
  strutlib_progress progress;
  void *context;
};

/** The flag that stops a computation, or NULL. */
static inline const strut_flag *abi_interrupt_of(const strutlib_control *control) {
  return control ? &control->interrupt : NULL;
}

/** Tells the progress to whoever wants to know, who may interrupt. */
static inline void abi_progress(strutlib_control *control, double fraction) {
  if (control->progress && control->progress(control->context, fraction)) control->interrupt = 1;
}

/* ---- errors ---- */

/** Makes *error (which may be NULL) describe a failure; returns the status. */
int abi_fail(strutlib_error **error, int status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/** The same from the error of a library call. */
int abi_fail_with(strutlib_error **error, strut_status status, const strut_error *what);
/** The same from everything that was found in `count` texts, found[i] in each. */
int abi_fail_located(strutlib_error **error, strut_status status, strut_diagnostics *const *found,
                     size_t count);
/** The end of reading a text: the same of a failure, and frees what was found. Returns the status. */
strut_status abi_settle(strutlib_error **error, strut_status status, strut_diagnostics *found);
int abi_no_memory(strutlib_error **error);
/** Is an argument that a call needs NULL? Then *error says which. */
bool abi_lacks(strutlib_error **error, const void *argument, const char *name);
/** The same of a list of texts and of each of them; of pairs of texts. */
bool abi_lacks_texts(strutlib_error **error, size_t count, const char *const *texts,
                     const char *name);
#define abi_lacks_pairs(ERROR, COUNT, NAMES, VALUES)                                               \
  (abi_lacks_texts(ERROR, COUNT, NAMES, "names") || abi_lacks_texts(ERROR, COUNT, VALUES, "values"))

/* ---- messages ---- */

/** Texts that a call tells: warnings and notes are kept, an error is remembered. Zero-initialise. */
typedef struct abi_messages {
  strut_arena arena;
  const char **warnings; /* (count) */
  size_t count, capacity;
  strut_error error;
  bool out_of_memory;
} abi_messages;

/** A listener that keeps what it hears; both stay where they are. */
strut_listener abi_listen(abi_messages *messages);
void abi_add_warning(abi_messages *messages, const char *text);
void abi_add_notes(abi_messages *messages, const strut_diagnostics *found);
void abi_messages_free(abi_messages *messages);

/* ---- scenes ---- */

/** A text that was read once; scenes with different settings share it. */
typedef struct abi_source {
  atomic_int users;
  char *name, *text; /* owned */
  size_t length;
  strut_scene_source *tree;
} abi_source;

/** A named array of a handle. */
typedef struct abi_array {
  const char *name, *unit;
  const double *data;
  int dimensions;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS];
} abi_array;

/** Row by row: the last index runs first. */
abi_array abi_array_of(const char *name, const char *unit, const double *data, int dimensions,
                       const size_t *shape);
/** Fills in where an array is and its shape. Returns 0 if there is no array or an argument is NULL, else 1. */
int abi_show_array(const abi_array *array, const double **data, int *dimensions, size_t *shape,
                   size_t *stride);

/** Arrays, and what else their handle owns. Zero-initialise. */
typedef struct abi_arrays {
  abi_array *items; /* (count) of strut_allocate */
  size_t count, capacity;
  strut_arena arena;
} abi_arrays;

/** Adds an array with copies of its texts. NULL: memory is out. */
const abi_array *abi_add_array(abi_arrays *list, const abi_array *array);
/** An array (count) or (count, components) to be filled in, zeros at first; NULL: memory is out. */
double *abi_new_array(abi_arrays *list, const char *name, const char *unit, size_t count,
                      size_t components);
/** By name, or NULL. */
const abi_array *abi_find_array(const abi_arrays *list, const char *name);
void abi_arrays_free(abi_arrays *list);

struct strutlib_scene {
  abi_source *source;
  strut_setting *settings; /* (setting_count) in the arena of the arrays */
  size_t setting_count;
  strut_setup setup; /* as strut_open_model reads it for any purpose */
  abi_messages messages;
  abi_arrays arrays;
  pthread_mutex_t lock; /* of the tree, which is made when it is first asked for */
  abi_tree *tree;
};

/** Reads the scene again for a purpose: what a call may change. Release it by strut_setup_free. */
strut_status abi_setup(const strutlib_scene *scene, strut_purpose purpose, strut_setup *setup,
                       strutlib_error **error);
/* ---- calls ---- */

/** Clears *error. For calls that compute: the host's GSL handler sleeps until abi_leave. */
void abi_enter(strutlib_error **error);
/** The end of such a call. Of one that failed *error says why, if it does not yet: `what` (or NULL), or the status. */
void abi_leave(strutlib_error **error, strut_status status, const strut_error *what);
/** The same of a call that returns a text of strut_allocate; NULL is a failure, of memory unless `what` says more. */
char *abi_leave_text(strutlib_error **error, char *text, const strut_error *what);

/** A call's options, as pairs of texts. */
typedef struct abi_pairs {
  size_t count;
  const char *const *names, *const *values;
} abi_pairs;

/** A call with options under way. Stays where it is. */
typedef struct abi_call {
  const strutlib_scene *scene; /* NULL: of a file */
  strut_arguments arguments;
  strutlib_control *control; /* may be NULL */
  strutlib_error **error;
  strut_listener listener;
  abi_messages messages; /* what it heard */
  strut_error what;      /* why it failed, unless it heard that or *error says it */
  bool complete;         /* there is a result, in spite of a failure, too */
} abi_call;

/** A call of a scene, as yet without options. */
abi_call abi_call_of(const strutlib_scene *scene, const strut_command *command,
                     strutlib_control *control, strutlib_error **error);
/** Reads its options by the command's table. STRUT_INTERRUPTED where the control is. */
strut_status abi_call_begin(abi_call *call, const abi_pairs *options);
/** abi_leave with what the call knows. */
void abi_call_leave(const abi_call *call, strut_status status);

/** What a call computes into its result. Where it fails, it fills call->what or *call->error, or the listener heard. */
typedef strut_status abi_work(abi_call *call, strutlib_result *result);
/** A whole call: the result, which is there only if it is complete. */
strutlib_result *abi_compute(abi_call *call, const abi_pairs *options, abi_work *work);
/** The function of the header that is called as all of STRUTLIB_CALLS. */
#define ABI_CALL(NAME, WORK)                                                                       \
  strutlib_result *strutlib_##NAME(const strutlib_scene *scene, size_t count,                      \
                                   const char *const *names, const char *const *values,            \
                                   strutlib_control *control, strutlib_error **error) {            \
    if (abi_lacks(error, scene, "scene")) return NULL;                                             \
    abi_call call = abi_call_of(scene, &abi_##NAME##_command, control, error);                     \
    return abi_compute(&call, &(abi_pairs){count, names, values}, WORK);                           \
  }

extern const strut_command abi_run_command, abi_equilibria_command, abi_modes_command,
    abi_rigidity_command, abi_form_command, abi_path_command, abi_matrices_command,
    abi_sweep_command, abi_study_command, abi_simulation_command, abi_svg_command;

/* ---- results ---- */

struct strutlib_result {
  const strut_command *command;
  int status;
  char *json, *table; /* of strut_allocate */
  abi_messages messages;
  bool opened; /* there is a setup */
  strut_setup setup;
  strut_model *model;
  abi_arrays arrays; /* that are not in the JSON */
  /** Draws a figure into the file; NULL: there is none. */
  strut_status (*draw)(const strutlib_result *result, const strut_arguments *arguments,
                       const char *path, strut_error *error);
  void *detail; /* what only one kind of result has, or NULL */
  void (*release)(void *detail);
  pthread_mutex_t lock; /* of what follows, made when it is first asked for */
  abi_tree *tree;
  abi_arrays made; /* of the JSON */
};

/** A result without content; NULL: memory is out. */
strutlib_result *abi_result_create(const strut_command *command);
/** The motion that a result recorded, or NULL; and its summary. */
const strut_trajectory *abi_result_motion(const strutlib_result *result);

/* ---- figures and pages as texts ---- */

/** Options "title" and "width" into a plot that goes to `path`. */
strut_status abi_plot_read(const strut_arguments *arguments, const char *path, strut_plot *plot);

/* ---- a temporary folder for what is made as a file and shown as a text or as arrays ---- */

typedef struct abi_scratch {
  char folder[300], path[340]; /* path: of the one file in it */
} abi_scratch;

/** Makes the folder below TMPDIR or /tmp, for a file of that name. STRUT_FILE_TROUBLE. */
strut_status abi_scratch_begin(abi_scratch *scratch, const char *name, strut_error *error);
/** Its file, or another one in it, as a text of strut_allocate; NULL with the error. */
char *abi_scratch_read(const abi_scratch *scratch, const char *name, strut_error *error);
/** Removes the folder and these files in it; NULL after the last. */
void abi_scratch_end(const abi_scratch *scratch, const char *const *names);

/* ---- results of statics, for other files of the library ---- */

/** The equilibria that a result of strutlib_equilibria holds, or NULL. */
const strut_equilibria *abi_result_equilibria(const strutlib_result *result);

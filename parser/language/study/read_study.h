/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * From a study's YAML text, and the model it names, to points and their scenes.
 *
 * The model's text becomes a tree once; each point's scene is read from that tree with the point's parameters.
 */
#pragma once

#include "engine/scene/study.h"
#include "parser/language/read/read_scene.h"
#include "parser/language/read/reuse/used_files.h"

/** A file of points that the study names. */
typedef struct strut_study_points {
  const struct strut_tree *node; /* its name in the study */
  const char *copy;              /* the name of its copy beside results */
  strut_safe_text file;
} strut_study_points;

/** What is done to each scene of an open study once it was read, by several threads at a time. */
typedef struct strut_study_adjustment {
  strut_status (*adjust)(const void *context, strut_setup *setup); /* NULL: nothing */
  const void *context;
  strut_purpose purpose; /* of the scenes of runs */
} strut_study_adjustment;

/** A study as read. Zero-initialise; strut_study_close releases it. Constant once it is open. */
typedef struct strut_study_file {
  strut_study study;
  /* The model, with the study's solver, run, initial and output laid over, and those of a variant:
     one for each variant, whose name is the first column then, or one. */
  size_t source_count;
  strut_scene_source **sources;
  bool variants;
  size_t setting_count, column_count;
  strut_setting *settings; /* (setting_count) the same at every point: --set, set, derive */
  strut_setting *columns;  /* (column_count) of the axes, their values to be filled in */
  const char *path;        /* of the study; not owned */
  unsigned number;         /* of the study's text among the files that the model uses */
  char *text, *model_path, *model_text;
  size_t length, model_length;
  strut_document document; /* the study's tree */
  strut_diagnostics diagnostics, model_diagnostics;
  strut_arena arena;
  size_t table_count;
  strut_study_points *tables; /* (table_count) files of points */
  char *model_copy;           /* a model that uses files, in one text; NULL: model_text is that */
  strut_setting followed;     /* the parameter that is followed, its value to be filled in */
  strut_study_adjustment adjustment;
} strut_study_file;

/**
 * Reads the study at `path` and its model. On STRUT_BAD_SCENE strut_study_messages has every finding;
 * STRUT_FILE_TROUBLE with the reason in `error`. overrides (--set) are not copied.
 */
STRUT_API strut_status strut_study_open(const char *path, const strut_setting *overrides,
                                        size_t override_count, strut_study_file *file,
                                        strut_error *error);
/** All messages as printed text, at most `most` of each file; NULL: memory is out. */
STRUT_API const char *strut_study_messages(strut_study_file *file, size_t most);
/** All notes of the points tried, such as on former names of keys; NULL: memory is out. */
STRUT_API const char *strut_study_notes(strut_study_file *file);
/**
 * The scene and experiment of a strut_study_file where the axes have these values (column_count). On STRUT_BAD_SCENE
 * `error` has the first finding with its place. Safe from several threads.
 */
STRUT_API strut_status strut_study_setup(void *study_file, const strut_study_value *values,
                                         strut_setup *setup, strut_error *error);
/** The same where the parameter that is followed has the value [SI]. */
STRUT_API strut_status strut_study_setup_at(void *study_file, const strut_study_value *values,
                                            double value, strut_setup *setup, strut_error *error);
/** strut_study_setup where the parameters `by` have the values numbers (count) [SI]. */
STRUT_API strut_status strut_study_vary(void *study_file, const strut_study_value *values,
                                        const strut_derived_by *by, size_t count,
                                        const double *numbers, strut_setup *setup,
                                        strut_error *error);
/**
 * Like strut_study_setup, or with a value as strut_study_setup_at, for one thread: all findings go to the messages,
 * with the values of the axes.
 */
STRUT_API strut_status strut_study_try(strut_study_file *file, const strut_study_value *values,
                                       const double *followed);
/**
 * All that decides the results, as a text that does not change with comments, blanks and the order
 * of texts; a block of strut_allocate, or NULL.
 */
STRUT_API char *strut_study_identity(const strut_study_file *file);
/**
 * The study's text as it was written, but naming `model` as its model and files of points by the names of
 * their copies, so that it may stand beside copies of them; comments at its end say what the model was, and
 * which options, each before its value in `words`, it was run with. A block of strut_allocate, or NULL.
 */
STRUT_API char *strut_study_copy(const strut_study_file *file, const char *model,
                                 const char *const *words, size_t word_count);
STRUT_API void strut_study_close(strut_study_file *file);

/* ---- expressions of columns ---- */

/** A column of the table. */
typedef struct strut_table_name {
  const char *name, *unit; /* unit "" or "1": none */
  bool word;
} strut_table_name;

/**
 * Compiles the goal and the conditions of an open study that searches, for a table with these columns.
 * On STRUT_BAD_SCENE strut_study_messages has every finding.
 */
STRUT_API strut_status strut_study_search_bind(strut_study_file *file,
                                               const strut_table_name *columns, size_t count);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Requests for single evaluations: parameters of a model, and what is computed with them.
 * 
 * A request is a mapping {"set": {NAME: VALUE, ...}, "id": ..., "compute": ..., "keep": ..., "at": ...,
 * "variant": ...}, or the parameters alone: any mapping whose "set" is no mapping, where "id" is none of the
 * model's parameters. A number is in SI, in the unit of the parameter; a text is an expression such as
 * "10 Hz", or the value of a text parameter.
 */
#ifndef STRUT_PARSER_STUDY_STUDY_REQUEST_H
#define STRUT_PARSER_STUDY_STUDY_REQUEST_H

#include "parser/study/read_study.h"

/** Opens a model as a study without axes, which computes a run. As strut_study_open. */
STRUT_API strut_status strut_study_open_model(const char *path, const strut_override *overrides,
                                              size_t override_count, strut_study_file *file,
                                              strut_error *error);

/** The same for a file that is either: a study, whose axes do not matter, or a model. */
STRUT_API strut_status strut_study_open_either(const char *path, const strut_override *overrides,
                                               size_t override_count, strut_study_file *file,
                                               strut_error *error);

/** One parameter of a request. */
typedef struct strut_request_value {
  const char *name, *text;
  bool number;                   /* the text is a plain number, in SI */
  strut_place name_place, place; /* of the name and of the value, in the request's text */
} strut_request_value;

typedef struct strut_request {
  const strut_tree *id; /* a scalar, or NULL */
  size_t value_count;
  strut_request_value *values;
  const char *variant; /* of the study; NULL: it has none */
  size_t source;       /* its model */
  /* The study with what the request chooses, without axes. */
  strut_study study;
  strut_arena arena; /* owns all of the above that the study file does not */
} strut_request;

/** What is said about a request: "FILE:LINE:COLUMN: TEXT" each, in the request's arena. */
typedef struct strut_request_findings {
  const char *file; /* name of the request's text */
  size_t count;     /* of all; the first STRUT_REQUEST_FINDINGS are stored */
  const char *text[16];
} strut_request_findings;
enum { STRUT_REQUEST_FINDINGS = 16 };

/** What a request may choose besides parameters; NULL: as the study has it. */
typedef struct strut_request_choice {
  const char *compute, *keep, *at; /* keep: words with commas or blanks between */
} strut_request_choice;

/** A request of the study without values, with nothing chosen. strut_request_free releases it. */
STRUT_API void strut_request_begin(const strut_study_file *file, strut_request *request);
STRUT_API void strut_request_free(strut_request *request);
/**
 * Chooses what is computed and kept. STRUT_BAD_SCENE with one sentence, which names the word that is
 * wrong. Names of measured quantities are checked by strut_request_setup.
 */
STRUT_API strut_status strut_request_choose(strut_request *request,
                                            const strut_request_choice *choice, strut_error *error);
/** Has the request's model a parameter of that name? *text: it is a text. */
STRUT_API bool strut_request_parameter(const strut_study_file *file, const strut_request *request,
                                       const char *name, bool *text);
/** Reads the tree of a JSON text, which lives as long as the request. STRUT_BAD_SCENE with findings. */
STRUT_API strut_status strut_request_read(const strut_study_file *file, const strut_tree *tree,
                                          strut_request *request, strut_request_findings *findings);
/**
 * The scene of a request. STRUT_BAD_SCENE with findings: of the request's values at their places, others in
 * the model or the study.
 */
STRUT_API strut_status strut_request_setup(const strut_study_file *file, strut_request *request,
                                           strut_setup *setup, strut_request_findings *findings);

/* ---- files of Dakota ---- */

/** A function that DAKOTA wants. */
typedef struct strut_dakota_function {
  const char *name; /* the response's descriptor, "" where the file has none */
  int wanted;       /* sum of 1: value, 2: gradient, 4: Hessian */
  strut_place place;
} strut_dakota_function;

typedef struct strut_dakota_file {
  size_t variable_count, function_count;
  strut_request_value *variables;
  strut_dakota_function *functions;
  strut_arena arena;
} strut_dakota_file;

/** Reads a text. STRUT_BAD_SCENE with every finding in the diagnostics, whose source it must be. */
STRUT_API strut_status strut_dakota_read(const char *text, size_t length,
                                         strut_diagnostics *diagnostics, strut_dakota_file *file);
STRUT_API void strut_dakota_free(strut_dakota_file *file);

/**
 * Makes the variables the values of a request of the study. STRUT_BAD_SCENE where a descriptor is no
 * parameter of the model.
 */
STRUT_API strut_status strut_dakota_request(const strut_study_file *study,
                                            const strut_dakota_file *file, strut_request *request,
                                            strut_diagnostics *diagnostics);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The parameters files of DAKOTA, in its standard format ("1.5 stiffness") and in APREPRO's
 * ("{ stiffness = 1.5 }").
 */
#ifndef STRUT_PARSER_STUDY_DAKOTA_FILE_H
#define STRUT_PARSER_STUDY_DAKOTA_FILE_H

#include "parser/study/study_request.h"

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

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/open_model.h"

#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "engine/output/results.h"
#include "engine/statics/equilibria/rest_state.h"
#include "parser/cli/streams.h"
#include "parser/read/read_scene.h"
#include "parser/yaml/memory_estimate.h"

enum { MOST_MESSAGES = 50 };

typedef struct source {
  const char *name;
  char *text;
  size_t length;
} source;

static strut_status read_source(const strut_arguments *arguments, const source *from,
                                strut_purpose purpose, strut_setup *setup) {
  strut_diagnostics diagnostics = {0};
  strut_error error = {0};
  strut_status status = strut_memory_check_document(from->name, from->text, from->length, &error);
  if (status == STRUT_NO_MEMORY) {
    strut_print_error(&error);
    return status;
  }
  status = strut_setup_read(setup, from->name, from->text, from->length, arguments->overrides,
                            arguments->override_count, purpose, &diagnostics);
  if (status == STRUT_BAD_SCENE) {
    const char *messages = strut_diagnostics_render(&diagnostics, MOST_MESSAGES);
    if (messages) fputs(messages, stderr);
    if (!messages) status = STRUT_NO_MEMORY;
  }
  if (status == STRUT_OK && diagnostics.note_count) {
    const char *notes = strut_diagnostics_render_notes(&diagnostics);
    if (notes) fputs(notes, stderr);
    if (!notes) strut_setup_free(setup);
    if (!notes) status = STRUT_NO_MEMORY;
  }
  if (status == STRUT_NO_MEMORY) {
    strut_memory_fail_document(from->name, from->text, from->length, &error);
    strut_print_error(&error);
  }
  strut_diagnostics_free(&diagnostics);
  return status;
}

strut_status strut_open_model(const strut_arguments *arguments, strut_open_purpose purpose,
                              strut_setup *setup) {
  source from = {.name = strcmp(arguments->model, "-") == 0 ? "<stdin>" : arguments->model};
  strut_error error = {0};
  strut_status status = strut_file_read(arguments->model, &from.text, &from.length, &error);
  if (status != STRUT_OK) {
    strut_print_error(&error);
    return status;
  }
  bool told = strut_option_text(arguments, STRUT_OPTION_ACCURACY) ||
              strut_option_text(arguments, STRUT_OPTION_STEP);
  strut_purpose run = told ? STRUT_FOR_RUN_STEP_LATER : STRUT_FOR_RUN;
  status =
      read_source(arguments, &from, purpose == STRUT_OPEN_FOR_RUN ? run : STRUT_FOR_ANY, setup);
  strut_release(from.text);
  if (status != STRUT_OK || purpose == STRUT_OPEN_FOR_ANY) return status;
  status = strut_resolve_start_equilibrium(setup, &error);
  if (status != STRUT_OK) {
    strut_print_error(&error);
    strut_setup_free(setup);
  }
  return status;
}

strut_status strut_warn_of_scene(const strut_setup *setup) {
  strut_findings warnings = {0};
  strut_status status = strut_setup_warn(setup, &warnings);
  for (size_t i = 0; i < warnings.count && !status; i++)
    fprintf(stderr, "strut: warning: %s\n", warnings.items[i].message);
  strut_findings_free(&warnings);
  return status ? strut_print_out_of_memory() : STRUT_OK;
}

strut_status strut_open_model_text(const strut_arguments *arguments, char **text, size_t *length,
                                   strut_setup *setup) {
  source from = {.name = strcmp(arguments->model, "-") == 0 ? "<stdin>" : arguments->model};
  strut_error error = {0};
  strut_status status = strut_file_read(arguments->model, &from.text, &from.length, &error);
  *text = NULL;
  if (status != STRUT_OK) {
    strut_print_error(&error);
    return status;
  }
  status = read_source(arguments, &from, STRUT_FOR_ANY, setup);
  if (status != STRUT_OK) {
    strut_release(from.text);
    return status;
  }
  *text = from.text;
  *length = from.length;
  return STRUT_OK;
}

strut_status strut_check_output_writable(const strut_arguments *arguments,
                                         const char *const *names) {
  strut_results results = {0};
  strut_error error = {0};
  if (!arguments->output) return STRUT_OK;
  strut_status status = strut_results_begin_named(&results, arguments->output, names, &error);
  if (status != STRUT_OK) strut_print_error(&error);
  strut_results_abandon(&results);
  return status;
}

strut_status strut_try_file(const char *path) {
  strut_file file = {0};
  strut_error error = {0};
  if (!path) return STRUT_OK;
  strut_status status = strut_file_open_path(&file, path, &error);
  if (status != STRUT_OK) strut_print_error(&error);
  strut_file_abandon(&file);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/analysis.h"

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "parser/program/streams.h"

strut_status strut_analysis_run(const strut_command *command, const strut_arguments *arguments,
                                const char *const *names, strut_analyse analyse) {
  strut_analysis a = {.arguments = arguments, .names = names};
  strut_error error = {0};
  strut_status status = strut_plot_read(command, arguments, 0, &a.plot);
  if (status == STRUT_OK) status = strut_check_output_writable(arguments, names);
  if (status == STRUT_OK) status = strut_open_model(arguments, STRUT_OPEN_FOR_ANY, &a.setup);
  if (status != STRUT_OK) return status;
  status = strut_model_compile(&a.setup.scene, &a.model, &error);
  if (status == STRUT_OK) status = analyse(&a, &error);
  if (status != STRUT_OK && error.message[0]) strut_print_error(&error);
  strut_model_free(a.model);
  strut_setup_free(&a.setup);
  return status;
}

static strut_status write_files(const char *directory, const char *const *names, const char *json,
                                const char *csv, strut_error *error) {
  strut_status status = strut_directory_create(directory, error);
  if (status == STRUT_OK && (!json || (names[1] && !csv)))
    status = strut_no_memory(error, "while writing files");
  if (status == STRUT_OK) status = strut_file_write_text(directory, names[0], json, error);
  if (status == STRUT_OK && csv) status = strut_file_write_text(directory, names[1], csv, error);
  return status;
}

bool strut_report_needs_json(const strut_arguments *arguments) {
  return arguments->json || arguments->output;
}

strut_status strut_report(const strut_arguments *arguments, const char *const *names, char *json,
                          char *csv, char *table, strut_error *error) {
  strut_status status = STRUT_OK;
  if (arguments->output) status = write_files(arguments->output, names, json, csv, error);
  char *shown = arguments->json ? json : table;
  strut_release(csv);
  strut_release(arguments->json ? table : json);
  if (status == STRUT_OK) return strut_print_report(arguments, shown);
  strut_release(shown);
  return status;
}

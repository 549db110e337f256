/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/outputs.h"

#include <stdio.h>

#include "engine/output/file.h"
#include "engine/output/result_values.h"
#include "engine/output/results.h"
#include "parser/program/commands.h"
#include "parser/program/open_model.h"
#include "parser/program/streams.h"

enum { MOST_FILES = 128, PATH = 4096 };

static void list_names(const strut_output_file *files, const char *names[MOST_FILES]) {
  size_t count = 0;
  while (files[count].name && count + 1 < MOST_FILES) names[count] = files[count].name, count++;
  names[count] = NULL;
}

strut_status strut_outputs_check(const strut_arguments *arguments, const strut_output_file *files) {
  const char *names[MOST_FILES];
  list_names(files, names);
  return strut_check_output_writable(arguments, names);
}

static strut_status write_file(const strut_outputs *outputs, const strut_output_file *file,
                               const char *directory, const strut_plot *plot, strut_error *error) {
  char path[PATH];
  if (file->absent) return STRUT_OK;
  const strut_value_rows *rows = file->rows ? file->rows : outputs->rows;
  if (!file->draw)
    return strut_file_write_block(
        directory, file->name,
        file->list ? strut_values_csv(rows, file->list, NULL, outputs->result, outputs->scene)
                   : strut_values_json(rows, outputs->result, outputs->scene),
        error);
  if (snprintf(path, sizeof path, "%s/%s", directory, file->name) >= (int)sizeof path)
    return strut_fail(error, STRUT_FILE_TROUBLE, "cannot write '%s': the path is too long",
                      file->name);
  strut_plot own = file->width > 0.0 ? (strut_plot){.width = file->width} : *plot;
  own.path = path;
  return file->draw(&own, outputs->result, file->index, error);
}

strut_status strut_outputs_make(const strut_arguments *arguments, const strut_plot *plot,
                                const strut_outputs *outputs) {
  const char *names[MOST_FILES];
  strut_results results = {0};
  strut_error error = {0};
  strut_status status = STRUT_OK;
  list_names(outputs->files, names);
  if (arguments->output) {
    status = strut_results_begin_named(&results, arguments->output, names, &error);
    for (const strut_output_file *file = outputs->files; file->name && !status; file++)
      status = write_file(outputs, file, results.stage, plot, &error);
    if (!status) status = strut_results_commit(&results, &error);
    strut_results_abandon(&results);
  }
  if (!status && plot->path) status = outputs->draw(plot, outputs->result, outputs->index, &error);
  if (status) return strut_print_failure(status, &error);
  if (arguments->csv && outputs->printed)
    return strut_print_block(
        strut_values_csv(outputs->rows, outputs->printed, NULL, outputs->result, outputs->scene));
  return strut_print_values(arguments, outputs->rows, outputs->result, outputs->scene);
}

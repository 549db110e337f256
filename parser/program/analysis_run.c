/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What commands with an analysis do: open, compute with progress, write the files of -o, print, draw. */
#include "engine/output/file.h"
#include "engine/output/result_values.h"
#include "engine/output/results.h"
#include "parser/program/command/analyses.h"
#include "parser/program/commands.h"
#include "parser/program/open_model.h"
#include "parser/program/options.h"
#include "parser/program/progress.h"
#include "parser/program/streams.h"

static size_t file_count(const strut_output_file *file) { return file->most ? file->most : 1; }

/* The name of a file, or of a numbered picture; NULL: memory is out. */
static const char *name_file(strut_arena *arena, const strut_output_file *file, size_t i) {
  return file->most ? strut_arena_format(arena, "%s-%zu.svg", file->name, i + 1) : file->name;
}

/* The names of all files, NULL after the last; NULL: memory is out. */
static const char *const *list_names(strut_arena *arena, const strut_output_file *files) {
  size_t count = 0, n = 0;
  for (const strut_output_file *file = files; file->name; file++) count += file_count(file);
  const char **names = strut_arena_allocate(arena, count + 1, sizeof *names);
  for (const strut_output_file *file = files; names && file->name; file++)
    for (size_t i = 0; i < file_count(file); i++)
      if (!(names[n++] = name_file(arena, file, i))) return NULL;
  return names;
}

static strut_status write_file(strut_analysis *a, const strut_output_file *file, size_t i,
                               const char *directory, const char *json, const strut_plot *plot,
                               strut_error *error) {
  const char *name = name_file(&a->arena, file, i);
  const strut_value_rows *rows = file->rows ? file->rows : a->kind->rows;
  if (file->there && !file->there(a, file->number + i)) return STRUT_OK;
  if (file->draw) {
    strut_plot own = file->width > 0.0 ? (strut_plot){.width = file->width} : *plot;
    own.path = strut_arena_format(&a->arena, "%s/%s", directory, name);
    return own.path ? file->draw(a, &own, file->number + i, error) : strut_no_memory(error, "");
  }
  if (file->csv || file->list)
    return strut_file_write_block(
        directory, name,
        file->csv ? file->csv(a) : strut_values_csv(rows, file->list, NULL, a->found, a->scene),
        error);
  return json ? strut_file_write_text(directory, name, json, error) : strut_no_memory(error, "");
}

/* Writes all files of -o or none. */
static strut_status write_files(strut_analysis *a, const char *directory, const char *json,
                                const strut_plot *plot, strut_error *error) {
  strut_results results = {0};
  const char *const *names = list_names(&a->arena, a->kind->files);
  strut_status status = names ? strut_results_begin_named(&results, directory, names, error)
                              : strut_no_memory(error, "");
  for (const strut_output_file *file = a->kind->files; !status && file->name; file++)
    for (size_t i = 0; i < file_count(file) && !status; i++)
      status = write_file(a, file, i, results.stage, json, plot, error);
  if (!status) status = strut_results_commit(&results, error);
  strut_results_abandon(&results);
  return status;
}

/* Writes the files and prints the CSV, the JSON or the table. */
static strut_status report(strut_analysis *a, const strut_arguments *arguments,
                           const strut_plot *plot, strut_error *error) {
  /* Of large structures the JSON takes long to make. */
  char *json = arguments->json || arguments->output ? strut_analysis_json(a) : NULL;
  strut_status status = STRUT_OK;
  if (arguments->output) status = write_files(a, arguments->output, json, plot, error);
  if (!status && arguments->json) return strut_print_report(arguments, json);
  strut_release(json);
  if (status) return status;
  return strut_print_report(
      arguments, arguments->csv
                     ? strut_values_csv(a->kind->rows, a->kind->printed, NULL, a->found, a->scene)
                     : strut_analysis_text(a, strut_report_width(arguments)));
}

/* Finds out, before anything is computed, whether the files can go where -o and --plot want them. */
static strut_status check_files(strut_analysis *a, const strut_arguments *arguments,
                                strut_plot *plot) {
  const strut_output_file *files = a->kind->files;
  const char *const *names = files ? list_names(&a->arena, files) : NULL;
  strut_status status = strut_plot_read(arguments, a->kind->width, plot);
  if (status) return status;
  if (arguments->json && arguments->csv)
    return strut_usage_error(arguments, "give either --json or --csv, not both");
  if (!files) return strut_try_file(arguments->output);
  return names ? strut_check_output_writable(arguments, names) : strut_print_out_of_memory();
}

strut_status strut_analysis_open(strut_analysis *a, char **text) {
  strut_open_report kept = {.prints = true};
  strut_status status = strut_open_model(a->arguments, STRUT_OPEN_FOR_STATICS, a->setup, &kept);
  a->scenes.text = *text = kept.text;
  a->scenes.length = kept.length;
  return status;
}

/* Computes, shows what was found, and says what is doubtful. */
static strut_status compute(strut_analysis *a, const strut_arguments *arguments,
                            const strut_plot *plot, strut_error *error) {
  strut_progress progress = strut_progress_begin(arguments->quiet);
  a->interrupt = a->kind->asks ? strut_interrupt_watch() : NULL;
  a->progress = progress.wanted ? strut_progress_show : NULL;
  a->progress_context = &progress;
  const strut_status computed = strut_analysis_compute(a, error);
  strut_progress_end(&progress);
  if (computed && !a->partial) return computed;
  strut_print_failure(computed, error);
  *error = (strut_error){0};
  strut_status status = arguments->command->report ? arguments->command->report(a, arguments, error)
                                                   : report(a, arguments, plot, error);
  if (!status && a->kind->warn) a->kind->warn(a, arguments->listener);
  if (!status && plot->path) status = a->kind->draw(a, plot, error);
  if (!status && a->kind->verdict) status = a->kind->verdict(a, error);
  return computed ? computed : status;
}

strut_status strut_analysis_run(const strut_arguments *arguments) {
  const strut_command *command = arguments->command;
  strut_setup setup = {0};
  strut_plot plot;
  strut_model *model = NULL;
  char *text = NULL;
  strut_error error = {0};
  strut_analysis a = {.kind = command->analysis,
                      .arguments = arguments,
                      .setup = &setup,
                      .scenes = {.file = strut_model_name(arguments)}};
  strut_status status = check_files(&a, arguments, &plot);
  if (!status) status = command->open ? command->open(&a, &text) : strut_analysis_open(&a, &text);
  if (!status && !a.kind->uncompiled) status = strut_model_compile(&setup.scene, &model, &error);
  a.model = model;
  if (!status) status = compute(&a, arguments, &plot, &error);
  if (status && error.message[0]) strut_print_error(&error);
  strut_analysis_free(&a);
  strut_model_free(model);
  strut_release(text);
  strut_setup_free(&setup);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `strut export --format scene`: a model, or another program's file, as a scene. */
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "parser/import/import.h"
#include "parser/program/commands.h"
#include "parser/program/open_model.h"
#include "parser/program/options.h"
#include "parser/program/streams.h"
#include "parser/read/read_scene.h"
#include "parser/write/write_scene.h"

static strut_status put_scene(const strut_arguments *arguments, const char *text) {
  strut_error error = {0};
  if (!arguments->output) return strut_print(text);
  return strut_print_failure(strut_file_write_path(arguments->output, text, &error), &error);
}

/* The scene as short as the file gave it, or the flat one where that cannot be kept. */
static strut_status write_parts(const strut_arguments *arguments) {
  strut_setup setup;
  char *text, *result = NULL;
  size_t length;
  strut_status status = strut_open_model_text(arguments, &text, &length, &setup);
  if (status != STRUT_OK) return status;
  char *flat = strut_setup_write(&setup);
  if (!flat) status = strut_print_out_of_memory();
  if (flat) status = strut_write_short(arguments, text, length, flat, &setup, true, &result);
  if (status == STRUT_OK) status = put_scene(arguments, result ? result : flat);
  strut_release(result);
  strut_release(flat);
  strut_release(text);
  strut_setup_free(&setup);
  return status;
}

static strut_status write_flat(const strut_arguments *arguments) {
  strut_setup setup;
  strut_status status = strut_open_model(arguments, STRUT_OPEN_AS_RUN, &setup);
  if (status != STRUT_OK) return status;
  char *text = strut_setup_write(&setup);
  status = text ? put_scene(arguments, text) : strut_print_out_of_memory();
  strut_release(text);
  strut_setup_free(&setup);
  return status;
}

enum { MOST_MESSAGES = 50, MOST_FILES = 16 };

static strut_status read_files(const strut_arguments *a, strut_import_file *files) {
  strut_error error = {0};
  for (size_t i = 0; i < a->model_count; i++) {
    files[i].name = strcmp(a->models[i], "-") == 0 ? "<stdin>" : a->models[i];
    strut_status status = strut_file_read(a->models[i], &files[i].text, &files[i].length, &error);
    if (status) return strut_print_failure(status, &error);
  }
  return STRUT_OK;
}

/* The format that is given, or else that of the first file, which has one. */
static strut_status find_format(const strut_arguments *a, const strut_import_file *file,
                                int *format) {
  static const char *const words[] = {
#define WORD(name, word, title) word,
      STRUT_IMPORT_FORMATS(WORD)
#undef WORD
          NULL};
  if (strut_option_text(a, STRUT_OPTION_INPUT))
    return strut_option_word(&strut_command_export, a, STRUT_OPTION_INPUT, words, format);
  *format = strut_import_guess(file->text, file->length);
  return STRUT_OK;
}

static void print_messages(strut_diagnostics *d) {
  const char *messages = d->count ? strut_diagnostics_render(d, MOST_MESSAGES) : "";
  const char *notes = d->note_count ? strut_diagnostics_render_notes(d) : "";
  if (messages) fputs(messages, stderr);
  if (notes) fputs(notes, stderr);
  if (!messages || !notes) strut_print_out_of_memory();
}

static strut_status import_files(const strut_arguments *a, strut_import_file *files, double unit) {
  strut_error error = {0};
  strut_diagnostics result = {0};
  char *scene = NULL;
  int format = 0;
  strut_status status = find_format(a, &files[0], &format);
  if (status) return status;
  status = strut_import((strut_import_format)format, files, a->model_count, unit, &scene, &result,
                        &error);
  for (size_t i = 0; i < a->model_count; i++) print_messages(&files[i].diagnostics);
  print_messages(&result);
  if (error.message[0]) strut_print_error(&error);
  if (!status) status = put_scene(a, scene);
  strut_diagnostics_free(&result);
  strut_release(scene);
  return status;
}

static strut_status run_import(const strut_arguments *arguments) {
  const strut_command *command = &strut_command_export;
  strut_import_file files[MOST_FILES] = {{0}};
  double unit = 0.0;
  if (arguments->model_count > MOST_FILES)
    return strut_print_usage_error(command, "unexpected argument '%s'",
                                   arguments->models[MOST_FILES]);
  strut_status status =
      strut_option_number(command, arguments, STRUT_OPTION_UNIT, STRUT_DIM_LENGTH, &unit);
  if (!status && strut_option_text(arguments, STRUT_OPTION_UNIT) && !(unit > 0.0))
    status = strut_print_usage_error(command, "--unit expects a length above 0, such as 1 cm");
  if (!status) status = read_files(arguments, files);
  if (!status) status = import_files(arguments, files, unit);
  strut_import_files_free(files, MOST_FILES);
  return status;
}

/* Is the file one of another program's? */
static bool is_foreign(const char *path) {
  strut_error error = {0};
  char *text = NULL;
  size_t length;
  if (strcmp(path, "-") == 0 || strut_file_read(path, &text, &length, &error) != STRUT_OK)
    return false;
  bool own = strncmp(text, "strut:", 6) == 0 || strstr(text, "\nstrut:");
  int format = own ? -1 : strut_import_guess(text, length);
  strut_release(text);
  return format >= 0;
}

strut_status strut_export_scene(const strut_arguments *arguments) {
  const strut_command *command = &strut_command_export;
  struct stat found;
  if (stat(arguments->model, &found) == 0 && S_ISDIR(found.st_mode))
    return strut_print_usage_error(command, "a run needs --format vtk; its scene is %s/scene.yaml",
                                   arguments->model);
  bool foreign = strut_option_text(arguments, STRUT_OPTION_INPUT) || is_foreign(arguments->model);
  if (foreign && (arguments->override_count || arguments->parts))
    return strut_print_usage_error(
        command, "--set and --parts are for strut's models, not for other programs' files");
  if (foreign) return run_import(arguments);
  if (strut_option_text(arguments, STRUT_OPTION_UNIT))
    return strut_print_usage_error(command, "--unit is for other programs' files");
  if (arguments->model_count > 1)
    return strut_print_usage_error(command, "unexpected argument '%s'", arguments->models[1]);
  return arguments->parts ? write_parts(arguments) : write_flat(arguments);
}

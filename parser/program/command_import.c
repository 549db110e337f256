/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <stdio.h>
#include <string.h>

#include "engine/output/file.h"
#include "parser/import/import.h"
#include "parser/program/commands.h"
#include "parser/program/options.h"
#include "parser/program/streams.h"
#include "parser/read/read_scene.h"

enum { MOST_MESSAGES = 50, MOST_FILES = 16 };

static const strut_option options[] = {
    {STRUT_OPTION_FORMAT, "format", "FORMAT",
     "ntrt, tensegritysim, springable or tables (default: found out)"},
    {STRUT_OPTION_OUTPUT, "output", "FILE", "write the scene into FILE (default: print it)"},
    {STRUT_OPTION_UNIT, "unit", "LENGTH",
     "unit of length of the file (default: 1 dm of ntrt, otherwise 1 m)"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_status read_files(const strut_arguments *a, strut_import_file *files) {
  strut_error error = {0};
  for (size_t i = 0; i < a->model_count; i++) {
    files[i].name = strcmp(a->models[i], "-") == 0 ? "<stdin>" : a->models[i];
    strut_status status = strut_file_read(a->models[i], &files[i].text, &files[i].length, &error);
    if (status) return strut_print_failure(status, &error);
  }
  return STRUT_OK;
}

/* The format that is given, or that the first file has. */
static strut_status find_format(const strut_arguments *a, const strut_import_file *file,
                                int *format) {
  static const char *const words[] = {
#define WORD(name, word, title) word,
      STRUT_IMPORT_FORMATS(WORD)
#undef WORD
          NULL};
  if (strut_option_text(a, STRUT_OPTION_FORMAT))
    return strut_option_word(&strut_command_import, a, STRUT_OPTION_FORMAT, words, format);
  *format = strut_import_guess(file->text, file->length);
  if (*format >= 0) return STRUT_OK;
  fprintf(stderr,
          "strut: error: '%s' looks like none of the formats that are known: give --format ntrt, "
          "tensegritysim, springable or tables\n",
          file->name);
  return STRUT_BAD_SCENE;
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
  if (!status && a->output)
    status = strut_print_failure(strut_file_write_path(a->output, scene, &error), &error);
  else if (!status)
    status = strut_print(scene);
  strut_diagnostics_free(&result);
  strut_release(scene);
  return status;
}

static strut_status run_import(const strut_arguments *arguments) {
  const strut_command *command = &strut_command_import;
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

const strut_command strut_command_import = {
    .name = "import",
    .model = "FILE [FILE]...",
    .many = true,
    .summary = "makes a scene of another program's file",
    .details =
        "\nFILE is a structure in NTRT's or TensegritySim's YAML or in springable's CSV; or two\n"
        "tables, of nodes (node,x [m],y [m],fixed,mass [kg]) and of members (member,kind,from,to,\n"
        "stiffness [N/m],rest length [m],...). What strut cannot say is listed with its place, "
        "what\n"
        "cannot be read is an error, and then nothing is written.\n",
    .options = options,
    .run = run_import,
};

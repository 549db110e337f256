/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `strut write` and `strut fmt`: a model as a text. */
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "parser/program/commands.h"
#include "parser/program/installed.h"
#include "parser/program/open_model.h"
#include "parser/program/streams.h"
#include "parser/write/write_scene.h"
#include "parser/yaml/document.h"
#include "parser/yaml/layout.h"

static const strut_option options[] = {
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    {STRUT_OPTION_PARTS, "parts", NULL, "keep parameters, groups and parts; files are written out"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

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
  if (status == STRUT_OK) status = strut_print(result ? result : flat);
  strut_release(result);
  strut_release(flat);
  strut_release(text);
  strut_setup_free(&setup);
  return status;
}

static strut_status run_write(const strut_arguments *arguments) {
  strut_setup setup;
  if (arguments->parts) return write_parts(arguments);
  strut_status status = strut_open_model(arguments, STRUT_OPEN_AS_RUN, &setup);
  if (status != STRUT_OK) return status;
  status = strut_print_block(strut_setup_write(&setup));
  strut_setup_free(&setup);
  return status;
}

const strut_command strut_command_write = {
    .name = "write",
    .model = "MODEL",
    .summary = "prints the scene that a run would use",
    .details =
        "\nParameters, groups and units are resolved: every value appears where it is used, in SI\n"
        "units. A run of the printed scene gives bit-identical results.\n"
        "--parts prints the scene as short as it was given, in one file: with its parameters (as\n"
        "--set changed them), groups and parts, and with what its base and its parts' files hold.\n"
        "Comments are lost.\n",
    .options = options,
    .run = run_write,
};

enum { MOST_MESSAGES = 50 };

/* What YAML itself finds wrong in the text is shown as by other commands. */
static strut_status print_syntax(const char *name, const char *text, size_t length) {
  strut_diagnostics diagnostics = {0};
  strut_document document = {.root = NULL};
  strut_diagnostics_source(&diagnostics, name, text, length);
  strut_status status = strut_document_read(&document, &diagnostics);
  if (status == STRUT_BAD_SCENE) {
    const char *messages = strut_diagnostics_render(&diagnostics, MOST_MESSAGES);
    if (messages) fputs(messages, stderr);
    if (!messages) status = STRUT_NO_MEMORY;
  }
  if (status == STRUT_NO_MEMORY) strut_print_out_of_memory();
  strut_document_free(&document);
  strut_diagnostics_free(&diagnostics);
  return status;
}

/* The text of a file in its layout; messages are printed. */
static strut_status lay_out(const char *path, char **text, char **result) {
  strut_error error = {0};
  size_t length;
  const char *name = strcmp(path, "-") == 0 ? "<stdin>" : path;
  strut_status status = strut_file_read(path, text, &length, &error);
  if (status != STRUT_OK) return strut_print_failure(status, &error);
  status = print_syntax(name, *text, length);
  if (status != STRUT_OK) return status;
  status = strut_layout_text(*text, length, result, &error);
  if (status == STRUT_BAD_SCENE)
    fprintf(stderr, "%s: error: %s\n", name, error.message);
  else
    strut_print_failure(status, &error);
  return status;
}

static strut_status format_file(const strut_arguments *arguments, const char *path, bool *differs) {
  char *text = NULL, *result = NULL;
  strut_error error = {0};
  strut_status status = lay_out(path, &text, &result);
  bool same = status == STRUT_OK && strcmp(text, result) == 0;
  bool input = strcmp(path, "-") == 0;
  if (status == STRUT_OK && !same) *differs = true;
  if (status != STRUT_OK) {
    /* it was reported */
  } else if (arguments->check) {
    if (!same && !arguments->quiet) printf("%s\n", input ? "<stdin>" : path);
  } else if (input) {
    status = strut_print(result);
  } else if (!same) {
    status = strut_replace_file(path, result, strlen(result), &error);
    strut_print_failure(status, &error);
    if (status == STRUT_OK && !arguments->quiet) printf("%s\n", path);
  }
  strut_release(text);
  strut_release(result);
  return status;
}

/* All files, whatever is wrong with one of them; the worst status. */
static strut_status run_fmt(const strut_arguments *arguments) {
  strut_status worst = STRUT_OK;
  bool differs = false;
  for (size_t i = 0; i < arguments->model_count; i++) {
    strut_status status = format_file(arguments, arguments->models[i], &differs);
    if (strut_status_exit_code(status) > strut_status_exit_code(worst)) worst = status;
  }
  return worst == STRUT_OK && arguments->check && differs ? STRUT_BAD_SCENE : worst;
}

static const strut_option fmt_options[] = {
    {STRUT_OPTION_CHECK, "check", NULL, "only list files that would change; exit code 2 if any"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

const strut_command strut_command_fmt = {
    .name = "fmt",
    .model = "MODEL",
    .many = true,
    .summary = "sets models and studies in the canonical layout",
    .details =
        "\nChanges indentation, blanks and blank lines, nothing else: comments, quotes, the order "
        "of keys\n"
        "and the places where lines break stay. A file is replaced as a whole, after its new text "
        "was\n"
        "read again and says the same; a file that cannot be kept so is left as it is. Prints the "
        "names\n"
        "of changed files. With - as MODEL it is a filter, from standard input to standard "
        "output.\n",
    .options = fmt_options,
    .run = run_fmt,
};

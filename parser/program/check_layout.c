/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `strut check --layout`: models and studies in the canonical layout. */
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "parser/program/commands.h"
#include "parser/program/installed.h"
#include "parser/program/streams.h"
#include "parser/yaml/document.h"
#include "parser/yaml/layout.h"

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
  if (status == STRUT_OK && !same && !input) *differs = true;
  if (status != STRUT_OK) {
    /* it was reported */
  } else if (!arguments->fix && !input) {
    if (!same && !arguments->quiet) printf("%s\n", path);
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
static strut_status run_layout(const strut_arguments *arguments) {
  strut_status worst = STRUT_OK;
  bool differs = false;
  for (size_t i = 0; i < arguments->model_count; i++) {
    strut_status status = format_file(arguments, arguments->models[i], &differs);
    if (strut_status_exit_code(status) > strut_status_exit_code(worst)) worst = status;
  }
  return worst == STRUT_OK && !arguments->fix && differs ? STRUT_BAD_SCENE : worst;
}

static const strut_option options[] = {
    {STRUT_OPTION_SELECTOR, "layout", NULL, "list files that are not in the canonical layout"},
    {STRUT_OPTION_FIX, "fix", NULL, "rewrite them"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

const strut_command strut_command_layout = {
    .name = "check --layout",
    .model = "MODEL",
    .many = true,
    .summary = "lists models and studies that are not in the canonical layout",
    .details =
        "\nExit code 2 if there are any. With --fix they are rewritten: indentation, blanks and "
        "blank\n"
        "lines change, nothing else. Comments, quotes, the order of keys and the places where "
        "lines\n"
        "break stay. A file is replaced as a whole, after its new text was read again and says "
        "the\n"
        "same; a file that cannot be kept so is left alone. With - as MODEL it is a filter from\n"
        "standard input to standard output.\n",
    .options = options,
    .run = run_layout,
};

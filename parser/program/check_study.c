/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/check_study.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "parser/program/check_messages.h"
#include "parser/program/streams.h"
#include "parser/program/sweep.h"
#include "parser/read/reader.h"

/* Larger files are models. */
enum { LARGEST = 16 << 20 };

/* A line that begins with the key, so that models, which may be large, are not read twice. */
static bool names_study(const char *text) {
  for (const char *line = text; line; line = strchr(line, '\n')) {
    if (*line == '\n') line++;
    if (strncmp(line, "study:", 6) == 0 || strncmp(line, "{", 1) == 0) return true;
  }
  return false;
}

bool strut_is_study(const char *path) {
  struct stat found;
  strut_error error = {0};
  strut_document document = {.root = NULL};
  strut_diagnostics unused = {0};
  char *text = NULL;
  size_t length;
  bool study = false;
  bool file = stat(path, &found) == 0 && S_ISREG(found.st_mode) && found.st_size <= LARGEST;
  if (!file || strut_file_read(path, &text, &length, &error) != STRUT_OK) return false;
  if (names_study(text)) {
    strut_diagnostics_source(&unused, path, text, length);
    strut_document_read(&document, &unused);
    study = document.root && strut_tree_is_study(document.root);
  }
  strut_document_free(&document);
  strut_diagnostics_free(&unused);
  strut_release(text);
  return study;
}

/* Options of a model, which the points of a study would not have. */
static strut_status refuse_options(const strut_command *command, const strut_arguments *arguments) {
  for (size_t i = 0; strut_option_at(command, i); i++) {
    const strut_option *option = strut_option_at(command, i);
    bool text = option->id >= STRUT_OPTION_TEXTS && option->id < STRUT_OPTION_TEXTS_END;
    if (text && strut_option_text(arguments, option->id))
      return strut_print_usage_error(command, "--%s needs a model, not the study '%s'",
                                     option->name, arguments->model);
  }
  return STRUT_OK;
}

static strut_status print_json(strut_sweep_study *study, strut_status status,
                               const strut_error *error) {
  strut_json json = strut_json_begin();
  strut_study_file *file = &study->file;
  strut_json_bool(&json, json.root, "valid", status == STRUT_OK);
  strut_json_text(&json, json.root, "study", status == STRUT_OK ? file->study.name : NULL);
  strut_json_number(&json, json.root, "points",
                    status == STRUT_OK ? (double)study->plan.points : (double)NAN);
  struct cJSON *messages = strut_json_array(&json, json.root, "messages");
  strut_add_diagnostics(&json, messages, &file->diagnostics);
  for (size_t i = 0; i < file->table_count; i++)
    strut_add_diagnostics(&json, messages, &file->tables[i].diagnostics);
  if (file->model_diagnostics.file)
    strut_add_diagnostics(&json, messages, &file->model_diagnostics);
  if (status != STRUT_OK && error->message[0])
    strut_add_message(&json, messages, file->path, "error", error->message);
  return strut_print_block(strut_json_end(&json));
}

strut_status strut_check_study(const strut_command *command, const strut_arguments *arguments) {
  strut_sweep_study study = {.plan = {0}};
  strut_error error = {0};
  strut_status status = refuse_options(command, arguments);
  if (status != STRUT_OK) return status;
  status = strut_sweep_study_try(arguments, &study, &error);
  bool reported = status == STRUT_OK || status == STRUT_BAD_SCENE;
  if (arguments->json && reported) {
    strut_status printed = print_json(&study, status, &error);
    if (printed != STRUT_OK) status = printed;
  } else if (status != STRUT_OK) {
    strut_sweep_study_report(&study, status, &error);
  } else if (!arguments->quiet) {
    printf("%s: valid\n  points             %" PRId64 "\n", study.file.study.name,
           study.plan.points);
  }
  strut_sweep_study_close(&study);
  return status;
}

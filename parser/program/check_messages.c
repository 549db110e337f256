/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/check_messages.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "parser/program/streams.h"
#include "parser/program/sweep.h"
#include "parser/read/reader.h"
#include "parser/yaml/document.h"

static void add_place(strut_json *json, struct cJSON *row, const char *file, strut_place place) {
  strut_json_text(json, row, "file", file);
  strut_json_integer(json, row, "line", place.line ? place.line : 1);
  strut_json_integer(json, row, "column", place.line && place.column ? place.column : 1);
  strut_json_integer(json, row, "length", place.line ? place.length : 0);
}

/* A suggestion at the end of a message is a hint of its own. */
static struct cJSON *add_row(strut_json *json, struct cJSON *to, const char *file,
                             strut_place place, const char *severity, const char *message) {
  char text[1000];
  struct cJSON *row = strut_json_object(json, to, NULL);
  const char *hint = strstr(message, "; did you mean ");
  size_t length = hint ? (size_t)(hint - message) : strlen(message);
  if (length >= sizeof text) length = sizeof text - 1;
  memcpy(text, message, length);
  text[length] = '\0';
  add_place(json, row, file, place);
  strut_json_text(json, row, "severity", severity);
  strut_json_text(json, row, "message", text);
  strut_json_text(json, row, "hint", hint ? hint + 2 : NULL);
  return row;
}

static void add_diagnostic(strut_json *json, struct cJSON *to, const strut_diagnostics *all,
                           const char *severity, const strut_diagnostic *item) {
  struct cJSON *row = add_row(json, to, strut_diagnostics_file(all, item->place), item->place,
                              severity, item->message);
  struct cJSON *notes = strut_json_array(json, row, "notes");
  for (size_t k = 0; k < STRUT_MESSAGE_NOTES && item->note[k]; k++) {
    struct cJSON *note = strut_json_object(json, notes, NULL);
    strut_place place = item->note_place[k];
    add_place(json, note, strut_diagnostics_file(all, place), place);
    strut_json_text(json, note, "message", item->note[k]);
  }
}

void strut_add_diagnostics(strut_json *json, struct cJSON *to, strut_diagnostics *diagnostics) {
  strut_diagnostics_sort(diagnostics);
  for (size_t i = 0; i < diagnostics->count; i++)
    add_diagnostic(json, to, diagnostics, "error", &diagnostics->items[i]);
  for (size_t i = 0; i < diagnostics->note_count; i++)
    add_diagnostic(json, to, diagnostics, "note", &diagnostics->notes[i]);
}

void strut_add_message(strut_json *json, struct cJSON *to, const char *file, const char *severity,
                       const char *message) {
  const strut_place whole = {.line = 0};
  strut_json_array(json, add_row(json, to, file, whole, severity, message), "notes");
}

static const strut_tree *map_below(const strut_tree *tree, const char *name, strut_tree **key) {
  if (!tree || tree->kind != STRUT_TREE_MAP) return NULL;
  return strut_tree_find(tree, name, key);
}

/*
 * The entry of a map with that name. A thing of a copy, "legs.2.foot", is where its part has it, as far
 * as parts are named in a line of their own; else where the copies are placed.
 */
static strut_tree *entry_of(const strut_tree *root, const strut_tree *tree, const char *map,
                            const char *name) {
  strut_tree *key = NULL, *placed = NULL;
  if (map_below(map_below(tree, map, NULL), name, &key)) return key;
  const strut_tree *place = map_below(tree, "place", NULL);
  if (!place || place->kind != STRUT_TREE_MAP) return NULL;
  size_t length = 0; /* of the placement's name: the longest that begins the thing's */
  for (strut_tree *at = place->first; at; at = at->next->next) {
    size_t n = strlen(at->text);
    if (n > length && strncmp(at->text, name, n) == 0 && name[n] == '.') placed = at, length = n;
  }
  if (!placed) return NULL;
  const strut_tree *part = map_below(placed->next, "part", NULL);
  part = part && part->kind == STRUT_TREE_SCALAR
             ? map_below(map_below(root, "parts", NULL), part->text, NULL)
             : NULL;
  const char *rest = name + length + 1;
  if (rest[0] >= '0' && rest[0] <= '9' && strchr(rest, '.')) rest = strchr(rest, '.') + 1;
  strut_tree *within = part ? entry_of(root, part, map, rest) : NULL;
  return within ? within : placed;
}

/* The name of the thing that a finding is about, in the text; line 0 where it is not there. */
static strut_place place_of(const strut_finding *finding, const strut_scene *scene,
                            const strut_tree *root) {
  const strut_place whole = {.line = 0};
  const char *map = NULL, *name = NULL;
  if (finding->subject == STRUT_ON_NODE)
    map = "nodes", name = scene->nodes[finding->index].name;
  else if (finding->subject == STRUT_ON_MEMBER)
    map = "members", name = scene->members[finding->index].name;
  const strut_tree *key = map ? entry_of(root, root, map, name) : NULL;
  return key ? key->place : whole;
}

void strut_add_warnings(strut_json *json, struct cJSON *to, const strut_findings *found,
                        const strut_scene *scene, const strut_diagnostics *source) {
  strut_document document = {.root = NULL};
  strut_diagnostics again = {0};
  if (!found->count) return;
  strut_diagnostics_source(&again, source->file, source->text, source->length);
  if (strut_document_read(&document, &again) == STRUT_NO_MEMORY) json->failed = true;
  for (size_t i = 0; i < found->count; i++) {
    strut_place place = place_of(&found->items[i], scene, document.root);
    strut_json_array(
        json, add_row(json, to, source->file, place, "warning", found->items[i].message), "notes");
  }
  strut_document_free(&document);
  strut_diagnostics_free(&again);
}

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

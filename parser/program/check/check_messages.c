/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/check/check_messages.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "engine/base/memory.h"
#include "engine/integrate/integrator.h"
#include "engine/run/measure/monitors.h"
#include "parser/language/read/reader.h"
#include "parser/language/yaml/document.h"
#include "parser/program/study/sweep.h"

#define LOCATED(X)                                                                                 \
  X("file", "", TEXT(at->file), "that it is about")                                                \
  X("line", "", COUNT(at->place.line ? at->place.line : 1), "from 1")                              \
  X("column", "", COUNT(at->place.line && at->place.column ? at->place.column : 1),                \
    "code point, from 1")                                                                          \
  X("length", "", COUNT(at->place.line ? at->place.length : 0), "code points; 0: of the file")     \
  X("message", "", TEXT(at->text), "one sentence")
#define MESSAGE(X)                                                                                 \
  LOCATED(X)                                                                                       \
  X("severity", "", TEXT(m->severity), "error, warning or note")                                   \
  X("hint", "", TEXT(m->hint), "a suggestion")                                                     \
  X("notes", "", LIST(m->note, m->note_count), "what else there is to say, and where",             \
    .rows = &note_values)
STRUT_VALUES_HERE(note_values, LOCATED, const strut_located *at = of->at)
STRUT_VALUES(strut_message_values, MESSAGE, const strut_message *m = of->at;
             const strut_located *at = &m->at)

/* A suggestion at the end of a message is a hint of its own. NULL: memory was out. */
static strut_message *add(strut_messages *to, const char *file, strut_place place,
                          const char *severity, const char *message) {
  const char *hint = strstr(message, "; did you mean ");
  size_t length = hint ? (size_t)(hint - message) : strlen(message);
  const char *text = strut_arena_text(&to->arena, message, length);
  strut_message *list = strut_reallocate(to->list, to->count + 1, sizeof *list);
  to->failed = to->failed || !text || !list;
  if (!list) return NULL;
  to->list = list;
  list[to->count] =
      (strut_message){{file, text, place}, severity, hint ? hint + 2 : NULL, 0, {{0}}};
  return &list[to->count++];
}

static void add_diagnostic(strut_messages *to, const strut_diagnostics *all, const char *severity,
                           const strut_diagnostic *item) {
  strut_message *message =
      add(to, strut_diagnostics_text(all, item->place).file, item->place, severity, item->message);
  for (size_t k = 0; message && k < STRUT_MESSAGE_NOTES && item->note[k]; k++)
    message->note[message->note_count++] = (strut_located){
        strut_diagnostics_text(all, item->note_place[k]).file, item->note[k], item->note_place[k]};
}

void strut_messages_add_diagnostics(strut_messages *to, strut_diagnostics *diagnostics) {
  strut_diagnostics_sort(diagnostics);
  for (size_t i = 0; i < diagnostics->count; i++)
    add_diagnostic(to, diagnostics, "error", &diagnostics->items[i]);
  for (size_t i = 0; i < diagnostics->note_count; i++)
    add_diagnostic(to, diagnostics, "note", &diagnostics->notes[i]);
}

void strut_messages_add_error(strut_messages *to, const char *file, const char *message) {
  const strut_place whole = {.line = 0};
  if (*message) add(to, file, whole, "error", message);
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

void strut_messages_add_warnings(strut_messages *to, const strut_findings *found,
                                 const strut_scene *scene, const strut_diagnostics *source) {
  strut_document document = {.root = NULL};
  strut_diagnostics again = {0};
  if (!found->count) return;
  strut_diagnostics_source(&again, source->file, source->text, source->length);
  if (strut_document_read(&document, &again) == STRUT_NO_MEMORY) to->failed = true;
  for (size_t i = 0; i < found->count; i++)
    add(to, source->file, place_of(&found->items[i], scene, document.root), "warning",
        found->items[i].message);
  strut_document_free(&document);
  strut_diagnostics_free(&again);
}

void strut_check_bands(const strut_model *model, const strut_experiment *experiment) {
  const strut_scene *scene = model->scene;
  const strut_integrator *method = strut_integrator_find(experiment->integrator);
  double needed = 0.0;
  int32_t first = -1, more = -1;
  for (int32_t i = 0; method && i < model->contacts.count; i++) {
    double here = strut_stick_band_needed(model, method, i, experiment->step);
    if (!(here * (1.0 - 1e-6) > model->contacts.entry[i].friction.stick_velocity)) continue;
    if (first < 0) first = i;
    if (here > needed) needed = here;
    more++;
  }
  if (first < 0) return;
  const strut_contact_entry *contact = &model->contacts.entry[first];
  char others[40] = "";
  if (more > 0) snprintf(others, sizeof others, " and %d more", (int)more);
  fprintf(stderr,
          "strut: warning: stick_velocity %s of node '%s'%s is narrower than the change of slip in "
          "one step of %s, so that sticking is a matter of chance; use stick_velocity >= %s, a "
          "smaller step, or a method with events\n",
          strut_quantity_of(contact->friction.stick_velocity, 5, "m/s").text,
          scene->nodes[contact->node].name, others,
          strut_quantity_of(experiment->step, 5, "s").text,
          strut_quantity_of(needed, 5, "m/s").text);
}

/* Larger files are models. */
enum { LARGEST = 16 << 20 };

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
  if (strstr(text, "study")) { /* so that models, which may be large, are not read twice */
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
static strut_status refuse_options(const strut_arguments *arguments) {
  const strut_option *option;
  for (size_t i = 0; (option = strut_option_row(arguments->command->options, i)); i++)
    if (strut_given_text(option, arguments))
      return strut_usage_error(arguments, "--%s needs a model, not the study '%s'", option->name,
                               arguments->model);
  return STRUT_OK;
}

static strut_status print_json(strut_sweep_study *study, strut_status status,
                               const strut_error *error) {
  strut_study_file *file = &study->file;
  strut_check_result checked = {.valid = status == STRUT_OK, .study = study};
  strut_messages_add_diagnostics(&checked.messages, &file->diagnostics);
  if (file->model_diagnostics.file)
    strut_messages_add_diagnostics(&checked.messages, &file->model_diagnostics);
  if (status != STRUT_OK) strut_messages_add_error(&checked.messages, file->path, error->message);
  return strut_check_print(&checked);
}

strut_status strut_check_study(const strut_arguments *arguments) {
  strut_sweep_study study = {.plan = {0}};
  strut_error error = {0};
  strut_status status = refuse_options(arguments);
  if (status != STRUT_OK) return status;
  status = strut_sweep_study_try(arguments, &study, &error);
  bool reported = status == STRUT_OK || status == STRUT_BAD_SCENE;
  if (arguments->json && reported) {
    strut_status printed = print_json(&study, status, &error);
    if (printed != STRUT_OK) status = printed;
  } else if (status != STRUT_OK) {
    strut_sweep_study_report(arguments->listener, &study, status, &error);
  } else if (!arguments->quiet) {
    printf("%s: valid\n  points             %" PRId64 "\n", study.file.study.name,
           study.plan.points);
  }
  strut_sweep_study_close(&study);
  return status;
}

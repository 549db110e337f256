/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/open_compared.h"

#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "parser/cli/streams.h"
#include "parser/read/difference.h"
#include "parser/read/read_scene.h"
#include "parser/write/write_scene.h"

enum { MOST_MESSAGES = 50 };

/* A model being read. */
typedef struct source {
  const char *path, *shown;
  char *text;
  size_t length;
  strut_override *known; /* (known_count) of --set: parameters that it has */
  size_t known_count;
} source;

/* ---- names ---- */

static bool is_taken(const strut_compared *compared, size_t count, const char *label) {
  for (size_t i = 0; i < count; i++)
    if (strcmp(compared->inputs[i].label, label) == 0) return true;
  return false;
}

/* The file's name without its folder and ending; else its path; else that with a number. */
static const char *label_of(strut_compared *compared, size_t number, const char *path) {
  const char *slash = strrchr(path, '/'), *name = slash && slash[1] ? slash + 1 : path;
  if (strcmp(path, "-") == 0) name = "stdin";
  size_t length = strlen(name);
  const char *dot = strrchr(name, '.');
  if (dot && dot > name && (strcmp(dot, ".yaml") == 0 || strcmp(dot, ".yml") == 0))
    length = (size_t)(dot - name);
  const char *label = strut_arena_text(&compared->arena, name, length);
  if (label && is_taken(compared, number, label))
    label = strut_arena_format(&compared->arena, "%s", path);
  for (int k = 2; label && is_taken(compared, number, label); k++)
    label = strut_arena_format(&compared->arena, "%s (%d)", path, k);
  return label;
}

/* ---- reading ---- */

static strut_status read_setup(const source *from, const strut_override *overrides, size_t count,
                               strut_setup *setup) {
  strut_diagnostics diagnostics = {0};
  strut_status status = strut_setup_read(setup, from->shown, from->text, from->length, overrides,
                                         count, STRUT_FOR_ANY, &diagnostics);
  if (status == STRUT_BAD_SCENE) {
    const char *messages = strut_diagnostics_render(&diagnostics, MOST_MESSAGES);
    if (messages) fputs(messages, stderr);
    if (!messages) status = STRUT_NO_MEMORY;
  }
  if (status == STRUT_NO_MEMORY) strut_print_out_of_memory();
  strut_diagnostics_free(&diagnostics);
  return status;
}

static bool has_parameter(const strut_scene *scene, const char *name) {
  for (size_t i = 0; i < scene->parameter_count; i++)
    if (strcmp(scene->parameters[i].name, name) == 0) return true;
  return false;
}

/* Sorts what is set into what the model has and what it has not. */
static strut_status sort_settings(const strut_arguments *arguments, const strut_scene *scene,
                                  strut_compared *compared, size_t number, source *from) {
  size_t count = arguments->override_count;
  strut_compare_input *input = &compared->inputs[number];
  const char **without = strut_arena_allocate(&compared->arena, count + 1, sizeof *without);
  from->known = strut_arena_allocate(&compared->arena, count + 1, sizeof *from->known);
  if (!without || !from->known) return strut_print_out_of_memory();
  for (size_t i = 0; i < count; i++) {
    if (has_parameter(scene, arguments->overrides[i].name))
      from->known[from->known_count++] = arguments->overrides[i];
    else
      without[input->without_count++] = arguments->overrides[i].name;
  }
  input->without = without;
  return STRUT_OK;
}

static strut_status open_one(const strut_arguments *arguments, strut_compared *compared,
                             size_t number) {
  const char *path = arguments->models[number];
  source from = {.path = path, .shown = strcmp(path, "-") == 0 ? "<stdin>" : path};
  strut_compare_input *input = &compared->inputs[number];
  strut_setup *setup = &compared->setups[number];
  strut_error error = {0};
  input->setup = setup;
  input->label = label_of(compared, number, path);
  if (!input->label) return strut_print_out_of_memory();
  strut_status status = strut_file_read(path, &from.text, &from.length, &error);
  if (status != STRUT_OK) {
    strut_print_error(&error);
    return status;
  }
  status = read_setup(&from, NULL, 0, setup);
  if (status == STRUT_OK) status = sort_settings(arguments, &setup->scene, compared, number, &from);
  if (status == STRUT_OK && from.known_count > 0) {
    strut_setup_free(setup);
    status = read_setup(&from, from.known, from.known_count, setup);
  }
  strut_release(from.text);
  return status;
}

/* ---- all of them ---- */

/* Every parameter of all models, one after the other. */
static const char *parameter_at(const void *context, size_t i) {
  const strut_compared *compared = context;
  for (size_t k = 0; k < compared->count; k++) {
    if (i < compared->setups[k].scene.parameter_count)
      return compared->setups[k].scene.parameters[i].name;
    i -= compared->setups[k].scene.parameter_count;
  }
  return NULL;
}

static strut_status check_settings(const strut_command *command, const strut_arguments *arguments,
                                   const strut_compared *compared) {
  for (size_t i = 0; i < arguments->override_count; i++) {
    const char *name = arguments->overrides[i].name;
    bool known = false;
    for (size_t k = 0; k < compared->count; k++)
      known = known || has_parameter(&compared->setups[k].scene, name);
    if (known) continue;
    const char *near = strut_did_you_mean(name, parameter_at, compared);
    fprintf(stderr, "strut %s: --set %s: no model has such a parameter", command->name, name);
    if (near) fprintf(stderr, "; did you mean '%s'?", near);
    fputc('\n', stderr);
    return STRUT_USAGE;
  }
  return STRUT_OK;
}

/* Before starts are resolved, so that what was written is compared and not what follows from it. */
static strut_status find_differences(strut_compared *compared) {
  strut_status status = STRUT_OK;
  char *first = strut_setup_write(&compared->setups[0]);
  if (!first) return strut_print_out_of_memory();
  for (size_t i = 1; i < compared->count && status == STRUT_OK; i++) {
    strut_compare_input *input = &compared->inputs[i];
    strut_difference *list = NULL;
    char *text = strut_setup_write(&compared->setups[i]);
    status = text ? strut_text_differences(first, text, &compared->arena, &list,
                                           &input->difference_count)
                  : STRUT_NO_MEMORY;
    input->differences = list;
    strut_release(text);
    if (status != STRUT_OK) strut_print_out_of_memory();
  }
  strut_release(first);
  return status == STRUT_OK ? STRUT_OK : STRUT_NO_MEMORY;
}

static strut_status refuse(const strut_command *command, const strut_arguments *arguments) {
  size_t standard = 0;
  for (size_t i = 0; i < arguments->model_count; i++)
    standard += strcmp(arguments->models[i], "-") == 0;
  if (standard > 1) {
    fprintf(stderr, "strut %s: the standard input can be read once: give '-' once\n",
            command->name);
    return STRUT_USAGE;
  }
  if (arguments->model_count > STRUT_COMPARE_MOST) {
    fprintf(stderr, "strut %s: %zu models are more than the %d that it takes\n", command->name,
            arguments->model_count, STRUT_COMPARE_MOST);
    return STRUT_USAGE;
  }
  return STRUT_OK;
}

strut_status strut_compared_open(const strut_command *command, const strut_arguments *arguments,
                                 strut_compared *compared) {
  size_t count = arguments->model_count;
  strut_status status = refuse(command, arguments);
  *compared = (strut_compared){.count = 0};
  if (status != STRUT_OK) return status;
  compared->inputs = strut_arena_allocate(&compared->arena, count, sizeof *compared->inputs);
  compared->setups = strut_arena_allocate(&compared->arena, count, sizeof *compared->setups);
  if (!compared->inputs || !compared->setups) status = strut_print_out_of_memory();
  for (size_t i = 0; i < count && status != STRUT_NO_MEMORY; i++) {
    strut_status here = open_one(arguments, compared, i);
    compared->count = i + 1;
    if (status == STRUT_OK || here == STRUT_NO_MEMORY) status = here;
  }
  if (status == STRUT_OK) status = check_settings(command, arguments, compared);
  if (status == STRUT_OK) status = find_differences(compared);
  if (status != STRUT_OK) strut_compared_free(compared);
  return status;
}

void strut_compared_free(strut_compared *compared) {
  for (size_t i = 0; i < compared->count; i++) strut_setup_free(&compared->setups[i]);
  strut_arena_free(&compared->arena);
  *compared = (strut_compared){0};
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/open_model.h"

#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "parser/cli/streams.h"
#include "parser/read_scene.h"

enum { MOST_MESSAGES = 50 };

typedef struct source {
  const char *name;
  char *text;
  size_t length;
} source;

static strut_status read_for(const strut_arguments *arguments, const source *from,
                             strut_purpose purpose, strut_scene *scene,
                             strut_diagnostics *diagnostics) {
  return strut_scene_read(scene, from->name, from->text, from->length, arguments->overrides,
                          arguments->override_count, purpose, diagnostics);
}

static bool speaks_of_a_run(const strut_scene *scene) {
  const strut_experiment *experiment = &scene->experiment;
  return experiment->step != 0 || experiment->duration != 0 || experiment->periods != 0;
}

/* True where the scene is fine as long as nobody runs it, and it does not ask to be run. */
static bool read_for_statics(const strut_arguments *arguments, const source *from,
                             strut_scene *scene) {
  strut_diagnostics diagnostics = {0};
  strut_status status = read_for(arguments, from, STRUT_FOR_STATICS, scene, &diagnostics);
  strut_diagnostics_free(&diagnostics);
  if (status == STRUT_OK && !speaks_of_a_run(scene)) return true;
  if (status == STRUT_OK) strut_scene_free(scene);
  return false;
}

static strut_status read_source(const strut_arguments *arguments, const source *from,
                                strut_open_purpose purpose, strut_scene *scene) {
  strut_diagnostics diagnostics = {0};
  strut_status status = read_for(arguments, from, STRUT_FOR_RUN, scene, &diagnostics);
  if (status == STRUT_BAD_SCENE && purpose == STRUT_OPEN_FOR_ANY &&
      read_for_statics(arguments, from, scene)) {
    status = STRUT_OK;
  }
  if (status == STRUT_BAD_SCENE) {
    const char *messages = strut_diagnostics_render(&diagnostics, MOST_MESSAGES);
    if (messages) fputs(messages, stderr);
    if (!messages) status = STRUT_NO_MEMORY;
  }
  if (status == STRUT_NO_MEMORY) strut_complain_of_memory();
  strut_diagnostics_free(&diagnostics);
  return status;
}

strut_status strut_open_model(const strut_arguments *arguments, strut_open_purpose purpose,
                              strut_scene *scene) {
  source from = {.name = strcmp(arguments->model, "-") == 0 ? "<stdin>" : arguments->model};
  strut_error error = {0};
  strut_status status = strut_file_read(arguments->model, &from.text, &from.length, &error);
  if (status != STRUT_OK) {
    strut_complain(&error);
    return status;
  }
  status = read_source(arguments, &from, purpose, scene);
  strut_release(from.text);
  return status;
}

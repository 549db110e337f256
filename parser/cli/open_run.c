/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/open_run.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "parser/cli/streams.h"
#include "parser/read/read_scene.h"

static bool is_directory(const char *path) {
  struct stat found;
  if (strcmp(path, "-") == 0) return false; /* the standard input */
  return stat(path, &found) == 0 && S_ISDIR(found.st_mode);
}

/* directory/name in the arena, or NULL. */
static char *inside(strut_arena *arena, const char *directory, const char *name) {
  size_t length = strlen(directory);
  bool slash = length > 0 && directory[length - 1] == '/';
  return strut_arena_format(arena, "%s%s%s", directory, slash ? "" : "/", name);
}

/* A directory without what every run has was made by something else. */
static strut_status check_files(const char *directory, const char *scene, const char *trajectory,
                                strut_error *error) {
  struct stat found;
  bool described = stat(scene, &found) == 0, recorded = stat(trajectory, &found) == 0;
  if (!described) {
    return strut_fail(error, STRUT_FILE_TROUBLE,
                      "'%s' holds no run: there is no scene.yaml in it ('strut run MODEL -o DIR' "
                      "makes one)",
                      directory);
  }
  if (recorded) return STRUT_OK;
  return strut_fail(error, STRUT_FILE_TROUBLE,
                    "'%s' holds no recorded motion: there is no trajectory.h5 in it", directory);
}

static strut_status read_motion(const char *directory, size_t room, strut_opened *opened,
                                strut_error *error) {
  strut_status status =
      strut_trajectory_read(directory, &opened->setup.scene, room, &opened->motion, error);
  if (status != STRUT_OK) return status;
  if (opened->motion.position && opened->motion.frames > 0) return STRUT_OK;
  return strut_fail(error, STRUT_FILE_TROUBLE,
                    opened->motion.frames == 0
                        ? "the run in '%s' was over before anything was recorded"
                        : "the run in '%s' recorded no positions: its scene wants 'position' among "
                          "the channels of 'output'",
                    directory);
}

/* Everything about the run in a directory; the scene's own messages have been printed already. */
static strut_status open_directory(const strut_arguments *arguments, size_t room,
                                   strut_arena *arena, strut_opened *opened, strut_error *error) {
  const char *directory = arguments->model;
  char *scene = inside(arena, directory, "scene.yaml");
  char *trajectory = inside(arena, directory, "trajectory.h5");
  char *summary = inside(arena, directory, "summary.json");
  if (!scene || !trajectory || !summary) return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  strut_status status = check_files(directory, scene, trajectory, error);
  if (status != STRUT_OK) return status;
  strut_arguments inner = *arguments;
  inner.model = scene;
  status = strut_open_model(&inner, STRUT_OPEN_FOR_ANY, &opened->setup);
  if (status != STRUT_OK) return status;
  status = strut_model_compile(&opened->setup.scene, &opened->model, error);
  if (status == STRUT_OK) status = read_motion(directory, room, opened, error);
  size_t length = 0;
  struct stat found;
  if (status == STRUT_OK && stat(summary, &found) == 0)
    status = strut_file_read(summary, &opened->summary, &length, error);
  return status;
}

strut_status strut_open_run(const strut_command *command, const strut_arguments *arguments,
                            strut_open_purpose purpose, size_t room, strut_opened *opened) {
  strut_error error = {0};
  strut_arena arena = {0};
  *opened = (strut_opened){.run = is_directory(arguments->model)};
  if (opened->run && arguments->override_count > 0) {
    fprintf(stderr, "strut %s: what was run is run: --set needs a model instead of '%s'\n",
            command->name, arguments->model);
    return STRUT_USAGE;
  }
  strut_status status;
  if (opened->run) {
    status = open_directory(arguments, room, &arena, opened, &error);
  } else {
    status = strut_open_model(arguments, purpose, &opened->setup);
    if (status == STRUT_OK)
      status = strut_model_compile(&opened->setup.scene, &opened->model, &error);
  }
  if (status != STRUT_OK && error.status != STRUT_OK) strut_print_error(&error);
  if (status != STRUT_OK) strut_opened_free(opened);
  strut_arena_free(&arena);
  return status;
}

void strut_opened_free(strut_opened *opened) {
  strut_release(opened->summary);
  strut_trajectory_free(&opened->motion);
  strut_model_free(opened->model);
  strut_setup_free(&opened->setup);
  *opened = (strut_opened){0};
}

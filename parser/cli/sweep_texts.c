/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/sweep_texts.h"

#include <string.h>
#include <sys/stat.h>

#include "engine/output/file.h"
#include "engine/output/ownership.h"

/* A copy, and where it came from. */
typedef struct copy {
  const char *name, *source, *text;
  const char *study, *model; /* paths of both sources */
} copy;

enum { COPIES = 2 };
static const char model_name[] = "model.yaml";

static strut_status no_memory(strut_error *error) {
  return strut_fail(error, STRUT_NO_MEMORY, "out of memory");
}

static bool same_file(const char *a, const char *b) {
  struct stat first, second;
  return stat(a, &first) == 0 && stat(b, &second) == 0 && first.st_dev == second.st_dev &&
         first.st_ino == second.st_ino;
}

/* Whether a file has these bytes; one that cannot be read has not. */
static bool holds(const char *path, const char *text) {
  char *there = NULL;
  size_t length;
  bool same = strut_file_read(path, &there, &length, NULL) == STRUT_OK && length == strlen(text) &&
              memcmp(there, text, length) == 0;
  strut_release(there);
  return same;
}

/* Whether a file stands in a directory. */
static bool lies_in(const char *directory, const char *path, strut_arena *arena) {
  const char *slash = strrchr(path, '/');
  size_t length = slash == path ? 1 : slash ? (size_t)(slash - path) : 0;
  const char *folder = slash ? strut_arena_text(arena, path, length) : ".";
  return folder && same_file(directory, folder);
}

/* Does what stands in the way of a copy belong to somebody else? */
static strut_status check(const char *directory, const copy *c, strut_arena *arena,
                          strut_error *error) {
  struct stat found;
  char *path = strut_arena_format(arena, "%s/%s", directory, c->name);
  if (!path) return no_memory(error);
  if (stat(path, &found) != 0 || same_file(path, c->source) || holds(path, c->text))
    return STRUT_OK;
  if (!lies_in(directory, c->study, arena) && !lies_in(directory, c->model, arena))
    return strut_ownership_check_path(path, error);
  return strut_fail(error, STRUT_USAGE,
                    "'%s' is the folder of the study or its model, and the copy of '%s' that goes "
                    "with results would take the place of '%s': give another directory",
                    directory, c->source, path);
}

static strut_status write(const char *directory, const copy *c, strut_arena *arena,
                          strut_error *error) {
  char *path = strut_arena_format(arena, "%s/%s", directory, c->name);
  if (!path) return no_memory(error);
  if (same_file(path, c->source) || holds(path, c->text)) return STRUT_OK; /* it stands there */
  return strut_file_write_text(directory, c->name, c->text, error);
}

static strut_status for_each(const strut_arguments *arguments, const strut_sweep_study *study,
                             strut_status (*what)(const char *, const copy *, strut_arena *,
                                                  strut_error *),
                             strut_error *error) {
  strut_arena arena = {0};
  const strut_study_file *file = &study->file;
  char *text = strut_study_copy(file, model_name, arguments->overrides, arguments->override_count);
  const char *study_path = file->path, *model_path = file->model_path;
  const copy copies[COPIES] = {{"study.yaml", study_path, text, study_path, model_path},
                               {model_name, model_path, file->model_text, study_path, model_path}};
  strut_status status = text ? STRUT_OK : no_memory(error);
  for (int i = 0; i < COPIES && status == STRUT_OK; i++)
    status = what(arguments->output, &copies[i], &arena, error);
  strut_release(text);
  strut_arena_free(&arena);
  return status;
}

strut_status strut_sweep_texts_check(const strut_arguments *arguments,
                                     const strut_sweep_study *study, strut_error *error) {
  return for_each(arguments, study, check, error);
}

strut_status strut_sweep_texts_write(const strut_arguments *arguments,
                                     const strut_sweep_study *study, strut_error *error) {
  return for_each(arguments, study, write, error);
}

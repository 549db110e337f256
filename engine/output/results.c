/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/results.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "engine/output/ownership.h"

static const char *const run_names[] = {
    "summary.json", "scene.yaml",   "nodes.csv",  "members.csv",   "hinges.csv",
    "cells.csv",    "contacts.csv", "energy.csv", "trajectory.h5", NULL};

const char *strut_results_name(int i) { return run_names[i]; }

static strut_status trouble(strut_error *error, const char *path, int code) {
  char reason[128];
  if (strerror_r(code, reason, sizeof reason) != 0) {
    snprintf(reason, sizeof reason, "error %d", code);
  }
  return strut_fail(error, STRUT_FILE_TROUBLE, "cannot write '%s': %s", path, reason);
}

strut_status strut_results_begin(strut_results *results, const char *directory,
                                 strut_error *error) {
  return strut_results_begin_named(results, directory, run_names, error);
}

strut_status strut_results_begin_named(strut_results *results, const char *directory,
                                       const char *const *names, strut_error *error) {
  struct stat found;
  *results = (strut_results){.made = stat(directory, &found) != 0, .names = names};
  strut_status status = strut_directory_create(directory, error);
  if (status != STRUT_OK) return status;
  results->directory = strut_allocate(strlen(directory) + 1, 1);
  if (!results->directory) {
    if (results->made) rmdir(directory);
    return strut_no_memory(error, "while writing files");
  }
  memcpy(results->directory, directory, strlen(directory));
  status = strut_ownership_check(directory, names, error);
  if (status == STRUT_OK) status = strut_stage_create(&results->held, directory, error);
  results->stage = results->held.path;
  if (status != STRUT_OK) strut_results_abandon(results);
  return status;
}

/* Moves the file, or removes that of an earlier run if this one has none. 0 or an errno. */
static int move(const char *from, const char *to) {
  if (rename(from, to) == 0) return 0;
  if (errno != ENOENT) return errno;
  return unlink(to) == 0 || errno == ENOENT ? 0 : errno;
}

/* Memory for paths is allocated before the first move, so that then only the moves can fail. */
static int move_all(const strut_results *results) {
  size_t longest = 0;
  for (int i = 0; results->names[i]; i++)
    if (strlen(results->names[i]) > longest) longest = strlen(results->names[i]);
  size_t from_room = strlen(results->stage) + longest + 2;
  size_t to_room = strlen(results->directory) + longest + 2;
  char *from = strut_allocate(from_room, 1), *to = strut_allocate(to_room, 1);
  int code = from && to ? 0 : ENOMEM;
  for (int i = 0; results->names[i] && !code; i++) {
    snprintf(from, from_room, "%s/%s", results->stage, results->names[i]);
    snprintf(to, to_room, "%s/%s", results->directory, results->names[i]);
    code = move(from, to);
  }
  strut_release(from);
  strut_release(to);
  return code;
}

strut_status strut_results_commit(strut_results *results, strut_error *error) {
  strut_status status = strut_ownership_check(results->directory, results->names, error);
  if (status == STRUT_OK)
    status = strut_ownership_claim(results->directory, results->stage, results->names, error);
  int code = status == STRUT_OK ? move_all(results) : 0;
  if (code) status = trouble(error, results->directory, code);
  int descriptor = open(results->directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor >= 0) {
    if (fsync(descriptor) != 0 && errno == EIO && !code) {
      status = trouble(error, results->directory, EIO);
    }
    close(descriptor);
  }
  if (status == STRUT_OK) results->made = false;
  strut_results_abandon(results);
  return status;
}

void strut_results_abandon(strut_results *results) {
  strut_stage_remove(&results->held);
  if (results->made && results->directory) {
    strut_file_remove(results->directory, STRUT_OWNERSHIP_LIST);
    rmdir(results->directory);
  }
  strut_release(results->directory);
  *results = (strut_results){0};
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/results.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/checksum.h"
#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "engine/scene/observables.h"

#define TABLE_FILE(OWNER, THING, TABLE, group, phrase, things, axis, file) file,
static const char *const run_names[] = {"summary.json", "scene.yaml",
                                        STRUT_TABLES(TABLE_FILE) "trajectory.h5", NULL};

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
  int code = status == STRUT_OK ? strut_stage_create(&results->held, directory) : 0;
  if (code) status = strut_file_fail(error, "write", directory, code);
  results->stage = results->held.path;
  if (status != STRUT_OK) strut_results_abandon(results);
  return status;
}

strut_status strut_results_commit(strut_results *results, strut_error *error) {
  strut_status status = strut_stage_move(results->stage, results->directory, results->names, error);
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

/* An entry is a line "SIZE CHECKSUM NAME". */
enum { BLOCK = 1 << 16, ENTRY_NUMBERS = 64, LIST_MOST = 1 << 28 };

typedef struct list {
  char *text; /* "" if there is no list */
  size_t length;
  size_t
      at; /* after the entry found last, as names are mostly requested in the order of the list */
} list;

/* Size and checksum of a file, block by block, each seeded by those before it; 0 or an errno. */
static int measure(int folder, const char *name, uint64_t *size, uint64_t *sum) {
  int descriptor = openat(folder, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return errno;
  unsigned char *block = strut_allocate(BLOCK, 1);
  FILE *file = block ? fdopen(descriptor, "rb") : NULL;
  int code = file ? 0 : ENOMEM;
  *size = *sum = 0;
  for (size_t got; file && (got = fread(block, 1, BLOCK, file)) > 0; *size += got)
    *sum = strut_checksum(block, got, *sum);
  if (file && ferror(file)) code = errno;
  strut_release(block);
  if (file)
    fclose(file);
  else
    close(descriptor);
  return code;
}

/* Reads the list of a folder; an empty one if none can be read. */
static strut_status read_list(int folder, list *self, strut_error *error) {
  struct stat found;
  *self = (list){.text = NULL};
  int file = openat(folder, STRUT_OWNERSHIP_LIST, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  size_t capacity = 0;
  if (file >= 0 && fstat(file, &found) == 0 && S_ISREG(found.st_mode) && found.st_size < LIST_MOST)
    capacity = (size_t)found.st_size;
  self->text = strut_allocate(capacity + 1, 1);
  ssize_t got = 1;
  while (self->text && self->length < capacity && got > 0) {
    got = read(file, self->text + self->length, capacity - self->length);
    if (got > 0) self->length += (size_t)got;
  }
  if (file >= 0) close(file);
  return self->text ? STRUT_OK : strut_no_memory(error, "while writing files");
}

/* Finds the next entry of that name, cyclically from the current place; false: none is left. */
static bool next_entry(list *self, const char *name, size_t *visited, uint64_t *size,
                       uint64_t *sum) {
  size_t wanted = strlen(name);
  while (*visited < self->length) {
    if (self->at >= self->length) self->at = 0;
    const char *line = self->text + self->at, *end = memchr(line, '\n', self->length - self->at);
    size_t length = end ? (size_t)(end - line) : self->length - self->at;
    int numbers = 0;
    self->at += length + 1;
    *visited += length + 1;
    if (!end || length <= wanted || line[length - wanted - 1] != ' ' ||
        memcmp(line + length - wanted, name, wanted) != 0)
      continue;
    if (sscanf(line, "%" SCNu64 " %" SCNx64 " %n", size, sum, &numbers) == 2 &&
        (size_t)numbers == length - wanted)
      return true;
  }
  return false;
}

/* Is an entry of this name, size and checksum in the list? */
static bool is_listed(list *self, const char *name, uint64_t size, uint64_t sum) {
  uint64_t listed_size, listed_sum;
  for (size_t visited = 0; next_entry(self, name, &visited, &listed_size, &listed_sum);)
    if (listed_size == size && listed_sum == sum) return true;
  return false;
}

static strut_status cannot_write(strut_error *error, const char *directory, const char *name,
                                 int code) {
  char path[600];
  snprintf(path, sizeof path, "%s%s%s", directory, name ? "/" : "", name ? name : "");
  return strut_file_fail(error, "write", path, code);
}

/* May the file be replaced? 0, EEXIST if strut did not write it, or another errno. */
static int check_one(int folder, list *self, const char *name) {
  struct stat found;
  uint64_t size = 0, sum = 0;
  if (fstatat(folder, name, &found, AT_SYMLINK_NOFOLLOW) != 0) return errno == ENOENT ? 0 : errno;
  if (S_ISDIR(found.st_mode)) return EISDIR;
  if (!S_ISREG(found.st_mode)) return EEXIST;
  if (found.st_size == 0) return 0; /* nothing would be lost */
  int code = measure(folder, name, &size, &sum);
  if (code == EACCES || code == ENOMEM) return code;
  if (code) return EEXIST;
  if (is_listed(self, name, size, sum)) return 0;
  /* another process may have listed it, and moved it here, since the list was read */
  strut_release(self->text);
  if (read_list(folder, self, NULL) != STRUT_OK) return ENOMEM;
  return is_listed(self, name, size, sum) ? 0 : EEXIST;
}

strut_status strut_ownership_check(const char *directory, const char *const *names,
                                   strut_error *error) {
  list l = {.text = NULL};
  int folder = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return STRUT_OK; /* does not exist, or writing will report the error */
  strut_status status = read_list(folder, &l, error);
  for (int i = 0; names[i] && status == STRUT_OK; i++) {
    int code = check_one(folder, &l, names[i]);
    if (code == EEXIST)
      status = strut_fail(error, STRUT_FILE_TROUBLE,
                          "'%s/%s' is not overwritten: strut did not write it, or it has been "
                          "changed since; move it away, or give another name",
                          directory, names[i]);
    else if (code)
      status = cannot_write(error, directory, names[i], code);
  }
  strut_release(l.text);
  close(folder);
  return status;
}

/* Opens the list of a folder for appending; -1 on failure. */
static int open_list(int folder) {
  struct stat found;
  int file = openat(folder, STRUT_OWNERSHIP_LIST,
                    O_WRONLY | O_APPEND | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
  if (file < 0 || (fstat(file, &found) == 0 && S_ISREG(found.st_mode))) return file;
  close(file);
  return -1;
}

/* Appends an entry in one piece, since other processes may append as well. 0 or an errno. */
static int append(int folder, const char *name, uint64_t size, uint64_t sum) {
  size_t capacity = strlen(name) + ENTRY_NUMBERS;
  char *line = strut_allocate(capacity, 1);
  if (!line) return ENOMEM;
  int length = snprintf(line, capacity, "%" PRIu64 " %016" PRIx64 " %s\n", size, sum, name);
  int file = open_list(folder), code = 0;
  errno = 0;
  if (file >= 0 && write(file, line, (size_t)length) != length) code = errno ? errno : ENOSPC;
  if (file >= 0) close(file);
  strut_release(line);
  return code;
}

/* Lists the file of the name. 0 or an errno. */
static int claim(int folder, list *self, int from, const char *name) {
  uint64_t size, sum;
  int code = measure(from, name, &size, &sum);
  if (code == ENOENT) return 0; /* not written this time */
  return code || is_listed(self, name, size, sum) ? code : append(folder, name, size, sum);
}

/* Moves the file, or removes that of an earlier run that this one does not have. 0 or an errno. */
static int move(int from, int to, const char *name) {
  if (renameat(from, name, to, name) == 0) return 0;
  return errno != ENOENT || (unlinkat(to, name, 0) != 0 && errno != ENOENT) ? errno : 0;
}

strut_status strut_stage_move(const char *stage, const char *directory, const char *const *names,
                              strut_error *error) {
  list l = {.text = NULL};
  strut_status status = strut_ownership_check(directory, names, error);
  if (status != STRUT_OK) return status;
  int from = open(stage, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  int to = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const char *at = NULL;
  int code = from < 0 || to < 0 ? errno : 0;
  if (!code && read_list(to, &l, NULL) != STRUT_OK) code = ENOMEM;
  for (int i = 0; names[i] && !code; i++) code = claim(to, &l, from, at = names[i]);
  for (int i = 0; names[i] && !code; i++) code = move(from, to, at = names[i]);
  if (!code && fsync(to) != 0 && errno != EINVAL && errno != EROFS && errno != ENOTSUP)
    at = NULL, code = errno;
  strut_release(l.text);
  if (from >= 0) close(from);
  if (to >= 0) close(to);
  return code ? cannot_write(error, directory, at, code) : STRUT_OK;
}

/* ---- measured data ---- */

enum { MISSING, SAME, DIFFERENT };

static int compare_file(const char *path, const char *text) {
  FILE *there = fopen(path, "rb");
  int c = there ? getc(there) : EOF;
  for (; there && c == (unsigned char)*text && *text; text++) c = getc(there);
  if (!there) return MISSING;
  fclose(there);
  return c == EOF && !*text ? SAME : DIFFERENT;
}

/* `path`, in an arena, is that of the copy; its folder is made. */
static strut_status copy_data(const strut_data_table *table, char *path, strut_error *error) {
  int found = compare_file(path, table->text);
  bool taken = found == DIFFERENT;
  for (size_t i = 0; run_names[i]; i++) taken = taken || strcmp(run_names[i], table->file) == 0;
  if (taken)
    return strut_fail(error, STRUT_USAGE,
                      "the copy of the data '%s' that is kept with the results would overwrite "
                      "'%s': remove that, or give another directory",
                      table->path, path);
  if (found == SAME) return STRUT_OK;
  char *end = strrchr(path, '/');
  *end = '\0';
  strut_status status = strut_directory_create(path, error);
  *end = '/';
  return status ? status : strut_file_write_path(path, table->text, error);
}

strut_status strut_data_copy(const strut_data_table *tables, size_t count, const char *directory,
                             strut_error *error) {
  strut_arena arena = {0};
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < count && status == STRUT_OK; i++) {
    char *path = strut_arena_format(&arena, "%s/%s", directory, tables[i].file);
    status = path ? copy_data(&tables[i], path, error) : strut_no_memory(error, "");
  }
  strut_arena_free(&arena);
  return status;
}

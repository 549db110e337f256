/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/memory.h"
#include "engine/output/results.h"

enum { MOST_NAMES = 1000, NUMBER_ROOM = 48 };

char *strut_file_folder(const char *path, const char **name) {
  const char *slash = strrchr(path, '/');
  size_t length = slash ? (size_t)(slash - path) + (slash == path) : 1;
  char *folder = strut_allocate(length + 1, 1);
  *name = slash ? slash + 1 : path;
  if (folder) memcpy(folder, slash ? path : ".", length);
  return folder;
}

static bool is_directory(const char *path) {
  struct stat found;
  return stat(path, &found) == 0 && S_ISDIR(found.st_mode);
}

strut_status strut_directory_create(const char *directory, strut_error *error) {
  size_t length = strlen(directory);
  if (length == 0) return strut_file_fail(error, "create directory", directory, ENOENT);
  char *path = strut_allocate(length + 1, 1);
  if (!path) return strut_no_memory(error, "while writing files");
  strut_status status = STRUT_OK;
  memcpy(path, directory, length);
  for (size_t i = 1; i <= length && status == STRUT_OK; i++) {
    if (directory[i] != '/' && directory[i] != '\0') continue;
    path[i] = '\0';
    if (mkdir(path, 0777) != 0) {
      int code = errno;
      if (!is_directory(path)) status = strut_file_fail(error, "create directory", path, code);
    }
    path[i] = '/';
  }
  strut_release(path);
  return status;
}

/* Is what is open still what has that name? */
static bool is_still(int descriptor, const char *name) {
  struct stat mine, there;
  return fstat(descriptor, &mine) == 0 && lstat(name, &there) == 0 && mine.st_dev == there.st_dev &&
         mine.st_ino == there.st_ino;
}

static void forget(strut_file *file) {
  strut_stage_remove(&file->held);
  strut_release(file->path);
  strut_release(file->part);
  *file = (strut_file){0};
}

/* Is it a folder of strut_stage? Its files move with it. */
static bool is_stage(const char *folder) {
  const char *slash = strrchr(folder, '/');
  return strncmp(slash ? slash + 1 : folder, STRUT_STAGE_PREFIX, strlen(STRUT_STAGE_PREFIX)) == 0;
}

/* Opens file->part, the file of that name in the folder or in a stage inside it. 0 or an errno. */
static int open_part(strut_file *file, const char *folder, const char *name, size_t capacity) {
  bool staged = is_stage(folder);
  int code = staged ? 0 : strut_stage_create(&file->held, folder);
  if (code) return code;
  snprintf(file->part, capacity, "%s/%s", staged ? folder : file->held.path, name);
  file->stream = fopen(file->part, "wbe");
  return file->stream ? 0 : errno;
}

strut_status strut_file_open_path(strut_file *file, const char *path, strut_error *error) {
  const char *names[2] = {NULL, NULL};
  size_t length = strlen(path) + 1, capacity = length + 2 * NUMBER_ROOM;
  char *folder = strut_file_folder(path, &names[0]);
  *file = (strut_file){.path = strut_allocate(length, 1), .part = strut_allocate(capacity, 1)};
  int code = !folder || !file->path || !file->part ? ENOMEM : is_directory(path) ? EISDIR : 0;
  strut_status status = STRUT_OK;
  if (!code && !is_stage(folder)) status = strut_ownership_check(folder, names, error);
  if (!code && !status) {
    memcpy(file->path, path, length);
    code = open_part(file, folder, names[0], capacity);
  }
  if (code) status = strut_file_fail(error, "write", path, code);
  if (status) forget(file);
  strut_release(folder);
  return status;
}

strut_status strut_file_open(strut_file *file, const char *directory, const char *name,
                             strut_error *error) {
  size_t capacity = strlen(directory) + strlen(name) + 2;
  char *path = strut_allocate(capacity, 1);
  *file = (strut_file){0};
  if (!path) return strut_no_memory(error, "while writing files");
  snprintf(path, capacity, "%s/%s", directory, name);
  strut_status status = strut_file_open_path(file, path, error);
  strut_release(path);
  return status;
}

strut_status strut_file_commit(strut_file *file, strut_error *error) {
  const char *names[2] = {NULL, NULL};
  char *folder = strut_file_folder(file->path, &names[0]);
  strut_status status = STRUT_OK;
  bool failed_before = ferror(file->stream) != 0;
  int code = folder ? 0 : ENOMEM;
  errno = 0;
  if (fflush(file->stream) != 0 || failed_before) code = errno ? errno : EIO;
  if (!code && fsync(fileno(file->stream)) != 0 && errno != EINVAL) code = errno;
  if (!code && !is_still(fileno(file->stream), file->part)) code = ENOENT;
  if (fclose(file->stream) != 0 && !code) code = errno;
  if (code)
    status = strut_file_fail(error, "write", file->path, code);
  else if (file->held.path)
    status = strut_stage_move(file->held.path, folder, names, error);
  if (status) unlink(file->part);
  strut_release(folder);
  forget(file);
  return status;
}

void strut_file_abandon(strut_file *file) {
  if (file->stream) {
    unlink(file->part);
    fclose(file->stream);
  }
  forget(file);
}

strut_status strut_file_trouble(const strut_file *file, strut_error *error) {
  return strut_file_fail(error, "write", file->path, errno ? errno : EIO);
}

void strut_file_remove(const char *directory, const char *name) {
  int descriptor = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  unlinkat(descriptor, name, 0);
  close(descriptor);
}

/* Writes a whole text into an open file and completes it. */
static strut_status write_and_commit(strut_file *file, const char *text, strut_error *error) {
  size_t length = strlen(text);
  errno = 0;
  if (fwrite(text, 1, length, file->stream) == length) return strut_file_commit(file, error);
  strut_status status = strut_file_trouble(file, error);
  strut_file_abandon(file);
  return status;
}

strut_status strut_file_write_text(const char *directory, const char *name, const char *text,
                                   strut_error *error) {
  strut_file file;
  strut_status status = strut_file_open(&file, directory, name, error);
  return status == STRUT_OK ? write_and_commit(&file, text, error) : status;
}

strut_status strut_file_write_block(const char *directory, const char *name, char *text,
                                    strut_error *error) {
  if (!text) return strut_no_memory(error, "while writing files");
  strut_status status = strut_file_write_text(directory, name, text, error);
  strut_release(text);
  return status;
}

strut_status strut_file_write_path(const char *path, const char *text, strut_error *error) {
  strut_file file;
  strut_status status = strut_file_open_path(&file, path, error);
  return status == STRUT_OK ? write_and_commit(&file, text, error) : status;
}

/* The file that marks a folder: its first line names the owner, its second the machine. */
#define MARK ".strut-stage"
#define MARK_BEGIN "strut collects results here; remove this only when no strut is running\n"

enum { HOST_MOST = 64 };

typedef char mark_text[sizeof MARK_BEGIN + HOST_MOST + 1];

/* States of the mark. */
static void fill_mark(mark_text text) {
  char host[HOST_MOST] = "";
  if (gethostname(host, sizeof host - 1) != 0) host[0] = '\0';
  snprintf(text, sizeof(mark_text), "%s%s\n", MARK_BEGIN, host);
}

static bool write_mark(int folder) {
  mark_text text;
  fill_mark(text);
  int file = openat(folder, MARK, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (file < 0) return false;
  bool written = write(file, text, strlen(text)) == (ssize_t)strlen(text);
  return close(file) == 0 && written;
}

typedef enum mark {
  MARK_NONE,
  MARK_BEGUN, /* its writer was killed while writing it */
  MARK_WHOLE
} mark;

/* Reads the mark of a folder. */
static mark read_mark(int folder) {
  mark_text wanted, found = "";
  fill_mark(wanted);
  int file = openat(folder, MARK, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return MARK_NONE;
  ssize_t got = read(file, found, sizeof found - 1);
  close(file);
  if (got < 0 || (size_t)got > strlen(wanted) || memcmp(found, wanted, (size_t)got) != 0)
    return MARK_NONE;
  return (size_t)got == strlen(wanted) ? MARK_WHOLE : MARK_BEGUN;
}

static DIR *open_directory(int folder) {
  int again = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  DIR *directory = again < 0 ? NULL : fdopendir(again);
  if (!directory && again >= 0) close(again);
  return directory;
}

/* Is there no other file than the mark? */
static bool holds_only_mark(int folder) {
  DIR *directory = open_directory(folder);
  bool only = directory != NULL;
  for (struct dirent *entry = only ? readdir(directory) : NULL; entry; entry = readdir(directory)) {
    const char *name = entry->d_name;
    only = only && (strcmp(name, MARK) == 0 || strcmp(name, ".") == 0 || strcmp(name, "..") == 0);
  }
  if (directory) closedir(directory);
  return only;
}

/* Removes the files, the mark last, so that a partly emptied folder stays recognisable. */
static void empty(int folder) {
  DIR *directory = open_directory(folder);
  if (!directory) return;
  for (struct dirent *entry = readdir(directory); entry; entry = readdir(directory))
    if (strcmp(entry->d_name, MARK) != 0) unlinkat(folder, entry->d_name, 0); /* not "." and ".." */
  closedir(directory);
  unlinkat(folder, MARK, 0);
}

/*
 * Removes a folder that no process holds. One without a whole mark and files is of a process that was killed
 * before it wrote the mark, or is about to write it: that process then makes another.
 */
static bool remove_left(int parent, const char *name) {
  int folder = openat(parent, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder < 0) return false;
  bool ours = flock(folder, LOCK_EX | LOCK_NB) == 0;
  mark found = ours ? read_mark(folder) : MARK_NONE;
  if (found == MARK_WHOLE || (found == MARK_BEGUN && holds_only_mark(folder))) empty(folder);
  bool removed = ours && unlinkat(parent, name, AT_REMOVEDIR) == 0; /* fails unless it is empty */
  close(folder);
  return removed;
}

bool strut_stage_sweep(const char *directory) {
  int parent = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  DIR *entries = parent < 0 ? NULL : open_directory(parent);
  bool removed = false;
  for (struct dirent *entry = entries ? readdir(entries) : NULL; entry; entry = readdir(entries))
    if (strncmp(entry->d_name, STRUT_STAGE_PREFIX, strlen(STRUT_STAGE_PREFIX)) == 0)
      removed = remove_left(parent, entry->d_name) || removed;
  if (entries) closedir(entries);
  if (parent >= 0) close(parent);
  return removed;
}

/* Locks and marks the new folder. False where somebody removed it meanwhile, with ENOENT, or with why
   not. A file system without locks gets no mark: then no process can know whether it is in use. */
static bool hold(strut_stage *stage) {
  stage->lock = open(stage->path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (stage->lock < 0) return false;
  bool held = flock(stage->lock, LOCK_EX) != 0 || write_mark(stage->lock);
  if (held && is_still(stage->lock, stage->path)) return true;
  int code = held ? ENOENT : errno;
  if (!held) empty(stage->lock); /* of a mark that was begun */
  close(stage->lock);
  if (!held && code != ENOENT) rmdir(stage->path);
  errno = code;
  return false;
}

int strut_stage_create(strut_stage *stage, const char *directory) {
  size_t capacity = strlen(directory) + NUMBER_ROOM;
  *stage = (strut_stage){.path = strut_allocate(capacity, 1)};
  if (!stage->path) return ENOMEM;
  strut_stage_sweep(directory);
  int code = EEXIST;
  for (int i = 0; i < MOST_NAMES && (code == EEXIST || code == ENOENT); i++) {
    snprintf(stage->path, capacity, "%s/" STRUT_STAGE_PREFIX "%ld-%d", directory, (long)getpid(),
             i);
    if (mkdir(stage->path, 0777) == 0 && hold(stage)) return 0;
    code = errno;
  }
  strut_release(stage->path);
  *stage = (strut_stage){.path = NULL};
  return code ? code : EIO;
}

void strut_stage_remove(strut_stage *stage) {
  if (!stage->path) return;
  empty(stage->lock);
  rmdir(stage->path);
  close(stage->lock);
  strut_release(stage->path);
  *stage = (strut_stage){.path = NULL};
}

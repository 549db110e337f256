/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/stage.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/memory.h"

/* The file that marks a folder: its first line names the owner, its second the machine. */
#define MARK ".strut-stage"
#define MARK_BEGIN "strut collects results here; remove this only when no strut is running\n"

enum { MOST_NAMES = 1000, NUMBER_ROOM = 48, HOST_MOST = 64 };

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

/* Removes a folder that nobody holds. One without a whole mark and files is of a process that was killed before
   it wrote the mark, or is about to write it: that process then makes another. */
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
   not. A file system without locks gets no mark: then nobody can tell whether it is in use. */
static bool hold(strut_stage *stage) {
  struct stat mine, there;
  stage->lock = open(stage->path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (stage->lock < 0) return false;
  bool held = flock(stage->lock, LOCK_EX) != 0 || write_mark(stage->lock);
  if (held && stat(stage->path, &there) == 0 && fstat(stage->lock, &mine) == 0 &&
      there.st_dev == mine.st_dev && there.st_ino == mine.st_ino)
    return true;
  int code = held ? ENOENT : errno;
  close(stage->lock);
  if (!held && code != ENOENT) rmdir(stage->path);
  errno = code;
  return false;
}

strut_status strut_stage_create(strut_stage *stage, const char *directory, strut_error *error) {
  size_t capacity = strlen(directory) + NUMBER_ROOM;
  *stage = (strut_stage){.path = strut_allocate(capacity, 1)};
  if (!stage->path) return strut_no_memory(error, "while writing files");
  strut_stage_sweep(directory);
  int code = EEXIST;
  for (int i = 0; i < MOST_NAMES && (code == EEXIST || code == ENOENT); i++) {
    snprintf(stage->path, capacity, "%s/" STRUT_STAGE_PREFIX "%ld-%d", directory, (long)getpid(),
             i);
    if (mkdir(stage->path, 0777) == 0 && hold(stage)) return STRUT_OK;
    code = errno;
  }
  char reason[128];
  if (strerror_r(code, reason, sizeof reason) != 0)
    snprintf(reason, sizeof reason, "error %d", code);
  strut_release(stage->path);
  *stage = (strut_stage){.path = NULL};
  return strut_fail(error, STRUT_FILE_TROUBLE, "cannot write '%s': %s", directory, reason);
}

void strut_stage_remove(strut_stage *stage) {
  if (!stage->path) return;
  empty(stage->lock);
  rmdir(stage->path);
  close(stage->lock);
  strut_release(stage->path);
  *stage = (strut_stage){.path = NULL};
}

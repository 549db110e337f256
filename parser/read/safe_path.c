/* SPDX-License-Identifier: GPL-3.0-or-later */
/* realpath belongs to the X/Open part of POSIX. */
#define _XOPEN_SOURCE 700

#include "parser/read/safe_path.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#ifndef PATH_MAX
#define PATH_MAX 4096
#endif

static strut_status cannot_read(strut_error *error, const char *path, int code) {
  char reason[128];
  if (strerror_r(code, reason, sizeof reason) != 0)
    snprintf(reason, sizeof reason, "error %d", code);
  return strut_fail(error, STRUT_FILE_TROUBLE, "cannot read '%.300s': %s", path, reason);
}

char *strut_folder_of(const char *path, strut_arena *arena) {
  const char *slash = strrchr(path, '/');
  if (!slash) return strut_arena_text(arena, ".", 1);
  return strut_arena_text(arena, path, slash == path ? 1 : (size_t)(slash - path));
}

/* Is one of the parts of the path ".."? */
static bool climbs(const char *name) {
  for (const char *at = name; *at;) {
    size_t length = strcspn(at, "/");
    if (length == 2 && at[0] == '.' && at[1] == '.') return true;
    at += length;
    at += *at == '/';
  }
  return false;
}

static strut_status check_name(const char *name, strut_error *error) {
  if (!*name) return strut_fail(error, STRUT_BAD_SCENE, "expected the path of a file, found ''");
  if (*name == '/')
    return strut_fail(error, STRUT_BAD_SCENE,
                      "'%.300s' is an absolute path, expected one below the folder of this file",
                      name);
  if (climbs(name))
    return strut_fail(error, STRUT_BAD_SCENE,
                      "'%.300s' has a '..', expected a path below the folder of this file", name);
  return STRUT_OK;
}

/* What `real` has behind the folder `root`; NULL: it lies elsewhere. Both have their links resolved. */
static const char *path_below(const char *root, const char *real) {
  size_t length = strlen(root);
  if (length == 1) return real + 1; /* the root of the file system */
  return strncmp(real, root, length) == 0 && real[length] == '/' ? real + length + 1 : NULL;
}

/*
 * Opens a file below the folder part by part, following no link, so that a path that is changed
 * meanwhile cannot lead elsewhere. -1 with errno; ELOOP and ENOTDIR then mean that it was changed.
 */
static int open_below(const char *root, const char *below, struct stat *found) {
  int folder = open(root, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  while (folder >= 0) {
    char part[NAME_MAX + 1];
    size_t length = strcspn(below, "/");
    bool last = !below[length];
    int next = -1;
    if (length > NAME_MAX) {
      errno = ENAMETOOLONG;
    } else {
      memcpy(part, below, length);
      part[length] = '\0';
      int how = last ? O_NONBLOCK | O_NOCTTY : O_DIRECTORY;
      bool regular = !last || (fstatat(folder, part, found, AT_SYMLINK_NOFOLLOW) == 0 &&
                               S_ISREG(found->st_mode));
      if (regular) next = openat(folder, part, O_RDONLY | O_NOFOLLOW | O_CLOEXEC | how);
    }
    int code = errno;
    close(folder);
    errno = code;
    if (last || next < 0) return next;
    folder = next;
    below += length + 1;
  }
  return -1;
}

/* Reads `size` bytes and one more, which must not exist. */
static strut_status read_bytes(int descriptor, size_t size, strut_safe_text *file,
                               strut_error *error) {
  file->text = strut_allocate(size + 2, 1);
  if (!file->text) return strut_no_memory(error, "");
  while (file->length <= size) {
    ssize_t got = read(descriptor, file->text + file->length, size + 1 - file->length);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return cannot_read(error, file->path, errno);
    if (got == 0) break;
    file->length += (size_t)got;
  }
  if (file->length > size)
    return strut_fail(error, STRUT_FILE_TROUBLE, "'%.300s' has changed while it was read",
                      file->path);
  file->text[file->length] = '\0';
  return STRUT_OK;
}

static strut_status read_below(const char *root, const char *below, size_t most,
                               strut_safe_text *file, strut_error *error) {
  struct stat found = {0};
  int descriptor = open_below(root, below, &found);
  int code = errno;
  strut_status status;
  if (descriptor >= 0 && fstat(descriptor, &found) != 0) {
    status = cannot_read(error, file->path, errno);
  } else if ((descriptor >= 0 || found.st_nlink > 0) && !S_ISREG(found.st_mode)) {
    status = strut_fail(error, STRUT_BAD_SCENE, "'%.300s' is not a regular file", file->path);
  } else if (descriptor < 0) {
    status = cannot_read(error, file->path, code);
  } else if (found.st_size > 0 && (uintmax_t)found.st_size > most) {
    status = strut_fail(error, STRUT_BAD_SCENE, "'%.300s' has %jd bytes, expected at most %zu",
                        file->path, (intmax_t)found.st_size, most);
  } else {
    file->device = (uint64_t)found.st_dev;
    file->inode = (uint64_t)found.st_ino;
    status = read_bytes(descriptor, (size_t)found.st_size, file, error);
  }
  if (descriptor >= 0) close(descriptor);
  return status;
}

/* The path of `name` from the folder of `from`, in a block of strut_allocate. */
static char *join(const char *from, const char *name) {
  const char *slash = strrchr(from, '/');
  size_t folder = slash ? (size_t)(slash - from) + 1 : 0;
  char *path = strut_allocate(folder + strlen(name) + 1, 1);
  if (!path) return NULL;
  memcpy(path, from, folder);
  strcpy(path + folder, name);
  return path;
}

strut_status strut_safe_read(const char *root, const char *from, const char *name, size_t most,
                             strut_safe_text *file, strut_error *error) {
  char top[PATH_MAX], real[PATH_MAX];
  *file = (strut_safe_text){0};
  strut_status status = check_name(name, error);
  if (status) return status;
  file->path = join(from, name);
  if (!file->path) return strut_no_memory(error, "");
  if (!realpath(root, top)) {
    status = cannot_read(error, root, errno);
  } else if (!realpath(file->path, real)) {
    status = cannot_read(error, file->path, errno);
  } else {
    const char *below = path_below(top, real);
    if (strcmp(top, real) == 0)
      status = strut_fail(error, STRUT_BAD_SCENE, "'%.300s' is not a regular file", file->path);
    else if (!below)
      status = strut_fail(error, STRUT_BAD_SCENE, "'%.300s' leads out of the folder '%.200s'",
                          file->path, root);
    else
      status = read_below(top, below, most, file, error);
  }
  if (status) strut_safe_text_free(file);
  return status;
}

void strut_safe_text_free(strut_safe_text *file) {
  strut_release(file->path);
  strut_release(file->text);
  *file = (strut_safe_text){0};
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* realpath belongs to the X/Open part of POSIX. */
#define _XOPEN_SOURCE 700
#include "parser/program/installed.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "engine/output/file.h"

/* folder/below/name; false where that is too long or does not exist. */
static bool join(const char *folder, const char *below, const char *name,
                 char path[STRUT_LONGEST_PATH]) {
  char joined[2 * STRUT_LONGEST_PATH];
  int length = snprintf(joined, sizeof joined, "%s%s%s", folder, below, name);
  if (length < 0 || (size_t)length >= sizeof joined || access(joined, R_OK) != 0) return false;
  char *whole = realpath(joined, NULL); /* without the steps up */
  bool fits = whole && strlen(whole) < STRUT_LONGEST_PATH;
  if (fits) strcpy(path, whole);
  free(whole);
  return fits;
}

/* The folder of the program. */
static bool find_folder(char folder[STRUT_LONGEST_PATH]) {
  ssize_t length = readlink("/proc/self/exe", folder, STRUT_LONGEST_PATH - 1);
  if (length <= 0) return false;
  folder[length] = '\0';
  *strrchr(folder, '/') = '\0';
  return true;
}

bool strut_find_module(const char *name, char path[STRUT_LONGEST_PATH]) {
  char folder[STRUT_LONGEST_PATH];
  return find_folder(folder) && (join(folder, "/" STRUT_MODULES_FROM_PROGRAM "/", name, path) ||
                                 join(folder, "/modules/", name, path));
}

bool strut_find_installed(const char *name, const char *built, char path[STRUT_LONGEST_PATH]) {
  char folder[STRUT_LONGEST_PATH];
  return find_folder(folder) && (join(folder, "/" STRUT_SHARE_FROM_PROGRAM "/", name, path) ||
                                 join(folder, "/", built, path));
}

static strut_status trouble(strut_error *error, const char *path, int code) {
  if (code == EEXIST)
    return strut_fail(error, STRUT_FILE_TROUBLE, "'%s' exists already, and is left as it is", path);
  return strut_fail(error, STRUT_FILE_TROUBLE, "cannot write '%s': %s", path, strerror(code));
}

/* Writes all and closes; an error number, or 0. */
static int write_all(int file, const char *text, size_t length) {
  int code = 0;
  for (size_t done = 0; done < length && !code;) {
    ssize_t written = write(file, text + done, length - done);
    if (written > 0)
      done += (size_t)written;
    else if (written == 0 || errno != EINTR)
      code = written == 0 ? EIO : errno;
  }
  if (!code && fsync(file) != 0 && errno != EINVAL && errno != EROFS) code = errno;
  if (close(file) != 0 && !code) code = errno;
  return code;
}

strut_status strut_create_file(const char *path, const char *text, size_t length,
                               strut_error *error) {
  int file = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0) return trouble(error, path, errno);
  int code = write_all(file, text, length);
  if (!code) return STRUT_OK;
  unlink(path);
  return trouble(error, path, code);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* realpath belongs to the X/Open part of POSIX. */
#define _XOPEN_SOURCE 700
#include "parser/program/installed.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "parser/read/read_scene.h"
#include "parser/yaml/document.h"

enum { FIRST_SIZE = 64 * 1024 };

static strut_status file_trouble(strut_error *error, const char *name, int code) {
  char reason[128];
  if (strerror_r(code, reason, sizeof reason) != 0)
    snprintf(reason, sizeof reason, "error %d", code);
  return strut_fail(error, STRUT_FILE_TROUBLE, "cannot read %s: %s", name, reason);
}

/* Reads to the end of the stream; the block grows as needed and keeps room for a NUL. */
static strut_status read_stream(FILE *stream, const char *name, char **text, size_t *length,
                                strut_error *error) {
  size_t capacity = 0, used = 0, got;
  do {
    if (capacity < used + 2) {
      size_t wider = capacity ? 2 * capacity : FIRST_SIZE;
      if (wider > STRUT_TEXT_MOST + 2) wider = STRUT_TEXT_MOST + 2;
      char *block = strut_reallocate(*text, wider, 1);
      if (!block) return strut_fail(error, STRUT_NO_MEMORY, "out of memory while reading %s", name);
      *text = block;
      capacity = wider;
    }
    errno = 0;
    got = fread(*text + used, 1, capacity - used - 1, stream);
    used += got;
    if (used > STRUT_TEXT_MOST)
      return strut_fail(error, STRUT_BAD_SCENE, "%s has more than %zu MiB", name,
                        STRUT_TEXT_MOST >> 20);
  } while (got);
  if (ferror(stream)) return file_trouble(error, name, errno ? errno : EIO);
  (*text)[used] = '\0';
  *length = used;
  return STRUT_OK;
}

strut_status strut_file_read(const char *path, char **text, size_t *length, strut_error *error) {
  char name[400];
  bool standard = strcmp(path, "-") == 0;
  *text = NULL;
  *length = 0;
  snprintf(name, sizeof name, standard ? "the standard input" : "'%s'", path);
  FILE *stream = standard ? stdin : fopen(path, "rb");
  if (!stream) return file_trouble(error, name, errno);
  strut_status status = read_stream(stream, name, text, length, error);
  if (!standard) fclose(stream);
  if (status != STRUT_OK) {
    strut_release(*text);
    *text = NULL;
  }
  return status;
}

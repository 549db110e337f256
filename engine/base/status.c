/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/base/status.h"

#include <assert.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const struct {
  int exit_code;
  const char *text;
} table[] = {
#define STRUT_STATUS_ROW(code, exit_code, text) {exit_code, text},
    STRUT_STATUS_TABLE(STRUT_STATUS_ROW)};

_Static_assert(sizeof table / sizeof table[0] == STRUT_STATUS_COUNT, "one row for each status");

const char *strut_status_text(strut_status status) {
  assert((unsigned)status < STRUT_STATUS_COUNT);
  return table[status].text;
}

int strut_status_exit_code(strut_status status) {
  assert((unsigned)status < STRUT_STATUS_COUNT);
  return table[status].exit_code;
}

strut_status strut_fail(strut_error *error, strut_status status, const char *format, ...) {
  if (error) {
    va_list arguments;
    va_start(arguments, format);
    error->status = status;
    vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
  }
  return status;
}

strut_status strut_no_memory(strut_error *error, const char *purpose) {
  return strut_fail(error, STRUT_NO_MEMORY, "out of memory%s%s", *purpose ? " " : "", purpose);
}

strut_status strut_file_fail(strut_error *error, const char *what, const char *path, int code) {
  char reason[128];
  if (code == ENOMEM) return strut_no_memory(error, "");
  if (strerror_r(code, reason, sizeof reason) != 0)
    snprintf(reason, sizeof reason, "error %d", code);
  return strut_fail(error, STRUT_FILE_TROUBLE, "cannot %s '%.400s': %s", what, path, reason);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The mark of an exported symbol: everything else is hidden by the build. */
#pragma once

#define STRUT_API __attribute__((visibility("default")))

/* Status codes and the message that travels with one.
 *
 * Every function of strut that can fail returns a strut_status and, where it takes a strut_error,
 * leaves one sentence there that says what failed, where, and what to do. The library never prints
 * and never exits. One table holds code, name, the program's exit code and the general text.
 */

/* X(code, exit code of the program, text) */
#define STRUT_STATUS_TABLE(X)                                                                      \
  X(STRUT_OK, 0, "completed")                                                                      \
  X(STRUT_USAGE, 1, "cannot be done as asked")                                                     \
  X(STRUT_BAD_SCENE, 2, "the scene is not valid")                                                  \
  X(STRUT_DIVERGED, 3, "diverged")                                                                 \
  X(STRUT_STEP_TOO_LARGE, 3, "the step is above the stability limit")                              \
  X(STRUT_NOT_SETTLED, 3, "the structure did not come to rest")                                    \
  X(STRUT_SINGULAR, 3, "a matrix is singular")                                                     \
  X(STRUT_WORK_LIMIT, 3, "the work allowed was used up")                                           \
  X(STRUT_FILE_TROUBLE, 4, "a file could not be read or written")                                  \
  X(STRUT_NO_MEMORY, 4, "out of memory")                                                           \
  X(STRUT_INTERRUPTED, 130, "interrupted")                                                         \
  X(STRUT_INACCURATE, 5, "completed, but less accurate than requested")

typedef enum strut_status {
#define STRUT_STATUS_ENUM(code, exit_code, text) code,
  STRUT_STATUS_TABLE(STRUT_STATUS_ENUM) STRUT_STATUS_COUNT
} strut_status;

/** One sentence that describes an error. Zeroed: no error. */
typedef struct strut_error {
  strut_status status;
  char message[600];
} strut_error;

/** General text of a status, e.g. "completed", "diverged", "interrupted". Never NULL. */
STRUT_API const char *strut_status_text(strut_status status);

/** The program's exit code for a status: 0, 1, 2, 3, 4, 5 or 130. */
STRUT_API int strut_status_exit_code(strut_status status);

/** Writes status and printf-style message into error (may be NULL); returns status. */
STRUT_API strut_status strut_fail(strut_error *error, strut_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/** The same for STRUT_NO_MEMORY: "out of memory", and what for, such as "while drawing", or "". */
STRUT_API strut_status strut_no_memory(strut_error *error, const char *purpose);
/** "cannot WHAT 'PATH': " and the reason of an errno: STRUT_FILE_TROUBLE, or STRUT_NO_MEMORY for ENOMEM. */
STRUT_API strut_status strut_file_fail(strut_error *error, const char *what, const char *path,
                                       int code);

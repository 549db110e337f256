/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/streams.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

void strut_streams_open(void) {
  /* The wrong way round on purpose: using a closed stream stays an error. */
  static const int modes[] = {O_WRONLY, O_RDONLY, O_RDONLY};
  for (int i = 0; i < 3; i++) {
    if (fcntl(i, F_GETFD) == -1 && errno == EBADF && open("/dev/null", modes[i]) != i) break;
  }
}

static void complain_of_output(int reason) {
  fprintf(stderr, "strut: error: cannot write to the standard output: %s\n",
          reason ? strerror(reason) : "an earlier write failed");
}

strut_status strut_print(const char *text) {
  errno = 0;
  if (fputs(text, stdout) >= 0 && fflush(stdout) == 0) return STRUT_OK;
  complain_of_output(errno);
  return STRUT_FILE_TROUBLE;
}

int strut_streams_close(strut_status status) {
  int code = strut_status_exit_code(status);
  errno = 0;
  bool failed = ferror(stdout) != 0;
  if (fflush(stdout) != 0) failed = true;
  int reason = errno;
  if (fclose(stdout) != 0 && !failed) {
    failed = true;
    reason = errno;
  }
  if (!failed || code != 0) return code; /* what failed has been told */
  complain_of_output(reason);
  return strut_status_exit_code(STRUT_FILE_TROUBLE);
}

void strut_print_error(const strut_error *error) {
  fprintf(stderr, "strut: error: %s\n",
          error->message[0] ? error->message : strut_status_text(error->status));
}

strut_status strut_print_out_of_memory(void) {
  strut_error error = {STRUT_NO_MEMORY, ""};
  strut_print_error(&error);
  return STRUT_NO_MEMORY;
}

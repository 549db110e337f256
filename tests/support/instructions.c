/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/support/instructions.h"

#include <signal.h>
#include <sys/ptrace.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

/* Two signals stand around the work, so that only what lies between them is counted. */
static void be_stepped(void (*work)(void *context), void *context) {
  work(context); /* once before: lazily bound functions and first touches of memory are not counted */
  if (ptrace(PTRACE_TRACEME, 0, NULL, NULL) < 0) _exit(1);
  raise(SIGUSR1);
  work(context);
  raise(SIGUSR2);
  _exit(0);
}

/* Steps the stopped child until it stops for SIGUSR2; the steps taken, or -1. */
static long step_through(pid_t child) {
  int status;
  for (long count = 0;; count++) {
    if (ptrace(PTRACE_SINGLESTEP, child, NULL, NULL) < 0) return -1;
    if (waitpid(child, &status, 0) < 0 || !WIFSTOPPED(status)) return -1;
    if (WSTOPSIG(status) == SIGUSR2) return count;
  }
}

long count_instructions(void (*work)(void *context), void *context) {
  int status;
  pid_t child = fork();
  if (child < 0) return -1;
  if (child == 0) be_stepped(work, context);
  long count = -1;
  if (waitpid(child, &status, 0) == child && WIFSTOPPED(status) && WSTOPSIG(status) == SIGUSR1)
    count = step_through(child);
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
  return count;
}

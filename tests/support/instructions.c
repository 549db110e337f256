/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/support/instructions.h"

#include <signal.h>
#include <stddef.h>
#include <sys/ptrace.h>
#include <sys/types.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

/* Two signals stand around the work, so that only what lies between them is counted. */
static void be_stepped(void (*work)(void *context), void *context) {
  work(
      context); /* once before: lazily bound functions and first touches of memory are not counted */
  if (ptrace(PTRACE_TRACEME, 0, NULL, NULL) < 0) _exit(1);
  raise(SIGUSR1);
  work(context);
  raise(SIGUSR2);
  _exit(0);
}

/* Where the child stands, so that a string instruction, which stops at each byte, counts once. */
static long place_of(pid_t child, long otherwise) {
#if defined(__x86_64__)
  (void)otherwise;
  return ptrace(PTRACE_PEEKUSER, child, offsetof(struct user, regs.rip), NULL);
#else
  (void)child;
  return otherwise;
#endif
}

/* Steps the stopped child until it stops for SIGUSR2; the instructions it took, or -1. */
static long step_through(pid_t child) {
  int status;
  long count = 0, place = 0;
  for (long step = 1;; step++) {
    if (ptrace(PTRACE_SINGLESTEP, child, NULL, NULL) < 0) return -1;
    if (waitpid(child, &status, 0) < 0 || !WIFSTOPPED(status)) return -1;
    if (WSTOPSIG(status) == SIGUSR2) return count;
    long before = place;
    place = place_of(child, step);
    count += place != before;
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

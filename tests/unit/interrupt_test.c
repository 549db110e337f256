/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ctrl-C: the first signal sets the flag, one that comes later kills. */
#define _GNU_SOURCE /* streams.c is part of this file */
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "parser/program/streams.c" /* the program is no library to link with */
#include "tests/support/test.h"

/* A child process gets the signal three times. */
static void send_signals(int signal_number) {
  int result = 0, pipe_ends[2];
  char mark = 0;
  assert_int_equal(pipe(pipe_ends), 0);
  pid_t child = fork();
  if (child == 0) {
    const strut_flag *flag = strut_interrupt_watch();
    if (*flag) _exit(1);
    raise(signal_number);
    if (!*flag) _exit(2);
    raise(signal_number); /* the same press, delivered twice */
    struct timespec pause = {0, 400000000};
    nanosleep(&pause, NULL);
    if (write(pipe_ends[1], "x", 1) != 1) _exit(3);
    raise(signal_number);
    _exit(4);
  }
  assert_int_equal(waitpid(child, &result, 0), child);
  close(pipe_ends[1]);
  assert_int_equal(read(pipe_ends[0], &mark, 1), 1); /* it lived until then */
  close(pipe_ends[0]);
  assert_true(WIFSIGNALED(result));
  assert_int_equal(WTERMSIG(result), signal_number);
}

TEST(interrupts) { send_signals(SIGINT); }

TEST(terminations) { send_signals(SIGTERM); }

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/interrupt.h"

#include <stddef.h>
#include <time.h>

/* One press may arrive twice: timeout(1), for one, signals the program and then its whole group. */
enum { SAME_PRESS = 300 /* [ms] */ };

/* A signal handler has no context: the only variables of the program that live outside of main. */
static volatile sig_atomic_t interrupted, first_time;

static int milliseconds(void) {
  struct timespec time = {0, 0};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (int)(time.tv_sec % 1000000 * 1000 + time.tv_nsec / 1000000);
}

static void note(int signal_number) {
  int time = milliseconds();
  if (!interrupted) {
    interrupted = 1;
    first_time = time;
  } else if (time < first_time || time - first_time > SAME_PRESS) {
    signal(signal_number, SIG_DFL);
    raise(signal_number); /* takes effect when the handler returns */
  }
}

const volatile sig_atomic_t *strut_interrupt_watch(void) {
  struct sigaction action = {.sa_handler = note, .sa_flags = SA_RESTART};
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  return &interrupted;
}

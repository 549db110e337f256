/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/interrupt.h"

#include <stddef.h>

/* A signal handler has no context: the one variable of the program that lives outside of main. */
static volatile sig_atomic_t interrupted;

static void note(int signal_number) {
  (void)signal_number;
  interrupted = 1;
}

const volatile sig_atomic_t *strut_interrupt_watch(void) {
  struct sigaction action = {.sa_handler = note, .sa_flags = (int)(SA_RESETHAND | SA_RESTART)};
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  return &interrupted;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Ctrl-C: the first one asks the run to stop and keep what it has, the second one kills.
 */
#ifndef STRUT_PARSER_CLI_INTERRUPT_H
#define STRUT_PARSER_CLI_INTERRUPT_H

#include <signal.h>

/** From now on SIGINT and SIGTERM set the flag that is returned; a moment later they kill. */
const volatile sig_atomic_t *strut_interrupt_watch(void);

#endif

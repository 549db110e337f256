/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Messages of a call to a listener: the program prints them, the library collects them. */
#ifndef STRUT_PARSER_PROGRAM_COMMAND_MESSAGES_H
#define STRUT_PARSER_PROGRAM_COMMAND_MESSAGES_H

#include "engine/base/status.h"

typedef enum strut_message_kind {
  STRUT_MESSAGE_USAGE,   /* an option is wrong */
  STRUT_MESSAGE_ERROR,   /* a computation failed */
  STRUT_MESSAGE_WARNING, /* a result exists but may not be what was meant */
  STRUT_MESSAGE_NOTE,    /* an outdated word */
  STRUT_MESSAGE_REMARK,  /* how something was done */
  STRUT_MESSAGE_LINES    /* of any length, with their ends: located errors or notes */
} strut_message_kind;

/** Longest message, its NUL included. */
enum { STRUT_MESSAGE_MOST = 900 };

typedef struct strut_listener {
  void *context;
  /** One sentence without a full stop. `command`: the command that it is about, or NULL. */
  void (*hear)(void *context, strut_message_kind kind, const char *command, const char *text);
} strut_listener;

/** Tells a message of at most STRUT_MESSAGE_MOST bytes. NULL: no one listens. */
void strut_tell(const strut_listener *listener, strut_message_kind kind, const char *command,
                const char *format, ...) __attribute__((format(printf, 4, 5)));

/** Tells the error, or out of memory, unless `status` is STRUT_OK; returns `status`. */
strut_status strut_tell_failure(const strut_listener *listener, strut_status status,
                                const strut_error *error);
/** Tells lines; NULL: memory is out, which is told and returned. */
strut_status strut_tell_lines(const strut_listener *listener, const char *lines);

#endif

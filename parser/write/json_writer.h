/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Growing JSON text, one member or item per line. Internal to parser/.
 */
#ifndef STRUT_PARSER_WRITE_JSON_WRITER_H
#define STRUT_PARSER_WRITE_JSON_WRITER_H

#include "parser/write/writer.h"

typedef struct strut_json_writer {
  strut_writer text;
  int depth;
  bool inside; /* the object or list that is open has something in it */
  bool keyed;  /* a key waits for its value */
} strut_json_writer;

/** Opens an object '{' or a list '['; closes it. */
void strut_json_open(strut_json_writer *json, char bracket);
void strut_json_close(strut_json_writer *json, char bracket);
/** The key of the value that follows, within an object. */
void strut_json_key(strut_json_writer *json, const char *key);
/** A value: a text, or what is JSON already (a number, true, false, null). */
void strut_json_put_text(strut_json_writer *json, const char *text);
void strut_json_put_raw(strut_json_writer *json, const char *raw);
/** The text with a line break at its end, a block of strut_allocate; NULL: memory was out. */
char *strut_json_finish(strut_json_writer *json);

#endif

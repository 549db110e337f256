/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/buffer.h"

#include <stdarg.h>
#include <stdio.h>

#include "engine/base/memory.h"

static bool make_room(strut_buffer *buffer, size_t more) {
  if (buffer->length + more < buffer->room) return true;
  size_t room = 2 * (buffer->length + more) + 256;
  char *text = strut_reallocate(buffer->text, room, 1);
  if (!text) return false;
  buffer->text = text;
  buffer->room = room;
  return true;
}

void strut_buffer_add(strut_buffer *buffer, const char *format, ...) {
  va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  int length = vsnprintf(NULL, 0, format, arguments);
  va_end(arguments);
  if (length < 0 || !make_room(buffer, (size_t)length)) {
    buffer->failed = true;
  } else {
    vsnprintf(buffer->text + buffer->length, buffer->room - buffer->length, format, again);
    buffer->length += (size_t)length;
  }
  va_end(again);
}

char *strut_buffer_take(strut_buffer *buffer) {
  char *text = buffer->text;
  if (buffer->failed) {
    strut_release(text);
    text = NULL;
  }
  *buffer = (strut_buffer){0};
  return text;
}

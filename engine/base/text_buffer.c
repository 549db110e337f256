/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/base/text_buffer.h"

#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"

bool strut_buffer_reserve(strut_buffer *buffer, size_t more) {
  if (!buffer->failed && buffer->length + more < buffer->room) return true;
  size_t room = 2 * (buffer->length + more) + 256;
  char *text = buffer->failed ? NULL : strut_reallocate(buffer->text, room, 1);
  buffer->failed = !text;
  if (!text) return false;
  buffer->text = text;
  buffer->room = room;
  return true;
}

void strut_buffer_put(strut_buffer *buffer, const char *text, size_t length) {
  if (!strut_buffer_reserve(buffer, length)) return;
  memcpy(buffer->text + buffer->length, text, length);
  buffer->length += length;
  buffer->text[buffer->length] = '\0';
}

void strut_buffer_add_list(strut_buffer *buffer, const char *format, va_list arguments) {
  va_list again;
  va_copy(again, arguments);
  int length = vsnprintf(NULL, 0, format, arguments);
  if (length < 0) buffer->failed = true;
  if (strut_buffer_reserve(buffer, (size_t)length)) {
    vsnprintf(buffer->text + buffer->length, buffer->room - buffer->length, format, again);
    buffer->length += (size_t)length;
  }
  va_end(again);
}

void strut_buffer_add(strut_buffer *buffer, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  strut_buffer_add_list(buffer, format, arguments);
  va_end(arguments);
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

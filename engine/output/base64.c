/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/base64.h"

#include <stdint.h>

enum { AT_ONCE = 3072 };

static size_t encode(const unsigned char *bytes, size_t count, char *text) {
  static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  char *at = text;
  for (size_t i = 0; i < count; i += 3) {
    size_t left = count - i;
    uint32_t group = (uint32_t)bytes[i] << 16;
    if (left > 1) group |= (uint32_t)bytes[i + 1] << 8;
    if (left > 2) group |= bytes[i + 2];
    *at++ = letters[group >> 18];
    *at++ = letters[group >> 12 & 63];
    *at++ = left > 1 ? letters[group >> 6 & 63] : '=';
    *at++ = left > 2 ? letters[group & 63] : '=';
  }
  return (size_t)(at - text);
}

void strut_base64_add(strut_buffer *buffer, const void *bytes, size_t count) {
  char text[AT_ONCE / 3 * 4];
  const unsigned char *from = bytes;
  for (size_t done = 0; done < count; done += AT_ONCE) {
    size_t part = count - done < AT_ONCE ? count - done : AT_ONCE;
    int length = (int)encode(from + done, part, text);
    strut_buffer_add(buffer, "%.*s", length, text);
  }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/language/faults.h"

#include <string.h>

static uint64_t dice = 20260101;

uint32_t throw_dice(uint32_t sides) {
  dice ^= dice << 13;
  dice ^= dice >> 7;
  dice ^= dice << 17;
  return (uint32_t)((dice >> 32) % sides);
}

static const char *const pieces[] = {"{",
                                     "}",
                                     "[",
                                     "]",
                                     ",",
                                     ":",
                                     " ",
                                     "\n",
                                     "#",
                                     " #x",
                                     "-",
                                     "- ",
                                     "\"",
                                     "'",
                                     "&a ",
                                     "*a",
                                     "!x ",
                                     "%",
                                     "@",
                                     "|",
                                     ">",
                                     "?",
                                     "? ",
                                     "\t",
                                     "\r",
                                     "\\",
                                     "<<",
                                     "~",
                                     "0",
                                     "x",
                                     ".",
                                     "...",
                                     "--",
                                     "---",
                                     "(",
                                     ")",
                                     "*",
                                     "/",
                                     "^",
                                     "+",
                                     "\xC3\xA4",
                                     "\xC2\x85",
                                     "\xE2\x80\xA8",
                                     "  ",
                                     ", ",
                                     ": ",
                                     "\n\n",
                                     "\n ",
                                     "\n  ",
                                     "a: ",
                                     "{a: ",
                                     "[a",
                                     "|\n",
                                     "\"\n",
                                     "'\n",
                                     "&b\n",
                                     "\n# comment\n",
                                     "\n---\n",
                                     "\n...\n"};

size_t spoil_text(const char *text, size_t length, char *spoilt) {
  memcpy(spoilt, text, length);
  for (uint32_t left = 1 + throw_dice(3); left > 0; left--) {
    size_t at = throw_dice((uint32_t)length), cut = throw_dice(3) ? throw_dice(3) : throw_dice(40);
    const char *piece = pieces[throw_dice(sizeof pieces / sizeof pieces[0])];
    size_t insert = throw_dice(4) ? strlen(piece) : 0;
    if (cut > length - at) cut = length - at;
    memmove(spoilt + at + insert, spoilt + at + cut, length - at - cut);
    memcpy(spoilt + at, piece, insert);
    length += insert;
    length -= cut;
    if (!length) spoilt[length++] = '\n';
  }
  return length;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cairo numbers an SVG's surfaces through the life of the process: here from 0 in every picture, so
   that its bytes do not tell what was drawn before. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/draw/canvas_parts.h"

/* How Cairo 1.16 and 1.18 call what carries such a number. Texts are outlines: none can look so. */
static const char *const prefixes[] = {"surface", "source-"};

typedef struct numbers {
  unsigned long *seen;
  size_t count, room;
} numbers;

/* The place of `number` among those seen so far; false when memory is out. */
static bool place_of(numbers *n, unsigned long number, size_t *place) {
  for (*place = 0; *place < n->count; ++*place)
    if (n->seen[*place] == number) return true;
  if (n->count == n->room) {
    size_t room = 2 * n->room + 16;
    unsigned long *more = strut_reallocate(n->seen, room, sizeof *more);
    if (!more) return false;
    n->seen = more;
    n->room = room;
  }
  n->seen[n->count++] = number;
  return true;
}

/* Length of the prefix of a numbered name at `text`, or 0. */
static size_t numbered(const char *text) {
  for (size_t i = 0; i < sizeof prefixes / sizeof *prefixes; i++) {
    size_t length = strlen(prefixes[i]);
    if (strncmp(text, prefixes[i], length) == 0 && text[length] >= '0' && text[length] <= '9')
      return length;
  }
  return 0;
}

bool strut_canvas_renumber(char *svg) {
  numbers n = {0};
  bool good = true;
  char *out = svg;
  for (const char *in = svg; *in && good;) {
    size_t length = *in == 's' ? numbered(in) : 0, place;
    if (!length) {
      *out++ = *in++;
      continue;
    }
    char *end;
    unsigned long number = strtoul(in + length, &end, 10);
    good = place_of(&n, number, &place);
    memmove(out, in, length);
    /* The i-th that appears cannot have a number below i: the new one is never longer. */
    char digits[24];
    size_t count = (size_t)snprintf(digits, sizeof digits, "%zu", place);
    memcpy(out + length, digits, count);
    out += length + count;
    in = end;
  }
  if (good) *out = '\0';
  strut_release(n.seen);
  return good;
}

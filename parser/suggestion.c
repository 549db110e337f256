/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <string.h>

#include "parser/yaml/diagnostics.h"
#include "parser/yaml/text.h"

/* Longer words get no suggestion; more candidates than this are not worth the time. */
enum { WORD_MOST = 64, CANDIDATE_MOST = 10000 };

typedef struct word {
  uint32_t code[WORD_MOST];
  size_t length;
} word;

static bool decode(const char *text, word *result) {
  size_t left = strnlen(text, 4 * WORD_MOST + 1);
  result->length = 0;
  while (left) {
    if (result->length == WORD_MOST) return false;
    size_t size = strut_text_decode(text, left, &result->code[result->length++]);
    text += size;
    left -= size;
  }
  return result->length > 0;
}

static size_t least(size_t a, size_t b) { return a < b ? a : b; }

/*
 * Insertions, deletions, substitutions and swaps of neighbours from a to b; most + 1 where there are
 * more than `most`. Only the band of the table that so few steps can reach is computed.
 */
static size_t distance(const word *a, const word *b, size_t most) {
  size_t rows[3][WORD_MOST + 2];
  size_t *before = rows[0], *above = rows[1], *row = rows[2], beyond = most + 1, last_nearest = 0;
  for (size_t j = 0; j <= b->length; j++) above[j] = least(j, beyond);
  for (size_t i = 1; i <= a->length; i++) {
    size_t first = i > most ? i - most : 1, last = least(b->length, i + most), nearest = beyond;
    row[first - 1] = first == 1 ? least(i, beyond) : beyond;
    for (size_t j = first; j <= last; j++) {
      size_t inserted = j < i + most ? above[j] + 1 : beyond;
      size_t substituted = above[j - 1] + (a->code[i - 1] != b->code[j - 1]);
      row[j] = least(least(inserted, row[j - 1] + 1), least(substituted, beyond));
      if (i > 1 && j > 1 && a->code[i - 1] == b->code[j - 2] && a->code[i - 2] == b->code[j - 1])
        row[j] = least(row[j], before[j - 2] + 1);
      nearest = least(nearest, row[j]);
    }
    nearest = least(nearest, row[first - 1]);
    if (nearest > most && last_nearest > most) return beyond; /* a swap looks two rows back */
    last_nearest = nearest;
    size_t *oldest = before;
    before = above;
    above = row;
    row = oldest;
  }
  return above[b->length];
}

const char *strut_did_you_mean(const char *text, const char *(*next)(const void *context, size_t i),
                               const void *context) {
  word wanted, candidate;
  if (!decode(text, &wanted)) return NULL;
  size_t allowed = wanted.length / 3 > 1 ? wanted.length / 3 : 1;
  const char *best = NULL, *name;
  for (size_t i = 0; i < CANDIDATE_MOST && (name = next(context, i)) != NULL; i++) {
    if (!decode(name, &candidate)) continue;
    size_t longer = wanted.length > candidate.length ? wanted.length : candidate.length;
    if (longer - least(wanted.length, candidate.length) > allowed) continue;
    size_t steps = distance(&wanted, &candidate, allowed);
    if (steps > allowed || steps >= longer) continue; /* nothing in common is no suggestion */
    best = name;
    if (steps == 0) return best;
    allowed = steps - 1; /* only a nearer one replaces it */
  }
  return best;
}

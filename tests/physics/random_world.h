/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Random scenes in the language that have every element, with the texts of their expressions beside them.
 */
#pragma once

#include "tests/physics/slow_world.h"

/** What a scene has beside springs, a running cable and hinges. */
typedef enum world_part {
  WORLD_BODIES = 1,   /* cells, collisions and distances */
  WORLD_GROUNDS = 2,  /* several, of every shape, some of them shaken */
  WORLD_DRIVES = 4,   /* moved supports, rotating masses, forces, moments; damping by ratios */
  WORLD_FEEDBACK = 8, /* sensors, expressions, states, lags, Maxwell branches */
  WORLD_SAMPLES = 16, /* sampled signals and controllers, every millisecond */
  WORLD_MEMORY = 32,  /* elements that yield, break, are released or rub */
  WORLD_SMOOTH = 64,  /* without what no method without events integrates at its order: one-sided
                          elements, contacts, stops, collisions */
  WORLD_LIGHT = 128,  /* grounds are hard, and touched from above only, as in life */
  WORLD_ALL = 63
} world_part;

enum { WORLD_SECTIONS = 16, WORLD_TEXTS = 16 };

typedef struct random_world {
  char text[32768]; /* of the whole scene */
  slow_text texts[WORLD_TEXTS];
  size_t text_count;
  /* while it is written */
  unsigned parts;
  uint64_t random;
  int nodes, ring; /* the first `ring` of them stand on a circle of 1 m */
  char section[WORLD_SECTIONS][6144];
} random_world;

/** Fills the world; parts: bits of world_part. */
void random_world_make(random_world *w, uint64_t seed, unsigned parts);

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/equilibria/barriers.h"

#include <math.h>

/* The first that stands in each of the landscape's minima, or -1. */
static void represent(const strut_equilibrium_search *h, int32_t *of_state) {
  for (int32_t s = 0; s < h->landscape.minima; s++) of_state[s] = -1;
  for (size_t i = 0; i < h->count; i++) {
    const strut_candidate_equilibrium *f = &h->finds[i];
    if (f->e.fate != STRUT_OUTCOME_STANDS || f->state < 0) continue;
    if (of_state[f->state] < 0) of_state[f->state] = (int32_t)i;
  }
}

static bool is_named(const strut_equilibrium_search *h, int32_t find) {
  return find >= 0 && h->finds[find].e.configured;
}

static bool next_to_named(const strut_equilibrium_search *h, const int32_t *of_state, int32_t s) {
  for (int32_t t = 0; t < h->landscape.minima; t++) {
    if (t == s || !is_named(h, of_state[t])) continue;
    if (strut_landscape_direct(&h->landscape, t, s) >= 0) return true;
  }
  return false;
}

/* States that enter the table, at most STRUT_MOST_BARRIERS_BETWEEN; their count. */
static int choose(const strut_equilibrium_search *h, const int32_t *of_state, int32_t *chosen) {
  int32_t minima = h->landscape.minima;
  bool names = false;
  int count = 0;
  for (int32_t s = 0; s < minima; s++) names = names || is_named(h, of_state[s]);
  for (int pass = 0; pass < 2; pass++) /* named ones first: they must not fall off the end */
    for (int32_t s = 0; s < minima && count < STRUT_MOST_BARRIERS_BETWEEN; s++) {
      if (of_state[s] < 0 || is_named(h, of_state[s]) != (pass == 0)) continue;
      if (pass == 1 && names && !next_to_named(h, of_state, s)) continue;
      chosen[count++] = s;
    }
  return count;
}

static int32_t find_saddle(const strut_equilibrium_search *h, int32_t saddle) {
  for (size_t i = 0; i < h->count; i++)
    if (!h->finds[i].e.supports && h->finds[i].number == saddle) return (int32_t)i;
  return -1;
}

/* The barrier from one of the landscape's minima to another; false: out of memory. */
static bool fill(const strut_equilibrium_search *h, const int32_t *of_state, int32_t a, int32_t b,
                 int32_t way, strut_barrier *barrier) {
  const strut_landscape *l = &h->landscape;
  const strut_critical_point *points = l->set.points;
  int32_t direct = strut_landscape_direct(l, a, b);
  *barrier = (strut_barrier){
      .from = of_state[a],
      .to = of_state[b],
      .height = points[way].potential - points[a].potential,
      .saddle = find_saddle(h, way),
      .direct = direct >= 0 ? points[direct].potential - points[a].potential : (double)NAN,
      .direct_saddle = direct >= 0 ? find_saddle(h, direct) : -1};
  barrier->via = strut_arena_allocate(&h->out->arena, (size_t)l->minima, sizeof *barrier->via);
  if (!barrier->via) return false;
  barrier->via_count = strut_landscape_between(l, a, b, way, barrier->via);
  for (int32_t i = 0; i < barrier->via_count; i++) barrier->via[i] = of_state[barrier->via[i]];
  return true;
}

strut_status strut_barriers_find(strut_equilibrium_search *h) {
  const strut_landscape *l = &h->landscape;
  int32_t chosen[STRUT_MOST_BARRIERS_BETWEEN];
  int32_t *of_state = strut_allocate((size_t)l->minima, sizeof *of_state);
  size_t most = (size_t)STRUT_MOST_BARRIERS_BETWEEN * (STRUT_MOST_BARRIERS_BETWEEN - 1);
  h->out->barriers = strut_arena_allocate(&h->out->arena, most, sizeof *h->out->barriers);
  bool good = of_state && h->out->barriers;
  if (good) represent(h, of_state);
  int count = good ? choose(h, of_state, chosen) : 0;
  for (int a = 0; a < count; a++)
    for (int b = 0; b < count && good; b++) {
      int32_t way = a == b ? -1 : strut_landscape_path(l, chosen[a], chosen[b]);
      if (way < 0) continue;
      good =
          fill(h, of_state, chosen[a], chosen[b], way, &h->out->barriers[h->out->barrier_count++]);
    }
  strut_release(of_state);
  return good ? STRUT_OK : strut_fail(h->error, STRUT_NO_MEMORY, "out of memory");
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/physics/random_elements.h"

#include <math.h>

#include "engine/base/vec.h"
#include "tests/support/build.h"
#include "tests/support/random.h"

/* A table that rises through the origin, by `points` random steps on either side. */
static void make_table(strut_scene *scene, strut_law *law, double size, double force, uint64_t *r) {
  enum { MOST = 9 };
  double x[MOST] = {0}, y[MOST] = {0};
  int32_t half = 1 + random_below(r, MOST / 2), count = 2 * half + 1;
  for (int sign = -1; sign <= 1; sign += 2)
    for (int32_t k = 1; k <= half; k++) {
      int32_t at = half + sign * k, before = at - sign;
      x[at] = x[before] + sign * random_between(r, 0.1, 0.6) * size;
      y[at] = y[before] + sign * random_between(r, 0.05, 1.0) * force;
    }
  law->count = (size_t)count;
  law->x = build_numbers(scene, x, law->count);
  law->force = build_numbers(scene, y, law->count);
  law->smooth = random_once_in(r, 2);
}

strut_law random_law(strut_scene *scene, strut_law_kind kind, double size, double force,
                     uint64_t *r) {
  strut_law law = {.kind = kind};
  double stiffness = force / size;
  switch (kind) {
    case STRUT_LAW_BILINEAR:
      law.knee = random_between(r, 0.1, 0.8) * size;
      law.second_stiffness = random_between(r, 0.1, 3.0) * stiffness;
      break;
    case STRUT_LAW_PLAY: law.gap = random_between(r, 0.1, 0.8) * size; break;
    case STRUT_LAW_ELASTIC_PLASTIC: law.yield = 1e6 * force; break; /* never */
    case STRUT_LAW_EXPONENTIAL: law.scale = random_between(r, 0.5, 2.0) * size; break;
    case STRUT_LAW_POLYNOMIAL: {
      const double c[] = {random_between(r, 0.1, 1.0) * stiffness,
                          random_between(r, -0.1, 0.1) * stiffness / size,
                          random_between(r, 0.1, 1.0) * stiffness / (size * size)};
      law.force = build_numbers(scene, c, 3);
      law.count = 3;
      break;
    }
    case STRUT_LAW_TABLE: make_table(scene, &law, size, force, r); break;
    case STRUT_LAW_FOLDING: /* without folds it is the table, without a spline */
      make_table(scene, &law, size, force, r);
      law.smooth = false;
      break;
    case STRUT_LAW_LINEAR:
    case STRUT_LAW_AXIAL:
    case STRUT_LAW_LOGARITHMIC:
    case STRUT_LAW_PRESSURE:
    case STRUT_LAW_ISOTHERMAL:
    case STRUT_LAW_ISENTROPIC:
    case STRUT_LAW_COUNT: break;
  }
  return law;
}

/* A law without memory, which statics and every method know. */
static strut_law_kind random_kind(uint64_t *r) {
  strut_law_kind kind = (strut_law_kind)random_below(r, STRUT_LAW_FOLDING - 1);
  return kind < STRUT_LAW_ELASTIC_PLASTIC ? kind : (strut_law_kind)(kind + 1);
}

/* A member from node to node with a random law, and stops now and then. */
static void add_member(strut_scene *scene, int32_t a, int32_t b, double damping, uint64_t *r) {
  const double *from = scene->nodes[a].position, *to = scene->nodes[b].position;
  double drawn = strut_distance(from, to), stiffness = random_between(r, 50, 200);
  strut_law_kind kind = random_kind(r);
  double rest = drawn * random_between(r, 0.8, 1.1);
  double own = damping * random_between(r, 0.1, 1.0);
  strut_member_kind member = random_once_in(r, 3) ? STRUT_CABLE : STRUT_SPRING;
  int32_t j = build_sized(scene, member, a, b, stiffness, own, 0, rest);
  strut_member *m = &scene->members[j];
  m->law = random_law(scene, kind, 0.3 * drawn, 0.3 * drawn * stiffness, r);
  if (m->kind == STRUT_SPRING) m->law.carries = (strut_carries)random_below(r, 3);
  if (strut_law_at(kind)->own) m->stiffness = 0;
  if (random_once_in(r, 2)) m->longest = drawn * random_between(r, 1.02, 1.1);
  if (random_once_in(r, 2)) m->shortest = drawn * random_between(r, 0.9, 0.98);
  bool stops = m->shortest > 0.0 || m->longest > 0.0;
  if (stops) m->stop_stiffness = 500, m->stop_damping = damping * random_between(r, 0.0, 3.0);
}

static void add_hinge(strut_scene *scene, int32_t a, int32_t b, int32_t c, double damping,
                      uint64_t *r) {
  double stiffness = random_between(r, 5, 20);
  strut_law_kind kind = random_kind(r);
  if (kind == STRUT_LAW_LOGARITHMIC) kind = STRUT_LAW_LINEAR;
  int32_t i = build_hinge(scene, a, b, c, stiffness, 0.1 * damping * random_between(r, 0.1, 1.0));
  strut_hinge *h = &scene->hinges[i];
  h->law = random_law(scene, kind, 0.5, 0.5 * stiffness, r);
  if (random_once_in(r, 3)) h->law.carries = (strut_carries)random_below(r, 3);
  if (strut_law_at(kind)->own) h->stiffness = 0;
  h->rest_angle = strut_hinge_drawn(scene, (size_t)i) + random_between(r, -0.5, 0.5);
}

void random_elements(strut_scene *scene, uint64_t seed, double damping) {
  uint64_t r = seed ^ 0x9e3779b97f4a7c15u;
  strut_scene_init(scene);
  int32_t n = 5 + random_below(&r, 3);
  for (int32_t i = 0; i < n; i++) {
    double turn = STRUT_TAU * (i + random_between(&r, -0.15, 0.15)) / n;
    build_mass(scene, cos(turn), sin(turn), random_between(&r, 0.5, 2));
  }
  scene->nodes[0].fixed[0] = scene->nodes[0].fixed[1] = true;
  for (int32_t i = 0; i < n; i++)
    build_member(scene, STRUT_SPRING, i, (i + 1) % n, 200, damping * 0.5, 0);
  const int32_t guides[] = {2, 4};
  int32_t j = build_member(scene, STRUT_CABLE, 0, 3, 80, damping * 0.3, 0.2);
  build_guides(scene, j, guides, 1 + (size_t)random_below(&r, 2));
  scene->members[j].rest_value = random_between(&r, 0.85, 1.02);
  for (int32_t k = 0; k < 3; k++) {
    int32_t a = random_below(&r, n), b = (a + 2 + random_below(&r, n - 3)) % n;
    add_member(scene, a, b, damping, &r);
  }
  for (int32_t k = 0; k < 2; k++) {
    int32_t b = random_below(&r, n);
    add_hinge(scene, (b + n - 1) % n, b, (b + 1 + random_below(&r, 2)) % n, damping, &r);
  }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/physics/random_scene.h"

#include "tests/support/build.h"
#include "tests/support/random.h"

/* Nodes lie near the points of a grid of 1 m, so that no two come close. */
static void add_node(strut_scene *scene, uint64_t *r) {
  size_t i = scene->node_count;
  double x = (double)(i % 6) + random_between(r, -0.3, 0.3);
  double y = (double)(i / 6) - 0.5 + random_between(r, -0.3, 0.3);
  build_node(scene, x, y);
  strut_node *node = &scene->nodes[i];
  if (random_once_in(r, 3)) node->mass = random_scale(r, 0.01, 10);
  if (!random_once_in(r, 5)) return;
  int which = 1 + random_below(r, 3);
  node->fixed[0] = which & 1, node->fixed[1] = which & 2;
}

/* Stiffness, damping, rest length in one of the four ways; always a valid set. */
static void set_law(strut_scene *scene, strut_member *m, uint64_t *r) {
  const double *a = scene->nodes[m->node[0]].position, *b = scene->nodes[m->node[1]].position;
  double drawn = hypot(b[0] - a[0], b[1] - a[1]);
  m->stiffness = random_scale(r, 10, 1e4);
  if (!random_once_in(r, 3)) m->damping = random_scale(r, 0.1, 100);
  m->rest_kind = (strut_rest_kind)random_below(r, 4);
  double ratio = random_between(r, 0.6, 1.3), force = m->stiffness * (1 - ratio) * drawn;
  bool by_ea = random_once_in(r, 4);
  if (m->kind == STRUT_CABLE && force < 0)
    m->rest_kind = random_once_in(r, 2) ? STRUT_REST_RATIO : STRUT_REST_LENGTH;
  if (by_ea) m->axial_stiffness = 2 * m->stiffness * drawn, m->stiffness = 0;
  m->rest_value = m->rest_kind == STRUT_REST_RATIO        ? ratio
                  : m->rest_kind == STRUT_REST_LENGTH     ? ratio * drawn
                  : m->rest_kind == STRUT_REST_PRETENSION ? force
                                                          : force / drawn;
  if (by_ea || !random_once_in(r, 8)) return;
  m->rest_kind = STRUT_REST_LENGTH;
  m->rest_value = random_once_in(r, 2) ? 0 : drawn;
  if (m->rest_value == 0) return;
  m->stiffness = 0, m->damping = random_scale(r, 1, 100); /* a damper alone */
}

static void add_member(strut_scene *scene, int32_t a, int32_t b, double mass, uint64_t *r) {
  int32_t kind = mass > 0 ? STRUT_BAR : random_below(r, 3);
  int32_t j = random_once_in(r, 2) ? build_member(scene, (strut_member_kind)kind, a, b, 0, 0, mass)
                                   : build_member(scene, (strut_member_kind)kind, b, a, 0, 0, mass);
  set_law(scene, &scene->members[j], r);
}

/* `size` nodes that masses couple: a random tree of heavy bars and a few more of them. */
static void add_group(strut_scene *scene, int32_t size, uint64_t *r) {
  int32_t first = (int32_t)scene->node_count;
  for (int32_t i = 0; i < size; i++) add_node(scene, r);
  for (int32_t i = 1; i < size; i++) {
    double mass = random_scale(r, 0.01, 10);
    add_member(scene, first + random_below(r, i), first + i, mass, r);
  }
  for (int32_t i = 0; i < size / 3; i++) {
    int32_t a = random_below(r, size), b = random_below(r, size);
    if (a != b) add_member(scene, first + a, first + b, random_scale(r, 0.01, 10), r);
  }
  if (size == 1) scene->nodes[first].mass = random_scale(r, 0.01, 10);
}

static void add_structure(strut_scene *scene, uint64_t *r) {
  int32_t groups = 1 + random_below(r, 4);
  for (int32_t i = 0; i < groups; i++) {
    bool large = random_once_in(r, 4);
    add_group(scene, large ? 9 + random_below(r, 16) : 1 + random_below(r, 10), r);
  }
  int32_t n = (int32_t)scene->node_count;
  if (n == 1) build_support(scene, 1, -0.4), n++;
  for (int32_t i = 0; i < n; i++) {
    int32_t a = random_below(r, n), b = random_below(r, n);
    if (a != b) add_member(scene, a, b, 0, r);
  }
  if (random_once_in(r, 3)) { /* a member between fixed nodes, twice */
    int32_t a = build_support(scene, -1, 1), b = build_support(scene, -1, 2.5);
    add_member(scene, a, b, random_once_in(r, 2) ? 1.5 : 0, r);
    add_member(scene, b, a, 0, r);
  }
}

/* One signal of every kind; the sum comes last. */
static void add_signals(strut_scene *scene, uint64_t *r) {
  static int32_t terms[] = {1, 3, 5};
  for (int kind = STRUT_CONSTANT; kind <= STRUT_SUM; kind++) {
    strut_signal s = strut_signal_default((strut_signal_kind)kind);
    s.amplitude = random_between(r, -0.2, 0.2);
    s.frequency = random_between(r, 0.3, 3);
    if (kind == STRUT_SINE || kind == STRUT_SQUARE) s.phase = random_between(r, -1, 1);
    s.start = random_once_in(r, 2) ? 0 : random_between(r, 0, 1);
    if (kind == STRUT_RAMP || random_once_in(r, 4)) s.stop = s.start + random_between(r, 0.2, 1.5);
    if (kind == STRUT_TABLE) {
      double time[] = {0, random_between(r, 0.1, 0.5), random_between(r, 0.6, 1), 1.5};
      double value[] = {random_between(r, -0.2, 0.2), 0.1, random_between(r, -0.2, 0.2), -0.1};
      s.point_count = 1 + (size_t)random_below(r, 4);
      s.time = build_numbers(scene, time, 4), s.value = build_numbers(scene, value, 4);
    }
    if (kind == STRUT_SUM) s.terms = terms, s.term_count = 3;
    build_signal(scene, s);
  }
}

static void add_drives_and_loads(strut_scene *scene, uint64_t *r) {
  int32_t members = (int32_t)scene->member_count, nodes = (int32_t)scene->node_count;
  int32_t signals = (int32_t)scene->signal_count;
  for (int32_t i = random_below(r, 6); i > 0; i--) {
    int32_t signal = random_below(r, signals);
    build_actuator(scene, random_below(r, members), signal);
  }
  if (scene->actuator_count) /* two on one member add up */
    build_actuator(scene, scene->actuators[0].member, random_below(r, signals));
  for (int32_t i = random_below(r, 5); i > 0; i--) {
    int32_t signal = random_once_in(r, 2) ? -1 : random_below(r, signals);
    double fy = random_between(r, -50, 50), fx = random_between(r, -50, 50);
    build_load(scene, random_below(r, nodes), fx, fy, signal);
  }
}

static void add_ground(strut_scene *scene, uint64_t *r) {
  bool rough = random_once_in(r, 2);
  scene->ground.height = random_between(r, -0.5, 0.5);
  if (random_once_in(r, 2)) scene->ground.slope = random_between(r, -0.7, 0.7);
  if (random_once_in(r, 2)) scene->ground.belt_speed = random_between(r, -1, 1);
  for (int32_t i = 0; i < (int32_t)scene->node_count; i++) {
    if (random_once_in(r, 4)) continue;
    double stiffness = random_scale(r, 100, 1e4);
    double damping = random_once_in(r, 3) ? 0 : random_scale(r, 1, 100);
    double mu_kinetic = random_between(r, 0.1, 1), mu_static = mu_kinetic * random_between(r, 1, 3);
    if (rough && !random_once_in(r, 4))
      build_rough_contact(scene, i, stiffness, damping, mu_static, mu_kinetic,
                          random_scale(r, 1e-3, 2));
    else
      build_contact(scene, i, stiffness, damping);
  }
  scene->ground.present = scene->contact_count > 0;
}

void random_scene(strut_scene *scene, uint64_t seed) {
  uint64_t state = seed, *r = &state;
  strut_scene_init(scene);
  scene->mass_model = random_once_in(r, 4) ? STRUT_MASS_LUMPED : STRUT_MASS_CONSISTENT;
  add_structure(scene, r);
  if (random_once_in(r, 2)) /* supports alike in x and y: one mass matrix for both */
    for (size_t i = 0; i < scene->node_count; i++)
      scene->nodes[i].fixed[1] = scene->nodes[i].fixed[0];
  add_signals(scene, r);
  if (!random_once_in(r, 4)) add_drives_and_loads(scene, r);
  if (!random_once_in(r, 3)) scene->gravity[1] = random_between(r, -20, 0);
  if (random_once_in(r, 3)) scene->gravity[0] = random_between(r, -5, 5);
  if (!random_once_in(r, 4)) add_ground(scene, r);
}

void random_motion(const strut_scene *scene, uint64_t seed, double *t, double *q, double *v) {
  uint64_t state = ~seed, *r = &state;
  *t = random_between(r, 0, 2);
  for (size_t i = 0; i < 2 * scene->node_count; i++) {
    const strut_node *node = &scene->nodes[i / 2];
    q[i] = node->position[i % 2] + (node->fixed[i % 2] ? 0 : random_between(r, -0.15, 0.15));
    v[i] = node->fixed[i % 2] ? 0 : random_between(r, -2, 2);
  }
}

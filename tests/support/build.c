/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/support/build.h"

#include "tests/support/check.h"

strut_scene build_scene(void) {
  strut_scene scene;
  strut_scene_init(&scene);
  return scene;
}

strut_setup build_setup(void) {
  strut_setup setup;
  strut_setup_init(&setup);
  return setup;
}

/* The new last one of an array of `count` things, whose room doubles at 8, 16, 32, ...; all zero. */
static void *add(strut_scene *scene, void *array, size_t *count, size_t size) {
  void **things = array;
  bool full = *count == 0 || (*count >= 8 && (*count & (*count - 1)) == 0);
  if (full) {
    void *larger = strut_arena_allocate(&scene->arena, *count ? 2 * *count : 8, size);
    assert_non_null(larger);
    if (*count) memcpy(larger, *things, *count * size);
    *things = larger;
  }
  return (char *)*things + (*count)++ * size;
}
#define ADD(things, count) add(scene, &scene->things, &scene->count, sizeof *scene->things)

/* The last one's name: the letter and its number from 1. */
static const char *name(strut_scene *scene, const char *letter, size_t number) {
  const char *text = strut_arena_format(&scene->arena, "%s%zu", letter, number);
  assert_non_null(text);
  return text;
}

int32_t build_node(strut_scene *scene, double x, double y) {
  strut_node *node = ADD(nodes, node_count);
  *node = strut_node_default();
  node->name = name(scene, "n", scene->node_count);
  node->position[0] = node->start[0] = x, node->position[1] = node->start[1] = y;
  return (int32_t)scene->node_count - 1;
}

int32_t build_mass(strut_scene *scene, double x, double y, double mass) {
  int32_t i = build_node(scene, x, y);
  scene->nodes[i].mass = mass;
  return i;
}

int32_t build_support(strut_scene *scene, double x, double y) {
  int32_t i = build_node(scene, x, y);
  scene->nodes[i].fixed[0] = scene->nodes[i].fixed[1] = true;
  return i;
}

int32_t build_member(strut_scene *scene, strut_member_kind kind, int32_t from, int32_t to,
                     double stiffness, double damping, double mass) {
  strut_member *member = ADD(members, member_count);
  *member = strut_member_default();
  member->name = name(scene, "m", scene->member_count);
  member->kind = kind, member->node[0] = from, member->node[1] = to;
  member->stiffness = stiffness, member->damping = damping, member->mass = mass;
  return (int32_t)scene->member_count - 1;
}

int32_t build_sized(strut_scene *scene, strut_member_kind kind, int32_t from, int32_t to,
                    double stiffness, double damping, double mass, double rest_length) {
  int32_t i = build_member(scene, kind, from, to, stiffness, damping, mass);
  scene->members[i].rest_kind = STRUT_REST_LENGTH, scene->members[i].rest_value = rest_length;
  return i;
}

int32_t build_signal(strut_scene *scene, strut_signal signal) {
  strut_signal *added = ADD(signals, signal_count);
  *added = signal;
  added->name = name(scene, "s", scene->signal_count);
  return (int32_t)scene->signal_count - 1;
}

int32_t build_sine(strut_scene *scene, double amplitude, double frequency) {
  strut_signal signal = strut_signal_default(STRUT_SINE);
  signal.amplitude = amplitude, signal.frequency = frequency;
  return build_signal(scene, signal);
}

int32_t build_actuator(strut_scene *scene, int32_t member, int32_t signal) {
  strut_actuator *actuator = ADD(actuators, actuator_count);
  *actuator = (strut_actuator){.member = member, .hinge = -1, .signal = signal};
  actuator->name = name(scene, "a", scene->actuator_count);
  return (int32_t)scene->actuator_count - 1;
}

int32_t build_hinge(strut_scene *scene, int32_t a, int32_t b, int32_t c, double stiffness,
                    double damping) {
  strut_hinge *hinge = ADD(hinges, hinge_count);
  *hinge = strut_hinge_default();
  hinge->name = name(scene, "h", scene->hinge_count);
  hinge->node[0] = a, hinge->node[1] = b, hinge->node[2] = c;
  hinge->stiffness = stiffness, hinge->damping = damping;
  return (int32_t)scene->hinge_count - 1;
}

void build_guides(strut_scene *scene, int32_t member, const int32_t *guides, size_t count) {
  int32_t *copy = strut_arena_allocate(&scene->arena, count, sizeof *copy);
  assert_non_null(copy);
  memcpy(copy, guides, count * sizeof *copy);
  scene->members[member].guides = copy, scene->members[member].guide_count = count;
}

int32_t build_load(strut_scene *scene, int32_t node, double x, double y, int32_t signal) {
  strut_load *load = ADD(loads, load_count);
  *load = (strut_load){.node = node, .force = {x, y}, .signal = signal};
  load->name = name(scene, "l", scene->load_count);
  return (int32_t)scene->load_count - 1;
}

int32_t build_contact(strut_scene *scene, int32_t node, double stiffness, double damping) {
  strut_contact *contact = ADD(contacts, contact_count);
  *contact = strut_contact_default();
  contact->node = node, contact->stiffness = stiffness, contact->damping = damping;
  scene->ground.present = true;
  return (int32_t)scene->contact_count - 1;
}

int32_t build_rough_contact(strut_scene *scene, int32_t node, double stiffness, double damping,
                            double mu_static, double mu_kinetic, double stick_velocity) {
  int32_t i = build_contact(scene, node, stiffness, damping);
  scene->contacts[i].friction = (strut_friction){.law = STRUT_FRICTION_KARNOPP,
                                                 .mu_static = mu_static,
                                                 .mu_kinetic = mu_kinetic,
                                                 .stick_velocity = stick_velocity};
  return i;
}

const double *build_numbers(strut_scene *scene, const double *numbers, size_t count) {
  double *copy = strut_arena_allocate(&scene->arena, count, sizeof *copy);
  assert_non_null(copy);
  memcpy(copy, numbers, count * sizeof *copy);
  return copy;
}

strut_setup build_falling(void) {
  strut_setup setup = build_setup();
  setup.scene.gravity[1] = -9.81;
  return setup;
}

strut_setup build_tethered(double x, double y, double mass) {
  strut_setup setup = build_setup();
  build_support(&setup.scene, 0, 0);
  build_mass(&setup.scene, x, y, mass);
  return setup;
}

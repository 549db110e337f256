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

/* Room for one more in an array of `count` things: it doubles at 8, 16, 32, ... */
static void *grown(strut_scene *scene, void *array, size_t count, size_t size) {
  bool full = count == 0 || (count >= 8 && (count & (count - 1)) == 0);
  if (!full) return array;
  void *larger = strut_arena_allocate(&scene->arena, count ? 2 * count : 8, size);
  assert_non_null(larger);
  if (count) memcpy(larger, array, count * size);
  return larger;
}

static const char *name(strut_scene *scene, const char *letter, size_t index) {
  const char *text = strut_arena_format(&scene->arena, "%s%zu", letter, index + 1);
  assert_non_null(text);
  return text;
}

int32_t build_node(strut_scene *scene, double x, double y) {
  size_t i = scene->node_count;
  scene->nodes = grown(scene, scene->nodes, i, sizeof *scene->nodes);
  strut_node *node = &scene->nodes[i];
  *node = strut_node_default();
  node->name = name(scene, "n", i);
  node->position[0] = node->start[0] = x;
  node->position[1] = node->start[1] = y;
  scene->node_count++;
  return (int32_t)i;
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
  size_t i = scene->member_count;
  scene->members = grown(scene, scene->members, i, sizeof *scene->members);
  strut_member *member = &scene->members[i];
  *member = strut_member_default();
  member->name = name(scene, "m", i);
  member->kind = kind;
  member->node[0] = from, member->node[1] = to;
  member->stiffness = stiffness, member->damping = damping, member->mass = mass;
  scene->member_count++;
  return (int32_t)i;
}

int32_t build_sized(strut_scene *scene, strut_member_kind kind, int32_t from, int32_t to,
                    double stiffness, double damping, double mass, double rest_length) {
  int32_t i = build_member(scene, kind, from, to, stiffness, damping, mass);
  scene->members[i].rest_kind = STRUT_REST_LENGTH;
  scene->members[i].rest_value = rest_length;
  return i;
}

int32_t build_signal(strut_scene *scene, strut_signal signal) {
  size_t i = scene->signal_count;
  scene->signals = grown(scene, scene->signals, i, sizeof *scene->signals);
  signal.name = name(scene, "s", i);
  scene->signals[i] = signal;
  scene->signal_count++;
  return (int32_t)i;
}

int32_t build_sine(strut_scene *scene, double amplitude, double frequency) {
  strut_signal signal = strut_signal_default(STRUT_SINE);
  signal.amplitude = amplitude, signal.frequency = frequency;
  return build_signal(scene, signal);
}

int32_t build_actuator(strut_scene *scene, int32_t member, int32_t signal) {
  size_t i = scene->actuator_count;
  scene->actuators = grown(scene, scene->actuators, i, sizeof *scene->actuators);
  scene->actuators[i] = (strut_actuator){
      .name = name(scene, "a", i), .member = member, .hinge = -1, .signal = signal};
  scene->actuator_count++;
  return (int32_t)i;
}

int32_t build_hinge(strut_scene *scene, int32_t a, int32_t b, int32_t c, double stiffness,
                    double damping) {
  size_t i = scene->hinge_count;
  scene->hinges = grown(scene, scene->hinges, i, sizeof *scene->hinges);
  strut_hinge *hinge = &scene->hinges[i];
  *hinge = strut_hinge_default();
  hinge->name = name(scene, "h", i);
  hinge->node[0] = a, hinge->node[1] = b, hinge->node[2] = c;
  hinge->stiffness = stiffness, hinge->damping = damping;
  scene->hinge_count++;
  return (int32_t)i;
}

void build_guides(strut_scene *scene, int32_t member, const int32_t *guides, size_t count) {
  int32_t *copy = strut_arena_allocate(&scene->arena, count, sizeof *copy);
  assert_non_null(copy);
  memcpy(copy, guides, count * sizeof *copy);
  scene->members[member].guides = copy;
  scene->members[member].guide_count = count;
}

int32_t build_load(strut_scene *scene, int32_t node, double x, double y, int32_t signal) {
  size_t i = scene->load_count;
  scene->loads = grown(scene, scene->loads, i, sizeof *scene->loads);
  scene->loads[i] =
      (strut_load){.name = name(scene, "l", i), .node = node, .force = {x, y}, .signal = signal};
  scene->load_count++;
  return (int32_t)i;
}

int32_t build_contact(strut_scene *scene, int32_t node, double stiffness, double damping) {
  size_t i = scene->contact_count;
  scene->contacts = grown(scene, scene->contacts, i, sizeof *scene->contacts);
  strut_contact *contact = &scene->contacts[i];
  *contact = strut_contact_default();
  contact->node = node, contact->stiffness = stiffness, contact->damping = damping;
  scene->ground.present = true;
  scene->contact_count++;
  return (int32_t)i;
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

strut_setup build_tethered(double x, double y, double mass) {
  strut_setup setup = build_setup();
  build_support(&setup.scene, 0, 0);
  build_mass(&setup.scene, x, y, mass);
  return setup;
}

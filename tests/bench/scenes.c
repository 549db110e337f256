/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/bench/scenes.h"

/* Sizes of a chain's frame and its members; the names of a node tell column and row. */
#define SIDE 0.1
#define BAR_STIFFNESS 1e5
#define BAR_MASS 0.1
#define CABLE_STIFFNESS 3000.0
#define CABLE_RATIO 0.98
#define DAMPING 0.2
enum { PER_FRAME = 5 };

static strut_status allocate(strut_setup *setup, size_t nodes, size_t members) {
  strut_setup_init(setup);
  setup->scene.nodes = strut_arena_allocate(&setup->scene.arena, nodes, sizeof *setup->scene.nodes);
  setup->scene.members =
      strut_arena_allocate(&setup->scene.arena, members, sizeof *setup->scene.members);
  if (!setup->scene.nodes || !setup->scene.members) {
    strut_setup_free(setup);
    return STRUT_NO_MEMORY;
  }
  setup->scene.node_count = nodes, setup->scene.member_count = members;
  return STRUT_OK;
}

static void place(strut_node *node, double x, double y) {
  *node = strut_node_default();
  node->position[0] = node->start[0] = x;
  node->position[1] = node->start[1] = y;
}

static void table1(strut_member *member, int i1, int i2, double rest, double stiffness,
                   double mass) {
  *member = strut_member_default();
  member->kind = mass > 0 ? STRUT_BAR : STRUT_SPRING;
  member->node[0] = i1 - 1, member->node[1] = i2 - 1;
  member->rest_kind = STRUT_REST_LENGTH, member->rest_value = rest;
  member->stiffness = stiffness, member->damping = 0.2, member->mass = mass;
}

static void fill_members(strut_member *m) {
  table1(&m[0], 1, 2, 0.10, 1e6, 0.1);
  table1(&m[1], 3, 5, 0.02, 1e6, 0.02);
  table1(&m[2], 4, 5, 0.02, 1e6, 0.02);
  table1(&m[3], 1, 3, 0.02, 3000, 0);
  table1(&m[4], 2, 3, 0.02, 3000, 0);
  table1(&m[5], 2, 4, 0.02, 3000, 0);
  table1(&m[6], 1, 4, 0.02, 3000, 0);
  table1(&m[7], 1, 5, 0.01, 1e4, 0);
  table1(&m[8], 2, 5, 0.01, 1e4, 0);
}

strut_status bench_crawler_scene(strut_setup *setup, double f, double a, double mu) {
  static const double drawn[5][2] = {{0, 0},
                                     {0.0965109, 0.0238714},
                                     {0.0526668, 0.0283691},
                                     {0.0602933, 0},
                                     {0.0434758, 0.0106875}};
  strut_status status = allocate(setup, 5, 9);
  if (status != STRUT_OK) return status;
  for (int i = 0; i < 5; i++) place(&setup->scene.nodes[i], drawn[i][0], drawn[i][1]);
  fill_members(setup->scene.members);
  setup->scene.gravity[1] = -9.81;
  setup->scene.ground.present = true;
  setup->scene.contacts =
      strut_arena_allocate(&setup->scene.arena, 5, sizeof *setup->scene.contacts);
  setup->scene.signals = strut_arena_allocate(&setup->scene.arena, 1, sizeof *setup->scene.signals);
  setup->scene.actuators =
      strut_arena_allocate(&setup->scene.arena, 1, sizeof *setup->scene.actuators);
  if (!setup->scene.contacts || !setup->scene.signals || !setup->scene.actuators) {
    strut_setup_free(setup);
    return STRUT_NO_MEMORY;
  }
  setup->scene.contact_count = 5, setup->scene.signal_count = setup->scene.actuator_count = 1;
  for (int i = 0; i < 5; i++) {
    setup->scene.contacts[i] = (strut_contact){.node = i, .stiffness = 1e5, .damping = 100};
    setup->scene.contacts[i].friction = (strut_friction){
        .law = STRUT_FRICTION_KARNOPP, .mu_static = mu, .mu_kinetic = mu, .stick_velocity = 1e-4};
  }
  setup->scene.signals[0] = strut_signal_default(STRUT_SINE);
  setup->scene.signals[0].amplitude = a, setup->scene.signals[0].frequency = f;
  setup->scene.actuators[0] = (strut_actuator){.name = "drive", .member = 7, .signal = 0};
  setup->experiment.step = 1e-4, setup->experiment.duration = 1;
  return STRUT_OK;
}

static strut_member link(strut_member_kind kind, size_t from, size_t to) {
  strut_member member = strut_member_default();
  member.kind = kind;
  member.node[0] = (int32_t)from, member.node[1] = (int32_t)to;
  member.stiffness = kind == STRUT_BAR ? BAR_STIFFNESS : CABLE_STIFFNESS;
  member.mass = kind == STRUT_BAR ? BAR_MASS : 0;
  member.rest_value = kind == STRUT_BAR ? 1 : CABLE_RATIO;
  member.damping = DAMPING;
  return member;
}

static size_t frames_of(size_t members) { return members < PER_FRAME ? 1 : members / PER_FRAME; }

strut_status bench_chain_scene(strut_setup *setup, size_t members, strut_mass_model mass) {
  size_t frames = frames_of(members);
  strut_status status = allocate(setup, 2 * (frames + 1), PER_FRAME * frames);
  if (status != STRUT_OK) return status;
  for (size_t i = 0; i <= frames; i++) {
    place(&setup->scene.nodes[2 * i], SIDE * (double)i, 0);
    place(&setup->scene.nodes[2 * i + 1], SIDE * (double)i, SIDE);
  }
  for (int i = 0; i < 2; i++)
    setup->scene.nodes[i].fixed[0] = setup->scene.nodes[i].fixed[1] = true;
  strut_member *next = setup->scene.members;
  for (size_t low = 0; low < 2 * frames; low += 2) {
    *next++ = link(STRUT_BAR, low, low + 3);
    *next++ = link(STRUT_BAR, low + 1, low + 2);
    *next++ = link(STRUT_CABLE, low, low + 2);
    *next++ = link(STRUT_CABLE, low + 1, low + 3);
    *next++ = link(STRUT_CABLE, low + 2, low + 3);
  }
  setup->scene.mass_model = mass;
  setup->experiment.step = 1e-4, setup->experiment.duration = 1e-3;
  return STRUT_OK;
}

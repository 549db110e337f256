/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/physics/smooth_scenes.h"

#include "tests/support/structures.h"

/* A mass on a spring, w = 10 rad/s. */
static void oscillator(strut_scene *scene) {
  strut_scene_init(scene);
  build_support(scene, 0, 0);
  build_mass(scene, 1, 0, 2);
  build_member(scene, STRUT_SPRING, 0, 1, 200, 0, 0);
  scene->nodes[1].velocity[0] = 1.5;
}

/* Free, damped, driven in a bar and a cable, pushed by a constant and an alternating load. */
static void frame(strut_scene *scene, strut_mass_model mass_model) {
  x_frame it = {1, 60, .cable = {400, 0.5, 0.05}, .bar = {2000, 0.3, 0.4}};
  strut_scene_init(scene);
  scene->mass_model = mass_model;
  structure_x_frame(scene, &it);
  structure_throw(scene, 0.3, 0.2, 2);
  build_actuator(scene, 4, build_sine(scene, 0.01, 3));
  build_actuator(scene, 0, build_sine(scene, 0.005, 5));
  build_load(scene, 1, 0.5, -0.2, build_sine(scene, 2, 2));
  build_load(scene, 2, -0.3, 0.1, -1);
  scene->gravity[0] = 1, scene->gravity[1] = -9.81;
}

static void consistent_frame(strut_scene *scene) { frame(scene, STRUT_MASS_CONSISTENT); }
static void lumped_frame(strut_scene *scene) { frame(scene, STRUT_MASS_LUMPED); }

static void pendulum(strut_scene *scene) {
  strut_scene_init(scene);
  structure_pendulum(scene, 2e4, 2, false, 0);
}

static void double_pendulum(strut_scene *scene) {
  strut_scene_init(scene);
  structure_pendulum(scene, 5e3, 1.5, true, 0.5);
}

static void held_chain(strut_scene *scene) {
  strut_scene_init(scene);
  structure_chain(scene, 6, STRUT_MASS_CONSISTENT);
  for (size_t j = 0; j < scene->member_count; j++) scene->members[j].kind = STRUT_SPRING;
  scene->gravity[1] = -9.81;
}

const smooth_scene smooth_scenes[SMOOTH_SCENES] = {
    {"oscillator", oscillator, 0.01, 2},
    {"driven X-frame", consistent_frame, 1e-3, 0.8},
    {"driven X-frame, lumped", lumped_frame, 1e-3, 0.8},
    {"rod pendulum", pendulum, 8e-4, 0.8},
    {"double rod", double_pendulum, 5e-4, 1.6},
    {"chain of X-frames", held_chain, 1e-4, 0.02}};

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/support/structures.h"

#include <math.h>

#include "tests/support/build.h"

static int32_t with_density(strut_scene *scene, int32_t member, double density) {
  scene->members[member].rest_kind = STRUT_REST_FORCE_DENSITY;
  scene->members[member].rest_value = density;
  return member;
}

void structure_x_frame(strut_scene *scene, const x_frame *f) {
  double h = 0.5 * f->side, corner[4][2] = {{-h, -h}, {h, -h}, {h, h}, {-h, h}};
  for (int i = 0; i < 4; i++) build_node(scene, corner[i][0], corner[i][1]);
  for (int i = 0; i < 4; i++)
    with_density(scene,
                 build_member(scene, STRUT_CABLE, i, (i + 1) % 4, f->cable.stiffness,
                              f->cable.damping, f->cable.mass),
                 f->force_density);
  for (int i = 0; i < 2; i++)
    with_density(
        scene,
        build_member(scene, STRUT_BAR, i, i + 2, f->bar.stiffness, f->bar.damping, f->bar.mass),
        -f->force_density);
}

void structure_throw(strut_scene *scene, double x, double y, double spin) {
  for (size_t i = 0; i < scene->node_count; i++) {
    strut_node *node = &scene->nodes[i];
    node->velocity[0] = x - spin * node->start[1];
    node->velocity[1] = y + spin * node->start[0];
  }
}

void structure_crawler(strut_scene *scene, double frequency, double amplitude, double mu,
                       bool state_two) {
  static const double drawn[5][2] = {{0, 0},
                                     {0.0965109, 0.0238714},
                                     {0.0526668, 0.0283691},
                                     {0.0602933, 0},
                                     {0.0434758, 0.0106875}};
  static const struct {
    int i1, i2;
    double rest, stiffness, mass;
  } table1[9] = {{1, 2, 0.10, 1e6, 0.1}, {3, 5, 0.02, 1e6, 0.02}, {4, 5, 0.02, 1e6, 0.02},
                 {1, 3, 0.02, 3000, 0},  {2, 3, 0.02, 3000, 0},   {2, 4, 0.02, 3000, 0},
                 {1, 4, 0.02, 3000, 0},  {1, 5, 0.01, 1e4, 0},    {2, 5, 0.01, 1e4, 0}};
  for (int i = 0; i < 5; i++) {
    const double *at = drawn[state_two && i < 2 ? 1 - i : i];
    build_node(scene, state_two ? -at[0] : at[0], at[1]);
  }
  for (int j = 0; j < 9; j++)
    build_sized(scene, table1[j].mass > 0 ? STRUT_BAR : STRUT_SPRING, table1[j].i1 - 1,
                table1[j].i2 - 1, table1[j].stiffness, 0.2, table1[j].mass, table1[j].rest);
  for (int i = 0; i < 5; i++) build_rough_contact(scene, i, 1e5, 100, mu, mu, 1e-4);
  build_actuator(scene, 7, build_sine(scene, amplitude, frequency));
  scene->gravity[1] = -9.81;
}

void structure_chain(strut_scene *scene, size_t frames, strut_mass_model mass_model) {
  const double side = 0.1;
  scene->mass_model = mass_model;
  for (size_t i = 0; i <= frames; i++)
    for (int top = 0; top < 2; top++) build_node(scene, side * (double)i, top ? side : 0);
  for (int i = 0; i < 2; i++) scene->nodes[i].fixed[0] = scene->nodes[i].fixed[1] = true;
  for (int32_t low = 0; low < 2 * (int32_t)frames; low += 2) {
    build_member(scene, STRUT_BAR, low, low + 3, 1e5, 0.2, 0.1);
    build_member(scene, STRUT_BAR, low + 1, low + 2, 1e5, 0.2, 0.1);
    build_sized(scene, STRUT_CABLE, low, low + 2, 3000, 0.2, 0, 0.98 * side);
    build_sized(scene, STRUT_CABLE, low + 1, low + 3, 3000, 0.2, 0, 0.98 * side);
    build_sized(scene, STRUT_CABLE, low + 2, low + 3, 3000, 0.2, 0, 0.98 * side);
  }
}

static void add_frames(strut_scene *scene, int32_t columns, int32_t rows, double damping) {
  for (int32_t x = 0; x < columns; x++)
    for (int32_t i = x * rows; i < (x + 1) * rows; i++) {
      bool right = x + 1 < columns, up = i + 1 < (x + 1) * rows;
      if (right) build_sized(scene, STRUT_CABLE, i, i + rows, 3000, damping, 0, 0.098);
      if (up) build_sized(scene, STRUT_CABLE, i, i + 1, 3000, damping, 0, 0.098);
      if (right && up) build_member(scene, STRUT_BAR, i, i + rows + 1, 1e5, damping, 0.1);
      if (right && up) build_member(scene, STRUT_BAR, i + 1, i + rows, 1e5, damping, 0.1);
    }
}

void structure_grid(strut_scene *scene, int32_t columns, int32_t rows, strut_mass_model mass_model,
                    double y, double damping, double mu) {
  const double side = 0.1;
  scene->mass_model = mass_model;
  scene->gravity[1] = -9.81;
  for (int32_t c = 0; c < columns; c++)
    for (int32_t r = 0; r < rows; r++) build_node(scene, side * c, y + side * r);
  add_frames(scene, columns, rows, damping);
  for (int32_t i = 0; i < columns * rows; i++)
    if (mu > 0)
      build_rough_contact(scene, i, 1e4, 2, mu, mu, 1e-3);
    else
      build_contact(scene, i, 1e4, 2);
}

void structure_pendulum(strut_scene *scene, double stiffness, double a, bool second, double b) {
  build_support(scene, 0, 0);
  build_node(scene, sin(a), -cos(a));
  build_member(scene, STRUT_BAR, 0, 1, stiffness, 0, 1);
  scene->gravity[1] = -9.81;
  if (!second) return;
  build_node(scene, sin(a) + sin(b), -cos(a) - cos(b));
  build_member(scene, STRUT_BAR, 1, 2, stiffness, 0, 1);
}

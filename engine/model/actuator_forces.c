/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/actuator_forces.h"

#include "engine/model/element_compile.h"

static int32_t nodes_of(const strut_scene *scene, const strut_actuator *a) {
  return a->member >= 0 ? (int32_t)scene->members[a->member].guide_count + 2 : 3;
}

static int32_t node_of(const strut_scene *scene, const strut_actuator *a, int32_t k) {
  return a->member >= 0 ? strut_member_node(&scene->members[a->member], (size_t)k)
                        : scene->hinges[a->hinge].node[k];
}

bool strut_actuator_forces_compile(strut_model *model) {
  const strut_scene *scene = model->scene;
  size_t count = 0, nodes = 0;
  for (size_t i = 0; i < scene->actuator_count; i++) {
    if (!scene->actuators[i].force) continue;
    count++;
    nodes += (size_t)nodes_of(scene, &scene->actuators[i]);
  }
  if (!count) return true;
  strut_actuator_force *item = strut_arena_allocate(&model->arena, count, sizeof *item);
  uint32_t *at = strut_arena_allocate(&model->arena, nodes, sizeof *at);
  if (!item || !at) return false;
  int32_t filled = 0, first = 0;
  for (size_t i = 0; i < scene->actuator_count; i++) {
    const strut_actuator *a = &scene->actuators[i];
    if (!a->force) continue;
    int32_t n = nodes_of(scene, a);
    bool member = a->member >= 0;
    item[filled++] = (strut_actuator_force){.strain = !member ? STRUT_STRAIN_ANGLE
                                                      : n > 2 ? STRUT_STRAIN_PATH
                                                              : STRUT_STRAIN_LENGTH,
                                            .member = member ? a->member : -1,
                                            .hinge = member ? -1 : a->hinge,
                                            .signal = a->signal,
                                            .first = first,
                                            .nodes = n};
    for (int32_t k = 0; k < n; k++) at[first + k] = 2 * (uint32_t)node_of(scene, a, k);
    first += n;
  }
  model->actuator_forces = (strut_actuator_force_table){(int32_t)count, item, at};
  model->plan |= STRUT_TERM_ACTUATOR_FORCES;
  return true;
}

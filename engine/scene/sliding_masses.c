/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Masses that slide along members: where they are. See scene.h. */
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/scene/scene.h"

double strut_sliding_mass_scale(const strut_scene *scene, size_t index) {
  const strut_sliding_mass *s = &scene->sliding_masses[index];
  const int32_t *node = scene->members[s->member].node;
  if (!s->travel) return 1.0;
  double drawn = strut_distance(scene->nodes[node[0]].position, scene->nodes[node[1]].position);
  return drawn > 0.0 ? 1.0 / drawn : 0.0;
}

double strut_sliding_mass_share(const strut_scene *scene, size_t index, double t) {
  const strut_sliding_mass *s = &scene->sliding_masses[index];
  double value, rate;
  if (s->signal < 0) return s->share;
  strut_signal_evaluate(scene->signals, s->signal, t, &value, &rate);
  return s->share + strut_sliding_mass_scale(scene, index) * value;
}

double strut_sliding_mass_rate(const strut_scene *scene, size_t index, double t) {
  const strut_sliding_mass *s = &scene->sliding_masses[index];
  double value, rate;
  if (s->signal < 0) return 0.0;
  strut_signal_evaluate(scene->signals, s->signal, t, &value, &rate);
  return strut_sliding_mass_scale(scene, index) * rate;
}

bool strut_scene_hold_sliding_masses(strut_scene *scene, strut_arena *arena) {
  size_t count = scene->sliding_count;
  strut_sliding_mass *held = strut_arena_allocate(arena, count, sizeof *held);
  if (!held) return false;
  for (size_t i = 0; i < count; i++) {
    held[i] = scene->sliding_masses[i];
    held[i].share = strut_sliding_mass_share(scene, i, 0.0);
    held[i].signal = -1;
  }
  scene->sliding_masses = held;
  return true;
}

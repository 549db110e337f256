/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/support_motion.h"

#include "engine/model/compile_parts.h"
#include "engine/scene/signal.h"

/* Which moved coordinate stands at a place; NONE: none. */
enum { NONE = -1 };

static void add_coupling(strut_model *model, strut_support_coupling *list, int32_t item,
                         uint32_t other, double mass) {
  strut_support_motion_table *table = &model->support_motion;
  if (item == NONE || model->fixed[other]) return;
  list[table->coupling_count++] = (strut_support_coupling){item, (int32_t)other, mass};
  table->corners =
      table->corners || strut_signal_has_corners(model->scene->signals, table->item[item].signal);
}

static bool add_couplings(strut_model *model) {
  const strut_member_table *members = &model->members;
  strut_support_motion_table *table = &model->support_motion;
  size_t most = 4 * (size_t)members->count, length = (size_t)model->length;
  strut_support_coupling *list = strut_arena_allocate(&model->arena, most, sizeof *list);
  int32_t *item_at = strut_allocate(length, sizeof *item_at);
  if (!list || !item_at) {
    strut_release(item_at);
    return false;
  }
  for (size_t i = 0; i < length; i++) item_at[i] = NONE;
  for (int32_t i = 0; i < table->count; i++) item_at[table->item[i].at] = i;
  for (int32_t j = 0; j < members->count; j++)
    for (uint32_t c = 0; c < 2 && members->mass[j] > 0.0; c++) {
      uint32_t a = members->from[j] + c, b = members->to[j] + c;
      add_coupling(model, list, item_at[a], b, members->mass[j] / 6.0);
      add_coupling(model, list, item_at[b], a, members->mass[j] / 6.0);
    }
  table->coupling = list;
  strut_release(item_at);
  return true;
}

bool strut_support_motion_compile(strut_model *model) {
  const strut_scene *scene = model->scene;
  size_t count = scene->support_motion_count;
  if (!count) return true;
  strut_moved_coordinate *item = strut_arena_allocate(&model->arena, count, sizeof *item);
  if (!item) return false;
  for (size_t i = 0; i < count; i++) {
    const strut_support_motion *motion = &scene->support_motions[i];
    double value, rate;
    item[i] = (strut_moved_coordinate){.at = 2 * motion->node + motion->axis,
                                       .signal = motion->signal,
                                       .base = scene->nodes[motion->node].start[motion->axis]};
    strut_signal_evaluate(scene->signals, motion->signal, 0.0, &value, &rate);
    ((double *)model->start)[item[i].at] = item[i].base + value;
    ((double *)model->velocity)[item[i].at] = rate;
  }
  model->support_motion = (strut_support_motion_table){.count = (int32_t)count, .item = item};
  model->terms |= STRUT_TERM_SUPPORT_MOTION;
  return scene->mass_model != STRUT_MASS_CONSISTENT || add_couplings(model);
}

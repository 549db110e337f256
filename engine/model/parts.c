/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/parts.h"

static int32_t root(int32_t *parent, int32_t a) {
  while (parent[a] != a) a = parent[a] = parent[parent[a]];
  return a;
}

static void connect_nodes(const strut_model *model, int32_t *parent) {
  for (int32_t i = 0; i < model->node_count; i++) parent[i] = i;
  for (int32_t j = 0; j < model->members.count; j++) {
    int32_t a = (int32_t)model->members.from[j] / 2, b = (int32_t)model->members.to[j] / 2;
    parent[root(parent, a)] = root(parent, b);
  }
  for (int32_t j = 0; j < model->elements.count; j++) {
    const uint32_t *at = model->elements.at + model->elements.element[j].first;
    for (int32_t k = 1; k < model->elements.element[j].nodes; k++)
      parent[root(parent, (int32_t)at[0] / 2)] = root(parent, (int32_t)at[k] / 2);
  }
}

void strut_connected_parts_find(const strut_model *model, const double *force, int32_t *part_of,
                                strut_connected_part *part) {
  connect_nodes(model, part_of);
  for (int32_t i = 0; i < model->node_count; i++) {
    strut_connected_part *connected_part = &part[part_of[i] = root(part_of, i)];
    for (int c = 0; c < 2; c++) {
      connected_part->held[c] = connected_part->held[c] || model->fixed[2 * i + c];
      if (!model->fixed[2 * i + c]) connected_part->force[c] += force[2 * i + c];
    }
  }
  for (int32_t i = 0; i < model->contacts.count; i++)
    part[part_of[model->contacts.entry[i].node]].touches = true;
}

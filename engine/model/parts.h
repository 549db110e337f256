/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The parts of a structure, nodes that members and elements connect, and what acts on each as a whole. */
#ifndef STRUT_ENGINE_MODEL_PARTS_H
#define STRUT_ENGINE_MODEL_PARTS_H

#include "engine/model/model.h"

typedef struct strut_connected_part {
  double force[2]; /* sum of those on free coordinates [N] */
  bool held[2];    /* some node of it, along x, along y */
  bool touches;    /* some node of it is one that contacts have */
} strut_connected_part;

/**
 * part_of (node_count) becomes the number of a node's part, the first that was found of its nodes; part
 * (node_count), zeros before, is filled there. force: (length) [N].
 */
void strut_connected_parts_find(const strut_model *model, const double *force, int32_t *part_of,
                                strut_connected_part *part);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What can never come to rest, found before it is tried: it slides along the ground whatever friction does. */
#include <math.h>
#include <stdio.h>

#include "engine/model/model.h"
#include "engine/run/settle.h"

/* Pulls beyond what friction holds, over the push, that are rounding. */
static const double ROUNDING = 1e-12;

/* Forces on a part of the structure, and what the ground can hold of it. */
typedef struct held_part {
  double along, press; /* [N] */
  double grip;         /* largest static coefficient; 0: nothing sticks [1] */
} held_part;

static held_part find_grip(const strut_relaxation *relaxation, const int32_t *part_of, int32_t part,
                           const double force[2]) {
  const strut_contact_table *contacts = &relaxation->model->contacts;
  held_part found = {.along = force[0] * contacts->tangent[0] + force[1] * contacts->tangent[1],
                     .press = -force[0] * contacts->normal[0] - force[1] * contacts->normal[1]};
  for (int32_t i = 0; i < contacts->count; i++) {
    const strut_friction *friction = &contacts->entry[i].friction;
    if (part_of[contacts->entry[i].node] == part && friction->law != STRUT_FRICTION_NONE)
      found.grip = fmax(found.grip, strut_friction_static(friction, found.along));
  }
  return found;
}

static strut_status fail_sliding(const strut_relaxation *relaxation, const held_part *part,
                                 const char *node, strut_error *error) {
  char grip[100];
  if (!relaxation->experiment->settle.friction)
    snprintf(grip, sizeof grip, "friction acts with initial.settle.friction: kept");
  else if (part->grip > 0.0)
    snprintf(grip, sizeof grip, "it is %.4g at most", part->grip);
  else
    snprintf(grip, sizeof grip, "of the laws of friction coulomb and karnopp hold what is at rest");
  return strut_fail(error, STRUT_NOT_SETTLED,
                    "the structure cannot come to rest: nothing but friction holds node '%.60s' "
                    "along the ground, and that takes a static coefficient of at least %.4g; %s",
                    node, fabs(part->along) / part->press, grip);
}

strut_status strut_relaxation_check(strut_relaxation *relaxation, strut_error *error) {
  const strut_model *model = relaxation->model;
  const strut_contact_table *contacts = &model->contacts;
  size_t nodes = (size_t)model->node_count;
  if (!model->constant_force || !contacts->count || (contacts->surface && !contacts->parallel))
    return STRUT_OK;
  int32_t *part_of = strut_arena_allocate(&relaxation->arena, nodes, sizeof *part_of);
  strut_connected_part *part = strut_arena_allocate(&relaxation->arena, nodes, sizeof *part);
  if (!part_of || !part) return strut_no_memory(error, "");
  strut_connected_parts_find(model, model->constant_force, part_of, part);
  for (int32_t i = 0; i < model->node_count; i++) {
    if (part_of[i] != i || !part[i].touches || part[i].held[0] || part[i].held[1]) continue;
    held_part own = find_grip(relaxation, part_of, i, part[i].force);
    if (own.press > 0.0 && fabs(own.along) > (own.grip + ROUNDING) * own.press)
      return fail_sliding(relaxation, &own, relaxation->scene.nodes[i].name, error);
  }
  return STRUT_OK;
}

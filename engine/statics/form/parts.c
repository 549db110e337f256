/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the ways of form finding share. See parts.h. */
#include "engine/statics/form/parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/model/pose.h"

static const double TOUCH = 1e-6; /* of the size: nearer to the ground is drawn on it */

double strut_form_depth(const strut_former *f, int32_t contact) {
  const strut_contact_table *c = &f->model->contacts;
  const double *at = f->scene->nodes[c->entry[contact].node].position;
  return -strut_ground_gap(c, at);
}

bool strut_form_touches(const strut_former *f, int32_t contact) {
  return strut_form_depth(f, contact) >= -TOUCH * f->size;
}

strut_status strut_form_out_of_range(strut_error *error) {
  return strut_fail(error, STRUT_DIVERGED,
                    "energies and forces leave the range of numbers; check the units of sizes, "
                    "stiffnesses and loads");
}

strut_status strut_form_set_force(strut_former *f, size_t j, double force, strut_error *error) {
  strut_member *m = &f->scene->members[j];
  const double *a = f->scene->nodes[m->node[0]].start;
  const double *b = f->scene->nodes[m->node[1]].start;
  double length = strut_distance(a, b);
  double rest = m->axial_stiffness > 0 ? m->axial_stiffness * length / (m->axial_stiffness + force)
                : m->stiffness > 0     ? length - force / m->stiffness
                                       : length;
  if (!isfinite(force) || !isfinite(length)) return strut_form_out_of_range(error);
  bool carries = m->axial_stiffness > 0 || m->stiffness > 0 || force == 0;
  if (!carries || !isfinite(rest) || rest < 0)
    return strut_fail(error, STRUT_NOT_SETTLED,
                      "member %s would have to carry %.4g N at a length of %.4g m, which its "
                      "stiffness does not allow; make it stiffer",
                      m->name, force, length);
  m->rest_kind = STRUT_REST_LENGTH;
  m->rest_value = rest;
  f->form->largest_force = fmax(f->form->largest_force, fabs(force));
  return STRUT_OK;
}

void strut_form_name_nodes(const strut_former *f, const uint8_t *marked, char *text, size_t size) {
  size_t used = 0, left = 0, room = size - 20;
  *text = '\0';
  for (size_t i = 0; i < f->scene->node_count; i++) {
    if (!marked[i]) continue;
    size_t need = strlen(f->scene->nodes[i].name) + 2;
    if (left || used + need >= room) {
      left++;
      continue;
    }
    used += (size_t)snprintf(text + used, size - used, "%s%s", used ? ", " : "",
                             f->scene->nodes[i].name);
  }
  if (left) snprintf(text + used, size - used, " and %zu more", left);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Damping that a scene gives as a ratio or by Rayleigh's two numbers; see element_compile.h. */
#include <math.h>

#include "engine/base/vec.h"
#include "engine/model/element_compile.h"

/* Inverse of a node's lumped mass along d, in which supported directions are infinitely heavy. */
static double lightness(const strut_model *model, int32_t node, strut_vec2 d) {
  const uint8_t *fixed = model->fixed + 2 * node;
  double along = (fixed[0] ? 0.0 : d.x * d.x) + (fixed[1] ? 0.0 : d.y * d.y);
  return along > 0.0 ? along / model->weight[node] : 0.0;
}

static strut_vec2 direction(const strut_scene *scene, int32_t a, int32_t b) {
  strut_vec2 span = strut_vec2_between(scene->nodes[a].position, scene->nodes[b].position);
  return strut_vec2_unit(span, strut_vec2_length(span));
}

/* Mass against which a member as drawn changes its length: 1 / sum |de/dq|^2 / m over its nodes. */
static double mass_of_length(const strut_model *model, size_t j) {
  const strut_scene *scene = model->scene;
  const strut_member *m = &scene->members[j];
  double sum = 0.0;
  for (size_t k = 0; k < m->guide_count + 2; k++) {
    int32_t node = strut_member_node(m, k);
    strut_vec2 d = {0.0, 0.0};
    if (k > 0) d = direction(scene, strut_member_node(m, k - 1), node);
    if (k <= m->guide_count) {
      strut_vec2 next = direction(scene, node, strut_member_node(m, k + 1));
      d.x -= next.x, d.y -= next.y;
    }
    sum += lightness(model, node, d);
  }
  return sum > 0.0 ? 1.0 / sum : 0.0;
}

static void damp_member(strut_model *model, size_t j, double more) {
  strut_member_table *t = &model->members;
  if (!(more > 0.0)) return;
  if (strut_member_is_element(&model->elements, (int32_t)j)) {
    ((strut_element *)strut_element_of_member(&model->elements, (int32_t)j))->damping += more;
    return;
  }
  ((double *)t->damping)[j] += more;
  uint16_t *terms = (uint16_t *)t->block_terms;
  terms[j / STRUT_BLOCK] = (uint16_t)(terms[j / STRUT_BLOCK] | STRUT_TERM_DAMPING);
  model->plan |= STRUT_TERM_DAMPING;
}

static double stiffness_of(const strut_model *model, size_t j) {
  const strut_element *e = strut_element_of_member(&model->elements, (int32_t)j);
  bool element = e && e->role == STRUT_ELEMENT_MEMBER;
  return fmax(0.0, element ? e->numbers.stiffness : model->members.stiffness[j]);
}

void strut_damping_compile(strut_model *model) {
  const strut_scene *scene = model->scene;
  double share = scene->rayleigh_stiffness;
  for (size_t j = 0; j < scene->member_count; j++) {
    double ratio = scene->members[j].damping_ratio, c = stiffness_of(model, j);
    if (ratio > 0.0) damp_member(model, j, 2.0 * ratio * sqrt(c * mass_of_length(model, j)));
    damp_member(model, j, share * c);
  }
  for (int32_t i = 0; i < model->elements.count && share > 0.0; i++) {
    strut_element *e = (strut_element *)&model->elements.element[i];
    if (e->role == STRUT_ELEMENT_HINGE) e->damping += share * fmax(0.0, e->numbers.stiffness);
  }
  model->mass_damping = scene->rayleigh_mass;
  if (model->mass_damping > 0.0) model->plan |= STRUT_TERM_MASS_DAMPING;
}

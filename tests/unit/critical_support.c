/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/unit/critical_support.h"

#include <math.h>

#include "tests/support/build.h"
#include "tests/support/check.h"

void critical_find(fixture *f, const uint8_t *held, bool ground, bool saddles) {
  strut_critical_effort effort = {.seed = 1, .saddles = saddles};
  assert_int_equal(strut_model_compile(&f->scene, &f->model, NULL), STRUT_OK);
  assert_int_equal(strut_potential_create(f->model, held, ground, &f->potential, NULL), STRUT_OK);
  assert_int_equal(strut_critical_search(f->potential, &effort, &f->set, NULL), STRUT_OK);
  for (size_t i = 0; i < f->set.count; i++) { /* what every point must be */
    const strut_critical_point *p = &f->set.points[i];
    assert_true(p->residual <= 16 * strut_potential_rounding(f->potential, p->q));
    assert_true(p->found > 0 || p->label == STRUT_STABLE || p->label == STRUT_FLOPPY);
    if (i > 0 && p[-1].label == p->label) assert_true(p[-1].potential <= p->potential);
    for (int k = 0; k < 2; k++)
      if (p->down[k] >= 0) assert_true(f->set.points[p->down[k]].potential < p->potential);
  }
}

void critical_tear_down(fixture *f) {
  strut_critical_free(&f->set);
  strut_potential_free(f->potential);
  strut_model_free(f->model);
  strut_scene_free(&f->scene);
}

size_t count_of(const fixture *f, strut_stability label) {
  size_t count = 0;
  for (size_t i = 0; i < f->set.count; i++) count += f->set.points[i].label == label;
  return count;
}

const strut_critical_point *nearest(const fixture *f, strut_stability label, double value) {
  const strut_critical_point *best = NULL;
  for (size_t i = 0; i < f->set.count; i++) {
    const strut_critical_point *p = &f->set.points[i];
    if (p->label != label) continue;
    if (!best || fabs(p->potential - value) < fabs(best->potential - value)) best = p;
  }
  assert_non_null(best);
  return best;
}

void critical_build(strut_scene *scene, const node_row *node, int nodes, const member_row *member,
                    int members) {
  strut_scene_init(scene);
  for (int i = 0; i < nodes; i++) {
    build_node(scene, node[i].x, node[i].y);
    scene->nodes[i].fixed[0] = node[i].fixed & 1;
    scene->nodes[i].fixed[1] = node[i].fixed & 2;
  }
  for (int j = 0; j < members; j++)
    build_sized(scene, member[j].kind, member[j].a - 1, member[j].b - 1, member[j].stiffness, 0, 0,
                member[j].rest);
}
void assert_minima(const fixture *f, const double *energy, size_t count, double tolerance) {
  assert_int_equal(count_of(f, STRUT_STABLE), count);
  for (size_t i = 0; i < count; i++) {
    assert_int_equal(f->set.points[i].label, STRUT_STABLE);
    assert_near(f->set.points[i].potential, energy[i], tolerance);
  }
}

void assert_saddle(const fixture *f, double energy, double tolerance, int32_t negative) {
  const strut_critical_point *p = nearest(f, STRUT_SADDLE, energy);
  assert_near(p->potential, energy, tolerance);
  assert_int_equal(p->negative, negative);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All stationary points of structures whose answers are known: the gallery, the paper's crawler. */
#include "engine/statics/critical.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/build.h"
#include "tests/support/check.h"
#include "tests/support/structures.h"

typedef struct fixture {
  strut_scene scene;
  strut_model *model;
  strut_potential *potential;
  strut_critical_set set;
} fixture;

static void search(fixture *f, const uint8_t *held, bool ground, bool saddles) {
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

static void tear_down(fixture *f) {
  strut_critical_free(&f->set);
  strut_potential_free(f->potential);
  strut_model_free(f->model);
  strut_scene_free(&f->scene);
}

static size_t count_of(const fixture *f, strut_stability label) {
  size_t count = 0;
  for (size_t i = 0; i < f->set.count; i++) count += f->set.points[i].label == label;
  return count;
}

/* The point of that label whose potential is nearest. */
static const strut_critical_point *nearest(const fixture *f, strut_stability label, double value) {
  const strut_critical_point *best = NULL;
  for (size_t i = 0; i < f->set.count; i++) {
    const strut_critical_point *p = &f->set.points[i];
    if (p->label != label) continue;
    if (!best || fabs(p->potential - value) < fabs(best->potential - value)) best = p;
  }
  assert_non_null(best);
  return best;
}

static void the_crawler_on_nodes_1_and_4(void **state) {
  static const double saddles[] = {22.6833957641, 22.6844442893, 22.6896852375, 22.7089940895,
                                   22.7184950429, 22.7235766608, 37.4984114922};
  static const double minima[] = {22.2125952092, 22.2460123011, 22.6641332092,
                                  22.6690358567, 22.706131,     22.712029};
  uint8_t held[64] = {0};
  fixture f = {0};
  (void)state;
  held[0] = held[1] = held[7] = 1;
  strut_scene_init(&f.scene);
  structure_crawler(&f.scene, 10, 1e-4, 0.1, false);
  search(&f, held, false, true);
  assert_int_equal(count_of(&f, STRUT_STABLE), 6);
  assert_int_equal(count_of(&f, STRUT_FLOPPY), 0);
  for (size_t i = 0; i < 6; i++) assert_near(f.set.points[i].potential, minima[i], 1e-6);
  const strut_critical_point *two = nearest(&f, STRUT_STABLE, 22.712029);
  assert_near(fabs(two->q[2]), 93.5388e-3, 1e-7);
  assert_near(two->q[3], 33.6848e-3, 1e-7);
  assert_near(fabs(two->q[6]), 43.9094e-3, 1e-7);
  for (size_t i = 0; i < sizeof saddles / sizeof saddles[0]; i++) {
    const strut_critical_point *p = nearest(&f, STRUT_SADDLE, saddles[i]);
    assert_near(p->potential, saddles[i], 1e-9);
    assert_int_equal(p->negative, 1);
    assert_true(p->down[0] >= 0 && p->down[1] >= 0);
  }
  assert_true(f.set.missed == 0);
  tear_down(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_crawler_on_nodes_1_and_4),
  };
  return cmocka_run_group_tests_name("critical", tests, NULL, NULL);
}

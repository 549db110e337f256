/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Equilibria that the points of a study share: only structures that stand alike may. */
#include "engine/study/sweep/sweep_parts.h"

#include "tests/support/build.h"
#include "tests/support/check.h"

enum { NODES = 3 };

/* A weight on two springs that also presses a soft ground; its configuration is its only shape. */
static strut_setup hanging(void) {
  strut_setup setup = build_falling();
  build_support(&setup.scene, -1, 0);
  build_support(&setup.scene, 1, 0.1);
  build_mass(&setup.scene, 0.1, -0.6, 2);
  for (int32_t i = 0; i < 2; i++) build_sized(&setup.scene, STRUT_SPRING, i, 2, 60, 1, 0.1, 0.9);
  build_contact(&setup.scene, 2, 40, 3);
  build_load(&setup.scene, 2, 1.5, -0.5, -1);
  setup.scene.ground.height = -0.45;
  setup.experiment.search.starts = 20;
  setup.scene.configurations =
      strut_arena_allocate(&setup.scene.arena, 1, sizeof *setup.scene.configurations);
  assert_non_null(setup.scene.configurations);
  double(*shape)[2] = strut_arena_allocate(&setup.scene.arena, NODES, sizeof *shape);
  assert_non_null(shape);
  for (int i = 0; i < NODES; i++) memcpy(shape[i], setup.scene.nodes[i].position, sizeof *shape);
  setup.scene.configurations[0] =
      (strut_configuration){.name = "rest", .shaped = true, .position = shape};
  setup.scene.configuration_count = 1;
  setup.scene.start_equilibrium = 0;
  return setup;
}

/* Where the scene stands, by equilibria that may be known already. */
static void resolve(strut_equilibrium_cache *standing, strut_setup *setup, double at[2]) {
  strut_error error = {0};
  strut_status status = strut_equilibrium_cache_resolve(standing, setup, &error);
  if (status) fail_msg("%s", error.message);
  assert_int_equal(setup->scene.start_equilibrium, -1);
  memcpy(at, setup->scene.nodes[2].start, 2 * sizeof *at);
}

/* Each number of a scene that matters, changed a little; false: there are no more. */
static bool change(strut_setup *s, int which) {
  double *const numbers[] = {&s->scene.nodes[0].position[1], &s->scene.nodes[2].mass,
                             &s->scene.members[0].stiffness, &s->scene.members[1].rest_value,
                             &s->scene.members[1].mass,      &s->scene.contacts[0].stiffness,
                             &s->scene.loads[0].force[0],    &s->scene.loads[0].force[1],
                             &s->scene.gravity[0],           &s->scene.gravity[1],
                             &s->scene.ground.height,        &s->scene.ground.slope};
  if (which >= (int)(sizeof numbers / sizeof numbers[0])) return false;
  double *x = numbers[which];
  *x = *x != 0.0 ? *x * 1.01 : 0.02;
  if (which == 0) s->scene.nodes[0].start[1] = *x;
  return true;
}

TEST(each_structure_has_equilibria_of_its_own) {
  strut_equilibrium_cache *shared = strut_equilibrium_cache_create();
  double first[2], again[2];
  assert_non_null(shared);
  for (int which = -1;; which++) {
    double found[2], alone[2];
    strut_setup setup = hanging();
    strut_setup copy = hanging();
    if (which >= 0 && !(change(&setup, which) && change(&copy, which))) {
      resolve(shared, &setup, again); /* the first one, unchanged */
      strut_setup_free(&setup);
      strut_setup_free(&copy);
      break;
    }
    strut_equilibrium_cache *own = strut_equilibrium_cache_create();
    assert_non_null(own);
    resolve(shared, &setup, found);
    resolve(own, &copy, alone);
    for (int c = 0; c < 2; c++) assert_same_bits(found[c], alone[c]);
    if (which < 0)
      memcpy(first, found, sizeof first);
    else if (!(hypot(found[0] - first[0], found[1] - first[1]) > 1e-5))
      fail_msg("change %d moves nothing", which);
    strut_equilibrium_cache_free(own);
    strut_setup_free(&setup);
    strut_setup_free(&copy);
  }
  for (int c = 0; c < 2; c++) assert_same_bits(again[c], first[c]);
  strut_equilibrium_cache_free(shared);
}

/* What stands alike is looked for once: friction and the run's step change nothing of where. */
TEST(points_that_stand_alike_share) {
  strut_equilibrium_cache *shared = strut_equilibrium_cache_create();
  double at[2], other[2];
  assert_non_null(shared);
  OWN(strut_setup) setup = hanging();
  OWN(strut_setup) rough = hanging();
  rough.scene.contacts[0].friction =
      (strut_friction){.law = STRUT_FRICTION_KARNOPP, .mu_static = 0.3, .mu_kinetic = 0.2};
  rough.experiment.step = 1e-5;
  resolve(shared, &setup, at);
  uint64_t before = strut_allocation_count();
  resolve(shared, &rough, other);
  assert_true(strut_allocation_count() - before < 20); /* no search */
  for (int c = 0; c < 2; c++) assert_same_bits(other[c], at[c]);
  strut_equilibrium_cache_free(shared);
}

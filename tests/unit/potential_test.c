/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The potential energy, its gradient and Hessian against differences and the engine's own sums. */
#include "engine/statics/potential.h"

#include "engine/forces/forces.h"
#include "engine/forces/tangent.h"
#include "tests/physics/random_scene.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"

FREED_BY(strut_potential_free, strut_potential)

enum { SCENES = 120 };

typedef struct fixture {
  strut_scene scene;
  strut_model *model;
  strut_potential *potential;
  double *q, *g, *up, *down;
} fixture;

/* Is every cable clear of slackness and every contact clear of the ground's line? */
static bool clear_of_kinks(const strut_model *model, const double *q, double margin) {
  const strut_member_table *t = &model->members;
  const strut_contact_table *c = &model->contacts;
  for (int32_t j = 0; j < t->count; j++) {
    const double *a = q + t->from[j], *b = q + t->to[j];
    double length = hypot(b[0] - a[0], b[1] - a[1]);
    if (length < 20 * margin) return false;
    if (t->slack[j] == 0 && fabs(length - t->rest[j]) < margin) return false;
  }
  for (int32_t i = 0; i < c->count; i++) {
    const double *at = q + c->at[i];
    double gap = at[0] * c->normal[0] + (at[1] - c->height) * c->normal[1];
    if (fabs(gap) < margin) return false;
  }
  return true;
}

static bool set_up(fixture *f, uint64_t seed) {
  uint64_t r = seed ^ 0x5bd1e995u;
  double t, *v;
  random_scene(&f->scene, seed);
  assert_ok(strut_model_compile(&f->scene, &f->model, NULL));
  size_t length = (size_t)f->model->length;
  uint8_t *held = strut_arena_allocate(&f->scene.arena, length, 1);
  f->q = strut_arena_allocate(&f->scene.arena, length, sizeof(double));
  f->g = strut_arena_allocate(&f->scene.arena, length, sizeof(double));
  f->up = strut_arena_allocate(&f->scene.arena, length, sizeof(double));
  f->down = strut_arena_allocate(&f->scene.arena, length, sizeof(double));
  v = strut_arena_allocate(&f->scene.arena, length, sizeof(double));
  for (size_t i = 0; i < length; i++) held[i] = (uint8_t)random_once_in(&r, 10);
  bool contacts = !random_once_in(&r, 4);
  const uint8_t *mask = random_once_in(&r, 2) ? held : NULL;
  assert_ok(strut_potential_create(f->model, mask, contacts, &f->potential, NULL));
  for (uint64_t again = 0; again < 20; again++) {
    random_motion(&f->scene, seed + 1000 * again, &t, f->q, v);
    if (clear_of_kinks(f->model, f->q, 3e-3)) return f->potential->n > 0;
  }
  return false;
}

static void tear_down(fixture *f) {
  strut_potential_free(f->potential);
  strut_model_free(f->model);
  strut_scene_free(&f->scene);
}

/* The engine's forces, energies and tangent stiffness know nothing of this room. */
TEST(it_agrees_with_the_engine) {
  for (uint64_t seed = 0; seed < SCENES; seed++) {
    fixture f = {0};
    if (!set_up(&f, seed)) {
      tear_down(&f);
      continue;
    }
    OWN(strut_arena) arena = {0};
    strut_tangent tangent;
    OWN_POINTER(strut_potential) all;
    assert_ok(strut_potential_create(f.model, NULL, true, &all, NULL));
    strut_sparse *k = strut_potential_matrix(all, &arena);
    strut_potential_hessian(all, f.q, k);
    assert_ok(strut_tangent_assemble(f.model, f.q, f.model->members.rest, STRUT_CLOSED_TOUCHING,
                                     &arena, &tangent));
    assert_int_equal(tangent.n, all->n);
    double *x = strut_arena_allocate(&arena, (size_t)all->n, sizeof *x);
    double *y = strut_arena_allocate(&arena, (size_t)all->n, sizeof *y);
    double *z = strut_arena_allocate(&arena, (size_t)all->n, sizeof *z);
    for (int32_t i = 0; i < all->n; i++) x[i] = sin(1.0 + 3.0 * i);
    strut_sparse_multiply(k, x, y);
    strut_sparse_multiply(tangent.stiffness, x, z);
    for (int32_t i = 0; i < all->n; i++) assert_near(y[i], z[i], 1e-9 * (1 + fabs(z[i])));

    f.scene.actuator_count = 0;
    OWN_POINTER(strut_model) quiet;
    OWN_POINTER(strut_state) still;
    assert_ok(strut_model_compile(&f.scene, &quiet, NULL));
    assert_ok(strut_state_create(quiet, &still, NULL));
    memcpy(still->q, f.q, (size_t)f.model->length * sizeof *f.q);
    memset(still->v, 0, (size_t)f.model->length * sizeof *f.q);
    strut_energies stored = strut_energy_evaluate(quiet, still, 0);
    double sum = stored.elastic + stored.gravity + stored.contact;
    double loads = strut_energy_load_potential(quiet, still);
    double scale = fabs(stored.elastic) + fabs(stored.gravity) + fabs(loads) + stored.contact;
    assert_near(strut_potential_value(all, f.q), sum - loads, 1e-13 * scale);
    assert_near(strut_potential_energy(all, f.q), stored.elastic + stored.gravity, 1e-13 * scale);
    strut_potential_gradient(all, f.q, f.g);
    strut_potential_force(all, f.q, f.up);
    for (int32_t i = 0; i < all->n; i++) assert_same_bits(0 - f.g[i], 0 + f.up[all->coordinate[i]]);
    tear_down(&f);
  }
}

/* A spring of no length and no rest length pulls alike everywhere; one with a rest length not. */
TEST(members_of_zero_length) {
  OWN(strut_scene) scene = build_scene();
  OWN_POINTER(strut_model) model;
  OWN_POINTER(strut_potential) p;
  OWN(strut_arena) arena = {0};
  build_support(&scene, 0, 0);
  build_node(&scene, 0, 0);
  build_node(&scene, 1, 0);
  build_sized(&scene, STRUT_SPRING, 0, 1, 7, 0, 0, 0);
  build_sized(&scene, STRUT_SPRING, 0, 2, 5, 0, 0, 1);
  build_sized(&scene, STRUT_CABLE, 0, 1, 3, 0, 0, 0);
  assert_ok(strut_model_compile(&scene, &model, NULL));
  assert_ok(strut_potential_create(model, NULL, true, &p, NULL));
  strut_sparse *k = strut_potential_matrix(p, &arena);
  double g[4];
  strut_potential_hessian(p, model->start, k);
  strut_potential_gradient(p, model->start, g);
  for (int i = 0; i < 4; i++) assert_near(g[i], 0, 0);
  assert_all_near(0, k->value[k->start[0]], 7, k->value[k->start[1]], 7, k->value[k->start[2]], 5);
  assert_near(k->value[k->start[3]], 0, 0);
  double q[12] = {0};
  strut_potential_hessian(p, q, k);
  assert_all_near(0, k->value[k->start[2]], 0, k->value[k->start[3]], 0);
}

/* A weight on a soft ground that slopes: the force is the load's plus the ground's push. */
TEST(a_slope_pushes_along_its_normal) {
  OWN(strut_scene) scene = build_scene();
  OWN_POINTER(strut_model) model;
  strut_potential *p;
  build_mass(&scene, 1, 0.4, 2);
  build_contact(&scene, 0, 1000, 5);
  build_load(&scene, 0, 3, 4, -1);
  scene.ground.slope = 0.5;
  scene.gravity[1] = -10;
  assert_ok(strut_model_compile(&scene, &model, NULL));
  assert_ok(strut_potential_create(model, NULL, true, &p, NULL));
  double depth = sin(0.5) - 0.4 * cos(0.5), force[8];
  assert_true(depth > 0);
  strut_potential_force(p, model->start, force);
  assert_near(force[0], 3 - 1000 * depth * sin(0.5), 1e-11);
  assert_near(force[1], 4 - 20 + 1000 * depth * cos(0.5), 1e-11);
  assert_near(p->force_scale, 25, 1e-14);
  strut_potential_free(p);
  assert_ok(strut_potential_create(model, NULL, false, &p, NULL));
  strut_potential_force(p, model->start, force);
  assert_all_near(0, force[0], 3, force[1], -16);
  strut_potential_free(p);
}

/* A refusal of memory at any place is passed on. */
TEST(refused_memory) {
  OWN(strut_scene) scene;
  OWN_POINTER(strut_model) model;
  random_scene(&scene, 3);
  assert_ok(strut_model_compile(&scene, &model, NULL));
  REFUSE_EACH(n, status, 1) {
    OWN_POINTER(strut_potential) p;
    status = refused(n, strut_potential_create(model, NULL, true, &p, NULL));
  }
}

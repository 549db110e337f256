/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The step's vector kernels against pose.h, on random poses: members_kernel.h and forces_kernel.h in
 * strut_forces_evaluate.
 */
#include "engine/model/pose.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"

enum { NODES = 7, MEMBERS = 13, POSES = 2000 };

/* Cables and bars between random nodes, one of them without a length, over an inclined ground. */
static void build(strut_scene *scene, uint64_t *r, double slope) {
  strut_scene_init(scene);
  for (int i = 0; i < NODES; i++) {
    double y = random_between(r, -1, 1), x = random_between(r, -1, 1);
    build_mass(scene, x, y, 1.0);
  }
  for (int j = 0; j < MEMBERS; j++) {
    int32_t a = (int32_t)(j % NODES), b = (int32_t)((a + 1 + j / NODES) % NODES);
    double rest = random_between(r, 0, 1.5), damping = j % 4 ? random_scale(r, 0.1, 100) : 0.0;
    strut_member_kind kind = j % 3 ? STRUT_CABLE : STRUT_BAR;
    build_sized(scene, kind, a, b, random_scale(r, 1, 1e6), damping, 0.0, rest);
  }
  for (int i = 0; i < NODES; i++) {
    double damping = random_scale(r, 1, 100), stiffness = random_scale(r, 1e2, 1e5);
    build_rough_contact(scene, i, stiffness, damping, 0.5, 0.4, 0.1);
  }
  scene->ground.slope = slope;
  scene->ground.height = random_between(r, -0.5, 0.5);
  scene->ground.belt_speed = random_between(r, -1, 1);
}

/* Forces by pose.h, in the order of the kernels. */
static void add_forces(const strut_model *model, const double *q, const double *v, double *force) {
  const strut_member_table *t = &model->members;
  const strut_contact_table *c = &model->contacts;
  memset(force, 0, (size_t)model->length * sizeof *force);
  for (int32_t j = 0; j < t->count; j++) {
    strut_member_pose pose = strut_member_pose_at(t, t->rest, j, q);
    double tension = t->stiffness[j] * pose.stretch;
    tension += t->damping[j] * strut_member_rate(t, j, &pose, v);
    if (!pose.taut || !(tension > t->slack[j])) tension = 0.0;
    double *a = force + t->from[j], *b = force + t->to[j];
    a[0] += tension * pose.unit.x, a[1] += tension * pose.unit.y;
    b[0] -= tension * pose.unit.x, b[1] -= tension * pose.unit.y;
  }
  for (int32_t i = 0; i < c->count; i++) {
    const strut_contact_entry *e = &c->entry[i];
    double gap = strut_contact_gap(c, i, q), into = strut_contact_along_normal(c, i, v);
    if (!(gap < 0.0)) continue;
    double normal = -e->stiffness * gap - (into < 0.0 ? e->damping * into : 0.0);
    double friction = strut_friction_force(&e->friction, normal, strut_contact_slip(c, i, v),
                                           strut_contact_along_ground(c, i, force));
    for (int k = 0; k < 2; k++)
      force[c->at[i] + (uint32_t)k] += friction * c->tangent[k] + normal * c->normal[k];
  }
}

static void compare_forces(double slope) {
  uint64_t r = 7;
  for (int round = 0; round < 20; round++) {
    OWN(strut_scene) scene;
    OWN_POINTER(strut_model) model = NULL;
    OWN_POINTER(strut_state) state = NULL;
    double force[2 * NODES + 2 * STRUT_LANES];
    build(&scene, &r, slope);
    assert_ok(strut_model_compile(&scene, &model, NULL));
    assert_ok(strut_state_create(model, &state, NULL));
    assert_true((size_t)model->length <= sizeof force / sizeof *force);
    for (int pose = 0; pose < POSES / 20; pose++) {
      strut_state_reset(model, state);
      for (int32_t i = 0; i < 2 * NODES; i++) {
        state->q[i] = random_between(&r, -1, 1);
        state->v[i] = random_between(&r, -1, 1);
      }
      if (pose % 5 == 0) memcpy(state->q + 2, state->q, 2 * sizeof(double)); /* no length */
      strut_forces_evaluate(model, state, 0.0, state->q, state->v);
      add_forces(model, state->q, state->v, force);
      double scale = strut_largest_magnitude(force, 2 * NODES);
      for (int32_t i = 0; i < 2 * NODES; i++)
        assert_near(state->latest->force[i], force[i], 1e-13 * scale);
    }
  }
}

TEST(the_kernels_on_level_ground) { compare_forces(0.0); }

TEST(the_kernels_on_a_slope) { compare_forces(0.3); }

/* The stiffness across a member is what turning it by a small angle takes. */
TEST(stiffness_along_and_across) {
  uint64_t r = 3;
  OWN(strut_scene) scene;
  OWN_POINTER(strut_model) model = NULL;
  build(&scene, &r, 0.0);
  assert_ok(strut_model_compile(&scene, &model, NULL));
  const strut_member_table *t = &model->members;
  for (int32_t j = 0; j < t->count; j++) {
    double q[2 * NODES + 2 * STRUT_LANES], step = 1e-6, push[2][2];
    memcpy(q, model->start, (size_t)model->length * sizeof *q);
    strut_member_pose pose = strut_member_pose_at(t, t->rest, j, q);
    if (!pose.taut) continue;
    const strut_vec2 aside = {-pose.unit.y, pose.unit.x};
    for (int side = 0; side < 2; side++) {
      double *b = q + t->to[j], sign = side ? step : -step;
      memcpy(q, model->start, (size_t)model->length * sizeof *q);
      b[0] += sign * (pose.unit.x + aside.x), b[1] += sign * (pose.unit.y + aside.y);
      strut_member_pose moved = strut_member_pose_at(t, t->rest, j, q);
      double tension = strut_member_elastic_force(t, j, &moved);
      push[side][0] = tension * (moved.unit.x * pose.unit.x + moved.unit.y * pose.unit.y);
      push[side][1] = tension * (moved.unit.x * aside.x + moved.unit.y * aside.y);
    }
    double scale = t->stiffness[j];
    assert_near((push[1][0] - push[0][0]) / (2 * step), t->stiffness[j], 1e-4 * scale);
    assert_near((push[1][1] - push[0][1]) / (2 * step),
                strut_member_across_stiffness(t, t->rest, j, &pose), 1e-4 * scale);
  }
}

TEST(largest_magnitude_keeps_what_is_no_number) {
  const double plain[] = {1, -3, 2}, poisoned[] = {1, (double)NAN, 2};
  assert_all(strut_largest_magnitude(plain, 3) == 3, strut_largest_magnitude(plain, 0) == 0);
  assert_true(isnan(strut_largest_magnitude(poisoned, 3)));
}

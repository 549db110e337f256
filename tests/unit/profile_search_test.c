/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Searches through long profiles: the answers, and their bits, of a search through everything; and their time. */
#include "engine/model/pose.h"
#include "engine/scene/profile.h"
#include "tests/models/run_model.h"
#include "tests/support/check.h"
#include "tests/support/random.h"

enum { LONGEST = 100000 };

/* ---- convex pieces ---- */

static void make_convex(uint64_t *r, int32_t count, strut_facet *facet, strut_surface *s) {
  double angle = random_between(r, 0, 6), x = 0, y = 0, turn = random_between(r, 0.1, 3.1) / count;
  bool alike = random_once_in(r, 3); /* a regular polygon has ties */
  for (int32_t k = 0; k < count; k++) {
    double length = alike ? 0.125 : random_between(r, 0.01, 1), c = cos(angle), d = sin(angle);
    facet[k] = (strut_facet){.point = {x, y}, .axes = {{c, d}, {-d, c}}, .length = length};
    x += length * c, y += length * d;
    angle -= alike ? turn : random_between(r, 0, 2 * turn);
  }
  *s = (strut_surface){.facets = count,
                       .facet = facet,
                       .pieces = 1,
                       .before = random_once_in(r, 2) ? HUGE_VAL : random_between(r, 0, 2),
                       .beyond = random_once_in(r, 2) ? HUGE_VAL : random_between(r, 0, 2)};
}

static void compare_poses(const strut_surface *plain, const strut_surface *bounded,
                          const double p[2]) {
  strut_contact_pose a = {.facet = -1}, b = {.facet = -2};
  strut_surface_find(plain, p, -1, &a);
  strut_surface_find(bounded, p, -1, &b);
  assert_int_equal(a.facet, b.facet);
  assert_same_bits(a.gap, b.gap);
  assert_same_bits(a.curvature, b.curvature);
  for (int c = 0; c < 2; c++) {
    assert_same_bits(a.axes.normal[c], b.axes.normal[c]);
    assert_same_bits(a.axes.tangent[c], b.axes.tangent[c]);
  }
  int32_t one, other;
  double margin = strut_surface_margin(plain, p, a.facet, &one);
  assert_same_bits(strut_surface_margin(bounded, p, a.facet, &other), margin);
  assert_int_equal(one, other);
}

TEST(bounds_do_not_change_the_nearest_facet) {
  uint64_t r = 1;
  for (int round = 0; round < 300; round++) {
    strut_facet facet[400];
    OWN(strut_arena) arena = {0};
    strut_surface plain, bounded;
    int32_t count = 9 + random_below(&r, 390);
    make_convex(&r, count, facet, &plain);
    bounded = plain;
    assert_true(strut_surface_bound_facets(&arena, &bounded));
    assert_non_null(bounded.bounds);
    for (int i = 0; i < 200; i++) {
      const strut_facet *f = &facet[random_below(&r, count)];
      double along = random_between(&r, -1, 2) * f->length;
      double side = random_once_in(&r, 2) ? 1 : -1, across = side * random_scale(&r, 1e-9, 30);
      if (random_once_in(&r, 10)) across = 0.0;
      double p[2];
      for (int c = 0; c < 2; c++)
        p[c] = f->point[c] + along * f->axes.tangent[c] + across * f->axes.normal[c];
      compare_poses(&plain, &bounded, p);
      compare_poses(&plain, &bounded, f->point);
    }
  }
}

/* ---- many pieces ---- */

static void read_terrain(uint64_t *r, size_t count, model_run *run) {
  char *text = malloc(60 * count + 1000), *at = text;
  at +=
      sprintf(at,
              "strut: 1\nnodes: {a: {position: [3, 9], mass: 1}, b: {position: [5, 9], mass: 1}}\n"
              "members: {m: {kind: bar, nodes: [a, b], stiffness: 1e3}}\n"
              "solver: {step: 1 ms}\nrun: {duration: 1 s}\n"
              "ground: {stiffness: 1e5, profile: [[-1, 0]");
  for (size_t k = 0; k < count; k++)
    at += sprintf(at, ", [%.17g, %.17g]", (double)k, random_between(r, 0, 0.3));
  sprintf(at, ", [%zu, 0]]}\n", count + 1);
  *run = model_read_text("terrain.yaml", text, set_none);
  assert_ok(strut_model_compile(&run->setup.scene, &run->model, NULL));
  free(text);
}

/* All that may touch are near, and few are. */
TEST(only_pieces_nearby_are_looked_at) {
  uint64_t r = 7;
  enum { POINTS = 1000 };
  OWN(model_run) run = {0};
  read_terrain(&r, POINTS, &run);
  const strut_contact_table *c = &run.model->contacts;
  int32_t end = strut_contacts_end_of_node(c, 0), *list = malloc((size_t)c->count * sizeof *list);
  assert_true(end > POINTS / 4 && c->count == 2 * end);
  assert_int_equal(strut_contacts_end_of_node(c, end), c->count);
  double q[8] = {0};
  size_t looked = 0, times = 2000;
  for (size_t i = 0; i < times; i++) {
    double margin = random_once_in(&r, 2) ? 0.0 : random_scale(&r, 1e-3, 0.05);
    int32_t near = 0, first = random_once_in(&r, 2) ? 0 : end;
    q[c->at[first]] = random_between(&r, -5, POINTS + 5);
    q[c->at[first] + 1] = random_between(&r, -0.05, 1.5);
    int32_t count = strut_contacts_near(c, first, first + end, q, NULL, margin, list);
    looked += (size_t)count;
    for (int32_t k = 0; k < end; k++) {
      bool listed = near < count && list[near] == first + k;
      double gap = strut_contact_gap(c, first + k, q);
      if (listed) near++;
      assert_true(listed || gap > margin || (margin == 0.0 && gap >= 0.0));
    }
    assert_int_equal(near, count);
    double least = HUGE_VAL, lowest;
    int32_t which = -1, found = strut_contacts_lowest(c, first, q, NULL, &lowest);
    for (int32_t k = 0; k < end; k++) {
      double gap = strut_contact_gap(c, first + k, q);
      if (gap < least) least = gap, which = first + k;
    }
    assert_int_equal(found, which);
    assert_same_bits(lowest, least);
  }
  assert_within((double)looked / (double)times, 0.0, 120.0);
  free(list);
}

/* ---- crossings and reaches ---- */

static strut_ground profile_of(double (*points)[2], size_t count) {
  return (strut_ground){
      .present = true, .shape = STRUT_GROUND_PROFILE, .points = points, .point_count = count};
}

/* A walk that seldom turns: some of these cross themselves, some do not. */
static void make_walk(uint64_t *r, size_t count, double wildness, double (*points)[2]) {
  double angle = 0, x = 0, y = 0;
  for (size_t k = 0; k < count; k++) {
    points[k][0] = x, points[k][1] = y;
    double length = random_between(r, 0.1, 1);
    x += length * cos(angle), y += length * sin(angle);
    angle += random_between(r, -wildness, wildness);
  }
}

static bool crosses_at_first(const strut_ground *g, size_t *segment, size_t *other) {
  for (size_t k = 2; k + 1 < g->point_count; k++)
    for (size_t j = 0; j + 1 < k; j++) {
      strut_stretch a = strut_profile_stretch(g, j), b = strut_profile_stretch(g, k);
      *segment = k, *other = j;
      if (!isnan(strut_stretches_meet(&a, &b))) return true;
    }
  return false;
}

static double cast_at_all(const strut_ground *g, const strut_stretch *ray, size_t at) {
  double first = HUGE_VAL;
  for (size_t k = 0; k + 1 < g->point_count; k++) {
    strut_stretch other = strut_profile_stretch(g, k);
    double where = k == at || k + 1 == at ? (double)NAN : strut_stretches_meet(ray, &other);
    if (where < first) first = where;
  }
  return first;
}

TEST(crossings_are_those_of_all_pairs) {
  uint64_t r = 3;
  enum { POINTS = 120 };
  int crossed = 0, rounds = 400;
  for (int round = 0; round < rounds; round++) {
    double points[POINTS][2];
    make_walk(&r, POINTS, random_scale(&r, 0.05, 1.5), points);
    strut_ground g = profile_of(points, POINTS);
    size_t segment, other, k, j;
    bool crosses = crosses_at_first(&g, &k, &j);
    strut_profile_fault fault = strut_profile_check(&g, &segment, &other);
    assert_int_equal(fault, crosses ? STRUT_PROFILE_CROSSES : STRUT_PROFILE_FINE);
    crossed += crosses;
    if (crosses) assert_true(segment == k && other == j);
    OWN(strut_arena) arena = {0};
    strut_profile_index index;
    assert_true(strut_profile_index_create(&arena, &g, &index));
    for (size_t at = 1; at + 1 < POINTS; at++)
      for (int way = 0; way < 2; way++) {
        strut_vec2 d = strut_vec2_between(points[at - (size_t)way], points[at + 1 - (size_t)way]);
        const strut_stretch ray = {points[at], way ? d : (strut_vec2){-d.x, -d.y}, 0.0, HUGE_VAL};
        assert_same_bits(strut_profile_cast_ray(&index, &ray, at), cast_at_all(&g, &ray, at));
      }
  }
  assert_within(crossed, 0.2 * rounds, 0.9 * rounds);
}

/* A spiral of many turns, whose last line leads out, is no graph over any line. */
TEST(long_profiles_are_checked_at_once) {
  double(*points)[2] = malloc(LONGEST * sizeof *points);
  size_t segment, other;
  for (size_t k = 0; k < LONGEST; k++) {
    double turns = 30.0 * (double)k / LONGEST, radius = 1.0 + turns;
    points[k][0] = radius * cos(STRUT_TAU * turns), points[k][1] = radius * sin(STRUT_TAU * turns);
  }
  strut_ground g = profile_of(points, LONGEST);
  double begin = test_seconds();
  /* the line before its begin leads through all the turns */
  assert_int_equal(strut_profile_check(&g, &segment, &other), STRUT_PROFILE_CROSSES);
  assert_int_equal(other, 0);
  assert_within(test_seconds() - begin, 0.0, 5.0);
  for (size_t k = 0; k < LONGEST; k++)
    points[k][0] = (double)k, points[k][1] = k % 2 ? -1.0 : -1.0001;
  begin = test_seconds();
  assert_int_equal(strut_profile_check(&g, &segment, &other), STRUT_PROFILE_FINE);
  assert_within(test_seconds() - begin, 0.0, 1.0);
  free(points);
}

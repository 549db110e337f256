/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All stationary points of structures whose answers are known: the gallery, the paper's crawler. */
#include "engine/statics/critical.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif

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
  /* found again by every one of several seeds */
  static const double saddles[] = {22.672821403,  22.6786953479, 22.6833957641, 22.6844442893,
                                   22.6896852375, 22.7089940895, 22.7133877053, 22.7150093907,
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


/* A structure of the gallery by its numbers alone. */
typedef struct node_row {
  double x, y;
  int fixed; /* 1: in x, 2: in y */
} node_row;
typedef struct member_row {
  strut_member_kind kind;
  int a, b; /* from 1 */
  double stiffness, rest;
} member_row;

static void build(strut_scene *scene, const node_row *node, int nodes, const member_row *member,
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
#define BUILD(scene, node, member)                                                                 \
  build(scene, node, (int)(sizeof(node) / sizeof(node)[0]), member,                                \
        (int)(sizeof(member) / sizeof(member)[0]))

/* Exactly these energies, in this order, are the minima's, each of that label. */
static void assert_minima(const fixture *f, const double *energy, size_t count, double tolerance) {
  assert_int_equal(count_of(f, STRUT_STABLE), count);
  for (size_t i = 0; i < count; i++) {
    assert_int_equal(f->set.points[i].label, STRUT_STABLE);
    assert_near(f->set.points[i].potential, energy[i], tolerance);
  }
}

static void assert_saddle(const fixture *f, double energy, double tolerance, int32_t negative) {
  const strut_critical_point *p = nearest(f, STRUT_SADDLE, energy);
  assert_near(p->potential, energy, tolerance);
  assert_int_equal(p->negative, negative);
}

/* P1: one shape in four placements. */
static void snelsons_square(void **state) {
  static const node_row node[] = {{0, 0, 3}, {1, 0, 2}, {1, 1, 0}, {0, 1, 0}};
  static const double eigenvalue[] = {41.420771, 99.582797, 157.296395, 1105.450613, 1607.664949};
  const double diagonal = sqrt(2);
  const member_row member[] = {{STRUT_CABLE, 1, 2, 100, 0.95},    {STRUT_CABLE, 2, 3, 100, 0.95},
                               {STRUT_CABLE, 3, 4, 100, 0.95},    {STRUT_CABLE, 4, 1, 100, 0.95},
                               {STRUT_BAR, 2, 4, 1000, diagonal}, {STRUT_BAR, 1, 3, 1000, diagonal}};
  fixture f = {0};
  (void)state;
  BUILD(&f.scene, node, member);
  search(&f, NULL, false, true);
  assert_minima(&f, (double[]){5.0 / 11}, 1, 1e-13);
  assert_int_equal(f.set.points[0].placements, 4);
  for (int i = 0; i < 5; i++) assert_near(f.set.points[0].eigenvalues[i], eigenvalue[i], 1e-6);
  tear_down(&f);

  BUILD(&f.scene, node, member); /* the same in the air: two placements, three free motions */
  f.scene.nodes[0].fixed[0] = f.scene.nodes[0].fixed[1] = f.scene.nodes[1].fixed[1] = false;
  search(&f, NULL, false, false);
  assert_minima(&f, (double[]){5.0 / 11}, 1, 1e-13);
  assert_int_equal(f.set.points[0].rigid, 3);
  assert_int_equal(f.set.points[0].zero, 3);
  assert_true(f.set.points[0].placements <= 2);
  tear_down(&f);
}

/* P2: the folded twin has the same member lengths and energy, and is another shape. */
static void double_square(void **state) {
  static const node_row node[] = {{0, 0, 3}, {1, 0, 2}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}};
  const double d = sqrt(2);
  const member_row member[] = {
      {STRUT_BAR, 1, 3, 1000, d},     {STRUT_BAR, 2, 4, 1000, d},     {STRUT_BAR, 2, 6, 1000, d},
      {STRUT_BAR, 3, 5, 1000, d},     {STRUT_CABLE, 1, 2, 100, 0.95}, {STRUT_CABLE, 2, 3, 100, 0.95},
      {STRUT_CABLE, 3, 4, 100, 0.95}, {STRUT_CABLE, 4, 1, 100, 0.95}, {STRUT_CABLE, 2, 5, 100, 0.95},
      {STRUT_CABLE, 5, 6, 100, 0.95}, {STRUT_CABLE, 6, 3, 100, 0.95}};
  fixture f = {0};
  (void)state;
  BUILD(&f.scene, node, member);
  search(&f, NULL, false, false);
  assert_minima(&f, (double[]){0.741869206537, 0.741869206537}, 2, 1e-11);
  double a = f.set.points[0].eigenvalues[0], b = f.set.points[1].eigenvalues[0];
  assert_near(fmin(a, b), 15.634929, 1e-6);
  assert_near(fmax(a, b), 23.4244, 1e-4);
  assert_int_equal(f.set.points[0].placements + f.set.points[1].placements, 8);
  assert_int_not_equal(f.set.points[0].shape, f.set.points[1].shape);
  tear_down(&f);
}

/* P3: a rhombus of stiff bars: one prestressed shape that may turn, and one continuum of slack ones. */
static void d_bar(void **state) {
  static const node_row node[] = {{0, 0, 3}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const double d = sqrt(2), ea = 219.911486;
  const member_row member[] = {{STRUT_BAR, 4, 1, 1e7, 1},      {STRUT_BAR, 1, 2, 1e7, 1},
                               {STRUT_BAR, 2, 3, 1e7, 1},      {STRUT_BAR, 3, 4, 1e7, 1},
                               {STRUT_CABLE, 2, 4, ea / d, d}, {STRUT_CABLE, 1, 3, ea / d / 0.7, 0.7 * d}};
  fixture f = {0};
  (void)state;
  BUILD(&f.scene, node, member);
  search(&f, NULL, false, false);
  assert_int_equal(f.set.count, 2);
  assert_int_equal(f.set.points[0].label, STRUT_FLOPPY);
  assert_near(f.set.points[0].potential, 0, 1e-15);
  assert_int_equal(f.set.points[1].label, STRUT_STABLE);
  assert_int_equal(f.set.points[1].rigid, 1);
  assert_near(f.set.points[1].potential, 6.4389642, 1e-6);
  tear_down(&f);
}

/* P5 without load: upright and hanging, and two saddles with the bar on its side. */
static void half_t_bar(void **state) {
  static const node_row node[] = {{-1, 0, 3}, {0, 0, 3}, {1, 0, 3}, {0, 1, 0}};
  const double bar = 1.0000043657, cable = 1.4140076829;
  const member_row member[] = {{STRUT_BAR, 2, 4, 11453019.53174 / bar, bar},
                               {STRUT_CABLE, 1, 4, 242825.130902 / cable, cable},
                               {STRUT_CABLE, 3, 4, 242825.130902 / cable, cable}};
  fixture f = {0};
  (void)state;
  BUILD(&f.scene, node, member);
  search(&f, NULL, false, true);
  assert_minima(&f, (double[]){0.00738808, 0.00738808}, 2, 1e-8);
  assert_relative(f.set.points[0].eigenvalues[0], 171703.2967, 1e-9);
  assert_relative(f.set.points[0].eigenvalues[1], 11624722.8284, 1e-9);
  assert_int_equal(f.set.points[1].shape, 0);
  assert_saddle(&f, 29049.497, 1e-3, 1);
  tear_down(&f);
}

/* P6: a mechanism that prestress alone stiffens, with two kinds of saddle. */
static void hexagon_of_cables(void **state) {
  const double h = sqrt(7) / 4, p = 0.3;
  const node_row node[] = {{0, 0, 3},         {h, 0.75, 0},      {h + 1, 0.75, 0},
                           {2 * h + 1, 0, 3}, {h + 1, -0.75, 0}, {h, -0.75, 0}};
  const member_row member[] = {{STRUT_CABLE, 1, 2, 1, 1 - p}, {STRUT_CABLE, 2, 3, 1, 1 - p},
                               {STRUT_CABLE, 3, 4, 1, 1 - p}, {STRUT_CABLE, 4, 5, 1, 1 - p},
                               {STRUT_CABLE, 5, 6, 1, 1 - p}, {STRUT_CABLE, 6, 1, 1, 1 - p},
                               {STRUT_BAR, 2, 6, 0.5, 1.5 * (1 + p)},
                               {STRUT_BAR, 3, 5, 0.5, 1.5 * (1 + p)}};
  fixture f = {0};
  (void)state;
  BUILD(&f.scene, node, member);
  search(&f, NULL, false, true);
  assert_minima(&f, (double[]){0.363146484, 0.363146484}, 2, 1e-9);
  assert_near(f.set.points[0].eigenvalues[0], 0.200814, 1e-6);
  assert_near(f.set.points[0].eigenvalues[1], 0.564213, 1e-6);
  assert_int_equal(f.set.points[1].shape, f.set.points[0].shape);
  assert_saddle(&f, 0.67448409, 1e-8, 1);
  assert_saddle(&f, 0.83992735, 1e-8, 1);
  tear_down(&f);
}

/* P9: snap-through, and the apex beyond a support. */
static void von_mises_truss(void **state) {
  static const node_row node[] = {{-1, 0, 3}, {1, 0, 3}, {0, 0.5, 0}};
  const double l = sqrt(1.25);
  const member_row member[] = {{STRUT_BAR, 1, 3, 1, l}, {STRUT_BAR, 2, 3, 1, l}};
  fixture f = {0};
  (void)state;
  BUILD(&f.scene, node, member);
  search(&f, NULL, false, true);
  assert_minima(&f, (double[]){0, 0}, 2, 1e-15);
  assert_int_equal(f.set.count, 5);
  const strut_critical_point *pass = &f.set.points[2], *aside = &f.set.points[3];
  assert_near(pass->potential, (l - 1) * (l - 1), 1e-15);
  assert_near(pass->eigenvalues[0], -0.2360679775, 1e-9);
  assert_near(pass->eigenvalues[1], 2, 1e-14);
  assert_int_equal(pass->down[0] + pass->down[1], 1);
  assert_near(aside->potential, 1, 1e-15);
  assert_near(fabs(aside->q[4]), l, 1e-14);
  assert_int_equal(aside->negative, 1);
  tear_down(&f);
}

/* P10: two bistable cells; the mixed states go when the coupling grows. */
static void bistable_cells(void **state) {
  const double l = sqrt(1.09), couplings[] = {0.01, 0.0290, 0.0293};
  const node_row node[] = {{-1, 0, 3}, {1, 0, 3}, {0, 0.3, 1}, {-1, 2, 3}, {1, 2, 3}, {0, 2.3, 1}};
  (void)state;
  for (int i = 0; i < 3; i++) {
    fixture f = {0};
    const member_row member[] = {{STRUT_BAR, 1, 3, 1, l}, {STRUT_BAR, 2, 3, 1, l},
                                 {STRUT_BAR, 4, 6, 1, l}, {STRUT_BAR, 5, 6, 1, l},
                                 {STRUT_SPRING, 3, 6, couplings[i], 2}};
    BUILD(&f.scene, node, member);
    search(&f, NULL, false, true);
    assert_int_equal(count_of(&f, STRUT_STABLE), i < 2 ? 4 : 2);
    if (i == 0) {
      const double e = 0.001584158416;
      assert_minima(&f, (double[]){0, 0, e, e}, 4, 1e-12);
      assert_int_equal(count_of(&f, STRUT_SADDLE), 4);
      for (int k = 4; k < 8; k++) assert_near(f.set.points[k].potential, 0.002412301, 1e-9);
      assert_int_equal(count_of(&f, STRUT_MAXIMUM), 1);
      assert_near(f.set.points[8].potential, 0.003877396, 1e-9);
    }
    tear_down(&f);
  }
}

/* P11: Zeeman's machine inside and outside its cusp. */
static void zeemans_machine(void **state) {
  static const struct {
    double x, y;
    size_t stable;
    double energy[2];
  } answer[] = {{0, 0, 1, {0.681319842}},
                {0.1, -0.25, 2, {0.708701247, 0.725778073}},
                {0.1, -0.5, 1, {0.696760380}},
                {0.1, -0.3433, 2, {0}},
                {0.1, -0.3435, 1, {0}},
                {0.1, -0.1447, 2, {0}},
                {0.1, -0.1444, 1, {0}}};
  (void)state;
  for (size_t i = 0; i < sizeof answer / sizeof answer[0]; i++) {
    fixture f = {0};
    const node_row node[] = {{1, 0, 3}, {2, 0.25, 3}, {answer[i].x, answer[i].y, 3}, {1.2, 0.4, 0}};
    const member_row member[] = {{STRUT_BAR, 1, 4, 1e6, 0.5},
                                 {STRUT_CABLE, 2, 4, 1, 0.25},
                                 {STRUT_CABLE, 3, 4, 1, 0.25}};
    BUILD(&f.scene, node, member);
    search(&f, NULL, false, true);
    assert_int_equal(count_of(&f, STRUT_STABLE), answer[i].stable);
    for (size_t k = 0; k < answer[i].stable && answer[i].energy[0] > 0; k++)
      assert_near(f.set.points[k].potential, answer[i].energy[k], 1e-6);
    if (i == 1) {
      assert_saddle(&f, 0.740753781, 1e-6, 1);
      assert_saddle(&f, 0.837260196, 1e-6, 1);
    }
    tear_down(&f);
  }
}

/* P12: crossed bars and the parallelogram, each up and down. */
static void x_joint(void **state) {
  const double s = sqrt(0.0075);
  const node_row node[] = {{0, 0, 3}, {0.05, 0, 3}, {0.05, s, 0}, {0, s, 0}};
  const member_row member[] = {{STRUT_BAR, 1, 3, 1e6, 0.1},
                               {STRUT_BAR, 2, 4, 1e6, 0.1},
                               {STRUT_BAR, 4, 3, 1e6, 0.05},
                               {STRUT_CABLE, 1, 4, 100, 0.06},
                               {STRUT_CABLE, 2, 3, 100, 0.06}};
  const double crossed = 0.070758901, open = 0.26833506;
  fixture f = {0};
  (void)state;
  BUILD(&f.scene, node, member);
  search(&f, NULL, false, true);
  assert_minima(&f, (double[]){crossed, crossed, open, open}, 4, 1e-8);
  assert_near(f.set.points[0].eigenvalues[0], 32.6775, 1e-4);
  tear_down(&f);
}

/*
 * P13: besides the gallery's four states the mirrored triangle has a fifth with both springs crossed,
 * beyond the cusp where one of them is a point: its length has no sign.
 */
static void dual_triangle(void **state) {
  const double c = sqrt(0.75);
  const node_row node[] = {{0, 0, 3}, {-c, 0.5, 3}, {-c, -0.5, 3}, {c, -0.5, 0}, {c, 0.5, 0}};
  const member_row member[] = {{STRUT_BAR, 1, 4, 1e6, 1},
                               {STRUT_BAR, 1, 5, 1e6, 1},
                               {STRUT_BAR, 4, 5, 1e6, 1},
                               {STRUT_SPRING, 2, 4, 100, 0.8},
                               {STRUT_SPRING, 3, 5, 100, 0.8}};
  fixture f = {0};
  (void)state;
  (void)node, (void)member;
  BUILD(&f.scene, node, member);
  search(&f, NULL, false, true);
  assert_minima(&f, (double[]){0, 0, 4, 67.995, 67.995}, 5, 1e-3);
  for (size_t i = 0; i < 5; i++) {
    const double *q = f.set.points[i].q;
    double turned = fabs(atan2(q[7] + q[9], q[6] + q[8])) * 180 / acos(-1);
    assert_near(turned, i < 2 ? 132.8436 : i == 2 ? 180 : 92.2908, 1e-3);
  }
  assert_saddle(&f, 86.8588, 1e-4, 1);
  assert_saddle(&f, 143.9856, 1e-4, 1);
  tear_down(&f);
}

/* A node on a loose cable hangs, or lies anywhere where the cable is slack: one floppy point. */
static void a_slack_arc_is_one_point(void **state) {
  static const node_row node[] = {{1, 2, 3}, {3, 4, 3}, {2, 3, 0}};
  static const member_row member[] = {{STRUT_BAR, 1, 3, 1000, 2}, {STRUT_CABLE, 2, 3, 1, 1}};
  fixture f = {0};
  (void)state;
  BUILD(&f.scene, node, member);
  search(&f, NULL, false, false);
  assert_int_equal(f.set.count, 1);
  assert_int_equal(f.set.points[0].label, STRUT_FLOPPY);
  assert_int_equal(f.set.points[0].zero, 1);
  tear_down(&f);
}

/* Nothing holds it: every start falls for ever. */
static void what_falls_has_no_point(void **state) {
  fixture f = {0};
  (void)state;
  strut_scene_init(&f.scene);
  structure_crawler(&f.scene, 10, 1e-4, 0.1, false);
  search(&f, NULL, false, false);
  assert_int_equal(f.set.count, 0);
  assert_int_equal(f.set.runaway + f.set.exhausted, f.set.starts);
  tear_down(&f);
}

static void the_threads_change_no_bit(void **state) {
  fixture one = {0}, three = {0};
  uint8_t held[64] = {0};
  (void)state;
  held[0] = held[1] = held[7] = 1;
#ifdef _OPENMP
  omp_set_num_threads(1);
#endif
  strut_scene_init(&one.scene);
  structure_crawler(&one.scene, 10, 1e-4, 0.1, false);
  search(&one, held, false, true);
#ifdef _OPENMP
  omp_set_num_threads(3);
#endif
  strut_scene_init(&three.scene);
  structure_crawler(&three.scene, 10, 1e-4, 0.1, false);
  search(&three, held, false, true);
  assert_int_equal(one.set.count, three.set.count);
  assert_int_equal(one.set.starts, three.set.starts);
  assert_int_equal(one.set.saddle_starts, three.set.saddle_starts);
  for (size_t i = 0; i < one.set.count; i++) {
    const strut_critical_point *a = &one.set.points[i], *b = &three.set.points[i];
    assert_memory_equal(a->q, b->q, (size_t)one.model->length * sizeof *a->q);
    assert_memory_equal(a->eigenvalues, b->eigenvalues, 7 * sizeof *a->eigenvalues);
    assert_memory_equal(a->softest, b->softest, (size_t)one.model->length * sizeof *a->q);
    assert_same_bits(a->potential, b->potential);
    assert_int_equal(a->found, b->found);
    assert_int_equal(a->placements, b->placements);
    assert_int_equal(a->down[0], b->down[0]);
    assert_int_equal(a->down[1], b->down[1]);
  }
  tear_down(&one);
  tear_down(&three);
}

static void refused_memory(void **state) {
  static const node_row node[] = {{-1, 0, 3}, {1, 0, 3}, {0, 0.5, 0}};
  static const member_row member[] = {{STRUT_BAR, 1, 3, 1, 1.1}, {STRUT_BAR, 2, 3, 1, 1.1}};
  strut_critical_effort effort = {.seed = 1, .saddles = true, .starts = 4};
  fixture f = {0};
  (void)state;
#ifdef _OPENMP
  omp_set_num_threads(1); /* else which allocation is refused is up to chance */
#endif
  BUILD(&f.scene, node, member);
  assert_int_equal(strut_model_compile(&f.scene, &f.model, NULL), STRUT_OK);
  assert_int_equal(strut_potential_create(f.model, NULL, false, &f.potential, NULL), STRUT_OK);
  for (int64_t n = 0;; n++) {
    strut_fail_allocation_after(n);
    strut_status status = strut_critical_search(f.potential, &effort, &f.set, NULL);
    strut_fail_allocation_after(-1);
    if (status == STRUT_OK) break;
    assert_int_equal(status, STRUT_NO_MEMORY);
    assert_int_equal(f.set.count, 0);
    assert_true(n < 1000);
  }
  tear_down(&f);
}

/* By eigenvectors and by factors the same judgement: a chain just below the limit and above. */
static void large_structures_are_judged_alike(void **state) {
  double before = 0;
  (void)state;
  for (size_t frames = 28; frames <= 32; frames += 4) {
    fixture f = {0};
    strut_critical_effort effort = {.seed = 1};
    strut_scene_init(&f.scene);
    structure_chain(&f.scene, frames, STRUT_MASS_LUMPED);
    assert_int_equal(strut_model_compile(&f.scene, &f.model, NULL), STRUT_OK);
    assert_int_equal(strut_potential_create(f.model, NULL, false, &f.potential, NULL), STRUT_OK);
    assert_int_equal(f.potential->n <= STRUT_DENSE_STATICS, frames == 28);
    effort.starts = frames == 28;
    assert_int_equal(strut_critical_search(f.potential, &effort, &f.set, NULL), STRUT_OK);
    assert_true(f.set.count >= 1);
    const strut_critical_point *p = &f.set.points[0];
    for (size_t i = 0; i < f.set.count; i++)
      if (strut_shape_distance(f.model, f.set.points[i].q, f.model->start, false, NULL) <
          strut_shape_distance(f.model, p->q, f.model->start, false, NULL))
        p = &f.set.points[i];
    assert_int_equal(p->label, STRUT_STABLE);
    /* a cantilever's softest stiffness, per length^4: alike for both */
    double scaled = p->eigenvalues[0] * pow((double)frames, 4);
    if (before > 0) assert_within(scaled / before, 0.95, 1.05);
    before = scaled;
    tear_down(&f);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_crawler_on_nodes_1_and_4),
      cmocka_unit_test(snelsons_square),
      cmocka_unit_test(double_square),
      cmocka_unit_test(d_bar),
      cmocka_unit_test(half_t_bar),
      cmocka_unit_test(hexagon_of_cables),
      cmocka_unit_test(von_mises_truss),
      cmocka_unit_test(bistable_cells),
      cmocka_unit_test(zeemans_machine),
      cmocka_unit_test(x_joint),
      cmocka_unit_test(dual_triangle),
      cmocka_unit_test(a_slack_arc_is_one_point),
      cmocka_unit_test(what_falls_has_no_point),
      cmocka_unit_test(the_threads_change_no_bit),
      cmocka_unit_test(refused_memory),
      cmocka_unit_test(large_structures_are_judged_alike),
  };
  return cmocka_run_group_tests_name("critical", tests, NULL, NULL);
}

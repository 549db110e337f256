/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The search for stationary points: the paper's crawler, what is floppy, threads, memory, size. */
#ifdef _OPENMP
#include <omp.h>
#endif

#include "engine/statics/search/critical.h"
#include "tests/support/random.h"
#include "tests/support/structures.h"

/* A scene (fill it first), and what a search of it gives. */
typedef struct fixture {
  strut_scene scene;
  strut_model *model;
  strut_potential *potential;
  strut_critical_set set;
} fixture;

static void compile(fixture *f, const uint8_t *held, bool ground) {
  assert_ok(strut_model_compile(&f->scene, &f->model, NULL));
  assert_ok(strut_potential_create(f->model, held, ground, &f->scene.arena, &f->potential, NULL));
}

/* Compiles and searches with seed 1; checks what every point must be. */
static void critical_find(fixture *f, const uint8_t *held, bool ground, bool saddles) {
  strut_critical_effort effort = {.seed = 1, .saddles = saddles};
  compile(f, held, ground);
  assert_ok(strut_critical_search(f->potential, &effort, &f->set, NULL));
  for (size_t i = 0; i < f->set.count; i++) {
    const strut_critical_point *p = &f->set.points[i];
    assert_true(p->residual <= 16 * strut_potential_rounding(f->potential, p->q));
    assert_true(p->found > 0 || p->label == STRUT_STABLE || p->label == STRUT_FLOPPY);
    if (i > 0 && p[-1].label == p->label) assert_true(p[-1].potential <= p->potential);
    for (int k = 0; k < 2; k++)
      if (p->down[k] >= 0) assert_true(f->set.points[p->down[k]].potential < p->potential);
  }
}

static void fixture_free(fixture *f) {
  strut_critical_free(&f->set);
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

static void find_crawler(fixture *f) {
  static const uint8_t held[64] = {1, 1, [7] = 1};
  structure_crawler(&f->scene, 10, 1e-4, 0.1, false);
  critical_find(f, held, false, true);
}

TEST(the_crawler_on_nodes_1_and_4) {
  /* found again by every one of several seeds */
  static const double saddles[] = {22.672821403,  22.6786953479, 22.6833957641, 22.6844442893,
                                   22.6896852375, 22.7089940895, 22.7133877053, 22.7150093907,
                                   22.7184950429, 22.7235766608, 37.4984114922};
  static const double minima[] = {22.2125952092, 22.2460123011, 22.6641332092,
                                  22.6690358567, 22.706131,     22.712029};
  OWN(fixture) f = {.scene = build_scene()};
  find_crawler(&f);
  assert_all_equal(count_of(&f, STRUT_STABLE), 6, count_of(&f, STRUT_FLOPPY), 0);
  for (size_t i = 0; i < 6; i++) assert_near(f.set.points[i].potential, minima[i], 1e-6);
  const strut_critical_point *two = nearest(&f, STRUT_STABLE, 22.712029);
  assert_all_near(1e-7, fabs(two->q[2]), 93.5388e-3, two->q[3], 33.6848e-3);
  assert_near(fabs(two->q[6]), 43.9094e-3, 1e-7);
  for (size_t i = 0; i < sizeof saddles / sizeof saddles[0]; i++) {
    const strut_critical_point *p = nearest(&f, STRUT_SADDLE, saddles[i]);
    assert_near(p->potential, saddles[i], 1e-9);
    assert_int_equal(p->negative, 1);
    assert_true(p->down[0] >= 0 && p->down[1] >= 0);
  }
  /* no shape was met just once: the estimate is that of one more, and the limit that of three */
  strut_missed missed = f.set.missed;
  assert_within(missed.probability, 1.0 / 4001.0, 1.0 / 257.0);
  assert_near(missed.below, -log(0.05) / (1.0 / missed.probability - 1.0), 1e-12);
  assert_int_equal(f.set.unseen, 0);
}

/* `starts` draws of n independent cells, up with the probability `up`: what they tell, and the truth. */
static strut_missed draw_states(int cells, double up, int starts, uint64_t *state, double *mass,
                                double *largest) {
  static int hits[1 << 10];
  int64_t distinct = 0, once = 0, twice = 0;
  memset(hits, 0, sizeof hits);
  for (int i = 0; i < starts; i++) {
    int drawn = 0;
    for (int k = 0; k < cells; k++) drawn = 2 * drawn + (random_between(state, 0, 1) < up);
    hits[drawn]++;
  }
  *mass = *largest = 0.0;
  for (int i = 0; i < 1 << cells; i++) {
    double share = 1.0;
    for (int k = 0; k < cells; k++) share *= i >> k & 1 ? up : 1.0 - up;
    distinct += hits[i] > 0, once += hits[i] == 1, twice += hits[i] == 2;
    if (hits[i]) continue;
    *mass += share;
    *largest = fmax(*largest, share);
  }
  return strut_estimate_missed(starts, distinct, once, twice);
}

/* Each of the three limits holds in 95 of 100 searches of n bistable cells, which have 2^n states. */
TEST(limits_on_what_was_missed_hold) {
  enum { TURNS = 1000, MOST_WRONG = 65 };
  static const int starts[] = {30, 100, 400, 3000};
  static const double up[] = {0.5, 0.7, 0.8};
  uint64_t state = 7;
  for (int cells = 4; cells <= 10; cells += 3)
    for (int k = 0; k < 12; k++) {
      int wrong[3] = {0}, n = starts[k % 4];
      double estimated = 0.0, missed = 0.0, mass, largest;
      for (int turn = 0; turn < TURNS; turn++) {
        strut_missed m = draw_states(cells, up[k / 4], n, &state, &mass, &largest);
        wrong[0] += mass > m.below;
        wrong[1] += largest > m.one;
        wrong[2] += (double)(1 << cells) < m.count;
        estimated += m.probability / TURNS, missed += mass / TURNS;
      }
      for (int i = 0; i < 3; i++) assert_within(wrong[i], 0, MOST_WRONG);
      /* (once + 1) / (n + 1) is by as much more than once / n, whose mean is that of what is missed */
      assert_near(estimated, missed + (1.0 - missed) / n, 4.0 / sqrt((double)n * TURNS));
    }
  strut_missed none = strut_estimate_missed(0, 0, 0, 0);
  assert_true(none.probability == 1.0 && none.below == 1.0 && none.one == 1.0 && none.count == 0.0);
}

/* A node on a loose cable hangs, or lies anywhere where the cable is slack: one floppy point. */
TEST(a_slack_arc_is_one_point) {
  OWN(fixture) f = {.scene = build_scene()};
  build_support(&f.scene, 1, 2);
  build_support(&f.scene, 3, 4);
  build_node(&f.scene, 2, 3);
  build_sized(&f.scene, STRUT_BAR, 0, 2, 1000, 0, 0, 2);
  build_sized(&f.scene, STRUT_CABLE, 1, 2, 1, 0, 0, 1);
  critical_find(&f, NULL, false, false);
  assert_all_equal(f.set.count, 1, f.set.points[0].label, STRUT_FLOPPY, f.set.points[0].zero, 1);
}

/*
 * A truss that snaps through, weakly loaded, beside a rod that may point anywhere: two shapes that are
 * floppy, whose energies differ by a part in 10000. A stretched spring between supports adds 1 J.
 */
TEST(floppy_shapes_of_almost_one_energy_are_two) {
  const double push = 2e-4;
  OWN(fixture) f = {.scene = build_scene()};
  build_support(&f.scene, -1, 0);
  build_support(&f.scene, 1, 0);
  build_node(&f.scene, 0, 0.3);
  build_support(&f.scene, 5, 0);
  build_node(&f.scene, 5, 1);
  for (int32_t i = 0; i < 2; i++) build_member(&f.scene, STRUT_BAR, i, 2, 1000, 0, 0);
  build_sized(&f.scene, STRUT_SPRING, 0, 1, 2, 0, 0, 1);
  build_member(&f.scene, STRUT_BAR, 3, 4, 10, 0, 0);
  build_load(&f.scene, 2, 0, push, -1);
  critical_find(&f, NULL, false, false);
  assert_int_equal(count_of(&f, STRUT_FLOPPY), 2);
  for (int i = 0; i < 2; i++) {
    double side = i ? -0.3 : 0.3;
    assert_near(nearest(&f, STRUT_FLOPPY, 1 - push * side)->potential, 1 - push * side, 1e-8);
    assert_near(nearest(&f, STRUT_FLOPPY, 1 - push * side)->q[5], side, 1e-4);
  }
}

/* Turned, shifted, mirrored: the same shape; a node moved by 0.1 is that far off at most. */
TEST(the_distance_of_shapes) {
  static const double corner[4][2] = {{0, 0}, {2, 0}, {2, 1}, {0.3, 1.4}};
  bool mirrored;
  OWN(fixture) f = {.scene = build_scene()};
  for (int i = 0; i < 4; i++) build_node(&f.scene, corner[i][0], corner[i][1]);
  build_member(&f.scene, STRUT_BAR, 0, 1, 1, 0, 0);
  assert_ok(strut_model_compile(&f.scene, &f.model, NULL));
  for (int side = 1; side >= -1; side -= 2) {
    double q[16] = {0}, c = cos(0.7), s = sin(0.7);
    for (int i = 0; i < 4; i++) {
      q[2 * i] = 3 + side * (c * corner[i][0] - s * corner[i][1]);
      q[2 * i + 1] = -1 + s * corner[i][0] + c * corner[i][1];
    }
    assert_near(strut_shape_distance(f.model, f.model->start, q, true, &mirrored), 0, 1e-14);
    assert_int_equal(mirrored, side < 0);
    double plain = strut_shape_distance(f.model, f.model->start, q, false, &mirrored);
    assert_all(!mirrored, side > 0 ? plain < 1e-14 : plain > 0.1);
    q[5] += 0.1;
    assert_within(strut_shape_distance(f.model, f.model->start, q, true, NULL), 0.03, 0.1);
  }
}

/* A cable that pulls with next to nothing counts as slack where that is asked for, a contact too. */
TEST(what_rounding_alone_closes) {
  OWN(strut_arena) arena = {0};
  OWN(fixture) f = {.scene = build_scene()};
  build_support(&f.scene, 0, 1);
  build_node(&f.scene, 0, -1e-9);
  build_sized(&f.scene, STRUT_CABLE, 0, 1, 100, 0, 0, 1);
  build_contact(&f.scene, 1, 1000, 0);
  compile(&f, NULL, true);
  strut_sparse *k = strut_potential_matrix(f.potential, &arena);
  const double least[] = {0, 5e-7, 5e-6}, stiffness[] = {1100, 1000, 0};
  for (int i = 0; i < 3; i++) { /* the cable pulls with 1e-7 N, the ground pushes with 1e-6 N */
    strut_potential_hessian_above(f.potential, f.model->start, least[i], k);
    assert_near(k->value[k->start[1]], stiffness[i], 1e-9);
  }
}

/* Nothing holds it: every start falls for ever. */
TEST(what_falls_has_no_point) {
  OWN(fixture) f = {.scene = build_scene()};
  structure_crawler(&f.scene, 10, 1e-4, 0.1, false);
  critical_find(&f, NULL, false, false);
  assert_all_equal(f.set.count, 0, f.set.runaway + f.set.exhausted, f.set.starts);
}

TEST(the_threads_change_no_bit) {
  OWN(fixture) one = {.scene = build_scene()}, three = {.scene = build_scene()};
#ifdef _OPENMP
  omp_set_num_threads(1);
#endif
  find_crawler(&one);
#ifdef _OPENMP
  omp_set_num_threads(3);
#endif
  find_crawler(&three);
  assert_all_equal(one.set.count, three.set.count, one.set.starts, three.set.starts);
  assert_int_equal(one.set.saddle_starts, three.set.saddle_starts);
  for (size_t i = 0; i < one.set.count; i++) {
    const strut_critical_point *a = &one.set.points[i], *b = &three.set.points[i];
    assert_memory_equal(a->q, b->q, (size_t)one.model->length * sizeof *a->q);
    assert_memory_equal(a->eigenvalues, b->eigenvalues, 7 * sizeof *a->eigenvalues);
    assert_memory_equal(a->softest, b->softest, (size_t)one.model->length * sizeof *a->q);
    assert_same_bits(a->potential, b->potential);
    assert_all_equal(a->found, b->found, a->placements, b->placements, a->down[0], b->down[0]);
    assert_int_equal(a->down[1], b->down[1]);
  }
}

TEST(refused_memory) {
  strut_critical_effort effort = {.seed = 1, .saddles = true, .starts = 4};
  OWN(fixture) f = {.scene = build_scene()};
  build_support(&f.scene, -1, 0);
  build_support(&f.scene, 1, 0);
  build_node(&f.scene, 0, 0.5);
  for (int32_t i = 0; i < 2; i++) build_sized(&f.scene, STRUT_BAR, i, 2, 1, 0, 0, 1.1);
#ifdef _OPENMP
  omp_set_num_threads(1); /* else which allocation is refused is up to chance */
#endif
  compile(&f, NULL, false);
  REFUSE_EACH(n, status, 1) {
    status = refused(n, strut_critical_search(f.potential, &effort, &f.set, NULL));
    if (status) assert_int_equal(f.set.count, 0);
  }
}

/* By eigenvectors and by factors the same judgement: a chain just below the limit and above. */
TEST(large_structures_are_judged_alike) {
  double before = 0;
  for (size_t frames = 28; frames <= 32; frames += 4) {
    strut_critical_effort effort = {.seed = 1};
    OWN(fixture) f = {.scene = build_scene()};
    structure_chain(&f.scene, frames, STRUT_MASS_LUMPED);
    compile(&f, NULL, false);
    assert_int_equal(f.potential->n <= STRUT_DENSE_STATICS, frames == 28);
    effort.starts = frames == 28;
    assert_ok(strut_critical_search(f.potential, &effort, &f.set, NULL));
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
  }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Elements: every strain and every law against differences and formulas. */
#include "engine/forces/elements.h"

#include <float.h>

#include "engine/forces/strains/strains.h"
#include "tests/physics/random_elements.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"

/* Richardson's extrapolation of central differences with steps h, h/2, h/4: error of sixth order. */
static double extrapolated(double a, double b, double c) {
  double first = (4 * b - a) / 3, second = (4 * c - b) / 3;
  return (16 * second - first) / 15;
}

/* ---- strains ---- */

enum { MOST_NODES = 6, MOST_PLACES = 2 * MOST_NODES };

typedef struct strain {
  const char *name;
  double (*value)(const uint32_t *at, int n, const double *q, double reference, double *b);
  void (*bend)(const uint32_t *at, int n, const double *q, double t, double *h);
  int least, most; /* nodes */
} strain;

/* An arc of 0.3 m on a slope, as other strains are called. */
static double foot_value(const uint32_t *at, int n, const double *q, double reference, double *b) {
  (void)reference;
  return strut_strain_foot(at, n, q, 0.7, 0.3, b);
}
static void foot_bend(const uint32_t *at, int n, const double *q, double t, double *h) {
  strut_strain_foot_bend(at, n, q, 0.7, 0.3, t, h);
}

/* Guides of 0.05 m, the second to the right. */
static double wrap_value(const uint32_t *at, int n, const double *q, double reference, double *b) {
  (void)reference;
  return strut_strain_wrap(at, n, q, 4, 0.05, b);
}
static void wrap_bend(const uint32_t *at, int n, const double *q, double t, double *h) {
  strut_strain_wrap_bend(at, n, q, 4, 0.05, t, h);
}

static const strain strains[] = {
#define NODES_length 2, 2
#define NODES_path 2, MOST_NODES
#define NODES_angle 2, 3
#define NODES_area 3, MOST_NODES
#define NODES_reach 3, 3
#define NODES_along 2, 2
#define NODES_offset 3, 3
#define NODES_foot 2, 2
#define NODES_wrap 3, MOST_NODES
#define VALUES_TURN(name) strut_strain_##name, strut_strain_##name##_bend
#define VALUES_AXIS(name) strut_strain_##name, strut_strain_##name##_bend
#define VALUES_ARC(name) name##_value, name##_bend
#define STRAIN(NAME, name, unit, reference, ...) {#name, VALUES_##reference(name), NODES_##name},
    STRUT_STRAINS(STRAIN, )};
enum { STRAINS = sizeof strains / sizeof strains[0] };

static const uint32_t places[MOST_NODES] = {4, 0, 10, 2, 8, 6}; /* not in the order of the nodes */

/* Nodes about points of a zigzag, so that no two are near each other; now and then far from the origin. */
static void place_nodes(double *q, uint64_t *r) {
  double far = random_once_in(r, 4) ? 100.0 : 0.0;
  for (int k = 0; k < MOST_NODES; k++) {
    q[2 * k] = far + k + random_between(r, -0.4, 0.4);
    q[2 * k + 1] = k % 2 + random_between(r, -0.4, 0.4);
  }
}

/* Would some guide be touched or left if a node moved a little? */
static bool near_unwrapping(int n, double *q) {
  strut_wrap here, there;
  strut_strain_wrap_find(places, n, q, 4, 0.05, &here);
  for (int j = 0; j < 4 * n; j++) {
    double *x = &q[places[j / 4] + (uint32_t)(j / 2 % 2)], keep = *x;
    *x += j % 2 ? 4e-3 : -4e-3;
    strut_strain_wrap_find(places, n, q, 4, 0.05, &there);
    *x = keep;
    if (here.count != there.count ||
        memcmp(here.node, there.node, sizeof(int) * (size_t)here.count))
      return true;
  }
  return false;
}

/* Would the nearest point of the segment change from beside it to one of its ends? */
static bool near_end(const strain *s, int n, double *q) {
  if (s->value == wrap_value) return near_unwrapping(n, q);
  if (s->value != strut_strain_reach) return false;
  strut_reach to = strut_reach_of(places, q);
  double w2 = to.length * to.length;
  double along = ((q[places[0]] - q[places[1]]) * (q[places[2]] - q[places[1]]) +
                  (q[places[0] + 1] - q[places[1] + 1]) * (q[places[2] + 1] - q[places[1] + 1])) /
                 w2;
  return fabs(along) < 0.02 || fabs(along - 1.0) < 0.02 || to.distance < 0.3;
}

static void strain_slopes(const strain *s, int n, double *q, uint32_t at, double h, double *value,
                          double *b) {
  double up[MOST_PLACES] = {0}, down[MOST_PLACES] = {0}, keep = q[at];
  q[at] = keep + h;
  double high = s->value(places, n, q, 0.3, up);
  q[at] = keep - h;
  double low = s->value(places, n, q, 0.3, down);
  q[at] = keep;
  *value = (high - low) / (2 * h);
  for (int i = 0; i < 2 * n; i++) b[i] = (up[i] - down[i]) / (2 * h);
}

static void check_strain(const strain *s, int n, double *q, uint64_t *r) {
  double b[MOST_PLACES], bend[MOST_PLACES * MOST_PLACES] = {0}, t = random_between(r, -3, 3);
  int side = 2 * n;
  for (int i = 0; i < side * side; i++) bend[i] = 0.5; /* it adds */
  s->value(places, n, q, 0.3, b);
  s->bend(places, n, q, t, bend);
  for (int j = 0; j < side; j++) {
    double value[3], slope[3][MOST_PLACES];
    for (int k = 0; k < 3; k++)
      strain_slopes(s, n, q, places[j / 2] + (uint32_t)(j % 2), ldexp(2e-3, -k), &value[k],
                    slope[k]);
    assert_near(b[j], extrapolated(value[0], value[1], value[2]), 1e-9);
    for (int i = 0; i < side; i++) {
      double d = extrapolated(slope[0][i], slope[1][i], slope[2][i]);
      assert_near(bend[i * side + j] - 0.5, t * d, 1e-9 * (1 + fabs(t)));
      assert_near(bend[i * side + j], bend[j * side + i], 1e-14);
    }
  }
}

TEST(gradients_and_second_derivatives_of_strains) {
  uint64_t r = 11;
  for (int k = 0; k < STRAINS; k++)
    for (int pass = 0; pass < 200; pass++) {
      const strain *s = &strains[k];
      double q[MOST_PLACES];
      int n = s->least + random_below(&r, s->most - s->least + 1);
      place_nodes(q, &r);
      if (near_end(s, n, q)) continue;
      check_strain(s, n, q, &r);
    }
}

/* A gradient has no part along a shift, nor along a turn, but for a distance along a direction in space; that of a
   foot is one of a line in space. */
TEST(strains_do_not_feel_a_shift_or_a_turn) {
  uint64_t r = 12;
  for (int k = 0; k < STRAINS; k++)
    for (int pass = 0; pass < 100; pass++) {
      const strain *s = &strains[k];
      if (s->value == foot_value) continue;
      double q[MOST_PLACES], b[MOST_PLACES], x = 0, y = 0, turn = 0;
      int n = s->least + random_below(&r, s->most - s->least + 1);
      place_nodes(q, &r);
      s->value(places, n, q, 0, b);
      for (int i = 0; i < n; i++) {
        const double *at = q + places[i];
        x += b[2 * i], y += b[2 * i + 1], turn += b[2 * i + 1] * at[0] - b[2 * i] * at[1];
      }
      assert_all_near(1e-13, x, 0, y, 0);
      double expected = s->value == strut_strain_angle && n == 2; /* a direction turns along */
      if (s->value != strut_strain_along) assert_near(turn, expected, 1e-11);
    }
}

TEST(strains_of_known_figures) {
  const double q[] = {0, 0, 4, 0, 4, 3, 0, 3};
  const uint32_t ring[] = {0, 2, 4, 6, 0}, back[] = {6, 4, 2, 0}, corner[] = {4, 0, 2};
  const uint32_t beside[] = {6, 0, 2}, beyond[] = {4, 0, 6};
  double b[MOST_PLACES];
  assert_near(strut_strain_path(ring, 5, q, 0, b), 14, 1e-15);
  assert_near(strut_strain_length(ring, 2, q, 0, b), 4, 1e-15);
  assert_near(strut_strain_area(ring, 4, q, 0, b), 12, 1e-15);
  assert_near(strut_strain_area(back, 4, q, 0, b), -12, 1e-15);
  assert_near(strut_strain_angle(corner, 3, q, 0, b), -atan(0.75), 1e-15);
  assert_near(strut_strain_angle(corner, 3, q, 12, b), 2 * STRUT_TAU - atan(0.75), 1e-14);
  assert_near(strut_strain_reach(beside, 3, q, 0, b), 3, 1e-15);
  assert_near(strut_strain_reach(beyond, 3, q, 0, b), 4, 1e-15);
  assert_near(strut_strain_offset(beside, 3, q, 0, b), 3, 1e-15);
  assert_near(strut_strain_offset(beyond, 3, q, 0, b), -4, 1e-15);
  assert_near(strut_strain_along(beyond, 2, q, 0, b), -4, 0);           /* along x */
  assert_near(strut_strain_along(beyond, 2, q, 1, b), -3, 0);           /* along y */
  assert_near(strut_strain_along(beyond, 2, q, 1.0 / 3, b), -5, 1e-15); /* along (4, 3) / 5 */
}

/* Half round a circle, as over Atwood's pulley; from below one to above another; and past one that it does not touch. */
TEST(cables_over_circles_of_known_figures) {
  const double pulley[] = {-1, -3, 0, 0, 1, -5}, cross[] = {0, 1, 0, 0, 4, 0, 4, -1};
  const double past[] = {-2, 0, 0, -1.5, 2, 0};
  const uint32_t way[] = {0, 2, 4, 6};
  double b[8];
  assert_near(strut_strain_wrap(way, 3, pulley, 2, 1, b), 3 + 5 + STRUT_PI, 1e-14);
  assert_near(b[1], -1, 1e-15); /* up to the pulley */
  assert_near(b[3], 2, 1e-15);
  assert_near(strut_strain_wrap(way, 4, cross, 4, 0.5, b),
              2 * sqrt(0.75) + sqrt(15) + STRUT_TAU / 3 + asin(0.25), 1e-14);
  assert_near(strut_strain_wrap(way, 3, past, 2, 1, b), 4, 1e-15);
  assert_near(b[2], 0, 0);
  assert_near(strut_strain_wrap(way, 3, past, 2, 2, b), 2 * (1.5 + 2 * (atan(2 / 1.5) - acos(0.8))),
              1e-14);
}

/* Nodes in one place: no direction, but numbers. */
TEST(strains_without_a_direction_are_finite) {
  const double q[MOST_PLACES] = {0};
  for (int k = 0; k < STRAINS; k++) {
    double b[MOST_PLACES], h[MOST_PLACES * MOST_PLACES] = {0};
    int n = strains[k].most;
    assert_near(strains[k].value(places, n, q, 0, b), 0, 0);
    strains[k].bend(places, n, q, 1, h);
    bool directed = strains[k].value == strut_strain_along || strains[k].value == foot_value;
    for (int i = 0; i < 2 * n && !directed; i++) assert_near(b[i], 0, 0);
    for (int i = 0; i < 4 * n * n; i++) assert_true(isfinite(h[i]));
  }
}

/* ---- laws ---- */

/* A spring of that law between two nodes; its numbers belong to the model. */
typedef struct law_model {
  strut_scene scene;
  strut_model *model;
  const strut_element *element;
} law_model;

static void make_law(law_model *m, strut_law_kind kind, uint64_t *r) {
  strut_scene_init(&m->scene);
  build_support(&m->scene, 0, 0);
  build_mass(&m->scene, 1, 0, 1);
  int32_t j = build_member(&m->scene, STRUT_SPRING, 0, 1, random_between(r, 0.5, 5), 0, 0);
  strut_member *member = &m->scene.members[j];
  member->law = random_law(&m->scene, kind, 0.3, 0.3 * member->stiffness, r);
  if (kind == STRUT_LAW_LINEAR) member->law.carries = STRUT_CARRIES_COMPRESSION; /* an element */
  if (strut_law_at(kind)->own) member->stiffness = 0;
  m->model = motion_compile(&m->scene);
  m->element = m->model->elements.element;
  assert_int_equal(m->model->elements.count, 1);
}

static void free_law(law_model *m) {
  strut_model_free(m->model);
  strut_scene_free(&m->scene);
}

static strut_law_response respond(const strut_element *e, double x, double e0, int piece) {
  return strut_law_respond(e->law, &e->numbers, e0 + x, e0, piece);
}

static void check_slopes(const strut_element *e, double x, double e0, int piece) {
  strut_law_response at = respond(e, x, e0, piece);
  double force[3], slope[3];
  for (int k = 0; k < 3; k++) {
    double h = ldexp(1e-3, -k);
    strut_law_response up = respond(e, x + h, e0, piece), down = respond(e, x - h, e0, piece);
    force[k] = (up.energy - down.energy) / (2 * h);
    slope[k] = (up.force - down.force) / (2 * h);
  }
  double scale = 1 + fabs(at.force) + fabs(at.slope);
  assert_near(at.force, extrapolated(force[0], force[1], force[2]), 1e-9 * scale);
  assert_near(at.slope, extrapolated(slope[0], slope[1], slope[2]), 1e-9 * scale);
}

/* Is x near a place where the force is not smooth: a kink, or a point of a spline? */
static bool near_point(const strut_element *e, double x) {
  const strut_law_curve *c = e->law == STRUT_LAW_TABLE ? e->numbers.curve : NULL;
  for (int k = 0; k < strut_law_kinks(e->law, &e->numbers); k++)
    if (fabs(x - strut_law_kink(e->law, &e->numbers, k)) < 2e-3) return true;
  for (size_t k = 0; c && k < c->count; k++)
    if (fabs(x - c->x[k]) < 2e-3) return true;
  return false;
}

static void check_law(strut_law_kind kind, uint64_t *r) {
  law_model m = {0};
  make_law(&m, kind, r);
  const strut_element *e = m.element;
  int kinks = strut_law_kinks(e->law, &e->numbers);
  for (int pass = 0; pass < 40; pass++) {
    double x = random_between(r, -0.7, 0.9), e0 = random_between(r, 0.8, 1.2);
    if (kind == STRUT_LAW_TABLE && pass % 4 == 0) x *= 5; /* beyond the ends */
    if (!near_point(e, x)) check_slopes(e, x, e0, -1);
    /* a frozen piece gives the same bits on the piece, and is smooth beyond its ends */
    int piece = strut_law_piece(e->law, &e->numbers, e0 + x - e0);
    strut_law_response free = respond(e, x, e0, -1), frozen = respond(e, x, e0, piece);
    if (kinks) assert_near(frozen.force, free.force, 1e-14 * (1 + fabs(free.force)));
    if (kinks) assert_near(frozen.energy, free.energy, 1e-14 * (1 + fabs(free.energy)));
    for (int other = 0; other <= kinks && kinks; other++) check_slopes(e, x, e0, other);
  }
  for (int k = 0; k < kinks; k++) {
    double at = strut_law_kink(e->law, &e->numbers, k);
    strut_law_response left = respond(e, at, 0, k), right = respond(e, at, 0, k + 1);
    assert_near(left.force, right.force, 1e-14 * (1 + fabs(left.force)));
    assert_near(left.energy, right.energy, 1e-14 * (1 + fabs(left.energy)));
    if (k) assert_true(at > strut_law_kink(e->law, &e->numbers, k - 1));
    assert_int_equal(strut_law_piece(e->law, &e->numbers, at - 1e-9), k);
    assert_int_equal(strut_law_piece(e->law, &e->numbers, at + 1e-9), k + 1);
  }
  assert_near(respond(e, 0, 1, -1).energy, 0, 1e-16);
  if (kind != STRUT_LAW_PLAY)
    assert_relative(respond(e, 0, 1, -1).slope, e->numbers.stiffness, 1e-14);
  free_law(&m);
}

TEST(force_is_the_slope_of_the_energy) {
  uint64_t r = 21;
  for (int kind = 0; kind < STRUT_MEMBER_LAW_COUNT; kind++)
    for (int pass = 0; pass < 20; pass++) check_law((strut_law_kind)kind, &r);
}

/* EA over the natural strain: force and work of the drive are the slopes of the energy, over e and over e0. */
TEST(a_stiffness_that_follows_the_length) {
  static const strut_law_kind materials[] = {STRUT_LAW_LINEAR, STRUT_LAW_BILINEAR, STRUT_LAW_PLAY,
                                             STRUT_LAW_LOGARITHMIC, STRUT_LAW_EXPONENTIAL};
  for (size_t k = 0; k < sizeof materials / sizeof *materials; k++)
    for (double e0 = 0.3; e0 < 3; e0 *= 1.3)
      for (double x = -0.21; x < 0.5; x += 0.0973) {
        const double h = 1e-5;
        strut_law_numbers n = {.axial = 8, .material = materials[k], .stiffness = 4};
        n.knee = n.gap = 0.1, n.scale = 0.5, n.second_stiffness = k == 1 ? 3 : 0;
        strut_law_response at = strut_law_respond(STRUT_LAW_AXIAL, &n, e0 + x, e0, -1), r[4];
        for (int i = 0; i < 4; i++)
          r[i] = strut_law_respond(STRUT_LAW_AXIAL, &n, e0 + x + (i < 2 ? (2 * i - 1) * h : 0),
                                   e0 + (i < 2 ? 0 : (2 * i - 5) * h), -1);
        assert_near(at.force, (r[1].energy - r[0].energy) / (2 * h), 1e-7);
        assert_near(at.excess - at.force, (r[3].energy - r[2].energy) / (2 * h), 1e-7);
        n.stiffness = 8 / e0; /* as the law alone has it at that length */
        assert_near(at.force, strut_law_respond(materials[k], &n, e0 + x, e0, -1).force, 0);
      }
  /* down to a millionth of the first length, and straight on below */
  strut_law_numbers n = {.axial = 8, .material = STRUT_LAW_LINEAR, .stiffness = 4};
  assert_relative(strut_law_respond(STRUT_LAW_AXIAL, &n, 1, 1e-3, -1).slope, 8e3, 1e-15);
  assert_relative(strut_law_respond(STRUT_LAW_AXIAL, &n, 1, -1, -1).slope, 8 / 2e-6, 1e-12);
  assert_near(strut_law_respond(STRUT_LAW_AXIAL, &n, 1, -1, -1).excess, 0, 0);
}

/* Energies of small strains, as series; and what a change of the natural strain does to them. */
TEST(energies_of_small_strains_keep_their_digits) {
  const strut_law_numbers n = {.stiffness = 4, .scale = 0.5};
  for (double u = 1e-9; u < 0.2; u *= 1.5)
    for (int sign = -1; sign <= 1; sign += 2) {
      double x = sign * u, e0 = 2, h = 1e-4;
      long double w = sign * (long double)u, grown = expm1l(w / 0.5L) - w / 0.5L;
      long double part = w / 2, rest = (1 + part) * log1pl(part) - part;
      if (u < 1e-3) { /* where even these lose digits */
        long double v = w / 0.5L;
        grown = v * v / 2 * (1 + v / 3 * (1 + v / 4 * (1 + v / 5 * (1 + v / 6))));
        rest = part * part *
               (0.5L - part * (1 / 6.0L - part * (1 / 12.0L - part * (0.05L - part / 30))));
      }
      strut_law_response exponential = strut_law_respond(STRUT_LAW_EXPONENTIAL, &n, 2 + x, 2, -1);
      strut_law_response logarithmic = strut_law_respond(STRUT_LAW_LOGARITHMIC, &n, 2 + x, 2, -1);
      double blur = 2e-16 / u + 1e-14; /* of the strain itself */
      assert_relative(exponential.energy, (double)grown, 4 * blur);
      assert_relative(logarithmic.energy, (double)(16 * rest), 4 * blur);
      if (u < 0.01) continue;
      double up = strut_law_respond(STRUT_LAW_LOGARITHMIC, &n, e0 + x, e0 + h, -1).energy;
      double down = strut_law_respond(STRUT_LAW_LOGARITHMIC, &n, e0 + x, e0 - h, -1).energy;
      assert_near(logarithmic.excess - logarithmic.force, (up - down) / (2 * h), 1e-8);
    }
}

/* A spline is smooth at its points, keeps to the range of two neighbours, and is straight on beyond. */
TEST(a_smooth_table_has_no_kinks_and_does_not_overshoot) {
  const double x[] = {-2, -1, 0, 1, 1.5, 3}, y[] = {-1, -1, 0, 4, 4, 5};
  law_model m = {0};
  strut_scene_init(&m.scene);
  build_support(&m.scene, 0, 0);
  build_mass(&m.scene, 5, 0, 1);
  int32_t j = build_member(&m.scene, STRUT_SPRING, 0, 1, 0, 0, 0);
  m.scene.members[j].law =
      (strut_law){.kind = STRUT_LAW_TABLE, .count = 6, .smooth = true, .x = x, .force = y};
  m.model = motion_compile(&m.scene);
  m.element = m.model->elements.element;
  assert_int_equal(strut_law_kinks(m.element->law, &m.element->numbers), 0);
  for (int k = 0; k < 6; k++) {
    strut_law_response left = respond(m.element, x[k] - 1e-9, 0, -1);
    strut_law_response right = respond(m.element, x[k] + 1e-9, 0, -1);
    assert_near(respond(m.element, x[k], 0, -1).force, y[k], 1e-15);
    assert_all_near(1e-7, left.slope, right.slope, left.force, right.force);
    assert_near(left.energy, right.energy, 1e-7);
    for (double at = x[k]; k < 5 && at <= x[k + 1]; at += 0.01)
      assert_within(respond(m.element, at, 0, -1).force, y[k] - 1e-14, y[k + 1] + 1e-14);
  }
  strut_law_response end = respond(m.element, 3, 0, -1), out = respond(m.element, 7, 0, -1);
  assert_near(out.force, end.force + 4 * end.slope, 1e-14);
  assert_near(out.energy, end.energy + 4 * end.force + 8 * end.slope, 1e-13);
  free_law(&m);
}

static strut_status compile_and_stand(const strut_scene *scene) {
  OWN_POINTER(strut_model) model = NULL;
  OWN_POINTER(strut_state) state = NULL;
  strut_status status = strut_model_compile(scene, &model, NULL);
  return status == STRUT_OK ? strut_state_create(model, &state, NULL) : status;
}

/* A refusal of memory at any place is passed on. */
TEST(refused_memory) {
  OWN(strut_scene) scene;
  random_elements(&scene, 3, 1);
  REFUSE_EACH(n, status, 1) status = refused(n, compile_and_stand(&scene));
}

/* In all directions and beside the axes, against the library's, to four units in the last place. */
TEST(directions_are_those_of_atan2) {
  const double tiny[] = {0.0, 5e-324, 1e-300, 1e-17, 1e-9, 1e-3};
  for (int i = 0; i < 200000; i++) {
    double angle = STRUT_TAU * (i / 200000.0 - 0.5) + 1e-6, size = pow(10.0, i % 7 - 3);
    double x = size * cos(angle), y = size * sin(angle), expected = atan2(y, x);
    double found = strut_law_direction_of(x, y);
    assert_true(fabs(found - expected) <= 4 * DBL_EPSILON * fmax(fabs(expected), 1e-300));
  }
  for (size_t i = 0; i < sizeof tiny / sizeof tiny[0]; i++)
    for (int sign = -1; sign <= 1; sign += 2) {
      double x = sign, y = tiny[i];
      assert_near(strut_law_direction_of(x, y), atan2(y, x), 1e-15);
      assert_near(strut_law_direction_of(y, x), atan2(x, y), 1e-15);
    }
  assert_true(strut_law_direction_of(0.0, 0.0) == 0.0);
}

/* Hinges are stepped four at a time: the forces of seven are those of each alone, to the bit. */
TEST(hinges_in_vectors_have_the_forces_of_single_ones) {
  enum { HINGES = 7 };
  double together[2 * (HINGES + 2)], alone[2 * (HINGES + 2)] = {0};
  for (int only = -1; only < HINGES; only++) {
    OWN(strut_scene) scene = build_scene();
    OWN_POINTER(strut_model) model = NULL;
    OWN_POINTER(strut_state) state = NULL;
    for (int i = 0; i < HINGES + 2; i++) build_mass(&scene, 0.1 * i, 0.03 * (i * i % 5), 1);
    for (int i = 0; i < HINGES; i++) {
      if (only >= 0 && only != i) continue;
      int32_t h = build_hinge(&scene, i, i + 1, i + 2, 0.3 + 0.1 * i, i % 2 ? 0.02 : 0.0);
      scene.hinges[h].rest_angle = 2.5 + 0.2 * i;
    }
    assert_ok(strut_model_compile(&scene, &model, NULL));
    assert_ok(strut_state_create(model, &state, NULL));
    for (int i = 0; i < 2 * (HINGES + 2); i++) state->v[i] = sin(1.0 + i);
    strut_forces_evaluate(model, state, 0.0, state->q, state->v);
    for (int i = 0; i < 2 * (HINGES + 2); i++)
      if (only < 0)
        together[i] = state->latest->force[i];
      else
        alone[i] += state->latest->force[i];
  }
  for (int i = 0; i < 2 * (HINGES + 2); i++) assert_true(alone[i] == together[i]);
}

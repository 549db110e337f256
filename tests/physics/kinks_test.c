/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What is measured where expressions have kinks, and where a target is hardly reached or hardly missed: two
 * oscillators without damping, whose exact motions are cosines.
 */

#include "engine/run/accuracy/accuracy.h"
#include "engine/run/measure/measure.h"
#include "tests/models/run_model.h"
#include "tests/support/motion.h"

/* Runs to the accuracy that is asked for; free the setup too. */
static strut_summary run_as_asked(model_run read, strut_setup *setup) {
  strut_summary s;
  *setup = read.setup;
  OWN_POINTER(strut_model) model = motion_compile(&setup->scene);
  assert_ok(strut_simulate_as_asked(model, &setup->experiment, &(strut_run_options){0}, &s, NULL));
  return s;
}

/* Masses of 1 kg on springs from x = 0 to x = 1 m, elongated by `a` at the start. */
typedef struct two_oscillators {
  double k[2], a[2];
} two_oscillators;

typedef double value_at(const two_oscillators *o, double t);

static double force(const two_oscillators *o, int i, double t) {
  return o->k[i] * o->a[i] * cos(sqrt(o->k[i]) * t);
}

static double speed(const two_oscillators *o, int i, double t) {
  return -sqrt(o->k[i]) * o->a[i] * sin(sqrt(o->k[i]) * t);
}

static double largest(const two_oscillators *o, double t) {
  return fmax(fabs(force(o, 0, t)), fabs(force(o, 1, t)));
}

static double sum(const two_oscillators *o, double t) {
  return fabs(force(o, 0, t)) + fabs(force(o, 1, t));
}

static double faster(const two_oscillators *o, double t) {
  return fmax(speed(o, 0, t), speed(o, 1, t));
}

static double slower(const two_oscillators *o, double t) {
  return fmin(fabs(speed(o, 0, t)), fabs(speed(o, 1, t)));
}

static double kinetic(const two_oscillators *o, double t) {
  return 0.5 * (pow(speed(o, 0, t), 2) + pow(speed(o, 1, t), 2));
}

static double first_speed(const two_oscillators *o, double t) { return speed(o, 0, t); }

/* The same expressions; one of them with kinks that no word shows. */
static const struct expression {
  const char *text;
  value_at *at;
} expressions[] = {{"largest_force", largest},
                   {"abs(p.force) + abs(q.force)", sum},
                   {"sqrt(p.force^2) + sqrt(q.force^2)", sum},
                   {"max(b.vx, e.vx)", faster},
                   {"min(abs(b.vx), abs(e.vx))", slower},
                   {"energy.kinetic", kinetic},
                   {"b.vx", first_speed}};
enum { EXPRESSIONS = sizeof expressions / sizeof *expressions, FINE = 40000 };

/* The least (1) or greatest (-1) value, by a fine grid and ever finer ones about its best places. */
static double extreme(value_at *at, const two_oscillators *o, double from, double to, double sign,
                      int depth) {
  double best = HUGE_VAL, place = from, step = (to - from) / (depth ? 40 : FINE);
  for (int i = 0; i <= (depth ? 40 : FINE); i++) {
    double t = from + step * i, f = sign * at(o, t);
    if (f < best) best = f, place = t;
  }
  if (depth == 12) return sign * best;
  double inner = extreme(at, o, fmax(from, place - step), fmin(to, place + step), sign, depth + 1);
  return sign * fmin(best, sign * inner);
}

/* When the target is first passed; NAN: never. What a grid misses is told by its turns. */
static double arrival(value_at *at, const two_oscillators *o, double duration, double target) {
  double side = at(o, 0.0) > target ? 1.0 : -1.0, step = duration / FINE, low = 0.0, high = NAN;
  for (int i = 1; i <= FINE && isnan(high); i++) {
    double t = step * i;
    if (side * (at(o, t) - target) <= 0.0) {
      low = t - step, high = t;
    } else if (i > 1 && side * at(o, t - step) < side * at(o, t - 2 * step) + 0.0 &&
               side * at(o, t - step) <= side * at(o, t)) {
      double turn = extreme(at, o, t - 2 * step, t, side, 1);
      if (side * (turn - target) > 0.0) continue;
      for (double u = t - 2 * step; u <= t && isnan(high); u += 1e-4 * step)
        if (side * (at(o, u) - target) <= 0.0) low = u - 1e-4 * step, high = u;
    }
  }
  for (int i = 0; i < 60 && !isnan(high); i++) {
    double middle = 0.5 * (low + high);
    *(side * (at(o, middle) - target) <= 0.0 ? &high : &low) = middle;
  }
  return high;
}

static unsigned seed = 1;
static double random_between(double low, double high) {
  seed = seed * 1664525u + 1013904223u;
  return low + (high - low) * (seed >> 8) / 16777216.0;
}

static two_oscillators random_oscillators(void) {
  two_oscillators o;
  for (int i = 0; i < 2; i++) {
    o.k[i] = random_between(30, 400);
    o.a[i] = (random_between(0, 1) < 0.5 ? -1 : 1) * random_between(0.003, 0.02);
  }
  return o;
}

static strut_summary run_two(const two_oscillators *o, const char *accuracy, double duration,
                             const char *quantities, strut_setup *setup) {
  return run_as_asked(
      model_read_format(
          "nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1, fixed: y},"
          " c: {position: [0, 1], fixed: both}, e: {position: [1, 1], mass: 1, fixed: y}}\n"
          "members: {p: {kind: spring, nodes: [a, b], stiffness: %.17g, rest_length: %.17g},"
          " q: {kind: spring, nodes: [c, e], stiffness: %.17g, rest_length: %.17g}}\n"
          "solver: {integrator: adaptive, step: 10 ms%s%s}\n"
          "run: {duration: %.17g, measure: {quantities: {%s}}}\n",
          o->k[0], 1.0 - o->a[0], o->k[1], 1.0 - o->a[1], accuracy[0] ? ", accuracy: " : "",
          accuracy, duration, quantities),
      setup);
}

/* Extremes at kinks and between samples are as exact as asked for, and as told. */
TEST(extremes_with_kinks) {
  static const char *const accuracies[] = {"", "2 %", "0.2 %", "0.01 %"};
  static const double wanted[] = {1e-3, 2e-2, 2e-3, 1e-4};
  static const char *const takes[] = {"min", "max"};
  int kept = 0, count = 0;
  for (int i = 0; i < 160; i++) {
    two_oscillators o = random_oscillators();
    const struct expression *x = &expressions[i % EXPRESSIONS];
    double duration = random_between(0.6, 3), sign = i / EXPRESSIONS % 2 ? -1 : 1;
    int a = i / (2 * EXPRESSIONS) % 4;
    char quantities[200];
    snprintf(quantities, sizeof quantities, "v: {of: \"%s\", take: %s}", x->text, takes[sign < 0]);
    OWN(strut_setup) setup;
    OWN(strut_summary) s = run_two(&o, accuracies[a], duration, quantities, &setup);
    const strut_measured *m = &s.measured[0];
    double right = extreme(x->at, &o, 0, duration, sign, 0), error = fabs(m->value - right);
    double allowed = wanted[a] * fmax(fabs(right), 1e-3 * m->scale);
    if (a && !s.accuracy.kept) continue;
    kept++, count += a > 0;
    if (!(error <= allowed) || (a && !(error <= 1.5 * m->expected + 2 * m->rounding)))
      fail_msg("%d: %s of %s, %s: %.9g, right is %.9g, told %.2g", i, takes[sign < 0], x->text,
               accuracies[a], m->value, right, m->expected);
  }
  assert_true(kept > 150 && count > 100);
}

/* A target within the error of the extreme that decides is not decided; what is told as certain is right. */
TEST(arrivals_that_graze) {
  int reached = 0, never = 0;
  for (int i = 0; i < 160; i++) {
    two_oscillators o = random_oscillators();
    const struct expression *x = &expressions[i % EXPRESSIONS];
    double duration = random_between(0.6, 3), side = i / EXPRESSIONS % 2 ? -1 : 1;
    double far = pow(10, random_between(-5, -2)) * (random_between(0, 1) < 0.5 ? -1 : 1);
    double low = extreme(x->at, &o, 0, duration, 1, 0);
    double high = extreme(x->at, &o, 0, duration, -1, 0);
    double target = (side > 0 ? low : high) + side * far * (high - low);
    char quantities[200];
    snprintf(quantities, sizeof quantities, "v: {of: \"%s\", take: arrival, target: %.17g}",
             x->text, target);
    OWN(strut_setup) setup;
    OWN(strut_summary) s = run_two(&o, i % 3 ? "1 %" : "0.1 %", duration, quantities, &setup);
    const strut_measured *m = &s.measured[0];
    double right = arrival(x->at, &o, duration, target);
    double wanted = i % 3 ? 1e-2 : 1e-3;
    const char *word = strut_measured_arrival(m);
    assert_true(m->kept == s.accuracy.kept);
    assert_int_equal(m->undecided, strcmp(word, "not decided") == 0);
    if (m->undecided) assert_true(strstr(s.accuracy.why, "not decided") && !m->kept);
    if (!m->kept) continue;
    bool good = isnan(right) ? isnan(m->value) : fabs(m->value - right) <= wanted * right + 1e-12;
    assert_string_equal(word, isnan(m->value) ? "never" : "reached");
    if (!good)
      fail_msg("%d: %s at %.17g: %.9g, right is %.9g", i, x->text, target, m->value, right);
    *(isnan(right) ? &never : &reached) += 1;
  }
  assert_true(reached > 50 && never > 50);
}

/* The least of two pulls, which a root has where one of them is 0, lies below the target between two steps. */
TEST(an_arrival_at_the_kink_of_a_root) {
  const two_oscillators o = {{102.5404721914456, 296.33626146264874},
                             {-0.00793031714, -0.0140540826}};
  static const char *const roots[] = {"sqrt(p.force^2) + sqrt(q.force^2)",
                                      "hypot(p.force, 0) + hypot(q.force, 0)",
                                      "sqrt(p.force*p.force) + sqrt(q.force*q.force)"};
  double right = arrival(sum, &o, 2.678, 75.586302e-3);
  for (int i = 0; i < 3; i++) {
    char quantities[120];
    snprintf(quantities, sizeof quantities, "v: {of: \"%s\", take: arrival, target: 75.586302 mN}",
             roots[i]);
    OWN(strut_setup) setup;
    OWN(strut_summary) s = run_two(&o, "1 %", 2.678, quantities, &setup);
    assert_near(s.measured[0].value, right, s.measured[0].expected);
  }
}

/* At the maximum to the last digit nobody knows. */
TEST(a_target_at_the_maximum) {
  const two_oscillators o = {{100, 50}, {0.01, 0.01}};
  static const char quantities[] =
      "v: {of: energy.kinetic - 0.5 * e.vx^2 * 1 kg, take: arrival,"
      " target: 5 mJ}, w: {of: b.x, take: min}";
  OWN(strut_setup) setup;
  OWN(strut_summary) s = run_two(&o, "1 %", 2, quantities, &setup);
  assert_true(s.measured[0].undecided && !s.measured[0].kept && !s.accuracy.kept);
  assert_true(isnan(s.accuracy.expected) && isnan(s.measured[0].expected));
  assert_string_equal(strut_measured_arrival(&s.measured[0]), "not decided");
  assert_true(s.measured[1].kept);
}

/* floor jumps: the mean and the moments of its steps. */
TEST(steps_of_an_expression) {
  const two_oscillators o = {{100, 50}, {0.01, 0.01}};
  static const char quantities[] =
      "up: {of: floor(10 * time / 1 s), take: mean}, at: {of: round(time / 1 s), take: arrival,"
      " target: 1}, most: {of: ceil(b.vx / (0.04 m/s)), take: max}";
  OWN(strut_setup) setup;
  OWN(strut_summary) s = run_two(&o, "", 1, quantities, &setup);
  assert_all_relative(1e-7, s.measured[0].value, 4.5, s.measured[1].value, 0.5);
  assert_near(s.measured[2].value, 3, 1e-12); /* 0.1 m/s */
}

static strut_summary run_linkage(const char *more, strut_setup *setup) {
  return run_as_asked(
      model_read_format(
          "gravity: [0, -9.81]\n"
          "bars: rigid\n"
          "groups: {r: {kind: bar, stiffness: 1e8}}\n"
          "nodes: {o: {position: [0, 0], fixed: both}, m: {position: [0.5, sin(60 deg)], mass: "
          "0.1},"
          " a: {position: [1, 0], fixed: y, mass: 0.5}, b: {position: [0, 2*sin(60 deg)], mass: 1},"
          " c: {position: [0.9, 1.4], mass: 0.01}}\n"
          "members: {om: {group: r, nodes: [o, m]}, am: {group: r, nodes: [a, m]},"
          " mb: {group: r, nodes: [m, b]}, ac: {group: r, nodes: [a, c]},"
          " bc: {group: r, nodes: [b, c]}, mc: {group: r, nodes: [m, c]}}\n"
          "solver: {accuracy: 0.1 %%}\n"
          "run: {duration: 0.3 s, measure: {quantities: {y: {of: b.y, take: final}%s}}}\n",
          more),
      setup);
}

/* A straight-line linkage: a range of exactly zero is rounding, is kept and costs nothing. */
TEST(a_range_of_zero) {
  OWN(strut_setup) plain, setup;
  OWN(strut_summary) without = run_linkage("", &plain);
  OWN(strut_summary) s =
      run_linkage(", x: {of: b.x, take: range}, still: {of: o.y, take: range}", &setup);
  assert_true(without.accuracy.kept && s.accuracy.kept && s.accuracy.expected < 1e-3);
  for (int i = 0; i < 3; i++) assert_true(s.measured[i].kept);
  assert_true(s.measured[1].zero && s.measured[2].zero && s.measured[1].expected < 1e-12);
  assert_int_equal(s.spent.evaluations, without.spent.evaluations);
  assert_int_equal(s.accuracy.check_evaluations, without.accuracy.check_evaluations);
}

/* Energy from nothing is not certified, nor is a balance that is no number. */
TEST(an_open_balance_is_not_kept) {
  strut_accuracy a = {.target = 0.05};
  strut_energy e = {.initial = 1, .residual = 0.03, .moved = 1};
  strut_summary s = {.balance = strut_balance_judge(&e, 100), .energy = e};
  assert_int_equal(s.balance, STRUT_BALANCE_OPEN);
  assert_false(strut_accuracy_balance_is_open(&a, &s)); /* 5 % explain 3 % */
  a.target = 0.01;
  assert_true(strut_accuracy_balance_is_open(&a, &s));
  e.residual = (double)NAN;
  assert_int_equal(strut_balance_judge(&e, 100), STRUT_BALANCE_OPEN);
  e.residual = 0.009;
  assert_int_equal(strut_balance_judge(&e, 100), STRUT_BALANCE_CLOSED);
}

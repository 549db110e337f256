/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How fast two double rod pendulums part that began 1e-9 apart: strut's, of stiff bars and of rigid
 * ones, against the two equations of motion in the angles, integrated here by themselves (Benettin's
 * method).
 */
#include "tests/support/structures.h"

static const double G = 9.81, APART = 1e-9;
static int ensembles = 1;

/* Angles a, b from below and their rates, of two rods of 1 m and 1 kg each. */
typedef struct angles {
  double y[4];
} angles;

/*
 * (4/3) a'' + (1/2) (cos(a-b) b'' + sin(a-b) b'^2) + (3/2) g sin a = 0
 * (1/3) b'' + (1/2) (cos(a-b) a'' - sin(a-b) a'^2) + (1/2) g sin b = 0
 */
static angles rate(angles s) {
  double c = 0.5 * cos(s.y[0] - s.y[1]), d = 0.5 * sin(s.y[0] - s.y[1]);
  double p = -d * s.y[3] * s.y[3] - 1.5 * G * sin(s.y[0]);
  double q = d * s.y[2] * s.y[2] - 0.5 * G * sin(s.y[1]);
  double det = 4.0 / 9 - c * c;
  return (angles){{s.y[2], s.y[3], (p / 3 - c * q) / det, (4.0 / 3 * q - c * p) / det}};
}

static angles moved(angles s, double h, angles k) {
  for (int i = 0; i < 4; i++) s.y[i] += h * k.y[i];
  return s;
}

static angles advance(angles s, double h) {
  angles k1 = rate(s), k2 = rate(moved(s, h / 2, k1)), k3 = rate(moved(s, h / 2, k2));
  angles k4 = rate(moved(s, h, k3));
  for (int i = 0; i < 4; i++) s.y[i] += h / 6 * (k1.y[i] + 2 * (k2.y[i] + k3.y[i]) + k4.y[i]);
  return s;
}

static double between(angles s, angles t) {
  double sum = 0;
  for (int i = 0; i < 4; i++) sum += (s.y[i] - t.y[i]) * (s.y[i] - t.y[i]) / (i < 2 ? 1 : G);
  return sqrt(sum);
}

/* ln of the growth over `seconds`: two orbits, brought back to APART every tenth of a second. */
static double benettin(double a, double b, double seconds) {
  angles s = {{a, b, 0, 0}}, t = {{a + APART, b, 0, 0}};
  double sum = 0, h = 1e-4;
  for (int part = 0; part < (int)lround(10 * seconds); part++) {
    for (int n = 0; n < 1000; n++) s = advance(s, h), t = advance(t, h);
    double apart = between(s, t);
    sum += log(apart / APART);
    for (int i = 0; i < 4; i++) t.y[i] = s.y[i] + (t.y[i] - s.y[i]) * APART / apart;
  }
  return sum;
}

static angles angles_of(const motion *m) {
  const double *q = m->state->q, *v = m->state->v;
  double x = q[4] - q[2], y = q[5] - q[3], u = v[4] - v[2], w = v[5] - v[3];
  return (angles){{atan2(q[2], -q[3]), atan2(x, -y),
                   (q[2] * v[3] - q[3] * v[2]) / (q[2] * q[2] + q[3] * q[3]),
                   (x * w - y * u) / (x * x + y * y)}};
}

/* ln of the growth of the distance between two runs of the engine. */
static double parted(double a, double b, double seconds, strut_bar_model bars) {
  strut_scene scene[2];
  motion m[2];
  /* bars of 1e9 N/m: their limit is 1.1e-5 s */
  const double step = bars == STRUT_BARS_RIGID ? 1e-3 : 1e-5;
  for (int k = 0; k < 2; k++) {
    strut_scene_init(&scene[k]);
    scene[k].bar_model = bars;
    structure_pendulum(&scene[k], 1e9, k ? a + APART : a, true, b);
    m[k] = motion_begin(&scene[k], step);
    motion_steps(&m[k], llround(seconds / step));
  }
  double apart = between(angles_of(&m[0]), angles_of(&m[1]));
  for (int k = 0; k < 2; k++) {
    motion_free(&m[k]);
    strut_scene_free(&scene[k]);
  }
  return log(apart / APART);
}

static void check_separation(strut_bar_model bars, const char *name) {
  const double seconds = 3;
  double ours = 0, theirs = 0;
  int count = 8 * ensembles;
  for (int k = 0; k < count; k++) {
    double a = 1.9 + 0.9 * k / count, b = 2.2 + 0.7 * k / count;
    ours += parted(a, b, seconds, bars), theirs += benettin(a, b, seconds);
  }
  double lambda = ours / (seconds * count), expected = theirs / (seconds * count);
  print_message("%s bars: two runs part by a factor e in %.4f s, Benettin's method: %.4f s\n", name,
                1 / lambda, 1 / expected);
  print_message("a rounding error of 1e-16 is 1e-3 after %.0f s\n", log(1e13) / lambda);
  assert_true(expected > 1); /* it is chaos */
  assert_relative(lambda, expected, 0.05);
}

BEFORE_ALL { ensembles = (int)test_number(1, ensembles); }

TEST(separation_of_stiff_bars) { check_separation(STRUT_BARS_ELASTIC, "stiff"); }

TEST(separation_of_rigid_bars) { check_separation(STRUT_BARS_RIGID, "rigid"); }

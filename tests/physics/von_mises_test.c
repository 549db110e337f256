/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The dynamic threshold of von Mises' truss: a load put on at once, a part in a thousand either way. */
#include <math.h>

#include "tests/support/build.h"
#include "tests/support/check.h"
#include "tests/support/motion.h"

static const double HALF_SPAN = 5, HEIGHT = 1, AXIAL = 1280e6;

/* A load put on at once carries the apex to y if its work there is the energy of the bars. */
static double load_to(double y) {
  double rest = hypot(HALF_SPAN, HEIGHT), length = hypot(HALF_SPAN, y), k = AXIAL / rest;
  return k * (rest - length) * (rest - length) / (HEIGHT - y);
}

/* The largest of these. */
static double threshold(void) {
  double low = 0, high = HEIGHT;
  for (int i = 0; i < 200; i++) {
    double a = low + (high - low) / 3, b = high - (high - low) / 3;
    if (load_to(a) < load_to(b))
      low = a;
    else
      high = b;
  }
  return load_to(low);
}

/* The lowest that the apex comes under a load put on at once, in the model's own simulation. */
static double lowest(double load, double mass, double duration) {
  strut_scene scene;
  strut_scene_init(&scene);
  int32_t left = build_support(&scene, -HALF_SPAN, 0), right = build_support(&scene, HALF_SPAN, 0);
  int32_t apex = build_mass(&scene, 0, HEIGHT, mass);
  build_member(&scene, STRUT_BAR, apex, left, 1, 0, 0);
  build_member(&scene, STRUT_BAR, apex, right, 1, 0, 0);
  for (int i = 0; i < 2; i++)
    scene.members[i].stiffness = 0, scene.members[i].axial_stiffness = AXIAL;
  build_load(&scene, apex, 0, -load, -1);
  motion m;
  double bottom = HEIGHT, step = 0.02 * sqrt(mass * hypot(HALF_SPAN, HEIGHT) / AXIAL);
  motion_begin(&m, &scene, step);
  for (int64_t i = 0; i < (int64_t)(duration / step); i++) {
    motion_steps(&m, 1);
    bottom = fmin(bottom, m.state->q[2 * apex + 1]);
  }
  assert_near(m.state->q[2 * apex], 0, 1e-9);
  motion_end(&m);
  strut_scene_free(&scene);
  return bottom;
}

TEST(step_load) {
  double limit = threshold();
  assert_near(limit, 2910.77e3, 0.005e3);
  /* the slow passage of the top takes a few of the 10 ms periods at 100 kg */
  assert_true(lowest(0.999 * limit, 100, 0.5) > 0);
  assert_true(lowest(1.001 * limit, 100, 0.5) < -HEIGHT);
}

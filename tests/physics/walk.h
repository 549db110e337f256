/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A scene's model and its path of equilibria; whatever fails, fails the test.
 */
#pragma once

#include "engine/statics/path/path.h"
#include "tests/support/motion.h"

typedef struct walk {
  strut_model *model;
  strut_path path;
} walk;

static inline walk walk_by(const strut_setup *setup, strut_path_options options) {
  walk w = {.model = motion_compile(&setup->scene)};
  strut_error error = {0};
  strut_status status = strut_path_follow(w.model, &setup->experiment, &options, &w.path, &error);
  if (status) print_error("%s\n", error.message);
  assert_int_equal(status, STRUT_OK);
  return w;
}

static inline walk walk_until(const strut_setup *setup, double until) {
  return walk_by(setup, (strut_path_options){.until = until});
}

static inline void walk_free(walk *w) {
  strut_path_free(&w->path);
  strut_model_free(w->model);
}

/** Von Mises' truss: supports at (-+a, 0), then the apex at (0, h). */
static inline strut_setup arch(double a, double h, double k) {
  strut_setup setup = build_setup();
  int32_t left = build_support(&setup.scene, -a, 0), right = build_support(&setup.scene, a, 0);
  int32_t apex = build_node(&setup.scene, 0, h);
  build_member(&setup.scene, STRUT_BAR, apex, left, k, 0, 0);
  build_member(&setup.scene, STRUT_BAR, apex, right, k, 0, 0);
  return setup;
}

/** What holds its apex at y, downwards. */
static inline double arch_load(double a, double h, double k, double y) {
  return 2 * k * y * (hypot(a, h) / hypot(a, y) - 1);
}

static inline size_t walk_count(const strut_path *path, strut_path_event_kind kind) {
  size_t sum = 0;
  for (size_t i = 0; i < path->event_count; i++) sum += path->events[i].kind == kind;
  return sum;
}

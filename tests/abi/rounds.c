/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens, runs and closes again and again, for valgrind: abi_rounds COUNT. */
#include <stdio.h>
#include <stdlib.h>
#include <strut/abi.h>
#include <unistd.h>

#include "tests/abi/triangle.h"

static const char text[] = TRIANGLE("2 ms", "");

static int failed(strutlib_error *error) {
  fprintf(stderr, "%s", strutlib_error_report(error));
  strutlib_error_free(error);
  return 1;
}

static int simulate(const strutlib_scene *scene) {
  strutlib_error *error;
  double *rest;
  const double *force;
  int dimensions, wrong = 0;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS];
  strutlib_simulation *s = strutlib_simulation_open(scene, 0, NULL, NULL, NULL, &error);
  if (!s) return failed(error);
  strutlib_simulation_array(s, "force", &force, &dimensions, shape, stride);
  strutlib_simulation_input(s, "rest", &rest, &dimensions, shape, stride);
  strutlib_snapshot *snapshot = strutlib_simulation_snapshot(s, &error);
  rest[1] *= 1.01;
  if (strutlib_simulation_advance(s, 10, &error) != STRUTLIB_OK) wrong = failed(error);
  strutlib_simulation_restore(s, snapshot, NULL);
  strutlib_snapshot_free(snapshot);
  strutlib_simulation_close(s);
  return wrong;
}

static int write_file(const char *name, const char *content) {
  FILE *file = fopen(name, "w");
  if (!file || fputs(content, file) < 0) return 1;
  return fclose(file) != 0;
}

/* A study by file, and one that is refused; both in a folder of their own, which is the current one. */
static int compute_study(void) {
  static const char head[] = "strut: 1\nstudy: two\nmodel: model.yaml\n";
  char folder[] = "/tmp/strut-rounds-XXXXXX", study[200], command[80];
  strutlib_error *error;
  if (!mkdtemp(folder) || chdir(folder) || write_file("model.yaml", text)) return 1;
  snprintf(study, sizeof study, "%saxes: [{drop: [10 mm, 20 mm]}]\n", head);
  if (write_file("study.yaml", study)) return 1;
  snprintf(study, sizeof study, "%saxes: [{drip: [10 mm]}]\nkeep: [odd]\n", head);
  if (write_file("wrong.yaml", study)) return 1;
  strutlib_result *result =
      strutlib_study("study.yaml", "out", 0, NULL, NULL, 0, NULL, NULL, NULL, &error);
  if (!result) return failed(error);
  strutlib_result_free(result);
  if (strutlib_study("wrong.yaml", "out", 0, NULL, NULL, 0, NULL, NULL, NULL, &error)) return 1;
  strutlib_error_free(error);
  snprintf(command, sizeof command, "rm -rf %s", folder);
  return chdir("/") || system(command);
}

/* One scene with everything that is quick, and a text that is refused. */
static int go_round(void) {
  static const char wrong[] = "strut: 1\nnodes: {a: [0, 0], a: [1, 0]}\n";
  const char *names[] = {"drop"}, *values[] = {"30 mm"}, *axes[] = {"drop"};
  const double points[] = {0.01, 0.02};
  strutlib_error *error;
  strutlib_scene *scene =
      strutlib_open_text("round", text, sizeof text - 1, 1, names, values, &error);
  if (!scene) return failed(error);
  strutlib_result *result = strutlib_run(scene, 0, NULL, NULL, NULL, &error);
  if (!result) return failed(error);
  double velocity;
  strutlib_result_number(result, "velocity", &velocity);
  strutlib_result_free(result);
  result = strutlib_rigidity(scene, 0, NULL, NULL, NULL, &error);
  if (!result) return failed(error);
  strutlib_result_free(result);
  result = strutlib_sweep(scene, 1, axes, 2, points, NULL, 0, NULL, 0, NULL, NULL, NULL, NULL, NULL,
                          &error);
  if (!result) return failed(error);
  strutlib_result_free(result);
  if (strutlib_open_text("wrong", wrong, sizeof wrong - 1, 0, NULL, NULL, &error)) return 1;
  strutlib_error_free(error);
  int bad = simulate(scene) || compute_study();
  strutlib_close(scene);
  return bad;
}

int main(int count, char **arguments) {
  int rounds = count == 2 ? atoi(arguments[1]) : 1;
  for (int i = 0; i < rounds; i++)
    if (go_round()) return 1;
  return 0;
}

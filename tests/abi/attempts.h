/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A round of everything that is quick, each with its answer or an error: where memory fails, and under valgrind.
 */
#pragma once

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "parser/bindings/abi/abi.h"
#include "tests/abi/triangle.h"

static const char text[] = TRIANGLE("2 ms", "");

/* Whether it was good; an answer that is an error is in *error. */
typedef bool (*attempt)(strutlib_scene *scene, strutlib_error **error);

static bool open_text(strutlib_scene *scene, strutlib_error **error) {
  (void)scene;
  const char *names[] = {"drop"}, *values[] = {"30 mm"};
  strutlib_scene *own =
      strutlib_open_text("memory", text, sizeof text - 1, 1, names, values, error);
  strutlib_close(own);
  return own != NULL;
}

/* A text that is wrong in two places: the error itself takes memory. */
static bool open_wrong(strutlib_scene *scene, strutlib_error **error) {
  static const char wrong[] = "strut: 1\nnodes: {a: [0, 0]}\nmembers: {m: {nodes: [a, q]}}\n";
  (void)scene;
  return !strutlib_open_text("wrong", wrong, sizeof wrong - 1, 0, NULL, NULL, error) && *error &&
         strutlib_error_status(*error) == STRUTLIB_BAD_SCENE && strutlib_error_count(*error) > 0;
}

static bool show_scene(strutlib_scene *scene, strutlib_error **error) {
  const char *names[] = {"drop"}, *values[] = {"30 mm"};
  strutlib_scene *other = strutlib_scene_with(scene, 1, names, values, error);
  char *json = other ? strutlib_scene_json(other, error) : NULL;
  char *yaml = json ? strutlib_scene_yaml(other, 0, error) : NULL;
  char *parts = yaml ? strutlib_scene_yaml(other, 1, error) : NULL;
  strutlib_release(json);
  strutlib_release(yaml);
  strutlib_release(parts);
  strutlib_close(other);
  return parts != NULL;
}

static char rest[1000]; /* of a run's table, whose cost is above that */
static bool changed;    /* a run that was no error had another */

static bool run(strutlib_scene *scene, strutlib_error **error) {
  const double *data;
  int dimensions;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS];
  double velocity;
  strutlib_result *result = strutlib_run(scene, 0, NULL, NULL, NULL, error);
  bool good = result && strutlib_result_number(result, "velocity", &velocity) == 1 &&
              strutlib_result_array(result, "nodes", &data, &dimensions, shape, stride) == 1;
  const char *contacts = good ? strstr(strutlib_result_table(result), "\ncontact\n") : NULL;
  if (contacts && !*rest) snprintf(rest, sizeof rest, "%s", contacts);
  changed = changed || (good && !(contacts && strcmp(contacts, rest) == 0));
  strutlib_result_free(result);
  return good;
}

static bool analyse(strutlib_scene *scene, strutlib_error **error) {
  strutlib_result *result = strutlib_rigidity(scene, 0, NULL, NULL, NULL, error);
  if (result) {
    strutlib_result_free(result);
    result = strutlib_matrices(scene, 0, NULL, NULL, NULL, error);
  }
  strutlib_result_free(result);
  return result != NULL;
}

static bool simulate(strutlib_scene *scene, strutlib_error **error) {
  double *load;
  const double *force;
  int dimensions, status = STRUTLIB_NO_MEMORY;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS];
  strutlib_simulation *s = strutlib_simulation_open(scene, 0, NULL, NULL, NULL, error);
  strutlib_snapshot *snapshot = s ? strutlib_simulation_snapshot(s, error) : NULL;
  if (snapshot && strutlib_simulation_input(s, "load", &load, &dimensions, shape, stride) &&
      strutlib_simulation_array(s, "force", &force, &dimensions, shape, stride)) {
    load[1] = 1.0;
    status = strutlib_simulation_advance(s, 10, error);
    strutlib_simulation_restore(s, snapshot, NULL);
  }
  strutlib_snapshot_free(snapshot);
  strutlib_simulation_close(s);
  return status == STRUTLIB_OK;
}

static bool record(strutlib_scene *scene, strutlib_error **error) {
  const char *names[] = {"record"}, *values[] = {"yes"};
  strutlib_simulation *simulation = strutlib_simulation_open(scene, 1, names, values, NULL, error);
  bool good = simulation && strutlib_simulation_advance(simulation, 10, error) == STRUTLIB_OK;
  strutlib_result *result = good ? strutlib_simulation_finish(simulation, error) : NULL;
  good = result && strutlib_result_status(result) == STRUTLIB_INTERRUPTED &&
         strstr(strutlib_result_table(result), "max height");
  strutlib_result_free(result);
  strutlib_simulation_close(simulation);
  return good;
}

static bool sweep(strutlib_scene *scene, strutlib_error **error) {
  const char *axes[] = {"drop"}, *keep[] = {"velocity", "method"};
  const char *names[] = {"threads"}, *values[] = {"1"};
  const double points[] = {0.01, 0.02};
  strutlib_result *result = strutlib_sweep(scene, 1, axes, 2, points, NULL, 2, keep, 1, names,
                                           values, NULL, NULL, NULL, error);
  strutlib_result_free(result);
  return result != NULL;
}

/* Studies of two points by file, the second of a parameter that there is none of. */
static char folder[] = "/tmp/strut-attempts-XXXXXX";

static strutlib_result *study_of(const char *name, strutlib_error **error) {
  const char *names[] = {"threads"}, *values[] = {"1"};
  char path[60], output[60];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  snprintf(output, sizeof output, "%s/out", folder);
  return strutlib_study(path, output, 0, NULL, NULL, 1, names, values, NULL, error);
}

static bool study(strutlib_scene *scene, strutlib_error **error) {
  (void)scene;
  strutlib_result *result = study_of("study.yaml", error);
  bool good = result && strutlib_result_status(result) == STRUTLIB_OK &&
              strutlib_result_cell(result, "status", 1) == NULL &&
              strutlib_result_column(result, 1);
  strutlib_result_free(result);
  return good;
}

static bool wrong_study(strutlib_scene *scene, strutlib_error **error) {
  (void)scene;
  return !study_of("wrong.yaml", error) && *error &&
         strutlib_error_status(*error) == STRUTLIB_BAD_SCENE;
}

static const struct {
  const char *name;
  attempt call;
} attempts[] = {
    {"open", open_text},  {"wrong text", open_wrong},  {"show", show_scene}, {"run", run},
    {"statics", analyse}, {"simulation", simulate},    {"record", record},   {"sweep", sweep},
    {"study", study},     {"wrong study", wrong_study}};
enum { ATTEMPTS = sizeof attempts / sizeof attempts[0] };

static bool write_file(const char *name, const char *content) {
  char path[60];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "w");
  return file && fputs(content, file) >= 0 && fclose(file) == 0;
}

static strutlib_scene *attempts_begin(void) {
#define STUDY(axis)                                                                                \
  "strut: 1\nstudy: two\nmodel: model.yaml\naxes: [{" axis "}]\nkeep: [velocity, method]\n"
  bool written = mkdtemp(folder) && write_file("model.yaml", text) &&
                 write_file("study.yaml", STUDY("drop: [10 mm, 20 mm]")) &&
                 write_file("wrong.yaml", STUDY("drip: [10 mm]"));
  return written ? strutlib_open_text("memory", text, sizeof text - 1, 0, NULL, NULL, NULL) : NULL;
}

static bool attempts_end(strutlib_scene *scene) {
  char command[60];
  strutlib_close(scene);
  snprintf(command, sizeof command, "rm -rf %s", folder);
  return system(command) == 0 && !changed;
}

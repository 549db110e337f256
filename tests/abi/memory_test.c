/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Memory that is out is an error of every call, never an abort: the k-th allocation fails, for k from 1 on,
 * until a call succeeds. Sees the library from inside, where tests can make allocations fail.
 */
#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

#include "engine/base/memory.h"
#include "parser/bindings/abi/abi.h"
#include "tests/abi/triangle.h"
#include "tests/support/test.h"

FREED_BY(strutlib_result_free, strutlib_result)
FREED_BY(strutlib_close, strutlib_scene)
FREED_BY(strutlib_simulation_close, strutlib_simulation)

static const char text[] = TRIANGLE("5 ms", "");

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
  strutlib_scene *own = strutlib_open_text("wrong", wrong, sizeof wrong - 1, 0, NULL, NULL, error);
  assert_null(own);
  return *error && strutlib_error_status(*error) == STRUTLIB_BAD_SCENE &&
         strutlib_error_count(*error) > 0;
}

static bool show_scene(strutlib_scene *scene, strutlib_error **error) {
  const char *names[] = {"drop"}, *values[] = {"30 mm"};
  OWN_POINTER(strutlib_scene) other = strutlib_scene_with(scene, 1, names, values, error);
  char *json = other ? strutlib_scene_json(other, error) : NULL;
  char *yaml = json ? strutlib_scene_yaml(other, 0, error) : NULL;
  char *parts = yaml ? strutlib_scene_yaml(other, 1, error) : NULL;
  strutlib_release(json);
  strutlib_release(yaml);
  strutlib_release(parts);
  return parts != NULL;
}

static char rest[1000]; /* of a run's table, whose cost is above that */

static bool run(strutlib_scene *scene, strutlib_error **error) {
  const double *data;
  int dimensions;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS];
  OWN_POINTER(strutlib_result) result = strutlib_run(scene, 0, NULL, NULL, NULL, error);
  bool good =
      result && strutlib_result_array(result, "nodes", &data, &dimensions, shape, stride) == 1;
  const char *contacts = good ? strstr(strutlib_result_table(result), "\ncontact\n") : NULL;
  if (contacts && !*rest) snprintf(rest, sizeof rest, "%s", contacts);
  if (good) assert_string_equal(contacts, rest);
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
  OWN_POINTER(strutlib_simulation) s = strutlib_simulation_open(scene, 0, NULL, NULL, NULL, error);
  strutlib_snapshot *snapshot = s ? strutlib_simulation_snapshot(s, error) : NULL;
  if (snapshot && strutlib_simulation_input(s, "load", &load, &dimensions, shape, stride) &&
      strutlib_simulation_array(s, "force", &force, &dimensions, shape, stride)) {
    load[1] = 1.0;
    status = strutlib_simulation_advance(s, 10, error);
    strutlib_simulation_restore(s, snapshot, NULL);
  }
  strutlib_snapshot_free(snapshot);
  return status == STRUTLIB_OK;
}

static bool record(strutlib_scene *scene, strutlib_error **error) {
  const char *names[] = {"record"}, *values[] = {"yes"};
  OWN_POINTER(strutlib_simulation) s =
      strutlib_simulation_open(scene, 1, names, values, NULL, error);
  bool good = s && strutlib_simulation_advance(s, 10, error) == STRUTLIB_OK;
  OWN_POINTER(strutlib_result) result = good ? strutlib_simulation_finish(s, error) : NULL;
  if (result) assert_int_equal(strutlib_result_status(result), STRUTLIB_INTERRUPTED);
  return result && strstr(strutlib_result_table(result), "max height");
}

static bool sweep(strutlib_scene *scene, strutlib_error **error) {
  const char *axes[] = {"drop"}, *keep[] = {"velocity", "method"};
  const char *names[] = {"threads"}, *values[] = {"1"};
  const double points[] = {0.01, 0.02};
  OWN_POINTER(strutlib_result) result = strutlib_sweep(scene, 1, axes, 2, points, NULL, 2, keep, 1,
                                                       names, values, NULL, NULL, NULL, error);
  return result != NULL;
}

/* A study of two points by file; what is computed stays in its folder. */
static char folder[] = "/tmp/strut-memory-XXXXXX";

static bool study(strutlib_scene *scene, strutlib_error **error) {
  const char *names[] = {"threads"}, *values[] = {"1"};
  char path[60], output[60];
  (void)scene;
  snprintf(path, sizeof path, "%s/study.yaml", folder);
  snprintf(output, sizeof output, "%s/out", folder);
  OWN_POINTER(strutlib_result) result =
      strutlib_study(path, output, 0, NULL, NULL, 1, names, values, NULL, error);
  return result && strutlib_result_status(result) == STRUTLIB_OK &&
         strutlib_result_cell(result, "status", 1) == NULL && strutlib_result_column(result, 1);
}

static void write_file(const char *name, const char *content) {
  char path[60];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fputs(content, file);
  fclose(file);
}

BEFORE_ALL {
  assert_non_null(mkdtemp(folder));
  write_file("model.yaml", text);
  write_file("study.yaml",
             "strut: 1\nstudy: two\nmodel: model.yaml\naxes: [{drop: [10 mm, 20 mm]}]\n"
             "keep: [velocity, method]\n");
}

AFTER_ALL {
  char command[60];
  snprintf(command, sizeof command, "rm -rf %s", folder);
  assert_int_equal(system(command), 0);
}

/* Returns how many allocations could fail. */
static int64_t fail_each(strutlib_scene *scene, attempt call) {
  for (int64_t k = 0;; k++) {
    strutlib_error *error = NULL;
    strut_fail_allocation_after(k);
    bool good = call(scene, &error);
    strut_fail_allocation_after(-1);
    if (good) {
      strutlib_error_free(error);
      return k;
    }
    if (error && strutlib_error_status(error) != STRUTLIB_NO_MEMORY &&
        strutlib_error_status(error) != STRUTLIB_BAD_SCENE)
      print_message("allocation %lld: %s\n", (long long)k, strutlib_error_message(error));
    assert_true(!error || strutlib_error_status(error) == STRUTLIB_NO_MEMORY ||
                strutlib_error_status(error) == STRUTLIB_BAD_SCENE);
    if (error) assert_non_null(strutlib_error_message(error)[0] ? error : NULL);
    strutlib_error_free(error);
    assert_true(k < 200000);
  }
}

TEST(memory_that_is_out_is_an_error) {
  static const struct {
    const char *name;
    attempt call;
  } calls[] = {{"open", open_text}, {"wrong text", open_wrong}, {"show", show_scene},
               {"run", run},        {"statics", analyse},       {"simulation", simulate},
               {"record", record},  {"sweep", sweep},           {"study", study}};
  OWN_POINTER(strutlib_scene) scene =
      strutlib_open_text("memory", text, sizeof text - 1, 0, NULL, NULL, NULL);
  assert_non_null(scene);
  assert_true(run(scene, NULL)); /* what it is with memory enough */
  for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
    int64_t count = fail_each(scene, calls[i].call);
    print_message("%s: %lld allocations failed in turn\n", calls[i].name, (long long)count);
    assert_true(count > 3);
  }
}

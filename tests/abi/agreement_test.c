/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What the program prints and writes is what the library gives: JSON byte for byte, and each number of the
 * CSV files of a run bit for bit, on ten models.
 *
 *   test_abi_agreement PROGRAM
 */
#include <stdbool.h>
#include <unistd.h>

#include "tests/abi/library.h"
#include "tests/unit/scratch.h"

static const char *program;

static const char *const models[] = {
    "models/basics/oscillator.yaml",       "models/basics/pendulum.yaml",
    "models/basics/bouncing-node.yaml",    "models/basics/sliding-block.yaml",
    "models/basics/x-frame.yaml",          "models/crawler/crawler.yaml",
    "models/gallery/double-pendulum.yaml", "models/gallery/snapping-square.yaml",
    "models/gallery/cable-finger.yaml",    "models/gallery/two-mass-crawler.yaml",
    "models/parts/spring-chain.yaml"};
enum { MODELS = sizeof models / sizeof models[0] };

static char *read_file(const char *name) {
  size_t length;
  return scratch_read(scratch_path(name), &length);
}

/* Runs the program; its exit code. Standard output goes into the file "out". */
static int run_program(const char *words, const char *model) {
  char command[900];
  snprintf(command, sizeof command, "%s %s %s --quiet >%s 2>%s", program, words, model,
           scratch_path("out"), scratch_path("err"));
  int status = system(command);
  return status == -1 ? -1 : status / 256;
}

/* "n1.x" of nodes.csv is "position.n1.x", "m1.force" of members.csv "force.m1". */
static void name_of_array(const char *file, const char *column, char *name, size_t size) {
  const char *dot = strrchr(column, '.');
  if (strcmp(column, "time") == 0) {
    snprintf(name, size, "time");
  } else if (strcmp(file, "nodes.csv") == 0) {
    bool speed = strncmp(dot, ".v", 2) == 0;
    snprintf(name, size, "%s.%.*s.%s", speed ? "velocity" : "position", (int)(dot - column), column,
             dot + (speed ? 2 : 1));
  } else if (strcmp(file, "contacts.csv") == 0) {
    snprintf(name, size, "contact.%s", column);
  } else if (strcmp(file, "energy.csv") == 0) {
    snprintf(name, size, "energy.%s", column);
  } else {
    snprintf(name, size, "%s.%.*s", dot + 1, (int)(dot - column), column);
  }
}

/* Compares one file with the arrays; the number of numbers. */
static size_t compare_file(const strutlib_result *result, const char *file) {
  char *text = read_file(file), *line_end, *save = NULL;
  size_t compared = 0, columns = 0;
  const double *data[400];
  size_t stride[400], rows = 0;
  if (!text) return 0;
  char *header = strtok_r(text, "\n", &line_end);
  for (char *cell = strtok_r(header, ",", &save); cell; cell = strtok_r(NULL, ",", &save)) {
    char name[200], *unit = strstr(cell, " [");
    if (unit) *unit = '\0';
    name_of_array(file, cell, name, sizeof name);
    array a = array_of(result, name);
    assert_int_equal(a.dimensions, 1);
    rows = a.shape[0], data[columns] = a.data, stride[columns++] = a.stride[0];
  }
  for (size_t i = 0; i < rows; i++) {
    char *line = strtok_r(NULL, "\n", &line_end), *cells = NULL;
    assert_non_null(line);
    char *cell = strtok_r(line, ",", &cells);
    for (size_t c = 0; c < columns; c++, compared++) {
      assert_non_null(cell);
      double value = strtod(cell, NULL);
      assert_memory_equal(&value, &data[c][i * stride[c]], sizeof value);
      cell = strtok_r(NULL, ",", &cells);
    }
  }
  assert_null(strtok_r(NULL, "\n", &line_end));
  free(text);
  return compared;
}

static void check_run(const char *model, const strutlib_scene *scene) {
  static const char *const files[] = {"nodes.csv", "members.csv", "contacts.csv", "energy.csv"};
  char words[400];
  strutlib_error *error;
  size_t compared = 0;
  snprintf(words, sizeof words, "run -o %s", scratch_make());
  int code = run_program(words, model);
  strutlib_result *result = strutlib_run(scene, NONE, NULL, &error);
  assert_int_equal(code, error ? strutlib_exit_code(strutlib_error_status(error)) : 0);
  strutlib_error_free(error);
  if (!result) return;
  FREED char *json = read_file("summary.json"), *yaml = read_file("scene.yaml");
  char *as_run = strutlib_result_yaml(result, &error);
  assert_string_equal(json, strutlib_result_json(result));
  assert_string_equal(yaml, as_run);
  for (size_t i = 0; i < 4; i++) compared += compare_file(result, files[i]);
  assert_true(compared > 100);
  strutlib_release(as_run);
  strutlib_result_free(result);
}

typedef strutlib_result *call(const strutlib_scene *, size_t, const char *const *,
                              const char *const *, strutlib_control *, strutlib_error **);

/* The same JSON, or the same failure with the same sentence. */
static bool check_statics(const char *model, const strutlib_scene *scene, const char *command,
                          call *compute) {
  char words[100];
  strutlib_error *error;
  scratch_make();
  snprintf(words, sizeof words, "%s --json", command);
  int code = run_program(words, model);
  OWN_POINTER(strutlib_result) result = compute(scene, NONE, NULL, &error);
  FREED char *out = read_file("out"), *err = read_file("err");
  if (result) {
    assert_int_equal(code, 0);
    assert_string_equal(out, strutlib_result_json(result));
    for (size_t i = 0; strutlib_result_warning(result, i); i++)
      assert_non_null(strstr(err, strutlib_result_warning(result, i)));
  } else {
    assert_int_equal(code, strutlib_exit_code(strutlib_error_status(error)));
    if (!strstr(err, strutlib_error_message(error)))
      fail_msg("%s %s: '%s' is not in '%s'", command, model, strutlib_error_message(error), err);
  }
  strutlib_error_free(error);
  return result != NULL;
}

BEFORE_ALL {
  program = test_word(1);
  assert_non_null(program);
}

TEST(the_library_agrees_with_the_program) {
  static const struct {
    const char *command;
    call *compute;
  } commands[] = {{"equilibria", strutlib_equilibria},
                  {"modes", strutlib_modes},
                  {"rigidity", strutlib_rigidity},
                  {"form", strutlib_form},
                  {"path", strutlib_path}};
  size_t agreed = 0;
  for (size_t i = 0; i < MODELS; i++) {
    strutlib_error *error;
    OWN_POINTER(strutlib_scene) scene = library_open(models[i]);
    print_message("%s\n", models[i]);
    scratch_make();
    assert_int_equal(run_program("export", models[i]), 0);
    FREED char *out = read_file("out");
    char *yaml = strutlib_scene_yaml(scene, 0, &error);
    assert_string_equal(out, yaml);
    strutlib_release(yaml);
    check_run(models[i], scene);
    for (size_t c = 0; c < sizeof commands / sizeof commands[0]; c++)
      agreed += check_statics(models[i], scene, commands[c].command, commands[c].compute);
  }
  assert_true(agreed > 2 * MODELS);
}

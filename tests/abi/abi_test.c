/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The library as a program of somebody else's sees it: every function of strut/abi.h, errors with their
 * places, threads, interrupts, and what belongs to the host. Knows that header alone.
 */
#include <fenv.h>
#include <gsl/gsl_errno.h>
#include <locale.h>
#include <pthread.h>
#include <signal.h>
#include <time.h>

#include "tests/abi/library.h"
#include "tests/abi/triangle.h"

static const char crawler[] = "models/crawler/crawler.yaml";

static strutlib_scene *open_crawler(void) { return library_open(crawler); }

/* A falling, bouncing triangle: small, with a duration of its own. */
static const char triangle[] =
    TRIANGLE("0.2 s", ", channels: [position, velocity, length, force, contact, energy]");

static strutlib_scene *open_triangle(void) { return library_open_text(triangle); }

static void assert_number(const strutlib_scene *scene, const char *path, double expected) {
  double value;
  assert_int_equal(strutlib_scene_number(scene, path, &value), 1);
  if (value != expected) fail_msg("%s is %.17g, expected %.17g", path, value, expected);
}

static strutlib_error *error; /* of the latest call */

/* ---- versions and codes ---- */

TEST(versions_and_codes_are_reported) {
  assert_int_equal(strutlib_abi_version(), STRUTLIB_ABI_VERSION);
  assert_non_null(strchr(strutlib_version(), '.'));
  assert_all_texts(strutlib_status_name(STRUTLIB_OK), "ok",
                   strutlib_status_name(STRUTLIB_INTERRUPTED), "interrupted",
                   strutlib_status_name(99), "unknown", strutlib_status_text(STRUTLIB_BAD_SCENE),
                   "the scene is not valid");
  assert_non_null(strutlib_status_text(-1));
  assert_int_equal(strutlib_exit_code(STRUTLIB_BAD_SCENE), 2);
  assert_int_equal(strutlib_exit_code(STRUTLIB_INTERRUPTED), 130);
  strutlib_release(NULL);
  strutlib_error_free(NULL);
  strutlib_close(NULL);
  strutlib_result_free(NULL);
  strutlib_simulation_close(NULL);
  strutlib_snapshot_free(NULL);
  strutlib_control_free(NULL);
}

/* ---- scenes ---- */

TEST(a_scene_shows_names_and_values) {
  OWN_POINTER(strutlib_scene) scene = open_crawler();
  const double *data;
  int dimensions, flag;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS];
  double value = 0.0;
  assert_int_equal(strutlib_name_count(scene, "nodes"), 5);
  assert_string_equal(strutlib_name(scene, "members", 7), "m8");
  assert_null(strutlib_name(scene, "members", 9));
  assert_all_equal(strutlib_index(scene, "members", "m8"), 7, strutlib_index(scene, "members", "m"),
                   -1, strutlib_name_count(scene, "planets"), 0);
  assert_string_equal(strutlib_name(scene, "configurations", 1), "II");
  for (size_t i = 0; strutlib_name(scene, "kinds", i); i++) {
    const char *kind = strutlib_name(scene, "kinds", i);
    assert_null(strutlib_name(scene, kind, strutlib_name_count(scene, kind)));
  }
  assert_number(scene, "members.m8.stiffness", 10000.0);
  assert_number(scene, "parameters.amplitude", 0.1e-3);
  assert_number(scene, "nodes.n2.1", 0.0238714);
  assert_int_equal(strutlib_scene_number(scene, "members.m8.stifness", &value), 0);
  assert_string_equal(strutlib_scene_text(scene, "parameters.start"), "I");
  assert_string_equal(strutlib_scene_text(scene, "solver.integrator"), "rk4");
  assert_null(strutlib_scene_text(scene, "solver.step"));
  assert_int_equal(strutlib_scene_flag(scene, "solver.step", &flag), 0);
  assert_int_equal(strutlib_scene_array(scene, "members.nodes", &data, &dimensions, shape, stride),
                   1);
  assert_all_equal(dimensions, 2, shape[0], 9, shape[1], 2);
  assert_true(data[7 * stride[0]] == 0.0 && data[7 * stride[0] + 1] == 4.0);
  assert_int_equal(
      strutlib_scene_array(scene, "members.rest_length", &data, &dimensions, shape, stride), 1);
  assert_true(dimensions == 1 && data[7] == 0.01);
  assert_int_equal(strutlib_scene_array(scene, "members.colour", &data, &dimensions, shape, stride),
                   0);
}

TEST(a_setting_changes_a_scene) {
  strutlib_scene *scene =
      strutlib_open(crawler, WITH_BOTH("frequency", "12 Hz", "friction", "0.25"), &error);
  assert_number(given(scene, error), "parameters.frequency", 12.0);
  OWN_POINTER(strutlib_scene) other = strutlib_scene_with(scene, WITH("friction", "0.5"), &error);
  strutlib_close(scene); /* the text is shared */
  assert_number(given(other, error), "parameters.frequency", 12.0);
  assert_number(other, "ground.friction.mu_static", 0.5);
  assert_null(strutlib_scene_with(other, WITH("fricton", "0.5"), &error));
  assert_refused(error, STRUTLIB_BAD_SCENE, "fricton");
}

TEST(json_is_a_scene_too) {
  static const char json[] =
      "{\"strut\": 1, \"nodes\": {\"a\": {\"position\": [0, 0], \"fixed\": \"both\"}, \"b\": [1, "
      "0]},\n"
      " \"members\": {\"m\": {\"nodes\": [\"a\", \"b\"], \"kind\": \"spring\",\n"
      "  \"stiffness\": \"4 N/cm\", \"mass\": 2}}}";
  OWN_POINTER(strutlib_scene) scene = library_open_text(json);
  assert_number(scene, "members.m.stiffness", 400.0);
  char *again = strutlib_scene_json(scene, &error);
  assert_non_null(again);
  OWN_POINTER(strutlib_scene) second = library_open_text(again);
  char *yaml = strutlib_scene_yaml(scene, 0, &error),
       *copy = strutlib_scene_yaml(second, 0, &error);
  assert_string_equal(yaml, copy);
  strutlib_release(again);
  strutlib_release(yaml);
  strutlib_release(copy);
}

TEST(a_scene_is_written_short_too) {
  OWN_POINTER(strutlib_scene) scene = open_triangle();
  char *flat = strutlib_scene_yaml(scene, 0, &error), *text = strutlib_scene_yaml(scene, 1, &error);
  assert_non_null(flat);
  assert_non_null(text);
  assert_all(strstr(text, "drop + 80 mm"), !strstr(flat, "drop + 80 mm"));
  strutlib_release(flat);
  strutlib_release(text);
}

/* ---- errors ---- */

TEST(an_error_knows_all_its_places) {
  static const char bad[] =
      "strut: 1\n"
      "nodes:\n"
      "  a: [0, 0]\n"
      "  b: {position: [1, 0], mass: 3 s}\n"
      "members:\n"
      "  m: {nodes: [a, b], kind: spring, stifness: 3 N/m}\n";
  assert_null(strutlib_open_text("bad.yaml", bad, sizeof bad - 1, NONE, &error));
  assert_int_equal(strutlib_error_status(error), STRUTLIB_BAD_SCENE);
  assert_int_equal(strutlib_error_count(error), 2);
  assert_non_null(strstr(strutlib_error_message(error), "bad.yaml:4:31: "));
  assert_non_null(strstr(strutlib_error_report(error), "^~~~"));
  assert_string_equal(strutlib_error_file(error, 0), "bad.yaml");
  assert_all_equal(strutlib_error_line(error, 0), 4, strutlib_error_column(error, 0), 31,
                   strutlib_error_length(error, 0), 3);
  assert_string_equal(strutlib_error_source(error, 0), "  b: {position: [1, 0], mass: 3 s}");
  assert_string_equal(strutlib_error_key(error, 0), "nodes.b.mass");
  assert_null(strutlib_error_hint(error, 0));
  assert_non_null(strstr(strutlib_error_text(error, 1), "unknown key 'stifness'"));
  assert_string_equal(strutlib_error_hint(error, 1), "stiffness");
  assert_string_equal(strutlib_error_key(error, 1), "members.m.stifness");
  assert_null(strutlib_error_text(error, 2));
  assert_int_equal(strutlib_error_line(error, 2), 0);
  strutlib_error_free(error);
  assert_null(strutlib_open_text("bad.yaml", bad, sizeof bad - 1, NONE, NULL));
  assert_null(strutlib_open("there-is-no-such-file", NONE, &error));
  assert_refused(error, STRUTLIB_FILE_TROUBLE, "there-is-no-such-file");
  assert_null(strutlib_open("-", NONE, &error));
  assert_refused(error, STRUTLIB_FILE_TROUBLE, "no file");
}

TEST(options_are_checked_as_on_the_command_line) {
  OWN_POINTER(strutlib_scene) scene = open_crawler();
  static const struct {
    const char *name, *value, *words;
  } wrong[] = {{"acuracy", "1 %", "did you mean 'accuracy'?"},
               {"accuracy", "3 m", "expects a number without unit"},
               {"step", "0", "must be above zero"},
               {"integrator", "rk5", "did you mean 'rk4'?"},
               {"force", "perhaps", "expects yes or no"},
               {"channels", "position,colour", "not 'colour'"},
               {"bars", "soft", "expects elastic or rigid"},
               {"output", "x", "unknown option 'output'"}};
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
    assert_null(strutlib_run(scene, 1, &wrong[i].name, &wrong[i].value, NULL, &error));
    assert_refused(error, STRUTLIB_USAGE, wrong[i].words);
  }
  assert_null(strutlib_modes(scene, WITH("at", "IV"), NULL, &error));
  assert_refused(error, STRUTLIB_USAGE, "IV");
  assert_null(strutlib_equilibria(scene, WITH("supports", "n1,n9"), NULL, &error));
  assert_refused(error, STRUTLIB_USAGE, "there is no node 'n9'");
  assert_null(strutlib_path(scene, WITH("over", "frequenz"), NULL, &error));
  assert_refused(error, STRUTLIB_USAGE, "did you mean 'frequency'?");
  assert_null(strutlib_form(scene, WITH("least-tension", "-1 N"), NULL, &error));
  assert_refused(error, STRUTLIB_USAGE, "must not be negative");
  assert_string_equal(strutlib_option_name("run", 0), "force");
  assert_non_null(strutlib_option_help("path", 0));
  assert_all(!strutlib_option_name("run", 100), !strutlib_option_name("ride", 0));
}

/* ---- runs ---- */

TEST(a_run_has_its_channels) {
  strutlib_scene *scene = open_triangle();
  OWN_POINTER(strutlib_result) result = given(strutlib_run(scene, NONE, NULL, &error), error);
  assert_null(error);
  strutlib_close(scene); /* a result stays */
  assert_int_equal(strutlib_result_status(result), STRUTLIB_OK);
  assert_string_equal(strutlib_result_command(result), "run");
  array time = array_of(result, "time"), position = array_of(result, "position");
  array one = array_of(result, "position.c"), y = array_of(result, "position.c.y");
  assert_int_equal(time.shape[0], 201);
  assert_true(time.data[200] == 0.2);
  assert_int_equal(position.dimensions, 3);
  assert_true(position.shape[0] == 201 && position.shape[1] == 3 && position.shape[2] == 2);
  assert_true(one.dimensions == 2 && one.shape[0] == 201 && one.shape[1] == 2);
  assert_int_equal(y.dimensions, 1);
  for (size_t i = 0; i < 201; i++) {
    double whole =
        position.data[i * position.stride[0] + 2 * position.stride[1] + position.stride[2]];
    assert_true(y.data[i * y.stride[0]] == whole);
    assert_true(one.data[i * one.stride[0] + one.stride[1]] == whole);
  }
  assert_all_equal(array_of(result, "force.bc").shape[0], 201,
                   array_of(result, "contact.a.normal").shape[0], 201,
                   array_of(result, "energy.kinetic").shape[0], 201);
  assert_string_equal(strutlib_result_array_name(result, 0), "time");
  assert_string_equal(strutlib_result_array_unit(result, "velocity"), "m/s");
  assert_string_equal(strutlib_result_array_unit(result, "velocity.a.x"), "m/s");
  assert_null(strutlib_result_array_unit(result, "colour"));
  double value, other;
  assert_int_equal(strutlib_result_number(result, "nodes.c.position.1", &value), 1);
  assert_true(value == y.data[200 * y.stride[0]]);
  assert_int_equal(strutlib_result_number(result, "velocity", &other), 1);
  assert_int_equal(strutlib_result_number(result, "steady", &other), 0);
  assert_string_equal(strutlib_result_text(result, "status"), "completed");
  assert_null(strutlib_result_text(result, "velocity"));
  int flag;
  assert_int_equal(strutlib_result_flag(result, "status", &flag), 0);
  assert_int_equal(strutlib_result_count(result, "nodes"), 3);
  assert_string_equal(strutlib_result_key(result, "nodes", 1), "b");
  assert_string_equal(strutlib_result_key(result, "", 0), "name");
  assert_null(strutlib_result_key(result, "nodes", 3));
  array ends = array_of(result, "nodes");
  assert_all(ends.dimensions == 3 && ends.shape[0] == 3,
             strstr(strutlib_result_table(result), "completed"),
             !strutlib_result_cell(result, "outcome", 0), !strutlib_result_column(result, 0));
}

/* A page's data: one JSON object with that text in it, which is released. */
static void check_page_data(char *data, const char *wanted) {
  assert_non_null(data);
  assert_true(data[0] == '{' && strcmp(data + strlen(data) - 2, "}\n") == 0);
  if (!strstr(data, wanted)) fail_msg("the data lack %s", wanted);
  strutlib_release(data);
}

TEST(a_run_records_what_is_asked_for) {
  array none;
  OWN_POINTER(strutlib_scene) scene = open_triangle();
  OWN_POINTER(strutlib_result) some =
      given(strutlib_run(scene, WITH("channels", "force,energy"), NULL, &error), error);
  array_of(some, "force");
  assert_int_equal(strutlib_result_array(some, "position", &none.data, &none.dimensions, none.shape,
                                         none.stride),
                   0);
  assert_null(strutlib_result_svg(some, NONE, &error));
  assert_refused(error, STRUTLIB_USAGE, "recorded");
  OWN_POINTER(strutlib_result) nothing =
      given(strutlib_run(scene, WITH("record", "no"), NULL, &error), error);
  assert_null(strutlib_result_array_name(nothing, 0));
  assert_null(strutlib_result_html(nothing, &error));
  assert_refused(error, STRUTLIB_USAGE, "without a recorded motion");
  check_page_data(strutlib_result_page_data(nothing, &error), "\"motion\":null");
}

TEST(a_run_that_diverges_is_there_up_to_then) {
  OWN_POINTER(strutlib_scene) scene = open_triangle();
  const char *names[] = {"force", "step", "integrator"}, *values[] = {"yes", "5 ms", "rk4"};
  assert_null(strutlib_run(scene, 2, names + 1, values + 1, NULL, &error));
  assert_refused(error, STRUTLIB_STEP_TOO_LARGE, "largest stable step");
  OWN_POINTER(strutlib_result) result =
      given(strutlib_run(scene, 3, names, values, NULL, &error), error);
  assert_int_equal(strutlib_result_status(result), STRUTLIB_DIVERGED);
  assert_string_equal(strutlib_result_text(result, "status"), "diverged");
  assert_refused(error, STRUTLIB_DIVERGED, "");
}

/* ---- statics, pictures ---- */

/* The data of its page, where it has one, have these words; it has a picture; and it is released. */
static void check_shown(strutlib_result *result, const char *words) {
  if (words) check_page_data(strutlib_result_page_data(result, &error), words);
  char *svg = given(
      strutlib_result_svg(result, WITH_BOTH("title", "A title", "width", "column"), &error), error);
  assert_non_null(strstr(svg, "<svg"));
  strutlib_release(svg);
  strutlib_result_free(result);
}

/* Names given as options belong to the caller, who may release them after the call. */
TEST(pictures_of_paths_outlive_the_options) {
  static const char text[] =
      "strut: 1\n"
      "parameters: {softness: 1 kN/m}\n"
      "nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1 m, 0], fixed: y, mass: 1 kg}}\n"
      "members: {s: {kind: spring, nodes: [a, b], stiffness: softness}}\n"
      "loads: {push: {node: b, force: [-9 N, 0]}}\n";
  const char *names[2][3] = {{"load", "steps"}, {"over", "steps", "until"}};
  for (size_t i = 0; i < 2; i++) {
    char name[] = "push    ";
    const char *values[] = {name, "9", "2 kN/m"};
    strcpy(name, i == 0 ? "push" : "softness");
    OWN_POINTER(strutlib_scene) scene = library_open_text(text);
    OWN_POINTER(strutlib_result) result =
        given(strutlib_path(scene, 2 + i, names[i], values, NULL, &error), error);
    char *before = strutlib_result_svg(result, NONE, &error);
    memset(name, 'X', strlen(name));
    char *after = strutlib_result_svg(result, NONE, &error);
    assert_string_equal(before, after);
    strutlib_release(before);
    strutlib_release(after);
  }
}

TEST(statics_have_arrays_and_pictures) {
  OWN_POINTER(strutlib_scene) scene = open_crawler();
  strutlib_result *result = given(strutlib_equilibria(scene, NONE, NULL, &error), error);
  array energy = array_of(result, "equilibria.energy"),
        nodes = array_of(result, "equilibria.nodes");
  assert_int_equal(energy.shape[0], strutlib_result_count(result, "equilibria"));
  assert_true(nodes.dimensions == 3 && nodes.shape[1] == 5 && nodes.shape[2] == 2);
  double value;
  assert_int_equal(strutlib_result_number(result, "equilibria.3.energy", &value), 1);
  assert_true(value == energy.data[3]);
  assert_non_null(strutlib_result_text(result, "equilibria.0.name"));
  strutlib_release(given(strutlib_result_html(result, &error), error));
  check_shown(result, "\"fate\":\"stands\"");

  result = given(strutlib_modes(scene, NONE, NULL, &error), error);
  assert_int_equal(array_of(result, "modes.frequency").shape[0], 10);
  assert_int_equal(array_of(result, "modes.shape").dimensions, 3);
  check_shown(result, "\"motion\":null");

  result = given(strutlib_rigidity(scene, NONE, NULL, &error), error);
  assert_int_equal(array_of(result, "self_stress.states.forces").shape[1], 9);
  int flag;
  assert_int_equal(strutlib_result_flag(result, "self_stress.states.0.feasible", &flag), 1);
  check_shown(result, NULL);

  result = given(strutlib_form(scene, NONE, NULL, &error), error);
  assert_int_equal(array_of(result, "forces").shape[0], 9);
  char *yaml = strutlib_result_yaml(result, &error);
  strutlib_close(library_open_text(yaml));
  strutlib_release(yaml);
  check_shown(result, "\"motion\":null");

  const char *path_names[] = {"over", "until", "steps"}, *path_values[] = {"drive", "1 mm", "9"};
  result = given(strutlib_path(scene, 3, path_names, path_values, NULL, &error), error);
  assert_int_equal(array_of(result, "points.value").dimensions, 1);
  check_shown(result, "\"motion\":null");

  result = given(strutlib_matrices(scene, NONE, NULL, &error), error);
  array value_of = array_of(result, "mass.value"), size = array_of(result, "mass.size");
  double sum = 0.0; /* of a consistent mass matrix over x and y: twice the mass */
  for (size_t i = 0; i < value_of.shape[0]; i++) sum += value_of.data[i];
  assert_true(size.data[0] == 10 && size.data[1] == 10 && fabs(sum - 2 * 0.14) < 1e-12);
  assert_null(strutlib_result_svg(result, NONE, &error));
  assert_refused(error, STRUTLIB_USAGE, "no figure of matrices");
  strutlib_result_free(result);
}

TEST(the_language_is_a_schema) {
  char *scene = strutlib_schema(0, &error), *study = strutlib_schema(1, NULL);
  assert_all(!error, strstr(scene, "\"title\":\t\"scene\""),
             strstr(study, "\"title\":\t\"study\""));
  strutlib_release(scene);
  strutlib_release(study);
}

/* ---- what belongs to the host ---- */

static void host_handler(const char *reason, const char *file, int line, int code) {
  (void)reason, (void)file, (void)line, (void)code;
}

TEST(nothing_of_the_host_is_changed) {
  struct sigaction before, after;
  const char *locale = setlocale(LC_ALL, "");
  char kept[200];
  snprintf(kept, sizeof kept, "%s", locale ? locale : "C");
  gsl_error_handler_t *of_test = gsl_set_error_handler(host_handler);
  sigaction(SIGINT, NULL, &before);
  fesetround(FE_TONEAREST);
  fenv_t mode;
  fegetenv(&mode);
  OWN_POINTER(strutlib_scene) scene = open_triangle();
  OWN_POINTER(strutlib_result) result = strutlib_run(scene, NONE, NULL, &error);
  OWN_POINTER(strutlib_simulation) simulation = strutlib_simulation_open(scene, NONE, NULL, &error);
  strutlib_simulation_advance(simulation, 100, &error);
  volatile double tiny = 1e-310; /* flushed to zero where the mode were left on */
  assert_true(tiny * 1.0 != 0.0);
  assert_int_equal(fegetround(), FE_TONEAREST);
  sigaction(SIGINT, NULL, &after);
  assert_true(before.sa_handler == after.sa_handler);
  assert_ptr_equal(gsl_set_error_handler(of_test), host_handler);
  assert_string_equal(setlocale(LC_ALL, NULL), kept);
  setlocale(LC_ALL, "C");
}

/* ---- threads and interrupts ---- */

static void *run_once(void *scene) {
  strutlib_error *own;
  strutlib_result *result = strutlib_run(scene, NONE, NULL, &own);
  if (!result) return NULL;
  char *text = malloc(strlen(strutlib_result_json(result)) + 1);
  strcpy(text, strutlib_result_json(result));
  double value;
  strutlib_result_number(result, "energy.residual", &value);
  strutlib_result_free(result);
  return text;
}

TEST(eight_threads_get_the_bytes_of_one) {
  enum { THREADS = 8 };
  pthread_t thread[THREADS];
  OWN_POINTER(strutlib_scene) scene = open_triangle();
  FREED char *alone = run_once(scene);
  assert_non_null(alone);
  for (int i = 0; i < THREADS; i++)
    assert_int_equal(pthread_create(&thread[i], NULL, run_once, scene), 0);
  for (int i = 0; i < THREADS; i++) {
    FREED void *text;
    pthread_join(thread[i], &text);
    assert_non_null(text);
    assert_string_equal(text, alone);
  }
}

static double processor_time(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double start_of_interrupt;

/* Interrupts what has worked for a fifth of a second: the time after that is what counts. */
static int interrupt_soon(void *context, double fraction) {
  (void)fraction;
  if (start_of_interrupt > 0.0 || processor_time() < 0.2 + *(double *)context) return 0;
  start_of_interrupt = processor_time();
  return 1;
}

TEST(an_interrupt_returns_what_there_is) {
  strutlib_scene *scene = open_crawler();
  OWN_POINTER(strutlib_control) control = strutlib_control_create();
  double begin = processor_time();
  start_of_interrupt = 0.0;
  assert_int_equal(strutlib_control_interrupted(control), 0);
  strutlib_control_on_progress(control, interrupt_soon, &begin);
  strutlib_result *result = strutlib_run(scene, WITH("step", "0.001 ms"), control, &error);
  double late = processor_time() - start_of_interrupt;
  assert_non_null(result);
  assert_int_equal(strutlib_result_status(result), STRUTLIB_INTERRUPTED);
  assert_refused(error, STRUTLIB_INTERRUPTED, "interrupted at t = ");
  assert_true(late < 0.2);
  assert_int_equal(strutlib_control_interrupted(control), 1);
  strutlib_result_free(result);
  assert_null(strutlib_run(scene, NONE, control, &error));
  assert_refused(error, STRUTLIB_INTERRUPTED, "before anything");
  strutlib_control_reset(control);
  strutlib_control_on_progress(control, NULL, NULL);
  strutlib_close(scene);
  scene = open_triangle();
  OWN_POINTER(strutlib_simulation) simulation =
      strutlib_simulation_open(scene, NONE, control, &error);
  assert_non_null(simulation);
  strutlib_interrupt(control);
  assert_int_equal(strutlib_simulation_advance(simulation, 5, &error), STRUTLIB_INTERRUPTED);
  strutlib_error_free(error);
  strutlib_control_reset(control);
  assert_int_equal(strutlib_simulation_advance(simulation, 5, &error), STRUTLIB_OK);
  strutlib_close(scene);
}

static void *interrupt_later(void *control) {
  struct timespec wait = {0, 100000000};
  nanosleep(&wait, NULL);
  strutlib_interrupt(control);
  return NULL;
}

TEST(another_thread_interrupts_searches_and_sweeps) {
  OWN_POINTER(strutlib_scene) scene = open_crawler();
  OWN_POINTER(strutlib_control) control = strutlib_control_create();
  pthread_t thread;
  pthread_create(&thread, NULL, interrupt_later, control);
  assert_null(strutlib_equilibria(scene, WITH("starts", "10000000"), control, &error));
  assert_refused(error, STRUTLIB_INTERRUPTED, "interrupted");
  pthread_join(thread, NULL);
  strutlib_control_reset(control);
  const char *axes[] = {"frequency"}, *keep[] = {"velocity"};
  double points[400];
  for (int i = 0; i < 400; i++) points[i] = 8.0 + 0.01 * i;
  pthread_create(&thread, NULL, interrupt_later, control);
  OWN_POINTER(strutlib_result) result = strutlib_sweep(scene, 1, axes, 400, points, NULL, 1, keep,
                                                       0, NULL, NULL, NULL, NULL, control, &error);
  pthread_join(thread, NULL);
  assert_non_null(result);
  assert_int_equal(strutlib_result_status(result), STRUTLIB_INTERRUPTED);
  assert_refused(error, STRUTLIB_INTERRUPTED, "of 400 points");
  array status = array_of(result, "status");
  assert_true(status.data[399] == (double)STRUTLIB_INTERRUPTED);
}

/* Statics look at the interrupt between factorisations, and within a linear programme of 40 s. */
TEST(statics_end_too) {
  static strutlib_result *(*const find[])(const strutlib_scene *, size_t, const char *const *,
                                          const char *const *, strutlib_control *,
                                          strutlib_error **) = {strutlib_form, strutlib_modes};
  OWN_POINTER(strutlib_control) control = strutlib_control_create();
  OWN_POINTER(strutlib_scene) scene =
      given(strutlib_open("models/parts/x-chain.yaml", WITH("cells", "4000"), &error), error);
  for (size_t i = 0; i < sizeof find / sizeof *find; i++) {
    pthread_t thread;
    strutlib_control_reset(control);
    pthread_create(&thread, NULL, interrupt_later, control);
    double begin = processor_time();
    assert_null(find[i](scene, NONE, control, &error));
    assert_true(processor_time() - begin < 5.0);
    assert_refused(error, STRUTLIB_INTERRUPTED, "interrupted");
    pthread_join(thread, NULL);
  }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the reader makes of a text: values, groups, parameters, --set, layers; memory; locale. */

#include "parser/language/read/read_scene.h"
#include "parser/language/write/write_scene.h"
#include "tests/language/cases.h"
#include "tests/support/motion.h"

/* What every scene here ends with. */
#define RUN "solver: {step: 1 ms}\nrun: {duration: 10 s}\n"

static strut_status read_text(strut_setup *setup, const char *text, const strut_setting *set,
                              size_t sets) {
  OWN(strut_diagnostics) diagnostics = {0};
  return strut_setup_read(setup, "test.yaml", text, strlen(text), set, sets, STRUT_FOR_RUN,
                          &diagnostics);
}

/* Reads a scene that must be valid. */
static void read_good(strut_setup *setup, const char *text, const strut_setting *set, size_t sets) {
  OWN(strut_diagnostics) diagnostics = {0};
  if (strut_setup_read(setup, "test.yaml", text, strlen(text), set, sets, STRUT_FOR_RUN,
                       &diagnostics) != STRUT_OK)
    fail_msg("%s", strut_diagnostics_render(&diagnostics, 50));
  assert_int_equal(diagnostics.count, 0);
}

static char *read_path(const char *path, size_t *length) {
  strut_error error;
  char *text;
  if (strut_file_read(path, &text, length, &error)) fail_msg("%s", error.message);
  return text;
}

TEST(the_crawler_page) {
  size_t length;
  OWN(strut_setup) s;
  char *text = read_path(STRUT_TESTS_DIR "/language/good/crawler.yaml", &length);
  read_good(&s, text, NULL, 0);
  strut_release(text); /* the scene owns all it needs */
  assert_string_equal(s.scene.name, "Nine-member multistable crawler");
  assert_true(s.scene.node_count == 5 && s.scene.member_count == 9 && s.scene.contact_count == 5);
  assert_all(
      s.scene.gravity[0] == 0 && s.scene.gravity[1] == -9.81,
      s.scene.nodes[1].position[0] == 0.0965109 && s.scene.nodes[1].position[1] == 0.0238714);
  assert_true(s.scene.nodes[1].start[0] == 0.096 &&
              s.scene.nodes[1].start[1] == 0.024); /* start: "II" */
  assert_true(s.scene.nodes[2].start[0] == s.scene.nodes[2].position[0]);
  const strut_member *m = s.scene.members;
  assert_true(m[0].kind == STRUT_BAR && m[0].stiffness == 1e6 && m[0].damping == 0.2);
  assert_true(m[0].mass == 0.1 && m[0].rest_kind == STRUT_REST_LENGTH && m[0].rest_value == 0.1);
  assert_true(m[1].node[0] == 2 && m[1].node[1] == 1);
  assert_true(m[3].kind == STRUT_SPRING && m[3].stiffness == 3000 && m[3].rest_value == 0.02);
  assert_all(m[4].stiffness == 2000 && m[8].mass == 1e-6,
             s.scene.ground.present && s.scene.ground.height == 0 && s.scene.contacts[4].node == 4);
  assert_true(s.scene.contacts[4].stiffness == 1e5 && s.scene.contacts[4].damping == 100);
  const strut_friction *f = &s.scene.contacts[2].friction;
  assert_true(f->law == STRUT_FRICTION_KARNOPP && f->mu_static == 0.1 && f->mu_kinetic == 0.1);
  assert_true(f->stick_velocity == 1e-4);
  assert_true(s.scene.actuator_count == 1 && s.scene.actuators[0].member == 7);
  const strut_signal *drive = &s.scene.signals[s.scene.actuators[0].signal];
  assert_all(drive->kind == STRUT_SINE && drive->amplitude == 1e-4 && drive->frequency == 10,
             s.experiment.settle.wanted && s.experiment.settle.speed == 1e-8 &&
                 s.experiment.settle.limit == 100);
  assert_true(s.experiment.step == 1e-4 && s.experiment.periods == 1100);
  assert_true(s.experiment.measure_last == 100 && s.experiment.period_signal == 0);
  assert_string_equal(s.experiment.period_of, "drive");
  assert_int_equal(s.scene.parameter_count, 4);
  assert_string_equal(s.scene.parameters[0].text, "10 Hz");
  assert_true(s.scene.parameters[0].value == 10 && isnan(s.scene.parameters[3].value));
}

TEST(overrides) {
  static const char text[] =
      "strut: 1\n"
      "parameters: {f: 10 Hz, l: 2 mm, twice: 2*l, bare: 3, start: \"I\"}\n"
      "nodes: {a: {position: [twice, bare], mass: f*1 kg s}}\n"
      "configurations: {I: {a: [1, 1]}, II: {a: [2, 2]}}\n"
      "initial: {configuration: start}\n" RUN;
  const strut_setting set[] = {{.name = "f", .text = "20"},
                               {.name = "l", .text = "twice_bare"},
                               {.name = "bare", .text = "1 cm"},
                               {.name = "start", .text = "II"}};
  strut_setup s;
  read_good(&s, text, NULL, 0);
  assert_true(s.scene.nodes[0].position[0] == 0.004 && s.scene.nodes[0].mass == 10);
  assert_true(s.scene.nodes[0].start[0] == 1);
  strut_setup_free(&s);
  const strut_setting good[] = {set[0], {.name = "l", .text = "1 m + 100 mm"}, set[2], set[3]};
  read_good(&s, text, good, 4);
  assert_true(s.scene.nodes[0].position[0] == 2.2 && s.scene.nodes[0].position[1] == 0.01);
  assert_true(s.scene.nodes[0].mass == 20 && s.scene.nodes[0].start[0] == 2);
  assert_all_texts(s.scene.parameters[0].text, "20", s.scene.parameters[4].text, "II");
  strut_setup_free(&s);
  assert_int_equal(read_text(&s, text, &set[1], 1), STRUT_BAD_SCENE);
  const strut_setting wrong[] = {{.name = "l", .text = "twice"}, /* a circle */
                                 {.name = "bare", .text = "1 kg"}};
  for (int i = 0; i < 2; i++) assert_int_equal(read_text(&s, text, &wrong[i], 1), STRUT_BAD_SCENE);
}

TEST(configurations) {
  static const char text[] =
      "strut: 1\n"
      "parameters: {start: \"I\"}\n"
      "nodes: {a: [0, 0], b: [1, 0], c: [1, 1], shape: [2, 2]}\n"
      "groups: {rod: {kind: bar, stiffness: 1, mass: 1}}\n"
      "members: {ab: {group: rod, nodes: [a, b]}, cs: {group: rod, nodes: [c, shape]}}\n"
      "ground: {stiffness: 1, nodes: [a, b]}\n"
      "configurations:\n"
      "  I: {contacts: [b, a], shape: {c: [0, 3]}}\n"
      "  II: {contacts: [[a], [b, a]]}\n"
      "  III: {}\n"
      "  IV: {shape: [5, 6]}\n"
      "equilibria: {supports: [[b, a]], starts: 20*5, seed: 12}\n"
      "initial: {equilibrium: start, velocity: [0, 1]}\n" RUN;
  strut_setup s;
  read_good(&s, text, NULL, 0);
  assert_int_equal(s.scene.configuration_count, 4);
  const strut_configuration *c = s.scene.configurations;
  assert_true(c[0].shaped && c[0].set_count == 1 && c[0].sets[0].count == 2);
  assert_true(c[0].sets[0].node[0] == 1 && c[0].sets[0].node[1] == 0);
  assert_true(c[0].position[2][0] == 0 && c[0].position[2][1] == 3 && c[0].position[1][0] == 1);
  assert_all(!c[1].shaped && c[1].set_count == 2 && c[1].sets[1].node[1] == 0,
             c[1].position[3][0] == 2, c[2].shaped && c[2].set_count == 0);
  assert_all(
      c[3].shaped && c[3].position[3][0] == 5 && c[3].position[3][1] == 6,
      s.experiment.search.support_count == 1 && s.experiment.search.supports[0].node[0] == 1);
  assert_true(s.experiment.search.starts == 100 && s.experiment.search.seed == 12);
  assert_true(s.scene.start_equilibrium == 0 && s.scene.nodes[2].velocity[1] == 1);
  assert_true(s.scene.nodes[2].start[0] == 1); /* as drawn, until it is resolved */
  strut_setup_free(&s);
  read_good(&s, text, &(strut_setting){.name = "start", .text = "II"}, 1);
  assert_int_equal(s.scene.start_equilibrium, 1);
  strut_setup_free(&s);
}

TEST(groups_give_defaults) {
  static const char text[] =
      "strut: 1\n"
      "groups:\n"
      "  one: {kind: bar, stiffness: 1, rest_length: 2, mass: 3}\n"
      "  two: {kind: cable, axial_stiffness: 5, pretension: 6, damping: 7}\n"
      "  held: {fixed: both, mass: 8}\n"
      "nodes: {a: {position: [0, 0], group: held}, b: {position: [0, 4], group: held, fixed: y}}\n"
      "members:\n"
      "  m1: {group: [one, two], nodes: [a, b]}\n"
      "  m2: {group: [two, one], nodes: [a, b]}\n"
      "  m3: {group: one, nodes: [a, b], axial_stiffness: 9, rest_length_ratio: 0.5, mass: "
      "0}\n" RUN;
  OWN(strut_setup) s;
  read_good(&s, text, NULL, 0);
  const strut_member *m = s.scene.members;
  assert_all(s.scene.nodes[0].fixed[0] && s.scene.nodes[0].fixed[1] && s.scene.nodes[0].mass == 8,
             !s.scene.nodes[1].fixed[0] && s.scene.nodes[1].fixed[1] && s.scene.nodes[1].mass == 8);
  assert_all(m[0].kind == STRUT_CABLE && m[0].stiffness == 0 && m[0].axial_stiffness == 5,
             m[0].rest_kind == STRUT_REST_PRETENSION && m[0].rest_value == 6,
             m[0].damping == 7 && m[0].mass == 3,
             m[1].kind == STRUT_BAR && m[1].stiffness == 1 && m[1].axial_stiffness == 0,
             m[1].rest_kind == STRUT_REST_LENGTH && m[1].rest_value == 2 && m[1].damping == 7,
             m[2].stiffness == 0 && m[2].axial_stiffness == 9 && m[2].mass == 0,
             m[2].rest_kind == STRUT_REST_RATIO && m[2].rest_value == 0.5);
}

TEST(friction_comes_in_layers) {
  static const char text[] =
      "strut: 1\n"
      "groups: {ice: {friction: {mu: 0.01}}, wet: {damping: 9, friction: {mu_static: 0.2}}}\n"
      "nodes: {a: {position: [0, 1], mass: 1}, b: {position: [1, 1], mass: 1},\n"
      "        c: {position: [2, 1], mass: 1}, d: {position: [3, 1], mass: 1}}\n"
      "ground:\n"
      "  stiffness: 1e4\n"
      "  friction: {mu_static: 0.5, mu_kinetic: 0.4, stick_velocity: 1 mm/s}\n"
      "  nodes: [d, c, b]\n"
      "  contacts:\n"
      "    c: {group: [ice, wet], friction: {stick_velocity: 2 mm/s}}\n"
      "    d: {stiffness: 2e4, friction: {law: none}}\n" RUN;
  OWN(strut_setup) s;
  read_good(&s, text, NULL, 0);
  assert_int_equal(s.scene.contact_count, 3);
  const strut_contact *c = s.scene.contacts;
  assert_all(c[0].node == 1 && c[1].node == 2 && c[2].node == 3,
             c[0].friction.mu_static == 0.5 && c[0].friction.mu_kinetic == 0.4,
             c[1].friction.mu_static == 0.2 && c[1].friction.mu_kinetic == 0.01,
             c[1].friction.stick_velocity == 0.002 && c[1].damping == 9 && c[1].stiffness == 1e4,
             c[2].friction.law == STRUT_FRICTION_NONE && c[2].stiffness == 2e4);
}

TEST(signals_and_their_names) {
  static const char text[] =
      "strut: 1\n"
      "nodes: {a: {position: [0, 0], fixed: x, mass: 1}, b: {position: [1, 0], mass: 1}}\n"
      "members: {m: {nodes: [a, b], kind: bar, stiffness: 1}}\n"
      "signals:\n"
      "  late: {sum: [early, {constant: 1 mm}]}\n"
      "  early: {sine: {amplitude: 2 mm, frequency: 3 Hz, phase: 90 deg, start: 1 s, stop: 1 "
      "min}}\n"
      "  factor: {table: [[0, 0], [1 s, 1]]}\n"
      "actuators: {one: {member: m, signal: late}, two: {member: m, signal: early}}\n"
      "loads: {push: {node: b, force: [1, 0], signal: factor}, pull: {node: b, force: [0, 2]}}\n"
      "initial: {velocity: [1, 2], velocities: {b: [3, 4]}}\n"
      "solver: {step: 1 ms}\n"
      "run: {periods: 3, of: two, measure: {node: b}}\n"
      "output: {channels: [energy, position]}\n";
  OWN(strut_setup) s;
  read_good(&s, text, NULL, 0);
  assert_int_equal(s.scene.signal_count, 4);
  assert_string_equal(s.scene.signals[0].name, "early"); /* terms come before their sum */
  assert_all(s.scene.signals[0].phase == 0.25 && s.scene.signals[0].start == 1 &&
                 s.scene.signals[0].stop == 60,
             s.scene.signals[1].kind == STRUT_CONSTANT && s.scene.signals[1].name == NULL);
  assert_string_equal(s.scene.signals[2].name, "late");
  assert_true(s.scene.signals[2].term_count == 2 && s.scene.signals[2].terms[0] == 0);
  assert_all(s.scene.actuators[0].signal == 2 && s.scene.actuators[1].signal == 0,
             s.scene.loads[0].signal == 3 && s.scene.loads[1].signal == -1 &&
                 s.scene.loads[1].force[1] == 2);
  assert_true(s.experiment.period_signal == 0 && s.experiment.measure_node == 1);
  assert_int_equal(s.experiment.channels, STRUT_CHANNEL_ENERGY | STRUT_CHANNEL_POSITION);
  assert_true(s.scene.nodes[0].velocity[0] == 0 &&
              s.scene.nodes[0].velocity[1] == 2); /* held in x */
  assert_true(s.scene.nodes[1].velocity[0] == 3 && s.scene.nodes[1].velocity[1] == 4);
}

TEST(statics_need_no_run) {
  static const char text[] =
      "strut: 1\nnodes: {a: {position: [0, 0], fixed: both}, b: [1, 0]}\n"
      "members: {m: {nodes: [a, b], kind: bar, stiffness: 1}}\n";
  OWN(strut_diagnostics) diagnostics = {0};
  strut_setup s;
  assert_ok(
      strut_setup_read(&s, "f", text, strlen(text), NULL, 0, STRUT_FOR_STATICS, &diagnostics));
  strut_setup_free(&s);
  assert_int_equal(read_text(&s, text, NULL, 0), STRUT_BAD_SCENE);
}

/* Fails each allocation in turn: no crash, no leak, and never a scene that is only half there. */
TEST(memory_may_run_out_anywhere) {
  size_t length;
  RELEASED char *text = read_path(STRUT_TESTS_DIR "/language/good/every-key.yaml", &length);
  REFUSE_EACH(n, status, 20) {
    OWN(strut_setup) s;
    OWN(strut_diagnostics) diagnostics = {0};
    strut_fail_allocation_after(n);
    status = strut_setup_read(&s, "f", text, length, NULL, 0, STRUT_FOR_RUN, &diagnostics);
    RELEASED char *written = status == STRUT_OK ? strut_setup_write(&s) : NULL;
    strut_fail_allocation_after(-1);
    if (status) assert_null(s.scene.nodes);
    if (!status && !written) status = STRUT_NO_MEMORY;
  }
}

TEST(memory_may_run_out_in_a_bad_file) {
  faulty_cases cases = read_faulty_cases(STRUT_TESTS_DIR "/language/bad");
  const faulty_case *many = find_faulty_case(&cases, "many-errors");
  strut_status status = STRUT_NO_MEMORY;
  assert_non_null(many);
  for (int64_t n = 0; status == STRUT_NO_MEMORY && n < 5000; n++) {
    strut_setup s;
    OWN(strut_diagnostics) diagnostics = {0};
    strut_fail_allocation_after(n);
    status =
        strut_setup_read(&s, "f", many->text, many->length, NULL, 0, STRUT_FOR_RUN, &diagnostics);
    strut_fail_allocation_after(-1);
    assert_null(s.scene.nodes);
  }
  assert_int_equal(status, STRUT_BAD_SCENE);
  free_faulty_cases(&cases);
}

/* A chain of n members; `spoilt`: every member has a misspelt node. */
static char *chain(int n, bool spoilt, size_t *length) {
  size_t size = (size_t)n * 120 + 1000, used = 0;
  char *text = malloc(size);
  used +=
      (size_t)snprintf(text + used, size - used,
                       "strut: 1\ngroups: {g: {kind: bar, stiffness: 1 N/m, mass: 1 g}}\nnodes:\n");
  for (int i = 0; i <= n; i++)
    used += (size_t)snprintf(text + used, size - used, "  n%d: [%d mm, 0]\n", i, i);
  used += (size_t)snprintf(text + used, size - used, "members:\n");
  for (int i = 0; i < n; i++)
    used += (size_t)snprintf(text + used, size - used,
                             "  m%d: {group: g, nodes: [n%d, %c%d], rest_length: 0.9 mm}\n", i, i,
                             spoilt ? 'x' : 'n', i + 1);
  used += (size_t)snprintf(text + used, size - used, RUN);
  *length = used;
  return text;
}

static double seconds_to_read(int n, bool spoilt, strut_status expected) {
  size_t length;
  FREED char *text = chain(n, spoilt, &length);
  OWN(strut_setup) s;
  OWN(strut_diagnostics) diagnostics = {0};
  double begin = test_seconds();
  assert_int_equal(strut_setup_read(&s, "f", text, length, NULL, 0, STRUT_FOR_RUN, &diagnostics),
                   expected);
  double seconds = test_seconds() - begin;
  assert_int_equal(diagnostics.count + diagnostics.unstored, spoilt ? n : 0);
  return seconds;
}

/* Time grows with the size and not with its square, errors and suggestions included. */
TEST(big_files_take_linear_time) {
  double small = seconds_to_read(4000, false, STRUT_OK) + 0.01;
  assert_true(seconds_to_read(40000, false, STRUT_OK) < 40 * small);
  small = seconds_to_read(4000, true, STRUT_BAD_SCENE) + 0.05;
  assert_true(seconds_to_read(40000, true, STRUT_BAD_SCENE) < 40 * small);
}

/* Former names and synonyms mean what the current ones do; former ones are noted, once each. */
TEST(other_spellings) {
  static const char text[] =
      "strut: 1\n"
      "groups: {soft: {kind: string, stiffness: 10, damping: 1}}\n"
      "nodes: {a: {position: [0, 0], fixed: xy}, b: {position: [1, 0], mass: 1}}\n"
      "members: {m: {group: soft, nodes: [a, b]}, n: {kind: strut, stiffness: 5, nodes: [a, b]}}\n"
      "actuators: {d: {member: m, signal: {sine: {amplitude: 1e-3, frequency: 1}}}}\n"
      "ground: {height: -1, stiffness: 10, damping_law: printed}\n"
      "solver: {step: 1 ms}\n"
      "run: {periods: 9, of: d, measure: {steady: {floor: 1e-3, successive: 3}}}\n";
  OWN(strut_setup) s;
  OWN(strut_diagnostics) diagnostics = {0};
  assert_ok(
      strut_setup_read(&s, "test.yaml", text, strlen(text), NULL, 0, STRUT_FOR_RUN, &diagnostics));
  assert_all_equal(s.scene.members[0].kind, STRUT_CABLE, s.scene.members[1].kind, STRUT_BAR,
                   s.scene.ground.damping_law, STRUT_DAMPING_APPROACH);
  assert_true(s.scene.nodes[0].fixed[0] && s.scene.nodes[0].fixed[1]);
  assert_true(s.experiment.steady.floor == 1e-3 && s.experiment.steady.successive == 3);
  const char *notes = strut_diagnostics_render_notes(&diagnostics);
  assert_non_null(strstr(notes, "test.yaml:6:50: note: 'printed' is now called 'approach_only'\n"));
  assert_non_null(
      strstr(notes, "test.yaml:8:45: note: 'floor' is now called 'absolute_tolerance'\n"));
  assert_non_null(
      strstr(notes, "test.yaml:8:58: note: 'successive' is now called 'repetitions'\n"));
  assert_int_equal(diagnostics.note_count, 3);
}

/* A key by both of its names is given twice. */
TEST(both_spellings_of_a_key) {
  static const char text[] =
      "strut: 1\n"
      "nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1}}\n"
      "members: {m: {kind: bar, stiffness: 5, nodes: [a, b]}}\n"
      "actuators: {d: {member: m, signal: {sine: {amplitude: 1e-3, frequency: 1}}}}\n"
      "solver: {step: 1 ms}\n"
      "run: {periods: 9, of: d, measure: {steady: {floor: 1e-3, absolute_tolerance: 1e-3}}}\n";
  strut_setup s;
  OWN(strut_diagnostics) diagnostics = {0};
  assert_int_equal(
      strut_setup_read(&s, "test.yaml", text, strlen(text), NULL, 0, STRUT_FOR_RUN, &diagnostics),
      STRUT_BAD_SCENE);
  assert_non_null(strstr(strut_diagnostics_render(&diagnostics, 9),
                         "the steady state gives both 'floor' and 'absolute_tolerance', expected "
                         "one of them"));
}

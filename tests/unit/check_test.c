/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The semantic rules on scenes made without a file: each spoilt in one way, each finding named. Rules that files break
   as well are seen in tests/language/bad, with the places of their messages. */
#include "engine/scene/checks/check.h"
#include "tests/models/run_model.h"

/* A valid scene that uses much: its signals are wave, the table, the sum of both, the ramp. */
static const char text[] =
    "nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0]},\n"
    "        c: {position: [2, 0], mass: 1}}\n"
    "members: {ab: {kind: bar, nodes: [a, b], stiffness: 10, mass: 2},\n"
    "          bc: {kind: bar, nodes: [b, c], stiffness: 10, mass: 2}}\n"
    "ground: {stiffness: 100, nodes: [b, c],\n"
    "         friction: {mu_static: 0.2, mu_kinetic: 0.1, stick_velocity: 1e-4}}\n"
    "signals: {wave: {sine: {frequency: 2, amplitude: 0.1}}}\n"
    "actuators: {drive: {member: bc, signal: {sum: [wave, {table: [[0, 0], [1, 1]]}]}}}\n"
    "loads: {push: {node: c, force: [1, 0]},\n"
    "        swell: {node: b, force: [1, 0], signal: {ramp: {amplitude: 1, stop: 2}}}}\n"
    "initial: {settle: true}\n"
    "solver: {step: 1 ms}\n"
    "run: {periods: 10, of: wave, measure: {last: 5}}\n"
    "output: {last: 10}\n";

/* The same in arrays that a test may spoil. */
typedef struct sample {
  strut_setup setup;
  strut_node *nodes;
  strut_member *members;
  strut_contact *contacts;
  strut_actuator *actuators;
  strut_load *loads;
  strut_signal *signals;
  double time[2], value[2];
  int32_t terms[2];
} sample;

static void fill(sample *s) {
  strut_setup_free(&s->setup);
  s->setup = model_read_text("sample", text, set_none).setup;
  strut_scene *scene = &s->setup.scene;
  s->nodes = scene->nodes, s->members = scene->members, s->contacts = scene->contacts;
  s->actuators = scene->actuators, s->loads = scene->loads, s->signals = scene->signals;
  s->signals[1].time = memcpy(s->time, s->signals[1].time, sizeof s->time);
  s->signals[1].value = memcpy(s->value, s->signals[1].value, sizeof s->value);
  s->signals[2].terms = memcpy(s->terms, s->signals[2].terms, sizeof s->terms);
}

/* Checks the spoilt sample: exactly one finding, about that key, whose text has the word. */
static void expect(sample *s, strut_subject subject, size_t index, const char *key,
                   const char *word) {
  OWN(strut_findings) findings = {0};
  strut_status status = strut_setup_check(&s->setup, STRUT_FOR_RUN, &findings);
  if (findings.count != 1) {
    for (size_t i = 0; i < findings.count; i++) print_error("%s\n", findings.items[i].message);
    fail_msg("%zu findings instead of one: %s", findings.count, word);
  }
  const strut_finding *f = &findings.items[0];
  assert_int_equal(status, STRUT_BAD_SCENE);
  if (!strstr(f->message, word)) fail_msg("'%s' lacks '%s'", f->message, word);
  assert_all_equal(f->subject, subject, f->index, index);
  if (key && (!f->key || strcmp(f->key, key) != 0)) fail_msg("key %s, not %s", f->key, key);
  if (!key) assert_null(f->key);
  fill(s);
}

static sample s;

BEFORE_EACH { fill(&s); }
AFTER_ALL { strut_setup_free(&s.setup); }

/* The same of the sample after a change. */
#define EXPECT(change, subject, index, key, word)                                                  \
  do {                                                                                             \
    change;                                                                                        \
    expect(&s, STRUT_ON_##subject, index, key, word);                                              \
  } while (0)

TEST(a_valid_scene_has_no_findings) {
  OWN(strut_findings) findings = {0};
  assert_ok(strut_setup_check(&s.setup, STRUT_FOR_RUN, &findings));
  assert_ok(strut_setup_check(&s.setup, STRUT_FOR_STATICS, &findings));
  assert_int_equal(findings.count, 0);
}

TEST(nodes) {
  EXPECT(s.nodes[1].name = "a", NODE, 1, NULL, "two nodes 'a'");
  EXPECT(s.nodes[1].name = NULL, NODE, 1, NULL, "no name");
  EXPECT(s.nodes[1].name = "", NODE, 1, NULL, "no name");
  EXPECT(s.nodes[2].mass = -1, NODE, 2, "mass", "negative");
  EXPECT(s.nodes[2].mass = (double)INFINITY, NODE, 2, "mass", "finite");
  EXPECT(s.nodes[2].position[1] = (double)NAN, NODE, 2, "position", "finite");
  EXPECT(s.nodes[2].start[0] = (double)NAN, NODE, 2, "start", "finite");
  EXPECT(s.nodes[2].velocity[0] = (double)NAN, NODE, 2, "velocity", "finite");
  EXPECT(s.nodes[0].velocity[1] = 1, NODE, 0, "velocity", "fixed in y");
}

TEST(members) {
  for (int32_t bad = -1; bad <= 3; bad += 4) {
    s.members[0].node[1] = bad;
    expect(&s, STRUT_ON_MEMBER, 0, "nodes", "does not exist");
  }
  EXPECT(s.members[0].kind = (strut_member_kind)7, MEMBER, 0, "kind", "unknown");
  EXPECT(s.members[0].rest_kind = (strut_rest_kind)-1, MEMBER, 0, "kind", "unknown");
  EXPECT(s.members[0].stiffness = -1, MEMBER, 0, "stiffness", "negative");
  EXPECT((s.members[0].stiffness = 0, s.members[0].axial_stiffness = -1), MEMBER, 0,
         "axial_stiffness", "negative");
  EXPECT(s.members[0].axial_stiffness = 1, MEMBER, 0, "axial_stiffness", "both");
  EXPECT(s.members[0].damping = (double)NAN, MEMBER, 0, "damping", "finite");
  EXPECT(s.members[0].mass = -0.5, MEMBER, 0, "mass", "-0.5");
  EXPECT(s.members[0].rest_value = -1, MEMBER, 0, "rest_length_ratio", "negative");
  EXPECT((s.members[0].rest_kind = STRUT_REST_FORCE_DENSITY, s.members[0].rest_value = (double)NAN),
         MEMBER, 0, "force_density", "finite");
  EXPECT(
      (s.members[0].stiffness = 0, s.members[0].axial_stiffness = 5, s.members[0].rest_value = 0),
      MEMBER, 0, "rest_length_ratio", "above zero");
}

TEST(a_spring_of_no_length_may_begin_in_one_place) {
  strut_findings findings = {0};
  s.nodes[1].position[0] = s.nodes[1].start[0] = 0;
  s.members[0].rest_kind = STRUT_REST_LENGTH, s.members[0].rest_value = 0;
  assert_ok(strut_setup_check(&s.setup, STRUT_FOR_RUN, &findings));
}

TEST(ground) {
  EXPECT(s.setup.scene.ground.height = (double)NAN, GROUND, 0, "height", "finite");
  EXPECT(s.setup.scene.ground.belt_speed = (double)INFINITY, GROUND, 0, "belt_speed", "finite");
  EXPECT(s.setup.scene.ground.slope = (double)NAN, GROUND, 0, "slope", "between");
  EXPECT(s.setup.scene.ground.present = false, GROUND, 0, NULL, "no ground");
  EXPECT(s.contacts[1].node = 3, CONTACT, 1, NULL, "does not exist");
  EXPECT(s.contacts[1].node = 1, CONTACT, 1, NULL, "out of order");
  EXPECT(s.contacts[1].stiffness = 0, CONTACT, 1, "stiffness", "above zero");
  EXPECT(s.contacts[1].damping = -1, CONTACT, 1, "damping", "negative");
  EXPECT(s.contacts[0].friction.mu_static = -1, CONTACT, 0, "mu_static", "node 'b'");
  EXPECT(s.contacts[0].friction.mu_static = 0.05, CONTACT, 0, "mu_static",
         "below kinetic friction");
  EXPECT(s.contacts[0].friction.mu_kinetic = (double)NAN, CONTACT, 0, "mu_kinetic", "finite");
  EXPECT(s.contacts[0].friction.stick_velocity = 0, CONTACT, 0, "stick_velocity", "above zero");
  EXPECT(s.contacts[0].friction.law = (strut_friction_law)9, CONTACT, 0, "law", "unknown");
}

TEST(signals) {
  EXPECT((s.setup.experiment.periods = 0, s.setup.experiment.duration = 20,
          s.signals[0].frequency = 0),
         SIGNAL, 0, "frequency", "signal 'wave'");
  EXPECT(s.signals[0].frequency = (double)NAN, SIGNAL, 0, "frequency",
         "finite"); /* and the run does not say it again */
  EXPECT(s.signals[0].amplitude = (double)INFINITY, SIGNAL, 0, "amplitude", "finite");
  EXPECT((s.signals[0].start = 3, s.signals[0].stop = 3), SIGNAL, 0, "stop", "after its start");
  EXPECT(s.signals[3].stop = (double)INFINITY, SIGNAL, 3, "stop", "load 'swell' needs a stop");
  EXPECT(s.time[1] = -1, SIGNAL, 1, "table", "actuator 'drive' must increase");
  EXPECT(s.value[1] = (double)NAN, SIGNAL, 1, "table", "point 2");
  EXPECT(s.terms[0] = 2, SIGNAL, 2, "sum", "term 1");
  EXPECT(s.terms[1] = -1, SIGNAL, 2, "sum", "term 2");
  EXPECT(s.signals[1].kind = (strut_signal_kind)12, SIGNAL, 1, NULL, "unknown kind");
}

/* Sums of sums: two terms each make 2^40 in 40 steps; a chain of 100 is too deep to evaluate. */
TEST(sums_cannot_explode) {
  static strut_signal signals[101];
  static int32_t terms[101][2];
  for (int wide = 0; wide < 2; wide++) {
    OWN(strut_findings) findings = {0};
    fill(&s);
    signals[0] = strut_signal_default(STRUT_CONSTANT);
    for (int i = 1; i <= 100; i++) {
      signals[i] = strut_signal_default(STRUT_SUM);
      terms[i][0] = terms[i][1] = i - 1;
      signals[i].terms = terms[i], signals[i].term_count = wide ? 2 : 1;
    }
    s.setup.scene.signals = signals, s.setup.scene.signal_count = wide ? 41 : 101;
    s.setup.scene.actuators[0].signal = wide ? 40 : 100;
    s.setup.scene.load_count = 1;
    s.setup.experiment.periods = 0, s.setup.experiment.duration = 20;
    assert_int_equal(strut_setup_check(&s.setup, STRUT_FOR_RUN, &findings), STRUT_BAD_SCENE);
    assert_int_equal(findings.count, 1);
    assert_non_null(strstr(findings.items[0].message, "more than 10000 terms"));
  }
}

TEST(drives) {
  EXPECT(s.actuators[0].member = 2, ACTUATOR, 0, "member", "does not exist");
  EXPECT(s.actuators[0].signal = -1, ACTUATOR, 0, "signal", "no signal");
  EXPECT(s.actuators[0].signal = 4, ACTUATOR, 0, "signal", "no signal");
  EXPECT(s.loads[0].node = -1, LOAD, 0, "node", "does not exist");
  EXPECT(s.loads[0].force[1] = (double)NAN, LOAD, 0, "force", "finite");
  EXPECT(s.loads[0].signal = 4, LOAD, 0, "signal", "does not exist");
}

TEST(motions) {
  strut_support_motion motions[2], *second = &motions[1];
#define SPOILT(change, subject, index, key, word)                                                  \
  do {                                                                                             \
    motions[0] = (strut_support_motion){0, 0, 0}, motions[1] = (strut_support_motion){0, 1, 0};    \
    s.setup.scene.support_motions = motions, s.setup.scene.support_motion_count = 2;               \
    EXPECT(change, subject, index, key, word);                                                     \
  } while (0)
  SPOILT(second->axis = 0, NODE, 0, "moves", "out of order");
  SPOILT(second->node = 1, NODE, 1, "moves", "not fixed");
  SPOILT(second->node = 7, SCENE, 0, "nodes", "does not exist");
  SPOILT(second->axis = 2, NODE, 0, "moves", "axis");
  SPOILT(second->signal = 4, NODE, 0, "moves", "a signal that does not exist");
#undef SPOILT
}

TEST(shapes) {
  int32_t nodes[2] = {1, 2};
  double position[3][2] = {{0, 0}, {1, 0}, {2, 0}};
  strut_node_set set = {2, nodes};
  strut_configuration configuration = {"I", true, position, 1, &set};
  strut_configuration two[2] = {configuration, configuration};
#define SPOILT(change, subject, index, key, word)                                                  \
  do {                                                                                             \
    s.setup.scene.configurations = two, s.setup.scene.configuration_count = 1;                     \
    two[0] = configuration, set = (strut_node_set){2, nodes};                                      \
    nodes[0] = 1, nodes[1] = 2, position[2][1] = 0;                                                \
    EXPECT(change, subject, index, key, word);                                                     \
  } while (0)
  SPOILT(s.setup.scene.configuration_count = 2, CONFIGURATION, 1, NULL, "two configurations 'I'");
  SPOILT(nodes[1] = 3, CONFIGURATION, 0, "contacts", "does not exist");
  SPOILT(position[2][1] = (double)NAN, CONFIGURATION, 0, NULL, "not finite");
  SPOILT((s.setup.experiment.search.supports = &set, s.setup.experiment.search.support_count = 1,
          s.setup.scene.configuration_count = 0, nodes[0] = -1),
         EQUILIBRIA, 0, "supports", "does not exist");
  SPOILT(s.setup.experiment.search.starts = -1, EQUILIBRIA, 0, "starts", "from 0");
  SPOILT(s.setup.experiment.search.seed = UINT64_MAX, EQUILIBRIA, 0, "seed", "at most");
  SPOILT(s.setup.scene.start_equilibrium = 1, INITIAL, 0, NULL, "does not exist");
  SPOILT(s.setup.scene.start_equilibrium = 0, INITIAL, 0, NULL, "nothing to settle");
#undef SPOILT
}

TEST(experiment) {
  strut_experiment *e = &s.setup.experiment;
  EXPECT(s.setup.experiment.settle.speed = 0, INITIAL, 0, "speed", "above zero");
  EXPECT(s.setup.experiment.settle.limit = (double)NAN, INITIAL, 0, "limit", "finite");
  EXPECT(s.setup.scene.gravity[1] = (double)NAN, SCENE, 0, "gravity", "finite");
  EXPECT(s.setup.scene.mass_model = (strut_mass_model)5, SCENE, 0, "mass_model", "unknown");
  EXPECT(e->step = -1, SOLVER, 0, "step", "above zero");
  EXPECT(e->step = (double)NAN, SOLVER, 0, "step", "finite");
  EXPECT(e->integrator = "", SOLVER, 0, "integrator", "no integrator");
  EXPECT(e->duration = 1, RUN, 0, "periods", "both");
  EXPECT(e->duration = -1, RUN, 0, "duration", "negative");
  EXPECT(e->period_signal = 3, RUN, 0, "of", "no period");
  EXPECT(e->period_signal = 4, RUN, 0, "of", "needs a signal");
  EXPECT((e->periods = 1e308, s.signals[0].frequency = 1e-10), RUN, 0, "periods", "overflows");
  EXPECT(e->measure_node = 3, RUN, 0, "node", "does not exist");
  EXPECT(e->output_last = 11, OUTPUT, 0, "last", "cannot record");
  EXPECT(e->output_every = -1, OUTPUT, 0, "every", "negative");
}

TEST(statics_need_neither_mass_nor_run) {
  OWN(strut_findings) findings = {0};
  s.nodes[2].mass = s.members[0].mass = s.members[1].mass = 0;
  s.setup.experiment.step = s.setup.experiment.periods = 0;
  s.setup.experiment.measure_last = s.setup.experiment.output_last = 0;
  assert_ok(strut_setup_check(&s.setup, STRUT_FOR_STATICS, &findings));
  assert_int_equal(strut_setup_check(&s.setup, STRUT_FOR_RUN, &findings), STRUT_BAD_SCENE);
  assert_int_equal(findings.count, 4); /* nodes b and c, the step, the run */
}

TEST(no_memory) {
  strut_status status = STRUT_NO_MEMORY;
  s.nodes[2].mass = -1;
  for (int n = 0; status == STRUT_NO_MEMORY && n < 100; n++) {
    OWN(strut_findings) findings = {0};
    strut_fail_allocation_after(n);
    status = strut_setup_check(&s.setup, STRUT_FOR_RUN, &findings);
    strut_fail_allocation_after(-1);
  }
  assert_int_equal(status, STRUT_BAD_SCENE);
}

/* A valid cell and a valid collision, each spoilt in turn. */
TEST(cells_and_collisions) {
  int32_t corners[3], *node = corners;
  strut_cell cell;
  strut_collision collision;
#define SPOILT(change, subject, key, word)                                                         \
  do {                                                                                             \
    fill(&s);                                                                                      \
    corners[0] = 0, corners[1] = 1, corners[2] = 2;                                                \
    cell = strut_cell_default(), collision = strut_collision_default();                            \
    cell.name = "bag", cell.node = node, cell.node_count = 3, cell.pressure = 1;                   \
    collision.name = "hit", collision.node[0] = 0, collision.node[1] = 2;                          \
    collision.thickness = 0.1, collision.stiffness = 1;                                            \
    s.nodes[2].position[1] += 0.5, s.nodes[2].start[1] += 0.5;                                     \
    s.setup.scene.cells = &cell, s.setup.scene.cell_count = 1;                                     \
    s.setup.scene.collisions = &collision, s.setup.scene.collision_count = 1;                      \
    change;                                                                                        \
    expect(&s, subject, 0, key, word);                                                             \
  } while (0)
  SPOILT(cell.node_count = 2, STRUT_ON_CELL, "nodes", "3 to 32");
  SPOILT(node[1] = 7, STRUT_ON_CELL, "nodes", "does not exist");
  SPOILT(cell.pressure = (double)NAN, STRUT_ON_CELL, "pressure", "finite");
  SPOILT(cell.law = STRUT_LAW_PLAY, STRUT_ON_CELL, "gas", "not for cells");
  SPOILT(cell.law = STRUT_LAW_LINEAR, STRUT_ON_CELL, NULL, "neither stiffness nor damping");
  SPOILT((cell.law = STRUT_LAW_ISOTHERMAL, cell.pressure = 0), STRUT_ON_CELL, "pressure", "above");
  SPOILT((cell.law = STRUT_LAW_ISENTROPIC, cell.outside = -1), STRUT_ON_CELL, "outside",
         "negative");
  SPOILT(collision.thickness = 0, STRUT_ON_COLLISION, "thickness", "above zero");
  SPOILT(collision.damping = -1, STRUT_ON_COLLISION, "damping", "negative");
  SPOILT(collision.node[1] = 9, STRUT_ON_COLLISION, NULL, "does not exist");
  SPOILT(collision.node[1] = -1, STRUT_ON_COLLISION, NULL, "two nodes, of two members");
  SPOILT(s.members[0].law.kind = STRUT_LAW_ISOTHERMAL, STRUT_ON_MEMBER, "law", "cells only");
#undef SPOILT
}

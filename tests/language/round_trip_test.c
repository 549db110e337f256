/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is written reads back to the same bits, for every valid scene of the repository. */
#include <locale.h>

#include "parser/language/keys/keys.h"
#include "parser/language/write/write_scene.h"
#include "tests/language/scenes.h"
#include "tests/support/check.h"

static void same_bits(const char *what, const void *a, const void *b, size_t size) {
  if (memcmp(a, b, size) != 0) fail_msg("%s: not the same bits", what);
}

#define SAME(field) same_bits(#field, &a->field, &b->field, sizeof a->field)

static void same_nodes(const strut_setup *first, const strut_setup *second) {
  assert_int_equal(first->scene.node_count, second->scene.node_count);
  for (size_t i = 0; i < first->scene.node_count; i++) {
    const strut_node *a = &first->scene.nodes[i], *b = &second->scene.nodes[i];
    assert_string_equal(a->name, b->name);
    SAME(position), SAME(mass), SAME(fixed), SAME(start), SAME(velocity);
  }
}

static void same_members(const strut_setup *first, const strut_setup *second) {
  assert_int_equal(first->scene.member_count, second->scene.member_count);
  for (size_t i = 0; i < first->scene.member_count; i++) {
    const strut_member *a = &first->scene.members[i], *b = &second->scene.members[i];
    assert_string_equal(a->name, b->name);
    SAME(node), SAME(kind), SAME(stiffness), SAME(axial_stiffness), SAME(damping), SAME(mass);
    SAME(rest_kind), SAME(rest_value);
  }
}

static void same_ground(const strut_setup *a, const strut_setup *b) {
  SAME(scene.ground.present), SAME(scene.ground.height), SAME(scene.ground.slope);
  SAME(scene.ground.belt_speed), SAME(scene.ground.damping_law);
  assert_int_equal(a->scene.contact_count, b->scene.contact_count);
  for (size_t i = 0; i < a->scene.contact_count; i++) {
    SAME(scene.contacts[i].node), SAME(scene.contacts[i].stiffness);
    SAME(scene.contacts[i].damping), SAME(scene.contacts[i].dissipation);
    SAME(scene.contacts[i].friction.law), SAME(scene.contacts[i].friction.mu_static);
    SAME(scene.contacts[i].friction.mu_kinetic), SAME(scene.contacts[i].friction.stick_velocity);
    SAME(scene.contacts[i].friction.width);
  }
}

static void same_signals(const strut_setup *first, const strut_setup *second) {
  assert_int_equal(first->scene.signal_count, second->scene.signal_count);
  for (size_t i = 0; i < first->scene.signal_count; i++) {
    const strut_signal *a = &first->scene.signals[i], *b = &second->scene.signals[i];
    assert_int_equal(a->name == NULL, b->name == NULL);
    if (a->name) assert_string_equal(a->name, b->name);
    SAME(kind), SAME(amplitude), SAME(frequency), SAME(phase), SAME(start), SAME(stop);
    SAME(point_count), SAME(term_count);
    if (a->point_count) {
      same_bits("times", a->time, b->time, a->point_count * sizeof *a->time);
      same_bits("values", a->value, b->value, a->point_count * sizeof *a->value);
    }
    if (a->term_count) same_bits("terms", a->terms, b->terms, a->term_count * sizeof *a->terms);
  }
}

static void same_drives(const strut_setup *a, const strut_setup *b) {
  assert_int_equal(a->scene.actuator_count, b->scene.actuator_count);
  assert_int_equal(a->scene.load_count, b->scene.load_count);
  for (size_t i = 0; i < a->scene.actuator_count; i++) {
    assert_string_equal(a->scene.actuators[i].name, b->scene.actuators[i].name);
    SAME(scene.actuators[i].member), SAME(scene.actuators[i].signal);
  }
  for (size_t i = 0; i < a->scene.load_count; i++) {
    assert_string_equal(a->scene.loads[i].name, b->scene.loads[i].name);
    SAME(scene.loads[i].node), SAME(scene.loads[i].force), SAME(scene.loads[i].moment);
    assert_true(!a->scene.loads[i].couple ||
                (b->scene.loads[i].couple && a->scene.loads[i].hinge == b->scene.loads[i].hinge &&
                 a->scene.loads[i].member == b->scene.loads[i].member));
    SAME(scene.loads[i].signal);
  }
}

static void same_sets(const strut_node_set *a, const strut_node_set *b, size_t count) {
  for (size_t i = 0; i < count; i++, a++, b++) {
    SAME(count);
    same_bits("nodes of a set", a->node, b->node, a->count * sizeof *a->node);
  }
}

static void same_shapes(const strut_setup *a, const strut_setup *b) {
  SAME(scene.configuration_count);
  for (size_t i = 0; i < a->scene.configuration_count; i++) {
    const strut_configuration *c = &a->scene.configurations[i], *d = &b->scene.configurations[i];
    assert_string_equal(c->name, d->name);
    SAME(scene.configurations[i].shaped), SAME(scene.configurations[i].set_count);
    same_bits("positions", c->position, d->position, a->scene.node_count * sizeof *c->position);
    same_sets(c->sets, d->sets, c->set_count);
  }
  SAME(scene.start_equilibrium), SAME(experiment.search.starts), SAME(experiment.search.seed);
  SAME(experiment.search.support_count);
  same_sets(a->experiment.search.supports, b->experiment.search.supports,
            a->experiment.search.support_count);
}

static void same_scene(const strut_setup *a, const strut_setup *b) {
  assert_all_texts(a->scene.name, b->scene.name, a->scene.description, b->scene.description);
  assert_string_equal(a->scene.source, b->scene.source);
  SAME(scene.mass_model), SAME(scene.bar_model), SAME(scene.gravity);
  same_nodes(a, b);
  same_members(a, b);
  same_ground(a, b);
  same_signals(a, b);
  same_drives(a, b);
  same_shapes(a, b);
  SAME(experiment.settle.wanted);
  if (a->experiment.settle.wanted) {
    SAME(experiment.settle.speed), SAME(experiment.settle.acceleration);
    SAME(experiment.settle.limit), SAME(experiment.settle.friction);
  }
  assert_string_equal(a->experiment.integrator, b->experiment.integrator);
  SAME(experiment.step), SAME(experiment.duration), SAME(experiment.periods);
  SAME(experiment.period_signal), SAME(experiment.measure_last), SAME(experiment.tolerance);
  SAME(experiment.refine), SAME(experiment.refine_time), SAME(experiment.accuracy);
  SAME(experiment.steady.wanted), SAME(experiment.steady.tolerance), SAME(experiment.steady.floor);
  SAME(experiment.steady.successive), SAME(experiment.measure_node), SAME(experiment.output_every);
  SAME(experiment.output_last), SAME(experiment.channels);
}

/* The text behind the comments at its head. */
static const char *body(const char *text) {
  while (*text == '#') text = strchr(text, '\n') + 1;
  return text;
}

TEST(written_scenes_read_back_to_the_same_bits) {
  scene_file *files;
  size_t count = scene_files(&files);
  for (size_t i = 0; i < count; i++) {
    strut_setup first, second;
    if (read_quietly_as(files[i].path, files[i].text, files[i].length, &first) != STRUT_OK)
      fail_msg("%s is refused", files[i].path);
    RELEASED char *written = strut_setup_write(&first);
    assert_non_null(written);
    if (read_quietly_as(files[i].path, written, strlen(written), &second) != STRUT_OK)
      fail_msg("%s, written: refused:\n%s", files[i].path, written);
    same_scene(&first, &second);
    RELEASED char *again = strut_setup_write(&second);
    assert_non_null(again);
    assert_string_equal(body(written), body(again));
    strut_setup_free(&first);
    strut_setup_free(&second);
  }
  free_scene_files(files, count);
}

/* Numbers whose shortest text is easily got wrong, through the whole writer and reader. */
TEST(single_numbers_survive) {
  uint64_t seed = 12345;
  strut_node nodes[2] = {{.name = "a", .mass = 1}, {.name = "b", .mass = 1}};
  strut_setup setup;
  strut_setup_init(&setup);
  setup.scene.nodes = nodes;
  setup.scene.node_count = 2;
  setup.experiment.step = 1e-3;
  setup.experiment.duration = 1;
  static const double corners[] = {0.1,
                                   1.0 / 3,
                                   5e-324,
                                   2.2250738585072014e-308,
                                   1e15,
                                   1e22,
                                   -0.0,
                                   1e16,
                                   123456789012345680.0,
                                   9007199254740993.0,
                                   1e-7,
                                   1.7976931348623157e308};
  for (size_t i = 0; i < 2000; i++) {
    uint64_t bits = seed = seed * 6364136223846793005u + 1442695040888963407u;
    double value;
    memcpy(&value, &bits, sizeof value);
    if (i < sizeof corners / sizeof corners[0]) value = corners[i];
    if (!(value - value == 0.0)) continue;
    setup.scene.gravity[0] = value;
    RELEASED char *text = strut_setup_write(&setup);
    OWN(strut_setup) back;
    assert_ok(read_quietly(text, strlen(text), &back));
    same_bits(text, &back.scene.gravity[0], &value, sizeof value);
  }
}

/* A scene of the C interface whose drive has no name anywhere still says what its periods are of. */
TEST(a_nameless_period_gets_a_name) {
  strut_node nodes[1] = {{.name = "a", .mass = 1}};
  strut_signal signal = strut_signal_default(STRUT_SINE);
  signal.amplitude = 1, signal.frequency = 4, signal.phase = 0.25;
  strut_setup setup, back;
  strut_setup_init(&setup);
  setup.scene.nodes = nodes;
  setup.scene.node_count = 1;
  setup.scene.signals = &signal;
  setup.scene.signal_count = 1;
  setup.experiment.step = 1e-3;
  setup.experiment.periods = 3;
  setup.experiment.period_signal = 0;
  setup.scene.name = "quote \" slash \\ line\nbreak \xe2\x80\xa8 tab \t control \x01 bad \xff.";
  RELEASED char *text = strut_setup_write(&setup);
  assert_ok(read_quietly(text, strlen(text), &back));
  assert_string_equal(back.scene.name,
                      "quote \" slash \\ line\nbreak \xe2\x80\xa8 tab \t control \xef\xbf\xbd bad "
                      "\xef\xbf\xbd.");
  assert_true(back.scene.signals[back.experiment.period_signal].phase == 0.25);
  strut_setup_free(&back);
}

TEST(every_key_stands_in_a_good_file) {
  scene_file *files;
  size_t count = scene_files(&files);
  for (int key = 0; key < strut_section_first(STRUT_SECTION_STUDY);
       key++) { /* studies: study_test.c */
    char with_colon[60];
    bool found = false;
    snprintf(with_colon, sizeof with_colon, "%s:", strut_key_at(key)->name);
    for (size_t i = 0; i < count && !found; i++) found = strstr(files[i].text, with_colon) != NULL;
    if (!found) fail_msg("no good file has the key '%s'", strut_key_at(key)->name);
  }
  free_scene_files(files, count);
}

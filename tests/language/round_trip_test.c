/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is written reads back to the same bits, for every valid scene of the repository. */
#include <locale.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "parser/language/keys.h"
#include "parser/write/write_scene.h"
#include "tests/language/scenes.h"

static void same_bits(const char *what, const void *a, const void *b, size_t size) {
  if (memcmp(a, b, size) != 0) fail_msg("%s: not the same bits", what);
}

#define SAME(field) same_bits(#field, &a->field, &b->field, sizeof a->field)

static void same_nodes(const strut_scene *first, const strut_scene *second) {
  assert_int_equal(first->node_count, second->node_count);
  for (size_t i = 0; i < first->node_count; i++) {
    const strut_node *a = &first->nodes[i], *b = &second->nodes[i];
    assert_string_equal(a->name, b->name);
    SAME(position);
    SAME(mass);
    SAME(fixed);
    SAME(start);
    SAME(velocity);
  }
}

static void same_members(const strut_scene *first, const strut_scene *second) {
  assert_int_equal(first->member_count, second->member_count);
  for (size_t i = 0; i < first->member_count; i++) {
    const strut_member *a = &first->members[i], *b = &second->members[i];
    assert_string_equal(a->name, b->name);
    SAME(node);
    SAME(kind);
    SAME(stiffness);
    SAME(axial_stiffness);
    SAME(damping);
    SAME(mass);
    SAME(rest_kind);
    SAME(rest_value);
  }
}

static void same_ground(const strut_scene *a, const strut_scene *b) {
  SAME(ground.present);
  SAME(ground.height);
  SAME(ground.slope);
  SAME(ground.belt_speed);
  SAME(ground.damping_law);
  assert_int_equal(a->contact_count, b->contact_count);
  for (size_t i = 0; i < a->contact_count; i++) {
    SAME(contacts[i].node);
    SAME(contacts[i].stiffness);
    SAME(contacts[i].damping);
    SAME(contacts[i].dissipation);
    SAME(contacts[i].friction.law);
    SAME(contacts[i].friction.mu_static);
    SAME(contacts[i].friction.mu_kinetic);
    SAME(contacts[i].friction.stick_velocity);
    SAME(contacts[i].friction.width);
  }
}

static void same_signals(const strut_scene *first, const strut_scene *second) {
  assert_int_equal(first->signal_count, second->signal_count);
  for (size_t i = 0; i < first->signal_count; i++) {
    const strut_signal *a = &first->signals[i], *b = &second->signals[i];
    assert_int_equal(a->name == NULL, b->name == NULL);
    if (a->name) assert_string_equal(a->name, b->name);
    SAME(kind);
    SAME(amplitude);
    SAME(frequency);
    SAME(phase);
    SAME(start);
    SAME(stop);
    SAME(point_count);
    SAME(term_count);
    if (a->point_count) {
      same_bits("times", a->time, b->time, a->point_count * sizeof *a->time);
      same_bits("values", a->value, b->value, a->point_count * sizeof *a->value);
    }
    if (a->term_count) same_bits("terms", a->terms, b->terms, a->term_count * sizeof *a->terms);
  }
}

static void same_drives(const strut_scene *a, const strut_scene *b) {
  assert_int_equal(a->actuator_count, b->actuator_count);
  assert_int_equal(a->load_count, b->load_count);
  for (size_t i = 0; i < a->actuator_count; i++) {
    assert_string_equal(a->actuators[i].name, b->actuators[i].name);
    SAME(actuators[i].member);
    SAME(actuators[i].signal);
  }
  for (size_t i = 0; i < a->load_count; i++) {
    assert_string_equal(a->loads[i].name, b->loads[i].name);
    SAME(loads[i].node);
    SAME(loads[i].force);
    SAME(loads[i].signal);
  }
}

static void same_sets(const strut_node_set *a, const strut_node_set *b, size_t count) {
  for (size_t i = 0; i < count; i++, a++, b++) {
    SAME(count);
    same_bits("nodes of a set", a->node, b->node, a->count * sizeof *a->node);
  }
}

static void same_shapes(const strut_scene *a, const strut_scene *b) {
  SAME(configuration_count);
  for (size_t i = 0; i < a->configuration_count; i++) {
    const strut_configuration *c = &a->configurations[i], *d = &b->configurations[i];
    assert_string_equal(c->name, d->name);
    SAME(configurations[i].shaped);
    SAME(configurations[i].set_count);
    same_bits("positions", c->position, d->position, a->node_count * sizeof *c->position);
    same_sets(c->sets, d->sets, c->set_count);
  }
  SAME(start_equilibrium);
  SAME(search.starts);
  SAME(search.seed);
  SAME(search.support_count);
  same_sets(a->search.supports, b->search.supports, a->search.support_count);
}

static void same_scene(const strut_scene *a, const strut_scene *b) {
  assert_string_equal(a->name, b->name);
  assert_string_equal(a->description, b->description);
  assert_string_equal(a->source, b->source);
  SAME(mass_model);
  SAME(bar_model);
  SAME(gravity);
  same_nodes(a, b);
  same_members(a, b);
  same_ground(a, b);
  same_signals(a, b);
  same_drives(a, b);
  same_shapes(a, b);
  SAME(settle.wanted);
  if (a->settle.wanted) {
    SAME(settle.speed);
    SAME(settle.acceleration);
    SAME(settle.limit);
    SAME(settle.friction);
  }
  assert_string_equal(a->experiment.integrator, b->experiment.integrator);
  SAME(experiment.step);
  SAME(experiment.duration);
  SAME(experiment.periods);
  SAME(experiment.period_signal);
  SAME(experiment.measure_last);
  SAME(experiment.tolerance);
  SAME(experiment.refine);
  SAME(experiment.refine_time);
  SAME(experiment.accuracy);
  SAME(experiment.steady.wanted);
  SAME(experiment.steady.tolerance);
  SAME(experiment.steady.floor);
  SAME(experiment.steady.successive);
  SAME(experiment.steady.shooting);
  SAME(experiment.measure_node);
  SAME(experiment.output_every);
  SAME(experiment.output_last);
  SAME(experiment.channels);
}

/* The text behind the comments at its head. */
static const char *body(const char *text) {
  while (*text == '#') text = strchr(text, '\n') + 1;
  return text;
}

static void written_scenes_read_back_to_the_same_bits(void **state) {
  (void)state;
  scene_file *files;
  size_t count = scene_files(&files);
  for (size_t i = 0; i < count; i++) {
    strut_scene first, second;
    if (read_quietly(files[i].text, files[i].length, &first) != STRUT_OK)
      fail_msg("%s is refused", files[i].path);
    char *written = strut_scene_write(&first);
    assert_non_null(written);
    if (read_quietly(written, strlen(written), &second) != STRUT_OK)
      fail_msg("%s, written: refused:\n%s", files[i].path, written);
    same_scene(&first, &second);
    char *again = strut_scene_write(&second);
    assert_non_null(again);
    assert_string_equal(body(written), body(again));
    strut_release(written);
    strut_release(again);
    strut_scene_free(&first);
    strut_scene_free(&second);
  }
  free_scene_files(files, count);
}

/* Numbers whose shortest text is easily got wrong, through the whole writer and reader. */
static void single_numbers_survive(void **state) {
  (void)state;
  uint64_t seed = 12345;
  strut_node nodes[2] = {{.name = "a", .mass = 1}, {.name = "b", .mass = 1}};
  strut_scene scene;
  strut_scene_init(&scene);
  scene.nodes = nodes;
  scene.node_count = 2;
  scene.experiment.step = 1e-3;
  scene.experiment.duration = 1;
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
    nodes[0].position[0] = nodes[0].start[0] = value;
    char *text = strut_scene_write(&scene);
    strut_scene back;
    assert_int_equal(read_quietly(text, strlen(text), &back), STRUT_OK);
    same_bits(text, &back.nodes[0].position[0], &value, sizeof value);
    strut_scene_free(&back);
    strut_release(text);
  }
}

/* A scene of the C interface whose drive has no name anywhere still says what its periods are of. */
static void a_nameless_period_gets_a_name(void **state) {
  (void)state;
  strut_node nodes[1] = {{.name = "a", .mass = 1}};
  strut_signal signal = strut_signal_default(STRUT_SINE);
  signal.amplitude = 1;
  signal.frequency = 4;
  signal.phase = 0.25;
  strut_scene scene, back;
  strut_scene_init(&scene);
  scene.nodes = nodes;
  scene.node_count = 1;
  scene.signals = &signal;
  scene.signal_count = 1;
  scene.experiment.step = 1e-3;
  scene.experiment.periods = 3;
  scene.experiment.period_signal = 0;
  scene.name = "quote \" slash \\ line\nbreak \xe2\x80\xa8 tab \t control \x01 bad \xff.";
  char *text = strut_scene_write(&scene);
  assert_int_equal(read_quietly(text, strlen(text), &back), STRUT_OK);
  assert_string_equal(back.name,
                      "quote \" slash \\ line\nbreak \xe2\x80\xa8 tab \t control \xef\xbf\xbd bad "
                      "\xef\xbf\xbd.");
  assert_true(back.signals[back.experiment.period_signal].phase == 0.25);
  strut_scene_free(&back);
  strut_release(text);
}

static void every_key_stands_in_a_good_file(void **state) {
  (void)state;
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

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(written_scenes_read_back_to_the_same_bits),
      cmocka_unit_test(single_numbers_survive),
      cmocka_unit_test(a_nameless_period_gets_a_name),
      cmocka_unit_test(every_key_stands_in_a_good_file),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Comparing: differences of texts, every allocation failing once, an interrupt, what is reported. */
#include "engine/study/compare/compare.h"
#include "engine/output/result_values.h"
#include "parser/language/read/reuse/overlay.h"
#include "tests/models/run_model.h"
#include "tests/support/check.h"

static const char hopper[] =
    "name: hopper, of \"one\" leg\n"
    "nodes: {a: {position: [0, 0], mass: 1 kg}, b: {position: [0, 0.1], mass: 1 kg}}\n"
    "members: {leg: {kind: spring, nodes: [a, b], stiffness: 4000 N/m, damping: 20 N s/m}}\n"
    "gravity: [0, -9.81]\n"
    "ground: {stiffness: 1e5 N/m, damping: 100 N s/m, friction: {mu: 0.1, stick_velocity: 1 "
    "mm/s}}\n"
    "actuators: {d: {member: leg, signal: {sine: {amplitude: 1 mm, frequency: 5 Hz}}}}\n"
    "solver: {step: 0.1 ms}\n"
    "run: {periods: 20, of: d, measure: {last: 5}}\n";

static strut_setup read_hopper(void) { return model_read_text("hopper", hopper, set_none).setup; }

TEST(differences) {
  static const char first[] = "name: A\na: {b: 1, c: [1, {d: 2}], e: {f: 3}}\ng: 1\nsame: {x: 1}\n";
  static const char second[] = "name: B\nsame: {x: 1}\nnew: [1]\na: {b: 2, c: [1, {d: 3}]}\n";
  static const strut_difference wanted[] = {{"a.b", "1", "2"},
                                            {"a.c", "[1, {d: 2}]", "[1, {d: 3}]"},
                                            {"a.e", "{f: 3}", NULL},
                                            {"g", "1", NULL},
                                            {"new", NULL, "[1]"}};
  OWN(strut_arena) arena = {0};
  strut_difference *list;
  size_t count;
  assert_ok(strut_text_differences(first, second, &arena, &list, &count));
  assert_int_equal(count, 5);
  for (size_t i = 0; i < count; i++) {
    assert_string_equal(list[i].where, wanted[i].where);
    assert_all_equal(!list[i].was, !wanted[i].was, !list[i].is, !wanted[i].is);
    if (list[i].was) assert_string_equal(list[i].was, wanted[i].was);
    if (list[i].is) assert_string_equal(list[i].is, wanted[i].is);
  }
  assert_ok(strut_text_differences(first, first, &arena, &list, &count));
  assert_int_equal(count, 0);
  assert_int_equal(strut_text_differences(first, "a: [", &arena, &list, &count), STRUT_BAD_SCENE);
}

TEST(differences_without_memory) {
  REFUSE_EACH(n, status, 3) {
    OWN(strut_arena) arena = {0};
    strut_difference *list;
    size_t count;
    status = refused(
        n, strut_text_differences("a: {b: 1, c: 2}\n", "a: {b: 3}\n", &arena, &list, &count));
  }
}

/* Makes and tells; the status of what failed first. */
static strut_status make(const strut_compare_options *options, bool tell) {
  static const strut_difference changed = {"members.leg.stiffness", "1", "2"};
  static const char *const without[] = {"friction"};
  strut_setup scenes[2];
  OWN(strut_compare) result;
  strut_error error = {0};
  for (int i = 0; i < 2; i++) scenes[i] = read_hopper();
  const strut_compare_input inputs[2] = {{.label = "one", .setup = &scenes[0]},
                                         {.label = "two",
                                          .setup = &scenes[1],
                                          .differences = &changed,
                                          .difference_count = 1,
                                          .without = without,
                                          .without_count = 1}};
  strut_status status = strut_compare_make(inputs, 2, options, &result, &error);
  if (status != STRUT_OK) assert_int_equal(error.status, status);
  if (status == STRUT_OK && tell) {
    char *texts[] = {strut_values_text(&strut_compare_values, &result, NULL, 60, STRUT_REPORT_ROWS),
                     strut_values_csv(&strut_compare_values, "models", NULL, &result, NULL),
                     strut_values_json(&strut_compare_values, &result, NULL)};
    for (int i = 0; i < 3; i++) {
      if (!texts[i]) status = STRUT_NO_MEMORY;
      strut_release(texts[i]);
    }
  }
  for (int i = 0; i < 2; i++) strut_setup_free(&scenes[i]);
  return status;
}

TEST(without_memory) {
  const strut_compare_options options = {.no_states = true, .accuracy = 0.05};
  strut_status status = STRUT_NO_MEMORY;
  uint64_t before = strut_allocation_count();
  assert_ok(make(&options, true));
  int64_t all = (int64_t)(strut_allocation_count() - before), refused = 0;
  for (int64_t n = 0; n < all; n += 1 + all / 400) {
    strut_setup probe; /* what reading takes is not asked here */
    uint64_t start = strut_allocation_count();
    for (int i = 0; i < 2; i++) {
      probe = read_hopper();
      strut_setup_free(&probe);
    }
    int64_t reading = (int64_t)(strut_allocation_count() - start);
    strut_fail_allocation_after(reading + n);
    status = make(&options, true);
    strut_fail_allocation_after(-1);
    assert_true(status == STRUT_OK || status == STRUT_NO_MEMORY);
    refused += status == STRUT_NO_MEMORY;
  }
  assert_true(refused > 50);
}

TEST(interrupted) {
  const strut_flag now = 1;
  assert_int_equal(make(&(strut_compare_options){.interrupt = &now}, false), STRUT_INTERRUPTED);
}

TEST(what_is_reported) {
  OWN(strut_setup) setup = read_hopper();
  OWN(strut_compare) result;
  const strut_compare_input input = {.label = "one", .setup = &setup};
  const strut_compare_options options = {.accuracy = 0.01};
  assert_ok(strut_compare_make(&input, 1, &options, &result, NULL));
  RELEASED char *csv = strut_values_csv(&strut_compare_values, "models", NULL, &result, NULL);
  assert_non_null(csv);
  assert_non_null(strstr(csv, "\none,\"hopper, of \"\"one\"\" leg\",2,1,0,1,0,2,1,2,4,"));
  for (int i = 0; i < STRUT_COMPARE_QUANTITIES; i++) {
    const strut_compare_cell *cell = &result.columns[0].cell[i];
    assert_int_equal(isfinite(cell->value), !cell->reason);
    assert_non_null(strut_compare_row_of((strut_compare_quantity)i).key);
  }
  assert_true(fabs(result.columns[0].cell[STRUT_COMPARE_MASS].value - 2.0) < 1e-12);
  assert_true(fabs(result.columns[0].cell[STRUT_COMPARE_DRIVE_FREQUENCY].value - 5.0) < 1e-12);
  assert_int_equal(strut_compare_figure(&(strut_plot){.path = "/nowhere/at/all.svg", .width = 200},
                                        &result, 0, 1, NULL),
                   STRUT_FILE_TROUBLE);
}

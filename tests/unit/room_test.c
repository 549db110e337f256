/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scene that memory cannot hold is refused by its counts, before anything is allocated for it. */
#include "engine/model/room.h"

#include <string.h>
#include <sys/resource.h>

#include "engine/base/memory.h"
#include "engine/model/model.h"
#include "tests/support/check.h"

/* Nothing but its counts is looked at. */
static strut_status compile(size_t nodes, size_t members, strut_error *error) {
  strut_scene scene = {.node_count = nodes, .member_count = members};
  strut_model *model = NULL;
  *error = (strut_error){0};
  uint64_t before = strut_allocation_count();
  strut_status status = strut_model_compile(&scene, &model, error);
  assert_null(model);
  assert_true(strut_allocation_count() == before);
  return status;
}

static void test_more_than_the_machine_has(void **unused) {
  (void)unused;
  strut_error error;
  assert_int_equal(compile((size_t)1 << 40, (size_t)1 << 41, &error), STRUT_NO_MEMORY);
  print_message("%s\n", error.message);
  assert_non_null(strstr(error.message, "1099511627776 nodes"));
  assert_non_null(strstr(error.message, "MB of memory, and the machine has"));
}

static void test_more_than_the_process_may_have(void **unused) {
  (void)unused;
  static const int resource[] = {RLIMIT_AS, RLIMIT_DATA};
  for (int i = 0; i < 2; i++) {
    struct rlimit before, now;
    strut_error error;
    assert_int_equal(getrlimit(resource[i], &before), 0);
    now = before, now.rlim_cur = 300000000;
    assert_int_equal(setrlimit(resource[i], &now), 0);
    strut_status status = compile(400000, 1000000, &error); /* 260 + 450 MB */
    assert_int_equal(setrlimit(resource[i], &before), 0);
    assert_int_equal(status, STRUT_NO_MEMORY);
    print_message("%s\n", error.message);
    assert_non_null(strstr(error.message, "needs at least 710 MB"));
    assert_non_null(strstr(error.message, i ? "(ulimit -d) 300 MB" : "(ulimit -v) 300 MB"));
  }
}

static void test_a_small_scene_has_room(void **unused) {
  (void)unused;
  strut_scene scene = {.node_count = 100, .member_count = 100};
  assert_int_equal(strut_room_check(&scene, NULL), STRUT_OK);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_more_than_the_machine_has),
      cmocka_unit_test(test_more_than_the_process_may_have),
      cmocka_unit_test(test_a_small_scene_has_room),
  };
  return cmocka_run_group_tests_name("room", tests, NULL, NULL);
}

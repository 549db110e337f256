/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Status codes, what the program makes of them, and messages. */
#include "tests/support/check.h"

/* The codes that scripts and papers rely on. */
TEST(exit_codes_are_as_documented) {
  static const struct {
    strut_status status;
    int code;
  } expected[] = {{STRUT_OK, 0},        {STRUT_USAGE, 1},          {STRUT_BAD_SCENE, 2},
                  {STRUT_DIVERGED, 3},  {STRUT_STEP_TOO_LARGE, 3}, {STRUT_NOT_SETTLED, 3},
                  {STRUT_SINGULAR, 3},  {STRUT_WORK_LIMIT, 3},     {STRUT_FILE_TROUBLE, 4},
                  {STRUT_NO_MEMORY, 4}, {STRUT_INTERRUPTED, 130},  {STRUT_INACCURATE, 5}};
  assert_int_equal(sizeof expected / sizeof expected[0], STRUT_STATUS_COUNT);
  for (size_t i = 0; i < STRUT_STATUS_COUNT; i++)
    assert_int_equal(strut_status_exit_code(expected[i].status), expected[i].code);
}

TEST(texts_are_there_and_differ) {
  assert_all_texts(strut_status_text(STRUT_OK), "completed", strut_status_text(STRUT_DIVERGED),
                   "diverged", strut_status_text(STRUT_INTERRUPTED), "interrupted");
  for (int i = 0; i < STRUT_STATUS_COUNT; i++)
    for (int k = 0; k < i; k++)
      assert_string_not_equal(strut_status_text((strut_status)i),
                              strut_status_text((strut_status)k));
}

TEST(fail_fills_the_error) {
  strut_error error = {0};
  assert_int_equal(strut_fail(&error, STRUT_SINGULAR, "node '%s' %d", "n1", 7), STRUT_SINGULAR);
  assert_int_equal(error.status, STRUT_SINGULAR);
  assert_string_equal(error.message, "node 'n1' 7");
  assert_int_equal(strut_fail(NULL, STRUT_NO_MEMORY, "nobody listens"), STRUT_NO_MEMORY);
}

TEST(a_message_that_is_too_long_is_cut) {
  struct {
    strut_error error;
    char guard;
  } it = {{STRUT_OK, {0}}, 'g'};
  char text[2000];
  memset(text, 'y', sizeof text - 1);
  text[sizeof text - 1] = '\0';
  strut_fail(&it.error, STRUT_USAGE, "%s", text);
  assert_int_equal(strlen(it.error.message), sizeof it.error.message - 1);
  assert_true(it.guard == 'g');
}

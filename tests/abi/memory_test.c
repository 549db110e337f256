/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Memory that is out is an error of every call, never an abort: the k-th allocation fails, for k from 1 on,
 * until a call succeeds. Sees the library from inside, where tests can make allocations fail.
 */
#include "engine/base/memory.h"
#include "tests/abi/attempts.h"
#include "tests/support/test.h"

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
  strutlib_scene *scene = attempts_begin();
  assert_non_null(scene);
  assert_true(run(scene, NULL)); /* what it is with memory enough */
  for (size_t i = 0; i < ATTEMPTS; i++) {
    int64_t count = fail_each(scene, attempts[i].call);
    print_message("%s: %lld allocations failed in turn\n", attempts[i].name, (long long)count);
    assert_true(count > 3);
  }
  assert_true(attempts_end(scene));
}

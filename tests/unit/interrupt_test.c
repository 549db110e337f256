/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ctrl-C: the first signal sets the flag, the second one kills. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "parser/cli/interrupt.c" /* the program is no library to link with */

static void test_first_and_second(void **state) {
  const int *signal_number = *state;
  int result = 0;
  pid_t child = fork();
  if (child == 0) {
    const volatile sig_atomic_t *flag = strut_interrupt_watch();
    if (*flag) _exit(1);
    raise(*signal_number);
    if (!*flag) _exit(2);
    raise(*signal_number);
    _exit(3);
  }
  assert_int_equal(waitpid(child, &result, 0), child);
  assert_true(WIFSIGNALED(result));
  assert_int_equal(WTERMSIG(result), *signal_number);
}

int main(void) {
  int interrupt = SIGINT, terminate = SIGTERM;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_prestate(test_first_and_second, &interrupt),
      cmocka_unit_test_prestate(test_first_and_second, &terminate),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

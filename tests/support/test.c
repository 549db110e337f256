/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/support/test.h"

#include <time.h>

enum { MOST_TESTS = 100 };

typedef struct registered {
  const char *name;
  void (*function)(void);
  int line;
} registered;

static registered tests[MOST_TESTS];
static size_t test_count;
static void (*hooks[TEST_AFTER_ALL + 1])(void); /* by moment */
static char **words;
static int word_count;
static bool
    finished; /* no assertion of AFTER_ALL has failed; cmocka prints, but does not count it */

void register_test(test_moment moment, const char *name, void (*function)(void), int line) {
  if (moment != TEST_ITSELF) {
    hooks[moment] = function;
  } else {
    if (test_count == MOST_TESTS) abort();
    tests[test_count++] = (registered){name, function, line};
  }
}

const char *test_word(int n) { return n < word_count ? words[n] : NULL; }

double test_number(int n, double otherwise) {
  return test_word(n) ? strtod(test_word(n), NULL) : otherwise;
}

double test_seconds(void) { return (double)clock() / CLOCKS_PER_SEC; }

/* Compilers may reorder the constructors of a file. */
static int by_line(const void *a, const void *b) {
  return ((const registered *)a)->line - ((const registered *)b)->line;
}

static void run_registered(void **state) { ((const registered *)*state)->function(); }

static int run_hook(test_moment moment) {
  if (hooks[moment]) hooks[moment]();
  return 0;
}

static int before_each(void **state) {
  (void)state;
  return run_hook(TEST_BEFORE_EACH);
}

static int before_all(void **state) {
  (void)state;
  return run_hook(TEST_BEFORE_ALL);
}

static int after_all(void **state) {
  (void)state;
  run_hook(TEST_AFTER_ALL);
  finished = true;
  return 0;
}

int main(int count, char **arguments) {
  struct CMUnitTest list[MOST_TESTS];
  words = arguments;
  word_count = count;
  qsort(tests, test_count, sizeof tests[0], by_line);
  for (size_t i = 0; i < test_count; i++)
    list[i] = (struct CMUnitTest){.name = tests[i].name,
                                  .test_func = run_registered,
                                  .setup_func = before_each,
                                  .initial_state = &tests[i]};
  int failed = _cmocka_run_group_tests("tests", list, test_count, before_all, after_all);
  return failed || !finished || test_count == 0;
}

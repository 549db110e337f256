/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Tests that register themselves, above cmocka. Each TEST of a program runs, in the order of its file, and
 * is named when it fails:
 *
 *     TEST(a_member_pulls) { assert_true(...); }
 *
 * A program has no main() of its own; test.c has it.
 */
#pragma once

/* What cmocka.h needs, and what most tests do: they have no need to say so. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/** When a function runs: as a test, before each test, before the first, after the last. */
typedef enum test_moment {
  TEST_ITSELF,
  TEST_BEFORE_EACH,
  TEST_BEFORE_ALL,
  TEST_AFTER_ALL
} test_moment;

void register_test(test_moment moment, const char *name, void (*function)(void), int line);

#define REGISTERED_TEST(moment, name)                                                              \
  static void test_##name(void);                                                                   \
  __attribute__((constructor)) static void register_##name(void) {                                 \
    register_test(moment, #name, test_##name, __LINE__);                                           \
  }                                                                                                \
  static void test_##name(void)

#define TEST(name) REGISTERED_TEST(TEST_ITSELF, name)
#define BEFORE_EACH REGISTERED_TEST(TEST_BEFORE_EACH, before_each)
#define BEFORE_ALL REGISTERED_TEST(TEST_BEFORE_ALL, before_all)
#define AFTER_ALL REGISTERED_TEST(TEST_AFTER_ALL, after_all)

/** The call returns STRUT_OK. */
#define assert_ok(call) assert_int_equal((call), STRUT_OK)

/** Pairs of whole numbers, all of which a long double holds exactly: actual, expected, actual, expected, ... */
#define assert_all_equal(...) check_equal_pairs(PAIRS(long double, __VA_ARGS__), __FILE__, __LINE__)
/** Pairs of texts. */
#define assert_all_texts(...) check_text_pairs(PAIRS(char const *, __VA_ARGS__), __FILE__, __LINE__)
/** Each of these is true. */
#define assert_all(...) check_all(PAIRS(bool, __VA_ARGS__), __FILE__, __LINE__)
#define PAIRS(type, ...)                                                                           \
  (type const[]){__VA_ARGS__}, sizeof((type const[]){__VA_ARGS__}) / sizeof(type), #__VA_ARGS__

void check_equal_pairs(const long double *pairs, size_t count, const char *what, const char *file,
                       int line);
void check_text_pairs(const char *const *pairs, size_t count, const char *what, const char *file,
                      int line);
void check_all(const bool *conditions, size_t count, const char *what, const char *file, int line);

/** The n-th word of the command line, from 1; NULL where there are fewer. */
const char *test_word(int n);
/** The same as a number; `otherwise` where there are fewer words. */
double test_number(int n, double otherwise);
/** Processor time that this program has taken [s]. */
double test_seconds(void);

/*
 * Variables that are freed where their block ends, last declared first. Not where an assertion fails: what
 * a failed test holds it keeps.
 *
 *     OWN(strut_setup) setup;                                        strut_setup_free(&setup)
 *     OWN_POINTER(strut_model) model = motion_compile(&setup.scene); strut_model_free(model)
 *     FREED char *text = scratch_read(path, &length);                free(text)
 */
#define OWN(type) __attribute__((cleanup(type##_free))) type
#define OWN_POINTER(type) __attribute__((cleanup(type##_free_at))) type *
/** Says once in a file how a type is freed that OWN_POINTER names. */
#define FREED_BY(function, type)                                                                   \
  static inline void type##_free_at(type **pointer) { function(*pointer); }
#define FREED __attribute__((cleanup(own_free)))

static inline void own_free(void *pointer) { free(*(void **)pointer); }

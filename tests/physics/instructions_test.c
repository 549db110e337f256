/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What nobody uses costs no instruction: the crawler, a scene of bars, springs, a drive and contacts with
 * one straight ground, takes as many per step as before there were any other elements, grounds, drives,
 * sensors and memories.
 *
 * The numbers are of commit f7f3a85, which had none of these, made by this program. They hold for one
 * compiler, its options and one set of registers; elsewhere there is nothing to compare with.
 */
#include "tests/support/instructions.h"
#include "engine/model/small_model.h"
#include "tests/support/check.h"
#include "tests/support/motion.h"
#include "tests/support/structures.h"

enum { BEFORE = 500, STEPS = 10 };
static const double STEP = 5e-5, MORE = 1.01;

typedef struct budget {
  const char *method;
  bool ledger;
  long instructions;       /* of STEPS steps */
  strut_small_level level; /* the kernel that steps it */
} budget;

static const budget budgets[] = {
    {"rk4", true, 38487, STRUT_SMALL_NONE},
    {"rk4", false, 34026, STRUT_SMALL_NONE},
    {"euler", true, 10358, STRUT_SMALL_NONE},
    {"verlet", true, 11375, STRUT_SMALL_NONE},
    {"verlet-events", true, 14378, STRUT_SMALL_NONE},
    {"verlet-events", false, 12918, STRUT_SMALL_NONE},
    {"rk4-events", true, 49836, STRUT_SMALL_NONE},
    {"euler-events", true, 18426, STRUT_SMALL_NONE},
    {"adaptive", true, 94476, STRUT_SMALL_NONE},
    /* by the kernel of small models, which is younger */
    {"rk4", true, 17024, STRUT_SMALL_AVX512},
    {"rk4", false, 12531, STRUT_SMALL_AVX512},
    {"verlet", true, 5621, STRUT_SMALL_AVX512},
    {"rk4", true, 35943, STRUT_SMALL_AVX2},
    {"rk4", false, 29617, STRUT_SMALL_AVX2},
    {"verlet", true, 10534, STRUT_SMALL_AVX2},
};
enum { BUDGETS = sizeof budgets / sizeof budgets[0] };

static bool numbers_hold_here(void) {
#if defined(STRUT_COUNTED_BUILD) && defined(__x86_64__) && defined(__GNUC__) &&                    \
    !defined(__clang__) && __GNUC__ == 12
  return __builtin_cpu_supports("avx2");
#else
  return false;
#endif
}

/* Lowers the model to the budget's kernel; false where the processor has none such. */
static bool use_kernel(strut_model *model, strut_small_level level) {
  if (level == STRUT_SMALL_NONE) {
    model->small = NULL;
    return true;
  }
  if (!model->small || model->small->level < level) return false;
  model->small->level = level;
  return true;
}

static void some_steps(void *context) { motion_steps(context, STEPS); }

/* 0: not on this processor. */
static long count_of(const budget *b) {
  strut_setup setup = {.experiment = strut_experiment_default()};
  motion m;
  setup.experiment.step = STEP;
  strut_scene_init(&setup.scene);
  structure_crawler(&setup.scene, 10, 1e-4, 0.1, false);
  motion_begin_by(&m, &setup, b->method, STEP);
  m.state->ledger = b->ledger;
  long count = 0;
  if (use_kernel(m.model, b->level)) {
    motion_steps(&m, BEFORE);
    count = count_instructions(some_steps, &m);
  }
  motion_end(&m);
  strut_scene_free(&setup.scene);
  return count;
}

static void test_what_the_crawler_does_not_use_costs_it_nothing(void **unused) {
  (void)unused;
  int over = 0;
  if (!numbers_hold_here()) {
    print_message("the numbers are of another compiler, build or processor\n");
    skip();
  }
  for (int i = 0; i < BUDGETS; i++) {
    const budget *b = &budgets[i];
    long count = count_of(b);
    if (count < 0) {
      print_message("this machine does not let a process be stepped\n");
      skip();
    }
    bool good = (double)count <= MORE * (double)b->instructions;
    static const char *const kernel[] = {"general", "AVX2", "AVX-512"};
    print_message("%s: {\"%s\", %s, %ld}, %s kernel, budget %ld\n", good ? "ok" : "over", b->method,
                  b->ledger ? "true" : "false", count, kernel[b->level], b->instructions);
    over += !good;
  }
  assert_int_equal(over, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_what_the_crawler_does_not_use_costs_it_nothing),
  };
  return cmocka_run_group_tests_name("instructions", tests, NULL, NULL);
}

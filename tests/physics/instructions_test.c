/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What nobody uses costs no instruction: the crawler, a scene of bars, springs, a drive and contacts with
 * one straight ground, takes as many per step as before there were any other elements, grounds, drives,
 * sensors and memories.
 *
 * Commit f7f3a85, which had none of these, took as many, but for the sines of drives: it computed those of many
 * steps at once, for 1 to 6 % of the instructions. The numbers were made by this program when that went. They
 * hold for one compiler, its options and one set of registers; elsewhere there is nothing to compare with.
 */
#include "tests/support/instructions.h"
#include "tests/support/structures.h"

enum { BEFORE = 500, STEPS = 10 };
static const double STEP = 5e-5, MORE = 1.01;

typedef struct budget {
  const char *method;
  bool balance;
  long instructions; /* of STEPS steps */
} budget;

static const budget budgets[] = {
    {"rk4", true, 40413},        {"rk4", false, 35069},          {"euler", true, 10621},
    {"verlet", true, 11679},     {"verlet-events", true, 14837}, {"verlet-events", false, 13048},
    {"rk4-events", true, 58023}, {"euler-events", true, 18897},  {"adaptive", true, 98073}};
enum { BUDGETS = sizeof budgets / sizeof budgets[0] };

static bool numbers_hold_here(void) {
#if defined(STRUT_COUNTED_BUILD) && defined(__x86_64__) && defined(__GNUC__) &&                    \
    !defined(__clang__) && __GNUC__ == 12
  return __builtin_cpu_supports("avx2");
#else
  return false;
#endif
}

static void some_steps(void *context) { motion_steps(context, STEPS); }

static long count_of(const budget *b) {
  strut_setup setup = {.experiment = strut_experiment_default()};
  setup.experiment.step = STEP;
  strut_scene_init(&setup.scene);
  structure_crawler(&setup.scene, 10, 1e-4, 0.1, false);
  OWN(motion) m = motion_begin_by(&setup, b->method, STEP);
  m.state->balance = b->balance;
  motion_steps(&m, BEFORE);
  long count = count_instructions(some_steps, &m);
  strut_scene_free(&setup.scene);
  return count;
}

TEST(what_the_crawler_does_not_use_costs_it_nothing) {
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
    print_message("%s: {\"%s\", %s, %ld}, budget %ld\n", good ? "ok" : "over", b->method,
                  b->balance ? "true" : "false", count, b->instructions);
    over += !good;
  }
  assert_int_equal(over, 0);
}

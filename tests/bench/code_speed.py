#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a step of the C costs that `strut export --format code` writes of the crawler.

usage: code_speed.py STRUT [REPEATS]

Compiled with the compilers that are here, in double and float, and timed in turns with the kernel that is written by
hand for this structure (hand_kernel.c, scalar, the same flags): least CPU time of a step, and the median and the
quartiles of the turns' ratios.
"""
import os
import shutil
import subprocess
import sys
import tempfile

strut = os.path.realpath(sys.argv[1])
repeats = int(sys.argv[2]) if len(sys.argv) > 2 else 31
here = os.path.dirname(os.path.realpath(__file__))
model = os.path.join(here, "..", "..", "models", "crawler", "crawler.yaml")
MAIN = """#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include "crawler.h"
#include "tests/bench/hand_kernel.h"
enum { STEPS = 20000, KINDS = 3 };
static crawler_state rk4, verlet;
static hand_crawler_state hand;
static double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
static double turn(int kind) {
  double start = seconds();
  if (kind == 0) hand_crawler_run_scalar(&hand, 1e-4, 10, 1e-4, 0.1, STEPS);
  for (int n = 0; n < STEPS && kind == 1; n++) crawler_step_rk4(&rk4, NULL, 1e-4);
  for (int n = 0; n < STEPS && kind == 2; n++) crawler_step_verlet(&verlet, NULL, 2e-5);
  return 1e9 * (seconds() - start) / STEPS;
}
static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}
int main(int argc, char **argv) {
  int count = argc > 1 ? atoi(argv[1]) : 31;
  static double time[KINDS][1000];
  hand_crawler_place(&hand, 0);
  crawler_init(&rk4);
  crawler_init(&verlet);
  for (int r = -1; r < count; r++)
    for (int k = 0; k < KINDS; k++) {
      double taken = turn(k);
      if (r >= 0) time[k][r] = taken;
    }
  for (int k = 1; k < KINDS; k++) {
    for (int r = 0; r < count; r++) time[k][r] /= time[0][r];
    qsort(time[k], (size_t)count, sizeof time[k][0], ascending);
    printf(" %6.3f (%.3f to %.3f)", time[k][count / 2], time[k][count / 4], time[k][3 * count / 4]);
  }
  qsort(time[0], (size_t)count, sizeof time[0][0], ascending);
  printf("   by hand %.0f ns\\n", time[0][0]);
  return 0;
}
"""
work = tempfile.mkdtemp()
print(f"{'':40} {'rk4, by hand = 1':>25} {'verlet, the same':>25}")
for real in ("double", "float"):
    folder = os.path.join(work, real)
    subprocess.run([strut, "export", model, "--format", "code", "-o", folder, "--real", real], check=True, capture_output=True)
    with open(os.path.join(work, "main.c"), "w", encoding="utf-8") as file:
        file.write(MAIN)
    for compiler in filter(shutil.which, ("gcc", "clang")):
        for flags in ("-O2", "-O3 -march=native"):
            program = os.path.join(work, "program")
            subprocess.run([compiler, "-std=gnu99", "-ffp-contract=off", *flags.split(), "-I", folder, "-I",
                            os.path.join(here, "..", ".."), os.path.join(work, "main.c"),
                            os.path.join(folder, "crawler.c"), os.path.join(here, "hand_kernel.c"), "-lm", "-o", program],
                           check=True)
            done = subprocess.run([program, str(repeats)], check=True, capture_output=True, text=True)
            print(f"{real + ', ' + compiler + ' ' + flags:40}{done.stdout.rstrip()}", flush=True)
shutil.rmtree(work)

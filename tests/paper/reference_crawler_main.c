/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The independent crawler as a program:
 *
 *   reference_crawler [frequency [mu [I|II [dt [periods [window [amplitude]]]]]]]
 *
 * prints one line: f, mu, start, dt, velocity of the centre of mass and of node 1 [mm/s], then for
 * each node the fraction of the window in contact and the largest height [mm].
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/paper/reference_crawler.h"

int main(int argc, char **argv) {
  reference_crawler it = {.frequency = argc > 1 ? atof(argv[1]) : 10.0,
                          .mu = argc > 2 ? atof(argv[2]) : 0.1,
                          .amplitude = argc > 7 ? atof(argv[7]) : 1e-4};
  int mirrored = argc > 3 && strcmp(argv[3], "II") == 0;
  double dt = argc > 4 ? atof(argv[4]) : 1e-4;
  double periods = argc > 5 ? atof(argv[5]) : 1100.0, window = argc > 6 ? atof(argv[6]) : 100.0;
  double z[REFERENCE_STATE];
  reference_figures figures;
  reference_prepare(&it, mirrored, z);
  if (!reference_settle(&it, dt, z)) {
    fprintf(stderr, "reference_crawler: did not settle\n");
    return 1;
  }
  reference_run(&it, dt, periods, window, z, &figures);
  printf("f %g mu %g start %s dt %g: v_com %.4f v_1 %.4f", it.frequency, it.mu,
         mirrored ? "II" : "I", dt, 1e3 * figures.velocity, 1e3 * figures.velocity_one);
  for (int i = 0; i < REFERENCE_NODES; i++)
    printf("  node %d duty %.4f max %.4f", i + 1, figures.duty[i], 1e3 * figures.highest[i]);
  printf("\n");
  return 0;
}

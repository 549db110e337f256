/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The crawler in MuJoCo: three rigid bars, six spatial tendons, friction, RK4. */
#ifndef STRUT_TESTS_BENCH_MUJOCO_CRAWLER_H
#define STRUT_TESTS_BENCH_MUJOCO_CRAWLER_H

#include <stddef.h>

typedef struct mujoco_crawler mujoco_crawler;

/** State I, dt in its text is 1e-4 s; drive f [Hz], a [m]. NULL and a message where it fails. */
mujoco_crawler *mujoco_crawler_create(double f, double a, char *message, size_t size);
/** Calls mj_step so many times; the driven tendon's spring length is set before each. */
void mujoco_crawler_run(mujoco_crawler *it, long long steps);
/** x of node 1 [m]: shows that the thing crawls at all. */
double mujoco_crawler_position(const mujoco_crawler *it);
void mujoco_crawler_free(mujoco_crawler *it);

#endif

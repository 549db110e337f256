/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Scenes of the bench, made through the C API: the paper's crawler, and chains of X-frames. */
#ifndef STRUT_TESTS_BENCH_SCENES_H
#define STRUT_TESTS_BENCH_SCENES_H

#include "engine/scene/experiment.h"

/**
 * The crawler of Table 1 at state I as drawn, drive f [Hz], a [m], friction mu, every node may touch
 * the ground, step 1e-4 s. STRUT_OK or STRUT_NO_MEMORY; free with strut_scene_free.
 */
strut_status bench_crawler_scene(strut_setup *setup, double f, double a, double mu);

/**
 * A chain of `members` / 5 X-frames (at least one), each two crossed bars and three cables and two
 * nodes more than the one before; the first two nodes are fixed. The cables are shorter than drawn,
 * so it vibrates. Free with strut_scene_free.
 */
strut_status bench_chain_scene(strut_setup *setup, size_t members, strut_mass_model mass);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The front door of the libraries: everything a program needs to read a scene, compile it, know it
 * at rest, run it, write what came out, run it at the points of a study and draw it (what draws is in
 * the library strut_pictures and studies are in strut_study, which only programs that draw or sweep have
 * to link). Installed as include/strut/strut.h, beside the tree it includes.
 *
 * The libraries are written in C17; C++ programs may include this header as it stands.
 */
#pragma once

/* System headers come first, so that none is included inside the extern "C" below. */
#include <assert.h>
#include <float.h>
#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __cplusplus
#define restrict __restrict /* C's word, which C++ compilers know by this name only */
extern "C" {
#endif

#include "engine/base/memory.h"
#include "engine/base/status.h"
#include "engine/forces/forces.h"
#include "engine/integrate/integrator.h"
#include "engine/model/model.h"
#include "engine/model/state.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/draw/chart.h"
#include "engine/output/draw/figure.h"
#include "engine/output/figures/run_figure.h"
#include "engine/output/figures/statics_figures.h"
#include "engine/output/figures/table_figure.h"
#include "engine/output/file.h"
#include "engine/output/page/page.h"
#include "engine/output/record_files.h"
#include "engine/output/run_report.h"
#include "engine/output/trajectory.h"
#include "engine/run/measure/summary.h"
#include "engine/run/recorder.h"
#include "engine/run/simulate.h"
#include "engine/scene/checks/check.h"
#include "engine/scene/experiment.h"
#include "engine/scene/quantity.h"
#include "engine/scene/signal.h"
#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/form/form.h"
#include "engine/statics/modes/modes.h"
#include "engine/statics/path/path.h"
#include "engine/statics/rigidity/rigidity.h"
#include "engine/study/cluster/cluster_script.h"
#include "engine/study/compare/compare.h"
#include "engine/study/results/slots.h"
#include "engine/study/results/study_table.h"
#include "engine/study/sweep/sweep.h"
#include "engine/study/tradeoff/tradeoff.h"
#include "parser/language/read/read_scene.h"
#include "parser/language/study/read_study.h"
#include "parser/language/write/write_scene.h"

#ifdef __cplusplus
}
#undef restrict
#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The figures of a study, drawn of its table.
 */
#ifndef STRUT_PARSER_CLI_SWEEP_FIGURES_H
#define STRUT_PARSER_CLI_SWEEP_FIGURES_H

#include "engine/study/sweep/sweep.h"

/** Do all figures name columns of what they draw? STRUT_BAD_SCENE with the reason. */
strut_status strut_sweep_figures_check(const strut_sweep_plan *plan, strut_error *error);
/**
 * Fails where strut would have to overwrite somebody else's table.csv or picture. Pictures of single runs
 * are refused when they are drawn.
 */
strut_status strut_sweep_figures_check_files(const strut_sweep_plan *plan, const char *directory,
                                             strut_error *error);
/**
 * Draws each as directory/NAME.svg, of the table at `path` or of the runs beside it. Messages go to
 * stderr.
 */
strut_status strut_sweep_figures_draw(const strut_sweep_plan *plan, const char *directory,
                                      const char *path);

#endif

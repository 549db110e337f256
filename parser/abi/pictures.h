/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Figures and pages as texts. */
#ifndef STRUT_PARSER_ABI_PICTURES_H
#define STRUT_PARSER_ABI_PICTURES_H

#include "engine/output/draw/plot.h"
#include "engine/output/figures/run_figure.h"
#include "parser/command/arguments.h"

enum { ABI_MOST_TIMES = 100 };

/** Options "draw", "scale", "times", "title" and "width" into a figure of a run; times has room for ABI_MOST_TIMES. */
strut_status abi_run_figure_read(const strut_arguments *arguments, strut_run_figure *figure,
                                 double *times);
/** Options "title" and "width" into a plot that goes to `path`. */
strut_status abi_plot_read(const strut_arguments *arguments, const char *path, strut_plot *plot);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The figure of a search's best point beside its start, with the numbers of `strut compare`. */
#include "engine/study/compare/compare.h"
#include "engine/study/sweep/grid.h"
#include "parser/program/streams.h"
#include "parser/program/sweep.h"

/* The scene of the best point, or of the start with the same axes and scenario. */
static strut_status set_up(const strut_sweep_plan *plan, const strut_search_point *best, bool start,
                           strut_setup *setup, strut_error *error) {
  strut_study_value *values = strut_allocate(plan->axis_columns + 1, sizeof *values);
  if (!values) return strut_no_memory(error, "");
  strut_grid_values(plan->study, best->worst, values); /* the variables' own axis holds the start */
  if (!start) strut_search_values(plan, best->worst, best->values, values);
  strut_status status = plan->scenes.setup(plan->scenes.context, values, setup, error);
  strut_release(values);
  return status;
}

strut_status strut_sweep_search_winner(const strut_sweep_plan *plan, const strut_study_figure *f,
                                       const char *path, const strut_search_point *best,
                                       double width, strut_error *error) {
  strut_setup setups[2];
  strut_compare result = {0};
  const strut_compare_input inputs[] = {{.label = "start", .setup = &setups[0]},
                                        {.label = "best", .setup = &setups[1]}};
  strut_status status = set_up(plan, best, true, &setups[0], error);
  if (status) return status;
  status = set_up(plan, best, false, &setups[1], error);
  if (!status) {
    const strut_compare_options options = {.accuracy = setups[1].experiment.accuracy,
                                           .no_motion = plan->study->compute != STRUT_COMPUTE_RUN,
                                           .no_states = true,
                                           .interrupt = strut_interrupt_watch()};
    const strut_plot plot = {.path = path, .title = f->title, .width = width};
    status = strut_compare_make(inputs, 2, &options, &result, error);
    if (!status) status = strut_compare_figure(&plot, &result, 0, result.count, error);
    strut_compare_free(&result);
    strut_setup_free(&setups[1]);
  }
  strut_setup_free(&setups[0]);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>

#include "engine/base/memory.h"
#include "engine/output/draw/figure.h"
#include "engine/output/figures/statics_figures.h"

enum { NAME = 200 };

/* Over one step the phase itself; over two the place on the line, with its corners by name. */
static void name_axis(const strut_waves *waves, char text[NAME]) {
  size_t used = (size_t)snprintf(
      text, NAME, "%s", waves->steps == 1 ? "phase from cell to cell in turns" : "wave vector:");
  for (int32_t i = 0; i < waves->corner_count && waves->steps == 2; i++) {
    const char *name = waves->corner[i].name[0] == 'G' ? "\u0393" : waves->corner[i].name;
    used += (size_t)snprintf(text + used, NAME - used, "%s %s at %d", i ? "," : "", name, (int)i);
  }
}

strut_status strut_waves_figure(const strut_plot *plot, const strut_model *model,
                                const strut_waves *waves, strut_error *error) {
  strut_arena arena = {0};
  char name[NAME];
  size_t lines = (size_t)waves->shown, gaps = 0;
  strut_series *series = strut_arena_allocate(&arena, lines, sizeof *series);
  strut_band *bands = strut_arena_allocate(&arena, waves->gap_count + 1, sizeof *bands);
  double *x = strut_arena_allocate(&arena, waves->count, sizeof *x);
  double *y = strut_arena_allocate(&arena, lines * waves->count, sizeof *y);
  bool fine = series && bands && x && y;
  for (size_t i = 0; i < waves->count && fine; i++) {
    x[i] = waves->steps == 1 ? waves->phase[i][0] : waves->along[i];
    for (size_t b = 0; b < lines; b++)
      y[b * waves->count + i] = waves->frequency[i * (size_t)waves->band_count + b];
  }
  for (size_t b = 0; b < lines && fine; b++)
    series[b] = (strut_series){
        .count = waves->count, .x = x, .y = y + b * waves->count, .markers = STRUT_MARKERS_NONE};
  for (size_t g = 0; g < waves->gap_count && fine; g++)
    if (waves->gaps[g].below < waves->shown)
      bands[gaps++] = (strut_band){waves->gaps[g].low, waves->gaps[g].high, true, "no waves"};
  name_axis(waves, name);
  const strut_panel panel = {
      .x = {.name = name, .high = waves->steps == 1 ? 0.5 : waves->corner_count - 1.0},
      .y = strut_axis_of("frequency", "Hz"),
      .series_count = lines,
      .series = series,
      .band_count = gaps,
      .bands = bands};
  const strut_figure figure = {.title = model->scene->name, .panel_count = 1, .panels = &panel};
  strut_status status =
      fine ? strut_figure_draw(plot, &figure, error) : strut_no_memory(error, "while drawing");
  strut_arena_free(&arena);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/figure.h"
#include "engine/output/figures/statics_figures.h"

/* Over one step the phase itself; over two the place on the line, with its corners by name. */
static const char *name_axis(const strut_waves *waves, strut_figure *figure) {
  const char *text = "wave vector:";
  if (waves->steps == 1) return "phase from cell to cell in turns";
  for (int32_t i = 0; i < waves->corner_count && waves->steps == 2; i++)
    text = strut_figure_text(figure, "%s%s %s at %d", text, i ? "," : "",
                             waves->corner[i].name[0] == 'G' ? "\u0393" : waves->corner[i].name,
                             (int)i);
  return text;
}

strut_status strut_waves_figure(const strut_plot *plot, const strut_model *model,
                                const strut_waves *waves, strut_error *error) {
  strut_figure figure = {.title = model->scene->name};
  strut_panel *panel = strut_add_panel(&figure);
  bool one = waves->steps == 1;
  for (int32_t b = 0; b < waves->shown; b++) {
    strut_series *series = strut_add_series(&figure, panel, NULL);
    series->look = 0;
    series->markers = STRUT_MARKERS_NONE;
    for (size_t i = 0; i < waves->count; i++)
      strut_add_point(&figure, series, one ? waves->phase[i][0] : waves->along[i],
                      waves->frequency[i * (size_t)waves->band_count + (size_t)b]);
  }
  for (size_t g = 0; g < waves->gap_count; g++)
    if (waves->gaps[g].below < waves->shown)
      strut_add_band(&figure, panel, waves->gaps[g].low, waves->gaps[g].high, "no waves")->level =
          true;
  panel->x = (strut_axis){.name = name_axis(waves, &figure),
                          .high = one ? 0.5 : waves->corner_count - 1.0};
  panel->y = strut_axis_of("frequency", "Hz");
  return strut_figure_draw(plot, &figure, error);
}

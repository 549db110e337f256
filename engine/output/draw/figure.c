/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/figure.h"

#include "engine/output/draw/view.h"

static const double EDGE = 5, GAP = 12; /* [pt] */

/* Views below each other in groups. For now charts have painters of their own. */
static double draw_panels(strut_canvas *canvas, double y, double width, const strut_figure *figure,
                          bool draw) {
  size_t count = 0;
  bool foot = true;
  for (size_t i = 0; i < figure->panel_count; i += count) {
    const strut_panel *p = &figure->panels[i];
    for (count = 1; i + count < figure->panel_count && p[count].small == p->small; count++) continue;
    y += strut_draw_views(canvas, (strut_box){EDGE, y, width - 2 * EDGE, 0}, figure, p, count, foot,
                          draw) +
         GAP;
    foot = false;
  }
  return y - GAP;
}

strut_status strut_figure_draw(const strut_plot *plot, const strut_figure *figure,
                               strut_error *error) {
  strut_canvas *canvas = NULL, *ruler = NULL;
  double head = 0.0;
  const strut_heading heading = {.width = plot->width,
                                 .edge = EDGE,
                                 .title = strut_plot_title(plot, figure->title),
                                 .note = figure->note,
                                 .alarm = figure->alarm};
  strut_status status = strut_heading_measure(&heading, &head, error);
  if (status == STRUT_OK) status = strut_canvas_open_pixels(1, 1, 1, &ruler, error);
  if (status == STRUT_OK)
    status = strut_canvas_open(plot->path, plot->width,
                               draw_panels(ruler, EDGE + head, plot->width, figure, false) + EDGE,
                               heading.title, &canvas, error);
  if (status == STRUT_OK) {
    strut_heading_draw(canvas, &heading);
    draw_panels(canvas, EDGE + head, plot->width, figure, true);
    status = strut_canvas_commit(canvas, error);
  }
  strut_canvas_free(canvas);
  strut_canvas_free(ruler);
  return status;
}

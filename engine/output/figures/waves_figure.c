/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>

#include "engine/base/c_locale.h"
#include "engine/base/memory.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/draw/chart.h"
#include "engine/output/figures/statics_figures.h"

static const double TALL = 0.66, EDGE = 2.0; /* height over width; [pt] */

typedef struct wave_picture {
  strut_series *series; /* (bands) */
  strut_band *bands;    /* (gaps) */
  double *x, *y;        /* (samples), (bands, samples) */
  size_t gap_count;
  char name[200]; /* of the x axis */
  strut_arena arena;
} wave_picture;

static bool allocate(wave_picture *p, const strut_waves *w) {
  size_t bands = (size_t)w->shown;
  p->series = strut_arena_allocate(&p->arena, bands, sizeof *p->series);
  p->bands = strut_arena_allocate(&p->arena, w->gap_count + 1, sizeof *p->bands);
  p->x = strut_arena_allocate(&p->arena, w->count, sizeof *p->x);
  p->y = strut_arena_allocate(&p->arena, bands * w->count, sizeof *p->y);
  return p->series && p->bands && p->x && p->y;
}

/* Over one step the phase itself; over two the place on the line, with its corners by name. */
static void name_axis(wave_picture *p, const strut_waves *w) {
  size_t used =
      (size_t)snprintf(p->name, sizeof p->name, "%s",
                       w->steps == 1 ? "phase from cell to cell in turns" : "wave vector:");
  for (int32_t i = 0; i < w->corner_count && w->steps == 2; i++) {
    const char *name = w->corner[i].name[0] == 'G' ? "\u0393" : w->corner[i].name;
    used += (size_t)snprintf(p->name + used, sizeof p->name - used, "%s %s at %d", i ? "," : "",
                             name, (int)i);
  }
}

static void fill(wave_picture *p, const strut_waves *w) {
  for (size_t i = 0; i < w->count; i++) {
    p->x[i] = w->steps == 1 ? w->phase[i][0] : w->along[i];
    for (size_t b = 0; b < (size_t)w->shown; b++)
      p->y[b * w->count + i] = w->frequency[i * (size_t)w->band_count + b];
  }
  for (size_t b = 0; b < (size_t)w->shown; b++)
    p->series[b] =
        (strut_series){.count = w->count, .x = p->x, .y = p->y + b * w->count, .look = 0};
  for (size_t g = 0; g < w->gap_count; g++) {
    const strut_wave_gap *gap = &w->gaps[g];
    if (gap->below >= w->shown) continue;
    p->bands[p->gap_count] = (strut_band){.low = gap->low, .high = gap->high, .level = true};
    if (p->gap_count++ == 0) p->bands[0].label = "no waves";
  }
}

strut_status strut_waves_figure(const strut_plot *plot, const strut_model *model,
                                const strut_waves *w, strut_error *error) {
  wave_picture p = {.gap_count = 0};
  strut_canvas *canvas = NULL;
  strut_status status = STRUT_NO_MEMORY;
  const char *title = strut_plot_title(plot, model->scene->name);
  strut_c_locale locale = strut_c_locale_enter();
  if (allocate(&p, w)) {
    name_axis(&p, w);
    fill(&p, w);
    status = strut_canvas_open(plot->path, plot->width, TALL * plot->width, title, &canvas, error);
  } else {
    strut_no_memory(error, "");
  }
  strut_curves curves = {.title = title,
                         .x = {p.name, "", false, 0.0, w->steps == 1 ? 0.5 : w->corner_count - 1.0},
                         .y = {"frequency", "Hz", false, (double)NAN, (double)NAN},
                         .series_count = (size_t)w->shown,
                         .series = p.series,
                         .band_count = p.gap_count,
                         .bands = p.bands};
  if (status == STRUT_OK) {
    strut_box box = strut_canvas_box(canvas);
    box.x += EDGE, box.y += EDGE, box.width -= 2 * EDGE, box.height -= 2 * EDGE;
    status = strut_draw_curves(canvas, box, &curves);
    status = status ? strut_no_memory(error, "") : strut_canvas_commit(canvas, error);
  }
  strut_canvas_free(canvas);
  strut_arena_free(&p.arena);
  strut_c_locale_leave(locale);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The overview of a run: where it ended, how it got there, and curves of the last periods. */
#include <math.h>
#include <stdio.h>

#include "engine/output/figures/run_parts.h"

enum { MOST_PANELS = 4, MOST_STACKED = 3, ITEMS = 2, MOST_WAYS = 300 };

static const double YARDSTICK = 14, KEY_LINE = 11; /* [pt] */
static const double SCALE = 46, CHART = 118, MARGIN = 27, GAP = 6, WIDE = 380;
static const double PERIODS = 5, PART = 0.1; /* of what was recorded, where nothing is periodic */
static const double SEEN = 2e-3;             /* of the drawing: less is no way */
static const double REACH = 0.6; /* ways are shown so far around the shape, in its sizes */

static size_t first_of_ways(const strut_run_scene *run) {
  double all = strut_run_time_from(run, 0);
  return strut_run_since(run, run->period > 0 ? fmin(run->period, all) : PART * all);
}

static size_t first_of_curves(const strut_run_scene *run) {
  double all = strut_run_time_from(run, 0);
  return strut_run_since(run, run->period > 0 ? fmin(PERIODS * run->period, all) : all);
}

/* The last shape, with as much of the ways to it as does not make it small. */
static strut_bounds bounds_of(const strut_run_scene *run) {
  strut_bounds shape = strut_run_frame_bounds(run, run->frames - 1), all = shape;
  double reach = REACH * strut_run_extent(&shape);
  for (size_t f = first_of_ways(run); f < run->frames; f++)
    strut_bounds_add(&all, run->model, strut_run_positions(run, f));
  for (int d = 0; d < 2; d++) {
    all.low[d] = fmax(all.low[d], shape.low[d] - reach);
    all.high[d] = fmin(all.high[d], shape.high[d] + reach);
  }
  strut_run_add_ground(run, &all);
  return all;
}

static double drawing_height(const strut_run_scene *run) {
  strut_bounds b = bounds_of(run);
  double width = run->figure->width - 2 * STRUT_RUN_EDGE - SCALE;
  return strut_run_drawing_height(&b, width, MARGIN, 0.16, 0.62);
}

static bool beside(const strut_run_scene *run) { return run->figure->width >= WIDE; }

static int panels_of(const strut_run_scene *run, int panels[MOST_PANELS]) {
  static const int order[] = {STRUT_RUN_WAY, STRUT_RUN_NORMALS, STRUT_RUN_DRIVE, STRUT_RUN_HEIGHTS,
                              STRUT_RUN_FORCES};
  int count = 0, most = beside(run) ? MOST_PANELS : MOST_STACKED;
  for (size_t i = 0; run->frames > 1 && i < sizeof order / sizeof *order && count < most; i++)
    if (strut_run_panel_wanted(run, order[i])) panels[count++] = order[i];
  return count;
}

/* Whether any way is long enough to be seen. */
static bool moves(const strut_run_scene *run) {
  size_t last = run->frames - 1, nodes = run->motion->node_count;
  strut_bounds b = bounds_of(run);
  if (nodes > MOST_WAYS) return false;
  double least = SEEN * strut_run_extent(&b);
  for (size_t f = first_of_ways(run); f < last; f++)
    for (size_t i = 0; i < 2 * nodes; i++)
      if (fabs(strut_run_positions(run, f)[i] - strut_run_positions(run, last)[i]) > least)
        return true;
  return false;
}

static size_t key_of(strut_run_scene *run, char texts[ITEMS][120], strut_key_item items[ITEMS]) {
  size_t count = 0;
  strut_run_expect_frame(run, run->frames - 1);
  if (strut_run_arrow_item(run, texts[0], &items[0])) count++;
  if (moves(run)) {
    double span = strut_run_time_from(run, first_of_ways(run));
    snprintf(texts[count], 120, "ways in the last %s, dark to bright",
             strut_drawn_quantity(span, 3, "s").text);
    items[count] = (strut_key_item){.sign = STRUT_KEY_WORDS, .text = texts[count]};
    count++;
  }
  return count;
}

/* Below the drawing the yardstick stands, and beside it the key. */
static double key_indent(const strut_run_scene *run) {
  return 0.3 * (run->figure->width - 2 * STRUT_RUN_EDGE - SCALE) + 14;
}

static double foot_height(const strut_run_scene *run, strut_canvas *canvas,
                          const strut_key_item *items, size_t count) {
  double width = run->figure->width - 2 * STRUT_RUN_EDGE - key_indent(run);
  return YARDSTICK - KEY_LINE + fmax(KEY_LINE, strut_key_height(canvas, width, items, count));
}

double strut_run_overview_height(strut_run_scene *run) {
  int panels[MOST_PANELS], count = panels_of(run, panels);
  char texts[ITEMS][120];
  strut_key_item items[ITEMS];
  size_t keys = key_of(run, texts, items);
  double key = foot_height(run, run->ruler, items, keys);
  return 2 * STRUT_RUN_EDGE + STRUT_RUN_TITLE + drawing_height(run) + key + GAP +
         CHART * (beside(run) ? (count + 1) / 2 : count);
}

static bool draw_structure(strut_run_scene *run, strut_canvas *canvas, strut_box box) {
  size_t last = run->frames - 1, first = first_of_ways(run), nodes = run->motion->node_count;
  strut_window window = strut_window_fit(box, bounds_of(run), MARGIN);
  double(*way)[2] = strut_arena_allocate(&run->arena, run->frames - first, sizeof *way);
  double *q = strut_run_shape(run, last);
  if (!way || !q || !strut_run_draw_frame(run, canvas, &window, last)) return false;
  for (size_t i = 0; i < nodes && nodes <= MOST_WAYS; i++) {
    for (size_t f = first; f < run->frames; f++)
      for (size_t d = 0; d < 2; d++) way[f - first][d] = strut_run_positions(run, f)[2 * i + d];
    strut_run_draw_path(run, canvas, &window, (const double(*)[2])way, run->frames - first, 0.9);
  }
  strut_run_draw_reactions(run, canvas, &window, last);
  strut_run_draw_names(run, canvas, &window, q);
  window.box.y += YARDSTICK;
  strut_draw_yardstick(canvas, &window);
  return true;
}

/* Two beside each other where there is room; one that is left over has a row of its own. */
static strut_status draw_charts(strut_run_scene *run, strut_canvas *canvas, strut_box box) {
  int panels[MOST_PANELS], count = panels_of(run, panels), columns = beside(run) ? 2 : 1;
  for (int i = 0, row = 0; i < count; row++) {
    int in_row = columns == 2 && (count - i) % 2 == 0 ? 2 : 1;
    for (int k = 0; k < in_row; k++, i++) {
      strut_box chart = {box.x + k * box.width / in_row, box.y + row * CHART, box.width / in_row,
                         CHART};
      strut_status status =
          strut_run_draw_panel(run, canvas, chart, panels[i], first_of_curves(run));
      if (status != STRUT_OK) return status;
    }
  }
  return STRUT_OK;
}

strut_status strut_run_overview(strut_run_scene *run, strut_canvas *canvas) {
  double width = run->figure->width - 2 * STRUT_RUN_EDGE, height = drawing_height(run);
  char what[100], texts[ITEMS][120];
  strut_key_item items[ITEMS];
  size_t keys = key_of(run, texts, items);
  snprintf(what, sizeof what, "shape at %s",
           strut_drawn_quantity(run->motion->time[run->frames - 1], 5, "s").text);
  strut_run_draw_title(run, canvas, what, true);
  strut_box box = {STRUT_RUN_EDGE, STRUT_RUN_EDGE + STRUT_RUN_TITLE, width - SCALE, height};
  if (!draw_structure(run, canvas, box)) return STRUT_NO_MEMORY;
  strut_run_draw_scale(
      run, canvas,
      (strut_box){STRUT_RUN_EDGE + width - SCALE + 6, box.y, SCALE - 6, fmin(height, 130)});
  strut_box below = {STRUT_RUN_EDGE, box.y + height, width, 0};
  strut_draw_key(canvas,
                 (strut_box){below.x + key_indent(run), below.y + (YARDSTICK - KEY_LINE),
                             width - key_indent(run), 0},
                 items, keys);
  below.y += foot_height(run, canvas, items, keys) + GAP;
  return draw_charts(run, canvas, below);
}

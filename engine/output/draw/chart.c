/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The chart of a panel: bands, axes, cells, lines, points, marks, and a legend clear of them. */
#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/output/draw/painter.h"

static const double GRAIN = 0.25, MARKER = 2.0, LONE_MARKER = 1.4, CLOUD = 2.6; /* [pt] */
static const double INSET = 4, PADDING = 3, STRIP = 18, TITLE = 8.5, TITLE_GAP = 2.5, GAP = 6,
                    SCALE = 52;
static const double NOTE_WIDTH = 0.6, NOTE_INSET = 3; /* of the frame; [pt] */
enum { FEW_POINTS = 30, MARKERS = 8, MOST_LABELLED = 6 };

/** A chart being drawn. */
typedef struct strut_chart {
  strut_canvas *canvas;
  const strut_panel *panel; /* axes and scale settled */
  strut_axes axes;
  strut_box strip;      /* above the frame, for lost points; height 0: none */
  double (**points)[2]; /* (series) on the page, broken lines with NAN between; thinned */
  size_t *counts;       /* (series) */
  strut_arena *arena;
} strut_chart;

static strut_fill band_fill(void) { return (strut_fill){.colour = strut_grey(0.86)}; }

static size_t look_of(const strut_panel *panel, size_t i) {
  return panel->series[i].look >= 0 ? (size_t)panel->series[i].look : i;
}

static strut_pen pen_of(const strut_panel *panel, size_t i) {
  return panel->series[i].pen.width > 0 ? panel->series[i].pen
                                        : strut_series_pen(look_of(panel, i));
}

static bool has_markers(const strut_panel *panel, const strut_series *series) {
  if (series->markers != STRUT_MARKERS_AUTO) return series->markers == STRUT_MARKERS_ALL;
  return panel->series_count > 1 && !(series->pen.width > 0) && !series->cloud;
}

/* ---- the cells of a map ---- */

static strut_fill category_fill(size_t i) {
  /* Distinguishable in grey: light and dark alternate, and repeated colours are hatched. */
  static const unsigned order[] = {0xF2C14E, 0x2F6DB5, 0x8C2D62, 0xBFD8EA, 0x4C9F70, 0xE7E7E7};
  static const strut_hatch hatches[] = {STRUT_HATCH_NONE, STRUT_HATCH_RISING, STRUT_HATCH_FALLING,
                                        STRUT_HATCH_LEVEL};
  size_t count = sizeof order / sizeof *order;
  unsigned rgb = order[i % count];
  return (strut_fill){
      .colour = {(rgb >> 16) / 255.0, (rgb >> 8 & 255) / 255.0, (rgb & 255) / 255.0, 1},
      .hatch = hatches[i / count % 4],
      .hatch_colour = strut_grey(0.3)};
}

/* The lower edge of cell i of (count) ascending positions: midway to the previous one. */
static double edge(const double *at, size_t count, size_t i) {
  if (count == 1) return at[0] + (i ? 0.5 : -0.5) * (at[0] != 0 ? fabs(at[0]) : 1);
  if (i == 0) return at[0] - 0.5 * (at[1] - at[0]);
  if (i == count) return at[count - 1] + 0.5 * (at[count - 1] - at[count - 2]);
  return 0.5 * (at[i - 1] + at[i]);
}

void strut_map_limits(const double *at, size_t count, double limits[2]) {
  limits[0] = edge(at, count, 0), limits[1] = edge(at, count, count);
}

static bool has_result(const strut_map *map, size_t k) {
  return map->category ? map->category[k] >= 0 : isfinite(map->value[k]);
}

/* ---- the legend ---- */

size_t strut_panel_legend_room(const strut_panel *panel) {
  return panel->series_count + panel->band_count + (panel->map ? panel->map->category_count : 0) +
         2;
}

static size_t add_item(strut_key_item *items, size_t count, strut_key_item item) {
  if (!item.text || !*item.text) return count;
  for (size_t k = 0; k < count; k++)
    if (strcmp(items[k].text, item.text) == 0) return count;
  items[count] = item;
  return count + 1;
}

static size_t add_area(strut_key_item *items, size_t count, strut_fill fill, const char *text) {
  return add_item(items, count,
                  (strut_key_item){.sign = STRUT_KEY_AREA, .fill = fill, .text = text});
}

static size_t name_cells(const strut_map *map, strut_key_item *items, size_t count) {
  strut_fill fill = {.colour = strut_grey(1), .hatch_colour = strut_grey(0.05)};
  bool doubt = false, missing = false;
  for (size_t k = 0; k < map->columns * map->rows; k++) {
    doubt = doubt || (map->doubtful && map->doubtful[k]);
    missing = missing || !has_result(map, k);
  }
  for (size_t i = 0; map->category && i < map->category_count; i++)
    count = add_area(items, count, category_fill(i), map->names[i]);
  if (missing) count = add_area(items, count, fill, "no result");
  fill.hatch = STRUT_HATCH_RISING;
  return doubt ? add_area(items, count, fill, map->doubt ? map->doubt : "doubtful") : count;
}

size_t strut_panel_legend(const strut_panel *panel, strut_key_item *items, size_t count) {
  for (size_t i = 0; i < panel->series_count; i++) {
    strut_pen pen = pen_of(panel, i);
    strut_key_sign sign = pen.width > 4 ? STRUT_KEY_AREA : STRUT_KEY_LINE; /* bars */
    if (panel->series[i].cloud) sign = STRUT_KEY_CLOUD;
    count = add_item(items, count,
                     (strut_key_item){.sign = sign,
                                      .pen = pen,
                                      .fill = {.colour = pen.colour},
                                      .marked = has_markers(panel, &panel->series[i]),
                                      .look = look_of(panel, i),
                                      .text = panel->series[i].label});
  }
  for (size_t i = 0; i < panel->band_count; i++)
    count = add_area(items, count, band_fill(), panel->bands[i].label);
  return panel->map ? name_cells(panel->map, items, count) : count;
}

/* Counts samples of the lines that lie in a box. */
static size_t covered(const strut_chart *chart, strut_box box) {
  size_t count = 0;
  for (size_t i = 0; i < chart->panel->series_count; i++)
    for (size_t k = 0; k + 1 < chart->counts[i]; k++) {
      const double *a = chart->points[i][k], *b = chart->points[i][k + 1];
      if (isnan(a[0])) continue;
      int pieces = isnan(b[0]) ? 0 : (int)fmin(fmax(fabs(b[0] - a[0]), fabs(b[1] - a[1])) / 3, 100);
      for (int m = 0; m <= pieces; m++) {
        double t = pieces ? (double)m / pieces : 0;
        double x = t > 0 ? a[0] + t * (b[0] - a[0]) : a[0];
        double y = t > 0 ? a[1] + t * (b[1] - a[1]) : a[1];
        count += x > box.x && x < box.x + box.width && y > box.y && y < box.y + box.height;
      }
    }
  return count;
}

/* Finds a place for a legend of this size that covers no curve; false if every place covers one. */
static bool find_corner(const strut_chart *chart, strut_box *key) {
  const strut_box *box = &chart->axes.frame;
  if (chart->panel->map || key->width > 0.6 * box->width || key->height > 0.6 * box->height)
    return false;
  for (int k = 0; k < 6; k++) {
    double across = k < 4 ? (k % 2 ? 0 : 1) : 0.5, down = k < 4 ? k / 2 : k - 4;
    key->x = box->x + INSET + across * (box->width - key->width - 2 * INSET);
    key->y = box->y + INSET + down * (box->height - key->height - 2 * INSET);
    if (!covered(chart, (strut_box){key->x - 2, key->y - 2, key->width + 4, key->height + 4}))
      return true;
  }
  return false;
}

/* ---- points on the page ---- */

size_t strut_thin(double (*points)[2], size_t count, double grain) {
  size_t kept = 0;
  for (size_t i = 1; i < count; i++)
    if (!(points[i][0] >= points[i - 1][0])) return count;
  for (size_t first = 0; first < count;) {
    double cell = floor(points[first][0] / grain);
    size_t last = first, low = first, high = first;
    while (last + 1 < count && floor(points[last + 1][0] / grain) == cell) {
      last++;
      if (points[last][1] < points[low][1]) low = last;
      if (points[last][1] > points[high][1]) high = last;
    }
    size_t pick[4] = {first, low < high ? low : high, low < high ? high : low, last};
    for (int k = 0; k < 4; k++) {
      if (k > 0 && pick[k] == pick[k - 1]) continue;
      points[kept][0] =
          points[pick[k]][0]; /* kept <= pick[k]: nothing is overwritten that is read later */
      points[kept++][1] = points[pick[k]][1];
    }
    first = last + 1;
  }
  return kept;
}

/* Where point k of a series is: lost ones in the strip, each series at its own height. */
static void place(const strut_chart *chart, size_t i, size_t k, double at[2]) {
  const strut_point *p = &chart->panel->series[i].points[k];
  const strut_box *frame = &chart->axes.frame;
  bool lost = chart->panel->lost && !isfinite(p->y);
  bool zero = chart->axes.y.logarithmic && p->y == 0;
  at[0] = at[1] = (double)NAN;
  if (!isfinite(p->x) || (!isfinite(p->y) && !lost)) return;
  if (chart->axes.x.logarithmic && !(p->x > 0)) return;
  strut_axes_point(&chart->axes, p->x, lost || zero ? chart->axes.y.high : p->y, at);
  if (zero) at[1] = frame->y + frame->height; /* is off a logarithmic scale */
  double part = ((double)look_of(chart->panel, i) + 0.5) / (double)chart->panel->series_count;
  if (lost) at[1] = chart->strip.y + chart->strip.height * (0.2 + 0.6 * fmin(part, 1));
}

/* Fills the points of a series' line. Lines that change along them keep all points. */
static void place_line(strut_chart *chart, size_t i) {
  const strut_series *series = &chart->panel->series[i];
  double(*points)[2] = chart->points[i];
  size_t used = 0, start = 0;
  bool whole = false;
  for (size_t k = 0; k < series->count; k++) whole = whole || series->points[k].unstable;
  for (size_t k = 0; k <= series->count; k++) {
    double at[2] = {(double)NAN, (double)NAN};
    if (k < series->count && isfinite(series->points[k].y)) place(chart, i, k, at);
    bool known = isfinite(at[0]) && isfinite(at[1]);
    if (!known && !whole && used == start) continue;
    if (!known && !whole) used = start + strut_thin(points + start, used - start, GRAIN);
    points[used][0] = known ? at[0] : (double)NAN;
    points[used++][1] = at[1];
    if (!known) start = used;
  }
  chart->counts[i] = used;
}

/* Places frame, strip and lines in a box. */
static void place_chart(strut_chart *chart, strut_box box) {
  const strut_panel *panel = chart->panel;
  bool lost = false;
  for (size_t i = 0; i < panel->series_count && panel->lost; i++)
    for (size_t k = 0; k < panel->series[i].count; k++)
      lost = lost || !isfinite(panel->series[i].points[k].y);
  double strip = lost ? STRIP : 0;
  const strut_box rest = {box.x, box.y + strip, box.width, box.height - strip};
  chart->axes = strut_axes_place(chart->canvas, rest, panel->x, panel->y);
  chart->strip = chart->axes.frame;
  chart->strip.height = strip, chart->strip.y -= strip;
  for (size_t i = 0; i < panel->series_count; i++) place_line(chart, i);
}

static bool make_room(strut_chart *chart) {
  size_t count = chart->panel->series_count;
  chart->points = strut_arena_allocate(chart->arena, count + 1, sizeof *chart->points);
  chart->counts = strut_arena_allocate(chart->arena, count + 1, sizeof *chart->counts);
  for (size_t i = 0; chart->points && chart->counts && i < count; i++) {
    chart->points[i] = strut_arena_allocate(chart->arena, chart->panel->series[i].count + 1,
                                            sizeof **chart->points);
    if (!chart->points[i]) return false;
  }
  return chart->points && chart->counts;
}

/* ---- drawing ---- */

static void draw_bands(const strut_chart *chart) {
  const strut_fill fill = band_fill();
  for (size_t i = 0; i < chart->panel->band_count; i++) {
    const strut_band *band = &chart->panel->bands[i];
    const strut_axis *x = &chart->axes.x, *y = &chart->axes.y, *axis = band->level ? y : x;
    double from = fmax(band->low, axis->low), to = fmin(band->high, axis->high), low[2], high[2];
    if (!(to > from)) continue;
    strut_axes_point(&chart->axes, band->level ? x->low : from, band->level ? to : y->high, low);
    strut_axes_point(&chart->axes, band->level ? x->high : to, band->level ? from : y->low, high);
    strut_draw_box(chart->canvas, (strut_box){low[0], low[1], high[0] - low[0], high[1] - low[1]},
                   &fill, NULL);
  }
}

/* A note inside a box, where it is emptiest, near its upper right corner. */
static void draw_note(const strut_chart *chart, const strut_box *box, const char *text,
                      double wide) {
  strut_draw_label(
      chart->canvas,
      &(strut_label){.text = text,
                     .font = {.size = 7,
                              .colour = strut_grey(0.3),
                              .halo = strut_grey(1),
                              .width = wide * box->width},
                     .at = {box->x + box->width, box->y},
                     .inside = {box->x + NOTE_INSET, box->y + NOTE_INSET,
                                box->width - 2 * NOTE_INSET, box->height - 2 * NOTE_INSET},
                     .priority = 3,
                     .loose = true});
}

static void draw_strip(const strut_chart *chart) {
  const strut_fill grey = {.colour = strut_grey(0.94)};
  const strut_pen frame = {.colour = strut_grey(0.25), .width = 0.6};
  strut_draw_box(chart->canvas, chart->strip, &grey, &frame);
  draw_note(chart, &chart->strip, chart->panel->lost, 1);
}

static void stroke(const strut_chart *chart, size_t i, size_t from, size_t to) {
  const strut_series *series = &chart->panel->series[i];
  const double(*at)[2] = (const double(*)[2])chart->points[i] + from;
  strut_pen pen = pen_of(chart->panel, i);
  bool own = series->pen.width > 0;
  if (series->points[from].unstable)
    pen = (strut_pen){
        .colour = pen.colour, .width = (own ? 1.0 : 0.65) * pen.width, .dash = {3, 2}, .butt = own};
  if (to > from)
    strut_draw_line(chart->canvas, at, to - from + 1, pen);
  else if (!own) /* a line of one point would be invisible */
    strut_draw_marker(chart->canvas, look_of(chart->panel, i), at[0][0], at[0][1], LONE_MARKER);
}

/* Stretches without a gap and of one stability, which share their ends. */
static void draw_line(const strut_chart *chart, size_t i) {
  const double(*at)[2] = (const double(*)[2])chart->points[i];
  const strut_point *points = chart->panel->series[i].points;
  for (size_t k = 0, from = 0; k < chart->counts[i]; k++) {
    if (isnan(at[k][0])) {
      from = k + 1;
      continue;
    }
    bool last = k + 1 == chart->counts[i] || isnan(at[k + 1][0]);
    bool turns = points[k].unstable != points[from].unstable;
    if (!last && !turns) continue;
    stroke(chart, i, from, k);
    from = k;
  }
}

/* True on the frame's edge, too, and in the strip above it. */
static bool is_inside(const strut_chart *chart, const double at[2]) {
  const double hair = 0.01; /* [pt] */
  const strut_box *box = &chart->axes.frame;
  return at[0] >= box->x - hair && at[0] <= box->x + box->width + hair &&
         at[1] >= chart->strip.y - hair && at[1] <= box->y + box->height + hair;
}

static void draw_whisker(const strut_chart *chart, size_t i, size_t k) {
  const strut_point *p = &chart->panel->series[i].points[k];
  const strut_pen bar = {.colour = pen_of(chart->panel, i).colour, .width = 0.7, .butt = true};
  double ends[2][2];
  if (!isfinite(p->low) || !isfinite(p->high)) return;
  if (chart->axes.y.logarithmic && !(p->low > 0)) return;
  strut_axes_point(&chart->axes, p->x, p->low, ends[0]);
  strut_axes_point(&chart->axes, p->x, p->high, ends[1]);
  strut_draw_line(chart->canvas, (const double(*)[2])ends, 2, bar);
  for (int e = 0; e < 2; e++)
    strut_draw_segment(chart->canvas, ends[e][0] - 2, ends[e][1], ends[e][0] + 2, ends[e][1], bar);
}

static void draw_point(const strut_chart *chart, size_t i, size_t k) {
  const strut_series *series = &chart->panel->series[i];
  const strut_colour_scale *scale = &chart->panel->scale;
  double at[2];
  place(chart, i, k, at);
  if (!isfinite(at[0]) || !is_inside(chart, at)) return;
  draw_whisker(chart, i, k);
  if (!series->cloud) {
    strut_draw_marker(chart->canvas, look_of(chart->panel, i), at[0], at[1], MARKER);
    return;
  }
  double value = series->points[k].value;
  strut_fill fill = {.colour = scale->name ? strut_grey(0.75) : pen_of(chart->panel, i).colour};
  if (scale->name && isfinite(value))
    fill.colour = strut_palette_at(scale->colours, value, scale->low, scale->high);
  strut_draw_circle(chart->canvas, at[0], at[1], CLOUD, &fill, NULL);
}

/* Whole points, on the frame too. */
static void draw_points(const strut_chart *chart, size_t i) {
  const strut_series *series = &chart->panel->series[i];
  size_t look = look_of(chart->panel, i);
  bool all = series->cloud || series->markers == STRUT_MARKERS_ALL || series->count <= FEW_POINTS;
  if (!series->cloud && (!has_markers(chart->panel, series) || (!all && !series->label))) return;
  /* A few markers, at other points than those of the other curves. */
  size_t every = all ? 1 : series->count / MARKERS;
  size_t first = all ? 0 : (look * every / 3 + every / 2) % every;
  for (size_t k = first; k < series->count; k += every) draw_point(chart, i, k);
}

static strut_fill cell_fill(const strut_panel *panel, size_t k) {
  const strut_map *map = panel->map;
  const strut_colour_scale *scale = &panel->scale;
  if (!has_result(map, k)) return (strut_fill){.colour = strut_grey(1)};
  if (map->category) return category_fill((size_t)map->category[k]);
  return (strut_fill){.colour =
                          strut_palette_at(scale->colours, map->value[k], scale->low, scale->high)};
}

/* The box of (count) cells of a row from `column` on. */
static strut_box cell_box(const strut_chart *chart, size_t row, size_t column, size_t count) {
  const strut_map *map = chart->panel->map;
  double a[2], b[2];
  strut_axes_point(&chart->axes, edge(map->xs, map->columns, column), edge(map->ys, map->rows, row),
                   a);
  strut_axes_point(&chart->axes, edge(map->xs, map->columns, column + count),
                   edge(map->ys, map->rows, row + 1), b);
  return (strut_box){a[0], b[1], b[0] - a[0], a[1] - b[1]};
}

/* Cells of a map from which on neighbours in a row that look alike are drawn as one. */
enum { MANY_CELLS = 10000 };

static bool look_alike(const strut_map *map, size_t a, size_t b) {
  bool has = has_result(map, a);
  if (has != has_result(map, b)) return false;
  if (!has) return true;
  return map->category ? map->category[a] == map->category[b] : map->value[a] == map->value[b];
}

/* Hatching on a doubtful cell, a dot on one without a result. */
static void mark_cell(const strut_chart *chart, size_t k) {
  const strut_map *map = chart->panel->map;
  const strut_fill doubt = {.hatch = STRUT_HATCH_RISING, .hatch_colour = strut_grey(0.05)};
  const strut_fill dot = {.colour = strut_grey(0.5)};
  strut_box box = cell_box(chart, k / map->columns, k % map->columns, 1);
  if (map->doubtful && map->doubtful[k]) strut_draw_box(chart->canvas, box, &doubt, NULL);
  if (!has_result(map, k))
    strut_draw_circle(chart->canvas, box.x + 0.5 * box.width, box.y + 0.5 * box.height,
                      fmin(1.0, 0.25 * fmin(box.width, box.height)), &dot, NULL);
}

static void draw_map(const strut_chart *chart) {
  const strut_map *map = chart->panel->map;
  size_t cells = map->columns * map->rows, joined;
  for (size_t k = 0; k < cells; k += joined) {
    size_t row = k / map->columns, column = k % map->columns;
    for (joined = 1; cells >= MANY_CELLS && column + joined < map->columns; joined++)
      if (!look_alike(map, k, k + joined)) break;
    strut_fill fill = cell_fill(chart->panel, k);
    strut_box box = cell_box(chart, row, column, joined);
    box.width += 0.4, box.y -= 0.4, box.height += 0.4;
    strut_draw_box(chart->canvas, box, &fill, NULL);
  }
  for (size_t k = 0; k < cells; k++) mark_cell(chart, k);
}

/* ---- marks ---- */

/* A mark of the chart, or what stands for it at the frame's upper or lower edge. */
static void draw_mark(const strut_chart *chart, const strut_label *mark) {
  const strut_axes *axes = &chart->axes;
  bool above = mark->at[1] > axes->y.high, below = mark->at[1] < axes->y.low;
  strut_label label = *mark;
  strut_axes_point(axes, mark->at[0], fmin(fmax(mark->at[1], axes->y.low), axes->y.high), label.at);
  if (!is_inside(chart, label.at)) return;
  label.inside = axes->frame;
  if (above || below) {
    label.dot = label.ring = false;
    label.angle = (above ? -0.5 : 0.5) * STRUT_PI;
    label.gap = STRUT_BEYOND_SIZE + 1;
    strut_draw_beyond(chart->canvas, label.at, above ? STRUT_SIDE_TOP : STRUT_SIDE_BOTTOM, 0);
  }
  strut_draw_label(chart->canvas, &label);
}

/* Marks where curves leave the frame above or below, and says how many points are there. */
static void mark_beyond(const strut_chart *chart) {
  strut_beyond beyond = {0};
  const strut_axis *axis = &chart->axes.y;
  char text[STRUT_BEYOND_TEXT];
  size_t labelled = 0;
  for (size_t i = 0; i < chart->panel->series_count; i++) {
    const strut_series *series = &chart->panel->series[i];
    size_t farthest = SIZE_MAX; /* of the excursion that k is in */
    for (size_t k = 0; k <= series->count; k++) {
      double y = k < series->count ? series->points[k].y : (double)NAN;
      bool out = y > axis->high || y < axis->low;
      if (out && (farthest == SIZE_MAX || fabs(y) > fabs(series->points[farthest].y))) farthest = k;
      if (!out && farthest != SIZE_MAX) {
        const strut_point *p = &series->points[farthest];
        const strut_rounded_quantity value = strut_drawn_quantity(p->y, 3, axis->unit);
        strut_label mark =
            strut_mark_of(p->x, p->y, labelled++ < MOST_LABELLED ? value.text : NULL);
        mark.steady = 0.2;
        draw_mark(chart, &mark);
      }
      if (!out) farthest = SIZE_MAX;
      if (!out) continue;
      beyond.above++;
      if (fabs(y) > fabs(beyond.farthest)) beyond.farthest = y;
    }
  }
  draw_note(chart, &chart->axes.frame, strut_beyond_text(&beyond, "point", axis->unit, text),
            NOTE_WIDTH);
}

static void draw_data(const strut_chart *chart) {
  const strut_panel *panel = chart->panel;
  strut_canvas_clip(chart->canvas, chart->axes.frame);
  draw_bands(chart);
  strut_canvas_unclip(chart->canvas);
  strut_draw_axes(chart->canvas, &chart->axes);
  if (chart->strip.height > 0) draw_strip(chart);
  strut_canvas_clip(chart->canvas, chart->axes.frame);
  if (panel->map) draw_map(chart);
  strut_canvas_unclip(chart->canvas);
  for (size_t i = 0; i < panel->series_count; i++)
    if (panel->series[i].cloud) draw_points(chart, i);
  strut_canvas_clip(chart->canvas, chart->axes.frame);
  for (size_t i = 0; i < panel->series_count; i++)
    if (!panel->series[i].cloud) draw_line(chart, i);
  strut_canvas_unclip(chart->canvas);
  if (panel->map)
    strut_draw_box(chart->canvas, chart->axes.frame, NULL,
                   &(strut_pen){.colour = strut_grey(0.25), .width = 0.6});
  for (size_t i = 0; i < panel->series_count; i++)
    if (!panel->series[i].cloud) draw_points(chart, i);
  if (panel->outliers) mark_beyond(chart);
  for (size_t i = 0; i < panel->mark_count; i++) draw_mark(chart, &panel->marks[i]);
  if (panel->remark) draw_note(chart, &chart->axes.frame, panel->remark, NOTE_WIDTH);
}

/* A title, centred above the frame; returns its height. */
static double draw_title(const strut_chart *chart, strut_box box, bool draw) {
  const strut_box *f = &chart->axes.frame;
  const strut_font font = {.size = TITLE, .bold = true, .across = 0.5, .width = f->width};
  if (!chart->panel->title || !*chart->panel->title) return 0;
  if (draw) strut_draw_text(chart->canvas, f->x + 0.5 * f->width, box.y, chart->panel->title, font);
  return strut_text_height(chart->canvas, chart->panel->title, font) + TITLE_GAP;
}

bool strut_draw_chart(strut_canvas *canvas, strut_box box, const strut_panel *panel, bool legend,
                      strut_arena *arena) {
  const strut_fill white = {.colour = strut_faded(strut_grey(1), 0.85)};
  const strut_pen edge = {.colour = strut_grey(0.8), .width = 0.4};
  strut_chart c = {.canvas = canvas, .panel = panel, .arena = arena};
  strut_key_item *items =
      strut_arena_allocate(arena, strut_panel_legend_room(panel), sizeof *items);
  if (!items || !make_room(&c)) return false;
  size_t count = legend ? strut_panel_legend(panel, items, 0) : 0;
  strut_box rest = box, key = strut_draw_key(canvas, (strut_box){0, 0, 0, 0}, items, count, false);
  if (panel->scale.name) rest.width = fmax(box.width - SCALE, 60);
  place_chart(&c, rest);
  double title = draw_title(&c, box, false);
  rest.y += title, rest.height -= title;
  if (title > 0) place_chart(&c, rest);
  key.width += 2 * PADDING, key.height += 2 * PADDING;
  bool inside = count && find_corner(&c, &key);
  if (count && !inside) {
    key = (strut_box){c.axes.frame.x + PADDING, rest.y + PADDING,
                      fmax(c.axes.frame.width, 60) - 2 * PADDING, 0};
    double height = strut_draw_key(canvas, key, items, count, false).height + 2 * PADDING;
    rest.y += height, rest.height -= height;
    place_chart(&c, rest);
  }
  draw_title(&c, box, true);
  draw_data(&c);
  if (inside) { /* on a white ground */
    strut_draw_box(canvas, key, &white, &edge);
    key = (strut_box){key.x + PADDING, key.y + PADDING, 0, 0};
  }
  strut_draw_key(canvas, key, items, count, true);
  if (panel->scale.name)
    strut_draw_colour_scale(canvas,
                            (strut_box){rest.x + rest.width + GAP, c.axes.frame.y - 8, SCALE - GAP,
                                        fmax(c.axes.frame.height, 60)},
                            &panel->scale);
  return true;
}

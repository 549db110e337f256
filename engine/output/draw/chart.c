/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A panel: legend, bands, axes, cells, or structures; lines, points, marks. */
#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/output/draw/painter.h"

static const double GRAIN = 0.25, MARKER = 2.0, LONE_MARKER = 1.4, CLOUD = 2.6; /* [pt] */
static const double PADDING = 3;                                                /* [pt] */
/* Between turns of a line that is an area, on average: along x and up or down; its columns [pt]. */
static const double TURN = 1.25, VISIBLE = 8, COLUMN = 1;
enum { FEW_POINTS = 30, MARKERS = 8 };

/* A series on the page. */
typedef struct line {
  const strut_series *series;
  size_t look, count;
  strut_pen pen;
  double (*at)[2]; /* (count) thinned, broken lines with NAN between */
  bool area;       /* it turns too often to be seen */
} line;

/** A chart being drawn. */
typedef struct chart {
  strut_canvas *canvas;
  const strut_panel *panel; /* axes and scale settled */
  strut_axes axes;
  line *lines; /* (series) */
  strut_arena *arena;
} chart;

static size_t look_of(const strut_panel *panel, size_t i) {
  return panel->series[i].look >= 0 ? (size_t)panel->series[i].look : i;
}

static strut_pen pen_of(const strut_panel *panel, size_t i) {
  return panel->series[i].pen.width > 0 ? panel->series[i].pen
                                        : strut_series_pen(look_of(panel, i));
}

static bool has_markers(const strut_panel *panel, const strut_series *series) {
  return !series->unmarked && panel->series_count > 1 && !(series->pen.width > 0) &&
         series->kind == STRUT_SERIES_LINE && !(series->bar > 0);
}

/* ---- the cells of a map ---- */

static strut_fill category_fill(size_t i) {
  /* Distinguishable in grey: light and dark alternate, and repeated colours are hatched. */
  static const unsigned order[] = {0xF2C14E, 0x2F6DB5, 0x8C2D62, 0xBFD8EA, 0x4C9F70, 0xE7E7E7};
  size_t count = sizeof order / sizeof *order;
  unsigned rgb = order[i % count];
  return (strut_fill){
      .colour = {(rgb >> 16) / 255.0, (rgb >> 8 & 255) / 255.0, (rgb & 255) / 255.0, 1},
      .hatch = strut_faded(strut_grey(0.35 * fmax(0, (double)(i / count) - 1)), i >= count)};
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

/* ---- the legend ---- */

static void add_item(strut_figure *legend, strut_key_item item) {
  if (item.text && *item.text) *strut_add_key(legend, item.sign, item.pen, item.text) = item;
}

static void add_area(strut_figure *legend, strut_fill fill, const char *text) {
  add_item(legend, (strut_key_item){.sign = STRUT_KEY_AREA, .fill = fill, .text = text});
}

static void name_cells(const strut_map *map, strut_figure *legend) {
  strut_fill fill = {.colour = strut_grey(1)};
  bool doubt = false, missing = false;
  for (size_t k = 0; k < map->columns * map->rows; k++) {
    doubt = doubt || (map->doubtful && map->doubtful[k]);
    missing = missing || !isfinite(map->value[k]);
  }
  for (size_t i = 0; map->names && i < map->name_count; i++)
    add_area(legend, category_fill(i), map->names[i]);
  if (missing) add_area(legend, fill, "no result");
  fill.hatch = strut_grey(0.05);
  if (doubt) add_area(legend, fill, map->doubt ? map->doubt : "doubtful");
}

static const strut_fill band_fill = {.colour = {0.86, 0.86, 0.86, 1}};

void strut_panel_legend(const strut_panel *panel, strut_figure *legend) {
  for (size_t i = 0; i < panel->series_count; i++) {
    const strut_series *series = &panel->series[i];
    bool dots = series->kind == STRUT_SERIES_DOTS;
    strut_pen pen = pen_of(panel, i);
    add_item(legend, (strut_key_item){.sign = dots              ? STRUT_KEY_DOT
                                              : series->bar > 0 ? STRUT_KEY_AREA
                                                                : STRUT_KEY_LINE,
                                      .pen = dots ? (strut_pen){.width = 0} : pen,
                                      .fill = {.colour = pen.colour},
                                      .marked = has_markers(panel, series),
                                      .look = look_of(panel, i),
                                      .text = series->label});
  }
  for (size_t i = 0; i < panel->band_count; i++) add_area(legend, band_fill, panel->bands[i].label);
  if (panel->map) name_cells(panel->map, legend);
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
    for (int k = 0; k < 4; k++) /* kept <= pick[k]: nothing is overwritten that is read later */
      if (k == 0 || pick[k] != pick[k - 1])
        memmove(points[kept++], points[pick[k]], sizeof *points);
    first = last + 1;
  }
  return kept;
}

/* Where point k of a line is. */
static void place(const chart *self, const line *l, size_t k, double at[2]) {
  const strut_point *p = &l->series->points[k];
  const strut_box *frame = &self->axes.frame;
  bool zero = self->axes.y.logarithmic && p->y == 0;
  at[0] = at[1] = (double)NAN;
  if (!isfinite(p->x) || !isfinite(p->y)) return;
  if (self->axes.x.logarithmic && !(p->x > 0)) return;
  strut_axes_point(&self->axes, (const double[2]){p->x, zero ? self->axes.y.high : p->y}, at);
  if (zero) at[1] = frame->y + frame->height; /* is off a logarithmic scale */
}

/* An unbroken line that turns more often than can be seen is an area: pale, between least and largest. */
static void find_area(line *l) {
  size_t turns = 0, count = l->count;
  double way = 0, before = 0; /* up and down in all; the latest step */
  if (count && isnan(l->at[count - 1][0])) count--;
  for (size_t k = 1; k < count; k++) {
    double step = l->at[k][1] - l->at[k - 1][1];
    if (!(l->at[k][0] >= l->at[k - 1][0])) return;
    turns += step * before < 0;
    if (step != 0) before = step;
    way += fabs(step);
  }
  if (turns < FEW_POINTS || way < VISIBLE * (double)turns) return;
  l->area = (double)turns * TURN > l->at[count - 1][0] - l->at[0][0];
  if (!l->area) return;
  l->count = strut_thin(l->at, count, COLUMN);
  l->pen.colour = strut_faded(l->pen.colour, 0.35);
}

/* Fills the points of a line. Lines that change along them keep all points. */
static void place_line(const chart *self, line *l) {
  const strut_series *series = l->series;
  size_t used = 0, start = 0;
  bool whole = series->kind == STRUT_SERIES_SEQUENCE;
  for (size_t k = 0; k < series->count; k++) whole = whole || series->points[k].unstable;
  for (size_t k = 0; k <= series->count; k++) {
    double at[2] = {(double)NAN, (double)NAN};
    if (k < series->count) place(self, l, k, at);
    bool known = isfinite(at[0]) && isfinite(at[1]);
    if (!known && !whole && used == start) continue;
    if (!known && !whole) used = start + strut_thin(l->at + start, used - start, GRAIN);
    l->at[used][0] = known ? at[0] : (double)NAN;
    l->at[used++][1] = at[1];
    if (!known) start = used;
  }
  l->count = used;
}

/* Places all lines. False: out of memory. */
static bool place_lines(chart *self) {
  const strut_panel *panel = self->panel;
  self->lines = strut_arena_allocate(self->arena, panel->series_count + 1, sizeof *self->lines);
  for (size_t i = 0; self->lines && i < panel->series_count; i++) {
    line *l = &self->lines[i];
    l->series = &panel->series[i], l->look = look_of(panel, i), l->pen = pen_of(panel, i);
    l->at = strut_arena_allocate(self->arena, l->series->count + 1, sizeof *l->at);
    if (!l->at) return false;
    if (l->series->bar > 0) continue;
    place_line(self, l);
    if (l->series->kind == STRUT_SERIES_LINE && !(l->series->pen.width > 0)) find_area(l);
  }
  return self->lines != NULL;
}

/* ---- drawing ---- */

/* The box between two places of the axes. */
static strut_box box_between(const strut_axes *axes, const double from[2], const double to[2]) {
  double a[2], b[2];
  strut_axes_point(axes, from, a);
  strut_axes_point(axes, to, b);
  return (strut_box){a[0], b[1], b[0] - a[0], a[1] - b[1]};
}

static void draw_bands(const chart *self) {
  const strut_axis *x = &self->axes.x, *y = &self->axes.y;
  for (size_t i = 0; i < self->panel->band_count; i++) {
    const strut_band *band = &self->panel->bands[i];
    double from[2] = {x->low, y->low}, to[2] = {x->high, y->high};
    int d = band->level;
    from[d] = fmax(from[d], band->low), to[d] = fmin(to[d], band->high);
    if (to[d] > from[d])
      strut_draw_box(self->canvas, box_between(&self->axes, from, to), &band_fill, NULL);
  }
}

static void stroke(const chart *self, const line *l, size_t from, size_t to) {
  strut_pen pen = l->pen;
  bool own = l->series->pen.width > 0;
  if (l->series->points[from].unstable)
    pen = (strut_pen){
        .colour = pen.colour, .width = (own ? 1.0 : 0.65) * pen.width, .dash = {3, 2}, .butt = own};
  if (to > from)
    strut_draw_line(self->canvas, (const double(*)[2])l->at + from, to - from + 1, pen);
  else if (!own) /* a line of one point would be invisible */
    strut_draw_marker(self->canvas, l->look, l->at[from][0], l->at[from][1], LONE_MARKER);
}

/* Stretches without a gap and of one stability, which share their ends. */
static void draw_line(const chart *self, const line *l) {
  const strut_point *points = l->series->points;
  for (size_t k = 0, from = 0; k < l->count; k++) {
    if (isnan(l->at[k][0])) {
      from = k + 1;
      continue;
    }
    bool last = k + 1 == l->count || isnan(l->at[k + 1][0]);
    if (!last && points[k].unstable == points[from].unstable) continue;
    stroke(self, l, from, k);
    from = k;
  }
}

static void draw_bars(const chart *self, const line *l) {
  const strut_axis *x = &self->axes.x, *y = &self->axes.y;
  const strut_pen pen = {.colour = l->pen.colour,
                         .width = l->series->bar / (x->high - x->low) * self->axes.frame.width,
                         .butt = true};
  double ends[2][2];
  for (size_t k = 0; k < l->series->count; k++) {
    place(self, l, k, ends[1]);
    const double foot[2] = {l->series->points[k].x, y->logarithmic ? y->low : 0};
    strut_axes_point(&self->axes, foot, ends[0]);
    if (isfinite(ends[1][1])) strut_draw_line(self->canvas, (const double(*)[2])ends, 2, pen);
  }
}

/* True on the frame's edge, too. */
static bool is_inside(const chart *self, const double at[2]) {
  const double hair = 0.01; /* [pt] */
  const strut_box *box = &self->axes.frame;
  return at[0] >= box->x - hair && at[0] <= box->x + box->width + hair && at[1] >= box->y - hair &&
         at[1] <= box->y + box->height + hair;
}

static void draw_whiskers(const chart *self, const line *l) {
  const strut_series *series = l->series;
  const strut_pen bar = {
      .colour = l->series->bar > 0 ? strut_grey(0.15) : l->pen.colour, .width = 0.7, .butt = true};
  for (const strut_point *p = series->points; p < series->points + series->count; p++) {
    double ends[2][2];
    if (!isfinite(p->low) || !isfinite(p->high)) continue;
    if (self->axes.y.logarithmic && !(p->low > 0)) continue;
    strut_axes_point(&self->axes, (const double[2]){p->x, p->low}, ends[0]);
    strut_axes_point(&self->axes, (const double[2]){p->x, p->high}, ends[1]);
    strut_draw_line(self->canvas, (const double(*)[2])ends, 2, bar);
    for (int e = 0; e < 2; e++)
      strut_draw_segment(self->canvas, ends[e][0] - 2, ends[e][1], ends[e][0] + 2, ends[e][1], bar);
  }
}

static void draw_point(const chart *self, const line *l, size_t k) {
  const strut_colour_scale *scale = &self->panel->scale;
  const strut_point *p = &l->series->points[k];
  double at[2];
  place(self, l, k, at);
  if (!isfinite(at[0]) || !is_inside(self, at)) return;
  if (l->series->kind != STRUT_SERIES_DOTS) {
    strut_draw_marker(self->canvas, l->look, at[0], at[1], MARKER);
    return;
  }
  bool empty = scale->name && !isfinite(p->value);
  strut_fill fill = {.colour = l->pen.colour};
  if (scale->name && !empty)
    fill.colour = strut_palette_at(scale->colours, p->value, scale->low, scale->high);
  strut_draw_circle(self->canvas, at[0], at[1], CLOUD, empty ? NULL : &fill,
                    empty ? &(strut_pen){.colour = strut_grey(0.45), .width = 0.7} : NULL);
}

/* Whole points, on the frame too. */
static void draw_points(const chart *self, const line *l) {
  const strut_series *series = l->series;
  bool dots = series->kind == STRUT_SERIES_DOTS, all = dots || series->count <= FEW_POINTS;
  if (!dots && (!has_markers(self->panel, series) || (!all && !series->label))) return;
  /* A few markers, at other points than those of the other curves. */
  size_t every = all ? 1 : series->count / MARKERS;
  size_t first = all ? 0 : (l->look * every / 3 + every / 2) % every;
  for (size_t k = first; k < series->count; k += every) draw_point(self, l, k);
}

/* The box of (count) cells of a row from cell k on. */
static strut_box cell_box(const chart *self, size_t k, size_t count) {
  const strut_map *map = self->panel->map;
  size_t row = k / map->columns, column = k % map->columns;
  return box_between(
      &self->axes,
      (const double[2]){edge(map->xs, map->columns, column), edge(map->ys, map->rows, row)},
      (const double[2]){edge(map->xs, map->columns, column + count),
                        edge(map->ys, map->rows, row + 1)});
}

/* The colours of cells; of a large map, equal neighbours in a row are drawn as one. */
static void draw_cells(const chart *self) {
  enum { MANY_CELLS = 10000 };
  const strut_map *map = self->panel->map;
  const strut_colour_scale *scale = &self->panel->scale;
  size_t cells = map->columns * map->rows, joined;
  for (size_t k = 0; k < cells; k += joined) {
    for (joined = 1; cells >= MANY_CELLS && (k + joined) % map->columns; joined++)
      if (map->value[k + joined] != map->value[k]) break;
    double value = map->value[k];
    strut_fill fill = {.colour = strut_grey(1)};
    if (isfinite(value) && map->names) fill = category_fill((size_t)value);
    if (isfinite(value) && !map->names)
      fill.colour = strut_palette_at(scale->colours, value, scale->low, scale->high);
    strut_box box = cell_box(self, k, joined);
    box.width += 0.4, box.y -= 0.4, box.height += 0.4;
    strut_draw_box(self->canvas, box, &fill, NULL);
  }
}

/* Hatching on doubtful cells, a dot on those without a result. */
static void mark_cells(const chart *self) {
  const strut_map *map = self->panel->map;
  const strut_fill doubt = {.hatch = strut_grey(0.05)}, dot = {.colour = strut_grey(0.5)};
  for (size_t k = 0; k < map->columns * map->rows; k++) {
    strut_box box = cell_box(self, k, 1);
    double radius = fmin(1.0, 0.25 * fmin(box.width, box.height));
    if (map->doubtful && map->doubtful[k]) strut_draw_box(self->canvas, box, &doubt, NULL);
    if (!isfinite(map->value[k]))
      strut_draw_circle(self->canvas, box.x + 0.5 * box.width, box.y + 0.5 * box.height, radius,
                        &dot, NULL);
  }
}

/* ---- marks ---- */

/* A mark of the chart, or what stands for it at the frame's upper or lower edge. */
static void draw_mark(const chart *self, const strut_label *mark) {
  const strut_axes *axes = &self->axes;
  bool above = mark->at[1] > axes->y.high, below = mark->at[1] < axes->y.low;
  strut_label label = *mark;
  label.at[1] = fmin(fmax(mark->at[1], axes->y.low), axes->y.high);
  strut_axes_point(axes, label.at, label.at);
  if (!is_inside(self, label.at)) return;
  label.inside = axes->frame;
  if (above || below) {
    label.dot = label.ring = false;
    label.angle = (above ? -0.5 : 0.5) * STRUT_PI;
    label.gap = STRUT_BEYOND_SIZE + 1;
    strut_draw_arrow(self->canvas, label.at[0], label.at[1] + (above ? 1 : -1) * STRUT_BEYOND_SIZE,
                     label.at[0], label.at[1], STRUT_BEYOND_SIZE,
                     (strut_pen){.colour = strut_grey(0.15)});
  }
  strut_draw_label(self->canvas, &label);
}

/* Marks where curves leave the frame above or below. */
static void mark_beyond(const chart *self) {
  const strut_axis *axis = &self->axes.y;
  for (size_t i = 0; i < self->panel->series_count; i++) {
    const strut_series *series = &self->panel->series[i];
    bool before = false;
    for (const strut_point *p = series->points; p < series->points + series->count; p++) {
      bool out = p->y > axis->high || p->y < axis->low;
      if (out && !before) draw_mark(self, &(strut_label){.at = {p->x, p->y}});
      before = out;
    }
  }
}

static void draw_sequence(const chart *self, const line *l) {
  enum { SHADES = 64 };
  size_t all = l->count > 2 ? l->count - 2 : 0;
  for (size_t shade = 0; shade < SHADES; shade++) {
    size_t first = shade * all / SHADES, last = (shade + 1) * all / SHADES;
    strut_pen pen = l->pen;
    pen.colour = strut_palette_at(STRUT_COLOURS_SEQUENTIAL, (double)shade, 0, SHADES - 1);
    if (last > first)
      strut_draw_line(self->canvas, (const double(*)[2])l->at + first, last - first + 1, pen);
  }
}

/* An arrow ends before the node at its tip; one that is no longer than that is not drawn. */
static void draw_arrow(const chart *self, const line *l) {
  const double node = 2.5; /* of a node as drawn [pt] */
  if (l->count < 3) return;
  const double *from = l->at[0], *to = l->at[l->count - 2];
  double x = to[0] - from[0], y = to[1] - from[1], length = hypot(x, y);
  double end = length > 3 * node ? node / length : 0;
  if (length >= 2 * node)
    strut_draw_arrow(self->canvas, from[0], from[1], to[0] - end * x, to[1] - end * y, 5, l->pen);
}

/* Is a line of its own pen longer than a dot? */
static bool is_visible(const line *l) {
  bool own = l->series->pen.width > 0 && !(l->series->bar > 0);
  double farthest = own ? 0.0 : HUGE_VAL;
  for (size_t k = 1; k + 1 < l->count; k++)
    farthest = fmax(farthest, strut_distance(l->at[k], l->at[0]));
  return farthest > 0.3;
}

/* All series but dots, within the frame. */
static void draw_lines(const chart *self) {
  static void (*const draw[])(const chart *self, const line *l) = {
      [STRUT_SERIES_LINE] = draw_line,
      [STRUT_SERIES_SEQUENCE] = draw_sequence,
      [STRUT_SERIES_ARROW] = draw_arrow};
  strut_canvas_clip(self->canvas, self->axes.frame);
  for (const line *l = self->lines; l < self->lines + self->panel->series_count; l++) {
    if (l->series->kind == STRUT_SERIES_DOTS || !is_visible(l)) continue;
    (l->series->bar > 0 ? draw_bars : draw[l->series->kind])(self, l);
    draw_whiskers(self, l);
  }
  strut_canvas_unclip(self->canvas);
}

/* The dots, or the markers of the lines. */
static void draw_all_points(const chart *self, bool dots) {
  for (const line *l = self->lines; l < self->lines + self->panel->series_count; l++)
    if ((l->series->kind == STRUT_SERIES_DOTS) == dots) draw_points(self, l);
}

static void draw_chart(const chart *self) {
  bool areas = false;
  const strut_panel *panel = self->panel;
  const strut_pen frame = {.colour = strut_grey(0.25), .width = 0.6};
  strut_canvas_clip(self->canvas, self->axes.frame);
  draw_bands(self);
  strut_canvas_unclip(self->canvas);
  strut_draw_axes(self->canvas, &self->axes);
  strut_canvas_clip(self->canvas, self->axes.frame);
  if (panel->map) draw_cells(self), mark_cells(self);
  strut_canvas_unclip(self->canvas);
  draw_all_points(self, true);
  draw_lines(self);
  if (panel->map) strut_draw_box(self->canvas, self->axes.frame, NULL, &frame);
  draw_all_points(self, false);
  if (panel->outliers) mark_beyond(self);
  for (size_t i = 0; i < panel->mark_count; i++) draw_mark(self, &panel->marks[i]);
  for (size_t i = 0; i < panel->series_count; i++) areas = areas || self->lines[i].area;
  const strut_box *box = &self->axes.frame;
  if (areas)
    strut_draw_label(self->canvas, &(strut_label){.text = "areas: ranges of oscillations",
                                                  .font = {.size = 7, .halo = strut_grey(1)},
                                                  .at = {box->x + box->width, box->y},
                                                  .inside = *box});
}

/* Structures, lines and marks in their plane. */
static void draw_view(const chart *self) {
  const strut_panel *view = self->panel;
  const strut_box *box = &self->axes.frame;
  strut_canvas_clip(self->canvas, *box);
  strut_draw_shapes(self->canvas, &self->axes, view);
  draw_lines(self);
  for (size_t i = 0; i < view->mark_count; i++) draw_mark(self, &view->marks[i]);
  strut_canvas_unclip(self->canvas);
  strut_draw_names(self->canvas, &self->axes, view);
  if (view->yardstick)
    strut_draw_yardstick(self->canvas, box->x, box->y + box->height, box->width, self->axes.scale);
}

bool strut_draw_panel(strut_canvas *canvas, strut_box box, const strut_panel *panel, bool legend,
                      strut_arena *arena) {
  chart c = {.canvas = canvas, .panel = panel, .arena = arena};
  strut_figure key = {0};
  if (panel->shape_count) {
    c.axes = strut_view_axes(box, panel);
    if (place_lines(&c)) draw_view(&c);
    return c.lines != NULL;
  }
  if (legend) strut_panel_legend(panel, &key);
  c.axes = strut_axes_place(canvas, box, panel->x, panel->y);
  const strut_box place = {c.axes.frame.x + PADDING, box.y + PADDING,
                           fmax(c.axes.frame.width, 60) - 2 * PADDING, 0};
  double above = strut_draw_key(canvas, place, key.keys, key.key_count).height;
  if (above > 0) above += 2 * PADDING;
  strut_arena_free(&key.arena);
  box.y += above, box.height -= above;
  c.axes = strut_axes_place(canvas, box, panel->x, panel->y);
  if (key.failed || !place_lines(&c)) return false;
  draw_chart(&c);
  return true;
}

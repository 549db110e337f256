/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/compare/compare.h"

#include <math.h>
#include <stdio.h>

#include "engine/base/c_locale.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/draw/chart.h"
#include "engine/output/draw/legend.h"
#include "engine/output/draw/structure.h"

static const double EDGE = 5, GAP = 12, TITLE = 13, LINE = 11, MARGIN = 16, NARROWEST = 150;
static const double FOOT = 0.08; /* space for the scale bar, relative to the extent */
static const double DOT = 4.0;   /* radius around a node [pt] */
static const double UNLIKE = 4.0, FLATTEST = 0.35, TALLEST = 1.2;
enum { COLUMNS = 3, NAMED = 40, WORDS = 200, KEYS = 5, DRIVEN = 2, LINES = 3 };

typedef struct sheet {
  const strut_compare_column *columns; /* (count) */
  size_t count, across, rows;
  double width, cell, height; /* of a panel, its texts included [pt] */
  bool alike;                 /* the same scale for all */
  double size[2];             /* the largest extents [m] */
  strut_canvas *canvas;
} sheet;

static strut_bounds bounds_of(const strut_compare_column *c) {
  strut_bounds bounds = strut_bounds_none();
  strut_bounds_add(&bounds, c->model, c->q);
  return bounds;
}

static void lay_out(sheet *s) {
  double least = HUGE_VAL, most = 0.0;
  for (size_t i = 0; i < s->count; i++) {
    strut_bounds b = bounds_of(&s->columns[i]);
    double wide = b.high[0] - b.low[0], high = b.high[1] - b.low[1], extent = fmax(wide, high);
    least = fmin(least, extent);
    most = fmax(most, extent);
    s->size[0] = fmax(s->size[0], wide);
    s->size[1] = fmax(s->size[1], high);
  }
  s->alike = most <= UNLIKE * least;
  s->across = (size_t)fmax(1, fmin(COLUMNS, floor((s->width - 2 * EDGE) / NARROWEST)));
  if (s->across > s->count) s->across = s->count;
  s->rows = (s->count + s->across - 1) / s->across;
  s->cell = (s->width - 2 * EDGE - (double)(s->across - 1) * GAP) / (double)s->across;
  double aspect = s->alike && s->size[0] > 0 ? s->size[1] / s->size[0] : 0.8;
  s->height = TITLE + LINES * LINE + 2 * MARGIN +
              (s->cell - 2 * MARGIN) * fmax(FLATTEST, fmin(TALLEST, aspect));
}

/* The structure's own extent, or the largest of all about its middle and from its foot on. */
static strut_bounds shown(const sheet *s, const strut_compare_column *c) {
  strut_bounds b = bounds_of(c);
  double extent = fmax(b.high[0] - b.low[0], b.high[1] - b.low[1]);
  if (!s->alike) b.low[1] -= FOOT * extent;
  if (!s->alike) return b;
  double middle = 0.5 * (b.low[0] + b.high[0]);
  b.low[0] = middle - 0.5 * s->size[0];
  b.high[0] = middle + 0.5 * s->size[0];
  b.high[1] = b.low[1] + s->size[1];
  b.low[1] -= FOOT * fmax(s->size[0], s->size[1]);
  return b;
}

/* A driven member's segment, as a broad line that leaves its nodes visible. */
static void mark_segment(const sheet *s, double from[2], double to[2]) {
  double length = hypot(to[0] - from[0], to[1] - from[1]);
  for (int d = 0; d < 2 && length > 3 * DOT; d++) {
    double step = DOT * (to[d] - from[d]) / length;
    from[d] += step;
    to[d] -= step;
  }
  strut_draw_segment(s->canvas, from[0], from[1], to[0], to[1],
                     (strut_pen){.colour = strut_grey(1.0), .width = 4.2});
  strut_draw_segment(s->canvas, from[0], from[1], to[0], to[1],
                     (strut_pen){.colour = strut_palette_thing(DRIVEN), .width = 2.6});
}

static void mark_driven(const sheet *s, const strut_window *window, const strut_compare_column *c) {
  const strut_scene *scene = c->model->scene;
  for (size_t i = 0; i < scene->actuator_count; i++) {
    if (scene->actuators[i].member < 0) continue;
    size_t member = (size_t)scene->actuators[i].member;
    for (size_t k = 0; k < strut_member_segments(c->model, member); k++) {
      double ends[2][2];
      strut_window_segment(window, c->model, c->q, member, k, ends);
      mark_segment(s, ends[0], ends[1]);
    }
  }
}

/* The most important results, in three lines. */
static void words_of(const strut_compare_column *c, char words[LINES][WORDS]) {
  const strut_compare_cell *v = c->cell;
  double states = v[STRUT_COMPARE_STATES].value, lowest = v[STRUT_COMPARE_FREQUENCY_1].value;
  strut_c_locale locale = strut_c_locale_enter();
  int used = snprintf(words[0], WORDS, "%.0f nodes, %.0f members", v[STRUT_COMPARE_NODES].value,
                      v[STRUT_COMPARE_MEMBERS].value);
  if (v[STRUT_COMPARE_MASS].value > 0)
    snprintf(words[0] + used, WORDS - (size_t)used, ", %s",
             strut_drawn_quantity(1000 * v[STRUT_COMPARE_MASS].value, 3, "g").text);
  used = 0;
  if (states > 0)
    used = snprintf(words[1], WORDS, "%.0f stable state%s", states, states > 1 ? "s" : "");
  if (isfinite(lowest))
    snprintf(words[1] + used, WORDS - (size_t)used, "%s%s",
             used ? ", lowest frequency " : "lowest frequency ",
             strut_drawn_quantity(lowest, 3, "Hz").text);
  used = 0;
  if (c->still)
    snprintf(words[2], WORDS, "no net motion");
  else if (isfinite(v[STRUT_COMPARE_VELOCITY].value))
    used = snprintf(words[2], WORDS, "%s",
                    strut_drawn_quantity(v[STRUT_COMPARE_VELOCITY].value, 3, "m/s").text);
  if (isfinite(v[STRUT_COMPARE_TRANSPORT].value))
    snprintf(words[2] + used, WORDS - (size_t)used, ", cost of transport %.3g",
             v[STRUT_COMPARE_TRANSPORT].value);
  strut_c_locale_leave(locale);
}

static void draw_text(const sheet *s, double x, double y, const char *text, strut_font font) {
  char fitted[STRUT_FITTED_TEXT];
  strut_draw_text(s->canvas, x, y, strut_text_fit(s->canvas, text, font, s->cell, 0, fitted), font);
}

static void draw_panel(const sheet *s, const strut_compare_column *c, strut_box box) {
  char words[LINES][WORDS] = {{0}};
  words_of(c, words);
  const strut_font plain = {.size = 7, .colour = strut_grey(0.3)};
  draw_text(s, box.x, box.y, c->input->label, (strut_font){.size = 8.5, .bold = true});
  for (int i = 0; i < LINES; i++) draw_text(s, box.x, box.y + TITLE + LINE * i, words[i], plain);
  double head = TITLE + LINES * LINE;
  strut_box inner = {box.x, box.y + head, box.width, box.height - head};
  strut_window window = strut_window_fit(inner, shown(s, c), MARGIN);
  const strut_structure_style by_kind = {.colouring = STRUT_COLOUR_KIND};
  strut_canvas_clip(s->canvas, inner);
  strut_draw_ground(s->canvas, &window, c->model);
  strut_draw_structure(s->canvas, &window, c->model, c->q, &by_kind);
  mark_driven(s, &window, c);
  if (c->model->node_count <= NAMED) strut_draw_names(s->canvas, &window, c->model, c->q, false);
  strut_canvas_unclip(s->canvas);
  if (!s->alike || c == s->columns) strut_draw_yardstick(s->canvas, &window);
}

static strut_key_item line(strut_colour colour, double width, const char *text) {
  return (strut_key_item){
      .sign = STRUT_KEY_LINE, .pen = {.colour = colour, .width = width}, .text = text};
}

static bool any(const sheet *s, strut_compare_quantity quantity) {
  for (size_t i = 0; i < s->count; i++)
    if (s->columns[i].cell[quantity].value > 0) return true;
  return false;
}

static size_t make_key(const sheet *s, strut_key_item items[KEYS]) {
  size_t count = 0;
  if (any(s, STRUT_COMPARE_BARS)) items[count++] = line(strut_grey(0.13), 3.0, "bar");
  if (any(s, STRUT_COMPARE_SPRINGS)) items[count++] = line(strut_palette_thing(0), 1.4, "spring");
  if (any(s, STRUT_COMPARE_CABLES)) items[count++] = line(strut_palette_thing(1), 1.0, "cable");
  if (any(s, STRUT_COMPARE_ACTUATORS))
    items[count++] = line(strut_palette_thing(DRIVEN), 2.6, "driven");
  if (s->alike && s->count > 1)
    items[count++] = (strut_key_item){.sign = STRUT_KEY_WORDS, .text = "same scale"};
  return count;
}

strut_status strut_compare_figure(const strut_plot *plot, const strut_compare *result, size_t first,
                                  size_t count, strut_error *error) {
  double width = plot->width, top = EDGE, head = 0.0;
  const strut_heading heading = {.width = width, .edge = EDGE, .title = plot->title};
  sheet s = {.columns = result->columns + first, .count = count, .width = width};
  strut_key_item items[KEYS] = {{0}};
  lay_out(&s);
  size_t keys = make_key(&s, items);
  strut_canvas *ruler;
  strut_status status = strut_canvas_open_pixels(1, 1, 1.0, &ruler, error);
  if (status != STRUT_OK) return status;
  double key = strut_key_height(ruler, width - 2 * EDGE, items, keys);
  strut_canvas_free(ruler);
  status = strut_heading_measure(&heading, &head, error);
  if (status != STRUT_OK) return status;
  top += head;
  double height = top + EDGE + (double)s.rows * (s.height + GAP) + key;
  status = strut_canvas_open(plot->path, width, height,
                             strut_plot_title(plot, "Structures side by side"), &s.canvas, error);
  if (status != STRUT_OK) return status;
  strut_heading_draw(s.canvas, &heading);
  for (size_t i = 0; i < count; i++)
    draw_panel(&s, &s.columns[i],
               (strut_box){EDGE + (double)(i % s.across) * (s.cell + GAP),
                           top + (double)(i / s.across) * (s.height + GAP), s.cell, s.height});
  strut_draw_key(s.canvas, (strut_box){EDGE, height - EDGE - key, width - 2 * EDGE, key}, items,
                 keys);
  status = strut_canvas_commit(s.canvas, error);
  strut_canvas_free(s.canvas);
  return status;
}

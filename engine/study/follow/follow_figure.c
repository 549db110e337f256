/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Velocity over the parameter: stable motions solid, unstable ones dashed, special points marked. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/output/draw/legend.h"
#include "engine/study/follow/follow_study.h"

static const double EDGE = 4.0, PAGE = 510.24, ASPECT = 0.6, ROOM = 0.04; /* [pt], [1] */
static const double MARKER = 2.6, NAME = 7.0, KEY = 16.0;                 /* [pt] */
enum { MOST_NAMES = 40, KINDS = 4 };

typedef struct mark {
  double at[2];
  const strut_follow_point *point;
} mark;

typedef struct drawing {
  strut_canvas *canvas;
  const strut_follow_result *r;
  strut_axes axes;
  double (*points)[2]; /* of the longest branch */
  mark marks[MOST_NAMES];
  size_t mark_count;
} drawing;

/* Is the point marked in the figure? Events that change nothing are in the table alone. */
static bool is_marked(const strut_follow_point *p) {
  if (p->kind >= STRUT_FOLLOW_FOLD && p->kind <= STRUT_FOLLOW_TORUS) return true;
  return p->detail && p->changes;
}

/* What is drawn: velocity, or amplitude of what does not travel. */
static double height_of(const strut_follow_branch *b, const strut_follow_point *p) {
  return b->travels ? p->velocity : p->amplitude;
}

static strut_colour kind_colour(strut_follow_kind kind) {
  switch (kind) {
    case STRUT_FOLLOW_FOLD: return strut_palette_thing(5);
    case STRUT_FOLLOW_DOUBLING: return strut_palette_thing(2);
    case STRUT_FOLLOW_TORUS:
    case STRUT_FOLLOW_BRANCHING: return strut_palette_thing(3);
    case STRUT_FOLLOW_REGULAR:
    case STRUT_FOLLOW_START:
    case STRUT_FOLLOW_END:
    case STRUT_FOLLOW_TOUCH:
    case STRUT_FOLLOW_LIFT:
    case STRUT_FOLLOW_STICK:
    case STRUT_FOLLOW_SLIP:
    case STRUT_FOLLOW_SWITCH:
    case STRUT_FOLLOW_MEETING:
    case STRUT_FOLLOW_KINDS: break;
  }
  return strut_grey(1.0);
}

/* Stretches of equal stability, which share their ends. */
static void draw_branch(drawing *d, size_t index) {
  const strut_follow_branch *b = &d->r->branches[index].branch;
  strut_pen pen = {.colour = strut_palette_thing(index), .width = 1.2};
  size_t from = 0;
  for (size_t k = 0; k < b->count; k++)
    strut_axes_point(&d->axes, b->points[k].value, height_of(b, &b->points[k]), d->points[k]);
  for (size_t k = 1; k <= b->count; k++) {
    if (k < b->count && b->points[k].stable == b->points[from].stable) continue;
    bool stable = b->points[from].stable;
    pen.dash[0] = stable ? 0.0 : 3.0, pen.dash[1] = stable ? 0.0 : 2.0;
    pen.width = stable ? 1.4 : 0.9;
    strut_draw_line(d->canvas, (const double(*)[2])d->points + from,
                    (k < b->count ? k + 1 : k) - from, pen);
    from = k;
  }
}

static void gather_marks(drawing *d) {
  for (size_t i = 0; i < d->r->count; i++) {
    const strut_follow_branch *b = &d->r->branches[i].branch;
    for (size_t k = 0; k < b->count && d->mark_count < MOST_NAMES; k++) {
      const strut_follow_point *p = &b->points[k];
      if (!is_marked(p)) continue;
      mark *m = &d->marks[d->mark_count++];
      m->point = p;
      strut_axes_point(&d->axes, p->value, height_of(b, p), m->at);
    }
  }
}

/* Names stand where they are clear of the others, else nowhere. */
static void draw_marks(drawing *d) {
  static const double sides[4][2] = {{1, -1}, {-1, -1}, {1, 1}, {-1, 1}};
  strut_box taken[MOST_NAMES];
  size_t count = 0;
  const strut_pen edge = {.colour = strut_grey(0.1), .width = 0.6};
  for (size_t i = 0; i < d->mark_count; i++) {
    const strut_fill fill = {.colour = kind_colour(d->marks[i].point->kind)};
    strut_draw_circle(d->canvas, d->marks[i].at[0], d->marks[i].at[1], MARKER, &fill, &edge);
  }
  for (size_t i = 0; i < d->mark_count; i++) {
    const strut_follow_point *p = d->marks[i].point;
    char text[120];
    double width, height;
    strut_font font = {.size = NAME, .halo = strut_faded(strut_grey(1), 0.85)};
    snprintf(text, sizeof text, "%s%s%.60s", strut_follow_kind_word(p->kind), p->node ? " " : "",
             p->node ? p->node : "");
    strut_text_size(d->canvas, text, font, &width, &height);
    for (int side = 0; side < 4; side++) {
      strut_box box = {d->marks[i].at[0] + (sides[side][0] > 0 ? 4.0 : -4.0 - width),
                       d->marks[i].at[1] + (sides[side][1] > 0 ? 3.0 : -3.0 - height), width,
                       height};
      bool clear = box.x >= d->axes.frame.x && box.y >= d->axes.frame.y &&
                   box.x + width <= d->axes.frame.x + d->axes.frame.width &&
                   box.y + height <= d->axes.frame.y + d->axes.frame.height;
      for (size_t k = 0; k < count && clear; k++)
        clear = box.x + box.width < taken[k].x || taken[k].x + taken[k].width < box.x ||
                box.y + box.height < taken[k].y || taken[k].y + taken[k].height < box.y;
      if (!clear) continue;
      strut_draw_text(d->canvas, box.x, box.y, text, font);
      taken[count++] = box;
      break;
    }
  }
}

static void draw_key(drawing *d, strut_box box) {
  const strut_pen solid = {.colour = strut_grey(0.2), .width = 1.4};
  const strut_pen dashed = {.colour = strut_grey(0.2), .width = 0.9, .dash = {3.0, 2.0}};
  const strut_pen edge = {.colour = strut_grey(0.1), .width = 0.6};
  const strut_key_item items[] = {{.sign = STRUT_KEY_LINE, .pen = solid, .text = "stable"},
                                  {.sign = STRUT_KEY_LINE, .pen = dashed, .text = "unstable"},
                                  {.sign = STRUT_KEY_DOT,
                                   .pen = edge,
                                   .fill = {.colour = kind_colour(STRUT_FOLLOW_FOLD)},
                                   .text = "fold"},
                                  {.sign = STRUT_KEY_DOT,
                                   .pen = edge,
                                   .fill = {.colour = kind_colour(STRUT_FOLLOW_DOUBLING)},
                                   .text = "period doubling"},
                                  {.sign = STRUT_KEY_DOT,
                                   .pen = edge,
                                   .fill = {.colour = kind_colour(STRUT_FOLLOW_TORUS)},
                                   .text = "torus, branching"},
                                  {.sign = STRUT_KEY_DOT,
                                   .pen = edge,
                                   .fill = {.colour = kind_colour(STRUT_FOLLOW_TOUCH)},
                                   .text = "an event that changes the stability"}};
  strut_draw_key(d->canvas, box, items, sizeof items / sizeof items[0]);
}

strut_status strut_follow_figure(const strut_plot *plot, const strut_follow_result *r,
                                 strut_error *error) {
  double width = plot->width > 0.0 ? plot->width : PAGE;
  drawing d = {.r = r};
  strut_arena arena = {0};
  size_t longest = 1;
  strut_axis x = {r->name, r->unit, false, (double)NAN, (double)NAN};
  bool travels = r->count && r->branches[0].branch.travels;
  strut_axis y = {travels ? "velocity" : "amplitude", travels ? "m/s" : "m", false, (double)NAN,
                  (double)NAN};
  const char *title = strut_plot_title(plot, r->title);
  strut_c_locale locale = strut_c_locale_enter();
  for (size_t i = 0; i < r->count; i++) {
    const strut_follow_branch *b = &r->branches[i].branch;
    if (b->count > longest) longest = b->count;
    for (size_t k = 0; k < b->count; k++) {
      strut_axis_include(&x, b->points[k].value);
      strut_axis_include(&y, height_of(b, &b->points[k]));
    }
  }
  strut_axis_settle(&x, 0.0);
  strut_axis_settle(&y, ROOM);
  strut_axis_choose(&x, &plot->x);
  strut_axis_choose(&y, &plot->y);
  d.points = strut_arena_allocate(&arena, longest, sizeof *d.points);
  strut_status status = d.points
                            ? strut_canvas_open(plot->path, width, ASPECT * width + KEY + 2 * EDGE,
                                                title, &d.canvas, error)
                            : strut_no_memory(error, "while drawing");
  if (!status) {
    strut_box box = {EDGE, EDGE, width - 2 * EDGE, ASPECT * width};
    d.axes = strut_axes_place(d.canvas, box, x, y, NULL, title);
    strut_draw_axes(d.canvas, &d.axes, title);
    strut_canvas_clip(d.canvas, d.axes.frame);
    for (size_t i = 0; i < r->count; i++) draw_branch(&d, i);
    strut_canvas_unclip(d.canvas);
    gather_marks(&d);
    draw_marks(&d);
    box.y += box.height + 2.0;
    draw_key(&d, box);
    status = strut_canvas_commit(d.canvas, error);
  }
  strut_canvas_free(d.canvas);
  strut_arena_free(&arena);
  strut_c_locale_leave(locale);
  return status;
}

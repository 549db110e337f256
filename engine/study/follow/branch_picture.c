/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/follow/branch_picture.h"

#include <math.h>
#include <stdio.h>

#include "engine/base/c_locale.h"

static const double EDGE = 4.0, PAGE = 510.24, ASPECT = 0.6, ROOM = 0.04; /* [pt], [1] */
static const double MARKER = 2.6, NAME = 7.0, GAP = 2.0;                  /* [pt] */
enum { MOST_NAMES = 40 };

typedef struct drawing {
  strut_canvas *canvas;
  const strut_branch_picture *p;
  strut_axes axes;
  double (*points)[2]; /* of the longest line [pt] */
} drawing;

strut_colour strut_branch_colour(strut_follow_kind kind) {
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

void strut_branch_keys(strut_key_item keys[STRUT_BRANCH_KEYS]) {
  const strut_pen solid = {.colour = strut_grey(0.2), .width = 1.4};
  const strut_pen dashed = {.colour = strut_grey(0.2), .width = 0.9, .dash = {3.0, 2.0}};
  const strut_pen edge = {.colour = strut_grey(0.1), .width = 0.6};
  const struct {
    strut_follow_kind kind;
    const char *text;
  } dots[] = {{STRUT_FOLLOW_FOLD, "fold"},
              {STRUT_FOLLOW_DOUBLING, "period doubling"},
              {STRUT_FOLLOW_TORUS, "torus, branching"},
              {STRUT_FOLLOW_TOUCH, "an event that changes the stability"}};
  keys[0] = (strut_key_item){.sign = STRUT_KEY_LINE, .pen = solid, .text = "stable"};
  keys[1] = (strut_key_item){.sign = STRUT_KEY_LINE, .pen = dashed, .text = "unstable"};
  for (size_t i = 0; i < sizeof dots / sizeof dots[0]; i++)
    keys[i + 2] = (strut_key_item){.sign = STRUT_KEY_DOT,
                                   .pen = edge,
                                   .fill = {.colour = strut_branch_colour(dots[i].kind)},
                                   .text = dots[i].text};
}

/* Stretches of equal stability, which share their ends. */
static void draw_line(drawing *d, const strut_branch_line *line) {
  strut_pen pen = {.colour = strut_palette_thing(line->look), .width = 1.2};
  size_t from = 0;
  for (size_t k = 0; k < line->count; k++)
    strut_axes_point(&d->axes, line->data[k][0], line->data[k][1], d->points[k]);
  for (size_t k = 1; k <= line->count; k++) {
    if (k < line->count && line->stable[k] == line->stable[from]) continue;
    bool stable = line->stable[from];
    pen.dash[0] = stable ? 0.0 : 3.0, pen.dash[1] = stable ? 0.0 : 2.0;
    pen.width = stable ? 1.4 : 0.9;
    strut_draw_line(d->canvas, (const double(*)[2])d->points + from,
                    (k < line->count ? k + 1 : k) - from, pen);
    from = k;
  }
}

static bool overlaps(const strut_box *a, const strut_box *b) {
  return !(a->x + a->width < b->x || b->x + b->width < a->x || a->y + a->height < b->y ||
           b->y + b->height < a->y);
}

static bool is_within(const strut_box *box, const strut_box *frame) {
  return box->x >= frame->x && box->y >= frame->y &&
         box->x + box->width <= frame->x + frame->width &&
         box->y + box->height <= frame->y + frame->height;
}

/* The name of a mark where it is clear of the others, else nowhere. */
static void draw_name(drawing *d, const strut_branch_mark *m, strut_box *taken, size_t *count) {
  static const double sides[4][2] = {{1, -1}, {-1, -1}, {1, 1}, {-1, 1}};
  const strut_font font = {.size = NAME, .halo = strut_faded(strut_grey(1), 0.85)};
  char text[120];
  double at[2], width, height;
  strut_axes_point(&d->axes, m->data[0], m->data[1], at);
  snprintf(text, sizeof text, "%s%s%.60s", strut_follow_kind_word(m->kind),
           m->node && *m->node ? " " : "", m->node ? m->node : "");
  strut_text_size(d->canvas, text, font, &width, &height);
  for (int side = 0; side < 4; side++) {
    strut_box box = {at[0] + (sides[side][0] > 0 ? 4.0 : -4.0 - width),
                     at[1] + (sides[side][1] > 0 ? 3.0 : -3.0 - height), width, height};
    bool clear = is_within(&box, &d->axes.frame);
    for (size_t k = 0; k < *count && clear; k++) clear = !overlaps(&box, &taken[k]);
    if (!clear) continue;
    strut_draw_text(d->canvas, box.x, box.y, text, font);
    taken[(*count)++] = box;
    return;
  }
}

static void draw_marks(drawing *d) {
  strut_box taken[MOST_NAMES];
  size_t count = 0;
  const strut_pen edge = {.colour = strut_grey(0.1), .width = 0.6};
  for (size_t i = 0; i < d->p->mark_count; i++) {
    const strut_branch_mark *m = &d->p->marks[i];
    const strut_fill fill = {.colour = strut_branch_colour(m->kind)};
    double at[2];
    strut_axes_point(&d->axes, m->data[0], m->data[1], at);
    strut_draw_circle(d->canvas, at[0], at[1], MARKER, &fill, &edge);
  }
  for (size_t i = 0; i < d->p->mark_count && count < MOST_NAMES; i++)
    draw_name(d, &d->p->marks[i], taken, &count);
}

/* Height of the key, which a canvas must be there to measure. */
static strut_status measure_key(const strut_branch_picture *p, double width, double *height,
                                strut_error *error) {
  strut_canvas *ruler;
  strut_status status = strut_canvas_open_pixels(1, 1, 1.0, &ruler, error);
  if (status) return status;
  *height = strut_key_height(ruler, width, p->keys, p->key_count);
  strut_canvas_free(ruler);
  return STRUT_OK;
}

static strut_status draw_on_canvas(drawing *d, const strut_plot *plot, strut_axis x, strut_axis y,
                                   strut_error *error) {
  const strut_branch_picture *p = d->p;
  const char *title = strut_plot_title(plot, p->title);
  double width = plot->width > 0.0 ? plot->width : PAGE, key = 0.0;
  strut_box box = {EDGE, EDGE, width - 2 * EDGE, ASPECT * width};
  strut_status status = measure_key(p, box.width, &key, error);
  if (!status)
    status = strut_canvas_open(plot->path, width, box.height + GAP + key + 2 * EDGE, title,
                               &d->canvas, error);
  if (status) return status;
  d->axes = strut_axes_place(d->canvas, box, x, y, NULL, title);
  strut_draw_axes(d->canvas, &d->axes, title);
  strut_canvas_clip(d->canvas, d->axes.frame);
  for (size_t i = 0; i < p->line_count; i++) draw_line(d, &p->lines[i]);
  strut_canvas_unclip(d->canvas);
  draw_marks(d);
  box.y += box.height + GAP;
  box.height = key;
  strut_draw_key(d->canvas, box, p->keys, p->key_count);
  return strut_canvas_commit(d->canvas, error);
}

strut_status strut_branch_draw(const strut_plot *plot, const strut_branch_picture *picture,
                               strut_error *error) {
  drawing d = {.p = picture};
  strut_arena arena = {0};
  strut_axis x = picture->x, y = picture->y;
  size_t longest = 1;
  strut_c_locale locale = strut_c_locale_enter();
  x.low = x.high = y.low = y.high = (double)NAN;
  for (size_t i = 0; i < picture->line_count; i++) {
    const strut_branch_line *line = &picture->lines[i];
    if (line->count > longest) longest = line->count;
    for (size_t k = 0; k < line->count; k++) {
      strut_axis_include(&x, line->data[k][0]);
      strut_axis_include(&y, line->data[k][1]);
    }
  }
  strut_axis_settle(&x, 0.0);
  strut_axis_settle(&y, ROOM);
  strut_axis_choose(&x, &plot->x);
  strut_axis_choose(&y, &plot->y);
  d.points = strut_arena_allocate(&arena, longest, sizeof *d.points);
  strut_status status =
      d.points ? draw_on_canvas(&d, plot, x, y, error) : strut_no_memory(error, "while drawing");
  strut_canvas_free(d.canvas);
  strut_arena_free(&arena);
  strut_c_locale_leave(locale);
  return status;
}

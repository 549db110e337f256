/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/output/draw/painter.h"

/* Distances from what is named at which a label is tried, beyond its own gap; from LED on with a line [pt]. */
static const double RINGS[] = {0, 2, 5, 9, 14, 20, 27, 35, 45, 57, 72, 90, 115, 145};
static const double LED = 9.0;
enum { DIRECTIONS = 24 };
static const double WORST = 14.0; /* a place that costs more helps nobody: the label is left out */

/* What a place costs: for each pt^2 of ink below the text and around it, for each pt of distance, for a
   line, for a turn away from the preferred direction, and beside something else that is named. */
static const double INK = 0.30, NEAR_INK = 0.05, DISTANCE = 0.16, LINE = 1.2, TURN = 0.6,
                    MISLEADING = 2.5;
static const double AROUND = 2.0; /* seen around a label [pt] */
static const double BESIDE = 3.0,
                    BELOW =
                        0.8; /* least distances of texts side by side and below each other [pt] */

/* ---- what waits, and what is there ---- */

static strut_box settle_box(strut_box b) {
  return (strut_box){strut_settle_coordinate(b.x), strut_settle_coordinate(b.y),
                     strut_settle_coordinate(b.width), strut_settle_coordinate(b.height)};
}

void strut_labels_add(strut_labels *labels, const strut_label *label) {
  if (!label->text || !*label->text || !isfinite(label->at[0] + label->at[1])) return;
  char *text = strut_arena_text(&labels->arena, label->text, strlen(label->text));
  labels->failed = labels->failed || !text ||
                   !strut_grow(&labels->list, &labels->room, labels->count, sizeof *labels->list);
  if (labels->failed) return;
  strut_label *added = &labels->list[labels->count++];
  *added = *label;
  added->text = text;
  for (int d = 0; d < 2; d++) added->at[d] = strut_settle_coordinate(label->at[d]);
  added->inside = settle_box(label->inside);
}

void strut_labels_avoid(strut_labels *labels, strut_box ink) {
  labels->failed = labels->failed || !strut_grow(&labels->texts, &labels->text_room,
                                                 labels->text_count, sizeof *labels->texts);
  if (!labels->failed && isfinite(ink.x + ink.y))
    labels->texts[labels->text_count++] = settle_box(ink);
}

void strut_labels_free(strut_labels *labels) {
  strut_release(labels->list);
  strut_release(labels->texts);
  strut_arena_free(&labels->arena);
}

/* ---- boxes ---- */

static strut_box widened(strut_box box, double by) {
  return (strut_box){box.x - by, box.y - by, box.width + 2 * by, box.height + 2 * by};
}

/* The point of a box nearest to `at`, and its distance. */
static double nearest_point(const strut_box *box, const double at[2], double point[2]) {
  point[0] = fmin(fmax(at[0], box->x), box->x + box->width);
  point[1] = fmin(fmax(at[1], box->y), box->y + box->height);
  return hypot(point[0] - at[0], point[1] - at[1]);
}

/* ---- one label ---- */

/* A label being placed. */
typedef struct search {
  const strut_labels *labels;
  strut_canvas *canvas;
  const strut_label *label;
  strut_box inside; /* and on the page */
  double width, height;
  strut_box best;
  double cost; /* of the best place, or a worse one */
} search;

/* True if it is inside and over no text. */
static bool is_free(const search *self, const strut_box *box) {
  const strut_box *in = &self->inside, *t = self->labels->texts;
  double right = box->x + box->width, bottom = box->y + box->height;
  if (box->x < in->x || box->y < in->y || right > in->x + in->width || bottom > in->y + in->height)
    return false;
  for (; t < self->labels->texts + self->labels->text_count; t++)
    if (box->x - BESIDE < t->x + t->width && t->x < right + BESIDE &&
        box->y - BELOW < t->y + t->height && t->y < bottom + BELOW)
      return false;
  return true;
}

/* Cost of being nearer to something else that is named in the same place. */
static double confusion(const search *self, const strut_box *box) {
  double point[2], own = nearest_point(box, self->label->at, point), cost = 0.0;
  for (size_t i = 0; i < self->labels->count; i++) {
    const strut_label *other = &self->labels->list[i];
    if (other == self->label ||
        memcmp(&other->inside, &self->label->inside, sizeof other->inside) != 0)
      continue;
    if (hypot(other->at[0] - self->label->at[0], other->at[1] - self->label->at[1]) < 0.5) continue;
    double distance = nearest_point(box, other->at, point);
    if (distance < own + 1.0) cost += MISLEADING;
  }
  return cost;
}

/* Keeps a box that is free and costs less than the best so far. */
static void consider(search *self, strut_box box, double cost) {
  if (cost >= self->cost || !is_free(self, &box)) return;
  cost += INK * strut_canvas_ink(self->canvas, box) +
          NEAR_INK * strut_canvas_ink(self->canvas, widened(box, AROUND)) + confusion(self, &box);
  if (cost < self->cost - 1e-9) self->cost = cost, self->best = box;
}

/* Considers the place in one direction at one ring. */
static void try_place(search *self, double ring, int direction) {
  const strut_label *label = self->label;
  double angle = label->angle + 2 * STRUT_PI * direction / DIRECTIONS, gap = label->gap + ring;
  double x = label->at[0] + (gap + 0.5 * self->width) * cos(angle);
  double y = label->at[1] - (gap + 0.5 * self->height) * sin(angle);
  int turn = direction <= DIRECTIONS / 2 ? direction : DIRECTIONS - direction;
  consider(self,
           settle_box((strut_box){x - 0.5 * self->width, y - 0.5 * self->height, self->width,
                                  self->height}),
           DISTANCE * ring + TURN * label->steady * turn + (ring >= LED ? LINE : 0.0));
}

/* The thin line from what is named to a label that is far from it. */
static void draw_line(strut_canvas *canvas, const strut_label *label, const strut_box *box) {
  double end[2], length = nearest_point(box, label->at, end), start = 0.7 * label->gap;
  if (length < LED + 0.5 * label->gap) return;
  double x = (end[0] - label->at[0]) / length, y = (end[1] - label->at[1]) / length;
  strut_draw_segment(canvas, label->at[0] + start * x, label->at[1] + start * y, end[0], end[1],
                     (strut_pen){.colour = strut_grey(0.45), .width = 0.4});
}

/* The part of the page on which a label may be. */
static strut_box find_inside(strut_canvas *canvas, const strut_label *label) {
  const strut_box page = widened(strut_canvas_box(canvas), -1.0), *wanted = &label->inside;
  if (!(wanted->width > 0.0)) return page;
  double x = fmax(page.x, wanted->x), y = fmax(page.y, wanted->y);
  return (strut_box){x, y, fmin(page.x + page.width, wanted->x + wanted->width) - x,
                     fmin(page.y + page.height, wanted->y + wanted->height) - y};
}

/* Height of a text's letters, of that of its lines. */
static const double LETTERS = 0.86, MOST_WIDTH = 130.0; /* [1], [pt] */

static bool place_label(const strut_labels *labels, const strut_label *label,
                        strut_canvas *canvas) {
  search s = {.labels = labels,
              .canvas = canvas,
              .label = label,
              .inside = find_inside(canvas, label),
              .cost = WORST};
  double most = fmin(s.inside.width, MOST_WIDTH);
  strut_font font = label->font;
  if (strut_text_box(canvas, label->text, font).width > most) font.width = most, font.lines = 1;
  const strut_box text = strut_text_box(canvas, label->text, font);
  s.width = text.width, s.height = LETTERS * text.height;
  for (size_t r = 0; r < sizeof RINGS / sizeof *RINGS; r++)
    for (int k = 0; k < DIRECTIONS; k++) /* by turns to both sides of the preferred direction */
      try_place(&s, RINGS[r], k % 2 ? (k + 1) / 2 : (DIRECTIONS - k / 2) % DIRECTIONS);
  if (!(s.best.width > 0)) return false;
  draw_line(canvas, label, &s.best);
  font.across = font.down = 0.5;
  strut_draw_text(canvas, s.best.x + 0.5 * s.best.width, s.best.y + 0.5 * s.best.height,
                  label->text, font);
  return true;
}

/* ---- all labels ---- */

/* Says in the page's lower left margin how many labels found no place. */
static void note_omitted(strut_canvas *canvas, size_t count) {
  char text[60];
  snprintf(text, sizeof text, "%zu label%s left out", count, count > 1 ? "s" : "");
  strut_draw_text(canvas, 2, strut_canvas_box(canvas).height - 1, text,
                  (strut_font){.size = 5.5, .colour = strut_grey(0.3), .down = 1});
}

void strut_labels_place(strut_labels *labels, strut_canvas *canvas) {
  size_t omitted = 0;
  for (int priority = STRUT_HIGHEST_PRIORITY; priority >= 0; priority--)
    for (size_t i = 0; i < labels->count; i++)
      if (labels->list[i].priority == priority)
        omitted += !place_label(labels, &labels->list[i], canvas);
  labels->count = 0;
  if (omitted) note_omitted(canvas, omitted);
}

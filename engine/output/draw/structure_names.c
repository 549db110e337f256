/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names beside nodes and members, where the page is emptiest. */
#include <math.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/draw/legend.h"
#include "engine/output/draw/palette.h"
#include "engine/output/draw/structure_parts.h"

enum { DIRECTIONS = 16, MOST_NAMED = 60 };

static const double PI = 3.14159265358979323846, GAP = 3.6, SIZE = 7.5, MOST_WIDTH = 90;
static const double SUPPORT = 5.0; /* half the width of a support [pt] */
static const double HATCHED = 2.0, FREE = 1.0,
                    FAR = 6.0; /* cost, enough freedom, second try [pt] */

/* Everything that names should keep away from. */
typedef struct obstacles {
  size_t member_count, label_count;
  double (*ends)[2]; /* (2 member_count) [pt] */
  strut_box *labels; /* those placed so far */
  strut_box inside;  /* names stay in here */
  bool ground;       /* its body lies below the segment `surface`, as deep as it is hatched */
  double surface[2][2];
} obstacles;

/* Distance of a point from a segment. */
static double from_segment(const double p[2], const double a[2], const double b[2]) {
  double along[2] = {b[0] - a[0], b[1] - a[1]}, square = along[0] * along[0] + along[1] * along[1];
  double t = square > 0 ? ((p[0] - a[0]) * along[0] + (p[1] - a[1]) * along[1]) / square : 0;
  t = fmax(0, fmin(1, t));
  return hypot(p[0] - a[0] - t * along[0], p[1] - a[1] - t * along[1]);
}

/* Whether a point is on the hatching below the ground's line. */
static bool is_on_hatching(const obstacles *o, const double p[2]) {
  const double *a = o->surface[0], *b = o->surface[1];
  double along[2] = {b[0] - a[0], b[1] - a[1]}, length = hypot(along[0], along[1]);
  double depth = (along[0] * (p[1] - a[1]) - along[1] * (p[0] - a[0])) / length;
  return o->ground && depth > 0 && depth < STRUT_GROUND_DEPTH;
}

/* How free a box is: its distance from what is drawn; below zero where it covers another name. */
static double freedom(const obstacles *o, strut_box box) {
  double least = HUGE_VAL;
  for (int i = 0; i <= 4; i++)
    for (int k = 0; k <= 2; k++) {
      const double p[2] = {box.x + 0.25 * i * box.width, box.y + 0.5 * k * box.height};
      if (is_on_hatching(o, p)) least = -HATCHED;
    }
  for (size_t j = 0; j < o->member_count; j++)
    for (int i = 0; i <= 4; i++)
      for (int k = 0; k <= 2; k++) {
        const double p[2] = {box.x + 0.25 * i * box.width, box.y + 0.5 * k * box.height};
        least = fmin(least, from_segment(p, o->ends[2 * j], o->ends[2 * j + 1]));
      }
  for (size_t i = 0; i < o->label_count; i++) {
    const strut_box *other = &o->labels[i];
    double dx = fmax(other->x - box.x - box.width, box.x - other->x - other->width);
    double dy = fmax(other->y - box.y - box.height, box.y - other->y - other->height);
    double apart = fmax(dx, dy);
    least = fmin(least, apart < 0 ? apart - 20 : apart);
  }
  double out = fmax(fmax(o->inside.x - box.x, o->inside.y - box.y),
                    fmax(box.x + box.width - o->inside.x - o->inside.width,
                         box.y + box.height - o->inside.y - o->inside.height));
  return out > 0 ? fmin(least, -out) : least;
}

static strut_font name_font(void) {
  return (strut_font){.size = SIZE, .italic = true, .halo = strut_faded(strut_grey(1), 0.85)};
}

/* The box of a name of this size around `at`, in one of the directions. */
static strut_box beside(const double at[2], int direction, double gap, double width,
                        double height) {
  double angle = 2 * PI * direction / DIRECTIONS;
  double x = at[0] + (gap + 0.5 * width) * cos(angle),
         y = at[1] - (gap + 0.5 * height) * sin(angle);
  return (strut_box){x - 0.5 * width, y - 0.5 * height, width, height};
}

static void place_name(strut_canvas *canvas, obstacles *o, const double at[2], double gap,
                       const char *name) {
  double width, height, best = -HUGE_VAL;
  char fitted[STRUT_FITTED_TEXT];
  strut_box chosen = {0};
  name = strut_text_fit(canvas, name, name_font(), MOST_WIDTH, 0, fitted);
  strut_text_size(canvas, name, name_font(), &width, &height);
  for (int k = 0; k < 2 * DIRECTIONS; k++) {
    /* Up and to the right first, and far enough is good enough; farther away where nothing near is. */
    int direction = (k + DIRECTIONS / 8) % DIRECTIONS;
    if (k == DIRECTIONS && best > FREE) break;
    strut_box box = beside(at, direction, gap + (k < DIRECTIONS ? 0 : FAR), width, height);
    double free = fmin(freedom(o, box), 4.0);
    if (free > best + 1e-9) {
      best = free;
      chosen = box;
    }
  }
  o->labels[o->label_count++] = chosen;
  strut_draw_text(canvas, chosen.x, chosen.y, name, name_font());
}

/* The sides of supports below nodes count as members too. */
static void add_supports(const strut_window *w, const strut_model *model, const double *q,
                         obstacles *o) {
  for (int32_t i = 0; i < model->node_count; i++) {
    if (!model->scene->nodes[i].fixed[1]) continue;
    for (int side = -1; side <= 1; side += 2) {
      double(*ends)[2] = o->ends + 2 * o->member_count++;
      strut_window_point(w, q + 2 * i, ends[0]);
      ends[1][0] = ends[0][0] + side * SUPPORT;
      ends[1][1] = ends[0][1] + 2 * SUPPORT;
    }
  }
}

static bool gather(const strut_window *w, const strut_model *model, const double *q, size_t others,
                   obstacles *o, strut_arena *arena) {
  size_t members = model->scene->member_count, nodes = (size_t)model->node_count;
  o->member_count = members;
  o->ends = strut_arena_allocate(arena, 2 * (members + 1 + 2 * nodes + others), sizeof *o->ends);
  o->labels = strut_arena_allocate(arena, nodes + members, sizeof *o->labels);
  o->inside = w->box;
  if (!o->ends || !o->labels) return false;
  for (size_t j = 0; j < members; j++) strut_member_ends(w, model, q, j, o->ends + 2 * j);
  if (model->scene->ground.present) { /* its line counts as one more member */
    strut_ground_line(w, model, o->ends + 2 * members);
    memcpy(o->surface, o->ends + 2 * members, sizeof o->surface);
    o->ground = true;
    o->member_count++;
  }
  add_supports(w, model, q, o);
  return true;
}

void strut_draw_names(strut_canvas *canvas, const strut_window *w, const strut_model *model,
                      const double *q, bool nodes, bool members, const double (*others)[2],
                      size_t other_count) {
  const strut_scene *scene = model->scene;
  strut_arena arena = {0};
  obstacles o = {0};
  if (scene->node_count <= MOST_NAMED && gather(w, model, q, other_count, &o, &arena)) {
    if (other_count) memcpy(o.ends + 2 * o.member_count, others, 2 * other_count * sizeof *others);
    o.member_count += other_count;
    for (size_t i = 0; i < scene->node_count && nodes; i++) {
      double at[2];
      strut_window_point(w, q + 2 * i, at);
      if (isfinite(at[0]) && isfinite(at[1])) place_name(canvas, &o, at, GAP, scene->nodes[i].name);
    }
    for (size_t j = 0; j < scene->member_count && members; j++) {
      /* the middle of its line */
      const double at[2] = {0.5 * (o.ends[2 * j][0] + o.ends[2 * j + 1][0]),
                            0.5 * (o.ends[2 * j][1] + o.ends[2 * j + 1][1])};
      if (isfinite(at[0]) && isfinite(at[1]))
        place_name(canvas, &o, at, 1.5, scene->members[j].name);
    }
  }
  strut_arena_free(&arena);
}

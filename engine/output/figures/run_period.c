/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The nodes' ways over the last period, exaggerated, as in the paper's figure 9. */
#include <math.h>
#include <stdio.h>

#include "engine/base/c_locale.h"
#include "engine/output/draw/palette.h"
#include "engine/output/figures/run_parts.h"

static const double KEY = 30, NOTE = 28, WIDE = 380, MARGIN = 20; /* [pt] */
static const double CLOSED = 1e-3; /* of the model's size: less above the ground is on it */

typedef struct ways {
  size_t first, count;
  double *rest;     /* (length) where the ways are exaggerated from */
  double *shape;    /* (length) that is drawn beneath: those places, or the last shape */
  double (*way)[2]; /* (nodes, count) as drawn */
  bool grounded;    /* some are exaggerated from the ground */
  strut_bounds bounds;
} ways;

/* The last period, or all there is where nothing is periodic. */
static size_t first_frame(const strut_run_scene *run) {
  double all = strut_run_time_from(run, 0);
  return strut_run_since(run, run->period > 0 ? fmin(run->period, all) : all);
}

static double factor(const strut_run_scene *run, int axis) {
  return run->figure->scale[axis] > 0 ? run->figure->scale[axis] : 1;
}

static bool exaggerated(const strut_run_scene *run) {
  return factor(run, 0) != 1 || factor(run, 1) != 1;
}

static bool can_touch(const strut_run_scene *run, size_t node) {
  for (int32_t i = 0; i < run->model->contacts.count; i++)
    if ((size_t)run->model->contacts.entry[i].node == node) return true;
  return false;
}

/* Where a node's motion is drawn from: its mean place, of a node that touches the ground the place
   below that on the ground, so that it is drawn touching it when it does. */
static void anchor(const strut_run_scene *run, size_t node, ways *w) {
  double *at = w->rest + 2 * node, lowest = HUGE_VAL;
  at[0] = at[1] = 0;
  for (size_t f = w->first; f < run->frames; f++) {
    const double *p = strut_run_positions(run, f) + 2 * node;
    for (int d = 0; d < 2; d++) at[d] += p[d] / (double)w->count;
    if (run->model->scene->ground.present)
      lowest = fmin(lowest, p[1] - strut_run_ground_at(run, p[0]));
  }
  if (!(lowest < CLOSED * run->model->size) || !can_touch(run, node)) return;
  at[1] = strut_run_ground_at(run, at[0]);
  w->grounded = true;
}

static bool find_ways(strut_run_scene *run, ways *w) {
  size_t nodes = run->motion->node_count;
  *w = (ways){.first = first_frame(run)};
  w->count = run->frames - w->first;
  w->rest = strut_arena_allocate(&run->arena, (size_t)run->model->length, sizeof *w->rest);
  w->way = strut_arena_allocate(&run->arena, nodes * w->count, sizeof *w->way);
  if (!w->rest || !w->way) return false;
  w->bounds = strut_run_frame_bounds(run, run->frames - 1);
  for (size_t i = 0; i < nodes; i++) {
    anchor(run, i, w);
    for (size_t f = 0; f < w->count; f++)
      for (int d = 0; d < 2; d++) {
        double rest = w->rest[2 * i + (size_t)d];
        double moved = strut_run_positions(run, w->first + f)[2 * i + (size_t)d] - rest;
        double drawn = rest + factor(run, d) * moved;
        w->way[i * w->count + f][d] = drawn;
        w->bounds.low[d] = fmin(w->bounds.low[d], drawn);
        w->bounds.high[d] = fmax(w->bounds.high[d], drawn);
      }
  }
  strut_run_add_ground(run, &w->bounds);
  /* Mean places are no shape where the motion is large: only what is exaggerated needs them. */
  w->shape = exaggerated(run) ? w->rest : strut_run_shape(run, run->frames - 1);
  return w->shape;
}

/* What stands below the drawing: in a narrow one the note has lines of its own. */
static double foot_height(const strut_run_scene *run) {
  return run->figure->width < WIDE && exaggerated(run) ? KEY + NOTE : KEY;
}

/* The ways of the other motion, moved to the places of this one. */
static void add_other(const ways *w, ways *o, size_t nodes) {
  for (size_t i = 0; i < nodes; i++)
    for (size_t f = 0; f < o->count; f++)
      for (int d = 0; d < 2; d++)
        o->way[i * o->count + f][d] += w->rest[2 * i + (size_t)d] - o->rest[2 * i + (size_t)d];
}

/* False: memory is out. */
static bool draw_other(const strut_run_scene *run, strut_canvas *canvas, const ways *w,
                       const strut_window *window) {
  strut_run_scene other;
  ways o;
  if (!strut_run_find_other(run, &other)) return true;
  bool fine = find_ways(&other, &o);
  if (fine) add_other(w, &o, run->motion->node_count);
  for (size_t i = 0; i < run->motion->node_count && fine; i++)
    fine = strut_run_draw_other_path(&other, canvas, window,
                                     (const double(*)[2])(o.way + i * o.count), o.count);
  strut_arena_free(&other.arena);
  return fine;
}

double strut_run_period_height(strut_run_scene *run) {
  ways w;
  double width = run->figure->width - 2 * STRUT_RUN_EDGE;
  if (!find_ways(run, &w)) return width;
  return 2 * STRUT_RUN_EDGE + STRUT_RUN_TITLE + foot_height(run) +
         strut_run_drawing_height(&w.bounds, width, MARGIN, 0.16, 0.75);
}

static void describe(const strut_run_scene *run, const ways *w, char *text, size_t size) {
  strut_c_locale locale = strut_c_locale_enter();
  /* The period itself: the frames drawn of it span a whole number of samples. */
  double span = run->period > 0 ? run->period : strut_run_time_from(run, w->first);
  snprintf(text, size, "%s%s%s%s, dark to bright",
           run->figure->width < WIDE ? "" : "node trajectories over ",
           run->period > 0 ? "one period (" : "", strut_drawn_quantity(span, 4, "s").text,
           run->period > 0 ? ")" : "");
  strut_c_locale_leave(locale);
}

/* What is exaggerated, and from where: between yardstick and scale, or above both. */
static void draw_note(const strut_run_scene *run, strut_canvas *canvas, const ways *w,
                      strut_box box) {
  char text[240], fitted[STRUT_FITTED_TEXT];
  bool narrow = run->figure->width < WIDE;
  if (!exaggerated(run)) return;
  strut_c_locale locale = strut_c_locale_enter();
  snprintf(text, sizeof text,
           "Motion drawn %g-fold along x and %g-fold along y, from each node's mean place "
           "(grey)%s.",
           factor(run, 0), factor(run, 1),
           w->grounded ? ", on the ground where it touches that" : "");
  strut_c_locale_leave(locale);
  double indent = narrow ? 0 : 0.34 * (run->figure->width - 2 * STRUT_RUN_EDGE);
  strut_font note = {.size = 7, .colour = strut_grey(0.3)};
  note.width = narrow ? run->figure->width - 2 * STRUT_RUN_EDGE : box.width - indent;
  note.down = narrow ? 0 : 0.5;
  strut_draw_text(canvas, box.x + indent, narrow ? box.y : box.y + 0.5 * box.height,
                  strut_text_fit(canvas, text, note, note.width, box.height, fitted), note);
}

static void draw_time_scale(const strut_run_scene *run, strut_canvas *canvas, const ways *w,
                            strut_box box) {
  bool parts = run->period > 0;
  const strut_colour_scale scale = {.name = parts ? "phase" : "time",
                                    .unit = parts ? "" : "s",
                                    .high = parts ? 1 : strut_run_time_from(run, w->first),
                                    .colours = STRUT_COLOURS_SEQUENTIAL};
  if (scale.high > 0) strut_draw_colour_scale(canvas, box, &scale);
}

strut_status strut_run_period(strut_run_scene *run, strut_canvas *canvas) {
  ways w;
  char text[240];
  double width = run->figure->width - 2 * STRUT_RUN_EDGE, page = strut_canvas_box(canvas).height;
  double foot = page - STRUT_RUN_EDGE - KEY, scale_width = fmin(150, 0.45 * width);
  double end = page - STRUT_RUN_EDGE - foot_height(run);
  if (!find_ways(run, &w)) return STRUT_NO_MEMORY;
  describe(run, &w, text, sizeof text);
  strut_run_describe_other(run, text, sizeof text);
  strut_run_draw_title(run, canvas, text, run->figure->width >= WIDE);
  strut_box box = {STRUT_RUN_EDGE, STRUT_RUN_EDGE + STRUT_RUN_TITLE, width,
                   end - STRUT_RUN_EDGE - STRUT_RUN_TITLE};
  strut_window window = strut_window_fit(box, w.bounds, MARGIN);
  const strut_structure_style pale = {
      .colouring = STRUT_COLOUR_ONE, .colour = strut_grey(0.72), .thinness = 0.5};
  strut_draw_ground(canvas, &window, run->model);
  strut_draw_structure(canvas, &window, run->model, w.shape, &pale);
  for (size_t i = 0; i < run->motion->node_count; i++)
    strut_run_draw_path(run, canvas, &window, (const double(*)[2])(w.way + i * w.count), w.count,
                        1.5);
  if (!draw_other(run, canvas, &w, &window)) return STRUT_NO_MEMORY;
  strut_run_draw_names(run, canvas, &window, w.shape);
  window.box.y = page - STRUT_RUN_EDGE - box.height; /* at the foot, where no structure is */
  strut_draw_yardstick(canvas, &window);
  double right = STRUT_RUN_EDGE + width - scale_width;
  draw_note(run, canvas, &w, (strut_box){STRUT_RUN_EDGE, end, right - STRUT_RUN_EDGE - 6, KEY});
  draw_time_scale(run, canvas, &w, (strut_box){right, foot, scale_width, KEY});
  return STRUT_OK;
}

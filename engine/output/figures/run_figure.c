/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/run_figure.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/model/pose.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/figures/run_parts.h"

enum { LEAST_SAMPLES = 8 };       /* per period, for its shape to be visible */
static const double BURST = 10.0; /* a diverged shape larger than this, in sizes, is not drawn */
static const double FEW_FRAMES = 0.05;
static const double SMALLEST = 0.2; /* of the model's size, for a drawing */

static const struct {
  void (*describe)(strut_run_scene *run, char *text);
  double (*height)(strut_run_scene *run);
  strut_status (*draw)(strut_run_scene *run, strut_canvas *canvas);
  bool velocity; /* its heading tells the velocity */
} views[] = {
    [STRUT_RUN_OVERVIEW] = {strut_run_overview_describe, strut_run_overview_height,
                            strut_run_overview, true},
    [STRUT_RUN_PERIOD] = {strut_run_period_describe, strut_run_period_height, strut_run_period,
                          true},
    [STRUT_RUN_SNAPSHOTS] = {strut_run_snapshots_describe, strut_run_snapshots_height,
                             strut_run_snapshots, false},
    [STRUT_RUN_CURVES] = {strut_run_curves_describe, strut_run_curves_height, strut_run_curves,
                          true},
};

strut_status strut_run_figure_check(const strut_run_figure *figure, const strut_model *model,
                                    strut_error *error) {
  strut_span span = strut_experiment_span(figure->experiment, model->scene);
  double every = fmax(span.record_every, figure->experiment->step), slack = 0.5 * every;
  double from = span.record_start - slack, to = span.duration + slack;
  for (size_t i = 0; i < figure->time_count; i++)
    if (!(figure->times[i] >= from && figure->times[i] <= to))
      return strut_fail(error, STRUT_USAGE,
                        "nothing is recorded at %s: the record goes from %s to %s ('output: {last: "
                        "...}' sets the range)",
                        strut_quantity_of(figure->times[i], 6, "s").text,
                        strut_quantity_of(span.record_start, 6, "s").text,
                        strut_quantity_of(span.duration, 6, "s").text);
  if (figure->view == STRUT_RUN_PERIOD && span.period > 0 &&
      span.period < LEAST_SAMPLES * every * (1 - 1e-9))
    return strut_fail(
        error, STRUT_USAGE,
        "a period of %s cannot be drawn from one sample every %s: add 'output: {every: "
        "%s, last: 10}' to the model",
        strut_quantity_of(span.period, 4, "s").text, strut_quantity_of(every, 4, "s").text,
        strut_quantity_of(span.period / 100, 4, "s").text);
  return STRUT_OK;
}

const double *strut_run_positions(const strut_run_scene *run, size_t frame) {
  assert(frame < run->motion->frames);
  return run->motion->position + 2 * frame * run->motion->node_count;
}

static bool is_shape(const strut_run_scene *run, size_t frame) {
  const double *q = strut_run_positions(run, frame);
  for (size_t i = 0; i < 2 * run->motion->node_count; i++)
    if (!isfinite(q[i])) return false;
  bool burst = run->summary && run->summary->status == STRUT_DIVERGED;
  if (!burst && run->motion->status != STRUT_DIVERGED) return true;
  strut_bounds b = strut_bounds_none();
  strut_bounds_add(&b, run->model, q);
  return strut_run_extent(&b) <= BURST * run->model->size;
}

static double largest(const double *values, size_t count) {
  double most = 0;
  for (size_t i = 0; values && i < count; i++)
    if (isfinite(values[i])) most = fmax(most, fabs(values[i]));
  return most;
}

bool strut_run_find_limits(strut_run_scene *run) {
  const strut_trajectory *m = run->motion;
  double *most = strut_arena_allocate(&run->arena, run->frames + 1, sizeof *most);
  if (!most) return false;
  for (size_t f = 0; f < run->frames && m->force; f++)
    most[f] = largest(m->force + f * m->member_count, m->member_count);
  run->force_limit = strut_limit_without_outliers(most, run->frames, 0.0, FEW_FRAMES, &run->beyond);
  run->beyond.below = run->beyond.above; /* of either sign */
  return true;
}

void strut_run_count_frames(strut_run_scene *run) {
  const strut_trajectory *m = run->motion;
  while (run->frames < m->frames && is_shape(run, run->frames)) run->frames++;
  double period = strut_experiment_span(run->figure->experiment, run->model->scene).period;
  double all = run->frames ? strut_run_time_from(run, 0) : 0;
  bool fine = (double)(run->frames - 1) * period >= LEAST_SAMPLES * all * (1 - 1e-9);
  if (run->frames > 1 && fine && period > 0) run->period = period;
}

static const char *title_of(const strut_run_scene *run) {
  return run->figure->title ? run->figure->title : run->model->scene->name;
}

double *strut_run_shape(strut_run_scene *run, size_t frame) {
  double *q = strut_arena_allocate(&run->arena, (size_t)run->model->length, sizeof *q);
  if (q) memcpy(q, strut_run_positions(run, frame), 2 * run->motion->node_count * sizeof *q);
  return q;
}

double strut_run_time_from(const strut_run_scene *run, size_t frame) {
  return run->motion->time[run->frames - 1] - run->motion->time[frame];
}

size_t strut_run_nearest(const strut_run_scene *run, double time) {
  const double *times = run->motion->time;
  size_t low = 0, high = run->frames - 1;
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    *(times[middle] <= time ? &low : &high) = middle;
  }
  return time - times[low] <= times[high] - time ? low : high;
}

size_t strut_run_since(const strut_run_scene *run, double duration) {
  size_t first = run->frames - 1;
  while (first > 0 && strut_run_time_from(run, first - 1) <= duration * (1 + 1e-9)) first--;
  return run->frames > 1 && first == run->frames - 1 ? run->frames - 2 : first;
}

double strut_run_measured(const strut_run_scene *run, size_t frame, int axis) {
  const double *q = strut_run_positions(run, frame);
  int32_t node = run->figure->experiment->measure_node;
  if (node >= 0) return q[2 * node + axis];
  double sum = 0, mass = 0;
  for (int32_t i = 0; i < run->model->node_count; i++) {
    sum += run->model->weight[i] * q[2 * i + axis];
    mass += run->model->weight[i];
  }
  sum += strut_sliding_moment(run->model, run->motion->time[frame], axis, q);
  return mass > 0 ? sum / mass : q[axis];
}

const char *strut_run_measured_name(const strut_run_scene *run) {
  int32_t node = run->figure->experiment->measure_node;
  return node >= 0 ? run->model->scene->nodes[node].name : "centre of mass";
}

double strut_run_ground_at(const strut_run_scene *run, double x) {
  const strut_ground *ground = &run->model->scene->ground;
  return ground->height + tan(ground->slope) * x;
}

double strut_run_extent(const strut_bounds *b) {
  return fmax(b->high[0] - b->low[0], b->high[1] - b->low[1]);
}

strut_bounds strut_run_frame_bounds(const strut_run_scene *run, size_t frame) {
  strut_bounds b = strut_bounds_none();
  strut_bounds_add(&b, run->model, strut_run_positions(run, frame));
  double missing = SMALLEST * run->model->size - strut_run_extent(&b);
  const double share[2] = {0.5,
                           0.15}; /* the missing extent goes to the width rather than the height */
  for (int d = 0; d < 2 && missing > 0; d++) {
    b.low[d] -= share[d] * missing;
    b.high[d] += share[d] * missing;
  }
  return b;
}

void strut_run_add_ground(const strut_run_scene *run, strut_bounds *b) {
  if (!run->model->scene->ground.present) return;
  double ground = strut_run_ground_at(run, 0.5 * (b->low[0] + b->high[0]));
  if (b->low[1] > ground && b->low[1] - ground < strut_run_extent(b)) b->low[1] = ground;
}

double strut_run_drawing_height(const strut_bounds *b, double width, double margin, double least,
                                double most) {
  double wide = b->high[0] - b->low[0], high = b->high[1] - b->low[1];
  double wanted = wide > 0 ? (width - 2 * margin) * high / wide + 2 * margin : most * width;
  return fmax(fmax(least * width, 2 * margin + 8), fmin(wanted, most * width));
}

/* Parts of several views: titles, shapes, contact forces, paths, names. */

enum { MOST_NAMES = 30 };

static const double DOT = 0.3;       /* [pt] */
static const double STANDING = 1e-6; /* of the model's size over the whole run: it stands still */

void strut_run_expect_frame(strut_run_scene *run, size_t frame) {
  const strut_trajectory *m = run->motion;
  for (size_t i = 0; m->contact && i < 2 * m->contact_count; i++) {
    double force = fabs(m->contact[2 * frame * m->contact_count + i]);
    if (isfinite(force)) run->contact_limit = fmax(run->contact_limit, force);
  }
}

bool strut_run_draw_frame(strut_run_scene *run, strut_canvas *canvas, const strut_window *window,
                          size_t frame) {
  const strut_trajectory *m = run->motion;
  double *q = strut_run_shape(run, frame);
  if (!q) return false;
  strut_structure_style style = {.colouring = STRUT_COLOUR_KIND,
                                 .time = m->time ? m->time[frame] : 0.0};
  if (m->force) {
    style.colouring = STRUT_COLOUR_FORCE;
    style.values = style.slack_forces = m->force + frame * m->member_count;
    style.limit = run->force_limit;
  }
  strut_draw_ground_at(canvas, window, run->model, m->time ? m->time[frame] : (double)NAN);
  strut_draw_structure(canvas, window, run->model, q, &style);
  return true;
}

void strut_run_draw_reactions(strut_run_scene *run, strut_canvas *canvas,
                              const strut_window *window, size_t frame) {
  const strut_trajectory *m = run->motion;
  const double *q = strut_run_positions(run, frame);
  if (!m->contact || !(run->contact_limit > 0)) return;
  const double *force = m->contact + 2 * frame * m->contact_count;
  strut_draw_contact_forces(canvas, window, run->model, q, (const double(*)[2])force,
                            run->contact_limit, run->arrow);
}

/* True if a path is longer than a dot on the page. */
static bool is_visible(const strut_window *window, const double (*path)[2], size_t count) {
  double first[2], at[2];
  for (size_t i = 0; i < count; i++) {
    strut_window_point(window, path[i], i ? at : first);
    if (i && hypot(at[0] - first[0], at[1] - first[1]) > DOT) return true;
  }
  return false;
}

void strut_run_draw_path(strut_canvas *canvas, const strut_window *window, const double (*path)[2],
                         size_t count, double width) {
  if (!is_visible(window, path, count)) return;
  strut_canvas_clip(canvas, window->box);
  strut_draw_trail(canvas, window, path, count, width);
  strut_canvas_unclip(canvas);
}

void strut_run_draw_names(const strut_run_scene *run, strut_canvas *canvas,
                          const strut_window *window, const double *q) {
  if (run->model->node_count <= MOST_NAMES) strut_draw_names(canvas, window, run->model, q, false);
}

void strut_run_draw_scale(const strut_run_scene *run, strut_canvas *canvas, strut_box box) {
  const strut_colour_scale scale = {.name = "force",
                                    .unit = "N",
                                    .low = -run->force_limit,
                                    .high = run->force_limit,
                                    .colours = STRUT_COLOURS_SIGNED,
                                    .beyond = run->beyond};
  if (run->motion->force && run->force_limit > 0) strut_draw_colour_scale(canvas, box, &scale);
}

bool strut_run_arrow_item(const strut_run_scene *run, char text[120], strut_key_item *item) {
  if (!(run->contact_limit > 0)) return false;
  snprintf(text, 120, "contact force, up to %s",
           strut_drawn_quantity(run->contact_limit, 3, "N").text);
  *item = (strut_key_item){.sign = STRUT_KEY_ARROW,
                           .pen = {.colour = strut_palette_thing(1), .width = 1.1},
                           .text = text};
  return true;
}

/* The measured velocity; 0 for a structure that stands still. */
static double shown_velocity(const strut_run_scene *run) {
  const strut_summary *s = run->summary;
  double path = fabs(s->velocity) * fmax(s->duration, STRUT_RUN_MOMENT);
  return path > STANDING * run->model->size ? s->velocity : 0;
}

/* A second motion of the same structure, dashed below the first. */

static const double FRINGE =
    1.8; /* both edges of dashes, which show on both sides of what lies on them [pt] */
static const strut_colour DASHES = {0.25, 0.25, 0.25, 1};

bool strut_run_find_other(const strut_run_scene *run, strut_run_scene *other) {
  *other = (strut_run_scene){.figure = run->figure,
                             .model = run->model,
                             .motion = run->figure->other,
                             .arrow = run->arrow};
  if (!other->motion || !other->motion->position) return false;
  strut_run_count_frames(other);
  return other->frames > 0;
}

void strut_run_draw_other(const strut_run_scene *other, strut_canvas *canvas,
                          const strut_window *window, const double *q) {
  const strut_structure_style style = {.colouring = STRUT_COLOUR_ONE,
                                       .colour = DASHES,
                                       .fringe = FRINGE,
                                       .no_nodes = true,
                                       .no_supports = true};
  strut_draw_structure(canvas, window, other->model, q, &style);
}

bool strut_run_draw_other_path(strut_run_scene *other, strut_canvas *canvas,
                               const strut_window *window, const double (*path)[2], size_t count) {
  const strut_pen pen = {
      .colour = DASHES, .width = STRUT_RUN_TRAIL + FRINGE, .dash = {2.2, 2.2}, .butt = true};
  double(*points)[2] = strut_arena_allocate(&other->arena, count, sizeof *points);
  for (size_t i = 0; points && i < count; i++) strut_window_point(window, path[i], points[i]);
  if (points) strut_draw_line(canvas, (const double(*)[2])points, count, pen);
  return points != NULL;
}

void strut_run_describe_other(const strut_run_scene *run, char *text, size_t size) {
  size_t used = strlen(text);
  if (run->figure->other)
    snprintf(text + used, size - used, "; thick dashes: %s",
             run->figure->other_name ? run->figure->other_name : "another");
}

/* ---- the whole figure ---- */

/* The heading: the model's name and `what`, with the velocity where wanted, or the failure; in `note`. */
static strut_status describe_run(strut_run_scene *run, char note[STRUT_RUN_NOTE],
                                 strut_error *error) {
  const strut_summary *s = run->summary;
  char what[STRUT_RUN_NOTE];
  bool failed = s && s->status != STRUT_OK;
  views[run->figure->view].describe(run, what);
  int used = 0;
  if (failed)
    used = snprintf(note, STRUT_RUN_NOTE, "%s at %s; ",
                    s->status == STRUT_DIVERGED ? "diverged" : "stopped",
                    strut_drawn_quantity(s->duration, 4, "s").text);
  used += snprintf(note + used, STRUT_RUN_NOTE - (size_t)used, "%.400s", what);
  if (views[run->figure->view].velocity && s && !failed && isfinite(s->velocity)) {
    double v = shown_velocity(run);
    snprintf(note + used, STRUT_RUN_NOTE - (size_t)used, "; velocity of %.60s %s%s",
             strut_run_measured_name(run), strut_drawn_quantity(v, 4, "m/s").text,
             v > 0   ? " \xe2\x86\x92"
             : v < 0 ? " \xe2\x86\x90"
                     : "");
  }
  run->heading = (strut_heading){.width = run->figure->width,
                                 .edge = STRUT_RUN_EDGE,
                                 .title = title_of(run),
                                 .note = note,
                                 .alarm = failed};
  return strut_heading_measure(&run->heading, &run->head, error);
}

strut_status strut_run_figure_draw(const char *path, const strut_run_figure *figure,
                                   const strut_model *model, const strut_trajectory *motion,
                                   const strut_summary *summary, strut_error *error) {
  strut_run_scene run = {
      .figure = figure, .model = model, .motion = motion, .summary = summary, .arrow = 24};
  if (motion->position) strut_run_count_frames(&run);
  if (!run.frames)
    return strut_fail(error, STRUT_USAGE, "there is nothing to draw: no positions were recorded");
  strut_canvas *canvas = NULL;
  char note[STRUT_RUN_NOTE];
  strut_status status = strut_canvas_open_pixels(1, 1, 1, &run.ruler, error);
  if (status == STRUT_OK && !strut_run_find_limits(&run))
    status = strut_no_memory(error, "while drawing");
  if (status == STRUT_OK) status = describe_run(&run, note, error);
  if (status == STRUT_OK)
    status = strut_canvas_open(path, figure->width, views[figure->view].height(&run),
                               title_of(&run), &canvas, error);
  if (status == STRUT_OK) {
    strut_heading_draw(canvas, &run.heading);
    status = views[figure->view].draw(&run, canvas);
    if (status != STRUT_OK) strut_fail(error, status, "out of memory while drawing");
  }
  if (status == STRUT_OK) status = strut_canvas_commit(canvas, error);
  strut_canvas_free(canvas);
  strut_canvas_free(run.ruler);
  strut_arena_free(&run.arena);
  return status;
}

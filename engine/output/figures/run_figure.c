/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/run_figure.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/model/pose.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/figures/run_parts.h"

enum { LEAST_SAMPLES = 8 };         /* per period, for its shape to be visible */
static const double BURST = 10.0;   /* a diverged shape larger than this, in sizes, is not drawn */
static const double SMALLEST = 0.2; /* of the model's size, for a drawing */

static const struct {
  double (*height)(strut_run_scene *run);
  strut_status (*draw)(strut_run_scene *run, strut_canvas *canvas);
  unsigned channels;
} views[] = {
    [STRUT_RUN_OVERVIEW] = {strut_run_overview_height, strut_run_overview,
                            STRUT_CHANNEL_FORCE | STRUT_CHANNEL_CONTACT | STRUT_CHANNEL_ANGLE},
    [STRUT_RUN_PERIOD] = {strut_run_period_height, strut_run_period, 0},
    [STRUT_RUN_SNAPSHOTS] = {strut_run_snapshots_height, strut_run_snapshots,
                             STRUT_CHANNEL_FORCE | STRUT_CHANNEL_CONTACT},
    [STRUT_RUN_CURVES] = {strut_run_curves_height, strut_run_curves,
                          STRUT_CHANNEL_FORCE | STRUT_CHANNEL_CONTACT | STRUT_CHANNEL_ENERGY |
                              STRUT_CHANNEL_ANGLE | STRUT_CHANNEL_MOMENT | STRUT_CHANNEL_AREA |
                              STRUT_CHANNEL_PRESSURE},
};

unsigned strut_run_figure_channels(strut_run_view view) {
  return STRUT_CHANNEL_POSITION | views[view].channels;
}

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

void strut_run_count_frames(strut_run_scene *run) {
  const strut_trajectory *m = run->motion;
  while (run->frames < m->frames && is_shape(run, run->frames)) run->frames++;
  run->force_limit = largest(m->force, run->frames * m->member_count);
  double period = strut_experiment_span(run->figure->experiment, run->model->scene).period;
  double all = run->frames ? strut_run_time_from(run, 0) : 0;
  bool fine = (double)(run->frames - 1) * period >= LEAST_SAMPLES * all * (1 - 1e-9);
  if (run->frames > 1 && fine && period > 0) run->period = period;
}

static const char *title_of(const strut_run_scene *run) {
  return run->figure->title ? run->figure->title : run->model->scene->name;
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
  strut_status status = strut_canvas_open_pixels(1, 1, 1, &run.ruler, error);
  if (status == STRUT_OK)
    status = strut_canvas_open(path, figure->width, views[figure->view].height(&run),
                               title_of(&run), &canvas, error);
  if (status == STRUT_OK) {
    status = views[figure->view].draw(&run, canvas);
    if (status != STRUT_OK) strut_fail(error, status, "out of memory while drawing");
  }
  if (status == STRUT_OK) status = strut_canvas_commit(canvas, error);
  strut_canvas_free(canvas);
  strut_canvas_free(run.ruler);
  strut_arena_free(&run.arena);
  return status;
}

double *strut_run_shape(strut_run_scene *run, size_t frame) {
  double *q = strut_arena_allocate(&run->arena, (size_t)run->model->length, sizeof *q);
  if (q) memcpy(q, strut_run_positions(run, frame), 2 * run->motion->node_count * sizeof *q);
  return q;
}

double strut_run_time_from(const strut_run_scene *run, size_t frame) {
  return run->motion->time[run->frames - 1] - run->motion->time[frame];
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

enum { MOST_NAMES = 30, MOST_AVOIDED = 1500, PATH_PIECES = 40, LINE = 600 };

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

/* Adds a segment that names avoid; ignored without memory or beyond MOST_AVOIDED. */
static void add_obstacle(strut_run_scene *run, const double from[2], const double to[2]) {
  if (!run->avoid)
    run->avoid = strut_arena_allocate(&run->arena, 2 * MOST_AVOIDED, sizeof *run->avoid);
  if (!run->avoid || run->avoid_count == MOST_AVOIDED) return;
  memcpy(run->avoid[2 * run->avoid_count], from, sizeof *run->avoid);
  memcpy(run->avoid[2 * run->avoid_count + 1], to, sizeof *run->avoid);
  run->avoid_count++;
}

void strut_run_draw_reactions(strut_run_scene *run, strut_canvas *canvas,
                              const strut_window *window, size_t frame) {
  const strut_trajectory *m = run->motion;
  const strut_contact_table *contacts = &run->model->contacts;
  const double *q = strut_run_positions(run, frame);
  if (!m->contact || !(run->contact_limit > 0)) return;
  const double *force = m->contact + 2 * frame * m->contact_count;
  strut_draw_contact_forces(canvas, window, run->model, q, (const double(*)[2])force,
                            run->contact_limit, run->arrow);
  for (int32_t i = 0; i < contacts->count; i++) {
    double at[2], length = force[2 * i] / run->contact_limit * run->arrow;
    strut_window_point(window, q + contacts->at[i], at);
    const strut_contact_pose pose = strut_contact_pose_at(contacts, i, q, NULL, -1);
    const double *n = pose.axes.normal, *t = pose.axes.tangent;
    const double foot[2] = {at[0] - length * n[0], at[1] + length * n[1]};
    if (length > 1) add_obstacle(run, foot, at);
    length = force[2 * i + 1] / run->contact_limit * run->arrow;
    const double tip[2] = {at[0] + length * t[0], at[1] - length * t[1]};
    if (fabs(length) > 1) add_obstacle(run, at, tip);
  }
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

void strut_run_draw_path(strut_run_scene *run, strut_canvas *canvas, const strut_window *window,
                         const double (*path)[2], size_t count, double width) {
  double before[2], at[2];
  if (!is_visible(window, path, count)) return;
  strut_canvas_clip(canvas, window->box);
  strut_draw_trail(canvas, window, path, count, width);
  strut_canvas_unclip(canvas);
  for (size_t i = 0; i <= PATH_PIECES && count > 1; i++) {
    strut_window_point(window, path[i * (count - 1) / PATH_PIECES], at);
    if (i > 0 && hypot(at[0] - before[0], at[1] - before[1]) > 0.5) add_obstacle(run, before, at);
    if (i > 0 && hypot(at[0] - before[0], at[1] - before[1]) <= 0.5) continue;
    memcpy(before, at, sizeof before);
  }
}

void strut_run_draw_names(strut_run_scene *run, strut_canvas *canvas, const strut_window *window,
                          const double *q) {
  if (run->model->node_count <= MOST_NAMES)
    strut_draw_names(canvas, window, run->model, q,
                     &(strut_drawn_names){.nodes = true,
                                          .others = (const double(*)[2])run->avoid,
                                          .other_count = run->avoid_count});
  run->avoid_count = 0;
}

void strut_run_draw_scale(const strut_run_scene *run, strut_canvas *canvas, strut_box box) {
  const strut_colour_scale scale = {.name = "force",
                                    .unit = "N",
                                    .low = -run->force_limit,
                                    .high = run->force_limit,
                                    .colours = STRUT_COLOURS_SIGNED};
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

/* Appends the velocity to the line, with the measured point's name if it fits. */
static void append_velocity(const strut_run_scene *run, strut_canvas *canvas, double velocity,
                            double room, strut_font font, char line[LINE]) {
  size_t used = strlen(line);
  double width, height;
  strut_rounded_quantity text = strut_drawn_quantity(velocity, 4, "m/s");
  snprintf(line + used, LINE - used, "; velocity of %s %s", strut_run_measured_name(run),
           text.text);
  strut_text_size(canvas, line, font, &width, &height);
  if (width > room) snprintf(line + used, LINE - used, "; velocity %s", text.text);
}

void strut_run_draw_title(const strut_run_scene *run, strut_canvas *canvas, const char *what,
                          bool velocity) {
  const strut_summary *s = run->summary;
  double room = strut_canvas_box(canvas).width - 2 * STRUT_RUN_EDGE, width, height;
  const double arrow = 18, x = STRUT_RUN_EDGE, y = STRUT_RUN_EDGE + 12;
  char line[LINE], fitted[STRUT_FITTED_TEXT];
  const strut_font title = {.size = 9, .bold = true};
  strut_font below = {.size = 8, .colour = strut_grey(0.3)};
  bool failed = s && s->status != STRUT_OK;
  if (failed) below.colour = strut_palette_thing(1);
  velocity = velocity && !failed && s && isfinite(s->velocity);
  double v = velocity ? shown_velocity(run) : 0;
  if (failed)
    snprintf(line, sizeof line, "%s at %s; %s",
             s->status == STRUT_DIVERGED ? "diverged" : "stopped",
             strut_drawn_quantity(s->duration, 4, "s").text, what);
  else
    snprintf(line, sizeof line, "%s", what);
  if (velocity) append_velocity(run, canvas, v, v != 0 ? room - arrow - 6 : room, below, line);
  strut_draw_text(canvas, x, STRUT_RUN_EDGE,
                  strut_text_fit(canvas, title_of(run), title, room, 0, fitted), title);
  strut_text_fit(canvas, line, below, v != 0 ? room - arrow - 6 : room, 0, fitted);
  strut_draw_text(canvas, x, y, fitted, below);
  if (v == 0) return;
  strut_text_size(canvas, fitted, below, &width, &height);
  double left = x + width + 5, right = left + arrow, middle = y + 0.5 * height;
  strut_draw_arrow(canvas, v > 0 ? left : right, middle, v > 0 ? right : left, middle, 5,
                   (strut_pen){.colour = strut_grey(0.3), .width = 1.1});
}

/* A second motion of the same structure, dashed over the first. */

static const strut_pen PEN = {.colour = {0.05, 0.05, 0.05, 1}, .width = 0.7, .dash = {2.4, 1.6}};

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
                          const strut_window *window, size_t frame) {
  const strut_scene *scene = other->model->scene;
  const double *q = strut_run_positions(other, frame);
  for (size_t i = 0; i < scene->member_count; i++)
    for (size_t k = 0; k < strut_member_segments(other->model, i); k++) {
      double ends[2][2];
      strut_window_segment(window, other->model, q, i, k, ends);
      strut_draw_segment(canvas, ends[0][0], ends[0][1], ends[1][0], ends[1][1], PEN);
    }
}

bool strut_run_draw_other_path(strut_run_scene *other, strut_canvas *canvas,
                               const strut_window *window, const double (*path)[2], size_t count) {
  double(*points)[2] = strut_arena_allocate(&other->arena, count, sizeof *points);
  for (size_t i = 0; points && i < count; i++) strut_window_point(window, path[i], points[i]);
  if (points) strut_draw_line(canvas, (const double(*)[2])points, count, PEN);
  return points != NULL;
}

void strut_run_describe_other(const strut_run_scene *run, char *text, size_t size) {
  size_t used = strlen(text);
  if (run->figure->other)
    snprintf(text + used, size - used, ", black dashes: %s",
             run->figure->other_name ? run->figure->other_name : "another");
}

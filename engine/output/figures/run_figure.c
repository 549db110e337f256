/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which frames there are to draw, and what they hold. */
#include "engine/output/figures/run_figure.h"

#include <math.h>
#include <string.h>

#include "engine/output/figures/run_parts.h"

enum { LEAST_SAMPLES = 8 };         /* of a period, or it is not seen */
static const double BURST = 10.0;   /* a diverging structure so many times its size is none */
static const double SMALLEST = 0.2; /* of the model's size, for a drawing */

static const struct {
  double (*height)(strut_run_scene *run);
  strut_status (*draw)(strut_run_scene *run, strut_canvas *canvas);
  unsigned channels;
} views[] = {
    [STRUT_RUN_OVERVIEW] = {strut_run_overview_height, strut_run_overview,
                            STRUT_CHANNEL_FORCE | STRUT_CHANNEL_CONTACT},
    [STRUT_RUN_PERIOD] = {strut_run_period_height, strut_run_period, 0},
    [STRUT_RUN_SNAPSHOTS] = {strut_run_snapshots_height, strut_run_snapshots,
                             STRUT_CHANNEL_FORCE | STRUT_CHANNEL_CONTACT},
    [STRUT_RUN_CURVES] = {strut_run_curves_height, strut_run_curves,
                          STRUT_CHANNEL_FORCE | STRUT_CHANNEL_CONTACT | STRUT_CHANNEL_ENERGY},
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
                        "...}' says what is recorded)",
                        strut_quantity_of(figure->times[i], 6, "s").text,
                        strut_quantity_of(span.record_start, 6, "s").text,
                        strut_quantity_of(span.duration, 6, "s").text);
  if (figure->view == STRUT_RUN_PERIOD && span.period > 0 &&
      span.period < LEAST_SAMPLES * every * (1 - 1e-9))
    return strut_fail(error, STRUT_USAGE,
                      "a period of %s cannot be drawn from a sample each %s: add 'output: {every: "
                      "%s, last: 10}' to the model",
                      strut_quantity_of(span.period, 4, "s").text,
                      strut_quantity_of(every, 4, "s").text,
                      strut_quantity_of(span.period / 100, 4, "s").text);
  return STRUT_OK;
}

const double *strut_run_positions(const strut_run_scene *run, size_t frame) {
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
                               model->scene->name, &canvas, error);
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
  const double share[2] = {0.5, 0.15}; /* wide rather than high */
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

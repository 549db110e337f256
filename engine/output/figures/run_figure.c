/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/run_figure.h"

#include <assert.h>
#include <gsl/gsl_interp.h>
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

static const char *(*const views[])(strut_run_scene *run, strut_figure *figure) = {
    [STRUT_RUN_OVERVIEW] = strut_run_overview,
    [STRUT_RUN_PERIOD] = strut_run_period,
    [STRUT_RUN_SNAPSHOTS] = strut_run_snapshots,
    [STRUT_RUN_CURVES] = strut_run_curves};

strut_status strut_run_figure_check(const strut_run_figure *figure, const strut_scene *scene,
                                    strut_error *error) {
  strut_span span = strut_experiment_span(figure->experiment, scene);
  double least = figure->experiment->output_every > 0.0 ? 0.0 : figure->experiment->step;
  double every = fmax(span.record_every, least), slack = 0.5 * every;
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
  strut_bounds b = strut_bounds_of(run->model, q);
  return strut_bounds_extent(&b) <= BURST * run->model->size;
}

void strut_run_find_limits(strut_run_scene *run) {
  const strut_trajectory *trajectory = run->motion;
  double *most = strut_figure_numbers(run->page, NULL, run->frames);
  if (!most) return;
  for (size_t f = 0; f < run->frames && trajectory->force; f++)
    most[f] =
        strut_largest(trajectory->force + f * trajectory->member_count, trajectory->member_count);
  double range[2] = {0, 0};
  run->beyond = strut_leave_out(most, run->frames, FEW_FRAMES, range);
  run->force_limit = range[1];
  run->beyond.below = run->beyond.above; /* of either sign */
}

void strut_run_count_frames(strut_run_scene *run) {
  const strut_trajectory *trajectory = run->motion;
  while (run->frames < trajectory->frames && is_shape(run, run->frames)) run->frames++;
  double period = strut_experiment_span(run->figure->experiment, run->model->scene).period;
  double all = run->frames ? strut_run_time_from(run, 0) : 0;
  bool fine = (double)(run->frames - 1) * period >= LEAST_SAMPLES * all * (1 - 1e-9);
  if (!(run->frames > 1 && fine && period > 0)) return;
  int32_t repeats = run->summary ? run->summary->steady.repeats : 0;
  bool whole = repeats * period <= all + 1e-6 * period; /* of the orbit is recorded */
  run->repeats = repeats > 1 && whole ? repeats : 1;
  run->period = run->repeats * period;
}

double *strut_run_coordinates(const strut_run_scene *run, size_t frame) {
  double *q = strut_figure_numbers(run->page, NULL, (size_t)run->model->length);
  if (q) memcpy(q, strut_run_positions(run, frame), 2 * run->motion->node_count * sizeof *q);
  return q;
}

double strut_run_time_from(const strut_run_scene *run, size_t frame) {
  return run->motion->time[run->frames - 1] - run->motion->time[frame];
}

size_t strut_run_nearest(const strut_run_scene *run, double time) {
  const double *times = run->motion->time;
  size_t low = gsl_interp_bsearch(times, time, 0, run->frames - 1);
  bool next = low + 1 < run->frames && time - times[low] > times[low + 1] - time;
  return next ? low + 1 : low;
}

size_t strut_run_first(const strut_run_scene *run, double periods, double part) {
  double all = strut_run_time_from(run, 0);
  double duration = run->period > 0 ? fmin(periods * run->period, all) : part * all;
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

strut_bounds strut_run_frame_bounds(const strut_run_scene *run, size_t frame) {
  strut_bounds b = strut_bounds_of(run->model, strut_run_positions(run, frame));
  double missing = SMALLEST * run->model->size - strut_bounds_extent(&b);
  const double share[2] = {0.5,
                           0.15}; /* the missing extent goes to the width rather than the height */
  for (int d = 0; d < 2 && missing > 0; d++) {
    b.low[d] -= share[d] * missing;
    b.high[d] += share[d] * missing;
  }
  return b;
}

void strut_run_add_ground(const strut_run_scene *run, strut_bounds *bounds) {
  if (!run->model->scene->ground.present) return;
  double ground = strut_run_ground_at(run, 0.5 * (bounds->low[0] + bounds->high[0]));
  if (bounds->low[1] > ground && bounds->low[1] - ground < strut_bounds_extent(bounds))
    bounds->low[1] = ground;
}

/* Parts of several views: shapes, contact forces, scales. */

static const double STANDING = 1e-6; /* of the model's size over the whole run: it stands still */

strut_shape *strut_run_add_shape(const strut_run_scene *run, strut_panel *panel, size_t frame) {
  const strut_trajectory *trajectory = run->motion;
  strut_shape *shape =
      strut_add_shape(run->page, panel, run->model, strut_run_coordinates(run, frame));
  shape->style.time = trajectory->time ? trajectory->time[frame] : 0.0;
  shape->ground = true;
  shape->moving = trajectory->time != NULL;
  if (trajectory->force) {
    shape->style.colouring = STRUT_COLOUR_FORCE;
    shape->style.values = shape->style.slack_forces =
        trajectory->force + frame * trajectory->member_count;
    shape->style.limit = run->force_limit;
  }
  if (trajectory->contact)
    shape->forces =
        (const double(*)[2])(trajectory->contact + 2 * frame * trajectory->contact_count);
  return shape;
}

void strut_run_add_scales(const strut_run_scene *run) {
  run->page->yardstick = true;
  run->page->scale = strut_force_scale(run->motion->force ? run->force_limit : 0, &run->beyond);
}

/* ---- the whole figure ---- */

/* What the figure shows: the failure, `what`, the velocity. */
static const char *describe_run(const strut_run_scene *run, const char *what) {
  const strut_summary *summary = run->summary;
  if (summary && summary->status != STRUT_OK)
    return strut_figure_text(run->page, "%s at %s; %.400s",
                             summary->status == STRUT_DIVERGED ? "diverged" : "stopped",
                             strut_quantity_of(summary->duration, 4, "s").text, what);
  bool moving = summary && run->figure->view != STRUT_RUN_SNAPSHOTS;
  if (!moving || !isfinite(summary->velocity)) return what;
  double way = fabs(summary->velocity) * fmax(summary->duration, STRUT_RUN_MOMENT);
  double v = way > STANDING * run->model->size ? summary->velocity : 0;
  return strut_figure_text(run->page, "%.400s; velocity of %.60s %s%s", what,
                           strut_run_measured_name(run), strut_quantity_of(v, 4, "m/s").text,
                           v > 0   ? " \xe2\x86\x92"
                           : v < 0 ? " \xe2\x86\x90"
                                   : "");
}

strut_status strut_run_figure_draw(const strut_run_figure *figure, const strut_model *model,
                                   const strut_trajectory *motion, const strut_summary *summary,
                                   strut_error *error) {
  strut_figure page = {.title = model->scene->name,
                       .alarm = summary && summary->status != STRUT_OK};
  strut_run_scene run = {
      .figure = figure, .model = model, .motion = motion, .summary = summary, .page = &page};
  if (motion->position) strut_run_count_frames(&run);
  if (!run.frames)
    return strut_fail(error, STRUT_USAGE, "there is nothing to draw: no positions were recorded");
  strut_run_find_limits(&run);
  page.note = describe_run(&run, views[figure->view](&run, &page));
  return strut_figure_draw(&figure->plot, &page, error);
}

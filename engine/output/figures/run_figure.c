/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/run_figure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/draw/palette.h"
#include "engine/output/figures/run_parts.h"

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

static double largest(const double *values, size_t count) {
  double most = 0;
  for (size_t i = 0; values && i < count; i++)
    if (isfinite(values[i])) most = fmax(most, fabs(values[i]));
  return most;
}

static strut_status check_times(const strut_run_figure *figure, const strut_trajectory *motion,
                                strut_error *error) {
  double first = motion->time[0], last = motion->time[motion->frames - 1];
  for (size_t i = 0; i < figure->time_count; i++)
    if (!(figure->times[i] >= first - 1e-9 && figure->times[i] <= last + 1e-9))
      return strut_fail(error, STRUT_USAGE,
                        "nothing was recorded at %s: the record goes from %s to %s (output.last and "
                        "output.every say what is recorded)",
                        strut_drawn_quantity(figure->times[i], 6, "s").text,
                        strut_drawn_quantity(first, 6, "s").text, strut_drawn_quantity(last, 6, "s").text);
  return STRUT_OK;
}

strut_status strut_run_figure_draw(const char *path, const strut_run_figure *figure,
                                   const strut_model *model, const strut_trajectory *motion,
                                   const strut_summary *summary, strut_error *error) {
  if (!motion->frames || !motion->position)
    return strut_fail(error, STRUT_USAGE, "there is nothing to draw: no positions were recorded");
  strut_status status = check_times(figure, motion, error);
  if (status != STRUT_OK) return status;
  strut_run_scene run = {.figure = figure,
                         .model = model,
                         .motion = motion,
                         .summary = summary,
                         .period = strut_scene_span(model->scene).period};
  run.force_limit = largest(motion->force, motion->frames * motion->member_count);
  strut_canvas *canvas = NULL;
  status = strut_canvas_open(path, figure->width, views[figure->view].height(&run),
                             model->scene->name, &canvas, error);
  if (status == STRUT_OK) {
    status = views[figure->view].draw(&run, canvas);
    if (status != STRUT_OK) strut_fail(error, status, "out of memory while drawing");
  }
  if (status == STRUT_OK) status = strut_canvas_commit(canvas, error);
  strut_canvas_free(canvas);
  strut_arena_free(&run.arena);
  return status;
}

double *strut_run_shape(strut_run_scene *run, size_t frame) {
  size_t used = 2 * run->motion->node_count;
  double *q = strut_arena_allocate(&run->arena, (size_t)run->model->length, sizeof *q);
  if (q) memcpy(q, run->motion->position + frame * used, used * sizeof *q);
  return q;
}

size_t strut_run_since(const strut_run_scene *run, double duration) {
  const strut_trajectory *m = run->motion;
  double from = m->time[m->frames - 1] - duration * (1 + 1e-9);
  size_t first = m->frames - 1;
  while (first > 0 && m->time[first - 1] >= from) first--;
  return m->frames > 1 && first == m->frames - 1 ? m->frames - 2 : first;
}

double strut_run_measured(const strut_run_scene *run, size_t frame) {
  const double *q = run->motion->position + 2 * frame * run->motion->node_count;
  int32_t node = run->model->scene->experiment.measure_node;
  if (node >= 0) return q[2 * node];
  double sum = 0, mass = 0;
  for (size_t i = 0; i < run->motion->node_count; i++) {
    sum += run->model->weight[i] * q[2 * i];
    mass += run->model->weight[i];
  }
  return mass > 0 ? sum / mass : q[0];
}

const char *strut_run_measured_name(const strut_run_scene *run) {
  int32_t node = run->model->scene->experiment.measure_node;
  return node >= 0 ? run->model->scene->nodes[node].name : "centre of mass";
}

bool strut_run_draw_trails(strut_run_scene *run, strut_canvas *canvas, const strut_window *window,
                           size_t first, size_t last) {
  size_t count = last - first + 1, nodes = run->motion->node_count;
  double(*way)[2] = strut_arena_allocate(&run->arena, count, sizeof *way);
  for (size_t i = 0; way && i < nodes; i++) {
    for (size_t f = 0; f < count; f++)
      memcpy(way[f], run->motion->position + 2 * ((first + f) * nodes + i), sizeof *way);
    strut_draw_trail(canvas, window, (const double(*)[2])way, count, 0.9);
  }
  return way;
}

void strut_run_expect_frame(strut_run_scene *run, size_t frame) {
  size_t size = 2 * run->motion->contact_count;
  if (!run->motion->contact) return;
  run->contact_limit =
      fmax(run->contact_limit, largest(run->motion->contact + frame * size, size));
}

bool strut_run_draw_frame(strut_run_scene *run, strut_canvas *canvas, const strut_window *window,
                          size_t frame, bool names) {
  const strut_trajectory *m = run->motion;
  double *q = strut_run_shape(run, frame);
  if (!q) return false;
  strut_structure_style style = {.colouring = STRUT_COLOUR_KIND, .node_names = names};
  if (m->force) {
    style.colouring = STRUT_COLOUR_FORCE;
    style.values = style.slack_forces = m->force + frame * m->member_count;
    style.limit = run->force_limit;
  }
  strut_draw_ground(canvas, window, run->model);
  strut_draw_structure(canvas, window, run->model, q, &style);
  if (m->contact)
    strut_draw_contact_forces(
        canvas, window, run->model, q,
        (const double(*)[2])(m->contact + 2 * frame * m->contact_count), run->contact_limit, 26);
  return true;
}

void strut_run_draw_scale(const strut_run_scene *run, strut_canvas *canvas, strut_box box) {
  const strut_colour_scale scale = {
      .name = "force", .unit = "N", .low = -run->force_limit, .high = run->force_limit};
  if (run->motion->force && run->force_limit > 0) strut_draw_colour_scale(canvas, box, &scale);
}

double strut_run_draw_title(const strut_run_scene *run, strut_canvas *canvas, strut_box box,
                            const char *what) {
  const strut_summary *s = run->summary;
  char line[700];
  double width, height, used;
  strut_font title = {.size = 9, .bold = true, .width = box.width};
  strut_font below = {.size = 8, .width = box.width, .colour = strut_grey(0.3)};
  if (s && s->status != STRUT_OK) below.colour = strut_palette_thing(1);
  strut_draw_text(canvas, box.x, box.y, run->model->scene->name, title);
  strut_text_size(canvas, run->model->scene->name, title, &width, &used);
  used += 1;
  if (s && s->status != STRUT_OK) {
    snprintf(line, sizeof line, "%s at %s: %s", strut_status_text(s->status),
             strut_drawn_quantity(s->duration, 4, "s").text, what);
  } else if (s && isfinite(s->velocity)) {
    snprintf(line, sizeof line, "%s; %s moves with %s", what, strut_run_measured_name(run),
             strut_drawn_quantity(fabs(s->velocity) < 1e-12 ? 0 : s->velocity, 4, "m/s").text);
  } else {
    snprintf(line, sizeof line, "%s", what);
  }
  strut_draw_text(canvas, box.x, box.y + used, line, below);
  strut_text_size(canvas, line, below, &width, &height);
  return used + height + 3;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/film/film.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>

#include "engine/output/draw/canvas.h"
#include "engine/output/draw/chart.h"

/* The camera follows motion beyond this many sizes of the structure, in x and in y. */
static const double RANGE[2] = {2.05, 1.6};

/* Symmetric moving averages of one column of (count, 2) rows;
 * `sum` has room for (count + 1). */
static void smooth(double (*to)[2], const double (*from)[2], int axis, size_t count, size_t reach,
                   double *sum) {
  sum[0] = 0;
  for (size_t i = 0; i < count; i++) sum[i + 1] = sum[i] + from[i][axis];
  for (size_t i = 0; i < count; i++) {
    size_t near = i < count - 1 - i ? i : count - 1 - i;
    if (near > reach) near = reach;
    to[i][axis] = (sum[i + near + 1] - sum[i - near]) / (double)(2 * near + 1);
  }
}

static strut_bounds union_of(const strut_bounds *bounds, size_t count, double *size) {
  strut_bounds all = strut_bounds_none();
  *size = 0;
  for (size_t i = 0; i < count; i++) {
    for (int k = 0; k < 2; k++) {
      all.low[k] = fmin(all.low[k], bounds[i].low[k]);
      all.high[k] = fmax(all.high[k], bounds[i].high[k]);
      *size = fmax(*size, bounds[i].high[k] - bounds[i].low[k]);
    }
  }
  return all;
}

bool strut_camera_plan(strut_camera *camera, const strut_bounds *bounds, size_t count, size_t reach,
                       strut_arena *arena) {
  double size;
  strut_bounds all = union_of(bounds, count, &size);
  *camera = (strut_camera){.count = count};
  camera->middle = strut_arena_allocate(arena, count, sizeof *camera->middle);
  double(*once)[2] = strut_arena_allocate(arena, count, sizeof *once);
  double *sum = strut_arena_allocate(arena, count + 1, sizeof *sum);
  if (!camera->middle || !once || !sum) return false;
  for (int k = 0; k < 2; k++) {
    camera->follows[k] = size > 0 && all.high[k] - all.low[k] > RANGE[k] * size;
    for (size_t i = 0; i < count; i++)
      camera->middle[i][k] = camera->follows[k] ? 0.5 * (bounds[i].low[k] + bounds[i].high[k])
                                                : 0.5 * (all.low[k] + all.high[k]);
    if (camera->follows[k]) { /* twice, so that its speed has no jumps either */
      smooth(once, (const double(*)[2])camera->middle, k, count, reach, sum);
      smooth(camera->middle, (const double(*)[2])once, k, count, reach, sum);
    }
    for (size_t i = 0; i < count; i++) {
      double middle = camera->middle[i][k];
      double need = fmax(bounds[i].high[k] - middle, middle - bounds[i].low[k]);
      camera->half[k] = fmax(camera->half[k], need);
    }
  }
  return true;
}

static const double FAR = 20; /* a diverged shape larger than this, in sizes, is not drawn */

/* True if a shape is finite and, if the run diverged, of drawable size. */
static bool is_drawable(const strut_model *model, const strut_trajectory *motion, const double *q) {
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
  for (size_t i = 0; i < 2 * motion->node_count; i++) {
    if (!isfinite(q[i])) return false;
    low[i % 2] = fmin(low[i % 2], q[i]);
    high[i % 2] = fmax(high[i % 2], q[i]);
  }
  double size = fmax(high[0] - low[0], high[1] - low[1]);
  return motion->status != STRUT_DIVERGED || size < FAR * model->size;
}

size_t strut_frames_to_show(const strut_model *model, const strut_trajectory *motion) {
  size_t frames = 0;
  while (frames < motion->frames &&
         is_drawable(model, motion, motion->position + 2 * motion->node_count * frames))
    frames++;
  return frames;
}

bool strut_moment_create(strut_moment *moment, const strut_model *model,
                         const strut_trajectory *motion, strut_arena *arena) {
  *moment = (strut_moment){0};
  moment->q = strut_arena_allocate(arena, (size_t)model->length, sizeof(double));
  if (motion->force) {
    moment->force = strut_arena_allocate(arena, motion->member_count, sizeof(double));
    if (!moment->force) return false;
  }
  if (motion->contact && motion->contact_count > 0) {
    moment->contact = strut_arena_allocate(arena, 2 * motion->contact_count, sizeof(double));
    if (!moment->contact) return false;
  }
  return moment->q;
}

/* to = (1 - part) row i + part row j of (rows, count). */
static void interpolate_rows(double *to, const double *rows, size_t count, size_t i, size_t j,
                             double part) {
  const double *from = rows + i * count, *next = rows + j * count;
  for (size_t k = 0; k < count; k++)
    to[k] = part > 0 ? from[k] + part * (next[k] - from[k]) : from[k];
}

void strut_moment_at(strut_moment *moment, const strut_trajectory *motion, size_t frames,
                     double time) {
  const double *t = motion->time;
  assert(frames > 0 && moment->frame < frames);
  size_t i = moment->frame;
  while (i + 1 < frames && t[i + 1] <= time) i++;
  size_t j = i + 1 < frames ? i + 1 : i;
  double part = t[j] > t[i] && time > t[i] ? fmin(1, (time - t[i]) / (t[j] - t[i])) : 0;
  moment->frame = i;
  moment->time = time;
  interpolate_rows(moment->q, motion->position, 2 * motion->node_count, i, j, part);
  if (moment->force)
    interpolate_rows(moment->force, motion->force, motion->member_count, i, j, part);
  if (moment->contact)
    interpolate_rows(moment->contact, motion->contact, 2 * motion->contact_count, i, j, part);
}

double strut_moment_travel(const strut_moment *moment, const strut_model *model, int32_t node) {
  double sum = 0, weight = 0;
  if (node >= 0) return moment->q[2 * node];
  for (int32_t i = 0; i < model->node_count; i++) {
    sum += model->weight[i] * moment->q[2 * i];
    weight += model->weight[i];
  }
  sum += strut_sliding_moment(model, moment->time, 0, moment->q);
  return weight > 0 ? sum / weight : moment->q[0];
}

enum { DIGITS = 3, TEXT = 64, MOST_MARKS = 200, TITLE = 84 };

static const double EDGE = 14, ABOVE = 34, BELOW = 46; /* of the page [pt] */
static const double AROUND = 34, CLOSE = 18;           /* the structure, with arrows and without */
static const double ARROW = 26;                        /* of the largest contact force */
static const double BETWEEN = 70; /* approximate spacing of ground marks [pt] */
static const double LEAST =
    0.02;                       /* of the structure's size, or of 1 m: least range around a point */
static const double NEAR = 0.5; /* a ground nearer than this, in sizes, is always in view */

static double round_step(double length) {
  double power = pow(10.0, floor(log10(length)));
  return length >= 5 * power ? 5 * power : length >= 2 * power ? 2 * power : power;
}

/* Bounds to show around the camera's middle, with a nearby ground. */
static strut_bounds around(const strut_view_frame *s) {
  const strut_camera *camera = s->camera;
  const strut_ground *ground = &s->model->scene->ground;
  double least =
      fmax(camera->half[0], camera->half[1]) < LEAST * s->model->size ? LEAST * s->model->size : 0;
  strut_bounds bounds;
  for (int k = 0; k < 2; k++) {
    bounds.low[k] = -fmax(camera->half[k], least);
    bounds.high[k] = fmax(camera->half[k], least);
  }
  if (ground->present && ground->slope == 0 && !camera->follows[1]) {
    double size = fmax(camera->half[0], camera->half[1]);
    double height = ground->height - camera->middle[0][1];
    if (height < bounds.low[1] && bounds.low[1] - height <= 2 * NEAR * size) bounds.low[1] = height;
  }
  return bounds;
}

void strut_view_frame_fit(strut_view_frame *s, strut_box page) {
  strut_bounds bounds = around(s);
  strut_box box = {page.x, page.y + ABOVE, page.width, page.height - ABOVE - BELOW};
  s->window = strut_window_fit(box, bounds, s->model->contacts.count > 0 ? AROUND : CLOSE);
  s->step = round_step(BETWEEN / s->window.scale);
}

void strut_view_frame_speed(strut_view_frame *s, double speed) {
  double whole = speed < 1 ? 1 / speed : speed;
  bool round_number = fabs(whole - round(whole)) < 1e-9 * whole;
  if (speed == 1) {
    snprintf(s->speed, sizeof s->speed, "true speed");
  } else if (speed < 1 && round_number) {
    snprintf(s->speed, sizeof s->speed, "1/%.0f of true speed", whole);
  } else {
    snprintf(s->speed, sizeof s->speed, "%.4g %s true speed", speed, speed < 1 ? "of" : "times");
  }
}

/* The window of picture i. */
static strut_window window_at(const strut_view_frame *s, size_t i) {
  strut_window window = s->window;
  window.left += s->camera->middle[i][0];
  window.top += s->camera->middle[i][1];
  return window;
}

/* Marks along the ground, numbered with their distance; those of a belt move with it. */
static void draw_marks(const strut_view_frame *s, strut_canvas *canvas, const strut_window *window,
                       double time) {
  const strut_ground *ground = &s->model->scene->ground;
  double tangent[2] = {cos(ground->slope), sin(ground->slope)}, factor;
  double moved = ground->belt_speed * time;
  double left = window->left / tangent[0], width = window->box.width / window->scale / tangent[0];
  double first = ceil((left - moved) / s->step);
  const char *prefix = strut_prefix(fmax(fabs(left), fabs(left + width)), "m", &factor);
  const strut_pen pen = {.colour = strut_grey(0.3), .width = 0.9, .butt = true};
  for (int k = 0; k < MOST_MARKS; k++) {
    double distance = (first + k) * s->step + moved, point[2], end[2];
    if (distance > left + width) break;
    const double at[2] = {distance * tangent[0], ground->height + distance * tangent[1]};
    char text[TEXT];
    strut_window_point(window, at, point);
    end[0] = point[0] + 11 * tangent[1];
    end[1] = point[1] + 11 * tangent[0];
    strut_draw_segment(canvas, point[0], point[1], end[0], end[1], pen);
    if (moved != 0 || ground->belt_speed != 0) continue;
    double number = (first + k) * s->step / factor;
    const char *sign = number < 0 ? "\xe2\x88\x92" : "";
    snprintf(text, sizeof text, "%s%.6g %sm", sign, fabs(number), prefix);
    const strut_font font = {.size = 7.5, .across = 0.5, .colour = strut_grey(0.3)};
    double half, high;
    strut_text_size(canvas, text, font, &half, &high);
    half *= 0.5;
    double right = window->box.x + window->box.width;
    if (end[0] - half < window->box.x || end[0] + half > right) continue;
    strut_draw_text(canvas, end[0], end[1] + 1, text, font);
  }
}

/* Without a ground, faint vertical lines show the motion of the camera. */
static void draw_lattice(const strut_view_frame *s, strut_canvas *canvas,
                         const strut_window *window) {
  const strut_pen pen = {.colour = strut_grey(0.9), .width = 0.6, .butt = true};
  strut_box box = window->box;
  for (int axis = 0; axis < 2; axis++) {
    double span = (axis == 0 ? box.width : box.height) / window->scale;
    double low = axis == 0 ? window->left : window->top - span;
    double first = ceil(low / s->step);
    for (int k = 0; k < MOST_MARKS && (first + k) * s->step <= low + span; k++) {
      double at[2] = {window->left, window->top}, point[2];
      at[axis] = (first + k) * s->step;
      strut_window_point(window, at, point);
      if (axis == 0) {
        strut_draw_segment(canvas, point[0], box.y, point[0], box.y + box.height, pen);
      } else {
        strut_draw_segment(canvas, box.x, point[1], box.x + box.width, point[1], pen);
      }
    }
  }
}

/* The time with fixed digits and unit. */
static void time_text(const strut_view_frame *s, double time, char text[TEXT]) {
  double factor;
  const char *prefix = strut_prefix(fmax(fabs(s->end_time), fabs(s->start_time)), "s", &factor);
  double digits = s->shown > 0 ? ceil(-log10(s->shown / factor) - 1e-6) : 0;
  int decimals = digits < 0 ? 0 : digits > 6 ? 6 : (int)digits;
  snprintf(text, TEXT, "%.*f %ss", decimals, time / factor, prefix);
}

/* A name cut to two lines. */
static void title_text(const char *name, char text[2 * TEXT]) {
  size_t length = 0;
  while (name[length] && length < TITLE) length++;
  while (length > 0 && ((unsigned char)name[length] & 0xc0) == 0x80) length--;
  snprintf(text, 2 * TEXT, "%.*s%s", (int)length, name, name[length] ? "\xe2\x80\xa6" : "");
}

static void draw_words(const strut_view_frame *s, strut_canvas *canvas,
                       const strut_moment *moment) {
  strut_box page = strut_canvas_box(canvas);
  const strut_colour grey = strut_grey(0.35);
  char text[2 * TEXT];
  title_text(s->model->scene->name, text);
  strut_draw_text(canvas, EDGE, EDGE - 4, text,
                  (strut_font){.size = 11, .bold = true, .width = 0.65 * page.width});
  time_text(s, moment->time, text);
  strut_draw_text(canvas, page.width - EDGE, EDGE - 4, text,
                  (strut_font){.size = 12, .bold = true, .across = 1});
  strut_draw_text(canvas, page.width - EDGE, EDGE + 12, s->speed,
                  (strut_font){.size = 8.5, .across = 1, .colour = grey});
  if (!s->travels) return;
  double moved = strut_moment_travel(moment, s->model, s->measured_node) - s->travelled_from;
  if (fabs(moved) < 1e-9 * s->model->size) moved = 0;
  snprintf(text, sizeof text, "moved %s", strut_drawn_quantity(moved, DIGITS, "m").text);
  strut_draw_text(canvas, EDGE, page.height - 36, text, (strut_font){.size = 9});
  double velocity = s->mean_velocity;
  if (fabs(velocity) * (s->end_time - s->start_time) < 1e-9 * s->model->size) velocity = 0;
  snprintf(text, sizeof text, "mean velocity %s",
           strut_drawn_quantity(velocity, DIGITS, "m/s").text);
  strut_draw_text(canvas, EDGE, page.height - 23, text, (strut_font){.size = 9, .colour = grey});
}

static void draw_scale(const strut_view_frame *s, strut_canvas *canvas) {
  strut_box page = strut_canvas_box(canvas);
  const strut_colour_scale scale = {.name = "force",
                                    .unit = "N",
                                    .low = -s->most_force,
                                    .high = s->most_force,
                                    .colours = STRUT_COLOURS_SIGNED};
  if (!(s->most_force > 0)) return;
  strut_draw_colour_scale(canvas, (strut_box){page.width - 190, page.height - 39, 180, 30}, &scale);
}

/* Progress bar along the lower edge. */
static void draw_progress(const strut_view_frame *s, strut_canvas *canvas, size_t i) {
  strut_box page = strut_canvas_box(canvas);
  double part = s->camera->count > 1 ? (double)i / (double)(s->camera->count - 1) : 1;
  const strut_fill fill = {.colour = strut_grey(0.75)};
  strut_draw_box(canvas, (strut_box){0, page.height - 2.5, page.width * part, 2.5}, &fill, NULL);
}

void strut_view_frame_draw(const strut_view_frame *s, strut_canvas *canvas, size_t i,
                           const strut_moment *moment) {
  strut_window window = window_at(s, i);
  strut_structure_style style = {.colouring = STRUT_COLOUR_KIND, .time = moment->time};
  if (s->most_force > 0) {
    style.colouring = STRUT_COLOUR_FORCE;
    style.values = moment->force;
    style.limit = s->most_force;
    style.slack_forces = moment->force;
  }
  bool ground = s->model->scene->ground.present;
  strut_canvas_clear(canvas, strut_grey(1));
  strut_canvas_clip(canvas, window.box);
  if (!ground && (s->camera->follows[0] || s->camera->follows[1])) draw_lattice(s, canvas, &window);
  strut_draw_ground_at(canvas, &window, s->model, moment->time);
  if (ground) draw_marks(s, canvas, &window, moment->time);
  strut_draw_structure(canvas, &window, s->model, moment->q, &style);
  if (moment->contact)
    strut_draw_contact_forces(canvas, &window, s->model, moment->q,
                              (const double(*)[2])moment->contact, s->most_contact, ARROW);
  strut_canvas_unclip(canvas);
  draw_words(s, canvas, moment);
  draw_scale(s, canvas);
  draw_progress(s, canvas, i);
}

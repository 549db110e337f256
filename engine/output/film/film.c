/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/film/film.h"

#include <math.h>

#include "engine/base/c_locale.h"

enum { WIDTH = 1280, HEIGHT = 720, GIF_WIDTH = 640, GIF_HEIGHT = 360 };

static const double PAGE_WIDTH = 512; /* [pt], the same in all sizes */
static const double LOOK_AHEAD = 0.6; /* time over which the camera averages [s of film] */

/* State while a film is made. */
typedef struct making {
  const strut_film *film;
  const strut_model *model;
  const strut_trajectory *motion;
  size_t shown; /* drawable frames of the motion */
  strut_film_made *made;
  strut_camera camera;
  strut_view_frame scenery;
  strut_moment moment;
  strut_arena arena;
} making;

strut_status strut_film_check(const char *path, strut_error *error) {
  strut_film_format format;
  strut_file file = {0};
  strut_status status = strut_encoder_format(path, &format, error);
  if (status == STRUT_OK) status = strut_encoder_find(error);
  if (status == STRUT_OK) status = strut_file_open_path(&file, path, error);
  strut_file_abandon(&file);
  return status;
}

strut_status strut_film_check_length(const strut_film *film, double motion, strut_error *error) {
  double lasts = motion / film->speed;
  if (!film->path || lasts <= STRUT_FILM_LONGEST) return STRUT_OK;
  return strut_fail(error, STRUT_USAGE,
                    "the film would last %.4g s, at most %d s are allowed: give a higher "
                    "--speed, or record less of the run (output: last)",
                    lasts, STRUT_FILM_LONGEST);
}

/* Sets the number of pictures, their size and their spacing in time. */
static strut_status count_frames(making *m, strut_film_format format, strut_error *error) {
  const double *time = m->motion->time;
  strut_film_made *made = m->made;
  bool gif = format == STRUT_FILM_GIF;
  m->shown = strut_frames_to_show(m->model, m->motion);
  if (m->shown == 0)
    return strut_fail(error, STRUT_DIVERGED, "the recording holds no motion to film");
  double usual = gif ? STRUT_FILM_GIF_FPS : STRUT_FILM_FPS;
  double lasts = time[m->shown - 1] - time[0];
  *made = (strut_film_made){.width = gif ? GIF_WIDTH : WIDTH,
                            .height = gif ? GIF_HEIGHT : HEIGHT,
                            .fps = m->film->fps > 0 ? m->film->fps : usual,
                            .lasts = lasts / m->film->speed};
  strut_status status = strut_film_check_length(m->film, lasts, error);
  if (status != STRUT_OK) return status;
  made->frames = 1 + (size_t)floor(made->lasts * made->fps + 1e-9);
  made->shown = m->film->speed / made->fps;
  made->every = m->shown > 1 ? lasts / (double)(m->shown - 1) : 0;
  return STRUT_OK;
}

static double frame_time(const making *m, size_t i) {
  return m->motion->time[0] + (double)i * m->made->shown;
}

/* Finds the scales that all pictures share. */
static bool survey(making *m) {
  size_t count = m->made->frames;
  strut_bounds *bounds = strut_arena_allocate(&m->arena, count, sizeof *bounds);
  if (!bounds || !strut_moment_create(&m->moment, m->model, m->motion, &m->arena)) return false;
  for (size_t i = 0; i < count; i++) {
    strut_moment_at(&m->moment, m->motion, m->shown, frame_time(m, i));
    bounds[i] = strut_bounds_none();
    strut_bounds_add(&bounds[i], m->model, m->moment.q);
  }
  return strut_camera_plan(&m->camera, bounds, count, (size_t)(LOOK_AHEAD * m->made->fps),
                           &m->arena);
}

static double largest(const double *values, size_t count) {
  double most = 0;
  for (size_t i = 0; values && i < count; i++)
    if (isfinite(values[i])) most = fmax(most, fabs(values[i]));
  return most;
}

static void find_scales(making *m) {
  strut_view_frame *s = &m->scenery;
  const strut_trajectory *motion = m->motion;
  const double *time = motion->time;
  size_t members = motion->member_count, last = m->shown - 1;
  *s = (strut_view_frame){.model = m->model,
                          .camera = &m->camera,
                          .shown = m->made->shown,
                          .measured_node = m->film->experiment->measure_node};
  strut_view_frame_fit(s, (strut_box){0, 0, PAGE_WIDTH, PAGE_WIDTH * HEIGHT / WIDTH});
  strut_view_frame_speed(s, m->film->speed);
  if (m->moment.force) s->most_force = largest(motion->force, members * m->shown);
  s->most_contact = largest(motion->contact, 2 * motion->contact_count * m->shown);
  s->start_time = time[0];
  s->end_time = time[last];
  m->moment.frame = 0;
  strut_moment_at(&m->moment, motion, m->shown, time[last]);
  double end = strut_moment_travel(&m->moment, m->model, s->measured_node);
  m->moment.frame = 0;
  strut_moment_at(&m->moment, motion, m->shown, time[0]);
  s->travelled_from = strut_moment_travel(&m->moment, m->model, s->measured_node);
  if (time[last] > time[0]) s->mean_velocity = (end - s->travelled_from) / (time[last] - time[0]);
  s->travels = true;
  for (size_t i = 0; i < m->model->scene->node_count; i++)
    if (m->model->scene->nodes[i].fixed[0]) s->travels = false;
}

static strut_status draw_frames(making *m, strut_canvas *canvas, strut_encoder *encoder,
                                strut_error *error) {
  const strut_film *film = m->film;
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < m->made->frames && status == STRUT_OK; i++) {
    size_t stride = 0;
    if (film->interrupt && *film->interrupt)
      return strut_fail(error, STRUT_INTERRUPTED, "interrupted; no film was written");
    strut_moment_at(&m->moment, m->motion, m->shown, frame_time(m, i));
    strut_view_frame_draw(&m->scenery, canvas, i, &m->moment);
    const unsigned char *pixels = strut_canvas_pixels(canvas, &stride);
    if (!pixels) return strut_no_memory(error, "while making a film");
    status = strut_encoder_frame(encoder, pixels, m->made->width, m->made->height, stride, error);
    if (film->progress) film->progress(film->progress_context, (double)i / (double)m->made->frames);
  }
  return status;
}

static strut_status encode(making *m, strut_error *error) {
  strut_encoder encoder;
  strut_canvas *canvas = NULL;
  const strut_film_made *made = m->made;
  strut_status status =
      strut_canvas_open_pixels(made->width, made->height, made->width / PAGE_WIDTH, &canvas, error);
  if (status != STRUT_OK) return status;
  status = strut_encoder_begin(&encoder, m->film->path, made->width, made->height, made->fps,
                               made->frames, error);
  if (status == STRUT_OK) {
    strut_c_locale locale = strut_c_locale_enter();
    status = draw_frames(m, canvas, &encoder, error);
    strut_c_locale_leave(locale);
    if (status == STRUT_OK) {
      status = strut_encoder_end(&encoder, error);
    } else {
      strut_encoder_abandon(&encoder);
    }
  }
  strut_canvas_free(canvas);
  return status;
}

strut_status strut_film_make(const strut_film *film, const strut_model *model,
                             const strut_trajectory *motion, strut_film_made *made,
                             strut_error *error) {
  making m = {.film = film, .model = model, .motion = motion, .made = made};
  strut_film_format format;
  strut_status status = strut_encoder_format(film->path, &format, error);
  if (status == STRUT_OK) status = count_frames(&m, format, error);
  if (status == STRUT_OK && !survey(&m)) status = strut_no_memory(error, "while making a film");
  if (status == STRUT_OK) {
    find_scales(&m);
    status = encode(&m, error);
  }
  strut_arena_free(&m.arena);
  return status;
}

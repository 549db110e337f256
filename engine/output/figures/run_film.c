/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/run_figure.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/output/draw/figure.h"
#include "engine/output/figures/run_parts.h"
#include "engine/output/file.h"

typedef struct film_format {
  const char *ending, *words;
  int width, height;
  double fps;
} film_format;

#define AS_MP4 "-c:v libx264 -preset fast -crf 18 -pix_fmt yuv420p -movflags +faststart -f mp4"
#define AS_WEBM "-c:v libvpx-vp9 -crf 30 -b:v 0 -cpu-used 5 -row-mt 0 -pix_fmt yuv420p -f webm"
#define AS_GIF                                                                                     \
  "-filter_complex 'split[a][b];[a]palettegen=stats_mode=single[p];"                               \
  "[b][p]paletteuse=dither=none:new=1' -loop 0 -f gif"

static const film_format formats[] = {{".mp4", AS_MP4, 1280, 720, STRUT_FILM_FPS},
                                      {".webm", AS_WEBM, 1280, 720, STRUT_FILM_FPS},
                                      {".gif", AS_GIF, 640, 360, STRUT_FILM_GIF_FPS}};
enum { FORMATS = sizeof formats / sizeof *formats, LONGEST = 1800 /* film [s] */ };

static const film_format *format_of(const char *path) {
  const char *ending = strrchr(path, '.');
  for (size_t i = 0; i < FORMATS && ending && ending != path; i++)
    if (!strcmp(ending, formats[i].ending)) return &formats[i];
  return NULL;
}

strut_status strut_film_check(strut_film *film, double motion, strut_error *error) {
  const film_format *format = format_of(film->path);
  strut_file file = {0};
  if (!format)
    return strut_fail(error, STRUT_USAGE,
                      "'%s' is not the name of a film: it must end in .mp4, .webm or .gif",
                      film->path);
  if (system("command -v ffmpeg >/dev/null") != 0)
    return strut_fail(error, STRUT_FILE_TROUBLE,
                      "cannot find ffmpeg, which makes films: install it (Debian: apt-get install "
                      "ffmpeg), or have a figure drawn with --plot");
  if (motion / film->speed > LONGEST)
    return strut_fail(error, STRUT_USAGE,
                      "the film would last %.4g s, at most %d s are allowed: give a higher "
                      "--speed, or record less of the run (output: last)",
                      motion / film->speed, LONGEST);
  if (film->fps == 0) film->fps = format->fps;
  film->width = format->width, film->height = format->height;
  strut_status status = strut_file_open_path(&file, film->path, error);
  strut_file_abandon(&file);
  return status;
}

/* Takes pixels. One thread and no dates: the same film has the same bytes. Its name is in a variable, not in the command. */
static FILE *start_ffmpeg(const strut_film *film, const char *path) {
  char command[1024];
  snprintf(
      command, sizeof command,
      "exec ffmpeg -nostdin -hide_banner -v error -f rawvideo -pixel_format bgr0 -video_size %dx%d "
      "-framerate %.6f -i pipe:0 %s -an -threads 1 -map_metadata -1 -fflags +bitexact "
      "-flags:v +bitexact -y \"file:$STRUT_FILM\" >/dev/null",
      film->width, film->height, film->fps, format_of(film->path)->words);
  return setenv("STRUT_FILM", path, 1) ? NULL : popen(command, "w");
}

static const double PAGE = 400, HEIGHT = 163, MARGIN = 13; /* of the drawing [pt] */
static const double FAR = 1; /* sizes of the structure over which the window moves along */

typedef struct making {
  strut_film *film;
  strut_run_scene run;
  double travel[2];     /* of the window during the film [m] */
  strut_bounds view;    /* of all shapes in the first picture's window */
  double contact_limit; /* largest force of the ground [N] */
} making;

static size_t frame_at(const making *self, size_t i) {
  double shown = (double)i * self->film->speed / self->film->fps;
  return strut_run_nearest(&self->run, self->run.motion->time[0] + shown);
}

static strut_bounds bounds_of(const making *self, size_t i) {
  return strut_bounds_of(self->run.model, strut_run_positions(&self->run, frame_at(self, i)));
}

/* Moves bounds as the window has moved at picture i, or back. */
static strut_bounds move(const making *self, size_t i, int sign, strut_bounds b) {
  double part = sign * (double)i / fmax((double)self->film->frames - 1, 1);
  for (int d = 0; d < 2; d++)
    b.low[d] += part * self->travel[d], b.high[d] += part * self->travel[d];
  return b;
}

static void find_view(making *self) {
  const strut_bounds first = bounds_of(self, 0), last = bounds_of(self, self->film->frames - 1);
  double size = strut_bounds_extent(&first);
  for (int d = 0; d < 2; d++) {
    double way = 0.5 * (last.low[d] + last.high[d] - first.low[d] - first.high[d]);
    if (size > 0 && fabs(way) > FAR * size) self->travel[d] = way;
  }
  self->view = strut_bounds_none();
  for (size_t i = 0; i < self->film->frames; i++) {
    const strut_bounds b = move(self, i, -1, bounds_of(self, i));
    strut_bounds_widen(&self->view, b.low, b.high);
  }
  strut_run_add_ground(&self->run, &self->view);
}

/* Marks along the ground, which they show passing. */
static void add_marks(const making *self, strut_figure *page, strut_panel *panel) {
  enum { MARKS = 40 };
  const strut_pen pen = {.colour = strut_grey(0.3), .width = 0.9, .butt = true};
  const strut_ground *ground = &self->run.model->scene->ground;
  const double *low = panel->bounds.low, *high = panel->bounds.high;
  double scale =
      fmin((PAGE - 2 * MARGIN) / (high[0] - low[0]), (HEIGHT - 2 * MARGIN) / (high[1] - low[1]));
  double step = pow(10.0, ceil(log10(20.0 / scale))), half = 0.5 * PAGE / scale;
  double middle = 0.5 * (low[0] + high[0]), x = step * ceil((middle - half) / step);
  if (!ground->present || ground->belt_speed != 0) return;
  for (int i = 0; x < middle + half && i < MARKS; i++, x += step) {
    double y = strut_run_ground_at(&self->run, x);
    strut_add_segment(page, panel, STRUT_SERIES_LINE, pen, (const double[2]){x, y},
                      (const double[2]){x, y - 9 / scale});
  }
}

/* Describes picture i. */
static void fill(const making *self, size_t i, strut_figure *page) {
  strut_run_scene run = self->run;
  size_t frame = frame_at(self, i);
  double digits = fmin(fmax(ceil(-log10(self->film->speed / self->film->fps) - 1e-6), 0), 6);
  double moved = strut_run_measured(&run, frame, 0) - strut_run_measured(&run, 0, 0);
  run.page = page;
  strut_panel *panel = strut_add_panel(page);
  panel->bounds = move(self, i, 1, self->view);
  panel->margin = MARGIN;
  panel->height = HEIGHT;
  add_marks(self, page, panel);
  strut_run_add_shape(&run, panel, frame)->force_limit = self->contact_limit;
  if (fabs(moved) < 1e-9 * run.model->size) moved = 0;
  page->title = *run.model->scene->name ? run.model->scene->name : " "; /* its line stays */
  page->scale = strut_force_scale(run.motion->force ? run.force_limit : 0, &run.beyond);
  strut_add_key(page, STRUT_KEY_WORDS, (strut_pen){0},
                strut_figure_text(page, "%.*f s   %.60s: x %s%s", (int)digits,
                                  run.motion->time[frame], strut_run_measured_name(&run),
                                  moved < 0 ? "" : "+", strut_quantity_of(moved, 3, "m").text));
}

/* Draws all pictures and writes them to ffmpeg. */
static strut_status draw_all(const making *self, const strut_cairo_library *cairo,
                             strut_canvas *canvas, FILE *pipe, strut_error *error) {
  const strut_film *film = self->film;
  for (size_t i = 0; i < film->frames; i++) {
    size_t stride = 0;
    strut_figure page = {0};
    if (film->interrupt && *film->interrupt)
      return strut_fail(error, STRUT_INTERRUPTED, "interrupted; no film was written");
    fill(self, i, &page);
    const unsigned char *pixels = cairo->paint(canvas, &page, &stride);
    strut_arena_free(&page.arena);
    if (!pixels) return strut_no_memory(error, "while making a film");
    if (!fwrite(pixels, stride * (size_t)film->height, 1, pipe)) break; /* ffmpeg says why */
    if (film->progress) film->progress(film->progress_context, (double)i / (double)film->frames);
  }
  return STRUT_OK;
}

static strut_status encode(const making *self, strut_error *error) {
  const strut_film *film = self->film;
  const strut_cairo_library *cairo = NULL;
  strut_canvas *canvas = NULL;
  strut_file file = {0};
  strut_status status = strut_cairo_load(&cairo, error);
  if (status != STRUT_OK) return status;
  void (*before)(int) = signal(SIGPIPE, SIG_IGN);
  status = cairo->open(film->width, film->height, film->width / PAGE, &canvas, error);
  if (status == STRUT_OK) status = strut_file_open_path(&file, film->path, error);
  FILE *pipe = status == STRUT_OK ? start_ffmpeg(film, file.part) : NULL;
  if (pipe) status = draw_all(self, cairo, canvas, pipe, error);
  if ((!pipe || pclose(pipe) != 0) && status == STRUT_OK)
    status = strut_fail(error, STRUT_FILE_TROUBLE, "ffmpeg could not write '%s'", film->path);
  if (status == STRUT_OK) status = strut_file_commit(&file, error);
  strut_file_abandon(&file);
  cairo->free(canvas);
  signal(SIGPIPE, before);
  return status;
}

strut_status strut_film_make(strut_film *film, const strut_model *model,
                             const strut_trajectory *motion, strut_error *error) {
  const strut_run_figure figure = {.experiment = film->experiment};
  strut_figure page = {0};
  making m = {.film = film,
              .run = {.figure = &figure, .model = model, .motion = motion, .page = &page}};
  if (motion->position) strut_run_count_frames(&m.run);
  if (!m.run.frames)
    return strut_fail(error, STRUT_DIVERGED, "the recording holds no motion to film");
  film->motion = strut_run_time_from(&m.run, 0);
  film->frames = 1 + (size_t)floor(film->motion / film->speed * film->fps + 1e-9);
  film->every = m.run.frames > 1 ? film->motion / (double)(m.run.frames - 1) : 0;
  m.contact_limit = strut_largest(motion->contact, 2 * m.run.frames * motion->contact_count);
  find_view(&m);
  strut_run_find_limits(&m.run);
  strut_status status =
      page.failed ? strut_no_memory(error, "while making a film") : encode(&m, error);
  strut_arena_free(&page.arena);
  return status;
}

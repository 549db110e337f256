/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/run_film.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/figures/run_parts.h"
#include "engine/output/file.h"

static const struct {
  const char *ending, *words;
  int width, height;
  double fps;
} formats[] = {
    {".mp4", "-c:v libx264 -preset fast -crf 18 -pix_fmt yuv420p -movflags +faststart -f mp4", 1280,
     720, 30},
    {".webm", "-c:v libvpx-vp9 -crf 30 -b:v 0 -cpu-used 5 -row-mt 0 -pix_fmt yuv420p -f webm", 1280,
     720, 30},
    {".gif",
     "-filter_complex 'split[a][b];[a]palettegen=stats_mode=single[p];"
     "[b][p]paletteuse=dither=none:new=1' -loop 0 -f gif",
     640, 360, 25}};
enum { FORMATS = sizeof formats / sizeof *formats, LONGEST = 1800 /* film [s] */ };

static strut_status find_format(const char *path, int *format, strut_error *error) {
  for (*format = 0; *format < FORMATS; (*format)++) {
    size_t length = strlen(path), end = strlen(formats[*format].ending);
    if (length > end && !strcmp(path + length - end, formats[*format].ending)) return STRUT_OK;
  }
  return strut_fail(error, STRUT_USAGE,
                    "'%s' is not the name of a film: it must end in .mp4, .webm or .gif", path);
}

/* ---- ffmpeg ---- */

typedef struct encoder {
  strut_file file;
  FILE *messages, *pipe; /* standard error of ffmpeg, and its pixels */
} encoder;

/* One thread and no dates, so that the same film has the same bytes. Its name is in a variable, not in the command. */
static strut_status start(encoder *e, const char *path, int format, const strut_film_made *made,
                          strut_error *error) {
  char command[1024];
  strut_status status = strut_file_open_path(&e->file, path, error);
  if (status != STRUT_OK) return status;
  e->messages = tmpfile();
  snprintf(
      command, sizeof command,
      "exec ffmpeg -nostdin -hide_banner -v error -f rawvideo -pixel_format bgr0 -video_size %dx%d "
      "-framerate %.6f -i pipe:0 %s -an -threads 1 -map_metadata -1 -fflags +bitexact "
      "-flags:v +bitexact -y \"file:$STRUT_FILM\" >/dev/null 2>&%d",
      made->width, made->height, made->fps, formats[format].words,
      e->messages ? fileno(e->messages) : 2);
  if (e->messages && !setenv("STRUT_FILM", e->file.part, 1)) e->pipe = popen(command, "w");
  if (e->pipe) return STRUT_OK;
  return strut_fail(error, STRUT_FILE_TROUBLE, "cannot start ffmpeg: %s", strerror(errno));
}

/* Ends the pixels; where ffmpeg is not content, its first message is the error. */
static strut_status finish(encoder *e, strut_error *error) {
  char text[300] = "";
  int result = pclose(e->pipe);
  e->pipe = NULL;
  if (result == 0) return STRUT_OK;
  rewind(e->messages);
  if (!fgets(text, sizeof text, e->messages)) strcpy(text, "it gave no reason");
  text[strcspn(text, "\r\n")] = '\0';
  return strut_fail(error, STRUT_FILE_TROUBLE, "ffmpeg could not write '%s': %s", e->file.path,
                    text);
}

strut_status strut_film_check(const char *path, strut_error *error) {
  int format;
  strut_file file = {0};
  strut_status status = find_format(path, &format, error);
  if (status == STRUT_OK && system("command -v ffmpeg >/dev/null") != 0)
    status =
        strut_fail(error, STRUT_FILE_TROUBLE,
                   "cannot find ffmpeg, which makes films: install it (Debian: apt-get install "
                   "ffmpeg), or have a figure drawn with --plot");
  if (status == STRUT_OK) status = strut_file_open_path(&file, path, error);
  strut_file_abandon(&file);
  return status;
}

/* ---- frames ---- */

static const double PAGE = 512, HEAD = 30, FOOT = 40, EDGE = 14, MARGIN = 18, ARROW = 26; /* [pt] */
static const double STAYS = 2.05;     /* sizes of the structure within which the window stands */
static const double LOOK_AHEAD = 0.6; /* over which a moving window's middle is averaged [s] */

typedef struct making {
  const strut_film *film;
  strut_film_made *made;
  strut_run_scene run;
  strut_bounds
      all; /* of all frames, or along an axis that is followed of the largest one about 0 */
  bool follows[2];
} making;

/* The frame nearest to picture i of the film. */
static size_t frame_at(const making *m, size_t i) {
  const double *time = m->run.motion->time, wanted = time[0] + (double)i * m->made->shown;
  size_t low = 0, high = m->run.frames - 1;
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    *(time[middle] <= wanted ? &low : &high) = middle;
  }
  return wanted - time[low] <= time[high] - wanted ? low : high;
}

static strut_bounds bounds_of(const making *m, size_t i) {
  strut_bounds b = strut_bounds_none();
  strut_bounds_add(&b, m->run.model, strut_run_positions(&m->run, frame_at(m, i)));
  return b;
}

static void find_window(making *m) {
  double half[2] = {0, 0};
  m->all = strut_bounds_none();
  for (size_t i = 0; i < m->made->frames; i++) {
    const strut_bounds b = bounds_of(m, i);
    for (int d = 0; d < 2; d++) {
      m->all.low[d] = fmin(m->all.low[d], b.low[d]);
      m->all.high[d] = fmax(m->all.high[d], b.high[d]);
      half[d] = fmax(half[d], 0.5 * (b.high[d] - b.low[d]));
    }
  }
  strut_run_add_ground(&m->run, &m->all);
  double size = 2.0 * fmax(half[0], half[1]);
  for (int d = 0; d < 2; d++) {
    m->follows[d] = size > 0 && m->all.high[d] - m->all.low[d] > STAYS * size;
    if (m->follows[d]) m->all.low[d] = -1.2 * half[d], m->all.high[d] = 1.2 * half[d];
  }
}

static strut_window window_at(const making *m, size_t i, double height) {
  const strut_film_made *made = m->made;
  size_t reach = (size_t)(LOOK_AHEAD * made->fps), before = i < reach ? i : reach;
  if (before > made->frames - 1 - i) before = made->frames - 1 - i;
  strut_bounds b = m->all;
  for (size_t k = i - before; k <= i + before; k++) {
    const strut_bounds own = bounds_of(m, k);
    for (int d = 0; d < 2; d++) {
      double part = 0.5 * (own.low[d] + own.high[d]) / (double)(2 * before + 1);
      if (m->follows[d]) b.low[d] += part, b.high[d] += part;
    }
  }
  return strut_window_fit((strut_box){0, HEAD, PAGE, height - HEAD - FOOT}, b, MARGIN);
}

/* Along the ground, which they show passing. */
static void draw_marks(const making *m, strut_canvas *canvas, const strut_window *w) {
  const strut_pen pen = {.colour = strut_grey(0.3), .width = 0.9, .butt = true};
  double step = pow(10.0, ceil(log10(20.0 / w->scale))), right = w->left + w->box.width / w->scale;
  const strut_ground *ground = &m->run.model->scene->ground;
  if (!ground->present || ground->belt_speed != 0) return;
  for (double x = step * ceil(w->left / step); x < right; x += step) {
    double at[2] = {x, strut_run_ground_at(&m->run, x)}, point[2];
    strut_window_point(w, at, point);
    strut_draw_segment(canvas, point[0], point[1], point[0], point[1] + 9, pen);
  }
}

static bool draw(making *m, strut_canvas *canvas, size_t i) {
  strut_box page = strut_canvas_box(canvas);
  strut_window window = window_at(m, i, page.height);
  strut_run_scene run = m->run; /* with an arena for this frame alone */
  size_t frame = frame_at(m, i);
  char text[160], fitted[STRUT_FITTED_TEXT];
  const strut_font bold = {.size = 11, .bold = true}, right = {.size = 12, .across = 1};
  run.arena = (strut_arena){0};
  strut_canvas_clear(canvas, strut_grey(1));
  strut_canvas_clip(canvas, window.box);
  bool good = strut_run_draw_frame(&run, canvas, &window, frame);
  draw_marks(m, canvas, &window);
  strut_run_draw_reactions(&run, canvas, &window, frame);
  strut_canvas_unclip(canvas);
  strut_arena_free(&run.arena);
  strut_text_fit(canvas, run.model->scene->name, bold, 0.7 * PAGE, 0, fitted);
  strut_draw_text(canvas, EDGE, EDGE - 4, fitted, bold);
  double digits = fmin(fmax(ceil(-log10(m->made->shown) - 1e-6), 0), 6);
  snprintf(text, sizeof text, "%.*f s", (int)digits, run.motion->time[frame]);
  strut_draw_text(canvas, PAGE - EDGE, EDGE - 4, text, right);
  double moved = strut_run_measured(&run, frame, 0) - strut_run_measured(&run, 0, 0);
  if (fabs(moved) < 1e-9 * run.model->size) moved = 0;
  snprintf(text, sizeof text, "%.60s: x %s%s", strut_run_measured_name(&run), moved < 0 ? "" : "+",
           strut_drawn_quantity(moved, 3, "m").text);
  strut_draw_text(canvas, EDGE, page.height - 23, text, (strut_font){.size = 9});
  strut_run_draw_scale(&run, canvas, (strut_box){PAGE - 190, page.height - 36, 180, 30});
  return good;
}

static strut_status draw_all(making *m, strut_canvas *canvas, encoder *e, strut_error *error) {
  const strut_film *film = m->film;
  for (size_t i = 0; i < m->made->frames; i++) {
    size_t stride = 0;
    if (film->interrupt && *film->interrupt)
      return strut_fail(error, STRUT_INTERRUPTED, "interrupted; no film was written");
    const unsigned char *pixels = draw(m, canvas, i) ? strut_canvas_pixels(canvas, &stride) : NULL;
    if (!pixels) return strut_no_memory(error, "while making a film");
    if (!fwrite(pixels, stride * (size_t)m->made->height, 1, e->pipe)) break; /* ffmpeg says why */
    if (film->progress) film->progress(film->progress_context, (double)i / (double)m->made->frames);
  }
  return finish(e, error);
}

static strut_status encode(making *m, int format, strut_error *error) {
  encoder e = {0};
  strut_canvas *canvas = NULL;
  const strut_film_made *made = m->made;
  void (*before)(int) = signal(SIGPIPE, SIG_IGN);
  strut_c_locale locale = strut_c_locale_enter();
  strut_status status =
      strut_canvas_open_pixels(made->width, made->height, made->width / PAGE, &canvas, error);
  if (status == STRUT_OK) status = start(&e, m->film->path, format, made, error);
  if (status == STRUT_OK) status = draw_all(m, canvas, &e, error);
  if (status == STRUT_OK) status = strut_file_commit(&e.file, error);
  if (e.pipe) finish(&e, NULL);
  if (e.messages) fclose(e.messages);
  strut_file_abandon(&e.file);
  strut_canvas_free(canvas);
  strut_c_locale_leave(locale);
  signal(SIGPIPE, before);
  return status;
}

strut_status strut_film_check_length(const strut_film *film, double motion, strut_error *error) {
  double lasts = motion / film->speed;
  if (!film->path || lasts <= LONGEST) return STRUT_OK;
  return strut_fail(
      error, STRUT_USAGE,
      "the film would last %.4g s, at most %d s are allowed: give a higher --speed, or "
      "record less of the run (output: last)",
      lasts, LONGEST);
}

strut_status strut_film_make(const strut_film *film, const strut_model *model,
                             const strut_trajectory *motion, strut_film_made *made,
                             strut_error *error) {
  const strut_run_figure figure = {.experiment = film->experiment};
  making m = {.film = film, .made = made};
  m.run = (strut_run_scene){.figure = &figure, .model = model, .motion = motion, .arrow = ARROW};
  int format;
  strut_status status = find_format(film->path, &format, error);
  if (status != STRUT_OK) return status;
  if (motion->position) strut_run_count_frames(&m.run);
  if (!m.run.frames)
    return strut_fail(error, STRUT_DIVERGED, "the recording holds no motion to film");
  double lasts = strut_run_time_from(&m.run, 0);
  *made = (strut_film_made){.width = formats[format].width,
                            .height = formats[format].height,
                            .fps = film->fps > 0 ? film->fps : formats[format].fps,
                            .lasts = lasts / film->speed};
  made->frames = 1 + (size_t)floor(made->lasts * made->fps + 1e-9);
  made->shown = film->speed / made->fps;
  made->every = m.run.frames > 1 ? lasts / (double)(m.run.frames - 1) : 0;
  status = strut_film_check_length(film, lasts, error);
  if (status != STRUT_OK) return status;
  for (size_t i = 0; i < m.run.frames; i++) strut_run_expect_frame(&m.run, i);
  find_window(&m);
  status = strut_run_find_limits(&m.run) ? encode(&m, format, error)
                                         : strut_no_memory(error, "while making a film");
  strut_arena_free(&m.run.arena);
  return status;
}

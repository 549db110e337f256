/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/film/film.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "engine/base/c_locale.h"
#include "engine/base/memory.h"

enum { MOST_WORDS = 48, TEXT = 32, SAID = 300 };

extern char **environ;

static const char *const endings[] = {".mp4", ".webm", ".gif"};

/* Options after those of the input pixels. One thread, so that the same film has the same bytes. */
static const char *const words_of[][24] = {
    {"-c:v", "libx264", "-preset", "fast", "-crf", "18", "-pix_fmt", "yuv420p", "-movflags",
     "+faststart", "-f", "mp4", NULL},
    {"-c:v", "libvpx-vp9", "-crf", "30", "-b:v", "0", "-deadline", "good", "-cpu-used", "5",
     "-row-mt", "0", "-pix_fmt", "yuv420p", "-f", "webm", NULL},
    {"-filter_complex",
     "split[a][b];[a]palettegen=stats_mode=diff:reserve_transparent=0[p];"
     "[b][p]paletteuse=dither=none:diff_mode=rectangle",
     "-loop", "0", "-f", "gif", NULL},
    {"-filter_complex",
     "split[a][b];[a]palettegen=stats_mode=single:reserve_transparent=0[p];"
     "[b][p]paletteuse=dither=none:new=1",
     "-loop", "0", "-f", "gif", NULL},
};

/* One palette for all frames needs all of them in memory, a megabyte each; beyond this number
   each has its * own, which makes larger files. */
enum { ONE_PALETTE = 300, GIF_OF_MANY = STRUT_FILM_GIF + 1 };

strut_status strut_encoder_format(const char *path, strut_film_format *format, strut_error *error) {
  size_t length = strlen(path);
  for (int i = 0; i < 3; i++) {
    size_t end = strlen(endings[i]);
    if (length <= end || strcmp(path + length - end, endings[i]) != 0) continue;
    *format = (strut_film_format)i;
    return STRUT_OK;
  }
  return strut_fail(error, STRUT_USAGE,
                    "'%s' is not the name of a film: it must end in .mp4, .webm or .gif", path);
}

static strut_status not_found(strut_error *error) {
  return strut_fail(error, STRUT_FILE_TROUBLE,
                    "cannot find ffmpeg, which makes films: install it (Debian: apt-get install "
                    "ffmpeg), or have a figure drawn with --plot");
}

strut_status strut_encoder_find(strut_error *error) {
  const char *path = getenv("PATH");
  strut_arena arena = {0};
  bool found = false;
  while (path && !found) {
    size_t length = strcspn(path, ":");
    char *name = strut_arena_format(&arena, "%.*s%sffmpeg", (int)length, path, length ? "/" : "");
    found = name && access(name, X_OK) == 0;
    path = path[length] ? path + length + 1 : NULL;
  }
  strut_arena_free(&arena);
  return found ? STRUT_OK : not_found(error);
}

/* Builds the command line; `texts` holds the arguments of this film. */
static void command_line(int row, int width, int height, double fps, const char *target,
                         char texts[2][TEXT], const char *words[MOST_WORDS]) {
  const char *const first[] = {"ffmpeg", "-nostdin",   "-hide_banner",  "-v",   "error",
                               "-f",     "rawvideo",   "-pixel_format", "bgr0", "-video_size",
                               texts[0], "-framerate", texts[1],        "-i",   "pipe:0"};
  const char *const last[] = {"-an",       "-threads", "1",         "-map_metadata",
                              "-1",        "-fflags",  "+bitexact", "-flags:v",
                              "+bitexact", "-y",       target};
  int count = 0;
  snprintf(texts[0], TEXT, "%dx%d", width, height);
  snprintf(texts[1], TEXT, "%.6f", fps);
  for (size_t i = 0; i < sizeof first / sizeof *first; i++) words[count++] = first[i];
  for (int i = 0; words_of[row][i]; i++) words[count++] = words_of[row][i];
  for (size_t i = 0; i < sizeof last / sizeof *last; i++) words[count++] = last[i];
  words[count] = NULL;
}

/* Starts ffmpeg in its own process group, since this program handles Ctrl-C. Returns 0 or an
   errno. */
static int spawn(strut_encoder *encoder, const char *const *words, const int pipe_ends[2]) {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  sigset_t plain;
  sigemptyset(&plain);
  sigaddset(&plain, SIGPIPE);
  int code = posix_spawn_file_actions_init(&actions);
  if (code) return code;
  code = posix_spawnattr_init(&attributes);
  if (!code) {
    posix_spawn_file_actions_adddup2(&actions, pipe_ends[0], STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, fileno(encoder->messages), STDERR_FILENO);
    posix_spawnattr_setsigdefault(&attributes, &plain);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
    code = posix_spawnp(&encoder->process, words[0], &actions, &attributes, (char *const *)words,
                        environ);
    if (code) encoder->process = 0;
    posix_spawnattr_destroy(&attributes);
  }
  posix_spawn_file_actions_destroy(&actions);
  return code;
}

/* Opens a pipe that other children do not inherit; returns 0 or an errno. */
static int open_pipe(int ends[2]) {
  if (pipe(ends) != 0) return errno;
  for (int i = 0; i < 2; i++)
    if (fcntl(ends[i], F_SETFD, FD_CLOEXEC) != 0) return errno;
  return 0;
}

static strut_status start_process(strut_encoder *encoder, const char *const *words,
                                  strut_error *error) {
  int ends[2] = {-1, -1};
  encoder->messages = tmpfile();
  int code = encoder->messages ? open_pipe(ends) : errno;
  if (!code) code = spawn(encoder, words, ends);
  if (ends[0] >= 0) close(ends[0]);
  if (code) {
    if (ends[1] >= 0) close(ends[1]);
    if (code == ENOENT) return not_found(error);
    return strut_fail(error, STRUT_FILE_TROUBLE, "cannot start ffmpeg: %s", strerror(code));
  }
  encoder->pipe = ends[1];
  return STRUT_OK;
}

strut_status strut_encoder_begin(strut_encoder *encoder, const char *path, int width, int height,
                                 double fps, size_t frames, strut_error *error) {
  strut_film_format format = STRUT_FILM_MP4;
  strut_arena arena = {0};
  char texts[2][TEXT];
  const char *words[MOST_WORDS];
  *encoder = (strut_encoder){.pipe = -1};
  strut_status status = strut_encoder_format(path, &format, error);
  if (status == STRUT_OK) status = strut_file_open_path(&encoder->file, path, error);
  if (status != STRUT_OK) return status;
  /* the prefix "file:" keeps ffmpeg from reading a protocol or an option in the name */
  char *target = strut_arena_format(&arena, "file:%s", encoder->file.part);
  if (target) {
    strut_c_locale locale = strut_c_locale_enter();
    bool many = format == STRUT_FILM_GIF && frames > ONE_PALETTE;
    command_line(many ? GIF_OF_MANY : (int)format, width, height, fps, target, texts, words);
    strut_c_locale_leave(locale);
    status = start_process(encoder, words, error);
  } else {
    status = strut_no_memory(error, "while writing a film");
  }
  strut_arena_free(&arena);
  if (status != STRUT_OK) strut_encoder_abandon(encoder);
  return status;
}

/* Writes all bytes; false with errno set. A closed pipe is an error, not a signal. */
static bool write_all(int descriptor, const unsigned char *bytes, size_t count) {
  sigset_t broken, before, pending;
  sigemptyset(&broken);
  sigaddset(&broken, SIGPIPE);
  sigpending(&pending);
  pthread_sigmask(SIG_BLOCK, &broken, &before);
  bool good = true;
  while (count > 0 && good) {
    ssize_t written = write(descriptor, bytes, count);
    if (written < 0 && errno == EINTR) continue;
    good = written > 0;
    if (!good) break;
    bytes += written;
    count -= (size_t)written;
  }
  int code = errno;
  const struct timespec now = {0, 0};
  if (!good && code == EPIPE && !sigismember(&pending, SIGPIPE))
    while (sigtimedwait(&broken, NULL, &now) < 0 && errno == EINTR) continue;
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  errno = code;
  return good;
}

/* Closes the pipe and waits; whether ffmpeg succeeded. */
static bool finish_encoding(strut_encoder *encoder) {
  int result = -1;
  if (encoder->pipe >= 0) close(encoder->pipe);
  encoder->pipe = -1;
  if (encoder->process <= 0) return false;
  while (waitpid(encoder->process, &result, 0) < 0)
    if (errno != EINTR) break;
  encoder->process = 0;
  return WIFEXITED(result) && WEXITSTATUS(result) == 0;
}

/* Reports ffmpeg's last message as an error. */
static strut_status complaint(strut_encoder *encoder, strut_error *error) {
  char text[SAID] = "";
  if (encoder->messages && fseek(encoder->messages, 0, SEEK_SET) == 0) {
    char line[SAID];
    while (fgets(line, sizeof line, encoder->messages)) {
      line[strcspn(line, "\r\n")] = '\0';
      if (*line && !*text) memcpy(text, line, sizeof text);
    }
  }
  return strut_fail(error, STRUT_FILE_TROUBLE, "ffmpeg could not write '%s': %s",
                    encoder->file.path, *text ? text : "it gave no reason");
}

strut_status strut_encoder_frame(strut_encoder *encoder, const unsigned char *pixels, int width,
                                 int height, size_t stride, strut_error *error) {
  bool good = true;
  size_t row = 4 * (size_t)width;
  if (row == stride) {
    good = write_all(encoder->pipe, pixels, row * (size_t)height);
  } else {
    for (int i = 0; i < height && good; i++)
      good = write_all(encoder->pipe, pixels + (size_t)i * stride, row);
  }
  if (good) return STRUT_OK;
  finish_encoding(encoder);
  return complaint(encoder, error);
}

strut_status strut_encoder_end(strut_encoder *encoder, strut_error *error) {
  strut_status status = finish_encoding(encoder) ? STRUT_OK : complaint(encoder, error);
  if (status == STRUT_OK) status = strut_file_commit(&encoder->file, error);
  strut_encoder_abandon(encoder);
  return status;
}

void strut_encoder_abandon(strut_encoder *encoder) {
  if (encoder->process > 0) kill(encoder->process, SIGKILL);
  finish_encoding(encoder);
  if (encoder->messages) fclose(encoder->messages);
  strut_file_abandon(&encoder->file);
  *encoder = (strut_encoder){.pipe = -1};
}

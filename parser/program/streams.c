/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fopencookie is of GNU and musl; TIOCGWINSZ is not in POSIX 2008: without it, COLUMNS gives the width. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include "parser/program/commands.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/run/simulate.h"
#include "parser/language/yaml/text.h"

/* ---- hidden characters ---- */

/* A stream that people read. */
typedef struct reading {
  int descriptor;
  size_t count;
  char held[4]; /* (count) the begin of a character */
} reading;

/* May the held bytes become a character? */
static bool is_begun(const reading *self) {
  unsigned char lead = (unsigned char)self->held[0];
  size_t size = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : lead >= 0xC2 ? 2 : 1;
  for (size_t i = 1; i < self->count; i++)
    if (((unsigned char)self->held[i] & 0xC0) != 0x80) return false;
  return lead <= 0xF4 && self->count < size;
}

/* Moves the first held character, or bad byte, to `to`, where there is space for 16 bytes. */
static size_t show_character(reading *self, char *to) {
  uint32_t code;
  size_t size = strut_text_decode(self->held, self->count, &code);
  int shown = (int)size;
  if (code != STRUT_BAD_CODE && strut_text_hidden(code))
    shown = snprintf(to, 16, code > 0xFFFF ? "\\U%08X" : "\\u%04X", (unsigned)code);
  else
    memcpy(to, self->held, size);
  self->count -= size;
  memmove(self->held, self->held + size, self->count);
  return (size_t)shown;
}

static bool write_whole(int descriptor, const char *bytes, size_t size) {
  while (size > 0) {
    ssize_t done = write(descriptor, bytes, size);
    if (done < 0 && errno != EINTR) return false;
    if (done > 0) bytes += done, size -= (size_t)done;
  }
  return true;
}

static ssize_t write_shown(void *cookie, const char *bytes, size_t size) {
  reading *self = cookie;
  char out[1024];
  size_t used = 0;
  bool whole = true;
  for (size_t i = 0; i < size && whole; i++) {
    self->held[self->count++] = bytes[i];
    while (self->count && !is_begun(self)) used += show_character(self, out + used);
    if (used + 4 * 16 <= sizeof out) continue;
    whole = write_whole(self->descriptor, out, used);
    used = 0;
  }
  return whole && write_whole(self->descriptor, out, used) ? (ssize_t)size : 0;
}

/* A stream in place of a standard one; NULL: that one stays. */
static FILE *open_reading(reading *self, int mode) {
  FILE *stream = fopencookie(self, "w", (cookie_io_functions_t){.write = write_shown});
  if (stream) setvbuf(stream, NULL, mode, BUFSIZ);
  return stream;
}

static void show_hidden(void) {
  static reading out = {.descriptor = STDOUT_FILENO}, messages = {.descriptor = STDERR_FILENO};
  FILE *stream = isatty(STDOUT_FILENO) ? open_reading(&out, _IOLBF) : NULL;
  if (stream) stdout = stream;
  if ((stream = open_reading(&messages, _IONBF))) stderr = stream;
}

/* ---- output ---- */

void strut_streams_open(void) {
  /* Reversed on purpose: using a closed stream must stay an error. */
  static const int modes[] = {O_WRONLY, O_RDONLY, O_RDONLY};
  for (int i = 0; i < 3; i++) {
    if (fcntl(i, F_GETFD) == -1 && errno == EBADF && open("/dev/null", modes[i]) != i) break;
  }
  show_hidden();
}

static void print_output_error(int reason) {
  fprintf(stderr, "strut: error: cannot write to the standard output: %s\n",
          reason ? strerror(reason) : "an earlier write failed");
}

strut_status strut_print(const char *text) {
  errno = 0;
  if (fputs(text, stdout) >= 0 && fflush(stdout) == 0) return STRUT_OK;
  print_output_error(errno);
  return STRUT_FILE_TROUBLE;
}

strut_status strut_print_block(char *text) {
  strut_status status = text ? strut_print(text) : strut_print_out_of_memory();
  strut_release(text);
  return status;
}

strut_status strut_print_report(const strut_arguments *arguments, char *text) {
  bool suppressed = arguments->quiet && !arguments->json && !arguments->csv;
  if (!suppressed || !text) return strut_print_block(text);
  strut_release(text);
  return STRUT_OK;
}

int strut_streams_close(strut_status status) {
  int code = strut_status_exit_code(status);
  errno = 0;
  bool failed = ferror(stdout) != 0;
  if (fflush(stdout) != 0) failed = true;
  int reason = errno;
  if (fclose(stdout) != 0 && !failed) {
    failed = true;
    reason = errno;
  }
  if (!failed || code != 0) return code; /* that failure has been reported */
  print_output_error(reason);
  return strut_status_exit_code(STRUT_FILE_TROUBLE);
}

void strut_print_error(const strut_error *error) {
  fprintf(stderr, "strut: error: %s\n",
          error->message[0] ? error->message : strut_status_text(error->status));
}

strut_status strut_print_failure(strut_status status, const strut_error *error) {
  if (status != STRUT_OK) strut_print_error(error);
  return status;
}

strut_status strut_print_out_of_memory(void) {
  return strut_print_failure(STRUT_NO_MEMORY, &(strut_error){STRUT_NO_MEMORY, ""});
}

static void show_message(void *context, strut_message_kind kind, const char *command,
                         const char *text) {
  (void)context;
  switch (kind) {
    case STRUT_MESSAGE_USAGE: fprintf(stderr, "strut %s: %s\n", command, text); break;
    case STRUT_MESSAGE_ERROR: fprintf(stderr, "strut: error: %s\n", text); break;
    case STRUT_MESSAGE_WARNING: fprintf(stderr, "strut: warning: %s\n", text); break;
    case STRUT_MESSAGE_NOTE: fprintf(stderr, "strut %s: note: %s\n", command, text); break;
    case STRUT_MESSAGE_REMARK: fprintf(stderr, "strut: %s\n", text); break;
    case STRUT_MESSAGE_LINES: fputs(text, stderr); break;
  }
}

const strut_listener *strut_stderr_listener(void) {
  static const strut_listener listener = {NULL, show_message};
  return &listener;
}

/* ---- interrupts ---- */

/* One press may arrive twice: timeout(1), for one, signals the program and then its whole group. */
enum { SAME_PRESS = 300 /* [ms] */ };

/* A signal handler has no context: the only variables of the program that live outside of main. */
static strut_flag interrupted, first_time;

static int milliseconds(void) {
  struct timespec time = {0, 0};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (int)(time.tv_sec % 1000000 * 1000 + time.tv_nsec / 1000000);
}

static void note(int signal_number) {
  int time = milliseconds();
  if (!interrupted) {
    interrupted = 1;
    first_time = time;
  } else if (time < first_time || time - first_time > SAME_PRESS) {
    signal(signal_number, SIG_DFL);
    raise(signal_number); /* takes effect when the handler returns */
  }
}

const strut_flag *strut_interrupt_watch(void) {
  struct sigaction action = {.sa_handler = note, .sa_flags = SA_RESTART};
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  return &interrupted;
}

/* ---- the terminal ---- */

int strut_terminal_columns(int descriptor, int usual) {
#ifdef TIOCGWINSZ
  struct winsize size = {0};
  if (ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return (int)size.ws_col;
#else
  (void)descriptor;
#endif
  const char *text = getenv("COLUMNS");
  long columns = text ? strtol(text, NULL, 10) : 0;
  return columns > 0 && columns < 10000 ? (int)columns : usual;
}

/* ---- progress ---- */

enum { WIDTH = 30, USUAL = 80, BAR_ROOM = WIDTH + 1, TEXT = 128, LEAST = 8 };

/* Runs shorter than this show no bar [s]. */
static const double PATIENCE = 0.5;

strut_progress strut_progress_begin(bool quiet) {
  const char *no_colour = getenv("NO_COLOR"), *terminal = getenv("TERM");
  bool plain = (no_colour && *no_colour) || !terminal || strcmp(terminal, "dumb") == 0;
  return (strut_progress){
      .wanted = !quiet && isatty(STDERR_FILENO),
      .colour = !plain,
      .start = strut_run_clock(),
      .columns = strut_terminal_columns(STDERR_FILENO, USUAL),
  };
}

/* "46.2 of 110 s, ", in the unit of the whole; empty where no time passes. */
static void write_simulated(char *text, size_t size, double fraction, double span) {
  static const char *const units[] = {"s", "ms", "us"};
  int unit = 0;
  *text = '\0';
  if (!(span > 0)) return;
  for (; unit < 2 && span < 1; unit++) span *= 1000;
  snprintf(text, size, "%.1f of %.5g %s, ", fraction * span, span, units[unit]);
}

void strut_progress_bar(char *bar, int width, double fraction) {
  double part = fraction < 0 ? 0 : fraction > 1 ? 1 : fraction;
  int done = (int)(part * width);
  for (int i = 0; i < width; i++) bar[i] = i < done ? '#' : '.';
  bar[width] = '\0';
}

void strut_progress_phase(void *context, const char *name) {
  strut_progress *progress = context;
  progress->phase = name;
  progress->run_start = strut_run_clock();
  progress->last = 0;
}

/* ", up to 12 s left in this run": a run may stop early; what follows it is unknown. Empty at first. */
static void write_run_left(strut_progress *progress, double fraction, char *text, size_t size) {
  char left[STRUT_DURATION_TEXT];
  if (fraction < progress->last)
    progress->run_start = strut_run_clock(); /* the phase begins another run */
  progress->last = fraction;
  double elapsed = strut_run_clock() - progress->run_start;
  *text = '\0';
  if (elapsed < PATIENCE || !(fraction > 0)) return;
  strut_duration_text(elapsed * (1.0 - fraction) / fraction, left);
  snprintf(text, size, ", up to %s left in this run", left);
}

void strut_progress_show(void *context, double fraction) {
  strut_progress *progress = context;
  char bar[BAR_ROOM], left[STRUT_DURATION_TEXT], simulated[48], run_left[64], text[TEXT];
  double elapsed = strut_run_clock() - progress->start;
  write_run_left(progress, fraction, run_left, sizeof run_left);
  if (elapsed < PATIENCE) return;
  strut_duration_text(fraction > 0 ? elapsed * (1.0 - fraction) / fraction : HUGE_VAL, left);
  write_simulated(simulated, sizeof simulated, fraction, progress->span);
  double percent = floor(100.0 * fraction);
  int length;
  if (progress->phase) { /* the number of runs that follow is unknown */
    strut_duration_text(elapsed, left);
    length = snprintf(text, sizeof text, " %s: %.0f %%, %s so far%s", progress->phase, percent,
                      left, run_left);
  } else {
    length = snprintf(text, sizeof text, " %3.0f %%, %s%s left", percent, simulated, left);
  }
  int room = progress->columns - 1 - length; /* the last column would break the line */
  if (room < LEAST) {
    length = snprintf(text, sizeof text, " %3.0f %%, %s %s", percent, left,
                      progress->phase ? "so far" : "left");
    room = progress->columns - 1 - length;
  }
  int width = room > WIDTH ? WIDTH : room > 0 ? room : 0;
  strut_progress_bar(bar, width, fraction);
  const char *on = progress->colour ? "\033[36m" : "", *off = progress->colour ? "\033[0m" : "";
  int blank = room - width < 6 ? room - width : 6; /* erase the rest of a longer line */
  fprintf(stderr, "\r%s%s%s%.*s", on, bar, off, progress->columns - 1, text);
  if (progress->colour) {
    fprintf(stderr, "\033[K");
  } else if (blank > 0) {
    fprintf(stderr, "%*s", blank, "");
  }
  fflush(stderr);
  progress->shown = true;
}

void strut_progress_end(strut_progress *progress) {
  if (!progress->shown) return;
  if (progress->colour) {
    fprintf(stderr, "\r\033[K");
  } else {
    fprintf(stderr, "\r%*s\r", progress->columns - 1, "");
  }
  fflush(stderr);
  progress->shown = false;
}

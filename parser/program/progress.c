/* SPDX-License-Identifier: GPL-3.0-or-later */
/* TIOCGWINSZ is not in POSIX 2008; without it, COLUMNS gives the width. */
#define _DEFAULT_SOURCE 1
#include "parser/program/progress.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "engine/base/text.h"
#include "engine/run/simulate.h"

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
    if (progress->columns - 1 - length < LEAST)
      length =
          snprintf(text, sizeof text, " %s: %.0f %%, %s so far", progress->phase, percent, left);
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

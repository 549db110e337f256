/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/progress.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { WIDTH = 30, LINE = 79 };

/* A run shorter than this needs no bar [s]. */
static const double PATIENCE = 0.5;

static double now(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

strut_progress strut_progress_begin(bool quiet) {
  const char *no_colour = getenv("NO_COLOR"), *terminal = getenv("TERM");
  bool plain = (no_colour && *no_colour) || !terminal || strcmp(terminal, "dumb") == 0;
  return (strut_progress){
      .wanted = !quiet && isatty(STDERR_FILENO), .colour = !plain, .start = now()};
}

static void write_time(char *text, size_t size, double seconds) {
  double whole = ceil(seconds);
  if (!(whole < 1e7)) {
    snprintf(text, size, "?");
  } else if (whole < 60) {
    snprintf(text, size, "%.0f s", whole);
  } else if (whole < 3600) {
    snprintf(text, size, "%d min %02d s", (int)whole / 60, (int)whole % 60);
  } else {
    snprintf(text, size, "%d h %02d min", (int)whole / 3600, (int)whole / 60 % 60);
  }
}

void strut_progress_show(void *context, double fraction) {
  strut_progress *progress = context;
  char bar[WIDTH + 1] = {0}, left[32];
  double elapsed = now() - progress->start;
  if (elapsed < PATIENCE) return;
  int done = (int)(fraction * WIDTH);
  for (int i = 0; i < WIDTH; i++) bar[i] = i < done ? '#' : '.';
  write_time(left, sizeof left, fraction > 0 ? elapsed * (1.0 - fraction) / fraction : HUGE_VAL);
  const char *on = progress->colour ? "\033[36m" : "", *off = progress->colour ? "\033[0m" : "";
  fprintf(stderr, "\r%s%s%s %3.0f %%, %s left      ", on, bar, off, floor(100.0 * fraction), left);
  fflush(stderr);
  progress->shown = true;
}

void strut_progress_end(strut_progress *progress) {
  if (!progress->shown) return;
  if (progress->colour) {
    fprintf(stderr, "\r\033[K");
  } else {
    fprintf(stderr, "\r%*s\r", LINE, "");
  }
  fflush(stderr);
  progress->shown = false;
}

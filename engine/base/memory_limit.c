/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/base/memory_limit.h"

#include <math.h>
#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>

static double of_process(int resource) {
  struct rlimit limit;
  if (getrlimit(resource, &limit) || limit.rlim_cur == RLIM_INFINITY) return HUGE_VAL;
  return (double)limit.rlim_cur;
}

static double of_machine(void) {
  double page = (double)sysconf(_SC_PAGESIZE), pages = (double)sysconf(_SC_PHYS_PAGES);
  return page > 0 && pages > 0 ? page * pages : HUGE_VAL;
}

/* A container's, where the file is there and holds a number ("max": no limit). */
static double of_group(void) {
  static const char *const files[] = {"/sys/fs/cgroup/memory.max",
                                      "/sys/fs/cgroup/memory/memory.limit_in_bytes"};
  for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
    double bytes = 0.0;
    FILE *file = fopen(files[i], "r");
    int got = file ? fscanf(file, "%lf", &bytes) : 0;
    if (file) fclose(file);
    if (got == 1 && bytes > 0.0) return bytes;
  }
  return HUGE_VAL;
}

double strut_memory_most(const char **whose) {
  const struct {
    double bytes;
    const char *whose;
  } bound[] = {{of_machine(), "the machine has"},
               {of_group(), "the machine has for this container"},
               {of_process(RLIMIT_AS), "the process may have (ulimit -v)"},
               {of_process(RLIMIT_DATA), "the process may have (ulimit -d)"}};
  size_t least = 0;
  for (size_t i = 1; i < sizeof bound / sizeof bound[0]; i++)
    if (bound[i].bytes < bound[least].bytes) least = i;
  *whose = bound[least].whose;
  return bound[least].bytes;
}

/* Smaller requests are not checked: every process has this much. */
static const double ALWAYS = 16e6;

static strut_status say(const char *begin, double bytes, const char *what, strut_error *error) {
  const char *whose;
  double most = strut_memory_most(&whose);
  int digits = bytes < 1e7 ? 2 : 0;
  if (!(most < HUGE_VAL))
    return strut_fail(error, STRUT_NO_MEMORY, "%s%s needs at least %.*f MB of memory", begin, what,
                      digits, bytes / 1e6);
  return strut_fail(error, STRUT_NO_MEMORY,
                    "%s%s needs at least %.*f MB of memory, and %s %.0f MB; simplify the scene or "
                    "allow more",
                    begin, what, digits, bytes / 1e6, whose, most / 1e6);
}

strut_status strut_memory_check(double bytes, const char *what, strut_error *error) {
  const char *whose;
  return bytes <= ALWAYS || bytes <= strut_memory_most(&whose) ? STRUT_OK
                                                               : say("", bytes, what, error);
}

strut_status strut_memory_fail(double bytes, const char *what, strut_error *error) {
  return say("out of memory: ", bytes, what, error);
}

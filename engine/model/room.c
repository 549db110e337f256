/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/room.h"

#include <math.h>
#include <sys/resource.h>
#include <unistd.h>

/* Bytes for each thing, from the tables and matrices that hold it: a little less than
   what chains of X-frames were seen to take, so that nothing is refused that would do. */
static const double PER_NODE = 650.0, PER_MEMBER = 450.0, PER_CONTACT = 100.0;

double strut_room_needed(const strut_scene *scene) {
  return PER_NODE * (double)scene->node_count + PER_MEMBER * (double)scene->member_count +
         PER_CONTACT * (double)(scene->ground.present ? scene->node_count : 0);
}

static double limit_of(int resource) {
  struct rlimit limit;
  if (getrlimit(resource, &limit) || limit.rlim_cur == RLIM_INFINITY) return HUGE_VAL;
  return (double)limit.rlim_cur;
}

strut_status strut_room_check(const strut_scene *scene, strut_error *error) {
  double needed = strut_room_needed(scene), there = HUGE_VAL;
  const char *what = "";
  double page = (double)sysconf(_SC_PAGESIZE), pages = (double)sysconf(_SC_PHYS_PAGES);
  const struct {
    double bytes;
    const char *what;
  } bound[] = {{page > 0 && pages > 0 ? page * pages : HUGE_VAL, "the machine has"},
               {limit_of(RLIMIT_AS), "the process may have (ulimit -v)"},
               {limit_of(RLIMIT_DATA), "the process may have (ulimit -d)"}};
  for (size_t i = 0; i < sizeof bound / sizeof bound[0]; i++)
    if (bound[i].bytes < there) there = bound[i].bytes, what = bound[i].what;
  if (needed <= there) return STRUT_OK;
  return strut_fail(error, STRUT_NO_MEMORY,
                    "a scene of %zu nodes and %zu members needs at least %.0f MB of memory, and %s "
                    "%.0f MB; simplify the scene or allow more",
                    scene->node_count, scene->member_count, needed / 1e6, what, there / 1e6);
}

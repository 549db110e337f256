/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/film/camera.h"

#include <math.h>

/* It follows what moves farther than so many sizes of the structure, in x and in y. */
static const double RANGE[2] = {2.05, 1.6};

/* Means over the neighbours, as many on both sides, from one column of rows of two to another;
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

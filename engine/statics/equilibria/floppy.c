/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/equilibria/floppy.h"

#include <math.h>
#include <string.h>

#include "engine/statics/minimise.h"

/* Nodes that move at least this share of the one that moves most. */
static const double MOVES = 0.1;
/* How far it is pushed, and how far it must stay away, in model sizes. */
static const double PUSHED = 0.02, AWAY = 0.005;

/* A velocity of one node, and a rate of turning about it. */
typedef struct whole {
  int32_t about;
  double shift[2], turn;
} whole;

static double speed(const double *q, const double *mode, const whole *w, int32_t i) {
  double dx = q[2 * i] - q[2 * w->about], dy = q[2 * i + 1] - q[2 * w->about + 1];
  return hypot(mode[2 * i] - w->shift[0] + w->turn * dy,
               mode[2 * i + 1] - w->shift[1] - w->turn * dx);
}

/* Flags the nodes that move besides w; their count. */
static int32_t flag_moving(const strut_model *model, const strut_critical_point *point,
                           const whole *w, uint8_t *flag) {
  double most = 0.0;
  int32_t count = 0;
  for (int32_t i = 0; i < model->node_count; i++)
    most = fmax(most, speed(point->q, point->softest, w, i));
  for (int32_t i = 0; i < model->node_count; i++)
    count += flag[i] = speed(point->q, point->softest, w, i) > MOVES * most;
  return count;
}

/* The rigid motion that goes with node a, and with b as far as turning can. */
static whole going_with(const strut_critical_point *point, bool turns, int32_t a, int32_t b) {
  const double *q = point->q, *mode = point->softest;
  double dx = q[2 * b] - q[2 * a], dy = q[2 * b + 1] - q[2 * a + 1], square = dx * dx + dy * dy;
  whole w = {.about = a, .shift = {mode[2 * a], turns ? mode[2 * a + 1] : 0.0}};
  if (turns && square > 0)
    w.turn = ((mode[2 * b + 1] - mode[2 * a + 1]) * dx - (mode[2 * b] - mode[2 * a]) * dy) / square;
  return w;
}

void strut_floppy_nodes(const strut_model *model, const strut_critical_point *point,
                        uint8_t *flag) {
  whole still = {0}, best = still;
  int32_t least = flag_moving(model, point, &still, flag);
  bool turns = point->rigid == 3;
  for (int32_t a = 0; a < model->node_count && point->rigid > 0; a++)
    for (int32_t b = 0; b < (turns ? model->node_count : 1); b++) {
      whole w = going_with(point, turns, a, b);
      int32_t count = flag_moving(model, point, &w, flag);
      if (count > 0 && count < least) least = count, best = w;
    }
  flag_moving(model, point, &best, flag);
}

/* The largest distance, rigid motions apart where the whole is free. */
static double moved(const strut_model *model, const strut_critical_point *point, const double *q) {
  double most = 0.0;
  if (point->rigid > 0) return strut_shape_distance(model, point->q, q, false, NULL);
  for (int32_t at = 0; at < 2 * model->node_count; at++)
    most = fmax(most, fabs(q[at] - point->q[at]));
  return most;
}

bool strut_floppy_stays(const strut_potential *p, const strut_critical_point *point) {
  const strut_model *model = p->model;
  size_t length = (size_t)model->length;
  double size = model->size > 0 ? model->size : 1.0, most = 0.0, stiffest = 0.0;
  strut_minimiser *minimiser = NULL;
  double *q = strut_allocate(length, sizeof *q);
  bool good = q && strut_minimiser_create(p, &minimiser, NULL) == STRUT_OK, stays = false;
  for (int32_t at = 0; at < 2 * model->node_count; at++)
    most = fmax(most, fabs(point->softest[at]));
  for (int32_t j = 0; j < model->members.count; j++)
    stiffest = fmax(stiffest, model->members.stiffness[j]);
  double same = 1e-12 * (fabs(point->potential) + stiffest * size * size);
  for (int side = -1; side <= 1 && good && most > 0 && !stays; side += 2) {
    memcpy(q, point->q, length * sizeof *q);
    for (int32_t at = 0; at < 2 * model->node_count; at++)
      q[at] += side * PUSHED * size / most * point->softest[at];
    strut_descent end = strut_minimise(minimiser, q, 0.0);
    stays = end.end == STRUT_DESCENT_REACHED && moved(model, point, q) > AWAY * size &&
            fabs(strut_potential_value(p, q) - point->potential) <= same;
  }
  strut_minimiser_free(minimiser);
  strut_release(q);
  return stays;
}

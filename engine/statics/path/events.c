/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regula falsi with the Illinois correction; each trial is corrected back onto the path. */
#include "engine/statics/path/events.h"

#include <math.h>
#include <string.h>

enum { MOST_TRIALS = 60 };

static const double ZERO = 1e-13;   /* of the measure at the ends */
static const double NARROW = 1e-13; /* of the piece's length */
/* Of the eigenvalue at the ends. Nearer than this Newton's method may leave by the other branch. */
static const double FORK = 1e-8;

double strut_path_measure_switch(strut_path_system *s, const double *y,
                                 const strut_path_piece *piece, int32_t which) {
  (void)piece;
  strut_path_place(s, y, s->q);
  return strut_path_switch_value(s, which, s->q);
}

double strut_path_measure_eigenvalue(strut_path_system *s, const double *y,
                                     const strut_path_piece *piece, int32_t which) {
  (void)piece;
  strut_path_spectrum(s, y, false);
  return gsl_vector_get(s->values, (size_t)which);
}

double strut_path_measure_turn(strut_path_system *s, const double *y, const strut_path_piece *piece,
                               int32_t which) {
  (void)which;
  double *tangent = strut_allocate((size_t)s->n + 1, sizeof *tangent);
  double turn = (double)NAN;
  if (tangent && strut_path_tangent(s, y, piece->tangent, tangent)) turn = tangent[s->n];
  strut_release(tangent);
  return turn;
}

static void blend(const strut_path_system *s, double share, const double *low, const double *high,
                  double *y) {
  for (int32_t i = 0; i <= s->n; i++) y[i] = low[i] + share * (high[i] - low[i]);
}

/* The point of the path at `place` along the tangent, begun between the two ends low and high. */
static bool point_at(strut_path_system *s, const strut_path_piece *piece, double place,
                     double share, const double *low, const double *high, double *y) {
  double value = place;
  blend(s, share, low, high, y);
  for (int32_t i = 0; i <= s->n; i++) value += piece->tangent[i] * piece->from[i];
  return strut_path_correct(s, piece->tangent, value, y) >= 0;
}

double strut_path_locate(strut_path_system *s, const strut_path_piece *piece,
                         strut_path_measure measure, int32_t which, double *y) {
  size_t bytes = ((size_t)s->n + 1) * sizeof *y;
  double at[2] = {0, piece->length}, place = -1;
  double value[2] = {measure(s, piece->from, piece, which), measure(s, piece->to, piece, which)};
  double scale = fmax(fabs(value[0]), fabs(value[1]));
  double near = measure == strut_path_measure_eigenvalue ? FORK : ZERO;
  double *end[2] = {strut_allocate(1, bytes), strut_allocate(1, bytes)};
  if (end[0] && end[1] && value[0] * value[1] <= 0 && scale > 0) {
    memcpy(end[0], piece->from, bytes);
    memcpy(end[1], piece->to, bytes);
    for (int k = 0, last = -1; k < MOST_TRIALS; k++) {
      double share = value[0] / (value[0] - value[1]);
      place = at[0] + share * (at[1] - at[0]);
      bool found = point_at(s, piece, place, share, end[0], end[1], y);
      double now = found ? measure(s, y, piece, which) : (double)NAN;
      if (!found || !(fabs(now) <= 2 * scale)) { /* it left the path */
        blend(s, share, end[0], end[1], y);
        break;
      }
      int side = now * value[1] > 0 || (now == 0 && value[1] != 0) ? 1 : 0;
      at[side] = place, value[side] = now;
      memcpy(end[side], y, bytes);
      if (fabs(now) <= near * scale || at[1] - at[0] <= NARROW * piece->length) {
        share = value[0] / (value[0] - value[1]);
        if (near > ZERO) blend(s, share, end[0], end[1], y);
        break;
      }
      if (side == last) value[1 - side] *= 0.5;
      last = side;
    }
  }
  strut_release(end[0]);
  strut_release(end[1]);
  return place;
}

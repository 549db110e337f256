/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scales that few values do not flatten. See chart.h. */
#include <gsl/gsl_sort_double.h>
#include <math.h>
#include <stdio.h>

#include "engine/base/vec.h"
#include "engine/output/draw/chart.h"

/* Values that take more than this part of a scale are left out of it, if they are few: of all values. */
static const double MOST_OF_RANGE = 0.75, FEW = 0.05;
static const double NOTE_WIDTH = 0.6; /* of the frame; longer notes wrap */
static const double INSET = 3.0;      /* of notes from the frame [pt] */

/* Sorts the finite values to the front. Returns how many there are. */
static size_t sort_finite(double *values, size_t count) {
  size_t kept = 0;
  for (size_t i = 0; i < count; i++)
    if (isfinite(values[i])) values[kept++] = values[i];
  if (kept) gsl_sort(values, 1, kept);
  return kept;
}

double strut_limit_without_outliers(double *magnitudes, size_t count, double other, double share,
                                    strut_beyond *beyond) {
  size_t kept = sort_finite(magnitudes, count), most = (size_t)(share * (double)kept);
  *beyond = (strut_beyond){0};
  if (!kept) return other;
  for (; beyond->above < most && kept > 1; kept--) {
    double rest = fmax(magnitudes[kept - 2], other);
    if (!(magnitudes[kept - 1] * (1 - MOST_OF_RANGE) > rest) || !(rest > 0)) break;
    if (!beyond->above++) beyond->farthest = magnitudes[kept - 1];
  }
  return fmax(magnitudes[kept - 1], other);
}

void strut_range_without_outliers(double *values, size_t count, double *low, double *high,
                                  strut_beyond *beyond) {
  size_t kept = sort_finite(values, count), most = (size_t)(FEW * (double)kept), best = 0;
  double least = HUGE_VAL;
  *beyond = (strut_beyond){0};
  if (!kept) return;
  for (size_t below = 0; below <= most; below++) { /* so many at the lower end, the others above */
    double range = values[kept - 1 - (most - below)] - values[below];
    if (range < least) least = range, best = below;
  }
  double whole = values[kept - 1] - values[0];
  if (!(least < (1 - MOST_OF_RANGE) * whole) || !(least > 0)) return;
  /* The rest of the values decides; of those left out, which still fit into its neighbourhood stay. */
  *low = values[best], *high = values[kept - 1 - (most - best)];
  for (size_t i = best; i-- > 0 && values[i] >= *low - 0.5 * least;) *low = values[i];
  for (size_t i = kept - (most - best); i < kept && values[i] <= *high + 0.5 * least; i++)
    *high = values[i];
  for (size_t i = 0; i < kept; i++) {
    if (values[i] >= *low && values[i] <= *high) continue;
    beyond->below += values[i] < *low;
    beyond->above += values[i] > *high;
    if (fabs(values[i]) > fabs(beyond->farthest)) beyond->farthest = values[i];
  }
}

const char *strut_beyond_text(const strut_beyond *beyond, const char *what, const char *unit,
                              char text[STRUT_BEYOND_TEXT]) {
  size_t count = beyond->below + beyond->above;
  text[0] = '\0';
  if (count)
    snprintf(text, STRUT_BEYOND_TEXT, "%zu %s%s beyond the scale, up to %s", count, what,
             count > 1 ? "s" : "",
             strut_drawn_quantity(beyond->farthest, 3, unit ? unit : "").text);
  return text;
}

void strut_draw_beyond(strut_canvas *canvas, const double at[2], strut_side side, double outside) {
  static const double outwards[][2] = {{0, -1}, {0, 1}, {-1, 0}, {1, 0}};
  const double *out = outwards[side], size = STRUT_BEYOND_SIZE;
  double tip[3][2];
  for (int d = 0; d < 2; d++) {
    double across = 0.45 * size * out[1 - d];
    tip[0][d] = at[d] + outside * out[d];
    tip[1][d] = tip[0][d] - size * out[d] + across;
    tip[2][d] = tip[0][d] - size * out[d] - across;
  }
  const strut_fill fill = {.colour = strut_grey(0.15)};
  const strut_pen rim = {.colour = strut_grey(1), .width = 0.4};
  strut_draw_polygon(canvas, (const double(*)[2])tip, 3, &fill, &rim);
}

void strut_draw_axis_note(strut_canvas *canvas, const strut_axes *axes, const char *text) {
  const strut_box *box = &axes->frame;
  const strut_box inside = {box->x + INSET, box->y + INSET, box->width - 2 * INSET,
                            box->height - 2 * INSET};
  strut_draw_label(canvas, &(strut_label){.text = text,
                                          .font = {.size = 7,
                                                   .colour = strut_grey(0.3),
                                                   .halo = strut_grey(1),
                                                   .width = NOTE_WIDTH * box->width},
                                          .at = {box->x + box->width, box->y},
                                          .gap = 2,
                                          .angle = 1.25 * STRUT_PI,
                                          .inside = inside,
                                          .priority = 3,
                                          .loose = true});
}

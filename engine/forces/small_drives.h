/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: driven rest lengths of a small model for many instants at once.
 */
#ifndef STRUT_ENGINE_FORCES_SMALL_DRIVES_H
#define STRUT_ENGINE_FORCES_SMALL_DRIVES_H

#include "engine/forces/signal_vector.h"
#include "engine/forces/small_balance.h"

enum { SMALL_STEPS = 16, SMALL_INSTANTS = 2 * SMALL_STEPS + 4 }; /* whole groups of 4 */

/*
 * row[j] = x, by a store as wide as the loads that the law of members makes: one that has to gather a row
 * from several stores waits until these have left the processor's queue, and with them all that came before.
 */
STRUT_SMALL_INLINE void small_put(double *row, int32_t j, double x) {
  static const int64_t one[2 * STRUT_SMALL_SLOTS] = {[STRUT_SMALL_SLOTS] = -1};
  int32_t from = j / SMALL_WIDTH * SMALL_WIDTH;
  const int64_t *at = one + STRUT_SMALL_SLOTS - (j - from);
  if (from < 8) {
    small_store(row + from,
                small_choose(small_mask_load(at), small_all(x), small_load(row + from)));
    return;
  }
  strut_lane_mask there = (strut_lane_mask)_mm256_loadu_si256((const __m256i *)at);
  small4_store(row + from, small4_choose(there, _mm256_set1_pd(x), small4_load(row + from)));
}

/* The drives' share of rest lengths at `count` times; rows have the other members' already. */
STRUT_SMALL_INLINE void small_drive(const strut_model *model, const double *time, int32_t count,
                                    small_rest *rows) {
  const strut_drive_table *d = &model->drives;
  double value[SMALL_INSTANTS], rate[SMALL_INSTANTS];
  for (int32_t i = 0; i < d->count; i++) {
    int32_t j = d->member[i];
    double natural = model->members.rest[j];
    signal_at_times(model->scene->signals, d->signal[i], time, count, value, rate);
    for (int32_t h = 0; h < count && d->first[i]; h++)
      small_put(rows[h].rest, j, natural + value[h]), small_put(rows[h].rate, j, rate[h]);
    for (int32_t h = 0; h < count && !d->first[i]; h++) {
      small_put(rows[h].rest, j, rows[h].rest[j] + value[h]);
      small_put(rows[h].rate, j, rows[h].rate[j] + rate[h]);
    }
  }
}

#endif

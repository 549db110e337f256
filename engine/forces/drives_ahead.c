/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/drives_ahead.h"

#include "engine/forces/signal_lanes.h"

STRUT_CLONES
static void evaluate_ahead(const strut_model *model, strut_drives_ahead *drives) {
  const strut_drive_table *d = &model->drives;
  for (int32_t i = 0; i < d->count; i++)
    signal_at_times(model->scene->signals, d->signal[i], drives->time, drives->count,
                    drives->value[i], drives->rate[i]);
}

void strut_drives_ahead_evaluate(const strut_model *model, strut_drives_ahead *drives,
                                 int32_t count) {
  drives->next = 0;
  drives->count = count;
  evaluate_ahead(model, drives);
}

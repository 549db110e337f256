/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>

#include "engine/base/c_locale.h"
#include "engine/base/number_text.h"
#include "engine/output/buffer.h"
#include "engine/output/report/reports.h"
#include "engine/output/result_values.h"

enum { MOST_ROWS = 40, DIGITS = 6 };

static bool grows(const strut_waves *w) { return w->band[0].low.frequency < 0.0; }

static void add_head(strut_buffer *table, const strut_model *model, const strut_waves *w) {
  const char *name = model->scene->name;
  strut_buffer_add(table, "%s%swaves at %s, over ", name, *name ? ": " : "", w->at);
  for (int32_t k = 0; k < w->steps; k++)
    strut_buffer_add(table, "%s[%g m, %g m]", k ? " and " : "", model->scene->lattice[k][0],
                     model->scene->lattice[k][1]);
  strut_buffer_add(table, "\n  %d coordinates in a cell, %d node%s of the next cells; ",
                   (int)w->band_count, (int)w->images, w->images == 1 ? "" : "s");
  strut_buffer_add(table, "%zu samples of the wave vector\n", w->count + w->inside);
  strut_buffer_add(table, "  equilibrium %s from that shape, residual force %s\n",
                   strut_quantity_of(w->moved, 3, "m").text,
                   strut_quantity_of(w->residual, 2, "N").text);
  if (grows(w))
    strut_buffer_add(table,
                     "  frequencies below zero: the wave grows, the structure is unstable\n");
  for (int32_t k = 0; k < w->steps && w->acoustic; k++) {
    strut_buffer_add(table, "  long waves%s ",
                     w->steps == 1 ? ""
                     : k           ? " across step 1"
                                   : " across step 2");
    for (int32_t b = 0; b < w->acoustic; b++)
      strut_buffer_add(table, "%s%s", b ? " and " : "at ",
                       strut_quantity_of(w->speed[k][b], DIGITS, "m/s").text);
    strut_buffer_add(table, "\n");
  }
}

char *strut_waves_table(const strut_model *model, const strut_waves *w) {
  strut_c_locale locale = strut_c_locale_enter();
  strut_buffer table = {0};
  add_head(&table, model, w);
  strut_values_add_tables(&table, &strut_waves_values,
                          &(strut_result_object){w, NULL, model->scene, 0},
                          &(strut_table_limits){MOST_ROWS, DIGITS});
  if (!w->gap_count) strut_buffer_add(&table, "\n  no gap: bands meet or overlap\n");
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}

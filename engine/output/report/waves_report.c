/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>

#include "engine/base/c_locale.h"
#include "engine/base/number_text.h"
#include "engine/output/buffer.h"
#include "engine/output/report/reports.h"

enum { MOST_ROWS = 40, DIGITS = 6 };

static const char *hertz(double value, strut_rounded_quantity *text) {
  *text = strut_quantity_of(value, DIGITS, "Hz");
  return text->text;
}

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
  strut_rounded_quantity low, high, wide;
  add_head(&table, model, w);
  strut_buffer_add(&table, "\n  %4s %14s %14s\n", "band", "lowest", "highest");
  for (int32_t b = 0; b < w->shown && b < MOST_ROWS; b++)
    strut_buffer_add(&table, "  %4d %14s %14s\n", (int)b + 1, hertz(w->band[b].low.frequency, &low),
                     hertz(w->band[b].high.frequency, &high));
  if (w->shown > MOST_ROWS)
    strut_buffer_add(&table, "  ... and %d more; --json lists all\n", (int)w->shown - MOST_ROWS);
  strut_buffer_add(&table, w->gap_count ? "\n" : "\n  no gap: bands meet or overlap\n");
  for (size_t g = 0; g < w->gap_count; g++) {
    const strut_wave_gap *gap = &w->gaps[g];
    strut_buffer_add(&table, "  gap %s band %d: %s to %s, %s wide\n",
                     gap->below ? "above" : "under", gap->below ? (int)gap->below : 1,
                     hertz(gap->low, &low), hertz(gap->high, &high),
                     hertz(gap->high - gap->low, &wide));
  }
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}

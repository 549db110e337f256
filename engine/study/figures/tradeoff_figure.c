/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The diagram of a study: settings of the unchanged model, and what models are worth. */
#include <math.h>

#include "engine/output/figures/work_precision.h"
#include "engine/study/tradeoff/tradeoff.h"
#include "engine/study/tradeoff/tradeoff_parts.h"

enum { MOST_GROUPS = 64 };
static const double BEYOND = 10; /* an error of which nothing can be said but that it is one */

/* A panel being gathered. */
typedef struct panel {
  strut_saving *savings;
  size_t count;
  const char *groups[MOST_GROUPS];
  size_t group_count;
  strut_figure *figure;
} panel;

static void add_group(panel *self, const char *name) {
  self->groups[self->group_count++] = strut_figure_text(self->figure, "%s", name);
}

/* A point of the diagram, and one more at the upper edge where some of its runs diverged. */
static void add_saving(panel *self, const strut_tradeoff *tradeoff, const strut_tradeoff_row *row,
                       const strut_spread *spread, bool label) {
  char text[STRUT_TRADEOFF_TEXT];
  strut_saving lost = {.group = (int)self->group_count - 1,
                       .cost = row->evaluations,
                       .error = HUGE_VAL,
                       .low = (double)NAN,
                       .high = (double)NAN};
  strut_saving saving = lost;
  bool gone = !(spread->median <= BEYOND);
  const double *errors = spread == &row->total_spread ? row->total : row->error;
  if (label)
    saving.label = strut_figure_text(self->figure, "%s", strut_tradeoff_step_text(row, text));
  if (!gone) saving.error = spread->median;
  if (!gone && tradeoff->point_count > 1) {
    saving.low = saving.high = spread->median;
    for (size_t k = 0; k < tradeoff->point_count && !(spread->worst <= BEYOND); k++)
      if (errors[k] <= BEYOND) saving.high = fmax(saving.high, errors[k]);
    if (spread->worst <= BEYOND) saving.high = spread->worst;
  }
  self->savings[self->count++] = saving;
  if (row->diverged && !gone) self->savings[self->count++] = lost;
}

/* Step errors of the unchanged model, a group for each method. */
static void fill_methods(panel *self, const strut_tradeoff *tradeoff) {
  int last = -1;
  for (size_t i = 0; i < tradeoff->row_count; i++) {
    const strut_tradeoff_row *row = &tradeoff->rows[i];
    char text[STRUT_TRADEOFF_TEXT];
    if (row->variant != 0) continue;
    if (row->group != last && self->group_count == MOST_GROUPS) break;
    if (row->group != last) add_group(self, strut_tradeoff_group_text(row, text));
    last = row->group;
    add_saving(self, tradeoff, row, &row->error_spread, row->front);
  }
}

static bool on_total_front(const strut_tradeoff *tradeoff, const strut_tradeoff_row *row) {
  if (!(row->total_spread.worst <= BEYOND)) return false;
  for (size_t i = 0; i < tradeoff->row_count; i++) {
    const strut_tradeoff_row *tradeoff_row = &tradeoff->rows[i];
    if (tradeoff_row->variant == row->variant && tradeoff_row->evaluations <= row->evaluations &&
        tradeoff_row->total_spread.worst < row->total_spread.worst)
      return false;
  }
  return true;
}

/* Total errors, a group for each model with those of its rows that no other of it beats, by cost. */
static void fill_models(panel *self, const strut_tradeoff *tradeoff) {
  for (size_t v = 0; v < tradeoff->variant_count; v++) {
    if (!tradeoff->variants[v].run) continue;
    add_group(self, tradeoff->variants[v].name);
    const strut_tradeoff_row *next = NULL;
    for (double done = 0;; done = next->evaluations) {
      next = NULL;
      for (size_t i = 0; i < tradeoff->row_count; i++) {
        const strut_tradeoff_row *row = &tradeoff->rows[i];
        if (row->variant != (int)v || !(row->evaluations > done) || !on_total_front(tradeoff, row))
          continue;
        if (!next || row->evaluations < next->evaluations) next = row;
      }
      if (!next) break;
      add_saving(self, tradeoff, next, &next->total_spread, false);
    }
  }
}

strut_status strut_tradeoff_figure(const strut_plot *plot, const strut_tradeoff *tradeoff,
                                   strut_error *error) {
  static const char *const titles[] = {"Methods: unchanged model (beyond 1000 %: diverged)",
                                       "Models: cheapest method for each error"};
  strut_figure figure = {0};
  size_t models = 0;
  char text[3 * STRUT_TRADEOFF_TEXT];
  const char *cost = strut_figure_text(&figure, "cost in force evaluations, %s = 1",
                                       strut_tradeoff_base_text(tradeoff, text));
  for (size_t i = 0; i < tradeoff->variant_count; i++) models += tradeoff->variants[i].run ? 1 : 0;
  for (int i = 0; i < (models > 1 ? 2 : 1); i++) {
    panel self = {.figure = &figure};
    const char *measure = strut_figure_text(&figure, "%s error of the %s%s", i ? "total" : "step",
                                            strut_tradeoff_measure_text(tradeoff->measure),
                                            tradeoff->point_count > 1 ? ", median to worst" : "");
    self.savings =
        strut_arena_allocate(&figure.arena, 2 * tradeoff->row_count + 1, sizeof *self.savings);
    figure.failed |= !self.savings;
    if (figure.failed) break;
    if (i)
      fill_models(&self, tradeoff);
    else
      fill_methods(&self, tradeoff);
    const strut_work_precision diagram = {.title = titles[i],
                                          .cost = strut_axis_of(cost, ""),
                                          .error = strut_axis_of(measure, ""),
                                          .group_count = self.group_count,
                                          .count = self.count,
                                          .groups = self.groups,
                                          .bargains = self.savings};
    strut_add_work_precision(&figure, &diagram);
  }
  return strut_figure_draw(plot, &figure, error);
}

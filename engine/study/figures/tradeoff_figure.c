/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The diagram of a study: settings of the unchanged model, and what models are worth. */
#include <math.h>

#include "engine/output/figures/work_precision.h"
#include "engine/study/tradeoff/tradeoff.h"
#include "engine/study/tradeoff/tradeoff_parts.h"

static const double BEYOND = 10; /* an error of which nothing can be said but that it is one */

/* The points of a panel being gathered. */
typedef struct gathered {
  const strut_tradeoff *tradeoff;
  strut_saving *savings;
  size_t count;
  strut_figure *figure;
} gathered;

/* A point of the diagram, and one more at the upper edge where some of its runs diverged. */
static void add_saving(gathered *self, const strut_tradeoff_row *row, bool total,
                       const char *group) {
  const strut_spread *spread = total ? &row->total_spread : &row->error_spread;
  const double *errors = total ? row->total : row->error;
  char text[STRUT_TRADEOFF_TEXT];
  strut_saving lost = {.group = group,
                       .cost = row->evaluations,
                       .error = HUGE_VAL,
                       .low = (double)NAN,
                       .high = (double)NAN};
  strut_saving saving = lost;
  bool gone = !(spread->median <= BEYOND);
  if (!total && row->front)
    saving.label = strut_figure_text(self->figure, "%s", strut_tradeoff_step_text(row, text));
  if (!gone) saving.error = spread->median;
  if (!gone && self->tradeoff->point_count > 1) {
    saving.low = saving.high = spread->median;
    for (size_t k = 0; k < self->tradeoff->point_count && !(spread->worst <= BEYOND); k++)
      if (errors[k] <= BEYOND) saving.high = fmax(saving.high, errors[k]);
    if (spread->worst <= BEYOND) saving.high = spread->worst;
  }
  self->savings[self->count++] = saving;
  if (row->diverged && !gone) self->savings[self->count++] = lost;
}

/* Step errors of the unchanged model, a group for each method. */
static void add_methods(gathered *self) {
  const char *name = "";
  int last = -1;
  for (size_t i = 0; i < self->tradeoff->row_count; i++) {
    const strut_tradeoff_row *row = &self->tradeoff->rows[i];
    char text[STRUT_TRADEOFF_TEXT];
    if (row->variant != 0) continue;
    if (row->group != last)
      name = strut_figure_text(self->figure, "%s", strut_tradeoff_group_text(row, text));
    last = row->group;
    add_saving(self, row, false, name);
  }
}

static bool on_total_front(const strut_tradeoff *tradeoff, const strut_tradeoff_row *row) {
  if (!(row->total_spread.worst <= BEYOND)) return false;
  for (size_t i = 0; i < tradeoff->row_count; i++) {
    const strut_tradeoff_row *other = &tradeoff->rows[i];
    if (other->variant == row->variant && other->evaluations <= row->evaluations &&
        other->total_spread.worst < row->total_spread.worst)
      return false;
  }
  return true;
}

/* Total errors, a group for each model with those of its rows that no other of it beats, by cost. */
static void add_models(gathered *self) {
  const strut_tradeoff *tradeoff = self->tradeoff;
  for (size_t v = 0; v < tradeoff->variant_count; v++) {
    const strut_tradeoff_row *next = NULL;
    for (double done = 0; tradeoff->variants[v].run; done = next->evaluations) {
      next = NULL;
      for (size_t i = 0; i < tradeoff->row_count; i++) {
        const strut_tradeoff_row *row = &tradeoff->rows[i];
        if (row->variant == (int)v && row->evaluations > done &&
            (!next || row->evaluations < next->evaluations) && on_total_front(tradeoff, row))
          next = row;
      }
      if (!next) break;
      add_saving(self, next, true, tradeoff->variants[v].name);
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
    gathered g = {.figure = &figure, .tradeoff = tradeoff};
    const char *measure = strut_figure_text(&figure, "%s error of the %s%s", i ? "total" : "step",
                                            strut_tradeoff_measure_text(tradeoff->measure),
                                            tradeoff->point_count > 1 ? ", median to worst" : "");
    g.savings = strut_arena_allocate(&figure.arena, 2 * tradeoff->row_count + 1, sizeof *g.savings);
    figure.failed |= !g.savings;
    if (figure.failed) break;
    (i ? add_models : add_methods)(&g);
    strut_add_work_precision(&figure, strut_axis_of(cost, ""), strut_axis_of(measure, ""),
                             g.savings, g.count)
        ->title = titles[i];
  }
  return strut_figure_draw(plot, &figure, error);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The diagram of a study: settings of the unchanged model, and what models are worth. */
#include <math.h>
#include <stdio.h>

#include "engine/base/c_locale.h"
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
  strut_arena *arena;
} panel;

static bool add_group(panel *p, const char *name) {
  p->groups[p->group_count] = strut_arena_format(p->arena, "%s", name);
  return p->groups[p->group_count++] != NULL;
}

/* A point of the diagram, and one more at the upper edge where some of its runs diverged. */
static bool add_saving(panel *p, const strut_tradeoff *r, const strut_tradeoff_row *row,
                       const strut_spread *spread, bool label) {
  char text[STRUT_TRADEOFF_TEXT];
  strut_saving lost = {.group = (int)p->group_count - 1,
                       .cost = row->evaluations,
                       .error = HUGE_VAL,
                       .low = (double)NAN,
                       .high = (double)NAN};
  strut_saving saving = lost;
  bool gone = !(spread->median <= BEYOND);
  const double *errors = spread == &row->total_spread ? row->total : row->error;
  if (label) saving.label = strut_arena_format(p->arena, "%s", strut_tradeoff_step_text(row, text));
  if (!gone) saving.error = spread->median;
  if (!gone && r->point_count > 1) {
    saving.low = saving.high = spread->median;
    for (size_t k = 0; k < r->point_count && !(spread->worst <= BEYOND); k++)
      if (errors[k] <= BEYOND) saving.high = fmax(saving.high, errors[k]);
    if (spread->worst <= BEYOND) saving.high = spread->worst;
  }
  p->savings[p->count++] = saving;
  if (row->diverged && !gone) p->savings[p->count++] = lost;
  return !label || saving.label;
}

/* Step errors of the unchanged model, a group for each method. */
static bool fill_methods(panel *p, const strut_tradeoff *r) {
  int last = -1;
  for (size_t i = 0; i < r->row_count; i++) {
    const strut_tradeoff_row *row = &r->rows[i];
    char text[STRUT_TRADEOFF_TEXT];
    if (row->variant != 0) continue;
    if (row->group != last && p->group_count == MOST_GROUPS) break;
    if (row->group != last && !add_group(p, strut_tradeoff_group_text(row, text))) return false;
    last = row->group;
    if (!add_saving(p, r, row, &row->error_spread, row->front)) return false;
  }
  return true;
}

static bool on_total_front(const strut_tradeoff *r, const strut_tradeoff_row *a) {
  if (!(a->total_spread.worst <= BEYOND)) return false;
  for (size_t i = 0; i < r->row_count; i++) {
    const strut_tradeoff_row *b = &r->rows[i];
    if (b->variant == a->variant && b->evaluations <= a->evaluations &&
        b->total_spread.worst < a->total_spread.worst)
      return false;
  }
  return true;
}

/* Total errors, a group for each model with those of its rows that no other of it beats, by cost. */
static bool fill_models(panel *p, const strut_tradeoff *r) {
  for (size_t v = 0; v < r->variant_count; v++) {
    if (!r->variants[v].run) continue;
    if (!add_group(p, r->variants[v].name)) return false;
    const strut_tradeoff_row *next = NULL;
    for (double done = 0;; done = next->evaluations) {
      next = NULL;
      for (size_t i = 0; i < r->row_count; i++) {
        const strut_tradeoff_row *row = &r->rows[i];
        if (row->variant != (int)v || !(row->evaluations > done) || !on_total_front(r, row))
          continue;
        if (!next || row->evaluations < next->evaluations) next = row;
      }
      if (!next) break;
      if (!add_saving(p, r, next, &next->total_spread, false)) return false;
    }
  }
  return true;
}

strut_status strut_tradeoff_figure(const strut_plot *plot, const strut_tradeoff *r,
                                   strut_error *error) {
  static const char *const titles[] = {"Methods: unchanged model (beyond 1000 %: diverged)",
                                       "Models: cheapest method for each error"};
  strut_arena arena = {0};
  panel gathered[2] = {{.arena = &arena}, {.arena = &arena}};
  strut_panel panels[2];
  size_t models = 0;
  char text[3 * STRUT_TRADEOFF_TEXT];
  strut_c_locale locale = strut_c_locale_enter();
  const char *cost = strut_arena_format(&arena, "cost in force evaluations, %s = 1",
                                        strut_tradeoff_base_text(r, text));
  for (size_t i = 0; i < r->variant_count; i++) models += r->variants[i].run ? 1 : 0;
  bool fine = cost != NULL;
  for (int i = 0; i < 2 && fine; i++) {
    panel *p = &gathered[i];
    const char *measure = strut_arena_format(&arena, "%s error of the %s%s", i ? "total" : "step",
                                             strut_tradeoff_measure_text(r->measure),
                                             r->point_count > 1 ? ", median to worst" : "");
    p->savings = strut_arena_allocate(&arena, 2 * r->row_count + 1, sizeof *p->savings);
    fine = measure && p->savings && (i ? fill_models(p, r) : fill_methods(p, r));
    const strut_work_precision diagram = {.title = titles[i],
                                          .cost = strut_axis_of(cost, ""),
                                          .error = strut_axis_of(measure, ""),
                                          .group_count = p->group_count,
                                          .count = p->count,
                                          .groups = p->groups,
                                          .bargains = p->savings};
    fine = fine && strut_work_precision_fill(&diagram, &arena, &panels[i]);
  }
  const strut_figure figure = {.panel_count = models > 1 ? 2 : 1, .panels = panels};
  strut_status status =
      fine ? strut_figure_draw(plot, &figure, error) : strut_no_memory(error, "while drawing");
  strut_c_locale_leave(locale);
  strut_arena_free(&arena);
  return status;
}

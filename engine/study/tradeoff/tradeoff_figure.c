/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The diagram of a study: settings of the unchanged model, and what models are worth. */
#include <math.h>
#include <stdio.h>

#include "engine/base/c_locale.h"
#include "engine/output/draw/work_precision.h"
#include "engine/study/tradeoff/tradeoff.h"
#include "engine/study/tradeoff/tradeoff_parts.h"

enum { MOST_GROUPS = 64 };
static const double BEYOND = 10; /* an error of which nothing can be said but that it is one */
static const double EDGE = 4, BETWEEN = 10, ASPECT = 0.62;

/* A panel being gathered. */
typedef struct panel {
  strut_saving *savings;
  size_t count;
  const char *groups[MOST_GROUPS];
  size_t group_count;
} panel;

static bool begin_panel(panel *p, const strut_tradeoff *r, strut_arena *arena) {
  p->savings = strut_arena_allocate(arena, 2 * r->row_count + 1, sizeof *p->savings);
  return p->savings != NULL;
}

/* A point of the diagram, and one more at the upper edge where some of its runs diverged. */
static bool add_saving(panel *p, const strut_tradeoff *r, const strut_tradeoff_row *row, int group,
                       const strut_spread *spread, bool label, strut_arena *arena) {
  char text[STRUT_TRADEOFF_TEXT];
  char *name = label ? strut_arena_format(arena, "%s", strut_tradeoff_step_text(row, text)) : NULL;
  if (label && !name) return false;
  bool gone = !(spread->median <= BEYOND);
  bool many = r->point_count > 1 && !gone;
  double worst = spread->worst;
  if (many && !(worst <= BEYOND)) {
    const double *errors = spread == &row->total_spread ? row->total : row->error;
    worst = spread->median;
    for (size_t k = 0; k < r->point_count; k++)
      if (errors[k] <= BEYOND) worst = fmax(worst, errors[k]);
  }
  p->savings[p->count++] = (strut_saving){.group = group,
                                          .label = name,
                                          .cost = row->evaluations,
                                          .error = gone ? HUGE_VAL : spread->median,
                                          .low = many ? spread->median : (double)NAN,
                                          .high = many ? worst : (double)NAN};
  if (row->diverged && !gone)
    p->savings[p->count++] = (strut_saving){.group = group,
                                            .cost = row->evaluations,
                                            .error = HUGE_VAL,
                                            .low = (double)NAN,
                                            .high = (double)NAN};
  return true;
}

/* Step errors of the unchanged model, a group for each method. */
static bool fill_methods(panel *p, const strut_tradeoff *r, strut_arena *arena) {
  int last = -1;
  for (size_t i = 0; i < r->row_count; i++) {
    const strut_tradeoff_row *row = &r->rows[i];
    char text[STRUT_TRADEOFF_TEXT];
    if (row->variant != 0) continue;
    if (row->group != last) {
      if (p->group_count == MOST_GROUPS) break;
      p->groups[p->group_count] =
          strut_arena_format(arena, "%s", strut_tradeoff_group_text(row, text));
      if (!p->groups[p->group_count++]) return false;
      last = row->group;
    }
    if (!add_saving(p, r, row, (int)p->group_count - 1, &row->error_spread, row->front, arena))
      return false;
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

/* Adds the rows of a model that no other of it beats, by cost. */
static bool add_model(panel *p, const strut_tradeoff *r, int variant, strut_arena *arena) {
  double done = 0;
  for (;;) {
    const strut_tradeoff_row *next = NULL;
    for (size_t i = 0; i < r->row_count; i++) {
      const strut_tradeoff_row *row = &r->rows[i];
      if (row->variant != variant || !(row->evaluations > done)) continue;
      if (!on_total_front(r, row)) continue;
      if (!next || row->evaluations < next->evaluations) next = row;
    }
    if (!next) return true;
    done = next->evaluations;
    if (!add_saving(p, r, next, (int)p->group_count - 1, &next->total_spread, false, arena))
      return false;
  }
}

/* Total errors, a group for each model with the best of its methods. */
static bool fill_models(panel *p, const strut_tradeoff *r, strut_arena *arena) {
  for (size_t f = 0; f < r->variant_count; f++) {
    if (!r->variants[f].run) continue;
    p->groups[p->group_count++] = r->variants[f].name;
    if (!add_model(p, r, (int)f, arena)) return false;
  }
  return true;
}

static strut_status draw_panel(strut_canvas *canvas, strut_box box, const panel *p,
                               const char *title, const char *error, const strut_tradeoff *r) {
  char cost[4 * STRUT_TRADEOFF_TEXT], text[3 * STRUT_TRADEOFF_TEXT];
  snprintf(cost, sizeof cost, "cost in force evaluations, %s = 1",
           strut_tradeoff_base_text(r, text));
  const strut_work_precision diagram = {.title = title,
                                        .cost = {cost, "", true, (double)NAN, (double)NAN},
                                        .error = {error, "", true, (double)NAN, (double)NAN},
                                        .group_count = p->group_count,
                                        .count = p->count,
                                        .groups = p->groups,
                                        .bargains = p->savings};
  return strut_draw_work_precision(canvas, box, &diagram);
}

static strut_status draw(const char *path, double width, const strut_tradeoff *r,
                         const panel panels[2], bool two, strut_error *error) {
  strut_canvas *canvas = NULL;
  char names[2][STRUT_TRADEOFF_TEXT];
  const char *measure = strut_tradeoff_measure_text(r->measure);
  const char *many = r->point_count > 1 ? ", median to worst" : "";
  snprintf(names[0], sizeof names[0], "step error of the %s%s", measure, many);
  snprintf(names[1], sizeof names[1], "total error of the %s%s", measure, many);
  strut_box box = {EDGE, EDGE, width - 2 * EDGE, ASPECT * width};
  double height = (two ? 2 * box.height + BETWEEN : box.height) + 2 * EDGE;
  strut_status status = strut_canvas_open(path, width, height, r->name, &canvas, error);
  if (status != STRUT_OK) return status;
  status = draw_panel(canvas, box, &panels[0], "Methods: unchanged model (beyond 1000 %: diverged)",
                      names[0], r);
  box.y += box.height + BETWEEN;
  if (two && status == STRUT_OK)
    status =
        draw_panel(canvas, box, &panels[1], "Models: cheapest method for each error", names[1], r);
  if (status != STRUT_OK)
    strut_fail(error, status, "out of memory while drawing");
  else
    status = strut_canvas_commit(canvas, error);
  strut_canvas_free(canvas);
  return status;
}

strut_status strut_tradeoff_figure(const char *path, double width, const strut_tradeoff *r,
                                   strut_error *error) {
  strut_arena arena = {0};
  panel panels[2] = {{0}};
  size_t models = 0;
  strut_c_locale locale = strut_c_locale_enter();
  for (size_t i = 0; i < r->variant_count; i++) models += r->variants[i].run ? 1 : 0;
  bool good = begin_panel(&panels[0], r, &arena) && begin_panel(&panels[1], r, &arena) &&
              fill_methods(&panels[0], r, &arena) && fill_models(&panels[1], r, &arena);
  strut_status status = good ? draw(path, width, r, panels, models > 1, error)
                             : strut_no_memory(error, "while drawing");
  strut_c_locale_leave(locale);
  strut_arena_free(&arena);
  return status;
}

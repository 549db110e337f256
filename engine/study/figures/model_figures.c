/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures of models beside each other: of a comparison, and of what models and settings are worth. */
#include "engine/study/compare/compare.h"

#include <gsl/gsl_sort_double.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#include "engine/base/vec.h"
#include "engine/output/draw/figure.h"
#include "engine/study/tradeoff/tradeoff.h"
#include "engine/study/tradeoff/tradeoff_parts.h"

static const double MARGIN = 16, NARROWEST = 150, ASPECT = 0.6; /* [pt], [1] */
static const double FOOT = 0.08; /* space for a scale bar, relative to the extent */
static const double UNLIKE = 4.0;
enum { DRIVEN = STRUT_CABLE + 1 /* beside the kinds of members */ };

typedef struct sheet {
  const strut_compare_column *columns; /* (count) */
  size_t count;
  bool alike;     /* the same scale for all */
  double size[2]; /* the largest extents [m] */
  strut_figure figure;
} sheet;

static void find_sizes(sheet *self) {
  double least = HUGE_VAL, most = 0.0;
  for (size_t i = 0; i < self->count; i++) {
    strut_bounds b = strut_bounds_of(self->columns[i].model, self->columns[i].q);
    double extent = strut_bounds_extent(&b);
    least = fmin(least, extent);
    most = fmax(most, extent);
    for (int d = 0; d < 2; d++) self->size[d] = fmax(self->size[d], b.high[d] - b.low[d]);
  }
  self->alike = most <= UNLIKE * least;
}

/* The most important results, as far as they are known, below the name that is not in the title. */
static const char *words_of(sheet *self, const strut_compare_column *column) {
  static const struct {
    strut_compare_quantity of;
    const char *before, *text;
  } shown[] = {{STRUT_COMPARE_NODES, "", "nodes"},
               {STRUT_COMPARE_MEMBERS, ", ", "members"},
               {STRUT_COMPARE_MASS, ", ", "mass"},
               {STRUT_COMPARE_STATES, "\n", "stable states"},
               {STRUT_COMPARE_FREQUENCY_1, "\n", "lowest frequency"},
               {STRUT_COMPARE_VELOCITY, "\n", "velocity"},
               {STRUT_COMPARE_TRANSPORT, ", ", "cost of transport"}};
  const char *name = column->model->scene->name;
  if (*self->figure.title || strcasecmp(name, column->input->label) == 0) name = "";
  const char *words = strut_figure_text(&self->figure, "%s%s", name, *name ? "\n" : "");
  for (size_t i = 0; i < sizeof shown / sizeof *shown; i++) {
    double value = column->cell[shown[i].of].value;
    const char *unit = strut_compare_row_of(shown[i].of).unit;
    strut_file_unit gram = {strcmp(unit, "kg") == 0 && value < 1 ? "g" : NULL, 1e-3};
    if (shown[i].of == STRUT_COMPARE_VELOCITY && column->still) value = 0;
    if (isfinite(value))
      words = strut_figure_text(&self->figure, "%s%s%s %s", words, shown[i].before, shown[i].text,
                                strut_quantity_shown(value, 3, *unit ? unit : "1", gram).text);
  }
  return words;
}

static void add_panel(sheet *self, const strut_compare_column *column) {
  strut_panel *panel = strut_add_panel(&self->figure);
  panel->title = column->input->label;
  panel->note = words_of(self, column);
  panel->bounds = strut_bounds_of(column->model, column->q);
  /* The structure's own extent, or the largest of all about its middle and from its foot on. */
  if (self->alike)
    strut_bounds_share(&panel->bounds, self->size);
  else
    panel->bounds.low[1] -= FOOT * strut_bounds_extent(&panel->bounds);
  panel->margin = MARGIN;
  panel->yardstick = !self->alike;
  strut_shape *shape = strut_add_shape(&self->figure, panel, column->model, column->q);
  shape->ground = shape->names = true;
}

/* The kinds of members that are there, and those that are driven. */
static void add_keys(sheet *self) {
  static const char *const kinds[] = {
      [STRUT_BAR] = "bar", [STRUT_SPRING] = "spring", [STRUT_CABLE] = "cable", [DRIVEN] = "driven"};
  for (int k = 0; k <= DRIVEN; k++)
    for (const strut_compare_column *c = self->columns; c < self->columns + self->count; c++)
      for (size_t j = 0; j < c->model->scene->member_count; j++) {
        strut_member_kind kind = c->model->scene->members[j].kind;
        bool driven = strut_member_is_driven(c->model->scene, j);
        if ((driven ? DRIVEN : (int)kind) == k)
          strut_add_key(&self->figure, STRUT_KEY_LINE, strut_kind_pen(kind, driven), kinds[k]);
      }
}

/* The name of all scenes; "" where they differ. */
static const char *common_name(const sheet *self) {
  const char *name = self->columns[0].model->scene->name;
  for (size_t i = 1; i < self->count; i++)
    if (strcmp(self->columns[i].model->scene->name, name) != 0) return "";
  return name;
}

strut_status strut_compare_figure(const strut_plot *plot, const strut_compare *result, size_t first,
                                  size_t count, strut_error *error) {
  sheet s = {.columns = result->columns + first,
             .count = count,
             .figure = {.least_width = NARROWEST, .aspect = ASPECT}};
  find_sizes(&s);
  s.figure.title = common_name(&s);
  for (size_t i = 0; i < count; i++) add_panel(&s, &s.columns[i]);
  add_keys(&s);
  s.figure.yardstick = s.alike;
  return strut_figure_draw(plot, &s.figure, error);
}

/* The diagram of a study: settings of the unchanged model, and what models are worth. */

static const double BEYOND = 10; /* an error of which nothing can be said but that it is one */

typedef struct diagram {
  const strut_tradeoff *tradeoff;
  strut_figure figure;
} diagram;

static strut_panel *add_diagram(diagram *self, const char *title) {
  const strut_tradeoff *tradeoff = self->tradeoff;
  char text[3 * STRUT_TRADEOFF_TEXT];
  strut_panel *panel = strut_add_panel(&self->figure);
  panel->title = title;
  panel->x = strut_axis_of(strut_figure_text(&self->figure, "cost in force evaluations, %s = 1",
                                             strut_tradeoff_base_text(tradeoff, text)),
                           "");
  panel->y = strut_axis_of(strut_figure_text(&self->figure, "error of the %s%s",
                                             strut_tradeoff_measure_text(tradeoff->measure),
                                             tradeoff->point_count > 1 ? ": median to worst" : ""),
                           "");
  panel->x.logarithmic = panel->y.logarithmic = true;
  panel->room = 0.06;
  return panel;
}

/* Adds a row to the line of that name, and a point at the upper edge where some of its runs diverged. */
static void add_setting(diagram *self, strut_panel *panel, const char *name, const char *step,
                        const strut_tradeoff_row *row, const strut_spread *spread) {
  strut_figure *figure = &self->figure;
  bool gone = !(spread->median <= BEYOND), lost = gone || row->diverged;
  strut_series *line = panel->series;
  while (line < panel->series + panel->series_count && strcmp(line->label, name) != 0) line++;
  if (line == panel->series + panel->series_count) line = strut_add_series(figure, panel, name);
  if (!gone) {
    strut_point *point = strut_add_point(figure, line, row->evaluations, spread->median);
    if (self->tradeoff->point_count > 1) point->low = point->high = spread->median;
    for (size_t k = 0; k < spread->count && isfinite(point->high); k++)
      if (spread->values[k] <= BEYOND) point->high = fmax(point->high, spread->values[k]);
    if (*step)
      strut_add_mark(figure, panel, row->evaluations, spread->median, step)->angle =
          1.25 * STRUT_PI;
  }
  if (!lost) return;
  strut_add_point(figure, line, (double)NAN, (double)NAN);
  strut_add_point(figure, line, row->evaluations, BEYOND);
  strut_add_point(figure, line, (double)NAN, (double)NAN);
  panel->note = "at the upper edge: diverged";
}

/* The step of a row on the front; with its group where another one on the front has the same. */
static const char *step_of(diagram *self, const strut_tradeoff_row *row, const char *group) {
  const strut_tradeoff *tradeoff = self->tradeoff;
  char own[STRUT_TRADEOFF_TEXT], other[STRUT_TRADEOFF_TEXT];
  bool alike = false;
  if (!row->front) return "";
  strut_tradeoff_step_text(row, own);
  for (const strut_tradeoff_row *r = tradeoff->rows; r < tradeoff->rows + tradeoff->row_count; r++)
    alike = alike || (r != row && r->front && r->variant == row->variant &&
                      strcmp(strut_tradeoff_step_text(r, other), own) == 0);
  return strut_figure_text(&self->figure, alike ? "%s, %s" : "%s", own, group);
}

/* Step errors of the unchanged model, a line for each method. */
static void add_methods(diagram *self) {
  const strut_tradeoff *tradeoff = self->tradeoff;
  char text[STRUT_TRADEOFF_TEXT];
  strut_panel *panel =
      add_diagram(self, "a) Methods: step error of the unchanged model (beyond 1000 %: diverged)");
  for (const strut_tradeoff_row *r = tradeoff->rows; r < tradeoff->rows + tradeoff->row_count;
       r++) {
    const char *group = strut_figure_text(&self->figure, "%s", strut_tradeoff_group_text(r, text));
    if (r->variant == 0)
      add_setting(self, panel, group, step_of(self, r, group), r, &r->error_spread);
  }
}

/* Total errors on the fronts of several models, by cost. */
static void add_models(diagram *self) {
  const strut_tradeoff *tradeoff = self->tradeoff;
  size_t count = tradeoff->row_count, models = 0;
  size_t *order = strut_arena_allocate(&self->figure.arena, count + 1, sizeof *order);
  double *cost = strut_figure_numbers(&self->figure, NULL, count);
  self->figure.failed = self->figure.failed || !order;
  for (size_t v = 0; v < tradeoff->variant_count; v++) models += tradeoff->variants[v].run;
  if (self->figure.failed || models < 2) return;
  strut_panel *panel = add_diagram(self, "b) Models: total error, cheapest method for each");
  for (size_t i = 0; i < count; i++) cost[i] = tradeoff->rows[i].evaluations;
  gsl_sort_index(order, cost, 1, count);
  for (size_t v = 0; v < tradeoff->variant_count; v++)
    for (size_t i = 0; i < count; i++) {
      const strut_tradeoff_row *row = &tradeoff->rows[order[i]];
      if (tradeoff->variants[v].run && row->variant == (int)v && row->total_front)
        add_setting(self, panel, tradeoff->variants[v].name, "", row, &row->total_spread);
    }
}

strut_status strut_tradeoff_figure(const strut_plot *plot, const strut_tradeoff *tradeoff,
                                   strut_error *error) {
  diagram d = {.tradeoff = tradeoff};
  add_methods(&d);
  add_models(&d);
  return strut_figure_draw(plot, &d.figure, error);
}

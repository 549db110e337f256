/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures of models beside each other: of a comparison, and of what models and settings are worth. */
#include "engine/study/compare/compare.h"

#include <math.h>
#include <string.h>
#include <strings.h>

#include "engine/output/draw/figure.h"
#include "engine/output/figures/work_precision.h"
#include "engine/study/tradeoff/tradeoff.h"
#include "engine/study/tradeoff/tradeoff_parts.h"

static const double MARGIN = 16, NARROWEST = 150, ASPECT = 0.6; /* [pt], [1] */
static const double FOOT = 0.08; /* space for a scale bar, relative to the extent */
static const double DOT = 4.0;   /* radius around a node [pt] */
static const double UNLIKE = 4.0;
enum { NAMED = 40, DRIVEN = STRUT_CABLE + 1 /* beside the kinds of members */ };

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

static strut_colour driven_colour(void) { return strut_palette_thing(2); }

/* The segments of driven members, as broad lines that leave their nodes visible. */
static void mark_driven(sheet *self, const strut_compare_column *column, strut_panel *panel) {
  const strut_scene *scene = column->model->scene;
  const strut_pen pens[] = {{.colour = strut_grey(1.0), .width = 4.2},
                            {.colour = driven_colour(), .width = 2.6}};
  for (size_t i = 0; i < scene->actuator_count; i++) {
    if (scene->actuators[i].member < 0) continue;
    const strut_member *member = &scene->members[scene->actuators[i].member];
    for (size_t k = 0; k < 2 * (member->guide_count + 1); k++) {
      const double *from = column->q + 2 * strut_member_node(member, k / 2);
      const double *to = column->q + 2 * strut_member_node(member, k / 2 + 1);
      strut_add_segment(&self->figure, panel, STRUT_TRAIL_LINE, pens[k % 2], from, to)->gap = DOT;
    }
  }
}

/* The most important results, in three lines, below the name that is not in the title. */
static const char *words_of(sheet *self, const strut_compare_column *column) {
  const strut_compare_cell *cell = column->cell;
  double states = cell[STRUT_COMPARE_STATES].value, lowest = cell[STRUT_COMPARE_FREQUENCY_1].value;
  double velocity = cell[STRUT_COMPARE_VELOCITY].value, mass = cell[STRUT_COMPARE_MASS].value;
  double transport = cell[STRUT_COMPARE_TRANSPORT].value;
  strut_figure *figure = &self->figure;
  const char *name = column->model->scene->name;
  if (*figure->title || strcasecmp(name, column->input->label) == 0) name = "";
  const char *words =
      strut_figure_text(figure, "%s%s%.0f nodes, %.0f member%s", name, *name ? "\n" : "",
                        cell[STRUT_COMPARE_NODES].value, cell[STRUT_COMPARE_MEMBERS].value,
                        cell[STRUT_COMPARE_MEMBERS].value == 1 ? "" : "s");
#define ADD(FORMAT, ...) words = strut_figure_text(figure, "%s" FORMAT, words, __VA_ARGS__)
  if (mass > 0) ADD(", %s", strut_quantity_of(1000 * mass, 3, "g").text);
  if (states > 0) ADD("\n%.0f stable state%s", states, states > 1 ? "s" : "");
  if (isfinite(lowest))
    ADD("%slowest frequency %s", states > 0 ? ", " : "\n", strut_quantity_of(lowest, 3, "Hz").text);
  if (column->still)
    ADD("%s", "\nno net motion");
  else if (isfinite(velocity))
    ADD("\n%s", strut_quantity_of(velocity, 3, "m/s").text);
  if (isfinite(transport))
    ADD("%scost of transport %.3g", column->still || isfinite(velocity) ? ", " : "\n", transport);
#undef ADD
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
  shape->ground = true;
  shape->names = column->model->node_count <= NAMED;
  mark_driven(self, column, panel);
}

/* Is a member of the kind, which is not drawn as driven, to be seen in any panel? */
static bool is_seen(const sheet *self, int kind) {
  for (size_t i = 0; i < self->count; i++) {
    const strut_scene *scene = self->columns[i].model->scene;
    for (size_t j = 0; j < scene->member_count; j++) {
      bool driven = false;
      for (size_t k = 0; k < scene->actuator_count; k++)
        driven = driven || scene->actuators[k].member == (int32_t)j;
      if (driven ? kind == DRIVEN : (int)scene->members[j].kind == kind) return true;
    }
  }
  return false;
}

static void add_keys(sheet *self) {
  const struct {
    strut_colour colour;
    double width;
    const char *text;
  } kinds[] = {[STRUT_BAR] = {strut_grey(0.13), 3.0, "bar"},
               [STRUT_SPRING] = {strut_palette_thing(0), 1.4, "spring"},
               [STRUT_CABLE] = {strut_palette_thing(1), 1.0, "cable"},
               [DRIVEN] = {driven_colour(), 2.6, "driven"}};
  for (int k = 0; k <= DRIVEN; k++)
    if (is_seen(self, k))
      strut_add_key(&self->figure, STRUT_KEY_LINE,
                    (strut_pen){.colour = kinds[k].colour, .width = kinds[k].width}, kinds[k].text);
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

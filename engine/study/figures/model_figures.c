/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures of models beside each other: of a comparison, and of what models and settings are worth. */
#include "engine/study/compare/compare.h"

#include <gsl/gsl_sort_double.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#include "engine/output/draw/figure.h"
#include "engine/output/figures/table_figure.h"
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

/* Its columns: texts, then numbers. */
enum { PANEL, GROUP, STEP, COST, ERROR, LOW, HIGH, DRAWN };

typedef struct diagram {
  const strut_tradeoff *tradeoff;
  const char **text[COST];
  double *number[DRAWN];
  strut_table table;
} diagram;

/* Room for a point and a lost one of each row in both panels. False: out of memory. */
static bool begin_diagram(diagram *self, const char *cost, const char *error) {
  const char *const names[] = {" ", "", "step", cost, error, "low", "high"};
  strut_arena *arena = &self->table.arena;
  size_t room = 4 * self->tradeoff->row_count + 1;
  bool fine =
      (self->table.columns = strut_arena_allocate(arena, DRAWN, sizeof(strut_table_column)));
  for (int i = 0; i < DRAWN && fine; i++) {
    strut_table_column *column = &self->table.columns[i];
    *column = (strut_table_column){.name = names[i], .unit = ""};
    if (i < COST)
      column->text = self->text[i] = strut_arena_allocate(arena, room, sizeof(char *));
    else
      column->value = self->number[i] = strut_arena_allocate(arena, room, sizeof(double));
    fine = column->text || column->value;
  }
  self->table.column_count = DRAWN;
  return fine;
}

static void add_point(diagram *self, const char *const text[COST], double cost,
                      const double range[3]) {
  size_t row = self->table.row_count++;
  for (int i = 0; i < COST; i++) self->text[i][row] = text[i];
  self->number[COST][row] = cost;
  for (int i = 0; i < 3; i++) self->number[ERROR + i][row] = range[i];
}

/* A row of the table, and one more at the upper edge where some of its runs diverged. */
static void add_setting(diagram *self, const char *const text[COST], const strut_tradeoff_row *row,
                        bool total) {
  const strut_spread *spread = total ? &row->total_spread : &row->error_spread;
  double range[] = {spread->median, (double)NAN, (double)NAN};
  const double lost[] = {HUGE_VAL, (double)NAN, (double)NAN};
  bool gone = !(spread->median <= BEYOND);
  if (self->tradeoff->point_count > 1) {
    range[1] = range[2] = spread->median;
    for (size_t k = 0; k < spread->count; k++)
      if (spread->values[k] <= BEYOND) range[2] = fmax(range[2], spread->values[k]);
  }
  if (!gone) add_point(self, text, row->evaluations, range);
  if (gone || row->diverged)
    add_point(self, (const char *[]){text[PANEL], text[GROUP], ""}, row->evaluations, lost);
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
  const char *text = strut_arena_format(&self->table.arena, alike ? "%s, %s" : "%s", own, group);
  return text ? text : "";
}

/* Step errors of the unchanged model, a group for each method; total errors on the fronts of models, by cost. */
static bool fill_diagram(diagram *self) {
  const strut_tradeoff *tradeoff = self->tradeoff;
  size_t count = tradeoff->row_count, models = 0;
  size_t *order = strut_arena_allocate(&self->table.arena, count + 1, sizeof *order);
  double *cost = strut_arena_allocate(&self->table.arena, count + 1, sizeof *cost);
  char text[STRUT_TRADEOFF_TEXT];
  if (!order || !cost) return false;
  for (size_t v = 0; v < tradeoff->variant_count; v++) models += tradeoff->variants[v].run;
  for (size_t i = 0; i < count; i++) {
    const strut_tradeoff_row *row = &tradeoff->rows[i];
    const char *group =
        strut_arena_format(&self->table.arena, "%s", strut_tradeoff_group_text(row, text));
    cost[i] = row->evaluations;
    if (!group) return false;
    if (row->variant == 0)
      add_setting(
          self,
          (const char *[]){"Methods: step error of the unchanged model (beyond 1000 %: diverged)",
                           group, step_of(self, row, group)},
          row, false);
  }
  gsl_sort_index(order, cost, 1, count);
  for (size_t v = 0; v < tradeoff->variant_count && models > 1; v++)
    for (size_t i = 0; i < count; i++) {
      const strut_tradeoff_row *row = &tradeoff->rows[order[i]];
      if (tradeoff->variants[v].run && row->variant == (int)v && row->total_front)
        add_setting(self,
                    (const char *[]){"Models: total error, cheapest method for each",
                                     tradeoff->variants[v].name, ""},
                    row, true);
    }
  return true;
}

strut_status strut_tradeoff_figure(const strut_plot *plot, const strut_tradeoff *tradeoff,
                                   strut_error *error) {
  diagram d = {.tradeoff = tradeoff};
  char text[3 * STRUT_TRADEOFF_TEXT];
  const char *cost = strut_arena_format(&d.table.arena, "cost in force evaluations, %s = 1",
                                        strut_tradeoff_base_text(tradeoff, text));
  const char *measure = strut_arena_format(&d.table.arena, "error of the %s%s",
                                           strut_tradeoff_measure_text(tradeoff->measure),
                                           tradeoff->point_count > 1 ? ": median to worst" : "");
  const strut_study_figure figure = {.x = cost,
                                     .y = measure,
                                     .series = "",
                                     .panels = " ",
                                     .thing = "step",
                                     .low = "low",
                                     .high = "high",
                                     .lost = "at the upper edge: diverged",
                                     .apart = true};
  strut_plot scaled = *plot;
  scaled.x.logarithmic = scaled.y.logarithmic = true;
  bool fine = cost && measure && begin_diagram(&d, cost, measure) && fill_diagram(&d);
  strut_status status =
      fine ? strut_table_draw(&scaled, &figure, &d.table, (strut_table_marks){0}, error)
           : strut_no_memory(error, "while drawing");
  strut_arena_free(&d.table.arena);
  return status;
}

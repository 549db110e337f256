/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/compare/compare.h"

#include <math.h>
#include <stdio.h>

#include "engine/base/c_locale.h"
#include "engine/output/draw/figure.h"

static const double MARGIN = 16, NARROWEST = 150, ASPECT = 0.6; /* [pt], [1] */
static const double FOOT = 0.08; /* space for a scale bar, relative to the extent */
static const double DOT = 4.0;   /* radius around a node [pt] */
static const double UNLIKE = 4.0;
enum { NAMED = 40, WORDS = 400, KEYS = 5, DRIVEN = 2 };

typedef struct sheet {
  const strut_compare_column *columns; /* (count) */
  size_t count;
  bool alike;     /* the same scale for all */
  double size[2]; /* the largest extents [m] */
  strut_arena arena;
} sheet;

static strut_bounds bounds_of(const strut_compare_column *column) {
  strut_bounds bounds = strut_bounds_none();
  strut_bounds_add(&bounds, column->model, column->q);
  return bounds;
}

static void find_sizes(sheet *self) {
  double least = HUGE_VAL, most = 0.0;
  for (size_t i = 0; i < self->count; i++) {
    strut_bounds b = bounds_of(&self->columns[i]);
    double extent = strut_bounds_extent(&b);
    least = fmin(least, extent);
    most = fmax(most, extent);
    for (int d = 0; d < 2; d++) self->size[d] = fmax(self->size[d], b.high[d] - b.low[d]);
  }
  self->alike = most <= UNLIKE * least;
}

/* The structure's own extent, or the largest of all about its middle and from its foot on. */
static strut_bounds shown(const sheet *self, const strut_compare_column *column) {
  strut_bounds b = bounds_of(column);
  if (!self->alike) b.low[1] -= FOOT * strut_bounds_extent(&b);
  if (!self->alike) return b;
  double middle = 0.5 * (b.low[0] + b.high[0]);
  b.low[0] = middle - 0.5 * self->size[0];
  b.high[0] = middle + 0.5 * self->size[0];
  b.high[1] = b.low[1] + self->size[1];
  return b;
}

/* The segments of driven members, as broad lines that leave their nodes visible. */
static bool mark_driven(sheet *self, const strut_compare_column *column, strut_view *view) {
  const strut_scene *scene = column->model->scene;
  size_t most = 0;
  for (size_t i = 0; i < scene->actuator_count; i++)
    if (scene->actuators[i].member >= 0)
      most += 2 * strut_member_segments(column->model, (size_t)scene->actuators[i].member);
  strut_trail *trails = strut_arena_allocate(&self->arena, most + 1, sizeof *trails);
  double(*ends)[2] = strut_arena_allocate(&self->arena, most + 1, sizeof *ends);
  if (!trails || !ends) return false;
  for (size_t i = 0; i < scene->actuator_count; i++) {
    if (scene->actuators[i].member < 0) continue;
    const strut_member *member = &scene->members[scene->actuators[i].member];
    for (size_t k = 0; k <= member->guide_count; k++) {
      for (size_t e = 0; e < 2; e++)
        for (int d = 0; d < 2; d++)
          ends[view->trail_count + e][d] = column->q[2 * strut_member_node(member, k + e) + d];
      for (int over = 0; over < 2; over++)
        trails[view->trail_count + (size_t)over] =
            (strut_trail){.count = 2,
                          .at = (const double(*)[2])ends + view->trail_count,
                          .pen = {.colour = over ? strut_palette_thing(DRIVEN) : strut_grey(1.0),
                                  .width = over ? 2.6 : 4.2},
                          .gap = DOT};
      view->trail_count += 2;
    }
  }
  view->trails = trails;
  return true;
}

/* The most important results, in three lines. */
static void words_of(const strut_compare_column *column, char words[WORDS]) {
  const strut_compare_cell *cell = column->cell;
  double states = cell[STRUT_COMPARE_STATES].value, lowest = cell[STRUT_COMPARE_FREQUENCY_1].value;
  double velocity = cell[STRUT_COMPARE_VELOCITY].value, mass = cell[STRUT_COMPARE_MASS].value;
  double transport = cell[STRUT_COMPARE_TRANSPORT].value;
  int used = snprintf(words, WORDS, "%.0f nodes, %.0f members", cell[STRUT_COMPARE_NODES].value,
                      cell[STRUT_COMPARE_MEMBERS].value);
#define ADD(...) used += snprintf(words + used, (size_t)(WORDS - used), __VA_ARGS__)
  if (mass > 0) ADD(", %s", strut_drawn_quantity(1000 * mass, 3, "g").text);
  if (states > 0) ADD("\n%.0f stable state%s", states, states > 1 ? "s" : "");
  if (isfinite(lowest))
    ADD("%slowest frequency %s", states > 0 ? ", " : "\n",
        strut_drawn_quantity(lowest, 3, "Hz").text);
  if (column->still)
    ADD("\nno net motion");
  else if (isfinite(velocity))
    ADD("\n%s", strut_drawn_quantity(velocity, 3, "m/s").text);
  if (isfinite(transport))
    ADD("%scost of transport %.3g", column->still || isfinite(velocity) ? ", " : "\n", transport);
#undef ADD
}

static bool fill_panel(sheet *self, const strut_compare_column *column, strut_panel *panel) {
  char words[WORDS];
  strut_view *view = strut_arena_allocate(&self->arena, 1, sizeof *view);
  strut_shape *shape = strut_arena_allocate(&self->arena, 1, sizeof *shape);
  words_of(column, words);
  *panel = (strut_panel){.title = column->input->label,
                         .note = strut_arena_format(&self->arena, "%s", words),
                         .view = view};
  if (!view || !shape || !panel->note) return false;
  *shape = (strut_shape){.model = column->model,
                         .q = column->q,
                         .style = {.colouring = STRUT_COLOUR_KIND},
                         .ground = true,
                         .names = column->model->node_count <= NAMED};
  *view = (strut_view){.shape_count = 1,
                       .shapes = shape,
                       .bounds = shown(self, column),
                       .margin = MARGIN,
                       .yardstick = !self->alike};
  return mark_driven(self, column, view);
}

static strut_key_item line(strut_colour colour, double width, const char *text) {
  return (strut_key_item){
      .sign = STRUT_KEY_LINE, .pen = {.colour = colour, .width = width}, .text = text};
}

static size_t make_key(const sheet *self, strut_key_item items[KEYS]) {
  const struct {
    strut_compare_quantity quantity;
    strut_key_item item;
  } all[] = {{STRUT_COMPARE_BARS, line(strut_grey(0.13), 3.0, "bar")},
             {STRUT_COMPARE_SPRINGS, line(strut_palette_thing(0), 1.4, "spring")},
             {STRUT_COMPARE_CABLES, line(strut_palette_thing(1), 1.0, "cable")},
             {STRUT_COMPARE_ACTUATORS, line(strut_palette_thing(DRIVEN), 2.6, "driven")}};
  size_t count = 0;
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
    bool any = false;
    for (size_t i = 0; i < self->count; i++)
      any = any || self->columns[i].cell[all[k].quantity].value > 0;
    if (any) items[count++] = all[k].item;
  }
  if (self->alike && self->count > 1)
    items[count++] = (strut_key_item){.sign = STRUT_KEY_WORDS, .text = "same scale"};
  return count;
}

strut_status strut_compare_figure(const strut_plot *plot, const strut_compare *result, size_t first,
                                  size_t count, strut_error *error) {
  sheet s = {.columns = result->columns + first, .count = count};
  strut_key_item items[KEYS];
  strut_panel *panels = strut_arena_allocate(&s.arena, count, sizeof *panels);
  strut_c_locale locale = strut_c_locale_enter();
  bool fine = panels != NULL;
  find_sizes(&s);
  for (size_t i = 0; i < count && fine; i++) fine = fill_panel(&s, &s.columns[i], &panels[i]);
  const strut_figure figure = {.panel_count = count,
                               .panels = panels,
                               .least_width = NARROWEST,
                               .aspect = ASPECT,
                               .yardstick = s.alike,
                               .keys = items,
                               .key_count = make_key(&s, items)};
  strut_status status =
      fine ? strut_figure_draw(plot, &figure, error) : strut_no_memory(error, "while drawing");
  strut_c_locale_leave(locale);
  strut_arena_free(&s.arena);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines over a parameter: stable motions solid, unstable ones dashed, special points marked. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/vec.h"
#include "engine/study/follow/follow_parts.h"
#include "engine/study/follow/follow_study.h"

static const double ASPECT = 0.6;
enum { MOST_NAMES = 40, MOST_KEYS = 18, MOST_LINES = 12, CURVE_KEYS = 4 };

/* ---- pictures of branches ---- */

/* A picture that is filled line by line, point by point. */
typedef struct picture {
  const char *title;
  strut_axis along, upwards;
  size_t line_count, count, mark_count, key_count;
  strut_series *lines;
  strut_pen *pens; /* (line_count) */
  double *x, *y;   /* (count) of all lines */
  bool *unstable;  /* (count) */
  strut_mark *marks;
  strut_key_item keys[MOST_KEYS];
  strut_arena arena;
} picture;

static strut_colour colour_of(strut_follow_kind kind) {
  static const unsigned char thing[STRUT_FOLLOW_KINDS] = {[STRUT_FOLLOW_FOLD] = 6,
                                                          [STRUT_FOLLOW_DOUBLING] = 3,
                                                          [STRUT_FOLLOW_TORUS] = 4,
                                                          [STRUT_FOLLOW_BRANCHING] = 4};
  return thing[kind] ? strut_palette_thing(thing[kind] - 1U) : strut_grey(1.0);
}

static strut_key_item line_key(strut_colour colour, bool unstable, const char *text) {
  strut_key_item item = {
      .sign = STRUT_KEY_LINE, .pen = {.colour = colour, .width = 1.4}, .text = text};
  if (unstable) item.pen.width = 0.9, item.pen.dash[0] = 3.0, item.pen.dash[1] = 2.0;
  return item;
}

/* What every figure of branches explains. */
static void add_keys(picture *self) {
  static const strut_follow_kind kinds[] = {STRUT_FOLLOW_FOLD, STRUT_FOLLOW_DOUBLING,
                                            STRUT_FOLLOW_TORUS, STRUT_FOLLOW_TOUCH};
  static const char *const texts[] = {"fold", "period doubling", "torus, branching",
                                      "an event that changes the stability"};
  self->keys[self->key_count++] = line_key(strut_grey(0.2), false, "stable");
  self->keys[self->key_count++] = line_key(strut_grey(0.2), true, "unstable");
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
    self->keys[self->key_count++] =
        (strut_key_item){.sign = STRUT_KEY_DOT,
                         .pen = {.colour = strut_grey(0.1), .width = 0.6},
                         .fill = {.colour = colour_of(kinds[i])},
                         .text = texts[i]};
}

static bool begin_picture(picture *self, size_t lines, size_t points) {
  self->lines = strut_arena_allocate(&self->arena, lines + 1, sizeof *self->lines);
  self->pens = strut_arena_allocate(&self->arena, lines + 1, sizeof *self->pens);
  self->marks = strut_arena_allocate(&self->arena, points + 1, sizeof *self->marks);
  self->x = strut_arena_allocate(&self->arena, points + 1, sizeof *self->x);
  self->y = strut_arena_allocate(&self->arena, points + 1, sizeof *self->y);
  self->unstable = strut_arena_allocate(&self->arena, points + 1, sizeof *self->unstable);
  return self->lines && self->pens && self->marks && self->x && self->y && self->unstable;
}

static void begin_line(picture *self, size_t look) {
  strut_pen *pen = &self->pens[self->line_count];
  *pen = (strut_pen){.colour = strut_palette_thing(look), .width = 1.4};
  self->lines[self->line_count++] = (strut_series){.x = self->x + self->count,
                                                   .y = self->y + self->count,
                                                   .unstable = self->unstable + self->count,
                                                   .pen = pen};
}

static void add_point(picture *self, double x, double y, bool stable) {
  self->x[self->count] = x, self->y[self->count] = y;
  self->unstable[self->count++] = !stable;
  self->lines[self->line_count - 1].count++;
}

static bool mark_point(picture *self, strut_follow_kind kind, const char *word, const char *node) {
  strut_mark *mark = &self->marks[self->mark_count++];
  *mark = (strut_mark){.at = {self->x[self->count - 1], self->y[self->count - 1]},
                       .text = strut_arena_format(&self->arena, "%s%s%.60s", word,
                                                  node && *node ? " " : "", node ? node : ""),
                       .dot = true,
                       .colour = colour_of(kind),
                       .angle = 0.25 * STRUT_PI};
  return mark->text != NULL;
}

static strut_status draw_picture(const strut_plot *plot, const picture *self, bool fine,
                                 strut_error *error) {
  const strut_panel panel = {.x = self->along,
                             .y = self->upwards,
                             .series_count = self->line_count,
                             .series = self->lines,
                             .mark_count = self->mark_count,
                             .marks = self->marks};
  const strut_figure figure = {.title = self->title,
                               .panel_count = 1,
                               .panels = &panel,
                               .aspect = ASPECT,
                               .keys = self->keys,
                               .key_count = self->key_count};
  for (size_t i = 0; i < self->mark_count && self->mark_count > MOST_NAMES; i++)
    self->marks[i].text = NULL;
  strut_status status =
      fine ? strut_figure_draw(plot, &figure, error) : strut_no_memory(error, "while drawing");
  strut_arena_free((strut_arena *)&self->arena);
  return status;
}

/* ---- velocity over the parameter ---- */

static strut_axis height_axis(bool travels) {
  return strut_axis_of(travels ? "velocity" : "amplitude", travels ? "m/s" : "m");
}

static bool is_special(strut_follow_kind kind) {
  return kind >= STRUT_FOLLOW_FOLD && kind <= STRUT_FOLLOW_TORUS;
}

/* Appends the line of a branch and its marks. Events that change nothing are in the table alone. */
static bool add_branch(picture *self, const strut_follow_branch *branch, size_t look) {
  bool fine = true;
  begin_line(self, look);
  for (size_t k = 0; k < branch->count && fine; k++) {
    const strut_follow_point *point = &branch->points[k];
    add_point(self, point->at.value[0], branch->travels ? point->velocity : point->amplitude,
              point->stable);
    if (is_special(point->kind) || (point->detail && point->changes))
      fine = mark_point(self, point->kind, strut_follow_kind_word(point->kind), point->node);
  }
  return fine;
}

strut_status strut_follow_figure(const strut_plot *plot, const strut_follow_result *result,
                                 strut_error *error) {
  size_t points = 0;
  for (size_t i = 0; i < result->count; i++) points += result->branches[i].branch.count;
  picture p = {.title = result->title,
               .along = strut_axis_of(result->name, result->unit),
               .upwards = height_axis(result->count && result->branches[0].branch.travels)};
  bool fine = begin_picture(&p, result->count, points);
  add_keys(&p);
  for (size_t i = 0; i < result->count && fine; i++)
    fine = add_branch(&p, &result->branches[i].branch, i);
  return draw_picture(plot, &p, fine, error);
}

/* ---- curves over two parameters ---- */

static const struct {
  strut_follow_kind kind;
  const char *text;
} kinds[CURVE_KEYS] = {{STRUT_FOLLOW_FOLD, "fold"},
                       {STRUT_FOLLOW_DOUBLING, "period doubling"},
                       {STRUT_FOLLOW_TOUCH, "grazing"},
                       {STRUT_FOLLOW_LIFT, "lift-off"}};

static size_t look_of(strut_follow_kind kind) {
  size_t look = 0;
  while (look + 1 < CURVE_KEYS && kinds[look].kind != kind) look++;
  return look;
}

static bool add_curve(picture *self, const strut_follow_branch *curve) {
  bool fine = true;
  begin_line(self, look_of(curve->kind));
  for (size_t k = 0; k < curve->count && fine; k++) {
    const strut_follow_point *point = &curve->points[k];
    add_point(self, point->at.value[0], point->at.value[1], point->stable);
    if (point->kind == STRUT_FOLLOW_CUSP) fine = mark_point(self, curve->kind, "cusp", NULL);
  }
  return fine;
}

strut_status strut_follow_curves_figure(const strut_plot *plot, const strut_follow_result *result,
                                        strut_error *error) {
  size_t points = 0;
  for (size_t i = 0; i < result->curve_count; i++) points += result->curves[i].count;
  picture p = {.title = result->title,
               .along = strut_axis_of(result->name, result->unit),
               .upwards = strut_axis_of(result->second.name, result->second.unit)};
  bool fine = begin_picture(&p, result->curve_count, points);
  for (size_t i = 0; i < CURVE_KEYS; i++)
    p.keys[p.key_count++] = line_key(strut_palette_thing(i), false, kinds[i].text);
  p.keys[p.key_count++] = line_key(strut_grey(0.2), false, "of a motion that is stable beside it");
  p.keys[p.key_count++] = line_key(strut_grey(0.2), true, "of an unstable motion");
  for (size_t i = 0; i < result->curve_count && fine; i++) fine = add_curve(&p, &result->curves[i]);
  return draw_picture(plot, &p, fine, error);
}

/* ---- the branches of a study: a colour for each point of the axes ---- */

enum { LABEL = 120 };

/* Columns of the table that are drawn. */
enum { BRANCH, VELOCITY, AMPLITUDE, STABLE, POINT, NODE, CHANGES, VALUE, DRAWN };

typedef struct source {
  const strut_table *table;
  size_t axes;
  const strut_table_column *column[DRAWN];
} source;

static const strut_table_column *find_column(const strut_table *table, const char *name) {
  for (size_t i = 0; i < table->column_count; i++)
    if (strcmp(table->columns[i].name, name) == 0) return &table->columns[i];
  return NULL;
}

static const char *text_of(const strut_table_column *column, size_t row) {
  return column->text && column->text[row] ? column->text[row] : "";
}

static double number_of(const strut_table_column *column, size_t row) {
  return column->value ? column->value[row] : (double)NAN;
}

static bool same_axes(const source *self, size_t a, size_t b) {
  bool same = true;
  for (size_t i = 0; i < self->axes && same; i++)
    same = strcmp(text_of(&self->table->columns[i], a), text_of(&self->table->columns[i], b)) == 0;
  return same;
}

/* "friction 0.2, start I" */
static const char *row_label(const source *self, size_t row, strut_arena *arena) {
  char text[LABEL] = "";
  size_t used = 0;
  for (size_t i = 0; i < self->axes && used < sizeof text; i++) {
    const strut_table_column *column = &self->table->columns[i];
    double value = number_of(column, row);
    const char *unit = column->unit && *column->unit ? column->unit : "1";
    int n = snprintf(
        text + used, sizeof text - used, "%s%.40s %.40s", used ? ", " : "", column->name,
        isfinite(value) ? strut_quantity_of_any(value, 4, unit).text : text_of(column, row));
    used += n > 0 ? (size_t)n : 0;
  }
  return strut_arena_format(arena, "%s", text);
}

/* Appends the point of a row, and a mark where it is special. */
static bool add_row(const source *self, picture *p, size_t row) {
  double amplitude = number_of(self->column[AMPLITUDE], row); /* of structures that do not travel */
  const char *word = text_of(self->column[POINT], row);
  strut_follow_kind kind = STRUT_FOLLOW_REGULAR;
  for (int k = 0; k < STRUT_FOLLOW_KINDS; k++)
    if (strcmp(strut_follow_kind_word((strut_follow_kind)k), word) == 0)
      kind = (strut_follow_kind)k;
  add_point(p, number_of(self->column[VALUE], row),
            isfinite(amplitude) ? amplitude : number_of(self->column[VELOCITY], row),
            strcmp(text_of(self->column[STABLE], row), "yes") == 0);
  if (!is_special(kind) && strcmp(text_of(self->column[CHANGES], row), "yes") != 0) return true;
  return mark_point(p, kind, strut_follow_kind_word(kind), text_of(self->column[NODE], row));
}

/* Lines, marks and keys of all rows. False: no memory. */
static bool gather(const source *self, picture *p) {
  size_t rows = self->table->row_count, look = 0;
  bool fine = begin_picture(p, rows, rows);
  const strut_table_column *branch = self->column[BRANCH];
  for (size_t i = 0; i < rows && fine; i++) {
    bool other = i == 0 || !same_axes(self, i - 1, i);
    if (other && i > 0) look++;
    if (other && self->axes && look < MOST_LINES) {
      const char *label = row_label(self, i, &p->arena);
      p->keys[p->key_count++] = line_key(strut_palette_thing(look), false, label);
      fine = label != NULL;
    }
    if (other || number_of(branch, i) != number_of(branch, i - 1)) begin_line(p, look);
    fine = fine && add_row(self, p, i);
  }
  return fine;
}

strut_status strut_follow_points_figure(const strut_plot *plot, const strut_sweep_plan *plan,
                                        const strut_table *table, strut_error *error) {
  static const char *const names[DRAWN] = {"branch", "velocity", "amplitude",        "stable",
                                           "point",  "node",     "changes_stability"};
  const strut_study_follow *follow = plan->study->follow;
  source s = {.table = table, .axes = plan->axis_columns};
  for (int i = 0; i < DRAWN; i++)
    if (!(s.column[i] = find_column(table, i == VALUE ? follow->over : names[i])))
      return strut_fail(error, STRUT_FILE_TROUBLE, "branches.csv lacks a column");
  picture p = {
      .title = plan->study->name,
      .along = strut_axis_of(follow->over, follow->unit),
      .upwards = height_axis(!table->row_count || !isfinite(number_of(s.column[AMPLITUDE], 0)))};
  strut_c_locale locale = strut_c_locale_enter();
  bool fine = gather(&s, &p);
  strut_c_locale_leave(locale);
  add_keys(&p);
  return draw_picture(plot, &p, fine, error);
}

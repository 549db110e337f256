/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines over a parameter: stable motions solid, unstable ones dashed, special points marked. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/output/figures/table_figure.h"
#include "engine/study/follow/follow_parts.h"
#include "engine/study/follow/follow_study.h"

static const double ASPECT = 0.6;
enum { MOST_NAMES = 40, MOST_LINES = 12, CURVE_KEYS = 4, LABEL = 120 };

/* ---- pictures of branches ---- */

/* A picture that is filled line by line, point by point. */
typedef struct picture {
  strut_panel *panel;
  strut_series *line; /* the last one */
  strut_figure figure;
} picture;

static strut_colour colour_of(strut_follow_kind kind) {
  static const unsigned char thing[STRUT_FOLLOW_KINDS] = {[STRUT_FOLLOW_FOLD] = 6,
                                                          [STRUT_FOLLOW_DOUBLING] = 3,
                                                          [STRUT_FOLLOW_TORUS] = 4,
                                                          [STRUT_FOLLOW_BRANCHING] = 4};
  return thing[kind] ? strut_palette_thing(thing[kind] - 1U) : strut_grey(1.0);
}

static void add_line_key(picture *self, strut_colour colour, bool unstable, const char *text) {
  strut_pen pen = {.colour = colour, .width = unstable ? 0.9 : 1.4};
  if (unstable) pen.dash[0] = 3.0, pen.dash[1] = 2.0;
  strut_add_key(&self->figure, STRUT_KEY_LINE, pen, text);
}

/* What every figure of branches explains. */
static void add_keys(picture *self) {
  static const strut_follow_kind kinds[] = {STRUT_FOLLOW_FOLD, STRUT_FOLLOW_DOUBLING,
                                            STRUT_FOLLOW_TORUS, STRUT_FOLLOW_TOUCH};
  static const char *const texts[] = {"fold", "period doubling", "torus, branching",
                                      "an event that changes the stability"};
  const strut_pen rim = {.colour = strut_grey(0.1), .width = 0.6};
  add_line_key(self, strut_grey(0.2), false, "stable");
  add_line_key(self, strut_grey(0.2), true, "unstable");
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
    strut_add_key(&self->figure, STRUT_KEY_DOT, rim, texts[i])->fill.colour = colour_of(kinds[i]);
}

static void begin_picture(picture *self, const char *title, strut_axis along, strut_axis upwards) {
  *self = (picture){.figure = {.title = title, .aspect = ASPECT}};
  self->panel = strut_add_panel(&self->figure);
  self->panel->x = along, self->panel->y = upwards;
}

static void begin_line(picture *self, size_t look) {
  self->line = strut_add_series(&self->figure, self->panel, NULL);
  self->line->pen = (strut_pen){.colour = strut_palette_thing(look), .width = 1.4};
}

static void add_point(picture *self, double x, double y, bool stable) {
  strut_add_point(&self->figure, self->line, x, y)->unstable = !stable;
}

static void mark_point(picture *self, strut_follow_kind kind, double x, double y, const char *word,
                       const char *node) {
  strut_label *mark = strut_add_mark(&self->figure, self->panel, x, y,
                                     strut_figure_text(&self->figure, "%s%s%.60s", word,
                                                       node && *node ? " " : "", node ? node : ""));
  mark->dot = true;
  mark->colour = colour_of(kind);
  mark->angle = 0.25 * STRUT_PI;
}

static strut_status draw_picture(const strut_plot *plot, picture *self, strut_error *error) {
  strut_panel *panel = self->panel;
  for (size_t i = 0; i < panel->mark_count && panel->mark_count > MOST_NAMES; i++)
    if (!self->figure.failed) panel->marks[i].text = NULL;
  return strut_figure_draw(plot, &self->figure, error);
}

/* ---- velocity over the parameter ---- */

static strut_axis height_axis(bool travels) {
  return strut_axis_of(travels ? "velocity" : "amplitude", travels ? "m/s" : "m");
}

static bool is_special(strut_follow_kind kind) {
  return kind >= STRUT_FOLLOW_FOLD && kind <= STRUT_FOLLOW_TORUS;
}

/* Adds the line of a branch and its marks. Events that change nothing are in the table alone. */
static void add_branch(picture *self, const strut_follow_branch *branch, size_t look) {
  begin_line(self, look);
  for (size_t k = 0; k < branch->count; k++) {
    const strut_follow_point *point = &branch->points[k];
    double height = branch->travels ? point->velocity : point->amplitude,
           value = point->at.value[0];
    add_point(self, value, height, point->stable);
    if (is_special(point->kind) || (point->detail && point->changes))
      mark_point(self, point->kind, value, height, strut_follow_kind_word(point->kind),
                 point->node);
  }
}

strut_status strut_follow_figure(const strut_plot *plot, const strut_follow_result *result,
                                 strut_error *error) {
  picture p;
  begin_picture(&p, result->title, strut_axis_of(result->name, result->unit),
                height_axis(result->count && result->branches[0].branch.travels));
  add_keys(&p);
  for (size_t i = 0; i < result->count; i++) add_branch(&p, &result->branches[i].branch, i);
  return draw_picture(plot, &p, error);
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

static void add_curve(picture *self, const strut_follow_branch *curve) {
  begin_line(self, look_of(curve->kind));
  for (size_t k = 0; k < curve->count; k++) {
    const strut_follow_point *point = &curve->points[k];
    double x = point->at.value[0], y = point->at.value[1];
    add_point(self, x, y, point->stable);
    if (point->kind == STRUT_FOLLOW_CUSP) mark_point(self, curve->kind, x, y, "cusp", NULL);
  }
}

strut_status strut_follow_curves_figure(const strut_plot *plot, const strut_follow_result *result,
                                        strut_error *error) {
  picture p;
  begin_picture(&p, result->title, strut_axis_of(result->name, result->unit),
                strut_axis_of(result->second.name, result->second.unit));
  for (size_t i = 0; i < CURVE_KEYS; i++)
    add_line_key(&p, strut_palette_thing(i), false, kinds[i].text);
  add_line_key(&p, strut_grey(0.2), false, "of a motion that is stable beside it");
  add_line_key(&p, strut_grey(0.2), true, "of an unstable motion");
  for (size_t i = 0; i < result->curve_count; i++) add_curve(&p, &result->curves[i]);
  return draw_picture(plot, &p, error);
}

/* ---- the branches of a study: a colour for each point of the axes ---- */

/* Columns of the table that are drawn. */
enum { BRANCH, VELOCITY, AMPLITUDE, STABLE, POINT, NODE, CHANGES, VALUE, DRAWN };

typedef struct source {
  const strut_table *table;
  size_t axes;
  const strut_table_column *column[DRAWN];
} source;

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
static const char *row_label(const source *self, size_t row, picture *p) {
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
  return strut_figure_text(&p->figure, "%s", text);
}

/* Adds the point of a row, and a mark where it is special. */
static void add_row(const source *self, picture *p, size_t row) {
  double amplitude = number_of(self->column[AMPLITUDE], row); /* of structures that do not travel */
  double value = number_of(self->column[VALUE], row);
  double height = isfinite(amplitude) ? amplitude : number_of(self->column[VELOCITY], row);
  const char *word = text_of(self->column[POINT], row);
  strut_follow_kind kind = STRUT_FOLLOW_REGULAR;
  for (int k = 0; k < STRUT_FOLLOW_KINDS; k++)
    if (strcmp(strut_follow_kind_word((strut_follow_kind)k), word) == 0)
      kind = (strut_follow_kind)k;
  add_point(p, value, height, strcmp(text_of(self->column[STABLE], row), "yes") == 0);
  if (is_special(kind) || strcmp(text_of(self->column[CHANGES], row), "yes") == 0)
    mark_point(p, kind, value, height, strut_follow_kind_word(kind),
               text_of(self->column[NODE], row));
}

/* Lines, marks and keys of all rows. */
static void gather(const source *self, picture *p) {
  size_t rows = self->table->row_count, look = 0;
  const strut_table_column *branch = self->column[BRANCH];
  for (size_t i = 0; i < rows; i++) {
    bool other = i == 0 || !same_axes(self, i - 1, i);
    if (other && i > 0) look++;
    if (other && self->axes && look < MOST_LINES)
      add_line_key(p, strut_palette_thing(look), false, row_label(self, i, p));
    if (other || number_of(branch, i) != number_of(branch, i - 1)) begin_line(p, look);
    add_row(self, p, i);
  }
}

strut_status strut_follow_points_figure(const strut_plot *plot, const strut_sweep_plan *plan,
                                        const strut_table *table, strut_error *error) {
  static const char *const names[DRAWN] = {"branch", "velocity", "amplitude",        "stable",
                                           "point",  "node",     "changes_stability"};
  const strut_study_follow *follow = plan->study->follow;
  source s = {.table = table, .axes = plan->axis_columns};
  for (int i = 0; i < DRAWN; i++) {
    const char *name = i == VALUE ? follow->over : names[i];
    int column = strut_table_column_of(table, name, strlen(name));
    if (column == STRUT_NO_COLUMN)
      return strut_fail(error, STRUT_FILE_TROUBLE, "branches.csv lacks a column");
    s.column[i] = &table->columns[column];
  }
  picture p;
  begin_picture(&p, plan->study->name, strut_axis_of(follow->over, follow->unit),
                height_axis(!table->row_count || !isfinite(number_of(s.column[AMPLITUDE], 0))));
  gather(&s, &p);
  add_keys(&p);
  return draw_picture(plot, &p, error);
}

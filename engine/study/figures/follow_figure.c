/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines over a parameter: stable motions solid, unstable ones dashed, special points marked. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/output/figures/table_figure.h"
#include "engine/study/follow/follow_parts.h"
#include "engine/study/follow/follow_study.h"

static const double ASPECT = 0.6, WIDTH = 1.4; /* [1], of lines [pt] */
enum { MOST_NAMES = 40, MOST_LINES = 12, CURVE_KEYS = 4, LABEL = 120 };

/* A picture that is filled point by point. */
typedef struct picture {
  strut_panel *panel;
  strut_series *series; /* the last line */
  size_t line;          /* its number, from 1 on */
  unsigned marked;      /* bits of `marks` */
  unsigned looks;       /* bits of the first looks of lines */
  bool has[2];          /* unstable, stable points */
  strut_figure figure;
} picture;

/* A point of a line, which is a mark with `word` if `marked`. */
typedef struct dot {
  size_t line, look;
  double x, y;
  bool stable, marked;
  strut_follow_kind kind;
  const char *word, *node; /* node may be NULL */
} dot;

/* Marks by kind, the last for all others. */
static const struct {
  unsigned kinds; /* bits */
  size_t thing;   /* of the colours, from 1 on; 0: white */
  const char *text;
} marks[] = {{1U << STRUT_FOLLOW_FOLD, 6, "fold"},
             {1U << STRUT_FOLLOW_DOUBLING, 3, "period doubling"},
             {1U << STRUT_FOLLOW_TORUS | 1U << STRUT_FOLLOW_BRANCHING, 4, "torus, branching"},
             {~0U, 0, "an event that changes the stability"}};

static size_t mark_of(strut_follow_kind kind) {
  size_t i = 0;
  while (!(marks[i].kinds >> kind & 1U)) i++;
  return i;
}

static strut_colour mark_colour(size_t i) {
  return marks[i].thing ? strut_palette_thing(marks[i].thing - 1) : strut_grey(1.0);
}

static void add_dot(picture *self, const dot *d) {
  if (d->line != self->line) {
    self->series = strut_add_series(&self->figure, self->panel, NULL);
    self->series->pen = (strut_pen){.colour = strut_palette_thing(d->look), .width = WIDTH};
    self->line = d->line;
  }
  strut_add_point(&self->figure, self->series, d->x, d->y)->unstable = !d->stable;
  self->has[d->stable] = true;
  if (d->look < CURVE_KEYS) self->looks |= 1U << d->look;
  if (!d->marked) return;
  self->marked |= 1U << mark_of(d->kind);
  bool node = d->node && *d->node;
  strut_label *mark = strut_add_mark(
      &self->figure, self->panel, d->x, d->y,
      strut_figure_text(&self->figure, "%s%s%.60s", d->word, node ? " " : "", node ? d->node : ""));
  mark->dot = true;
  mark->colour = mark_colour(mark_of(d->kind));
  mark->angle = 0.25 * STRUT_PI;
}

static void add_line_key(picture *self, strut_colour colour, bool unstable, const char *text) {
  strut_pen pen = {.colour = colour, .width = WIDTH, .butt = unstable};
  if (unstable) pen.dash[0] = 3.0, pen.dash[1] = 2.0;
  strut_add_key(&self->figure, STRUT_KEY_LINE, pen, text);
}

/* Explains what the figure of branches has. */
static void add_keys(picture *self) {
  const strut_pen rim = {.colour = strut_grey(0.1), .width = 0.6};
  if (self->has[true]) add_line_key(self, strut_grey(0.2), false, "stable");
  if (self->has[false]) add_line_key(self, strut_grey(0.2), true, "unstable");
  for (size_t i = 0; i < sizeof marks / sizeof *marks; i++)
    if (self->marked >> i & 1U)
      strut_add_key(&self->figure, STRUT_KEY_DOT, rim, marks[i].text)->fill.colour = mark_colour(i);
}

static void begin_picture(picture *self, const char *title, strut_axis along, strut_axis upwards) {
  *self = (picture){.figure = {.title = title, .aspect = ASPECT}};
  self->panel = strut_add_panel(&self->figure);
  self->panel->x = along, self->panel->y = upwards;
}

static strut_status draw_picture(const strut_plot *plot, picture *self, strut_error *error) {
  strut_panel *panel = self->panel;
  for (size_t i = 0; i < panel->mark_count && panel->mark_count > MOST_NAMES; i++)
    if (!self->figure.failed) panel->marks[i].text = NULL;
  return strut_figure_draw(plot, &self->figure, error);
}

/* ---- velocity over the parameter, of a result ---- */

static strut_axis height_axis(bool travels) {
  return strut_axis_of(travels ? "velocity" : "amplitude", travels ? "m/s" : "m");
}

/* Events that change nothing are in the table alone. */
static bool is_marked(strut_follow_kind kind, bool changes) {
  return changes || (kind >= STRUT_FOLLOW_FOLD && kind <= STRUT_FOLLOW_TORUS);
}

strut_status strut_follow_figure(const strut_plot *plot, const strut_follow_result *result,
                                 strut_error *error) {
  picture p;
  begin_picture(&p, result->title, strut_axis_in(result->name, result->unit, result->shown),
                height_axis(result->count && result->branches[0].branch.travels));
  for (size_t i = 0; i < result->count; i++) {
    const strut_follow_branch *branch = &result->branches[i].branch;
    for (const strut_follow_point *at = branch->points; at < branch->points + branch->count; at++)
      add_dot(&p, &(dot){i + 1, i, at->at.value[0], branch->travels ? at->velocity : at->amplitude,
                         at->stable, is_marked(at->kind, at->detail && at->changes), at->kind,
                         strut_follow_kind_word(at->kind), at->node});
  }
  add_keys(&p);
  return draw_picture(plot, &p, error);
}

/* ---- curves over two parameters ---- */

strut_status strut_follow_curves_figure(const strut_plot *plot, const strut_follow_result *result,
                                        strut_error *error) {
  static const strut_follow_kind kinds[CURVE_KEYS] = {STRUT_FOLLOW_FOLD, STRUT_FOLLOW_DOUBLING,
                                                      STRUT_FOLLOW_TOUCH, STRUT_FOLLOW_LIFT};
  static const char *const texts[CURVE_KEYS] = {"fold", "period doubling", "grazing", "lift-off"};
  picture p;
  begin_picture(&p, result->title, strut_axis_in(result->name, result->unit, result->shown),
                strut_axis_in(result->second.name, result->second.unit, result->second.shown));
  for (size_t i = 0, look; i < result->curve_count; i++) {
    const strut_follow_branch *curve = &result->curves[i];
    for (look = 0; look + 1 < CURVE_KEYS && kinds[look] != curve->kind;) look++;
    for (const strut_follow_point *at = curve->points; at < curve->points + curve->count; at++)
      add_dot(&p, &(dot){i + 1, look, at->at.value[0], at->at.value[1], at->stable,
                         at->kind == STRUT_FOLLOW_CUSP, curve->kind, "cusp", NULL});
  }
  for (size_t i = 0; i < CURVE_KEYS; i++)
    if (p.looks >> i & 1U) add_line_key(&p, strut_palette_thing(i), false, texts[i]);
  if (p.has[true]) add_line_key(&p, strut_grey(0.2), false, "of a motion that is stable beside it");
  if (p.has[false]) add_line_key(&p, strut_grey(0.2), true, "of an unstable motion");
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

static double number_of(const source *self, int column, size_t row) {
  const double *value = self->column[column]->value;
  return value ? value[row] : (double)NAN;
}

static bool same_axes(const source *self, size_t a, size_t b) {
  bool same = true;
  for (size_t i = 0; i < self->axes && same; i++)
    same = strcmp(text_of(&self->table->columns[i], a), text_of(&self->table->columns[i], b)) == 0;
  return same;
}

/* "friction 0.2, start I" */
static const char *row_label(const source *self, size_t row, picture *p) {
  const char *text = "";
  for (size_t i = 0; i < self->axes && strlen(text) < LABEL; i++) {
    const strut_table_column *column = &self->table->columns[i];
    double value = column->value ? column->value[row] : (double)NAN;
    const char *unit = column->unit && *column->unit ? column->unit : "1";
    text =
        strut_figure_text(&p->figure, "%s%s%.40s %.40s", text, i ? ", " : "", column->name,
                          isfinite(value) ? strut_quantity_shown(value, 4, unit, column->shown).text
                                          : text_of(column, row));
  }
  return text;
}

static strut_follow_kind kind_of(const char *word) {
  int kind = STRUT_FOLLOW_KINDS - 1;
  while (kind > 0 && strcmp(strut_follow_kind_word((strut_follow_kind)kind), word) != 0) kind--;
  return (strut_follow_kind)kind;
}

/* Lines, marks and keys of all rows. */
static void add_rows(const source *self, picture *p) {
  size_t look = 0, line = 0;
  for (size_t i = 0; i < self->table->row_count; i++) {
    bool other = i == 0 || !same_axes(self, i - 1, i);
    double amplitude = number_of(self, AMPLITUDE, i); /* of structures that do not travel */
    strut_follow_kind kind = kind_of(text_of(self->column[POINT], i));
    if (other && i > 0) look++;
    if (other && self->axes && look < MOST_LINES)
      add_line_key(p, strut_palette_thing(look), false, row_label(self, i, p));
    line += other || number_of(self, BRANCH, i) != number_of(self, BRANCH, i - 1);
    bool changes = strcmp(text_of(self->column[CHANGES], i), "yes") == 0;
    bool stable = strcmp(text_of(self->column[STABLE], i), "yes") == 0;
    double height = isfinite(amplitude) ? amplitude : number_of(self, VELOCITY, i);
    add_dot(p,
            &(dot){line, look, number_of(self, VALUE, i), height, stable, is_marked(kind, changes),
                   kind, strut_follow_kind_word(kind), text_of(self->column[NODE], i)});
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
  begin_picture(&p, plan->study->name, strut_axis_in(follow->over, follow->unit, follow->shown),
                height_axis(!table->row_count || !isfinite(number_of(&s, AMPLITUDE, 0))));
  add_rows(&s, &p);
  add_keys(&p);
  return draw_picture(plot, &p, error);
}

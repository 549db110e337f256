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
static void add_keys(picture *p) {
  static const strut_follow_kind kinds[] = {STRUT_FOLLOW_FOLD, STRUT_FOLLOW_DOUBLING,
                                            STRUT_FOLLOW_TORUS, STRUT_FOLLOW_TOUCH};
  static const char *const texts[] = {"fold", "period doubling", "torus, branching",
                                      "an event that changes the stability"};
  p->keys[p->key_count++] = line_key(strut_grey(0.2), false, "stable");
  p->keys[p->key_count++] = line_key(strut_grey(0.2), true, "unstable");
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
    p->keys[p->key_count++] = (strut_key_item){.sign = STRUT_KEY_DOT,
                                               .pen = {.colour = strut_grey(0.1), .width = 0.6},
                                               .fill = {.colour = colour_of(kinds[i])},
                                               .text = texts[i]};
}

static bool begin_picture(picture *p, size_t lines, size_t points) {
  p->lines = strut_arena_allocate(&p->arena, lines + 1, sizeof *p->lines);
  p->pens = strut_arena_allocate(&p->arena, lines + 1, sizeof *p->pens);
  p->marks = strut_arena_allocate(&p->arena, points + 1, sizeof *p->marks);
  p->x = strut_arena_allocate(&p->arena, points + 1, sizeof *p->x);
  p->y = strut_arena_allocate(&p->arena, points + 1, sizeof *p->y);
  p->unstable = strut_arena_allocate(&p->arena, points + 1, sizeof *p->unstable);
  return p->lines && p->pens && p->marks && p->x && p->y && p->unstable;
}

static void begin_line(picture *p, size_t look) {
  strut_pen *pen = &p->pens[p->line_count];
  *pen = (strut_pen){.colour = strut_palette_thing(look), .width = 1.4};
  p->lines[p->line_count++] = (strut_series){
      .x = p->x + p->count, .y = p->y + p->count, .unstable = p->unstable + p->count, .pen = pen};
}

static void add_point(picture *p, double x, double y, bool stable) {
  p->x[p->count] = x, p->y[p->count] = y;
  p->unstable[p->count++] = !stable;
  p->lines[p->line_count - 1].count++;
}

static bool mark_point(picture *p, strut_follow_kind kind, const char *word, const char *node) {
  strut_mark *mark = &p->marks[p->mark_count++];
  *mark = (strut_mark){.at = {p->x[p->count - 1], p->y[p->count - 1]},
                       .text = strut_arena_format(&p->arena, "%s%s%.60s", word,
                                                  node && *node ? " " : "", node ? node : ""),
                       .dot = true,
                       .colour = colour_of(kind),
                       .angle = 0.25 * STRUT_PI};
  return mark->text != NULL;
}

static strut_status draw_picture(const strut_plot *plot, const picture *p, bool fine,
                                 strut_error *error) {
  const strut_panel panel = {.x = p->along,
                             .y = p->upwards,
                             .series_count = p->line_count,
                             .series = p->lines,
                             .mark_count = p->mark_count,
                             .marks = p->marks};
  const strut_figure figure = {.title = p->title,
                               .panel_count = 1,
                               .panels = &panel,
                               .aspect = ASPECT,
                               .keys = p->keys,
                               .key_count = p->key_count};
  for (size_t i = 0; i < p->mark_count && p->mark_count > MOST_NAMES; i++) p->marks[i].text = NULL;
  strut_status status =
      fine ? strut_figure_draw(plot, &figure, error) : strut_no_memory(error, "while drawing");
  strut_arena_free((strut_arena *)&p->arena);
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
static bool add_branch(picture *p, const strut_follow_branch *b, size_t look) {
  bool fine = true;
  begin_line(p, look);
  for (size_t k = 0; k < b->count && fine; k++) {
    const strut_follow_point *point = &b->points[k];
    add_point(p, point->value, b->travels ? point->velocity : point->amplitude, point->stable);
    if (is_special(point->kind) || (point->detail && point->changes))
      fine = mark_point(p, point->kind, strut_follow_kind_word(point->kind), point->node);
  }
  return fine;
}

strut_status strut_follow_figure(const strut_plot *plot, const strut_follow_result *r,
                                 strut_error *error) {
  size_t points = 0;
  for (size_t i = 0; i < r->count; i++) points += r->branches[i].branch.count;
  picture p = {.title = r->title,
               .along = strut_axis_of(r->name, r->unit),
               .upwards = height_axis(r->count && r->branches[0].branch.travels)};
  bool fine = begin_picture(&p, r->count, points);
  add_keys(&p);
  for (size_t i = 0; i < r->count && fine; i++) fine = add_branch(&p, &r->branches[i].branch, i);
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

static bool add_curve(picture *p, const strut_follow_curve *c) {
  bool fine = true;
  begin_line(p, look_of(c->kind));
  for (size_t k = 0; k < c->count && fine; k++) {
    const strut_follow_curve_point *point = &c->points[k];
    add_point(p, point->value[0], point->value[1], point->stable);
    if (point->cusp) fine = mark_point(p, c->kind, "cusp", NULL);
  }
  return fine;
}

strut_status strut_follow_curves_figure(const strut_plot *plot, const strut_follow_result *r,
                                        strut_error *error) {
  size_t points = 0;
  for (size_t i = 0; i < r->curve_count; i++) points += r->curves[i].count;
  picture p = {.title = r->title,
               .along = strut_axis_of(r->name, r->unit),
               .upwards = strut_axis_of(r->second.name, r->second.unit)};
  bool fine = begin_picture(&p, r->curve_count, points);
  for (size_t i = 0; i < CURVE_KEYS; i++)
    p.keys[p.key_count++] = line_key(strut_palette_thing(i), false, kinds[i].text);
  p.keys[p.key_count++] = line_key(strut_grey(0.2), false, "of a motion that is stable beside it");
  p.keys[p.key_count++] = line_key(strut_grey(0.2), true, "of an unstable motion");
  for (size_t i = 0; i < r->curve_count && fine; i++) fine = add_curve(&p, &r->curves[i]);
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

static bool same_axes(const source *s, size_t a, size_t b) {
  bool same = true;
  for (size_t i = 0; i < s->axes && same; i++)
    same = strcmp(text_of(&s->table->columns[i], a), text_of(&s->table->columns[i], b)) == 0;
  return same;
}

/* "friction 0.2, start I" */
static const char *row_label(const source *s, size_t row, strut_arena *arena) {
  char text[LABEL] = "";
  size_t used = 0;
  for (size_t i = 0; i < s->axes && used < sizeof text; i++) {
    const strut_table_column *c = &s->table->columns[i];
    double value = number_of(c, row);
    const char *unit = c->unit && *c->unit ? c->unit : "1";
    int n =
        snprintf(text + used, sizeof text - used, "%s%.40s %.40s", used ? ", " : "", c->name,
                 isfinite(value) ? strut_quantity_of_any(value, 4, unit).text : text_of(c, row));
    used += n > 0 ? (size_t)n : 0;
  }
  return strut_arena_format(arena, "%s", text);
}

/* Appends the point of a row, and a mark where it is special. */
static bool add_row(const source *s, picture *p, size_t row) {
  double amplitude = number_of(s->column[AMPLITUDE], row); /* of structures that do not travel */
  const char *word = text_of(s->column[POINT], row);
  strut_follow_kind kind = STRUT_FOLLOW_REGULAR;
  for (int k = 0; k < STRUT_FOLLOW_KINDS; k++)
    if (strcmp(strut_follow_kind_word((strut_follow_kind)k), word) == 0)
      kind = (strut_follow_kind)k;
  add_point(p, number_of(s->column[VALUE], row),
            isfinite(amplitude) ? amplitude : number_of(s->column[VELOCITY], row),
            strcmp(text_of(s->column[STABLE], row), "yes") == 0);
  if (!is_special(kind) && strcmp(text_of(s->column[CHANGES], row), "yes") != 0) return true;
  return mark_point(p, kind, strut_follow_kind_word(kind), text_of(s->column[NODE], row));
}

/* Lines, marks and keys of all rows. False: no memory. */
static bool gather(const source *s, picture *p) {
  size_t rows = s->table->row_count, look = 0;
  bool fine = begin_picture(p, rows, rows);
  const strut_table_column *branch = s->column[BRANCH];
  for (size_t i = 0; i < rows && fine; i++) {
    bool other = i == 0 || !same_axes(s, i - 1, i);
    if (other && i > 0) look++;
    if (other && s->axes && look < MOST_LINES) {
      const char *label = row_label(s, i, &p->arena);
      p->keys[p->key_count++] = line_key(strut_palette_thing(look), false, label);
      fine = label != NULL;
    }
    if (other || number_of(branch, i) != number_of(branch, i - 1)) begin_line(p, look);
    fine = fine && add_row(s, p, i);
  }
  return fine;
}

strut_status strut_follow_points_figure(const strut_plot *plot, const strut_sweep_plan *plan,
                                        const strut_table *table, strut_error *error) {
  static const char *const names[DRAWN] = {"branch", "velocity", "amplitude",        "stable",
                                           "point",  "node",     "changes_stability"};
  const strut_study_follow *f = plan->study->follow;
  source s = {.table = table, .axes = plan->axis_columns};
  for (int i = 0; i < DRAWN; i++)
    if (!(s.column[i] = find_column(table, i == VALUE ? f->over : names[i])))
      return strut_fail(error, STRUT_FILE_TROUBLE, "branches.csv lacks a column");
  picture p = {
      .title = plan->study->name,
      .along = strut_axis_of(f->over, f->unit),
      .upwards = height_axis(!table->row_count || !isfinite(number_of(s.column[AMPLITUDE], 0)))};
  strut_c_locale locale = strut_c_locale_enter();
  bool fine = gather(&s, &p);
  strut_c_locale_leave(locale);
  add_keys(&p);
  return draw_picture(plot, &p, fine, error);
}

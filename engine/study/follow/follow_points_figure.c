/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The branches of a study in one figure: a colour for each point of the axes. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/study/follow/branch_picture.h"
#include "engine/study/follow/follow_parts.h"

/* Points of the axes that the key explains, at most. */
enum { MOST_KEYS = 12, LABEL = 120 };

/* The table, and the columns of it that are drawn. */
typedef struct source {
  const strut_table *table;
  size_t axes;
  const strut_table_column *branch, *value, *velocity, *amplitude, *stable, *point, *node, *changes;
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

/* Of structures that travel the velocity, else the amplitude. */
static double height_of(const source *s, size_t row) {
  double amplitude = number_of(s->amplitude, row);
  return isfinite(amplitude) ? amplitude : number_of(s->velocity, row);
}

static strut_follow_kind kind_of(const source *s, size_t row) {
  for (int k = 0; k < STRUT_FOLLOW_KINDS; k++)
    if (strcmp(strut_follow_kind_word((strut_follow_kind)k), text_of(s->point, row)) == 0)
      return (strut_follow_kind)k;
  return STRUT_FOLLOW_REGULAR;
}

static bool is_marked(const source *s, size_t row) {
  strut_follow_kind kind = kind_of(s, row);
  return (kind >= STRUT_FOLLOW_FOLD && kind <= STRUT_FOLLOW_TORUS) ||
         strcmp(text_of(s->changes, row), "yes") == 0;
}

/* "friction 0.2, start I" */
static const char *label_of(const source *s, size_t row, strut_arena *arena) {
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

/* Lines, marks and keys of all rows. False: no memory. */
static bool gather(const source *s, strut_branch_picture *p, strut_key_item *keys,
                   strut_arena *arena) {
  size_t rows = s->table->row_count, look = 0;
  double(*data)[2] = strut_arena_allocate(arena, rows + 1, sizeof *data);
  bool *stable = strut_arena_allocate(arena, rows + 1, sizeof *stable);
  p->lines = strut_arena_allocate(arena, rows + 1, sizeof *p->lines);
  p->marks = strut_arena_allocate(arena, rows + 1, sizeof *p->marks);
  if (!data || !stable || !p->lines || !p->marks) return false;
  for (size_t i = 0; i < rows; i++) {
    bool other = i == 0 || !same_axes(s, i - 1, i);
    if (other && i > 0) look++;
    if (other && s->axes && look < MOST_KEYS) {
      const strut_pen pen = {.colour = strut_palette_thing(look), .width = 1.4};
      const char *label = label_of(s, i, arena);
      if (!label) return false;
      keys[p->key_count++] = (strut_key_item){.sign = STRUT_KEY_LINE, .pen = pen, .text = label};
    }
    if (other || number_of(s->branch, i) != number_of(s->branch, i - 1))
      p->lines[p->line_count++] =
          (strut_branch_line){.look = look, .data = data + i, .stable = stable + i};
    p->lines[p->line_count - 1].count++;
    data[i][0] = number_of(s->value, i);
    data[i][1] = height_of(s, i);
    stable[i] = strcmp(text_of(s->stable, i), "yes") == 0;
    if (is_marked(s, i))
      p->marks[p->mark_count++] = (strut_branch_mark){
          .data = {data[i][0], data[i][1]}, .kind = kind_of(s, i), .node = text_of(s->node, i)};
  }
  return true;
}

strut_status strut_follow_points_figure(const strut_plot *plot, const strut_sweep_plan *plan,
                                        const strut_table *table, strut_error *error) {
  const strut_study_follow *f = plan->study->follow;
  strut_key_item keys[MOST_KEYS + STRUT_BRANCH_KEYS];
  strut_arena arena = {0};
  source s = {.table = table,
              .axes = plan->axis_columns,
              .branch = find_column(table, "branch"),
              .value = find_column(table, f->over),
              .velocity = find_column(table, "velocity"),
              .amplitude = find_column(table, "amplitude"),
              .stable = find_column(table, "stable"),
              .point = find_column(table, "point"),
              .node = find_column(table, "node"),
              .changes = find_column(table, "changes_stability")};
  if (!s.branch || !s.value || !s.velocity || !s.amplitude || !s.stable || !s.point || !s.node ||
      !s.changes)
    return strut_fail(error, STRUT_FILE_TROUBLE, "branches.csv lacks a column");
  bool travels = !table->row_count || !isfinite(number_of(s.amplitude, 0));
  strut_branch_picture p = {
      .title = plan->study->name,
      .x = {.name = f->over, .unit = f->unit},
      .y = {.name = travels ? "velocity" : "amplitude", .unit = travels ? "m/s" : "m"},
      .keys = keys};
  bool fine = gather(&s, &p, keys, &arena);
  strut_branch_keys(keys + p.key_count);
  p.key_count += STRUT_BRANCH_KEYS;
  strut_status status =
      fine ? strut_branch_draw(plot, &p, error) : strut_no_memory(error, "while drawing");
  strut_arena_free(&arena);
  return status;
}

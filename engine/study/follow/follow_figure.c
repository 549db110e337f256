/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/follow/follow_parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/vec.h"
#include "engine/study/follow/follow_study.h"

static const double EDGE = 4.0, PAGE = 510.24, ASPECT = 0.6, ROOM = 0.04; /* [pt], [1] */
static const double MARKER = 2.6, NAME = 7.0, GAP = 2.0;                  /* [pt] */
enum { MOST_NAMES = 40 };

typedef struct drawing {
  strut_canvas *canvas;
  const strut_branch_picture *p;
  strut_axes axes;
  double (*points)[2]; /* of the longest line [pt] */
} drawing;

strut_colour strut_branch_colour(strut_follow_kind kind) {
  switch (kind) {
    case STRUT_FOLLOW_FOLD: return strut_palette_thing(5);
    case STRUT_FOLLOW_DOUBLING: return strut_palette_thing(2);
    case STRUT_FOLLOW_TORUS:
    case STRUT_FOLLOW_BRANCHING: return strut_palette_thing(3);
    case STRUT_FOLLOW_REGULAR:
    case STRUT_FOLLOW_START:
    case STRUT_FOLLOW_END:
    case STRUT_FOLLOW_TOUCH:
    case STRUT_FOLLOW_LIFT:
    case STRUT_FOLLOW_STICK:
    case STRUT_FOLLOW_SLIP:
    case STRUT_FOLLOW_SWITCH:
    case STRUT_FOLLOW_MEETING:
    case STRUT_FOLLOW_KINDS: break;
  }
  return strut_grey(1.0);
}

void strut_branch_keys(strut_key_item keys[STRUT_BRANCH_KEYS]) {
  const strut_pen solid = {.colour = strut_grey(0.2), .width = 1.4};
  const strut_pen dashed = {.colour = strut_grey(0.2), .width = 0.9, .dash = {3.0, 2.0}};
  const strut_pen edge = {.colour = strut_grey(0.1), .width = 0.6};
  const struct {
    strut_follow_kind kind;
    const char *text;
  } dots[] = {{STRUT_FOLLOW_FOLD, "fold"},
              {STRUT_FOLLOW_DOUBLING, "period doubling"},
              {STRUT_FOLLOW_TORUS, "torus, branching"},
              {STRUT_FOLLOW_TOUCH, "an event that changes the stability"}};
  keys[0] = (strut_key_item){.sign = STRUT_KEY_LINE, .pen = solid, .text = "stable"};
  keys[1] = (strut_key_item){.sign = STRUT_KEY_LINE, .pen = dashed, .text = "unstable"};
  for (size_t i = 0; i < sizeof dots / sizeof dots[0]; i++)
    keys[i + 2] = (strut_key_item){.sign = STRUT_KEY_DOT,
                                   .pen = edge,
                                   .fill = {.colour = strut_branch_colour(dots[i].kind)},
                                   .text = dots[i].text};
}

/* Stretches of equal stability, which share their ends. */
static void draw_line(drawing *d, const strut_branch_line *line) {
  strut_pen pen = {.colour = strut_palette_thing(line->look), .width = 1.2};
  size_t from = 0;
  for (size_t k = 0; k < line->count; k++)
    strut_axes_point(&d->axes, line->data[k][0], line->data[k][1], d->points[k]);
  for (size_t k = 1; k <= line->count; k++) {
    if (k < line->count && line->stable[k] == line->stable[from]) continue;
    bool stable = line->stable[from];
    pen.dash[0] = stable ? 0.0 : 3.0, pen.dash[1] = stable ? 0.0 : 2.0;
    pen.width = stable ? 1.4 : 0.9;
    strut_draw_line(d->canvas, (const double(*)[2])d->points + from,
                    (k < line->count ? k + 1 : k) - from, pen);
    from = k;
  }
}

static void draw_name(const drawing *d, const strut_branch_mark *m, const double at[2]) {
  char text[120];
  snprintf(text, sizeof text, "%s%s%.60s", m->text ? m->text : strut_follow_kind_word(m->kind),
           m->node && *m->node ? " " : "", m->node ? m->node : "");
  strut_draw_label(d->canvas,
                   &(strut_label){.text = text,
                                  .font = {.size = NAME, .halo = strut_faded(strut_grey(1), 0.85)},
                                  .at = {at[0], at[1]},
                                  .gap = MARKER + 1.5,
                                  .angle = 0.25 * STRUT_PI,
                                  .inside = d->axes.frame});
}

static void draw_marks(const drawing *d) {
  const strut_pen edge = {.colour = strut_grey(0.1), .width = 0.6};
  for (size_t i = 0; i < d->p->mark_count; i++) {
    const strut_branch_mark *m = &d->p->marks[i];
    const strut_fill fill = {.colour = strut_branch_colour(m->kind)};
    double at[2];
    strut_axes_point(&d->axes, m->data[0], m->data[1], at);
    strut_draw_circle(d->canvas, at[0], at[1], MARKER, &fill, &edge);
    if (d->p->mark_count <= MOST_NAMES) draw_name(d, m, at);
  }
}

/* Height of the key, which a canvas must be there to measure. */
static strut_status measure_key(const strut_branch_picture *p, double width, double *height,
                                strut_error *error) {
  strut_canvas *ruler;
  strut_status status = strut_canvas_open_pixels(1, 1, 1.0, &ruler, error);
  if (status) return status;
  *height = strut_key_height(ruler, width, p->keys, p->key_count);
  strut_canvas_free(ruler);
  return STRUT_OK;
}

static strut_status draw_on_canvas(drawing *d, const strut_plot *plot, strut_axis x, strut_axis y,
                                   strut_error *error) {
  const strut_branch_picture *p = d->p;
  const char *title = strut_plot_title(plot, p->title);
  double width = plot->width > 0.0 ? plot->width : PAGE, key = 0.0;
  strut_box box = {EDGE, EDGE, width - 2 * EDGE, ASPECT * width};
  strut_status status = measure_key(p, box.width, &key, error);
  if (!status)
    status = strut_canvas_open(plot->path, width, box.height + GAP + key + 2 * EDGE, title,
                               &d->canvas, error);
  if (status) return status;
  d->axes = strut_axes_place(d->canvas, box, x, y, title);
  strut_draw_axes(d->canvas, &d->axes, title);
  strut_canvas_clip(d->canvas, d->axes.frame);
  for (size_t i = 0; i < p->line_count; i++) draw_line(d, &p->lines[i]);
  strut_canvas_unclip(d->canvas);
  draw_marks(d);
  box.y += box.height + GAP;
  box.height = key;
  strut_draw_key(d->canvas, box, p->keys, p->key_count);
  return strut_canvas_commit(d->canvas, error);
}

strut_status strut_branch_draw(const strut_plot *plot, const strut_branch_picture *picture,
                               strut_error *error) {
  drawing d = {.p = picture};
  strut_arena arena = {0};
  strut_axis x = picture->x, y = picture->y;
  size_t longest = 1;
  strut_c_locale locale = strut_c_locale_enter();
  x.low = x.high = y.low = y.high = (double)NAN;
  for (size_t i = 0; i < picture->line_count; i++) {
    const strut_branch_line *line = &picture->lines[i];
    if (line->count > longest) longest = line->count;
    for (size_t k = 0; k < line->count; k++) {
      strut_axis_include(&x, line->data[k][0]);
      strut_axis_include(&y, line->data[k][1]);
    }
  }
  strut_axis_settle(&x, 0.0);
  strut_axis_settle(&y, ROOM);
  strut_axis_choose(&x, &plot->x);
  strut_axis_choose(&y, &plot->y);
  d.points = strut_arena_allocate(&arena, longest, sizeof *d.points);
  strut_status status =
      d.points ? draw_on_canvas(&d, plot, x, y, error) : strut_no_memory(error, "while drawing");
  strut_canvas_free(d.canvas);
  strut_arena_free(&arena);
  strut_c_locale_leave(locale);
  return status;
}

/* Velocity over the parameter: stable motions solid, unstable ones dashed, special points marked. */

/* Is the point marked in the figure? Events that change nothing are in the table alone. */
static bool point_is_marked(const strut_follow_point *p) {
  if (p->kind >= STRUT_FOLLOW_FOLD && p->kind <= STRUT_FOLLOW_TORUS) return true;
  return p->detail && p->changes;
}

/* What is drawn: velocity, or amplitude of what does not travel. */
static double point_height(const strut_follow_branch *b, const strut_follow_point *p) {
  return b->travels ? p->velocity : p->amplitude;
}

/* Appends the line of a branch and its marks. False: no memory. */
static bool add_branch(strut_branch_picture *p, const strut_follow_branch *b, strut_arena *arena) {
  strut_branch_line *line = &p->lines[p->line_count];
  line->data = strut_arena_allocate(arena, b->count, sizeof *line->data);
  line->stable = strut_arena_allocate(arena, b->count, sizeof *line->stable);
  if (!line->data || !line->stable) return false;
  line->look = p->line_count++;
  line->count = b->count;
  for (size_t k = 0; k < b->count; k++) {
    const strut_follow_point *point = &b->points[k];
    line->data[k][0] = point->value;
    line->data[k][1] = point_height(b, point);
    line->stable[k] = point->stable;
    if (!point_is_marked(point)) continue;
    p->marks[p->mark_count++] = (strut_branch_mark){
        .data = {point->value, point_height(b, point)}, .kind = point->kind, .node = point->node};
  }
  return true;
}

strut_status strut_follow_figure(const strut_plot *plot, const strut_follow_result *r,
                                 strut_error *error) {
  strut_arena arena = {0};
  strut_key_item keys[STRUT_BRANCH_KEYS];
  bool travels = r->count && r->branches[0].branch.travels;
  size_t points = 0;
  for (size_t i = 0; i < r->count; i++) points += r->branches[i].branch.count;
  strut_branch_picture p = {
      .title = r->title,
      .x = {.name = r->name, .unit = r->unit},
      .y = {.name = travels ? "velocity" : "amplitude", .unit = travels ? "m/s" : "m"},
      .lines = strut_arena_allocate(&arena, r->count + 1, sizeof *p.lines),
      .marks = strut_arena_allocate(&arena, points + 1, sizeof *p.marks),
      .keys = keys,
      .key_count = STRUT_BRANCH_KEYS};
  strut_branch_keys(keys);
  bool fine = p.lines && p.marks;
  for (size_t i = 0; i < r->count && fine; i++)
    fine = add_branch(&p, &r->branches[i].branch, &arena);
  strut_status status =
      fine ? strut_branch_draw(plot, &p, error) : strut_no_memory(error, "while drawing");
  strut_arena_free(&arena);
  return status;
}

/* The branches of a study in one figure: a colour for each point of the axes. */

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
static double row_height(const source *s, size_t row) {
  double amplitude = number_of(s->amplitude, row);
  return isfinite(amplitude) ? amplitude : number_of(s->velocity, row);
}

static strut_follow_kind row_kind(const source *s, size_t row) {
  for (int k = 0; k < STRUT_FOLLOW_KINDS; k++)
    if (strcmp(strut_follow_kind_word((strut_follow_kind)k), text_of(s->point, row)) == 0)
      return (strut_follow_kind)k;
  return STRUT_FOLLOW_REGULAR;
}

static bool row_is_marked(const source *s, size_t row) {
  strut_follow_kind kind = row_kind(s, row);
  return (kind >= STRUT_FOLLOW_FOLD && kind <= STRUT_FOLLOW_TORUS) ||
         strcmp(text_of(s->changes, row), "yes") == 0;
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
      const char *label = row_label(s, i, arena);
      if (!label) return false;
      keys[p->key_count++] = (strut_key_item){.sign = STRUT_KEY_LINE, .pen = pen, .text = label};
    }
    if (other || number_of(s->branch, i) != number_of(s->branch, i - 1))
      p->lines[p->line_count++] =
          (strut_branch_line){.look = look, .data = data + i, .stable = stable + i};
    p->lines[p->line_count - 1].count++;
    data[i][0] = number_of(s->value, i);
    data[i][1] = row_height(s, i);
    stable[i] = strcmp(text_of(s->stable, i), "yes") == 0;
    if (row_is_marked(s, i))
      p->marks[p->mark_count++] = (strut_branch_mark){
          .data = {data[i][0], data[i][1]}, .kind = row_kind(s, i), .node = text_of(s->node, i)};
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

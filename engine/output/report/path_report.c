/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/report/reports.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/output/buffer.h"
#include "engine/output/result_values.h"

enum {
  MOST_ROWS = 20,
  DIGITS = 6,
  LONG = 8,
  MOST_STOPS = 5,
  MOST_FORCES = 40,
  COLUMN = 14,
  LABEL = 20
};

static const double ROUNDING = 1e-12; /* of the largest force */

static strut_result_object object_of(const strut_path_state *state,
                                     const strut_result_object *path) {
  return (strut_result_object){state, path, path->scene, 0};
}

static double largest_force(const strut_path *path, const strut_scene *scene) {
  double most = 0;
  for (size_t k = 0; k < path->point_count; k++)
    for (size_t j = 0; j < scene->member_count; j++)
      most = fmax(most, fabs(path->points[k].at.force[j]));
  return most;
}

/* The largest of some values anywhere on the path; of supports and the ground that of members. */
static double largest_value(const strut_result_object *whole, size_t row) {
  const strut_path *path = whole->at;
  double most = 0;
  for (size_t k = 0; k < path->point_count; k++) {
    strut_value values[STRUT_MOST_VALUES];
    strut_result_object at = object_of(&path->points[k].at, whole);
    strut_path_state_values.fill(&at, values);
    const strut_value *value = &values[row];
    if (value->owner == STRUT_OWNER_NODE || value->owner == STRUT_OWNER_CONTACT)
      return largest_force(path, whole->scene);
    for (size_t i = 0; i < value->count; i++)
      most = fmax(most, fabs(strut_value_item(value, &at, i)));
  }
  return most;
}

/* A force as tables show it: 0 where it is a rounding of others. */
static double shown_force(double value, double largest) {
  return fabs(value) > ROUNDING * largest ? value : 0.0;
}

/* The node that is farthest from where the path began at some point of it; a free one if there is. */
static size_t farthest_node(const strut_path *path, const strut_scene *scene) {
  const double *from = path->points[0].at.q;
  double most = -1;
  size_t best = 0;
  for (int pass = 0; pass < 2 && most < 0; pass++)
    for (size_t k = 0; k < path->point_count; k++)
      for (size_t i = 0; i < scene->node_count; i++) {
        if (pass == 0 && scene->nodes[i].fixed[0] && scene->nodes[i].fixed[1]) continue;
        double dx = path->points[k].at.q[2 * i] - from[2 * i];
        double dy = path->points[k].at.q[2 * i + 1] - from[2 * i + 1];
        if (dx * dx + dy * dy > most * (1 + 1e-9)) most = dx * dx + dy * dy, best = i;
      }
  return best;
}

/* The parameter with its unit; a load's factor without. */
static const char *value_text(const strut_path *path, double value,
                              char text[STRUT_QUANTITY_TEXT]) {
  if (*path->unit) return strut_quantity_text(value, LONG, path->unit, text);
  snprintf(text, STRUT_QUANTITY_TEXT, "%.*g", LONG, value);
  return text;
}

/* The column of a displaced coordinate shows its reaction. */
static bool has_force(const strut_path *path) {
  return path->coordinate >= 0 || (path->over == STRUT_PATH_OVER_LOAD && path->reference > 0);
}

static double force_of(const strut_path *path, const strut_path_state *at) {
  return path->coordinate >= 0 ? at->reaction[path->coordinate] : at->factor * path->reference;
}

static void add_row(strut_buffer *table, const strut_path *path, const strut_path_state *at,
                    size_t node, const char *what, double largest) {
  const double *q = at->q + 2 * node, *from = path->points[0].at.q + 2 * node;
  double own = shown_force(force_of(path, at), largest);
  char value[STRUT_QUANTITY_TEXT], force[STRUT_QUANTITY_TEXT];
  char x[STRUT_QUANTITY_TEXT], y[STRUT_QUANTITY_TEXT];
  strut_buffer_add(table, "  %14s", value_text(path, at->factor, value));
  if (has_force(path))
    strut_buffer_add(table, "  %14s", strut_quantity_text(own, LONG, "N", force));
  strut_buffer_add(table, "  %14s  %14s  %s\n", strut_quantity_text(q[0] - from[0], DIGITS, "m", x),
                   strut_quantity_text(q[1] - from[1], DIGITS, "m", y), what);
}

/* Bytes of the first characters of a text, at most `most`; their number into *count. */
static int text_bytes(const char *text, int most, int *count) {
  int bytes = 0;
  for (*count = 0; text[bytes]; bytes++) {
    if (((unsigned char)text[bytes] & 0xC0) == 0x80) continue;
    if (*count == most) break;
    ++*count;
  }
  return bytes;
}

/* Adds a text cut to the width of a column, aligned right or left. */
static void add_cut(strut_buffer *table, const char *text, int columns, bool right) {
  int count, bytes = text_bytes(text, columns, &count);
  strut_buffer_add(table, "%*s%.*s%*s", right ? columns - count : 0, "", bytes, text,
                   right ? 0 : columns - count, "");
}

static void add_head(strut_buffer *table, const strut_path *path, const char *node) {
  static const char *const axes[] = {" moves x", " moves y"};
  strut_buffer_add(table, "  ");
  add_cut(table, path->over == STRUT_PATH_OVER_LOAD ? "factor" : path->name, COLUMN, true);
  if (has_force(path))
    strut_buffer_add(table, "  %*s", COLUMN,
                     path->coordinate >= 0 ? "reaction"
                     : path->several       ? "force of each"
                                           : "force");
  for (int axis = 0; axis < 2; axis++) {
    int count, bytes = text_bytes(node, COLUMN - (int)strlen(axes[axis]), &count);
    strut_buffer_add(table, "  %*s%.*s%s", COLUMN - (int)strlen(axes[axis]) - count, "", bytes,
                     node, axes[axis]);
  }
  strut_buffer_add(table, "\n");
}

/* The states that forces are printed of: the beginning, the first events, the end. */
static size_t choose_stops(const strut_path *path, const strut_path_state *stops[MOST_STOPS],
                           const char *heads[MOST_STOPS]) {
  size_t count = 1;
  heads[0] = "start";
  stops[0] = &path->points[0].at;
  for (size_t i = 0; i < path->event_count && count + 1 < MOST_STOPS; i++) {
    if (path->events[i].at.arc == stops[count - 1]->arc) continue;
    heads[count] = strut_path_event_name(path->events[i].kind);
    stops[count++] = &path->events[i].at;
  }
  heads[count] = "end";
  stops[count++] = &path->points[path->point_count - 1].at;
  return count;
}

/* A row for each thing that has such a force, as long as there is room. */
static void add_forces(strut_buffer *table, const strut_result_object *whole, size_t row,
                       const strut_path_state *const *stops, size_t count, size_t *rows) {
  const strut_value_row *what = &strut_path_state_values.row[row];
  strut_value values[MOST_STOPS][STRUT_MOST_VALUES], *first = &values[0][row];
  double largest = largest_value(whole, row);
  for (size_t k = 0; k < count; k++) {
    strut_result_object at = object_of(stops[k], whole);
    strut_path_state_values.fill(&at, values[k]);
  }
  size_t columns = first->columns;
  strut_result_object begin = object_of(stops[0], whole);
  for (size_t i = 0; i < columns * first->count; i++) {
    char text[STRUT_QUANTITY_TEXT];
    if (!strut_value_has(first, &begin, i) || (*rows)++ >= MOST_FORCES) continue;
    const char *name = strut_owner_name(first->owner, whole->scene, i / columns);
    const char *which = what->label[i % columns];
    int room = LABEL - (int)strlen(which), characters, bytes = text_bytes(name, room, &characters);
    strut_buffer_add(table, "  %.*s%s%*s", bytes, name, which, room - characters, "");
    for (size_t k = 0; k < count; k++) {
      double force = strut_value_item(&values[k][row], whole, i);
      strut_buffer_add(table, "  %14s",
                       strut_quantity_text(shown_force(force, largest), DIGITS, what->unit, text));
    }
    strut_buffer_add(table, "\n");
  }
}

/* Forces of members, supports and ground where something happens. */
static void add_force_table(strut_buffer *table, const strut_result_object *whole) {
  const strut_path *path = whole->at;
  const strut_path_state *stops[MOST_STOPS];
  const char *heads[MOST_STOPS];
  char text[STRUT_QUANTITY_TEXT];
  size_t count = choose_stops(path, stops, heads), rows = 0;
  strut_buffer_add(table, "\n  %-*s", LABEL, "forces at");
  for (size_t k = 0; k < count; k++) {
    strut_buffer_add(table, "  ");
    add_cut(table, heads[k], COLUMN, true);
  }
  strut_buffer_add(table, "\n  ");
  add_cut(table, path->over == STRUT_PATH_OVER_LOAD ? "factor" : path->name, LABEL, false);
  for (size_t k = 0; k < count; k++)
    strut_buffer_add(table, "  %14s", value_text(path, stops[k]->factor, text));
  strut_buffer_add(table, "\n");
  for (size_t i = 0; i < strut_path_state_values.count; i++)
    if (strut_path_state_values.row[i].label[0]) add_forces(table, whole, i, stops, count, &rows);
  if (rows > MOST_FORCES)
    strut_buffer_add(table, "  and %zu more; -o DIR writes all of them\n", rows - MOST_FORCES);
}

static bool was_stable(const strut_path *path) {
  for (size_t k = 0; k < path->point_count; k++)
    if (path->points[k].negative == 0) return true;
  return false;
}

static bool is_always_stable(const strut_path *path) {
  for (size_t k = 0; k < path->point_count; k++)
    if (path->points[k].negative > 0) return false;
  return true;
}

static const char *stability_of(const strut_path *path) {
  return is_always_stable(path) ? "stable" : was_stable(path) ? "stable in part" : "unstable";
}

/* One row for each stage before this one. */
static void add_stage_table(strut_buffer *table, const strut_path *path) {
  char from[STRUT_QUANTITY_TEXT], to[STRUT_QUANTITY_TEXT];
  if (!path->stage_count) return;
  strut_buffer_add(table,
                   "\n  stages before           from              to  points  events  over\n");
  for (size_t i = 0; i < path->stage_count; i++) {
    const strut_path *stage = &path->stages[i];
    strut_buffer_add(table, "  %13zu  %14s  %14s  %6zu  %6zu  %s, %s\n", i + 1,
                     value_text(stage, stage->points[0].at.factor, from),
                     value_text(stage, stage->points[stage->point_count - 1].at.factor, to),
                     stage->point_count, stage->event_count, stage->name, stability_of(stage));
  }
}

/* One row for each branch: where it leaves, how far it leads, stability, what it resembles. */
static void add_branch_table(strut_buffer *table, const strut_path *path) {
  char from[STRUT_QUANTITY_TEXT], to[STRUT_QUANTITY_TEXT];
  if (!path->branches) return;
  if (!path->branch_count) {
    strut_buffer_add(table,
                     "\n  no branches: the path has no bifurcation that one was followed from\n");
    return;
  }
  strut_buffer_add(table,
                   "\n  branch  leaves branch              at              to  points  events\n");
  for (size_t i = 0; i < path->branch_count; i++) {
    const strut_path *b = &path->branches[i];
    char number[16] = "path";
    if (b->from.path) snprintf(number, sizeof number, "%d", (int)b->from.path);
    strut_buffer_add(table, "  %6zu  %13s  %14s  %14s  %6zu  %6zu  %s", i + 1, number,
                     value_text(path, b->from.factor, from),
                     value_text(path, b->points[b->point_count - 1].at.factor, to), b->point_count,
                     b->event_count, stability_of(b));
    if (b->from.twin) strut_buffer_add(table, ", twin of branch %d", (int)b->from.twin);
    if (b->remark[0]) strut_buffer_add(table, "; %s", b->remark);
    strut_buffer_add(table, "\n");
  }
}

char *strut_path_table(const strut_path *path, const strut_scene *scene) {
  strut_buffer table = {0};
  size_t node = farthest_node(path, scene), at = 0;
  size_t every = (path->point_count + MOST_ROWS - 1) / MOST_ROWS;
  strut_result_object whole = {path, NULL, scene, 0};
  double largest = path->coordinate >= 0 ? largest_force(path, scene) : 0;
  strut_c_locale locale = strut_c_locale_enter();
  strut_buffer_add(&table, "%s%spath %s %s, %zu points\n\n", scene->name, *scene->name ? ": " : "",
                   path->over == STRUT_PATH_OVER_LOAD ? "of" : "over", path->name,
                   path->point_count);
  add_head(&table, path, scene->nodes[node].name);
  for (size_t k = 0; k < path->point_count; k++) {
    const strut_path_point *point = &path->points[k];
    for (; at < path->event_count && path->events[at].at.arc <= point->at.arc; at++) {
      char what[400];
      snprintf(what, sizeof what, "%s: %s", strut_path_event_name(path->events[at].kind),
               path->events[at].detail);
      add_row(&table, path, &path->events[at].at, node, what, largest);
    }
    if (k % every == 0 || k + 1 == path->point_count)
      add_row(&table, path, &point->at, node, point->negative ? "unstable" : "stable", largest);
  }
  add_force_table(&table, &whole);
  add_branch_table(&table, path);
  add_stage_table(&table, path);
  if (path->remark[0]) strut_buffer_add(&table, "\n%s\n", path->remark);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}

/* The parameter and what else a row begins with; then the values of its state. */
static void add_header(strut_buffer *csv, const strut_path *path, const strut_scene *scene) {
  bool loads = path->over == STRUT_PATH_OVER_LOAD, staged = path->stages;
  strut_result_object whole = {path, NULL, scene, 0}, at = object_of(&path->points[0].at, &whole);
  strut_buffer_add(csv, staged ? "stage,over,unit," : "");
  strut_buffer_add(csv, path->branches ? "branch," : "");
  strut_buffer_add(csv,
                   staged        ? "value"
                   : loads       ? "factor"
                   : *path->unit ? "value [%s]"
                                 : "value",
                   path->unit);
  if (loads && path->reference > 0 && !staged) strut_buffer_add(csv, ",force [N]");
  strut_buffer_add(csv, ",arc,negative_eigenvalues,event");
  strut_csv_add_names(csv, &strut_path_state_values, &at);
  strut_buffer_add(csv, "\n");
}

/* Whose rows are written, and the columns that they begin with. */
typedef struct rows {
  const strut_path *path; /* the whole, of which they are a stage or a branch */
  const strut_path *part;
  int stage, branch;
} rows;

static void add_numbers(strut_buffer *csv, const rows *of, const strut_scene *scene,
                        const strut_path_state *state, const char *negative, const char *event) {
  const strut_path *path = of->path;
  strut_result_object whole = {path, NULL, scene, 0}, at = object_of(state, &whole);
  if (path->stages) {
    strut_buffer_add(csv, "%d,", of->stage);
    strut_csv_add_text(csv, "%s", of->part->name);
    strut_buffer_add(csv, ",%s,", of->part->unit);
  }
  if (path->branches) strut_buffer_add(csv, "%d,", of->branch);
  strut_csv_add_number(csv, state->factor);
  if (path->over == STRUT_PATH_OVER_LOAD && path->reference > 0 && !path->stages) {
    strut_buffer_add(csv, ",");
    strut_csv_add_number(csv, state->factor * path->reference);
  }
  strut_buffer_add(csv, ",");
  strut_csv_add_number(csv, state->arc);
  strut_buffer_add(csv, ",%s,%s", negative, event);
  strut_csv_add_values(csv, &strut_path_state_values, &at);
  strut_buffer_add(csv, "\n");
}

static void add_rows(strut_buffer *csv, const rows *of, const strut_scene *scene) {
  const strut_path *path = of->part;
  size_t at = 0;
  for (size_t k = 0; k < path->point_count; k++) {
    const strut_path_point *point = &path->points[k];
    char negative[16];
    for (; at < path->event_count && path->events[at].at.arc <= point->at.arc; at++)
      add_numbers(csv, of, scene, &path->events[at].at, "",
                  strut_path_event_name(path->events[at].kind));
    snprintf(negative, sizeof negative, "%d", (int)point->negative);
    add_numbers(csv, of, scene, &point->at, negative, "");
  }
}

char *strut_path_csv(const strut_path *path, const strut_scene *scene) {
  strut_buffer csv = {0};
  int last = (int)path->stage_count + 1;
  add_header(&csv, path, scene);
  for (int i = 1; i < last; i++) add_rows(&csv, &(rows){path, &path->stages[i - 1], i, 0}, scene);
  add_rows(&csv, &(rows){path, path, last, 0}, scene);
  for (int i = 1; i <= (int)path->branch_count; i++)
    add_rows(&csv, &(rows){path, &path->branches[i - 1], last, i}, scene);
  return strut_buffer_take(&csv);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/report/reports.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/output/buffer.h"
#include "engine/output/json_value.h"

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

/* One line of a path, a point or an event. */
typedef struct state {
  double factor, arc;
  const double *q, *force, *moment, *reaction, *contact, *friction, *pressure, *distance;
} state;

static state state_of_point(const strut_path_point *p) {
  return (state){p->factor,   p->arc,     p->q,        p->force,    p->moment,
                 p->reaction, p->contact, p->friction, p->pressure, p->distance};
}

static state state_of_event(const strut_path_event *e) {
  return (state){e->factor,   e->arc,     e->q,        e->force,    e->moment,
                 e->reaction, e->contact, e->friction, e->pressure, e->distance};
}

/* ---- what carries load: one row for JSON, CSV and the table each ---- */

typedef enum carrier {
  MEMBERS,
  HINGES,
  CELLS,
  DISTANCES,
  SUPPORTS,
  CONTACTS,
  FRICTION,
  CARRIERS
} carrier;

/* Key in JSON; column of the CSV and words in the table, of supports along x and y; unit. */
static const struct {
  const char *key, *column[2], *words[2], *unit;
} carriers[CARRIERS] = {
    [MEMBERS] = {"forces", {"force [N]"}, {""}, "N"},
    [HINGES] = {"moments", {"moment [N m]"}, {" moment"}, "N m"},
    [CELLS] = {"pressures", {"pressure [N/m]"}, {" pressure"}, "N/m"},
    [DISTANCES] = {"distance_forces", {"force [N]"}, {""}, "N"},
    [SUPPORTS] = {"reactions",
                  {"reaction_x [N]", "reaction_y [N]"},
                  {" support x", " support y"},
                  "N"},
    [CONTACTS] = {"contacts", {"ground [N]"}, {" ground"}, "N"},
    [FRICTION] = {"friction", {"friction [N]"}, {" friction"}, "N"},
};

/* Number of values of a kind at a state; of supports two for each node. */
static size_t count_values(const strut_scene *scene, carrier kind) {
  const size_t counts[CARRIERS] = {
      scene->member_count,   scene->hinge_count,   scene->cell_count,   scene->distance_count,
      2 * scene->node_count, scene->contact_count, scene->contact_count};
  return counts[kind];
}

static const double *values_of(const state *at, carrier kind) {
  const double *const values[CARRIERS] = {at->force,    at->moment,  at->pressure, at->distance,
                                          at->reaction, at->contact, at->friction};
  return values[kind];
}

static const char *name_of(const strut_scene *scene, carrier kind, size_t i) {
  switch (kind) {
    case MEMBERS: return scene->members[i].name;
    case HINGES: return scene->hinges[i].name;
    case CELLS: return scene->cells[i].name;
    case DISTANCES: return scene->distances[i].name;
    case SUPPORTS: return scene->nodes[i / 2].name;
    case CONTACTS:
    case FRICTION: return strut_contact_name(scene, i);
    case CARRIERS: break;
  }
  return "";
}

/* The largest value of a kind anywhere on the path; of supports and the ground that of members. */
static double largest_value(const strut_path *path, const strut_scene *scene, carrier kind) {
  carrier of = kind == HINGES || kind == CELLS || kind == DISTANCES ? kind : MEMBERS;
  double most = 0;
  for (size_t k = 0; k < path->point_count; k++) {
    state at = state_of_point(&path->points[k]);
    for (size_t i = 0; i < count_values(scene, of); i++)
      most = fmax(most, fabs(values_of(&at, of)[i]));
  }
  return most;
}

/* A force as tables show it: 0 where it is a rounding of others. */
static double shown_force(double value, double largest) {
  return fabs(value) > ROUNDING * largest ? value : 0.0;
}

/* Of coordinates only those have a reaction that are held; there is friction only where it was kept. */
static bool has_value(const strut_path *path, carrier kind, size_t i) {
  return kind == FRICTION ? path->friction : kind != SUPPORTS || path->held[i];
}

static void add_nodes(strut_json *json, struct cJSON *to, const strut_scene *scene,
                      const double *q) {
  struct cJSON *nodes = strut_json_object(json, to, "nodes");
  for (size_t i = 0; i < scene->node_count; i++)
    strut_json_numbers(json, nodes, scene->nodes[i].name, q + 2 * i, 2);
}

/* Hinges and cells only where there are some; supports as pairs. */
static void add_forces(strut_json *json, struct cJSON *to, const strut_path *path,
                       const strut_scene *scene, const state *at) {
  for (carrier kind = MEMBERS; kind < CARRIERS; kind++) {
    size_t count = count_values(scene, kind);
    if (!count && (kind == HINGES || kind == CELLS || kind == DISTANCES)) continue;
    if (kind == FRICTION && !path->friction) continue;
    struct cJSON *values = strut_json_object(json, to, carriers[kind].key);
    for (size_t i = 0; i < count; i += kind == SUPPORTS ? 2 : 1) {
      const double *value = values_of(at, kind) + i;
      if (kind != SUPPORTS)
        strut_json_number(json, values, name_of(scene, kind, i), *value);
      else if (has_value(path, kind, i) || has_value(path, kind, i + 1))
        strut_json_numbers(json, values, name_of(scene, kind, i), value, 2);
    }
  }
}

/* The parameter: a load's factor and what it is in newtons, or a value. */
static void add_value(strut_json *json, struct cJSON *to, const strut_path *path, double value) {
  if (path->over != STRUT_PATH_OVER_LOAD) {
    strut_json_number(json, to, "value", value);
    return;
  }
  strut_json_number(json, to, "factor", value);
  if (path->reference > 0) strut_json_number(json, to, "force", value * path->reference);
}

static void add_points(strut_json *json, struct cJSON *to, const strut_path *path,
                       const strut_scene *scene) {
  struct cJSON *points = strut_json_array(json, to, "points");
  for (size_t i = 0; i < path->point_count; i++) {
    const strut_path_point *point = &path->points[i];
    struct cJSON *row = strut_json_object(json, points, NULL);
    state at = state_of_point(point);
    add_value(json, row, path, point->factor);
    strut_json_number(json, row, "arc", point->arc);
    strut_json_bool(json, row, "stable", point->negative == 0);
    strut_json_integer(json, row, "negative_eigenvalues", point->negative);
    add_nodes(json, row, scene, point->q);
    add_forces(json, row, path, scene, &at);
  }
}

static void add_events(strut_json *json, struct cJSON *to, const strut_path *path,
                       const strut_scene *scene) {
  struct cJSON *events = strut_json_array(json, to, "events");
  for (size_t i = 0; i < path->event_count; i++) {
    const strut_path_event *event = &path->events[i];
    struct cJSON *row = strut_json_object(json, events, NULL);
    state at = state_of_event(event);
    strut_json_text(json, row, "kind", strut_path_event_name(event->kind));
    add_value(json, row, path, event->factor);
    strut_json_number(json, row, "arc", event->arc);
    strut_json_text(json, row, "detail", event->detail);
    strut_json_bool(json, row, "stable_before", event->before == 0);
    strut_json_bool(json, row, "stable_after", event->after == 0);
    strut_json_integer(json, row, "negative_before", event->before);
    strut_json_integer(json, row, "negative_after", event->after);
    add_nodes(json, row, scene, event->q);
    add_forces(json, row, path, scene, &at);
  }
}

/* What is followed, why it ended, points and events. */
static void add_walk(strut_json *json, struct cJSON *to, const strut_path *path,
                     const strut_scene *scene) {
  strut_json_text(json, to, "load", path->load);
  strut_json_text(json, to, "over", path->over == STRUT_PATH_OVER_LOAD ? NULL : path->name);
  strut_json_text(json, to, "unit", path->unit);
  strut_json_text(json, to, "end", strut_path_end_word(path->end));
  strut_json_text(json, to, "remark", path->remark[0] ? path->remark : NULL);
  add_points(json, to, path, scene);
  add_events(json, to, path, scene);
}

static void add_branches(strut_json *json, const strut_path *path, const strut_scene *scene) {
  if (!path->branches) return;
  struct cJSON *branches = strut_json_array(json, json->root, "branches");
  for (size_t i = 0; i < path->branch_count; i++) {
    const strut_path *branch = &path->branches[i];
    struct cJSON *row = strut_json_object(json, branches, NULL);
    strut_json_integer(json, row, "from_branch", branch->from.path);
    add_value(json, row, path, branch->from.factor);
    strut_json_number(json, row, "arc", branch->from.arc);
    strut_json_integer(json, row, "twin", branch->from.twin);
    add_walk(json, row, branch, scene);
  }
}

char *strut_path_json(const strut_path *path, const strut_scene *scene) {
  strut_json json = strut_json_begin();
  strut_json_text(&json, json.root, "name", scene->name);
  strut_json_text(&json, json.root, "strut_version", STRUT_VERSION);
  add_walk(&json, json.root, path, scene);
  add_branches(&json, path, scene);
  struct cJSON *stages = path->stages ? strut_json_array(&json, json.root, "earlier_stages") : NULL;
  for (size_t i = 0; i < path->stage_count; i++)
    add_walk(&json, strut_json_object(&json, stages, NULL), &path->stages[i], scene);
  return strut_json_end(&json);
}

/* The node that is farthest from where the path began at some point of it; a free one if there is. */
static size_t farthest_node(const strut_path *path, const strut_scene *scene) {
  const double *from = path->points[0].q;
  double most = -1;
  size_t best = 0;
  for (int pass = 0; pass < 2 && most < 0; pass++)
    for (size_t k = 0; k < path->point_count; k++)
      for (size_t i = 0; i < scene->node_count; i++) {
        if (pass == 0 && scene->nodes[i].fixed[0] && scene->nodes[i].fixed[1]) continue;
        double dx = path->points[k].q[2 * i] - from[2 * i];
        double dy = path->points[k].q[2 * i + 1] - from[2 * i + 1];
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

static double force_of(const strut_path *path, const state *at) {
  return path->coordinate >= 0 ? at->reaction[path->coordinate] : at->factor * path->reference;
}

static void add_row(strut_buffer *table, const strut_path *path, const state *at, size_t node,
                    const char *what, double largest) {
  const double *q = at->q + 2 * node, *from = path->points[0].q + 2 * node;
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
static size_t choose_stops(const strut_path *path, state stops[MOST_STOPS],
                           const char *heads[MOST_STOPS]) {
  size_t count = 1;
  heads[0] = "start";
  stops[0] = state_of_point(&path->points[0]);
  for (size_t i = 0; i < path->event_count && count + 1 < MOST_STOPS; i++) {
    if (path->events[i].arc == stops[count - 1].arc) continue;
    heads[count] = strut_path_event_name(path->events[i].kind);
    stops[count++] = state_of_event(&path->events[i]);
  }
  heads[count] = "end";
  stops[count++] = state_of_point(&path->points[path->point_count - 1]);
  return count;
}

static void add_force_row(strut_buffer *table, const char *name, const char *which,
                          const char *unit, size_t count, const double *values,
                          const double *largest) {
  char text[STRUT_QUANTITY_TEXT];
  int characters, bytes = text_bytes(name, LABEL - (int)strlen(which), &characters);
  strut_buffer_add(table, "  %.*s%s%*s", bytes, name, which,
                   LABEL - (int)strlen(which) - characters, "");
  for (size_t k = 0; k < count; k++)
    strut_buffer_add(table, "  %14s",
                     strut_quantity_text(shown_force(values[k], largest[k]), DIGITS, unit, text));
  strut_buffer_add(table, "\n");
}

/* Forces of members, supports and ground where something happens. */
static void add_force_table(strut_buffer *table, const strut_path *path, const strut_scene *scene) {
  state stops[MOST_STOPS];
  const char *heads[MOST_STOPS];
  double values[MOST_STOPS], largest[MOST_STOPS];
  char text[STRUT_QUANTITY_TEXT];
  size_t count = choose_stops(path, stops, heads), rows = 0, left = 0;
  strut_buffer_add(table, "\n  %-*s", LABEL, "forces at");
  for (size_t k = 0; k < count; k++) {
    strut_buffer_add(table, "  ");
    add_cut(table, heads[k], COLUMN, true);
  }
  strut_buffer_add(table, "\n  ");
  add_cut(table, path->over == STRUT_PATH_OVER_LOAD ? "factor" : path->name, LABEL, false);
  for (size_t k = 0; k < count; k++)
    strut_buffer_add(table, "  %14s", value_text(path, stops[k].factor, text));
  strut_buffer_add(table, "\n");
  for (carrier kind = MEMBERS; kind < CARRIERS; kind++) {
    for (size_t k = 0; k < count; k++) largest[k] = largest_value(path, scene, kind);
    for (size_t i = 0; i < count_values(scene, kind); i++) {
      if (!has_value(path, kind, i) || rows++ >= MOST_FORCES) continue;
      for (size_t k = 0; k < count; k++) values[k] = values_of(&stops[k], kind)[i];
      add_force_row(table, name_of(scene, kind, i),
                    carriers[kind].words[kind == SUPPORTS ? i % 2 : 0], carriers[kind].unit, count,
                    values, largest);
    }
  }
  left = rows > MOST_FORCES ? rows - MOST_FORCES : 0;
  if (left) strut_buffer_add(table, "  and %zu more; -o DIR writes all of them\n", left);
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
                     value_text(stage, stage->points[0].factor, from),
                     value_text(stage, stage->points[stage->point_count - 1].factor, to),
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
                     value_text(path, b->points[b->point_count - 1].factor, to), b->point_count,
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
  double largest = path->coordinate >= 0 ? largest_value(path, scene, MEMBERS) : 0;
  strut_c_locale locale = strut_c_locale_enter();
  strut_buffer_add(&table, "%s%spath %s %s, %zu points\n\n", scene->name, *scene->name ? ": " : "",
                   path->over == STRUT_PATH_OVER_LOAD ? "of" : "over", path->name,
                   path->point_count);
  add_head(&table, path, scene->nodes[node].name);
  for (size_t k = 0; k < path->point_count; k++) {
    const strut_path_point *point = &path->points[k];
    state here = state_of_point(point);
    for (; at < path->event_count && path->events[at].arc <= point->arc; at++) {
      char what[400];
      state there = state_of_event(&path->events[at]);
      snprintf(what, sizeof what, "%s: %s", strut_path_event_name(path->events[at].kind),
               path->events[at].detail);
      add_row(&table, path, &there, node, what, largest);
    }
    if (k % every == 0 || k + 1 == path->point_count)
      add_row(&table, path, &here, node, point->negative ? "unstable" : "stable", largest);
  }
  add_force_table(&table, path, scene);
  add_branch_table(&table, path);
  add_stage_table(&table, path);
  if (path->remark[0]) strut_buffer_add(&table, "\n%s\n", path->remark);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}

static void add_cell(strut_buffer *csv, const char *name, const char *what) {
  strut_buffer_add(csv, ",");
  strut_csv_add_text(csv, "%s.%s", name, what);
}

static void add_number(strut_buffer *csv, double value) {
  strut_buffer_add(csv, ",");
  strut_csv_add_number(csv, value);
}

static void add_header(strut_buffer *csv, const strut_path *path, const strut_scene *scene) {
  static const char *const axes[] = {"x [m]", "y [m]"};
  bool loads = path->over == STRUT_PATH_OVER_LOAD, staged = path->stages;
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
  for (size_t i = 0; i < 2 * scene->node_count; i++)
    add_cell(csv, scene->nodes[i / 2].name, axes[i % 2]);
  for (carrier kind = MEMBERS; kind < CARRIERS; kind++)
    for (size_t i = 0; i < count_values(scene, kind); i++)
      if (has_value(path, kind, i))
        add_cell(csv, name_of(scene, kind, i), carriers[kind].column[kind == SUPPORTS ? i % 2 : 0]);
  strut_buffer_add(csv, "\n");
}

/* Whose rows are written, and the columns that they begin with. */
typedef struct rows {
  const strut_path *path; /* the whole, of which they are a stage or a branch */
  const strut_path *part;
  int stage, branch;
} rows;

static void add_numbers(strut_buffer *csv, const rows *of, const strut_scene *scene,
                        const state *at, const char *negative, const char *event) {
  const strut_path *path = of->path;
  if (path->stages) {
    strut_buffer_add(csv, "%d,", of->stage);
    strut_csv_add_text(csv, "%s", of->part->name);
    strut_buffer_add(csv, ",%s,", of->part->unit);
  }
  if (path->branches) strut_buffer_add(csv, "%d,", of->branch);
  strut_csv_add_number(csv, at->factor);
  if (path->over == STRUT_PATH_OVER_LOAD && path->reference > 0 && !path->stages)
    add_number(csv, at->factor * path->reference);
  add_number(csv, at->arc);
  strut_buffer_add(csv, ",%s,%s", negative, event);
  for (size_t i = 0; i < 2 * scene->node_count; i++) add_number(csv, at->q[i]);
  for (carrier kind = MEMBERS; kind < CARRIERS; kind++)
    for (size_t i = 0; i < count_values(scene, kind); i++)
      if (has_value(path, kind, i)) add_number(csv, values_of(at, kind)[i]);
  strut_buffer_add(csv, "\n");
}

static void add_rows(strut_buffer *csv, const rows *of, const strut_scene *scene) {
  const strut_path *path = of->part;
  size_t at = 0;
  for (size_t k = 0; k < path->point_count; k++) {
    const strut_path_point *point = &path->points[k];
    char negative[16];
    state here = state_of_point(point);
    for (; at < path->event_count && path->events[at].arc <= point->arc; at++) {
      state there = state_of_event(&path->events[at]);
      add_numbers(csv, of, scene, &there, "", strut_path_event_name(path->events[at].kind));
    }
    snprintf(negative, sizeof negative, "%d", (int)point->negative);
    add_numbers(csv, of, scene, &here, negative, "");
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

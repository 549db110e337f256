/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/path_report.h"

#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/number_text.h"
#include "engine/output/buffer.h"
#include "engine/output/json_value.h"
#include "engine/output/quantity_text.h"

enum { MOST_ROWS = 20, MOST_NODES = 4, DIGITS = 6 };

static void add_nodes(strut_json *json, struct cJSON *to, const strut_scene *scene,
                      const double *q) {
  struct cJSON *nodes = strut_json_object(json, to, "nodes");
  for (size_t i = 0; i < scene->node_count; i++)
    strut_json_numbers(json, nodes, scene->nodes[i].name, q + 2 * i, 2);
}

static const char *load_name(const strut_path *path) {
  return path->load ? path->load : "all loads";
}

static void add_points(strut_json *json, const strut_path *path, const strut_scene *scene) {
  struct cJSON *points = strut_json_array(json, json->root, "points");
  for (size_t i = 0; i < path->point_count; i++) {
    const strut_path_point *point = &path->points[i];
    struct cJSON *row = strut_json_object(json, points, NULL);
    strut_json_number(json, row, "factor", point->factor);
    strut_json_number(json, row, "arc", point->arc);
    strut_json_bool(json, row, "stable", point->negative == 0);
    strut_json_integer(json, row, "negative_eigenvalues", point->negative);
    add_nodes(json, row, scene, point->q);
  }
}

static void add_events(strut_json *json, const strut_path *path, const strut_scene *scene) {
  struct cJSON *events = strut_json_array(json, json->root, "events");
  for (size_t i = 0; i < path->event_count; i++) {
    const strut_path_event *event = &path->events[i];
    struct cJSON *row = strut_json_object(json, events, NULL);
    strut_json_text(json, row, "kind", strut_path_event_name(event->kind));
    strut_json_number(json, row, "factor", event->factor);
    strut_json_text(json, row, "detail", event->detail);
    add_nodes(json, row, scene, event->q);
  }
}

char *strut_path_json(const strut_path *path, const strut_scene *scene) {
  static const char *const ends[] = {"until", "steps", "away", "lost"};
  strut_json json = strut_json_begin();
  strut_json_text(&json, json.root, "name", scene->name);
  strut_json_text(&json, json.root, "strut_version", STRUT_VERSION);
  strut_json_text(&json, json.root, "load", path->load);
  strut_json_text(&json, json.root, "end", ends[path->end]);
  strut_json_text(&json, json.root, "remark", path->remark[0] ? path->remark : NULL);
  add_points(&json, path, scene);
  add_events(&json, path, scene);
  return strut_json_end(&json);
}

/* How far the nodes are from where the path began, for the node that is farthest at its end. */
static size_t farthest_node(const strut_path *path, const strut_scene *scene) {
  const double *from = path->points[0].q;
  double most = -1;
  size_t best = 0;
  for (size_t k = 0; k < path->point_count; k++)
    for (size_t i = 0; i < scene->node_count; i++) {
      double dx = path->points[k].q[2 * i] - from[2 * i];
      double dy = path->points[k].q[2 * i + 1] - from[2 * i + 1];
      if (dx * dx + dy * dy > most * (1 + 1e-9)) most = dx * dx + dy * dy, best = i;
    }
  return best;
}

static void add_row(strut_buffer *table, double factor, const double *q, const double *from,
                    const char *what) {
  char x[STRUT_QUANTITY_TEXT], y[STRUT_QUANTITY_TEXT];
  strut_buffer_add(table, "  %12.8g  %14s  %14s  %s\n", factor,
                   strut_quantity_text(q[0] - from[0], DIGITS, "m", x),
                   strut_quantity_text(q[1] - from[1], DIGITS, "m", y), what);
}

char *strut_path_table(const strut_path *path, const strut_scene *scene) {
  strut_buffer table = {0};
  size_t node = farthest_node(path, scene), at = 0;
  size_t every = (path->point_count + MOST_ROWS - 1) / MOST_ROWS;
  const double *from = path->points[0].q + 2 * node;
  strut_c_locale locale = strut_c_locale_enter();
  strut_buffer_add(&table, "%s%spath of %s, %zu points\n\n", scene->name, *scene->name ? ": " : "",
                   load_name(path), path->point_count);
  char head[2][STRUT_QUANTITY_TEXT];
  snprintf(head[0], sizeof head[0], "%.10s moves x", scene->nodes[node].name);
  snprintf(head[1], sizeof head[1], "%.10s moves y", scene->nodes[node].name);
  strut_buffer_add(&table, "  %12s  %14s  %14s\n", "factor", head[0], head[1]);
  for (size_t k = 0; k < path->point_count; k++) {
    const strut_path_point *point = &path->points[k];
    for (; at < path->event_count && path->events[at].arc <= point->arc; at++) {
      char what[300];
      snprintf(what, sizeof what, "%s: %s", strut_path_event_name(path->events[at].kind),
               path->events[at].detail);
      add_row(&table, path->events[at].factor, path->events[at].q + 2 * node, from, what);
    }
    if (k % every == 0 || k + 1 == path->point_count)
      add_row(&table, point->factor, point->q + 2 * node, from,
              point->negative ? "unstable" : "stable");
  }
  if (path->remark[0]) strut_buffer_add(&table, "\n%s\n", path->remark);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}

/* A cell of the header; RFC 4180 wants quotes around one that holds a comma, a quote or a break. */
static void add_cell(strut_buffer *csv, const char *name, const char *axis) {
  bool quoted = strpbrk(name, ",\"\r\n") != NULL;
  strut_buffer_add(csv, quoted ? ",\"" : ",");
  for (; *name; name++) strut_buffer_add(csv, *name == '"' ? "\"\"" : "%c", *name);
  strut_buffer_add(csv, ".%s [m]%s", axis, quoted ? "\"" : "");
}

static void add_numbers(strut_buffer *csv, double factor, double arc, const char *negative,
                        const char *event, const double *q, size_t count) {
  char text[STRUT_NUMBER_TEXT];
  strut_number_text(factor, text);
  strut_buffer_add(csv, "%s,", text);
  strut_number_text(arc, text);
  strut_buffer_add(csv, "%s,%s,%s", text, negative, event);
  for (size_t i = 0; i < count; i++) {
    strut_number_text(q[i], text);
    strut_buffer_add(csv, ",%s", text);
  }
  strut_buffer_add(csv, "\n");
}

char *strut_path_csv(const strut_path *path, const strut_scene *scene) {
  strut_buffer csv = {0};
  size_t at = 0, count = 2 * scene->node_count;
  strut_buffer_add(&csv, "factor,arc,negative_eigenvalues,event");
  for (size_t i = 0; i < scene->node_count; i++) {
    add_cell(&csv, scene->nodes[i].name, "x");
    add_cell(&csv, scene->nodes[i].name, "y");
  }
  strut_buffer_add(&csv, "\n");
  for (size_t k = 0; k < path->point_count; k++) {
    const strut_path_point *point = &path->points[k];
    char negative[16];
    for (; at < path->event_count && path->events[at].arc <= point->arc; at++) {
      const strut_path_event *event = &path->events[at];
      add_numbers(&csv, event->factor, event->arc, "", strut_path_event_name(event->kind), event->q,
                  count);
    }
    snprintf(negative, sizeof negative, "%d", (int)point->negative);
    add_numbers(&csv, point->factor, point->arc, negative, "", point->q, count);
  }
  return strut_buffer_take(&csv);
}

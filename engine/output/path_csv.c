/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A path of equilibria as a curve in CSV. */
#include <stdio.h>

#include "engine/output/buffer.h"
#include "engine/output/record_files.h"
#include "engine/output/result_values.h"
#include "engine/statics/path/path.h"

static strut_result_object object_of(const strut_path_state *state,
                                     const strut_result_object *path) {
  return (strut_result_object){state, path, path->scene, 0};
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

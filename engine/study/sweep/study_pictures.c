/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures of the runs of a study, one each, or two over one another. See study_runs.h. */
#include <stdint.h>
#include <string.h>

#include "engine/output/figures/run_figure.h"
#include "engine/study/sweep/grid.h"
#include "engine/study/sweep/study_runs.h"

/* The axis that `difference` names; axis_count: none. */
static strut_status find_axis(const strut_sweep_plan *plan, const strut_study_figure *figure,
                              size_t *axis, strut_error *error) {
  const strut_study *study = plan->study;
  *axis = study->axis_count;
  for (size_t i = 0; figure->difference && i < plan->axis_columns; i++)
    if (strcmp(plan->columns[i].name, figure->difference) == 0) strut_grid_column(study, i, axis);
  if (*axis == study->axis_count || study->axes[*axis].count == 2) return STRUT_OK;
  return strut_fail(
      error, STRUT_USAGE,
      "figure '%.60s' of the study: 'difference' needs an axis of two values; '%.60s' "
      "has %lld",
      figure->name, figure->difference, (long long)study->axes[*axis].count);
}

/* The point with the first value along that axis; itself where it is one. */
static int64_t partner(const strut_study *study, size_t axis, int64_t point) {
  int64_t stride = 1;
  for (size_t i = study->axis_count; --i > axis;) stride *= study->axes[i].count;
  return point / stride % 2 ? point - stride : point;
}

/* NAME-TEXT-TEXT.svg; a text that is no name of a file becomes one. */
static const char *file_of(const strut_sweep_plan *plan, const char *directory,
                           const strut_study_figure *figure, strut_study_opened *o) {
  char *name = strut_arena_format(&o->arena, "%s", figure->name);
  for (size_t i = 0; name && i < plan->axis_columns; i++) {
    const char *column = plan->columns[i].name;
    size_t axis, before = SIZE_MAX, length = figure->only ? strcspn(figure->only, "=") : 0;
    strut_grid_column(plan->study, i, &axis);
    if (i > 0) strut_grid_column(plan->study, i - 1, &before);
    bool told =
        plan->study->axes[axis].count > 1 && axis != before; /* what is zipped by its first */
    if (figure->difference && strcmp(column, figure->difference) == 0) told = false;
    if (figure->only && strlen(column) == length && memcmp(column, figure->only, length) == 0)
      told = false;
    if (told) name = strut_arena_format(&o->arena, "%s-%s", name, o->texts[i]);
  }
  for (char *c = name; c && *c; c++)
    if (*c == '/') *c = '_';
  return name ? strut_arena_format(&o->arena, "%s/%s.svg", directory, name) : NULL;
}

static strut_status draw(const strut_sweep_plan *plan, const char *directory,
                         const strut_study_figure *figure, double width, strut_study_opened *o,
                         const strut_study_opened *other, const char *other_name,
                         strut_error *error) {
  strut_model *model = NULL;
  const strut_run_figure picture = {
      .experiment = &o->setup.experiment,
      .view = figure->kind == STRUT_FIGURE_PERIOD ? STRUT_RUN_PERIOD : STRUT_RUN_SNAPSHOTS,
      .width = width,
      .scale = {figure->scale[0], figure->scale[1]},
      .time_count = figure->time_count,
      .times = figure->times,
      .other = other ? &other->motion : NULL,
      .other_name = other_name};
  const char *path = file_of(plan, directory, figure, o);
  if (!path) return strut_fail(error, STRUT_NO_MEMORY, "out of memory while drawing");
  strut_status status = strut_model_compile(&o->setup.scene, &model, error);
  if (!status) status = strut_run_figure_draw(path, &picture, model, &o->motion, NULL, error);
  strut_model_free(model);
  return status;
}

/* The picture of one point, if it has one. */
static strut_status draw_point(const strut_sweep_plan *plan, const char *directory,
                               const strut_study_figure *figure, double width, size_t axis,
                               int64_t point, bool *drawn, strut_error *error) {
  strut_study_opened o, other;
  bool there = false, beside = false, pairs = axis < plan->study->axis_count;
  int64_t with = pairs ? partner(plan->study, axis, point) : point;
  if (pairs && with == point) return STRUT_OK; /* drawn over its partner */
  strut_status status = strut_study_run_open(plan, directory, figure, point, &o, &there, error);
  if (!status && there && pairs) {
    status = strut_study_run_open(plan, directory, figure, with, &other, &beside, error);
    const char *name = NULL;
    for (size_t i = 0; i < plan->axis_columns && !status; i++)
      if (strcmp(plan->columns[i].name, figure->difference) == 0) name = other.texts[i];
    if (!status)
      status = draw(plan, directory, figure, width, &o, beside ? &other : NULL, name, error);
    strut_study_run_close(&other);
  } else if (!status && there) {
    status = draw(plan, directory, figure, width, &o, NULL, NULL, error);
  }
  *drawn = *drawn || there;
  strut_study_run_close(&o);
  return status;
}

strut_status strut_study_pictures(const strut_sweep_plan *plan, const char *directory,
                                  const strut_study_figure *figure, double width,
                                  strut_error *error) {
  size_t axis;
  bool drawn = false;
  strut_status status = find_axis(plan, figure, &axis, error);
  for (int64_t point = 0; point < plan->points && !status; point++)
    status = draw_point(plan, directory, figure, width, axis, point, &drawn, error);
  if (status || drawn) return status;
  return strut_fail(error, STRUT_USAGE, "figure '%.60s' of the study: no run recorded any of it",
                    figure->name);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The recorded runs of a study: their motion as one table, and figures of single runs. */
#include "engine/study/sweep/sweep.h"

#include <stdint.h>
#include <string.h>
#include <sys/stat.h>

#include "engine/base/text.h"
#include "engine/output/figures/run_figure.h"
#include "engine/output/trajectory.h"

/* ---- the recorded runs of a study ---- */

static const struct {
  const char *name, *unit;
} columns[] = {{"node", ""}, {"time", "s"}, {"elapsed", "s"}, {"x", "m"},
               {"y", "m"},   {"dx", "m"},   {"dy", "m"}};
enum { COLUMNS = sizeof columns / sizeof columns[0] };
static const size_t MOST_ROWS = 20000000;

const char *strut_study_motion_column(size_t i, const char **unit) {
  *unit = i < COLUMNS ? columns[i].unit : "";
  return i < COLUMNS ? columns[i].name : NULL;
}

/* Does the figure's `only` select this text of a column? */
static bool shows(const strut_study_figure *figure, const char *column, const char *text) {
  if (!figure->only) return true;
  size_t length = strcspn(figure->only, "=");
  if (strlen(column) != length || memcmp(column, figure->only, length) != 0) return true;
  return strcmp(figure->only + length + 1, text) == 0;
}

/* An opened run, from which pictures and motions are drawn. */
typedef struct opened_run {
  strut_study_value *values; /* (axis columns of the plan) */
  const char **texts;        /* the same as texts */
  strut_setup setup;
  strut_trajectory motion;
  strut_arena arena;
} opened_run;

/* Values of the axes at a point. */
static strut_status read_values(const strut_sweep_plan *plan, const strut_study_figure *figure,
                                int64_t point, opened_run *opened, bool *shown,
                                strut_error *error) {
  size_t count = plan->axis_columns;
  if (!STRUT_ALLOCATE(&opened->arena, STRUT_NEW(opened->values, count + 1),
                      STRUT_NEW(opened->texts, count + 1)))
    return strut_no_memory(error, "while drawing");
  strut_grid_values(plan->study, point, opened->values);
  for (size_t i = 0; i < count; i++) {
    char number[STRUT_NUMBER_TEXT];
    strut_number_text(opened->values[i].number, number);
    opened->texts[i] = opened->values[i].word
                           ? opened->values[i].word
                           : strut_arena_text(&opened->arena, number, strlen(number));
    if (!opened->texts[i]) return strut_no_memory(error, "while drawing");
    *shown = *shown && shows(figure, plan->columns[i].name, opened->texts[i]);
  }
  return STRUT_OK;
}

/*
 * Opens the run of a point. *there is false where it recorded nothing, or the figure leaves it out; nothing is open
 * then. Close it after a failure too.
 */
static strut_status open_run(const strut_sweep_plan *plan, const char *directory,
                             const strut_study_figure *figure, int64_t point, opened_run *opened,
                             bool *there, strut_error *error) {
  struct stat found;
  *opened = (opened_run){.motion = {0}};
  *there = false;
  bool shown = true;
  strut_status status = read_values(plan, figure, point, opened, &shown, error);
  if (status || !shown) return status;
  const char *folder =
      strut_arena_format(&opened->arena, "%s/runs/%09lld", directory, (long long)point);
  const char *file = folder ? strut_arena_format(&opened->arena, "%s/trajectory.h5", folder) : NULL;
  if (!file) return strut_no_memory(error, "while drawing");
  if (stat(file, &found) != 0) return STRUT_OK; /* it failed before recording anything */
  status = plan->scenes.setup(plan->scenes.context, opened->values, &opened->setup, error);
  if (!status)
    status = strut_trajectory_read(folder, &opened->setup.scene, STRUT_TRAJECTORY_ROOM,
                                   &opened->motion, error);
  if (!status && !opened->motion.position)
    status = strut_fail(error, STRUT_USAGE, "its runs recorded no positions");
  *there = !status && opened->motion.frames > 0;
  return status;
}

static void close_run(opened_run *opened) {
  strut_trajectory_free(&opened->motion);
  strut_setup_free(&opened->setup);
  strut_arena_free(&opened->arena);
  *opened = (opened_run){.motion = {0}};
}

/* The table being built, in whose arena all is. */
typedef struct builder {
  const strut_sweep_plan *plan;
  const strut_study_figure *figure;
  strut_table *table;
  size_t capacity; /* of rows */
} builder;

static bool has_text(const builder *self, size_t column) {
  return column <= self->plan->axis_columns;
}

static bool has_value(const builder *self, size_t column) {
  size_t axes = self->plan->axis_columns;
  return column < axes ? !self->plan->columns[column].word : column > axes;
}

static bool make_columns(builder *self) {
  strut_table *table = self->table;
  const strut_slot_column *axes = self->plan->columns;
  size_t count = self->plan->axis_columns;
  table->columns = strut_arena_allocate(&table->arena, count + COLUMNS, sizeof *table->columns);
  for (size_t i = 0; i < count + COLUMNS && table->columns; i++) {
    const char *unit = i < count ? axes[i].unit : columns[i - count].unit;
    table->columns[table->column_count++] =
        (strut_table_column){.name = i < count ? axes[i].name : columns[i - count].name,
                             .unit = strcmp(unit, "1") == 0 ? "" : unit};
  }
  return table->columns != NULL;
}

/* A larger block with what another has. */
static const void *larger(builder *self, const void *block, size_t capacity, size_t size) {
  void *to = strut_arena_allocate(&self->table->arena, capacity, size);
  if (to && self->table->row_count) memcpy(to, block, self->table->row_count * size);
  return to;
}

static bool reserve(builder *self, size_t rows) {
  strut_table *table = self->table;
  bool fine = true;
  if (rows <= self->capacity) return true;
  self->capacity = 2 * rows;
  for (size_t i = 0; i < table->column_count && fine; i++) {
    strut_table_column *column = &table->columns[i];
    if (has_text(self, i))
      column->text = larger(self, column->text, self->capacity, sizeof(char *));
    if (has_value(self, i))
      column->value = larger(self, column->value, self->capacity, sizeof(double));
    fine = (column->text || !has_text(self, i)) && (column->value || !has_value(self, i));
  }
  return fine;
}

/* A row for a node in a frame; texts (axes and node): those of the table's arena. */
static void add_row(builder *self, const opened_run *run, const char *const *texts, size_t frame,
                    size_t node) {
  const strut_trajectory *trajectory = &run->motion;
  const double *at = trajectory->position + 2 * (frame * trajectory->node_count + node);
  const double *from = trajectory->position + 2 * node;
  const double time = trajectory->time[frame];
  const double numbers[] = {
      time, time - trajectory->time[0], at[0], at[1], at[0] - from[0], at[1] - from[1]};
  size_t row = self->table->row_count++, axes = self->plan->axis_columns;
  for (size_t i = 0; i < self->table->column_count; i++) {
    const strut_table_column *column = &self->table->columns[i];
    if (has_text(self, i)) ((const char **)column->text)[row] = texts[i];
    if (has_value(self, i))
      ((double *)column->value)[row] = i < axes ? run->values[i].number : numbers[i - axes - 1];
  }
}

static strut_status add_run(builder *self, const opened_run *run, strut_error *error) {
  const strut_trajectory *trajectory = &run->motion;
  strut_table *table = self->table;
  size_t axes = self->plan->axis_columns;
  const char **texts = strut_arena_allocate(&table->arena, axes + 1, sizeof *texts);
  for (size_t i = 0; i < axes && texts; i++) {
    texts[i] = strut_arena_text(&table->arena, run->texts[i], strlen(run->texts[i]));
    if (!texts[i]) return strut_no_memory(error, "while drawing");
  }
  if (trajectory->frames > MOST_ROWS / trajectory->node_count ||
      table->row_count > MOST_ROWS - trajectory->frames * trajectory->node_count)
    return strut_fail(error, STRUT_USAGE, "more than %zu rows", MOST_ROWS);
  for (size_t node = 0; node < trajectory->node_count; node++) {
    const char *name = run->setup.scene.nodes[node].name;
    if (!shows(self->figure, "node", name)) continue;
    if (!texts || !reserve(self, table->row_count + trajectory->frames))
      return strut_no_memory(error, "while drawing");
    texts[axes] = strut_arena_text(&table->arena, name, strlen(name));
    if (!texts[axes]) return strut_no_memory(error, "while drawing");
    for (size_t f = 0; f < trajectory->frames; f++)
      if (trajectory->time[f] >= self->figure->from && trajectory->time[f] <= self->figure->to)
        add_row(self, run, texts, f, node);
  }
  return STRUT_OK;
}

strut_status strut_study_motion(const strut_sweep_plan *plan, const char *directory,
                                const strut_study_figure *figure, strut_table *table,
                                strut_error *error) {
  builder b = {.plan = plan, .figure = figure, .table = table};
  *table = (strut_table){0};
  strut_status status = make_columns(&b) ? STRUT_OK : strut_no_memory(error, "while drawing");
  for (int64_t point = 0; point < plan->points && !status; point++) {
    opened_run opened;
    bool there;
    status = open_run(plan, directory, figure, point, &opened, &there, error);
    if (!status && there) status = add_run(&b, &opened, error);
    close_run(&opened);
  }
  if (!status && !table->row_count)
    status = strut_fail(error, STRUT_USAGE, "no run recorded any of this");
  if (status) strut_arena_free(&table->arena);
  return status;
}

/* ---- figures of single runs ---- */

/* The axis that `difference` names, or axis_count. */
static size_t find_axis(const strut_sweep_plan *plan, const strut_study_figure *figure) {
  size_t axis = plan->study->axis_count;
  for (size_t i = 0; figure->difference && i < plan->axis_columns; i++)
    if (strcmp(plan->columns[i].name, figure->difference) == 0)
      strut_grid_column(plan->study, i, &axis);
  return axis;
}

/* The point with the first value along that axis. */
static int64_t partner(const strut_study *study, size_t axis, int64_t point) {
  int64_t stride = 1;
  for (size_t i = study->axis_count; --i > axis;) stride *= study->axes[i].count;
  return point / stride % 2 ? point - stride : point;
}

/* NAME-TEXT-TEXT.svg, with texts made valid as file names. */
static const char *file_of(const strut_sweep_plan *plan, const char *directory,
                           const strut_study_figure *figure, opened_run *opened) {
  char *name = strut_arena_format(&opened->arena, "%s", figure->name);
  for (size_t i = 0; name && i < plan->axis_columns; i++) {
    const char *column = plan->columns[i].name;
    size_t axis, before = SIZE_MAX, length = figure->only ? strcspn(figure->only, "=") : 0;
    strut_grid_column(plan->study, i, &axis);
    if (i > 0) strut_grid_column(plan->study, i - 1, &before);
    bool named = plan->study->axes[axis].count > 1 && axis != before; /* zipped: by the first */
    if (figure->difference && strcmp(column, figure->difference) == 0) named = false;
    if (figure->only && strlen(column) == length && memcmp(column, figure->only, length) == 0)
      named = false;
    if (named) name = strut_arena_format(&opened->arena, "%s-%s", name, opened->texts[i]);
  }
  for (char *c = name; c && *c; c++)
    if (*c == '/') *c = '_';
  return name ? strut_arena_format(&opened->arena, "%s/%s.svg", directory, name) : NULL;
}

/* The pictures of a figure: one for each point. */
typedef struct pictures {
  const strut_sweep_plan *plan;
  const char *directory;
  const strut_study_figure *figure;
  size_t axis; /* along which two points share a picture; axis_count: none */
  bool drawn;  /* some are */
} pictures;

static strut_status draw(const pictures *self, opened_run *opened, const opened_run *other,
                         const char *other_name, strut_error *error) {
  const strut_study_figure *figure = self->figure;
  strut_model *model = NULL;
  const strut_run_figure picture = {
      .experiment = &opened->setup.experiment,
      .view = figure->kind == STRUT_FIGURE_PERIOD ? STRUT_RUN_PERIOD : STRUT_RUN_SNAPSHOTS,
      .plot = {.path = file_of(self->plan, self->directory, figure, opened),
               .texts = self->plan->texts},
      .scale = {figure->scale[0], figure->scale[1]},
      .time_count = figure->time_count,
      .times = figure->times,
      .other = other ? &other->motion : NULL,
      .other_name = other_name};
  if (!picture.plot.path) return strut_no_memory(error, "while drawing");
  strut_status status = strut_model_compile(&opened->setup.scene, &model, error);
  if (!status) status = strut_run_figure_draw(&picture, model, &opened->motion, NULL, error);
  strut_model_free(model);
  return status;
}

/* Draws the figure of one point, if it has one. */
static strut_status draw_point(pictures *self, int64_t point, strut_error *error) {
  const strut_sweep_plan *plan = self->plan;
  opened_run o, other;
  bool there = false, beside = false, pairs = self->axis < plan->study->axis_count;
  int64_t with = pairs ? partner(plan->study, self->axis, point) : point;
  if (pairs && with == point) return STRUT_OK; /* drawn over its partner */
  strut_status status = open_run(plan, self->directory, self->figure, point, &o, &there, error);
  if (!status && there && pairs) {
    status = open_run(plan, self->directory, self->figure, with, &other, &beside, error);
    const char *name = NULL;
    for (size_t i = 0; i < plan->axis_columns && !status; i++)
      if (strcmp(plan->columns[i].name, self->figure->difference) == 0)
        name = plan->columns[i].word ? other.texts[i]
                                     : strut_arena_format(&other.arena, "%s %s",
                                                          plan->columns[i].name, other.texts[i]);
    if (!status) status = draw(self, &o, beside ? &other : NULL, name, error);
    close_run(&other);
  } else if (!status && there) {
    status = draw(self, &o, NULL, NULL, error);
  }
  self->drawn = self->drawn || there;
  close_run(&o);
  return status;
}

strut_status strut_study_pictures(const strut_sweep_plan *plan, const char *directory,
                                  const strut_study_figure *figure, strut_error *error) {
  pictures p = {plan, directory, figure, find_axis(plan, figure), false};
  strut_status status = STRUT_OK;
  for (int64_t point = 0; point < plan->points && !status; point++)
    status = draw_point(&p, point, error);
  if (status || p.drawn) return status;
  return strut_fail(error, STRUT_USAGE, "no run recorded any of this");
}

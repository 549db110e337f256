/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The recorded runs of a study: their motion as one table, and figures of single runs. */
#include "engine/study/sweep/study_runs.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "engine/base/number_text.h"
#include "engine/output/figures/run_figure.h"
#include "engine/study/sweep/grid.h"

/* ---- the recorded runs of a study ---- */

static const struct {
  const char *name, *unit;
} columns[] = {{"node", ""}, {"time", "s"}, {"elapsed", "s"}, {"x", "m"},
               {"y", "m"},   {"dx", "m"},   {"dy", "m"}};
enum { COLUMNS = sizeof columns / sizeof columns[0], NUMBERS = COLUMNS - 1 };
static const size_t MOST_ROWS = 20000000;

const char *strut_study_motion_column(size_t i) { return i < COLUMNS ? columns[i].name : NULL; }

bool strut_study_shows(const strut_study_figure *figure, const char *column, const char *text) {
  if (!figure->only) return true;
  size_t length = strcspn(figure->only, "=");
  if (strlen(column) != length || memcmp(column, figure->only, length) != 0) return true;
  return strcmp(figure->only + length + 1, text) == 0;
}

/* Values of the axes at a point. */
static strut_status read_values(const strut_sweep_plan *plan, const strut_study_figure *figure,
                                int64_t point, strut_study_opened *opened, bool *shown,
                                strut_error *error) {
  size_t count = plan->axis_columns;
  opened->values = strut_arena_allocate(&opened->arena, count + 1, sizeof *opened->values);
  opened->texts = strut_arena_allocate(&opened->arena, count + 1, sizeof *opened->texts);
  if (!opened->values || !opened->texts) return strut_no_memory(error, "while drawing");
  strut_grid_values(plan->study, point, opened->values);
  for (size_t i = 0; i < count; i++) {
    char number[STRUT_NUMBER_TEXT];
    strut_number_text(opened->values[i].number, number);
    opened->texts[i] = opened->values[i].word
                           ? opened->values[i].word
                           : strut_arena_text(&opened->arena, number, strlen(number));
    if (!opened->texts[i]) return strut_no_memory(error, "while drawing");
    *shown = *shown && strut_study_shows(figure, plan->columns[i].name, opened->texts[i]);
  }
  return STRUT_OK;
}

strut_status strut_study_run_open(const strut_sweep_plan *plan, const char *directory,
                                  const strut_study_figure *figure, int64_t point,
                                  strut_study_opened *opened, bool *there, strut_error *error) {
  struct stat found;
  *opened = (strut_study_opened){.motion = {0}};
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
    status = strut_fail(error, STRUT_USAGE,
                        "figure '%.60s' of the study: the runs recorded no "
                        "positions ('output: {channels: [position]}')",
                        figure->name);
  opened->run = (strut_study_run){.point = point,
                                  .values = opened->values,
                                  .texts = opened->texts,
                                  .scene = &opened->setup.scene,
                                  .motion = &opened->motion};
  *there = !status && opened->motion.frames > 0;
  return status;
}

void strut_study_run_close(strut_study_opened *opened) {
  strut_trajectory_free(&opened->motion);
  strut_setup_free(&opened->setup);
  strut_arena_free(&opened->arena);
  *opened = (strut_study_opened){.motion = {0}};
}

/* The table being built. */
typedef struct builder {
  const strut_sweep_plan *plan;
  const strut_study_figure *figure;
  strut_table *table;
  const char **texts[64]; /* (axis columns and node) in blocks of strut_allocate */
  double *axes[64];       /* (axis columns) of numbers */
  double *numbers[NUMBERS];
  size_t rows, capacity;
} builder;

static bool grow_texts(const char ***column, size_t capacity) {
  const char **more = strut_reallocate(*column, capacity, sizeof *more);
  if (more) *column = more;
  return more != NULL;
}

static bool grow_numbers(double **column, size_t capacity) {
  double *more = strut_reallocate(*column, capacity, sizeof *more);
  if (more) *column = more;
  return more != NULL;
}

static bool reserve(builder *self, size_t rows) {
  if (rows <= self->capacity) return true;
  size_t capacity = rows + rows / 2, axes = self->plan->axis_columns;
  bool fine = true;
  for (size_t i = 0; i <= axes && fine; i++) fine = grow_texts(&self->texts[i], capacity);
  for (size_t i = 0; i < axes && fine; i++) fine = grow_numbers(&self->axes[i], capacity);
  for (size_t i = 0; i < NUMBERS && fine; i++) fine = grow_numbers(&self->numbers[i], capacity);
  if (fine) self->capacity = capacity;
  return fine;
}

static void add_row(builder *self, const strut_study_run *run, const char *const *texts,
                    size_t frame, size_t node, const char *name) {
  const strut_trajectory *trajectory = run->motion;
  const double *at = trajectory->position + 2 * (frame * trajectory->node_count + node);
  const double *from = trajectory->position + 2 * node;
  const double numbers[NUMBERS] = {trajectory->time[frame],
                                   trajectory->time[frame] - trajectory->time[0],
                                   at[0],
                                   at[1],
                                   at[0] - from[0],
                                   at[1] - from[1]};
  size_t row = self->rows++;
  for (size_t i = 0; i < self->plan->axis_columns; i++) {
    self->texts[i][row] = texts[i];
    self->axes[i][row] = run->values[i].number;
  }
  self->texts[self->plan->axis_columns][row] = name;
  for (size_t i = 0; i < NUMBERS; i++) self->numbers[i][row] = numbers[i];
}

/* Texts that outlive the run, in the table's arena. */
static const char *kept(builder *self, const char *text) {
  return strut_arena_text(&self->table->arena, text, strlen(text));
}

static strut_status add_run(builder *self, const strut_study_run *run, strut_error *error) {
  const strut_trajectory *trajectory = run->motion;
  const char *texts[64];
  for (size_t i = 0; i < self->plan->axis_columns; i++) {
    texts[i] = kept(self, run->texts[i]);
    if (!texts[i]) return strut_no_memory(error, "while drawing");
  }
  if (trajectory->frames > MOST_ROWS / trajectory->node_count ||
      self->rows > MOST_ROWS - trajectory->frames * trajectory->node_count)
    return strut_fail(error, STRUT_USAGE, "figure '%.60s' of the study: more than %zu rows",
                      self->figure->name, MOST_ROWS);
  for (size_t node = 0; node < trajectory->node_count; node++) {
    if (!strut_study_shows(self->figure, "node", run->scene->nodes[node].name)) continue;
    const char *name = kept(self, run->scene->nodes[node].name);
    if (!name || !reserve(self, self->rows + trajectory->frames))
      return strut_no_memory(error, "while drawing");
    for (size_t f = 0; f < trajectory->frames; f++)
      if (trajectory->time[f] >= self->figure->from && trajectory->time[f] <= self->figure->to)
        add_row(self, run, texts, f, node, name);
  }
  return STRUT_OK;
}

/* Copies into the table's arena, which owns all of it. */
static const void *owned(builder *self, const void *block, size_t size) {
  void *copy = strut_arena_allocate(&self->table->arena, self->rows, size);
  if (copy && self->rows) memcpy(copy, block, self->rows * size); /* no rows: block may be NULL */
  return copy;
}

static strut_status finish(builder *self, strut_error *error) {
  strut_table *table = self->table;
  size_t axes = self->plan->axis_columns;
  table->row_count = self->rows;
  table->columns = strut_arena_allocate(&table->arena, axes + COLUMNS, sizeof *table->columns);
  if (!table->columns) return strut_no_memory(error, "while drawing");
  for (size_t i = 0; i < axes + COLUMNS; i++) {
    bool axis = i < axes, word = axis ? self->plan->columns[i].word : i == axes;
    strut_table_column *column = &table->columns[table->column_count++];
    const char *unit = axis ? self->plan->columns[i].unit : columns[i - axes].unit;
    column->name = axis ? self->plan->columns[i].name : columns[i - axes].name;
    column->unit = strcmp(unit, "1") == 0 ? "" : unit;
    if (i <= axes) column->text = owned(self, self->texts[i], sizeof(char *));
    if (!word)
      column->value =
          owned(self, axis ? self->axes[i] : self->numbers[i - axes - 1], sizeof(double));
    if ((i <= axes && !column->text) || (!word && !column->value))
      return strut_no_memory(error, "while drawing");
  }
  return STRUT_OK;
}

strut_status strut_study_motion(const strut_sweep_plan *plan, const char *directory,
                                const strut_study_figure *figure, strut_table *table,
                                strut_error *error) {
  builder b = {.plan = plan, .figure = figure, .table = table};
  strut_status status = STRUT_OK;
  *table = (strut_table){0};
  if (plan->axis_columns >= 64)
    return strut_fail(error, STRUT_USAGE, "motion is drawn of studies with up to 63 axes");
  for (int64_t point = 0; point < plan->points && !status; point++) {
    strut_study_opened opened;
    bool there;
    status = strut_study_run_open(plan, directory, figure, point, &opened, &there, error);
    if (!status && there) status = add_run(&b, &opened.run, error);
    strut_study_run_close(&opened);
  }
  if (!status && !b.rows)
    status = strut_fail(error, STRUT_USAGE,
                        "figure '%.60s' of the study: no run recorded any of this", figure->name);
  if (!status) status = finish(&b, error);
  for (size_t i = 0; i <= plan->axis_columns; i++) strut_release(b.texts[i]);
  for (size_t i = 0; i < plan->axis_columns; i++) strut_release(b.axes[i]);
  for (size_t i = 0; i < NUMBERS; i++) strut_release(b.numbers[i]);
  if (status) strut_arena_free(&table->arena);
  return status;
}

/* ---- figures of single runs ---- */

/* The axis that `difference` names, or axis_count. */
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

/* The point with the first value along that axis. */
static int64_t partner(const strut_study *study, size_t axis, int64_t point) {
  int64_t stride = 1;
  for (size_t i = study->axis_count; --i > axis;) stride *= study->axes[i].count;
  return point / stride % 2 ? point - stride : point;
}

/* NAME-TEXT-TEXT.svg, with texts made valid as file names. */
static const char *file_of(const strut_sweep_plan *plan, const char *directory,
                           const strut_study_figure *figure, strut_study_opened *opened) {
  char *name = strut_arena_format(&opened->arena, "%s", figure->name);
  for (size_t i = 0; name && i < plan->axis_columns; i++) {
    const char *column = plan->columns[i].name;
    size_t axis, before = SIZE_MAX, length = figure->only ? strcspn(figure->only, "=") : 0;
    strut_grid_column(plan->study, i, &axis);
    if (i > 0) strut_grid_column(plan->study, i - 1, &before);
    bool named =
        plan->study->axes[axis].count > 1 && axis != before; /* zipped axes by their first column */
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
  double width;
  size_t axis; /* along which two points share a picture; axis_count: none */
  bool drawn;  /* some are */
} pictures;

static strut_status draw(const pictures *self, strut_study_opened *opened,
                         const strut_study_opened *other, const char *other_name,
                         strut_error *error) {
  const strut_study_figure *figure = self->figure;
  strut_model *model = NULL;
  const strut_run_figure picture = {
      .experiment = &opened->setup.experiment,
      .view = figure->kind == STRUT_FIGURE_PERIOD ? STRUT_RUN_PERIOD : STRUT_RUN_SNAPSHOTS,
      .width = self->width,
      .scale = {figure->scale[0], figure->scale[1]},
      .time_count = figure->time_count,
      .times = figure->times,
      .other = other ? &other->motion : NULL,
      .other_name = other_name};
  const char *path = file_of(self->plan, self->directory, figure, opened);
  if (!path) return strut_no_memory(error, "while drawing");
  strut_status status = strut_model_compile(&opened->setup.scene, &model, error);
  if (!status) status = strut_run_figure_draw(path, &picture, model, &opened->motion, NULL, error);
  strut_model_free(model);
  return status;
}

/* Draws the figure of one point, if it has one. */
static strut_status draw_point(pictures *self, int64_t point, strut_error *error) {
  const strut_sweep_plan *plan = self->plan;
  strut_study_opened o, other;
  bool there = false, beside = false, pairs = self->axis < plan->study->axis_count;
  int64_t with = pairs ? partner(plan->study, self->axis, point) : point;
  if (pairs && with == point) return STRUT_OK; /* drawn over its partner */
  strut_status status =
      strut_study_run_open(plan, self->directory, self->figure, point, &o, &there, error);
  if (!status && there && pairs) {
    status =
        strut_study_run_open(plan, self->directory, self->figure, with, &other, &beside, error);
    const char *name = NULL;
    for (size_t i = 0; i < plan->axis_columns && !status; i++)
      if (strcmp(plan->columns[i].name, self->figure->difference) == 0) name = other.texts[i];
    if (!status) status = draw(self, &o, beside ? &other : NULL, name, error);
    strut_study_run_close(&other);
  } else if (!status && there) {
    status = draw(self, &o, NULL, NULL, error);
  }
  self->drawn = self->drawn || there;
  strut_study_run_close(&o);
  return status;
}

strut_status strut_study_pictures(const strut_sweep_plan *plan, const char *directory,
                                  const strut_study_figure *figure, double width,
                                  strut_error *error) {
  pictures p = {.plan = plan, .directory = directory, .figure = figure, .width = width};
  strut_status status = find_axis(plan, figure, &p.axis, error);
  for (int64_t point = 0; point < plan->points && !status; point++)
    status = draw_point(&p, point, error);
  if (status || p.drawn) return status;
  return strut_fail(error, STRUT_USAGE, "figure '%.60s' of the study: no run recorded any of this",
                    figure->name);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/sweep_figures.h"

#include <stdio.h>
#include <string.h>

#include "engine/output/figures/table_map.h"
#include "parser/cli/streams.h"
#include "parser/cli/table_file.h"
#include "parser/diagnostics.h"

static const double PAGE = 510.24; /* 180 mm [pt] */

static const char *column_name(const void *context, size_t i) {
  const strut_sweep_plan *plan = context;
  return i < plan->column_count ? plan->columns[i].name : NULL;
}

/* May the figure name this column? NULL is none. */
static strut_status check_column(const strut_sweep_plan *plan, const strut_study_figure *figure,
                                 const char *name, bool number, strut_error *error) {
  for (size_t i = 0; name && i < plan->column_count; i++) {
    if (strcmp(plan->columns[i].name, name) != 0) continue;
    if (!number || !plan->columns[i].word) return STRUT_OK;
    return strut_fail(error, STRUT_BAD_SCENE,
                      "figure '%.60s' of the study: column '%.60s' holds texts, not numbers",
                      figure->name, name);
  }
  if (!name) return STRUT_OK;
  const char *near = strut_did_you_mean(name, column_name, plan);
  return strut_fail(
      error, STRUT_BAD_SCENE, "figure '%.60s' of the study: the table has no column '%.60s'%s%s%s",
      figure->name, name, near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

/* COLUMN=TEXT, where the column has to be one of the table; the name is in `room`. */
static strut_status check_match(const strut_sweep_plan *plan, const strut_study_figure *figure,
                                const char *text, const char *key, strut_error *error) {
  char name[60];
  if (!text) return STRUT_OK;
  if (!strchr(text, '='))
    return strut_fail(error, STRUT_BAD_SCENE,
                      "figure '%.60s' of the study: '%s' expects COLUMN=TEXT, not '%.60s'",
                      figure->name, key, text);
  snprintf(name, sizeof name, "%.*s", (int)strcspn(text, "="), text);
  return check_column(plan, figure, name, false, error);
}

strut_status strut_sweep_figures_check(const strut_sweep_plan *plan, strut_error *error) {
  strut_status status = STRUT_OK;
  for (size_t i = 0; i < plan->study->figure_count && !status; i++) {
    const strut_study_figure *f = &plan->study->figures[i];
    status = check_column(plan, f, f->x, true, error);
    if (!status) status = check_column(plan, f, f->y, true, error);
    if (!status) status = check_column(plan, f, f->series, false, error);
    if (!status) status = check_column(plan, f, f->color, false, error);
    if (!status) status = check_column(plan, f, f->panels, false, error);
    if (!status) status = check_column(plan, f, f->difference, false, error);
    if (!status) status = check_match(plan, f, f->band, "band", error);
    if (!status) status = check_match(plan, f, f->only, "only", error);
  }
  return status;
}

static int column_of(const strut_table *table, const char *name) {
  for (size_t i = 0; name && i < table->column_count; i++)
    if (strcmp(table->columns[i].name, name) == 0) return (int)i;
  return STRUT_NO_COLUMN;
}

/* COLUMN=TEXT. */
static int column_of_match(const strut_table *table, const char *match, const char **text) {
  size_t length = match ? strcspn(match, "=") : 0;
  for (size_t i = 0; match && i < table->column_count; i++) {
    const char *name = table->columns[i].name;
    if (strlen(name) != length || memcmp(name, match, length) != 0) continue;
    *text = match + length + 1;
    return (int)i;
  }
  return STRUT_NO_COLUMN;
}

static strut_status draw(const strut_study_figure *f, const char *path, const strut_table *table,
                         strut_error *error) {
  strut_table_choice choice = {.difference = column_of(table, f->difference)};
  choice.only = column_of_match(table, f->only, &choice.only_value);
  if (f->map) {
    const strut_table_map_figure map = {.title = f->title,
                                        .width = PAGE,
                                        .x = column_of(table, f->x),
                                        .y = column_of(table, f->y),
                                        .value = column_of(table, f->color),
                                        .panels = column_of(table, f->panels),
                                        .doubt = column_of(table, "flips"),
                                        .choice = choice};
    return strut_table_map(path, &map, table, error);
  }
  strut_table_figure lines = {.title = f->title,
                                    .width = PAGE,
                                    .x = column_of(table, f->x),
                                    .y = {column_of(table, f->y)},
                                    .y_count = 1,
                                    .by = column_of(table, f->series),
                                    .panels = column_of(table, f->panels),
                                    .choice = choice};
  lines.band = column_of_match(table, f->band, &lines.band_value);
  return strut_table_curves(path, &lines, table, error);
}

strut_status strut_sweep_figures_draw(const strut_study *study, const char *directory,
                                      const char *path) {
  strut_table table = {0};
  if (study->figure_count == 0) return STRUT_OK;
  strut_status status = strut_table_read(path, &table);
  for (size_t i = 0; i < study->figure_count && !status; i++) {
    strut_error error = {0};
    const char *file =
        strut_arena_format(&table.arena, "%s/%s.svg", directory, study->figures[i].name);
    if (!file) status = strut_complain_of_memory();
    if (!status) status = draw(&study->figures[i], file, &table, &error);
    if (error.message[0]) strut_complain(&error);
  }
  strut_arena_free(&table.arena);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines over a parameter: stable motions solid, unstable ones dashed, special points marked. */
#include <math.h>
#include <string.h>

#include "engine/output/figures/table_figure.h"
#include "engine/study/follow/follow_study.h"

static int column_of(const strut_table *table, const char *name) {
  return strut_table_column_of(table, name, strlen(name));
}

/* Events that change nothing, and starts, are in the table alone. */
static bool is_marked(const char *point, const char *changes) {
  bool marked = *point && strcmp(changes, "yes") == 0;
  for (int kind = STRUT_FOLLOW_CUSP; kind <= STRUT_FOLLOW_TORUS; kind++)
    marked = marked || strcmp(point, strut_follow_kind_word((strut_follow_kind)kind)) == 0;
  return marked;
}

strut_status strut_follow_figure(const strut_plot *plot, const char *title, size_t axes,
                                 strut_table *table, strut_error *error) {
  const bool curves = column_of(table, "curve") >= 0;
  const int over = column_of(table, "arclength") + 1, point = column_of(table, "point");
  const int changes = column_of(table, "changes_stability"), wide = column_of(table, "amplitude");
  const char **mark = strut_arena_allocate(&table->arena, table->row_count + 1, sizeof *mark);
  if (over == 0 || point < 0 || wide < 0)
    return strut_fail(error, STRUT_FILE_TROUBLE, "the table of branches lacks a column");
  if (!mark) return strut_no_memory(error, "while drawing");
  const strut_table_column *columns = table->columns;
  const char *const *text = columns[point].text;
  for (size_t i = 0; i < table->row_count; i++)
    mark[i] = is_marked(text[i], changes < 0 ? "" : columns[changes].text[i]) ? text[i] : "";
  table->columns[point].text = mark;
  const char *groups[] = {curves ? "kind" : columns[axes ? axes - 1 : 0].name,
                          axes > 1 ? columns[axes - 2].name : NULL};
  strut_table_groups found;
  for (int k = 0; k < 2; k++) /* too many have neither colours nor panels */
    if (groups[k] && strut_table_groups_find(table, column_of(table, groups[k]),
                                             STRUT_MOST_TABLE_GROUPS, "", &found, NULL))
      groups[k] = NULL;
  strut_plot titled = *plot;
  if (!plot->title) titled.title = title;
  const strut_study_figure figure = {
      .x = columns[over].name,
      .y = columns[curves                ? over + 1
                   : columns[wide].value ? wide
                                         : column_of(table, "velocity")]
               .name,
      .series = groups[0],
      .panels = groups[1],
      .line = curves ? "curve" : "branch",
      .stable = "stable",
      .mark = "point",
      .thing = curves ? NULL : "node"};
  return strut_table_draw(&titled, &figure, table, false, error);
}

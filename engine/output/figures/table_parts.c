/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/table_parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/draw/legend.h"

static const double EDGE = 5, TITLE = 15, LOWEST = 165, HIGHEST = 260;

strut_status strut_table_groups_find(const strut_table *table, int column, size_t most,
                                     const char *what, strut_table_groups *g, strut_error *error) {
  g->count = 1;
  g->name[0] = NULL;
  if (column == STRUT_NO_COLUMN) return STRUT_OK;
  g->count = 0;
  for (size_t i = 0; i < table->row_count; i++) {
    const char *text = table->columns[column].text[i];
    size_t k = 0;
    while (k < g->count && strcmp(g->name[k], text) != 0) k++;
    if (k < g->count) continue;
    if (g->count == most)
      return strut_fail(error, STRUT_USAGE, "column '%s' makes more than %zu %s",
                        table->columns[column].name, most, what);
    g->name[g->count++] = text;
  }
  return STRUT_OK;
}

bool strut_table_belongs(const strut_table *table, int column, const char *name, size_t row) {
  return column == STRUT_NO_COLUMN || strcmp(table->columns[column].text[row], name) == 0;
}

strut_status strut_table_numbers(const strut_table *table, int column, strut_error *error) {
  if (table->columns[column].value) return STRUT_OK;
  return strut_fail(error, STRUT_USAGE, "column '%s' does not hold numbers",
                    table->columns[column].name);
}

void strut_table_panel_title(const strut_table *table, int column, const char *name, size_t panel,
                             char title[300]) {
  title[0] = '\0';
  if (column == STRUT_NO_COLUMN) return;
  const strut_table_column *c = &table->columns[column];
  snprintf(title, 300, "%c) %s = %s%s%s", (char)('a' + (int)(panel % 26)), c->name, name,
           *c->unit ? " " : "", c->unit);
}

strut_status strut_panel_page_draw(const char *path, const char *title,
                                   const strut_panel_page *page,
                                   void (*head)(void *context, strut_canvas *canvas, strut_box box),
                                   strut_panel_draw panel, void *context, strut_error *error) {
  double inner = page->width - 2 * EDGE, top = EDGE + (title ? TITLE : 0);
  size_t columns = (size_t)fmax(1, fmin(3, floor(inner / page->least_width)));
  if (columns > page->panels) columns = page->panels;
  size_t rows = (page->panels + columns - 1) / columns;
  double wide = inner / (double)columns;
  double high = fmax(LOWEST, fmin(page->aspect * wide, HIGHEST));
  strut_canvas *canvas = NULL;
  strut_status status =
      strut_canvas_open(path, page->width, top + page->head + (double)rows * high + EDGE,
                        title ? title : "", &canvas, error);
  if (status != STRUT_OK) return status;
  strut_font font = {.size = 9, .bold = true};
  char fitted[STRUT_FITTED_TEXT];
  if (title)
    strut_draw_text(canvas, EDGE, EDGE, strut_text_fit(canvas, title, font, inner, 0, fitted),
                    font);
  if (head) head(context, canvas, (strut_box){EDGE, top, inner, page->head});
  for (size_t k = 0; k < page->panels && status == STRUT_OK; k++)
    status = panel(context, canvas,
                   (strut_box){EDGE + (double)(k % columns) * wide,
                               top + page->head + (double)(k / columns) * high, wide, high},
                   k);
  if (status != STRUT_OK) strut_fail(error, status, "out of memory while drawing");
  if (status == STRUT_OK) status = strut_canvas_commit(canvas, error);
  strut_canvas_free(canvas);
  return status;
}

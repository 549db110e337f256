/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What people read of a result: the values that have a label. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/base/vec.h"
#include "engine/output/result_values.h"
#include "engine/scene/scene.h"

enum { MOST_INLINE = 10, TITLE = 80, WIDEST = 40 };

/* Part of the largest of several forces below which one is rounding, and shown as 0. */
static const double ROUNDING = 1e-12;

/* ---- texts of values ---- */

/* "rest_length" as "rest length", behind the title of the part that it is in. */
static const char *title_of(const strut_value_row *row, const char *part, const char *own,
                            char title[TITLE]) {
  const char *label = own ? own : row->label[0];
  size_t used = (size_t)snprintf(title, TITLE, "%s%s", part, *part ? " " : "");
  snprintf(title + used, TITLE - used, "%s", *label ? label : row->key);
  for (char *c = title + used; *c && (own || !*label); c++)
    if (*c == '_') *c = ' ';
  return title;
}

static void add_number(strut_buffer *text, const strut_value_row *row, const strut_value *value,
                       double number, int digits) {
  const char *unit = value->own_unit ? value->own_unit : row->unit;
  bool percent = row->label[1] && *row->label[1] == '%';
  if (value->digits) digits = value->digits;
  if (isnan(number)) return;
  if (percent && isfinite(number))
    strut_buffer_add(text, "%.3g %%", 100.0 * number);
  else if (isinf(number))
    strut_buffer_add(text, percent ? "diverged" : "any");
  else
    strut_buffer_add(
        text, "%s",
        strut_quantity_shown(number, digits, *unit ? unit : "1", (strut_file_unit){0}).text);
}

/* Numbers, names and values of an array, one after the other. */
static void add_value(strut_buffer *text, const strut_value_row *row, const strut_result_object *of,
                      const strut_value *value, int digits) {
  char room[STRUT_VALUE_ROOM] = "";
  const char *written = value->text;
  bool several = value->kind == STRUT_VALUE_NAMES || value->kind == STRUT_VALUE_MAP ||
                 (value->kind == STRUT_VALUE_NUMBERS && value->items);
  if (value->kind == STRUT_VALUE_WORDS) value->write(of, room), written = room;
  if (value->kind == STRUT_VALUE_NUMBER)
    add_number(text, row, value, value->number, digits);
  else if (value->kind == STRUT_VALUE_COUNT && strcmp(row->unit, "B") == 0)
    add_number(text, row, value, (double)value->integer, digits);
  else if (value->kind == STRUT_VALUE_COUNT)
    strut_buffer_add(text, "%lld", (long long)value->integer);
  else if (value->kind == STRUT_VALUE_FLAG)
    strut_buffer_add(text, value->integer ? "yes" : "no");
  else if (!several && written)
    strut_buffer_add(text, "%s", written);
  for (size_t i = 0, shown = 0; several && i < value->count; i++) {
    strut_value item = {
        .kind = STRUT_VALUE_NUMBER, .own_unit = value->own_unit, .digits = value->digits};
    if (value->kind == STRUT_VALUE_NAMES) item = STRUT_VALUE_AS_TEXT(value->name(of, i));
    if (value->kind == STRUT_VALUE_MAP) item = value->value(of, i);
    if (value->kind == STRUT_VALUE_NUMBERS)
      item.number = *(const double *)(const void *)((const char *)value->items + i * value->size);
    if (item.kind == STRUT_VALUE_ABSENT || (item.kind == STRUT_VALUE_TEXT && !item.text) ||
        (item.kind == STRUT_VALUE_NUMBER && isnan(item.number)))
      continue;
    if (shown) strut_buffer_add(text, shown < MOST_INLINE ? ", " : ", ...");
    if (shown++ == MOST_INLINE) return;
    add_value(text, row, of, &item, digits);
  }
}

/* ---- cells ---- */

/* A title and the values of several structs. */
typedef struct cell_column {
  const char *title;
  const char **cell; /* (items) NULL: empty */
  bool number;       /* which stand on the right */
  int width;         /* 0: all cells are empty */
} cell_column;

/* Columns in the order in which the first struct has them. */
typedef struct cell_table {
  cell_column column[2 * STRUT_MOST_VALUES];
  size_t count, items, item, next; /* next: column of the item */
  int digits;
  bool failed;
  strut_arena arena;
} cell_table;

/* Letters of a UTF-8 text, as a terminal's columns. */
static int letters(const char *text) {
  int count = 0;
  for (; text && *text; text++) count += ((unsigned char)*text & 0xC0) != 0x80;
  return count;
}

static void put_cell(cell_table *table, const char *title, const strut_value_row *row,
                     const strut_result_object *of, const strut_value *value) {
  strut_buffer buffer = {0};
  if (table->next == 2 * STRUT_MOST_VALUES) return;
  cell_column *column = &table->column[table->next++];
  if (table->next > table->count) {
    table->count = table->next;
    column->title = strut_arena_format(&table->arena, "%s", title);
    column->cell = strut_arena_allocate(&table->arena, table->items + 1, sizeof *column->cell);
    table->failed = table->failed || !column->title || !column->cell;
  }
  add_value(&buffer, row, of, value, table->digits);
  bool known = buffer.failed || buffer.length > 0;
  char *text = strut_buffer_take(&buffer);
  if (known && !table->failed) {
    const char *cell = text ? strut_arena_format(&table->arena, "%s", text) : NULL;
    int width = letters(cell);
    table->failed = !cell;
    column->cell[table->item] = cell;
    column->number |= value->kind == STRUT_VALUE_NUMBER || value->kind == STRUT_VALUE_COUNT;
    if (!column->width) column->width = letters(column->title);
    if (width > column->width) column->width = width;
  }
  strut_release(text);
}

/* A cell for each thing: "a", "a support x". */
static void put_things(cell_table *table, const strut_value_row *row, const strut_result_object *of,
                       const strut_value *value) {
  char title[TITLE];
  double largest = 0.0;
  for (size_t k = 0; k < value->columns * value->count; k++)
    if (strut_value_has(value, of, k))
      largest = fmax(largest, fabs(strut_value_item(value, of, k)));
  for (size_t k = 0; k < value->columns * value->count; k++) {
    const char *name = strut_owner_name(value->owner, of->scene, k / value->columns);
    if (!strut_value_has(value, of, k)) continue;
    snprintf(title, sizeof title, "%.50s%s", name, row->label[k % value->columns]);
    double number = strut_value_item(value, of, k);
    if (fabs(number) <= ROUNDING * largest) number = 0.0;
    put_cell(table, title, row, of, &STRUT_VALUE_AS_NUMBER(number));
  }
}

/* Cells of all values with a label but lists. */
static void put_cells(cell_table *table, const strut_value_rows *rows, const char *part,
                      const strut_result_object *of) {
  strut_value values[STRUT_MOST_VALUES];
  char title[TITLE], prefix[TITLE];
  rows->fill(of, values);
  for (size_t i = 0; i < rows->count; i++) {
    const strut_value_row *row = &rows->row[i];
    const strut_value *value = &values[i];
    const strut_result_object within = {value->items, of, of->scene, 0};
    if (value->kind == STRUT_VALUE_PART && (row->label[0] || !row->key)) {
      bool titled = row->label[0] && *row->label[0] != ' ';
      put_cells(table, row->rows, titled ? title_of(row, part, NULL, title) : part,
                value->items == of->at ? of : &within);
    } else if (!row->label[0] || value->kind == STRUT_VALUE_PART || row->rows ||
               (row->label[1] && *row->label[1] == '0' && value->number == 0.0)) {
      continue;
    } else if (value->kind == STRUT_VALUE_MAP && value->name) {
      const char *before = *row->label[0] ? title_of(row, part, NULL, prefix) : part;
      for (size_t k = 0; k < value->count; k++) {
        const strut_value item = value->value(of, k);
        put_cell(table, title_of(row, before, value->name(of, k), title), row, of, &item);
      }
    } else if (value->kind == STRUT_VALUE_THINGS) {
      put_things(table, row, of, value);
    } else if (value->kind == STRUT_VALUE_NUMBERS && row->label[1] && *row->label[1] != '%') {
      for (size_t k = 0; k < value->count; k++)
        put_cell(table, title_of(row, part, row->label[k], title), row, of,
                 &STRUT_VALUE_AS_NUMBER(strut_value_item(value, of, k)));
    } else {
      put_cell(table, title_of(row, part, value->own_unit ? value->text : NULL, title), row, of,
               value);
    }
  }
}

/* ---- layout ---- */

/* A cell of LaTeX: signs that mean something there, and "50 us". */
static void add_latex(strut_buffer *text, const char *cell) {
  for (const char *c = cell ? cell : ""; *c; c++)
    strut_buffer_add(text,
                     strchr("#$%&_{}", *c)                                       ? "\\%c"
                     : *c == 'u' && c > cell + 1 && c[-1] == ' ' && c[-2] <= '9' ? "\\textmu{}"
                     : *c == '^'                                                 ? "\\^{}"
                     : *c == '~'                                                 ? "\\~{}"
                     : *c == '\\' ? "\\textbackslash{}"
                                  : "%c",
                     *c);
}

/* The next cell of a line: as wide as its column or, in LaTeX, behind a mark unless it is the first. */
static void add_cell(strut_buffer *text, const char *cell, int width, bool right, bool first,
                     bool latex) {
  int fill = width > letters(cell) ? width - letters(cell) : 0;
  if (!latex)
    strut_buffer_add(text, "  %*s%s%*s", right ? fill : 0, "", cell ? cell : "", right ? 0 : fill,
                     "");
  if (latex && !first) strut_buffer_add(text, " & ");
  if (latex) add_latex(text, cell);
}

/* What stands around a table in LaTeX: `across` has a line for each value. */
static void begin_tabular(strut_buffer *text, const cell_table *table, bool across) {
  strut_buffer_add(text, "\\begin{tabular}{%s", across ? "l" : "");
  for (size_t i = 0; across && i < table->items; i++) strut_buffer_add(text, "r");
  for (size_t k = 0; !across && k < table->count; k++)
    if (table->column[k].width) strut_buffer_add(text, table->column[k].number ? "r" : "l");
  strut_buffer_add(text, "}\n\\hline\n");
}
static const char END_TABULAR[] = "\\hline\n\\end{tabular}\n";

static int width_of(const cell_column *column) {
  return column->width < WIDEST ? column->width : WIDEST;
}

/* The bytes of the first letters of a text. */
static int bytes_of(const char *text, int most) {
  int bytes = 0;
  for (; text[bytes] && (most > 0 || ((unsigned char)text[bytes] & 0xC0) == 0x80); bytes++)
    most -= ((unsigned char)text[bytes] & 0xC0) != 0x80;
  return bytes;
}

/* A line for each struct; long texts end early, but in the last column. */
static void add_lines(strut_buffer *text, const cell_table *table, bool latex) {
  size_t last = 0;
  for (size_t k = 0; k < table->count; k++)
    if (table->column[k].width) last = k;
  if (latex) begin_tabular(text, table, false);
  for (size_t i = 0; i <= table->items; i++) {
    bool first = true;
    for (size_t k = 0; k < table->count; k++) {
      const cell_column *column = &table->column[k];
      const char *cell = i ? column->cell[i - 1] : column->title;
      bool cut = !latex && k != last && letters(cell) > WIDEST;
      int width = k == last && !column->number ? 0 : width_of(column);
      if (!column->width || (k == last && !cell && !latex)) continue;
      if (cut)
        strut_buffer_add(text, "  %.*s...", bytes_of(cell, WIDEST - 3), cell);
      else
        add_cell(text, cell, width, column->number, first, latex);
      first = false;
    }
    strut_buffer_add(text, !latex ? "\n" : i ? " \\\\\n" : " \\\\\n\\hline\n");
  }
  if (latex) strut_buffer_add(text, END_TABULAR);
}

static int width_of_item(const cell_table *table, size_t item) {
  int width = 0;
  for (size_t k = 0; k < table->count; k++)
    if (letters(table->column[k].cell[item]) > width) width = letters(table->column[k].cell[item]);
  return width;
}

/* A line for each value, with as many structs side by side as there is width for. */
static void add_columns(strut_buffer *text, const cell_table *table, int width) {
  bool latex = width == STRUT_REPORT_LATEX, any = false;
  int titles = 0;
  for (size_t k = 0; k < table->count; k++) {
    any = any || table->column[k].width;
    if (table->column[k].width && letters(table->column[k].title) > titles)
      titles = letters(table->column[k].title);
  }
  if (!any) return;
  if (latex) begin_tabular(text, table, true);
  for (size_t first = 0, end; first < table->items; first = end) {
    int used = titles + 2;
    for (end = first; end < table->items; end++) {
      used += width_of_item(table, end) + 2;
      if (used > width && end > first && !latex) break;
    }
    if (first) strut_buffer_add(text, "\n");
    for (size_t k = 0; k < table->count; k++) {
      const cell_column *column = &table->column[k];
      if (!column->width) continue;
      add_cell(text, column->title, titles, false, true, latex);
      for (size_t i = first; i < end; i++)
        add_cell(text, column->cell[i], table->items > 1 ? width_of_item(table, i) : 0, true, false,
                 latex);
      strut_buffer_add(text, latex ? " \\\\\n" : "\n");
    }
  }
  if (latex) strut_buffer_add(text, END_TABULAR);
}

static void add_lists(strut_buffer *text, const strut_value_rows *rows,
                      const strut_result_object *of, const char *before,
                      const strut_table_page *page);

/* A table of the structs of a list, then the lists within each. */
static void add_list(strut_buffer *text, const strut_value_row *row, const strut_result_object *of,
                     const strut_value *list, const char *before, const strut_table_page *page) {
  static const strut_value_row name_row = {.unit = "", .label = {""}};
  cell_table *table = strut_allocate(1, sizeof *table);
  char title[TITLE], within[2 * TITLE];
  int all = 0, shown = 0;
  size_t more = 0;
  text->failed = text->failed || !table;
  if (!table) return;
  table->items = list->count < page->most ? list->count : page->most;
  table->digits = page->digits;
  strut_result_object *item = strut_arena_allocate(&table->arena, table->items + 1, sizeof *item);
  table->failed = !item;
  title_of(row, "", NULL, title);
  for (size_t i = 0; item && i < list->count; i++) {
    const strut_scene *scene = list->scene ? list->scene(of, i) : of->scene;
    const char *name = list->name ? list->name(of, i) : NULL;
    if ((list->name && !name) || !strut_value_has(list, of, i)) continue;
    if (table->item == table->items && ++more) continue;
    item[table->item] =
        (strut_result_object){(const char *)list->items + i * list->size, of, scene, i};
    table->next = 0;
    if (name) put_cell(table, title, &name_row, of, &STRUT_VALUE_AS_TEXT(name));
    put_cells(table, row->rows, "", &item[table->item]);
    table->item++;
  }
  table->items = table->item;
  for (size_t k = 0; k < table->count; k++)
    if (table->column[k].width) all += width_of(&table->column[k]) + 2, shown++;
  text->failed = text->failed || table->failed;
  bool latex = page->width == STRUT_REPORT_LATEX, few = 2 * (int)table->items <= shown;
  int width = latex ? STRUT_REPORT_WIDTH : page->width;
  bool across = all > (few ? width : 2 * width);
  if (all) strut_buffer_add(text, "\n%s%s%s\n", latex ? "% " : "", before, title);
  if (across && !text->failed)
    add_columns(text, table, page->width);
  else if (all && !text->failed)
    add_lines(text, table, latex);
  if (more)
    strut_buffer_add(text, "%s ... and %zu more: JSON and CSV have all\n", latex ? "%" : " ", more);
  for (size_t i = 0; i < table->items && !text->failed; i++) {
    const cell_column *first = table->column;
    bool named = table->count && !first->number && first->cell[i];
    snprintf(within, sizeof within, named ? "%.80s: " : "%s %zu: ", named ? first->cell[i] : title,
             item[i].index + 1);
    add_lists(text, row->rows, &item[i], within, page);
  }
  strut_arena_free(&table->arena);
  strut_release(table);
}

static void add_lists(strut_buffer *text, const strut_value_rows *rows,
                      const strut_result_object *of, const char *before,
                      const strut_table_page *page) {
  strut_value value[STRUT_MOST_VALUES];
  rows->fill(of, value);
  for (size_t i = 0; i < rows->count; i++) {
    const strut_value_row *row = &rows->row[i];
    const strut_result_object within = {value[i].items, of, of->scene, 0};
    if (value[i].kind == STRUT_VALUE_LIST && value[i].items && row->label[0])
      add_list(text, row, of, &value[i], before, page);
    else if (value[i].kind == STRUT_VALUE_MAP && row->rows && row->label[0])
      for (size_t k = 0; k < value[i].count; k++) {
        const strut_value list = value[i].value(of, k);
        add_list(text, row, of, &list, before, page);
      }
    else if (value[i].kind == STRUT_VALUE_PART && (!row->key || row->label[0]))
      add_lists(text, row->rows, value[i].items == of->at ? of : &within, before, page);
  }
}

void strut_values_add_tables(strut_buffer *text, const strut_value_rows *rows,
                             const strut_result_object *of, const strut_table_page *page) {
  cell_table *table = strut_allocate(1, sizeof *table);
  text->failed = text->failed || !table;
  if (!table) return;
  table->items = 1;
  table->digits = page->digits;
  put_cells(table, rows, "", of);
  if (!table->failed) add_columns(text, table, page->width);
  text->failed = text->failed || table->failed;
  strut_arena_free(&table->arena);
  strut_release(table);
  add_lists(text, rows, of, "", page);
}

char *strut_values_text(const strut_value_rows *rows, const void *result, const strut_scene *scene,
                        int width, size_t most) {
  const char *before = width == STRUT_REPORT_LATEX ? "% " : "";
  strut_buffer text = {0};
  strut_c_locale locale = strut_c_locale_enter();
  for (const char *line = scene ? scene->name : ""; *line; line += strspn(line, "\n")) {
    size_t length = strcspn(line, "\n");
    strut_buffer_add(&text, "%s%.*s\n", before, (int)length, line);
    line += length;
  }
  strut_values_add_tables(&text, rows, &(strut_result_object){result, NULL, scene, 0},
                          &(strut_table_page){width, most, 6});
  strut_c_locale_leave(locale);
  return strut_buffer_take(&text);
}

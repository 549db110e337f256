/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/results/study_table.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/number_text.h"
#include "engine/output/buffer.h"
#include "engine/output/file.h"

/* PART: bytes written at once. The buffer holds one more cell of any length. */
enum { PART = 1 << 16, MOST_CELL = 2 * STRUT_SLOT_MESSAGE + 2 };

/* Buffered text of the file. */
typedef struct writer {
  strut_file file;
  size_t used;
  bool failed;
  char buffer[PART + MOST_CELL];
} writer;

_Static_assert((int)STRUT_SLOT_WORD <= (int)STRUT_SLOT_MESSAGE &&
                   (int)STRUT_NUMBER_TEXT <= (int)MOST_CELL,
               "room for any one cell");

static void flush(writer *w) {
  if (!w->failed) {
    errno = 0;
    w->failed = fwrite(w->buffer, 1, w->used, w->file.stream) != w->used;
  }
  w->used = 0;
}

/* Ends a cell. */
static void end_cell(writer *w, char mark) {
  w->buffer[w->used++] = mark;
  if (w->used >= PART) flush(w);
}

static void put(writer *w, const char *bytes, size_t length) {
  while (length > 0) {
    size_t part = length < PART ? length : PART;
    if (w->used + part > PART) flush(w);
    memcpy(w->buffer + w->used, bytes, part);
    w->used += part;
    bytes += part;
    length -= part;
  }
}

static strut_status finish(writer *w, strut_error *error) {
  flush(w);
  if (!w->failed) return strut_file_commit(&w->file, error);
  strut_status status = strut_file_trouble(&w->file, error);
  strut_file_abandon(&w->file);
  return status;
}

static bool put_header(writer *w, const strut_slots_description *plan) {
  strut_buffer header = {0};
  strut_buffer_add(&header, "point,");
  for (size_t i = 0; i < plan->column_count; i++) {
    const strut_slot_column *column = &plan->columns[i];
    bool plain = strcmp(column->unit, "1") == 0 || !*column->unit;
    strut_csv_add_text(&header, plain ? "%s%s" : "%s [%s]", column->name,
                       plain ? "" : column->unit);
    strut_buffer_add(&header, ",");
  }
  strut_buffer_add(&header, "status,message\n");
  char *text = strut_buffer_take(&header);
  if (text) put(w, text, strlen(text));
  strut_release(text);
  return text != NULL;
}

static void put_number(writer *w, double value) {
  if (!isnan(value)) w->used += strut_number_text(value, w->buffer + w->used);
  end_cell(w, ',');
}

static void put_text(writer *w, const char *text, size_t room, char mark) {
  w->used += strut_csv_quote(text, room - 1, w->buffer + w->used);
  end_cell(w, mark);
}

static void put_row(writer *w, const strut_slots_description *plan, int64_t point,
                    const strut_result_slot *row) {
  size_t numbers = 0, words = 0;
  put_number(w, (double)point);
  for (size_t i = 0; i < plan->column_count; i++) {
    if (plan->columns[i].word)
      put_text(w, row->words[words++], STRUT_SLOT_WORD, ',');
    else
      put_number(w, row->numbers[numbers++]);
  }
  put_text(w, strut_status_text(row->status), STRUT_SLOT_MESSAGE, ',');
  put_text(w, row->message, STRUT_SLOT_MESSAGE, '\n');
}

/* The table of all rows, or of those that there are. */
static strut_status write_table(const char *directory, const char *name,
                                strut_slots *const *sources, size_t count, bool partial,
                                int64_t *rows, strut_error *error) {
  writer w = {.used = 0};
  const strut_slots_description *plan = strut_slots_description_of(sources[0]);
  strut_status status = strut_file_open(&w.file, directory, name, error);
  if (status != STRUT_OK) return status;
  if (!put_header(&w, plan)) {
    strut_file_abandon(&w.file);
    return strut_no_memory(error, "");
  }
  *rows = 0;
  for (int64_t point = 0; point < plan->points && !w.failed; point++) {
    strut_result_slot row;
    strut_slots *source = sources[(size_t)point % count];
    if (partial && !strut_slots_done(source, point)) continue;
    if (strut_slots_get(source, point, &row)) {
      put_row(&w, plan, point, &row);
      ++*rows;
    } else if (!partial) {
      strut_file_abandon(&w.file);
      return strut_fail(error, STRUT_USAGE, "no table yet: point %lld is missing",
                        (long long)point);
    }
  }
  return finish(&w, error);
}

strut_status strut_study_table_write(const char *directory, const char *name,
                                     strut_slots *const *sources, size_t count,
                                     strut_error *error) {
  int64_t rows;
  return write_table(directory, name, sources, count, false, &rows, error);
}

strut_status strut_study_table_write_partial(const char *directory, const char *name,
                                             strut_slots *const *sources, size_t count,
                                             int64_t *rows, strut_error *error) {
  int64_t unread;
  return write_table(directory, name, sources, count, true, rows ? rows : &unread, error);
}

strut_status strut_study_table_write_points(const char *directory, const char *name,
                                            strut_slots *source, const int64_t *points,
                                            size_t count, strut_error *error) {
  writer w = {.used = 0};
  const strut_slots_description *plan = strut_slots_description_of(source);
  strut_status status = strut_file_open(&w.file, directory, name, error);
  if (status != STRUT_OK) return status;
  if (!put_header(&w, plan)) {
    strut_file_abandon(&w.file);
    return strut_no_memory(error, "");
  }
  for (size_t i = 0; i < count && !w.failed; i++) {
    strut_result_slot row;
    if (strut_slots_get(source, points[i], &row)) put_row(&w, plan, points[i], &row);
  }
  return finish(&w, error);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/study_table.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/number_text.h"
#include "engine/output/file.h"

enum { BUFFER = 1 << 16 };

/* Text on its way into the file. */
typedef struct writer {
  strut_file file;
  size_t used;
  bool failed;
  char buffer[BUFFER];
} writer;

static void put(writer *w, const char *bytes, size_t length) {
  while (length > 0 && !w->failed) {
    size_t part = length < sizeof w->buffer - w->used ? length : sizeof w->buffer - w->used;
    memcpy(w->buffer + w->used, bytes, part);
    w->used += part;
    bytes += part;
    length -= part;
    if (w->used < sizeof w->buffer && length == 0) break;
    errno = 0;
    w->failed = fwrite(w->buffer, 1, w->used, w->file.stream) != w->used;
    w->used = 0;
  }
}

static strut_status finish(writer *w, strut_error *error) {
  errno = 0;
  if (!w->failed) w->failed = fwrite(w->buffer, 1, w->used, w->file.stream) != w->used;
  if (!w->failed) return strut_file_commit(&w->file, error);
  strut_status status = strut_file_trouble(&w->file, error);
  strut_file_abandon(&w->file);
  return status;
}

/* A cell of two texts; RFC 4180 wants quotes around one that holds a comma, a quote or a break. */
static void put_cell(writer *w, const char *text, const char *unit) {
  bool quoted = strpbrk(text, ",\"\r\n") || strpbrk(unit, ",\"\r\n");
  if (quoted) put(w, "\"", 1);
  const char *parts[] = {text, *unit ? " [" : "", unit, *unit ? "]" : ""};
  for (int i = 0; i < 4; i++)
    for (const char *at = parts[i]; *at;) {
      size_t length = strcspn(at, "\"");
      put(w, at, length);
      at += length;
      if (*at) {
        put(w, "\"\"", 2);
        at++;
      }
    }
  if (quoted) put(w, "\"", 1);
}

static void put_header(writer *w, const strut_slots_plan *plan) {
  put(w, "point,", 6);
  for (size_t i = 0; i < plan->column_count; i++) {
    const strut_slot_column *column = &plan->columns[i];
    put_cell(w, column->name, strcmp(column->unit, "1") == 0 ? "" : column->unit);
    put(w, ",", 1);
  }
  put(w, "status,message\n", 15);
}

static void put_number(writer *w, double value) {
  char text[STRUT_NUMBER_TEXT];
  if (!isnan(value)) put(w, text, strut_number_text(value, text));
  put(w, ",", 1);
}

static void put_row(writer *w, const strut_slots_plan *plan, int64_t point, const strut_slot *row) {
  char number[STRUT_NUMBER_TEXT];
  size_t numbers = 0, words = 0;
  int length = snprintf(number, sizeof number, "%lld,", (long long)point);
  put(w, number, (size_t)length);
  for (size_t i = 0; i < plan->column_count; i++) {
    if (plan->columns[i].word) {
      put_cell(w, row->words[words++], "");
      put(w, ",", 1);
    } else {
      put_number(w, row->numbers[numbers++]);
    }
  }
  put_cell(w, strut_status_text(row->status), "");
  put(w, ",", 1);
  put_cell(w, row->message, "");
  put(w, "\n", 1);
}

strut_status strut_study_table_write(const char *directory, const char *name,
                                     strut_slots *const *sources, size_t count,
                                     strut_error *error) {
  writer w = {.used = 0};
  const strut_slots_plan *plan = strut_slots_plan_of(sources[0]);
  strut_status status = strut_file_open(&w.file, directory, name, error);
  if (status != STRUT_OK) return status;
  put_header(&w, plan);
  for (int64_t point = 0; point < plan->points && !w.failed; point++) {
    strut_slot row;
    if (!strut_slots_get(sources[(size_t)point % count], point, &row)) {
      strut_file_abandon(&w.file);
      return strut_fail(error, STRUT_USAGE, "no table yet: point %lld is missing",
                        (long long)point);
    }
    put_row(&w, plan, point, &row);
  }
  return finish(&w, error);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/record_files.h"

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/output/buffer.h"
#include "engine/output/file.h"

enum { BUFFER = 1 << 16 };

typedef struct table {
  strut_file file;
  size_t column_count;
  size_t *columns; /* (column_count) places in a row of the recorder */
} table;

typedef struct csv {
  strut_sink sink;
  const char *directory;
  strut_arena arena;               /* of its name */
  size_t width;                    /* doubles in a row of the recorder */
  table tables[STRUT_OWNER_COUNT]; /* a file without channels is not written */
  size_t used;
  char buffer[BUFFER]; /* not yet written */
} csv;

static const char *file_name(int owner) {
  return strut_owner_row_of((strut_channel_owner)owner)->file;
}

static strut_status flush(csv *self, table *t, strut_error *error) {
  size_t count = self->used;
  self->used = 0;
  if (fwrite(self->buffer, 1, count, t->file.stream) == count) return STRUT_OK;
  return strut_file_trouble(&t->file, error);
}

/* "n1.x [m]", "n1.vx [m/s]", "m1.length [m]", "kinetic [J]". */
static void add_name(strut_buffer *header, const strut_record_channel *channel, size_t item,
                     size_t component) {
  const strut_channel_row *row = strut_channel_row_of(channel->id);
  bool whole = strut_channel_is_whole(row);
  strut_buffer_add(header, ",");
  strut_csv_add_text(header, "%s%s%s [%s]", whole ? "" : channel->item_names[item],
                     whole ? "" : ".", row->column_names[component],
                     channel->item_units ? channel->item_units[item] : channel->unit);
}

static bool is_in_table(const strut_record_channel *channel, int owner) {
  return (int)strut_channel_row_of(channel->id)->owner == owner;
}

/* Adds the columns of one item, channel by channel, so that the columns of a node are adjacent. */
static void add_item(table *self, strut_buffer *header, const strut_record_layout *layout,
                     int owner, size_t item) {
  for (size_t i = 0; i < layout->channel_count; i++) {
    const strut_record_channel *channel = &layout->channels[i];
    if (!is_in_table(channel, owner) || item >= channel->items) continue;
    for (size_t j = 0; j < channel->components; j++) {
      self->columns[self->column_count++] = channel->offset + item * channel->components + j;
      add_name(header, channel, item, j);
    }
  }
}

static strut_status begin_table(csv *self, int owner, const strut_record_layout *layout,
                                strut_error *error) {
  table *t = &self->tables[owner];
  size_t total = 0, items = 0;
  for (size_t i = 0; i < layout->channel_count; i++) {
    const strut_record_channel *channel = &layout->channels[i];
    if (!is_in_table(channel, owner)) continue;
    total += channel->items * channel->components;
    if (channel->items > items) items = channel->items;
  }
  if (total == 0) return STRUT_OK;
  t->columns = strut_allocate(total, sizeof *t->columns);
  if (!t->columns) return strut_no_memory(error, "for the CSV columns");
  strut_status status = strut_file_open(&t->file, self->directory, file_name(owner), error);
  if (status != STRUT_OK) return status;
  strut_buffer header = {0};
  strut_buffer_add(&header, "time [s]");
  for (size_t item = 0; item < items; item++) add_item(t, &header, layout, owner, item);
  strut_buffer_add(&header, "\n");
  char *text = strut_buffer_take(&header);
  if (!text) return strut_no_memory(error, "for the CSV columns");
  fputs(text, t->file.stream);
  strut_release(text);
  return ferror(t->file.stream) ? strut_file_trouble(&t->file, error) : STRUT_OK;
}

static void abandon(csv *self) {
  for (int i = 0; i < STRUT_OWNER_COUNT; i++) {
    strut_file_abandon(&self->tables[i].file);
    strut_release(self->tables[i].columns);
    self->tables[i] = (table){0};
  }
}

static strut_status begin(void *context, const strut_record_layout *layout, strut_error *error) {
  csv *self = context;
  self->width = layout->width;
  for (int owner = 0; owner < STRUT_OWNER_COUNT; owner++) {
    strut_status status = begin_table(self, owner, layout, error);
    if (status == STRUT_OK) continue;
    abandon(self);
    return status;
  }
  return STRUT_OK;
}

static strut_status write_rows(csv *self, table *t, const double *rows, size_t count,
                               strut_error *error) {
  for (const double *row = rows; count > 0; count--, row += self->width) {
    for (size_t i = 0; i <= t->column_count; i++) { /* the time, then the columns */
      if (self->used + STRUT_NUMBER_TEXT + 1 > BUFFER) {
        strut_status status = flush(self, t, error);
        if (status != STRUT_OK) return status;
      }
      char *at = self->buffer + self->used;
      size_t length = strut_number_text(row[i ? t->columns[i - 1] : 0], at);
      at[length] = i == t->column_count ? '\n' : ',';
      self->used += length + 1;
    }
  }
  return flush(self, t, error);
}

static strut_status take_rows(void *context, const double *rows, size_t count, strut_error *error) {
  csv *self = context;
  for (int i = 0; i < STRUT_OWNER_COUNT; i++) {
    table *t = &self->tables[i];
    strut_status status = t->columns ? write_rows(self, t, rows, count, error) : STRUT_OK;
    if (status != STRUT_OK) return status;
  }
  return STRUT_OK;
}

/* Completes all files or none. */
static strut_status commit(csv *self, strut_error *error) {
  for (int i = 0; i < STRUT_OWNER_COUNT; i++) {
    if (!self->tables[i].file.stream) continue;
    strut_status status = strut_file_commit(&self->tables[i].file, error);
    for (int j = 0; status != STRUT_OK && j < i; j++) {
      if (self->tables[j].columns) strut_file_remove(self->directory, file_name(j));
    }
    if (status != STRUT_OK) return status;
  }
  return STRUT_OK;
}

static strut_status end(void *context, strut_status run_status, strut_error *error) {
  csv *self = context;
  strut_status status = STRUT_OK;
  if (run_status != STRUT_FILE_TROUBLE && run_status != STRUT_NO_MEMORY) {
    status = commit(self, error);
  }
  abandon(self);
  return status;
}

strut_sink *strut_csv_create(const char *directory) {
  csv *self = strut_allocate(1, sizeof *self);
  if (!self) return NULL;
  self->sink = (strut_sink){self, begin, take_rows, end, 0};
  self->directory = strut_arena_format(&self->arena, "%s", directory);
  if (self->directory) return &self->sink;
  strut_csv_free(&self->sink);
  return NULL;
}

void strut_csv_free(strut_sink *sink) {
  if (!sink) return;
  csv *self = sink->context;
  abandon(self);
  strut_arena_free(&self->arena);
  strut_release(self);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/hdf5_library.h"

#include <errno.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "engine/output/hdf5_parts.h"

enum { CHUNK_BYTES = 1 << 18, CHUNK_DOUBLES = CHUNK_BYTES / 8 };
/* Of the time, of components, of owners with and without a total. */
enum { SCALES = 1 + STRUT_CHANNEL_COUNT + 2 * STRUT_OWNER_COUNT };

/* One growing dataset; rows are collected until they fill a chunk. */
typedef struct series {
  hid_t dataset;
  int rank;
  hsize_t shape[STRUT_HDF5_RANK]; /* rows in the file, items, components */
  size_t offset, size;            /* place in a row of the recorder, and doubles there */
  size_t most, held;
  double *rows; /* (most, size) */
} series;

typedef struct hdf5 {
  strut_sink sink;
  const char *directory, *scene_text;
  strut_file file;
  hid_t id; /* 0: no file open */
  size_t width, series_count;
  series series[1 + STRUT_CHANNEL_COUNT]; /* the time comes first */
  int scale_count;
  strut_hdf5_scale scales[SCALES];
} hdf5;

/* Closes the HDF5 file; false if not all of it could be written. */
static bool close_file(hdf5 *self) {
  bool good = true;
  if (self->id > 0) good = H5Fclose(self->id) >= 0;
  self->id = 0;
  return good;
}

static void abandon(hdf5 *self) {
  close_file(self);
  strut_file_abandon(&self->file);
  for (size_t i = 0; i < self->series_count; i++) strut_release(self->series[i].rows);
  self->series_count = 0;
  self->scale_count = 0;
}

/* Without a message of the library, which where no file is open is not initialised, and need not be. */
static void abandon_quietly(hdf5 *self) {
  if (self->id <= 0) {
    abandon(self);
    return;
  }
  strut_hdf5_quiet quiet = strut_hdf5_hush();
  abandon(self);
  strut_hdf5_unhush(quiet);
}

/* The scale of that name, created from the names if necessary; NULL on failure. */
static strut_hdf5_scale *scale_of_names(hdf5 *self, const char *name, const char *const *names,
                                        size_t count) {
  for (int i = 0; i < self->scale_count; i++) {
    if (strcmp(self->scales[i].name, name) == 0) return &self->scales[i];
  }
  strut_hdf5_scale *scale = &self->scales[self->scale_count];
  hid_t dataset = strut_hdf5_names(self->id, name, names, count);
  if (dataset < 0 || !strut_hdf5_scale_begin(scale, self->id, dataset, name)) return NULL;
  self->scale_count++;
  return scale;
}

/* Rows per chunk: about CHUNK_BYTES, and no more than will be recorded. Very long rows are split. */
static bool create_series(hdf5 *self, series *s, const char *name, const char *unit,
                          size_t expected_rows) {
  hsize_t chunk[STRUT_HDF5_RANK] = {1, s->shape[1], s->shape[2]};
  s->most = s->size < CHUNK_DOUBLES ? CHUNK_DOUBLES / s->size : 1;
  if (s->most > expected_rows) s->most = expected_rows > 0 ? expected_rows : 1;
  chunk[0] = s->most;
  if (s->size > CHUNK_DOUBLES) chunk[1] = CHUNK_DOUBLES / s->shape[2];
  s->rows = strut_allocate(s->most, s->size * sizeof *s->rows);
  if (!s->rows) {
    errno = ENOMEM;
    return false;
  }
  s->dataset = strut_hdf5_series(self->id, name, s->rank, s->shape, chunk);
  return s->dataset >= 0 && strut_hdf5_text(s->dataset, "units", unit);
}

static bool create_time(hdf5 *self, size_t expected_rows) {
  series *s = &self->series[self->series_count++];
  *s = (series){.rank = 1, .size = 1, .shape = {0, 1, 1}};
  return create_series(self, s, "time", "s", expected_rows) &&
         strut_hdf5_scale_begin(&self->scales[self->scale_count++], self->id, s->dataset, "time");
}

static bool create_channel(hdf5 *self, const strut_record_channel *channel, size_t expected_rows) {
  series *s = &self->series[self->series_count++];
  *s = (series){.rank = STRUT_HDF5_RANK,
                .shape = {0, channel->items, channel->components},
                .offset = channel->offset,
                .size = channel->items * channel->components};
  if (!create_series(self, s, channel->name, channel->unit, expected_rows)) return false;
  strut_hdf5_scale *scales[STRUT_HDF5_RANK] = {&self->scales[0]};
  const strut_channel_row *row = strut_channel_row_of(channel->id);
  const strut_owner_row *owner = strut_owner_row_of(row->owner);
  scales[1] = scale_of_names(self, row->total ? owner->axis_with_total : owner->axis,
                             channel->item_names, channel->items);
  if (!scales[1]) return false;
  if (channel->component_names[0][0] != '\0') { /* a single one without a name needs no scale */
    scales[2] =
        scale_of_names(self, row->component_axis, channel->component_names, channel->components);
    if (!scales[2]) return false;
  }
  return strut_hdf5_scale_attach(self->id, s->dataset, channel->name, STRUT_HDF5_RANK, scales);
}

static bool create_all(hdf5 *self, const strut_record_layout *layout) {
  self->id = strut_hdf5_create_file(self->file.part);
  bool good = self->id > 0 && strut_hdf5_text(self->id, "strut_version", STRUT_VERSION) &&
              strut_hdf5_text(self->id, "scene", self->scene_text) &&
              create_time(self, layout->expected_rows);
  for (size_t i = 0; good && i < layout->channel_count; i++) {
    const strut_record_channel *channel = &layout->channels[i];
    if (channel->items * channel->components > 0) {
      good = create_channel(self, channel, layout->expected_rows);
    }
  }
  for (int i = 0; good && i < self->scale_count; i++) good = strut_hdf5_scale_end(&self->scales[i]);
  return good;
}

static strut_status begin(void *context, const strut_record_layout *layout, strut_error *error) {
  hdf5 *self = context;
  self->width = layout->width;
  strut_status status = strut_file_open(&self->file, self->directory, "trajectory.h5", error);
  if (status != STRUT_OK) return status;
  strut_hdf5_quiet quiet = strut_hdf5_hush();
  errno = 0;
  if (!create_all(self, layout)) {
    status = strut_file_trouble(&self->file, error);
    abandon(self);
  }
  strut_hdf5_unhush(quiet);
  return status;
}

/* Appends the rows gathered to the dataset. */
static bool flush_series(series *self) {
  if (self->held == 0) return true;
  if (!strut_hdf5_has_memory()) {
    errno = ENOMEM;
    return false;
  }
  hsize_t start[STRUT_HDF5_RANK] = {self->shape[0]};
  hsize_t count[STRUT_HDF5_RANK] = {self->held, self->shape[1], self->shape[2]};
  self->shape[0] += self->held;
  if (H5Dset_extent(self->dataset, self->shape) < 0) return false;
  hid_t file_space = H5Dget_space(self->dataset);
  hid_t memory_space = H5Screate_simple(self->rank, count, NULL);
  bool good = H5Sselect_hyperslab(file_space, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
              H5Dwrite(self->dataset, H5T_NATIVE_DOUBLE, memory_space, file_space, H5P_DEFAULT,
                       self->rows) >= 0;
  H5Sclose(memory_space);
  H5Sclose(file_space);
  self->held = 0;
  return good;
}

static bool take_row(hdf5 *self, const double *row) {
  for (size_t i = 0; i < self->series_count; i++) {
    series *s = &self->series[i];
    memcpy(s->rows + s->held * s->size, row + s->offset, s->size * sizeof *row);
    if (++s->held == s->most && !flush_series(s)) return false;
  }
  return true;
}

static strut_status take_rows(void *context, const double *rows, size_t count, strut_error *error) {
  hdf5 *self = context;
  strut_status status = STRUT_OK;
  strut_hdf5_quiet quiet = strut_hdf5_hush();
  errno = 0;
  for (size_t i = 0; status == STRUT_OK && i < count; i++) {
    if (!take_row(self, rows + i * self->width)) status = strut_file_trouble(&self->file, error);
  }
  strut_hdf5_unhush(quiet);
  return status;
}

/* Writes pending rows, closes the file and renames it. */
static strut_status complete(hdf5 *self, strut_status run_status, strut_error *error) {
  errno = 0;
  bool good = true;
  for (size_t i = 0; good && i < self->series_count; i++) good = flush_series(&self->series[i]);
  good = good && strut_hdf5_text(self->id, "status", strut_status_text(run_status));
  int code = errno;
  bool closed = close_file(self);
  if (!good && !errno) errno = code; /* report the first failure */
  good = good && closed;
  return good ? strut_file_commit(&self->file, error) : strut_file_trouble(&self->file, error);
}

static strut_status end(void *context, strut_status run_status, strut_error *error) {
  hdf5 *self = context;
  strut_status status = STRUT_OK;
  bool keep = run_status != STRUT_FILE_TROUBLE && run_status != STRUT_NO_MEMORY;
  if (keep && self->id > 0) {
    strut_hdf5_quiet quiet = strut_hdf5_hush();
    status = complete(self, run_status, error);
    strut_hdf5_unhush(quiet);
  }
  abandon_quietly(self);
  return status;
}

static strut_sink *create_sink(const char *directory, const char *scene_text) {
  hdf5 *self = strut_allocate(1, sizeof *self);
  if (!self) return NULL;
  self->sink = (strut_sink){self, begin, take_rows, end, 0};
  self->directory = directory, self->scene_text = scene_text;
  return &self->sink;
}

static void free_sink(strut_sink *sink) {
  if (!sink) return;
  hdf5 *self = sink->context;
  abandon_quietly(self);
  strut_release(self);
}

static void leave_at_exit(void) { H5dont_atexit(); }

extern STRUT_API const strut_hdf5_library strut_hdf5_table;
const strut_hdf5_library strut_hdf5_table = {
    .stamp = STRUT_LIBRARY_STAMP(strut_hdf5_library),
    .create = create_sink,
    .free = free_sink,
    .read = strut_trajectory_read_file,
    .leave_at_exit = leave_at_exit,
};

strut_status strut_hdf5_load(const strut_hdf5_library **library, strut_error *error) {
  (void)error;
  *library = &strut_hdf5_table;
  return STRUT_OK;
}

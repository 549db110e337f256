/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/hdf5_library.h"

#include <assert.h>
#include <errno.h>
#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/file.h"
#include "engine/output/hdf5_parts.h"

enum { DEFLATE_LEVEL = 4 };

static pthread_mutex_t alone = PTHREAD_MUTEX_INITIALIZER; /* the library is not thread-safe */

strut_hdf5_quiet strut_hdf5_hush(void) {
  strut_hdf5_quiet quiet = {0};
  pthread_mutex_lock(&alone);
  H5Eget_auto2(H5E_DEFAULT, &quiet.function, &quiet.data);
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  return quiet;
}

void strut_hdf5_unhush(strut_hdf5_quiet quiet) {
  H5Eset_auto2(H5E_DEFAULT, quiet.function, quiet.data);
  pthread_mutex_unlock(&alone);
}

/* A type of texts; negative where it could not be made. */
static hid_t text_type(size_t size, H5T_cset_t characters) {
  hid_t type = H5Tcopy(H5T_C_S1);
  if (type < 0 || (H5Tset_cset(type, characters) >= 0 && H5Tset_size(type, size) >= 0)) return type;
  H5Tclose(type);
  return -1;
}

static bool write_attribute(hid_t object, const char *name, hid_t file_type, hid_t memory_type,
                            hid_t space, const void *value) {
  if (file_type < 0 || memory_type < 0 || space < 0) return false;
  hid_t attribute = H5Acreate2(object, name, file_type, space, H5P_DEFAULT, H5P_DEFAULT);
  bool good = attribute >= 0 && H5Awrite(attribute, memory_type, value) >= 0;
  if (attribute >= 0) H5Aclose(attribute);
  return good;
}

static bool write_scalar(hid_t object, const char *name, hid_t type, const void *value) {
  hid_t space = H5Screate(H5S_SCALAR);
  bool good = write_attribute(object, name, type, type, space, value);
  H5Sclose(space);
  return good;
}

bool strut_hdf5_text(hid_t object, const char *name, const char *text) {
  hid_t type = text_type(H5T_VARIABLE, H5T_CSET_UTF8);
  bool good = write_scalar(object, name, type, &text);
  H5Tclose(type);
  return good;
}

/* As the specification of scales wants it: of fixed length, with its NUL. */
static bool write_fixed_text(hid_t object, const char *name, const char *text) {
  hid_t type = text_type(strlen(text) + 1, H5T_CSET_ASCII);
  bool good = write_scalar(object, name, type, text);
  H5Tclose(type);
  return good;
}

static hid_t create_dataset(hid_t file, const char *name, hid_t type, hid_t space,
                            const hsize_t *chunk, int rank) {
  hid_t creation = H5Pcreate(H5P_DATASET_CREATE), dataset = -1;
  if (H5Pset_obj_track_times(creation, false) >= 0 &&
      (!chunk || (H5Pset_chunk(creation, rank, chunk) >= 0 && H5Pset_shuffle(creation) >= 0 &&
                  H5Pset_deflate(creation, DEFLATE_LEVEL) >= 0))) {
    dataset = H5Dcreate2(file, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
  }
  H5Pclose(creation);
  return dataset;
}

hid_t strut_hdf5_series(hid_t file, const char *name, int rank, const hsize_t *shape,
                        const hsize_t *chunk) {
  hsize_t most[STRUT_HDF5_RANK] = {H5S_UNLIMITED};
  for (int i = 1; i < rank; i++) most[i] = shape[i];
  hid_t space = H5Screate_simple(rank, shape, most);
  hid_t dataset = create_dataset(file, name, H5T_IEEE_F64LE, space, chunk, rank);
  H5Sclose(space);
  return dataset;
}

hid_t strut_hdf5_names(hid_t file, const char *name, const char *const *names, size_t count) {
  size_t longest = 1;
  for (size_t i = 0; i < count; i++) {
    if (strlen(names[i]) > longest) longest = strlen(names[i]);
  }
  char *texts = strut_allocate(count, longest);
  if (!texts) {
    errno = ENOMEM;
    return -1;
  }
  for (size_t i = 0; i < count; i++) memcpy(texts + i * longest, names[i], strlen(names[i]));
  hsize_t shape = count;
  hid_t type = text_type(longest, H5T_CSET_UTF8), space = H5Screate_simple(1, &shape, NULL);
  bool good = type >= 0 && space >= 0 && H5Tset_strpad(type, H5T_STR_NULLPAD) >= 0;
  hid_t dataset = good ? create_dataset(file, name, type, space, NULL, 1) : -1;
  if (dataset >= 0 && H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts) < 0) {
    H5Dclose(dataset);
    dataset = -1;
  }
  H5Sclose(space);
  H5Tclose(type);
  strut_release(texts);
  return dataset;
}

bool strut_hdf5_scale_begin(strut_hdf5_scale *scale, hid_t file, hid_t dataset, const char *name) {
  *scale = (strut_hdf5_scale){.name = name, .dataset = dataset};
  return H5Rcreate(&scale->reference, file, name, H5R_OBJECT, -1) >= 0 &&
         write_fixed_text(dataset, "CLASS", "DIMENSION_SCALE") &&
         write_fixed_text(dataset, "NAME", name);
}

bool strut_hdf5_scale_attach(hid_t file, hid_t dataset, const char *name, int rank,
                             strut_hdf5_scale *scales[STRUT_HDF5_RANK]) {
  hobj_ref_t itself;
  hvl_t lists[STRUT_HDF5_RANK] = {{0, NULL}};
  if (H5Rcreate(&itself, file, name, H5R_OBJECT, -1) < 0) return false;
  for (int i = 0; i < rank; i++) {
    strut_hdf5_scale *scale = scales[i];
    if (!scale) continue;
    assert(scale->user_count < STRUT_HDF5_USERS);
    scale->users[scale->user_count].dataset = itself;
    scale->users[scale->user_count++].dimension = i;
    lists[i] = (hvl_t){1, &scale->reference};
  }
  hsize_t count = (hsize_t)rank;
  hid_t type = H5Tvlen_create(H5T_STD_REF_OBJ), space = H5Screate_simple(1, &count, NULL);
  bool good = write_attribute(dataset, "DIMENSION_LIST", type, type, space, lists);
  H5Sclose(space);
  H5Tclose(type);
  return good;
}

bool strut_hdf5_scale_end(const strut_hdf5_scale *scale) {
  if (scale->user_count == 0) return true;
  size_t whole = sizeof scale->users[0], second = sizeof(hobj_ref_t);
  hid_t memory = H5Tcreate(H5T_COMPOUND, whole), packed = H5Tcreate(H5T_COMPOUND, second + 4);
  size_t dimension =
      (size_t)((const char *)&scale->users[0].dimension - (const char *)&scale->users[0]);
  bool good = memory >= 0 && packed >= 0 && H5Tinsert(memory, "dataset", 0, H5T_STD_REF_OBJ) >= 0 &&
              H5Tinsert(memory, "dimension", dimension, H5T_NATIVE_INT) >= 0 &&
              H5Tinsert(packed, "dataset", 0, H5T_STD_REF_OBJ) >= 0 &&
              H5Tinsert(packed, "dimension", second, H5T_STD_I32LE) >= 0;
  hsize_t count = (hsize_t)scale->user_count;
  hid_t space = H5Screate_simple(1, &count, NULL);
  good = good &&
         write_attribute(scale->dataset, "REFERENCE_LIST", packed, memory, space, scale->users);
  H5Sclose(space);
  H5Tclose(memory);
  H5Tclose(packed);
  return good;
}

hid_t strut_hdf5_create_file(const char *path) {
  hid_t creation = H5Pcreate(H5P_FILE_CREATE), access = H5Pcreate(H5P_FILE_ACCESS), file = -1;
  if (H5Pset_obj_track_times(creation, false) >= 0 &&
      H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) >= 0 &&
      H5Pset_file_locking(access, false, true) >= 0) { /* strut has locked it */
    file = H5Fcreate(path, H5F_ACC_TRUNC, creation, access);
  }
  H5Pclose(creation);
  H5Pclose(access);
  return file;
}

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
  if (!strut_has_memory(STRUT_HDF5_MEMORY)) {
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

static void leave_at_exit(void) {
  pthread_mutex_lock(&alone);
  H5dont_atexit();
  pthread_mutex_unlock(&alone);
}

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

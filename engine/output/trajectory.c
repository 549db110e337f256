/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A motion in memory: recorded by a sink, or read back from trajectory.h5 (trajectory.c). */
#include "engine/output/trajectory.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "engine/base/memory.h"
#include "engine/output/hdf5_library.h"
#include "engine/output/hdf5_parts.h"

/* One array of a trajectory: `size` doubles of each frame. */
typedef struct trajectory_array {
  double **values;
  size_t size, offset; /* in a recorded row */
} trajectory_array;

/* ---- recording ---- */

enum { FIRST_FRAMES = 256 };

typedef struct keeper {
  strut_sink sink;
  strut_trajectory *t;
  const strut_scene *scene;
  size_t room, frame_size, width; /* doubles: limit, per frame, per row */
  size_t capacity, most;          /* frames: allocated, and the limit */
  size_t array_count;
  trajectory_array arrays[1 + STRUT_CHANNEL_COUNT];
  double *last; /* (width) the latest row, */
  bool waiting; /* the latest row is not yet a frame */
} keeper;

static size_t place_of(strut_channel id) {
  size_t place = 0;
  while (1u << place != (unsigned)id) place++;
  assert(place < STRUT_CHANNEL_COUNT);
  return place;
}

double **strut_trajectory_array(strut_trajectory *t, strut_channel id) {
  return &t->channel[place_of(id)];
}

const double *strut_trajectory_channel(const strut_trajectory *t, strut_channel id) {
  return t->channel[place_of(id)];
}

/* Memory for `capacity` frames. */
static bool grow(keeper *k, size_t capacity) {
  for (size_t i = 0; i < k->array_count; i++) {
    trajectory_array *a = &k->arrays[i];
    double *more = strut_reallocate(*a->values, capacity, a->size * sizeof *more);
    if (!more) return false;
    *a->values = more;
  }
  k->capacity = capacity;
  return true;
}

/* Drops every second frame; the others remain evenly spaced. */
static void thin(keeper *k) {
  strut_trajectory *t = k->t;
  size_t kept = (t->frames + 1) / 2;
  for (size_t i = 0; i < k->array_count; i++) {
    double *values = *k->arrays[i].values;
    size_t size = k->arrays[i].size;
    for (size_t f = 1; f < kept; f++)
      memcpy(values + f * size, values + 2 * f * size, size * sizeof *values);
  }
  t->frames = kept;
  t->every *= 2;
}

static void store(keeper *k, const double *row) {
  for (size_t i = 0; i < k->array_count; i++) {
    const trajectory_array *a = &k->arrays[i];
    memcpy(*a->values + k->t->frames * a->size, row + a->offset, a->size * sizeof *row);
  }
  k->t->frames++;
}

static bool take_row(keeper *k, const double *row) {
  strut_trajectory *t = k->t;
  if (t->recorded % t->every == 0 && t->frames == k->capacity) {
    if (k->capacity == k->most) {
      thin(k);
    } else {
      size_t more = 2 * k->capacity < k->most ? 2 * k->capacity : k->most;
      if (!grow(k, more)) return false;
    }
  }
  k->waiting = t->recorded % t->every != 0;
  if (k->waiting) {
    memcpy(k->last, row, k->width * sizeof *row);
  } else {
    store(k, row);
  }
  t->recorded++;
  return true;
}

static bool trajectory_contacts(strut_trajectory *t, const strut_scene *scene) {
  t->contact_count = scene->contact_count;
  t->contact_node = strut_arena_allocate(&t->arena, scene->contact_count, sizeof *t->contact_node);
  for (size_t i = 0; i < scene->contact_count && t->contact_node; i++)
    t->contact_node[i] = scene->contacts[i].node;
  return t->contact_node;
}

static strut_status begin(void *context, const strut_record_layout *layout, strut_error *error) {
  keeper *k = context;
  strut_trajectory *t = k->t;
  *t = (strut_trajectory){.every = 1,
                          .node_count = k->scene->node_count,
                          .member_count = k->scene->member_count,
                          .hinge_count = k->scene->hinge_count,
                          .cell_count = k->scene->cell_count};
  k->width = layout->width;
  k->arrays[0] = (trajectory_array){.values = &t->time, .size = 1};
  k->array_count = k->frame_size = 1;
  for (size_t i = 0; i < layout->channel_count; i++) {
    const strut_record_channel *c = &layout->channels[i];
    k->arrays[k->array_count++] = (trajectory_array){.values = strut_trajectory_array(t, c->id),
                                                     .size = c->items * c->components,
                                                     .offset = c->offset};
    k->frame_size += c->items * c->components;
  }
  k->most = k->room / k->frame_size;
  if (k->most < 4) k->most = 4;
  k->last = strut_allocate(k->width, sizeof *k->last);
  bool ready = k->last && trajectory_contacts(t, k->scene) &&
               grow(k, k->most < FIRST_FRAMES ? k->most : FIRST_FRAMES);
  return ready ? STRUT_OK : strut_no_memory(error, "for the recorded motion");
}

static strut_status take_rows(void *context, const double *rows, size_t count, strut_error *error) {
  keeper *k = context;
  for (size_t i = 0; i < count; i++)
    if (!take_row(k, rows + i * k->width)) return strut_no_memory(error, "for the recorded motion");
  return STRUT_OK;
}

/* The last frame is always kept. */
static strut_status end(void *context, strut_status run_status, strut_error *error) {
  keeper *k = context;
  k->t->status = run_status;
  if (!k->waiting) return STRUT_OK;
  if (k->t->frames == k->capacity && !grow(k, k->capacity + 1))
    return strut_no_memory(error, "for the recorded motion");
  store(k, k->last);
  k->waiting = false;
  return STRUT_OK;
}

strut_sink *strut_trajectory_sink(strut_trajectory *trajectory, const strut_scene *scene,
                                  unsigned channels, size_t room) {
  keeper *k = strut_allocate(1, sizeof *k);
  if (!k) return NULL;
  k->t = trajectory;
  k->scene = scene;
  k->room = room;
  k->sink = (strut_sink){k, begin, take_rows, end, channels};
  return &k->sink;
}

void strut_trajectory_sink_free(strut_sink *sink) {
  if (!sink) return;
  keeper *k = sink->context;
  strut_release(k->last);
  strut_release(k);
}

void strut_trajectory_free(strut_trajectory *t) {
  strut_release(t->time);
  for (size_t k = 0; k < STRUT_CHANNEL_COUNT; k++) strut_release(t->channel[k]);
  strut_arena_free(&t->arena);
  *t = (strut_trajectory){0};
}

/* ---- reading back ---- */

strut_status strut_trajectory_read(const char *directory, const strut_scene *scene, size_t room,
                                   strut_trajectory *trajectory, strut_error *error) {
  size_t length = strlen(directory) + sizeof "/trajectory.h5";
  char *path = strut_allocate(length, 1);
  const strut_hdf5_library *library = NULL;
  *trajectory = (strut_trajectory){.node_count = scene->node_count,
                                   .member_count = scene->member_count,
                                   .hinge_count = scene->hinge_count,
                                   .cell_count = scene->cell_count};
  if (!path) return strut_no_memory(error, "");
  snprintf(path, length, "%s/trajectory.h5", directory);
  strut_status status = STRUT_OK;
  if (!strut_hdf5_has_memory()) {
    status = strut_fail(error, STRUT_NO_MEMORY, "out of memory reading '%s'", path);
  } else if (access(path, R_OK) != 0) {
    char reason[128];
    if (strerror_r(errno, reason, sizeof reason) != 0) snprintf(reason, sizeof reason, "no access");
    status = strut_trajectory_trouble(path, reason, error);
  } else if ((status = strut_hdf5_ready(&library, error)) == STRUT_OK) {
    status = trajectory_contacts(trajectory, scene)
                 ? library->read(path, scene, room, trajectory, error)
                 : strut_no_memory(error, "for the recorded motion");
  }
  strut_release(path);
  if (status != STRUT_OK) strut_trajectory_free(trajectory);
  return status;
}

strut_status strut_trajectory_trouble(const char *path, const char *reason, strut_error *error) {
  return strut_fail(error, STRUT_FILE_TROUBLE, "cannot read '%s': %s; run the model again with -o",
                    path, reason);
}

/* A trajectory from trajectory.h5: as many frames as there is room for, of the scene beside the file only. */

typedef struct reader {
  hid_t file;
  const char *path;
  const strut_scene *scene;
  strut_trajectory *t;
  strut_error *error;
} reader;

static strut_status trouble(const reader *r, const char *what) {
  return strut_trajectory_trouble(r->path, what, r->error);
}

static strut_status report_no_memory(const reader *r) {
  return strut_no_memory(r->error, "for the recorded motion");
}

/* The shape of a dataset of that rank; false where it has another, or no doubles. */
static bool shape_of(hid_t dataset, int rank, hsize_t shape[STRUT_HDF5_RANK]) {
  hid_t space = H5Dget_space(dataset), type = H5Dget_type(dataset);
  bool good = H5Tget_class(type) == H5T_FLOAT && H5Sget_simple_extent_ndims(space) == rank &&
              H5Sget_simple_extent_dims(space, shape, NULL) == rank;
  H5Tclose(type);
  H5Sclose(space);
  return good;
}

/* Reads `frames` rows of `size` doubles with a stride of `every`, and the last row. */
static bool read_rows(hid_t dataset, int rank, const hsize_t *shape, size_t frames, size_t every,
                      size_t size, double *values) {
  size_t even = (shape[0] + every - 1) / every; /* those evenly spaced */
  hsize_t start[STRUT_HDF5_RANK] = {0}, stride[STRUT_HDF5_RANK] = {every, 1, 1};
  hsize_t count[STRUT_HDF5_RANK] = {even, rank > 1 ? shape[1] : 1, rank > 2 ? shape[2] : 1};
  hsize_t length = even * size;
  hid_t from = H5Dget_space(dataset), to = H5Screate_simple(1, &length, NULL);
  bool good = H5Sselect_hyperslab(from, H5S_SELECT_SET, start, stride, count, NULL) >= 0 &&
              H5Dread(dataset, H5T_NATIVE_DOUBLE, to, from, H5P_DEFAULT, values) >= 0;
  H5Sclose(to);
  if (good && frames > even) {
    start[0] = shape[0] - 1;
    stride[0] = count[0] = 1;
    length = size;
    to = H5Screate_simple(1, &length, NULL);
    good = H5Sselect_hyperslab(from, H5S_SELECT_SET, start, stride, count, NULL) >= 0 &&
           H5Dread(dataset, H5T_NATIVE_DOUBLE, to, from, H5P_DEFAULT, values + even * size) >= 0;
    H5Sclose(to);
  }
  H5Sclose(from);
  return good;
}

/* Is the file's list of the names of such things the scene's? A missing list counts as such. */
static bool same_names(const reader *r, const strut_channel_row *row) {
  const strut_owner_row *owner = strut_owner_row_of(row->owner);
  const char *list = row->total ? owner->axis_with_total : owner->axis;
  size_t count = strut_channel_items(row, r->scene);
  if (H5Lexists(r->file, list, H5P_DEFAULT) <= 0) return true;
  hid_t dataset = H5Dopen2(r->file, list, H5P_DEFAULT);
  hid_t type = H5Dget_type(dataset), space = H5Dget_space(dataset);
  size_t longest = H5Tget_size(type);
  bool good = H5Tget_class(type) == H5T_STRING && !H5Tis_variable_str(type) &&
              H5Sget_simple_extent_npoints(space) == (hssize_t)count;
  char *texts = good ? strut_allocate(count, longest) : NULL;
  good = texts && H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts) >= 0;
  for (size_t i = 0; i < count && good; i++) {
    const char *name = strut_channel_item(row, r->scene, i);
    good = strlen(name) <= longest && strncmp(name, texts + i * longest, longest) == 0;
  }
  strut_release(texts);
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(dataset);
  return good;
}

static strut_status read_channel(reader *r, const strut_channel_row *row) {
  if (H5Lexists(r->file, row->name, H5P_DEFAULT) <= 0) return STRUT_OK;
  hid_t dataset = H5Dopen2(r->file, row->name, H5P_DEFAULT);
  hsize_t shape[STRUT_HDF5_RANK] = {0};
  size_t items = strut_channel_items(row, r->scene), size = items * row->components;
  bool fits = dataset >= 0 && shape_of(dataset, 3, shape) && shape[0] == r->t->recorded &&
              shape[1] == items && shape[2] == row->components;
  double *values = fits ? strut_allocate(r->t->frames, size * sizeof *values) : NULL;
  bool good = values && read_rows(dataset, 3, shape, r->t->frames, r->t->every, size, values);
  *strut_trajectory_array(r->t, row->id) = values;
  if (dataset >= 0) H5Dclose(dataset);
  if (!fits) return trouble(r, "it belongs to another structure than the scene beside it");
  return good ? STRUT_OK : values ? trouble(r, "it is damaged") : report_no_memory(r);
}

/* Chooses the number of frames and reads their times. */
static strut_status read_time(reader *r, size_t room) {
  hsize_t shape[STRUT_HDF5_RANK] = {0};
  hid_t dataset =
      H5Lexists(r->file, "time", H5P_DEFAULT) > 0 ? H5Dopen2(r->file, "time", H5P_DEFAULT) : -1;
  if (dataset < 0 || !shape_of(dataset, 1, shape)) {
    if (dataset >= 0) H5Dclose(dataset);
    return trouble(r, "not a trajectory of strut");
  }
  strut_trajectory *t = r->t;
  size_t frame = 1;
  const strut_channel_row *row;
  for (size_t i = 0; (row = strut_channel_at(i)) != NULL; i++)
    if (H5Lexists(r->file, row->name, H5P_DEFAULT) > 0)
      frame += strut_channel_items(row, r->scene) * row->components;
  t->recorded = shape[0];
  t->every = 1;
  while (t->recorded / t->every > 4 && (t->recorded / t->every + 2) * frame > room) t->every *= 2;
  t->frames = (t->recorded + t->every - 1) / t->every;
  t->frames += t->recorded > 0 && (t->recorded - 1) % t->every != 0;
  t->time = strut_allocate(t->frames, sizeof *t->time);
  bool good =
      t->time && (!t->frames || read_rows(dataset, 1, shape, t->frames, t->every, 1, t->time));
  H5Dclose(dataset);
  return good ? STRUT_OK : t->time ? trouble(r, "it is damaged") : report_no_memory(r);
}

/* The run's status from its text. */
static strut_status run_status(const reader *r) {
  char *text = NULL;
  strut_status found = STRUT_OK;
  hid_t attribute = H5Aexists(r->file, "status") > 0 ? H5Aopen(r->file, "status", H5P_DEFAULT) : -1;
  if (attribute < 0) return STRUT_INTERRUPTED; /* it was never written */
  hid_t type = H5Aget_type(attribute);
  if (H5Tis_variable_str(type) > 0 && H5Aread(attribute, type, &text) >= 0 && text) {
    for (int s = 0; s < STRUT_STATUS_COUNT; s++)
      if (strcmp(text, strut_status_text((strut_status)s)) == 0) found = (strut_status)s;
    H5free_memory(text);
  }
  H5Tclose(type);
  H5Aclose(attribute);
  return found;
}

static strut_status read_file(reader *r, size_t room) {
  strut_trajectory *t = r->t;
  const strut_channel_row *row;
  for (size_t i = 0; (row = strut_channel_at(i)) != NULL; i++)
    if (row->owner != STRUT_OWNER_SYSTEM && !same_names(r, row))
      return trouble(r, "it belongs to another structure than the scene beside it");
  t->status = run_status(r);
  strut_status status = read_time(r, room);
  for (size_t i = 0; status == STRUT_OK && t->frames && (row = strut_channel_at(i)) != NULL; i++)
    status = read_channel(r, row);
  return status;
}

strut_status strut_trajectory_read_file(const char *path, const strut_scene *scene, size_t room,
                                        strut_trajectory *trajectory, strut_error *error) {
  reader r = {.path = path, .scene = scene, .t = trajectory, .error = error};
  strut_hdf5_quiet quiet = strut_hdf5_hush();
  r.file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
  strut_status status =
      r.file >= 0 ? read_file(&r, room) : trouble(&r, "it is not an HDF5 file, or damaged");
  if (r.file >= 0) H5Fclose(r.file);
  strut_hdf5_unhush(quiet);
  return status;
}

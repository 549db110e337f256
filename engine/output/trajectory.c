/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A motion in memory: recorded by a sink, or read back from trajectory.h5 (trajectory_file.c). */
#include "engine/output/trajectory.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "engine/base/memory.h"
#include "engine/output/hdf5_library.h"
#include "engine/output/record_files.h"

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

static size_t place_of(strut_channels id) {
  size_t place = 0;
  while ((strut_channels)1 << place != id) place++;
  assert(place < STRUT_CHANNEL_COUNT);
  return place;
}

double **strut_trajectory_array(strut_trajectory *trajectory, strut_channels id) {
  return &trajectory->channel[place_of(id)];
}

const double *strut_trajectory_channel(const strut_trajectory *trajectory, strut_channels id) {
  return trajectory->channel[place_of(id)];
}

/* Memory for `capacity` frames. */
static bool grow(keeper *self, size_t capacity) {
  for (size_t i = 0; i < self->array_count; i++) {
    trajectory_array *a = &self->arrays[i];
    double *more = strut_reallocate(*a->values, capacity, a->size * sizeof *more);
    if (!more) return false;
    *a->values = more;
  }
  self->capacity = capacity;
  return true;
}

/* Drops every second frame; the others remain evenly spaced. */
static void thin(keeper *self) {
  strut_trajectory *trajectory = self->t;
  size_t kept = (trajectory->frames + 1) / 2;
  for (size_t i = 0; i < self->array_count; i++) {
    double *values = *self->arrays[i].values;
    size_t size = self->arrays[i].size;
    for (size_t f = 1; f < kept; f++)
      memcpy(values + f * size, values + 2 * f * size, size * sizeof *values);
  }
  trajectory->frames = kept;
  trajectory->every *= 2;
}

static void store(keeper *self, const double *row) {
  for (size_t i = 0; i < self->array_count; i++) {
    const trajectory_array *a = &self->arrays[i];
    memcpy(*a->values + self->t->frames * a->size, row + a->offset, a->size * sizeof *row);
  }
  self->t->frames++;
}

static bool take_row(keeper *self, const double *row) {
  strut_trajectory *trajectory = self->t;
  if (trajectory->recorded % trajectory->every == 0 && trajectory->frames == self->capacity) {
    if (self->capacity == self->most) {
      thin(self);
    } else {
      size_t more = 2 * self->capacity < self->most ? 2 * self->capacity : self->most;
      if (!grow(self, more)) return false;
    }
  }
  self->waiting = trajectory->recorded % trajectory->every != 0;
  if (self->waiting) {
    memcpy(self->last, row, self->width * sizeof *row);
  } else {
    store(self, row);
  }
  trajectory->recorded++;
  return true;
}

/* An empty one with what the scene has. False: out of memory. */
static bool size_trajectory(strut_trajectory *trajectory, const strut_scene *scene) {
  *trajectory = (strut_trajectory){.every = 1,
                                   .node_count = scene->node_count,
                                   .member_count = scene->member_count,
                                   .hinge_count = scene->hinge_count,
                                   .cell_count = scene->cell_count,
                                   .contact_count = scene->contact_count};
  trajectory->contact_node = strut_arena_allocate(&trajectory->arena, scene->contact_count,
                                                  sizeof *trajectory->contact_node);
  for (size_t i = 0; i < scene->contact_count && trajectory->contact_node; i++)
    trajectory->contact_node[i] = scene->contacts[i].node;
  return trajectory->contact_node;
}

static strut_status begin(void *context, const strut_record_layout *layout, strut_error *error) {
  keeper *self = context;
  strut_trajectory *trajectory = self->t;
  bool ready = size_trajectory(trajectory, self->scene);
  self->width = layout->width;
  self->arrays[0] = (trajectory_array){.values = &trajectory->time, .size = 1};
  self->array_count = self->frame_size = 1;
  for (size_t i = 0; i < layout->channel_count; i++) {
    const strut_record_channel *channel = &layout->channels[i];
    self->arrays[self->array_count++] =
        (trajectory_array){.values = strut_trajectory_array(trajectory, channel->id),
                           .size = channel->items * channel->components,
                           .offset = channel->offset};
    self->frame_size += channel->items * channel->components;
  }
  self->most = self->room / self->frame_size;
  if (self->most < 4) self->most = 4;
  self->last = strut_allocate(self->width, sizeof *self->last);
  ready = ready && self->last && grow(self, self->most < FIRST_FRAMES ? self->most : FIRST_FRAMES);
  return ready ? STRUT_OK : strut_no_memory(error, "for the recorded motion");
}

static strut_status take_rows(void *context, const double *rows, size_t count, strut_error *error) {
  keeper *self = context;
  for (size_t i = 0; i < count; i++)
    if (!take_row(self, rows + i * self->width))
      return strut_no_memory(error, "for the recorded motion");
  return STRUT_OK;
}

/* The last frame is always kept. */
static strut_status end(void *context, strut_status run_status, strut_error *error) {
  keeper *self = context;
  self->t->status = run_status;
  if (!self->waiting) return STRUT_OK;
  if (self->t->frames == self->capacity && !grow(self, self->capacity + 1))
    return strut_no_memory(error, "for the recorded motion");
  store(self, self->last);
  self->waiting = false;
  return STRUT_OK;
}

strut_sink *strut_trajectory_sink(strut_trajectory *trajectory, const strut_scene *scene,
                                  strut_channels channels, size_t room) {
  keeper *self = strut_allocate(1, sizeof *self);
  if (!self) return NULL;
  self->t = trajectory;
  self->scene = scene;
  self->room = room;
  self->sink = (strut_sink){self, begin, take_rows, end, channels};
  return &self->sink;
}

void strut_trajectory_cut(strut_trajectory *trajectory, size_t frames) {
  if (trajectory->recorded > frames) trajectory->frames = trajectory->recorded = frames;
}

void strut_trajectory_sink_free(strut_sink *sink) {
  if (!sink) return;
  keeper *self = sink->context;
  strut_release(self->last);
  strut_release(self);
}

void strut_trajectory_free(strut_trajectory *trajectory) {
  strut_release(trajectory->time);
  for (size_t k = 0; k < STRUT_CHANNEL_COUNT; k++) strut_release(trajectory->channel[k]);
  strut_arena_free(&trajectory->arena);
  *trajectory = (strut_trajectory){0};
}

/* ---- reading back ---- */

strut_status strut_trajectory_read(const char *directory, const strut_scene *scene, size_t room,
                                   strut_trajectory *trajectory, strut_error *error) {
  size_t length = strlen(directory) + sizeof "/trajectory.h5";
  char *path = strut_allocate(length, 1);
  const strut_hdf5_library *library = NULL;
  bool ready = size_trajectory(trajectory, scene);
  if (path) snprintf(path, length, "%s/trajectory.h5", directory);
  strut_status status = STRUT_OK;
  if (!path || !ready) {
    status = strut_no_memory(error, "for the recorded motion");
  } else if (!strut_has_memory(STRUT_HDF5_MEMORY)) {
    status = strut_fail(error, STRUT_NO_MEMORY, "out of memory reading '%s'", path);
  } else if (access(path, R_OK) != 0) {
    char reason[128];
    if (strerror_r(errno, reason, sizeof reason) != 0) snprintf(reason, sizeof reason, "no access");
    status = strut_trajectory_trouble(path, reason, error);
  } else if ((status = strut_hdf5_ready(&library, error)) == STRUT_OK) {
    status = library->read(path, scene, room, trajectory, error);
  }
  strut_release(path);
  if (status != STRUT_OK) strut_trajectory_free(trajectory);
  return status;
}

strut_status strut_trajectory_trouble(const char *path, const char *reason, strut_error *error) {
  return strut_fail(error, STRUT_FILE_TROUBLE, "cannot read '%s': %s; run the model again with -o",
                    path, reason);
}

/* ---- data beside it ---- */

static bool is_beside(const strut_data_column *data, const strut_scene *scene,
                      const strut_channel_row *row, size_t k) {
  const strut_observable *of = strut_observable_at(row->first);
  const strut_dimension own = {(float)of->kg, (float)of->m, (float)of->s, (float)of->angle};
  const char *name = data->name;
  if (!data->unit || memcmp(&own, &data->dimension, sizeof own) != 0) return false;
  if (!strut_channel_is_whole(row)) {
    const char *thing = strut_channel_item(row, scene, k / row->components);
    size_t length = strlen(thing);
    if (strncmp(name, thing, length) != 0 || name[length] != '.') return false;
    name += length + 1;
  }
  return strcmp(name, row->column_names[k % row->components]) == 0;
}

size_t strut_data_dots(const strut_scene *scene, const strut_channel_row *row, size_t k,
                       const double span[2], double (*dots)[2]) {
  size_t count = 0, c;
  for (const strut_data_table *t = scene->tables; t < scene->tables + scene->table_count; t++) {
    for (c = 0; c < t->column_count && !is_beside(&t->columns[c], scene, row, k);) c++;
    if (c == t->column_count || t->time < 0) continue;
    const double *time = t->columns[t->time].values, *value = t->columns[c].values;
    size_t every = t->row_count * scene->table_count / STRUT_DATA_DOTS + 1;
    for (size_t i = 0; time && value && i < t->row_count && count < STRUT_DATA_DOTS; i += every) {
      if (!(time[i] >= span[0] && time[i] <= span[1]) || isnan(value[i])) continue;
      if (dots) dots[count][0] = time[i], dots[count][1] = value[i];
      count++;
    }
  }
  return count;
}

/* ---- the HDF5 library ---- */

static atomic_bool leaves_at_exit;

void strut_hdf5_leave_at_exit(void) { leaves_at_exit = true; }

strut_status strut_hdf5_ready(const strut_hdf5_library **library, strut_error *error) {
  strut_status status = strut_hdf5_load(library, error);
  if (status == STRUT_OK && atomic_exchange(&leaves_at_exit, false)) (*library)->leave_at_exit();
  return status;
}

strut_sink *strut_hdf5_create(const char *directory, const char *scene_text, strut_error *error) {
  const strut_hdf5_library *library;
  bool memory = strut_has_memory(STRUT_HDF5_MEMORY);
  if (memory && strut_hdf5_ready(&library, error) != STRUT_OK) return NULL;
  strut_sink *sink = memory ? library->create(directory, scene_text) : NULL;
  if (!sink) strut_no_memory(error, "while writing files");
  return sink;
}

void strut_hdf5_free(strut_sink *sink) {
  const strut_hdf5_library *library;
  if (sink && strut_hdf5_load(&library, NULL) == STRUT_OK) library->free(sink);
}

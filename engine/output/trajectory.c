/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A motion in memory: recorded by a sink, or read back from trajectory.h5 (trajectory_file.c). */
#include "engine/output/trajectory.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "engine/base/memory.h"
#include "engine/output/hdf5_library.h"

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

double **strut_trajectory_array(strut_trajectory *t, strut_channels id) {
  return &t->channel[place_of(id)];
}

const double *strut_trajectory_channel(const strut_trajectory *t, strut_channels id) {
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
                                  strut_channels channels, size_t room) {
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

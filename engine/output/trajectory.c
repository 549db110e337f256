/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/trajectory.h"

#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/trajectory_parts.h"

enum { FIRST_FRAMES = 256 };

typedef struct keeper {
  strut_sink sink;
  strut_trajectory *t;
  const strut_scene *scene;
  size_t room, frame_size, width; /* doubles at most, of a frame, of a row */
  size_t capacity, most;          /* frames there is memory for, and may be */
  size_t array_count;
  strut_trajectory_array arrays[STRUT_TRAJECTORY_ARRAYS];
  double *last; /* (width) the latest row, */
  bool waiting; /* which is not among the frames */
} keeper;

double **strut_trajectory_array_of(strut_trajectory *t, strut_channel id) {
  switch (id) {
    case STRUT_CHANNEL_POSITION: return &t->position;
    case STRUT_CHANNEL_VELOCITY: return &t->velocity;
    case STRUT_CHANNEL_LENGTH: return &t->length;
    case STRUT_CHANNEL_FORCE: return &t->force;
    case STRUT_CHANNEL_CONTACT: return &t->contact;
    case STRUT_CHANNEL_ENERGY: break;
  }
  return &t->energy;
}

/* Memory for `capacity` frames. */
static bool grow(keeper *k, size_t capacity) {
  for (size_t i = 0; i < k->array_count; i++) {
    strut_trajectory_array *a = &k->arrays[i];
    double *more = strut_reallocate(*a->values, capacity, a->size * sizeof *more);
    if (!more) return false;
    *a->values = more;
  }
  k->capacity = capacity;
  return true;
}

/* Leaves out every second frame; those that stay are still evenly spaced. */
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
    const strut_trajectory_array *a = &k->arrays[i];
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

static strut_status no_memory(strut_error *error) {
  return strut_fail(error, STRUT_NO_MEMORY, "out of memory for the recorded motion");
}

bool strut_trajectory_contacts(strut_trajectory *t, const strut_scene *scene) {
  t->contact_count = scene->contact_count;
  t->contact_node = strut_arena_allocate(&t->arena, scene->contact_count, sizeof *t->contact_node);
  for (size_t i = 0; i < scene->contact_count && t->contact_node; i++)
    t->contact_node[i] = scene->contacts[i].node;
  return t->contact_node;
}

static strut_status begin(void *context, const strut_record_layout *layout, strut_error *error) {
  keeper *k = context;
  strut_trajectory *t = k->t;
  *t = (strut_trajectory){
      .every = 1, .node_count = k->scene->node_count, .member_count = k->scene->member_count};
  k->width = layout->width;
  k->arrays[0] = (strut_trajectory_array){.values = &t->time, .size = 1};
  k->array_count = k->frame_size = 1;
  for (size_t i = 0; i < layout->channel_count; i++) {
    const strut_record_channel *c = &layout->channels[i];
    k->arrays[k->array_count++] =
        (strut_trajectory_array){.values = strut_trajectory_array_of(t, c->id),
                                 .size = c->items * c->components,
                                 .offset = c->offset};
    k->frame_size += c->items * c->components;
  }
  k->most = k->room / k->frame_size;
  if (k->most < 4) k->most = 4;
  k->last = strut_allocate(k->width, sizeof *k->last);
  bool ready = k->last && strut_trajectory_contacts(t, k->scene) &&
               grow(k, k->most < FIRST_FRAMES ? k->most : FIRST_FRAMES);
  return ready ? STRUT_OK : no_memory(error);
}

static strut_status take_rows(void *context, const double *rows, size_t count, strut_error *error) {
  keeper *k = context;
  for (size_t i = 0; i < count; i++)
    if (!take_row(k, rows + i * k->width)) return no_memory(error);
  return STRUT_OK;
}

/* The end of the motion is always there. */
static strut_status end(void *context, strut_status run_status, strut_error *error) {
  keeper *k = context;
  k->t->status = run_status;
  if (!k->waiting) return STRUT_OK;
  if (k->t->frames == k->capacity && !grow(k, k->capacity + 1)) return no_memory(error);
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
  strut_release(t->position);
  strut_release(t->velocity);
  strut_release(t->length);
  strut_release(t->force);
  strut_release(t->contact);
  strut_release(t->energy);
  strut_arena_free(&t->arena);
  *t = (strut_trajectory){0};
}

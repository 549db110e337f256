/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sink in front of the HDF5 library, which is loaded when a run begins to write. */
#include "engine/output/record_files.h"

#include <stdatomic.h>

#include "engine/base/memory.h"
#include "engine/output/hdf5_library.h"

enum { RESERVE = 8 << 20 };

static atomic_bool leaves_at_exit;

void strut_hdf5_leave_at_exit(void) { leaves_at_exit = true; }

bool strut_hdf5_has_memory(void) {
  void *block = strut_allocate(1, RESERVE);
  strut_release(block);
  return block != NULL;
}

strut_status strut_hdf5_ready(const strut_hdf5_library **library, strut_error *error) {
  strut_status status = strut_hdf5_load(library, error);
  if (status == STRUT_OK && atomic_exchange(&leaves_at_exit, false)) (*library)->leave_at_exit();
  return status;
}

typedef struct late_sink {
  strut_sink sink;
  const strut_hdf5_library *library;
  strut_sink *writer; /* NULL until the run begins, then `sink` is a copy of it */
  const char *directory, *scene_text;
  strut_arena arena;
} late_sink;

static strut_status begin(void *context, const strut_record_layout *layout, strut_error *error) {
  late_sink *self = context;
  if (!strut_hdf5_has_memory()) return strut_no_memory(error, "while writing files");
  strut_status status = strut_hdf5_ready(&self->library, error);
  if (status != STRUT_OK) return status;
  self->writer = self->library->create(self->directory, self->scene_text);
  if (!self->writer) return strut_no_memory(error, "while writing files");
  self->sink = *self->writer;
  return self->sink.begin(self->sink.context, layout, error);
}

strut_sink *strut_hdf5_create(const char *directory, const char *scene_text) {
  late_sink *self = strut_allocate(1, sizeof *self);
  if (!self) return NULL;
  self->sink = (strut_sink){.context = self, .begin = begin};
  self->directory = strut_arena_format(&self->arena, "%s", directory);
  self->scene_text = strut_arena_format(&self->arena, "%s", scene_text);
  if (self->directory && self->scene_text) return &self->sink;
  strut_hdf5_free(&self->sink);
  return NULL;
}

void strut_hdf5_free(strut_sink *sink) {
  late_sink *self = (late_sink *)sink;
  if (!self) return;
  if (self->writer) self->library->free(self->writer);
  strut_arena_free(&self->arena);
  strut_release(self);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sink in front of the HDF5 library, which is loaded when a run begins to write. */
#include "engine/output/record_files.h"

#include <stdatomic.h>
#include <string.h>

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
  char *directory, *scene_text;
  const strut_hdf5_library *library;
  strut_sink *writer; /* NULL until the run begins */
} late_sink;

static strut_status begin(void *context, const strut_record_layout *layout, strut_error *error) {
  late_sink *self = context;
  if (!strut_hdf5_has_memory()) return strut_no_memory(error, "while writing files");
  strut_status status = strut_hdf5_ready(&self->library, error);
  if (status != STRUT_OK) return status;
  if (!self->writer) self->writer = self->library->create(self->directory, self->scene_text);
  if (!self->writer) return strut_no_memory(error, "while writing files");
  return self->writer->begin(self->writer->context, layout, error);
}

static strut_status write_rows(void *context, const double *rows, size_t count,
                               strut_error *error) {
  const strut_sink *writer = ((late_sink *)context)->writer;
  return writer->rows(writer->context, rows, count, error);
}

static strut_status end(void *context, strut_status run_status, strut_error *error) {
  const strut_sink *writer = ((late_sink *)context)->writer;
  return writer->end(writer->context, run_status, error);
}

static char *copy(const char *text) {
  size_t length = strlen(text);
  char *result = strut_allocate(length + 1, 1);
  if (result) memcpy(result, text, length);
  return result;
}

strut_sink *strut_hdf5_create(const char *directory, const char *scene_text) {
  late_sink *self = strut_allocate(1, sizeof *self);
  if (!self) return NULL;
  self->sink = (strut_sink){self, begin, write_rows, end, 0};
  self->directory = copy(directory);
  self->scene_text = copy(scene_text);
  if (self->directory && self->scene_text) return &self->sink;
  strut_hdf5_free(&self->sink);
  return NULL;
}

void strut_hdf5_free(strut_sink *sink) {
  if (!sink) return;
  late_sink *self = sink->context;
  if (self->writer) self->library->free(self->writer);
  strut_release(self->directory);
  strut_release(self->scene_text);
  strut_release(self);
}

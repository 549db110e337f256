/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/vtk.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/number_text.h"
#include "engine/output/file.h"
#include "engine/output/results.h"
#include "engine/output/vtk_frame.h"

enum { FRAME_NAME = 24, OTHERS = 2 };

static const char list_name[] = "structure.pvd", ground_name[] = "ground.vtp";

static const char *frame_name(size_t i, char name[FRAME_NAME]) {
  snprintf(name, FRAME_NAME, "structure_%05u.vtp", (unsigned)(i % 100000));
  return name;
}

/* The number of a frame's file, or -1. */
static int frame_number(const char *name) {
  unsigned number;
  char again[FRAME_NAME];
  if (sscanf(name, "structure_%5u.vtp", &number) != 1) return -1;
  return strcmp(name, frame_name(number, again)) == 0 ? (int)number : -1;
}

/* How many frames an earlier export has left in the directory, counted up to the last one. */
static size_t frames_there(const char *path) {
  size_t count = 0;
  DIR *directory = opendir(path);
  if (!directory) return 0;
  for (struct dirent *entry = readdir(directory); entry; entry = readdir(directory)) {
    int number = frame_number(entry->d_name);
    if (number >= 0 && (size_t)number >= count) count = (size_t)number + 1;
  }
  closedir(directory);
  return count;
}

/* Names of all files that there will be or were, in the arena, ending with NULL; or NULL. */
static const char **file_names(const char *directory, size_t frames, strut_arena *arena) {
  size_t there = frames_there(directory), count = frames > there ? frames : there;
  const char **names = strut_arena_allocate(arena, count + OTHERS + 1, sizeof *names);
  char(*texts)[FRAME_NAME] = strut_arena_allocate(arena, count, sizeof *texts);
  if (!names || !texts) return NULL;
  for (size_t i = 0; i < count; i++) names[i] = frame_name(i, texts[i]);
  names[count] = ground_name;
  names[count + 1] = list_name;
  return names;
}

/* Writes a text and empties the buffer. Frames are many: none is synchronised on its own. */
static strut_status write_text(const char *directory, const char *name, strut_buffer *buffer,
                               strut_error *error) {
  strut_arena arena = {0};
  char *path = strut_arena_format(&arena, "%s/%s", directory, name);
  FILE *stream = NULL;
  strut_status status = STRUT_OK;
  if (buffer->failed || !path) {
    status = strut_fail(error, STRUT_NO_MEMORY, "out of memory while writing files");
  } else {
    errno = 0;
    stream = fopen(path, "wb");
    bool good = stream && fwrite(buffer->text, 1, buffer->length, stream) == buffer->length;
    if (stream && fclose(stream) != 0) good = false;
    char reason[128] = "";
    if (!good && strerror_r(errno, reason, sizeof reason) != 0) reason[0] = '\0';
    if (!good)
      status = strut_fail(error, STRUT_FILE_TROUBLE, "cannot write '%s': %s", name, reason);
  }
  buffer->length = 0;
  strut_arena_free(&arena);
  return status;
}

static strut_status write_frames(const char *stage, const strut_model *model,
                                 const strut_trajectory *motion, const strut_vtk_written *written,
                                 strut_buffer *buffer, strut_error *error) {
  strut_vtk_frame frame;
  strut_status status = STRUT_OK;
  if (!strut_vtk_frame_create(&frame, model, motion))
    status = strut_fail(error, STRUT_NO_MEMORY, "out of memory while writing files");
  for (size_t i = 0; i < written->frames && status == STRUT_OK; i++) {
    char name[FRAME_NAME];
    strut_vtk_frame_write(&frame, i * written->every, buffer);
    status = write_text(stage, frame_name(i, name), buffer, error);
  }
  strut_vtk_frame_free(&frame);
  return status;
}

static strut_status write_list(const char *stage, const strut_model *model,
                               const strut_trajectory *motion, const strut_vtk_written *written,
                               strut_buffer *buffer, strut_error *error) {
  strut_buffer_add(buffer,
                   "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
                   "byte_order=\"LittleEndian\">\n<Collection>\n");
  for (size_t i = 0; i < written->frames; i++) {
    char name[FRAME_NAME], time[STRUT_NUMBER_TEXT];
    strut_number_text(motion->time ? motion->time[i * written->every] : 0, time);
    strut_buffer_add(buffer, "<DataSet timestep=\"%s\" part=\"0\" file=\"%s\"/>\n", time,
                     frame_name(i, name));
    if (model->scene->ground.present)
      strut_buffer_add(buffer, "<DataSet timestep=\"%s\" part=\"1\" file=\"%s\"/>\n", time,
                       ground_name);
  }
  strut_buffer_add(buffer, "</Collection>\n</VTKFile>\n");
  return write_text(stage, list_name, buffer, error);
}

/* As far as the structure comes, and its size beyond on either side. */
static strut_status write_ground(const char *stage, const strut_model *model,
                                 const strut_trajectory *motion, strut_buffer *buffer,
                                 strut_error *error) {
  size_t count = motion->frames * motion->node_count;
  double low = (double)INFINITY, high = -(double)INFINITY;
  if (!model->scene->ground.present) return STRUT_OK;
  for (size_t i = 0; i < count; i++) {
    double x = motion->position[2 * i];
    if (!isfinite(x)) continue;
    low = fmin(low, x);
    high = fmax(high, x);
  }
  if (!(low <= high)) low = high = 0;
  strut_vtk_ground_write(model, low - model->size, high + model->size, buffer);
  return write_text(stage, ground_name, buffer, error);
}

static strut_status write_all(const char *stage, const strut_model *model,
                              const strut_trajectory *motion, const strut_vtk_written *written,
                              strut_error *error) {
  strut_buffer buffer = {0};
  strut_c_locale locale = strut_c_locale_enter();
  strut_status status = write_frames(stage, model, motion, written, &buffer, error);
  if (status == STRUT_OK) status = write_ground(stage, model, motion, &buffer, error);
  if (status == STRUT_OK) status = write_list(stage, model, motion, written, &buffer, error);
  strut_c_locale_leave(locale);
  strut_release(buffer.text);
  return status;
}

strut_status strut_vtk_write(const char *directory, const strut_model *model,
                             const strut_trajectory *motion, strut_vtk_written *written,
                             strut_error *error) {
  strut_results results = {0};
  strut_arena arena = {0};
  size_t most = STRUT_VTK_MOST_FRAMES;
  written->every = motion->frames > most ? (motion->frames + most - 1) / most : 1;
  written->frames = (motion->frames + written->every - 1) / written->every;
  const char **names = file_names(directory, written->frames, &arena);
  if (!names) return strut_fail(error, STRUT_NO_MEMORY, "out of memory while writing files");
  strut_status status = strut_results_begin_named(&results, directory, names, error);
  if (status == STRUT_OK) {
    status = write_all(results.stage, model, motion, written, error);
    if (status == STRUT_OK) {
      status = strut_results_commit(&results, error);
    } else {
      strut_results_abandon(&results);
    }
  }
  strut_arena_free(&arena);
  return status;
}

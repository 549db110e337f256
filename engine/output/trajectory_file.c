/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A trajectory from trajectory.h5: as many frames as there is room for, of the scene beside the file only. */
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/hdf5_library.h"
#include "engine/output/hdf5_parts.h"
#include "engine/output/trajectory.h"

typedef struct reader {
  hid_t file;
  const char *path;
  const strut_scene *scene;
  strut_trajectory *t;
  strut_error *error;
} reader;

static strut_status trouble(const reader *self, const char *what) {
  return strut_trajectory_trouble(self->path, what, self->error);
}

static strut_status report_no_memory(const reader *self) {
  return strut_no_memory(self->error, "for the recorded motion");
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
static bool same_names(const reader *self, const strut_channel_row *row) {
  const strut_owner_row *owner = strut_owner_row_of(row->owner);
  const char *list = row->total ? owner->axis_with_total : owner->axis;
  size_t count = strut_channel_items(row, self->scene);
  if (H5Lexists(self->file, list, H5P_DEFAULT) <= 0) return true;
  hid_t dataset = H5Dopen2(self->file, list, H5P_DEFAULT);
  hid_t type = H5Dget_type(dataset), space = H5Dget_space(dataset);
  size_t longest = H5Tget_size(type);
  bool good = H5Tget_class(type) == H5T_STRING && !H5Tis_variable_str(type) &&
              H5Sget_simple_extent_npoints(space) == (hssize_t)count;
  char *texts = good ? strut_allocate(count, longest) : NULL;
  good = texts && H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts) >= 0;
  for (size_t i = 0; i < count && good; i++) {
    const char *name = strut_channel_item(row, self->scene, i);
    good = strlen(name) <= longest && strncmp(name, texts + i * longest, longest) == 0;
  }
  strut_release(texts);
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(dataset);
  return good;
}

static strut_status read_channel(reader *self, const strut_channel_row *row) {
  if (H5Lexists(self->file, row->name, H5P_DEFAULT) <= 0) return STRUT_OK;
  hid_t dataset = H5Dopen2(self->file, row->name, H5P_DEFAULT);
  hsize_t shape[STRUT_HDF5_RANK] = {0};
  size_t items = strut_channel_items(row, self->scene), size = items * row->components;
  bool fits = dataset >= 0 && shape_of(dataset, 3, shape) && shape[0] == self->t->recorded &&
              shape[1] == items && shape[2] == row->components;
  double *values = fits ? strut_allocate(self->t->frames, size * sizeof *values) : NULL;
  bool good = values && read_rows(dataset, 3, shape, self->t->frames, self->t->every, size, values);
  *strut_trajectory_array(self->t, row->id) = values;
  if (dataset >= 0) H5Dclose(dataset);
  if (!fits) return trouble(self, "it belongs to another structure than the scene beside it");
  return good ? STRUT_OK : values ? trouble(self, "it is damaged") : report_no_memory(self);
}

/* Chooses the number of frames and reads their times. */
static strut_status read_time(reader *self, size_t room) {
  hsize_t shape[STRUT_HDF5_RANK] = {0};
  hid_t dataset = H5Lexists(self->file, "time", H5P_DEFAULT) > 0
                      ? H5Dopen2(self->file, "time", H5P_DEFAULT)
                      : -1;
  if (dataset < 0 || !shape_of(dataset, 1, shape)) {
    if (dataset >= 0) H5Dclose(dataset);
    return trouble(self, "not a trajectory of strut");
  }
  strut_trajectory *trajectory = self->t;
  size_t frame = 1;
  const strut_channel_row *row;
  for (size_t i = 0; (row = strut_channel_at(i)) != NULL; i++)
    if (H5Lexists(self->file, row->name, H5P_DEFAULT) > 0)
      frame += strut_channel_items(row, self->scene) * row->components;
  trajectory->recorded = shape[0];
  trajectory->every = 1;
  while (trajectory->recorded / trajectory->every > 4 &&
         (trajectory->recorded / trajectory->every + 2) * frame > room)
    trajectory->every *= 2;
  trajectory->frames = (trajectory->recorded + trajectory->every - 1) / trajectory->every;
  trajectory->frames +=
      trajectory->recorded > 0 && (trajectory->recorded - 1) % trajectory->every != 0;
  trajectory->time = strut_allocate(trajectory->frames, sizeof *trajectory->time);
  bool good = trajectory->time &&
              (!trajectory->frames || read_rows(dataset, 1, shape, trajectory->frames,
                                                trajectory->every, 1, trajectory->time));
  H5Dclose(dataset);
  return good               ? STRUT_OK
         : trajectory->time ? trouble(self, "it is damaged")
                            : report_no_memory(self);
}

/* The run's status from its text. */
static strut_status run_status(const reader *self) {
  char *text = NULL;
  strut_status found = STRUT_OK;
  hid_t attribute =
      H5Aexists(self->file, "status") > 0 ? H5Aopen(self->file, "status", H5P_DEFAULT) : -1;
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

static strut_status read_file(reader *self, size_t room) {
  strut_trajectory *trajectory = self->t;
  const strut_channel_row *row;
  for (size_t i = 0; (row = strut_channel_at(i)) != NULL; i++)
    if (!strut_channel_is_whole(row) && !same_names(self, row))
      return trouble(self, "it belongs to another structure than the scene beside it");
  trajectory->status = run_status(self);
  strut_status status = read_time(self, room);
  for (size_t i = 0;
       status == STRUT_OK && trajectory->frames && (row = strut_channel_at(i)) != NULL; i++)
    status = read_channel(self, row);
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

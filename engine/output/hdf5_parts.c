/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/hdf5_parts.h"

#include <assert.h>
#include <errno.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "engine/base/memory.h"

enum { DEFLATE_LEVEL = 4 };

strut_hdf5_quiet strut_hdf5_hush(void) {
  strut_hdf5_quiet quiet = {0};
  H5Eget_auto2(H5E_DEFAULT, &quiet.function, &quiet.data);
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  return quiet;
}

void strut_hdf5_unhush(strut_hdf5_quiet quiet) {
  H5Eset_auto2(H5E_DEFAULT, quiet.function, quiet.data);
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

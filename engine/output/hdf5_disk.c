/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/hdf5_disk.h"

#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

#include "engine/base/memory.h"

typedef struct strut_hdf5_piece {
  struct strut_hdf5_piece *next;
  haddr_t address;
  size_t size;
  unsigned char bytes[];
} piece;

/* The driver's file object; the part that HDF5 defines must come first. */
typedef struct driver_file {
  H5FD_t common;
  strut_hdf5_disk *disk;
  haddr_t end, allocated; /* end of what was written; end of what HDF5 may use */
} driver_file;

/* The property that passes the disk from create to open. */
typedef struct driver_setting {
  strut_hdf5_disk *disk;
} driver_setting;

static H5FD_t *open_file(const char *name, unsigned flags, hid_t access, haddr_t largest) {
  (void)name, (void)flags, (void)largest;
  const driver_setting *setting = H5Pget_driver_info(access);
  if (!setting) return NULL;
  driver_file *file = strut_allocate(1, sizeof *file);
  if (!file) {
    setting->disk->trouble = ENOMEM;
    return NULL;
  }
  file->disk = setting->disk;
  return &file->common;
}

static herr_t close_file(H5FD_t *common) {
  strut_release(common);
  return 0;
}

static herr_t query(const H5FD_t *common, unsigned long *flags) {
  (void)common;
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

static haddr_t get_allocated(const H5FD_t *common, H5FD_mem_t type) {
  (void)type;
  return ((const driver_file *)common)->allocated;
}

static herr_t set_allocated(H5FD_t *common, H5FD_mem_t type, haddr_t address) {
  (void)type;
  ((driver_file *)common)->allocated = address;
  return 0;
}

static haddr_t get_end(const H5FD_t *common, H5FD_mem_t type) {
  (void)type;
  return ((const driver_file *)common)->end;
}

/* Copies the part of a piece that lies in [address, address + size). */
static void copy_overlap(const piece *p, haddr_t address, size_t size, unsigned char *to) {
  haddr_t from = p->address > address ? p->address : address;
  haddr_t piece_end = p->address + p->size, end = address + size;
  if (piece_end < end) end = piece_end;
  if (from < end) memcpy(to + (from - address), p->bytes + (from - p->address), end - from);
}

static herr_t read_bytes(H5FD_t *common, H5FD_mem_t type, hid_t transfer, haddr_t address,
                         size_t size, void *buffer) {
  (void)type, (void)transfer;
  const strut_hdf5_disk *disk = ((driver_file *)common)->disk;
  unsigned char *to = buffer;
  size_t done = 0;
  while (done < size) {
    ssize_t got = pread(disk->descriptor, to + done, size - done, (off_t)(address + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    done += (size_t)got;
  }
  memset(to + done, 0, size - done); /* past the end of the data */
  for (const piece *p = disk->first; p; p = p->next) copy_overlap(p, address, size, to);
  return 0;
}

/* Remembers bytes that the disk does not take. Without memory for them they are lost: the file is
   so already. */
static void keep(strut_hdf5_disk *disk, haddr_t address, size_t size, const void *bytes) {
  piece *p = strut_allocate(1, sizeof *p + size);
  if (!p) return;
  p->address = address;
  p->size = size;
  memcpy(p->bytes, bytes, size);
  *disk->last = p;
  disk->last = &p->next;
}

static herr_t write_bytes(H5FD_t *common, H5FD_mem_t type, hid_t transfer, haddr_t address,
                          size_t size, const void *buffer) {
  (void)type, (void)transfer;
  driver_file *file = (driver_file *)common;
  strut_hdf5_disk *disk = file->disk;
  const unsigned char *from = buffer;
  size_t done = 0;
  while (done < size && !disk->trouble) {
    ssize_t put = pwrite(disk->descriptor, from + done, size - done, (off_t)(address + done));
    if (put > 0) done += (size_t)put;
    if (put == 0) disk->trouble = EIO;
    if (put < 0 && errno != EINTR) disk->trouble = errno;
  }
  if (done < size) keep(disk, address + done, size - done, from + done);
  if (address + size > file->end) file->end = address + size;
  return 0;
}

static herr_t truncate_file(H5FD_t *common, hid_t transfer, hbool_t closing) {
  (void)transfer, (void)closing;
  driver_file *file = (driver_file *)common;
  if (file->end != file->allocated && !file->disk->trouble) {
    if (ftruncate(file->disk->descriptor, (off_t)file->allocated) != 0) file->disk->trouble = errno;
  }
  file->end = file->allocated;
  return 0;
}

static hid_t register_driver(void) {
  const H5FD_class_t class = {
#ifdef H5FD_CLASS_VERSION
      .version = H5FD_CLASS_VERSION,
      .value = 511, /* the last of those set aside for use within one program */
#endif
      .name = "strut",
      .maxaddr = INT64_MAX,
      .fc_degree = H5F_CLOSE_STRONG,
      .fapl_size = sizeof(driver_setting),
      .open = open_file,
      .close = close_file,
      .query = query,
      .get_eoa = get_allocated,
      .set_eoa = set_allocated,
      .get_eof = get_end,
      .read = read_bytes,
      .write = write_bytes,
      .truncate = truncate_file,
      .fl_map = H5FD_FLMAP_DICHOTOMY,
  };
  return H5FDregister(&class);
}

hid_t strut_hdf5_disk_create(strut_hdf5_disk *disk, int descriptor) {
  *disk = (strut_hdf5_disk){.descriptor = descriptor, .last = &disk->first};
  driver_setting setting = {disk};
  hid_t creation = H5Pcreate(H5P_FILE_CREATE), access = H5Pcreate(H5P_FILE_ACCESS), file = -1;
  disk->driver = register_driver();
  if (disk->driver >= 0 && H5Pset_obj_track_times(creation, false) >= 0 &&
      H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) >= 0 &&
      H5Pset_driver(access, disk->driver, &setting) >= 0) {
    file = H5Fcreate("strut", H5F_ACC_TRUNC, creation, access);
  }
  H5Pclose(creation);
  H5Pclose(access);
  return file;
}

void strut_hdf5_disk_free(strut_hdf5_disk *disk) {
  if (disk->driver > 0) H5FDunregister(disk->driver);
  piece *p = disk->first;
  while (p) {
    piece *next = p->next;
    strut_release(p);
    p = next;
  }
  *disk = (strut_hdf5_disk){0};
}

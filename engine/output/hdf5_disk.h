/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * An HDF5 file driver whose writing never fails; for hdf5_writer.c alone.
 *
 * HDF5 1.10 cannot close a file once a write has failed: it keeps the file, complains, and crashes
 * when the program exits. So this driver hides a full disk from the library. What did not fit is
 * kept in memory until the file is closed, and the reason is noted here for the caller to ask for.
 */
#ifndef STRUT_ENGINE_OUTPUT_HDF5_DISK_H
#define STRUT_ENGINE_OUTPUT_HDF5_DISK_H

#include <hdf5.h>

/** Destination of one file's bytes. Must outlive the file's closing. */
typedef struct strut_hdf5_disk {
  int descriptor;                 /* open for reading and writing; not owned */
  int trouble;                    /* errno of the first failure, or 0 */
  hid_t driver;                   /* HDF5 1.10 still reads it after releasing it */
  struct strut_hdf5_piece *first; /* data that could not be written, in order */
  struct strut_hdf5_piece **last;
} strut_hdf5_disk;

/** A new HDF5 file, without times in it, on an empty file's descriptor. Negative on failure. */
hid_t strut_hdf5_disk_create(strut_hdf5_disk *disk, int descriptor);
/** Frees pending data and the driver, after the file was closed. A zeroed struct is allowed. */
void strut_hdf5_disk_free(strut_hdf5_disk *disk);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/hdf5_calls.h"

#include <stdatomic.h>
#include <stdbool.h>

#include "engine/output/record_files.h"

const void *strut_hdf5_loaded;

static atomic_bool leaves_at_exit;

strut_status strut_hdf5_load(strut_error *error) {
  strut_status status = strut_library_load(&strut_hdf5_loaded, strut_hdf5_table_find,
                                           sizeof(strut_hdf5_library), error);
  if (status == STRUT_OK && atomic_exchange(&leaves_at_exit, false)) H5dont_atexit();
  return status;
}

void strut_hdf5_leave_at_exit(void) { leaves_at_exit = true; }

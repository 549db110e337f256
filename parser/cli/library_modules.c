/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The program's modules: a table of functions each, in a shared object that is linked to the libraries which the
 * functions are of. Both are loaded when a command first needs them, and stay loaded.
 */
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/library_tables.h"
#include "engine/base/memory.h"
#include "parser/cli/installed.h"

/* Memory that the libraries of a module and their tables take while they are loaded [B]: GLib ends the process
   where its own allocations fail. */
enum { RESERVE = 32 << 20 };

static strut_status out_of_memory(strut_error *error, const char *name) {
  return strut_fail(error, STRUT_NO_MEMORY, "out of memory loading the module '%s'", name);
}

static strut_status cannot_load(strut_error *error, const char *name, const char *reason) {
  if (strstr(reason, "memory") || strstr(reason, "failed to map"))
    return out_of_memory(error, name);
  return strut_fail(error, STRUT_FILE_TROUBLE,
                    "cannot load the module '%s' of strut: %s; install strut again", name, reason);
}

/* The object `table` of the module `name`. */
static const void *find_table(const char *name, const char *table, strut_error *error) {
  char path[STRUT_LONGEST_PATH];
  void *reserve = strut_allocate(1, RESERVE);
  strut_release(reserve);
  if (!reserve) {
    out_of_memory(error, name);
    return NULL;
  }
  if (!strut_find_module(name, path)) {
    cannot_load(error, name, "no such file beside the program");
    return NULL;
  }
  void *module = dlopen(path, RTLD_LAZY | RTLD_LOCAL);
  const void *found = module ? dlsym(module, table) : NULL;
  if (!found) {
    const char *reason = dlerror();
    cannot_load(error, name, reason ? reason : "it is empty");
  }
  return found;
}

const void *strut_algebra_table_find(strut_error *error) {
  return find_table("strut-algebra.so", "strut_algebra_table", error);
}

const void *strut_hdf5_table_find(strut_error *error) {
  return find_table("strut-hdf5.so", "strut_hdf5_table", error);
}

const void *strut_drawing_table_find(strut_error *error) {
  return find_table("strut-drawing.so", "strut_drawing_table", error);
}

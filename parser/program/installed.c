/* SPDX-License-Identifier: GPL-3.0-or-later */
/* realpath belongs to the X/Open part of POSIX. */
#define _XOPEN_SOURCE 700
#include "parser/program/commands.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "engine/base/memory.h"
#include "engine/model/algebra/cholmod_factor.h"
#include "engine/output/draw/figure.h"
#include "engine/output/hdf5_library.h"
#include "engine/statics/algebra.h"

/* folder/below/name; false where that is too long or does not exist. */
static bool join(const char *folder, const char *below, const char *name,
                 char path[STRUT_LONGEST_PATH]) {
  char joined[2 * STRUT_LONGEST_PATH];
  int length = snprintf(joined, sizeof joined, "%s%s%s", folder, below, name);
  if (length < 0 || (size_t)length >= sizeof joined || access(joined, R_OK) != 0) return false;
  char *whole = realpath(joined, NULL); /* without the steps up */
  bool fits = whole && strlen(whole) < STRUT_LONGEST_PATH;
  if (fits) strcpy(path, whole);
  free(whole);
  return fits;
}

/* The folder of the program. */
static bool find_folder(char folder[STRUT_LONGEST_PATH]) {
  ssize_t length = readlink("/proc/self/exe", folder, STRUT_LONGEST_PATH - 1);
  if (length <= 0) return false;
  folder[length] = '\0';
  *strrchr(folder, '/') = '\0';
  return true;
}

/* The path of a module of the program: below lib/strut, or in modules beside a program that is not installed. */
static bool find_module(const char *name, char path[STRUT_LONGEST_PATH]) {
  char folder[STRUT_LONGEST_PATH];
  return find_folder(folder) && (join(folder, "/" STRUT_MODULES_FROM_PROGRAM "/", name, path) ||
                                 join(folder, "/modules/", name, path));
}

bool strut_find_installed(const char *name, const char *built, char path[STRUT_LONGEST_PATH]) {
  char folder[STRUT_LONGEST_PATH];
  return find_folder(folder) && (join(folder, "/" STRUT_SHARE_FROM_PROGRAM "/", name, path) ||
                                 join(folder, "/", built, path));
}

/*
 * The program's modules: shared objects with those files of strut that use a foreign library, linked to it
 * (engine/base/library.h). They are loaded when a command first needs them, and stay loaded; what they call of
 * strut is the program's.
 */

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

/* A table of functions in a module, found once. */
typedef struct late_library {
  const char *module, *table;
  size_t size; /* of the table */
  _Atomic(const void *) loaded;
} late_library;

/* The object `table` of the module. */
static const void *find_table(const late_library *library, strut_error *error) {
  char path[STRUT_LONGEST_PATH];
  void *reserve = strut_allocate(1, RESERVE);
  strut_release(reserve);
  if (!reserve) {
    out_of_memory(error, library->module);
    return NULL;
  }
  if (!find_module(library->module, path)) {
    cannot_load(error, library->module, "no such file beside the program");
    return NULL;
  }
  void *module = dlopen(path, RTLD_LAZY | RTLD_LOCAL);
  const void *found = module ? dlsym(module, library->table) : NULL;
  if (!found) {
    const char *reason = dlerror();
    cannot_load(error, library->module, reason ? reason : "it is empty");
  }
  return found;
}

static strut_status load_table(late_library *library, strut_error *error) {
  strut_error own = {0};
  const strut_library_stamp *found = find_table(library, &own);
  if (!found) return strut_fail(error, own.status, "%s", own.message);
  if (found->size != library->size || strcmp(found->version, STRUT_VERSION) != 0)
    return strut_fail(error, STRUT_FILE_TROUBLE,
                      "a module belongs to strut %s, and this is strut " STRUT_VERSION
                      ": install strut again",
                      found->version);
  atomic_store(&library->loaded, found);
  return STRUT_OK;
}

static pthread_mutex_t loading = PTHREAD_MUTEX_INITIALIZER;

/* The table, from any thread. */
static strut_status load(late_library *library, const void **table, strut_error *error) {
  strut_status status = STRUT_OK;
  if (!atomic_load(&library->loaded)) {
    pthread_mutex_lock(&loading);
    if (!atomic_load(&library->loaded)) status = load_table(library, error);
    pthread_mutex_unlock(&loading);
  }
  *table = atomic_load(&library->loaded);
  return status;
}

/* The definition of strut_NAME_load (engine/base/library.h) for a table in that module. */
#define LATE_LIBRARY(name, module)                                                                 \
  strut_status strut_##name##_load(const strut_##name##_library **library, strut_error *error) {   \
    static late_library late = {module, "strut_" #name "_table", sizeof **library, NULL};          \
    const void *table = NULL;                                                                      \
    strut_status status = load(&late, &table, error);                                              \
    *library = table;                                                                              \
    return status;                                                                                 \
  }

LATE_LIBRARY(cholmod, "strut-algebra.so")
LATE_LIBRARY(sparse_algebra, "strut-algebra.so")
LATE_LIBRARY(hdf5, "strut-hdf5.so")
LATE_LIBRARY(cairo, "strut-drawing.so")

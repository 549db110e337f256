/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the program opens: models, runs, what is installed with it, and its modules. */
#define _XOPEN_SOURCE 700 /* realpath belongs to the X/Open part of POSIX */
#include "parser/program/commands.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/memory.h"
#include "engine/model/algebra/cholmod_factor.h"
#include "engine/output/draw/figure.h"
#include "engine/output/file.h"
#include "engine/output/hdf5_library.h"
#include "engine/output/results.h"
#include "engine/statics/algebra.h"
#include "engine/statics/equilibria/equilibria.h"
#include "parser/language/read/read_scene.h"
#include "parser/language/write/write_scene.h"
#include "parser/program/command/scene_options.h"

enum { MOST_MESSAGES = 50 };

const char *strut_model_name(const strut_arguments *arguments) {
  return strcmp(arguments->model, "-") == 0 ? "<stdin>" : arguments->model;
}

strut_status strut_print_found(strut_diagnostics *diagnostics, strut_status status, bool noted,
                               strut_setup *setup) {
  if (status == STRUT_BAD_SCENE) {
    const char *messages = strut_diagnostics_render(diagnostics, MOST_MESSAGES);
    if (messages) fputs(messages, stderr);
    if (!messages) status = STRUT_NO_MEMORY;
  }
  if (status == STRUT_OK && diagnostics->note_count && !noted) {
    const char *notes = strut_diagnostics_render_notes(diagnostics);
    if (notes) fputs(notes, stderr);
    if (!notes) strut_setup_free(setup);
    if (!notes) status = STRUT_NO_MEMORY;
  }
  return status;
}

strut_status strut_open_model(const strut_arguments *arguments, strut_open_purpose purpose,
                              strut_setup *setup, strut_open_report *report) {
  const strut_purpose purposes[] = {[STRUT_OPEN_FOR_RUN] = strut_run_options_purpose(arguments),
                                    [STRUT_OPEN_AS_RUN] = STRUT_FOR_ANY,
                                    [STRUT_OPEN_FOR_ANY] = STRUT_FOR_ANY,
                                    [STRUT_OPEN_FOR_STATICS] = STRUT_FOR_ANY_STATICS};
  strut_open_report own = {.prints = true}, *to = report ? report : &own;
  strut_status status = strut_file_read(arguments->model, &to->text, &to->length, &to->error);
  if (status != STRUT_OK) {
    strut_print_failure(status, &to->error);
    to->error = (strut_error){0}; /* it is said */
    return status;
  }
  status = strut_setup_read(setup, strut_model_name(arguments), to->text, to->length,
                            arguments->overrides, arguments->override_count, purposes[purpose],
                            &to->diagnostics);
  if (to->prints) status = strut_print_found(&to->diagnostics, status, arguments->no_notes, setup);
  if (status == STRUT_NO_MEMORY) strut_print_out_of_memory();
  if (status == STRUT_OK && purpose <= STRUT_OPEN_AS_RUN) {
    status = strut_resolve_start_equilibrium(setup, &to->error);
    if (status != STRUT_OK) strut_setup_free(setup);
    if (to->prints) strut_print_failure(status, &to->error);
  }
  if (to->prints) strut_diagnostics_free(&to->diagnostics);
  if (!report || (to->prints && status != STRUT_OK)) strut_open_report_free(to);
  return status;
}

void strut_open_report_free(strut_open_report *report) {
  strut_diagnostics_free(&report->diagnostics);
  strut_release(report->text);
  *report = (strut_open_report){.prints = report->prints};
}

strut_status strut_warn_of_scene(const strut_setup *setup) {
  strut_findings warnings = {0};
  strut_status status = strut_setup_warn(setup, &warnings);
  for (size_t i = 0; i < warnings.count && !status; i++)
    fprintf(stderr, "strut: warning: %s\n", warnings.items[i].message);
  strut_findings_free(&warnings);
  return status ? strut_print_out_of_memory() : STRUT_OK;
}

/* Does the scene say something in a way that a flat one loses? */
static bool is_abbreviated(const strut_tree *root) {
  static const char *const keys[] = {"parameters", "groups", "parts"};
  for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
    if (strut_tree_find(root, keys[i], NULL)) return true;
  return false;
}

strut_status strut_write_short(const strut_arguments *arguments, const char *text, size_t length,
                               const char *before, const strut_setup *setup, bool all,
                               char **result) {
  strut_diagnostics unused = {0};
  strut_scene_source *tree = NULL;
  const char *name = strut_model_name(arguments);
  bool wanted = true;
  *result = NULL;
  strut_status status = strut_scene_source_open(name, text, length, &unused, &tree);
  strut_diagnostics_free(&unused);
  if (status == STRUT_OK) wanted = all || is_abbreviated(tree->document.root);
  if (status == STRUT_OK && wanted)
    status = strut_short_write(tree, arguments->overrides, arguments->override_count, before, setup,
                               arguments->output ? arguments->output : name, result);
  strut_scene_source_free(tree);
  if (status == STRUT_NO_MEMORY) return strut_print_out_of_memory();
  if (!*result && wanted)
    fputs(
        "strut: the scene is written without parameters, groups and parts: with them it would read "
        "as "
        "another one, as where a node of a copy has moved, or a file that it names is in another "
        "folder\n",
        stderr);
  return STRUT_OK;
}

strut_status strut_check_output_writable(const strut_arguments *arguments,
                                         const char *const *names) {
  strut_results results = {0};
  strut_error error = {0};
  if (!arguments->output) return STRUT_OK;
  strut_status status = strut_results_begin_named(&results, arguments->output, names, &error);
  if (status != STRUT_OK) strut_print_error(&error);
  strut_results_abandon(&results);
  return status;
}

strut_status strut_try_file(const char *path) {
  strut_file file = {0};
  strut_error error = {0};
  if (!path) return STRUT_OK;
  strut_status status = strut_file_open_path(&file, path, &error);
  if (status != STRUT_OK) strut_print_error(&error);
  strut_file_abandon(&file);
  return status;
}

/* ---- runs ---- */

static bool is_directory(const char *path) {
  struct stat found;
  if (strcmp(path, "-") == 0) return false; /* the standard input */
  return stat(path, &found) == 0 && S_ISDIR(found.st_mode);
}

/* directory/name in the arena, or NULL. */
static char *inside(strut_arena *arena, const char *directory, const char *name) {
  size_t length = strlen(directory);
  bool slash = length > 0 && directory[length - 1] == '/';
  return strut_arena_format(arena, "%s%s%s", directory, slash ? "" : "/", name);
}

/* Checks for the files that every run writes; of another kind, such as a FIFO, they are none of a run. */
static strut_status check_files(const char *directory, const char *const paths[3], bool *summarised,
                                strut_error *error) {
  static const char *const lacks[] = {
      "'%s' holds no run: it has no scene.yaml ('strut run MODEL -o DIR' writes one)",
      "'%s' holds no recorded motion: it has no trajectory.h5", NULL};
  for (int i = 0; i < 3; i++) {
    struct stat found;
    bool there = stat(paths[i], &found) == 0;
    if (!there && lacks[i]) return strut_fail(error, STRUT_FILE_TROUBLE, lacks[i], directory);
    if (there && !S_ISREG(found.st_mode))
      return strut_fail(error, STRUT_FILE_TROUBLE, "'%s' is not a regular file", paths[i]);
    *summarised = there;
  }
  return STRUT_OK;
}

static strut_status read_motion(const char *directory, size_t room, strut_opened *opened,
                                strut_error *error) {
  strut_status status =
      strut_trajectory_read(directory, &opened->setup.scene, room, &opened->motion, error);
  if (status != STRUT_OK) return status;
  if (opened->motion.position && opened->motion.frames > 0) return STRUT_OK;
  return strut_fail(
      error, STRUT_FILE_TROUBLE,
      opened->motion.frames == 0
          ? "the run in '%s' ended before anything was recorded"
          : "the run in '%s' recorded no positions: add 'position' to the channels of "
            "'output' in its scene",
      directory);
}

/* Reads the run in a directory. Messages about its scene are printed by strut_open_model. */
static strut_status open_directory(const strut_arguments *arguments, size_t room,
                                   strut_arena *arena, strut_opened *opened, strut_error *error) {
  const char *directory = arguments->model;
  char *scene = inside(arena, directory, "scene.yaml");
  char *trajectory = inside(arena, directory, "trajectory.h5");
  char *summary = inside(arena, directory, "summary.json");
  if (!scene || !trajectory || !summary) return strut_no_memory(error, "");
  bool summarised = false;
  const char *const paths[] = {scene, trajectory, summary};
  strut_status status = check_files(directory, paths, &summarised, error);
  if (status != STRUT_OK) return status;
  strut_arguments inner = *arguments;
  inner.model = scene;
  status = strut_open_model(&inner, STRUT_OPEN_FOR_ANY, &opened->setup, NULL);
  if (status != STRUT_OK) return status;
  status = strut_model_compile(&opened->setup.scene, &opened->model, error);
  if (status == STRUT_OK) status = read_motion(directory, room, opened, error);
  size_t length = 0;
  if (status == STRUT_OK && summarised)
    status = strut_file_read(summary, &opened->summary, &length, error);
  return status;
}

strut_status strut_open_run(const strut_arguments *arguments, size_t room, strut_opened *opened) {
  strut_error error = {0};
  strut_arena arena = {0};
  *opened = (strut_opened){.run = is_directory(arguments->model)};
  if (opened->run && arguments->override_count > 0)
    return strut_usage_error(arguments, "--set needs a model, not the finished run '%s'",
                             arguments->model);
  strut_status status;
  if (opened->run) {
    status = open_directory(arguments, room, &arena, opened, &error);
  } else {
    status = strut_open_model(arguments, STRUT_OPEN_AS_RUN, &opened->setup, NULL);
    if (status == STRUT_OK)
      status = strut_model_compile(&opened->setup.scene, &opened->model, &error);
  }
  if (status != STRUT_OK && error.status != STRUT_OK) strut_print_error(&error);
  if (status != STRUT_OK) strut_opened_free(opened);
  strut_arena_free(&arena);
  return status;
}

void strut_opened_free(strut_opened *opened) {
  strut_release(opened->summary);
  strut_trajectory_free(&opened->motion);
  strut_model_free(opened->model);
  strut_setup_free(&opened->setup);
  *opened = (strut_opened){0};
}

/* ---- what is installed ---- */

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

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The program strut: finds the command, runs it, and returns its exit code. */
#include <gsl/gsl_errno.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#ifdef _OPENMP
#include <omp.h>
#endif
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "engine/base/memory.h"
#include "engine/output/buffer.h"
#include "engine/output/record_files.h"
#include "engine/run/simulate.h"
#include "parser/language/yaml/document.h"
#include "parser/program/check/check_messages.h"
#include "parser/program/commands.h"

/* --threads, for all that computes on several. */
static void limit_threads(const strut_given_whole *threads) {
  if (!threads->value) return;
  setenv("OMP_NUM_THREADS", threads->text, 1);
#ifdef _OPENMP
  omp_set_num_threads((int)threads->value);
#endif
}

/* Is help asked for, even where an option lacks its value? */
static bool asks_for_help(int argc, char **argv) {
  for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++)
    if (strcmp(argv[i], "--help") == 0) return true;
  return false;
}

static strut_status run_command(const strut_command *command, int argc, char **argv) {
  strut_arguments arguments;
  const double begin = strut_run_clock();
  command = strut_command_variant_of(command, argc - 1, argv + 1);
  if (asks_for_help(argc, argv)) {
    strut_command_explain(command);
    return STRUT_OK;
  }
  strut_status status = strut_arguments_read(command, argc, argv, &arguments);
  if (status == STRUT_OK) limit_threads(&arguments.threads);
  if (status == STRUT_OK && arguments.help) {
    strut_command_explain(command);
  } else if (status == STRUT_OK) {
    status = command->run ? command->run(&arguments) : strut_analysis_run(&arguments);
    /* Below a table; never in JSON or a file, which must not change from run to run. */
    if (status == STRUT_OK && command->timed && !arguments.json && !arguments.quiet &&
        !arguments.format.index)
      printf("\n  took %s\n", strut_quantity_of(strut_run_clock() - begin, 3, "s").text);
  }
  strut_arguments_free(&arguments);
  return status;
}

/* What `strut MODEL` does: runs what describes a run, computes a study, finds the equilibria of the rest. */
static const strut_command *natural_command(const char *path) {
  strut_diagnostics diagnostics = {0};
  strut_scene_source *source = NULL;
  strut_error error = {0};
  char *text = NULL;
  size_t length;
  if (strut_is_study(path)) return &strut_command_sweep;
  const strut_command *command = &strut_command_run; /* which says what is wrong with the file */
  if (strut_file_read(path, &text, &length, &error) != STRUT_OK) return command;
  if (strut_scene_source_open(path, text, length, &diagnostics, &source) == STRUT_OK) {
    /* with what its base holds */
    const strut_tree *root = source->document.root;
    if (root && root->kind == STRUT_TREE_MAP && !strut_tree_find(root, "run", NULL))
      command = &strut_command_equilibria;
  }
  strut_scene_source_free(source);
  strut_diagnostics_free(&diagnostics);
  strut_release(text);
  return command;
}

static bool names_file(const char *word) {
  const char *end = strrchr(word, '.');
  struct stat found;
  return (end && (strcmp(end, ".yaml") == 0 || strcmp(end, ".yml") == 0)) ||
         (strchr(word, '/') && stat(word, &found) == 0 && S_ISREG(found.st_mode));
}

static strut_status run_program(int argc, char **argv) {
  const char *first = argc > 1 ? argv[1] : NULL;
  if (!first) {
    fprintf(stderr, "strut: missing COMMAND; 'strut help' lists the commands\n");
    return STRUT_USAGE;
  }
  if (strcmp(first, "--version") == 0 || strcmp(first, "-V") == 0) {
    printf("strut %s\n", STRUT_VERSION);
    return STRUT_OK;
  }
  if (strcmp(first, "complete") == 0) return strut_complete(argc - 2, argv + 2);
  if (strcmp(first, "--help") == 0 || strcmp(first, "-h") == 0) first = "help";
  if (!strut_command_named(first) && names_file(first))
    return run_command(natural_command(first), argc, argv);
  const strut_command *command = strut_command_find(first);
  return command ? run_command(command, argc - 1, argv + 1) : STRUT_USAGE;
}

/*
 * Blocks from this size on go back to the system when they are freed. By default glibc keeps those of up to 32 MB
 * as soon as one of that size has been freed: a file of a million members then takes 50 MB more.
 */
enum { LARGE_BLOCK = 4 << 20 };

static void return_large_blocks(void) {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, LARGE_BLOCK);
#endif
}

/*
 * OpenBLAS starts its threads when it is loaded, and at exit waits for ever for those that it had no memory for.
 * Where the process's memory is limited (ulimit -v), it gets none.
 */
static void keep_blas_to_one_thread(void) {
  struct rlimit limit;
  bool limited = getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  if (limited) setenv("OPENBLAS_NUM_THREADS", "1", 1);
}

int main(int argc, char **argv) {
  return_large_blocks();
  keep_blas_to_one_thread();
  strut_streams_open();
  strut_hdf5_leave_at_exit();
  gsl_set_error_handler_off(); /* GSL reports by its return values; it must not abort */
  return strut_streams_close(run_program(argc, argv));
}

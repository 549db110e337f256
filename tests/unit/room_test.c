/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What memory cannot hold is refused before it is allocated: a scene by its counts, a factor by its
   nonzeros, a text by its colons and commas. */
#include "engine/model/memory_estimate.h"

#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

#include "engine/base/memory.h"
#include "engine/model/model.h"
#include "engine/model/sparse.h"
#include "parser/read/read_scene.h"
#include "parser/yaml/document.h"
#include "parser/yaml/document_parts.h"
#include "tests/support/check.h"
#include "tests/support/sanitized.h"

/* Nothing but its counts is looked at. */
static strut_status compile(size_t nodes, size_t members, strut_error *error) {
  strut_scene scene = {.node_count = nodes, .member_count = members};
  strut_model *model = NULL;
  *error = (strut_error){0};
  uint64_t before = strut_allocation_count();
  strut_status status = strut_model_compile(&scene, &model, error);
  assert_null(model);
  assert_true(strut_allocation_count() == before);
  return status;
}

TEST(more_than_the_machine_has) {
  strut_error error;
  assert_int_equal(compile((size_t)1 << 40, (size_t)1 << 41, &error), STRUT_NO_MEMORY);
  print_message("%s\n", error.message);
  assert_non_null(strstr(error.message, "1099511627776 nodes"));
  assert_non_null(strstr(error.message, "MB of memory, and the machine has"));
}

TEST(more_than_the_process_may_have) {
  static const int resource[] = {RLIMIT_AS, RLIMIT_DATA};
  for (int i = 0; i < 2; i++) {
    struct rlimit before, now;
    strut_error error;
    assert_int_equal(getrlimit(resource[i], &before), 0);
    now = before, now.rlim_cur = 300000000;
    assert_int_equal(setrlimit(resource[i], &now), 0);
    strut_status status = compile(400000, 1000000, &error); /* 176 + 220 MB */
    assert_int_equal(setrlimit(resource[i], &before), 0);
    assert_int_equal(status, STRUT_NO_MEMORY);
    print_message("%s\n", error.message);
    assert_non_null(strstr(error.message, "needs at least 396 MB"));
    assert_non_null(strstr(error.message, i ? "(ulimit -d) 300 MB" : "(ulimit -v) 300 MB"));
  }
}

TEST(a_small_scene_has_room) {
  strut_scene scene = {.node_count = 100, .member_count = 100};
  assert_int_equal(strut_memory_check_model(&scene, NULL), STRUT_OK);
}

/* Data segments of this process [B]; OpenBLAS, where it is installed, has large ones. */
static rlim_t data_in_use(void) {
  unsigned long kilobytes = 0;
  char line[200];
  FILE *file = fopen("/proc/self/status", "r");
  assert_non_null(file);
  while (fgets(line, sizeof line, file)) sscanf(line, "VmData: %lu", &kilobytes);
  fclose(file);
  assert_true(kilobytes > 0);
  return (rlim_t)kilobytes * 1024;
}

/* A plane grid's matrix, whose factor fills in: counted, refused, and not computed. */
TEST(a_factor) {
  enum { SIDE = 600 };
  strut_arena arena = {0};
  strut_triplets t = {0};
  strut_factor *factor;
  struct rlimit before, now;
  strut_error error = {0};
  if (SANITIZED) skip();
  assert_true(strut_triplets_reserve(&t, 3 * SIDE * SIDE, &arena));
  for (int32_t i = 0; i < SIDE * SIDE; i++) {
    strut_triplets_add(&t, i, i, 5);
    if ((i + 1) % SIDE) strut_triplets_add(&t, i, i + 1, -1);
    if (i + SIDE < SIDE * SIDE) strut_triplets_add(&t, i, i + SIDE, -1);
  }
  strut_sparse *matrix = strut_sparse_build(SIDE * SIDE, &t, &arena);
  assert_non_null(matrix);
  assert_int_equal(getrlimit(RLIMIT_DATA, &before), 0);
  now = before, now.rlim_cur = data_in_use() + 100000000;
  assert_int_equal(setrlimit(RLIMIT_DATA, &now), 0);
  strut_status status = strut_factor_create(matrix, &factor, &error);
  assert_int_equal(setrlimit(RLIMIT_DATA, &before), 0);
  print_message("%s\n", error.message);
  assert_int_equal(status, STRUT_NO_MEMORY);
  assert_null(factor);
  assert_non_null(strstr(error.message, "the factor of a matrix of 360000 rows"));
  assert_null(strstr(error.message, "out of memory"));
  assert_int_equal(strut_factor_create(matrix, &factor, &error), STRUT_OK);
  double kept = 12.0 * factor->start[factor->n];
  print_message("%.0f MB are kept of it\n", kept / 1e6);
  assert_true(kept > 50e6);
  strut_factor_free(factor);
  strut_arena_free(&arena);
}

TEST(a_factor_that_cannot_be_counted) {
  strut_error error = {0};
  assert_int_equal(strut_memory_check_factor(100000000, 3e9, &error), STRUT_NO_MEMORY);
  assert_non_null(strstr(error.message, "3e+09 nonzeros"));
}

static double values_of(const strut_tree *tree) {
  double sum = 1;
  for (const strut_tree *child = tree->first; child; child = child->next) sum += values_of(child);
  return sum;
}

/* By hand; and hardly more than is read: a colon in running text counts for a pair. */
TEST(a_text) {
  static const char text[] = "a: {b: [1, 2], c: x, d: []}\n# e: f, [g, h]\ni: 'j: k, [l, m]'\n";
  size_t length = sizeof text - 1;
  assert_near(strut_document_needs(text, length), 12 * (double)sizeof(strut_tree) + (double)length,
              0);
  static const char *const files[] = {"models/crawler/crawler.yaml", "models/basics/belt.yaml",
                                      "models/gallery/d-bar.yaml"};
  for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
    char *file;
    strut_document document = {0};
    strut_diagnostics diagnostics = {0};
    assert_int_equal(strut_file_read(files[i], &file, &length, NULL), STRUT_OK);
    strut_diagnostics_source(&diagnostics, files[i], file, length);
    assert_int_equal(strut_document_read(&document, &diagnostics), STRUT_OK);
    double reported = (strut_document_needs(file, length) - (double)length) / sizeof(strut_tree);
    double read = values_of(document.root);
    print_message("%s: %.0f values reported, %.0f read\n", files[i], reported, read);
    assert_within(reported, 0.8 * read, 1.02 * read);
    strut_document_free(&document);
    strut_diagnostics_free(&diagnostics);
    strut_release(file);
  }
}

TEST(a_large_text) {
  enum { PAIRS = 4000000 };
  char *text = strut_allocate(5 * PAIRS + 1, 1);
  struct rlimit before, now;
  strut_error error = {0};
  if (SANITIZED) { /* has mapped far more than any limit, and stops where it may map no more */
    strut_release(text);
    skip();
  }
  assert_non_null(text);
  for (int i = 0; i < PAIRS; i++) memcpy(text + 5 * i, "k: v\n", 5);
  assert_int_equal(getrlimit(RLIMIT_AS, &before), 0);
  now = before, now.rlim_cur = 300000000;
  assert_int_equal(setrlimit(RLIMIT_AS, &now), 0);
  strut_status status = strut_memory_check_document("large.yaml", text, 5 * PAIRS, &error);
  assert_int_equal(setrlimit(RLIMIT_AS, &before), 0);
  assert_int_equal(status, STRUT_NO_MEMORY);
  print_message("%s\n", error.message);
  char needs[80]; /* a key and a value for each pair, and the text */
  snprintf(needs, sizeof needs, "reading 'large.yaml' needs at least %.0f MB",
           1e-6 * (2.0 * PAIRS * sizeof(strut_tree) + 5.0 * PAIRS));
  assert_non_null(strstr(error.message, needs));
  strut_release(text);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* CSV tables read for pictures: cells, numbers, what is no table, and nothing left behind. */
#include "parser/program/command/scene_options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "tests/support/check.h"
#include "tests/support/heap.h"
#include "tests/unit/scratch.h"

static strut_status read_text_as_file(const char *text, strut_table *table) {
  const char *path = scratch_path("table.csv");
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  fputs(text, file);
  assert_int_equal(fclose(file), 0);
  return strut_table_read(NULL, path, table); /* messages are for other tests */
}

BEFORE_EACH { scratch_make(); }

TEST(cells_and_numbers) {
  strut_table table;
  assert_ok(read_text_as_file("f [Hz],\"a, \"\"b\"\"\",v\r\n1.5,x,-2e3\r\n\r\n.25,\"y\nz\",nan\r\n",
                              &table));
  assert_all_equal(table.column_count, 3, table.row_count, 2);
  assert_all_texts(table.columns[0].name, "f", table.columns[0].unit, "Hz", table.columns[1].name,
                   "a, \"b\"", table.columns[1].text[1], "y\nz");
  assert_null(table.columns[1].value);
  assert_true(table.columns[0].value[0] == 1.5 && table.columns[0].value[1] == 0.25);
  assert_true(table.columns[2].value[0] == -2000 && isnan(table.columns[2].value[1]));
  strut_arena_free(&table.arena);
}

/* Each way to fail gives everything back, whether the table had begun or not. */
TEST(a_table_with_errors_leaves_nothing) {
  static const char *const bad[] = {"", "a,b\n", "a,b\n1,2\n3\n", "a,b\n1,\"2\n", "a\n\"1\"2\n"};
  size_t before = 0;
  for (int round = 0; round < 20; round++) {
    if (round == 8) before = heap_in_use(); /* by now malloc's caches are full */
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
      strut_table table;
      assert_int_equal(read_text_as_file(bad[i], &table), STRUT_BAD_SCENE);
      assert_null(table.arena.chunk);
    }
  }
  assert_in_range(heap_in_use(), 0, before + 500);
}

/* The same where memory is out, within a table of several pieces of memory. */
TEST(no_memory_leaves_nothing) {
  static char text[60000] = "a,b\n";
  size_t before = 0, length = strlen(text);
  while (length + 10 < sizeof text)
    length += (size_t)snprintf(text + length, sizeof text - length, "1,x\n");
  for (int round = 0; round < 20; round++) {
    if (round == 8) before = heap_in_use();
    REFUSE_EACH(n, status, 2) {
      strut_table table;
      status = refused(n, read_text_as_file(text, &table));
      if (status) assert_null(table.arena.chunk);
      strut_arena_free(&table.arena);
    }
  }
  assert_in_range(heap_in_use(), 0, before + 500);
}

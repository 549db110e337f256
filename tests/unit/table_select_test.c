/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables chosen from tables: rows of a text, differences of two sides, between points too. */
#include "engine/output/figures/table_figure.h"
#include "tests/support/check.h"

enum { ROWS = 9 };
enum { SIDE, X, Y, WORD, COLUMNS };

/* Side a has x = 0, 1, 3 with y = x^2 and a lone one in panel q; side b stands around and between. */
static const char *const side[ROWS] = {"a", "b", "b", "a", "b", "a", "b", "b", "a"};
static const double x[ROWS] = {3, 0, 2, 0, 1, 1, 4, 2, 2};
static const double y[ROWS] = {9, 10, 20, 0, 30, 1, 40, 50, 7};
static const char *const word[ROWS] = {"I", "I", "I", "I", "II", "I", "I", "I", "I"};
static const char *const panel[ROWS] = {"p", "p", "p", "p", "p", "p", "p", "q", "q"};

static strut_table_column columns[COLUMNS + 1] = {{.name = "side", .unit = "", .text = side},
                                                  {.name = "x", .unit = "s", .value = x},
                                                  {.name = "y", .unit = "m", .value = y},
                                                  {.name = "word", .unit = "", .text = word},
                                                  {.name = "panel", .unit = "", .text = panel}};
static const strut_table table = {
    .column_count = COLUMNS + 1, .row_count = ROWS, .columns = columns};
static const int compared[] = {Y, WORD};

static strut_status choose(int only, const char *text, int difference, bool between,
                           strut_table *chosen, strut_error *error) {
  const strut_table_pairing pairing = {.keys = {STRUT_NO_COLUMN, COLUMNS, X},
                                       .between = between,
                                       .values = compared,
                                       .value_count = 2};
  strut_status status = strut_table_choose(&table, only, text, NULL, chosen, error);
  if (!status && difference != STRUT_NO_COLUMN)
    status = strut_table_subtract(chosen, difference, &pairing, error);
  return status;
}

static void check(bool between, const double *wanted, const char *marks) {
  strut_table less = {0};
  assert_ok(choose(STRUT_NO_COLUMN, NULL, SIDE, between, &less, NULL));
  assert_all_equal(less.row_count, 5, less.column_count, COLUMNS + 2);
  assert_all_texts(less.columns[Y].name, "y, b less a", less.columns[COLUMNS + 1].name, "a: other");
  for (size_t k = 0, i = 0; k < 5; k++, i++) {
    while (strcmp(side[i], "b") != 0) i++;
    double found = less.columns[Y].value[k];
    assert_true(isnan(wanted[k]) ? isnan(found) : found == wanted[k]);
    assert_int_equal(*less.columns[COLUMNS + 1].text[k] != 0, marks[k] == '1');
    assert_true(strcmp(less.columns[SIDE].text[k], "b") == 0 && less.columns[X].value[k] == x[i]);
  }
  strut_arena_free(&less.arena);
}

/* b has x = 0, 2, 1, 4 in panel p and 2 in panel q, in that order. */
TEST(differences) {
  const double alone[] = {10, NAN, 29, NAN, 43}, line[] = {10, 15, 29, NAN, 43};
  check(false, alone, "01110");
  check(true, line,
        "00110"); /* at 2, half way from 1 to 9; 4 is beyond the last; I is not II at 1 */
}

TEST(only) {
  strut_table some = {0}, none = {0};
  strut_table_groups groups;
  assert_ok(choose(COLUMNS, "q", STRUT_NO_COLUMN, false, &some, NULL));
  assert_int_equal(some.row_count, 2);
  assert_true(some.columns[Y].value[0] == 50 && some.columns[Y].value[1] == 7);
  assert_null(some.columns[SIDE].value);
  assert_ok(strut_table_groups_find(&some, SIDE, 2, "", &groups, NULL));
  assert_int_equal(groups.count, 2);
  assert_all_texts(groups.name[0], "b", groups.name[1], "a"); /* not the order of all rows */
  assert_int_equal(choose(COLUMNS, "r", STRUT_NO_COLUMN, false, &none, NULL), STRUT_USAGE);
  strut_arena_free(&some.arena);
  strut_arena_free(&none.arena);
}

/* Both at once, and every allocation fails once. */
TEST(no_memory) {
  REFUSE_EACH(n, status, 1) {
    strut_table chosen = {0};
    strut_error error = {0};
    status = refused(n, choose(COLUMNS, "p", SIDE, true, &chosen, &error));
    if (status == STRUT_OK)
      assert_true(chosen.row_count == 4 && chosen.columns[Y].value[1] == 15);
    else
      assert_true(error.message[0]);
    strut_arena_free(&chosen.arena);
  }
}

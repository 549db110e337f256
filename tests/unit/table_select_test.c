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
                           strut_arena *arena, strut_table_rows *rows, strut_error *error) {
  *rows = (strut_table_rows){.table = &table,
                             .keys = {STRUT_NO_COLUMN, COLUMNS, X},
                             .between = between,
                             .values = compared,
                             .value_count = 2};
  return strut_table_rows_choose(rows, only, text, difference, arena, error);
}

static size_t count_shown(const strut_table_rows *rows) {
  size_t count = 0;
  for (size_t i = 0; i < ROWS; i++) count += rows->shown[i];
  return count;
}

static void check(bool between, const double *wanted, const char *marks) {
  strut_table_rows less;
  OWN(strut_arena) arena = {0};
  assert_ok(choose(STRUT_NO_COLUMN, NULL, SIDE, between, &arena, &less, NULL));
  assert_all_equal(count_shown(&less), 5, strut_table_compares(&less, Y), true);
  assert_false(strut_table_compares(&less, X));
  assert_all_texts(less.side[0], "a", less.side[1], "b");
  for (size_t i = 0, k = 0; i < ROWS; i++) {
    if (!less.shown[i]) continue;
    double found = strut_table_number(&less, Y, i);
    assert_true(isnan(wanted[k]) ? isnan(found) : found == wanted[k]);
    assert_int_equal(strut_table_differs(&less, WORD, i), marks[k++] == '1');
    assert_string_equal(side[i], "b");
  }
}

/* b has x = 0, 2, 1, 4 in panel p and 2 in panel q, in that order. */
TEST(differences) {
  const double alone[] = {10, NAN, 29, NAN, 43}, line[] = {10, 15, 29, NAN, 43};
  check(false, alone, "01110");
  check(true, line,
        "00110"); /* at 2, half way from 1 to 9; 4 is beyond the last; I is not II at 1 */
}

TEST(only) {
  strut_table_rows some;
  strut_table_groups groups;
  OWN(strut_arena) arena = {0};
  assert_ok(choose(COLUMNS, "q", STRUT_NO_COLUMN, false, &arena, &some, NULL));
  assert_int_equal(count_shown(&some), 2);
  assert_true(strut_table_number(&some, Y, 7) == 50 && strut_table_number(&some, Y, 8) == 7);
  assert_true(some.shown[7] && some.shown[8] && isnan(strut_table_number(&some, SIDE, 7)));
  assert_ok(strut_table_groups_find(&some, SIDE, 2, "", &groups, NULL));
  assert_int_equal(groups.count, 2);
  assert_all_texts(groups.name[0], "b", groups.name[1], "a"); /* not the order of all rows */
  assert_int_equal(choose(COLUMNS, "r", STRUT_NO_COLUMN, false, &arena, &some, NULL), STRUT_USAGE);
}

/* Both at once, and every allocation fails once. */
TEST(no_memory) {
  REFUSE_EACH(n, status, 1) {
    strut_table_rows chosen;
    strut_error error = {0};
    OWN(strut_arena) arena = {0};
    status = refused(n, choose(COLUMNS, "p", SIDE, true, &arena, &chosen, &error));
    if (status == STRUT_OK) {
      assert_int_equal(count_shown(&chosen), 4);
      assert_true(strut_table_number(&chosen, Y, 2) == 15);
    } else {
      assert_true(error.message[0]);
    }
  }
}

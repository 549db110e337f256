/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables chosen from tables: rows of a text, differences of two sides, between points too. */
#include "engine/output/figures/table_choice.h"
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

static strut_table_pairing pairing(bool between) {
  return (strut_table_pairing){.of = SIDE,
                               .keys = {STRUT_NO_COLUMN, COLUMNS, X},
                               .key_count = 3,
                               .between = between,
                               .values = compared,
                               .value_count = 2};
}

static void check(bool between, const double *wanted, const char *marks) {
  strut_table less;
  const strut_table_pairing how = pairing(between);
  assert_ok(strut_table_difference(&table, &how, &less, NULL));
  assert_all_equal(less.row_count, 5, less.column_count, COLUMNS + 2);
  assert_all_texts(less.columns[Y].name, "y, b less a", less.columns[COLUMNS + 1].name, "a: other");
  for (size_t i = 0; i < 5; i++) {
    double found = less.columns[Y].value[i];
    assert_true(isnan(wanted[i]) ? isnan(found) : found == wanted[i]);
    assert_int_equal(less.columns[COLUMNS + 1].text[i][0], marks[i]);
    assert_string_equal(less.columns[SIDE].text[i], "b");
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
  strut_table some;
  assert_ok(strut_table_only(&table, COLUMNS, "q", &some, NULL));
  assert_int_equal(some.row_count, 2);
  assert_true(some.columns[Y].value[0] == 50 && some.columns[Y].value[1] == 7);
  assert_null(some.columns[Y].text[0]);
  strut_arena_free(&some.arena);
  assert_int_equal(strut_table_only(&table, COLUMNS, "r", &some, NULL), STRUT_USAGE);
  strut_arena_free(&some.arena);
}

/* Both at once, and every allocation fails once. */
TEST(no_memory) {
  const strut_table_choice choice = {.only = COLUMNS, .only_value = "p", .difference = SIDE};
  REFUSE_EACH(n, status, 1) {
    strut_table_chosen chosen = {0};
    strut_error error = {0};
    status = refused(n, strut_table_choose(&table, &choice, pairing(true), &chosen, &error));
    if (status == STRUT_OK) {
      assert_int_equal(chosen.table->row_count, 4);
      assert_true(chosen.table->columns[Y].value[1] == 15);
    } else {
      assert_true(error.message[0]);
    }
    strut_table_chosen_free(&chosen);
  }
}

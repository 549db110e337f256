/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The map from names to indices, against a plain list. */
#include "engine/base/name_map.h"
#include "engine/base/memory.h"
#include "tests/support/test.h"

enum { MANY = 20000 };

TEST(many_names) {
  static char names[MANY][16];
  strut_name_map map = {0};
  assert_int_equal(strut_name_map_find(&map, "n0"), -1);
  for (int32_t i = 0; i < MANY; i++) {
    snprintf(names[i], sizeof names[i], "n%d", (int)i);
    assert_int_equal(strut_name_map_add(&map, names[i], i), -1);
  }
  assert_int_equal(map.count, MANY);
  for (int32_t i = 0; i < MANY; i++) {
    char copy[16];
    snprintf(copy, sizeof copy, "n%d", (int)i);
    assert_int_equal(strut_name_map_find(&map, copy), i);
    assert_int_equal(strut_name_map_add(&map, copy, i + 1), i);
  }
  assert_all_equal(strut_name_map_find(&map, "n"), -1, strut_name_map_find(&map, ""), -1,
                   strut_name_map_find(&map, "n20000"), -1, map.count, MANY);
  strut_name_map_free(&map);
  assert_int_equal(map.count, 0);
}

TEST(reserved_room_holds_its_names) {
  static char names[MANY][16];
  OWN(strut_name_map) map = {0};
  assert_true(strut_name_map_reserve(&map, 3)); /* few begin as ever */
  assert_int_equal(map.slots, 0);
  for (int32_t first = 0, end = MANY / 2; first < MANY; first = end, end = MANY) {
    assert_true(strut_name_map_reserve(&map, (size_t)end));
    uint64_t before = strut_allocation_count();
    for (int32_t i = first; i < end; i++) {
      snprintf(names[i], sizeof names[i], "n%d", (int)i);
      assert_int_equal(strut_name_map_add(&map, names[i], i), -1);
    }
    assert_true(strut_allocation_count() == before);
  }
  for (int32_t i = 0; i < MANY; i++) assert_int_equal(strut_name_map_find(&map, names[i]), i);
  assert_int_equal(strut_name_map_find(&map, "n"), -1);
}

TEST(no_memory) {
  OWN(strut_name_map) map = {0};
  strut_fail_allocation_after(0);
  assert_int_equal(strut_name_map_add(&map, "a", 0), -2);
  assert_false(strut_name_map_reserve(&map, MANY));
  strut_fail_allocation_after(-1);
  assert_int_equal(strut_name_map_find(&map, "a"), -1);
  assert_int_equal(strut_name_map_add(&map, "a", 7), -1);
  assert_int_equal(strut_name_map_find(&map, "a"), 7);
}

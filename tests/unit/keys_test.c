/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of keys is consistent, and the page made from it is the one in docs/. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "engine/base/memory.h"
#include "parser/language/keys.h"
#include "parser/write/keys_page.h"

static void sections_divide_the_table(void **state) {
  (void)state;
  int key = 0;
  for (int section = 0; section < STRUT_SECTION_COUNT; section++) {
    assert_int_equal(strut_section_first((strut_section)section), key);
    assert_true(strut_section_size((strut_section)section) >= 1);
    assert_true(strut_section_size((strut_section)section) <= STRUT_MOST_KEYS);
    for (int i = 0; i < strut_section_size((strut_section)section); i++, key++) {
      assert_int_equal(strut_key_at(key)->section, section);
      assert_int_equal(strut_key_find((strut_section)section, strut_key_at(key)->name), key);
      assert_true(strlen(strut_key_at(key)->description) > 3);
    }
  }
  assert_int_equal(key, STRUT_KEY_COUNT);
  assert_int_equal(strut_key_find(STRUT_SECTION_MEMBER, "positions"), -1);
}

/* A group's key is read once for all sections that have it: it must mean the same in each. */
static void shared_keys_of_groups_agree(void **state) {
  (void)state;
  static const strut_section sections[] = {STRUT_SECTION_MEMBER, STRUT_SECTION_NODE,
                                           STRUT_SECTION_CONTACT};
  int shared = 0;
  for (size_t a = 0; a < 3; a++)
    for (size_t b = 0; b < a; b++)
      for (int i = 0; i < strut_section_size(sections[a]); i++) {
        const strut_key *key = strut_key_at(strut_section_first(sections[a]) + i);
        int other = strut_key_find(sections[b], key->name);
        if (other < 0) continue;
        shared++;
        assert_int_equal(strut_key_at(other)->type, key->type);
        assert_int_equal(strut_key_at(other)->measure, key->measure);
      }
  assert_true(shared >= 4); /* group twice, stiffness, damping, mass */
}

static void words(void **state) {
  (void)state;
  char text[100];
  assert_string_equal(strut_words_text("bar|spring|cable", text, sizeof text),
                      "bar, spring or cable");
  assert_string_equal(strut_words_text("rk4", text, sizeof text), "rk4");
  assert_string_equal(strut_words_text("a|b", text, sizeof text), "a or b");
  assert_int_equal(strut_word_find("bar|spring|cable", "spring"), 1);
  assert_int_equal(strut_word_find("bar|spring|cable", "spr"), -1);
  assert_int_equal(strut_word_find("bar|spring|cable", "bar|spring"), -1);
  assert_null(strut_word_at("a|b", 2, text, sizeof text));
}

static void the_page_in_docs_is_this_one(void **state) {
  (void)state;
  char *page = strut_keys_page(), *committed = calloc(1, 1 << 20);
  assert_non_null(page);
  FILE *file = fopen(STRUT_SOURCE_DIR "/docs/language-keys.md", "rb");
  assert_non_null(file);
  assert_true(fread(committed, 1, (1 << 20) - 1, file) > 0);
  fclose(file);
  assert_string_equal(committed, page);
  free(committed);
  strut_release(page);
}

static void no_memory(void **state) {
  (void)state;
  strut_fail_allocation_after(3);
  char *page = strut_keys_page();
  strut_fail_allocation_after(-1);
  assert_null(page);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sections_divide_the_table),
      cmocka_unit_test(shared_keys_of_groups_agree),
      cmocka_unit_test(words),
      cmocka_unit_test(the_page_in_docs_is_this_one),
      cmocka_unit_test(no_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

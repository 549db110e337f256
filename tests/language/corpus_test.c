/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every case of tests/language/bad is refused with exactly the messages that it announces; bases are valid. */
#include "tests/language/case_messages.h"
#include "tests/support/test.h"

static strut_purpose purpose_of(const faulty_case *c) {
  if (strcmp(c->purpose, "statics") == 0) return STRUT_FOR_STATICS;
  return strcmp(c->purpose, "any") == 0 ? STRUT_FOR_ANY : STRUT_FOR_RUN;
}

/* Returns how much is wrong with a base or case. */
static size_t check_case(faulty_case *c) {
  strut_setting set[CASE_MOST_SETS];
  split_settings(c, set);
  OWN(strut_setup) setup;
  OWN(strut_diagnostics) diagnostics = {0};
  char path[500]; /* beside the files that it names */
  snprintf(path, sizeof path, STRUT_TESTS_DIR "/language/bad/%s", c->name);
  strut_status status = strut_setup_read(&setup, path, c->text, c->length, set, c->set_count,
                                         purpose_of(c), &diagnostics);
  size_t wrong = strike_messages(c, &diagnostics, NULL) + missing_messages(c);
  if (status != (c->is_base ? STRUT_OK : STRUT_BAD_SCENE)) {
    print_error("%s: %s: status %d\n", c->document, c->name, (int)status);
    wrong++;
  }
  if (!c->is_base && (setup.scene.arena.chunk || setup.scene.node_count || setup.scene.nodes)) {
    print_error("%s: %s: the scene is not empty\n", c->document, c->name);
    wrong++;
  }
  strut_diagnostics_render(&diagnostics, 50);
  return wrong;
}

TEST(every_case_says_what_it_announces) {
  faulty_cases cases = read_faulty_cases(STRUT_TESTS_DIR "/language/bad");
  size_t wrong = 0, faulty = 0;
  for (size_t i = 0; i < cases.count; i++) {
    wrong += check_case(&cases.items[i]);
    faulty += !cases.items[i].is_base;
  }
  free_faulty_cases(&cases);
  print_message("%zu faulty scenes\n", faulty);
  assert_int_equal(wrong, 0);
  assert_true(faulty >= 100);
}

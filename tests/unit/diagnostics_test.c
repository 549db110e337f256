/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Located messages: their text, order and limits, the caret, and suggestions. */
#include "engine/base/memory.h"
#include "parser/language/yaml/document.h"
#include "tests/support/test.h"

static strut_place at(uint32_t line, uint32_t column, uint32_t length) {
  return strut_place_at(line, column, length);
}

static strut_diagnostics about(const char *text) {
  strut_diagnostics diagnostics = {0};
  strut_diagnostics_source(&diagnostics, "a.yaml", text, strlen(text));
  return diagnostics;
}

/* One message "wrong" at the place is shown like this. */
static void expect_shown(const char *text, strut_place place, const char *expected) {
  OWN(strut_diagnostics) diagnostics = about(text);
  strut_diagnose(&diagnostics, place, "wrong");
  assert_string_equal(strut_diagnostics_render(&diagnostics, 50), expected);
}

TEST(nothing_is_shown_of_nothing) {
  OWN(strut_diagnostics) diagnostics = about("a: 1\n");
  assert_string_equal(strut_diagnostics_render(&diagnostics, 50), "");
}

TEST(a_message_has_place_line_and_caret) {
  OWN(strut_diagnostics) diagnostics = about("members:\n  m1: {group: rod, stifness: 3}\n");
  strut_diagnose(&diagnostics, at(2, 20, 8), "unknown key '%s' in member '%s'", "stifness", "m1");
  assert_int_equal(diagnostics.count, 1);
  assert_string_equal(strut_diagnostics_render(&diagnostics, 50),
                      "a.yaml:2:20: error: unknown key 'stifness' in member 'm1'\n"
                      "    2 |   m1: {group: rod, stifness: 3}\n"
                      "      |                    ^~~~~~~~\n");
}

TEST(the_caret_stands_right) {
  expect_shown("a: 1", at(1, 4, 1), "a.yaml:1:4: error: wrong\n    1 | a: 1\n      |    ^\n");
  expect_shown("a: 1", at(1, 1, 0), "a.yaml:1:1: error: wrong\n    1 | a: 1\n      | ^\n");
  expect_shown("a:\t\t1", at(1, 5, 1),
               "a.yaml:1:5: error: wrong\n    1 | a:\t\t1\n      |   \t\t^\n");
  expect_shown("\xC3\xA4\xE2\x82\xAC: x", at(1, 5, 1),
               "a.yaml:1:5: error: wrong\n    1 | \xC3\xA4\xE2\x82\xAC: x\n      |     ^\n");
  expect_shown("\xE6\xBC\xA2: x", at(1, 4, 1), /* a wide character takes two cells */
               "a.yaml:1:4: error: wrong\n    1 | \xE6\xBC\xA2: x\n      |     ^\n");
  expect_shown("\xE6\xBC\xA2: x", at(1, 1, 1),
               "a.yaml:1:1: error: wrong\n    1 | \xE6\xBC\xA2: x\n      | ^~\n");
  expect_shown("a\xCC\x88: x", at(1, 5, 1), /* a combining one takes none */
               "a.yaml:1:5: error: wrong\n    1 | a\xCC\x88: x\n      |    ^\n");
  expect_shown(
      "\xEF\xBB\xBF"
      "ab",
      at(1, 2, 1), "a.yaml:1:2: error: wrong\n    1 | ab\n      |  ^\n");
}

TEST(the_stretch_ends_with_the_line) {
  expect_shown("a: bc\nd", at(1, 4, 99),
               "a.yaml:1:4: error: wrong\n    1 | a: bc\n      |    ^~\n");
  expect_shown("a: bc\nd", at(1, 4, UINT32_MAX),
               "a.yaml:1:4: error: wrong\n    1 | a: bc\n      |    ^~\n");
  expect_shown("a:\nd", at(1, 3, 0), "a.yaml:1:3: error: wrong\n    1 | a:\n      |   ^\n");
  expect_shown("a:\nd", at(1, 3, 5), "a.yaml:1:3: error: wrong\n    1 | a:\n      |   ^\n");
}

TEST(places_outside_show_no_line) {
  expect_shown("a: 1\n", at(0, 0, 0), "a.yaml: error: wrong\n");
  expect_shown("a: 1\n", at(2, 1, 1), "a.yaml:2:1: error: wrong\n");
  expect_shown("a: 1\n", at(9, 1, 1), "a.yaml:9:1: error: wrong\n");
  expect_shown("a\n\nb", at(2, 1, 1), "a.yaml:2:1: error: wrong\n");
  expect_shown("", at(1, 1, 1), "a.yaml:1:1: error: wrong\n");
  OWN(strut_diagnostics) none = {0};
  strut_diagnose(&none, at(3, 4, 1), "wrong");
  assert_string_equal(strut_diagnostics_render(&none, 1), "<text>:3:4: error: wrong\n");
}

TEST(lines_end_where_libyaml_ends_them) {
  const char *expected = "a.yaml:3:1: error: wrong\n    3 | c\n      | ^\n";
  expect_shown("a\nb\nc\nd", at(3, 1, 1), expected);
  expect_shown("a\r\nb\r\nc\r\nd", at(3, 1, 1), expected);
  expect_shown("a\rb\rc\rd", at(3, 1, 1), expected);
  expect_shown(
      "a\xC2\x85"
      "b\xC2\x85"
      "c\xC2\x85"
      "d",
      at(3, 1, 1), expected);
  expect_shown(
      "a\xE2\x80\xA8"
      "b\xE2\x80\xA9"
      "c\xE2\x80\xA8"
      "d",
      at(3, 1, 1), expected);
}

TEST(long_lines_are_cut_around_the_place) {
  char text[401], expected[700];
  for (int i = 0; i < 400; i++) text[i] = (char)('a' + i % 26);
  text[400] = '\0';
  snprintf(expected, sizeof expected,
           "a.yaml:1:5: error: wrong\n    1 | %.100s...\n      |     ^~\n", text);
  expect_shown(text, at(1, 5, 2), expected);
  snprintf(expected, sizeof expected,
           "a.yaml:1:200: error: wrong\n    1 | ...%.100s...\n      | %*s^~~\n", text + 160, 42,
           "");
  expect_shown(text, at(1, 200, 3), expected);
  snprintf(expected, sizeof expected, "a.yaml:1:400: error: wrong\n    1 | ...%s\n      | %*s^\n",
           text + 360, 42, "");
  expect_shown(text, at(1, 400, 3), expected);
  text[100] = '\0';
  snprintf(expected, sizeof expected, "a.yaml:1:99: error: wrong\n    1 | %s\n      | %*s^\n", text,
           98, "");
  expect_shown(text, at(1, 99, 1), expected);
}

/* A terminal must not obey what a file holds. */
TEST(bytes_of_the_source_are_made_harmless) {
  expect_shown(
      "a\x1B[31m\xFF", at(1, 7, 1),
      "a.yaml:1:7: error: wrong\n    1 | a\xEF\xBF\xBD[31m\xEF\xBF\xBD\n      |       ^\n");
  OWN(strut_diagnostics) diagnostics = about("a");
  strut_diagnose(&diagnostics, at(0, 0, 0), "bad '%s'", "x\ny\x1B\x7F");
  assert_string_equal(diagnostics.items[0].message, "bad 'x y  '");
}

TEST(long_messages_are_cut_between_characters) {
  char word[2001];
  for (int shift = 0; shift < 4; shift++) {
    for (int i = 0; i + 1 < 2000; i += 2) memcpy(word + i, "\xC3\xA4", 2);
    word[2000] = '\0';
    OWN(strut_diagnostics) diagnostics = about("a");
    strut_diagnose(&diagnostics, at(1, 1, 1), "%.*s%s", shift, "abcd", word);
    const char *message = diagnostics.items[0].message;
    size_t length = strlen(message);
    assert_in_range(length, 890, 900);
    assert_string_equal(message + length - 3, "...");
    assert_int_equal((unsigned char)message[length - 4], 0xA4);
  }
}

TEST(messages_are_sorted_by_place) {
  OWN(strut_diagnostics) diagnostics = about("");
  strut_diagnose(&diagnostics, at(3, 1, 1), "e");
  strut_diagnose(&diagnostics, at(1, 9, 1), "c");
  strut_diagnose(&diagnostics, at(1, 2, 1), "b");
  strut_diagnose(&diagnostics, at(1, 9, 5), "d");
  strut_diagnose(&diagnostics, at(0, 0, 0), "a");
  assert_string_equal(strut_diagnostics_render(&diagnostics, 50),
                      "a.yaml: error: a\na.yaml:1:2: error: b\na.yaml:1:9: error: c\n"
                      "a.yaml:1:9: error: d\na.yaml:3:1: error: e\n");
  assert_string_equal(diagnostics.items[0].message, "a");
  assert_string_equal(strut_diagnostics_render(&diagnostics, 2),
                      "a.yaml: error: a\na.yaml:1:2: error: b\n... and 3 more\n");
  assert_string_equal(strut_diagnostics_render(&diagnostics, 0), "... and 5 more\n");
}

TEST(millions_of_messages_are_only_counted) {
  OWN(strut_diagnostics) diagnostics = about("");
  for (uint32_t i = 0; i < 100000; i++) strut_diagnose(&diagnostics, at(i + 1, 1, 1), "x");
  assert_int_equal(diagnostics.count, STRUT_DIAGNOSTICS_MOST);
  assert_int_equal(diagnostics.unstored, 100000 - STRUT_DIAGNOSTICS_MOST);
  assert_string_equal(strut_diagnostics_render(&diagnostics, 1),
                      "a.yaml:1:1: error: x\n... and 99999 more\n");
}

TEST(lost_memory_is_noticed) {
  int failures = 0;
  for (int n = 0;; n++) {
    strut_diagnostics diagnostics = about("a: 1\n");
    strut_fail_allocation_after(n);
    for (int i = 0; i < 40; i++) strut_diagnose(&diagnostics, at(1, 1, 1), "message %d", i);
    const char *text = strut_diagnostics_render(&diagnostics, 50);
    strut_fail_allocation_after(-1);
    assert_int_equal(diagnostics.count + diagnostics.unstored, 40);
    assert_true(diagnostics.out_of_memory == (diagnostics.unstored > 0));
    bool whole = text && !diagnostics.out_of_memory;
    strut_diagnostics_free(&diagnostics);
    if (whole) break;
    failures++;
  }
  assert_true(failures >= 3);
}

static const char *from_list(const void *context, size_t i) {
  return ((const char *const *)context)[i];
}

static const char list_umlaut[] =
    "\xC3\xA4u\xC3\x9F"
    "eres";

static void expect_suggestion(const char *word, const char *expected) {
  static const char *const list[] = {"stiffness",   "damping",   "mass",  "nodes",
                                     "rest_length", "kind",      "mm",    "a",
                                     "node",        list_umlaut, "com.x", NULL};
  const char *got = strut_did_you_mean(word, from_list, list);
  if (!expected)
    assert_null(got);
  else if (!got)
    fail_msg("nothing for '%s'", word);
  else
    assert_string_equal(got, expected);
}

TEST(suggestions_are_near) {
  expect_suggestion("stifness", "stiffness");   /* one left out */
  expect_suggestion("stiffnesss", "stiffness"); /* one too many */
  expect_suggestion("stiffnexs", "stiffness");  /* another one */
  expect_suggestion("sitffness", "stiffness");  /* neighbours swapped */
  expect_suggestion("stfifenss", "stiffness");  /* twice */
  expect_suggestion("Stiffness", "stiffness");
  expect_suggestion("restlength", "rest_length");
  expect_suggestion("nodse", "nodes");
  expect_suggestion("nod", "node");
  expect_suggestion("nodes", "nodes"); /* itself before others */
  expect_suggestion("mn", "mm");
  expect_suggestion("kidn", "kind");
  /* Two letters but four bytes away: letters count. */
  expect_suggestion("auseres", list_umlaut);
  expect_suggestion("com", "com.x"); /* what it begins */
  expect_suggestion("x", NULL);      /* nothing in common */
  expect_suggestion("xy", NULL);
  expect_suggestion("", NULL);
  expect_suggestion("completely", NULL);
  expect_suggestion("stfnes", NULL); /* three steps are too many for six letters */
  char word[80];
  memset(word, 'a', 79);
  word[79] = '\0';
  expect_suggestion(word, NULL);
}

static const char *endless(const void *context, size_t i) {
  ++*(size_t *)(uintptr_t)context;
  return i == 20000 ? "word" : "another";
}

TEST(endless_candidates_are_cut) {
  size_t calls = 0;
  assert_null(strut_did_you_mean("word", endless, &calls));
  assert_int_equal(calls, 10000);
}

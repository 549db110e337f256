/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The YAML reader: trees and places, and every refusal with its words. */
#include "tests/support/random.h"
#include "tests/support/test.h"
#include "tests/unit/document_support.h"

TEST(trees_have_the_shape_of_the_text) {
  expect_tree("a: 1\n", "{a: 1}");
  expect_tree("a: {b: [1, 2, {}], c: []}", "{a: {b: [1, 2, {}], c: []}}");
  expect_tree("a:\n- 1\n- b: 2\n  c: 3\n", "{a: [1, {b: 2, c: 3}]}");
  expect_tree("- 1\n- 2\n", "[1, 2]");
  expect_tree("word", "word");
  expect_tree("a: 'x'\nb: \"y\\tz\"\nc: |\n  t\n", "{a: 'x', b: 'y\tz', c: 't\n'}");
  expect_tree("a:\nb: ~\nc: null\nd: ''\n", "{a: , b: ~, c: null, d: ''}");
  expect_tree("? a\n: b\n", "{a: b}");
  expect_tree("a: 1 2\n  3\n", "{a: 1 2 3}");
  expect_tree("\"a\": 1\n'<<': 2\n", "{'a': 1, '<<': 2}");
  expect_tree("%YAML 1.2\n# c\n---\na: 1 # c\n...\n\n# c\n... # c\n", "{a: 1}");
  expect_tree("a: -5\nb: 10 Hz\nc: a*b\n", "{a: -5, b: 10 Hz, c: a*b}");
  expect_tree("a: \"\\u00e4\\U0001F600\"\n", "{a: '\xC3\xA4\xF0\x9F\x98\x80'}");
}

TEST(values_know_their_places) {
  expect_places("a: 12\nbc: xyz\n", "{a@1:1+1: 12@1:4+2, bc@2:1+2: xyz@2:5+3}@1:1+1");
  expect_places("a: {b: [1, 'x y']}",
                "{a@1:1+1: {b@1:5+1: [1@1:9+1, 'x y'@1:12+5]@1:8+10}@1:4+15}@1:1+1");
  expect_places("a:\n  - 1\n", "{a@1:1+1: [1@2:5+1]@2:3+1}@1:1+1");
  expect_places("a:\nb: 1", "{a@1:1+1: @1:3+0, b@2:1+1: 1@2:4+1}@1:1+1");
  expect_places("\xC3\xA4: \xE2\x82\xACx y\n", "{\xC3\xA4@1:1+1: \xE2\x82\xACx y@1:4+4}@1:1+1");
  expect_places(
      "\xEF\xBB\xBF"
      "a: 1",
      "{a@1:1+1: 1@1:4+1}@1:1+1");
  const char *two = "{a@1:1+1: 1@1:4+1, b@2:1+1: 2@2:4+1}@1:1+1";
  expect_places("a: 1\nb: 2\n", two);
  expect_places("a: 1\r\nb: 2\r\n", two);
  expect_places("a: 1\rb: 2\r", two);
  expect_places(
      "a: 1\xC2\x85"
      "b: 2\xC2\x85",
      two);
  expect_places(
      "a: 1\xE2\x80\xA8"
      "b: 2\xE2\x80\xA9",
      two);
}

TEST(anchors_repeat_values) {
  expect_tree("a: &x 1\nb: *x\nc: [*x, *x]\n", "{a: 1, b: 1, c: [1, 1]}");
  expect_tree("a: &x {k: [1]}\nb: *x\nc: 2\n", "{a: {k: [1]}, b: {k: [1]}, c: 2}");
  expect_tree("a: &x 1\nb: &x 2\nc: *x\n", "{a: 1, b: 2, c: 2}");
  expect_tree("a: [&x [1], *x, *x]\n", "{a: [[1], [1], [1]]}");
  expect_tree("a: &x [&x [1], *x]\nb: *x\n", "{a: [[1], [1]], b: [1]}"); /* the latest begun */
  expect_tree("a: &x\nb: *x\n", "{a: , b: }");
  expect_tree("&k key: &v value\n", "{key: value}");
  /* The place is the value's own, behind the anchor; an alias has its own. */
  expect_places("a: &x  12\nb: *x\n", "{a@1:1+1: 12@1:8+2, b@2:1+1: 12@2:4+2}@1:1+1");
  expect_places("a: 1\r\nb: &x  12\r\n", "{a@1:1+1: 1@1:4+1, b@2:1+1: 12@2:8+2}@1:1+1");
  expect_places("a: &x # c\n  b: 1\n", "{a@1:1+1: {b@2:3+1: 1@2:6+1}@2:3+1}@1:1+1");
  expect_places("\xC3\xA4: &x [&y 'z']\n", "{\xC3\xA4@1:1+1: ['z'@1:11+3]@1:7+8}@1:1+1");
}

TEST(bad_characters_are_refused) {
  static const char nul[] = "a: 1\nb: \0\n", two[] = "\x01: \x1F\n\x7F: 1";
  expect_of(nul, sizeof nul - 1, false, "", "2:4: a NUL byte is not allowed");
  expect_of(two, sizeof two - 1, false, "",
            "1:1: control character U+0001 is not allowed\n"
            "1:4: control character U+001F is not allowed\n"
            "2:1: control character U+007F is not allowed");
  expect_error("a: \xC2\x80", "1:4: control character U+0080 is not allowed");
  expect_error("a: \xEF\xBF\xBE", "1:4: control character U+FFFE is not allowed");
  expect_error("a: 1\r\n\xC3\xA4: \x02", "2:4: control character U+0002 is not allowed");
  expect_error("a: \xEF\xBB\xBF",
               "1:4: a byte order mark is allowed only at the beginning of the file");
  static const char *const bad[] = {"\xFF",
                                    "\x80",
                                    "\xC0\x80",
                                    "\xC1\xBF",
                                    "\xC3",
                                    "\xC3(",
                                    "\xE0\x80\x80",
                                    "\xE2\x82",
                                    "\xED\xA0\x80",
                                    "\xF0\x8F\xBF\xBF",
                                    "\xF4\x90\x80\x80",
                                    "\xF5\x80\x80\x80",
                                    "\xF0\x9F\x98"};
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    char text[40], message[80];
    snprintf(text, sizeof text, "\xC3\xA4: 1\nb: %s", bad[i]);
    snprintf(message, sizeof message, "2:4: byte 0x%02X is not valid UTF-8; save the file as UTF-8",
             (unsigned)(unsigned char)bad[i][0]);
    expect_error(text, message);
  }
  static const char utf16[] =
      "\xFF\xFE"
      "a\0:\0";
  expect_of(utf16, sizeof utf16 - 1, false, "", "0:0: the file is UTF-16; save it as UTF-8");
  char many[41];
  memset(many, 1, 40);
  many[40] = '\0';
  OWN(strut_diagnostics) diagnostics = {0};
  strut_document document = {0};
  strut_diagnostics_source(&diagnostics, "t", many, 40);
  assert_int_equal(strut_document_read(&document, &diagnostics), STRUT_BAD_SCENE);
  assert_int_equal(diagnostics.count, 10);
}

TEST(escapes_do_not_smuggle) {
  expect_of("a: \"x\\0y\"", 9, false, "{a: ''}",
            "1:4: an escape makes the control character U+0000");
  expect_of("a: \"\\x1b[0m\"", 12, false, "{a: ''}",
            "1:4: an escape makes the control character U+001B");
  expect_of("\"\\u0000\": 1", 11, false, "{'': 1}",
            "1:1: an escape makes the control character U+0000");
  expect_error("a: \"\\uD800\"", "1:7: the escape is not a character of Unicode");
  expect_error("a: \"\\q\"", "1:5: unknown escape; in double quotes a backslash is written '\\\\'");
  expect_error("a: \"\\xZZ\"", "1:7: an escape lacks hexadecimal digits");
}

TEST(keys_are_plain_and_single) {
  expect_of("a: 1\nb: 2\na: 3\n", 15, false, "{a: 1, b: 2}",
            "3:1: duplicate key 'a'; the first one is in line 1");
  expect_of("x: {b: 1, 'b': 2, b: 3}", 23, false, "{x: {b: 1}}",
            "1:11: duplicate key 'b'; the first one is in line 1\n"
            "1:19: duplicate key 'b'; the first one is in line 1");
  expect_of("a: &x 1\n<<: *x\nb: 2\n", 20, false, "{a: 1, b: 2}",
            "2:1: '<<' is not allowed; use groups to share keys between things");
  expect_of("a: {? : 1}", 10, false, "{a: {}}", "1:7: a key is missing before this ':'");
  expect_tree("a: {b: 1}\nb: {a: 1}\n", "{a: {b: 1}, b: {a: 1}}");
  expect_error("[a]: 1", "1:1: a key must be a plain text, not a list");
  expect_error("? {a: 1}\n: 2\n", "1:3: a key must be a plain text, not a mapping");
  expect_error("a: &x b\n*x : 1\n", "2:1: a key must be a plain text, not an alias");
}

/* More keys than are compared in pairs: the hash table finds what a plain search finds. */
TEST(many_keys_are_compared_alike) {
  enum { MOST = 3000 };
  uint64_t seed = 5;
  for (int count = 5; count < MOST; count = count * 2 + 1) {
    FREED char *text = calloc(MOST, 16);
    int *number = calloc(MOST, sizeof *number), doubles = 0;
    for (int i = 0; i < count; i++) {
      number[i] = random_below(&seed, 4 * count);
      bool again = false;
      for (int k = 0; k < i; k++) again = again || number[k] == number[i];
      doubles += again;
      sprintf(shown_end(text + (i ? strlen(text) : 0)), "k%d: 1\n", number[i]);
    }
    OWN(strut_document) document = {0};
    OWN(strut_diagnostics) diagnostics = {0};
    read_text(text, &document, &diagnostics);
    assert_int_equal(diagnostics.count, doubles);
    assert_int_equal(document.root->count, count - doubles);
    free(number);
  }
}

/* One table serves map after map: none sees the keys of another. */
TEST(big_maps_do_not_meet) {
  const char *map = "{a: 1, b: 1, c: 1, d: 1, e: 1, f: 1, g: 1, h: 1, i: 1, j: 1}";
  char text[300];
  snprintf(text, sizeof text, "[%s, %s, %s]", map, map, map);
  expect_tree(text, text);
}

TEST(tags_and_directives_are_refused) {
  const char *tag = "1:4: tags (words that begin with '!') are not allowed";
  expect_of("a: !!int 1", 10, false, "{a: 1}", tag);
  expect_of("a: ! 1", 6, false, "{a: 1}", tag);
  expect_of("a: !x [1]", 9, false, "{a: [1]}", tag);
  expect_of("a: !x {b: 1}", 12, false, "{a: {b: 1}}", tag);
  expect_of("!x a: 1", 7, false, "{a: 1}", "1:1: tags (words that begin with '!') are not allowed");
  expect_error("a: !y!x 1", tag);
  expect_error("a: !<", "1:6: tags (words that begin with '!') are not allowed");
  const char *directive = "directives such as %TAG are not allowed";
  char message[80];
  snprintf(message, sizeof message, "1:1: %s", directive);
  expect_error("%TAG ! tag:x,2000:\n---\na: 1\n", message);
  expect_error("%FOO\n---\na: 1\n", message);
  snprintf(message, sizeof message, "4:1: %s", directive);
  expect_error("# c\n\n  # d\n%TAG ! tag:x,2000:\n---\na: 1\n", message);
  snprintf(message, sizeof message, "2:1: %s", directive);
  expect_error("%YAML 1.1\n%TAG ! tag:x,2000:\n---\na: 1\n", message);
  expect_error("%YAML 1.1\n%YAML 1.1\n---\na: 1\n", "2:1: a second %YAML line");
  expect_error("%YAML 3.0\n---\na: 1\n", "1:1: only YAML 1.1 and 1.2 can be read");
  expect_error("%YAML x\n---\na: 1\n", "1:7: expected '%YAML 1.2'");
  expect_error("%YAML 1.2\na: 1\n", "2:1: expected '---' after a %YAML line");
}

TEST(a_file_holds_one_document) {
  expect_error("", "0:0: the file is empty");
  expect_error("\xEF\xBB\xBF", "0:0: the file is empty");
  expect_error("# only a comment\n", "0:0: the file has comments only");
  expect_error("---\n", "0:0: the file is empty");
  expect_error("---\n...\n", "0:0: the file is empty");
  expect_error("a: 1\n---\nb: 2\n", "2:1: a second document; a file holds one");
  expect_error("a: 1\n...\n---\nb: 2\n", "3:1: a second document; a file holds one");
  expect_error("a: 1\n...\n%TAG ! tag:x,2000:\n---\n", "3:1: text after the end of the document");
  expect_error("{a: 1} b\n", "1:8: text after the end of the document");
  expect_error("a: 1\n... b\n", "2:5: text after the end of the document");
}

TEST(common_mistakes_have_words) {
  expect_error(
      "a: b: c\n",
      "1:5: unexpected ':'; a key begins a new line, and a text that holds ': ' needs quotes");
  expect_error("a:\n\tb: 1\n", "2:1: a tab is not allowed as indentation; use spaces");
  expect_error("a: |\n  x\n\ty\n", "3:1: a tab is not allowed as indentation; use spaces");
  expect_error("a: [1, 2\n", "1:4: this '[' is never closed");
  expect_error("a: [1, 2, \n", "1:4: this '[' is never closed");
  expect_error("a: {b: 1\n", "1:4: this '{' is never closed");
  expect_error("a: {b: [1}\n", "1:10: expected ',' or ']' (the list that begins in line 1)");
  expect_error("a: [1, 2\nb: 3\n", "2:2: expected ',' or ']' (the list that begins in line 1)");
  expect_error("a: {b: 1\nc: 3\n", "2:2: expected ',' or '}' (the mapping that begins in line 1)");
  expect_error("a: \"x\nb: 2\n", "1:4: this quote is never closed");
  expect_error("a: 1\nb: 'x\n", "2:4: this quote is never closed");
  expect_error("a: \"x\n---\nb\n", "1:4: this quote is not closed before the document ends");
  expect_error("a: 1\nabc\n", "2:1: expected ':' and a value after this key");
  expect_error(
      "a:\n  b: 1\n c: 2\n",
      "3:2: expected a key at the same indentation as the other keys (the mapping that begins "
      "in line 1)");
  expect_error("- a\nb: 1\n",
               "2:1: expected '- ' at the same indentation as the other items (the list that "
               "begins in line 1)");
  expect_error("a: \"b\" c\n", "1:8: unexpected text after a value");
  expect_error("a: - b\n",
               "1:4: a '- ' item is not allowed here; begin it on a new line, or write [a, b]");
  expect_error("a: [1,,2]\n", "1:7: a value is missing here");
  expect_error("a: ? b\n", "1:4: a '? ' key is not allowed here");
  expect_error("a: @b\n", "1:4: a value cannot begin with '@'; put it in quotes");
  expect_error("a: %5\n", "1:4: a value cannot begin with '%'; put it in quotes");
  expect_error("a: `b`\n", "1:4: a value cannot begin with '`'; put it in quotes");
  expect_error("a: *\n",
               "1:5: expected a name after '*'; a text that begins with '*' needs quotes");
  expect_error("a: & b\n",
               "1:5: expected a name after '&'; a text that begins with '&' needs quotes");
  expect_error("a: |x\n b\n", "1:5: expected '|' or '>' and then a new line");
  expect_error("a: *x\n", "1:4: unknown alias '*x'");
  expect_error("a: &x [1, *x]\n", "1:11: alias '*x' refers to a value that contains it");
  expect_error("a: &x {b: {c: *x}}\n", "1:15: alias '*x' refers to a value that contains it");
}

TEST(finding_is_by_text) {
  const char *text = "a: 1\nb: {c: 2}\nd: b\n";
  OWN(strut_document) document = {0};
  OWN(strut_diagnostics) diagnostics = {0};
  strut_tree *key = NULL;
  assert_ok(read_text(text, &document, &diagnostics));
  assert_string_equal(strut_tree_find(document.root, "d", &key)->text, "b");
  assert_int_equal(key->place.line, 3);
  assert_int_equal(strut_tree_find(document.root, "b", NULL)->count, 1);
  assert_null(strut_tree_find(document.root, "c", NULL));
  assert_null(strut_tree_find(strut_tree_find(document.root, "a", NULL), "1", NULL));
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The YAML reader under pressure: limits, bombs, big texts, lost memory, files. */
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "parser/language/read/read_scene.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"
#include "tests/support/sanitized.h"
#include "tests/unit/document_support.h"

TEST(depth_is_limited) {
  static const char *const kinds[][2] = {{"[", "]"}, {"{a: ", "}"}, {"- ", ""}};
  for (size_t i = 0; i < 3; i++) {
    for (size_t depth = 64; depth <= 65; depth++) {
      FREED char *open = repeat("", kinds[i][0], depth, i == 2 ? "1" : "");
      FREED char *text = repeat(open, kinds[i][1], i == 2 ? 0 : depth, "");
      OWN(strut_document) document = {0};
      OWN(strut_diagnostics) diagnostics = {0};
      strut_status status = read_text(text, &document, &diagnostics);
      assert_int_equal(status, depth == 64 ? STRUT_OK : STRUT_BAD_SCENE);
      if (depth == 64) continue;
      assert_string_equal(diagnostics.items[0].message, "more than 64 levels of nesting");
      assert_int_equal(diagnostics.items[0].place.column, 64 * strlen(kinds[i][0]) + 1);
      assert_null(document.root);
    }
  }
}

/* Nesting cannot be built up from aliases either. */
TEST(depth_counts_aliases) {
  FREED char *open = repeat("a: &a ", "[", 40, ""), *closed = repeat(open, "]", 40, "\nb: ");
  FREED char *fits = repeat(closed, "[", 23, "*a"), *deep = repeat(closed, "[", 24, "*a");
  FREED char *good = repeat(fits, "]", 23, ""), *bad = repeat(deep, "]", 24, "");
  OWN(strut_document) document = {0};
  OWN(strut_diagnostics) diagnostics = {0};
  assert_ok(read_text(good, &document, &diagnostics));
  expect_error(bad, "2:28: more than 64 levels of nesting");
}

TEST(anchors_and_aliases_are_limited) {
  FREED char *thousand = calloc(1100, 16);
  for (int i = 0; i < 1000; i++) sprintf(shown_end(thousand), "- &a%d x\n", i);
  FREED char *most = repeat(thousand, "- *a999\n", 3, "- *a0\n");
  FREED char *more = repeat(thousand, "- &z x\n", 1, "");
  strut_document document = {0};
  OWN(strut_diagnostics) diagnostics = {0};
  assert_ok(read_text(most, &document, &diagnostics));
  assert_int_equal(document.root->count, 1004);
  strut_document_free(&document);
  expect_error(more, "1001:6: more than 1000 anchors");

  /* Ten thousand values, repeated a hundred times, and one too many. */
  FREED char *list = repeat("a: &a [1", ",1", 9998, "]\nb: [*a");
  FREED char *fits = repeat(list, ",*a", 99, "]\n"), *bad = repeat(list, ",*a", 100, "]\n");
  assert_ok(read_text(fits, &document, &diagnostics));
  strut_document_free(&document);
  expect_error(bad, "2:305: more than 1000000 values repeated by aliases");
}

TEST(a_thousand_problems_are_enough) {
  FREED char *text = repeat("a: [", "!x 1, ", 5000, "]");
  OWN(strut_document) document = {0};
  OWN(strut_diagnostics) diagnostics = {0};
  assert_int_equal(read_text(text, &document, &diagnostics), STRUT_BAD_SCENE);
  assert_int_equal(diagnostics.count, 1000);
  assert_null(document.root);
}

/* Reads in a child process: seconds of processor time and MiB of memory beyond the text itself. */
static void expect_bomb_defused(const char *name, char *text, const char *message) {
  int pipes[2];
  struct {
    double seconds, memory;
    int status;
    char message[200];
  } got = {0};
  assert_int_equal(pipe(pipes), 0);
  pid_t child = fork();
  if (child == 0) {
    strut_document document = {0};
    strut_diagnostics diagnostics = {0};
    struct rusage before, after;
    strut_diagnostics_source(&diagnostics, name, text, strlen(text));
    getrusage(RUSAGE_SELF, &before);
    double begin = test_seconds();
    got.status = (int)strut_document_read(&document, &diagnostics);
    const char *shown = strut_diagnostics_render(&diagnostics, 50);
    got.seconds = test_seconds() - begin;
    getrusage(RUSAGE_SELF, &after);
    got.memory = (double)(after.ru_maxrss - before.ru_maxrss) / 1024;
    if (shown && diagnostics.count == 1)
      snprintf(got.message, sizeof got.message, "%s", diagnostics.items[0].message);
    ssize_t written = write(pipes[1], &got, sizeof got);
    _exit(written == (ssize_t)sizeof got ? 0 : 1);
  }
  assert_int_equal(read(pipes[0], &got, sizeof got), sizeof got);
  waitpid(child, NULL, 0);
  close(pipes[0]);
  close(pipes[1]);
  print_message("%-12s %.4f s %.1f MiB\n", name, got.seconds, got.memory);
  assert_int_equal(got.status, STRUT_BAD_SCENE);
  assert_string_equal(got.message, message);
  if (!ADDRESS_SANITIZED) assert_all(got.seconds <= 0.1, got.memory <= 64);
  free(text);
}

static char *alias_bomb(int levels) {
  char *text = calloc(1, 4000);
  sprintf(text, "a0: &a0 [x,x,x,x,x,x,x,x,x]\n");
  for (int i = 1; i < levels; i++) {
    sprintf(shown_end(text), "a%d: &a%d [", i, i);
    for (int k = 0; k < 9; k++) sprintf(shown_end(text), "%s*a%d", k ? "," : "", i - 1);
    strcat(text, "]\n");
  }
  return text;
}

static char *numbered(const char *before, const char *format, int count) {
  char *text = calloc((size_t)count, 48), *end = text + sprintf(text, "%s", before);
  for (int i = 0; i < count; i++)
    for (const char *part = format; *part; part++)
      end += *part == '#' ? sprintf(end, "%d", i) : sprintf(end, "%c", *part);
  return text;
}

TEST(bombs_are_refused_at_once) {
  const char *deep = "more than 64 levels of nesting",
             *key = "a key must be a plain text, not a mapping";
  expect_bomb_defused("brackets", repeat("", "[", 100000, ""), deep);
  expect_bomb_defused("2 MB", repeat("a: ", "[", 2000000, ""), deep);
  FREED char *open = repeat("a: ", "[", 1000000, "");
  expect_bomb_defused("closed", repeat(open, "]", 1000000, ""), deep);
  expect_bomb_defused("braces", repeat("", "{", 2000000, ""), key);
  expect_bomb_defused("flow maps", repeat("", "{a: ", 40000, ""), deep);
  expect_bomb_defused("dashes", repeat("", "- ", 1000000, ""), deep);
  expect_bomb_defused("questions", repeat("", "? ", 1000000, ""), key);
  expect_bomb_defused(
      "colons", repeat("", "a: ", 700000, ""),
      "unexpected ':'; a key begins a new line, and a text that holds ': ' needs quotes");
  expect_bomb_defused("aliases", alias_bomb(9), "more than 1000000 values repeated by aliases");
  expect_bomb_defused("anchors", numbered("", "- &a# x\n", 40000), "more than 1000 anchors");
  expect_bomb_defused("%TAG", numbered("", "%TAG !t#! tag:x#,2000:\n", 20000),
                      "directives such as %TAG are not allowed");
  expect_bomb_defused("late %TAG", numbered("a: 1\n...\n", "%TAG !t#! tag:x#,2000:\n", 20000),
                      "text after the end of the document");
  expect_bomb_defused("%YAML", repeat("", "%YAML 1.1\n", 20000, "---\na: 1\n"),
                      "a second %YAML line");
  expect_bomb_defused("documents", repeat("a: 1\n", "---\na: 1\n", 100000, ""),
                      "a second document; a file holds one");
  expect_bomb_defused("tabs", repeat("", "\t", 2000000, ""),
                      "a tab is not allowed as indentation; use spaces");
  expect_bomb_defused("quote", repeat("a: \"", "x", 2000000, ""), "this quote is never closed");
}

/* A good big text, at a tenth of the size that must be readable. */
TEST(big_texts_are_read) {
  FREED char *text = numbered("members:\n", "  m#: {group: rod, nodes: [n#, k#]}\n", 100000);
  OWN(strut_document) document = {0};
  OWN(strut_diagnostics) diagnostics = {0};
  double begin = test_seconds();
  assert_ok(read_text(text, &document, &diagnostics));
  double seconds = test_seconds() - begin;
  assert_int_equal(document.root->first->next->count, 100000);
  print_message("%.2f s for %.1f MB, %.1f MB of tree\n", seconds, (double)strlen(text) * 1e-6,
                (double)document.arena.bytes * 1e-6);
  assert_true(document.arena.bytes < 60u * 100000 * 8);
}

/* Each allocation fails in turn: the answer is STRUT_NO_MEMORY or the right one, and nothing leaks. */
TEST(lost_memory_is_reported) {
  static const char *const texts[] = {
      "a: &x {b: 1, c: [1, 2]}\nd: *x\ne: 'a text that is longer than what is shared'\n",
      "a: 1\na: 2\n<<: 3\nb: !x 1\n",
      "a: [",
      "a: \x01",
      "%TAG ! x\n---\n",
      "{a,b,c,d,e,f,g,h,i,j,k,l,m,n}"};
  for (size_t t = 0; t < sizeof texts / sizeof texts[0]; t++) {
    int n = 0;
    for (strut_status status = STRUT_NO_MEMORY; status == STRUT_NO_MEMORY; n++) {
      OWN(strut_document) document = {0};
      OWN(strut_diagnostics) diagnostics = {0};
      strut_diagnostics_source(&diagnostics, "t", texts[t], strlen(texts[t]));
      strut_fail_allocation_after(n);
      status = strut_document_read(&document, &diagnostics);
      strut_fail_allocation_after(-1);
      if (status == STRUT_NO_MEMORY) {
        assert_null(document.root);
        continue;
      }
      assert_int_equal(status, t == 0 || t == 5 ? STRUT_OK : STRUT_BAD_SCENE);
      assert_int_equal(diagnostics.count == 0, status == STRUT_OK);
    }
    assert_true(n > 2);
  }
}

/* Random texts made of YAML's own signs: no crash, and a verdict that fits the messages. */
TEST(random_texts_are_survived) {
  static const char *const parts[] = {
      "a",        "b: ",  ": ",    "- ",           "[",    "]",     "{",   "}",        ", ",   "\n",
      "\n  ",     "&x ",  "*x",    "!t ",          "'",    "\"",    "|\n", ">",        "#",    " #",
      "? ",       "<<: ", "---\n", "...\n",        "%TAG", "\t",    "\\",  "\xC3\xA4", "\xFF", "\r",
      "\xC2\x85", "~",    "0x",    "\xEF\xBB\xBF", "\x01", "k: 1\n"};
  uint64_t seed = 99;
  int good = 0;
  for (int i = 0; i < 100000; i++) {
    char text[200] = "";
    for (int32_t n = 1 + random_below(&seed, 14); n; n--)
      strcat(text, parts[random_below(&seed, sizeof parts / sizeof parts[0])]);
    OWN(strut_document) document = {0};
    OWN(strut_diagnostics) diagnostics = {0};
    strut_status status = read_text(text, &document, &diagnostics);
    assert_true((status == STRUT_OK) == (diagnostics.count == 0));
    assert_true(status != STRUT_OK || document.root);
    assert_non_null(strut_diagnostics_render(&diagnostics, 50));
    good += status == STRUT_OK;
  }
  assert_true(good > 1000);
}

TEST(files_are_read_whole) {
  char path[] = "/tmp/strut-text-XXXXXX", *text = NULL;
  size_t length = 7, big = 300001;
  strut_error error = {0};
  int file = mkstemp(path);
  assert_true(file >= 0);
  assert_ok(strut_file_read(path, &text, &length, &error));
  assert_all(length == 0, !*text);
  strut_release(text);
  FREED char *bytes = malloc(big);
  for (size_t i = 0; i < big; i++) bytes[i] = (char)(i % 251);
  assert_int_equal(write(file, bytes, big), big);
  assert_ok(strut_file_read(path, &text, &length, &error));
  assert_int_equal(length, big);
  assert_memory_equal(text, bytes, big);
  assert_int_equal(text[big], 0);
  strut_release(text);
  REFUSE_EACH(n, status, 0) {
    status = refused(n, strut_file_read(path, &text, &length, &error));
    assert_true(status == STRUT_OK || !text);
    strut_release(text);
  }
  assert_int_equal(ftruncate(file, (off_t)STRUT_TEXT_MOST + 1), 0); /* a hole: no disk is used */
  assert_fails(strut_file_read(path, &text, &length, &error), STRUT_BAD_SCENE, error,
               "has more than 256 MiB");
  assert_null(text);
  close(file);
  unlink(path);
  assert_fails(strut_file_read(path, &text, &length, &error), STRUT_FILE_TROUBLE, error,
               "cannot read '/tmp/strut-text-", "No such file or directory");
  assert_fails(strut_file_read("/", &text, &length, &error), STRUT_FILE_TROUBLE, error,
               "directory");
}

TEST(standard_input_is_read) {
  int pipes[2], kept = dup(0);
  assert_int_equal(pipe(pipes), 0);
  assert_int_equal(write(pipes[1], "a: 1\n", 5), 5);
  close(pipes[1]);
  dup2(pipes[0], 0);
  close(pipes[0]);
  RELEASED char *text = NULL;
  size_t length = 0;
  strut_status status = strut_file_read("-", &text, &length, NULL);
  dup2(kept, 0);
  close(kept);
  assert_ok(status);
  assert_int_equal(length, 5);
  assert_string_equal(text, "a: 1\n");
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Runs of rows that libyaml does not see, deferred or not, give the tree and the messages that libyaml alone
 * gives: for every scene of the repository, good and bad, and for texts with random faults.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "parser/yaml/document_parts.h"
#include "parser/yaml/rows.h"
#include "tests/language/faults.h"
#include "tests/language/scenes.h"
#include "tests/support/test.h"

/* Equal in every field, down to the last leaf. */
static bool same_tree(const strut_tree *a, const strut_tree *b) {
  if (!a || !b) return a == b;
  if (a->kind != b->kind || a->count != b->count || a->quoted != b->quoted || b->deferred)
    return false;
  if (memcmp(&a->place, &b->place, sizeof a->place) != 0) return false;
  if (strcmp(a->text, b->text) != 0) return false;
  const strut_tree *x = a->first, *y = b->first;
  for (; x && y; x = x->next, y = y->next)
    if (!same_tree(x, y)) return false;
  return x == y;
}

typedef struct reading {
  strut_document document;
  strut_diagnostics diagnostics;
  strut_status status;
  const char *messages;
} reading;

static void read_text(const char *text, size_t length, uint32_t least, const char *const *keys,
                      reading *r) {
  *r = (reading){.status = STRUT_OK};
  strut_diagnostics_source(&r->diagnostics, "text", text, length);
  r->status = strut_document_read_rows(&r->document, &r->diagnostics, least, keys);
  r->messages = strut_diagnostics_render(&r->diagnostics, 50);
}

static void free_reading(reading *r) {
  strut_document_free(&r->document);
  strut_diagnostics_free(&r->diagnostics);
}

static size_t deferred_values; /* seen so far */

/* Expands the deferred values below the root one by one: each is that of the other tree. */
static bool same_values(const strut_tree *plain, const strut_tree *root) {
  strut_row_nodes nodes;
  const strut_tree *x = plain ? plain->first : NULL, *y = root ? root->first : NULL;
  if (root && root->kind != STRUT_TREE_MAP) return true;
  for (; x && y; x = x->next->next, y = y->next->next) {
    const strut_tree *a = x->next->first, *b = y->next->first;
    bool map = y->next->kind == STRUT_TREE_MAP;
    for (; a && b && map; a = a->next->next, b = b->next->next) {
      if (!same_tree(a->next, strut_row_expand(b->next, &nodes))) return false;
      deferred_values += b->next->deferred;
    }
  }
  return true;
}

/* Reads it without runs, with runs, and with deferred rows; the number of its runs. */
static size_t expect_same(const char *text, size_t length) {
  static const char *const keys[] = {"nodes", "members", "x", "list", "text", NULL};
  reading plain, rows, deferred;
  strut_row_runs runs = {0};
  assert_true(strut_row_runs_find(text, length, 2, &runs));
  size_t count = runs.count;
  read_text(text, length, 0, NULL, &plain);
  read_text(text, length, 2, NULL, &rows);
  read_text(text, length, 2, keys, &deferred);
  bool same = plain.status == rows.status && strcmp(plain.messages, rows.messages) == 0 &&
              same_tree(plain.document.root, rows.document.root);
  same = same && plain.status == deferred.status &&
         strcmp(plain.messages, deferred.messages) == 0 &&
         same_values(plain.document.root, deferred.document.root);
  same = same && strut_document_expand(&deferred.document) &&
         same_tree(plain.document.root, deferred.document.root);
  if (!same)
    print_error("without runs: %s\nwith runs: %s\nof the text:\n%.*s\n", plain.messages,
                rows.messages, length < 4000 ? (int)length : 4000, text);
  assert_true(same);
  free_reading(&plain);
  free_reading(&rows);
  free_reading(&deferred);
  strut_row_runs_free(&runs);
  return plain.status == STRUT_OK ? count : 0;
}

TEST(every_scene_is_the_same) {
  for (int bad = 0; bad < 2; bad++) {
    scene_file *files;
    size_t count = bad ? refused_files(&files) : scene_files(&files), runs = 0;
    for (size_t i = 0; i < count; i++) runs += expect_same(files[i].text, files[i].length);
    assert_true(runs > 20 && deferred_values > 100);
    free_scene_files(files, count);
  }
}

/* ---- faults ---- */

/* Texts that are mostly rows, with what may stand between, before and behind them. */
static const char *const texts[] = {
    "nodes:\n  a: [0, 0]\n  b: [1 mm, -2]\n  c: {position: [3, 4], fixed: both}\n  d: [5, 6] # c\n"
    "members:\n  ab: {group: x, nodes: [a, b]}\n  bc: {group: x, nodes: [b, c]}\n"
    "  cd: {group: x, nodes: [c, d], mass: 1e-3 kg}\n  da: {nodes: [d, a]}\nend: 1\n",
    "a: [1, 2]\nb: [3, 4]\nc: {x: {y: [1, {z: 2}]}}\nd: []\ne: [5]\nf: [6]\n\ng: [7]\nh: [8]\n",
    "list:\n- a: [1]\n  b: [2]\n  c: [3]\n- a: [1]\n  b: [2]\n  c: [3]\nlast: {a: 1}\nmore: {b: "
    "2}\n",
    "text: |\n  a: [1]\n  b: [2]\n  c: [3]\nquoted: \"\n  a: [1]\n  b: [2]\n\"\nx: [1]\ny: [2]\n",
    "x:\n  a: &n [1]\n  b: [2]\n  c: [3]\n  d: *n\n  e: [4]\n  f: [5]\n  g: [6, -7, a*b, (2), "
    ".5]\n",
    "nodes:\n  a: [1]\n  b: [2]\n  c: {x: {y: 3}}\nmembers: &m\n  a: [1]\n  b: [2]\n  c: [3]\nx: "
    "*m\n",
    "%YAML 1.2\n---\n  a: [1]\n  b: [2]\n  c: [3]\n...\n# end\n",
    "\xEF\xBB\xBFumlaut: \xC3\xA4\na: {k: v} \nb: {k: v}  # x\nc: {k: v}\nd: &x\n  e: [1]\n  f: "
    "[2]\ng: *x\n",
};

TEST(faults_are_the_same) {
  enum { ROOM = 4096 };
  char spoilt[ROOM];
  size_t good = 0,
         turns = getenv("STRUT_ROWS_TURNS") ? (size_t)atol(getenv("STRUT_ROWS_TURNS")) : 3000;
  for (size_t t = 0; t < sizeof texts / sizeof texts[0]; t++) {
    size_t length = strlen(texts[t]);
    expect_same(texts[t], length);
    for (size_t turn = 0; turn < turns; turn++)
      good += expect_same(spoilt, spoil_text(texts[t], length, spoilt)) > 0;
  }
  assert_true(good > turns / 2); /* often enough the runs were read */
}

TEST(only_plain_lines_are_rows) {
  static const struct {
    const char *text;
    int tokens; /* 0: no row */
  } lines[] = {
      {"a: [1, 2]\n", 4},
      {"  m1: {group: g, nodes: [a, b]}\n", 8},
      {"a: [1, 2]", 0},
      {"a: []\n", 0},
      {"a: 1\n", 0},
      {"a:[1]\n", 0},
      {"a: [1,]\n", 0},
      {"a: [1] 2\n", 0},
      {"a: [1]#\n", 0},
      {"a: [1] # c\n", 3},
      {"a: {b: 1, b: 2}\n", 0},
      {"a: {b: 1, c: [b, b]}\n", 8},
      {"a: {b: \"1\"}\n", 0},
      {"a: &x [1]\n", 0},
      {"a: [x y]\n", 3},
      {"a: [10 kN/m, -2*(a + b)^2 ]\n", 4},
      {"a: [- 1]\n", 0},
      {"- a: [1]\n", 0},
      {"a: {<<: 1}\n", 0},
      {"\ta: [1]\n", 0},
      {"a: [[[[[1]]]]]\n", 0},
      {"a: {b: }\n", 0},
      {"a: [1:2]\n", 0},
      {"a: [b: 2]\n", 0},
      {"a: {b: c: 2}\n", 0},
      {"a: [x\xC3\xA4]\n", 0},
  };
  for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
    strut_row row;
    bool found = strut_row_read(lines[i].text, strlen(lines[i].text), &row);
    if (found != (lines[i].tokens > 0) || (found && row.count != lines[i].tokens))
      print_error("%s", lines[i].text);
    assert_int_equal(found ? row.count : 0, lines[i].tokens);
  }
}

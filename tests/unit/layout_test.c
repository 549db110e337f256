/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The canonical layout of texts that are nearly YAML; tests/fuzz/fuzz_layout.c goes on for longer. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/memory.h"
#include "parser/yaml/layout.h"
#include "tests/language/scenes.h"
#include "tests/support/test.h"

enum { ROUNDS = 4000, ROOM = 64 };

static uint64_t next_random(uint64_t *state) {
  *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return *state >> 33;
}

/* A stretch of a scene in which a few pieces were put or taken away; the caller frees it. */
static char *disturbed(const scene_file *file, uint64_t *state) {
  static const char *const pieces[] = {
      " ",  "\n", "  ",    "\n\n",      "#x\n", " # c\n",   "- ",  "\t",  ", ", "{",
      "}",  "[",  "]",     "\"",        "'",    "|\n",      "&a ", "*a",  ": ", "\r\n",
      "\r", "? ", "---\n", ">-\n  x\n", "|2\n", "\xC2\x85", "!t ", "\xEF"};
  size_t begin = next_random(state) % 2 ? next_random(state) % file->length : 0;
  size_t length = begin ? next_random(state) % 400 : file->length;
  if (length > file->length - begin) length = file->length - begin;
  char *text = calloc(length + ROOM, 1);
  memcpy(text, file->text + begin, length);
  for (size_t k = 1 + next_random(state) % 4; k > 0; k--) {
    size_t at = next_random(state) % (length + 1), size = 1 + next_random(state) % 4;
    const char *piece = pieces[next_random(state) % (sizeof pieces / sizeof pieces[0])];
    if (next_random(state) % 3 && at + size <= length) {
      memmove(text + at, text + at + size, length - at - size + 1);
      length -= size;
    } else {
      memmove(text + at + strlen(piece), text + at, length - at + 1);
      memcpy(text + at, piece, strlen(piece));
      length += strlen(piece);
    }
  }
  return text;
}

TEST(a_layout_is_its_own_layout) {
  scene_file *files;
  size_t count = scene_files(&files), laid_out = 0;
  uint64_t seed = 7;
  for (int i = 0; i < ROUNDS; i++) {
    char *text = disturbed(&files[next_random(&seed) % count], &seed);
    char *result = NULL, *again = NULL;
    strut_error error = {0};
    strut_status status = strut_layout_text(text, strlen(text), &result, &error);
    assert_true(status == STRUT_OK || (status == STRUT_BAD_SCENE && error.message[0] && !result));
    if (status == STRUT_OK) {
      laid_out++;
      assert_int_equal(strut_layout_text(result, strlen(result), &again, &error), STRUT_OK);
      assert_string_equal(result, again);
    }
    strut_release(result);
    strut_release(again);
    free(text);
  }
  assert_true(laid_out > ROUNDS / 20);
  free_scene_files(files, count);
}

TEST(no_scene_is_refused) {
  scene_file *files;
  size_t count = scene_files(&files);
  for (size_t i = 0; i < count; i++) {
    char *result = NULL;
    strut_error error = {0};
    if (strut_layout_text(files[i].text, files[i].length, &result, &error) != STRUT_OK)
      fail_msg("%s: %s", files[i].path, error.message);
    char *before = read_and_write(files[i].path, files[i].text, files[i].length);
    char *after = read_and_write(files[i].path, result, strlen(result));
    assert_non_null(before);
    assert_string_equal(before, after);
    strut_release(before);
    strut_release(after);
    strut_release(result);
  }
  assert_true(count > 60);
  free_scene_files(files, count);
}

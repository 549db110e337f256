/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Scenes whose nodes and members are read from deferred rows: the same scene or messages as without, for all
 * scenes of the repository, good and bad, and with faults in their rows. And what a large file takes.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "parser/read/reader.h"
#include "parser/write/write_scene.h"
#include "tests/language/faults.h"
#include "tests/language/scenes.h"
#include "tests/support/sanitized.h"
#include "tests/support/test.h"

/* ---- the same, deferred or not ---- */

/* The scene written again, or the messages; free it. */
static char *read_rows(const char *path, const char *text, size_t length, uint32_t least) {
  strut_setup setup;
  strut_diagnostics diagnostics = {0};
  strut_status status = strut_setup_read_rows(&setup, path, text, length, NULL, 0, STRUT_FOR_ANY,
                                              least, &diagnostics);
  char *written = status == STRUT_OK ? strut_setup_write(&setup) : NULL;
  const char *messages = strut_diagnostics_render(&diagnostics, 1000);
  const char *notes = strut_diagnostics_render_notes(&diagnostics);
  assert_true((written || status != STRUT_OK) && messages && notes);
  size_t size = strlen(messages) + strlen(notes) + (written ? strlen(written) : 0) + 20;
  char *all = malloc(size);
  snprintf(all, size, "%d %s%s%s", (int)status, messages, notes, written ? written : "");
  strut_release(written);
  strut_setup_free(&setup);
  strut_diagnostics_free(&diagnostics);
  return all;
}

static void expect_same(const char *path, const char *text, size_t length) {
  char *plain = read_rows(path, text, length, 0), *deferred = read_rows(path, text, length, 2);
  if (strcmp(plain, deferred) != 0)
    print_error("%s\nwithout deferred rows: %.2000s\nwith these: %.2000s\nof the text:\n%.4000s\n",
                path, plain, deferred, text);
  assert_string_equal(plain, deferred);
  free(plain);
  free(deferred);
}

/* The byte of some letter or digit in a row; `length` if none was hit. */
static size_t choose_in_row(const char *text, size_t length) {
  strut_row row;
  for (int tries = 0; tries < 100 && length; tries++) {
    size_t at = throw_dice((uint32_t)length), begin = at;
    while (begin > 0 && text[begin - 1] != '\n') begin--;
    char c = text[at];
    bool word = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z');
    if (word && strut_row_read(text + begin, length - begin, &row)) return at;
  }
  return length;
}

static void scenes_with_faults_are_the_same(scene_file *file) {
  static const char others[] = "0159abkmnxyz.-_ ,:";
  for (int turn = 0; turn < 12; turn++) {
    size_t at = choose_in_row(file->text, file->length);
    if (at == file->length) return;
    char before = file->text[at];
    file->text[at] = others[throw_dice(sizeof others - 1)];
    expect_same(file->path, file->text, file->length);
    file->text[at] = before;
  }
}

TEST(every_scene_is_the_same) {
  for (int bad = 0; bad < 2; bad++) {
    scene_file *files;
    size_t count = bad ? refused_files(&files) : scene_files(&files);
    for (size_t i = 0; i < count; i++) {
      if (files[i].length > 100000) continue;
      expect_same(files[i].path, files[i].text, files[i].length);
      scenes_with_faults_are_the_same(&files[i]);
    }
    free_scene_files(files, count);
  }
}

/* ---- memory ---- */

enum { MEMBERS = 100000, LINE = 80 };

/* A chain of cables that hangs from its first node. */
static char *make_chain(void) {
  char *text = malloc((size_t)(2 * MEMBERS + 10) * LINE), *end = text;
  end += sprintf(end,
                 "strut: 1\ngravity: [0, -9.81]\ngroups:\n"
                 "  along: {kind: cable, stiffness: 1e7, mass: 0.01}\n"
                 "nodes:\n  a0: {position: [0, 0], fixed: both}\n");
  for (int i = 1; i <= MEMBERS; i++) end += sprintf(end, "  a%d: [0, -%d]\n", i, i);
  end += sprintf(end, "members:\n");
  for (int i = 1; i <= MEMBERS; i++)
    end += sprintf(end, "  t%d: {group: along, nodes: [a%d, a%d]}\n", i, i - 1, i);
  return text;
}

/* Bytes that reading takes at its largest, beyond the text. */
static double measure_reading(const char *text) {
  int pipes[2];
  double bytes = -1.0;
  assert_int_equal(pipe(pipes), 0);
  pid_t child = fork();
  if (child == 0) {
    struct rusage before, after;
    strut_setup setup;
    strut_diagnostics diagnostics = {0};
    getrusage(RUSAGE_SELF, &before);
    strut_status status =
        strut_setup_read(&setup, "chain", text, strlen(text), NULL, 0, STRUT_FOR_ANY, &diagnostics);
    getrusage(RUSAGE_SELF, &after);
    if (status == STRUT_OK && setup.scene.member_count == MEMBERS)
      bytes = 1024.0 * (double)(after.ru_maxrss - before.ru_maxrss);
    ssize_t written = write(pipes[1], &bytes, sizeof bytes);
    _exit(written == (ssize_t)sizeof bytes ? 0 : 1);
  }
  assert_int_equal(read(pipes[0], &bytes, sizeof bytes), sizeof bytes);
  waitpid(child, NULL, 0);
  close(pipes[0]);
  close(pipes[1]);
  return bytes;
}

TEST(a_member_takes_few_bytes) {
  char *text = make_chain();
  double bytes = measure_reading(text) / MEMBERS;
  free(text);
  print_message("%.0f bytes for each of %d members and its node\n", bytes, MEMBERS);
  assert_true(bytes > 0.0);
  if (!SANITIZED) assert_true(bytes < 450);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every file of tests/language/bad is refused with exactly the messages that it announces. */
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "parser/read/read_scene.h"

#define FOLDER STRUT_TESTS_DIR "/language/bad/"

enum { MOST_FILES = 1000, MOST_LINES = 40, MOST_SETS = 8 };

/* What a file announces: "# expect: LINE:COLUMN: message", "# note: LINE:COLUMN: text" of a note to one of
   them, "# set: name=value", "# purpose: ...". */
typedef struct announcement {
  size_t count, sets;
  char *expected[MOST_LINES];
  strut_override set[MOST_SETS];
  strut_purpose purpose;
  char *text; /* owns all of the above */
} announcement;

static char *read_text(const char *path, size_t *length) {
  FILE *file = fopen(path, "rb");
  if (!file) return NULL;
  char *text = calloc(1, 1 << 20);
  *length = fread(text, 1, (1 << 20) - 1, file);
  fclose(file);
  return text;
}

static void take_line(announcement *a, char *line) {
  static const char expect[] = "# expect: ", note[] = "# note: ", set[] = "# set: ",
                    statics[] = "# purpose: statics";
  if (strncmp(line, expect, strlen(expect)) == 0) {
    assert_true(a->count < MOST_LINES);
    a->expected[a->count++] = line + strlen(expect);
  } else if (strncmp(line, note, strlen(note)) == 0) {
    assert_true(a->count < MOST_LINES);
    a->expected[a->count++] = line + strlen("# ");
  } else if (strncmp(line, set, strlen(set)) == 0) {
    char *name = line + strlen(set), *equals = strchr(name, '=');
    assert_non_null(equals);
    *equals = '\0';
    a->set[a->sets++] = (strut_override){name, equals + 1};
  } else if (strcmp(line, statics) == 0) {
    a->purpose = STRUT_FOR_STATICS;
  } else if (strcmp(line, "# purpose: any") == 0) {
    a->purpose = STRUT_FOR_ANY;
  }
}

/* From the head of the file itself, or from the file beside it. */
static announcement read_announcement(const char *path, const char *text) {
  announcement a = {.purpose = STRUT_FOR_RUN};
  char beside[600];
  size_t length;
  snprintf(beside, sizeof beside, "%s.expect", path);
  a.text = read_text(beside, &length);
  if (a.text) {
    for (char *line = strtok(a.text, "\n"); line; line = strtok(NULL, "\n"))
      a.expected[a.count++] = line;
    return a;
  }
  a.text = strdup(text);
  for (char *line = strtok(a.text, "\n"); line && line[0] == '#'; line = strtok(NULL, "\n"))
    take_line(&a, line);
  return a;
}

static int by_text(const void *a, const void *b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

static char *line_of(const char *kind, strut_place place, const char *message) {
  size_t size = strlen(message) + 50;
  char *line = malloc(size);
  snprintf(line, size, "%s%u:%u: %s", kind, place.line, place.column, message);
  return line;
}

/* Compares as sets of lines; says what is missing and what is too much. Returns the differences. */
static size_t compare(const char *name, char **expected, size_t count,
                      const strut_diagnostics *found) {
  char **lines = calloc(found->count * (1 + STRUT_MESSAGE_NOTES) + 1, sizeof *lines);
  size_t e = 0, f = 0, all = 0, differences = 0;
  for (size_t i = 0; i < found->count; i++) {
    const strut_diagnostic *d = &found->items[i];
    lines[all++] = line_of("", d->place, d->message);
    for (int k = 0; k < STRUT_MESSAGE_NOTES; k++)
      if (d->note[k]) lines[all++] = line_of("note: ", d->note_place[k], d->note[k]);
  }
  qsort(lines, all, sizeof *lines, by_text);
  qsort(expected, count, sizeof *expected, by_text);
  while (e < count || f < all) {
    int order = e == count ? 1 : f == all ? -1 : strcmp(expected[e], lines[f]);
    if (order) differences++;
    if (order < 0) print_error("%s: not found: %s\n", name, expected[e]);
    if (order > 0) print_error("%s: not expected: %s\n", name, lines[f]);
    if (order <= 0) e++;
    if (order >= 0) f++;
  }
  for (size_t i = 0; i < all; i++) free(lines[i]);
  free(lines);
  return differences;
}

static size_t check_file(const char *name) {
  char path[500];
  size_t length = 0;
  snprintf(path, sizeof path, FOLDER "%s", name);
  char *text = read_text(path, &length);
  assert_non_null(text);
  announcement a = read_announcement(path, text);
  strut_setup setup;
  strut_diagnostics diagnostics = {0};
  strut_status status =
      strut_setup_read(&setup, name, text, length, a.set, a.sets, a.purpose, &diagnostics);
  size_t wrong = compare(name, a.expected, a.count, &diagnostics);
  if (status != STRUT_BAD_SCENE || a.count == 0) {
    print_error("%s: status %d, %zu messages announced\n", name, (int)status, a.count);
    wrong++;
  }
  if (setup.scene.arena.chunk || setup.scene.node_count || setup.scene.nodes) {
    print_error("%s: the scene is not empty\n", name);
    wrong++;
  }
  strut_diagnostics_render(&diagnostics, 50);
  strut_setup_free(&setup);
  strut_diagnostics_free(&diagnostics);
  free(a.text);
  free(text);
  return wrong;
}

static void every_bad_file_says_what_it_announces(void **state) {
  (void)state;
  DIR *folder = opendir(FOLDER);
  size_t files = 0, wrong = 0;
  assert_non_null(folder);
  for (struct dirent *entry = readdir(folder); entry; entry = readdir(folder)) {
    size_t length = strlen(entry->d_name);
    if (length < 5 || strcmp(entry->d_name + length - 5, ".yaml") != 0) continue;
    wrong += check_file(entry->d_name);
    files++;
  }
  closedir(folder);
  assert_int_equal(wrong, 0);
  assert_true(files >= 100 && files <= MOST_FILES);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_bad_file_says_what_it_announces)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

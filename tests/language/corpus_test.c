/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every case of tests/language/bad is refused with exactly the messages that it announces; bases are valid. */
#include "parser/language/read/read_scene.h"
#include "tests/language/cases.h"
#include "tests/support/test.h"

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
static size_t compare(faulty_case *c, const strut_diagnostics *found) {
  char **expected = c->message;
  char **lines = calloc(found->count * (1 + STRUT_MESSAGE_NOTES) + 1, sizeof *lines);
  size_t e = 0, f = 0, all = 0, count = c->message_count, differences = 0;
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
    if (order < 0) print_error("%s: %s: not found: %s\n", c->document, c->name, expected[e]);
    if (order > 0) print_error("%s: %s: not expected: %s\n", c->document, c->name, lines[f]);
    if (order <= 0) e++;
    if (order >= 0) f++;
  }
  for (size_t i = 0; i < all; i++) free(lines[i]);
  free(lines);
  return differences;
}

static strut_purpose purpose_of(const faulty_case *c) {
  if (strcmp(c->purpose, "statics") == 0) return STRUT_FOR_STATICS;
  return strcmp(c->purpose, "any") == 0 ? STRUT_FOR_ANY : STRUT_FOR_RUN;
}

static strut_override split_setting(char *setting) {
  char *equals = strchr(setting, '=');
  *equals = '\0';
  return (strut_override){setting, equals + 1};
}

/* Returns how much is wrong with a base or case. */
static size_t check_case(faulty_case *c) {
  strut_override set[CASE_MOST_SETS];
  for (size_t i = 0; i < c->set_count; i++) set[i] = split_setting(c->set[i]);
  OWN(strut_setup) setup;
  OWN(strut_diagnostics) diagnostics = {0};
  char path[500]; /* beside the files that it names */
  snprintf(path, sizeof path, STRUT_TESTS_DIR "/language/bad/%s", c->name);
  strut_status status = strut_setup_read(&setup, path, c->text, c->length, set, c->set_count,
                                         purpose_of(c), &diagnostics);
  size_t wrong = compare(c, &diagnostics);
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

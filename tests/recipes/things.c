/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What docs/dev/recipes.md adds to a scene by rows. The number of a hinge: read, with its unit and its range, from
 * a group, from a parameter and from a part, checked in scenes without a file, written, and part of what
 * identifies an equilibrium. A kind of thing: read from a scene and from copies of a part, its references
 * resolved, its mistakes located, and written.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/scene/checks/check.h"
#include "parser/language/read/read_scene.h"
#include "parser/language/write/write_scene.h"

int test_a_number_of_hinges(void);
int test_a_kind_of_thing(void);

static const char TEXT[] =
    "strut: 1\n"
    "parameters: {turn: 3 deg}\n"
    "groups: {bent: {set: 5 deg}}\n"
    "parts:\n"
    "  arm:\n"
    "    nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1},\n"
    "            c: {position: [0, 1], mass: 1}}\n"
    "    members: {p: {kind: bar, nodes: [a, b], stiffness: 9}, q: {kind: bar, nodes: [a, c], "
    "stiffness: 9}}\n"
    "    hinges:\n"
    "      own: {nodes: [b, a, c], stiffness: 1, set: turn}\n"
    "      shared: {nodes: [b, a, c], stiffness: 1, group: bent}\n"
    "place: {one: {part: arm}}\n";

static int failures;

static void expect(bool good, const char *what) {
  if (!good) printf("recipes for things: %s\n", what);
  failures += !good;
}

/* Reads the scene; *message: of the first error, "" without one. */
static bool read_text(const char *text, const char *turn, strut_setup *setup, char message[200]) {
  strut_diagnostics diagnostics = {0};
  const strut_setting set = {.name = "turn", .text = turn};
  strut_status status = strut_setup_read(setup, "recipe.yaml", text, strlen(text), &set,
                                         turn ? 1 : 0, STRUT_FOR_STATICS, &diagnostics);
  snprintf(message, 200, "%s", diagnostics.count ? diagnostics.items[0].message : "");
  strut_diagnostics_free(&diagnostics);
  return status == STRUT_OK;
}

typedef struct numbers {
  size_t count;
  double sum;
} numbers;

static void add(void *context, double number) {
  numbers *all = context;
  all->sum += (double)++all->count * (isnan(number) ? 1.0 : number);
}

/* A scene that was made without a file: its number is checked, and counts for what is at rest. */
static void change_the_scene(strut_setup *setup) {
  strut_findings findings = {0};
  numbers before = {0}, after = {0};
  strut_setup_at_rest(setup, add, &before);
  setup->scene.hinges[0].set += 0.01;
  strut_setup_at_rest(setup, add, &after);
  expect(before.count == after.count && before.sum != after.sum, "it does not count at rest");
  setup->scene.hinges[0].set = -1.0;
  expect(strut_setup_check(setup, STRUT_FOR_STATICS, &findings) == STRUT_BAD_SCENE &&
             strcmp(findings.items[0].key, "set") == 0 &&
             strstr(findings.items[0].message, "must not be negative"),
         "its range is not checked");
  strut_findings_free(&findings);
}

int test_a_number_of_hinges(void) {
  const double degree = 3.14159265358979323846 / 180.0;
  strut_setup setup, again;
  char message[200];
  bool fine = read_text(TEXT, NULL, &setup, message);
  expect(fine, message);
  if (!fine) return failures;
  expect(fabs(setup.scene.hinges[0].set - 3.0 * degree) < 1e-15, "the parameter is not read");
  expect(fabs(setup.scene.hinges[1].set - 5.0 * degree) < 1e-15, "the group is not read");
  expect(fabs(strut_hinge_rest(&setup.scene, 0) - strut_hinge_drawn(&setup.scene, 0) -
              3.0 * degree) < 1e-15,
         "it does not turn the hinge");
  char *text = strut_setup_write(&setup);
  expect(text && strstr(text, "set: 0.05") && read_text(text, NULL, &again, message), message);
  expect(text && again.scene.hinges[0].set == setup.scene.hinges[0].set, "it is not written");
  strut_setup_free(&again);
  strut_release(text);
  expect(read_text(TEXT, "20 deg", &again, message) &&
             fabs(again.scene.hinges[0].set - 20.0 * degree) < 1e-15,
         "--set does not reach it");
  strut_setup_free(&again);
  expect(!read_text(TEXT, "-1 deg", &again, message) && strstr(message, "must not be negative"),
         "its range is not read");
  expect(!read_text(TEXT, "1 N", &again, message) && strstr(message, "an angle"),
         "its unit is not read");
  change_the_scene(&setup);
  strut_setup_free(&setup);
  return failures;
}

static const char MARKS[] =
    "strut: 1\n"
    "parameters: {wide: 3 mm}\n"
    "parts:\n"
    "  arm: {nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1}},\n"
    "        members: {p: {kind: bar, nodes: [a, b], stiffness: 9}},\n"
    "        marks: {tip: {node: b, radius: 2 mm}}}\n"
    "place: {v: {part: arm, repeat: {count: 2, step: [0, 1]}}}\n"
    "marks: {own: {node: v.0.a, radius: wide}}\n";

int test_a_kind_of_thing(void) {
  strut_setup setup, again;
  char message[200];
  failures = 0;
  bool fine = read_text(MARKS, NULL, &setup, message);
  expect(fine, message);
  if (!fine) return failures;
  const strut_mark *mark = setup.scene.marks;
  int32_t second = -1, own = -1;
  for (int32_t i = 0; i < (int32_t)setup.scene.mark_count; i++) {
    if (strcmp(mark[i].name, "v.1.tip") == 0) second = i;
    if (strcmp(mark[i].name, "own") == 0) own = i;
  }
  expect(setup.scene.mark_count == 3 && second >= 0 && own >= 0, "copies do not have it");
  if (second < 0 || own < 0) return failures;
  expect(strcmp(setup.scene.nodes[mark[second].node].name, "v.1.b") == 0, "its copy is elsewhere");
  expect(mark[second].radius == 2e-3 && mark[own].radius == 3e-3, "its number is not read");
  char *text = strut_setup_write(&setup);
  expect(text && read_text(text, NULL, &again, message) && again.scene.mark_count == 3 &&
             again.scene.marks[own].node == mark[own].node,
         "it is not written");
  strut_setup_free(&again);
  strut_release(text);
  static const char *const bad[][3] = {{"radius: 2 mm", "radius: 2 N ", "a length"},
                                       {"radius: wide", "radius: -1  ", "above zero"},
                                       {"node: v.0.a", "node: v.0.c", "v.0."},
                                       {"marks: {own", "mraks: {own", "marks"}};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    char other[sizeof MARKS];
    memcpy(other, MARKS, sizeof MARKS);
    memcpy(strstr(other, bad[i][0]), bad[i][1], strlen(bad[i][1]));
    expect(!read_text(other, NULL, &again, message) && strstr(message, bad[i][2]), message);
  }
  strut_setup_free(&setup);
  return failures;
}

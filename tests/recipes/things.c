/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The number of a hinge that docs/recipes.md adds by a row and a field: read, with its unit and its range, from
 * a group, from a parameter and from a part, checked in scenes without a file, written, and part of what an
 * equilibrium is known by.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/scene/check.h"
#include "parser/read/read_scene.h"
#include "parser/write/write_scene.h"

int test_a_number_of_hinges(void);

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
  if (!good) printf("a number of hinges: %s\n", what);
  failures += !good;
}

/* Reads the scene; *message: of the first error, "" without one. */
static bool read_text(const char *text, const char *turn, strut_setup *setup, char message[200]) {
  strut_diagnostics diagnostics = {0};
  const strut_override set = {"turn", turn};
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

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tables of things: names by kind, and the numbers by which an equilibrium is known. */
#include "engine/scene/things.h"
#include "engine/base/memory.h"
#include "parser/language/keys/keys.h"
#include "tests/models/run_model.h"

static const char text[] =
    "nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1},\n"
    "        c: {position: [1, 1], mass: 1}, d: {position: [0, 1], mass: 1}}\n"
    "members:\n"
    "  p: {kind: cable, nodes: [a, b, c], stiffness: 10, mass: 0.5}\n"
    "  q: {kind: bar, nodes: [a, d], law: {kind: table, points: [[-1, -2], [0, 0], [1, 3]]}}\n"
    "  r: {kind: spring, nodes: [c, d], stiffness: 4, maxwell: {stiffness: 1, time: 2}}\n"
    "hinges: {h: {nodes: [b, a, d], stiffness: 1, law: {kind: play, gap: 0.1}}}\n"
    "cells: {k: {nodes: [a, b, c, d], gas: {kind: isentropic, pressure: 3}}}\n"
    "collisions: {t: {node: b, member: q, thickness: 0.1, stiffness: 5}}\n"
    "distances: {w: {nodes: [b, d], along: x, stiffness: 2, law: {kind: play, gap: 0.1}}}\n"
    "loads: {l: {node: c, force: [1, 2]}}\n"
    "unbalances: {u: {node: b, mass: 1, radius: 0.1, speed: 3 Hz}}\n"
    "sliders: {s: {member: q, mass: 1, position: 0.5}}\n"
    "configurations: {drawn: {}}\n"
    "grounds:\n"
    "  hill: {profile: [[-9, -1], [0, -2], [9, -1]], stiffness: 100, nodes: [b]}\n"
    "  pipe: {circle: {centre: [0, 0], radius: 50, inside: yes}, stiffness: 100, nodes: [c]}\n"
    "run: {duration: 1}\n";

typedef struct numbers {
  size_t count;
  double number[2000];
} numbers;

static void add(void *context, double number) {
  numbers *all = context;
  assert_true(all->count < 2000);
  all->number[all->count++] = number;
}

static bool same_at_rest(const strut_setup *setup, const numbers *before) {
  static numbers now;
  now.count = 0;
  strut_setup_at_rest(setup, add, &now);
  return now.count == before->count &&
         memcmp(now.number, before->number, now.count * sizeof *now.number) == 0;
}

/* What a test changes, and what must follow. */
typedef struct change {
  const strut_setup *setup;
  numbers before;
  size_t changed;
} change;

/* Another value within `size` bytes, which is put back. */
static void try_value(change *c, const strut_key *key, char *value, bool of_runs) {
  char kept[16];
  size_t size = key->field.type == STRUT_FIELD_BOOL || key->field.type == STRUT_FIELD_BOOL_PAIR
                    ? sizeof(bool)
                    : 4;
  memcpy(kept, value, size);
  value[0] ^= 1; /* the lowest bit, on machines whose lowest byte comes first */
  bool same = same_at_rest(c->setup, &c->before);
  memcpy(value, kept, size);
  if (same != of_runs)
    fail_msg("'%s' of %s %s", key->name, strut_section_name(key->section),
             same ? "does not change what an equilibrium is known by" : "is said to be of runs");
  c->changed++;
}

static void try_list(change *c, const strut_key *key, char *object) {
  size_t *count = (size_t *)(void *)(object + key->field.number);
  char *array;
  memcpy(&array, object + key->field.offset, sizeof array);
  if (!*count || !array) return;
  try_value(c, key, array, key->field.of_runs);
  --*count;
  assert_false(same_at_rest(c->setup, &c->before));
  ++*count;
}

static void try_section(change *c, strut_section section, char *object, size_t size, bool of_runs) {
  for (int i = 0; i < strut_section_size(section); i++) {
    const strut_key *key = strut_key_at(strut_section_first(section) + i);
    const strut_field *field = &key->field;
    bool runs = of_runs || field->of_runs;
    if (field->offset + field->size > size) continue; /* of a larger object */
    if (field->role == STRUT_FIELD_REFERENCE ||
        (field->role == STRUT_FIELD_VALUE && field->type != STRUT_FIELD_TEXT))
      try_value(c, key, object + field->offset, runs);
    else if (field->role == STRUT_FIELD_LIST)
      try_list(c, key, object);
    else if (field->role == STRUT_FIELD_NESTED)
      try_section(c, strut_section_below(key), object + field->offset, field->size, runs);
  }
}

/* A cached equilibrium is that of another structure as soon as one number differs. */
TEST(every_number_at_rest_counts) {
  static const struct {
    strut_thing kind;
    strut_section section;
  } things[] = {
      {STRUT_THING_NODE, STRUT_SECTION_NODE},      {STRUT_THING_MEMBER, STRUT_SECTION_MEMBER},
      {STRUT_THING_HINGE, STRUT_SECTION_HINGE},    {STRUT_THING_CELL, STRUT_SECTION_CELL},
      {STRUT_THING_CELL, STRUT_SECTION_GAS},       {STRUT_THING_COLLISION, STRUT_SECTION_COLLISION},
      {STRUT_THING_LOAD, STRUT_SECTION_LOAD},      {STRUT_THING_UNBALANCE, STRUT_SECTION_UNBALANCE},
      {STRUT_THING_SLIDER, STRUT_SECTION_SLIDER},  {STRUT_THING_GROUND, STRUT_SECTION_GROUND},
      {STRUT_THING_CONTACT, STRUT_SECTION_CONTACT}};
  static change c;
  OWN(strut_setup) setup = model_read_text("things", text, set_none).setup;
  c.setup = &setup;
  c.before.count = 0;
  strut_setup_at_rest(&setup, add, &c.before);
  for (size_t t = 0; t < sizeof things / sizeof things[0]; t++) {
    size_t count = strut_thing_count(&setup.scene, things[t].kind);
    assert_true(count > 0);
    for (size_t i = 0; i < count; i++)
      try_section(&c, things[t].section,
                  (char *)(uintptr_t)strut_thing_object(&setup.scene, things[t].kind, i),
                  strut_thing_at(things[t].kind)->size, false);
  }
  try_section(&c, STRUT_SECTION_RAYLEIGH, (char *)&setup.scene, sizeof setup.scene, false);
  try_section(&c, STRUT_SECTION_SCENE, (char *)&setup.scene, sizeof setup.scene, false);
  try_section(&c, STRUT_SECTION_EQUILIBRIA, (char *)&setup.experiment.search,
              sizeof setup.experiment.search, false);
  try_section(&c, STRUT_SECTION_SETTLE, (char *)&setup.experiment.settle,
              sizeof setup.experiment.settle, false);
  assert_true(c.changed > 150);
}

TEST(names_follow_the_arrays) {
  OWN(strut_setup) setup = model_read_text("things", text, set_none).setup;
  assert_int_equal(strut_thing_count(&setup.scene, STRUT_THING_MEMBER), 3);
  assert_string_equal(strut_thing_name(&setup.scene, STRUT_THING_MEMBER, 2), "r");
  assert_null(strut_thing_name(&setup.scene, STRUT_THING_MEMBER, 3));
  assert_string_equal(strut_thing_name(&setup.scene, STRUT_THING_SLIDER, 0), "s");
  assert_string_equal(strut_thing_name(&setup.scene, STRUT_THING_GROUND, 1), "pipe");
  assert_ptr_equal(strut_thing_object(&setup.scene, STRUT_THING_CELL, 0), setup.scene.cells);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * No value is lost silently: drop, rename or double any key of a valid scene, or change any number,
 * and either an error is reported or what is written back differs.
 */
#include "parser/language/yaml/document.h"
#include "tests/language/scenes.h"
#include "tests/support/test.h"

/* What saying nothing means too: dropping such a key changes nothing, and must not. */
static const char *const said_anyway[] = {
    "settle: false",
    "limit_things", /* a limit of the reader */
    "derivatives",  /* by parameters, which what is written has no more */
    "nodes: all",
    "law: none",
    "law: karnopp",
    "solver: {accuracy: 1 %}", /* which a run without a solver takes */
    "fixed: none",
    "mass: 0",
    "damping: 0",
    "height: 0",
    "contacts: {}",
    "friction: {law: none",
    "integrator: rk4",
    "mass_model: consistent",
    "kind: pid",
    "configuration: start", /* which is as drawn, in the crawler */
    "apex1: [0, height],",  /* a shape that says of one node what is drawn */
    "isolated: yes",
    "flip: no",
    "turn: turn",
    "set: {long: 200 mm + 0 mm*i}", /* where these are 0, or as declared */
    "normal: [-fy*si",
    "soft: {stiffness: soft}",                /* as its base has it */
    "mu: 0.3, width: 10 mm/s}, nodes: [k.a]", /* level; a contact has its own */
};

/* Names of what is merged into another node, which keeps its own. */
static const char *const names_anyway[] = {"n: {position: [0, 0], mass: 1 g}", "end: {part: dot"};

/* Numbers that say what a dimension is, or that nothing asks for. */
static const char *const numbers_anyway[] = {
    "0.3 m}\n    nodes:\n      left", /* parameters of a part that each placement sets */
    "0 mm} # of its place in the row",
    "1, axial_stiffness: 100, parts: 1",  /* a beam of one part does not bend */
    "1 m + si*fy*1 mm, 2 m",              /* of a point on level ground */
    "0.3, width: 10 mm/s}, nodes: [k.a]", /* that contact has its own */
};

typedef struct mutation {
  const scene_file *file;
  const char *written; /* the scene as it is */
  char *mutant;        /* room for 1 << 20 bytes */
  size_t tried, lost;
} mutation;

/* Byte offset of a place. All columns count code points; continuation bytes do not. */
static size_t offset_of(const char *text, strut_place place) {
  const char *c = text;
  for (uint32_t line = 1; line < place.line; line++) c = strchr(c, '\n') + 1;
  for (uint32_t column = 1; column < place.column; column++) do
      c++;
    while (((unsigned char)*c & 0xc0) == 0x80);
  return (size_t)(c - text);
}

/* Tries the text with `cut` bytes at `at` replaced; `what` says what was done. */
static void try_mutant(mutation *m, size_t at, size_t cut, const char *insert, const char *what,
                       const char *key) {
  const scene_file *f = m->file;
  size_t length = strlen(insert);
  memcpy(m->mutant, f->text, at);
  memcpy(m->mutant + at, insert, length);
  memcpy(m->mutant + at + length, f->text + at + cut, f->length - at - cut + 1);
  char *written = read_and_write(f->path, m->mutant, f->length - cut + length);
  m->tried++;
  if (written && strcmp(written, m->written) == 0) {
    print_error("%s: %s '%s' at byte %zu changes nothing\n", f->path, what, key, at);
    m->lost++;
  }
  strut_release(written);
}

static bool begins_with_one(const char *text, const char *const *beginnings, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (strncmp(text, beginnings[i], strlen(beginnings[i])) == 0) return true;
  return false;
}

static bool needs_not_be_said(const char *pair) {
  return begins_with_one(pair, said_anyway, sizeof said_anyway / sizeof said_anyway[0]);
}

static void mutate_key(mutation *m, const strut_tree *map, const strut_tree *key) {
  const char *text = m->file->text;
  size_t at = offset_of(text, key->place), length = key->place.length;
  bool flow = text[offset_of(text, map->place)] == '{';
  const strut_tree *following = key->next->next;
  char insert[400], indent[100] = "";
  length = strcspn(text + at, ":");
  snprintf(insert, sizeof insert, "x%.*s", key->quoted ? 0 : (int)length, text + at);
  if (!key->quoted &&
      !begins_with_one(text + at, names_anyway, sizeof names_anyway / sizeof names_anyway[0]))
    try_mutant(m, at, length, insert, "renaming", key->text);
  if (following && !needs_not_be_said(text + at))
    try_mutant(m, at, offset_of(text, following->place) - at, "", "dropping", key->text);
  snprintf(indent, sizeof indent, "\n%*s", (int)(key->place.column - 1), "");
  snprintf(insert, sizeof insert, "%.*s: 1%s", (int)length, text + at, flow ? ", " : indent);
  try_mutant(m, at, 0, insert, "doubling", key->text);
}

static void mutate_number(mutation *m, const strut_tree *value) {
  const char *text = m->file->text;
  size_t at = offset_of(text, value->place), length = strlen(value->text);
  char insert[400];
  bool number = strchr("-.(0123456789", value->text[0]) != NULL;
  if (value->quoted || !number || !value->text[0] || length > 300) return;
  if (strncmp(text + at, value->text, length) != 0) return; /* folded, or an alias */
  if (begins_with_one(text + at, numbers_anyway, sizeof numbers_anyway / sizeof numbers_anyway[0]))
    return;
  snprintf(insert, sizeof insert, "(%s)*1.5+0.125", value->text);
  try_mutant(m, at, length, insert, "changing", value->text);
}

static void mutate(mutation *m, const strut_tree *value) {
  if (value->kind == STRUT_TREE_SCALAR) mutate_number(m, value);
  if (value->kind == STRUT_TREE_LIST)
    for (const strut_tree *item = value->first; item; item = item->next) mutate(m, item);
  if (value->kind != STRUT_TREE_MAP) return;
  for (const strut_tree *key = value->first; key; key = key->next->next) {
    mutate_key(m, value, key);
    mutate(m, key->next);
  }
}

TEST(no_value_is_lost) {
  scene_file *files;
  size_t count = scene_files(&files), lost = 0, tried = 0;
  char *room = malloc(1 << 20);
  for (size_t i = 0; i < count; i++) {
    OWN(strut_diagnostics) diagnostics = {0};
    OWN(strut_document) document = {0};
    strut_diagnostics_source(&diagnostics, files[i].path, files[i].text, files[i].length);
    assert_ok(strut_document_read(&document, &diagnostics));
    char *written = read_and_write(files[i].path, files[i].text, files[i].length);
    assert_non_null(written);
    mutation m = {.file = &files[i], .written = written, .mutant = room};
    mutate(&m, document.root);
    lost += m.lost;
    tried += m.tried;
    strut_release(written);
  }
  free(room);
  free_scene_files(files, count);
  assert_int_equal(lost, 0);
  assert_true(tried > 1000);
}

/* Renames each key below `value` in turn: a second fault beside the one that the file has. */
static void misspell(mutation *m, const strut_tree *value) {
  for (const strut_tree *k = value->first; k; k = k->next) {
    if (value->kind == STRUT_TREE_MAP) {
      size_t at = offset_of(m->file->text, k->place);
      if (!k->quoted) try_mutant(m, at, 0, "x", "renaming", k->text);
      k = k->next;
    }
    misspell(m, k);
  }
}

TEST(a_second_fault_is_survived) {
  scene_file *files;
  size_t count = refused_files(&files), tried = 0;
  char *room = malloc(1 << 20);
  for (size_t i = 0; i < count; i++) {
    OWN(strut_diagnostics) diagnostics = {0};
    OWN(strut_document) document = {0};
    strut_diagnostics_source(&diagnostics, files[i].path, files[i].text, files[i].length);
    mutation m = {.file = &files[i], .written = "", .mutant = room};
    if (strut_document_read(&document, &diagnostics) == STRUT_OK) misspell(&m, document.root);
    tried += m.tried;
  }
  free(room);
  free_scene_files(files, count);
  assert_true(tried > 1000);
}

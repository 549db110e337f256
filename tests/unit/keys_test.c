/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of keys is consistent, and the page made from it is the one in docs/. */
#include "parser/language/keys/keys.h"
#include "engine/base/memory.h"
#include "parser/language/write/writer.h"
#include "tests/support/check.h"

TEST(sections_divide_the_table) {
  int key = 0;
  for (int section = 0; section < STRUT_SECTION_COUNT; section++) {
    assert_int_equal(strut_section_first((strut_section)section), key);
    assert_true(strut_section_size((strut_section)section) >= 1);
    assert_true(strut_section_size((strut_section)section) <= STRUT_MOST_KEYS);
    for (int i = 0; i < strut_section_size((strut_section)section); i++, key++) {
      assert_int_equal(strut_key_at(key)->section, section);
      assert_int_equal(strut_key_find((strut_section)section, strut_key_at(key)->name), key);
      assert_true(strlen(strut_key_at(key)->description) > 3);
    }
  }
  assert_int_equal(key, STRUT_KEY_COUNT);
  assert_int_equal(strut_key_find(STRUT_SECTION_MEMBER, "positions"), -1);
}

/* A group's key is read once for members, nodes and contacts: it must mean the same in each. */
TEST(shared_keys_of_groups_agree) {
  static const strut_section sections[] = {STRUT_SECTION_MEMBER, STRUT_SECTION_NODE,
                                           STRUT_SECTION_CONTACT};
  int shared = 0;
  for (size_t a = 0; a < 3; a++)
    for (size_t b = 0; b < a; b++)
      for (int i = 0; i < strut_section_size(sections[a]); i++) {
        const strut_key *key = strut_key_at(strut_section_first(sections[a]) + i);
        int other = strut_key_find(sections[b], key->name);
        if (other < 0) continue;
        shared++;
        assert_int_equal(strut_key_at(other)->type, key->type);
        assert_int_equal(strut_key_at(other)->measure, key->measure);
      }
  assert_true(shared >= 4); /* group twice, stiffness, damping, mass */
}

/* Numbers, words and texts that the reader and writer have code for, and why. */
static const struct exception {
  strut_section section;
  const char *name, *reason;
} exceptions[] = {{STRUT_SECTION_FRICTION, "mu", "sets two fields"},
                  {STRUT_SECTION_INITIAL, "velocity", "of every free node"},
                  {STRUT_SECTION_FRICTION, "mu_forward", "sets both coefficients of a direction"},
                  {STRUT_SECTION_FRICTION, "mu_forward_static", "another name for mu_static"},
                  {STRUT_SECTION_SETTLE, "step", "depends on the step of the run"},
                  {STRUT_SECTION_SCENE, "limit_things", "of the reader; the scene knows no parts"}};

static const char *reason_of(const strut_key *key) {
  for (size_t i = 0; i < sizeof exceptions / sizeof exceptions[0]; i++)
    if (exceptions[i].section == key->section && strcmp(exceptions[i].name, key->name) == 0)
      return exceptions[i].reason;
  return NULL;
}

static bool is_plain(strut_key_type type) {
  return type == STRUT_TYPE_NUMBER || type == STRUT_TYPE_PAIR || type == STRUT_TYPE_WORD ||
         type == STRUT_TYPE_WORDS || type == STRUT_TYPE_TEXT || type == STRUT_TYPE_FIXED;
}

TEST(plain_keys_are_bound_to_fields) {
  size_t wrong = 0;
  for (int i = 0; i < STRUT_KEY_COUNT; i++) {
    const strut_key *key = strut_key_at(i);
    bool excepted = reason_of(key) != NULL, by_hand = key->field.role == STRUT_FIELD_BY_HAND;
    if (!is_plain(key->type) || excepted == by_hand) continue;
    print_error("%s of %s: %s\n", key->name, strut_section_name(key->section),
                excepted ? "bound, but listed as an exception" : "not bound to a field");
    wrong++;
  }
  assert_int_equal(wrong, 0);
}

/* Each of these has code in the reader, and in the writer: a key that rows can describe is none of them. */
TEST(few_keys_are_read_by_hand) {
  int by_hand = 0;
  for (int i = 0; i < STRUT_KEY_COUNT; i++)
    by_hand += strut_key_at(i)->field.role == STRUT_FIELD_BY_HAND;
  assert_true(by_hand <= 30);
}

/* A mapping leads to a section, which has the keys below it. */
TEST(mappings_lead_to_sections) {
  for (int i = 0; i < STRUT_KEY_COUNT; i++) {
    const strut_key *key = strut_key_at(i);
    if (key->type == STRUT_TYPE_MAP) /* named after it: "friction", "friction of a collision" */
      assert_memory_equal(strut_section_name(strut_section_below(key)), key->name,
                          strlen(key->name));
    if (key->field.role == STRUT_FIELD_THINGS) assert_int_equal(key->type, STRUT_TYPE_THINGS);
  }
}

/* What a field of the section holds where the file does not give the key; NULL: nothing to compare. */
static const void *default_object(strut_section section, strut_setup *setup) {
  static strut_node node;
  static strut_member member;
  static strut_ground_section ground;
  static strut_signal signal;
  static strut_quantity_definition quantity;
  node = strut_node_default();
  member = strut_member_default();
  ground.contact = strut_contact_default();
  signal = strut_signal_default(STRUT_SINE);
  switch (section) {
    case STRUT_SECTION_SCENE: return &setup->scene;
    case STRUT_SECTION_NODE: return &node;
    case STRUT_SECTION_MEMBER: return &member;
    case STRUT_SECTION_GROUND: return &ground;
    case STRUT_SECTION_SINE:
    case STRUT_SECTION_HALF_SINE:
    case STRUT_SECTION_SQUARE:
    case STRUT_SECTION_RAMP: return &signal;
    case STRUT_SECTION_SETTLE: return &setup->experiment.settle;
    case STRUT_SECTION_EQUILIBRIA: return &setup->experiment.search;
    case STRUT_SECTION_SOLVER:
    case STRUT_SECTION_RUN:
    case STRUT_SECTION_OUTPUT: return &setup->experiment;
    case STRUT_SECTION_QUANTITY: return &quantity;
    case STRUT_SECTION_STEADY: return &setup->experiment.steady;
    default: return NULL;
  }
}

static double number_in(strut_field_type kind, const void *field) {
  switch (kind) {
    case STRUT_FIELD_DOUBLE: return *(const double *)field;
    case STRUT_FIELD_INT32: return *(const int32_t *)field;
    case STRUT_FIELD_UINT32: return *(const uint32_t *)field;
    case STRUT_FIELD_UINT64: return (double)*(const uint64_t *)field;
    case STRUT_FIELD_BOOL: return *(const bool *)field;
    default: fail_msg("no number"); return 0.0;
  }
}

/* The page says 4e7 where the field has 0 for it. */
static bool is_spelled_otherwise(const strut_key *key) {
  return key->section == STRUT_SECTION_SETTLE && strcmp(key->name, "evaluations") == 0;
}

TEST(defaults_are_those_of_the_fields) {
  strut_setup setup;
  strut_setup_init(&setup);
  size_t compared = 0;
  for (int i = 0; i < STRUT_KEY_COUNT; i++) {
    const strut_key *key = strut_key_at(i);
    const char *object = default_object(key->section, &setup);
    bool bound = key->field.role == STRUT_FIELD_VALUE && key->measure != STRUT_MEASURE_CONTEXT;
    if (!object || !bound || !*key->fallback || is_spelled_otherwise(key)) continue;
    char *end;
    const void *field = object + key->field.offset;
    double number = strtod(key->fallback, &end);
    if (key->type == STRUT_TYPE_WORD && key->field.type == STRUT_FIELD_TEXT) {
      assert_string_equal(*(const char *const *)field, key->fallback);
    } else if (key->type == STRUT_TYPE_WORD) {
      assert_int_equal((int)number_in(key->field.type, field),
                       strut_word_find(key->words, key->fallback));
    } else if (key->type == STRUT_TYPE_NUMBER && end != key->fallback) {
      if (strcmp(end, " %") == 0) number /= 100.0;
      assert_true(number_in(key->field.type, field) == number);
    } else {
      continue; /* two numbers, or in words: the whole run */
    }
    compared++;
  }
  assert_true(compared >= 25);
}

TEST(words) {
  char text[100];
  assert_string_equal(strut_words_text("bar|spring|cable", text, sizeof text),
                      "bar, spring or cable");
  assert_string_equal(strut_words_text("rk4", text, sizeof text), "rk4");
  assert_string_equal(strut_words_text("a|b", text, sizeof text), "a or b");
  assert_all_equal(strut_word_find("bar|spring|cable", "spring"), 1,
                   strut_word_find("bar|spring|cable", "spr"), -1,
                   strut_word_find("bar|spring|cable", "bar|spring"), -1);
  assert_null(strut_word_at("a|b", 2, text, sizeof text));
}

TEST(the_page_in_docs_is_this_one) {
  RELEASED char *page = strut_keys_page();
  FREED char *committed = calloc(1, 1 << 20);
  assert_non_null(page);
  FILE *file = fopen(STRUT_SOURCE_DIR "/docs/language-keys.md", "rb");
  assert_non_null(file);
  assert_true(fread(committed, 1, (1 << 20) - 1, file) > 0);
  fclose(file);
  assert_string_equal(committed, page);
}

TEST(no_memory) {
  strut_fail_allocation_after(3);
  char *page = strut_keys_page();
  strut_fail_allocation_after(-1);
  assert_null(page);
}

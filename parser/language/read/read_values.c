/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages of the reader, and single values: numbers, pairs, references. See reader.h. */
#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "parser/language/read/reader.h"
#include "parser/language/read/reuse/copies.h"
#include "parser/language/yaml/text.h"

/* Longest text from the file in a message, and most names compared for suggestions. */
enum { SHOWN = 60, MOST_SUGGESTIONS = 200000, LONGEST_NAME = 255 };

void strut_report_text(strut_reader *reader, strut_place place, const char *origin,
                       const char *text) {
  reader->failed = true;
  if (strut_error_is_repeated(reader, place, origin)) return;
  strut_diagnose(reader->diagnostics, place, "%s", text);
  strut_error_remember(reader, place, origin);
}

bool strut_report_error(strut_reader *reader, strut_place place, const char *format, ...) {
  char text[1200] = "";
  va_list arguments;
  va_start(arguments, format);
  if (!strut_diagnostics_full(reader->diagnostics)) vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  strut_report_text(reader, place, format, text);
  return false;
}

static void *allocate(strut_reader *reader, strut_arena *arena, size_t count, size_t size) {
  void *block = strut_arena_allocate(arena, count, size);
  if (!block) reader->out_of_memory = true;
  return block;
}

void *strut_keep_array(strut_reader *reader, size_t count, size_t size) {
  return allocate(reader, reader->keep, count, size);
}

void *strut_scratch_array(strut_reader *reader, size_t count, size_t size) {
  return allocate(reader, &reader->scratch, count, size);
}

void strut_reserve_names(strut_reader *reader, strut_name_map *map, size_t count) {
  if (!strut_name_map_reserve(map, count)) reader->out_of_memory = true;
}

void strut_add_name(strut_reader *reader, strut_name_map *map, const char *name, size_t index) {
  if (strut_diagnostics_full(reader->diagnostics)) return;
  if (strut_name_map_add(map, name, (int32_t)index) == -2) reader->out_of_memory = true;
}

size_t strut_next_entry(const strut_reader *reader, size_t *count) {
  return strut_diagnostics_full(reader->diagnostics) ? *count : (*count)++;
}

const char *strut_keep_text(strut_reader *reader, const char *text) {
  if (strut_diagnostics_full(reader->diagnostics)) return "";
  char *copy = strut_arena_text(reader->keep, text, strlen(text));
  if (copy) return copy;
  reader->out_of_memory = true;
  return "";
}

/* Returns an allocated text, or a stand-in after recording that memory ran out. */
static const char *kept(strut_reader *reader, const char *text) {
  if (text) return text;
  reader->out_of_memory = true;
  return "?";
}

const char *strut_formatted(strut_reader *reader, strut_arena *arena, const char *format, ...) {
  char text[1200];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return kept(reader, strut_arena_text(arena, text, strlen(text)));
}

const char *strut_piece_text(strut_reader *reader, strut_piece piece) {
  return kept(reader, strut_arena_text(&reader->scratch, piece.text, piece.length));
}

const char *strut_keep_unit(strut_reader *reader, strut_dimension dimension, const char *none) {
  char unit[STRUT_SUFFIX_TEXT];
  strut_dimension_suffix(dimension, unit, sizeof unit);
  return *unit ? strut_keep_text(reader, unit) : none;
}

const char *strut_sanitised_text(strut_reader *reader, const char *text) {
  size_t length = strlen(text), end = length;
  if (strut_diagnostics_full(reader->diagnostics)) return "";
  if (length > SHOWN) {
    end = SHOWN;
    while (end && ((unsigned char)text[end] & 0xc0) == 0x80) end--;
  }
  char *copy = strut_arena_text(&reader->scratch, text, end);
  if (!copy) return kept(reader, NULL);
  for (char *c = copy; *c; c++)
    if ((unsigned char)*c < 0x20 || *c == 0x7f) *c = '?';
  return end < length ? kept(reader, strut_arena_format(&reader->scratch, "%s...", copy)) : copy;
}

const char *strut_owner_text(strut_reader *reader, strut_owner owner) {
  if (!owner.name || strut_diagnostics_full(reader->diagnostics)) return owner.kind;
  return kept(reader, strut_arena_format(
                          &reader->scratch, "%s '%s'", owner.kind,
                          strut_sanitised_text(reader, strut_local_name(reader, owner.name))));
}

strut_owner strut_owner_within(strut_reader *reader, const char *what, strut_owner owner) {
  return (strut_owner){
      strut_scratch_text(reader, "the %s of %.150s", what, strut_owner_text(reader, owner)), NULL};
}

bool strut_hints_left(const strut_reader *reader) {
  return reader->suggestions < MOST_SUGGESTIONS && !strut_diagnostics_full(reader->diagnostics);
}

const char *strut_hint(strut_reader *reader, const char *word, strut_names *names,
                       const void *context) {
  if (strlen(word) > LONGEST_NAME || !strut_hints_left(reader)) return "";
  for (size_t i = 0; i < MOST_SUGGESTIONS && names(context, i); i++) reader->suggestions++;
  const strut_near near = strut_near_to(word, names, context);
  return kept(reader, strut_arena_text(&reader->scratch, near.text, strlen(near.text)));
}

const char *strut_hint_of_rows(strut_reader *reader, const char *word,
                               const strut_named_rows *rows) {
  return strut_hint(reader, word, strut_row_name, rows);
}

strut_place strut_root_place(const strut_reader *reader) {
  strut_place place = reader->document.root->place;
  place.length = 1;
  return place;
}

const char *strut_format_cycle(strut_reader *reader, const char *(*name)(strut_reader *, size_t),
                               size_t first, size_t depth) {
  const char *text = "";
  if (strut_diagnostics_full(reader->diagnostics)) return "";
  for (size_t i = first; i < depth; i++) {
    bool shown = depth - first <= 8 || i - first < 4 || depth - i <= 3;
    if (shown)
      text = kept(reader, strut_arena_format(&reader->scratch, "%s%s -> ", text, name(reader, i)));
    else if (i - first == 4)
      text = kept(reader, strut_arena_format(&reader->scratch, "%s... -> ", text));
  }
  return kept(reader, strut_arena_format(&reader->scratch, "%s%s", text, name(reader, first)));
}

bool strut_lacks_space(const strut_tree *value) {
  if (value->kind != STRUT_TREE_SCALAR || value->quoted) return false;
  size_t word = strspn(value->text, STRUT_LETTERS);
  const char *colon = value->text + word;
  return word && colon[0] == ':' && colon[1] && colon[1] != ' ';
}

bool strut_lacks_space_after(const strut_tree *value, const char *name) {
  size_t length = strlen(name);
  return strut_lacks_space(value) && strncmp(value->text, name, length) == 0 &&
         value->text[length] == ':';
}

const char *strut_found(strut_reader *reader, const strut_tree *value) {
  strut_arena *arena = &reader->scratch;
  if (strut_diagnostics_full(reader->diagnostics)) return "";
  if (value->kind == STRUT_TREE_MAP) return "a mapping";
  if (value->kind == STRUT_TREE_LIST && !value->count) return "an empty list";
  if (value->kind == STRUT_TREE_LIST)
    return kept(reader, strut_arena_format(arena, "a list of %u", (unsigned)value->count));
  if (strut_is_null(value)) return "nothing";
  if (!*value->text) return "an empty text";
  return kept(reader, strut_arena_format(arena, value->quoted ? "the text '%s'" : "'%s'",
                                         strut_sanitised_text(reader, value->text)));
}

static bool is_scalar(const strut_tree *value) {
  return value->kind == STRUT_TREE_SCALAR && !strut_is_null(value);
}

bool strut_refuse_value(strut_reader *reader, const strut_tree *value, const char *key,
                        strut_owner owner, const char *expected) {
  return strut_report_error(reader, value->place, "expected %s for '%s' of %s, found %s", expected,
                            key, strut_owner_text(reader, owner), strut_found(reader, value));
}

bool strut_read_scalar(strut_reader *reader, const strut_tree *value, const char *key,
                       strut_owner owner, const char *expected) {
  return is_scalar(value) || strut_refuse_value(reader, value, key, owner, expected);
}

/* The place in the file of an error within an expression; the whole value if quotes or escapes hide it. */
static strut_place place_within(const strut_tree *value, const strut_expression_error *error) {
  strut_place place = value->place;
  size_t points = strut_text_points(value->text, strlen(value->text));
  size_t quotes = place.length > points ? place.length - points : 0;
  if (quotes != (value->quoted ? 2u : 0u)) return place;
  place.column += (uint32_t)(error->offset + quotes / 2);
  place.length = error->length ? (uint32_t)error->length & STRUT_PLACE_LENGTH_MOST : 1;
  return place;
}

bool strut_read_quantity(strut_reader *reader, const strut_tree *value, const char *key,
                         strut_owner owner, strut_quantity *quantity) {
  return strut_read_program(reader, value, key, owner, NULL, quantity);
}

bool strut_read_any_quantity(strut_reader *reader, const strut_tree *value, const char *key,
                             strut_owner owner, const char *expected, strut_quantity *quantity) {
  return strut_read_scalar(reader, value, key, owner, expected) &&
         strut_read_quantity(reader, value, key, owner, quantity);
}

bool strut_refuse_dimension(strut_reader *reader, const strut_tree *value, const char *key,
                            strut_owner owner, const char *expected, strut_dimension found) {
  char name[80];
  return strut_report_error(reader, value->place, "expected %s for '%s' of %s, found %s", expected,
                            key, strut_owner_text(reader, owner),
                            strut_dimension_name(found, name, sizeof name));
}

/* A parameter that is called like a unit is reported once, however often the unit is used. */
static bool is_reported(strut_reader *reader, strut_piece name) {
  char text[LONGEST_NAME + 1];
  snprintf(text, sizeof text, "%.*s", (int)name.length, name.text);
  strut_parameter_state *parameter = strut_parameter_in_scope(reader, reader->scope, text);
  if (!parameter || parameter->ambiguous) return parameter != NULL;
  parameter->ambiguous = true;
  return false;
}

/* Characters of a text without quotes that is no sum. */
static const char WORDS[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_ ";

bool strut_read_program(strut_reader *reader, const strut_tree *value, const char *key,
                        strut_owner owner, strut_compiler *compiler, strut_quantity *quantity) {
  strut_expression_error error;
  error.message[0] = '\0';
  error.parameter.length = 0;
  strut_scope scope = strut_parameter_scope(reader);
  const strut_tree *asked_before = reader->asking;
  const char *set_before = reader->asking_set;
  reader->asking = value;
  reader->asking_set = NULL;
  strut_copy *scope_before = reader->scope;
  reader->scope = strut_scope_of(reader, value);
  bool fine = strut_expression_compile(value->text, &scope, compiler, quantity, &error);
  reader->scope = scope_before;
  reader->asking = asked_before;
  reader->asking_set = set_before;
  if (!fine && scope.names) reader->suggestions += reader->parameter_count;
  if (!fine && error.parameter.length && is_reported(reader, error.parameter)) {
    reader->failed = true;
    return false;
  }
  const bool text = strcmp(owner.kind, "the parameters") == 0 &&
                    strstr(error.message, "unknown parameter") &&
                    !value->text[strspn(value->text, WORDS)];
  if (!fine && error.message[0])
    strut_report_error(reader, place_within(value, &error), "in '%s' of %s: %s%s", key,
                       strut_owner_text(reader, owner), error.message,
                       text ? " (put a text in quotes)" : "");
  return fine;
}

bool strut_check_limits(strut_reader *reader, const strut_tree *value, const char *key,
                        strut_owner owner, strut_key_limits limits, double number) {
  char text[STRUT_LIMITS_TEXT];
  return !strut_limits_fault(limits, number, text) ||
         strut_report_error(reader, value->place, "'%s' of %s %s", key,
                            strut_owner_text(reader, owner), text);
}

/* Lengths of a scaled copy are longer, areas more so; other numbers stay. */
static double scale_of(const strut_reader *reader, const strut_tree *value,
                       strut_dimension dimension) {
  double scale = strut_scope_scale(reader, value);
  bool length = dimension.kg == 0.0f && dimension.s == 0.0f && dimension.angle == 0.0f;
  return scale == 1.0 || !length || dimension.m == 0.0f ? 1.0 : pow(scale, (double)dimension.m);
}

/* Of a value that is a parameter: where that is given. */
static const char *parameter_given(strut_reader *reader, const strut_tree *value) {
  const strut_parameter_state *parameter =
      strut_parameter_in_scope(reader, strut_scope_of(reader, value), value->text);
  if (!parameter || parameter->value->place.file != value->place.file) return "";
  return strut_scratch_text(reader, "; line %u gives '%s'", (unsigned)parameter->value->place.line,
                            parameter->name);
}

bool strut_read_number(strut_reader *reader, const strut_tree *value, const char *key,
                       strut_owner owner, strut_dimension dimension, strut_key_limits limits,
                       double *number) {
  char expected[200], found[80];
  strut_quantity quantity;
  const char *what = reader->signal_quantity ? reader->signal_quantity : key;
  if (value->kind != STRUT_TREE_SCALAR || strut_is_null(value)) {
    strut_expected_quantity(what, dimension, expected, sizeof expected);
    return strut_read_scalar(reader, value, key, owner, expected);
  }
  if (!strut_read_quantity(reader, value, key, owner, &quantity)) return false;
  if (!quantity.bare && !strut_dimension_equal(quantity.dimension, dimension)) {
    strut_expected_quantity(what, dimension, expected, sizeof expected);
    strut_dimension turned = quantity.dimension;
    turned.angle = -1.0f;
    bool per_angle = quantity.dimension.angle == 0.0f && strut_dimension_equal(turned, dimension);
    return strut_report_error(reader, value->place, "expected %s for '%s' of %s, found %s%s",
                              expected, key, strut_owner_text(reader, owner),
                              strut_dimension_name(quantity.dimension, found, sizeof found),
                              per_angle ? "; write (...)/(1 rad)" : parameter_given(reader, value));
  }
  *number = quantity.value;
  if (!strut_check_limits(reader, value, key, owner, limits, quantity.value)) return false;
  if (reader->scope) *number *= scale_of(reader, value, dimension);
  return true;
}

bool strut_read_pair(strut_reader *reader, const strut_tree *value, const char *key,
                     strut_owner owner, strut_dimension dimension, double number[2]) {
  if (value->kind == STRUT_TREE_LIST && value->count == 2) {
    const strut_tree *tree = value->first, *y = tree->next;
    bool fine =
        strut_read_number(reader, tree, key, owner, dimension, STRUT_WITHIN(ANY), &number[0]);
    return strut_read_number(reader, y, key, owner, dimension, STRUT_WITHIN(ANY), &number[1]) &&
           fine;
  }
  bool down = strut_dimension_equal(dimension, STRUT_DIM_ACCELERATION);
  const char *example = down ? "0, -9.81 m/s^2" : strut_dimension_example(dimension);
  bool longer = value->kind == STRUT_TREE_LIST && value->count > 2;
  return strut_report_error(reader, value->place,
                            "expected two numbers such as [%s%s] for '%s' of %s, found %s%s",
                            example ? example : "1", down ? "" : ", 0", key,
                            strut_owner_text(reader, owner), strut_found(reader, value),
                            longer ? "; scenes are planar, and the decimal mark is a point" : "");
}

/* Names as they are called within a copy; those of other things are "". */
typedef struct local_names {
  const strut_reader *reader;
  const strut_namespace *names;
} local_names;

static const char *local_name(const void *context, size_t i) {
  const local_names *all = context;
  const char *name = all->names->name(all->names->context, i);
  const char *local = name ? strut_local_name(all->reader, name) : NULL;
  return local == name && name ? "" : local;
}

static const char *hint_of_names(strut_reader *reader, const strut_tree *value,
                                 const strut_namespace *namespace) {
  const local_names within = {reader, namespace};
  const char *word = value->text, *hint = strut_copy_hint(reader, value);
  if (!*hint && reader->scope) hint = strut_hint(reader, word, local_name, &within);
  if (*hint) return hint;
  if (!strut_within_part(reader, value, namespace->map))
    return strut_hint(reader, word, namespace->name, namespace->context);
  return strut_name_map_find(namespace->map, word) < 0 ? "" : "; a part knows its own only";
}

const char *strut_list_names(strut_reader *reader, strut_names *names, const void *context) {
  const char *text = "", *name;
  if (names(context, 14)) return text;
  for (size_t i = 0; (name = names(context, i)); i++)
    text = strut_scratch_text(reader, "%s%s'%s'", text, i ? ", " : "; the names here are ", name);
  return text;
}

/* The thing whose name is the text of the parameter that the value names, or -1, which was reported. */
static int32_t find_named_by_parameter(strut_reader *reader, const strut_tree *value,
                                       const strut_tree *text, const strut_namespace *names) {
  if (strut_find_literally(reader, names->map, value, value->text) >= 0) {
    strut_report_error(reader, value->place,
                       "'%s' names a %s and a text parameter; rename one of them", value->text,
                       names->kind);
    return -1;
  }
  int32_t index = strut_find_literally(reader, names->map, value, text->text);
  if (index >= 0) return index;
  size_t item = reader->diagnostics->count;
  const char *hint = hint_of_names(reader, text, names), *option = "";
  const strut_setting *set =
      strut_parameter_in_scope(reader, strut_scope_of(reader, value), value->text)->set;
  if (set && !set->place.line)
    option = strut_scratch_text(reader, "--set %s=%s: ", value->text,
                                strut_sanitised_text(reader, set->text));
  strut_report_error(reader, text->place, "%sunknown %s '%s' in parameter '%s'%s", option,
                     names->kind, strut_sanitised_text(reader, text->text), value->text,
                     *hint ? hint : strut_list_names(reader, names->name, names->context));
  strut_diagnose_note(reader->diagnostics, item, value->place, "the parameter is used here");
  return -1;
}

int32_t strut_read_name_of(strut_reader *reader, const strut_tree *value, const char *key,
                           strut_owner owner, const strut_namespace *names) {
  const strut_name_map *nodes = &reader->things[STRUT_THING_NODE].names;
  if (!is_scalar(value)) {
    char expected[80];
    snprintf(expected, sizeof expected, "the name of a %s", names->kind);
    strut_read_scalar(reader, value, key, owner, expected);
    return -1;
  }
  strut_tree text;
  if (strut_text_parameter(reader, strut_scope_of(reader, value), value->text, &text))
    return find_named_by_parameter(reader, value, &text, names);
  int32_t index = strut_find_named(reader, names->map, value, value->text);
  const strut_parameter_state *meant =
      index < 0 ? strut_parameter_in_scope(reader, strut_scope_of(reader, value), value->text)
                : NULL;
  if (meant && meant->state == STRUT_FAILED) return -1;
  const char *hiding = index < 0 && names->map == nodes ? strut_hiding_part(reader, value) : NULL;
  if (hiding)
    strut_report_error(reader, value->place,
                       "node '%s' in '%s' of %s is not among the ports of part '%s', which shows "
                       "these only",
                       strut_sanitised_text(reader, value->text), key,
                       strut_owner_text(reader, owner), hiding);
  else if (index < 0)
    strut_report_error(reader, value->place, "unknown %s '%s' in '%s' of %s%s", names->kind,
                       strut_sanitised_text(reader, value->text), key,
                       strut_owner_text(reader, owner), hint_of_names(reader, value, names));
  return index;
}

/* Characters without a look of their own, or that turn text round, from and to; all below U+00A1 but ASCII. */
static const uint32_t INVISIBLE[][2] = {
    {0x80, 0xA0},     {0xAD, 0xAD},         {0x34F, 0x34F},   {0x61C, 0x61C},   {0x115F, 0x1160},
    {0x1680, 0x1680}, {0x17B4, 0x17B5},     {0x180B, 0x180F}, {0x2000, 0x206F}, {0x3000, 0x3000},
    {0x3164, 0x3164}, {0xD800, 0xF8FF},     {0xFE00, 0xFE0F}, {0xFEFF, 0xFEFF}, {0xFFA0, 0xFFA0},
    {0xFFF0, 0xFFFF}, {0xE0000, UINT32_MAX}};

static bool is_visible(uint32_t code) {
  for (size_t i = 0; i < sizeof INVISIBLE / sizeof INVISIBLE[0]; i++)
    if (code >= INVISIBLE[i][0] && code <= INVISIBLE[i][1]) return false;
  return true;
}

/* Bytes of the name's character at `c`; 0: none, or one that a name must not have. */
static size_t name_character(const char *text, size_t left) {
  unsigned char c = (unsigned char)*text;
  uint32_t code = c;
  if (c >= 0x80) {
    size_t size = strut_text_decode(text, left, &code);
    return is_visible(code) ? size : 0;
  }
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_' ||
         c == '-' || c == '.';
}

bool strut_read_name(strut_reader *reader, const strut_tree *key, const char *kind) {
  const char *c = key->text;
  size_t length = strlen(key->text), step;
  while (*c && (step = name_character(c, (size_t)(key->text + length - c))) > 0) c += step;
  strut_tree plain = *key; /* a name that reads as null could not be referred to */
  plain.quoted = false;
  if (length && !*c && length <= LONGEST_NAME && !strut_is_null(&plain)) return true;
  if (length > LONGEST_NAME && !*c)
    strut_report_error(reader, key->place, "the name of a %s may have at most %d bytes, found %zu",
                       kind, (int)LONGEST_NAME, length);
  else
    strut_report_error(
        reader, key->place,
        "'%s' cannot be the name of a %s, expected letters, digits, '_', '-' and '.'",
        strut_sanitised_text(reader, key->text), kind);
  return false;
}

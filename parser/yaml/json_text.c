/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/yaml/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

typedef struct json_reader {
  const char *text;
  size_t length, at; /* bytes */
  uint32_t line;
  size_t seen;          /* bytes before which the code points are counted: */
  uint32_t seen_column; /* the column there, from 1 */
  int depth;
  strut_arena *arena;
  strut_json_error *error;
  strut_status status;
} json_reader;

static strut_tree *read_value(json_reader *r);

/* Places are asked for from left to right, so that all of them together cost one pass. */
static uint32_t column_of(json_reader *r, size_t at) {
  if (at < r->seen) return (uint32_t)strut_text_points(r->text, at) + 1;
  r->seen_column += (uint32_t)strut_text_points(r->text + r->seen, at - r->seen);
  r->seen = at;
  return r->seen_column;
}

__attribute__((format(printf, 3, 4))) static void *refuse(json_reader *r, size_t at,
                                                          const char *format, ...) {
  va_list values;
  if (r->status) return NULL;
  r->status = STRUT_BAD_SCENE;
  r->error->column = column_of(r, at);
  va_start(values, format);
  vsnprintf(r->error->message, sizeof r->error->message, format, values);
  va_end(values);
  return NULL;
}

static void *no_memory(json_reader *r) {
  r->status = STRUT_NO_MEMORY;
  return NULL;
}

static int next_byte(const json_reader *r) {
  return r->at < r->length ? (unsigned char)r->text[r->at] : -1;
}

static void skip_blanks(json_reader *r) {
  while (r->at < r->length && memchr(" \t\r\n", r->text[r->at], 4)) r->at++;
}

/* "'x'" or "the end of the text": what stands at the reader's place. */
static const char *found(const json_reader *r, char text[32]) {
  uint32_t code;
  if (r->at >= r->length) return "the end of the text";
  size_t bytes = strut_text_decode(r->text + r->at, r->length - r->at, &code);
  if (code == STRUT_BAD_CODE) return "a byte that is not UTF-8";
  if (code < ' ' || strut_text_forbidden(code)) return "a control character";
  snprintf(text, 32, "'%.*s'", (int)bytes, r->text + r->at);
  return text;
}

static void *refuse_here(json_reader *r, const char *expected) {
  char text[32];
  return refuse(r, r->at, "expected %s, found %s", expected, found(r, text));
}

static strut_tree *make(json_reader *r, strut_tree_kind kind, size_t at) {
  strut_tree *node = strut_arena_allocate(r->arena, 1, sizeof *node);
  if (!node) return no_memory(r);
  node->place = strut_place_at(r->line, column_of(r, at), 1);
  node->kind = (uint32_t)kind & 3u;
  node->text = "";
  return node;
}

static int hex_digit(int c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* The four digits of \uXXXX; -1 where there are others. */
static long read_unit(json_reader *r) {
  long value = 0;
  if (r->length - r->at < 4) return -1;
  for (int i = 0; i < 4; i++) {
    int digit = hex_digit((unsigned char)r->text[r->at + (size_t)i]);
    if (digit < 0) return -1;
    value = 16 * value + digit;
  }
  r->at += 4;
  return value;
}

static size_t encode(unsigned long code, char *to) {
  if (code < 0x80) {
    to[0] = (char)code;
    return 1;
  }
  int more = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
  static const unsigned first[] = {0, 0xC0, 0xE0, 0xF0};
  to[0] = (char)(first[more] | code >> 6 * more);
  for (int i = 1; i <= more; i++) to[i] = (char)(0x80 | (code >> 6 * (more - i) & 0x3F));
  return (size_t)more + 1;
}

/* What follows \u, two of them for a character beyond U+FFFF. Bytes written to `to`; 0: refused. */
static size_t read_unicode(json_reader *r, size_t begin, char *to) {
  long code = read_unit(r);
  if (code >= 0xD800 && code < 0xDC00 && r->length - r->at >= 6 && r->text[r->at] == '\\' &&
      r->text[r->at + 1] == 'u') {
    r->at += 2;
    long low = read_unit(r);
    code = low >= 0xDC00 && low < 0xE000 ? 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00) : -1;
  }
  if (code > 0 && !(code >= 0xD800 && code < 0xE000)) return encode((unsigned long)code, to);
  refuse(r, begin,
         code == 0 ? "the character U+0000 is not allowed"
                   : "expected \\u and the four hexadecimal digits of a character");
  return 0;
}

/* What follows a backslash. Bytes written to `to`; 0: refused. */
static size_t read_escape(json_reader *r, char *to) {
  static const char names[] = "\"\\/bfnrt", values[] = "\"\\/\b\f\n\r\t";
  size_t begin = r->at++;
  int c = next_byte(r);
  const char *name = c > 0 ? strchr(names, c) : NULL;
  if (c == 'u') {
    r->at++;
    return read_unicode(r, begin, to);
  }
  if (!name) {
    refuse(r, begin, "expected an escape of JSON, such as \\\" or \\n");
    return 0;
  }
  r->at++;
  *to = values[name - names];
  return 1;
}

/* Bytes up to the quote that ends a string, or to the end of the text. */
static size_t span_string(const json_reader *r) {
  size_t end = r->at;
  while (end < r->length && r->text[end] != '"') end += r->text[end] == '\\' ? 2 : 1;
  return (end < r->length ? end : r->length) - r->at;
}

static strut_tree *read_string(json_reader *r) {
  enum { WIDEST = 4 }; /* bytes of a character, which no escape is shorter than */
  size_t begin = r->at++, used = 0;
  strut_tree *node = make(r, STRUT_TREE_SCALAR, begin);
  char *text = node ? strut_arena_allocate(r->arena, span_string(r) + WIDEST + 1, 1) : NULL;
  if (!text) return no_memory(r);
  for (int c; (c = next_byte(r)) != '"';) {
    uint32_t code;
    if (c < 0) return refuse(r, begin, "the text in quotes does not end");
    if (c == '\\') {
      size_t bytes = read_escape(r, text + used);
      if (!bytes) return NULL;
      used += bytes;
      continue;
    }
    size_t bytes = strut_text_decode(r->text + r->at, r->length - r->at, &code);
    if (code == STRUT_BAD_CODE || code < ' ') return refuse_here(r, "a character of a text");
    memcpy(text + used, r->text + r->at, bytes);
    used += bytes;
    r->at += bytes;
  }
  r->at++;
  node->quoted = true;
  node->text = text;
  return node;
}

static size_t span_digits(const json_reader *r, size_t at) {
  size_t end = at;
  while (end < r->length && r->text[end] >= '0' && r->text[end] <= '9') end++;
  return end - at;
}

/* Bytes of the number that begins here, by the grammar of JSON; 0: there is none. */
static size_t span_number(const json_reader *r) {
  size_t at = r->at + (next_byte(r) == '-'), digits = span_digits(r, at);
  if (digits == 0 || (digits > 1 && r->text[at] == '0')) return 0;
  at += digits;
  if (at < r->length && r->text[at] == '.') {
    digits = span_digits(r, at + 1);
    if (digits == 0) return 0;
    at += 1 + digits;
  }
  if (at < r->length && (r->text[at] == 'e' || r->text[at] == 'E')) {
    size_t sign = at + 1 < r->length && (r->text[at + 1] == '+' || r->text[at + 1] == '-');
    digits = span_digits(r, at + 1 + sign);
    if (digits == 0) return 0;
    at += 1 + sign + digits;
  }
  return at - r->at;
}

static size_t span_word(const json_reader *r) {
  static const char *const words[] = {"true", "false", "null"};
  for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
    size_t length = strlen(words[i]);
    if (r->length - r->at >= length && memcmp(r->text + r->at, words[i], length) == 0)
      return length;
  }
  return 0;
}

static strut_tree *read_plain(json_reader *r) {
  size_t length = span_number(r), begin = r->at;
  if (!length) length = span_word(r);
  size_t after = r->at + length;
  bool ends = length && (after == r->length || memchr(" \t\r\n,]}", r->text[after], 7));
  if (!ends) return refuse_here(r, "a value of JSON");
  strut_tree *node = make(r, STRUT_TREE_SCALAR, begin);
  const char *text = node ? strut_arena_text(r->arena, r->text + begin, length) : NULL;
  if (!text) return no_memory(r);
  r->at = after;
  node->text = text;
  node->place.length = (length < STRUT_PLACE_LENGTH_MOST ? length : 1) & STRUT_PLACE_LENGTH_MOST;
  return node;
}

/* Is the comma or the closing bracket here? Refuses anything else. True: another item follows. */
static bool goes_on(json_reader *r, char closing, const char *expected) {
  skip_blanks(r);
  int c = next_byte(r);
  if (c != ',' && c != closing) {
    refuse_here(r, expected);
    return false;
  }
  r->at++;
  return c == ',';
}

static strut_tree *read_list(json_reader *r) {
  strut_tree *list = make(r, STRUT_TREE_LIST, r->at++), **end = list ? &list->first : NULL;
  skip_blanks(r);
  if (list && next_byte(r) == ']') {
    r->at++;
    return list;
  }
  while (!r->status) {
    strut_tree *item = read_value(r);
    if (!item) break;
    *end = item;
    end = &item->next;
    list->count = (list->count + 1) & STRUT_TREE_COUNT_MASK;
    if (!goes_on(r, ']', "',' or ']'")) break;
  }
  return r->status ? NULL : list;
}

/* Mappings have few keys: the names of parameters. */
static bool is_twice(const strut_tree *map, const strut_tree *key) {
  const strut_tree *other = map->first;
  while (other && strcmp(other->text, key->text) != 0) other = other->next->next;
  return other != NULL;
}

static strut_tree *read_key(json_reader *r, const strut_tree *map) {
  enum { MOST_KEYS = 10000 };
  skip_blanks(r);
  if (next_byte(r) != '"') return refuse_here(r, "a name in double quotes");
  if (map->count == MOST_KEYS)
    return refuse(r, r->at, "more than %d names in a mapping", MOST_KEYS);
  size_t begin = r->at;
  strut_tree *key = read_string(r);
  if (key && is_twice(map, key)) return refuse(r, begin, "'%.80s' is given twice", key->text);
  return key;
}

static strut_tree *read_map(json_reader *r) {
  strut_tree *map = make(r, STRUT_TREE_MAP, r->at++), **end = map ? &map->first : NULL;
  skip_blanks(r);
  if (map && next_byte(r) == '}') {
    r->at++;
    return map;
  }
  while (!r->status) {
    strut_tree *key = read_key(r, map);
    skip_blanks(r);
    if (key && next_byte(r) != ':') refuse_here(r, "':'");
    if (r->status) break;
    r->at++;
    key->next = read_value(r);
    if (!key->next) break;
    *end = key;
    end = &key->next->next;
    map->count = (map->count + 1) & STRUT_TREE_COUNT_MASK;
    if (!goes_on(r, '}', "',' or '}'")) break;
  }
  return r->status ? NULL : map;
}

static strut_tree *read_value(json_reader *r) {
  strut_tree *value;
  skip_blanks(r);
  int c = next_byte(r);
  if ((c == '{' || c == '[') && r->depth == STRUT_JSON_DEEPEST)
    return refuse(r, r->at, "more than %d mappings and lists within each other",
                  STRUT_JSON_DEEPEST);
  r->depth++;
  if (c == '{')
    value = read_map(r);
  else if (c == '[')
    value = read_list(r);
  else
    value = c == '"' ? read_string(r) : read_plain(r);
  r->depth--;
  return value;
}

strut_status strut_json_text_read(const char *text, size_t length, uint32_t line,
                                  strut_arena *arena, strut_tree **root, strut_json_error *error) {
  json_reader r = {.text = text,
                   .length = length,
                   .line = line,
                   .seen_column = 1,
                   .arena = arena,
                   .error = error};
  *error = (strut_json_error){0};
  *root = read_value(&r);
  if (!r.status) skip_blanks(&r);
  if (!r.status && r.at < length) refuse_here(&r, "the end of the text");
  if (r.status) *root = NULL;
  return r.status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/language/yaml/text.h"

#include <stdint.h>
#include <string.h>

#include "engine/base/name_map.h"
#include "parser/language/yaml/document_parts.h"

static bool continues(unsigned char byte) { return (byte & 0xC0) == 0x80; }

size_t strut_text_decode(const char *text, size_t left, uint32_t *code) {
  const unsigned char *b = (const unsigned char *)text;
  if (b[0] < 0x80) {
    *code = b[0];
    return 1;
  }
  size_t size = b[0] >= 0xF0 ? 4 : b[0] >= 0xE0 ? 3 : 2;
  static const uint32_t least[5] = {0, 0, 0x80, 0x800, 0x10000};
  *code = STRUT_BAD_CODE;
  if (b[0] < 0xC2 || b[0] > 0xF4 || left < size) return 1;
  uint32_t value = b[0] & (0x7Fu >> size);
  for (size_t i = 1; i < size; i++) {
    if (!continues(b[i])) return 1;
    value = value << 6 | (b[i] & 0x3Fu);
  }
  if (value < least[size] || value > 0x10FFFF || (value >= 0xD800 && value <= 0xDFFF)) return 1;
  *code = value;
  return size;
}

size_t strut_text_break(const char *text, size_t left) {
  const unsigned char *b = (const unsigned char *)text;
  if (!left) return 0;
  if (b[0] == '\n') return 1;
  if (b[0] == '\r') return left > 1 && b[1] == '\n' ? 2 : 1;
  if (b[0] == 0xC2) return left > 1 && b[1] == 0x85 ? 2 : 0;
  if (b[0] == 0xE2) return left > 2 && b[1] == 0x80 && (b[2] == 0xA8 || b[2] == 0xA9) ? 3 : 0;
  return 0;
}

size_t strut_text_points(const char *text, size_t length) {
  size_t points = 0;
  uint32_t code;
  for (size_t at = 0; at < length; points++) at += strut_text_decode(text + at, length - at, &code);
  return points;
}

/* Bytes of text, at most `most`, that end where a character ends. */
static int cut_text(const char *text, int most) {
  int length = (int)strnlen(text, (size_t)most + 1);
  if (length <= most) return length;
  for (length = most; length && continues((unsigned char)text[length]); length--) continue;
  return length;
}

size_t strut_text_mark(const char *text, size_t length) {
  return length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
}

const char *strut_text_wide(const char *text, size_t length) {
  if (length >= 4 && (memcmp(text, "\xFF\xFE\0", 4) == 0 || memcmp(text, "\0\0\xFE\xFF", 4) == 0))
    return "UTF-32";
  bool wide = length >= 2 && (memcmp(text, "\xFF\xFE", 2) == 0 || memcmp(text, "\xFE\xFF", 2) == 0);
  return wide ? "UTF-16" : NULL;
}

bool strut_text_forbidden(uint32_t code) {
  if (code < 0x20) return code != '\t' && code != '\n' && code != '\r';
  if (code < 0x7F) return false;
  return (code < 0xA0 && code != 0x85) || code == 0xFEFF || code == 0xFFFE || code == 0xFFFF ||
         code > 0x10FFFF;
}

bool strut_text_hidden(uint32_t code) {
  return (code >= 0x80 && code < 0xA0) || code == 0x61C || code == 0x180E || code == 0x200B ||
         code == 0x200E || code == 0x200F || (code >= 0x2028 && code <= 0x202E) ||
         (code >= 0x2060 && code <= 0x206F) || code == 0xFEFF ||
         (code >= 0xFFF9 && code <= 0xFFFB) || (code >= 0xE0000 && code <= 0xE0FFF);
}

strut_cursor strut_cursor_begin(const char *text, size_t length) {
  return (strut_cursor){.text = text,
                        .length = length,
                        .offset = strut_text_mark(text, length),
                        .line = 1,
                        .column = 1};
}

bool strut_cursor_step(strut_cursor *cursor) {
  if (cursor->offset >= cursor->length) return false;
  const char *here = cursor->text + cursor->offset;
  size_t left = cursor->length - cursor->offset, size = strut_text_break(here, left);
  if (size) {
    cursor->index += *here == '\r' ? size : 1; /* CR LF is two code points, the others are one */
    cursor->line++;
    cursor->column = 1;
  } else {
    uint32_t code;
    size = strut_text_decode(here, left, &code);
    cursor->index++;
    cursor->column++;
  }
  cursor->offset += size;
  return true;
}

void strut_cursor_to_offset(strut_cursor *cursor, size_t offset) {
  while (cursor->offset < offset && strut_cursor_step(cursor)) continue;
}

/* Steps over printable ASCII up to an index, as most of a text is. */
static void step_over_ascii(strut_cursor *cursor, size_t index) {
  size_t most = index - cursor->index, left = cursor->length - cursor->offset, steps = 0;
  const char *here = cursor->text + cursor->offset;
  if (most > left) most = left;
  while (steps < most && here[steps] >= ' ' && here[steps] < 0x7F) steps++;
  cursor->offset += steps;
  cursor->index += steps;
  cursor->column += (uint32_t)steps;
}

void strut_cursor_to_index(strut_cursor *cursor, size_t index) {
  do
    if (cursor->index < index) step_over_ascii(cursor, index);
  while (cursor->index < index && strut_cursor_step(cursor));
}

void strut_cursor_to_line(strut_cursor *cursor, uint32_t line) {
  while (cursor->line < line && strut_cursor_step(cursor)) continue;
}

/* ---- what is wrong with a text before it is a tree: characters, directives, and syntax in plain words ---- */

/* Most forbidden characters that are reported. */
enum { REPORT_MOST = 10 };

static strut_place place_of(const strut_cursor *cursor) {
  return strut_place_at(cursor->line, cursor->column, 1);
}

/* Byte offset of the first character at or after `at` that is not allowed, or the length. */
static size_t find_forbidden(const char *text, size_t length, size_t at, uint32_t *code) {
  while (at < length) {
    unsigned char byte = (unsigned char)text[at];
    if (byte >= 0x20 && byte < 0x7F) {
      at++;
      continue;
    }
    size_t size = strut_text_decode(text + at, length - at, code);
    if (*code == STRUT_BAD_CODE || strut_text_forbidden(*code)) return at;
    at += size;
  }
  return length;
}

/* Reports one character; false if the following ones would be reported likewise. */
static bool report_character(strut_diagnostics *diagnostics, const strut_cursor *cursor,
                             uint32_t code) {
  unsigned byte = (unsigned char)cursor->text[cursor->offset];
  if (code == STRUT_BAD_CODE) {
    strut_diagnose(diagnostics, place_of(cursor),
                   "byte 0x%02X is not valid UTF-8; save the file as UTF-8", byte);
    return false;
  }
  if (code == 0)
    strut_diagnose(diagnostics, place_of(cursor), "a NUL byte is not allowed");
  else if (code == 0xFEFF)
    strut_diagnose(diagnostics, place_of(cursor),
                   "a byte order mark is allowed only at the beginning of the file");
  else
    strut_diagnose(diagnostics, place_of(cursor), "control character U+%04X is not allowed",
                   (unsigned)code);
  return true;
}

static bool scan_characters(strut_diagnostics *diagnostics) {
  const char *text = diagnostics->text;
  size_t length = diagnostics->length, at = strut_text_mark(text, length);
  strut_cursor cursor = strut_cursor_begin(text, length);
  uint32_t code = 0;
  int reported = 0;
  while ((at = find_forbidden(text, length, at, &code)) < length && reported < REPORT_MOST) {
    strut_cursor_to_offset(&cursor, at);
    reported++;
    if (!report_character(diagnostics, &cursor, code)) break;
    at += strut_text_decode(text + at, length - at, &code);
  }
  return reported == 0;
}

/*
 * Directives stand before the document: libyaml is quadratic in their number, and one %YAML is all that anybody needs.
 */
static bool scan_directives(strut_diagnostics *diagnostics) {
  strut_cursor cursor = strut_cursor_begin(diagnostics->text, diagnostics->length);
  bool seen = false;
  while (cursor.offset < cursor.length) {
    const char *line = cursor.text + cursor.offset;
    size_t left = cursor.length - cursor.offset;
    size_t blanks = 0;
    while (blanks < left && (line[blanks] == ' ' || line[blanks] == '\t')) blanks++;
    bool nothing =
        blanks == left || line[blanks] == '#' || strut_text_break(line + blanks, left - blanks);
    if (*line == '%') {
      bool version = left > 6 && memcmp(line, "%YAML ", 6) == 0;
      if (!version || seen) {
        strut_diagnose(
            diagnostics, place_of(&cursor),
            version ? "a second %%YAML line" : "directives such as %%TAG are not allowed");
        return false;
      }
      seen = true;
    } else if (!nothing) {
      return true;
    }
    strut_cursor_to_line(&cursor, cursor.line + 1);
  }
  return true;
}

bool strut_document_scan(strut_diagnostics *diagnostics) {
  const char *text = diagnostics->text;
  size_t length = diagnostics->length;
  if (length > STRUT_TEXT_MOST) {
    strut_diagnose(diagnostics, (strut_place){0}, "the text has %zu MiB, at most %zu are read",
                   length >> 20, STRUT_TEXT_MOST >> 20);
    return false;
  }
  const char *wide = strut_text_wide(text, length);
  if (wide) strut_diagnose(diagnostics, (strut_place){0}, "the file is %s; save it as UTF-8", wide);
  return !wide && scan_characters(diagnostics) && scan_directives(diagnostics);
}

/* libyaml's problem and context, and the message that replaces them. */
static const struct rule {
  const char *problem, *context; /* stretches of libyaml's words; NULL: any */
  const char *message;
  const char *begun; /* what began in the context's line, appended; or NULL */
  bool at_context;   /* the place is where the context begins */
  bool is_key;       /* the place is that of a key without a value */
  bool at_margin; /* holds only at the beginning of a line; elsewhere a value is followed by text */
} rules[] = {
    {"mapping values are not allowed",
     .message = "unexpected ':'; a key begins a new line, and a text that holds ': ' needs quotes"},
    {"tab character", .message = "a tab is not allowed as indentation; use spaces"},
    {"end of stream", "quoted scalar", .message = "this quote is never closed", .at_context = true},
    {"document indicator", "quoted scalar",
     .message = "this quote is not closed before the document ends", .at_context = true},
    {"expected ',' or ']'", .message = "expected ',' or ']'", .begun = "the list that begins"},
    {"expected ',' or '}'", .message = "expected ',' or '}'", .begun = "the mapping that begins"},
    {"could not find expected ':'", .message = "expected ':' and a value after this key",
     .at_context = true, .is_key = true},
    {"expected key", .message = "expected a key at the same indentation as the other keys",
     .begun = "the mapping that begins", .at_margin = true},
    {"expected '-' indicator",
     .message = "expected '- ' at the same indentation as the other items",
     .begun = "the list that begins", .at_margin = true},
    {"block sequence entries are not allowed",
     .message = "a '- ' item is not allowed here; begin it on a new line, or write [a, b]"},
    {"mapping keys are not allowed", .message = "a '? ' key is not allowed here"},
    {"expected node content", .message = "a value is missing here"},
    {"unknown escape character",
     .message = "unknown escape; in double quotes a backslash is written '\\\\'"},
    {"hexdecimal number", "quoted scalar", .message = "an escape lacks hexadecimal digits"},
    {"invalid Unicode", .message = "the escape is not a character of Unicode"},
    {"alphabetic or numeric character", "anchor",
     .message = "expected a name after '&'; a text that begins with '&' needs quotes"},
    {"alphabetic or numeric character", "alias",
     .message = "expected a name after '*'; a text that begins with '*' needs quotes"},
    {"undefined tag handle", .message = "tags (words that begin with '!') are not allowed"},
    {.context = "a tag", .message = "tags (words that begin with '!') are not allowed"},
    {"incompatible YAML document", .message = "only YAML 1.1 and 1.2 can be read"},
    {.context = "directive", .message = "expected '%YAML 1.2'"},
    {"<document start>", .message = "expected '---' after a %YAML line"},
    {.context = "block scalar", .message = "expected '|' or '>' and then a new line"},
};

static bool has(const char *text, const char *part) {
  return !part || (text && strstr(text, part));
}

static strut_place place_at(const strut_diagnostics *diagnostics, yaml_mark_t mark, char *here) {
  strut_cursor cursor = strut_cursor_begin(diagnostics->text, diagnostics->length);
  strut_cursor_to_index(&cursor, mark.index);
  *here = cursor.offset < cursor.length ? cursor.text[cursor.offset] : '\0';
  return strut_place_at((uint32_t)mark.line + 1, (uint32_t)mark.column + 1, 1);
}

/* "found character that cannot start any token" */
static void report_start(strut_diagnostics *diagnostics, strut_place place, char here) {
  if (here == '\t')
    strut_diagnose(diagnostics, place, "a tab is not allowed as indentation; use spaces");
  else
    strut_diagnose(diagnostics, place, "a value cannot begin with '%c'; put it in quotes", here);
}

/* True if the line has anything but blanks before the place. */
static bool behind_something(const strut_diagnostics *diagnostics, strut_place place) {
  strut_cursor cursor = strut_cursor_begin(diagnostics->text, diagnostics->length);
  strut_cursor_to_line(&cursor, place.line);
  while (cursor.line == place.line && cursor.column < place.column) {
    char c = cursor.offset < cursor.length ? cursor.text[cursor.offset] : ' ';
    if (c != ' ' && c != '\t') return true;
    if (!strut_cursor_step(&cursor)) break;
  }
  return false;
}

/* Is the word at the place followed by a colon without a space after it, as in `mass:1 kg`? */
static bool lacks_space(const strut_diagnostics *diagnostics, strut_place place) {
  strut_cursor cursor = strut_cursor_begin(diagnostics->text, diagnostics->length);
  strut_cursor_to_line(&cursor, place.line);
  while (cursor.column < place.column && strut_cursor_step(&cursor)) continue;
  const char *text = cursor.text + cursor.offset, *end = diagnostics->text + diagnostics->length;
  while (text < end && *text && !strchr(": \t\r\n", *text)) text++;
  return text + 1 < end && text[0] == ':' && !strchr(" \t\r\n", text[1]);
}

bool strut_document_syntax_error(const yaml_parser_t *parser, const strut_tree *open,
                                 strut_diagnostics *diagnostics) {
  if (parser->error == YAML_MEMORY_ERROR) return false;
  char here;
  strut_place place = place_at(diagnostics, parser->problem_mark, &here);
  if (has(parser->problem, "cannot start any token")) {
    report_start(diagnostics, place, here);
    return true;
  }
  if (here == '\0' && open && !has(parser->context, "quoted scalar")) {
    /* At the end of the text the open bracket is reported, at its place. */
    strut_diagnose(diagnostics, open->place, "this '%c' is never closed",
                   open->kind == STRUT_TREE_LIST ? '[' : '{');
    return true;
  }
  for (size_t i = 0; i < sizeof rules / sizeof rules[0]; i++) {
    const struct rule *rule = &rules[i];
    if (!has(parser->problem, rule->problem) || !has(parser->context, rule->context)) continue;
    if (rule->at_context) place = place_at(diagnostics, parser->context_mark, &here);
    if (rule->is_key && lacks_space(diagnostics, place)) {
      strut_diagnose(diagnostics, place, "this key needs a space after its colon");
      return true;
    }
    if (rule->at_margin && behind_something(diagnostics, place))
      strut_diagnose(diagnostics, place, "unexpected text after a value");
    else if (rule->begun)
      strut_diagnose(diagnostics, place, "%s (%s in line %zu)", rule->message, rule->begun,
                     parser->context_mark.line + 1);
    else
      strut_diagnose(diagnostics, place, "%s", rule->message);
    return true;
  }
  strut_diagnose(diagnostics, place, "not valid YAML: %s%s%s",
                 parser->problem ? parser->problem : "unknown trouble", parser->context ? " " : "",
                 parser->context ? parser->context : "");
  return true;
}

/* The keys of a mapping: none twice, none empty. */

/* Mappings of few keys are searched from end to end, and longest stretch of a key that a message repeats, in bytes. */
enum { FEW_KEYS = 8, SHOWN_MOST = 64 };

/* The line of an earlier key of that text; 0: there is none. */
static uint32_t find_among_few(const strut_tree *map, const strut_tree *key) {
  const strut_tree *other = map->first;
  while (other != key && strcmp(other->text, key->text) != 0) other = other->next->next;
  return other == key ? 0 : other->place.line;
}

static bool refuse_key(const strut_tree *key, uint32_t earlier, strut_diagnostics *diagnostics) {
  bool plain = !key->quoted;
  if (plain && key->text[0] == '\0')
    strut_diagnose(diagnostics, key->place, "a key is missing before this ':'");
  else if (plain && strcmp(key->text, "<<") == 0)
    strut_diagnose(diagnostics, key->place,
                   "'<<' is not allowed; use groups to share keys between things");
  else if (earlier)
    strut_diagnose(diagnostics, key->place, "duplicate key '%.*s'; the first one is in line %u",
                   cut_text(key->text, SHOWN_MOST), key->text, earlier);
  else
    return false;
  return true;
}

bool strut_document_check_keys(strut_tree *map, strut_diagnostics *diagnostics) {
  bool few = map->count <= FEW_KEYS;
  strut_name_map lines = {0};
  bool fine = few || strut_name_map_reserve(&lines, map->count);
  strut_tree **link = &map->first;
  while (*link && fine) {
    strut_tree *key = *link;
    int32_t added =
        few ? 0 : strut_name_map_add(&lines, key->text, (int32_t)(key->place.line & INT32_MAX));
    uint32_t earlier = few ? find_among_few(map, key) : added > 0 ? (uint32_t)added : 0;
    fine = added != -2;
    if (refuse_key(key, earlier, diagnostics)) {
      *link = key->next->next;
      map->count--;
    } else {
      link = &key->next->next;
    }
  }
  strut_name_map_free(&lines);
  return fine;
}

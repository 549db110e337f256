/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions of the engine's own laws, from their headers into the exported code. */
#include "engine/output/code/writer.h"

#include <assert.h>
#include <ctype.h>
#include <string.h>

#include "engine/output/code/code.h"

/* A function or a type of a law's header, with the comment before it. */
typedef struct definition {
  const char *text, *end;
  const char *name;
  size_t length;
  bool type;
} definition;

static bool is_letter(char c) { return isalnum((unsigned char)c) || c == '_'; }

static size_t identifier_length(const char *text) {
  size_t length = 0;
  while (is_letter(text[length])) length++;
  return length;
}

static bool is(const char *text, size_t length, const char *word) {
  return strlen(word) == length && !memcmp(text, word, length);
}

/* An identifier as the exported code has it: strut_ and LAW( ) are left out. */
static const char *bare(const char *text, size_t *length) {
  static const char prefix[] = "strut_";
  size_t skip = sizeof prefix - 1;
  if (*length <= skip || memcmp(text, prefix, skip)) return text;
  *length -= skip;
  return text + skip;
}

/* The next identifier from `text` on; the place behind it, NULL: there is none before `end`. */
static const char *next_identifier(const char *text, const char *end, const char **name,
                                   size_t *length) {
  while (text < end) {
    if (!strncmp(text, "/*", 2)) {
      text = strstr(text, "*/") + 2;
    } else if (isdigit((unsigned char)*text)) {
      while (is_letter(*text) || *text == '.') text++;
    } else if (is_letter(*text)) {
      *length = identifier_length(text);
      const char *behind = text + *length;
      *name = bare(text, length);
      return behind;
    } else {
      text++;
    }
  }
  return NULL;
}

static bool begins_function(const char *line) {
  return !strncmp(line, "LAW_INLINE", 10) || !strncmp(line, "static inline", 13);
}

/* The name that a definition gives: the last identifier of a type, or the one before the arguments. */
static bool find_name(definition *d) {
  const char *at = d->text, *name = NULL, *body = NULL;
  size_t length = 0;
  bool type = false;
  d->type = false;
  for (const char *line = d->text; line < d->end; line = strchr(line, '\n') + 1) {
    if (*line == '#') return false; /* rows of a table: not for other programs */
    type = type || !strncmp(line, "typedef struct", 14);
    if (!body && begins_function(line)) body = line;
  }
  if (!body && !type) return false;
  if (body) at = body;
  while ((at = next_identifier(at, d->end, &name, &length)) != NULL) {
    bool wrapped = is(name, length, "LAW") || is(name, length, "LAW_INLINE");
    if (wrapped || is(name, length, "const")) continue;
    d->name = name, d->length = length;
    const char *open = *at == ')' ? at + 1 : at;
    if (!type && *open == '(') return true;
  }
  d->type = type;
  return type;
}

/* The definition that ends with the next line that begins with a brace; false: there is none. */
static bool next_definition(const char **text, definition *d) {
  const char *begin = *text;
  for (const char *line = begin; *line; line = strchr(line, '\n') + 1) {
    const char *behind = strchr(line, '\n') + 1;
    bool blank = *line == '\n', ends = *line == '}';
    bool one_line = begins_function(line) && behind - line > 4 && !strncmp(behind - 4, "; }", 3);
    if (ends || one_line) {
      *d = (definition){.text = begin, .end = behind};
      *text = behind;
      return true;
    }
    if (blank || *line == '#') begin = behind;
  }
  return false;
}

/* The definition of a name in the headers of the laws, and its number among all of them. */
static bool find_definition(const char *name, size_t length, definition *found, int *number) {
  int count = 0;
  for (const strut_embedded *file = strut_code_law_texts; file->text; file++) {
    const char *text = file->text;
    while (next_definition(&text, found)) {
      count++;
      if (!find_name(found) || found->length != length || memcmp(found->name, name, length))
        continue;
      *number = count;
      return true;
    }
  }
  return false;
}

/* The value of a constant STRUT_NAME of the headers. */
static bool find_constant(const char *name, size_t length, const char **value) {
  for (const strut_embedded *file = strut_code_law_texts; file->text; file++)
    for (const char *line = file->text; (line = strstr(line, "#define ")) != NULL;) {
      line += 8;
      size_t own = identifier_length(line);
      if (own != length || memcmp(line, name, length) || line[own] != ' ') continue;
      *value = line + own + 1;
      return true;
    }
  return false;
}

/* A number of a formula: of `real` where it has a point. */
static const char *add_number(strut_code_writer *w, const char *text) {
  size_t length = 0;
  while (is_letter(text[length]) || text[length] == '.' ||
         (length && (text[length] == '-' || text[length] == '+') && text[length - 1] == 'e'))
    length++;
  bool point = memchr(text, '.', length) || memchr(text, 'e', length);
  strut_buffer_add(&w->text, "%.*s%s", (int)length, text, point && w->options->single ? "f" : "");
  return text + length;
}

/* The name of a definition that the texts call strut_law_NAME, as those for doubles are called. */
static const char *definition_name(const char *text, size_t *length) {
  definition d;
  int number;
  size_t skip = 4;
  bool prefixed = *length > skip && !memcmp(text, "law_", skip);
  if (!prefixed || find_definition(text, *length, &d, &number)) return text;
  if (!find_definition(text + skip, *length - skip, &d, &number)) return text;
  *length -= skip;
  return text + skip;
}

static void add_identifier(strut_code_writer *w, const char *text, size_t length) {
  static const char *const pairs[][2] = {
      {"LAW_INLINE", "static"}, {"double", "real"},      {"bool", "int"},
      {"false", "0"},           {"true", "1"},           {"sqrt", "root"},
      {"fabs", "magnitude"},    {"log1p", "real_log1p"}, {"expm1", "real_expm1"},
      {"exp", "real_exp"},      {"log", "real_log"},     {"uint32_t", "index_type"}};
  const char *value;
  for (size_t k = 0; k < sizeof pairs / sizeof pairs[0]; k++)
    if (is(text, length, pairs[k][0])) {
      strut_buffer_add(&w->text, "%s", pairs[k][1]);
      return;
    }
  if (!strncmp(text, "STRUT_", 6) && find_constant(text, length, &value)) {
    add_number(w, value);
    return;
  }
  text = bare(text, &length);
  text = definition_name(text, &length);
  strut_buffer_add(&w->text, "%.*s", (int)length, text);
}

static void add_text(strut_code_writer *w, const char *text, const char *end) {
  int wrapped = 0; /* parentheses of LAW( that are open */
  while (text < end) {
    size_t length = identifier_length(text);
    if (!strncmp(text, "/*", 2)) {
      const char *behind = strstr(text, "*/") + 2;
      strut_buffer_add(&w->text, "%.*s", (int)(behind - text), text);
      text = behind;
    } else if (!strncmp(text, "static inline", 13)) {
      strut_buffer_add(&w->text, "static");
      text += 13;
    } else if (!strncmp(text, "LAW(", 4)) {
      wrapped++;
      text += 4;
    } else if (isdigit((unsigned char)*text)) {
      text = add_number(w, text);
    } else if (length) {
      add_identifier(w, text, length);
      text += length;
    } else if (*text == ')' && wrapped) {
      wrapped--;
      text++;
    } else {
      strut_buffer_add(&w->text, "%c", *text++);
    }
  }
  strut_buffer_add(&w->text, "\n");
}

static void add_definition(strut_code_writer *w, const char *name, size_t length) {
  definition d, other;
  int number, of_other;
  if (!find_definition(name, length, &d, &number)) return;
  assert(number < STRUT_CODE_MOST_LAW_TEXTS);
  if (w->law_texts[number]) return;
  w->law_texts[number] = true;
  size_t own;
  for (const char *at = d.text; (at = next_identifier(at, d.end, &name, &own)) != NULL;) {
    bool called = *at == '(' || (*at == ')' && at[1] == '(');
    name = definition_name(name, &own);
    if (find_definition(name, own, &other, &of_other) && (called || other.type))
      add_definition(w, name, own);
  }
  add_text(w, d.text, d.end);
}

void strut_code_add_law(strut_code_writer *w, const char *name) {
  add_definition(w, name, strlen(name));
}

bool strut_code_knows_law(const char *name) {
  definition d;
  int number;
  return find_definition(name, strlen(name), &d, &number);
}

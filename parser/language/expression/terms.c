/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Number literals, correctly rounded in any locale, and the units behind them; columns of the motion, and programs. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/text.h"
#include "parser/language/expression/expression_parts.h"

enum { EXPONENT_MOST = 99999 };

/* A literal taken apart: mantissa * 10^exponent. */
typedef struct literal {
  size_t mantissa_length; /* bytes before the 'e' */
  bool zero;
  long exponent; /* the written one, cut to +-EXPONENT_MOST */
} literal;

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

static size_t read_digits(const char *text, size_t at, size_t left, literal *parts) {
  for (; at < left && is_digit(text[at]); at++) {
    if (text[at] != '0') parts->zero = false;
  }
  return at;
}

/* Bytes of the exponent that begins at text[at]: 0 where no complete one does. */
static size_t read_exponent(const char *text, size_t at, size_t left, literal *parts) {
  size_t begin = at;
  if (at >= left || (text[at] != 'e' && text[at] != 'E')) return 0;
  at++;
  bool negative = at < left && text[at] == '-';
  if (at < left && (text[at] == '-' || text[at] == '+')) at++;
  if (at >= left || !is_digit(text[at])) return 0;
  long exponent = 0;
  for (; at < left && is_digit(text[at]); at++) {
    exponent = exponent * 10 + (text[at] - '0');
    if (exponent > EXPONENT_MOST) exponent = EXPONENT_MOST;
  }
  parts->exponent = negative ? -exponent : exponent;
  return at - begin;
}

static size_t take_apart(const char *text, size_t left, literal *parts) {
  *parts = (literal){.zero = true};
  size_t whole = read_digits(text, 0, left, parts), at = whole;
  if (at + 1 < left && text[at] == '.' && is_digit(text[at + 1])) {
    at = read_digits(text, at + 1, left, parts);
  }
  if (!at) return 0;
  parts->mantissa_length = at;
  return at + read_exponent(text, at, left, parts);
}

size_t strut_number_scan(const char *text, size_t left) {
  literal parts;
  return take_apart(text, left, &parts);
}

static bool read_value(const char *text, const literal *parts, long exponent, double *value) {
  char buffer[STRUT_NUMBER_MOST + 32], *end;
  memcpy(buffer, text, parts->mantissa_length);
  int tail = 0;
  buffer[parts->mantissa_length] = '\0';
  if (exponent) tail = snprintf(buffer + parts->mantissa_length, 32, "e%ld", exponent);
  strut_c_locale locale = strut_c_locale_enter();
  *value = strtod(buffer, &end);
  strut_c_locale_leave(locale);
  /* Under a foreign locale (memory was out) strtod stops at the point: refuse, never guess. */
  return tail >= 0 && end == buffer + parts->mantissa_length + tail;
}

bool strut_number_read_scaled(const char *text, size_t length, int decimal, double *value) {
  literal parts;
  if (!length || length > STRUT_NUMBER_MOST || take_apart(text, length, &parts) != length)
    return false;
  *value = 0;
  if (parts.zero) return true;
  return read_value(text, &parts, parts.exponent + decimal, value) && isfinite(*value) &&
         *value != 0;
}

enum { UNIT_POWER_MOST = 12 };

/* The unit so far: up / down * 10^decimal. */
typedef struct unit_product {
  int decimal;
  double up, down;
  strut_dimension dimension;
  bool bare; /* nothing but percent */
} unit_product;

static void multiply(unit_product *product, const strut_unit *unit, int power) {
  float times = (float)power;
  product->decimal += unit->decimal * power;
  for (int i = 0; i < power; i++) product->up *= unit->rest;
  for (int i = 0; i > power; i--) product->down *= unit->rest;
  product->dimension.kg += times * unit->dimension.kg;
  product->dimension.m += times * unit->dimension.m;
  product->dimension.s += times * unit->dimension.s;
  product->dimension.angle += times * unit->dimension.angle;
  if (!strut_dimension_equal(unit->dimension, STRUT_DIM_NONE)) product->bare = false;
}

/* An optional ^ and whole number behind a unit. */
static bool read_power(strut_expression_reader *reader, int *power) {
  *power = 1;
  size_t resume = reader->at;
  if (strut_expression_peek(reader) != '^') {
    reader->at = resume;
    return true;
  }
  reader->at++;
  char c = strut_expression_peek(reader);
  size_t begin = reader->at;
  if (c == '-' || c == '+') reader->at++;
  const char *text = reader->text + reader->at;
  size_t digits = strspn(text, "0123456789");
  long value = digits ? strtol(text, NULL, 10) : 0;
  reader->at += digits;
  bool longer = text[digits] == '.' || strut_expression_word(reader, reader->at);
  if (!digits || longer || value > UNIT_POWER_MOST)
    return strut_expression_fail(reader, begin, reader->at + longer,
                                 "the power of a unit is a whole number such as 2");
  *power = (int)(c == '-' ? -value : value);
  return true;
}

static const strut_unit *unit_here(const strut_expression_reader *reader, size_t *length) {
  *length = strut_expression_word(reader, reader->at);
  if (!*length && reader->at < reader->length && reader->text[reader->at] == '%') *length = 1;
  return *length ? strut_unit_find(reader->text + reader->at, *length) : NULL;
}

/* True where the word of that length at `at` is a function with its parenthesis: min( is no unit. */
static bool is_call(const strut_expression_reader *reader, size_t length) {
  strut_expression_reader ahead = *reader;
  ahead.at += length;
  return strut_expression_peek(&ahead) == '(';
}

/*
 * Whether one more unit follows: 1 or -1 with r at its word (behind * or /), 0 with r unmoved. A
 * word that a parameter has too is refused: both readings would be sensible. 2: refused.
 */
static int read_joint(strut_expression_reader *reader, size_t *length) {
  size_t resume = reader->at;
  char c = strut_expression_peek(reader);
  bool operation = c == '*' || c == '/';
  if (operation) {
    reader->at++;
    strut_expression_peek(reader);
  }
  const strut_unit *unit =
      strut_expression_word(reader, reader->at) ? unit_here(reader, length) : NULL;
  if (!unit || is_call(reader, *length)) {
    reader->at = resume;
    return 0;
  }
  strut_quantity ignored;
  bool asks = operation && reader->compiler && reader->compiler->claims;
  strut_piece word = {reader->text + reader->at, *length};
  int claimed = asks ? reader->compiler->claims(reader->compiler->context, word) : 0;
  if (claimed > 0) {
    reader->at = resume;
    return 0;
  }
  if (claimed < 0) {
    strut_expression_fail(reader, reader->at, reader->at + *length,
                          "'%.*s' is a unit and a sensor; rename the sensor, or write '%c (%.*s)' "
                          "for it",
                          (int)*length, reader->text + reader->at, c, (int)*length,
                          reader->text + reader->at);
    return 2;
  }
  if (operation &&
      strut_expression_lookup(reader, reader->text + reader->at, *length, &ignored) != 0) {
    strut_expression_fail(reader, reader->at, reader->at + *length,
                          "'%.*s' is a unit and a parameter; rename the parameter, or write "
                          "'%c (%.*s)' for it",
                          (int)*length, reader->text + reader->at, c, (int)*length,
                          reader->text + reader->at);
    reader->error->parameter = (strut_piece){reader->text + reader->at, *length};
    return 2;
  }
  return c == '/' ? -1 : 1;
}

static bool read_unit(strut_expression_reader *reader, unit_product *product) {
  size_t length;
  const strut_unit *unit = unit_here(reader, &length);
  if (!unit) return strut_expression_unknown_unit(reader, reader->at, length);
  for (int sign = 1;; unit = strut_unit_find(reader->text + reader->at, length)) {
    int power;
    reader->at += length;
    if (!read_power(reader, &power)) return false;
    multiply(product, unit, sign * power);
    sign = read_joint(reader, &length);
    if (sign == 2) return false;
    if (sign == 0) return true;
  }
}

/* Reports characters right after a literal that make it look like another kind of number. */
static bool check_end(strut_expression_reader *reader, size_t begin) {
  char c = reader->at < reader->length ? reader->text[reader->at] : '\0';
  size_t word = strut_expression_word(reader, reader->at), end = reader->at + (word ? word : 1);
  if (c == '.')
    return strut_expression_fail(reader, begin, end,
                                 "a number has one decimal point and digits after it");
  if (c == '_')
    return strut_expression_fail(reader, begin, end, "digits cannot be grouped with '_'");
  if ((c == 'x' || c == 'X') && reader->at == begin + 1 && reader->text[begin] == '0')
    return strut_expression_fail(reader, begin, end, "hexadecimal numbers are not allowed");
  if ((c == 'e' || c == 'E') && word == 1)
    return strut_expression_fail(reader, begin, end, "the exponent of this number has no digits");
  return true;
}

bool strut_expression_literal(strut_expression_reader *reader, strut_quantity *quantity) {
  size_t begin = reader->at,
         scanned = strut_number_scan(reader->text + begin, reader->length - begin);
  if (!scanned) return strut_expression_unexpected(reader, "a number");
  reader->at += scanned;
  if (!check_end(reader, begin)) return false;
  size_t end = reader->at;
  unit_product product = {0, 1, 1, STRUT_DIM_NONE, true};
  char c = strut_expression_peek(reader);
  if ((c == '%' || strut_expression_word(reader, reader->at)) && !read_unit(reader, &product))
    return false;
  if (!strut_number_read_scaled(reader->text + begin, scanned, product.decimal, &quantity->value))
    return strut_expression_fail(reader, begin, end, "this number is beyond the range of numbers");
  if (product.up != 1) quantity->value *= product.up;
  if (product.down != 1) quantity->value /= product.down;
  if (!isfinite(quantity->value))
    return strut_expression_fail(reader, begin, reader->at,
                                 "this number is beyond the range of numbers");
  quantity->dimension = product.dimension;
  quantity->bare = product.bare;
  quantity->varies = false;
  return true;
}

/* ---- columns of the motion in expressions, and the program that is made of them ---- */

static bool is_name_byte(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         (unsigned char)c >= 0x80;
}

static strut_compiled *push(strut_expression_reader *reader) {
  strut_compiler *compiler = reader->compiler;
  return &compiler->program[compiler->length++];
}

/* Numbers on the stack after the instructions so far. */
static size_t stacked(const strut_compiler *compiler) {
  static const size_t operands[] = {
#define STRUT_OPERANDS(id, count, ...) count,
      STRUT_OPERATION_TABLE(STRUT_OPERANDS)
#undef STRUT_OPERANDS
  };
  size_t count = 0;
  for (size_t i = 0; i < compiler->length; i++)
    count += 1 - operands[compiler->program[i].instruction.operation];
  return count;
}

static void note_depth(strut_compiler *compiler) {
  size_t depth = stacked(compiler);
  if (depth > compiler->depth) compiler->depth = depth;
}

void strut_expression_emit_number(strut_expression_reader *reader, const strut_quantity *number) {
  if (!reader->compiler) return;
  *push(reader) = (strut_compiled){
      .instruction = {.operation = STRUT_OPERATION_NUMBER, .number = number->value},
      .dimension = number->bare ? STRUT_DIM_NONE : number->dimension};
  note_depth(reader->compiler);
}

void strut_expression_emit(strut_expression_reader *reader, strut_operation operation,
                           size_t operands, const strut_quantity *result) {
  strut_compiler *compiler = reader->compiler;
  if (!compiler) return;
  if (!result->varies) { /* then each operand is one number */
    assert(compiler->length >= operands);
    compiler->length -= operands;
    strut_expression_emit_number(reader, result);
    return;
  }
  for (size_t i = operands > 1 ? 1 : 0; i < (operands > 1 ? operands : 1); i++)
    *push(reader) = (strut_compiled){.instruction = {.operation = operation}};
}

/* What a look-up finds: > 0 there; 0 not; < 0 refused. */
typedef struct looked_up {
  int found;
  strut_column column;
  strut_dimension dimension;
  strut_refusal refusal;
} looked_up;

static looked_up nothing(void) {
  return (looked_up){.column = {.item = -1, .other = -1}, .dimension = STRUT_DIM_NONE};
}

/* Takes what a look-up has found for text[begin..end). */
static int take(strut_expression_reader *reader, size_t begin, size_t end, const looked_up *it,
                strut_quantity *quantity) {
  if (it->found < 0) strut_expression_fail(reader, begin, end, "%s", it->refusal.text);
  if (it->found <= 0) return it->found;
  *push(reader) =
      (strut_compiled){.instruction = {.operation = STRUT_OPERATION_COLUMN, .column = it->column}};
  note_depth(reader->compiler);
  bool bare = isnan(it->dimension.kg);
  *quantity = (strut_quantity){
      .value = 1, .dimension = bare ? STRUT_DIM_NONE : it->dimension, .bare = bare, .varies = true};
  reader->at = end;
  return 1;
}

static strut_piece piece(const strut_expression_reader *reader, size_t begin, size_t end) {
  return (strut_piece){reader->text + begin, end - begin};
}

static int look_up(strut_expression_reader *reader, const char *kind, size_t begin,
                   strut_piece owner, size_t field, size_t end, strut_quantity *quantity) {
  looked_up it = nothing();
  it.found =
      reader->compiler->column(reader->compiler->context, kind, owner, piece(reader, field, end),
                               &it.column, &it.dimension, &it.refusal);
  return take(reader, begin, end, &it, quantity);
}

/* A name within parentheses, without blanks about it, and `last`, which follows it. */
static bool read_raw_name(strut_expression_reader *reader, char last, strut_piece *name) {
  strut_expression_peek(reader);
  size_t begin = reader->at;
  while (reader->at < reader->length && !strchr("(),", reader->text[reader->at])) reader->at++;
  size_t end = reader->at;
  while (end > begin && reader->text[end - 1] == ' ') end--;
  *name = piece(reader, begin, end);
  if (end == begin) return strut_expression_unexpected(reader, "a name");
  if (reader->at < reader->length && reader->text[reader->at] == last) {
    reader->at++;
    return true;
  }
  return strut_expression_unexpected(reader, last == ',' ? "',' and a second node" : "')'");
}

/* node(NAME).FIELD, member(NAME).FIELD and the like, for names that expressions would take apart. */
static int read_quoted(strut_expression_reader *reader, const char *kind, size_t begin,
                       strut_quantity *quantity) {
  strut_piece name;
  if (!read_raw_name(reader, ')', &name)) return -1;
  size_t word = reader->at < reader->length && reader->text[reader->at] == '.'
                    ? strut_expression_word(reader, reader->at + 1)
                    : 0;
  if (!word) {
    strut_expression_fail(reader, begin, reader->at,
                          "expected a column of the %s, such as %s(%.*s).%s", kind, kind,
                          name.length > 40 ? 40 : (int)name.length, name.text,
                          kind[0] == 'n'   ? "y"
                          : kind[0] == 'h' ? "moment"
                          : kind[1] == 'e' ? "pressure"
                                           : "force");
    return -1;
  }
  size_t field = reader->at + 1;
  return look_up(reader, kind, begin, name, field, field + word, quantity);
}

static int read_pair(strut_expression_reader *reader, strut_piece word, size_t begin,
                     strut_quantity *quantity) {
  strut_piece first, second;
  if (!reader->compiler->pair) {
    reader->at = begin;
    return 0;
  }
  if (!read_raw_name(reader, ',', &first) || !read_raw_name(reader, ')', &second)) return -1;
  looked_up it = nothing();
  it.found = reader->compiler->pair(reader->compiler->context, word, first, second, &it.column,
                                    &it.dimension, &it.refusal);
  return take(reader, begin, reader->at, &it, quantity);
}

/* rate(SENSOR) */
static int read_rate(strut_expression_reader *reader, size_t begin, strut_quantity *quantity) {
  strut_piece name;
  if (!read_raw_name(reader, ')', &name)) return -1;
  return look_up(reader, "rate", begin, name, reader->at, reader->at, quantity);
}

/*
 * What looks like a function: node(A).x, member(A).force, hinge(A).moment, cell(A).area, angle(A, B),
 * distance(A, B) of two nodes, distance(A).force.
 */
static int read_call(strut_expression_reader *reader, size_t begin, size_t length,
                     strut_quantity *quantity) {
  static const char *const words[] = {"node",   "member", "hinge",    "cell", "collision",
                                      "slider", "angle",  "distance", "rate"};
  for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
    if (strlen(words[i]) != length || memcmp(words[i], reader->text + begin, length) != 0) continue;
    reader->at = begin + length;
    if (strut_expression_peek(reader) != '(') break;
    reader->at++;
    if (i == 8) return read_rate(reader, begin, quantity);
    bool one =
        i == 7 && reader->text[reader->at + strcspn(reader->text + reader->at, "(),")] == ')';
    return i < 6 || one ? read_quoted(reader, words[i], begin, quantity)
                        : read_pair(reader, piece(reader, begin, begin + length), begin, quantity);
  }
  reader->at = begin;
  return 0;
}

/* OWNER.FIELD with the longest owner that there is: its name may have dashes and dots. */
static int read_dotted(strut_expression_reader *reader, strut_quantity *quantity) {
  size_t begin = reader->at, end = begin;
  while (end < reader->length &&
         (is_name_byte(reader->text[end]) || strchr("-.", reader->text[end])))
    end++;
  for (size_t dot = end; dot-- > begin + 1;) {
    size_t word = reader->text[dot] == '.' ? strut_expression_word(reader, dot + 1) : 0;
    if (!word) continue;
    size_t simple = begin;
    while (is_name_byte(reader->text[simple])) simple++;
    bool plain = simple == dot && !is_digit(reader->text[begin]);
    looked_up it = nothing();
    it.found = reader->compiler->column(reader->compiler->context, NULL, piece(reader, begin, dot),
                                        piece(reader, dot + 1, dot + 1 + word), &it.column,
                                        &it.dimension, &it.refusal);
    if (it.found > 0 || (it.found < 0 && plain))
      return take(reader, begin, dot + 1 + word, &it, quantity);
  }
  return 0;
}

int strut_expression_column(strut_expression_reader *reader, strut_quantity *quantity) {
  if (!reader->compiler) return 0;
  strut_expression_peek(reader);
  if (reader->at >= reader->length || !is_name_byte(reader->text[reader->at])) return 0;
  size_t word = strut_expression_word(reader, reader->at);
  int found = word ? read_call(reader, reader->at, word, quantity) : 0;
  return found ? found : read_dotted(reader, quantity);
}

int strut_expression_column_word(strut_expression_reader *reader, size_t begin, size_t length,
                                 strut_quantity *quantity) {
  size_t resume = reader->at;
  if (!reader->compiler) return 0;
  int found = look_up(reader, NULL, begin, (strut_piece){"", 0}, begin, begin + length, quantity);
  if (found > 0) reader->at = resume;
  return found;
}

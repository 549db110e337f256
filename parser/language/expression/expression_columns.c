/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Columns of the motion in expressions, and the program that is made of them. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "parser/language/expression/expression_parts.h"

static bool is_name_byte(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         (unsigned char)c >= 0x80;
}

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

static strut_compiled *push(strut_expression_reader *r) {
  strut_compiler *c = r->compiler;
  return &c->program[c->length++];
}

/* Numbers on the stack after the instructions so far. */
static size_t stacked(const strut_compiler *c) {
  static const size_t operands[] = {
#define STRUT_OPERANDS(id, count, ...) count,
      STRUT_OPERATION_TABLE(STRUT_OPERANDS)
#undef STRUT_OPERANDS
  };
  size_t count = 0;
  for (size_t i = 0; i < c->length; i++) count += 1 - operands[c->program[i].instruction.operation];
  return count;
}

static void note_depth(strut_compiler *c) {
  size_t depth = stacked(c);
  if (depth > c->depth) c->depth = depth;
}

void strut_expression_emit_number(strut_expression_reader *r, const strut_quantity *number) {
  if (!r->compiler) return;
  *push(r) = (strut_compiled){
      .instruction = {.operation = STRUT_OPERATION_NUMBER, .number = number->value},
      .dimension = number->bare ? STRUT_DIM_NONE : number->dimension};
  note_depth(r->compiler);
}

void strut_expression_emit(strut_expression_reader *r, strut_operation operation, size_t operands,
                           const strut_quantity *result) {
  strut_compiler *c = r->compiler;
  if (!c) return;
  if (!result->varies) { /* then each operand is one number */
    assert(c->length >= operands);
    c->length -= operands;
    strut_expression_emit_number(r, result);
    return;
  }
  for (size_t i = operands > 1 ? 1 : 0; i < (operands > 1 ? operands : 1); i++)
    *push(r) = (strut_compiled){.instruction = {.operation = operation}};
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
static int take(strut_expression_reader *r, size_t begin, size_t end, const looked_up *it,
                strut_quantity *q) {
  if (it->found < 0) strut_expression_fail(r, begin, end, "%s", it->refusal.text);
  if (it->found <= 0) return it->found;
  *push(r) =
      (strut_compiled){.instruction = {.operation = STRUT_OPERATION_COLUMN, .column = it->column}};
  note_depth(r->compiler);
  bool bare = isnan(it->dimension.kg);
  *q = (strut_quantity){
      .value = 1, .dimension = bare ? STRUT_DIM_NONE : it->dimension, .bare = bare, .varies = true};
  r->at = end;
  return 1;
}

static strut_piece piece(const strut_expression_reader *r, size_t begin, size_t end) {
  return (strut_piece){r->text + begin, end - begin};
}

static int look_up(strut_expression_reader *r, const char *kind, size_t begin, strut_piece owner,
                   size_t field, size_t end, strut_quantity *q) {
  looked_up it = nothing();
  it.found = r->compiler->column(r->compiler->context, kind, owner, piece(r, field, end),
                                 &it.column, &it.dimension, &it.refusal);
  return take(r, begin, end, &it, q);
}

/* A name within parentheses, without blanks about it, and `last`, which follows it. */
static bool read_raw_name(strut_expression_reader *r, char last, strut_piece *name) {
  strut_expression_peek(r);
  size_t begin = r->at;
  while (r->at < r->length && !strchr("(),", r->text[r->at])) r->at++;
  size_t end = r->at;
  while (end > begin && r->text[end - 1] == ' ') end--;
  *name = piece(r, begin, end);
  if (end == begin) return strut_expression_unexpected(r, "a name");
  if (r->at < r->length && r->text[r->at] == last) {
    r->at++;
    return true;
  }
  return strut_expression_unexpected(r, last == ',' ? "',' and a second node" : "')'");
}

/* node(NAME).FIELD, member(NAME).FIELD and the like, for names that expressions would take apart. */
static int read_quoted(strut_expression_reader *r, const char *kind, size_t begin,
                       strut_quantity *q) {
  strut_piece name;
  if (!read_raw_name(r, ')', &name)) return -1;
  size_t word =
      r->at < r->length && r->text[r->at] == '.' ? strut_expression_word(r, r->at + 1) : 0;
  if (!word) {
    strut_expression_fail(r, begin, r->at, "expected a column of the %s, such as %s(%.*s).%s", kind,
                          kind, name.length > 40 ? 40 : (int)name.length, name.text,
                          kind[0] == 'n'   ? "y"
                          : kind[0] == 'h' ? "moment"
                          : kind[1] == 'e' ? "pressure"
                                           : "force");
    return -1;
  }
  size_t field = r->at + 1;
  return look_up(r, kind, begin, name, field, field + word, q);
}

static int read_pair(strut_expression_reader *r, strut_piece word, size_t begin,
                     strut_quantity *q) {
  strut_piece first, second;
  if (!read_raw_name(r, ',', &first) || !read_raw_name(r, ')', &second)) return -1;
  looked_up it = nothing();
  it.found = r->compiler->pair(r->compiler->context, word, first, second, &it.column, &it.dimension,
                               &it.refusal);
  return take(r, begin, r->at, &it, q);
}

/* rate(SENSOR) */
static int read_rate(strut_expression_reader *r, size_t begin, strut_quantity *q) {
  strut_piece name;
  if (!read_raw_name(r, ')', &name)) return -1;
  return look_up(r, "rate", begin, name, r->at, r->at, q);
}

/*
 * What looks like a function: node(A).x, member(A).force, hinge(A).moment, cell(A).area, angle(A, B),
 * distance(A, B) of two nodes, distance(A).force.
 */
static int read_call(strut_expression_reader *r, size_t begin, size_t length, strut_quantity *q) {
  static const char *const words[] = {"node",   "member", "hinge",    "cell", "collision",
                                      "slider", "angle",  "distance", "rate"};
  for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
    if (strlen(words[i]) != length || memcmp(words[i], r->text + begin, length) != 0) continue;
    r->at = begin + length;
    if (strut_expression_peek(r) != '(') break;
    r->at++;
    if (i == 8) return read_rate(r, begin, q);
    bool one = i == 7 && r->text[r->at + strcspn(r->text + r->at, "(),")] == ')';
    return i < 6 || one ? read_quoted(r, words[i], begin, q)
                        : read_pair(r, piece(r, begin, begin + length), begin, q);
  }
  r->at = begin;
  return 0;
}

/* OWNER.FIELD with the longest owner that there is: its name may have dashes and dots. */
static int read_dotted(strut_expression_reader *r, strut_quantity *q) {
  size_t begin = r->at, end = begin;
  while (end < r->length && (is_name_byte(r->text[end]) || strchr("-.", r->text[end]))) end++;
  for (size_t dot = end; dot-- > begin + 1;) {
    size_t word = r->text[dot] == '.' ? strut_expression_word(r, dot + 1) : 0;
    if (!word) continue;
    size_t simple = begin;
    while (is_name_byte(r->text[simple])) simple++;
    bool plain = simple == dot && !is_digit(r->text[begin]);
    looked_up it = nothing();
    it.found = r->compiler->column(r->compiler->context, NULL, piece(r, begin, dot),
                                   piece(r, dot + 1, dot + 1 + word), &it.column, &it.dimension,
                                   &it.refusal);
    if (it.found > 0 || (it.found < 0 && plain)) return take(r, begin, dot + 1 + word, &it, q);
  }
  return 0;
}

int strut_expression_column(strut_expression_reader *r, strut_quantity *q) {
  if (!r->compiler) return 0;
  strut_expression_peek(r);
  if (r->at >= r->length || !is_name_byte(r->text[r->at])) return 0;
  size_t word = strut_expression_word(r, r->at);
  int found = word ? read_call(r, r->at, word, q) : 0;
  return found ? found : read_dotted(r, q);
}

int strut_expression_column_word(strut_expression_reader *r, size_t begin, size_t length,
                                 strut_quantity *q) {
  size_t resume = r->at;
  if (!r->compiler) return 0;
  int found = look_up(r, NULL, begin, (strut_piece){"", 0}, begin, begin + length, q);
  if (found > 0) r->at = resume;
  return found;
}

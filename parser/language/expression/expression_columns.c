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

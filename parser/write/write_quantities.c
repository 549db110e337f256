/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measured quantities as YAML: programs as expressions again. See writer.h. */
#include <math.h>
#include <string.h>

#include "parser/expression/expression.h"
#include "parser/write/writer.h"

static const struct operation_row {
  size_t operands;
  const char *word;
} operations[] = {
#define STRUT_OPERATION_ROW(id, operands, word, sensitivity) {operands, word},
    STRUT_OPERATION_TABLE(STRUT_OPERATION_ROW)
#undef STRUT_OPERATION_ROW
};

/* How tightly operators bind; numbers, columns and functions need no parentheses. */
enum { OF_SUM = 1, OF_PRODUCT, OF_SIGN, OF_POWER, OF_PRIMARY };

static int binding(const strut_instruction *p) {
  static const int operators[STRUT_OPERATION_COUNT] = {
      [STRUT_OPERATION_ADD] = OF_SUM,          [STRUT_OPERATION_SUBTRACT] = OF_SUM,
      [STRUT_OPERATION_MULTIPLY] = OF_PRODUCT, [STRUT_OPERATION_DIVIDE] = OF_PRODUCT,
      [STRUT_OPERATION_NEGATE] = OF_SIGN,      [STRUT_OPERATION_POWER] = OF_POWER};
  if (p->operation == STRUT_OPERATION_NUMBER && (p->unit || signbit(p->number))) return 0;
  return operators[p->operation] ? operators[p->operation] : OF_PRIMARY;
}

/* Index of the first instruction of the operand whose last one is program[end - 1]. */
static size_t begin_of(const strut_instruction *program, size_t end) {
  size_t needed = 1;
  while (needed > 0) needed += operations[program[--end].operation].operands - 1;
  return end;
}

/* Names that an expression would split are written in parentheses. */
static void put_owner(strut_writer *writer, const char *kind, const char *name) {
  const char *c = name;
  while ((*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || *c == '_' ||
         (c > name && *c >= '0' && *c <= '9'))
    c++;
  bool plain = !*c;
  for (int owner = 0; owner <= STRUT_COLUMN_OF_LOSSES && plain; owner++) {
    const char *group = strut_column_group((strut_column_owner)owner);
    plain = !group || strcmp(group, name) != 0;
  }
  if (!plain) strut_put(writer, kind), strut_put(writer, "(");
  strut_put(writer, name);
  if (!plain) strut_put(writer, ")");
}

static void put_column(strut_writer *writer, strut_column column) {
  const strut_scene *scene = writer->scene;
  const char *word = strut_column_word(column.kind);
  strut_column_owner owner = strut_column_owner_of(column.kind);
  if (owner == STRUT_COLUMN_OF_FEEDBACK) {
    bool rate = column.kind == STRUT_COLUMN_SENSOR_RATE;
    bool sensor = rate || column.kind == STRUT_COLUMN_SENSOR;
    strut_put(writer, rate ? "rate(" : "");
    strut_put(writer, sensor                              ? scene->sensors[column.item].name
                      : column.kind == STRUT_COLUMN_STATE ? scene->states[column.item].name
                                                          : scene->signals[column.item].name);
    strut_put(writer, rate ? ")" : "");
    return;
  }
  if (owner == STRUT_COLUMN_OF_PAIR) {
    strut_put(writer, word);
    strut_put(writer, "(");
    strut_put(writer, scene->nodes[column.item].name);
    strut_put(writer, ", ");
    strut_put(writer, scene->nodes[column.other].name);
    strut_put(writer, ")");
    return;
  }
  if (owner == STRUT_COLUMN_OF_MEMBER)
    put_owner(writer, "member", scene->members[column.item].name);
  else if (owner == STRUT_COLUMN_OF_HINGE)
    put_owner(writer, "hinge", scene->hinges[column.item].name);
  else if (owner == STRUT_COLUMN_OF_CELL)
    put_owner(writer, "cell", scene->cells[column.item].name);
  else if (owner == STRUT_COLUMN_OF_SLIDER)
    put_owner(writer, "slider", scene->sliding_masses[column.item].name);
  else if (owner == STRUT_COLUMN_OF_COLLISION)
    put_owner(writer, "collision", scene->collisions[column.item].name);
  else if (owner == STRUT_COLUMN_OF_NODE || owner == STRUT_COLUMN_OF_CONTACT)
    put_owner(writer, "node", scene->nodes[column.item].name);
  else if (owner != STRUT_COLUMN_OF_RUN)
    strut_put(writer, strut_column_group(owner));
  if (owner != STRUT_COLUMN_OF_RUN) strut_put(writer, ".");
  strut_put(writer, word);
}

static void put_number(strut_writer *writer, const strut_instruction *p) {
  strut_put_number(writer, p->number);
  if (p->unit) strut_put(writer, " "), strut_put(writer, p->unit);
}

static void put_operand(strut_writer *writer, const strut_instruction *program, size_t end,
                        int least);

static void put_call(strut_writer *writer, const strut_instruction *program, size_t end) {
  size_t operands = operations[program[end - 1].operation].operands;
  size_t second = end - 1, first = operands > 1 ? begin_of(program, second) : second;
  strut_put(writer, operations[program[end - 1].operation].word);
  strut_put(writer, "(");
  put_operand(writer, program, first, OF_SUM);
  if (operands > 1) strut_put(writer, ", "), put_operand(writer, program, second, OF_SUM);
  strut_put(writer, ")");
}

static void put_operator(strut_writer *writer, const strut_instruction *program, size_t end,
                         int level) {
  const char *word = operations[program[end - 1].operation].word;
  if (level == OF_SIGN) {
    strut_put(writer, word);
    put_operand(writer, program, end - 1, OF_SIGN);
    return;
  }
  size_t second = end - 1, first = begin_of(program, second);
  bool power = level == OF_POWER;
  put_operand(writer, program, first, power ? OF_PRIMARY : level);
  strut_put(writer, power ? "" : " ");
  strut_put(writer, word);
  strut_put(writer, power ? "" : " ");
  put_operand(writer, program, second, power ? OF_PRIMARY : level + 1);
}

/* The operand that ends before `end`, in parentheses where it binds less tightly than `least`. */
static void put_operand(strut_writer *writer, const strut_instruction *program, size_t end,
                        int least) {
  const strut_instruction *last = &program[end - 1];
  int level = binding(last);
  bool enclosed = level < least;
  if (enclosed) strut_put(writer, "(");
  if (last->operation == STRUT_OPERATION_NUMBER)
    put_number(writer, last);
  else if (last->operation == STRUT_OPERATION_COLUMN)
    put_column(writer, last->column);
  else if (level == OF_PRIMARY)
    put_call(writer, program, end);
  else
    put_operator(writer, program, end, level);
  if (enclosed) strut_put(writer, ")");
}

void strut_put_program(strut_writer *writer, const strut_instruction *program, size_t length) {
  strut_writer part = {.scene = writer->scene};
  put_operand(&part, program, length, OF_SUM);
  if (part.failed || !part.text)
    writer->failed = true;
  else
    strut_put_quoted(writer, part.text);
  strut_release(part.text);
}

/* The expression; an accuracy: relative, or in the quantity's own unit; a target in the expression's. */
static void put_quantity_by_hand(strut_writer *writer, strut_mapping *mapping, int key,
                                 const void *object) {
  const strut_quantity_definition *d = object;
  bool absolute = d->accuracy_absolute > 0.0;
  if (key == STRUT_KEY_QUANTITY_OF) {
    strut_put_key_name(writer, mapping, key);
    strut_put_program(writer, d->program, d->length);
  } else if (key == STRUT_KEY_QUANTITY_TARGET) {
    if (d->take != STRUT_TAKE_ARRIVAL) return;
    bool unit = d->target_unit && strcmp(d->target_unit, "1") != 0;
    strut_put_key_name(writer, mapping, key);
    strut_put(writer, unit ? "\"" : "");
    strut_put_number(writer, d->target);
    strut_put(writer, unit ? " " : "");
    strut_put(writer, unit ? d->target_unit : "");
    strut_put(writer, unit ? "\"" : "");
  } else if (absolute || d->accuracy > 0.0) {
    strut_put_key_name(writer, mapping, key);
    strut_put(writer, absolute ? "\"" : "");
    strut_put_number(writer, absolute ? d->accuracy_absolute : d->accuracy);
    strut_put(writer, absolute ? " " : "");
    strut_put(writer, absolute ? d->unit : "");
    strut_put(writer, absolute ? "\"" : "");
  }
}

void strut_put_quantities(strut_writer *writer, strut_mapping *mapping) {
  const strut_experiment *e = writer->experiment;
  const strut_quantity_definition usual = {0};
  if (!e->quantity_count) return;
  strut_put_key_name(writer, mapping, STRUT_KEY_MEASURE_QUANTITIES);
  strut_put(writer, "{");
  for (size_t i = 0; i < e->quantity_count; i++) {
    strut_mapping inner = STRUT_MAPPING_INLINE;
    strut_put(writer, i ? ", " : "");
    strut_put_name(writer, e->quantities[i].name);
    strut_put(writer, ": {");
    strut_put_fields(writer, &inner, STRUT_SECTION_QUANTITY, &e->quantities[i], &usual,
                     put_quantity_by_hand);
    strut_put(writer, "}");
  }
  strut_put(writer, "}");
}

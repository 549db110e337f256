/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Programs of signals and states that the reader writes itself: those of oscillators, controllers, networks. */
#ifndef STRUT_PARSER_READ_PROGRAM_BUILDER_H
#define STRUT_PARSER_READ_PROGRAM_BUILDER_H

#include "parser/language/read/reader.h"

/** A program under construction. */
typedef struct builder {
  strut_reader *reader;
  strut_instruction *code; /* in the scene's memory */
  size_t length, room, stacked, most;
} builder;

static inline bool begin_program(strut_reader *reader, size_t room, builder *b) {
  *b = (builder){.reader = reader, .room = room};
  b->code = strut_reader_allocate(reader, &reader->scene->arena, room, sizeof *b->code);
  return b->code != NULL;
}

static inline void put(builder *b, strut_instruction p) {
  if (b->length == b->room) return;
  b->code[b->length++] = p;
  b->stacked += 1 - (size_t)strut_operation_operands(p.operation);
  if (b->stacked > b->most) b->most = b->stacked;
}

static inline void put_number(builder *b, double number, strut_dimension dimension) {
  char unit[STRUT_SUFFIX_TEXT];
  strut_dimension_suffix(dimension, unit, sizeof unit);
  put(b, (strut_instruction){.operation = STRUT_OPERATION_NUMBER,
                             .number = number,
                             .unit = *unit ? strut_keep_text(b->reader, unit) : NULL});
}

static inline void put_column(builder *b, strut_column_kind kind, int32_t item) {
  put(b, (strut_instruction){.operation = STRUT_OPERATION_COLUMN,
                             .column = {.kind = kind, .item = item, .other = -1}});
}

static inline void put_operation(builder *b, strut_operation operation) {
  put(b, (strut_instruction){.operation = operation});
}

static inline strut_program end_program(const builder *b) {
  return (strut_program){.length = b->length, .depth = b->most, .instruction = b->code};
}

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Programs of signals and states that the reader writes itself: those of oscillators, controllers, networks. */
#ifndef STRUT_PARSER_LANGUAGE_READ_PROGRAM_BUILDER_H
#define STRUT_PARSER_LANGUAGE_READ_PROGRAM_BUILDER_H

#include "parser/language/read/reader.h"

/** A program under construction. */
typedef struct builder {
  strut_reader *reader;
  strut_instruction *code; /* in the scene's memory */
  size_t length, room, stacked, most;
} builder;

static inline bool begin_program(strut_reader *reader, size_t room, builder *self) {
  *self = (builder){.reader = reader, .room = room};
  self->code = strut_reader_allocate(reader, &reader->scene->arena, room, sizeof *self->code);
  return self->code != NULL;
}

static inline void put(builder *self, strut_instruction p) {
  if (self->length == self->room) return;
  self->code[self->length++] = p;
  self->stacked += 1 - (size_t)strut_operation_operands(p.operation);
  if (self->stacked > self->most) self->most = self->stacked;
}

static inline void put_number(builder *self, double number, strut_dimension dimension) {
  char unit[STRUT_SUFFIX_TEXT];
  strut_dimension_suffix(dimension, unit, sizeof unit);
  put(self, (strut_instruction){.operation = STRUT_OPERATION_NUMBER,
                                .number = number,
                                .unit = *unit ? strut_keep_text(self->reader, unit) : NULL});
}

static inline void put_column(builder *self, strut_column_kind kind, int32_t item) {
  put(self, (strut_instruction){.operation = STRUT_OPERATION_COLUMN,
                                .column = {.kind = kind, .item = item, .other = -1}});
}

static inline void put_operation(builder *self, strut_operation operation) {
  put(self, (strut_instruction){.operation = operation});
}

static inline strut_program end_program(const builder *self) {
  return (strut_program){.length = self->length, .depth = self->most, .instruction = self->code};
}

#endif

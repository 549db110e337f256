/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Expressions with units: "2*amplitude + 0.1 mm", "1 / (1000 * frequency)".
 *
 * One table of unit names; a dimension is the exponents of kg, m, s and angle. A value carries its dimension. A *bare*
 * value is made of plain numbers only and fits any dimension: plain numbers are SI.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "engine/base/memory.h"
#include "engine/base/status.h"
#include "engine/base/text.h"
#include "engine/scene/observables.h"
#include "engine/scene/quantity.h"

/* ---- units and dimensions ---- */

/** The dimensions that keys of the language expect. */
#define STRUT_DIM_NONE ((strut_dimension){0, 0, 0, 0})
#define STRUT_DIM_LENGTH ((strut_dimension){0, 1, 0, 0})
#define STRUT_DIM_MASS ((strut_dimension){1, 0, 0, 0})
#define STRUT_DIM_TIME ((strut_dimension){0, 0, 1, 0})
#define STRUT_DIM_FREQUENCY ((strut_dimension){0, 0, -1, 0})
#define STRUT_DIM_ANGLE ((strut_dimension){0, 0, 0, 1})
#define STRUT_DIM_VELOCITY ((strut_dimension){0, 1, -1, 0})
#define STRUT_DIM_ACCELERATION ((strut_dimension){0, 1, -2, 0})
#define STRUT_DIM_FORCE ((strut_dimension){1, 1, -2, 0})
#define STRUT_DIM_STIFFNESS ((strut_dimension){1, 0, -2, 0})
#define STRUT_DIM_DAMPING ((strut_dimension){1, 0, -1, 0})
#define STRUT_DIM_MOMENT ((strut_dimension){1, 2, -2, 0})
#define STRUT_DIM_ANGULAR_STIFFNESS ((strut_dimension){1, 2, -2, -1})
#define STRUT_DIM_ANGULAR_DAMPING ((strut_dimension){1, 2, -1, -1})
#define STRUT_DIM_BENDING_STIFFNESS ((strut_dimension){1, 3, -2, 0})
#define STRUT_DIM_AREA ((strut_dimension){0, 2, 0, 0})
#define STRUT_DIM_CONDUCTANCE ((strut_dimension){0, 2, -1, 0})
#define STRUT_DIM_AREA_STIFFNESS ((strut_dimension){1, -2, -2, 0})
#define STRUT_DIM_AREA_DAMPING ((strut_dimension){1, -2, -1, 0})
#define STRUT_DIM_DISSIPATION ((strut_dimension){0, -1, 1, 0})

typedef struct strut_unit {
  const char *name;
  double factor; /* SI value of one: rest * 10^decimal */
  strut_dimension dimension;
  double rest; /* the factor without its power of ten: 60 for min, 1 for mm */
  int decimal; /* so that 0.1 ms has the bits of 1e-4 */
} strut_unit;

/** The unit of that name, or NULL. */
STRUT_API const strut_unit *strut_unit_find(const char *name, size_t length);
/** The i-th unit of the table, or NULL after the last. */
STRUT_API const strut_unit *strut_unit_at(size_t i);

/** The unit behind a plain number, such as mm of "-0.5 mm"; its name is in the arena or, without one, in the text. */
STRUT_API strut_file_unit strut_unit_of_text(const char *text, strut_arena *arena);

STRUT_API bool strut_dimension_equal(strut_dimension a, strut_dimension b);
/** "a length", "a frequency", ... or "kg m/s" for one without a name; written into buffer. */
STRUT_API const char *strut_dimension_name(strut_dimension dimension, char *buffer, size_t size);
/** An example for messages: "10 mm", "10 Hz", "0.2 N s/m"; NULL where there is none. */
STRUT_API const char *strut_dimension_example(strut_dimension dimension);
/** The SI unit to write after a number, "kg m s^-2" or "N"; "" for none; in buffer. */
STRUT_API const char *strut_dimension_suffix(strut_dimension dimension, char *buffer, size_t size);
/** The SI unit to write beside a number: "m", "N s/m"; "1" for none; "SI" for one without a name. */
STRUT_API const char *strut_dimension_unit(strut_dimension dimension);

/* ---- expressions ---- */

typedef struct strut_quantity {
  double value; /* SI */
  strut_dimension dimension;
  bool bare;
  bool varies; /* computed from columns of the motion, and thus without a value yet */
} strut_quantity;

/** A part of the text that is being read. */
typedef struct strut_piece {
  const char *text;
  size_t length;
} strut_piece;

/** An error in an expression: its offset and length in code points, and the message. */
typedef struct strut_expression_error {
  size_t offset, length;
  char message[300];
  strut_piece parameter; /* the parameter that is called like a unit, if that is why */
} strut_expression_error;

/**
 * Looks a parameter up by its name (not NUL-terminated). Returns 1 and fills the quantity; 0 when
 * there is none of that name; -1 when it exists but has no value (the lookup has reported why).
 */
typedef int strut_lookup(void *context, const char *name, size_t length, strut_quantity *quantity);
/** The i-th name for "did you mean", or NULL after the last. */
typedef const char *strut_names(const void *context, size_t i);

typedef struct strut_scope {
  strut_lookup *lookup; /* may be NULL: no parameters */
  strut_names *names;
  void *context;
  bool no_hints; /* errors suggest no name: that would take too long */
  bool unread;   /* messages will not be read: they only need not be empty */
} strut_scope;

/**
 * Evaluates text. Returns false with `error` filled; error->message is empty where the lookup has
 * already reported the cause. The result is finite.
 */
STRUT_API bool strut_expression_evaluate(const char *text, const strut_scope *scope,
                                         strut_quantity *quantity, strut_expression_error *error);

/** Why a column is refused; empty where that has been reported. */
typedef struct strut_refusal {
  char text[300];
} strut_refusal;

/**
 * Finds the column OWNER.FIELD; with an empty owner FIELD is a word alone. `kind`: "node", "member" or "hinge"
 * where the text says which, else NULL. Returns 1 and fills column and dimension; 0: nothing has that
 * name; -1: refused. A dimension of NAN: a bare column, which fits any.
 */
typedef int strut_find_column(void *context, const char *kind, strut_piece owner, strut_piece field,
                              strut_column *column, strut_dimension *dimension,
                              strut_refusal *refusal);
/** The same for the pairs WORD(FIRST, SECOND): angle and distance. */
typedef int strut_find_pair(void *context, strut_piece word, strut_piece first, strut_piece second,
                            strut_column *column, strut_dimension *dimension,
                            strut_refusal *refusal);

/** One instruction of a program under construction. */
typedef struct strut_compiled {
  strut_instruction instruction;
  strut_dimension dimension; /* of a NUMBER */
} strut_compiled;

/** Compiles an expression of columns to a program. */
typedef struct strut_compiler {
  strut_find_column *column;
  strut_find_pair *pair; /* NULL: there are none */
  void *context;
  strut_compiled *program; /* at least one for each byte of the text */
  size_t length, depth;    /* instructions so far; numbers on the stack at most */
  /** Is a unit's word behind * or / a name here? 1: it is; -1: it may be both; 0: no. NULL: never. */
  int (*claims)(void *context, strut_piece word);
} strut_compiler;

/** As strut_expression_evaluate; an expression with columns is compiled instead of evaluated. */
STRUT_API bool strut_expression_compile(const char *text, const strut_scope *scope,
                                        strut_compiler *compiler, strut_quantity *quantity,
                                        strut_expression_error *error);

/** True for the names that no parameter may have: pi and the functions. */
STRUT_API bool strut_expression_reserved(const char *name, size_t length);

/** Longest literal that is read, in bytes. */
enum { STRUT_NUMBER_MOST = 1000 };

/** Bytes of the literal at the beginning of the text, or 0. */
STRUT_API size_t strut_number_scan(const char *text, size_t left);
/**
 * The literal that fills text[0..length), times 10^decimal, rounded once: "96.51" with -3 has the
 * bits of 0.09651. False: not a literal, or neither zero nor representable.
 */
STRUT_API bool strut_number_read_scaled(const char *text, size_t length, int decimal,
                                        double *value);

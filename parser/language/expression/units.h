/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Units and dimensions. One table of unit names; a dimension is the exponents of kg, m, s and angle. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/scene/observables.h"

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

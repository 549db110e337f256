/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The language as a JSON Schema (draft-07), for editors: made from the table of keys.
 *
 * It tells what can be told without reading names and units: unknown keys, values of the wrong shape,
 * unknown words. Everything else is for strut itself.
 */
#ifndef STRUT_PARSER_WRITE_SCHEMA_H
#define STRUT_PARSER_WRITE_SCHEMA_H

#include <stdbool.h>

#include "engine/base/export.h"

/** The schema of a scene, or of a study, in a block of strut_allocate (release it); NULL: no memory. */
STRUT_API char *strut_schema_write(bool study);

#endif

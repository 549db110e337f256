/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The language as a JSON Schema, for editors. */
#pragma once

#include <stdbool.h>

/** Of a scene, or of a study, in a block of strut_allocate (release it); NULL: no memory. */
char *strut_schema_write(bool study);

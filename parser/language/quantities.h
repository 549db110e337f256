/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Columns of the motion as the language writes them. Internal to parser/.
 */
#ifndef STRUT_PARSER_LANGUAGE_QUANTITIES_H
#define STRUT_PARSER_LANGUAGE_QUANTITIES_H

#include "engine/scene/quantity.h"

/** Room for strut_dimension_suffix. */
enum { STRUT_SUFFIX_TEXT = 120 };

/** "force", "kinetic", "time" */
const char *strut_column_word(strut_column_kind kind);
strut_column_owner strut_column_owner_of(strut_column_kind kind);
/** "com", "energy", "work", "losses"; NULL for others. */
const char *strut_column_group(strut_column_owner owner);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The engine's own texts of laws (scene/laws, forces/strains) in exported code: put into the program at build
 * time, taken apart into functions and types, and written with the exported code's words.
 *
 * `LAW(name)` and `strut_name` become `name`, doubles `real`, numbers of formulas floats where these are
 * wanted. Functions with preprocessor lines inside are not for other programs.
 */
#ifndef STRUT_ENGINE_OUTPUT_CODE_LAW_TEXT_H
#define STRUT_ENGINE_OUTPUT_CODE_LAW_TEXT_H

#include "engine/output/code/writer.h"

/** Writes the function or type `name`, without prefix, after all that it names and that is not written yet. */
void strut_code_add_law(strut_code_writer *w, const char *name);
/** Do the texts have it? */
bool strut_code_knows_law(const char *name);

#endif

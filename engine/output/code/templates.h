/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The texts of which code.c makes C, put in at build time (EmbedFiles.cmake), each followed by a row of NULL.
 *
 * `$` is the prefix, `@_` the prefix in capitals, `@word` a number of the scene. Lines that begin with `@` are for
 * the writer: between `@if word !word ...` and `@else` or `@end` is what a scene needs for which each word holds
 * (none behind a `!`); in place of `@table word` come declarations with the scene's numbers.
 *
 * strut_code_law_texts are headers of the engine, see law_text.h.
 */
#ifndef STRUT_ENGINE_OUTPUT_CODE_TEMPLATES_H
#define STRUT_ENGINE_OUTPUT_CODE_TEMPLATES_H

#include "engine/output/buffer.h"

extern const strut_embedded strut_code_header_template[], strut_code_source_template[],
    strut_code_example_template[], strut_code_elements_template[], strut_code_duals_template[],
    strut_code_grounds_template[], strut_code_memory_template[], strut_code_observed_template[],
    strut_code_feedback_template[], strut_code_sliding_template[], strut_code_law_texts[];

#endif

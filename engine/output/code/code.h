/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A scene as C99 that steps itself: PREFIX.h, PREFIX.c, and an example with a main.
 *
 * No allocation and no library but libm. With doubles a step has the bits of the methods rk4 and verlet: sums
 * are in the scene's order. The formulas stand in templates (source.c.in), of which a scene gets what its terms
 * names; its numbers are tables with the names as comments.
 */
#ifndef STRUT_ENGINE_OUTPUT_CODE_CODE_H
#define STRUT_ENGINE_OUTPUT_CODE_CODE_H

#include "engine/model/model.h"
#include "engine/output/buffer.h"
#include "engine/scene/experiment.h"

typedef struct strut_code_options {
  const char *prefix;  /* of all names: a C identifier */
  bool single;         /* numbers are floats, not doubles */
  const char *program; /* who wrote it, such as "strut 1.0", for the comment at the top */
} strut_code_options;

/** May it be a prefix: a letter, then letters, digits and underscores, 64 at most? */
STRUT_API bool strut_code_is_prefix(const char *text);
/** Makes one of any text, such as a file's name, of which its folder and suffix are left out. */
STRUT_API void strut_code_prefix_of(const char *text, char prefix[65]);

/**
 * STRUT_BAD_SCENE, with all reasons in one sentence, where the scene has features that cannot be exported,
 * or, with floats, numbers that no float has.
 */
STRUT_API strut_status strut_code_check(const strut_model *model, strut_error *error);

/** Writes all files, or none. The model starts where the run is to begin: see strut_settle_model. */
STRUT_API strut_status strut_code_write(const char *directory, const strut_model *model,
                                        const strut_experiment *experiment,
                                        const strut_code_options *options, strut_error *error);

/*
 * The texts of which code.c makes C, put in at build time (EmbedFiles.cmake), each followed by a row of NULL.
 *
 * `$` is the prefix, `@_` the prefix in capitals, `@word` a number of the scene. Lines that begin with `@`
 * are for the writer: between `@if word !word ...` and `@else` or `@end` is what a scene needs for which each
 * word holds (none behind a `!`); in place of `@table word` come declarations with the scene's numbers.
 *
 * strut_code_law_texts are headers of the engine, see writer.h.
 */

extern const strut_embedded strut_code_header_template[], strut_code_source_template[],
    strut_code_example_template[], strut_code_elements_template[], strut_code_duals_template[],
    strut_code_grounds_template[], strut_code_memory_template[], strut_code_observed_template[],
    strut_code_feedback_template[], strut_code_sliding_template[], strut_code_law_texts[];

#endif

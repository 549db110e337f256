/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A tradeoff in words: names of settings, errors in per cent, advice.
 */
#ifndef STRUT_ENGINE_STUDY_TRADEOFF_TRADEOFF_WORDS_H
#define STRUT_ENGINE_STUDY_TRADEOFF_TRADEOFF_WORDS_H

#include "engine/output/buffer.h"
#include "engine/study/tradeoff/tradeoff.h"

enum { STRUT_STUDY_WORDS = 100 };

/** "0.43 %", "diverged" where infinite, "-" where it is not a number. */
const char *strut_study_percent(double error, char text[STRUT_STUDY_WORDS]);
/** "verlet-events, refined 8". */
const char *strut_study_group(const strut_tradeoff_row *row, char text[STRUT_STUDY_WORDS]);
/** "80 us", or "1e-05" of an adaptive method. */
const char *strut_study_step(const strut_tradeoff_row *row, char text[STRUT_STUDY_WORDS]);
/** "velocity", "position", "energy". */
const char *strut_study_measure(strut_tradeoff_measure measure);
/** One sentence for each level of error, and one for each other model. Call in the C locale. */
void strut_study_advise(strut_buffer *text, const strut_tradeoff *result);

#endif

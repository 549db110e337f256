/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Verdicts on rigidity in words, shared by the JSON and the table.
 */
#ifndef STRUT_ENGINE_OUTPUT_REPORT_RIGIDITY_WORDS_H
#define STRUT_ENGINE_OUTPUT_REPORT_RIGIDITY_WORDS_H

#include "engine/statics/rigidity/rigidity.h"

enum { STRUT_RIGIDITY_WORDS = 240 };

/** "bar", "spring", "cable". */
const char *strut_member_kind_words(strut_member_kind kind);
/** Which forces the stress matrix is about. */
const char *strut_stress_source_words(strut_stress_source source);
/** The test that shows what kind of motion it is; writes into and returns words. */
const char *strut_mechanism_words(const strut_mechanisms *all, const strut_mechanism *motion,
                                  char words[STRUT_RIGIDITY_WORDS]);
/** Super stable or not, and why. */
const char *strut_super_stability_words(const strut_rigidity *rigidity,
                                        char words[STRUT_RIGIDITY_WORDS]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Faults in texts, by a fixed sequence of dice. */
#ifndef STRUT_TESTS_LANGUAGE_FAULTS_H
#define STRUT_TESTS_LANGUAGE_FAULTS_H

#include <stddef.h>
#include <stdint.h>

/** 0 to sides - 1. */
uint32_t throw_dice(uint32_t sides);

/** text[0..length) with one to three faults; returns its length, which is up to 40 bytes more for each. */
size_t spoil_text(const char *text, size_t length, char *spoilt);

#endif

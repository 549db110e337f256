/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Strict decimal literals: digits[.digits][e[+-]digits], or .digits; correctly rounded in any locale.
 */
#ifndef STRUT_PARSER_EXPRESSION_NUMBER_H
#define STRUT_PARSER_EXPRESSION_NUMBER_H

#include <stdbool.h>
#include <stddef.h>

#include "engine/base/export.h"

/** Longest literal that is read, in bytes. */
enum { STRUT_NUMBER_MOST = 1000 };

/** Bytes of the literal that text begins with; 0 where it begins with none. */
size_t strut_number_scan(const char *text, size_t left);
/**
 * The literal that fills text[0..length), times 10^decimal, rounded once: "96.51" with -3 has the
 * bits of 0.09651. False: not a literal, or neither zero nor representable.
 */
STRUT_API bool strut_number_read_scaled(const char *text, size_t length, int decimal,
                                        double *value);

#endif

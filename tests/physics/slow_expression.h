/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Expressions of the language once more: read and computed in one pass over their text, in long double.
 * Numbers are in SI units, which may be written behind them and mean nothing here.
 */
#pragma once

#include <stddef.h>

/** Value of the variable of that name; `rate`: it stands in rate(...). */
typedef long double slow_variable(void *context, const char *name, int rate);

long double slow_expression(const char *text, slow_variable *variable, void *context);

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Results of statics, for other files of the library. */
#ifndef STRUT_PARSER_ABI_STATICS_H
#define STRUT_PARSER_ABI_STATICS_H

#include "engine/statics/equilibria/equilibria.h"
#include "parser/abi/handles.h"

/** The equilibria that a result of strutlib_equilibria holds, or NULL. */
const strut_equilibria *abi_result_equilibria(const strutlib_result *result);

#endif

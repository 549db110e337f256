/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/algebra_library.h"

const strut_algebra_library strut_algebra_table = {
    .stamp = {STRUT_VERSION, sizeof(strut_algebra_library)},
#define FUNCTION(name) .name = name,
    STRUT_ALGEBRA_FUNCTIONS(FUNCTION)
#undef FUNCTION
};

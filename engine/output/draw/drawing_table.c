/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/draw/drawing_library.h"

const strut_drawing_library strut_drawing_table = {
    .stamp = {STRUT_VERSION, sizeof(strut_drawing_library)},
#define FUNCTION(name) .name = name,
    STRUT_DRAWING_FUNCTIONS(FUNCTION)
#undef FUNCTION
};

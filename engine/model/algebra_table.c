/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/model/algebra_library.h"

/* Found among the libraries that the others need, if the BLAS is OpenBLAS. */
extern void openblas_set_num_threads(int count) __attribute__((weak));
extern int openblas_get_num_threads(void) __attribute__((weak));

const strut_algebra_library strut_algebra_table = {
    .stamp = {STRUT_VERSION, sizeof(strut_algebra_library)},
#define FUNCTION(name) .name = name,
    STRUT_ALGEBRA_FUNCTIONS(FUNCTION)
#undef FUNCTION
        .set_threads = openblas_set_num_threads,
    .get_threads = openblas_get_num_threads,
};

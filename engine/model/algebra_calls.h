/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * SuiteSparse's and ARPACK's functions under their own names, called through the table. Whoever calls one has
 * had STRUT_OK from strut_algebra_load before. A name that is missing here is missing in algebra_library.h, too.
 */
#ifndef STRUT_ENGINE_MODEL_ALGEBRA_CALLS_H
#define STRUT_ENGINE_MODEL_ALGEBRA_CALLS_H

#include "engine/model/algebra_library.h"

/** NULL before strut_algebra_load. */
extern const void *strut_algebra_loaded;
#define strut_algebra ((const strut_algebra_library *)strut_algebra_loaded)

/** Makes the libraries ready, once; fails where they are not installed, or memory is out. */
strut_status strut_algebra_load(strut_error *error);

/**
 * Between begin and end the BLAS keeps to one thread, since its sums have other bits with several. Several threads
 * may do so at a time.
 */
void strut_algebra_begin(void);
void strut_algebra_end(void);

#define cholmod_analyze (strut_algebra->cholmod_analyze)
#define cholmod_change_factor (strut_algebra->cholmod_change_factor)
#define cholmod_copy_factor (strut_algebra->cholmod_copy_factor)
#define cholmod_factorize (strut_algebra->cholmod_factorize)
#define cholmod_factorize_p (strut_algebra->cholmod_factorize_p)
#define cholmod_finish (strut_algebra->cholmod_finish)
#define cholmod_free_factor (strut_algebra->cholmod_free_factor)
#define cholmod_l_allocate_sparse (strut_algebra->cholmod_l_allocate_sparse)
#define cholmod_l_finish (strut_algebra->cholmod_l_finish)
#define cholmod_l_free (strut_algebra->cholmod_l_free)
#define cholmod_l_free_dense (strut_algebra->cholmod_l_free_dense)
#define cholmod_l_free_sparse (strut_algebra->cholmod_l_free_sparse)
#define cholmod_l_start (strut_algebra->cholmod_l_start)
#define cholmod_start (strut_algebra->cholmod_start)
#define SuiteSparseQR_C (strut_algebra->SuiteSparseQR_C)
#define dsaupd_c (strut_algebra->dsaupd_c)
#define dseupd_c (strut_algebra->dseupd_c)

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The functions of SuiteSparse and ARPACK that strut calls, as one table, so that a program may load these
 * libraries and the BLAS beneath them when it first needs one (engine/base/library_tables.h). For the files that
 * call them: algebra_calls.h.
 */
#ifndef STRUT_ENGINE_MODEL_ALGEBRA_LIBRARY_H
#define STRUT_ENGINE_MODEL_ALGEBRA_LIBRARY_H

#include <SuiteSparseQR_C.h>
#include <arpack.h>
#include <cholmod.h>

#include "engine/base/library_tables.h"

#define STRUT_ALGEBRA_FUNCTIONS(X)                                                                 \
  X(cholmod_analyze)                                                                               \
  X(cholmod_change_factor)                                                                         \
  X(cholmod_copy_factor)                                                                           \
  X(cholmod_factorize)                                                                             \
  X(cholmod_factorize_p)                                                                           \
  X(cholmod_finish)                                                                                \
  X(cholmod_free_factor)                                                                           \
  X(cholmod_l_allocate_sparse)                                                                     \
  X(cholmod_l_finish)                                                                              \
  X(cholmod_l_free)                                                                                \
  X(cholmod_l_free_dense)                                                                          \
  X(cholmod_l_free_sparse)                                                                         \
  X(cholmod_l_start)                                                                               \
  X(cholmod_start)                                                                                 \
  X(SuiteSparseQR_C)                                                                               \
  X(dsaupd_c)                                                                                      \
  X(dseupd_c)

typedef struct strut_algebra_library {
  strut_library_stamp stamp;
#define FUNCTION(name) __typeof__(name) *name;
  STRUT_ALGEBRA_FUNCTIONS(FUNCTION)
#undef FUNCTION
  /* of OpenBLAS; NULL with another BLAS */
  void (*set_threads)(int);
  int (*get_threads)(void);
} strut_algebra_library;

/** The table of the libraries that this program was linked to, or that a module of it was. */
extern STRUT_API const strut_algebra_library strut_algebra_table;

#endif

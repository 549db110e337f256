/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Variables that are freed where their block ends, last declared first. Not where an assertion fails: what
 * a failed test holds it keeps.
 *
 *     OWN(strut_setup) setup;                                        strut_setup_free(&setup)
 *     OWN_POINTER(strut_model) model = motion_compile(&setup.scene); strut_model_free(model)
 *     FREED char *text = scratch_read(path, &length);                free(text)
 */
#ifndef STRUT_TESTS_SUPPORT_OWN_H
#define STRUT_TESTS_SUPPORT_OWN_H

#include <stdlib.h>

#define OWN(type) __attribute__((cleanup(type##_free))) type
#define OWN_POINTER(type) __attribute__((cleanup(type##_free_at))) type *
/** Says once in a file how a type is freed that OWN_POINTER names. */
#define FREED_BY(function, type)                                                                   \
  static inline void type##_free_at(type **pointer) { function(*pointer); }
#define FREED __attribute__((cleanup(own_free)))

static inline void own_free(void *pointer) { free(*(void **)pointer); }

#endif

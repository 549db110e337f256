/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The words in which laws are written, so that one text serves single numbers and vector registers.
 *
 * A text includes this header first and laws/words_end.h last. It has no loop and no branch on a number; it
 * may be included once for each back end. A back end has the following under a prefix of its own, and
 * defines LAW(name), which puts that prefix before a name, and LAW_INLINE around the include:
 *
 *   real, mask          numbers and conditions of one thing, or of several side by side
 *   all(x)              the double x for each of them
 *   less(a, b), at_least(a, b)          a < b, a >= b; false where one of them is not a number
 *   both(m, n), either(m, n)
 *   some(m)             true if m holds anywhere
 *   choose(m, a, b)     a where m holds, b elsewhere
 *   keep(m, a)          a where m holds, 0 elsewhere
 *   add_where(m, sum, a)                sum + a where m holds, sum elsewhere
 *   magnitude(a), root(a)
 *   whole(a)            the whole number that is nearest to a, for sizes below 2^51
 *   against(a, b)       -a, a or 0 a, as b is positive, negative or neither
 *
 * Without a back end the words are those of single doubles (laws/scalar.h), under the prefix strut_law_.
 */
#include <stdbool.h>

#ifndef LAW
#include "engine/scene/laws/scalar.h"
#define LAW(name) strut_law_##name
#define LAW_INLINE static inline __attribute__((always_inline))
#define LAW_OF_DOUBLES
#endif

#define real LAW(real)
#define mask LAW(mask)
#define all LAW(all)
#define less LAW(less)
#define at_least LAW(at_least)
#define both LAW(both)
#define either LAW(either)
#define some LAW(some)
#define choose LAW(choose)
#define keep LAW(keep)
#define add_where LAW(add_where)
#define magnitude LAW(magnitude)
#define root LAW(root)
#define whole LAW(whole)
#define against LAW(against)

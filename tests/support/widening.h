/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Widening is the point of who includes this; clang counts it as promotion. */
#ifndef STRUT_TESTS_SUPPORT_WIDENING_H
#define STRUT_TESTS_SUPPORT_WIDENING_H

#pragma GCC diagnostic ignored "-Wdouble-promotion"

#endif

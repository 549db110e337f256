/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Widening is the point of who includes this; clang counts it as promotion. */
#pragma once

#pragma GCC diagnostic ignored "-Wdouble-promotion"

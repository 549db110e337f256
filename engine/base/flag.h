/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The word by which signal handlers and other threads ask computations to end. */
#pragma once

#include <signal.h>

#ifdef __cplusplus
typedef volatile sig_atomic_t strut_flag; /* its size; C++ has atomics of its own */
#else
/** Non-zero asks for an end. It is free of locks, so that handlers of signals may set it. */
typedef _Atomic sig_atomic_t strut_flag;
#endif

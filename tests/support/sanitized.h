/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Sanitizers take memory and time of their own, and stop the program where memory is refused.
 * ADDRESS_SANITIZED: 1 under the address sanitizer. SANITIZED: 1 under that of addresses or threads.
 */
#pragma once

#ifndef __has_feature
#define __has_feature(x) 0
#endif

#if defined(__SANITIZE_ADDRESS__) || __has_feature(address_sanitizer)
#define ADDRESS_SANITIZED 1
#else
#define ADDRESS_SANITIZED 0
#endif

#if ADDRESS_SANITIZED || defined(__SANITIZE_THREAD__) || __has_feature(thread_sanitizer)
#define SANITIZED 1
#else
#define SANITIZED 0
#endif

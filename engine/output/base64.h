/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Bytes as text (RFC 4648, with padding).
 */
#ifndef STRUT_ENGINE_OUTPUT_BASE64_H
#define STRUT_ENGINE_OUTPUT_BASE64_H

#include <stddef.h>

#include "engine/output/buffer.h"

/** Appends (count) bytes in base64, without line breaks. */
STRUT_API void strut_base64_add(strut_buffer *buffer, const void *bytes, size_t count);

#endif

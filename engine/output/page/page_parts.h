/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The parts of the page's data.
 */
#ifndef STRUT_ENGINE_OUTPUT_PAGE_PAGE_PARTS_H
#define STRUT_ENGINE_OUTPUT_PAGE_PAGE_PARTS_H

#include "engine/output/buffer.h"
#include "engine/output/json_value.h"
#include "engine/output/page/page.h"

/** The data as a whole, safe inside <script>: a block of strut_allocate, or NULL. */
char *strut_page_data(const strut_page *page, strut_page_frames *frames);

/**
 * Adds the keys equilibria, equilibria_remark, equilibria_left_out and barriers. False when memory
 * is out.
 */
bool strut_page_add_equilibria(strut_json *json, const strut_page *page);

/**
 * Appends the value of the key motion, about `room` bytes of it, or null. Frames from the first that
 * is not finite, or far out of all bounds, are left out; then as many evenly as it takes.
 */
void strut_page_add_motion(strut_buffer *buffer, const strut_page *page, size_t room,
                           strut_page_frames *frames);

#endif

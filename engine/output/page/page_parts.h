/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The parts of the page's data. Everything is added to JSON that forgets nothing of a failure: whoever
 * ends it asks (json_value.h); and the texts return NULL when memory is out.
 */
#ifndef STRUT_ENGINE_OUTPUT_PAGE_PAGE_PARTS_H
#define STRUT_ENGINE_OUTPUT_PAGE_PAGE_PARTS_H

#include "engine/output/buffer.h"
#include "engine/output/json_value.h"
#include "engine/output/page/page.h"

/** The data as a whole, safe inside <script>: a block of strut_allocate, or NULL. */
char *strut_page_data(const strut_page *page, strut_page_frames *frames);

/** Keys equilibria, equilibria_remark, equilibria_left_out and barriers. False when memory is out. */
bool strut_page_add_equilibria(strut_json *json, const strut_page *page);

/** Key summary: rows of text from the text of a summary.json, or none where it is NULL. */
void strut_page_add_summary(strut_json *json, const char *summary, const strut_scene *scene);

/**
 * Appends the value of the key motion, about `room` bytes of it, or null: frames from the first that is
 * not finite, or far out of all bounds, are left out, and then as many evenly as it takes.
 */
void strut_page_add_motion(strut_buffer *buffer, const strut_page *page, size_t room,
                           strut_page_frames *frames);

#endif

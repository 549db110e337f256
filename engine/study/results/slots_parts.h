/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What slots.c, slots_header.c and tables of slots share. Internal to engine/study. */
#pragma once

#include "engine/base/memory.h"
#include "engine/output/buffer.h"
#include "engine/study/results/slots.h"

enum { STRUT_SLOT_HEAD = 24 }; /* bytes: checksum, point, status */

/** Offsets in a file. */
typedef struct strut_slots_layout {
  size_t header_bytes, slot_bytes;
  size_t number_count, word_count;
} strut_slots_layout;

/** STRUT_USAGE if the plan's points or columns are invalid. Replaces a stride of 0 by 1. */
strut_status strut_slots_lay_out(strut_slots_description *plan, strut_slots_layout *layout,
                                 strut_error *error);
/** The header of a plan, whose texts are in it from now on: layout->header_bytes bytes in the arena, or NULL. */
unsigned char *strut_slots_header(strut_slots_description *plan, const strut_slots_layout *layout,
                                  strut_arena *arena);
/** An open file of slots, of which up to `most` bytes may be what a stopped process left. */
typedef struct strut_slots_file {
  int descriptor;
  const char *path;
  size_t most;
} strut_slots_file;

/**
 * Reads the header of an open file into *plan, its texts owned by the arena. *torn is set, with
 * STRUT_OK, where the file has up to `most` bytes and these are zeros or the begin of a header:
 * the process that wrote it was stopped before the first slot.
 */
strut_status strut_slots_read_header(const strut_slots_file *file, strut_slots_description *plan,
                                     strut_slots_layout *layout, strut_arena *arena, bool *torn,
                                     strut_error *error);
/** Names a difference between two plans, such as "the columns"; NULL: none. */
const char *strut_slots_difference(const strut_slots_description *first,
                                   const strut_slots_description *second);
/** STRUT_USAGE with the difference, unless both have the same study and points. */
strut_status strut_slots_compare(const char *path, const strut_slots_description *there,
                                 const strut_slots_description *wanted, strut_error *error);
/** Appends the header of a column of the table, and a comma. */
void strut_study_table_add_name(strut_buffer *line, const strut_slot_column *column);
/**
 * Reads up to `length` bytes at `offset`: how many there were, or -1 with errno. Writes all, or
 * returns false with errno.
 */
int64_t strut_slots_pread(int descriptor, void *bytes, size_t length, int64_t offset);
bool strut_slots_pwrite(int descriptor, const void *bytes, size_t length, int64_t offset);

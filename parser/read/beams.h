/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What the files that read beams share. */
#ifndef STRUT_PARSER_READ_BEAMS_H
#define STRUT_PARSER_READ_BEAMS_H

#include "parser/read/reader.h"

/** Node k of the beam, from 0 to its number of parts. */
static inline int32_t strut_beam_node(const strut_beam *b, int32_t k) {
  return k == 0 ? b->node[0] : k == b->parts ? b->node[1] : b->first_node + k - 1;
}

/** An array with place for `more` things at its end; NULL: out of memory. */
void *strut_lengthen(strut_reader *reader, strut_arena *arena, const void *old, size_t count,
                     size_t more, size_t size);
double strut_beam_part_length(const strut_reader *reader, const strut_beam *b);
/** Adds a hinge of the beam, for which there is space. */
void strut_add_beam_hinge(strut_reader *reader, strut_beam *b, const char *name,
                          const int32_t node[3], double stiffness, double damping,
                          double rest_angle);

/* beam_joints.c: ends that are clamped to members and to other beams */

/** Reads `clamped_to`. */
bool strut_read_clamped_to(strut_reader *reader, const strut_slot *slot, strut_beam *b);
/** Adds the hinges of such ends, after all others of beams. */
void strut_add_joint_hinges(strut_reader *reader);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What the parts of a study of branches share. Internal to engine/study/follow. */
#ifndef STRUT_ENGINE_STUDY_FOLLOW_PARTS_H
#define STRUT_ENGINE_STUDY_FOLLOW_PARTS_H

#include "engine/output/buffer.h"
#include "engine/output/json_value.h"
#include "engine/study/follow/follow_points.h"
#include "engine/study/follow/follow_study.h"

/** Finds the smallest kicks that a stable motion y (both) at the system's value does not survive. */
strut_status strut_follow_push(strut_follow_system *s, const double *y, strut_follow_basin *basin,
                               strut_error *error);

/**
 * Follows the curves through all special points of the result's branches; `like` is an open system over the
 * first parameter with the motions' units.
 */
strut_status strut_follow_find_curves(const strut_follow_options *o, strut_follow_result *r,
                                      const strut_follow_system *like, strut_error *error);
/** What the JSON text and the table tell of curves. */
void strut_follow_curves_json(const strut_follow_result *r, strut_json *json);
void strut_follow_curves_table(const strut_follow_result *r, strut_buffer *t);
/** Header and cell of a column of the axes, as CSV, in the arena. False: out of memory. */
bool strut_follow_axis_cell(const strut_slot_column *column, strut_study_value value,
                            strut_arena *arena, char **name, char **cell);

#endif

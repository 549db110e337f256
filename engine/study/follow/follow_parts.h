/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What the parts of a study of branches share. Internal to engine/study/follow. */
#ifndef STRUT_ENGINE_STUDY_FOLLOW_PARTS_H
#define STRUT_ENGINE_STUDY_FOLLOW_PARTS_H

#include "engine/study/follow/follow_points.h"
#include "engine/study/follow/follow_study.h"

/** Finds the smallest kicks that a stable motion y (both) at the system's value does not survive. */
strut_status strut_follow_push(strut_follow_system *s, const double *y, strut_follow_basin *basin,
                               strut_error *error);

/** Header and cell of a column of the axes, as CSV, in the arena. False: out of memory. */
bool strut_follow_axis_cell(const strut_slot_column *column, strut_study_value value,
                            strut_arena *arena, char **name, char **cell);

#endif

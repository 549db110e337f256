/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Between the values of a search's variables and points of the unit box.
 */
#ifndef STRUT_ENGINE_STUDY_SEARCH_BOX_H
#define STRUT_ENGINE_STUDY_SEARCH_BOX_H

#include "engine/scene/study.h"

/**
 * The value of a variable at a number of the box; numbers beyond it are brought in first. Values are rounded
 * to 15 digits. Whole numbers and choices have equal parts of the box each.
 */
strut_study_value strut_search_value(const strut_search_variable *variable, double number);
/** A number of the box that has this value. */
double strut_search_number(const strut_search_variable *variable, strut_study_value value);
/** Where the first search begins. */
double strut_search_start(const strut_search_variable *variable);
/** Do both have the same bits, or the same text? */
bool strut_search_same(strut_study_value a, strut_study_value b);
/** How many different values there are; 0: a continuum. */
int64_t strut_search_count(const strut_search_variable *variable);
/** Is it the lower (-1) or upper (1) bound of a range? 0: neither. */
int strut_search_bound(const strut_search_variable *variable, strut_study_value value);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Keys of one text laid over those of another, before either is read.
 */
#ifndef STRUT_PARSER_STUDY_OVERLAY_H
#define STRUT_PARSER_STUDY_OVERLAY_H

#include "parser/yaml/diagnostics.h"
#include "parser/yaml/document.h"

/** Set in the line of every place that comes from what was laid over. */
#define STRUT_OVERLAY_LINE ((uint32_t)1 << 30)

/** The same place, marked as one of the text laid over. */
strut_place strut_overlay_place(strut_place place);

/**
 * Lays the mapping `value` over the section of that name of the document: its keys replace those of
 * the section, mappings within mappings too, and those that say the same in another way (a duration
 * for periods, a step for an accuracy, a configuration for an equilibrium). False: memory is out.
 */
bool strut_overlay(strut_document *document, const char *section, const strut_tree *value);

/**
 * Moves messages at marked places from `from` to `over`, unmarked. False: memory is out.
 */
bool strut_overlay_split(strut_diagnostics *from, strut_diagnostics *over);

#endif

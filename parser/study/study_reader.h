/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the parts of the study reader share. Internal to parser/.
 */
#ifndef STRUT_PARSER_STUDY_STUDY_READER_H
#define STRUT_PARSER_STUDY_STUDY_READER_H

#include "parser/read/reader.h"
#include "parser/study/read_study.h"

typedef struct strut_study_reader {
  strut_reader *reader; /* of the study's text: its messages and its tree */
  strut_study_file *file;
  const strut_declared *declared; /* (declared_count) the model's parameters */
  size_t declared_count;
  strut_name_map given; /* parameters that the study gives: their declared index */
  size_t variant_count; /* 0: the study has none */
  const char **variant_names;
} strut_study_reader;

/** The parameter of the model that a key names; NULL where that was reported. */
const strut_declared *strut_study_parameter(strut_study_reader *r, const strut_tree *key);
/**
 * Opens the model that the study names, once for each variant, lays their keys over it, and finds its
 * parameters.
 */
strut_status strut_study_open_sources(strut_study_reader *r, strut_fields *top, strut_error *error);
/** Reads the axes into the study, and their columns. */
void strut_study_read_axes(strut_study_reader *r, const strut_tree *list);

/** Set in the line of every place of the study's text within the tree of the model. */
#define STRUT_OVERLAY_LINE ((uint32_t)1 << 30)

/** The place, marked as one of the study's text. */
strut_place strut_overlay_place(strut_place place);

/** Moves messages and notes at marked places from `from` to `over`, unmarked. False: memory is out. */
bool strut_overlay_split(strut_diagnostics *from, strut_diagnostics *over);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What a command makes of a result that rows describe: the files of -o, the figure of --plot, what is printed. */
#ifndef STRUT_PARSER_PROGRAM_OUTPUTS_H
#define STRUT_PARSER_PROGRAM_OUTPUTS_H

#include "engine/output/draw/chart.h"
#include "engine/scene/value_rows.h"
#include "parser/program/options.h"

/** Draws what the index says of a result. */
typedef strut_status strut_output_draw(const strut_plot *plot, const void *result, size_t index,
                                       strut_error *error);

typedef struct strut_output_file {
  const char *name;
  const char *list; /* of a CSV: the path of its structs; NULL: the whole as JSON, or a picture */
  const strut_value_rows *rows; /* of a CSV; NULL: all of the result's */
  strut_output_draw *draw;      /* of a picture */
  size_t index;                 /* what is drawn */
  double width;                 /* [pt]; 0: as --plot has it */
  bool absent;                  /* this result has no such file */
} strut_output_file;

typedef struct strut_outputs {
  const strut_value_rows *rows;
  const void *result;
  const struct strut_scene *scene; /* of the result, or NULL */
  const strut_output_file *files;  /* the last has no name */
  strut_output_draw *draw;         /* of --plot */
  size_t index;
  const char *printed; /* list that --csv prints */
} strut_outputs;

/** Finds out, before anything is computed, whether the files can go where -o wants them. */
strut_status strut_outputs_check(const strut_arguments *arguments, const strut_output_file *files);
/** Writes all files or none, draws, prints. Messages go to stderr. */
strut_status strut_outputs_make(const strut_arguments *arguments, const strut_plot *plot,
                                const strut_outputs *outputs);

#endif

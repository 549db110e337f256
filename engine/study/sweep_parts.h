/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the parts of the sweep share. Internal to engine/study.
 */
#ifndef STRUT_ENGINE_STUDY_SWEEP_PARTS_H
#define STRUT_ENGINE_STUDY_SWEEP_PARTS_H

#include "engine/run/recorder.h"
#include "engine/run/summary.h"
#include "engine/study/standing.h"
#include "engine/study/sweep.h"

/** The room of one thread, taken once. */
typedef struct strut_sweep_room {
  strut_study_value *values;       /* (axis columns) */
  double *numbers;                 /* (columns) */
  char (*words)[STRUT_SLOT_WORD];  /* (columns) */
  size_t number_count, word_count; /* filled so far */
  char message[STRUT_SLOT_MESSAGE];
  strut_slot row;
} strut_sweep_room;

/* sweep_columns.c */

/** Appends what is kept of a run; summary NULL: nothing of it is known. outcome may be "". */
void strut_sweep_fill(const strut_sweep_plan *plan, const strut_scene *scene,
                      const strut_summary *summary, const char *outcome, strut_sweep_room *room);
void strut_sweep_number(strut_sweep_room *room, double value);
void strut_sweep_word(strut_sweep_room *room, const char *word);

/* sweep_point.c */

typedef struct strut_sweep_worker {
  const strut_sweep_plan *plan;
  const strut_sweep_options *options;
  strut_standing *standing;
} strut_sweep_worker;

/**
 * Computes a point into room->row. STRUT_OK also where the point failed, which the row says; else what
 * stops the sweep.
 */
strut_status strut_sweep_point(const strut_sweep_worker *worker, int64_t point,
                               strut_sweep_room *room, strut_error *error);

/* sweep_record.c */

/** A directory of results for a run of a sweep. Zero-initialise. */
typedef struct strut_sweep_record strut_sweep_record;
/** Takes results of a point into directory/runs/POINT. NULL with the error. */
strut_sweep_record *strut_sweep_record_begin(const char *directory, int64_t point,
                                             const char *scene_text, strut_error *error);
strut_sink *strut_sweep_record_sink(strut_sweep_record *record);
/** Ends it: complete, or with a run that never began not at all. Frees it. */
strut_status strut_sweep_record_end(strut_sweep_record *record, const strut_scene *scene,
                                    const strut_summary *summary, bool keep, strut_error *error);

#endif

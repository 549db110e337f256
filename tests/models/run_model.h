/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A model file read, compiled and run in one call, with its rows kept.
 */
#pragma once

#include "engine/run/recorder.h"
#include "engine/run/simulate.h"
#include "parser/language/read/read_scene.h"
#include "tests/support/test.h"

typedef struct model_run {
  strut_setup setup;
  strut_model *model;
  strut_summary summary;
  /* what was recorded */
  strut_record_layout layout; /* its channels live as long as the run's own: copied below */
  strut_record_channel channels[6];
  size_t row_count, row_room;
  double *rows; /* (row_count, layout.width) */
} model_run;

/** "a=1", "b=2", NULL as overrides. */
#define set_none ((const char *const[]){NULL})
#define set_to(...) ((const char *const[]){__VA_ARGS__, NULL})

/** Reads models/NAME.yaml; fails the test if it is not valid. */
model_run model_read(const char *name, const char *const *settings);
/** Reads a scene from its text, whose first line, that of all scenes, may be left out; `name` is for messages. */
model_run model_read_text(const char *name, const char *text, const char *const *settings);
/** The same of a text in which `format` leaves places open, as printf has it. */
__attribute__((format(printf, 1, 2))) model_run model_read_format(const char *format, ...);
/** Compiles and runs what was read (and perhaps changed); fails the test unless it completes. */
void model_simulate(model_run *run);
/** The same by that method. */
void model_simulate_by(model_run *run, const char *method);
void model_run_free(model_run *run);

/** Position of a node at the end, [m]; fails the test if there is none of that name. */
const double *model_position(const model_run *run, const char *node);
/** Value in a row, e.g. (run, row, STRUT_CHANNEL_FORCE, "top", 0). */
double model_value(const model_run *run, size_t row, strut_channels channel, const char *item,
                   size_t component);

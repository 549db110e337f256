/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/sweep_study.h"

#include <stdio.h>
#include <string.h>

#include "engine/base/checksum.h"
#include "engine/study/sweep/grid.h"
#include "parser/cli/streams.h"
#include "parser/cli/sweep_figures.h"
#include "parser/write/write_scene.h"

enum { MOST_MESSAGES = 50 };

static strut_status complain(strut_study_file *file, strut_status status, strut_error *error) {
  if (status == STRUT_BAD_SCENE && !error->message[0]) {
    const char *messages = strut_study_messages(file, MOST_MESSAGES);
    if (!messages) return strut_print_out_of_memory();
    fputs(messages, stderr);
  } else if (status != STRUT_OK) {
    if (!error->message[0]) strut_fail(error, status, "%s", strut_status_text(status));
    strut_print_error(error);
  }
  return status;
}

/* The first point, then both ends of each axis with the others at their first values. */
static strut_status try_ends(strut_study_file *file) {
  const strut_study *study = &file->study;
  strut_study_value *values = strut_allocate(file->column_count, sizeof *values);
  if (!values) return STRUT_NO_MEMORY;
  strut_grid_values(study, 0, values);
  strut_status status = strut_study_try(file, values);
  int64_t stride = 1;
  for (size_t a = study->axis_count; a-- > 0 && !status;) {
    if (study->axes[a].count > 1) {
      strut_grid_values(study, stride * (study->axes[a].count - 1), values);
      status = strut_study_try(file, values);
    }
    stride *= study->axes[a].count;
  }
  strut_release(values);
  return status;
}

static strut_status setup_of(void *context, const strut_study_value *values, strut_setup *setup,
                             strut_error *error) {
  return strut_study_setup(context, values, setup, error);
}

/* What names the study: all that decides its results, and the program. */
static bool identify(const strut_study_file *file, uint8_t hash[STRUT_STUDY_HASH]) {
  char *text = strut_study_identity(file);
  if (!text) return false;
  size_t length = strlen(text);
  for (uint64_t i = 0; i < 2; i++) {
    uint64_t seed = strut_checksum(STRUT_VERSION, strlen(STRUT_VERSION), i);
    uint64_t sum = strut_checksum(text, length, seed);
    for (size_t k = 0; k < 8; k++) hash[8 * i + k] = (uint8_t)(sum >> 8 * k);
  }
  strut_release(text);
  return true;
}

strut_status strut_sweep_study_open(const strut_arguments *arguments, strut_sweep_study *study) {
  strut_error error = {0};
  strut_study_file *file = &study->file;
  const strut_sweep_scenes scenes = {setup_of, strut_setup_write, file};
  strut_status status = strut_study_open(arguments->model, arguments->overrides,
                                         arguments->override_count, file, &error);
  if (!status) status = try_ends(file);
  if (status) return complain(file, status, &error);
  status = strut_sweep_plan_make(&file->study, &scenes, &study->plan, &error);
  if (!status) status = strut_sweep_figures_check(&study->plan, &error);
  if (!status && !identify(file, study->slots.hash)) status = STRUT_NO_MEMORY;
  if (status) return complain(file, status, &error);
  study->slots.version = STRUT_VERSION;
  study->slots.name = file->study.name;
  study->slots.points = study->slots.count = study->plan.points;
  study->slots.columns = study->plan.columns;
  study->slots.column_count = study->plan.column_count;
  return STRUT_OK;
}

void strut_sweep_study_close(strut_sweep_study *study) {
  strut_sweep_plan_free(&study->plan);
  strut_study_close(&study->file);
}

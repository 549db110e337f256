/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records one run of a sweep as `strut run -o` does. The HDF5 library is not thread-safe. */
#include <dirent.h>
#include <stdio.h>
#include <unistd.h>

#include "engine/output/file.h"
#include "engine/output/record_files.h"
#include "engine/output/results.h"
#include "engine/output/run_report.h"
#include "engine/study/sweep/sweep_parts.h"

struct strut_sweep_record {
  strut_results results;
  char *scene_text;
  strut_sink *hdf5;
  strut_sink outer;
};

static strut_status begin(void *context, const strut_record_layout *layout, strut_error *error) {
  strut_sink *hdf5 = ((strut_sweep_record *)context)->hdf5;
  strut_status status;
#ifdef _OPENMP
#pragma omp critical(strut_sweep_hdf5)
#endif
  status = hdf5->begin(hdf5->context, layout, error);
  return status;
}

static strut_status take(void *context, const double *rows, size_t count, strut_error *error) {
  strut_sink *hdf5 = ((strut_sweep_record *)context)->hdf5;
  strut_status status;
#ifdef _OPENMP
#pragma omp critical(strut_sweep_hdf5)
#endif
  status = hdf5->rows(hdf5->context, rows, count, error);
  return status;
}

static strut_status end(void *context, strut_status run_status, strut_error *error) {
  strut_sink *hdf5 = ((strut_sweep_record *)context)->hdf5;
  strut_status status;
#ifdef _OPENMP
#pragma omp critical(strut_sweep_hdf5)
#endif
  status = hdf5->end(hdf5->context, run_status, error);
  return status;
}

static void discard(strut_sweep_record *record) {
#ifdef _OPENMP
#pragma omp critical(strut_sweep_hdf5)
#endif
  strut_hdf5_free(record->hdf5);
  strut_results_abandon(&record->results); /* does nothing once it is complete */
  strut_release(record->scene_text);
  strut_release(record);
}

strut_sweep_record *strut_sweep_record_begin(const char *directory, int64_t point,
                                             const char *scene_text, strut_error *error) {
  strut_arena arena = {0};
  strut_sweep_record *record = strut_allocate(1, sizeof *record);
  char *path = strut_arena_format(&arena, "%s/runs/%09lld", directory, (long long)point);
  char *text = strut_arena_format(&arena, "%s", scene_text);
  if (!record || !path || !text) {
    strut_no_memory(error, "");
    strut_release(record);
    strut_arena_free(&arena);
    return NULL;
  }
  strut_status status = strut_results_begin(&record->results, path, error);
  if (!status) {
    record->hdf5 = strut_hdf5_create(record->results.stage, text);
    if (!record->hdf5) status = strut_no_memory(error, "");
  }
  if (!status) status = strut_file_write_text(record->results.stage, "scene.yaml", text, error);
  strut_arena_free(&arena);
  if (status) {
    discard(record);
    return NULL;
  }
  record->outer = (strut_sink){record, begin, take, end, record->hdf5->channels};
  return record;
}

void strut_sweep_records_clear(const char *directory) {
  strut_arena arena = {0};
  char *runs = strut_arena_format(&arena, "%s/runs", directory);
  DIR *entries = runs ? opendir(runs) : NULL;
  for (struct dirent *entry = entries ? readdir(entries) : NULL; entry; entry = readdir(entries)) {
    if (entry->d_name[0] == '.') continue;
    char *path = strut_arena_format(&arena, "%s/%s", runs, entry->d_name);
    if (path && strut_stage_sweep(path)) rmdir(path); /* fails unless it is empty */
  }
  if (entries) closedir(entries);
  strut_arena_free(&arena);
}

strut_sink *strut_sweep_record_sink(strut_sweep_record *record) { return &record->outer; }

strut_status strut_sweep_record_end(strut_sweep_record *record, const strut_scene *scene,
                                    const strut_summary *summary, bool keep, strut_error *error) {
  strut_status status = STRUT_OK;
  if (keep) {
    char *json = strut_summary_json(summary, scene, false);
    if (!json) status = strut_no_memory(error, "");
    if (!status) status = strut_file_write_text(record->results.stage, "summary.json", json, error);
    if (!status) status = strut_results_commit(&record->results, error);
    strut_release(json);
  }
  discard(record);
  return status;
}

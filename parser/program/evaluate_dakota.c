/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One evaluation by the files of DAKOTA. */
#include <stdio.h>
#include <string.h>

#include "engine/base/number_text.h"
#include "engine/output/buffer.h"
#include "engine/output/file.h"
#include "parser/program/commands.h"
#include "parser/program/evaluate.h"
#include "parser/program/streams.h"
#include "parser/study/study_request.h"

enum { MOST_MESSAGES = 50 };

/* The result of a function: the one of its name, or the only number where there is one of each. */
static const strut_evaluated *find_result(const strut_evaluation *evaluation,
                                          const strut_dakota_file *file, size_t function) {
  const strut_evaluated *only = NULL;
  size_t numbers = 0;
  for (size_t i = 0; i < evaluation->count; i++) {
    const strut_evaluated *r = &evaluation->results[i];
    if (r->word) continue;
    if (strcmp(r->name, file->functions[function].name) == 0) return r;
    if (strcmp(r->name, STRUT_KEPT_COLUMN) == 0) continue; /* it is there without being asked for */
    only = r;
    numbers++;
  }
  return numbers == 1 && file->function_count == 1 ? only : NULL;
}

static strut_status refuse_function(const strut_evaluation *evaluation,
                                    const strut_dakota_function *f, const char *path) {
  char names[300] = "";
  size_t used = 0;
  for (size_t i = 0; i < evaluation->count && used < sizeof names - 1; i++) {
    if (evaluation->results[i].word) continue;
    int n = snprintf(names + used, sizeof names - used, "%s%s", used ? ", " : "",
                     evaluation->results[i].name);
    used += n > 0 ? (size_t)n : 0;
  }
  fprintf(stderr,
          "strut: error: %s:%u:%u: the response '%s' is no result: say response_descriptors of "
          "these to DAKOTA, or choose others by --keep: %s\n",
          path, f->place.line, f->place.column, f->name, names);
  return STRUT_BAD_SCENE;
}

/* A line for each value that is wanted. STRUT_DIVERGED: one is missing. */
static strut_status list_values(const strut_evaluation *evaluation, const strut_dakota_file *file,
                                const char *path, strut_buffer *text) {
  for (size_t i = 0; i < file->function_count; i++) {
    const strut_dakota_function *f = &file->functions[i];
    const strut_evaluated *r = find_result(evaluation, file, i);
    char number[STRUT_NUMBER_TEXT];
    if (!r) return refuse_function(evaluation, f, path);
    if (!(f->wanted & 1)) continue;
    if (r->number != r->number) {
      fprintf(stderr, "strut: this evaluation has no '%s'\n", r->name);
      return STRUT_DIVERGED;
    }
    strut_number_text(r->number, number);
    strut_buffer_add(text, "%s %s\n", number, *f->name ? f->name : r->name);
  }
  return STRUT_OK;
}

/* What the results file says: values, or FAIL, after which DAKOTA continues as its input says. */
static strut_status write_results(strut_status status, strut_buffer *text, const char *results) {
  strut_error error = {0};
  if (status == STRUT_DIVERGED) {
    strut_release(strut_buffer_take(text));
    strut_buffer_add(text, "FAIL\n");
    status = STRUT_OK;
  }
  strut_buffer_add(text, "%s", ""); /* a text even where no value is wanted */
  char *whole = strut_buffer_take(text);
  if (!status && !whole) status = strut_print_out_of_memory();
  if (!status) status = strut_print_failure(strut_file_write_path(results, whole, &error), &error);
  strut_release(whole);
  return status;
}

static strut_status compute(const strut_evaluate_task *task, const strut_dakota_file *file,
                            strut_request *request, strut_setup *setup, const char *path,
                            strut_buffer *text) {
  strut_evaluation evaluation;
  strut_status status = strut_evaluate(task->evaluator, &request->study, setup, &evaluation);
  if (status) return status;
  for (size_t i = 0; i < evaluation.warning_count; i++)
    fprintf(stderr, "strut: warning: %s\n", evaluation.warnings[i]);
  if (!evaluation.status) return list_values(&evaluation, file, path, text);
  fprintf(stderr, "strut: %s\n", evaluation.message);
  return STRUT_DIVERGED;
}

static void print_findings(strut_diagnostics *diagnostics, const strut_request_findings *findings) {
  const char *messages =
      diagnostics->count ? strut_diagnostics_render(diagnostics, MOST_MESSAGES) : "";
  if (messages) fputs(messages, stderr);
  for (size_t i = 0; i < findings->count && i < STRUT_REQUEST_FINDINGS; i++)
    fprintf(stderr, "strut: error: %s\n", findings->text[i]);
}

strut_status strut_evaluate_dakota(const strut_evaluate_task *task, const char *parameters,
                                   const char *results) {
  char *text = NULL;
  size_t length = 0;
  strut_error error = {0};
  strut_diagnostics diagnostics = {0};
  strut_dakota_file file = {0};
  strut_request request;
  strut_setup setup;
  strut_buffer values = {0};
  strut_request_findings findings = {.file = parameters};
  strut_request_begin(task->file, &request);
  strut_status status = strut_file_read(parameters, &text, &length, &error);
  strut_print_failure(status, &error);
  if (!status) {
    strut_diagnostics_source(&diagnostics, parameters, text, length);
    status = strut_request_choose(&request, &task->choice, &error);
    if (!status) status = strut_dakota_read(text, length, &diagnostics, &file);
    if (!status) status = strut_dakota_request(task->file, &file, &request, &diagnostics);
    if (!status) status = strut_request_setup(task->file, &request, &setup, &findings);
    print_findings(&diagnostics, &findings);
    if (status == STRUT_NO_MEMORY) strut_print_out_of_memory();
    if (!status)
      status = compute(task, &file, &request, &setup, parameters, &values);
    else if (status == STRUT_BAD_SCENE && findings.count > 0)
      status = STRUT_DIVERGED; /* values */
    status = write_results(status, &values, results);
  }
  strut_request_free(&request);
  strut_dakota_free(&file);
  strut_diagnostics_free(&diagnostics);
  strut_release(text);
  return status;
}

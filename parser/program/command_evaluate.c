/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <stdio.h>
#include <string.h>

#include "engine/output/json_value.h"
#include "parser/command/option_values.h"
#include "parser/program/commands.h"
#include "parser/program/evaluate.h"
#include "parser/program/streams.h"

enum { MOST_MESSAGES = 50, MOST_THREADS = 4096 };

static const strut_option options[] = {
    {STRUT_OPTION_COMPUTE, "compute", "WHAT",
     "run (default), equilibria, modes, rigidity, path or form"},
    {STRUT_OPTION_KEEP, "keep", "WORD,...", "which results, as 'keep' of a study"},
    {STRUT_OPTION_AT, "at", "NAME", "the equilibrium of modes, rigidity or path"},
    {STRUT_OPTION_IN, "in", "FILE", "read requests from FILE (default: standard input)"},
    {STRUT_OPTION_OUT, "out", "FILE", "write answers to FILE (default: standard output)"},
    {STRUT_OPTION_DAKOTA, "dakota", NULL,
     "read DAKOTA's PARAMETERS file and write its RESULTS file"},
    {STRUT_OPTION_THREADS, "threads", "N", "number of threads of a search (default 1)"},
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    {STRUT_OPTION_COUNT_POINTS, "count", NULL, "only print the names and units of the results"},
    {STRUT_OPTION_JSON, "json", NULL, "with --count: print one JSON object"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_status check_arguments(const strut_arguments *a) {
  const strut_command *command = &strut_command_evaluate;
  const char *in = strut_option_text(a, STRUT_OPTION_IN);
  bool files = in || strut_option_text(a, STRUT_OPTION_OUT);
  if (a->json && !a->count_points)
    return strut_print_usage_error(command, "--json is for --count: answers are JSON anyway");
  if (a->count_points && (a->dakota || files || a->model_count > 1))
    return strut_print_usage_error(command, "--count computes nothing: it goes with a model alone");
  if (a->dakota && files)
    return strut_print_usage_error(command, "--dakota names its files itself: omit --in and --out");
  if (a->dakota && a->model_count != 3)
    return strut_print_usage_error(
        command, "--dakota expects MODEL PARAMETERS RESULTS, found %zu arguments", a->model_count);
  if (!a->dakota && a->model_count > 1)
    return strut_print_usage_error(command, "unexpected argument '%s'", a->models[1]);
  bool same = strcmp(a->model, "-") == 0 &&
              (a->dakota ? strcmp(a->models[1], "-") == 0 : !in || strcmp(in, "-") == 0);
  if (same && !a->count_points)
    return strut_print_usage_error(command,
                                   "model and requests cannot both come from standard input");
  return STRUT_OK;
}

static strut_status report(strut_study_file *file, strut_status status, strut_error *error) {
  if (status == STRUT_BAD_SCENE && !error->message[0]) {
    const char *messages = strut_study_messages(file, MOST_MESSAGES);
    if (!messages) return strut_print_out_of_memory();
    fputs(messages, stderr);
  } else if (status) {
    if (!error->message[0]) strut_fail(error, status, "%s", strut_status_text(status));
    strut_print_error(error);
  }
  return status;
}

/* The model must make a scene without a request, and give what is to be kept. */
static strut_status try_model(const strut_evaluate_task *task, strut_study_file *file) {
  strut_error error = {0};
  strut_setup setup;
  strut_request request;
  strut_request_findings findings = {.file = "--keep"};
  strut_request_begin(file, &request);
  strut_status status = strut_request_choose(&request, &task->choice, &error);
  if (status) {
    strut_print_usage_error(&strut_command_evaluate, "%s", error.message);
    strut_request_free(&request);
    return STRUT_USAGE;
  }
  status = strut_request_setup(file, &request, &setup, &findings);
  if (!status) strut_setup_free(&setup);
  for (size_t i = 0; i < findings.count && i < STRUT_REQUEST_FINDINGS; i++)
    fprintf(stderr, "strut: error: %s\n", findings.text[i]);
  if (status == STRUT_NO_MEMORY) strut_print_out_of_memory();
  strut_request_free(&request);
  return status;
}

static strut_status give_setup(void *context, const strut_study_value *values, strut_setup *setup,
                               strut_error *error) {
  const strut_evaluate_task *task = context;
  strut_request request;
  strut_request_findings findings = {.file = ""};
  (void)values;
  strut_request_begin(task->file, &request);
  strut_status status = strut_request_choose(&request, &task->choice, error);
  if (!status) status = strut_request_setup(task->file, &request, setup, &findings);
  strut_request_free(&request);
  return status;
}

/* The results with their units: a line each, or a list of objects. */
static strut_status print_results(const strut_sweep_plan *plan, bool as_json) {
  strut_json json = strut_json_begin();
  struct cJSON *list = strut_json_array(&json, json.root, "results");
  for (size_t i = 0; i < plan->column_count; i++) {
    const strut_slot_column *c = &plan->columns[i];
    bool plain = c->word || !*c->unit || strcmp(c->unit, "1") == 0;
    struct cJSON *item = strut_json_object(&json, list, NULL);
    strut_json_text(&json, item, "name", c->name);
    strut_json_text(&json, item, "unit", plain ? "1" : c->unit);
    strut_json_bool(&json, item, "text", c->word);
    if (!as_json && plain) printf("%s\n", c->name);
    if (!as_json && !plain) printf("%s [%s]\n", c->name, c->unit);
  }
  char *text = strut_json_end(&json);
  if (as_json) return strut_print_block(text);
  strut_release(text);
  return STRUT_OK;
}

static strut_status print_columns(strut_evaluate_task *task) {
  strut_error error = {0};
  strut_request request;
  strut_sweep_plan plan = {0};
  const strut_sweep_scenes scenes = {.setup = give_setup, .context = task};
  strut_request_begin(task->file, &request);
  strut_status status = strut_request_choose(&request, &task->choice, &error);
  if (!status) status = strut_sweep_plan_make(&request.study, &scenes, &plan, &error);
  if (!status) status = print_results(&plan, task->arguments->json);
  if (status) strut_print_error(&error);
  strut_sweep_plan_free(&plan);
  strut_request_free(&request);
  return status;
}

static strut_status evaluate(strut_evaluate_task *task) {
  const strut_arguments *a = task->arguments;
  int64_t threads = 1;
  strut_status early = strut_option_integer(&strut_command_evaluate, a, STRUT_OPTION_THREADS, 1,
                                            MOST_THREADS, &threads);
  if (early) return early;
  if (a->count_points) return print_columns(task);
  task->interrupt = strut_interrupt_watch();
  task->evaluator = strut_evaluator_create(task->interrupt, (int)threads);
  if (!task->evaluator) return strut_print_out_of_memory();
  strut_status status = a->dakota ? strut_evaluate_dakota(task, a->models[1], a->models[2])
                                  : strut_evaluate_lines(task);
  strut_evaluator_free(task->evaluator);
  return status;
}

static strut_status run_evaluate(const strut_arguments *arguments) {
  strut_error error = {0};
  strut_study_file file = {0};
  strut_evaluate_task task = {
      .arguments = arguments,
      .file = &file,
      .choice = {.compute = strut_option_text(arguments, STRUT_OPTION_COMPUTE),
                 .keep = strut_option_text(arguments, STRUT_OPTION_KEEP),
                 .at = strut_option_text(arguments, STRUT_OPTION_AT)}};
  strut_status status = check_arguments(arguments);
  if (status) return status;
  status = strut_study_open_either(arguments->model, arguments->overrides,
                                   arguments->override_count, &file, &error);
  report(&file, status, &error);
  if (!status) status = try_model(&task, &file);
  if (!status) status = evaluate(&task);
  strut_study_close(&file);
  return status;
}

const strut_command strut_command_evaluate = {
    .name = "evaluate",
    .model = "MODEL|STUDY",
    .many = true,
    .summary = "answers requests, each a set of parameters, in one process",
    .details =
        "\nEach line of standard input is a request in JSON, such as {\"friction\": 0.2}, or\n"
        "{\"id\": 7, \"set\": {\"friction\": 0.2, \"frequency\": \"12 Hz\"}, \"keep\": "
        "[\"velocity\"]} with\n"
        "compute, keep, at and variant as choices. Numbers are in SI. Each gets one line with "
        "code,\n"
        "status, and results or message, at once and in order; a failure does not end the loop.\n"
        "The axes of a STUDY do not matter; its other keys do.\n"
        "With --dakota, after MODEL: PARAMETERS RESULTS, as DAKOTA calls a driver. The response\n"
        "descriptors name the results; a failed point is written as FAIL.\n"
        "\nExit code: 2 if a request could not be understood, else 3 if one failed, else 5 if one "
        "is\n"
        "less accurate than requested, which its result accuracy_kept says, else 0;\n"
        "with --dakota 0 where RESULTS says FAIL.\n",
    .options = options,
    .run = run_evaluate,
};

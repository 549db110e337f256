/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/commands.h"

#include "engine/base/memory.h"
#include "engine/integrate/integrator.h"
#include "parser/program/check/check_messages.h"
#include "parser/program/command/run_settings.h"
#include "parser/program/open_model.h"
#include "parser/program/streams.h"

static const strut_option options[] = {
    STRUT_SET_OPTION,
    {.table = strut_experiment_options},
    STRUT_PRINT_OPTIONS,
    {.name = NULL},
};

static strut_status print_json(strut_check_result *result, strut_open_report *report) {
  strut_status status = strut_setup_warn(result->setup, &result->found);
  strut_messages_add_diagnostics(&result->messages, &report->diagnostics);
  strut_messages_add_warnings(&result->messages, &result->found, &result->setup->scene,
                              &report->diagnostics);
  result->messages.failed = result->messages.failed || status != STRUT_OK;
  return strut_check_print(result);
}

static strut_status print_valid(const strut_arguments *arguments, strut_check_result *result,
                                strut_open_report *report) {
  result->drawn = strut_allocate((size_t)result->model->length, sizeof *result->drawn);
  if (!result->drawn) return strut_print_out_of_memory();
  const strut_scene *scene = result->model->scene;
  for (size_t i = 0; i < 2 * scene->node_count; i++)
    result->drawn[i] = scene->nodes[i / 2].position[i % 2];
  strut_status status = STRUT_OK;
  if (arguments->json)
    status = print_json(result, report);
  else
    status = strut_check_print_tables(result, strut_report_width(arguments));
  strut_release(result->drawn);
  return status;
}

/* Does the scene fix the method of a run? If not, it is for statics, or --accuracy chooses. */
static bool has_fixed_method(const strut_experiment *experiment) {
  bool by_hand = !(experiment->accuracy > 0.0);
  return by_hand &&
         (experiment->step != 0.0 || experiment->duration != 0.0 || experiment->periods != 0.0);
}

/* What is wrong, as JSON; returns `status`. */
static strut_status print_wrong(strut_status status, const strut_error *error,
                                strut_open_report *report) {
  strut_check_result checked = {.unlisted = report->diagnostics.unstored};
  strut_messages_add_diagnostics(&checked.messages, &report->diagnostics);
  strut_messages_add_error(&checked.messages, report->diagnostics.file, error->message);
  strut_status printed = strut_check_print(&checked);
  return printed != STRUT_OK ? printed : status;
}

static strut_status open_checked(const strut_arguments *arguments, strut_setup *setup,
                                 strut_open_report *report) {
  strut_status status = strut_open_model(arguments, STRUT_OPEN_AS_RUN, setup, report);
  if (!arguments->json) return status;
  bool located = status == STRUT_BAD_SCENE && report->diagnostics.count;
  if (located || report->error.message[0]) return print_wrong(status, &report->error, report);
  return status; /* what is not about the scene was printed */
}

static strut_status check_model(const strut_arguments *arguments, strut_open_report *report) {
  strut_setup setup;
  strut_cost_estimate estimate;
  strut_model *model = NULL;
  strut_error error = {0};
  strut_status status = open_checked(arguments, &setup, report);
  if (status != STRUT_OK) return status;
  status = strut_run_options_apply(arguments, &setup);
  if (status == STRUT_OK) status = strut_model_compile(&setup.scene, &model, &error);
  if (status == STRUT_OK && has_fixed_method(&setup.experiment))
    status = strut_integrator_check(model, &setup.experiment, &error);
  if (status == STRUT_OK) status = strut_cost_estimate_describe(model, &estimate, &error);
  if (status == STRUT_OK) strut_check_bands(model, &setup.experiment);
  if (status == STRUT_OK) status = strut_warn_of_scene(&setup);
  strut_check_result checked = {
      .valid = true, .setup = &setup, .model = model, .estimate = &estimate};
  if (status != STRUT_OK && error.message[0]) /* others are reported already */
    status =
        arguments->json ? print_wrong(status, &error, report) : strut_print_failure(status, &error);
  else if (status == STRUT_OK && (arguments->json || !arguments->quiet))
    status = print_valid(arguments, &checked, report);
  strut_model_free(model);
  strut_setup_free(&setup);
  return status;
}

static strut_status run_check(const strut_arguments *arguments) {
  strut_open_report report = {.prints = !arguments->json};
  if (strut_is_study(arguments->model)) return strut_check_study(arguments);
  strut_status status = check_model(arguments, &report);
  strut_open_report_free(&report);
  return status;
}

static const strut_refused_option refused[] = {
    {"plot", "'strut view' and 'strut run --plot' draw a model"},
    {"output", "it only prints; --json prints everything"},
    {"threads", "nothing takes long enough"},
    {NULL, NULL}};

const strut_command strut_command_check = {
    .name = "check",
    .model = "MODEL",
    .summary = "validates a model and describes what a run of it computes",
    .details =
        "\nPrints the numbers of nodes and members, the largest stable step, and for each member\n"
        "its rest length in each of the four forms that the language accepts. Hinges, cells,\n"
        "collisions and distances have tables of their own.\n"
        "--json lists all messages with their places, for editors; a study is checked, too.\n",
    .options = options,
    .run = run_check,
    .refused = refused,
};

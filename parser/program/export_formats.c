/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/export_formats.h"

#include <stdio.h>
#include <string.h>

#include "engine/output/code/code.h"
#include "engine/output/exports.h"
#include "engine/output/file.h"
#include "engine/run/settle.h"
#include "parser/command/statics_options.h"
#include "parser/program/commands.h"
#include "parser/program/open_model.h"
#include "parser/program/option_values.h"
#include "parser/program/streams.h"

/* A model to export, with its arguments. */
typedef struct exported {
  const strut_arguments *arguments;
  strut_setup setup;
  strut_model *model;
} exported;

static strut_status export_model(const strut_arguments *arguments, strut_open_purpose purpose,
                                 strut_status (*write)(exported *, strut_error *)) {
  exported x = {.arguments = arguments};
  strut_error error = {0};
  strut_status status = strut_open_model(arguments, purpose, &x.setup);
  if (status) return status;
  status = strut_model_compile(&x.setup.scene, &x.model, &error);
  if (!status) status = write(&x, &error);
  if (status && error.message[0]) strut_print_error(&error);
  strut_model_free(x.model);
  strut_setup_free(&x.setup);
  return status;
}

static strut_status write_build(exported *x, strut_error *error) {
  strut_arena arena = {0};
  strut_named_shape shape;
  strut_build build = {.model = x->model};
  strut_status status =
      strut_option_number(&strut_command_export, x->arguments, STRUT_OPTION_ALLOWANCE,
                          STRUT_DIM_LENGTH, &build.allowance);
  if (status) return status;
  if (build.allowance < 0.0)
    return strut_fail(error, STRUT_USAGE, "--allowance expects a length of 0 or more");
  status =
      strut_named_shape_find(x->arguments, x->model, &x->setup.experiment, &arena, &shape, error);
  if (!status) {
    build.q = shape.q;
    build.at = shape.name;
    status = strut_build_write(x->arguments->output, &build, error);
  }
  if (!status && !x->arguments->quiet) status = strut_print_block(strut_build_table(&build));
  strut_arena_free(&arena);
  return status;
}

strut_status strut_export_build(const strut_arguments *arguments) {
  return export_model(arguments, STRUT_OPEN_FOR_ANY, write_build);
}

static strut_status write_mjcf(exported *x, strut_error *error) {
  strut_mjcf mjcf = {0};
  const char *path = x->arguments->output;
  strut_status status = strut_mjcf_make(x->model, &x->setup.experiment, &mjcf, error);
  if (!status) status = strut_file_write_path(path, mjcf.text, error);
  for (size_t i = 0; i < mjcf.note_count && !status; i++)
    fprintf(stderr, "strut: not said in '%s': %s\n", path, mjcf.notes[i]);
  strut_mjcf_free(&mjcf);
  return status;
}

strut_status strut_export_mjcf(const strut_arguments *arguments) {
  if (strut_option_text(arguments, STRUT_OPTION_AT))
    return strut_print_usage_error(&strut_command_export,
                                   "--at is not for mjcf, which begins where a run does");
  return export_model(arguments, STRUT_OPEN_AS_RUN, write_mjcf);
}

/* The prefix that was asked for, or one of the model's file. */
static strut_status choose_prefix(const strut_arguments *arguments, char prefix[65]) {
  const char *asked = strut_option_text(arguments, STRUT_OPTION_PREFIX);
  if (!asked) {
    strut_code_prefix_of(strcmp(arguments->model, "-") ? arguments->model : "", prefix);
    return STRUT_OK;
  }
  if (!strut_code_is_prefix(asked))
    return strut_print_usage_error(&strut_command_export,
                                   "--prefix expects a letter, then letters, digits and "
                                   "underscores, 64 at most, not '%s'",
                                   asked);
  snprintf(prefix, 65, "%s", asked);
  return STRUT_OK;
}

/* The code starts where the run does: settled, where the experiment asks for that. */
static strut_status write_code(exported *x, strut_error *error) {
  static const char *const reals[] = {"double", "float", NULL};
  char prefix[65];
  int real = 0;
  strut_settled_start start = {.model = NULL};
  strut_status status = choose_prefix(x->arguments, prefix);
  if (!status && strut_option_text(x->arguments, STRUT_OPTION_REAL))
    status =
        strut_option_word(&strut_command_export, x->arguments, STRUT_OPTION_REAL, reals, &real);
  if (!status) status = strut_code_check(x->model, error);
  if (!status) status = strut_settle_model(x->model, &x->setup.experiment, NULL, &start, error);
  if (!status) {
    strut_code_options options = {prefix, real == 1, "strut " STRUT_VERSION};
    status = strut_code_write(strut_option_text(x->arguments, STRUT_OPTION_CODE), start.model,
                              &x->setup.experiment, &options, error);
  }
  strut_settled_start_free(&start);
  return status;
}

strut_status strut_export_code(const strut_arguments *arguments) {
  if (strut_option_text(arguments, STRUT_OPTION_AT))
    return strut_print_usage_error(&strut_command_export,
                                   "--at is not for --code, which starts where a run does");
  return export_model(arguments, STRUT_OPEN_AS_RUN, write_code);
}

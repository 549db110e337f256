/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/commands.h"

#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/figures/statics_figures.h"
#include "engine/output/file.h"
#include "engine/output/report/reports.h"
#include "parser/command/statics_options.h"
#include "parser/program/open_model.h"
#include "parser/program/option_values.h"
#include "parser/program/streams.h"
#include "parser/write/write_scene.h"

static const strut_option options[] = {
    STRUT_FORM_OPTIONS,
    {STRUT_OPTION_SET, "set", "NAME=VALUE", "change a parameter; may be repeated"},
    {STRUT_OPTION_OUTPUT, "output", "FILE", "write the new model to FILE and print a report"},
    {STRUT_OPTION_JSON, "json", NULL, "print the report as one JSON object instead of the model"},
    STRUT_PLOT_OPTIONS,
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

/* A model before its form was found. */
typedef struct drawn_model {
  char *text, *flat; /* of the file; of strut_setup_write */
  size_t length;
  double (*position)[2]; /* (node_count) */
} drawn_model;

/* The new model, in the words of the file where that can be. NULL: it was reported. */
static char *write_model(const strut_arguments *arguments, const drawn_model *drawn,
                         const strut_setup *setup) {
  char *model;
  if (strut_write_short(arguments, drawn->text, drawn->length, drawn->flat, setup, false, &model))
    return NULL;
  if (!model) model = strut_setup_write(setup);
  if (!model) strut_print_out_of_memory();
  return model;
}

/* With -o the model goes there, and a report to stdout, else the model. */
static strut_status report_form(const strut_arguments *arguments, const drawn_model *drawn,
                                const strut_setup *setup, const strut_form *form) {
  strut_error error = {0};
  bool silent = arguments->quiet && arguments->output && !arguments->json;
  bool wanted = arguments->output || !arguments->json;
  char *model = wanted ? write_model(arguments, drawn, setup) : NULL, *text = NULL;
  strut_status status = wanted && !model ? STRUT_NO_MEMORY : STRUT_OK;
  if (status == STRUT_OK && arguments->output) {
    status = strut_file_write_path(arguments->output, model, &error);
    if (status != STRUT_OK) strut_print_error(&error);
  }
  if (arguments->json || arguments->output)
    text = arguments->json ? strut_form_json(form, &setup->scene) : strut_form_table(form, setup);
  if (status == STRUT_OK && !text && (arguments->json || arguments->output))
    status = strut_print_out_of_memory();
  if (status == STRUT_OK && !silent) status = strut_print(text ? text : model);
  strut_release(model);
  strut_release(text);
  return status;
}

static strut_status draw_form(const strut_plot *plot, const strut_scene *scene,
                              const double (*drawn)[2], strut_error *error) {
  strut_model *model = NULL;
  if (!plot->path) return STRUT_OK;
  strut_status status = strut_model_compile(scene, &model, error);
  if (status == STRUT_OK) status = strut_form_figure(plot, model, drawn, error);
  strut_model_free(model);
  return status;
}

/* Finds the form, prints and draws it. */
static strut_status find_form(const strut_arguments *arguments, const strut_form_options *wanted,
                              const strut_plot *plot, strut_setup *setup,
                              const drawn_model *drawn) {
  const strut_scene *scene = &setup->scene;
  strut_form form;
  strut_error error = {0};
  for (size_t i = 0; i < scene->node_count; i++)
    memcpy(drawn->position[i], scene->nodes[i].position, sizeof *drawn->position);
  strut_status status = strut_form_find(setup, wanted, &form, &error);
  if (status == STRUT_OK) status = report_form(arguments, drawn, setup, &form);
  if (status == STRUT_OK)
    status = draw_form(plot, scene, (const double(*)[2])drawn->position, &error);
  if (error.message[0]) strut_print_error(&error);
  return status;
}

static strut_status run_form(const strut_arguments *arguments) {
  strut_setup setup;
  strut_form_options wanted = {0};
  strut_plot plot;
  strut_arena arena = {0};
  strut_status status = strut_form_options_read(&strut_command_form, arguments, &wanted);
  if (status == STRUT_OK) status = strut_plot_read(&strut_command_form, arguments, 0, &plot);
  if (status == STRUT_OK) status = strut_try_file(arguments->output);
  if (status != STRUT_OK) return status;
  drawn_model drawn = {0};
  status = strut_open_model_text(arguments, &drawn.text, &drawn.length, &setup);
  if (status != STRUT_OK) return status;
  drawn.flat = strut_setup_write(&setup);
  drawn.position = strut_arena_allocate(&arena, setup.scene.node_count, sizeof *drawn.position);
  status = drawn.position && drawn.flat ? find_form(arguments, &wanted, &plot, &setup, &drawn)
                                        : strut_print_out_of_memory();
  strut_release(drawn.text);
  strut_release(drawn.flat);
  strut_arena_free(&arena);
  strut_setup_free(&setup);
  return status;
}

const strut_command strut_command_form = {
    .name = "form",
    .model = "MODEL",
    .summary = "finds an equilibrium shape or prestress, and writes that model",
    .details =
        "\n--from densities: the shape given by the force densities of the members, or the "
        "nearest\n"
        "densities for which one exists. --from lengths: the shape given by the rest lengths.\n"
        "--from prestress: the drawn shape, with rest lengths that hold it under gravity, loads "
        "and\n"
        "ground forces, every cable in tension. By default, densities if the model gives force\n"
        "densities, lengths if it gives rest lengths, otherwise prestress.\n"
        "The new model is printed or written to FILE, with the parameters, groups and parts of "
        "the\n"
        "old one where these can say it; it stays at rest when run without drives.\n",
    .options = options,
    .run = run_form,
};
